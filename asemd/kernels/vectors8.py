"""Vectors of eight doubles or whole numbers as values of compiled code, for kernels that no compiler vectorises.

Inside compiled code a `Vector` is a register: ``+ - * /`` and the functions here work on all eight places at once, and a number with a
vector of doubles stands for eight. Without compiler vectors are arrays of eight. Multiplications and additions may be contracted. *Places*
are where atoms begin in flat tables ``(n * 4,)`` of x, y, z and one more number; they are read from memory, for taking them out of a
vector costs more.
"""
from __future__ import annotations

import operator

import numpy as np
from numba import config

LANES = 8
SCAN = 16      # atoms that `near16` looks at

if config.DISABLE_JIT:
    def load8(b, at):
        """``b[at:at + 8]``."""
        return b[at:at + LANES].copy()

    def store8(b, at, v):
        """``b[at:at + 8] = v``."""
        b[at:at + LANES] = v

    def all8(x):
        """A vector with `x` in all places."""
        return np.full(LANES, x, np.int32 if isinstance(x, (int, np.integer)) else float)

    def madd8(a, b, c):
        """``a * b + c``, in one rounding where the processor can."""
        return a * b + c

    def inverse_root8(v):
        """Inverse square roots, to about a digit in the last place."""
        with np.errstate(divide="ignore"):
            return 1.0 / np.sqrt(v)

    def whole8(v):
        """Towards zero, as whole numbers of 32 bits."""
        return v.astype(np.int32)

    def real8(v):
        """Whole numbers as doubles."""
        return v.astype(float)

    def smaller8(a, b):
        """The smaller one, place by place; `b` for what is not a number."""
        return np.where(a < b, a, b)

    def larger8(a, b):
        """The larger one, place by place; `b` for what is not a number."""
        return np.where(a > b, a, b)

    def below8(a, b, yes, no):
        """`yes` where a < b, else `no`."""
        return np.where(a < b, yes, no)

    def sum8(v):
        """The sum of the eight places."""
        return float(v.sum())

    def rows8(table, places, at, first):
        """Four vectors: the numbers from `first` on behind ``places[at:at + 8]`` in the flat `table`."""
        j = places[at:at + LANES] + first
        return table[j], table[j + 1], table[j + 2], table[j + 3]

    def lookup8(table, places, at):
        """``table[places[at:at + 8]]``, whole numbers."""
        return table[places[at:at + LANES]]

    def add_at8(table, places, at, values):
        """Add ``values[:8]`` to ``table[places[at:at + 8]]``."""
        for k in range(LANES):
            table[places[at + k]] += values[k]

    def oppose8(table, places, at, me, x, y, z):
        """Add the sums of x, y, z to the row of the flat `table` that begins at `me`, and take them from those at ``places[at:at + 8]``."""
        for k in range(LANES):
            j = places[at + k]
            table[j:j + 3] -= x[k], y[k], z[k]
        table[me:me + 3] += x.sum(), y.sum(), z.sum()

    def add_row(table, at, other, k):
        """Add the row of the flat table `other` that begins at `k` to the one of `table (n, 4)` with number `at`."""
        table[at] += other[k:k + 4]

    def pack8(b, at, row, local, near, entries, first, ox, oy, oz, shifts, mask, shifted):
        """Positions of eight atoms, ``entries[first:]``, less the origin: rows of the flat table `local` from row `at` on, and in single
        precision in the rows of `b`, which are `row` apart. Arguments as in `asemd.kernels.gather.gather8`."""
        for k in range(LANES):
            e = int(entries[first + k])
            one = near[e & mask].copy()
            if shifted:
                one += shifts[e // (mask + 1)]
            one[:3] -= ox, oy, oz
            local[4 * (at + k):4 * (at + k) + 4] = one
            b[at + k], b[at + k + row], b[at + k + 2 * row] = one[:3]

    def near16(b, at, row, x, y, z, turn, reach2, kept, n):
        """Append to ``kept[n:]`` the places of those atoms ``at ... at + 15`` in the rows of `b` that are closer to (x, y, z) than the root
        of `reach2` and whose number in the fourth row is above `turn`; returns the new `n`. What is behind it may be overwritten."""
        for k in range(at, at + SCAN):
            if (x - b[k])**2 + (y - b[k + row])**2 + (z - b[k + 2 * row])**2 < reach2 and b[k + 3 * row] > turn:
                kept[n] = 4 * k
                n += 1
        return n
else:
    from llvmlite import ir
    from numba import types
    from numba.core import cgutils
    from numba.core.typing.templates import AbstractTemplate, infer_global, signature
    from numba.extending import intrinsic, lower_builtin, models, register_model

    from asemd.kernels import target
    from asemd.kernels.gather import I32, I64, OCT, QUAD, _columns, _Memory, _rows

    WIDE = "+avx512f" in (config.CPU_FEATURES or "") and target is not None
    FUSE = ("contract", "nsz", "arcp")
    SINGLE, WOCT = ir.VectorType(ir.FloatType(), SCAN), ir.VectorType(I32, LANES)

    class Vector(types.Type):
        """The type of a vector; `kind` is ``float64`` or ``int32``."""

        def __init__(self, kind: str):
            self.kind = kind
            super().__init__(name=f"Vector({kind})")

    @register_model(Vector)
    class VectorModel(models.PrimitiveModel):
        """A vector is LLVM's vector."""

        def __init__(self, manager, kind):
            super().__init__(manager, kind, OCT if kind.kind == "float64" else WOCT)

    DOUBLES, WHOLES = Vector("float64"), Vector("int32")

    def _numbers(*args):
        """Types to which arguments are made: all vectors of whole numbers, or vectors of doubles and numbers; None for others."""
        if all(a == WHOLES for a in args):
            return [WHOLES] * len(args)
        ok = all(a == DOUBLES or isinstance(a, (types.Float, types.Integer)) for a in args)
        return [a if a == DOUBLES else types.float64 for a in args] if ok else None

    def _eights(builder, args):
        return [v if isinstance(v.type, ir.VectorType) else _all(builder, v) for v in args]

    def _operator(symbol, name):
        @infer_global(symbol)
        class Typing(AbstractTemplate):
            def generic(self, args, keywords):
                if len(args) != 2 or not any(isinstance(a, Vector) for a in args) or not (found := _numbers(*args)):
                    return None
                return signature(WHOLES if WHOLES in found else DOUBLES, *found)

        @lower_builtin(symbol, Vector, types.float64)
        @lower_builtin(symbol, types.float64, Vector)
        @lower_builtin(symbol, Vector, Vector)
        def lower(ctx, builder, sig, args):
            if sig.return_type == DOUBLES:
                return getattr(builder, "f" + name)(*_eights(builder, args), flags=FUSE)
            return getattr(builder, name)(*args)

    for _symbol, _name in ((operator.add, "add"), (operator.sub, "sub"), (operator.mul, "mul"), (operator.truediv, "div")):
        _operator(_symbol, _name)

    def _all(builder, scalar, lanes=LANES):
        v = builder.insert_element(ir.Constant(ir.VectorType(scalar.type, lanes), ir.Undefined), scalar, I32(0))
        return builder.shuffle_vector(v, v, ir.Constant(ir.VectorType(I32, lanes), [0] * lanes))

    def _calls(builder, name, kind, values):
        function = cgutils.get_or_insert_function(builder.module, ir.FunctionType(kind, [v.type for v in values]), name)
        return builder.call(function, values)

    @intrinsic
    def load8(typing, b, at):
        """``b[at:at + 8]``."""
        kind = DOUBLES if b.dtype == types.float64 else WHOLES

        def generate(ctx, builder, sig, args):
            m = _Memory(ctx, builder, sig, args)
            return builder.load(m.at(m.pointer(0), ctx.get_value_type(kind), m.place(1)), align=b.dtype.bitwidth // 8)
        return kind(b, at), generate

    @intrinsic
    def store8(typing, b, at, v):
        """``b[at:at + 8] = v``."""
        def generate(ctx, builder, sig, args):
            m = _Memory(ctx, builder, sig, args)
            builder.store(args[2], m.at(m.pointer(0), args[2].type, m.place(1)), align=b.dtype.bitwidth // 8)
            return ctx.get_dummy_value()
        return types.void(b, at, v), generate

    @intrinsic
    def all8(typing, x):
        """A vector with `x` in all places."""
        if isinstance(x, types.Integer):
            return WHOLES(types.int64), lambda ctx, builder, sig, args: _all(builder, builder.trunc(args[0], I32))
        return DOUBLES(types.float64), lambda ctx, builder, sig, args: _all(builder, args[0])

    @intrinsic
    def madd8(typing, a, b, c):
        """``a * b + c``, in one rounding where the processor can."""
        def generate(ctx, builder, sig, args):
            return _calls(builder, "llvm.fmuladd.v8f64", OCT, _eights(builder, args))
        return (DOUBLES(*found), generate) if WHOLES not in (found := _numbers(a, b, c) or [WHOLES]) else None

    @intrinsic
    def inverse_root8(typing, v):
        """Inverse square roots, to about a digit in the last place."""
        def generate(ctx, builder, sig, args):
            x, one, half = args[0], ir.Constant(OCT, [1.0] * LANES), ir.Constant(OCT, [0.5] * LANES)
            if not WIDE:
                return builder.fdiv(one, _calls(builder, "llvm.sqrt.v8f64", OCT, [x]))
            y = _calls(builder, "llvm.x86.avx512.rsqrt14.pd.512", OCT, [x, x, ir.IntType(8)(255)])
            for _ in range(2):      # y + y/2 (1 - x y y): 14 digits become 28, then all
                miss = builder.fsub(one, builder.fmul(builder.fmul(x, y), y, flags=FUSE), flags=FUSE)
                y = builder.fadd(y, builder.fmul(builder.fmul(y, half), miss, flags=FUSE), flags=FUSE)
            return y
        return DOUBLES(DOUBLES), generate

    @intrinsic
    def whole8(typing, v):
        """Towards zero, as whole numbers of 32 bits."""
        return WHOLES(DOUBLES), lambda ctx, builder, sig, args: builder.fptosi(args[0], WOCT)

    @intrinsic
    def real8(typing, v):
        """Whole numbers as doubles."""
        return DOUBLES(WHOLES), lambda ctx, builder, sig, args: builder.sitofp(args[0], OCT)

    def _less(builder, a, b):
        return builder.fcmp_ordered("<", a, b) if a.type == OCT else builder.icmp_signed("<", a, b)

    def _chosen(choose, *pairs):
        """An intrinsic that chooses between the last two of its arguments, place by place."""
        found = [_numbers(*pair) for pair in pairs]
        if None in found:
            return None
        return (WHOLES if WHOLES in found[-1] else DOUBLES)(*sum(found, [])), \
            lambda ctx, builder, sig, args: choose(builder, *_eights(builder, args))

    @intrinsic
    def smaller8(typing, a, b):
        """The smaller one, place by place; `b` for what is not a number."""
        return _chosen(lambda builder, a, b: builder.select(_less(builder, a, b), a, b), (a, b))

    @intrinsic
    def larger8(typing, a, b):
        """The larger one, place by place; `b` for what is not a number."""
        return _chosen(lambda builder, a, b: builder.select(_less(builder, b, a), a, b), (a, b))

    @intrinsic
    def below8(typing, a, b, yes, no):
        """`yes` where a < b, else `no`."""
        return _chosen(lambda builder, a, b, yes, no: builder.select(_less(builder, a, b), yes, no), (a, b), (yes, no))

    def _halved(builder, rows):
        while len(rows) > 1:
            rows = [builder.fadd(a, b) for a, b in zip(rows[::2], rows[1::2])]
        return rows[0]

    @intrinsic
    def sum8(typing, v):
        """The sum of the eight places."""
        def generate(ctx, builder, sig, args):
            v, width = args[0], LANES
            while width > 1:
                width //= 2
                parts = [ir.Constant(ir.VectorType(I32, width), list(range(k, k + width))) for k in (0, width)]
                v = builder.fadd(*(builder.shuffle_vector(v, v, order) for order in parts))
            return builder.extract_element(v, I32(0))
        return types.float64(DOUBLES), generate

    def _places(m, builder, k, at):
        """The eight whole numbers of array `k` from argument `at` on."""
        first = m.place(at)
        return [builder.zext(builder.load(builder.gep(m.pointer(k), [builder.add(first, I64(n))])), I64) for n in range(LANES)]

    @intrinsic
    def rows8(typing, table, places, at, first):
        """Four vectors: the numbers from `first` on behind ``places[at:at + 8]`` in the flat `table`."""
        def generate(ctx, builder, sig, args):
            m = _Memory(ctx, builder, sig, args)
            rows = [builder.load(m.at(m.pointer(0), QUAD, j, m.place(3)), align=8) for j in _places(m, builder, 1, 2)]
            return ctx.make_tuple(builder, sig.return_type, _columns(builder, rows))
        return types.UniTuple(DOUBLES, 4)(table, places, at, first), generate

    @intrinsic
    def lookup8(typing, table, places, at):
        """``table[places[at:at + 8]]``, whole numbers."""
        def generate(ctx, builder, sig, args):
            m, v = _Memory(ctx, builder, sig, args), ir.Constant(WOCT, ir.Undefined)
            for k, place in enumerate(_places(m, builder, 1, 2)):
                v = builder.insert_element(v, builder.load(builder.gep(m.pointer(0), [place])), I32(k))
            return v
        return WHOLES(table, places, at), generate

    @intrinsic
    def add_at8(typing, table, places, at, values):
        """Add ``values[:8]`` to ``table[places[at:at + 8]]``."""
        def generate(ctx, builder, sig, args):
            m = _Memory(ctx, builder, sig, args)
            for k, j in enumerate(_places(m, builder, 1, 2)):
                p = builder.gep(m.pointer(0), [j])
                builder.store(builder.fadd(builder.load(p), builder.load(builder.gep(m.pointer(3), [I64(k)]))), p)
            return ctx.get_dummy_value()
        return types.void(table, places, at, values), generate

    @intrinsic
    def oppose8(typing, table, places, at, me, x, y, z):
        """Add the sums of x, y, z to the row of the flat `table` that begins at `me`, and take them from those at ``places[at:at + 8]``."""
        def generate(ctx, builder, sig, args):
            m = _Memory(ctx, builder, sig, args)
            rows = _rows(builder, [*args[4:], ir.Constant(OCT, [0.0] * LANES)])
            for j, one in zip(_places(m, builder, 1, 2), rows):
                p = m.at(m.pointer(0), QUAD, j)
                builder.store(builder.fsub(builder.load(p, align=8), one), p, align=8)
            p = m.at(m.pointer(0), QUAD, m.place(3))
            builder.store(builder.fadd(builder.load(p, align=8), _halved(builder, rows)), p, align=8)
            return ctx.get_dummy_value()
        return types.void(table, places, at, me, x, y, z), generate

    @intrinsic
    def add_row(typing, table, at, other, k):
        """Add the row of the flat table `other` that begins at `k` to the one of `table (n, 4)` with number `at`."""
        def generate(ctx, builder, sig, args):
            m = _Memory(ctx, builder, sig, args)
            to, one = m.at(m.pointer(0), QUAD, (m.place(1), I64(4))), m.at(m.pointer(2), QUAD, m.place(3))
            builder.store(builder.fadd(builder.load(to, align=8), builder.load(one, align=8)), to, align=8)
            return ctx.get_dummy_value()
        return types.void(table, at, other, k), generate

    @intrinsic(prefer_literal=True)
    def pack8(typing, b, at, row, local, near, entries, first, ox, oy, oz, shifts, mask, shifted):
        """Positions of eight atoms, ``entries[first:]``, less the origin: rows of the flat table `local` from row `at` on, and in single
        precision in the rows of `b`, which are `row` apart. Arguments as in `asemd.kernels.gather.gather8`."""
        if not isinstance(mask, types.Literal) or not isinstance(shifted, types.Literal):
            return None
        low = mask.literal_value

        def generate(ctx, builder, sig, args):
            m = _Memory(ctx, builder, sig, args)
            origin, atoms = ir.Constant(QUAD, [0.0] * 4), []
            for d in range(3):
                origin = builder.insert_element(origin, args[7 + d], I32(d))
            for k in range(LANES):
                e, j = m.entry(m.pointer(5), m.place(6), k, low)
                one = builder.load(m.at(m.pointer(4), QUAD, j), align=8)
                if shifted.literal_value:
                    c = builder.zext(builder.lshr(e, e.type(low.bit_length())), I64)
                    one = builder.fadd(one, builder.load(m.at(m.pointer(10), QUAD, (c, I64(4))), align=8))
                atoms.append(builder.fsub(one, origin))
                builder.store(atoms[-1], m.at(m.pointer(3), QUAD, (builder.add(m.place(1), I64(k)), I64(4))), align=8)
            for d, column in enumerate(_columns(builder, atoms)[:3]):
                column = builder.fptrunc(column, ir.VectorType(ir.FloatType(), LANES))
                builder.store(column, m.at(m.pointer(0), column.type, m.place(1), (m.place(2), I64(d))), align=4)
            return ctx.get_dummy_value()
        return types.void(b, at, row, local, near, entries, first, ox, oy, oz, shifts, mask, shifted), generate

    def _append(builder, m, places, close, kept, n):
        """Write the places whose flag is set one after the other behind ``kept[n]``; returns how many there are."""
        if WIDE:
            nothing = ir.Constant(places.type, [0] * SCAN)
            packed = _calls(builder, "llvm.x86.avx512.mask.compress.v16i32", places.type, [places, nothing, close])
            builder.store(packed, builder.bitcast(builder.gep(kept, [n]), places.type.as_pointer()), align=4)
            return builder.add(n, builder.zext(builder.ctpop(builder.bitcast(close, ir.IntType(SCAN))), I64))
        for k in range(SCAN):
            builder.store(builder.extract_element(places, I32(k)), builder.gep(kept, [n]))
            n = builder.add(n, builder.zext(builder.extract_element(close, I32(k)), I64))
        return n

    @intrinsic
    def near16(typing, b, at, row, x, y, z, turn, reach2, kept, n):
        """Append to ``kept[n:]`` the places of those atoms ``at ... at + 15`` in the rows of `b` that are closer to (x, y, z) than the root
        of `reach2` and whose number in the fourth row is above `turn`; returns the new `n`. What is behind it may be overwritten."""
        def generate(ctx, builder, sig, args):
            m, r2 = _Memory(ctx, builder, sig, args), None
            rows = [builder.load(m.at(m.pointer(0), SINGLE, m.place(1), (m.place(2), I64(d))), align=4) for d in range(4)]
            for d in range(3):
                away = builder.fsub(_all(builder, args[3 + d], SCAN), rows[d])
                square = builder.fmul(away, away, flags=FUSE)
                r2 = square if r2 is None else builder.fadd(square, r2, flags=FUSE)
            close = builder.and_(builder.fcmp_ordered("<", r2, _all(builder, args[7], SCAN)),
                                 builder.fcmp_ordered(">", rows[3], _all(builder, args[6], SCAN)))
            first = builder.trunc(builder.mul(m.place(1), I64(4)), I32)
            steps = ir.Constant(ir.VectorType(I32, SCAN), [4 * k for k in range(SCAN)])
            return _append(builder, m, builder.add(_all(builder, first, SCAN), steps), close, m.pointer(8), m.place(9))
        single = types.float32
        return types.int64(b, at, row, single, single, single, single, single, kept, n), generate
