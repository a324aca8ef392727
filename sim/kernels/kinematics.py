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

from sim.chipmunk import ANGLE, BODY_WORDS, COSINE, SINE, X
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.bare import from_column
from sim.kernels.layout import (
    ANCHOR_A,
    ANCHOR_B,
    ARC,
    AXIS_A,
    AXIS_B,
    E_X,
    E_Y,
    HOLDS,
    INVERSE_I,
    INVERSE_M,
    REST_A,
    REST_B,
    TURN,
    U_A,
    U_B,
    V_A,
    V_B,
)
from sim.memory import floats, inlined, kernel

_EPSILON = 2.0**-52


@inlined
def take_up(t, ratio):  # type: ignore[no-untyped-def]
    """Joints that hold start from ``ratio`` times their last impulses; whether any holds to what does not move."""
    active, joint_bodies = views.active(t), views.joint_bodies(t)
    impulse, scale = views.per_joint(t, at.IMPULSE), views.scale(t)
    moving, held, holding = t[at.MOVING], False, 0
    for k in range(t[at.JOINTS]):
        holding += 1 if active[k] != 0 else 0
        held = held or (active[k] != 0 and (joint_bodies[k, 0] >= moving or joint_bodies[k, 1] >= moving))
        share = ratio if active[k] != 0 else 0.0
        if share != 1.0:
            for i in range(3):
                impulse[k, i] *= share
        if t[at.BREAKABLE] == 1:
            scale[k] = 1.0
    t[at.FREE], t[at.HOLDING] = 0 if held or t[at.PINNED] == 1 else 1, holding


@kernel
def let_go(t, k, h):  # type: ignore[no-untyped-def]
    """Book the impulse of joint k, in a step of ``h``, as forces from outside until now: it is not there any more."""
    joint_bodies, impulse, force = (
        views.joint_bodies(t),
        views.per_joint(t, at.IMPULSE),
        views.per_body(t, at.LAST_FORCE),
    )
    px, py, on_a, on_b = impulses(views.gradient(t), k, impulse[k, 0] / h, impulse[k, 1] / h, impulse[k, 2] / h)
    ia, ib = joint_bodies[k, 0], joint_bodies[k, 1]
    if ia < t[at.MOVING]:
        force[ia, 0] -= px
        force[ia, 1] -= py
        force[ia, 2] += on_a
    if ib < t[at.MOVING]:
        force[ib, 0] += px
        force[ib, 1] += py
        force[ib, 2] += on_b


@kernel
def lag_of(settings):  # type: ignore[no-untyped-def]
    """How far q* lags behind the old velocities: β times as long as they have moved the bodies [s]."""
    return settings[at.BETA] * settings[at.MOVE]


@kernel
def prepare(t):  # type: ignore[no-untyped-def]
    """Deformation and gradient at the bodies' present positions; joints that do not hold get none.

    Also what rounding of positions makes of the residual impulses, as an energy like theirs. Returns the elastic energy
    of what the average-acceleration rule finds them to differ by from where the last step left them, see `resolved`.
    """
    joint_bodies, body_at, active = views.joint_bodies(t), views.body_at(t), views.active(t)
    geometry, gradient, stiffness = views.geometry(t), views.gradient(t), views.stiffness(t)
    deformation, lightness = views.per_joint(t, at.DEFORMATION), views.per_joint(t, at.LIGHTNESS)
    settings, weight, last = views.settings(t), views.weight(t), views.per_body(t, at.LAST_VELOCITY)
    moving, lag, rounding, strayed, shift = t[at.MOVING], lag_of(settings), 0.0, 0.0, views.shift(t)
    # Straight on from the last step and straight back from this one lead to one place up to the third order, while both
    # are of one length.
    curved = 2.0 * lag * lag if settings[at.UNEVEN] != 0.0 else 0.0
    for k in range(t[at.JOINTS]):
        if active[k] == 0:
            for i in range(at.GRADIENT_WORDS):
                gradient[k, i] = 0.0
            for i in range(3):
                lightness[k, i] = 0.0
            continue
        ia, ib = joint_bodies[k, 0], joint_bodies[k, 1]
        a, b = floats(body_at[ia], BODY_WORDS), floats(body_at[ib], BODY_WORDS)
        rax, ray = turned(a, geometry[k, ANCHOR_A], geometry[k, ANCHOR_A + 1])
        rbx, rby = turned(b, geometry[k, ANCHOR_B], geometry[k, ANCHOR_B + 1])
        dx, dy = b[X] + rbx - a[X] - rax, b[X + 1] + rby - a[X + 1] - ray
        alpha = geometry[k, TURN]
        angle_a, angle_b = a[ANGLE] + geometry[k, REST_A], b[ANGLE] + geometry[k, REST_B]
        c, s = frame(a, b, geometry, k, angle_a, angle_b)
        u, v, kink = c * dx + s * dy, -s * dx + c * dy, angle_b - angle_a
        u_a, u_b = c * ray - s * rax + (1.0 - alpha) * v, -c * rby + s * rbx + alpha * v
        v_a, v_b = -s * ray - c * rax - (1.0 - alpha) * u, s * rby + c * rbx - alpha * u
        mass, turn_a, turn_b = 0.0, 0.0, 0.0
        if ia < moving:
            mass, turn_a = weight[ia, INVERSE_M], weight[ia, INVERSE_I]
        if ib < moving:
            mass, turn_b = mass + weight[ib, INVERSE_M], weight[ib, INVERSE_I]
        light_u, light_v = (
            mass + u_a * u_a * turn_a + u_b * u_b * turn_b,
            mass + v_a * v_a * turn_a + v_b * v_b * turn_b,
        )
        lightness[k, 0], lightness[k, 1], lightness[k, 2] = light_u, light_v, turn_a + turn_b
        place, turn = abs(b[X]) + abs(b[X + 1]) + abs(rbx) + abs(rby), abs(angle_a) + abs(angle_b)
        rounding += light_u * (stiffness[k, 0] * place) ** 2 + light_v * (stiffness[k, 3] * place) ** 2
        rounding += (turn_a + turn_b) * (stiffness[k, 5] * turn) ** 2
        arc = geometry[k, ARC] * kink
        expected_u, expected_v, expected_turn = deformation[k, 0], deformation[k, 1], deformation[k, 2]
        deformation[k, 0], deformation[k, 1], deformation[k, 2] = u - arc * kink, v, kink
        gradient[k, E_X], gradient[k, E_Y], gradient[k, HOLDS] = c, s, 1.0
        gradient[k, U_A], gradient[k, U_B] = u_a + 2.0 * arc, u_b - 2.0 * arc
        gradient[k, V_A], gradient[k, V_B] = v_a, v_b
        if lag != 0.0:
            x, y, z = rates(gradient, k, last, ia, last, ib)
            du, dv, dw = last[ib, 0] - last[ia, 0], last[ib, 1] - last[ia, 1], last[ib, 2] - last[ia, 2]
            du, dv = du - last[ib, 2] * rby + last[ia, 2] * ray, dv + last[ib, 2] * rbx - last[ia, 2] * rax
            turning, wa, wb = (1.0 - alpha) * last[ia, 2] + alpha * last[ib, 2], last[ia, 2] ** 2, last[ib, 2] ** 2
            ddx, ddy = wa * rax - wb * rbx, wa * ray - wb * rby
            ddu = c * ddx + s * ddy + 2.0 * turning * (c * dv - s * du) - turning**2 * u
            ddv = c * ddy - s * ddx - 2.0 * turning * (c * du + s * dv) - turning**2 * v
            ddu -= 2.0 * geometry[k, ARC] * dw * dw
            deformation[k, 0] -= lag * x - curved * ddu
            deformation[k, 1] -= lag * y - curved * ddv
            deformation[k, 2] -= lag * z
            u, v, kink = deformation[k, 0] - lag * x, deformation[k, 1] - lag * y, deformation[k, 2] - lag * z
            du, dv, dw = u - expected_u, v - expected_v, kink - expected_turn
            if t[at.SHIFTED] == 1:
                for first in range(0, 6, 3):
                    by = from_column(shift, first)
                    x, y, z = rates(gradient, k, by, ia, by, ib)
                    du, dv, dw = du - x, dv - y, dw - z
            strayed += 0.5 * quadratic(stiffness[k], du, dv, dw)
    settings[at.ROUNDING] = (_EPSILON * settings[at.STEP]) ** 2 * rounding
    return strayed


