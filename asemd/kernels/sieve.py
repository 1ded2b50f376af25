"""Candidates of a cluster's row, sorted sixteen at a time, for processors that can pack the chosen numbers of a vector (AVX-512).

The row is that of `asemd.kernels.cluster.arrange`, to the last entry; there each candidate is counted and placed by itself, which takes
longer.
"""
from __future__ import annotations

import numpy as np
from numba import config

CLUSTER = 8
MARK = True
LANES = 16
SUMS = 7            # of the first and the last pair in need: 0 to 6
MARKED = 1 << 30    # in tags
WIDE = False

if not config.DISABLE_JIT:
    from llvmlite import ir
    from numba import types
    from numba.extending import intrinsic

    from asemd.kernels import target
    from asemd.kernels.gather import I32, I64, _Memory, _shuffle
    from asemd.kernels.vectors8 import _calls

    WIDE = target.many_registers()
    ROW = ir.VectorType(I32, LANES)
    STEPS = ir.Constant(ROW, list(range(LANES)))

    def _all(builder, scalar):
        one = builder.insert_element(ir.Constant(ir.VectorType(scalar.type, LANES), ir.Undefined), scalar, I32(0))
        return _shuffle(builder, one, one, (0,) * LANES)

    def _before(builder, at, end):
        """Which of the places at ... at + 15 are before the end."""
        return builder.icmp_signed("<", STEPS, _all(builder, builder.trunc(builder.sub(end, at), I32)))

    def _place(m, pointer, at):
        return m.builder.bitcast(m.builder.gep(pointer, [at]), ROW.as_pointer())

    def _load(m, array, at):
        return m.builder.load(_place(m, m.pointer(array), at), align=4)

    def _append(m, chosen, at, *pairs):
        """The chosen numbers of vectors behind ``array[at]`` each, and what is behind them is overwritten; returns the new end."""
        builder = m.builder
        for values, array in pairs:
            packed = _calls(builder, "llvm.x86.avx512.mask.compress.v16i32", ROW, [values, ir.Constant(ROW, [0] * LANES), chosen])
            builder.store(packed, _place(m, m.pointer(array), at), align=4)
        return builder.add(at, builder.zext(builder.ctpop(builder.bitcast(chosen, ir.IntType(LANES))), I64))

    def _chosen(m, entries, who, tag, at, end, n, *arrays):
        """Those of sixteen candidates that somebody reaches, and their keys, behind the arrays; returns the new end."""
        builder = m.builder
        who = builder.and_(who, ir.Constant(ROW, [0xFF] * LANES))
        one, key = ir.Constant(ROW, [1] * LANES), None
        for bits in (who, builder.and_(who, builder.neg(who))):
            highest = builder.sub(ir.Constant(ROW, [31] * LANES), _calls(builder, "llvm.ctlz.v16i32", ROW, [bits, ir.IntType(1)(0)]))
            pair = builder.lshr(highest, one)
            key = pair if key is None else builder.add(key, pair)
        reached = builder.icmp_signed("!=", who, ir.Constant(ROW, [0] * LANES))
        return _append(m, builder.and_(_before(builder, at, end), reached), n, *zip((entries, tag, key), arrays))

    @intrinsic
    def sieve16(typing, codes, at, end, order, tags, keys, n):
        """Of the candidates ``at ... at + 15``, as far as they are before `end`, those that somebody reaches: their entries go behind
        ``order[n]``, bits 32 on of their codes behind ``tags[n]``, the first plus the last pair in need behind ``keys[n]``; returns the new
        `n`. Sixteen places of `codes`, and of the others from `n` on, must exist."""
        def generate(ctx, builder, signature, arguments):
            m = _Memory(ctx, builder, signature, arguments)
            half, parts = ir.VectorType(I64, LANES // 2), []
            for k in (0, LANES // 2):
                p = builder.gep(m.pointer(0), [builder.add(m.place(1), I64(k))])
                parts.append(builder.load(builder.bitcast(p, half.as_pointer()), align=8))
            short, up = ir.VectorType(I32, LANES // 2), ir.Constant(half, [32] * (LANES // 2))
            entries = _shuffle(builder, *(builder.trunc(v, short) for v in parts), range(LANES))
            tag = _shuffle(builder, *(builder.trunc(builder.lshr(v, up), short) for v in parts), range(LANES))
            return _chosen(m, entries, tag, tag, m.place(1), m.place(2), m.place(6), 3, 4, 5)
        return types.int64(codes, at, end, order, tags, keys, n), generate

    @intrinsic
    def pick16(typing, entries, first, who, hide, at, end, order, tags, keys, n):
        """As `sieve16`, of the entries ``first + at ...``; ``who[at:]`` says in its lowest eight bits who reaches them. A tag is what is
        above these, the candidate's place from bit 8 on, and its number in `hide`, whose places are those of the entries; but that is
        left out if `hide` is None."""
        def generate(ctx, builder, signature, arguments):
            m = _Memory(ctx, builder, signature, arguments)
            there = builder.add(m.place(1), m.place(4))
            at, who = builder.add(_all(builder, builder.trunc(m.place(4), I32)), STEPS), _load(m, 2, m.place(4))
            tag = builder.or_(builder.and_(who, ir.Constant(ROW, [~0xFF] * LANES)), builder.shl(at, ir.Constant(ROW, [8] * LANES)))
            if hide != types.none:
                bytes_ = ir.VectorType(ir.IntType(8), LANES)
                p = builder.bitcast(builder.gep(m.pointer(3), [there]), bytes_.as_pointer())
                tag = builder.or_(tag, builder.zext(builder.load(p, align=1), ROW))
            return _chosen(m, _load(m, 0, there), who, tag, m.place(4), m.place(5), m.place(9), 6, 7, 8)
        return types.int64(entries, first, who, hide, at, end, order, tags, keys, n), generate

    @intrinsic
    def take16(typing, keys, key, order, tags, at, end, to_order, to_tags, n):
        """Of the candidates ``at ... at + 15`` before `end` those with that key: from `order` and `tags` behind ``to_order[n]`` and
        ``to_tags[n]``; returns the new `n`."""
        def generate(ctx, builder, signature, arguments):
            m = _Memory(ctx, builder, signature, arguments)
            wanted = _all(builder, builder.trunc(m.place(1), I32))
            chosen = builder.and_(_before(builder, m.place(4), m.place(5)), builder.icmp_signed("==", _load(m, 0, m.place(4)), wanted))
            return _append(m, chosen, m.place(8), (_load(m, 2, m.place(4)), 6), (_load(m, 3, m.place(4)), 7))
        return types.int64(keys, key, order, tags, at, end, to_order, to_tags, n), generate

    @intrinsic
    def marked16(typing, tags, at, end, out, n):
        """The places ``at ... at + 15`` before `end` whose tags have bit 30 set, behind ``out[n]``; returns the new `n`."""
        def generate(ctx, builder, signature, arguments):
            m = _Memory(ctx, builder, signature, arguments)
            marks = builder.and_(_load(m, 0, m.place(1)), ir.Constant(ROW, [MARKED] * LANES))
            chosen = builder.and_(_before(builder, m.place(1), m.place(2)), builder.icmp_signed("!=", marks, ir.Constant(ROW, [0] * LANES)))
            return _append(m, chosen, m.place(4), (builder.add(_all(builder, builder.trunc(m.place(1), I32)), STEPS), 3))
        return types.int64(tags, at, end, out, n), generate


def named(builder) -> tuple:
    """The functions that make rows of lists, after a module was told what they take from here."""
    builder.line("from asemd.kernels.sieve import marked16, pick16, sieve16, take16")
    for constant, value in dict(LANES=LANES, SUMS=SUMS, MARKED=MARKED).items():
        builder.constant(constant, value)
    return PIECES


def place16(ci, kept, start, entries, own, span, tally, width, empty, order, tags, keys, to_order, to_tags):
    """The row of cluster `ci` from ``entries[start]`` on, as `asemd.kernels.cluster.arrange` has it, from `kept` chosen candidates; their
    tags are in `to_tags` then, in the order of the row without the cluster itself. Returns where the row ends."""
    at = np.int64(0)
    for key in range(SUMS):
        tally[key] = at
        for t in range(0, kept, LANES):
            at = take16(keys, key, order, tags, t, kept, to_order, to_tags, at)
    tally[SUMS] = kept
    mine = (tally[3] // width) * width      # the cluster's own place; what it displaces goes behind it
    for pair in range(4):
        span[ci, 2 * pair] = min((tally[pair] // width) * width, mine)
        span[ci, 2 * pair + 1] = ((tally[pair + 4] + CLUSTER + width - 1) // width) * width
    own[ci] = mine
    for q in range(mine):
        entries[np.uint64(start + q)] = to_order[np.uint64(q)]
    for k in range(CLUSTER):
        entries[start + mine + k] = np.int32(ci * CLUSTER + k) | np.int32(13 << 26)
    for q in range(mine, kept):
        entries[np.uint64(start + CLUSTER + q)] = to_order[np.uint64(q)]
    n = start + kept + CLUSTER
    while (n - start) % max(width, CLUSTER) != 0:
        entries[n] = np.int32(empty) | np.int32(13 << 26)
        n += 1
    return n


def arrange16(ci, codes, nt, start, entries, own, span, tally, width, empty, hide, order, tags, keys, to_order, to_tags):
    """As `asemd.kernels.cluster.arrange`, from all candidates, also those that nobody reaches; `order` to `to_tags`: work space, with room
    for sixteen more than there are. How many are left is in ``tally[7]``."""
    kept = np.int64(0)
    for t in range(0, nt, LANES):
        kept = sieve16(codes, t, nt, order, tags, keys, kept)
    n = place16(ci, kept, start, entries, own, span, tally, width, empty, order, tags, keys, to_order, to_tags)
    if MARK:
        mine = np.int64(own[ci])
        for q in range(mine):
            hide[np.uint64(start + q)] = np.uint8(255 - (to_tags[np.uint64(q)] & 255))
        for q in range(mine, kept):
            hide[np.uint64(start + CLUSTER + q)] = np.uint8(255 - (to_tags[np.uint64(q)] & 255))
        for q in range(start + kept + CLUSTER, n):
            hide[q] = np.uint8(255)
    return n


def reached16(x, y, z, who, nt, s, r2):
    """``who[:nt]``: a bit for each of the eight atoms at place `s` of x, y, z (single precision) that is not further from a candidate than
    the root of `r2`."""
    x0, x1, x2, x3, x4, x5, x6, x7 = x[s], x[s + 1], x[s + 2], x[s + 3], x[s + 4], x[s + 5], x[s + 6], x[s + 7]
    y0, y1, y2, y3, y4, y5, y6, y7 = y[s], y[s + 1], y[s + 2], y[s + 3], y[s + 4], y[s + 5], y[s + 6], y[s + 7]
    z0, z1, z2, z3, z4, z5, z6, z7 = z[s], z[s + 1], z[s + 2], z[s + 3], z[s + 4], z[s + 5], z[s + 6], z[s + 7]
    for t in range(nt):
        near = np.int32(0)
        a, b, c = x[t] - x0, y[t] - y0, z[t] - z0
        near |= np.int32(1) if a * a + b * b + c * c <= r2 else np.int32(0)
        a, b, c = x[t] - x1, y[t] - y1, z[t] - z1
        near |= np.int32(2) if a * a + b * b + c * c <= r2 else np.int32(0)
        a, b, c = x[t] - x2, y[t] - y2, z[t] - z2
        near |= np.int32(4) if a * a + b * b + c * c <= r2 else np.int32(0)
        a, b, c = x[t] - x3, y[t] - y3, z[t] - z3
        near |= np.int32(8) if a * a + b * b + c * c <= r2 else np.int32(0)
        a, b, c = x[t] - x4, y[t] - y4, z[t] - z4
        near |= np.int32(16) if a * a + b * b + c * c <= r2 else np.int32(0)
        a, b, c = x[t] - x5, y[t] - y5, z[t] - z5
        near |= np.int32(32) if a * a + b * b + c * c <= r2 else np.int32(0)
        a, b, c = x[t] - x6, y[t] - y6, z[t] - z6
        near |= np.int32(64) if a * a + b * b + c * c <= r2 else np.int32(0)
        a, b, c = x[t] - x7, y[t] - y7, z[t] - z7
        near |= np.int32(128) if a * a + b * b + c * c <= r2 else np.int32(0)
        who[t] = near


PIECES = place16, arrange16
