"""Arrays over memory that is known by its address: how compiled functions see Chipmunk's structs and each other.

Chipmunk hands a constraint function two plain numbers, and a law is called through its address; everything they work
on is reached by pointers kept in int64 tables.

Compiling is most of what the first start of a simulation takes, so what every kernel is full of is made cheap for
Numba: arrays come from intrinsics, which it does not have to analyse, and no wrappers for Python are made.
"""

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic
from numba.np.arrayobj import make_array, populate_array

_OPTIONS: dict[str, Any] = {"error_model": "numpy", "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
#: Compiles a function that only compiled functions call.
kernel = njit(forceinline=False, **_OPTIONS)
#: Compiles a function into those that call it: what is called in one place only, or for every joint or body. A call
#: takes some fifty instructions.
inlined = njit(forceinline=True, **_OPTIONS)

WORD = ir.IntType(64)


def array_at(context: Any, builder: Any, kind: types.Array, address: Any, shape: list[Any]) -> Any:
    """Code for an array of the type ``kind`` over the memory at ``address``; ``shape`` has one or two numbers."""
    array = make_array(kind)(context, builder)
    data = builder.inttoptr(address, context.get_data_type(kind.dtype).as_pointer())
    strides = [builder.mul(columns, WORD(8)) for columns in shape[1:]] + [WORD(8)]
    populate_array(array, data=data, shape=shape, strides=strides, itemsize=WORD(8), meminfo=None)
    return array._getvalue()


def _of(kind: types.Type) -> Callable[..., Any]:
    """A function that gives so many numbers of the type ``kind`` at an address."""

    @intrinsic
    def view(typing_context, address, count):  # type: ignore[no-untyped-def]
        def generate(context, builder, signature, args):  # type: ignore[no-untyped-def]
            return array_at(context, builder, signature.return_type, args[0], [args[1]])

        return types.Array(kind, 1, "C")(types.int64, types.int64), generate

    return view  # type: ignore[no-any-return]


#: Of an address and a number: so many float64, or int64, there.
floats, integers = _of(types.float64), _of(types.int64)


@intrinsic
def call_law(typing_context, function, parameters, state, deformation, out):  # type: ignore[no-untyped-def]
    """Call the C function at ``function`` with four addresses."""

    def generate(context, builder, signature, args):  # type: ignore[no-untyped-def]
        kind = ir.FunctionType(ir.VoidType(), [WORD] * 4)
        pointer = builder.inttoptr(args[0], kind.as_pointer())
        builder.call(pointer, args[1:])
        return context.get_dummy_value()

    return types.void(*[types.int64] * 5), generate


@intrinsic
def call_notice(typing_context, function, key):  # type: ignore[no-untyped-def]
    """Call the C function at ``function`` with one integer."""

    def generate(context, builder, signature, args):  # type: ignore[no-untyped-def]
        pointer = builder.inttoptr(args[0], ir.FunctionType(ir.VoidType(), [WORD]).as_pointer())
        builder.call(pointer, args[1:])
        return context.get_dummy_value()

    return types.void(types.int64, types.int64), generate


@intrinsic
def call_constraint(typing_context, function, constraint, h):  # type: ignore[no-untyped-def]
    """Call the C function at ``function`` with the address of a constraint and a number."""

    def generate(context, builder, signature, args):  # type: ignore[no-untyped-def]
        pointer = builder.inttoptr(args[0], ir.FunctionType(ir.VoidType(), [WORD, ir.DoubleType()]).as_pointer())
        builder.call(pointer, args[1:])
        return context.get_dummy_value()

    return types.void(types.int64, types.int64, types.float64), generate


@intrinsic
def call_post_solve(typing_context, function, constraint, space):  # type: ignore[no-untyped-def]
    """Call the C function at ``function`` with the addresses of a constraint and of its space."""

    def generate(context, builder, signature, args):  # type: ignore[no-untyped-def]
        pointer = builder.inttoptr(args[0], ir.FunctionType(ir.VoidType(), [WORD] * 2).as_pointer())
        builder.call(pointer, args[1:])
        return context.get_dummy_value()

    return types.void(*[types.int64] * 3), generate


#: Signature of both functions of a law: parameters, state, deformation, out.
LAW_SIGNATURE = types.void(types.int64, types.int64, types.int64, types.int64)
