"""Eight atoms at a time between arrays of x, y and z and tables where an atom's numbers lie side by side.

A pair kernel wants the positions of a cluster's neighbours as vectors of x, of y and of z, but neighbours stand anywhere. From a table
``(n, 4)`` of x, y, z and charge one load brings an atom, and a handful of shuffles turn eight atoms into vectors; forces go back the same
way. Compilers make a load and a store per number of such loops, or the processor's gather, which costs a third of the kernel's time.

`mask` are the low bits of a list entry, which name a row of the table; the bits above name a row of `shifts`. It, the last two
arguments of `gather8` and the last one of `scatter8` and of `fetch8` must be constants when compiled.
"""
from __future__ import annotations

from numba import config

if config.DISABLE_JIT:
    def take8(table, at, x, q):
        """Rows ``at ... at + 7`` of `table (n, 4)` from `x (3, n)` and `q (n,)`."""
        table[at:at + 8, :3] = x[:, at:at + 8].T
        table[at:at + 8, 3] = q[at:at + 8]

    def give8(table, at, x):
        """Add rows ``at ... at + 7`` of `table (n, 4)` to the first rows of `x (3 or more, n)` and set them to zero."""
        x[:3, at:at + 8] += table[at:at + 8, :3].T
        table[at:at + 8] = 0.0

    def gather8(b, at, row, table, entries, first, ox, oy, oz, shifts, mask, shifted, charge):
        """Positions of eight atoms, ``entries[first:]``, less the origin into ``b[at:at + 8]`` and the same places `row` and 2 `row` on.

        With the flag `shifted` the entry's row of `shifts (m, 4)` is added first; with `charge` not 0 charges go to `charge` rows on.
        """
        for k in range(8):
            e = int(entries[first + k])
            one = table[e & mask]
            if shifted:
                one = one + shifts[e // (mask + 1)]
            b[at + k], b[at + k + row], b[at + k + 2 * row] = one[0] - ox, one[1] - oy, one[2] - oz
            if charge:
                b[at + k + charge * row] = one[3]

    def fetch8(table, at, write):
        """Bring rows ``at ... at + 7`` of `table (n, 4)` into the cache, to `write` or to read them; they need not exist. Python has no
        such order, and numbers do not depend on it."""

    def scatter8(b, at, row, table, entries, first, mask, columns):
        """Add ``b[at:at + 8]`` and the same places `row`, 2 `row` ... on to the first `columns` columns of the rows of `table (n, 4)` named
        by ``entries[first:]``."""
        for k in range(8):
            j = int(entries[first + k]) & mask
            for d in range(columns):
                table[j, d] += b[at + k + d * row]
else:
    from llvmlite import ir
    from numba import types
    from numba.extending import intrinsic

    # numba has no vectors: these are written in LLVM's language
    I32, I64, F64 = ir.IntType(32), ir.IntType(64), ir.DoubleType()
    QUAD, OCT = ir.VectorType(F64, 4), ir.VectorType(F64, 8)
    EVEN, ODD = (0, 8, 2, 10, 4, 12, 6, 14), (1, 9, 3, 11, 5, 13, 7, 15)
    FRONT, BACK = (0, 1, 4, 5, 8, 9, 12, 13), (2, 3, 6, 7, 10, 11, 14, 15)

    def _shuffle(builder, a, b, order):
        return builder.shuffle_vector(a, b, ir.Constant(ir.VectorType(I32, len(order)), list(order)))

    def _columns(builder, rows):
        """Four vectors of eight from eight rows of four."""
        two = [_shuffle(builder, rows[k], rows[k + 2], range(8)) for k in (0, 1, 4, 5)]
        even = [_shuffle(builder, two[k], two[k + 1], EVEN) for k in (0, 2)]
        odd = [_shuffle(builder, two[k], two[k + 1], ODD) for k in (0, 2)]
        return [_shuffle(builder, *pair, half) for half in (FRONT, BACK) for pair in (even, odd)]

    def _rows(builder, columns):
        """Eight rows of four from four vectors of eight."""
        front = [_shuffle(builder, columns[0], columns[1], order) for order in (EVEN, ODD)]
        back = [_shuffle(builder, columns[2], columns[3], order) for order in (EVEN, ODD)]
        return [_shuffle(builder, front[k % 2], back[k % 2], (p, p + 1, 8 + p, 9 + p)) for k in range(8) for p in [2 * (k // 2)]]

    class _Memory:
        """The arguments of one intrinsic: arrays as pointers, places as 64-bit numbers."""

        def __init__(self, ctx, builder, signature, arguments):
            self.builder, self.kinds, self.values, self.ctx = builder, signature.args, arguments, ctx

        def array(self, k):
            return self.ctx.make_array(self.kinds[k])(self.ctx, self.builder, self.values[k])

        def pointer(self, k):
            return self.array(k).data

        def length(self, k):
            """Of the last axis."""
            return self.builder.extract_value(self.array(k).shape, self.kinds[k].ndim - 1)

        def place(self, k):
            return self.ctx.cast(self.builder, self.values[k], self.kinds[k], types.int64)

        def at(self, pointer, *terms):
            """Pointer to the vector of `kind` that begins at the sum of the terms, pairs (a, b) being products."""
            kind, *terms = terms
            total = I64(0)
            for t in terms:
                total = self.builder.add(total, self.builder.mul(*t) if isinstance(t, tuple) else t)
            return self.builder.bitcast(self.builder.gep(pointer, [total]), ir.PointerType(kind))

        def entry(self, pointer, first, k, mask):
            """The k-th entry and where its row of a table begins."""
            e = self.builder.load(self.builder.gep(pointer, [self.builder.add(first, I64(k))]))
            return e, self.builder.mul(self.builder.zext(self.builder.and_(e, e.type(mask)), I64), I64(4))

    def _known(*arguments):
        return all(isinstance(a, types.Literal) for a in arguments)

    @intrinsic(prefer_literal=True)
    def take8(typing, table, at, x, q):
        """Rows ``at ... at + 7`` of `table (n, 4)` from `x (3, n)` and `q (n,)`."""
        def generate(ctx, builder, signature, arguments):
            m = _Memory(ctx, builder, signature, arguments)
            at_, cap = m.place(1), m.length(2)
            columns = [builder.load(m.at(m.pointer(2), OCT, at_, (cap, I64(d))), align=8) for d in range(3)]
            columns.append(builder.load(m.at(m.pointer(3), OCT, at_), align=8))
            for k, one in enumerate(_rows(builder, columns)):
                builder.store(one, m.at(m.pointer(0), QUAD, (builder.add(at_, I64(k)), I64(4))), align=8)
            return ctx.get_dummy_value()
        return types.void(table, at, x, q), generate

    @intrinsic(prefer_literal=True)
    def give8(typing, table, at, x):
        """Add rows ``at ... at + 7`` of `table (n, 4)` to the first rows of `x (3 or more, n)` and set them to zero."""
        def generate(ctx, builder, signature, arguments):
            m = _Memory(ctx, builder, signature, arguments)
            at_, cap = m.place(1), m.length(2)
            places = [m.at(m.pointer(0), QUAD, (builder.add(at_, I64(k)), I64(4))) for k in range(8)]
            columns = _columns(builder, [builder.load(p, align=8) for p in places])
            for p in places:
                builder.store(ir.Constant(QUAD, [0.0] * 4), p, align=8)
            for d in range(3):
                p = m.at(m.pointer(2), OCT, at_, (cap, I64(d)))
                builder.store(builder.fadd(builder.load(p, align=8), columns[d]), p, align=8)
            return ctx.get_dummy_value()
        return types.void(table, at, x), generate

    @intrinsic(prefer_literal=True)
    def gather8(typing, b, at, row, table, entries, first, ox, oy, oz, shifts, mask, shifted, charge):
        """Positions of eight atoms, ``entries[first:]``, less the origin into ``b[at:at + 8]`` and the same places `row` and 2 `row` on.

        With the flag `shifted` the entry's row of `shifts (m, 4)` is added first; with `charge` not 0 charges go to `charge` rows on.
        """
        if not _known(mask, shifted, charge):
            return None
        low, add, charges = mask.literal_value, shifted.literal_value, charge.literal_value
        kind = b.dtype

        def generate(ctx, builder, signature, arguments):
            m = _Memory(ctx, builder, signature, arguments)
            atoms = []
            for k in range(8):
                e, j = m.entry(m.pointer(4), m.place(5), k, low)
                one = builder.load(m.at(m.pointer(3), QUAD, j), align=8)
                if add:
                    c = builder.zext(builder.lshr(e, e.type(low.bit_length())), I64)
                    one = builder.fadd(one, builder.load(m.at(m.pointer(9), QUAD, (c, I64(4))), align=8))
                atoms.append(one)
            for d, column in enumerate(_columns(builder, atoms)[:4 if charges else 3]):
                if d < 3:
                    o = builder.insert_element(ir.Constant(OCT, ir.Undefined), arguments[6 + d], I32(0))
                    column = builder.fsub(column, _shuffle(builder, o, o, (0,) * 8))
                if kind == types.float32:
                    column = builder.fptrunc(column, ir.VectorType(ir.FloatType(), 8))
                builder.store(column, m.at(m.pointer(0), column.type, m.place(1), (m.place(2), I64(d if d < 3 else charges))),
                              align=kind.bitwidth // 8)
            return ctx.get_dummy_value()
        return types.void(b, at, row, table, entries, first, ox, oy, oz, shifts, mask, shifted, charge), generate

    @intrinsic(prefer_literal=True)
    def fetch8(typing, table, at, write):
        """Bring rows ``at ... at + 7`` of `table (n, 4)` into the cache, to `write` or to read them; they need not exist."""
        if not _known(write):
            return None
        purpose = I32(int(write.literal_value))

        def generate(ctx, builder, signature, arguments):
            m = _Memory(ctx, builder, signature, arguments)
            byte = ir.PointerType(ir.IntType(8))
            prefetch = builder.module.declare_intrinsic("llvm.prefetch", [byte], ir.FunctionType(ir.VoidType(), [byte, I32, I32, I32]))
            for k in range(0, 8, 2):
                there = m.at(m.pointer(0), QUAD, (builder.add(m.place(1), I64(k)), I64(4)))
                builder.call(prefetch, [builder.bitcast(there, byte), purpose, I32(2), I32(1)])
            return ctx.get_dummy_value()
        return types.void(table, at, write), generate

    @intrinsic(prefer_literal=True)
    def scatter8(typing, b, at, row, table, entries, first, mask, columns):
        """Add ``b[at:at + 8]`` and the same places `row`, 2 `row` ... on to the first `columns` columns of the rows of `table (n, 4)` named
        by ``entries[first:]``."""
        if not _known(mask, columns):
            return None
        low, kind, count = mask.literal_value, b.dtype, columns.literal_value

        def generate(ctx, builder, signature, arguments):
            m = _Memory(ctx, builder, signature, arguments)
            parts = []
            for d in range(count):
                vector = ir.VectorType(ir.FloatType() if kind == types.float32 else F64, 8)
                v = builder.load(m.at(m.pointer(0), vector, m.place(1), (m.place(2), I64(d))), align=kind.bitwidth // 8)
                parts.append(builder.fpext(v, OCT) if kind == types.float32 else v)
            # one atom after the other: an atom may stand in the list twice, by two of its images
            for k, one in enumerate(_rows(builder, [*parts, *[ir.Constant(OCT, [0.0] * 8)] * (4 - count)])):
                _, j = m.entry(m.pointer(4), m.place(5), k, low)
                p = m.at(m.pointer(3), QUAD, j)
                builder.store(builder.fadd(builder.load(p, align=8), one), p, align=8)
            return ctx.get_dummy_value()
        return types.void(b, at, row, table, entries, first, mask, columns), generate
