"""Coefficients of the neighbours of a cluster by their types: a table of up to sixteen types stays in vector registers (AVX-512)."""
from __future__ import annotations

from numba import config

WIDE = False
MOST = 16           # types, with the unused one of number 0

if not config.DISABLE_JIT:
    from llvmlite import ir
    from numba import types
    from numba.core import cgutils
    from numba.extending import intrinsic

    from asemd.kernels import target
    from asemd.kernels.gather import I32, I64, OCT, _Memory
    from asemd.kernels.vectors8 import _calls

    WIDE = target.many_registers()

    @intrinsic(prefer_literal=True)
    def choose_rows(typing, b, at, row, table, kinds, full, columns, halves):
        """``b[at + c * row + k] = table[kinds[k], c]`` for k below `full`, a multiple of 8, and c below `columns`, at most 4.

        `table (n, 4)` has at most 8 rows for each of `halves`, 1 or 2, and must hold a zero or a coefficient for each number in `kinds`.
        """
        if not all(isinstance(a, types.Literal) for a in (columns, halves)):
            return None
        count, single = columns.literal_value, b.dtype == types.float32

        def generate(ctx, builder, signature, arguments):
            m = _Memory(ctx, builder, signature, arguments)
            rows = builder.extract_value(m.array(3).shape, 0)
            tables = []
            for c in range(count):
                halved = []
                for half in range(halves.literal_value):
                    v = ir.Constant(OCT, [0.0] * 8)
                    for t in range(8):
                        k = I64(8 * half + t)
                        k = builder.select(builder.icmp_signed("<", k, rows), k, I64(0))      # not beyond the end
                        p = builder.gep(m.pointer(3), [builder.add(builder.mul(k, I64(4)), I64(c))])
                        v = builder.insert_element(v, builder.load(p), I32(t))
                    halved.append(v)
                tables.append(halved)
            wide = ir.VectorType(I64, 8)
            with cgutils.for_range_slice(builder, I64(0), m.place(5), I64(8), intp=I64) as (k, _):
                p = builder.bitcast(builder.gep(m.pointer(4), [k]), ir.VectorType(I32, 8).as_pointer())
                kind = builder.zext(builder.load(p, align=4), wide)
                for c, halved in enumerate(tables):
                    if len(halved) == 1:
                        v = _calls(builder, "llvm.x86.avx512.permvar.df.512", OCT, [halved[0], kind])
                    else:
                        v = _calls(builder, "llvm.x86.avx512.vpermi2var.pd.512", OCT, [halved[0], kind, halved[1]])
                    if single:
                        v = builder.fptrunc(v, ir.VectorType(ir.FloatType(), 8))
                    place = builder.add(builder.add(m.place(1), builder.mul(m.place(2), I64(c))), k)
                    p = builder.bitcast(builder.gep(m.pointer(0), [place]), v.type.as_pointer())
                    builder.store(v, p, align=4 if single else 8)
            return ctx.get_dummy_value()
        return types.void(b, at, row, table, kinds, full, columns, halves), generate
