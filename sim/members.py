"""A scene's members, cut into rigid pieces and joined."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import pymunk

from capacity import InputError
from scene import Scene
from sim.body_loads import BodyLoad, body_loads
from sim.followed import check_followed
from sim.joint import DuctileJoint
from sim.limits import Limits
from sim.member_joints import Joined, JointPlace, MemberJoints, Settlement
from sim.member_laws import MemberLaws
from sim.model import MemberModel, Model
from sim.moment_peaks import moment_peaks
from sim.pieces import NodePoint, Piece, Pieces, Span
from sim.refinement import Refinement
from sim.rules import Rule, lobatto, member_rule
from sim.shapes import keep_neighbours_apart
from sim.structure import Structure


class Assembly:
    """A scene as pymunk bodies and joints, ready to step; `assemble` makes one.

    What it holds is replaced when members are refined.

    Attributes
    ----------
    space : pymunk.Space
        Holds all bodies and joints.
    joints : tuple of DuctileJoint
        Those of the members first, in the order of ``places``; then supports.
    structure : Structure
        All of them as one, as long as none breaks and nothing else is joined to them.
    pieces : tuple of Piece
    spans : tuple of Span
        The pieces, and the bits of members that belong to nodes.
    places : tuple of JointPlace
    nodes : dict[str, NodePoint]
        Where each node is.
    dead_loads : tuple of BodyLoad
        To be made to act before each step.
    sudden_loads : tuple of BodyLoad
        Those that a motion begins with; to be made to act before each of its steps.
    pattern : tuple of BodyLoad
        Proportional loads at a load factor of 1.
    settlements : tuple of Settlement
        Of supports, all of which are there from the start unless `settle` lets them grow.
    refined : list of str
        Members that have been refined, one after the other.
    """

    joints: tuple[DuctileJoint, ...]
    pieces: tuple[Piece, ...]
    spans: tuple[Span, ...]
    places: tuple[JointPlace, ...]
    nodes: dict[str, NodePoint]
    dead_loads: tuple[BodyLoad, ...]
    sudden_loads: tuple[BodyLoad, ...]
    pattern: tuple[BodyLoad, ...]
    settlements: tuple[Settlement, ...]

    @property
    def grounds(self) -> tuple[pymunk.Body, ...]:
        """What supports are fixed to: the world, and what settles."""
        return (self.space.static_body, *(support.body for support in self.settlements))

    def __init__(
        self,
        scene: Scene,
        pieces: Pieces,
        joined: dict[str, Joined],
        supports: list[DuctileJoint],
        settlements: list[Settlement],
        refinement: Refinement | None,
    ) -> None:
        self.space, self.settlements = pieces.space, tuple(settlements)
        self.refined: list[str] = []
        self._scene, self._pieces, self._joined, self._supports = scene, pieces, joined, supports
        self._refinement = refinement
        self._arrange()
        self.structure = Structure(self.joints)
        self.space.add(*self.joints)

    def _arrange(self) -> None:
        """Lay out what there is, in order."""
        scene, pieces = self._scene, self._pieces
        own = [joined for name in scene.members for joined in self._joined[name] if joined is not None]
        self.joints = (*(joint for joint, _ in own), *self._supports)
        self.places = tuple(place for _, place in own)
        self.pieces = tuple(piece for name in scene.members for piece in pieces.of[name])
        self.spans = tuple(span for name in scene.members for span in pieces.spans(name))
        self.nodes = pieces.node_points()
        self.dead_loads, self.sudden_loads, self.pattern = (
            body_loads(scene, kind, self.spans, self.nodes) for kind in ("dead", "step", "proportional")
        )

    def driven(self, node: str, direction: tuple[float, float]) -> tuple[BodyLoad, ...]:
        """What a push of ``node`` multiplies: the proportional loads, or else a force of 1 N on it."""
        point = self.nodes[node]
        return self.pattern or (BodyLoad(point.body, direction, 0.0, point.point),)

    def refine(self, members: Collection[str] = ()) -> tuple[str, ...]:
        """Refine the members that bear so much that the model asks for it, and coarse ones among ``members``.

        `step` does it by itself, for what is due. Returns the names of those that were refined: not of a member that
        has come apart, nor of one to whose pieces a constraint was added by hand; they stay coarse.
        """
        if self._refinement is None:
            return ()
        members, followers = self._refinement.refine(members)
        if members:
            self.structure = followers.get(self.structure, self.structure)
            self.refined.extend(members)
            self._arrange()
        return members

    def act(self, share: float = 1.0, *, sudden: bool = False) -> None:
        """Have a share of the dead loads act in the next step, and the sudden ones if wanted."""
        for load in self.dead_loads:
            load.act(share)
        if sudden:
            for load in self.sudden_loads:
                load.act()

    def step(self, dt: float, share: float = 1.0, *, sudden: bool = False) -> None:
        """Step the space by ``dt`` [s] with these loads."""
        self.refine()
        self.act(share, sudden=sudden)
        self.space.step(dt)


def assemble(
    scene: Scene,
    model: Model,
    space: pymunk.Space | None = None,
    *,
    limits: Mapping[str, Limits] | None = None,
    shapes: bool = True,
) -> Assembly:
    """Bodies and joints for ``scene``.

    Parameters
    ----------
    scene : Scene
    model : Model
    space : pymunk.Space, optional
        Where to put them; by default a space of their own with the scene's gravity and the model's iterations.
    limits : mapping, optional
        By member, when its joints break; those not named do not.
    shapes : bool
        Give the pieces shapes as deep as their sections, so that other things touch them. The parts of a structure that
        a joint holds together pass through each other.

    Raises
    ------
    ValueError
        When ``model`` names an unknown rule or law, or too few joints.
    InputError
        When its hinges are too long for a member, the scene has what joints do not follow, or ``limits`` names a member
        that it does not have.
    """
    check_followed(scene)
    for name in limits or ():
        if name not in scene.members:
            raise InputError(
                f"limits[{name!r}]", "there is no such member", f"the members are {', '.join(scene.members)}"
            )
    laws = MemberLaws(scene, model)
    finest = {name: _rule(scene, name, model.of(name)) for name in scene.members}
    rules = {name: _first_rule(model, rule) for name, rule in finest.items()}
    if space is None:
        space = pymunk.Space()
        space.iterations = model.iterations
        space.gravity = (0.0, -scene.gravity)
    pieces = Pieces(scene, rules, space, finest)
    maker = MemberJoints(scene, model, laws, limits or {}, pieces)
    joined = {name: maker.all_of(name, rules[name]) for name in scene.members}
    supports = [joint for name, body in pieces.at_node.items() for joint in maker.supports(name, body)]
    if shapes:
        pieces.add_shapes()
        keep_neighbours_apart(space, pieces.bodies(), pieces.greatest_depth())
    refinement = None
    if model.refine_at is not None:
        refinement = Refinement(pieces, maker, joined, rules, finest, model.refine_at)
    return Assembly(scene, pieces, joined, supports, maker.settlements, refinement)


def _rule(scene: Scene, name: str, model: MemberModel) -> Rule:
    hinge = model.hinge_length
    if hinge is None:
        low, high = scene.members[name].section.outline.extent()
        hinge = high - low
    return member_rule(model.rule, model.joints, hinge, name, scene.axis(name)[2], moment_peaks(scene, name))


def _first_rule(model: Model, finest: Rule) -> Rule:
    """What a member is cut by at first."""
    if model.refine_at is None or len(finest.points) <= model.coarse_joints:
        return finest
    return lobatto(model.coarse_joints)
