"""How structures go on from those that had their joints before."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import TYPE_CHECKING

import numpy as np
import pymunk

from sim import chipmunk
from sim.body_places import carry_along, led_aside
from sim.kernels import layout as at

if TYPE_CHECKING:
    from sim.structure import Structure

# Settings that are a structure's own: what its joints want, and what drives it.
_OWN = [at.TOLERANCE, at.WANTED_BETA, at.WANTED_DELTA, at.LARGEST, at.MOMENT]
_OWN += [at.SPREAD_STIFFNESS, at.SPREAD_GAP, at.SPREAD_IMPULSE]

# Entries of the ledger beside what a structure has at present and what came from outside; first those that close it.
_SPENT = [at.LEDGER_PLASTIC, at.LEDGER_CONTACT, at.LEDGER_VISCOUS, at.LEDGER_NUMERICAL]
_PASSED_ON = [*_SPENT, at.LEDGER_TO_COME, at.LEDGER_OWED]
# Over 1 + |x|: what is one place [m, rad].
_SAME = 1e-9


def book_gone(structure: Structure, space: pymunk.Space) -> None:
    """Take joints that have left ``space`` out of a structure that ends; their forces were ones from outside, now gone.

    What they store goes with them.
    """
    tables, there = structure.tables, space.constraints
    row = {body: i for i, body in enumerate(structure.bodies)}
    for k, joint in enumerate(structure.joints):
        if joint.structure is structure and joint not in there and tables[at.ACTIVE][k]:
            force = tables[at.RESULT][k, at.RESULT_FORCE : at.RESULT_FORCE + 3]
            for body, sign in ((joint.a, 1.0), (joint.b, -1.0)):
                if body.body_type == pymunk.Body.DYNAMIC:
                    tables[at.LAST_FORCE][row[body]] += sign * joint.rates_on(body).T @ force
            tables[at.ACTIVE][k] = 0
            tables[at.RESULT][k, : at.RESULT_BEFORE + 1] = 0.0


def was_away(structure: Structure, space: pymunk.Space) -> bool:
    """Whether a structure had no part in the last step of ``space``, which has begun another, and its bodies moved on.

    Those that fell asleep have made their last move, and may have been woken before this step or within it.
    """
    tables, moving = structure.tables, int(structure.tables.control[at.MOVING])
    missed = chipmunk.steps_begun(space) - 1 - int(tables.control[at.SEEN])
    if missed == 0 or tables.control[at.SEEN] == 0:
        return False
    noted = tables[at.BEGUN_AT if tables.control[at.PARTS] > 1 else at.LAST_POSITION][:moving]
    last = tables[at.LAST_VELOCITY][:moving]
    way = tables[at.SETTINGS][at.WHOLE_STEP] * (np.abs(last) + np.abs(tables[at.SHIFT][:moving, :3]))
    most = way + _SAME * (1.0 + np.abs(noted))
    bodies = structure.bodies[:moving]
    now, before = (
        np.array([place(body) for body in bodies]) for place in (chipmunk.place_of, chipmunk.place_before_step)
    )
    moved = np.minimum(np.abs(now - noted), np.abs(before - noted)) > most
    speeds = np.array([(*body.velocity, body.angular_velocity) for body in bodies])
    return bool(moved.any() or (missed == 1 and (speeds != last).any()))


def let_go(structure: Structure) -> None:
    """End a structure: joints that no other one has taken over do nothing until one does."""
    structure.superseded = True
    for joint in structure.joints:
        if joint.structure is structure:
            chipmunk.release(joint._constraint)
            if not joint.broken:
                joint.ask_for_structure()


def take_joints(new: Structure, olds: Collection[Structure]) -> None:
    """Have joints go on as they were in ``olds``; others keep the plastic state that they have."""
    tables = new.tables
    for i, joint in enumerate(new.joints):
        old, k = joint.structure, joint.index
        if old is None:
            continue
        tables.state(i)[:] = old.tables.state(k)
        if old in olds and (old.tables[at.ACTIVE][k] or joint.broken):
            tables.copy_joint(old.tables, i, k)
        else:
            tables[at.RESULT][i, at.RESULT_BEFORE + 1 :] = old.tables[at.RESULT][k, at.RESULT_BEFORE + 1 :]


def take_bodies(new: Structure, olds: Collection[Structure], carried: bool) -> None:
    """Have bodies go on as they moved in ``olds``.

    What is joined to one of those, or to a kinematic body, has been ``carried`` along with it since the last step,
    whatever its velocity; or it has moved by itself. A structure that is new and tied to the world at most begins to
    move with its first step.

    Structures may have taken the last step in different ways; the new one goes on in that of the hardest blow.
    """
    tables, row = new.tables, {body: i for i, body in enumerate(new.bodies)}
    stepped = [old for old in olds if old.step > 0.0]
    for old in stepped:
        tables.copy_bodies(old.tables, [(row[body], i) for i, body in enumerate(old.bodies) if body in row])
    moved = {body: tables[at.LAST_VELOCITY][row[body]] for old in stepped for body in old.bodies if body in row}
    known = set(moved)
    for body in new.bodies:
        if body.body_type == pymunk.Body.KINEMATIC and body not in moved:
            moved[body] = np.array([*body.velocity, body.angular_velocity])
    aside = {body: ahead for old in stepped for body, ahead in zip(old.bodies, led_aside(old.tables), strict=True)}
    if carried:
        if stepped and any(body.body_type == pymunk.Body.DYNAMIC and body not in moved for body in new.bodies):
            tables[at.SETTINGS][at.MOMENT] = _angular_momentum(new.bodies)
        carry_along(moved, aside, [(joint.a, joint.b) for joint in new.joints])
    elif moved:
        moved |= {body: np.array([*body.velocity, body.angular_velocity]) for body in new.bodies if body not in moved}
    for body in moved.keys() - known:
        i = row[body]
        tables[at.LAST_VELOCITY][i] = moved[body]
        tables[at.BEGUN_AT][i] = tables[at.LAST_POSITION][i] = chipmunk.place_before_step(body)
    if stepped:
        _go_on(new, max(stepped, key=_hardness), stepped)


def _angular_momentum(bodies: Iterable[pymunk.Body]) -> float:
    """Of dynamic bodies, about the origin [N m s]."""
    total = 0.0
    for body in bodies:
        if body.body_type == pymunk.Body.DYNAMIC:
            place, (vx, vy), spin = chipmunk.place_of(body), body.velocity, body.angular_velocity
            total += body.mass * float(place[0] * vy - place[1] * vx)
            total += body.moment * spin if spin != 0.0 else 0.0
    return total


def _hardness(structure: Structure) -> tuple[float, float]:
    settings = structure.tables[at.SETTINGS]
    return float(settings[at.BLOW]), -float(settings[at.NEXT_MOVE])


def _go_on(new: Structure, leading: Structure, olds: Collection[Structure]) -> None:
    """Have a structure go on in the way in which its ``leading`` predecessor has taken the last step."""
    tables, control = new.tables, leading.tables.control
    own = tables[at.SETTINGS][_OWN]
    tables[at.SETTINGS][:] = leading.tables[at.SETTINGS]
    tables[at.SETTINGS][_OWN] = own
    tables.control[[at.PARTS, at.CONTACTS]] = control[[at.PARTS, at.CONTACTS]]
    for word in (at.SHIFTED, at.FLOWING):
        tables.control[word] = max(old.tables.control[word] for old in olds)
    tables.make_room(max(int(tables.control[at.ROOM]), int(control[at.PUSHED])))
    tables.restore_pushes(leading.tables.pushes())
    for i, joint in enumerate(new.joints):
        if joint.structure is not None and joint.structure in olds:
            tables[at.IMPULSE][i] *= leading.step / joint.structure.step


def take_ledger(new: Structure, olds: Collection[Structure], whole: bool) -> None:
    """Have the ledger go on: with the share of the bodies that come from each of ``olds``, or the ``whole`` of theirs.

    What bodies store that are new, or bring in motion, is given from outside.
    """
    ledger, bodies = new.tables[at.LEDGER], set(new.bodies)
    mass = np.array([(b.mass, b.mass, b.moment) for b in new.bodies if b.body_type == pymunk.Body.DYNAMIC])
    moving = new.tables[at.LAST_VELOCITY][: len(mass)]
    # A body that never turns has a moment without bound.
    ledger[at.LEDGER_KINETIC] = 0.5 * np.sum(np.where(moving != 0.0, mass, 0.0) * moving**2)
    ledger[at.LEDGER_ELASTIC] = 0.5 * new.tables[at.RESULT][:, [at.RESULT_BEFORE, at.RESULT_ELASTIC]].sum()
    for old in olds:
        theirs, left = old.tables[at.LEDGER], old.to_pass_on
        count = left if whole else sum(body in bodies for body in old.bodies[: int(old.tables.control[at.MOVING])])
        if count:
            share = count / left * theirs[_PASSED_ON]
            ledger[_PASSED_ON] += share
            theirs[_PASSED_ON] -= share
            theirs[at.LEDGER_EXTERNAL] -= share[: len(_SPENT)].sum()
            old.to_pass_on -= count
    now = [at.LEDGER_KINETIC, at.LEDGER_ELASTIC]
    ledger[at.LEDGER_EXTERNAL] = ledger[[*now, *_SPENT]].sum()
