"""Capacities from a wanted behaviour: the other way round from sections and materials.

The rules are those of Nikula, Mikkola and Björk, *Breakable elastic-plastic constraint for rigid body simulation*: a
largest elastic deformation of a joint of known stiffness, a share of the capacity that own weight shall use, and a
bridge that a heaviest vehicle decides.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from capacity.catalogue import Entry
from capacity.errors import InputError
from capacity.materials import Material
from capacity.sections import Section
from capacity.yield_criteria import shear_ratio


@dataclass(frozen=True)
class Demand:
    """A capacity that a wanted behaviour asks for.

    Attributes
    ----------
    value : float
        M_max [N m] or N_max, Q_max [N].
    rule : str
        The rule that decided, in words.
    """

    value: float
    rule: str


def _positive(place: str, value: float, example: str) -> float:
    if not (math.isfinite(value) and value > 0.0):
        raise InputError(place, f"{value:g} is not greater than zero", f"write one such as {example}")
    return value


def reduced(first: float, second: float = math.inf) -> float:
    """Mass or inertia that two bodies put against each other, a b / (a + b); a fixed body is infinite.

    Raises
    ------
    InputError
        When neither is finite, or one is not greater than zero.
    """
    if not (first > 0.0 and second > 0.0) or (math.isinf(first) and math.isinf(second)):
        raise InputError("mass", f"{first:g} and {second:g} leave nothing to move", "give one finite mass or inertia")
    return 1.0 / (1.0 / first + 1.0 / second)


def stiffness_and_damping(frequency: float, damping_ratio: float, inertia: float) -> tuple[float, float]:
    """k = (2π f)² m and c = 2 ζ 2π f m of a joint given as a frequency [Hz] and a damping ratio.

    Parameters
    ----------
    inertia : float
        Reduced mass [kg] for k in N/m, or reduced moment of inertia [kg m²] for k in N m/rad.

    Raises
    ------
    InputError
        When the frequency or the inertia is not greater than zero, or the damping ratio is negative.
    """
    omega = 2.0 * math.pi * _positive("frequency", frequency, "1 Hz")
    _positive("inertia", inertia, "58320")
    if damping_ratio < 0.0:
        raise InputError("damping ratio", f"{damping_ratio:g} is negative", "write one such as 0.2")
    return omega * omega * inertia, 2.0 * damping_ratio * omega * inertia


def from_elastic_rotation(stiffness: float, largest_rotation: float) -> Demand:
    """M_max = k θ: the joint yields when its elastic rotation reaches ``largest_rotation`` [N m/rad, rad].

    Raises
    ------
    InputError
        When either is not greater than zero.
    """
    moment = _positive("stiffness", stiffness, "2 MN m/rad") * _positive("rotation", largest_rotation, "0.12 rad")
    return Demand(moment, f"M_max = k θ with k = {stiffness:.6g} N m/rad and θ = {largest_rotation:.6g} rad")


def from_elastic_deflection(stiffness: float, largest_deflection: float) -> Demand:
    """Force capacity k δ: the joint yields when it is stretched or sheared by ``largest_deflection`` [N/m, m].

    Raises
    ------
    InputError
        When either is not greater than zero.
    """
    force = _positive("stiffness", stiffness, "1e6 N/m") * _positive("deflection", largest_deflection, "20 mm")
    return Demand(force, f"force = k δ with k = {stiffness:.6g} N/m and δ = {largest_deflection:.6g} m")


def from_own_weight_share(own_moment: float, share: float) -> Demand:
    """M_max of which own weight at rest uses ``share`` as moment; the paper's ramp has 70 % [N m].

    Raises
    ------
    InputError
        When the moment is not greater than zero or the share is outside (0, 1).
    """
    _positive("own weight", own_moment, "194 kN m")
    _check_share("share of own weight", share)
    return Demand(own_moment / share, f"own weight, {own_moment:.6g} N m at rest, uses {share:.4g} of M_max")


def from_plastic_share(
    own_moment: float, stiffness: float, plastic_rotation: float, share: float, damping_ratio: float = 0.0
) -> Demand:
    """M_max with which own weight, let go at once, uses ``share`` of the plastic rotation; the paper's ramp has 13 %.

    Parameters
    ----------
    own_moment : float
        Moment of own weight in the joint [N m].
    stiffness : float
        k [N m/rad].
    plastic_rotation : float
        At which the joint breaks [rad].
    share : float
        Of it, that own weight shall use.
    damping_ratio : float
        ζ of the member turning on the joint.

    Raises
    ------
    InputError
        When a value is not greater than zero, the share is outside (0, 1) or the damping ratio outside [0, 1).
    """
    _positive("own weight", own_moment, "194 kN m")
    _positive("stiffness", stiffness, "2 MN m/rad")
    _positive("plastic rotation", plastic_rotation, "0.4 rad")
    _check_share("share of the plastic reserve", share)
    if not 0.0 <= damping_ratio < 1.0:
        raise InputError("damping ratio", f"{damping_ratio:g} is not in [0, 1)", "write one such as 0.2")
    # The plastic rotation falls as M_max grows, from endless at M_max = own moment to none at twice of it or before.
    low, high = own_moment, 2.0 * own_moment
    for _ in range(80):
        middle = 0.5 * (low + high)
        used = sudden_plastic_rotation(own_moment, middle, stiffness, damping_ratio)
        low, high = (middle, high) if used > share * plastic_rotation else (low, middle)
    rule = f"own weight, {own_moment:.6g} N m let go at once, uses {share:.4g} of {plastic_rotation:.6g} rad plastic"
    return Demand(0.5 * (low + high), rule)


def sudden_plastic_rotation(moment: float, M_max: float, stiffness: float, damping_ratio: float = 0.0) -> float:
    """Plastic rotation [rad] when ``moment`` acts at once on a joint at rest that yields at ``M_max`` [N m].

    One degree of freedom. Elastic: θ = (m/k) [1 - e^(-ζτ) (cos ντ + (ζ/ν) sin ντ)] with τ = ω t, ν = √(1 - ζ²), until
    spring and damper together reach M_max. Plastic: constant deceleration, so θ grows by θ'² / 2 (M_max - m) more.
    Undamped this is the balance of energy, m (θ_e + θ_p) = M θ_e / 2 + M θ_p. Time is in units of 1/ω.
    """
    if M_max <= moment:
        return math.inf
    zeta, nu = damping_ratio, math.sqrt(1.0 - damping_ratio**2)

    def state(tau: float) -> tuple[float, float]:
        decay = math.exp(-zeta * tau)
        turned = 1.0 - decay * (math.cos(nu * tau) + zeta / nu * math.sin(nu * tau))
        return turned, decay / nu * math.sin(nu * tau)

    # k θ + c θ' over the moment; greatest where its slope vanishes.
    def borne(tau: float) -> float:
        turned, speed = state(tau)
        return turned + 2.0 * zeta * speed

    limit = M_max / moment
    peak = math.pi / nu
    low, high = 0.0, peak
    for _ in range(60):  # the peak of what is borne: golden section is not needed, its slope changes sign once
        middle = 0.5 * (low + high)
        turned, speed = state(middle)
        acceleration = 1.0 - turned - 2.0 * zeta * speed
        low, high = (middle, high) if speed + 2.0 * zeta * acceleration > 0.0 else (low, middle)
    peak = high
    if borne(peak) <= limit:
        return 0.0
    low, high = 0.0, peak
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if borne(middle) < limit else (low, middle)
    turned, speed = state(low)
    stopped = turned + speed**2 / (2.0 * (limit - 1.0))
    return max(0.0, (stopped - limit) * moment / stiffness)


def _check_share(place: str, share: float) -> None:
    if not 0.0 < share < 1.0:
        raise InputError(place, f"{share:g} is not between 0 and 1", 'write one such as "70 %"')


@dataclass(frozen=True)
class Bridge:
    """A simply supported bridge with a joint that shall start to turn under the heaviest vehicle.

    Attributes
    ----------
    span : float
        [m]
    vehicle_weight : float
        Weight of the heaviest vehicle, as one force [N].
    vehicle_at : float
        Where along the span it is when the joint starts to turn [m].
    joint_at : float
        Where the joint is [m].
    weight_per_length : float
        Of the bridge beside its beams [N/m].
    """

    span: float
    vehicle_weight: float
    vehicle_at: float
    joint_at: float
    weight_per_length: float = 0.0

    def __post_init__(self) -> None:
        _positive("span", self.span, '"25 m"')
        _positive("heaviest vehicle", self.vehicle_weight, '"50 t"')
        for place, at in (("vehicle", self.vehicle_at), ("joint", self.joint_at)):
            if not 0.0 < at < self.span:
                raise InputError(place, f"{at:g} m is not between the ends of the span", "write one near mid-span")
        if self.weight_per_length < 0.0:
            raise InputError("weight", f"{self.weight_per_length:g} N/m is negative", "write the bridge's weight")

    def moment(self, vehicle_at: float, weight_per_length: float) -> float:
        """Moment in the joint [N m]: influence line of the vehicle, and q a (L - a) / 2 of the bridge."""
        a, L = self.joint_at, self.span
        near, far = min(a, vehicle_at), max(a, vehicle_at)
        return self.vehicle_weight * near * (L - far) / L + 0.5 * weight_per_length * a * (L - a)

    def M_max(self, own_weight: float = 0.0) -> Demand:
        """Moment at which the joint starts to turn with the vehicle where it is wanted [N m]."""
        value = self.moment(self.vehicle_at, self.weight_per_length + own_weight)
        rule = f"the joint at {self.joint_at:g} m starts to turn when the heaviest vehicle is at {self.vehicle_at:g} m"
        return Demand(value, rule)

    def Q_max(self) -> Demand:
        """Shear capacity to be exceeded: the weight of the heaviest vehicle [N]."""
        return Demand(self.vehicle_weight, f"above the weight of the heaviest vehicle, {self.vehicle_weight:.6g} N")


@dataclass(frozen=True)
class Choice:
    """The lightest section of the catalogue that does what is asked.

    Attributes
    ----------
    section : Section
    M_max, Q_max : float
        What it bears [N m, N].
    demand_M, demand_Q : Demand
        What is asked of it, its own weight included.
    decided : str
        Which of the two the next lighter section fails first.
    """

    section: Section
    M_max: float
    Q_max: float
    demand_M: Demand
    demand_Q: Demand
    decided: str


def lightest_for_bridge(
    bridge: Bridge,
    material: Material,
    entries: Iterable[Entry],
    criterion: str = "von-mises",
    gravity: float = 9.81,
) -> Choice:
    """The lightest of ``entries`` with Q_max above the vehicle's weight and M_max of at least what the bridge asks.

    Raises
    ------
    InputError
        When none does.
    """
    tau = shear_ratio(criterion) * material.yield_stress
    sections = sorted((entry.section() for entry in entries), key=lambda section: section.area)
    failed = "neither"
    for section in sections:
        demand = bridge.M_max(material.density * gravity * section.area)
        Q, M = tau * section.wall_area, material.yield_stress * section.plastic_modulus
        shears, bends = bridge.vehicle_weight < Q, demand.value <= M
        if shears and bends:
            decided = {"neither": "nothing: it is the lightest there is", "Q": "Q_max", "M": "M_max", "both": "both"}
            return Choice(section, M, Q, demand, bridge.Q_max(), decided[failed])
        failed = "both" if not (shears or bends) else "M" if shears else "Q"
    raise InputError("catalogue", "no section bears the vehicle", "use a stronger material, several beams or less span")
