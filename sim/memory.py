"""Arrays over memory that is known by its address: how compiled functions see Chipmunk's structs and each other.

Chipmunk hands a constraint function two plain numbers, and a law is called through its address; everything they work
on is reached by pointers kept in int64 tables.
"""

import numpy as np
from llvmlite import ir
from numba import carray, njit, types
from numba.core import cgutils
from numba.extending import intrinsic


@intrinsic
def as_pointer(typing_context, address):  # type: ignore[no-untyped-def]
    """The int64 ``address`` as a pointer."""

    def generate(context, builder, signature, args):  # type: ignore[no-untyped-def]
        return builder.inttoptr(args[0], cgutils.voidptr_t)

    return types.voidptr(types.int64), generate


@intrinsic
def call_law(typing_context, function, parameters, state, deformation, out):  # type: ignore[no-untyped-def]
    """Call the C function at ``function`` with four addresses."""

    def generate(context, builder, signature, args):  # type: ignore[no-untyped-def]
        word = ir.IntType(64)
        kind = ir.FunctionType(ir.VoidType(), [word] * 4)
        pointer = builder.inttoptr(args[0], kind.as_pointer())
        builder.call(pointer, args[1:])
        return context.get_dummy_value()

    return types.void(*[types.int64] * 5), generate


@intrinsic
def call_notice(typing_context, function, key):  # type: ignore[no-untyped-def]
    """Call the C function at ``function`` with one integer."""

    def generate(context, builder, signature, args):  # type: ignore[no-untyped-def]
        word = ir.IntType(64)
        pointer = builder.inttoptr(args[0], ir.FunctionType(ir.VoidType(), [word]).as_pointer())
        builder.call(pointer, args[1:])
        return context.get_dummy_value()

    return types.void(types.int64, types.int64), generate


@njit(inline="always")
def floats(address, count):  # type: ignore[no-untyped-def]
    """``count`` float64 at ``address``."""
    return carray(as_pointer(address), count, np.float64)


@njit(inline="always")
def table(address, rows, columns):  # type: ignore[no-untyped-def]
    """A ``rows`` × ``columns`` float64 array at ``address``."""
    return carray(as_pointer(address), (rows, columns), np.float64)


@njit(inline="always")
def integers(address, count):  # type: ignore[no-untyped-def]
    """``count`` int64 at ``address``."""
    return carray(as_pointer(address), count, np.int64)


#: Signature of both functions of a law: parameters, state, deformation, out.
LAW_SIGNATURE = types.void(types.int64, types.int64, types.int64, types.int64)
