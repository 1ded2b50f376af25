"""Vectors in compiled code: tuples of three numbers, made and used by plain functions that compile to a few instructions each.

Loops written with them have a tenth of the statements, and compile as much faster. Every operation rounds as it is written here.
"""
from __future__ import annotations

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import lower_builtin, type_callable

NUMBER, TRIPLE, NUMBERS = types.float64, types.UniTuple(types.float64, 3), types.CPointer(types.float64)
ROW = 72        # length of the rows of a block, see `asemd.kernels.block`


def number(b, row, k):
    """The number in a row and column of a block."""
    return b[row * ROW + k]


def put(b, row, k, value):
    """Write a number."""
    b[row * ROW + k] = value


def triple(b, row, k):
    """The vector in column k whose x is in a row; y and z are in the next two."""
    return b[row * ROW + k], b[(row + 1) * ROW + k], b[(row + 2) * ROW + k]


def store(b, row, k, a):
    """Write a vector."""
    b[row * ROW + k], b[(row + 1) * ROW + k], b[(row + 2) * ROW + k] = a


def narrow():
    """In a function: its vectors have 256 bits. Wider ones lower the clock of the processor, which single loads and stores pay for."""


def pointer(b):
    """Where the numbers of an array are: what is read there is not tested for the length or negative places, so that loops vectorise."""
    return b


def member(items, m, place):
    """The atom at a place of an item."""
    return int(items[m, place])


def between(x, i, j):
    """The vector from atom j to atom i of positions (3, n)."""
    return x[0, i] - x[0, j], x[1, i] - x[1, j], x[2, i] - x[2, j]


def push(out, i, a):
    """Add a vector to that of atom i in (3, n)."""
    for d in range(3):
        out[d, i] += a[d]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def times(w, a):
    return w * a[0], w * a[1], w * a[2]


def plus(a, b):
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def minus(a, b):
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def product(a, b):
    """The products of the components."""
    return a[0] * b[0], a[1] * b[1], a[2] * b[2]


FUNCTIONS = (narrow, number, put, triple, store, pointer, member, between, push, dot, cross, times, plus, minus, product)


# ------------------------------------------------------------- compiled ---

def _compiled(function, result, *kinds):
    """Compile a function as the instructions that ``emit(builder, array, *values)`` writes; vectors come apart and go together here."""
    def decorate(emit):
        type_callable(function)(lambda context: _typer(len(kinds), result))

        @lower_builtin(function, *kinds)
        def generate(context, builder, signature, arguments):
            def array(n):
                return context.make_array(signature.args[n])(context, builder, arguments[n])
            values = [cgutils.unpack_tuple(builder, v, 3) if kind is TRIPLE else v for kind, v in zip(kinds, arguments)]
            out = emit(builder, array, *values)
            if result is TRIPLE:
                return cgutils.pack_array(builder, out)
            return out if result is not types.void else context.get_dummy_value()
        return emit
    return decorate


def _typer(count, result):
    return {0: lambda: result, 1: lambda a: result, 2: lambda a, b: result, 3: lambda a, b, c: result, 4: lambda a, b, c, d: result}[count]


def _place(builder, b, row, k, more=0):
    whole = ir.IntType(64)
    start = builder.mul(builder.add(builder.sext(row, whole), whole(more)), whole(ROW), flags=["nsw"])
    return builder.gep(b, [builder.add(start, builder.sext(k, whole), flags=["nsw"])])


def _entry(builder, array, row, column):
    """Where an entry of an array with rows one after the other is; negative places and those beyond its shape are not looked for."""
    width = cgutils.unpack_tuple(builder, array.shape, 2)[1]
    place = builder.add(builder.mul(builder.sext(row, width.type), width, flags=["nsw"]), builder.sext(column, width.type), flags=["nsw"])
    return builder.gep(array.data, [place])


def _component(builder, array, d, i):
    return _entry(builder, array, ir.IntType(64)(d), i)


@_compiled(narrow, types.void)
def _narrow(builder, array):
    set.add(builder.function.attributes, '"prefer-vector-width"="256"')     # `add` of llvmlite knows attributes without values only


@_compiled(number, NUMBER, NUMBERS, types.Integer, types.Integer)
def _number(builder, array, b, row, k):
    return builder.load(_place(builder, b, row, k))


@_compiled(put, types.void, NUMBERS, types.Integer, types.Integer, NUMBER)
def _put(builder, array, b, row, k, value):
    builder.store(value, _place(builder, b, row, k))


@_compiled(triple, TRIPLE, NUMBERS, types.Integer, types.Integer)
def _triple(builder, array, b, row, k):
    return [builder.load(_place(builder, b, row, k, d)) for d in range(3)]


@_compiled(store, types.void, NUMBERS, types.Integer, types.Integer, TRIPLE)
def _store(builder, array, b, row, k, a):
    for d in range(3):
        builder.store(a[d], _place(builder, b, row, k, d))


@_compiled(pointer, NUMBERS, types.Array)
def _pointer(builder, array, b):
    return array(0).data


@_compiled(member, types.int64, types.Array, types.Integer, types.Integer)
def _member(builder, array, items, m, place):
    return builder.zext(builder.load(_entry(builder, array(0), m, place)), ir.IntType(64))


@_compiled(between, TRIPLE, types.Array, types.Integer, types.Integer)
def _between(builder, array, x, i, j):
    a = array(0)
    return [builder.fsub(*(builder.load(_component(builder, a, d, atom)) for atom in (i, j))) for d in range(3)]


@_compiled(push, types.void, types.Array, types.Integer, TRIPLE)
def _push(builder, array, out, i, a):
    for d in range(3):
        at = _component(builder, array(0), d, i)
        builder.store(builder.fadd(builder.load(at), a[d]), at)


@_compiled(dot, NUMBER, TRIPLE, TRIPLE)
def _dot(builder, array, a, b):
    x, y, z = (builder.fmul(p, q) for p, q in zip(a, b))
    return builder.fadd(builder.fadd(x, y), z)


@_compiled(cross, TRIPLE, TRIPLE, TRIPLE)
def _cross(builder, array, a, b):
    return [builder.fsub(builder.fmul(a[p], b[q]), builder.fmul(a[q], b[p])) for p, q in ((1, 2), (2, 0), (0, 1))]


@_compiled(times, TRIPLE, NUMBER, TRIPLE)
def _times(builder, array, w, a):
    return [builder.fmul(w, p) for p in a]


for _function, _operation in ((plus, "fadd"), (minus, "fsub"), (product, "fmul")):
    _compiled(_function, TRIPLE, TRIPLE, TRIPLE)(
        lambda builder, array, a, b, operation=_operation: [getattr(builder, operation)(p, q) for p, q in zip(a, b)])
