"""Multiply and add in one rounding where the processor can: a b + c that the compiler cannot split again."""
from __future__ import annotations

from numba import config

if config.DISABLE_JIT:
    def madd(a, b, c):
        """``a * b + c``."""
        return a * b + c
else:
    from llvmlite import ir
    from numba.extending import intrinsic

    @intrinsic
    def madd(context, a, b, c):
        """``a * b + c``, fused if the target has such an instruction; all three of one float type."""
        def generate(ctx, builder, signature, arguments):
            kind = arguments[0].type
            function = builder.module.declare_intrinsic("llvm.fmuladd", [kind], ir.FunctionType(kind, [kind] * 3))
            return builder.call(function, arguments)
        return (a(a, a, a), generate) if a == b == c else None
