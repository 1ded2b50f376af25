"""The points of a mesh around a charge, in vectors: ORDER x ORDER rows of neighbouring places in one flat array.

`rows (order^2,)` say where each row begins in `flat`; row `i` of `weight` holds the weights of the three directions, each continued with
zeros to WIDE numbers. Compilers make single additions of loops of five or fifteen steps; written as vectors these take a third of
the time. `order` must be a constant when compiled.
"""
from __future__ import annotations

from numba import config

WIDE = 8       # rows are read and written in vectors of that length: arrays are that much longer

if config.DISABLE_JIT:
    def deposit(flat, rows, weight, i, charge, order):
        """Add `charge` times the product of the weights to the points."""
        w = weight[i]
        for p in range(order):
            for m in range(order):
                o = rows[p * order + m]
                flat[o:o + WIDE] += charge * w[p] * w[WIDE + m] * w[2 * WIDE:3 * WIDE]

    def collect(flat, rows, weight, i, sums, order):
        """``sums[:3 * order]``: of three meshes side by side, their values weighted and added over the rows."""
        w = weight[i]
        sums[:] = 0.0
        for p in range(order):
            for m in range(order):
                o = rows[p * order + m]
                sums[:3 * order] += w[p] * w[WIDE + m] * flat[o:o + 3 * order]
else:
    from llvmlite import ir
    from numba import types
    from numba.extending import intrinsic

    I64, F64 = ir.IntType(64), ir.DoubleType()
    OCT = ir.VectorType(F64, WIDE)

    def _splat(builder, x):
        one = builder.insert_element(ir.Constant(OCT, ir.Undefined), x, ir.IntType(32)(0))
        return builder.shuffle_vector(one, one, ir.Constant(ir.VectorType(ir.IntType(32), WIDE), [0] * WIDE))

    class _Loads:
        """Pointers of the arguments, and the weights of the first two directions multiplied."""

        def __init__(self, context, builder, signature, values, order):
            def pointer(k):
                return context.make_array(signature.args[k])(context, builder, values[k]).data
            self.builder, self.order = builder, order
            self.flat, self.rows = pointer(0), pointer(1)
            table = context.make_array(signature.args[2])(context, builder, values[2])
            step = builder.extract_value(table.shape, 1)
            at = builder.mul(context.cast(builder, values[3], signature.args[3], types.int64), step)
            self.weight = builder.gep(table.data, [at])

        def add_product(self, a, b, c):
            """a b + c, in one instruction where there is one."""
            return self.builder.fadd(self.builder.fmul(a, b, flags=("contract",)), c, flags=("contract",))

        def number(self, k):
            return self.builder.load(self.builder.gep(self.weight, [I64(k)]))

        def vector(self, pointer, k=0):
            return self.builder.bitcast(self.builder.gep(pointer, [I64(k)]), OCT.as_pointer())

        def walk(self, front=None):
            """(pointer of a row, product of its two weights in all places of a vector) for each row."""
            b = self.builder
            second = [self.number(WIDE + m) for m in range(self.order)]
            for p in range(self.order):
                first = self.number(p)
                if front is not None:
                    first = b.fmul(front, first)
                for m in range(self.order):
                    row = b.load(b.gep(self.rows, [I64(p * self.order + m)]))
                    yield b.gep(self.flat, [row]), _splat(b, b.fmul(first, second[m]))

    @intrinsic(prefer_literal=True)
    def deposit(typing, flat, rows, weight, i, charge, order):
        """Add `charge` times the product of the weights to the points."""
        if not isinstance(order, types.Literal):
            return None
        n = order.literal_value

        def generate(context, builder, signature, values):
            loads = _Loads(context, builder, signature, values, n)
            along = builder.load(loads.vector(loads.weight, 2 * WIDE), align=8)
            for row, w in loads.walk(values[4]):
                place = loads.vector(row)
                builder.store(loads.add_product(w, along, builder.load(place, align=8)), place, align=8)
            return context.get_dummy_value()
        return types.void(flat, rows, weight, i, types.float64, order), generate

    @intrinsic(prefer_literal=True)
    def collect(typing, flat, rows, weight, i, sums, order):
        """``sums[:3 * order]``: of three meshes side by side, their values weighted and added over the rows."""
        if not isinstance(order, types.Literal):
            return None
        n = order.literal_value

        def generate(context, builder, signature, values):
            loads = _Loads(context, builder, signature, values, n)
            total = [ir.Constant(OCT, [0.0] * WIDE) for _ in range(0, 3 * n, WIDE)]
            for row, w in loads.walk():
                total = [loads.add_product(w, builder.load(loads.vector(row, WIDE * k), align=8), t) for k, t in enumerate(total)]
            out = context.make_array(signature.args[4])(context, builder, values[4]).data
            for k, t in enumerate(total):
                builder.store(t, loads.vector(out, WIDE * k), align=8)
            return context.get_dummy_value()
        return types.void(flat, rows, weight, i, sums, order), generate
