"""What lies where in the memory that the kernels and `sim.structure` share.

The control table is int64: sizes, counters, flags, then the addresses of the arrays; `views` gives the arrays.
"""

import math

# Sizes.
BODIES, MOVING, JOINTS, LOWER = 0, 1, 2, 3
# What happened: first joint whose law gave a number that is not finite (-1 if none, or `WITH_OTHERS` where another
# structure's did), counters, newly broken joints.
FAULT, NEWTON_STEPS, UNCONVERGED, BROKE = 4, 5, 6, 7
WITH_OTHERS = 1 << 40
# Within a step: address of the constraint that acts for all (0 between steps); whether nothing was solved yet.
LEADER, FRESH = 8, 9
# Address of a C function (structure's key) called when a joint broke or a step failed, and that key.
NOTICE, KEY = 10, 11
# Contacts of this step, room for them, those there was no room for, length of the hash table; whether overlap has
# been taken out in this step.
CONTACTS, ROOM, MISSED, HASH_LENGTH, PUSHED_APART = 12, 13, 14, 15, 16
# Whether any joint has a limit; whether a load pattern acts; whether any joint is damped.
BREAKABLE, SPREAD, DAMPED = 17, 18, 27
# Structures in contact with each other are solved together: control table of the one that acts for all of them (0: on
# its own), and the next one in their list.
HEAD, NEXT = 19, 20
# Whether any joint flowed in the last step.
FLOWING = 24
# In this step: whether a body was moved by anything but its velocity (if none was, all shifts are zero); whether a body
# turns with added inertia, and whether nothing holds the structure.
SHIFTED, TURNING, FREE = 21, 22, 23
# In how many parts the step is taken, and whether loose bodies have been moved ahead with them, see `parts`; whether
# the last one was taken in parts.
PARTS, AHEAD, AFTER_PARTS = 25, 26, 30
# Loose bodies noted in `PUSHES`; pairs of shapes that Chipmunk would part the wrong way (-1 once that was seen to).
PUSHED, ASTRAY = 28, 29
# How many of Chipmunk's own constraints a structure's bodies have, see `ties`; 0 before the step's first solve.
TIED = 31
# In this step: whether forces from outside differ from the last one's; whether bodies were moved on at its start, see
# `moves`; how many joints hold; whether nothing but those changes the bodies' velocities while they are solved.
FORCED, CARRYING, HOLDING, ALONE = 32, 33, 34, 35
# Address of the function table of the joints, behind which lie that of the one that acts for all, and the address of
# what is called for it at the end of a step.
OWN_CLASS = 36
# Contacts that may come within the step, after those that Chipmunk found, see `near`; what Python is asked for them,
# see `beside` for the last.
NEAR, ASKED = 37, 38
GATHER, LOOK, DROP, GATHER_BESIDE = 1, 2, 3, 4
# Address of what is noted of the space in a step, see `noted`; 0 before it was looked through.
NOTES = 39
# What Chipmunk would call at the end of a step for the joint that acts for all; 0 for nothing.
THEIR_POST_SOLVE = 40
# In which of its space's steps a structure last took part; 0 before the first. Whether any joint is new to the kernels.
SEEN, NEW = 41, 42
# Whether any lower block of the matrix is not one joint's alone: another's too, or filled in.
SHARED = 43
# How many of its joints Chipmunk has come to in this step; whether constraints of its own hold a structure, see `ties`;
# whether a support was set moving at once, see `late`.
CALLED, PINNED, JERKED = 44, 45, 46
# How many pairs of its bodies touch where they are joined, see `sim.abutting`.
ABUTTING = 47
# In `ACTIVE`: the joint holds, and what it stores is not known yet, see `strained`.
UNKNOWN = 2
_FIRST_ADDRESS = 48
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
    SCRATCH,  # room for what one law gives, and the deformation and state that it is given
    ACTIVE,  # (joints,) int64: 1 while the joint holds, and `UNKNOWN` before its first step
    COLUMN_START,  # (moving + 1,) int64
    COLUMN_ROWS,  # (lower,) int64
    FILL_TARGETS,  # int64
    JOINT_SLOT,  # (joints,) int64
    SETTINGS,  # (settings,)
    LEDGER,  # (ledger,)
    GRADIENT,  # (joints, 8): see below
    DEFORMATION,  # (joints, 3): q at the step's start, less the part of the old velocities; then see `resolved`
    LIGHTNESS,  # (joints, 3): diagonal of J M⁻¹ Jᵀ
    IMPULSE,  # (joints, 3): λ
    RESIDUAL,  # (joints, 3)
    SLOPE,  # (joints, 3): Δλ
    RESPONSE,  # (joints, 9)
    WEIGHT,  # (moving, 4): m, I with what is added to it, and their inverses
    VELOCITY,  # (bodies, 3): those that the solver works on
    WRITTEN,  # (bodies, 3): those that it gave the bodies last
    START_VELOCITY,  # (bodies, 3): before the step's forces
    LAST_VELOCITY,  # (bodies, 3): with which the last step ended, and the bodies were moved
    LAST_POSITION,  # (bodies, 3): with which the last step ended
    SHIFT,  # (bodies, 6): movement since then that velocities do not explain; by contacts, by anyone else
    EXTERNAL,  # (bodies, 3): impulses of the step from outside the structure
    CONTACT_IMPULSE,  # (bodies, 3): impulses of the step from contacts
    SOLUTION,  # (bodies, 3); stays zero for bodies that do not move
    DIAGONAL,  # (moving, 9)
    LOWER_BLOCKS,  # (lower, 9)
    COLUMN,  # (longest column of lower blocks, 9): room to work in
    RESULT,  # (joints, 16)
    BODY_KEYS,  # hash table from a body's address …
    BODY_VALUES,  # … to its index
    PLACES,  # (room, 8) int64: contacts, see `contacts`
    TOUCHES,  # (room, 33)
    PATTERN,  # (bodies, 3): forces of the load pattern for a load factor of 1
    IMAGE,  # (bodies, 3): H⁻¹ of it
    BEGUN_AT,  # (bodies, 3): positions at the start of a step that is taken in parts
    COPY,  # what such a step found, see `refusal`; made when first needed
    PUSHES,  # (room, 4): address (int64) and pseudo-velocities with which loose bodies ended the last step
    LAST_FORCE,  # (bodies, 3): forces and moments from outside in the last step, see `sudden`
    CARRIED,  # (bodies, 3): by what bodies were moved at the start of a step of another length, see `moves`
    ABUTTING_PAIRS,  # (pairs,) int64, sorted: of two bodies the lesser index times that of all, and the greater one
) = range(_FIRST_ADDRESS, _FIRST_ADDRESS + 50)
CONTROL_WORDS = _FIRST_ADDRESS + 50

