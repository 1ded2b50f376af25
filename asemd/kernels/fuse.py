"""Multiply and add in one rounding where the processor can: a b + c that the compiler cannot split again. Roots by rough estimates."""
from __future__ import annotations

from numba import config

if config.DISABLE_JIT:
    def madd(a, b, c):
        """``a * b + c``."""
        return a * b + c

    def rough_roots():
        """Nothing: roots are whole."""
else:
    import platform

    from llvmlite import ir
    from numba import types
    from numba.extending import intrinsic

    @intrinsic
    def madd(context, a, b, c):
        """``a * b + c``, fused if the target has such an instruction; all three of one float type."""
        def generate(ctx, builder, signature, arguments):
            kind = arguments[0].type
            function = builder.module.declare_intrinsic("llvm.fmuladd", [kind], ir.FunctionType(kind, [kind] * 3))
            return builder.call(function, arguments)
        return (a(a, a, a), generate) if a == b == c else None

    @intrinsic
    def rough_roots(context):
        """Let estimates of 1 / sqrt(x) in single precision be as the processor gives them in the function that says so, with eleven bits
        or more: LLVM adds a step that doubles them. Only where estimates are known to have that many bits."""
        def generate(ctx, builder, signature, arguments):
            if platform.machine().lower() in ("x86_64", "amd64"):
                # `add` of llvmlite knows attributes without values only
                set.add(builder.function.attributes, '"reciprocal-estimates"="sqrtf:0,vec-sqrtf:0"')
            return ctx.get_dummy_value()
        return types.void(), generate
