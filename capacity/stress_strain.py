"""Uniaxial stress–strain laws as straight pieces, alike in tension and compression."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class StressStrain:
    """σ(ε) = E ε up to the first break, then straight pieces; odd in ε.

    Attributes
    ----------
    breaks : (n,) float
        Strains where the slope changes, ascending [-].
    slopes : (n + 1,) float
        Slope of each piece, the first being Young's modulus [Pa].
    ultimate_strain : float
        Strain at which the material breaks; infinity when it does not.
    """

    breaks: np.ndarray
    slopes: np.ndarray
    ultimate_strain: float = float("inf")

    @staticmethod
    def bilinear(
        youngs_modulus: float,
        yield_stress: float,
        tangent_modulus: float = 0.0,
        ultimate_strain: float = float("inf"),
    ) -> StressStrain:
        """Elastic up to ``yield_stress``, then with ``tangent_modulus``, 0 being perfectly plastic [Pa]."""
        breaks = np.array([yield_stress / youngs_modulus])
        return StressStrain(breaks, np.array([youngs_modulus, tangent_modulus]), ultimate_strain)

    @staticmethod
    def table(pairs: Sequence[tuple[float, float]], ultimate_strain: float | None = None) -> StressStrain:
        """Through the points (strain, stress [Pa]) from the origin; flat beyond the last, where it breaks by default.

        Raises
        ------
        ValueError
            For fewer than one point, strains that do not ascend from zero, or stresses that fall.
        """
        points = [(float(e), float(s)) for e, s in pairs if (e, s) != (0.0, 0.0)]
        if not points:
            raise ValueError("a stress–strain table needs at least one point beside the origin")
        strain = np.array([0.0, *(e for e, _ in points)])
        stress = np.array([0.0, *(s for _, s in points)])
        if np.any(np.diff(strain) <= 0.0):
            raise ValueError("strains of a stress–strain table must ascend from zero")
        if np.any(np.diff(stress) < 0.0) or stress[1] <= 0.0:
            raise ValueError("stresses of a stress–strain table must not fall")
        slopes = np.append(np.diff(stress) / np.diff(strain), 0.0)
        return StressStrain(strain[1:], slopes, strain[-1] if ultimate_strain is None else ultimate_strain)

    @property
    def drops(self) -> np.ndarray:
        """By how much the slope falls at each break, (n,) [Pa]; negative where it rises."""
        return -np.diff(self.slopes)

    @property
    def unloads(self) -> bool:
        """Whether elements in parallel give the law, so that it says how to unload: no slope may rise."""
        return bool(np.all(self.drops >= 0.0))

    def stress(self, strain: float | np.ndarray) -> np.ndarray:
        """σ at ``strain`` on first loading [Pa]; shape of ``strain``."""
        size = np.abs(np.asarray(strain, dtype=float))
        over = np.maximum(size[..., None] - self.breaks, 0.0)
        stress: np.ndarray = np.sign(strain) * (self.slopes[0] * size - over @ self.drops)
        return stress

    def respond(self, strain: np.ndarray, slip: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Stress, tangent and new slips for any history: elastic–perfectly plastic elements in parallel (Besseling).

        Element j has stiffness E_(j-1) - E_j and yields at the strain ``breaks[j]``, which gives the curve on first
        loading, twice its size on unloading (Masing) and kinematic hardening.

        Parameters
        ----------
        strain : (m,) float
        slip : (m, n) float
            Plastic strain of each element so far.
        """
        elastic = strain[:, None] - slip
        held = np.clip(elastic, -self.breaks, self.breaks)
        stress = self.slopes[-1] * strain + held @ self.drops
        tangent = self.slopes[-1] + (np.abs(elastic) <= self.breaks) @ self.drops
        return stress, tangent, strain[:, None] - held
