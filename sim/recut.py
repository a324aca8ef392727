"""A member cut anew between two steps, its state carried over.

The new pieces lie on the elastic line that the forces of the old joints explain, between the same nodes, which stay
what they are. The lines are found for where the bodies are and, as they move, for half a step on, or a whole one with
implicit Euler: there the pieces are put, and then back by as much as they will move. The elastic energy is that of the
ledger, of the latter instant or, with implicit Euler, the mean of both.

Mass, momentum and angular momentum of the member are kept to rounding, and so is its kinetic and elastic energy, but
for what the forces on it, its weight above all, work as the pieces are put from one line to the other. A member that
hardly moves may not have the kinetic energy that this takes, and is not set in motion by what is left over; the rest is
in the ledger, as numerical.

Plastic deformations stay where they are: a new joint that takes an old one's place has its state at the same strains,
and what is left of the old one's deformation as a kink. Between two new joints they are kinks of both, by the lever
rule. What fibres store against each other in what becomes a kink is lost, and in the ledger as numerical, too.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pymunk

from sim.body_places import put_even
from sim.carried_motion import carried
from sim.elastic_line import Chain, End, interpolated
from sim.inheritance import Heir, external_force
from sim.joint import DuctileJoint
from sim.kernels import layout as at
from sim.laws import Law
from sim.member_joints import Joined, MemberJoints
from sim.pieces import Pieces
from sim.plastic_state import borne, locked_in, residual
from sim.rules import Rule
from sim.structure import Structure
from sim.successors import Successor, hand_on, holds, lay, shares_at, state_of


@dataclass(frozen=True)
class Recut:
    """A member cut anew.

    Attributes
    ----------
    member : str
    gone : list of DuctileJoint
        No longer in the space.
    joined : list
        The new joints and their places, one for each point of the rule, None at an end that nothing holds.
    heirs : dict[DuctileJoint, Heir]
        What each begins with.
    work : float
        What the forces on the member worked [J].
    """

    member: str
    gone: list[DuctileJoint]
    joined: Joined
    heirs: dict[DuctileJoint, Heir]
    work: float


def recut(
    name: str, pieces: Pieces, maker: MemberJoints, old: Sequence[DuctileJoint | None], before: Rule, after: Rule
) -> Recut | None:
    """Cut a member anew.

    Parameters
    ----------
    name : str
    pieces : Pieces
        Its pieces among them; they are replaced.
    maker : MemberJoints
    old : sequence of DuctileJoint or None
        Its joints, one for each point of the rule that it has been cut by; None at an end that nothing holds.
    before, after : Rule
        What it has been cut by, and what it shall be.

    Returns
    -------
    Recut
        None when no line closes, in a member that was bent out of all shape; nothing is changed then.
    """
    gone = [joint for joint in old if joint is not None]
    structure, ends = gone[0].structure, (old[0], old[-1])
    assert structure is not None
    results = structure.tables[at.RESULT]
    rest = np.array([np.zeros(3) if joint is None else residual(joint.law, state_of(joint)) for joint in old])
    coarse = _chain(pieces, name, before, [None if joint is None else joint.law for joint in old], rest)
    new = [Successor.new(maker, name, after, i) if holds(ends, i, after) else None for i in range(len(after.points))]
    shares = np.zeros((len(new), len(old)))
    for k, joint in enumerate(old):
        if joint is not None:
            shares[:, k] = shares_at([own is not None for own in new], after.points, before.points[k])
            hand_on(joint, results[joint.index], [(own, share) for own, share in zip(new, shares[:, k], strict=True)])
    fine = _chain(
        pieces,
        name,
        after,
        [None if own is None else own.law for own in new],
        np.array([np.zeros(3) if own is None else residual(own.law, own.state) for own in new]),
        np.array([np.zeros(3) if own is None else own.kink for own in new]),
    )
    wait = put_even(structure.bodies, structure.tables)
    moving = _Moving([piece.body for piece in pieces.of[name]])
    undamped = bool(structure.tables[at.SETTINGS][at.BETA] != 0.0)
    reach = structure.tables[at.SETTINGS][at.NEXT_MOVE] * (0.5 if undamped else 1.0)
    now, then = (_Line.of(coarse, fine, shares, moving, old, wait + ahead) for ahead in (0.0, reach))
    if now.poses is None or then.poses is None:
        return None
    work = _work(coarse, fine, then, _force_on(structure, moving.bodies))
    locked = [0.0 if own is None else locked_in(own.law, own.state) for own in new]
    stored = fine.energy(then.borne) + locked
    stored_before = stored if undamped else fine.energy(now.borne) + locked
    passed_on = sum(0.5 * (results[j.index, at.RESULT_BEFORE] + results[j.index, at.RESULT_ELASTIC]) for j in gone)
    lost = sum(locked_in(joint.law, state_of(joint)) for joint in gone) - sum(locked)
    kinetic = moving.kinetic + float(passed_on - lost - 0.5 * (stored_before + stored).sum()) + work
    velocity = carried(
        fine,
        then.poses,
        pieces.inertias(name, after),
        (then.poses - now.poses) / reach,
        moving.momentum,
        kinetic,
        reach,
    )
    pieces.space.remove(*gone)
    made = pieces.pieces_at(name, after, then.poses - (wait + reach) * velocity)
    for piece, (x, y, spin) in zip(made, velocity.tolist(), strict=True):
        piece.body.velocity, piece.body.angular_velocity = (x, y), spin
    pieces.replace(name, made)
    force = fine.force(then.borne)
    joined: Joined = []
    heirs = {}
    for i, (between, own) in enumerate(zip(maker.chain(name, [piece.body for piece in made]), new, strict=True)):
        if between is None or own is None:
            joined.append(None)
            continue
        place = maker.place(name, after, i)
        joint = maker.joint(name, own.law, place, between, (0.0, 0.0))
        lay(joint, own.kink, fine, i, ends)
        joint.at = joint.point_on(joint.b)
        own.result[:6] = *then.deformation[i], *force[i]
        own.result[[at.RESULT_BEFORE, at.RESULT_ELASTIC]] = stored_before[i], stored[i]
        heirs[joint] = Heir(own.state, own.result)
        joined.append((joint, place))
    pieces.space.add(*heirs)
    return Recut(name, gone, joined, heirs, work)


class _Moving:
    """Pieces of a member: masses and moments of inertia (n, 2), poses and velocities (n, 3)."""

    def __init__(self, bodies: Sequence[pymunk.Body]) -> None:
        self.bodies = bodies
        self.weight = np.array([(body.mass, body.moment) for body in bodies])
        self.poses = np.array([(*body.position, body.angle) for body in bodies])
        self.velocity = np.array([(*body.velocity, body.angular_velocity) for body in bodies])

    @property
    def momentum(self) -> np.ndarray:
        """Momentum x, y [N s], and angular momentum about the origin [N m s]."""
        (x, y, _), (vx, vy, spin), (m, i) = self.poses.T, self.velocity.T, self.weight.T
        return np.array([m @ vx, m @ vy, m @ (x * vy - y * vx) + i @ spin])

    @property
    def kinetic(self) -> float:
        """Kinetic energy [J]."""
        return 0.5 * float(np.sum(self.weight[:, [0, 0, 1]] * self.velocity**2))


@dataclass(frozen=True)
class _Line:
    """A member's pieces before and after, no poses if no line closes, and the new joints' deformations.

    Of these, the part that is ``borne`` is what forces explain, or stays without force. What goes beyond is what the
    old joints yield by within the time ahead, and the new ones are yet to.
    """

    before: np.ndarray
    poses: np.ndarray | None
    deformation: np.ndarray
    borne: np.ndarray

    @classmethod
    def of(
        cls,
        coarse: Chain,
        fine: Chain,
        shares: np.ndarray,
        moving: _Moving,
        old: Sequence[DuctileJoint | None],
        ahead: float,
    ) -> _Line:
        """The line as it would be if all went on as it moves for a time ahead [s]."""
        before = moving.poses + ahead * moving.velocity
        start, end = (None if joint is None else _side(joint, i, ahead) for i, joint in enumerate((old[0], old[-1])))
        nowhere = End(0.0j, 0.0)
        q = coarse.deformation(before, start or nowhere, end or nowhere)
        force = np.array([np.zeros(3) if joint is None else _borne(joint, q[i]) for i, joint in enumerate(old)])
        excess = shares @ coarse.excess(q, force)
        poses = fine.laid(interpolated(coarse, force, fine.points), excess, start, end)
        if poses is not None and start is None and end is None:
            poses = _put(poses, fine, before, moving.weight[:, 0])
        if poses is None:
            return cls(before, None, excess, excess)
        deformation = fine.deformation(poses, start or nowhere, end or nowhere)
        return cls(before, poses, deformation, deformation - excess)


def _borne(joint: DuctileJoint, deformation: np.ndarray) -> np.ndarray:
    assert joint.structure is not None
    return borne(joint.law, joint.structure.tables.parameters(joint.index), state_of(joint), deformation)


def _chain(
    pieces: Pieces, name: str, rule: Rule, laws: Sequence[Law | None], rest: np.ndarray, kink: np.ndarray | None = None
) -> Chain:
    length = pieces.scene.axis(name)[2]
    given = np.array([law is not None for law in laws])
    upper = np.array([np.zeros(6) if law is None else law.elastic_tangent() for law in laws])
    return Chain(
        points=rule.points * length,
        stops=np.array(pieces.stops(name, rule)),
        stiffness=upper[:, [0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(-1, 3, 3),
        arc=rule.weights * length / 24.0 * given,
        rest=rest,
        kink=np.zeros_like(rest) if kink is None else kink,
        held=(bool(given[0]), bool(given[-1])),
    )


def _side(joint: DuctileJoint, side: int, ahead: float) -> End:
    """Where the side of an end joint that is not the member's will be."""
    body = (joint.a, joint.b)[side]
    x, y = joint.geometry[2 * side : 2 * side + 2]
    angle = body.angle + ahead * body.angular_velocity
    centre = body.local_to_world(body.center_of_gravity) + ahead * body.velocity
    place = complex(*centre) + complex(x, y) * complex(math.cos(angle), math.sin(angle))
    return End(place, angle + joint.geometry[(at.REST_A, at.REST_B)[side]])


