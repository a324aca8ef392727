"""Deformations of the joints and their exact gradient.

With d the vector between a joint's two anchors and e, n the axes of a frame that turns with the angle
ψ = (1 - α)(θa + φa) + α (θb + φb):

    u = e·d,  v = n·d,  θ = (θb + φb) - (θa + φa),
    u̇ = e·ḋ + (n·d) ψ̇,  v̇ = n·ḋ - (e·d) ψ̇.

The terms in ψ̇ make the pair of forces exactly free of moment, so angular momentum is kept.
"""

import math

from numba import njit

from sim.chipmunk import ANGLE, BODY_WORDS, CONSTRAINT_SPACE, COSINE, MASS_INVERSE, MOMENT_INVERSE, SINE, X
from sim.kernels.layout import ANCHOR_A, ANCHOR_B, BETA, REST_A, REST_B, STEP, TURN
from sim.memory import floats, integers


@njit(error_model="numpy")
def prepare(  # type: ignore[no-untyped-def]
    n, joint_bodies, body_at, joint_at, active, geometry, settings, jacobian, deformation, lightness, velocity
):
    """Deformation and gradient at the bodies' present positions; joints no longer in the space get none."""
    beta, h = settings[BETA], settings[STEP]
    for k in range(n):
        j, q, light = jacobian[k], deformation[k], lightness[k]
        if integers(joint_at[k], CONSTRAINT_SPACE + 1)[CONSTRAINT_SPACE] == 0:
            active[k] = 0
        if active[k] == 0:
            j[:] = 0.0
            light[:] = 0.0
            continue
        ia, ib = joint_bodies[k, 0], joint_bodies[k, 1]
        a, b, g = floats(body_at[ia], BODY_WORDS), floats(body_at[ib], BODY_WORDS), geometry[k]
        rax = a[COSINE] * g[ANCHOR_A] - a[SINE] * g[ANCHOR_A + 1]
        ray = a[SINE] * g[ANCHOR_A] + a[COSINE] * g[ANCHOR_A + 1]
        rbx = b[COSINE] * g[ANCHOR_B] - b[SINE] * g[ANCHOR_B + 1]
        rby = b[SINE] * g[ANCHOR_B] + b[COSINE] * g[ANCHOR_B + 1]
        dx, dy = b[X] + rbx - a[X] - rax, b[X + 1] + rby - a[X + 1] - ray
        alpha = g[TURN]
        angle_a, angle_b = a[ANGLE] + g[REST_A], b[ANGLE] + g[REST_B]
        psi = (1.0 - alpha) * angle_a + alpha * angle_b
        c, s = math.cos(psi), math.sin(psi)
        u, v = c * dx + s * dy, -s * dx + c * dy
        j[0], j[1], j[2] = -c, -s, c * ray - s * rax + (1.0 - alpha) * v
        j[3], j[4], j[5] = c, s, -c * rby + s * rbx + alpha * v
        j[6], j[7], j[8] = s, -c, -s * ray - c * rax - (1.0 - alpha) * u
        j[9], j[10], j[11] = -s, c, s * rby + c * rbx - alpha * u
        j[12], j[13], j[14], j[15], j[16], j[17] = 0.0, 0.0, -1.0, 0.0, 0.0, 1.0
        mass, turn_a, turn_b = a[MASS_INVERSE] + b[MASS_INVERSE], a[MOMENT_INVERSE], b[MOMENT_INVERSE]
        light[0] = mass + j[2] * j[2] * turn_a + j[5] * j[5] * turn_b
        light[1] = mass + j[8] * j[8] * turn_a + j[11] * j[11] * turn_b
        light[2] = turn_a + turn_b
        q[0], q[1], q[2] = u, v, angle_b - angle_a
        if beta != 0.0:
            x, y, z = rates(j, velocity[ia], velocity[ib])
            q[0] -= beta * h * x
            q[1] -= beta * h * y
            q[2] -= beta * h * z


@njit(inline="always", error_model="numpy")
def rates(j, va, vb):  # type: ignore[no-untyped-def]
    """J times the velocities of a joint's two bodies."""
    return (
        j[0] * va[0] + j[1] * va[1] + j[2] * va[2] + j[3] * vb[0] + j[4] * vb[1] + j[5] * vb[2],
        j[6] * va[0] + j[7] * va[1] + j[8] * va[2] + j[9] * vb[0] + j[10] * vb[1] + j[11] * vb[2],
        vb[2] * j[17] + va[2] * j[14],
    )
