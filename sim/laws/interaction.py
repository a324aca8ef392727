"""Elastic–perfectly plastic joint in which N, Q and M interact: one yield surface, associated flow.

The surface is that of `capacity.FacetSurface`: facets in N and M, which shear draws in by the yield criterion,

    a_k N + b_k M ≤ f_k + w_k r,   r = √(1 - (Q / Q_max)²)   for every facet k.

The force is the point of this convex region that is nearest to the elastic trial force t in the elastic energy
½ (s - t)ᵀ C (s - t), C = diag(1/k_N, 1/k_Q, 1/k_M), so that flow is associated and dissipation cannot be negative.

For a given Q the facets are a polygon, and its nearest point lies on one edge or corner, with multipliers λ ≥ 0. What
is left is one equation for Q = Q_max sin φ, increasing in Q, solved by Newton's method between bounds:

    (Q - Q_t) / k_Q + Σ λ_k w_k · Q / (Q_max² r) = 0.

Parameters in memory: k_N, k_Q, k_M, Q_max, what counts as rounding in a facet's inequality, number of facets n, N_max,
M_max; then a, b, f, w of each facet, one list after another, by direction in (√k_N N, √k_M M) and scaled so that
a² k_N + b² k_M = 1.
State: plastic deformation (3).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numba import njit

from capacity import FacetSurface
from sim.compiling import law_function
from sim.memory import floats, kernel

_HEAD = 8
_ROUNDING = 1e-12
_ANGLE = 1e-14


@njit(error_model="numpy", fastmath=True)
def furthest(facets, n, r, N, M):  # type: ignore[no-untyped-def]
    """By how much (N, M) exceeds the facet that it exceeds most; negative inside."""
    most = -np.inf
    for k in range(n):
        most = max(most, facets[k] * N + facets[n + k] * M - facets[2 * n + k] - r * facets[3 * n + k])
    return most


@kernel
def excess(facets, n, k, r, N, M):  # type: ignore[no-untyped-def]
    """By how much (N, M) exceeds facet k."""
    return facets[k] * N + facets[n + k] * M - facets[2 * n + k] - r * facets[3 * n + k]


@kernel
def nearest(facets, n, r, kN, kM, rounding, N, M, i):  # type: ignore[no-untyped-def]
    """The facet or corner of the polygon at r that is nearest to (N, M): facets i and j (or -1), multipliers λ.

    The search goes from edge to edge, from facet ``i`` if (N, M) exceeds it.
    """
    if i < 0 or excess(facets, n, i, r, N, M) <= rounding:
        if furthest(facets, n, r, N, M) <= rounding:
            return -1, -1, 0.0, 0.0
        most = rounding
        for k in range(n):
            beyond = excess(facets, n, k, r, N, M)
            if beyond > most:
                i, most = k, beyond
        if most <= rounding:  # sums in another order, as fast mathematics may have them, differ by that
            return -1, -1, 0.0, 0.0
    over = 0.0
    for _ in range(n):
        ai, bi = facets[i], facets[n + i]
        over = excess(facets, n, i, r, N, M)
        foot_N, foot_M = N - over * ai * kN, M - over * bi * kM
        step = 0
        for side in (1, -1):
            j = (i + side) % n
            if excess(facets, n, j, r, foot_N, foot_M) <= rounding:
                continue
            # Beyond the edge's end: the corner is nearest if it takes both facets to push there.
            cosine = ai * facets[j] * kN + bi * facets[n + j] * kM
            beyond = excess(facets, n, j, r, N, M)
            det = 1.0 - cosine * cosine
            li, lj = (over - cosine * beyond) / det, (beyond - cosine * over) / det
            if li >= 0.0 and lj >= 0.0:
                return i, j, li, lj
            step = side
        if step == 0:
            break
        i = (i + step) % n
    return i, -1, over, 0.0


@kernel
def weights(facets, n, i, j, li, lj, kN, kM):  # type: ignore[no-untyped-def]
    """L = Σ λ w over the facets at work, and how fast it falls as r grows."""
    wi = facets[3 * n + i]
    if j < 0:
        return li * wi, wi * wi
    wj, cosine = facets[3 * n + j], facets[i] * facets[j] * kN + facets[n + i] * facets[n + j] * kM
    return li * wi + lj * wj, (wi * wi - 2.0 * cosine * wi * wj + wj * wj) / (1.0 - cosine * cosine)


@kernel
def project(head, facets, n, N, Q, M):  # type: ignore[no-untyped-def]
    """Angle φ of Q = Q_max sin φ and the facets at work, for a trial force; Q ≥ 0."""
    kN, kQ, kM, Q_max = head[0], head[1], head[2], head[3]
    phi = math.asin(min(1.0, Q / Q_max))
    i, j, li, lj = nearest(facets, n, math.cos(phi), kN, kM, head[4], N, M, -1)
    if i < 0 or Q == 0.0:
        return phi, i, j, li, lj
    low, high = 0.0, phi
    for _ in range(100):
        s, c = math.sin(phi), math.cos(phi)
        i, j, li, lj = nearest(facets, n, c, kN, kM, head[4], N, M, i)
        total, fall = 0.0, 0.0
        if i >= 0:
            total, fall = weights(facets, n, i, j, li, lj, kN, kM)
        g = c * Q_max * (Q_max * s - Q) / kQ + s * total
        if g > 0.0:
            high = phi
        else:
            low = phi
        slope = (Q_max * Q_max * (c * c - s * s) + Q_max * Q * s) / kQ + c * total + s * s * fall
        new = phi - g / slope if slope > 0.0 else -1.0
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - phi) <= _ANGLE or g == 0.0:
            break
        phi = new
    return phi, i, j, li, lj


@kernel
def force(head, facets, n, p, q, s):  # type: ignore[no-untyped-def]
    """Write the force at q to s; returns r, Σ λ w and the facets at work (-1 for none)."""
    kN, kQ, kM, Q_max = head[0], head[1], head[2], head[3]
    N, Q, M = kN * (q[0] - p[0]), kQ * (q[1] - p[1]), kM * (q[2] - p[2])
    s[0], s[1], s[2] = N, Q, M
    if abs(N) / head[6] + abs(Q) / Q_max + abs(M) / head[7] < 1.0:  # between the axes' ends a convex surface bulges
        return 1.0, 0.0, -1, -1
    phi, i, j, li, lj = project(head, facets, n, N, abs(Q), M)
    if i < 0 and abs(Q) <= Q_max:
        return math.cos(phi), 0.0, -1, -1
    s[1] = math.copysign(Q_max * math.sin(phi), Q)
    total = 0.0
    if i >= 0:
        s[0] -= kN * li * facets[i]
        s[2] -= kM * li * facets[n + i]
        total = li * facets[3 * n + i]
    if j >= 0:
        s[0] -= kN * lj * facets[j]
        s[2] -= kM * lj * facets[n + j]
        total += lj * facets[3 * n + j]
    return math.cos(phi), total, i, j


@law_function
def respond(parameters, state, deformation, out):  # type: ignore[no-untyped-def]
    head, p, q, d = floats(parameters, _HEAD), floats(state, 3), floats(deformation, 3), floats(out, 9)
    n = int(head[5])
    facets = floats(parameters + 8 * _HEAD, 4 * n)
    kN, kQ, kM, Q_max = head[0], head[1], head[2], head[3]
    r, total, i, j = force(head, facets, n, p, q, d)
    capped = abs(kQ * (q[1] - p[1])) > Q_max
    d[3], d[4], d[5], d[6], d[7], d[8] = kN, 0.0, 0.0, kQ, 0.0, kM
    if i < 0:
        if capped:
            d[6] = 0.0
        return
    # ds = C̃⁻¹ (dq - Σ n dλ) with C̃ = C + Σ λ ∂²g/∂s², which only softens Q; n is a facet's gradient.
    soft = r * r * r * Q_max * Q_max + kQ * total
    share = d[1] / Q_max
    d[6] = kQ * r * r * r * Q_max * Q_max / soft if soft > 0.0 else 0.0
    # C̃⁻¹ n, and nᵀ C̃⁻¹ n, with the powers of r that cancel left out.
    along = kQ * r * r * Q_max * share / soft if soft > 0.0 else 0.0
    across = kQ * r * share * share / soft if soft > 0.0 else 0.0
    ai, bi, wi = facets[i], facets[n + i], facets[3 * n + i]
    ui, vi, ti = kN * ai, along * wi, kM * bi
    gii = ai * ui + bi * ti + wi * wi * across
    if j < 0:
        d[3] -= ui * ui / gii
        d[4] -= ui * vi / gii
        d[5] -= ui * ti / gii
        d[6] -= vi * vi / gii
        d[7] -= vi * ti / gii
        d[8] -= ti * ti / gii
        return
    aj, bj, wj = facets[j], facets[n + j], facets[3 * n + j]
    uj, vj, tj = kN * aj, along * wj, kM * bj
    gjj, gij = aj * uj + bj * tj + wj * wj * across, ai * uj + bi * tj + wi * wj * across
    det = gii * gjj - gij * gij
    d[3] -= (gjj * ui * ui - 2.0 * gij * ui * uj + gii * uj * uj) / det
    d[4] -= (gjj * ui * vi - gij * (ui * vj + uj * vi) + gii * uj * vj) / det
    d[5] -= (gjj * ui * ti - gij * (ui * tj + uj * ti) + gii * uj * tj) / det
    d[6] -= (gjj * vi * vi - 2.0 * gij * vi * vj + gii * vj * vj) / det
    d[7] -= (gjj * vi * ti - gij * (vi * tj + vj * ti) + gii * vj * tj) / det
    d[8] -= (gjj * ti * ti - 2.0 * gij * ti * tj + gii * tj * tj) / det


@law_function
def commit(parameters, state, deformation, out):  # type: ignore[no-untyped-def]
    head, p, q, r = floats(parameters, _HEAD), floats(state, 3), floats(deformation, 3), floats(out, 5)
    n = int(head[5])
    s = np.empty(3)
    force(head, floats(parameters + 8 * _HEAD, 4 * n), n, p, q, s)
    energy, work = 0.0, 0.0
    for i in range(3):
        k = head[i]
        flow = q[i] - p[i] - s[i] / k
        p[i] += flow
        r[2 + i] = flow
        work += s[i] * flow
        energy += 0.5 * s[i] * s[i] / k
    # Where nothing yields flow is rounding, of either sign.
    r[0], r[1] = energy, max(work, 0.0)


@dataclass(frozen=True)
class InteractionPlastic:
    """Elastic–perfectly plastic with one yield surface for N, Q and M together, and flow normal to it.

    Parameters
    ----------
    stiffness : (float, float, float)
        Axial [N/m], shear [N/m] and rotational [N m/rad] stiffness, each above 0.
    surface : FacetSurface
        What the joint bears; `capacity.Interaction.facets` makes one, with its error against the exact surface.

    Raises
    ------
    ValueError
        When a stiffness is not above 0.
    """

    stiffness: tuple[float, float, float]
    surface: FacetSurface = field(repr=False)

    name = "interaction"
    yields_by = ("N-Q-M", "N-Q-M", "N-Q-M")
    respond_address = respond
    commit_address = commit

    def __post_init__(self) -> None:
        if min(self.stiffness) <= 0.0:
            raise ValueError(f"stiffness {self.stiffness}: where N, Q and M interact, each needs one above 0")

    def capacities(self) -> tuple[float, float, float]:
        """N_max [N], Q_max [N] and M_max [N m], each when it acts alone."""
        surface = self.surface
        N, M = (1.0 / float(surface.value(*unit)) for unit in ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)))
        return N, surface.Q_max, M

    def parameters(self) -> np.ndarray:
        """Parameters as they lie in memory."""
        (kN, kQ, kM), surface = self.stiffness, self.surface
        scaled = surface.normals * np.sqrt([kN, kM])
        order = np.argsort(np.arctan2(scaled[:, 1], scaled[:, 0]), kind="stable")
        size = np.hypot(scaled[:, 0], scaled[:, 1])
        a, b, f, w = (row / size for row in (*surface.normals.T, surface.fixed, surface.walls))
        rounding = _ROUNDING * float((f + w).max())
        N_max, _, M_max = self.capacities()
        head = [kN, kQ, kM, surface.Q_max, rounding, float(len(order)), N_max, M_max]
        return np.concatenate([head, a[order], b[order], f[order], w[order]])

    def state(self) -> np.ndarray:
        """State of a new joint as it lies in memory."""
        return np.zeros(3)

    def elastic_tangent(self) -> tuple[float, float, float, float, float, float]:
        """Upper triangle of ∂s/∂q while elastic, row by row."""
        k = self.stiffness
        return k[0], 0.0, 0.0, k[1], 0.0, k[2]
