"""Moment and curvature at any axial force, loading exactly and through any history.

Plane sections: ε(y) = ε0 + κ y, N = ∫σ dA, M = ∫σ y dA, y up from the centroid, so a positive moment pulls the upper
face. A law of straight pieces is a sum of ramps, σ = E ε - Σ ΔE_j [(ε - ε_j)₊ - (-ε - ε_j)₊], and the integral of a
ramp over a section is an area and a first moment above a height: exact for any outline.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from capacity.errors import InputError
from capacity.materials import Material
from capacity.outline import Outline
from capacity.sections import Section
from capacity.stress_strain import StressStrain


@dataclass(frozen=True)
class MomentCurvature:
    """States of a section at a given axial force.

    Attributes
    ----------
    curvature : (n,) float
        κ [1/m].
    moment : (n,) float
        M about the centroid [N m].
    centre_strain : (n,) float
        ε0 at the centroid [-].
    largest_strain : (n,) float
        Greatest |ε| in the section, over the ultimate strain of what is there [-].
    """

    curvature: np.ndarray
    moment: np.ndarray
    centre_strain: np.ndarray
    largest_strain: np.ndarray

    @property
    def broken(self) -> np.ndarray:
        """Whether a fibre is beyond its ultimate strain, (n,) bool."""
        return self.largest_strain > 1.0


def _laws(section: Section, material: Material) -> list[tuple[Outline, StressStrain]]:
    return [(part.outline, (part.material or material).stress_strain) for part in section.parts]


def resultants(
    laws: Sequence[tuple[Outline, StressStrain]], strain: float, curvature: float
) -> tuple[float, float, float]:
    """N, M and dN/dε0 on first loading to ``strain`` + ``curvature`` y [N, N m, N]."""
    force, moment, stiffness = 0.0, 0.0, 0.0
    for outline, law in laws:
        whole = outline.moments()[[0, 2, 5]]
        ramps = np.concatenate([law.breaks, law.breaks])
        side = np.repeat([1.0, -1.0], len(law.breaks))
        # Where side (ε0 + κ y) exceeds the break: above or below a height, everywhere or nowhere without curvature.
        reach = ramps - side * strain
        steep = side * curvature
        with np.errstate(divide="ignore", invalid="ignore"):
            height = np.where(steep == 0.0, np.where(reach < 0.0, -np.inf, np.inf), reach / steep)
        part = outline.moments(height)[:, [0, 2, 5]]
        part = np.where((steep < 0.0)[:, None], whole - part, part)
        drop = np.tile(law.drops, 2)
        e = law.slopes[0]
        excess = (strain - side * ramps)[:, None] * part[:, :2] + curvature * part[:, 1:]
        force += e * (strain * whole[0] + curvature * whole[1]) - float(drop @ excess[:, 0])
        moment += e * (strain * whole[1] + curvature * whole[2]) - float(drop @ excess[:, 1])
        stiffness += e * whole[0] - float(drop @ part[:, 0])
    return float(force), float(moment), float(stiffness)


def _balanced(laws: Sequence[tuple[Outline, StressStrain]], force: float, curvature: float, guess: float) -> float:
    """ε0 at which the axial force is ``force``: Newton within a bracket, N being monotone in ε0."""
    elastic = sum(law.slopes[0] * float(outline.moments()[0]) for outline, law in laws)
    span = max(float(np.abs(outline.extent()).max()) for outline, _ in laws)
    reach = 2.0 * max(float(law.breaks[-1]) for _, law in laws) + abs(curvature) * span + abs(force) / elastic
    low, high = -reach, reach
    while resultants(laws, high, curvature)[0] < force or resultants(laws, low, curvature)[0] > force:
        low, high = 2.0 * low, 2.0 * high
        if high > 1e6:
            raise ArithmeticError("no strain balances the axial force")
    strain = guess if low < guess < high else 0.0
    slack = 1e-14 * elastic * reach
    for _ in range(200):
        found, _, stiffness = resultants(laws, strain, curvature)
        if abs(found - force) <= slack:
            break
        low, high = (strain, high) if found < force else (low, strain)
        step = strain - (found - force) / stiffness if stiffness > 1e-12 * elastic else low
        strain = step if low < step < high else 0.5 * (low + high)
    return strain


def _check_force(section: Section, material: Material, force: float) -> None:
    for part in section.parts:
        if (part.material or material).stress_strain.slopes[-1] > 0.0:
            return
    most = sum(float(o.moments()[0]) * float(law.stress(law.breaks[-1])) for o, law in _laws(section, material))
    if abs(force) >= most * (1.0 - 1e-9):
        raise InputError(
            "axial force", f"{force:.6g} N is not within ±{most:.6g} N, full yield", "take a smaller axial force"
        )


def _largest_strain(section: Section, material: Material, strain: np.ndarray, curvature: np.ndarray) -> np.ndarray:
    most = np.zeros(len(strain))
    for part in section.parts:
        limit = (part.material or material).stress_strain.ultimate_strain
        for y in part.outline.extent():
            most = np.maximum(most, np.abs(strain + curvature * y) / limit)
    return most


def moment_curvature(
    section: Section, material: Material, curvature: Sequence[float] | np.ndarray, axial_force: float = 0.0
) -> MomentCurvature:
    """Moment at each curvature on first loading, at constant ``axial_force`` (tension positive); exact.

    Parameters
    ----------
    section : Section
    material : Material
        Of pieces that name none.
    curvature : (n,) float
        κ [1/m], in any order.
    axial_force : float
        N [N].

    Raises
    ------
    InputError
        When the axial force is at or beyond full yield of a section that does not harden.
    """
    _check_force(section, material, axial_force)
    laws = _laws(section, material)
    kappa = np.atleast_1d(np.asarray(curvature, dtype=float))
    strain, moment = np.zeros(len(kappa)), np.zeros(len(kappa))
    guess = 0.0
    for i, k in enumerate(kappa.tolist()):
        guess = strain[i] = _balanced(laws, axial_force, k, guess)
        moment[i] = resultants(laws, guess, k)[1]
    return MomentCurvature(kappa, moment, strain, _largest_strain(section, material, strain, kappa))


def moment_history(
    section: Section,
    material: Material,
    curvature: Sequence[float] | np.ndarray,
    axial_force: float = 0.0,
    fibres: int = 200,
) -> MomentCurvature:
    """Moment along a path of curvatures, loading and unloading, by fibres that remember their slips.

    Parameters
    ----------
    section, material, axial_force
        As in `moment_curvature`.
    curvature : (n,) float
        The path of κ [1/m], from the unloaded section; each entry is one step of an implicit integration, exact in
        time for paths whose axial strain turns only where the curvature does.
    fibres : int
        Fibres of each piece, at least 4.

    Raises
    ------
    InputError
        As `moment_curvature`; also when a law's slope rises, which says nothing about unloading.
    """
    _check_force(section, material, axial_force)
    pieces = [(f.y, f.area, m.stress_strain) for m, f in section.fibres_by_material(fibres, material)]
    if not all(law.unloads for _, _, law in pieces):
        raise InputError(
            "material", "its stress–strain curve grows steeper somewhere, which says nothing about unloading",
            "use a curve whose slope only falls, or load only",
        )  # fmt: skip
    slips = [np.zeros((len(y), len(law.breaks))) for y, _, law in pieces]
    kappa = np.atleast_1d(np.asarray(curvature, dtype=float))
    strain, moment = np.zeros(len(kappa)), np.zeros(len(kappa))
    elastic = sum(law.slopes[0] * float(area.sum()) for _, area, law in pieces)
    centre = 0.0
    for i, k in enumerate(kappa.tolist()):
        low, high = -math.inf, math.inf
        for _ in range(200):  # N is monotone in ε0: Newton, bisection where it leaves the bracket
            answers = [law.respond(centre + k * y, slip) for (y, _, law), slip in zip(pieces, slips, strict=True)]
            found = sum(float(a @ s) for (_, a, _), (s, _, _) in zip(pieces, answers, strict=True))
            if abs(found - axial_force) <= 1e-13 * elastic * (abs(centre) + abs(k) * section.depth + 1e-12):
                break
            low, high = (centre, high) if found < axial_force else (low, centre)
            stiffness = sum(float(a @ t) for (_, a, _), (_, t, _) in zip(pieces, answers, strict=True))
            step = centre - (found - axial_force) / max(stiffness, 1e-9 * elastic)
            if not low < step < high:
                step = 0.5 * (low + high)
            centre = step
        slips = [slip for _, _, slip in answers]
        strain[i] = centre
        moment[i] = sum(float(a * y @ s) for (y, a, _), (s, _, _) in zip(pieces, answers, strict=True))
    return MomentCurvature(kappa, moment, strain, _largest_strain(section, material, strain, kappa))
