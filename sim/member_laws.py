"""The law of a joint that stands for a length of a member."""

from __future__ import annotations

from scene import Scene
from sim.laws import ElasticPlastic, FibreSection, Law
from sim.model import Model

#: Shear stiffness of an Euler–Bernoulli member, which has none of its own to give way, over EI / L²: shear adds 3e-5
#: to the deflection of a cantilever and 5e-4 to that of a beam fixed at both ends.
_SHEAR_RIGID = 1e5


def joint_law(scene: Scene, name: str, length: float, model: Model, pinned: bool = False) -> Law:
    """Law of a joint that stands for ``length`` [m] of the member ``name``; a pinned one bears no moment.

    Raises
    ------
    ValueError
        When ``model`` names an unknown law.
    """
    member, c = scene.members[name], scene.capacity(name)
    shear = c.GA_s
    if member.theory == "euler-bernoulli":
        shear = _SHEAR_RIGID * c.EI / scene.axis(name)[2] ** 2
    if pinned:
        return ElasticPlastic((c.EA / length, shear / length, 0.0), (c.N_max, c.Q_max, 0.0))
    if model.law == "elastic-plastic":
        return ElasticPlastic((c.EA / length, shear / length, c.EI / length), (c.N_max, c.Q_max, c.M_max))
    if model.law == "fibre":
        fibres, material = member.section.fibres(model.fibres), member.material
        return FibreSection(
            length=length,
            y=fibres.y,
            area=fibres.area,
            youngs_modulus=material.youngs_modulus,
            yield_stress=material.yield_stress,
            tangent_modulus=material.tangent_modulus,
            shear_stiffness=shear / length,
            shear_capacity=c.Q_max,
        )
    raise ValueError(f'there is no joint law "{model.law}"; the laws are elastic-plastic and fibre')
