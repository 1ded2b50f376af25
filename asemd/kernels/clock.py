"""A clock compiled code can read: seconds, monotonic, about 30 ns a look."""
from __future__ import annotations

import sys
import time

from llvmlite import ir
from numba import config, types
from numba.core import cgutils
from numba.extending import intrinsic

from asemd.kernels.target import njit

_MONOTONIC = 6 if sys.platform == "darwin" else 1


@intrinsic
def _clock(context):
    def generate(context, builder, signature, arguments):
        pair = ir.LiteralStructType([ir.IntType(64), ir.IntType(64)])
        out = cgutils.alloca_once(builder, pair)
        kind = ir.FunctionType(ir.IntType(32), [ir.IntType(32), pair.as_pointer()])
        read = cgutils.get_or_insert_function(builder.module, kind, "clock_gettime")
        builder.call(read, [ir.Constant(ir.IntType(32), _MONOTONIC), out])
        seconds = builder.sitofp(builder.extract_value(builder.load(out), 0), ir.DoubleType())
        nano = builder.sitofp(builder.extract_value(builder.load(out), 1), ir.DoubleType())
        return builder.fadd(seconds, builder.fmul(nano, ir.Constant(ir.DoubleType(), 1e-9)))
    return types.float64(), generate


if config.DISABLE_JIT or sys.platform == "win32":
    now = time.perf_counter if config.DISABLE_JIT else njit(cache=True, nogil=True)(lambda: 0.0)
else:
    @njit(cache=True, nogil=True)
    def now():
        """Seconds since some fixed moment."""
        return _clock()
