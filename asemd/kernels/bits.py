"""Exponents of floating-point numbers taken apart and put together without calls, in forms that compilers turn into vector code.

Each function is plain Python for uncompiled use and an intrinsic in compiled code, for double and single precision. No step relies on the
order of additions, so callers may be compiled with any fastmath flags.
"""
from __future__ import annotations

import math
import struct

import numpy as np
from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic, overload


def nearest_integer(x):
    """The nearest whole number, as a float."""
    return np.rint(x)


def within(x, low, high):
    """`x`, or the end of the interval that it is beyond; what is not a number stays so.

    As conditional expressions the two steps become branches, for the compiler follows the constants, and loops are no vector code.
    """
    return low if x < low else high if x > high else x


def power_of_two(k):
    """2^k for a whole number `k` within the range of normal numbers."""
    return math.ldexp(1.0, int(k)) if k == k else k


def exponent(x):
    """The whole number k (as a float) with x = m 2^k, m from sqrt(1/2) to sqrt(2), for normal x > 0."""
    m, k = math.frexp(x)
    return k - 1.0 if m < 0.7071067811865476 else float(k)


def significand(x):
    """The m of `exponent`."""
    return math.ldexp(x, -int(exponent(x)))


def upper_half(x):
    """`x` with the lower half of its digits cut off: its square is exact."""
    if isinstance(x, np.float32):
        return np.float32(struct.unpack("<f", struct.pack("<I", struct.unpack("<I", struct.pack("<f", x))[0] & ~0xFFF))[0])
    return struct.unpack("<d", struct.pack("<Q", struct.unpack("<Q", struct.pack("<d", x))[0] & ~0x7FFFFFF))[0]


def _layout(kind):
    """LLVM types, digits after the point, exponent bias, and the integer image of sqrt(1/2)."""
    if kind == types.float32:
        return ir.FloatType(), ir.IntType(32), 23, 127, 0x3F3504F3
    return ir.DoubleType(), ir.IntType(64), 52, 1023, 0x3FE6A09E667F3BCD


def _make(python, emit):
    """Compile `python` as the instructions that `emit(builder, x, real, whole, digits, bias, half)` writes."""
    @intrinsic
    def compiled(typingctx, x):
        kind = types.float32 if x == types.float32 else types.float64
        return kind(kind), lambda context, builder, signature, args: emit(builder, args[0], *_layout(kind))

    @overload(python, inline="always")
    def use(x):
        return lambda x: compiled(x)


def _nearest(b, x, real, whole, digits, bias, half):
    return b.call(b.module.declare_intrinsic("llvm.rint", [real]), [x])


def _power(b, k, real, whole, digits, bias, half):
    # 1.5 2^digits holds small whole numbers in its last bits; the shift drops the rest
    magic = real(1.5 * 2.0**digits)
    image = b.shl(b.bitcast(b.fadd(k, magic), whole), whole(digits))
    return b.bitcast(b.add(image, whole(bias << digits)), real)


def _exponent(b, x, real, whole, digits, bias, half):
    image = b.add(b.bitcast(x, whole), whole((bias << digits) - half))
    image = b.or_(b.lshr(image, whole(digits)), whole((bias + digits) << digits))
    return b.fsub(b.bitcast(image, real), real(2.0**digits + bias))


def _significand(b, x, real, whole, digits, bias, half):
    image = b.add(b.bitcast(x, whole), whole((bias << digits) - half))
    return b.bitcast(b.add(b.and_(image, whole((1 << digits) - 1)), whole(half)), real)


def _upper(b, x, real, whole, digits, bias, half):
    return b.bitcast(b.and_(b.bitcast(x, whole), whole(~((1 << (digits + 2) // 2) - 1))), real)


@intrinsic
def _within(typingctx, x, low, high):
    kind = types.float32 if x == types.float32 else types.float64

    def generate(context, builder, signature, values):
        x, low, high = values
        x = builder.select(builder.fcmp_ordered("<", x, low), low, x)
        return builder.select(builder.fcmp_ordered(">", x, high), high, x)
    return kind(kind, kind, kind), generate


@overload(within, inline="always")
def _use_within(x, low, high):
    return lambda x, low, high: _within(x, low, high)


for _python, _emit in ((nearest_integer, _nearest), (power_of_two, _power), (exponent, _exponent), (significand, _significand),
                       (upper_half, _upper)):
    _make(_python, _emit)
