"""Fibre-section joint: N and M from elastic–plastic fibres over a length ℓ, shear capped by itself.

A fibre at height y has strain ε = (u - y θ) / ℓ and follows bilinear kinematic hardening with plastic modulus
H = E E_t / (E - E_t), so N–M interaction, gradual yielding and the Bauschinger effect come by themselves. Where a
stress–strain curve has more pieces, several fibres lie at one height, elastic–perfectly plastic ones in parallel
(J. F. Besseling, A theory of elastic, plastic and creep deformations, J. Appl. Mech. 25 (1958) 529–536).

Parameters in memory: ℓ, k_Q, Q_max, number of fibres f; then y, A, E, fy, H of each fibre, one list after another.
State: plastic slip, then the plastic strain of each fibre.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from capacity import InputError, Material, Section, capacity
from sim.compiling import law_function
from sim.laws.checks import check_length
from sim.memory import floats

# Yield stress of a layer that does not yield [Pa].
_NEVER = 1e30


@law_function
def respond(parameters, state, deformation, out):  # type: ignore[no-untyped-def]
    head, q, r = floats(parameters, 4), floats(deformation, 3), floats(out, 9)
    length, n = head[0], int(head[3])
    fibre, p = floats(parameters + 32, 5 * n), floats(state, 1 + n)
    mean, curvature = q[0] / length, q[2] / length
    axial, moment, ea, es, ei = 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(n):
        y, area, e, fy, h = fibre[i], fibre[n + i], fibre[2 * n + i], fibre[3 * n + i], fibre[4 * n + i]
        stress = e * (mean - y * curvature - p[1 + i])
        relative = stress - h * p[1 + i]
        tangent = e
        if relative > fy:
            stress -= e * (relative - fy) / (e + h)
            tangent = e * h / (e + h)
        elif relative < -fy:
            stress -= e * (relative + fy) / (e + h)
            tangent = e * h / (e + h)
        axial += area * stress
        moment -= area * y * stress
        ea += area * tangent
        es -= area * y * tangent
        ei += area * y * y * tangent
    shear = head[1] * (q[1] - p[0])
    r[0], r[1], r[2] = axial, min(max(shear, -head[2]), head[2]), moment
    r[3], r[4], r[5] = ea / length, 0.0, es / length
    r[6] = head[1] if abs(shear) < head[2] else 0.0
    r[7], r[8] = 0.0, ei / length


@law_function
def commit(parameters, state, deformation, out):  # type: ignore[no-untyped-def]
    head, q, r = floats(parameters, 4), floats(deformation, 3), floats(out, 5)
    length, n = head[0], int(head[3])
    fibre, p = floats(parameters + 32, 5 * n), floats(state, 1 + n)
    mean, curvature = q[0] / length, q[2] / length
    energy, work = 0.0, 0.0
    stretch, rotation, ea, ei = 0.0, 0.0, 0.0, 0.0
    for i in range(n):
        y, area, e, fy, h = fibre[i], fibre[n + i], fibre[2 * n + i], fibre[3 * n + i], fibre[4 * n + i]
        stress = e * (mean - y * curvature - p[1 + i])
        relative = stress - h * p[1 + i]
        flow = 0.0
        if relative > fy:
            flow = (relative - fy) / (e + h)
        elif relative < -fy:
            flow = (relative + fy) / (e + h)
        stress -= e * flow
        # What a fibre's flow dissipates; the rest of σ dεp is kept as energy of the back stress H εp.
        work += area * length * fy * abs(flow)
        p[1 + i] += flow
        energy += 0.5 * area * length * (stress * stress / e + h * p[1 + i] * p[1 + i])
        stretch += area * e * flow
        rotation -= area * e * y * flow
        ea += area * e
        ei += area * e * y * y
    r[2], r[3] = length * stretch / ea, 0.0
    r[4] = length * rotation / ei if ei > 0.0 else 0.0
    shear = head[1] * (q[1] - p[0])
    held = min(max(shear, -head[2]), head[2])
    if held != shear:
        slip = (shear - held) / head[1]
        p[0] += slip
        r[3] = slip
        work += held * slip
    if head[1] > 0.0:
        energy += 0.5 * held * held / head[1]
    r[0], r[1] = energy, work


@dataclass(frozen=True)
class FibreSection:
    """A section of elastic–plastic fibres with kinematic hardening, which makes N and M; shear is capped by itself.

    `of_section` makes one.

    Parameters
    ----------
    length : float
        Length ℓ over which the section's strains are constant [m].
    y, area : (f,) float
        Fibre heights [m] and areas [m²].
    youngs_modulus, yield_stress, tangent_modulus : (f,) float
        E, fy, E_t [Pa] of each.
    shear_stiffness : float
        k_Q [N/m].
    capacity : (float, float, float)
        N_max [N], Q_max [N], M_max [N m], each alone; only Q_max bounds anything, the others are what is called full.
    """

    length: float
    y: np.ndarray
    area: np.ndarray
    youngs_modulus: np.ndarray
    yield_stress: np.ndarray
    tangent_modulus: np.ndarray
    shear_stiffness: float
    capacity: tuple[float, float, float]

    name = "fibre"
    yields_by = ("fibres", "Q", "fibres")
    respond_address = respond
    commit_address = commit

    @classmethod
    def of_section(
        cls,
        section: Section,
        material: Material,
        length: float,
        fibres: int = 16,
        criterion: str = "von-mises",
        shear_stiffness: float | None = None,
    ) -> FibreSection:
        """A joint that stands for ``length`` [m] of a member, its section cut into ``fibres``, at least 4.

        Raises
        ------
        InputError
            When the length is not above 0, or a stress–strain curve grows steeper somewhere, which says nothing about
            unloading.
        ValueError
            For fewer than 4 fibres.
        """
        check_length(length)
        rows = [
            (cut.y, cut.area, *(np.full(len(cut.y), value) for value in layer))
            for own, cut in section.fibres_by_material(fibres, material)
            for layer in _layers(own)
        ]
        c = capacity(section, material, criterion)
        stiffness = c.GA_s / length if shear_stiffness is None else shear_stiffness
        y, area, e, fy, et = (np.concatenate(column) for column in zip(*rows, strict=True))
        return cls(length, y, area, e, fy, et, stiffness, (c.N_max, c.Q_max, c.M_max))

    def capacities(self) -> tuple[float, float, float]:
        """N_max [N], Q_max [N] and M_max [N m], each when it acts alone."""
        return self.capacity

    def parameters(self) -> np.ndarray:
        """Parameters as they lie in memory."""
        e, et = self.youngs_modulus, self.tangent_modulus
        head = [self.length, self.shear_stiffness, self.capacity[1], float(len(self.y))]
        return np.concatenate([head, self.y, self.area, e, self.yield_stress, e * et / (e - et)])

    def state(self) -> np.ndarray:
        """State of a new joint as it lies in memory."""
        return np.zeros(1 + len(self.y))

    def elastic_tangent(self) -> tuple[float, float, float, float, float, float]:
        """Upper triangle of ∂s/∂q while elastic, row by row."""
        stiffness = self.youngs_modulus * self.area / self.length
        ea, es, ei = stiffness.sum(), -(stiffness * self.y).sum(), (stiffness * self.y**2).sum()
        return ea, 0.0, es, self.shear_stiffness, 0.0, ei


def _layers(material: Material) -> list[tuple[float, float, float]]:
    """E, fy and E_t of the elements in parallel that a material is made of [Pa]."""
    curve = material.curve
    if curve is None:
        return [(material.youngs_modulus, material.yield_stress, material.tangent_modulus)]
    if not curve.unloads:
        fault = "its stress–strain curve grows steeper somewhere, which says nothing about unloading"
        raise InputError("material", fault, "use a curve whose slope only falls")
    layers = [
        (float(e), float(e * strain), 0.0) for e, strain in zip(curve.drops, curve.breaks, strict=True) if e > 0.0
    ]
    if curve.slopes[-1] > 0.0:
        layers.append((float(curve.slopes[-1]), _NEVER, 0.0))
    return layers
