"""Eight candidates of a cluster's neighbour list at a time: compilers copy them one by one, which takes three times as long."""
from __future__ import annotations

import numpy as np
from numba import config

if config.DISABLE_JIT:
    def copy8(b, c, d, numbers, at, x, first, px, py, pz, high):
        """Columns ``first ... first + 7`` of `x (3, n)`, shifted, into ``b[at:at + 8]``, `c` and `d`; their numbers, of at most 26 bits,
        with the bits of `high`, into `numbers`."""
        b[at:at + 8], c[at:at + 8], d[at:at + 8] = x[:, first:first + 8] + np.array([[px], [py], [pz]])
        numbers[at:at + 8] = np.arange(first, first + 8) | high
else:
    from llvmlite import ir
    from numba import types
    from numba.extending import intrinsic

    from asemd.kernels.gather import I32, I64, OCT, _Memory, _shuffle

    def _all(builder, scalar):
        one = builder.insert_element(ir.Constant(ir.VectorType(scalar.type, 8), ir.Undefined), scalar, I32(0))
        return _shuffle(builder, one, one, (0,) * 8)

    @intrinsic
    def copy8(typing, b, c, d, numbers, at, x, first, px, py, pz, high):
        """Columns ``first ... first + 7`` of `x (3, n)`, shifted, into ``b[at:at + 8]``, `c` and `d`; their numbers, of at most 26 bits,
        with the bits of `high`, into `numbers`."""
        def generate(ctx, builder, signature, arguments):
            m = _Memory(ctx, builder, signature, arguments)
            at_, first_ = m.place(4), m.place(6)
            for axis in range(3):
                v = builder.load(m.at(m.pointer(5), OCT, first_, (m.length(5), I64(axis))), align=8)
                builder.store(builder.fadd(v, _all(builder, arguments[7 + axis])), m.at(m.pointer(axis), OCT, at_), align=8)
            columns = builder.add(_all(builder, first_), ir.Constant(ir.VectorType(I64, 8), list(range(8))))
            columns = builder.or_(columns, _all(builder, m.place(10)))
            builder.store(columns, m.at(m.pointer(3), columns.type, at_), align=8)
            return ctx.get_dummy_value()
        return types.void(b, c, d, numbers, at, x, first, px, py, pz, high), generate
