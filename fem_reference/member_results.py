"""Forces in members along a path, and what each member has come to at its end."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference.frame import Frame, Response
from fem_reference.paths import Trace
from scene import Scene


@dataclass(frozen=True)
class MemberResult:
    """One member; k points of the path, m quadrature points in order along the member, j element ends.

    Attributes
    ----------
    end_forces : (k, 2, 3) float
        N, Q [N] and M [N m] at start and end, with the signs of the package `scene`, along the undeformed axes.
    station : (m,) float
        Quadrature points, from the start [m].
    axial_force, moment : (m,) float
        N [N] and M [N m] there at the end of the path.
    curvature : (m,) float
        κ there [1/m].
    plastic_strain : (m,) float
        Largest plastic strain of any fibre there [-]; with ideal hinges, plastic curvature times half the depth.
    point : (j,) float
        Element ends, from the start [m].
    shape : (j, 2) float
        Their displacements x, y at the end of the path [m].
    """

    end_forces: np.ndarray
    station: np.ndarray
    axial_force: np.ndarray
    moment: np.ndarray
    curvature: np.ndarray
    plastic_strain: np.ndarray
    point: np.ndarray
    shape: np.ndarray


def member_results(
    scene: Scene, frame: Frame, path: Trace, displacement: np.ndarray, response: Response
) -> dict[str, MemberResult]:
    """Results by member, from a path and the displacements (size,) and response at its end."""
    plastic_strain = np.abs(frame.sections.plastic_strain(response.strain, response.slip)).max(axis=-1)
    if scene.yielding == "ideal-hinges":
        outermost = np.array([0.5 * m.section.depth for m in scene.members.values()]) / frame.sections.y.max(axis=1)
        plastic_strain *= outermost[frame.sections.kind, None]
    spread = frame.element_weight + np.array(path.load)[:, None, None] * frame.element_pattern
    contact = np.array(path.element_forces) - spread
    results = {}
    start = 0
    for name, mesh in frame.meshes.items():
        part = slice(start, start + len(mesh.weights))
        start = part.stop
        c, s, _ = scene.axis(name)
        turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        # A node pulls a member's start backwards where the cut there pulls forwards.
        ends = np.stack([-contact[:, part.start, 0:3] @ turn.T, contact[:, part.stop - 1, 3:6] @ turn.T], axis=1)
        order = np.argsort(mesh.stations.ravel())
        nodes = np.vstack([frame.dofs[part, 0:2], frame.dofs[part.stop - 1, 3:5]])
        results[name] = MemberResult(
            end_forces=ends,
            station=mesh.stations.ravel()[order],
            axial_force=path.stress[-1][part, :, 0].ravel()[order],
            moment=path.stress[-1][part, :, 1].ravel()[order],
            curvature=response.strain[part, :, 1].ravel()[order],
            plastic_strain=plastic_strain[part].ravel()[order],
            point=mesh.points,
            shape=displacement[nodes],
        )
    return results
