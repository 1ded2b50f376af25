"""Python functions that compiled kernels call: for work that a library does, such as Fourier transforms."""
from __future__ import annotations

import ctypes
from collections.abc import Callable

from llvmlite import ir
from numba import types
from numba.extending import intrinsic, overload

from asemd.kernels import packed

_KIND = ctypes.CFUNCTYPE(None)


class Callback:
    """A Python function without arguments and its address; it must live as long as kernels may call it.

    Attributes
    ----------
    function : callable
    address : int
        What `call_back` takes; where nothing is compiled, the function itself.
    """

    def __init__(self, function: Callable[[], None]):
        self.function, self._keep = function, _KIND(function)
        self.address = function if packed.WITHOUT_COMPILER else ctypes.cast(self._keep, ctypes.c_void_p).value


def call_back(address) -> None:
    """Call the function of a `Callback`; compiled code that holds no interpreter lock takes it for the time of the call."""
    address()


@intrinsic
def _call(context, address):
    def generate(ctx, builder, signature, values):
        function = builder.inttoptr(values[0], ir.FunctionType(ir.VoidType(), []).as_pointer())
        builder.call(function, [])
        return ctx.get_dummy_value()
    return types.void(types.int64), generate


@overload(call_back, inline="always")
def _compiled(address):
    return lambda address: _call(address)
