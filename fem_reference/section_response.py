"""Stress resultants of fibre sections: every quadrature point of a frame at once.

A fibre at height y has strain ε = ε₀ - y κ and follows bilinear kinematic hardening (Simo & Hughes, *Computational
Inelasticity*, box 1.5): with plastic modulus H = E E_t / (E - E_t) and relative trial stress ξ = E (ε - εp) - H εp,

    Δεp = max(|ξ| - fy, 0) sign ξ / (E + H),   σ = E (ε - εp - Δεp),   dσ/dε = E_t where it yields, E where not.

The section gives N = Σ A σ and M = -Σ A y σ.
"""

from dataclasses import dataclass

import numpy as np

#: Least tangent modulus over E in the Newton matrix. A section that yields throughout has no stiffness left, not even
#: axially, and a member beyond it could slide off; the floor keeps the matrix regular and leaves the forces alone.
TANGENT_FLOOR = 1e-7


@dataclass(frozen=True)
class FibreSections:
    """Fibres of n elements; arrays broadcast to (element, quadrature point, fibre).

    Attributes
    ----------
    y, area : (n, 1, f) float
        Fibre heights [m] and areas [m²].
    youngs_modulus, yield_stress, tangent_modulus : (n, 1, 1) float
        E, fy, E_t [Pa].
    """

    y: np.ndarray
    area: np.ndarray
    youngs_modulus: np.ndarray
    yield_stress: np.ndarray
    tangent_modulus: np.ndarray

    def respond(
        self, axial_strain: np.ndarray, curvature: np.ndarray, plastic_strain: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Resultants, tangent and new plastic strain.

        Parameters
        ----------
        axial_strain, curvature : (n, q) float
            ε₀ [-] and κ [1/m].
        plastic_strain : (n, q, f) float
            Converged plastic strains before this step.

        Returns
        -------
        resultants : (n, q, 2) float
            N [N], M [N m].
        tangent : (n, q, 2, 2) float
            ∂(N, M)/∂(ε₀, κ), with E_t no less than `TANGENT_FLOOR` E.
        plastic_strain : (n, q, f) float
            Plastic strains if this step is accepted.
        """
        e, et = self.youngs_modulus, self.tangent_modulus
        hardening = e * et / (e - et)
        strain = axial_strain[..., None] - self.y * curvature[..., None]
        trial = e * (strain - plastic_strain)
        relative = trial - hardening * plastic_strain
        excess = np.abs(relative) - self.yield_stress
        flow = np.where(excess > 0.0, np.copysign(excess, relative), 0.0) / (e + hardening)
        force = self.area * (trial - e * flow)
        stiffness = self.area * np.where(excess > 0.0, np.maximum(et, TANGENT_FLOOR * e), e)
        resultants = np.stack([force.sum(-1), -(force * self.y).sum(-1)], axis=-1)
        ea, es, ei = stiffness.sum(-1), -(stiffness * self.y).sum(-1), (stiffness * self.y**2).sum(-1)
        tangent = np.stack([np.stack([ea, es], axis=-1), np.stack([es, ei], axis=-1)], axis=-2)
        return resultants, tangent, plastic_strain + flow
