"""How the pieces of a member that is cut anew move: as its line does, with the momentum and the energy that it had.

The wanted velocities W are those at which the line itself moves. They are corrected by as little as possible, measured
by H = M + τ² JᵀKJ, so that stiff joints are not torn: by Z = H⁻¹A for the momenta Aᵀ V, A being the pieces' masses
times the three motions of a rigid body, and then by H⁻¹ M V, less what it changes the momenta by, for the energy: once
where there is to be more of it, and step by step, as one descends, where there is to be less.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from sim.elastic_line import Chain

_MOST_STEPS = 100
_MOST_GAIN = 4.0
# A change whose own kinetic energy is below this share of the whole is rounding.
_NOTHING = 1e-20


def carried(
    chain: Chain,
    poses: np.ndarray,
    weight: np.ndarray,
    wanted: np.ndarray,
    momentum: np.ndarray,
    kinetic: float,
    reach: float,
) -> np.ndarray:
    """Velocities of the pieces, (n, 3) [m/s, m/s, rad/s].

    Parameters
    ----------
    chain : Chain
    poses : (n, 3) float
        x, y [m] and angle [rad] of the pieces.
    weight : (n, 2) float
        Mass [kg] and moment of inertia [kg m²] of each.
    wanted : (n, 3) float
        Velocities to keep to.
    momentum : (3,) float
        Momentum x, y [N s] and angular momentum about the origin [N m s] that they shall have.
    kinetic : float
        Kinetic energy that they shall have [J]. What a change that keeps the momenta does not reach is left; and
        nothing is made twice as fast by it, so that what rests stays at rest.
    reach : float
        Time τ [s].
    """
    masses = weight[:, [0, 0, 1]].ravel()
    centre = np.average(poses[:, :2], axis=0, weights=weight[:, 0])
    x, y = (poses[:, :2] - centre).T
    rigid = np.zeros((len(poses), 3, 3))
    rigid[:, [0, 1, 2], [0, 1, 2]] = 1.0
    rigid[:, 0, 2], rigid[:, 1, 2] = -y, x
    modes = masses[:, None] * rigid.reshape(-1, 3)
    goal = momentum - [0.0, 0.0, centre[0] * momentum[1] - centre[1] * momentum[0]]
    solve = _metric(chain, poses, masses, reach)
    shift = solve(modes)
    gain = np.linalg.inv(modes.T @ shift)

    def kept(velocity: np.ndarray, momenta: np.ndarray) -> np.ndarray:
        """The velocities corrected for the momenta that they shall have."""
        for _ in range(2):  # the second time for rounding
            velocity = velocity + shift @ (gain @ (momenta - modes.T @ velocity))
        return velocity

    velocity = kept(wanted.ravel(), goal)
    kinetic = min(kinetic, _MOST_GAIN * 0.5 * float(velocity @ (masses * velocity)))
    for _ in range(_MOST_STEPS):
        along = kept(solve(masses * velocity), np.zeros(3))
        share, reached = _share(velocity, along, masses, kinetic)
        velocity = velocity + share * along
        if reached:
            break
    return velocity.reshape(-1, 3)


def _share(velocity: np.ndarray, along: np.ndarray, masses: np.ndarray, kinetic: float) -> tuple[float, bool]:
    """How much of ``along`` brings the kinetic energy of ``velocity`` to ``kinetic``, or nearest; whether it does."""
    present, square = float(velocity @ (masses * velocity)), float(along @ (masses * along))
    if square <= _NOTHING * present or square == 0.0:
        return 0.0, True
    linear = float(velocity @ (masses * along))
    missing = 2.0 * kinetic - present
    root = linear**2 + square * missing
    if root <= 0.0:
        return -linear / square, False
    # The smaller of the two roots, without cancellation.
    return missing / (linear + math.copysign(root**0.5, linear)), True


def _metric(chain: Chain, poses: np.ndarray, masses: np.ndarray, reach: float) -> Callable[[np.ndarray], np.ndarray]:
    """H⁻¹, as a function of what it shall be multiplied with."""
    from scipy import sparse
    from scipy.sparse.linalg import splu

    n = len(poses)
    left = poses[:, :2] + (chain.points[:-1] - chain.middles)[:, None] * _direction(poses[:, 2])
    last = poses[-1, :2] + (chain.points[-1] - chain.middles[-1]) * _direction(poses[-1:, 2])[0]
    at = np.vstack([left, last])
    gradient = np.zeros((n + 1, 3, 6))
    for side, sign, pieces, joints in ((0, -1.0, slice(0, n), slice(1, n + 1)), (1, 1.0, slice(0, n), slice(0, n))):
        c, s = _direction(poses[pieces, 2]).T
        ax, ay = (at[joints] - poses[pieces, :2]).T
        block = gradient[joints, :, 3 * side : 3 * side + 3]
        block[:, 0, 0], block[:, 0, 1], block[:, 0, 2] = c, s, s * ax - c * ay
        block[:, 1, 0], block[:, 1, 1], block[:, 1, 2] = -s, c, c * ax + s * ay
        block[:, 2, 2] = 1.0
        block *= sign
    stiffness = reach**2 * np.einsum("nki,nkl,nlj->nij", gradient, chain.stiffness, gradient)
    index = 3 * np.arange(n + 1)[:, None] - 3 + np.arange(6)
    rows, columns = np.repeat(index, 6, axis=1).ravel(), np.tile(index, (1, 6)).ravel()
    inside = (rows >= 0) & (columns >= 0) & (rows < 3 * n) & (columns < 3 * n)
    entries = (stiffness.ravel()[inside], (rows[inside], columns[inside]))
    matrix = sparse.coo_matrix(entries, shape=(3 * n, 3 * n)) + sparse.diags(masses)
    solve: Callable[[np.ndarray], np.ndarray] = splu(matrix.tocsc()).solve
    return solve


def _direction(angle: np.ndarray) -> np.ndarray:
    return np.column_stack([np.cos(angle), np.sin(angle)])