# Settings (float64); the spread ones are those of the load pattern's spring, see `spread`; BETA and DELTA of a step are
# chosen from the wanted ones.
STEP, BETA, DELTA, TOLERANCE, LAST_RESIDUAL, TANGENT_REACH, ROUNDING = 0, 1, 2, 3, 4, 5, 6
SPREAD_STIFFNESS, SPREAD_GAP, SPREAD_IMPULSE = 7, 8, 9
WANTED_BETA, WANTED_DELTA = 10, 11
# Chipmunk's step, of which `STEP` may be a part, and over the last one; energy of a blow that lasts, see `blow`.
WHOLE_STEP, WHOLE_RATIO, BLOW = 12, 13, 14
# Since the blow began: kinetic energy then; elastic energy and plastic work, the least, the most after it; when that
# was, and time passed.
BLOW_KINETIC, BLOW_LEAST, BLOW_MOST, BLOW_MOST_AT, BLOW_AGE = 15, 16, 17, 18, 19
# Energy that forces from outside bring suddenly, see `sudden`; whether every step is to be taken whole.
SUDDEN, WHOLE_ONLY = 20, 21
# For how long the velocities at the start of a step have moved the bodies, see `moves`.
MOVE = 22
# Share of a structure's energy below which its blow is none any more.
BLOW_SHARE = 23
# How far surfaces may move until their contacts are to be found anew, and have moved [m].
MARGIN, TRAVEL = 24, 25
# 1 - δ of parts by the average-acceleration rule, or 0 for implicit Euler; what it is after impulses that bring much of
# a structure's energy, and after what else comes suddenly, see `sudden`.
UNDAMPED, AFTER_IMPULSES, AFTER_FORCES = 26, 0.98, 0.9
# For how long the velocities that a step ends with are to move the bodies: `STEP`, but in parts of one, see `parts`.
NEXT_MOVE = 27
# Shortest part of a step while a blow lasts, see `lengths`.
SHORTEST = 28
# Whether steps, or parts of them, have been of more than one length, see `kinematics.prepare`.
UNEVEN = 29
# By what share of their stiffness joints resist while the way to a solution is felt, see `approach`; 1 otherwise.
SOFT = 30
# The most that outer forces had done in any step by the average-acceleration rule [J], see `guard`.
LARGEST = 31
# Angular momentum of a new structure's bodies before some are put to where others have taken them; no number otherwise.
MOMENT = 32
# How old a blow was when it was over, and its parts began to grow to whole steps; 0 before, see `lengths`.
OVER_AT = 33
_NUMBERS = 34
# All of them again, as they were before the step.
BEFORE, SETTINGS_WORDS = _NUMBERS, 2 * _NUMBERS

