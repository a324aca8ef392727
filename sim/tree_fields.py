"""Chipmunk's trees of shapes as they lie in memory: where their fields are, and what hangs on what.

Offsets are in 8-byte words, as in `sim.chipmunk`.
"""

import numpy as np
import pymunk

from sim.chipmunk import SPACE_SHAPES, SPACE_WORDS, address, words

# cpBBTree: its kind, the set of its leaves, root, pools and counter of changes.
KIND, LEAVES, ROOT, PAIR_POOL, STAMP, TREE_WORDS = 0, 5, 6, 8, 10, 11
# Node: shape (none within the tree), box, node above; two below, or of a leaf when it last changed and its pairs.
SHAPE, BOX, ABOVE, FIRST, SECOND, NODE_WORDS = 0, slice(1, 5), 5, 6, 7, 8
CHANGED, PAIRS = FIRST, SECOND
# Pair: for each of its two leaves the pair before in that leaf's list, the leaf, and the pair after; then the features
# that were nearest.
BEFORE, LEAF, AFTER, FEATURES, PAIR_WORDS = (0, 3), (1, 4), (2, 5), 6, 7
# cpHashSet: how many it holds and how many lists there are, half a word each; the lists. Bin: what it holds, by which
# number, and the bin after.
SIZES, TABLE, SET_WORDS = 0, 3, 5
HELD, HASH, NEXT, BIN_WORDS = 0, 1, 2, 3
HALF = 0xFFFFFFFF


#: A space that is never anything but new.
_REFERENCE = pymunk.Space()


def tree_kind() -> int:
    """What the first word of a tree says; that of a spatial hash is another."""
    return word_at(tree_addresses(_REFERENCE)[0], KIND)


def tree_addresses(space: pymunk.Space) -> tuple[int, int]:
    """Where a space's trees lie, that of static shapes first."""
    w = words(address(space._space), SPACE_WORDS, np.int64)
    return int(w[SPACE_SHAPES]), int(w[SPACE_SHAPES + 1])


def shape_address(shape: pymunk.Shape) -> int:
    """Where a shape's struct lies."""
    return address(shape._shape)


def word_at(location: int, word: int) -> int:
    """One word of what lies at an address."""
    return int(words(location, word + 1, np.int64)[word])


def bins_of(tree: int) -> list[int]:
    """Bins of a tree's set of leaves, in the order in which Chipmunk goes through them."""
    found, held = [], word_at(tree, LEAVES)
    for first in words(word_at(held, TABLE), word_at(held, SIZES) >> 32, np.int64).tolist():
        at = first
        while at:
            found.append(at)
            at = word_at(at, NEXT)
    return found


def leaves_of(tree: int) -> list[int]:
    """A tree's leaves in the order in which Chipmunk goes through their set."""
    return [word_at(at, HELD) for at in bins_of(tree)]


def pairs_of(leaf: int) -> list[int]:
    """Pairs of a leaf, in order."""
    found, pair = [], word_at(leaf, PAIRS)
    while pair:
        found.append(pair)
        w = words(pair, PAIR_WORDS, np.int64)
        pair = int(w[AFTER[0 if w[LEAF[0]] == leaf else 1]])
    return found


def nodes_of(tree: int) -> list[int]:
    """Nodes from the root on, first branches first."""
    found, left = [], [word_at(tree, ROOT)]
    while left:
        node = left.pop()
        if node:
            found.append(node)
            if word_at(node, SHAPE) == 0:
                left += [word_at(node, SECOND), word_at(node, FIRST)]
    return found