@inlined
def turned(body, x, y):  # type: ignore[no-untyped-def]
    """A vector in body coordinates, in the world's."""
    c, s = body[COSINE], body[SINE]
    return c * x - s * y, s * x + c * y


@inlined
def frame(a, b, geometry, k, angle_a, angle_b):  # type: ignore[no-untyped-def]
    """Cosine and sine of ψ; halfway between the two bodies' axes without an angle function, while they are near."""
    alpha = geometry[k, TURN]
    if alpha == 0.5 and abs(angle_b - angle_a) < 1.0:
        ax, ay = turned(a, geometry[k, AXIS_A], geometry[k, AXIS_A + 1])
        bx, by = turned(b, geometry[k, AXIS_B], geometry[k, AXIS_B + 1])
        c, s = ax + bx, ay + by
        size = 1.0 / math.sqrt(c * c + s * s)
        return c * size, s * size
    psi = (1.0 - alpha) * angle_a + alpha * angle_b
    return math.cos(psi), math.sin(psi)


@inlined
def rates(gradient, k, va, ia, vb, ib):  # type: ignore[no-untyped-def]
    """u̇, v̇ and θ̇ of joint k at the velocities of its two bodies, rows ia of va and ib of vb."""
    c, s, spin_a, spin_b = gradient[k, E_X], gradient[k, E_Y], va[ia, 2], vb[ib, 2]
    x, y = vb[ib, 0] - va[ia, 0], vb[ib, 1] - va[ia, 1]
    return (
        c * x + s * y + gradient[k, U_A] * spin_a + gradient[k, U_B] * spin_b,
        c * y - s * x + gradient[k, V_A] * spin_a + gradient[k, V_B] * spin_b,
        gradient[k, HOLDS] * (spin_b - spin_a),
    )


@inlined
def quadratic(stiffness, x, y, z):  # type: ignore[no-untyped-def]
    """q·K q for a joint's deformation x, y, z and a stiffness whose upper triangle is given row by row."""
    square = stiffness[0] * x * x + stiffness[3] * y * y + stiffness[5] * z * z
    return square + 2.0 * (stiffness[1] * x * y + stiffness[2] * x * z + stiffness[4] * y * z)


@inlined
def impulses(gradient, k, x, y, z):  # type: ignore[no-untyped-def]
    """What a joint's impulses do to its bodies: momentum x, y of b, which a gives, and moments on a and on b."""
    c, s, turn = gradient[k, E_X], gradient[k, E_Y], gradient[k, HOLDS] * z
    on_a = gradient[k, U_A] * x + gradient[k, V_A] * y - turn
    on_b = gradient[k, U_B] * x + gradient[k, V_B] * y + turn
    return c * x - s * y, s * x + c * y, on_a, on_b
