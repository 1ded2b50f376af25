"""The points of a mesh around a charge, in vectors: ORDER x ORDER rows of neighbouring places in one flat array.

A row begins at ``planes[at0 + p] + lines[at1 + m] + at2`` of `flat`, where row `i` of ``base`` holds the three numbers `at` (the last one
counts `step` places); row `i` of `weight` holds the weights of the three directions, each continued with zeros to WIDE numbers. Compilers
make single additions of loops of five or fifteen steps; written as vectors these take a third of the time. Weights and mesh are both in
double or both in single precision. `step` and `order` must be constants when compiled.
"""
from __future__ import annotations

import functools

from numba import config

WIDE = 8       # rows are read and written in vectors of that length: arrays are that much longer
SUMS = 16      # `sums` of `collect` are longer than three times the order by so many

if config.DISABLE_JIT:
    def weigh(weight, i, k, pieces, t, order):
        """``weight[i, k:k + WIDE]``: polynomials of `t` with the coefficients ``pieces (order, WIDE)``, those of powers 0, 1 ..."""
        p = pieces[order - 1]
        for c in range(order - 2, -1, -1):
            p = p * weight.dtype.type(t) + pieces[c]
        weight[i, k:k + WIDE] = p

    def _rows(planes, lines, base, step, weight, i, order):
        """Where each row begins, and the product of its two weights."""
        for p in range(order):
            for m in range(order):
                yield planes[base[i, 0] + p] + lines[base[i, 1] + m] + step * base[i, 2], weight[i, p] * weight[i, WIDE + m]

    def deposit(flat, planes, lines, base, weight, i, charge, step, order):
        """Add `charge` times the product of the weights to the points."""
        for o, w in _rows(planes, lines, base, step, weight, i, order):
            flat[o:o + WIDE] += charge * w * weight[i, 2 * WIDE:3 * WIDE]

    def collect(flat, planes, lines, base, weight, i, sums, step, order):
        """``sums[:3 * order]``: of three meshes side by side, their values weighted and added over the rows."""
        sums[:] = 0.0
        for o, w in _rows(planes, lines, base, step, weight, i, order):
            sums[:3 * order] += w * flat[o:o + 3 * order]