def _put(poses: np.ndarray, fine: Chain, before: np.ndarray, mass: np.ndarray) -> np.ndarray:
    """A line that nothing holds, moved to where the old pieces are: the same centre of mass, the same mean angle."""
    long = np.diff(fine.stops)
    turn = np.average(before[:, 2], weights=mass) - np.average(poses[:, 2], weights=long)
    place = np.exp(1j * turn) * (poses[:, 0] + 1j * poses[:, 1])
    place += np.average(before[:, 0] + 1j * before[:, 1], weights=mass) - np.average(place, weights=long)
    return np.column_stack([place.real, place.imag, poses[:, 2] + turn])


def _force_on(structure: Structure, bodies: Sequence[pymunk.Body]) -> np.ndarray:
    index = {body: i for i, body in enumerate(structure.bodies)}
    force: np.ndarray = external_force(structure)[[index[body] for body in bodies]]
    return force


def _work(coarse: Chain, fine: Chain, line: _Line, force: np.ndarray) -> float:
    """Work of the forces (n, 3) on the old pieces, spread evenly over each, as these become the new ones [J]."""
    assert line.poses is not None
    low = np.maximum(coarse.stops[:-1, None], fine.stops[:-1])
    high = np.minimum(coarse.stops[1:, None], fine.stops[1:])
    share = np.maximum(high - low, 0.0)
    share /= share.sum(axis=1, keepdims=True)
    middle = 0.5 * (low + high)
    old, new = line.before[:, None, :], line.poses[None, :, :]
    from_old, from_new = middle - coarse.middles[:, None], middle - fine.middles
    x = new[..., 0] + from_new * np.cos(new[..., 2]) - old[..., 0] - from_old * np.cos(old[..., 2])
    y = new[..., 1] + from_new * np.sin(new[..., 2]) - old[..., 1] - from_old * np.sin(old[..., 2])
    turn = new[..., 2] - old[..., 2]
    return float(np.sum(share * (force[:, :1] * x + force[:, 1:2] * y + force[:, 2:] * turn)))
