"""Mass and inertia of the bodies in the solver, with what keeps pulled joints from whipping.

A joint's force F acts on a body at an arm r, and the direction of F and r are those of the step's start. Where the body
turns by h ω within the step, the moment it would have at the end is less by h ω k, with k = r·F for a force that pulls
outwards. Left out, this geometric stiffness is integrated explicitly, which is stable for h² k < 4 I only: light links
under a heavy load, bending freely, whip about with ever more energy. So where h² k exceeds the body's own inertia and
the joints' bending stiffness Σ D_θθ, which acts implicitly, the excess is added,

    I + max(0, h² (k - Σ D_θθ) - I) in place of I,   and ω̂ is scaled so that I ω̂ stays what it is:

an implicit moment - h k ω. Forces are those of the last step, tangents too. Nothing is added for forces that push
inwards, and nothing at all in ordinary structures.

On a structure that nothing holds, the moment impulses h k ω are given back as a rigid turn of the whole about its
centre of mass. It deforms no joint, so the solution stays one, and the angular momentum stays what it was to rounding.
"""

from sim.chipmunk import BODY_WORDS, MASS, MOMENT, X
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.bare import clear
from sim.kernels.kinematics import impulses, turned
from sim.kernels.layout import ANCHOR_A, INERTIA_I, INERTIA_M, INVERSE_I, INVERSE_M, TANGENT
from sim.memory import floats, inlined, kernel

# Stands for an infinite mass or moment of inertia, so that no 0 · ∞ arises.
_IMMOVABLE = 1e30


@inlined
def mass_of(b):  # type: ignore[no-untyped-def]
    """Mass of a body's struct, finite."""
    return min(b[MASS], _IMMOVABLE)


@inlined
def moment_of(b):  # type: ignore[no-untyped-def]
    """Moment of inertia of a body's struct, finite."""
    return min(b[MOMENT], _IMMOVABLE)


@inlined
def weigh(weight, i, b):  # type: ignore[no-untyped-def]
    """Weight of body i by its struct; mostly it is what it was."""
    mass, moment = mass_of(b), moment_of(b)
    if weight[i, INERTIA_M] != mass or weight[i, INERTIA_I] != moment:
        weight[i, INERTIA_M], weight[i, INERTIA_I] = mass, moment
        weight[i, INVERSE_M] = 1.0 / mass if mass < _IMMOVABLE else 0.0
        weight[i, INVERSE_I] = 1.0 / moment if moment < _IMMOVABLE else 0.0


@inlined
def add_inertia(t):  # type: ignore[no-untyped-def]
    """Add the geometric stiffness to the weights, and scale the solver's velocities accordingly.

    Needs gradient, impulses and responses of the last step, before they are renewed.
    """
    joint_bodies, body_at, weight = views.joint_bodies(t), views.body_at(t), views.weight(t)
    gradient, impulse, response = views.gradient(t), views.per_joint(t, at.IMPULSE), views.response(t)
    damping, geometry, settings = views.damping(t), views.geometry(t), views.settings(t)
    excess, velocity = views.per_body(t, at.SOLUTION), views.per_body(t, at.VELOCITY)
    moving, move, any_pulls = t[at.MOVING], settings[at.NEXT_MOVE], False
    factor, reach = settings[at.STEP] * move, settings[at.TANGENT_REACH]
    t[at.TURNING] = 0
    for k in range(t[at.JOINTS]):
        x, y = impulse[k, 0], impulse[k, 1]
        if x == 0.0 and y == 0.0:
            continue
        bending = factor * response[k, TANGENT + 5]
        if t[at.DAMPED] == 1:
            bending -= factor * damping[k, 2] / reach
        arms = abs(geometry[k, 0]) + abs(geometry[k, 1]) + abs(geometry[k, 2]) + abs(geometry[k, 3])
        if move * (abs(x) + abs(y)) * arms <= bending:
            continue  # it cannot outweigh what bends against it
        if not any_pulls:
            any_pulls = True
            clear(excess)
        px, py, _, _ = impulses(gradient, k, x, y, 0.0)
        for side in range(2):
            i = joint_bodies[k, side]
            if i < moving:
                b = floats(body_at[i], BODY_WORDS)
                rx, ry = turned(b, geometry[k, ANCHOR_A + 2 * side], geometry[k, ANCHOR_A + 2 * side + 1])
                outwards = move * (px * rx + py * ry)
                excess[i, 2] += (outwards if side == 1 else -outwards) - bending
    if not any_pulls:
        return
    for i in range(moving):
        moment = excess[i, 2]
        if moment > weight[i, INERTIA_I]:
            velocity[i, 2] *= weight[i, INERTIA_I] / moment
            weight[i, INERTIA_I] = moment
            weight[i, INVERSE_I] = 1.0 / moment if moment < _IMMOVABLE else 0.0
            t[at.TURNING] = 1


@kernel
def as_rigid_body(t):  # type: ignore[no-untyped-def]
    """Mass [kg], centre [m] and moment of inertia about it [kg m²] of a structure's moving bodies as one."""
    body_at, mass, cx, cy, inertia = views.body_at(t), 0.0, 0.0, 0.0, 0.0
    for i in range(t[at.MOVING]):
        b = floats(body_at[i], BODY_WORDS)
        mass, cx, cy = mass + mass_of(b), cx + mass_of(b) * b[X], cy + mass_of(b) * b[X + 1]
    cx, cy = cx / mass, cy / mass
    for i in range(t[at.MOVING]):
        b = floats(body_at[i], BODY_WORDS)
        x, y = b[X] - cx, b[X + 1] - cy
        inertia += moment_of(b) + mass_of(b) * (x * x + y * y)
    return mass, cx, cy, inertia


@kernel
def give_back(t, velocity, out):  # type: ignore[no-untyped-def]
    """Give the moment of the inertia that was added at ``velocity`` back to a free structure's velocities ``out``."""
    body_at, weight, moving = views.body_at(t), views.weight(t), t[at.MOVING]
    _, cx, cy, inertia = as_rigid_body(t)
    lost = 0.0
    for i in range(moving):
        lost += (weight[i, INERTIA_I] - moment_of(floats(body_at[i], BODY_WORDS))) * velocity[i, 2]
    turn = lost / inertia
    for i in range(moving):
        b = floats(body_at[i], BODY_WORDS)
        out[i, 0] -= turn * (b[X + 1] - cy)
        out[i, 1] += turn * (b[X] - cx)
        out[i, 2] += turn
