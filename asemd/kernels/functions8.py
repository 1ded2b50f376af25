"""Exponentials, logarithms and sines of vectors of eight doubles (`asemd.kernels.vectors8`), for kernels that no compiler vectorises.

Formulas and errors are those of `asemd.kernels.vector_math`, except for the sine, which has its own: 2 units of the last digit.
"""
from __future__ import annotations

import numpy as np
from numba import config

from asemd.kernels.vectors8 import below8, larger8, madd8, smaller8

NAMES = "nearest8", "parts8", "power8"

if config.DISABLE_JIT:
    nearest8 = np.rint

    def power8(k):
        """2^k for whole numbers `k` in the range of normal numbers."""
        return np.exp2(k)

    def parts8(x):
        """The whole numbers k and the m of x = m 2^k, m from sqrt(1/2) to sqrt(2), for normal x > 0."""
        m, k = np.frexp(x)
        low = m < 0.7071067811865476
        return k - np.where(low, 1.0, 0.0), m * np.where(low, 2.0, 1.0)
else:
    from llvmlite import ir
    from numba import types
    from numba.extending import intrinsic

    from asemd.kernels.gather import I64, OCT
    from asemd.kernels.vectors8 import DOUBLES, LANES, _calls

    IMAGE = ir.VectorType(I64, LANES)
    DIGITS, BIAS, HALF = 52, 1023, 0x3FE6A09E667F3BCD      # of doubles; sqrt(1/2) as a whole number

    def _same(number, kind=IMAGE):
        return ir.Constant(kind, [number] * LANES)

    @intrinsic
    def nearest8(typing, x):
        """The nearest whole numbers, as doubles."""
        return DOUBLES(DOUBLES), lambda ctx, builder, sig, args: _calls(builder, "llvm.rint.v8f64", OCT, args)

    @intrinsic
    def power8(typing, k):
        """2^k for whole numbers `k` in the range of normal numbers."""
        def generate(ctx, builder, sig, args):      # 1.5 2^52 holds small whole numbers in its last bits; the shift drops the rest
            image = builder.bitcast(builder.fadd(args[0], _same(1.5 * 2.0**DIGITS, OCT)), IMAGE)
            return builder.bitcast(builder.add(builder.shl(image, _same(DIGITS)), _same(BIAS << DIGITS)), OCT)
        return DOUBLES(DOUBLES), generate

    @intrinsic
    def parts8(typing, x):
        """The whole numbers k and the m of x = m 2^k, m from sqrt(1/2) to sqrt(2), for normal x > 0."""
        def generate(ctx, builder, sig, args):
            image = builder.add(builder.bitcast(args[0], IMAGE), _same((BIAS << DIGITS) - HALF))
            k = builder.or_(builder.lshr(image, _same(DIGITS)), _same((BIAS + DIGITS) << DIGITS))
            m = builder.add(builder.and_(image, _same((1 << DIGITS) - 1)), _same(HALF))
            k = builder.fsub(builder.bitcast(k, OCT), _same(2.0**DIGITS + BIAS, OCT))
            return ctx.make_tuple(builder, sig.return_type, [k, builder.bitcast(m, OCT)])
        return types.UniTuple(DOUBLES, 2)(DOUBLES), generate


def exp8(x):
    """e^x: 0 below -708, e^709.4 above 709.4."""
    y = smaller8(709.4, larger8(-708.0, x))
    k = nearest8(y * 1.4426950408889634)
    r = madd8(k, -1.90821492927058770002e-10, madd8(k, -6.93147180369123816490e-01, y))
    p = madd8(r, 1.6059043836821613e-10, 2.08767569878681e-09)
    p = madd8(p, r, 2.505210838544172e-08)
    p = madd8(p, r, 2.755731922398589e-07)
    p = madd8(p, r, 2.7557319223985893e-06)
    p = madd8(p, r, 2.48015873015873e-05)
    p = madd8(p, r, 0.0001984126984126984)
    p = madd8(p, r, 0.001388888888888889)
    p = madd8(p, r, 0.008333333333333333)
    p = madd8(p, r, 0.041666666666666664)
    p = madd8(p, r, 0.16666666666666666)
    p = madd8(p, r, 0.5)
    return below8(x, -708.0, 0.0, (madd8(r * r, p, r) + 1.0) * power8(k))


def log8(x):
    """Natural logarithms of normal numbers above 0."""
    k, m = parts8(x)
    f = m - 1.0
    s = f / (f + 2.0)
    z = s * s
    p = madd8(z, 0.09523809523809523, 0.10526315789473684)
    p = madd8(p, z, 0.11764705882352941)
    p = madd8(p, z, 0.13333333333333333)
    p = madd8(p, z, 0.15384615384615385)
    p = madd8(p, z, 0.18181818181818182)
    p = madd8(p, z, 0.2222222222222222)
    p = madd8(p, z, 0.2857142857142857)
    p = madd8(p, z, 0.4)
    p = madd8(p, z, 0.6666666666666666)
    h = 0.5 * f * f
    return madd8(k, 6.93147180369123816490e-01, f - (h - madd8(s, madd8(p, z, h), k * 1.90821492927058770002e-10)))


def sine8(x):
    """Sines for abs(x) <= pi/2, by their Taylor series."""
    z = x * x
    p = madd8(z, -3.868170170630684e-23, 1.9572941063391263e-20)
    p = madd8(p, z, -8.22063524662433e-18)
    p = madd8(p, z, 2.8114572543455206e-15)
    p = madd8(p, z, -7.647163731819816e-13)
    p = madd8(p, z, 1.6059043836821613e-10)
    p = madd8(p, z, -2.505210838544172e-08)
    p = madd8(p, z, 2.7557319223985893e-06)
    p = madd8(p, z, -0.0001984126984126984)
    p = madd8(p, z, 0.008333333333333333)
    p = madd8(p, z, -0.16666666666666666)
    return madd8(x * z, p, x)


FUNCTIONS = exp8, log8, sine8
