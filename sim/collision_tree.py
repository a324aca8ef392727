"""Chipmunk's two trees of shapes, one for what moves and one for what does not: read, and put back.

A tree's inner order follows from all it has been through. By it Chipmunk comes upon pairs of shapes in one order or
another, and its solver takes contacts in that order; where each search for the nearest features begins is kept in the
pairs, too. So a run goes on to the last bit only where both trees are what they were. Here they are numbers that
know shapes by their place in a list, and hold no address.

Offsets are in 8-byte words, as in `sim.chipmunk`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pymunk

from capacity import InputError
from sim.chipmunk import words
from sim.installed import check, is_address
from sim.tree_fields import (
    ABOVE,
    AFTER,
    BEFORE,
    BIN_WORDS,
    BOX,
    CHANGED,
    FEATURES,
    FIRST,
    HALF,
    HASH,
    HELD,
    KIND,
    LEAF,
    LEAVES,
    NEXT,
    NODE_WORDS,
    PAIR_POOL,
    PAIR_WORDS,
    PAIRS,
    ROOT,
    SECOND,
    SET_WORDS,
    SHAPE,
    SIZES,
    STAMP,
    TABLE,
    TREE_WORDS,
    bins_of,
    leaves_of,
    nodes_of,
    pairs_of,
    shape_address,
    tree_addresses,
    tree_kind,
    word_at,
)


@dataclass(frozen=True)
class _Tree:
    """One tree; shapes by their place in the list.

    Attributes
    ----------
    stamp : int
    lists : int
        Of the set of leaves.
    leaves : list of int
        In the order in which Chipmunk goes through the set.
    nodes : list of int
        From the root on, first branches first; -1 within the tree.
    boxes : (n, 4) float
        Of the nodes.
    """

    stamp: int
    lists: int
    leaves: list[int]
    nodes: list[int]
    boxes: np.ndarray


@dataclass(frozen=True)
class CollisionTrees:
    """Both trees of a space, the pairs of shapes that are near each other, and the numbers that shapes are known by.

    Attributes
    ----------
    trees : (static, dynamic)
    numbers : list of int
        Chipmunk's number of each shape.
    changed : list of int
        When each shape's leaf last changed.
    pairs : list of (first, second, features)
        Places of two shapes, and of the features that were nearest.
    near : list of list of int
        Pairs of each shape, in their order.
    """

    trees: tuple[_Tree, _Tree]
    numbers: list[int]
    changed: list[int]
    pairs: list[tuple[int, int, int]]
    near: list[list[int]]

    @classmethod
    def of(cls, space: pymunk.Space, shapes: Sequence[pymunk.Shape]) -> CollisionTrees:
        """Those of ``space``, whose shapes are all listed.

        Raises
        ------
        InputError
            When it uses a spatial hash.
        """
        at = tree_addresses(space)
        if any(word_at(tree, KIND) != tree_kind() for tree in at):
            fault = "it uses a spatial hash, of which pymunk saves nothing, so it would not go on as it was"
            raise InputError("space", fault, "make it without use_spatial_hash()")
        place = {shape_address(shape): i for i, shape in enumerate(shapes)}
        leaves = {place[word_at(leaf, SHAPE)]: leaf for tree in at for leaf in leaves_of(tree)}
        pairs: dict[int, int] = {}
        near = [[pairs.setdefault(p, len(pairs)) for p in pairs_of(leaves[i])] for i in range(len(shapes))]
        return cls(
            (_read_tree(at[0], place), _read_tree(at[1], place)),
            [shape._hashid for shape in shapes],
            [word_at(leaves[i], CHANGED) & HALF for i in range(len(shapes))],
            [_read_pair(pair, place) for pair in pairs],
            near,
        )

    def restore(self, space: pymunk.Space, shapes: Sequence[pymunk.Shape]) -> None:
        """Put them back to a space with the same shapes, each in the tree that it was in."""
        self._make_room(space)
        at = tree_addresses(space)
        leaves = {word_at(leaf, SHAPE): leaf for tree in at for leaf in leaves_of(tree)}
        leaf_of = [leaves[shape_address(shape)] for shape in shapes]
        free = self._free_pairs(at, leaf_of)
        for shape, number in zip(shapes, self.numbers, strict=True):
            shape._hashid = number
        for tree, saved in zip(at, self.trees, strict=True):
            _write_set(tree, saved, [leaf_of[i] for i in saved.leaves], [self.numbers[i] for i in saved.leaves])
            _write_tree(tree, saved, leaf_of)
        for leaf, changed in zip(leaf_of, self.changed, strict=True):
            words(leaf, NODE_WORDS, np.int64)[CHANGED] = changed
        self._write_pairs(leaf_of, free[: len(self.pairs)])
        pool = 0
        for pair in free[len(self.pairs) :]:
            words(pair, PAIR_WORDS, np.int64)[AFTER[0]] = pool
            pool = pair
        words(at[1], TREE_WORDS, np.int64)[PAIR_POOL] = pool

    def _make_room(self, space: pymunk.Space) -> None:
        """Have Chipmunk allocate what is lacking, by shapes in one place that are added and taken out again."""
        at = tree_addresses(space)
        for tree, saved, kind in zip(at, self.trees, (pymunk.Body.STATIC, pymunk.Body.KINEMATIC), strict=True):
            lists = word_at(word_at(tree, LEAVES), SIZES) >> 32
            lacking = saved.lists - sum(1 for _ in leaves_of(tree)) if lists < saved.lists else 0
            if kind == pymunk.Body.KINEMATIC:
                # As many as pair with each other often enough.
                lacking = max(lacking, 2 + int((2.0 * len(self.pairs)) ** 0.5))
            body = pymunk.Body(body_type=kind)
            circles = [pymunk.Circle(body, 1.0) for _ in range(lacking)]
            space.add(body, *circles)
            space.remove(*circles, body)

    def _free_pairs(self, at: tuple[int, int], leaf_of: Sequence[int]) -> list[int]:
        """Addresses of all pairs that there are, in use or not."""
        found = dict.fromkeys(pair for leaf in leaf_of for pair in pairs_of(leaf))
        pair = word_at(at[1], PAIR_POOL)
        while pair:
            found[pair] = None
            pair = word_at(pair, AFTER[0])
        return list(found)

    def _write_pairs(self, leaf_of: Sequence[int], where: Sequence[int]) -> None:
        for pair, (first, second, features) in zip(where, self.pairs, strict=True):
            w = words(pair, PAIR_WORDS, np.int64)
            w[:] = 0
            w[LEAF[0]], w[LEAF[1]], w[FEATURES] = leaf_of[first], leaf_of[second], features
        for leaf, listed in zip(leaf_of, self.near, strict=True):
            chain = [where[k] for k in listed]
            words(leaf, NODE_WORDS, np.int64)[PAIRS] = chain[0] if chain else 0
            for before, pair, after in zip([0, *chain], chain, [*chain[1:], 0], strict=False):
                w = words(pair, PAIR_WORDS, np.int64)
                side = 0 if w[LEAF[0]] == leaf else 1
                w[BEFORE[side]], w[AFTER[side]] = before, after


def verify() -> None:
    """Check the offsets against the installed pymunk, with two shapes that are near each other and one far away.

    Raises
    ------
    IncompatiblePymunk
        When something is not where it is expected.
    """
    space, bodies = pymunk.Space(), [pymunk.Body(1.0, 1.0) for _ in range(2)]
    shapes: list[pymunk.Shape] = [pymunk.Poly.create_box(body) for body in bodies]
    shapes.append(pymunk.Circle(space.static_body, 1.0, (30.0, 30.0)))
    bodies[1].position, bodies[1].angle = (11.5, 0.0), 0.5
    space.add(*bodies, *shapes)
    for _ in range(2):
        space.step(1.0)
    found = [
        {word_at(at, HELD): word_at(at, HASH) for at in bins_of(tree)} if _is_whole(tree, count) else {}
        for tree, count in zip(tree_addresses(space), (1, 2), strict=True)
    ]
    known = {word_at(leaf, SHAPE): number for tree in found for leaf, number in tree.items()}
    check(known == {shape_address(shape): shape._hashid for shape in shapes})
    trees = CollisionTrees.of(space, shapes)
    check(trees is not None)
    assert trees is not None
    check([sorted(pair[:2]) for pair in trees.pairs] == [[0, 1]] and trees.pairs[0][2] > 0)
    check(trees.near == [[0], [0], []] and [tree.nodes[0] for tree in trees.trees] == [2, -1])
    check(all(tree.boxes[0, 0] < tree.boxes[0, 2] for tree in trees.trees))


def _is_whole(tree: int, count: int) -> bool:
    """Whether there is a set of so many leaves where there should be."""
    held = word_at(tree, LEAVES)
    if not is_address(held):
        return False
    sizes = word_at(held, SIZES)
    return sizes & HALF == count and count <= sizes >> 32 < 1000


def _read_pair(pair: int, place: dict[int, int]) -> tuple[int, int, int]:
    w = words(pair, PAIR_WORDS, np.int64)
    first, second = (place[word_at(int(w[leaf]), SHAPE)] for leaf in LEAF)
    return first, second, int(w[FEATURES]) & HALF


def _read_tree(tree: int, place: dict[int, int]) -> _Tree:
    nodes = nodes_of(tree)
    boxes = [words(node, NODE_WORDS)[BOX].copy() for node in nodes]
    return _Tree(
        word_at(tree, STAMP) & HALF,
        word_at(word_at(tree, LEAVES), SIZES) >> 32,
        [place[word_at(leaf, SHAPE)] for leaf in leaves_of(tree)],
        [place.get(word_at(node, SHAPE), -1) for node in nodes],
        np.array(boxes).reshape(-1, 4),
    )


def _write_set(tree: int, saved: _Tree, leaves: Sequence[int], numbers: Sequence[int]) -> None:
    """Put the leaves into as many lists as there were, in their order; Chipmunk may have room for more."""
    bins, held = bins_of(tree), words(word_at(tree, LEAVES), SET_WORDS, np.int64)
    held[SIZES] = len(leaves) | saved.lists << 32
    table = words(int(held[TABLE]), saved.lists, np.int64)
    table[:] = 0
    last: dict[int, int] = {}
    for at, leaf, number in zip(bins, leaves, numbers, strict=True):
        words(at, BIN_WORDS, np.int64)[:] = leaf, number, 0
        index = number % saved.lists
        if index in last:
            words(last[index], BIN_WORDS, np.int64)[NEXT] = at
        else:
            table[index] = at
        last[index] = at


def _write_tree(tree: int, saved: _Tree, leaf_of: Sequence[int]) -> None:
    """Link the nodes anew."""
    inner = [node for node in nodes_of(tree) if word_at(node, SHAPE) == 0]
    nodes = [leaf_of[i] if i >= 0 else inner.pop() for i in saved.nodes]
    # Nodes whose branches are still to come.
    above: list[int] = []
    for node, shape, box in zip(nodes, saved.nodes, saved.boxes, strict=True):
        words(node, NODE_WORDS)[BOX] = box
        w = words(node, NODE_WORDS, np.int64)
        w[ABOVE] = above[-1] if above else 0
        if above:
            parent = words(above[-1], NODE_WORDS, np.int64)
            if parent[FIRST] == 0:
                parent[FIRST] = node
            else:
                parent[SECOND] = node
                above.pop()
        if shape < 0:
            w[FIRST], w[SECOND] = 0, 0
            above.append(node)
    words(tree, TREE_WORDS, np.int64)[[ROOT, STAMP]] = nodes[0] if nodes else 0, saved.stamp
