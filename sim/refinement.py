"""Members that start coarse and are cut finer once they bear much."""

from __future__ import annotations

import importlib
from collections.abc import Collection, Mapping
from typing import NamedTuple

import numpy as np

from sim.inheritance import succeed
from sim.member_joints import Joined, MemberJoints
from sim.pieces import Pieces
from sim.recut import Recut, recut
from sim.rules import Rule
from sim.structure import Structure


class _Watched(NamedTuple):
    """Joints of coarse members in a structure: their rows, what N, Q and M there weigh (n, 3), and their members."""

    structure: Structure
    rows: np.ndarray
    weights: np.ndarray
    members: tuple[str, ...]


class Refinement:
    """Watches members of a scene, and refines those that bear much.

    Parameters
    ----------
    pieces : Pieces
    maker : MemberJoints
    joined : dict[str, Joined]
        The joints of each member; kept up to date.
    rules, finest : mapping
        By member, what it is cut by at first, and once it is refined.
    threshold : float
        Share of first yield, or of the shear capacity, at which a member is refined.
    """

    def __init__(
        self,
        pieces: Pieces,
        maker: MemberJoints,
        joined: dict[str, Joined],
        rules: Mapping[str, Rule],
        finest: Mapping[str, Rule],
        threshold: float,
    ) -> None:
        self._pieces, self._maker, self._joined, self._threshold = pieces, maker, joined, threshold
        self._rules, self._finest = rules, finest
        self._coarse = [name for name in joined if rules[name] is not finest[name]]
        # What refining needs is loaded now, and not in the middle of a run.
        importlib.import_module("scipy.sparse.linalg")
        bears = {name: maker.scene.capacity(name) for name in self._coarse}
        self._weights = {name: (1.0 / c.N_max, 1.0 / c.Q_max, 1.0 / c.M_yield) for name, c in bears.items()}
        self._watched: list[_Watched] | None = None

    def refine(self, members: Collection[str]) -> tuple[tuple[str, ...], dict[Structure, Structure]]:
        """Refine what bears more than the threshold, and coarse ones among ``members``.

        Returns the names of those that were refined, and which structure took which one's place.
        """
        wanted = dict.fromkeys((*self._due(), *(name for name in self._coarse if name in members)))
        due = [cut for cut in map(self._cut, wanted) if cut is not None]
        if not due:
            return (), {}
        self._coarse = [name for name in self._coarse if name not in {cut.member for cut in due}]
        heirs = {joint: heir for cut in due for joint, heir in cut.heirs.items()}
        instead = {cut.gone[0]: list(cut.heirs) for cut in due}
        gone = {joint for cut in due for joint in cut.gone}
        followers = {}
        for old in dict.fromkeys(joint.structure for joint in instead):
            assert old is not None
            joints = [new for joint in old.joints for new in instead.get(joint, [] if joint in gone else [joint])]
            followers[old] = succeed(old, joints, heirs, sum(cut.work for cut in due if cut.gone[0].structure is old))
        self._watched = None
        return tuple(cut.member for cut in due), followers

    def _due(self) -> list[str]:
        """Coarse members that bear more than the threshold in any joint."""
        if self._watched is None or any(own.structure.superseded for own in self._watched):
            self._watched = self._watch()
        due: dict[str, None] = {}
        for own in self._watched:
            N, Q, M = (np.abs(own.structure.force[own.rows]) * own.weights).T
            for row in np.flatnonzero(np.maximum(N + M, Q) > self._threshold):
                due[own.members[row]] = None
        return list(due)

    def _watch(self) -> list[_Watched]:
        """The joints of the coarse members, by their structures."""
        joints = [(own[0], name) for name in self._coarse for own in self._joined[name] if own is not None]
        watched = []
        for structure in dict.fromkeys(joint.structure for joint, _ in joints):
            if structure is not None and not structure.superseded:  # a broken joint stays with the one that it broke in
                rows, members = zip(*((j.index, name) for j, name in joints if j.structure is structure), strict=True)
                weights = np.array([self._weights[name] for name in members])
                watched.append(_Watched(structure, np.array(rows), weights, members))
        return watched

    def _cut(self, name: str) -> Recut | None:
        """Cut one member anew; None when it has come apart, or something else is joined to its pieces."""
        there = set(self._pieces.space.constraints)
        old = [own[0] if own is not None and own[0] in there else None for own in self._joined[name]]
        gone = [joint for joint in old if joint is not None]
        strangers = {joint for piece in self._pieces.of[name] for joint in piece.body.constraints} - set(gone)
        if not gone or None in old[1:-1] or strangers:
            return None
        cut = recut(name, self._pieces, self._maker, old, self._rules[name], self._finest[name])
        if cut is not None:
            # An end that broke stays on the member's list, broken.
            self._joined[name] = [
                new if new is not None or i not in (0, len(cut.joined) - 1) else self._joined[name][0 if i == 0 else -1]
                for i, new in enumerate(cut.joined)
            ]
        return cut
