"""Deformations of the joints and their exact gradient.

With d the vector between a joint's two anchors and e, n the axes of a frame that turns with the angle
ψ = (1 - α)(θa + φa) + α (θb + φb):

    u = e·d,  v = n·d,  θ = (θb + φb) - (θa + φa),
    u̇ = e·ḋ + (n·d) ψ̇,  v̇ = n·ḋ - (e·d) ψ̇.

The terms in ψ̇ make the pair of forces exactly free of moment, so angular momentum is kept.

A joint that stands for a length ℓ of a member stands for an arc, and its kink for less way than that: with rotations
Δ_i = w_i L κ_i at the points x_i of a rule, the chain's Σ (1 - x_i) (sin θ_i - sin θ_{i-1}) falls short of the rule's
∫ (1 - x) κ cos θ dx by the factor 1 - Δ_i²/24. So u counts from an extension of ℓ θ²/24 on.
"""

import math

from numba import njit

from sim.chipmunk import ANGLE, BODY_WORDS, CONSTRAINT_SPACE, COSINE, SINE, X
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.layout import ANCHOR_A, ANCHOR_B, ARC, AXIS_A, AXIS_B, INVERSE_I, INVERSE_M, REST_A, REST_B, TURN
from sim.memory import floats, integers

_EPSILON = 2.0**-52


@njit(error_model="numpy")
def leave_out(t):  # type: ignore[no-untyped-def]
    """Let go of joints that are no longer in the space; returns whether any joint is tied to a held body."""
    active, joint_at, joint_bodies = views.active(t), views.joint_at(t), views.joint_bodies(t)
    moving, held = t[at.MOVING], False
    for k in range(t[at.JOINTS]):
        if integers(joint_at[k], CONSTRAINT_SPACE + 1)[CONSTRAINT_SPACE] == 0:
            active[k] = 0
        held = held or (active[k] != 0 and (joint_bodies[k, 0] >= moving or joint_bodies[k, 1] >= moving))
    return held


