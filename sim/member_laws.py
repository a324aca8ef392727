"""The laws of a scene's joints, each of which stands for a length of its member."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from capacity import Capacity, FacetSurface, Interaction
from scene import Member, Scene
from sim.laws import LAWS, ElasticPlastic, FibreSection, Law, RigidPlastic, section_law
from sim.model import Model

#: Shear stiffness of an Euler–Bernoulli member, which has none of its own to give way, over EI / L²: shear adds 3e-5
#: to the deflection of a cantilever and 5e-4 to that of a beam fixed at both ends. Of one that is shorter than three
#: depths it is this much over EA: a stub as stiff as the rest of its kind would leave the solver no digits.
_SHEAR_RIGID, _OVER_AXIAL = 1e5, 1e3


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
        self._fibres: dict[tuple[int, int, int], FibreSection] = {}
        self._surfaces: dict[tuple[str, str], FacetSurface] = {}

    def joint(self, name: str, length: float, *, pinned: bool = False, elastic: bool = False) -> Law:
        """Law of a joint that stands for ``length`` [m] of the member ``name``.

        A ``pinned`` one bears no moment; an ``elastic`` one does not yield.
        """
        member, c = self._scene.members[name], self._scene.capacity(name)
        model, shear = self._model.of(name), self._shear(name, c) / length
        Q_max = c.Q_max if self._model.shear_yields else math.inf
        if pinned:
            if model.law == "fibre":  # all at the axis: they harden under N as those of the other joints do
                fibres = self._fibre(member, model.fibres)
                return replace(
                    fibres,
                    length=length,
                    y=np.zeros_like(fibres.y),
                    shear_stiffness=shear,
                    capacity=(c.N_max, Q_max, 0.0),
                )
            if model.law == "rigid-plastic":
                k = RigidPlastic.of_section(c, length).stiffness
                return RigidPlastic((c.N_max, c.Q_max, 0.0), (k[0], k[1], 0.0))
            return ElasticPlastic((c.EA / length, shear, 0.0), (c.N_max, Q_max, 0.0))
        if elastic:
            return ElasticPlastic((c.EA / length, shear, c.EI / length), (math.inf, math.inf, math.inf))
        law: Law
        if model.law == "fibre":
            law = replace(self._fibre(member, model.fibres), length=length, shear_stiffness=shear)
        else:
            law = section_law(
                model.law,
                member.section,
                member.material,
                length,
                criterion=self._scene.criterion,
                shear_stiffness=shear,
                surface=self._surface(member) if model.law == "interaction" else None,
            )
        if isinstance(law, ElasticPlastic | FibreSection):
            law = replace(law, capacity=(law.capacity[0], Q_max, law.capacity[2]))
        return law

    def _shear(self, name: str, c: Capacity) -> float:
        if self._scene.members[name].theory == "euler-bernoulli":
            return min(_SHEAR_RIGID * c.EI / self._scene.axis(name)[2] ** 2, _OVER_AXIAL * c.EA)
        return c.GA_s

    def _fibre(self, member: Member, fibres: int) -> FibreSection:
        """The section cut into fibres, for a joint of a metre, which takes a millisecond or two."""
        key = (id(member.section), id(member.material), fibres)
        if key not in self._fibres:
            self._fibres[key] = FibreSection.of_section(
                member.section, member.material, 1.0, fibres, self._scene.criterion
            )
        return self._fibres[key]

    def _surface(self, member: Member) -> FacetSurface:
        """Members of one section and material share a surface, which takes some hundredths of a second to cut."""
        key = (member.section.name, member.material.name)
        if key not in self._surfaces:
            exact = Interaction(member.section, member.material, self._scene.criterion)
            self._surfaces[key] = exact.facets()
        return self._surfaces[key]
