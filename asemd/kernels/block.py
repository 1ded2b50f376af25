"""Bonded forces by blocks of items: what all internal coordinates have in common.

The items of a block are columns of one flat buffer whose rows are ROW apart (a constant, so that the compiler sees no aliasing): the
vectors between the atoms (row V1, then V2, V3), the forces along them (F1, F2, F3), the coordinates, the derivatives (from D on), the
energy (E), what the coordinate keeps for itself (SHAPE, or 0: positive unless the geometry is degenerate; VALUE, what to report) and the
coefficients (from P on). Every loop but `gather` and `scatter` runs over neighbouring numbers, so that it becomes vector code.

The style comes in as the address of a function of a block: `forces` is compiled once for all styles of the same coordinates.
`asemd.kernels.bonded` pastes it together with the functions of a coordinate (`gather`, `geometry`, `gradient`, `scatter`; for items with a
past `recall` and `part`, for the side of a plane `settle`) and writes out the constants: rows, SKEW (the cell), HISTORY; see there for
the arguments.
"""
from __future__ import annotations

import math

import numpy as np
from llvmlite import ir
from numba import carray, cfunc, config, types
from numba.core import cgutils
from numba.extending import intrinsic, overload

from asemd.kernels.algebra import NUMBERS, member, narrow, number, plus, pointer, product, put, store, triple

BLOCK = 64
VECTORS = STRESS = ATOMS = V1 = F1 = D = SLOPES = E = SHAPE = VALUE = P = 0
SKEW = HISTORY = False
SIDE = 0
gather = sides_of = skewed = geometry = settle = gradient = scatter = recall = part = None


def block_function(function):
    """Compile ``function(n, b, table, rows, columns)`` of a generated module so that it has an address."""
    if config.DISABLE_JIT:
        return function
    signature = types.void(types.int64, NUMBERS, NUMBERS, types.int64, types.int64)
    try:
        return cfunc(signature, nopython=True, cache=True, error_model="numpy")(function)
    except (OSError, RuntimeError):      # no room on the disk: compiled for this process only
        return cfunc(signature, nopython=True, error_model="numpy")(function)


def call(function, n, b, table):
    """Call a block function, in compiled code by its address."""
    function(n, b, table, *table.shape)


def as_table(numbers, rows, columns):
    """The table that a block function got, as an array."""
    return numbers


@intrinsic
def _call(context, function, n, b, table):
    def generate(ctx, builder, signature, arguments):
        numbers, whole = ir.DoubleType().as_pointer(), ir.IntType(64)
        kind = ir.FunctionType(ir.VoidType(), [whole, numbers, numbers, whole, whole])
        array = ctx.make_array(signature.args[3])(ctx, builder, arguments[3])
        address = builder.inttoptr(arguments[0], kind.as_pointer())
        builder.call(address, [arguments[1], arguments[2], array.data, *cgutils.unpack_tuple(builder, array.shape, 2)])
        return ctx.get_dummy_value()
    return types.void(types.int64, types.int64, NUMBERS, table), generate


@overload(call, inline="always")
def _compiled_call(function, n, b, table):
    return lambda function, n, b, table: _call(function, n, b, table)


@overload(as_table, inline="always")
def _compiled_table(numbers, rows, columns):
    return lambda numbers, rows, columns: carray(numbers, (rows, columns))


def coefficients(kind, types, first, n, coeff, b):
    """Coefficients of the items into their rows. Returns the type that all columns have now, -1 if there are several."""
    t = np.int64(types[first])
    others = 0
    for k in range(n):
        others += types[np.uint64(first + k)] != t
    if others > 0:
        for c in range(coeff.shape[0]):
            for k in range(n):
                put(b, P + c, k, coeff[np.uint64(c), np.uint32(types[np.uint64(first + k)])])
    elif t != kind:
        for c in range(coeff.shape[0]):
            for k in range(BLOCK):
                put(b, P + c, k, coeff[c, t])
    return t if others == 0 else -1


def odd(b, k, energy):
    """Not zero if an item is outside the domain of its style, or has two atoms at one place."""
    s = number(b, E, k) if energy else 0.0
    for c in range(SLOPES):
        s += number(b, D + c, k)
    if SHAPE:
        s = s if number(b, SHAPE, k) > 0.0 else math.nan
    return not s - s == 0.0


def report(b, n, first, energy, bad):
    """Take odd items out, and remember the first one."""
    for k in range(n):
        wrong = odd(b, k, energy)
        if wrong:
            if bad[0] == 0.0:
                value = number(b, VALUE, k)
                if SHAPE:
                    value = value if number(b, SHAPE, k) > 0.0 else math.nan
                bad[0], bad[1], bad[2] = 1.0, first + k, value
            for c in range(VECTORS):
                store(b, V1 + 3 * c, k, (0.0, 0.0, 0.0))
                store(b, F1 + 3 * c, k, (0.0, 0.0, 0.0))
            put(b, E, k, 0.0)


def sums(b, n, acc):
    """Energy and virial of a block, added one by one: how items fall into blocks must not show in the last digits."""
    total, along, across = acc[0], (acc[2], acc[3], acc[4]), (acc[5], acc[6], acc[7])
    for k in range(n):
        total += number(b, E, k)
        for c in range(STRESS):
            d, f = triple(b, V1 + 3 * c, k), triple(b, F1 + 3 * c, k)
            along = plus(along, product(d, f))
            across = plus(across, product((d[0], d[0], d[1]), (f[1], f[2], f[2])))
    acc[0] = total
    for c in range(3):
        acc[2 + c] = along[c]
        acc[5 + c] = across[c]


def shares(items, first, n, b, atom_energy, atom_virial):
    """Equal shares for the atoms of an item, as LAMMPS counts energy and stress per atom."""
    for k in range(n):
        for a in range(ATOMS):
            i = member(items, first + k, a)
            atom_energy[i] += 1.0 / ATOMS * number(b, E, k)
            for c in range(STRESS):
                d, f = triple(b, V1 + 3 * c, k), triple(b, F1 + 3 * c, k)
                along, across = product(d, f), product((d[0], d[0], d[1]), (f[1], f[2], f[2]))
                for q in range(3):
                    atom_virial[q, i] += 1.0 / ATOMS * along[q]
                    atom_virial[3 + q, i] += 1.0 / ATOMS * across[q]


def forces(th, x, out, items, types, cell, coeff, arrays, lo, hi, acc, atom_energy, atom_virial, bad, function, room):
    narrow()
    level = th.level
    energy = min(level, 1)
    kind, b = -1, pointer(room)
    sides = sides_of(cell)
    for first in range(lo, hi, BLOCK):
        n = min(BLOCK, hi - first)
        kind = coefficients(kind, types, first, n, coeff, b)
        gather(x, items, first, n, b)
        if SKEW:
            skewed(b, n, cell)
        geometry(b, n, sides)
        if SIDE:
            settle(b, n, first, x, items)
        if HISTORY:
            recall(b, n, first, lo, hi, items, types, arrays, level)
        call(function[energy], n, b, arrays[0])
        if HISTORY:
            part(b, n, first, items, types, arrays, x, level)
        gradient(b, n)
        count = 0
        for k in range(n):
            count += odd(b, k, energy)
        if count > 0:
            report(b, n, first, energy, bad)
        scatter(out, items, first, n, b)
        if energy:
            sums(b, n, acc)
        if level > 1:
            shares(items, first, n, b, atom_energy, atom_virial)