else:
    from llvmlite import ir
    from numba import types
    from numba.extending import intrinsic

    I64 = ir.IntType(64)

    class _Loads:
        """Arguments of an intrinsic, and what is done with vectors in the precision of the weights."""

        def __init__(self, context, builder, signature, values, weight, i):
            self.context, self.builder, self.signature, self.values = context, builder, signature, values
            self.real = context.get_data_type(signature.args[weight].dtype)
            self.bytes = 4 if isinstance(self.real, ir.FloatType) else 8
            self.weight = self.row(weight, i)

        def whole(self, k):
            return self.context.cast(self.builder, self.values[k], self.signature.args[k], types.int64)

        def array(self, k):
            return self.context.make_array(self.signature.args[k])(self.context, self.builder, self.values[k])

        def row(self, k, i):
            """Where row `i` of argument k begins."""
            table = self.array(k)
            return self.builder.gep(table.data, [self.builder.mul(self.whole(i), self.builder.extract_value(table.shape, 1))])

        def add_product(self, a, b, c):
            """a b + c, in one instruction where there is one."""
            return self.builder.fadd(self.builder.fmul(a, b, flags=("contract",)), c, flags=("contract",))

        def rounded(self, x):
            """A double in that precision."""
            return x if self.bytes == 8 else self.builder.fptrunc(x, self.real)

        def splat(self, x, wide=WIDE):
            one = self.builder.insert_element(ir.Constant(ir.VectorType(self.real, wide), ir.Undefined), x, ir.IntType(32)(0))
            return self.builder.shuffle_vector(one, one, ir.Constant(ir.VectorType(ir.IntType(32), wide), [0] * wide))

        def number(self, pointer, k):
            return self.builder.load(self.builder.gep(pointer, [k if isinstance(k, ir.Value) else I64(k)]))

        def place(self, pointer, k, wide):
            at = self.builder.gep(pointer, [k if isinstance(k, ir.Value) else I64(k)])
            return self.builder.bitcast(at, ir.VectorType(self.real, wide).as_pointer())

        def vector(self, pointer, k=0, wide=WIDE):
            return self.builder.load(self.place(pointer, k, wide), align=self.bytes)

        def keep(self, value, pointer, k=0, wide=WIDE):
            self.builder.store(value, self.place(pointer, k, wide), align=self.bytes)

        def walk(self, step, order, front=None, wide=WIDE):
            """(pointer of a row, product of its two weights in all places of a vector) for each row of the first three arguments."""
            b, flat, planes, lines, at = self.builder, self.array(0).data, self.array(1).data, self.array(2).data, self.row(3, 5)
            first, second, third = (self.number(at, d) for d in range(3))
            flat = b.gep(flat, [b.mul(third, I64(step))])
            beside = [self.number(lines, b.add(second, I64(m))) for m in range(order)]
            weights = [self.number(self.weight, WIDE + m) for m in range(order)]
            for p in range(order):
                plane, w = b.gep(flat, [self.number(planes, b.add(first, I64(p)))]), self.number(self.weight, p)
                w = w if front is None else b.fmul(front, w)
                for m in range(order):
                    yield b.gep(plane, [beside[m]]), self.splat(b.fmul(w, weights[m]), wide)

    @intrinsic(prefer_literal=True)
    def weigh(typing, weight, i, k, pieces, t, order):
        """``weight[i, k:k + WIDE]``: polynomials of `t` with the coefficients ``pieces (order, WIDE)``, those of powers 0, 1 ..."""
        if not isinstance(order, types.Literal):
            return None
        n = order.literal_value

        def generate(context, builder, signature, values):
            loads = _Loads(context, builder, signature, values, 0, 1)
            table = loads.array(3).data
            x, p = loads.splat(loads.rounded(values[4])), loads.vector(table, WIDE * (n - 1))
            for c in range(n - 2, -1, -1):
                p = loads.add_product(p, x, loads.vector(table, WIDE * c))
            loads.keep(p, loads.weight, loads.whole(2))
            return context.get_dummy_value()
        return types.void(weight, i, k, pieces, types.float64, order), generate

    @intrinsic(prefer_literal=True)
    def deposit(typing, flat, planes, lines, base, weight, i, charge, step, order):
        """Add `charge` times the product of the weights to the points."""
        if not isinstance(step, types.Literal) or not isinstance(order, types.Literal):
            return None

        def generate(context, builder, signature, values):
            loads = _Loads(context, builder, signature, values, 4, 5)
            along = loads.vector(loads.weight, 2 * WIDE)
            for row, w in loads.walk(step.literal_value, order.literal_value, loads.rounded(values[6])):
                loads.keep(loads.add_product(w, along, loads.vector(row)), row)
            return context.get_dummy_value()
        return types.void(flat, planes, lines, base, weight, i, types.float64, step, order), generate

    @intrinsic(prefer_literal=True)
    def collect(typing, flat, planes, lines, base, weight, i, sums, step, order):
        """``sums[:3 * order]``: of three meshes side by side, their values weighted and added over the rows."""
        if not isinstance(step, types.Literal) or not isinstance(order, types.Literal):
            return None
        n = order.literal_value

        def generate(context, builder, signature, values):
            loads = _Loads(context, builder, signature, values, 4, 5)
            wide = 64 // loads.bytes
            zero = ir.Constant(ir.VectorType(loads.real, wide), [0.0] * wide)
            totals = [[zero] * ((3 * n + wide - 1) // wide) for _ in range(2)]      # one sum would wait for itself
            for m, (row, w) in enumerate(loads.walk(step.literal_value, n, wide=wide)):
                totals[m % 2] = [loads.add_product(w, loads.vector(row, wide * k, wide), t) for k, t in enumerate(totals[m % 2])]
            out = loads.array(6).data
            for k, parts in enumerate(zip(*totals)):
                loads.keep(functools.reduce(builder.fadd, parts), out, wide * k, wide)
            return context.get_dummy_value()
        return types.void(flat, planes, lines, base, weight, i, sums, step, order), generate
