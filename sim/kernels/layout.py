"""What lies where in the memory that the kernels and `sim.structure` share.

The control table is int64: sizes, counters, flags, then the addresses of the arrays.
"""

# Sizes.
BODIES, MOVING, JOINTS, LOWER = 0, 1, 2, 3
# What happened: first joint whose law gave a number that is not finite (or -1), counters, newly broken joints.
FAULT, NEWTON_STEPS, UNCONVERGED, BROKE = 4, 5, 6, 7
# Within a step: address of the constraint that acts for all (0 between steps); whether nothing was solved yet.
LEADER, FRESH = 8, 9
# Address of a C function (structure's key) called when a joint broke or a step failed, and that key.
NOTICE, KEY = 10, 11
# Contacts of this step, room for them, those there was no room for, length of the hash table; whether overlap has
# been taken out in this step.
CONTACTS, ROOM, MISSED, HASH_LENGTH, PUSHED_APART = 12, 13, 14, 15, 16
# Whether any joint has a limit; whether a load pattern acts.
BREAKABLE, SPREAD = 17, 18
_FIRST_ADDRESS = 19
(
    BODY_AT,  # (bodies,) int64: addresses of the cpBody structs
    JOINT_AT,  # (joints,) int64: addresses of the cpConstraint structs
    JOINT_BODIES,  # (joints, 2) int64
    GEOMETRY,  # (joints, 12)
    LAWS,  # (joints, 5) int64: respond, commit, parameters, state, length of the state
    STIFFNESS,  # (joints, 6): elastic tangent
    DAMPING,  # (joints, 3): force over rate of deformation
    LIMITS,  # (joints, 4)
    SCALE,  # (joints,): share of its force that a joint about to break may still give; 1 otherwise
    SCRATCH,  # room for one joint's state
    ACTIVE,  # (joints,) int64: 1 while the joint holds
    COLUMN_START,  # (moving + 1,) int64
    COLUMN_ROWS,  # (lower,) int64
    FILL_TARGETS,  # int64
    JOINT_SLOT,  # (joints,) int64
    SETTINGS,  # (settings,)
    JACOBIAN,  # (joints, 18): rows u, v, θ; columns a's vx vy ω, b's vx vy ω
    DEFORMATION,  # (joints, 3): q at the step's start, less the part of the old velocities
    LIGHTNESS,  # (joints, 3): diagonal of J M⁻¹ Jᵀ
    IMPULSE,  # (joints, 3): λ
    RESIDUAL,  # (joints, 3)
    SLOPE,  # (joints, 3): Δλ
    RESPONSE,  # (joints, 9)
    VELOCITY,  # (bodies, 3)
    START_VELOCITY,  # (bodies, 3): before the step's forces
    LAST_VELOCITY,  # (bodies, 3): with which the last step ended, and the bodies were moved
    SOLUTION,  # (bodies, 3); stays zero for bodies that do not move
    DIAGONAL,  # (moving, 9)
    LOWER_BLOCKS,  # (lower, 9)
    SCALED_BLOCKS,  # (lower, 9)
    RESULT,  # (joints, 14)
    BODY_KEYS,  # hash table from a body's address …
    BODY_VALUES,  # … to its index
    PLACES,  # (room, 5) int64: contacts, see `contacts`
    TOUCHES,  # (room, 10)
    OPERATOR,  # (2 room, 2 room)
    CONTACT_VELOCITY,  # (2 room,)
    CONTACT_CHANGE,  # (2 room,)
    PATTERN,  # (bodies, 3): forces of the load pattern for a load factor of 1
    IMAGE,  # (bodies, 3): H⁻¹ of it
) = range(_FIRST_ADDRESS, _FIRST_ADDRESS + 40)
CONTROL_WORDS = _FIRST_ADDRESS + 40

# Settings (float64); the last three are those of the load pattern's spring, see `spread`.
STEP, BETA, DELTA, TOLERANCE, LAST_RESIDUAL = 0, 1, 2, 3, 4
SPREAD_STIFFNESS, SPREAD_GAP, SPREAD_IMPULSE = 5, 6, 7
SETTINGS_WORDS = 8

# Geometry of a joint: anchor on a and on b (from their centres of gravity, body coordinates), rest angle of the
# joint's frame on a and on b, share α of b's rotation in the frame, cosine and sine of the two rest angles, extension
# over the square of the rotation.
ANCHOR_A, ANCHOR_B, REST_A, REST_B, TURN, AXIS_A, AXIS_B, ARC = 0, 2, 4, 5, 6, 7, 9, 11
GEOMETRY_WORDS = 12

# Limits of a joint: plastic elongation, slip and rotation at which it breaks, whether compression counts (1) or not.
LIMITS_WORDS = 4

# Response of a law: s = (N, Q, M), then the upper triangle of D = ∂s/∂q row by row.
FORCE, TANGENT = 0, 3
RESPONSE_WORDS = 9

# What a law's commit gives: elastic energy, work dissipated in the step, plastic deformation added in it (u, v, θ).
COMMIT_WORDS = 5

# Result of a step: q*, force, plastic deformation summed without sign (elongation, shortening, slip, rotation),
# elastic energy, plastic work so far, viscous work so far, share of the plastic capacity used.
RESULT_Q, RESULT_FORCE, RESULT_PLASTIC = 0, 3, 6
RESULT_ELASTIC, RESULT_DISSIPATED, RESULT_VISCOUS, RESULT_USED = 10, 11, 12, 13
RESULT_WORDS = 14
