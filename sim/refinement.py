"""Members that start coarse and are cut finer once they bear much."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from sim.inheritance import succeed
from sim.joint import DuctileJoint
from sim.member_joints import Joined, MemberJoints
from sim.pieces import Pieces
from sim.recut import Recut, recut
from sim.rules import Rule
from sim.structure import Structure


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
        self._watched: list[tuple[DuctileJoint, str]] = []
        self._structures: list[Structure | None] = []
        self._rows: list[tuple[Structure, np.ndarray, np.ndarray, list[str]]] = []
        self._watch()

    def _watch(self) -> None:
        """Watch the joints of the coarse members."""
        self._watched = [(own[0], name) for name in self._coarse for own in self._joined[name] if own is not None]
        self._structures, self._rows = [], []

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
        self._watch()
        return tuple(cut.member for cut in due), followers

    def _due(self) -> list[str]:
        """Coarse members that bear more than the threshold in any joint."""
        structures = [joint.structure for joint, _ in self._watched]
        if structures != self._structures:
            self._structures, self._rows = structures, []
            for structure in dict.fromkeys(s for s in structures if s is not None):
                own = [(joint, name) for joint, name in self._watched if joint.structure is structure]
                bears = [self._maker.scene.capacity(name) for _, name in own]
                share = 1.0 / np.array([(c.N_max, c.Q_max, c.M_yield) for c in bears])
                self._rows.append((structure, np.array([j.index for j, _ in own]), share, [name for _, name in own]))
        due: dict[str, None] = {}
        for structure, rows, share, names in self._rows:
            N, Q, M = (np.abs(structure.force[rows]) * share).T
            for row in np.flatnonzero(np.maximum(N + M, Q) > self._threshold):
                due[names[row]] = None
        return list(due)

    def _cut(self, name: str) -> Recut | None:
        """Cut one member anew; None when it has come apart, or something else is joined to its pieces."""
        old = [None if own is None or own[0].broken else own[0] for own in self._joined[name]]
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