# Ledger [J], see `energy`: running totals, the present kinetic and elastic energy, plastic work that is to be booked in
# the next step, and such that nothing has paid for yet.
LEDGER_EXTERNAL, LEDGER_KINETIC, LEDGER_ELASTIC, LEDGER_PLASTIC = 0, 1, 2, 3
LEDGER_CONTACT, LEDGER_VISCOUS, LEDGER_NUMERICAL, LEDGER_TO_COME, LEDGER_OWED = 4, 5, 6, 7, 8
LEDGER_WORDS = 9

# Geometry of a joint: anchor on a and on b (from their centres of gravity, body coordinates), rest angle of the
# joint's frame on a and on b, share α of b's rotation in the frame, cosine and sine of the two rest angles, extension
# over the square of the rotation.
ANCHOR_A, ANCHOR_B, REST_A, REST_B, TURN, AXIS_A, AXIS_B, ARC = 0, 2, 4, 5, 6, 7, 9, 11
GEOMETRY_WORDS = 12

# Gradient of a joint's deformation: axis e of its frame; u̇ and v̇ per rate of rotation of a and of b; 1, or 0
# when the joint does not hold and all of these are 0. A word is spare, so that a row is a cache line.
E_X, E_Y, U_A, U_B, V_A, V_B, HOLDS = range(7)
GRADIENT_WORDS = 8

# Limits of a joint: plastic elongation, slip and rotation at which it breaks, whether compression counts (1) or not.
LIMITS_WORDS = 4

# Response of a law: s = (N, Q, M), then the upper triangle of D = ∂s/∂q row by row.
FORCE, TANGENT = 0, 3
RESPONSE_WORDS = 9
# What a law's commit gives: elastic energy, work dissipated in the step, plastic deformation added in it (u, v, θ).
COMMIT_WORDS, FLOW = 5, 2

# Where a joint's deformation and state begin in the scratch memory, after room for what its law gives.
SCRATCH_Q, SCRATCH_STATE = 9, 12

# Weight of a body in the solver.
INERTIA_M, INERTIA_I, INVERSE_M, INVERSE_I = 0, 1, 2, 3
WEIGHT_WORDS = 4

# Result of a step: q*, force, elastic energy and that before the step; then, in a cache line of its own, what changes
# where joints flow, are damped or may break: plastic deformation summed without sign (elongation, shortening, slip,
# rotation), plastic work so far, viscous work so far, share of the plastic capacity used, and a spare word.
RESULT_Q, RESULT_FORCE, RESULT_ELASTIC, RESULT_BEFORE = 0, 3, 6, 7
RESULT_PLASTIC, RESULT_DISSIPATED, RESULT_VISCOUS, RESULT_USED = 8, 12, 13, 14
RESULT_WORDS = 16

# A contact in `places`: address of the cpContact, its hash; for each side the control table of the structure that the
# body belongs to (0: none), its index there, and its address. A contact that came within the step keeps in place of a
# hash the address of the one of Chipmunk's that it stands for, or 0.
WHERE, HASH, OWNER_A, INDEX_A, BODY_A, OWNER_B, INDEX_B, BODY_B = range(8)
PLACE_WORDS = 8
# A contact in `touches`: normal, arms, friction, surface velocity along the tangent, wanted normal velocity, bias,
# cached impulses, velocities of the other side's point at the step's start (normal, tangent), and where neither body is
# a structure's, that of b's alone; distance of the surfaces, impulses of the step's earlier parts, wanted velocity by
# restitution alone, speed with which bodies struck each other in this contact; how far the two shapes reach from their
# bodies' centres, and their restitution, for contacts that come within the step; half the way from Chipmunk's point on
# a to that on b; the two masses that Chipmunk gave the contact; what share of the way from a's point to b's it acts at;
# what loose bodies gave to its velocity when it was solved last; by what radius either shape is rounded there.
NORMAL, ARM_A, ARM_B, FRICTION, SURFACE, WANTED, PUSH = 0, 2, 4, 6, 7, 8, 9
CACHED, OTHER_START, B_START, GAP, EARLIER, BOUNCE, STRIKE = 10, 12, 14, 16, 17, 19, 20
REACH, RETURN, HALF, MASSES, MEETING, SOLVED, ROUNDED = 21, 23, 24, 26, 28, 29, 31
TOUCH_WORDS = 33
# Distance of surfaces that cannot meet before contacts are found anew; it stays that, however they move [m].
FAR = math.inf