@njit(error_model="numpy")
def prepare(t):  # type: ignore[no-untyped-def]
    """Deformation and gradient at the bodies' present positions; joints that do not hold get none.

    Also what rounding of positions makes of the residual impulses, as an energy like theirs.
    """
    joint_bodies, body_at, active, geometry = (
        views.joint_bodies(t),
        views.body_at(t),
        views.active(t),
        views.geometry(t),
    )
    jacobian, deformation, lightness = (
        views.jacobian(t),
        views.per_joint(t, at.DEFORMATION),
        views.per_joint(t, at.LIGHTNESS),
    )
    settings, weight, last = views.settings(t), views.weight(t), views.per_body(t, at.LAST_VELOCITY)
    moving, lag, stiffness = t[at.MOVING], settings[at.BETA] * settings[at.STEP], views.stiffness(t)
    rounding = 0.0
    for k in range(t[at.JOINTS]):
        if active[k] == 0:
            for i in range(18):
                jacobian[k, i] = 0.0
            for i in range(3):
                lightness[k, i] = 0.0
            continue
        ia, ib = joint_bodies[k, 0], joint_bodies[k, 1]
        a, b = floats(body_at[ia], BODY_WORDS), floats(body_at[ib], BODY_WORDS)
        rax = a[COSINE] * geometry[k, ANCHOR_A] - a[SINE] * geometry[k, ANCHOR_A + 1]
        ray = a[SINE] * geometry[k, ANCHOR_A] + a[COSINE] * geometry[k, ANCHOR_A + 1]
        rbx = b[COSINE] * geometry[k, ANCHOR_B] - b[SINE] * geometry[k, ANCHOR_B + 1]
        rby = b[SINE] * geometry[k, ANCHOR_B] + b[COSINE] * geometry[k, ANCHOR_B + 1]
        dx, dy = b[X] + rbx - a[X] - rax, b[X + 1] + rby - a[X + 1] - ray
        alpha = geometry[k, TURN]
        angle_a, angle_b = a[ANGLE] + geometry[k, REST_A], b[ANGLE] + geometry[k, REST_B]
        c, s = frame(a, b, geometry, k, angle_a, angle_b)
        u, v = c * dx + s * dy, -s * dx + c * dy
        jacobian[k, 0], jacobian[k, 1], jacobian[k, 2] = -c, -s, c * ray - s * rax + (1.0 - alpha) * v
        jacobian[k, 3], jacobian[k, 4], jacobian[k, 5] = c, s, -c * rby + s * rbx + alpha * v
        jacobian[k, 6], jacobian[k, 7], jacobian[k, 8] = s, -c, -s * ray - c * rax - (1.0 - alpha) * u
        jacobian[k, 9], jacobian[k, 10], jacobian[k, 11] = -s, c, s * rby + c * rbx - alpha * u
        jacobian[k, 12], jacobian[k, 13], jacobian[k, 14] = 0.0, 0.0, -1.0
        jacobian[k, 15], jacobian[k, 16], jacobian[k, 17] = 0.0, 0.0, 1.0
        mass, turn_a, turn_b = 0.0, 0.0, 0.0
        if ia < moving:
            mass, turn_a = weight[ia, INVERSE_M], weight[ia, INVERSE_I]
        if ib < moving:
            mass, turn_b = mass + weight[ib, INVERSE_M], weight[ib, INVERSE_I]
        lightness[k, 0] = mass + jacobian[k, 2] * jacobian[k, 2] * turn_a + jacobian[k, 5] * jacobian[k, 5] * turn_b
        lightness[k, 1] = mass + jacobian[k, 8] * jacobian[k, 8] * turn_a + jacobian[k, 11] * jacobian[k, 11] * turn_b
        lightness[k, 2] = turn_a + turn_b
        deformation[k, 0], deformation[k, 1], deformation[k, 2] = u, v, angle_b - angle_a
        arc = geometry[k, ARC] * (angle_b - angle_a)
        deformation[k, 0] -= arc * (angle_b - angle_a)
        jacobian[k, 2] += 2.0 * arc
        jacobian[k, 5] -= 2.0 * arc
        place, turn = abs(b[X]) + abs(b[X + 1]) + abs(rbx) + abs(rby), abs(angle_a) + abs(angle_b)
        rounding += lightness[k, 0] * (stiffness[k, 0] * place) ** 2 + lightness[k, 1] * (stiffness[k, 3] * place) ** 2
        rounding += lightness[k, 2] * (stiffness[k, 5] * turn) ** 2
        if lag != 0.0:
            x, y, z = rates(jacobian, k, last, ia, last, ib)
            deformation[k, 0] -= lag * x
            deformation[k, 1] -= lag * y
            deformation[k, 2] -= lag * z
    settings[at.ROUNDING] = (_EPSILON * settings[at.STEP]) ** 2 * rounding


@njit(inline="always", error_model="numpy")
def frame(a, b, geometry, k, angle_a, angle_b):  # type: ignore[no-untyped-def]
    """Cosine and sine of ψ; halfway between the two bodies' axes without an angle function, while they are near."""
    alpha = geometry[k, TURN]
    if alpha == 0.5 and abs(angle_b - angle_a) < 1.0:
        c = (
            a[COSINE] * geometry[k, AXIS_A]
            - a[SINE] * geometry[k, AXIS_A + 1]
            + b[COSINE] * geometry[k, AXIS_B]
            - b[SINE] * geometry[k, AXIS_B + 1]
        )
        s = (
            a[SINE] * geometry[k, AXIS_A]
            + a[COSINE] * geometry[k, AXIS_A + 1]
            + b[SINE] * geometry[k, AXIS_B]
            + b[COSINE] * geometry[k, AXIS_B + 1]
        )
        size = 1.0 / math.sqrt(c * c + s * s)
        return c * size, s * size
    psi = (1.0 - alpha) * angle_a + alpha * angle_b
    return math.cos(psi), math.sin(psi)


@njit(inline="always", error_model="numpy")
def rates(j, k, va, ia, vb, ib):  # type: ignore[no-untyped-def]
    """J of joint k times the velocities of its two bodies, rows ia of va and ib of vb."""
    a0, a1, a2 = va[ia, 0], va[ia, 1], va[ia, 2]
    b0, b1, b2 = vb[ib, 0], vb[ib, 1], vb[ib, 2]
    return (
        j[k, 0] * a0 + j[k, 1] * a1 + j[k, 2] * a2 + j[k, 3] * b0 + j[k, 4] * b1 + j[k, 5] * b2,
        j[k, 6] * a0 + j[k, 7] * a1 + j[k, 8] * a2 + j[k, 9] * b0 + j[k, 10] * b1 + j[k, 11] * b2,
        j[k, 14] * a2 + j[k, 17] * b2,
    )
