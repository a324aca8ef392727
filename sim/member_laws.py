"""The laws of a scene's joints, each of which stands for a length of its member."""

from __future__ import annotations

import math

from capacity import Capacity, FacetSurface, Interaction
from scene import Member, Scene
from sim.laws import ElasticPlastic, FibreSection, InteractionPlastic, Law, RigidPlastic
from sim.model import Model

#: Names of the laws.
LAWS = ("rigid-plastic", "elastic-plastic", "interaction", "fibre")
#: Shear stiffness of an Euler–Bernoulli member, which has none of its own to give way, over EI / L²: shear adds 3e-5
#: to the deflection of a cantilever and 5e-4 to that of a beam fixed at both ends.
_SHEAR_RIGID = 1e5


class MemberLaws:
    """Laws of ``scene``'s joints as ``model`` wants them.

    Raises
    ------
    ValueError
        When ``model`` names an unknown law.
    """

    def __init__(self, scene: Scene, model: Model) -> None:
        for law in {model.of(name).law for name in scene.members}:
            if law not in LAWS:
                raise ValueError(f'there is no joint law "{law}"; the laws are {", ".join(LAWS)}')
        self._scene, self._model = scene, model
        self._surfaces: dict[tuple[str, str], FacetSurface] = {}

    def joint(self, name: str, length: float, *, pinned: bool = False, elastic: bool = False) -> Law:
        """Law of a joint that stands for ``length`` [m] of the member ``name``.

        A ``pinned`` one bears no moment; an ``elastic`` one does not yield.
        """
        member, c = self._scene.members[name], self._scene.capacity(name)
        model = self._model.of(name)
        stiffness = self._stiffness(name, c, length)
        if pinned:
            if model.law == "rigid-plastic":
                return RigidPlastic((c.N_max, c.Q_max, 0.0))
            return ElasticPlastic((*stiffness[:2], 0.0), (c.N_max, c.Q_max, 0.0))
        if elastic:
            return ElasticPlastic(stiffness, (math.inf, math.inf, math.inf))
        match model.law:
            case "rigid-plastic":
                return RigidPlastic.of_section(c)
            case "elastic-plastic":
                return ElasticPlastic(stiffness, (c.N_max, c.Q_max, c.M_max))
            case "interaction":
                return InteractionPlastic(stiffness, self._surface(member))
            case _:
                section, criterion = member.section, self._scene.criterion
                return FibreSection.of_section(section, member.material, length, model.fibres, criterion, stiffness[1])

    def _stiffness(self, name: str, c: Capacity, length: float) -> tuple[float, float, float]:
        shear = c.GA_s
        if self._scene.members[name].theory == "euler-bernoulli":
            shear = _SHEAR_RIGID * c.EI / self._scene.axis(name)[2] ** 2
        return c.EA / length, shear / length, c.EI / length

    def _surface(self, member: Member) -> FacetSurface:
        """Members of one section and material share a surface, which takes some hundredths of a second to cut."""
        key = (member.section.name, member.material.name)
        if key not in self._surfaces:
            exact = Interaction(member.section, member.material, self._scene.criterion)
            self._surfaces[key] = exact.facets()
        return self._surfaces[key]
