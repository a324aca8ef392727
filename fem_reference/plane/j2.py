"""J2 plasticity in plane stress, every quadrature point at once.

The return is projected on the plane stress subspace (Simo & Hughes, *Computational Inelasticity*, section 3.4). With
kinematic hardening h = 2 H / 3 and the stress s measured from the back stress β, the flow is Δεp = γ P s, and s lies on

    φ = √(s·P s) = √(2/3) (fy + H_iso α),   Δα = √(2/3) γ φ.

For an isotropic material, elasticity C and P are diagonal in the same orthonormal components, here called modes,

    (σ11 + σ22) / √2,   (σ22 - σ11) / √2,   σ12,

and so the return is one scalar equation for γ: with c = C P and s_trial the elastic guess,

    s = s_trial / (1 + γ (h + c)),   β = h P⁻¹ εp.

Written as 1/φ(γ) = (1 - 2/3 H_iso γ) / R, its left side is concave and almost straight, so that Newton's method from
γ = 0 rises to the root and never passes it.

In one direction this is bilinear: fy at first yield, then the slope E_t = E H / (E + H), as for the fibres of a frame.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from capacity import Material

Hardening = Literal["kinematic", "isotropic"]

#: Rows are the modes of (11, 22, 12); the matrix of σ and, with engineering shear, of ε.
MODES = np.array([[0.5**0.5, 0.5**0.5, 0.0], [-(0.5**0.5), 0.5**0.5, 0.0], [0.0, 0.0, 1.0]])
#: P in modes.
_PROJECTION = np.array([1.0 / 3.0, 1.0, 2.0])
_ROOT = (2.0 / 3.0) ** 0.5
_MOST_ITERATIONS = 60
#: Where a point flows without hardening its tangent has no stiffness one way; this share of E keeps a matrix regular
#: and leaves the stresses alone.
TANGENT_FLOOR = 1e-9


@dataclass(frozen=True)
class Flow:
    """What `J2.respond` found at n elements of q points; strains and stresses in modes.

    Attributes
    ----------
    stress : (n, q, 3) float
        σ [Pa].
    plastic_strain : (n, q, 3) float
        εp, with engineering shear [-].
    accumulated : (n, q) float
        Equivalent plastic strain α = ∫ √(2/3 ε̇p:ε̇p) dt [-].
    flows : (n, q) bool
        Where the step is plastic.
    tangent : (m, 3, 3) float
        Consistent tangent dσ/dε of those m points [Pa].
    """

    stress: np.ndarray
    plastic_strain: np.ndarray
    accumulated: np.ndarray
    flows: np.ndarray
    tangent: np.ndarray


@dataclass(frozen=True)
class J2:
    """The law of n elements, each of one material.

    Attributes
    ----------
    stiffness : (n, 1, 3) float
        C in modes: E / (1 - ν), 2G, G [Pa].
    yield_stress : (n, 1) float
        fy [Pa].
    kinematic, isotropic : (n, 1) float
        Plastic moduli H and H_iso [Pa]; one of them is zero.
    """

    stiffness: np.ndarray
    yield_stress: np.ndarray
    kinematic: np.ndarray
    isotropic: np.ndarray

    @staticmethod
    def of(materials: Sequence[Material], which: np.ndarray, hardening: Hardening = "kinematic") -> J2:
        """The law of elements whose materials are ``materials[which]``; E_t > 0 hardens as ``hardening`` says."""
        rows = []
        for material in materials:
            e, et, nu = material.youngs_modulus, material.tangent_modulus, material.poissons_ratio
            plastic = e * et / (e - et)
            kinematic, isotropic = (plastic, 0.0) if hardening == "kinematic" else (0.0, plastic)
            elastic = (e / (1.0 - nu), e / (1.0 + nu), material.shear_modulus)
            rows.append((*elastic, material.yield_stress, kinematic, isotropic))
        table = np.array(rows)[which][:, None, :]
        return J2(table[..., :3], table[..., 3], table[..., 4], table[..., 5])

    def respond(self, strain: np.ndarray, plastic_strain: np.ndarray, accumulated: np.ndarray) -> Flow:
        """Stresses at ``strain`` (n, q, 3), from the converged ``plastic_strain`` and ``accumulated`` so far.

        Raises
        ------
        ArithmeticError
            When a strain is not finite.
        """
        trial = self.stiffness * (strain - plastic_strain)
        relative = trial - (2.0 / 3.0) * self.kinematic[..., None] / _PROJECTION * plastic_strain
        radius = _ROOT * (self.yield_stress + self.isotropic * accumulated)
        size = np.einsum("nqi,i,nqi->nq", relative, _PROJECTION, relative)
        if not np.isfinite(size).all():
            raise ArithmeticError("a strain is not finite")
        flows = size > radius**2 * (1.0 + 1e-14)
        if not flows.any():
            return Flow(trial, plastic_strain, accumulated, flows, np.zeros((0, 3, 3)))
        element = np.nonzero(flows)[0]
        elastic = self.stiffness[element, 0]
        h, iso = (2.0 / 3.0) * self.kinematic[element], (2.0 / 3.0) * self.isotropic[element]
        mu = h + elastic * _PROJECTION
        guess, bound = relative[flows], radius[flows]
        gamma = _multiplier(guess, mu, iso[:, 0], bound)
        shrink = 1.0 + gamma[:, None] * mu
        s = guess / shrink
        flow = gamma[:, None] * _PROJECTION * s
        phi = np.sqrt((_PROJECTION * s**2).sum(axis=1))
        stress, plastic, alpha = trial.copy(), plastic_strain.copy(), accumulated.copy()
        stress[flows] -= elastic * flow
        plastic[flows] += flow
        alpha[flows] += _ROOT * gamma * phi
        # dσ = diag((1 + γh) C / (1 + γ(h + c))) dε - n n·dε / m: the derivative of the lines above.
        normal = elastic * _PROJECTION * s / shrink
        slack = iso[:, 0] * phi**2 / (1.0 - iso[:, 0] * gamma) + (_PROJECTION * s**2 * mu / shrink).sum(axis=1)
        tangent = -normal[:, :, None] * (normal / slack[:, None])[:, None, :]
        tangent[:, range(3), range(3)] += (1.0 + gamma[:, None] * h) * elastic / shrink + TANGENT_FLOOR * elastic
        return Flow(stress, plastic, alpha, flows, tangent)


def _multiplier(guess: np.ndarray, mu: np.ndarray, iso: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """γ (m,) at which the stress from ``guess`` (m, 3) is on the yield surface."""
    gamma = np.zeros(len(guess))
    square = _PROJECTION * guess**2
    for _ in range(_MOST_ITERATIONS):
        shrink = 1.0 + gamma[:, None] * mu
        parts = square / shrink**2
        phi = np.sqrt(parts.sum(axis=1))
        gap = radius / phi - (1.0 - iso * gamma)
        if np.abs(gap).max() <= 4e-15:
            break
        slope = radius * (parts * mu / shrink).sum(axis=1) / phi**3 + iso
        step = gap / slope
        gamma = gamma - step
        if np.all(np.abs(step) <= 1e-15 * gamma):
            break
    return gamma


def von_mises(stress: np.ndarray) -> np.ndarray:
    """Equivalent stress √(3/2 σ·P σ) [Pa] of stresses (…, 3) in modes."""
    return np.asarray(np.sqrt(1.5 * (_PROJECTION * stress**2).sum(axis=-1)))
