"""Bodies of which one half is solved: antisymmetric about the axis y = 0, like a beam that is pushed across.

Mirrored, u_x turns its sign and u_y does not; so do σ11 and σ22, and not σ12. On the axis u_x = 0. The half is given
twice the thickness, so that its loads, stiffnesses and energies are those of the whole.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fem_reference.plane.continuum import Continuum, State
from fem_reference.plane.j2 import J2
from fem_reference.plane.mesh import PlaneMesh, quadrature

#: Nodes of a mirrored quadrilateral, counter-clockwise again: its ξ and η change places.
_MIRRORED = [0, 3, 2, 1, 7, 6, 5, 4, 8]
_SIGNS = np.array([-1.0, -1.0, 1.0])


def whole(half: Continuum, states: Sequence[State]) -> tuple[Continuum, tuple[State, ...]]:
    """The continuum of the whole body and its states, from those of the upper half, of quadrilaterals."""
    mesh = half.mesh
    own = mesh.points[:, 1] > 1e-9 * np.ptp(mesh.points[:, 1])
    count = len(mesh.points)
    twin = np.where(own, count + np.cumsum(own) - 1, np.arange(count))
    points = np.concatenate([mesh.points, mesh.points[own] * [1.0, -1.0]])
    cells = np.concatenate([mesh.cells, twin[mesh.cells][:, _MIRRORED]])
    group = np.tile(mesh.group, 2)
    both = PlaneMesh(points, cells, {}, group).with_sides()
    dofs = np.arange(2 * len(points)).reshape(-1, 2)
    axes = np.tile(np.eye(2), (len(points), 1, 1))
    parts = (half.law.stiffness, half.law.yield_stress, half.law.kinematic, half.law.isotropic)
    law = J2(*(np.concatenate([part, part]) for part in parts))
    continuum = Continuum(both, 0.5 * half.thickness, law, dofs, axes)
    local, _ = quadrature(9)
    swapped = [int(np.argmin(np.abs(local - point[::-1, None]).sum(axis=0))) for point in local.T]

    def mirrored(state: State) -> State:
        moved = half.nodal_displacement(state.displacement)
        plastic = np.concatenate([state.plastic_strain, _SIGNS * state.plastic_strain[:, swapped]])
        accumulated = np.concatenate([state.accumulated, state.accumulated[:, swapped]])
        # Nothing flows any more at the strains of a converged state.
        before = replace(continuum.undeformed(), plastic_strain=plastic, accumulated=accumulated)
        displacement = np.concatenate([moved, moved[own] * [-1.0, 1.0]]).ravel()
        return continuum.respond(displacement, before)

    return continuum, tuple(map(mirrored, states))
