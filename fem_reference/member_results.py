"""Forces in members along a path, and what each member has come to at its end."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference.frame import Frame
from fem_reference.paths import Trace
from scene import Scene


@dataclass(frozen=True)
class MemberErrors:
    """Differences of one member's results from those of half the elements and fibres.

    Attributes
    ----------
    end_forces : (3,) float
        Largest of N, Q [N] and M [N m] at either end, anywhere along the path.
    axial_force, moment, curvature, plastic_strain : (m,) float
        At each quadrature point; the coarser model's values lie on straight lines between its own. Where a hinge has
        formed without hardening, curvature and plastic strain grow without limit as elements shrink, for the rotation
        is all in one point: an estimate as large as the value says so.
    shape : float
        Largest of any displacement at an element's end [m].
    """

    end_forces: np.ndarray
    axial_force: np.ndarray
    moment: np.ndarray
    curvature: np.ndarray
    plastic_strain: np.ndarray
    shape: float


@dataclass(frozen=True)
class MemberPath:
    """One member along the path; k points, m quadrature points in order along the member, j element ends.

    Attributes
    ----------
    axial_force, shear_force, moment : (k, m) float
        N, Q [N] and M [N m].
    curvature : (k, m) float
        κ [1/m].
    plastic_strain : (k, m) float
        As in `MemberResult` [-].
    shape : (k, j, 2) float
        Displacements x, y of the element ends [m].
    """

    axial_force: np.ndarray
    shear_force: np.ndarray
    moment: np.ndarray
    curvature: np.ndarray
    plastic_strain: np.ndarray
    shape: np.ndarray


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
    path : MemberPath
        The same all along.
    """

    end_forces: np.ndarray
    station: np.ndarray
    axial_force: np.ndarray
    moment: np.ndarray
    curvature: np.ndarray
    plastic_strain: np.ndarray
    point: np.ndarray
    shape: np.ndarray
    path: MemberPath

    def differences(self, coarse: MemberResult) -> MemberErrors:
        """How far this is from the result of a coarser model."""

        def gap(name: str) -> np.ndarray:
            other = np.interp(self.station, coarse.station, getattr(coarse, name))
            return np.asarray(np.abs(getattr(self, name) - other))

        both = min(len(self.end_forces), len(coarse.end_forces))
        shape = np.stack([np.interp(self.point, coarse.point, coarse.shape[:, i]) for i in (0, 1)], axis=1)
        at_points = np.isclose(self.point[:, None], coarse.point, rtol=0.0, atol=1e-9 * self.point[-1]).any(axis=1)
        return MemberErrors(
            np.abs(self.end_forces[:both] - coarse.end_forces[:both]).max(axis=(0, 1)),
            gap("axial_force"),
            gap("moment"),
            gap("curvature"),
            gap("plastic_strain"),
            float(np.abs(self.shape - shape)[at_points].max()),
        )


def member_results(scene: Scene, frame: Frame, path: Trace) -> dict[str, MemberResult]:
    """Results by member, from a path of ``frame``."""
    spread = frame.element_weight + np.array(path.load)[:, None, None] * frame.element_pattern
    contact = np.array(path.element_forces) - spread
    stress, strain = np.array(path.stress), np.array(path.strain)
    plastic_strain, moved = np.array(path.plastic_strain), np.array(path.displacements)
    if scene.yielding == "ideal-hinges":
        outermost = np.array([0.5 * m.section.depth for m in scene.members.values()]) / frame.sections.y.max(axis=1)
        plastic_strain *= outermost[frame.sections.kind, None]
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
        along = MemberPath(
            axial_force=stress[:, part, :, 0].reshape(len(stress), -1)[:, order],
            shear_force=_shear_force(stress[:, part, :, 1], mesh.stations)[:, order],
            moment=stress[:, part, :, 1].reshape(len(stress), -1)[:, order],
            curvature=strain[:, part, :, 1].reshape(len(strain), -1)[:, order],
            plastic_strain=plastic_strain[:, part].reshape(len(strain), -1)[:, order],
            shape=moved[:, nodes],
        )
        results[name] = MemberResult(
            end_forces=ends,
            station=mesh.stations.ravel()[order],
            axial_force=along.axial_force[-1],
            moment=along.moment[-1],
            curvature=along.curvature[-1],
            plastic_strain=along.plastic_strain[-1],
            point=mesh.points,
            shape=along.shape[-1],
            path=along,
        )
    return results


def _shear_force(moment: np.ndarray, stations: np.ndarray) -> np.ndarray:
    """Q = -dM/dx in each element of a member (k, 2 m), from M (k, m, 2) at its stations (m, 2).

    Exactly what balances the element's nodal forces, for two quadrature points stand for a linear M; a beam without
    shear flexibility has no strain to take Q from.
    """
    slope = np.diff(moment, axis=2) / np.diff(stations, axis=1)
    return np.repeat(-slope, 2, axis=2).reshape(len(moment), -1)
