"""Bare arrays, as kernels hand the arrays of a structure to each other: an address and how many rows there are.

A numpy array is seven words, counts its references, and asks of every index whether it is negative; a step of a small
structure would spend a quarter of its time on that. The rows of a bare one lie without gaps, and indices count from 0.
"""

import operator
from collections.abc import Callable
from typing import Any

from numba import types
from numba.core import cgutils
from numba.core.typing import signature
from numba.core.typing.templates import AbstractTemplate, infer_global
from numba.extending import intrinsic, lower_builtin, models, register_model
from numba.np.arrayobj import make_array

from sim.memory import WORD


class Bare(types.Type):  # type: ignore[misc]
    """Type of a bare array of float64 or int64, of one dimension unless it has ``columns``."""

    def __init__(self, kind: types.Type, columns: int = 0) -> None:
        self.kind, self.columns = kind, columns
        super().__init__(f"Bare({kind}, {columns})")


@register_model(Bare)
class _Model(models.StructModel):  # type: ignore[misc]
    def __init__(self, manager: Any, kind: Bare) -> None:
        super().__init__(manager, kind, [("data", types.CPointer(kind.kind)), ("count", types.int64)])


def bare_at(context: Any, builder: Any, kind: Bare, data: Any, count: Any) -> Any:
    """Code for a bare array with ``count`` rows from a pointer or an address on."""
    array = cgutils.create_struct_proxy(kind)(context, builder)
    pointer = context.get_data_type(kind.kind).as_pointer()
    array.data = data if data.type == pointer else builder.inttoptr(data, pointer)
    array.count = count
    return array._getvalue()


def _entry(context: Any, builder: Any, signature: Any, args: Any) -> Any:
    """Pointer to where an index leads: a number, or the beginning of a row."""
    kind, index = signature.args[0], [args[1]]
    array = cgutils.create_struct_proxy(kind)(context, builder, args[0])
    if isinstance(signature.args[1], types.BaseTuple):
        index = cgutils.unpack_tuple(builder, args[1])
    if kind.columns:
        index[0] = builder.mul(index[0], WORD(kind.columns))
    place = builder.add(*index) if len(index) == 2 else index[0]
    return builder.gep(array.data, [place])


def _key(index: types.Type) -> types.Type:
    """Type of one index or two, whatever integers they are."""
    return types.UniTuple(types.int64, 2) if isinstance(index, types.BaseTuple) else types.int64


@infer_global(operator.getitem)
class _Get(AbstractTemplate):  # type: ignore[misc]
    def generic(self, args: Any, _: Any) -> Any:
        array, index = args
        if not isinstance(array, Bare):
            return None
        is_row = array.columns and not isinstance(index, types.BaseTuple)
        return signature(Bare(array.kind) if is_row else array.kind, array, _key(index))


@infer_global(operator.setitem)
class _Set(AbstractTemplate):  # type: ignore[misc]
    def generic(self, args: Any, _: Any) -> Any:
        array, index = args[:2]
        return signature(types.none, array, _key(index), array.kind) if isinstance(array, Bare) else None


@infer_global(len)
class _Length(AbstractTemplate):  # type: ignore[misc]
    def generic(self, args: Any, _: Any) -> Any:
        return signature(types.int64, *args) if isinstance(args[0], Bare) else None


@lower_builtin(operator.getitem, Bare, types.Any)  # type: ignore[untyped-decorator]
def _get(context: Any, builder: Any, signature: Any, args: Any) -> Any:
    place, kind = _entry(context, builder, signature, args), signature.return_type
    if isinstance(kind, Bare):
        return bare_at(context, builder, kind, place, WORD(signature.args[0].columns))
    return builder.load(place)


@lower_builtin(operator.setitem, Bare, types.Any, types.Any)  # type: ignore[untyped-decorator]
def _set(context: Any, builder: Any, signature: Any, args: Any) -> Any:
    builder.store(args[2], _entry(context, builder, signature, args))
    return context.get_dummy_value()


@lower_builtin(len, Bare)  # type: ignore[untyped-decorator]
def _length(context: Any, builder: Any, signature: Any, args: Any) -> Any:
    return cgutils.create_struct_proxy(signature.args[0])(context, builder, args[0]).count


def rows_of(columns: int) -> Callable[..., Any]:
    """A function that gives a bare array over a numpy array with so many columns; `hold` keeps that until then."""

    @intrinsic
    def bare(typing_context, array):  # type: ignore[no-untyped-def]
        def generate(context, builder, signature, args):  # type: ignore[no-untyped-def]
            own = make_array(signature.args[0])(context, builder, args[0])
            count = builder.extract_value(own.shape, 0)
            return bare_at(context, builder, signature.return_type, own.data, count)

        return Bare(array.dtype, columns)(array), generate

    return bare  # type: ignore[no-any-return]


@intrinsic
def hold(typing_context, one, other):  # type: ignore[no-untyped-def]
    """Keep the memory of two numpy arrays until here, for bare arrays over it."""

    def generate(context, builder, signature, args):  # type: ignore[no-untyped-def]
        return context.get_dummy_value()

    return types.void(one, other), generate


@intrinsic
def clear(typing_context, array):  # type: ignore[no-untyped-def]
    """Set all of a bare array to 0."""

    def generate(context, builder, signature, args):  # type: ignore[no-untyped-def]
        kind = signature.args[0]
        own = cgutils.create_struct_proxy(kind)(context, builder, args[0])
        size = builder.mul(own.count, WORD(8 * max(kind.columns, 1)))
        cgutils.memset(builder, own.data, size, 0)
        return context.get_dummy_value()

    return types.void(array), generate


@intrinsic
def from_column(typing_context, array, first):  # type: ignore[no-untyped-def]
    """A bare array without the columns before the ``first``."""

    def generate(context, builder, signature, args):  # type: ignore[no-untyped-def]
        kind = signature.return_type
        own = cgutils.create_struct_proxy(kind)(context, builder, args[0])
        return bare_at(context, builder, kind, builder.gep(own.data, [args[1]]), own.count)

    return array(array, types.int64), generate
