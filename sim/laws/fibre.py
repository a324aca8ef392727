"""Fibre-section joint: N and M from elastic–plastic fibres over a length ℓ, shear capped by itself.

A fibre at height y has strain ε = (u - y θ) / ℓ and follows bilinear kinematic hardening with plastic modulus
H = E E_t / (E - E_t), so N–M interaction, gradual yielding and the Bauschinger effect come by themselves.

Parameters in memory: ℓ, k_Q, Q_max, number of fibres f; then y, A, E, fy, H of each fibre, one list after another.
State: plastic slip, then the plastic strain of each fibre.
"""

from dataclasses import dataclass

import numpy as np
from numba import cfunc

from sim.memory import LAW_SIGNATURE, floats


@cfunc(LAW_SIGNATURE, cache=True, error_model="numpy")
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


@cfunc(LAW_SIGNATURE, cache=True, error_model="numpy")
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
    r[2], r[3], r[4] = length * stretch / ea, 0.0, length * rotation / ei
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
    """The law above.

    Parameters
    ----------
    length : float
        Length ℓ over which the section's strains are constant [m].
    y, area : (f,) float
        Fibre heights [m] and areas [m²].
    youngs_modulus, yield_stress, tangent_modulus : float
        E, fy, E_t [Pa].
    shear_stiffness, shear_capacity : float
        k_Q [N/m] and Q_max [N].
    """

    length: float
    y: np.ndarray
    area: np.ndarray
    youngs_modulus: float
    yield_stress: float
    tangent_modulus: float
    shear_stiffness: float
    shear_capacity: float

    name = "fibre"
    yields_by = ("fibres", "Q", "fibres")
    respond_address = respond.address
    commit_address = commit.address

    def capacities(self) -> tuple[float, float, float]:
        """N_max [N], Q_max [N] and M_max [N m], each when it acts alone, at first full yield."""
        order = np.argsort(self.y)
        # The plastic centroid: the fibre at which half of the area is passed, or between two.
        passed = np.cumsum(self.area[order])
        middle = float(np.interp(0.5 * passed[-1], passed - 0.5 * self.area[order], self.y[order]))
        moment = self.yield_stress * float(self.area @ np.abs(self.y - middle))
        return self.yield_stress * float(self.area.sum()), self.shear_capacity, moment

    def parameters(self) -> np.ndarray:
        """Parameters as they lie in memory."""
        n = len(self.y)
        e, et = self.youngs_modulus, self.tangent_modulus
        head = [self.length, self.shear_stiffness, self.shear_capacity, float(n)]
        same = [np.full(n, e), np.full(n, self.yield_stress), np.full(n, e * et / (e - et))]
        return np.concatenate([head, self.y, self.area, *same])

    def state(self) -> np.ndarray:
        """State of a new joint as it lies in memory."""
        return np.zeros(1 + len(self.y))

    def elastic_tangent(self) -> tuple[float, float, float, float, float, float]:
        """Upper triangle of ∂s/∂q while elastic, row by row."""
        scale = self.youngs_modulus / self.length
        ea, es, ei = self.area.sum(), -(self.area * self.y).sum(), (self.area * self.y**2).sum()
        return scale * ea, 0.0, scale * es, self.shear_stiffness, 0.0, scale * ei
