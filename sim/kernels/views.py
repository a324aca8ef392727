"""The arrays of a structure: functions of its control table, a bare array each (`bare`).

Every kernel begins with some of them, so they are intrinsics: a few instructions where they are called, and nothing
for Numba to analyse.
"""

from collections.abc import Callable
from typing import Any

from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from sim.kernels import layout as at
from sim.kernels.bare import Bare, bare_at
from sim.memory import WORD, array_at

_FLOATS, _INTEGERS = types.float64, types.int64


def _word(context: Any, builder: Any, signature: Any, args: Any, index: Any) -> Any:
    """Code that reads a word of a control table, the first of ``args``."""
    data = cgutils.create_struct_proxy(signature.args[0])(context, builder, args[0]).data
    return builder.load(builder.gep(data, [index]))


def _of(kind: Bare, address: int, rows: int) -> Callable[..., Any]:
    """The array whose address is at the word ``address``, with as many rows as the word ``rows`` says."""

    @intrinsic
    def view(typing_context, t):  # type: ignore[no-untyped-def]
        def generate(context, builder, signature, args):  # type: ignore[no-untyped-def]
            start, count = (_word(context, builder, signature, args, WORD(word)) for word in (address, rows))
            return bare_at(context, builder, kind, start, count)

        return kind(t), generate

    return view  # type: ignore[no-any-return]


def _vector(address: int, rows: int, kind: types.Type = _FLOATS) -> Callable[..., Any]:
    """An array of one dimension."""
    return _of(Bare(kind), address, rows)


def _matrix(address: int, rows: int, columns: int, kind: types.Type = _FLOATS) -> Callable[..., Any]:
    """One with ``columns`` columns."""
    return _of(Bare(kind, columns), address, rows)


def _fixed(address: int, count: int, kind: types.Type = _FLOATS) -> Callable[..., Any]:
    """One of ``count`` entries, whose address is at the word ``address``."""

    @intrinsic
    def view(typing_context, t):  # type: ignore[no-untyped-def]
        def generate(context, builder, signature, args):  # type: ignore[no-untyped-def]
            start = _word(context, builder, signature, args, WORD(address))
            return bare_at(context, builder, signature.return_type, start, WORD(count))

        return Bare(kind)(t), generate

    return view  # type: ignore[no-any-return]


def _triples(rows: int) -> Callable[..., Any]:
    """Any array of floats with three columns, by the word of its address; the word ``rows`` says how many there are."""

    @intrinsic
    def view(typing_context, t, address):  # type: ignore[no-untyped-def]
        def generate(context, builder, signature, args):  # type: ignore[no-untyped-def]
            start, count = (_word(context, builder, signature, args, word) for word in (args[1], WORD(rows)))
            return bare_at(context, builder, signature.return_type, start, count)

        return Bare(_FLOATS, 3)(t, types.int64), generate

    return view  # type: ignore[no-any-return]


def _numpy_matrix(address: int, rows: int, columns: int, kind: types.Type = _FLOATS) -> Callable[..., Any]:
    """As `_matrix`, but an array of numpy's, as those are that contacts of several structures are gathered in."""

    @intrinsic
    def view(typing_context, t):  # type: ignore[no-untyped-def]
        def generate(context, builder, signature, args):  # type: ignore[no-untyped-def]
            start, count = (_word(context, builder, signature, args, WORD(word)) for word in (address, rows))
            return array_at(context, builder, signature.return_type, start, [count, WORD(columns)])

        return types.Array(kind, 2, "C")(t), generate

    return view  # type: ignore[no-any-return]


@intrinsic
def control(typing_context, address):  # type: ignore[no-untyped-def]
    """Control table at an address."""

    def generate(context, builder, signature, args):  # type: ignore[no-untyped-def]
        return bare_at(context, builder, signature.return_type, args[0], WORD(at.CONTROL_WORDS))

    return Bare(_INTEGERS)(types.int64), generate


per_joint = _triples(at.JOINTS)
per_body = _triples(at.BODIES)

body_at = _vector(at.BODY_AT, at.BODIES, _INTEGERS)
joint_at = _vector(at.JOINT_AT, at.JOINTS, _INTEGERS)
joint_bodies = _matrix(at.JOINT_BODIES, at.JOINTS, 2, _INTEGERS)
joint_slot = _vector(at.JOINT_SLOT, at.JOINTS, _INTEGERS)
active = _vector(at.ACTIVE, at.JOINTS, _INTEGERS)
laws = _matrix(at.LAWS, at.JOINTS, 5, _INTEGERS)
geometry = _matrix(at.GEOMETRY, at.JOINTS, at.GEOMETRY_WORDS)
stiffness = _matrix(at.STIFFNESS, at.JOINTS, 6)
damping = _matrix(at.DAMPING, at.JOINTS, 3)
limits = _matrix(at.LIMITS, at.JOINTS, at.LIMITS_WORDS)
scale = _vector(at.SCALE, at.JOINTS)
gradient = _matrix(at.GRADIENT, at.JOINTS, at.GRADIENT_WORDS)
response = _matrix(at.RESPONSE, at.JOINTS, at.RESPONSE_WORDS)
result = _matrix(at.RESULT, at.JOINTS, at.RESULT_WORDS)

shift = _matrix(at.SHIFT, at.BODIES, 6)
weight = _matrix(at.WEIGHT, at.MOVING, at.WEIGHT_WORDS)

# One more than there are moving bodies: where the last column ends.
column_start = _vector(at.COLUMN_START, at.MOVING, _INTEGERS)
column_rows = _vector(at.COLUMN_ROWS, at.LOWER, _INTEGERS)
# As many as the factor fills in, which the kernels do not need to know.
fill_targets = _fixed(at.FILL_TARGETS, 1, _INTEGERS)
diagonal = _matrix(at.DIAGONAL, at.MOVING, 9)
lower = _matrix(at.LOWER_BLOCKS, at.LOWER, 9)
# Of as many rows as it takes, which the kernels do not need to know.
column = _matrix(at.COLUMN, at.LOWER, 9)

settings = _fixed(at.SETTINGS, at.SETTINGS_WORDS)
ledger = _fixed(at.LEDGER, at.LEDGER_WORDS)

abutting = _vector(at.ABUTTING_PAIRS, at.ABUTTING, _INTEGERS)

places = _numpy_matrix(at.PLACES, at.ROOM, at.PLACE_WORDS, _INTEGERS)
touches = _numpy_matrix(at.TOUCHES, at.ROOM, at.TOUCH_WORDS)
