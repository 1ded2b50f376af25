"""Hooks of fixes called by their address, their arguments in memory: the time loop is compiled once, whatever fixes take part in it.

A hook is compiled as ``entry(thread, arguments)``, two addresses. Behind the first is a `Thread`; behind the second the address of the
`State`, then the fix's numbers and arrays, all in the layout of numba's tuples and arrays, whose members are 8 bytes each. A hook reads
only what it uses: the compiler drops the rest. Without compiler (``NUMBA_DISABLE_JIT``) hooks are plain functions and nothing is packed.
"""
from __future__ import annotations

import struct
import weakref

import numba
import numpy as np
from llvmlite import ir
from numba import cfunc, config, types
from numba._dispatcher import compute_fingerprint
from numba.core.imputils import impl_ret_borrowed
from numba.extending import intrinsic, overload

from asemd.kernels.state import BoxState, State, Thread, cell_arrays, empty_state
from asemd.kernels.target import njit

_ROWS, _THREES, _FOURS = np.zeros(3), np.zeros((3, 3)), np.zeros((4, 4))
_CELL = cell_arrays(np.eye(3), np.ones(3))
_BOX = BoxState(_THREES, _ROWS, _ROWS, _CELL, _THREES, _THREES, _THREES, _FOURS, _THREES, _THREES, _THREES, _ROWS)
STATE = numba.typeof(empty_state(8, np.zeros(1, np.int32), np.zeros((1, 3), np.int32), np.zeros((1, 1, 8)), _BOX))
THREAD = numba.typeof(Thread(0, 1, 0, 1, 0, 0, 0, 0.0, np.zeros(8, np.int64), np.zeros((1, 8)), 0))
NUMBERS = types.Array(types.float64, 1, "C")
LAYOUT = " ".join(State._fields + BoxState._fields)      # hooks are compiled for it
_DOUBLE, _SINGLE, _BITS = struct.Struct("d"), struct.Struct("ff"), struct.Struct("q")
WITHOUT_COMPILER = bool(config.DISABLE_JIT)
HANDLE = object if WITHOUT_COMPILER else np.int64
OWNERS = 2      # the first members of an array say whose its memory is


def _members(array: np.ndarray) -> tuple[int, ...]:
    """What numba's value of an array is made of; remembered as long as the array is there, for it takes some microseconds."""
    if not array.flags.c_contiguous:
        raise ValueError("arrays that are called by address are C-contiguous")
    key = id(array)
    members = (0, 0, array.size, array.itemsize, array.__array_interface__["data"][0], *array.shape, *array.strides)
    _arrays[key] = weakref.ref(array, lambda gone: _arrays.pop(key, None)), members
    return members


_arrays: dict[int, tuple[weakref.ref, tuple[int, ...]]] = {}


def pack(values: tuple, into: list[int]) -> None:
    """Append what numba's value of a tuple is made of: of an array no owner, then size, address, shape and strides.

    Raises
    ------
    ValueError
        An array is not C-contiguous.
    """
    for value in values:
        if isinstance(value, np.ndarray):
            known = _arrays.get(id(value))
            into += known[1] if known is not None and known[0]() is value else _members(value)
        elif isinstance(value, tuple):
            pack(value, into)
        elif isinstance(value, np.float32):
            into.append(_BITS.unpack(_SINGLE.pack(value, 0.0))[0])
        else:
            into.append(int(value) if isinstance(value, (int, np.integer)) else _BITS.unpack(_DOUBLE.pack(value))[0])


def block(value):
    """A tuple in memory; its arrays must live as long as it is used."""
    if WITHOUT_COMPILER:
        return value
    into: list[int] = []
    pack(value, into)
    return np.array(into, np.int64)


class Block:
    """A tuple in memory that may take other values of the same types; its arrays live as long as it does.

    Attributes
    ----------
    memory : (m,) int64, or the tuple itself where nothing is compiled
    """

    def __init__(self, values: tuple):
        self.values, self.places, self.memory = values, [], values
        if not WITHOUT_COMPILER:
            into: list[int] = []
            self.places = _places(values, into)
            self.memory = np.array(into, np.int64)

    def take(self, values: tuple) -> bool:
        """Other values of the same kind of tuple: only those that are others are packed. False if one is of another type, or where nothing
        is compiled: a new block is needed then."""
        known, self.values = self.values, values
        return not WITHOUT_COMPILER and _take(values, known, self.places, self.memory)


def _places(values: tuple, into: list[int]) -> list:
    """Where each value of a tuple begins, as it is packed; of a tuple within, such a list."""
    places: list = []
    for value in values:
        if isinstance(value, tuple):
            places.append(_places(value, into))
        else:
            places.append(len(into))
            pack((value,), into)
    return places


def _take(values: tuple, known: tuple, places: list, memory: np.ndarray) -> bool:
    """See `Block.take`."""
    if len(values) != len(places):
        return False
    for value, old, place in zip(values, known, places):
        if value is old:
            continue
        if isinstance(place, list):
            if not isinstance(value, tuple) or not _take(value, old, place, memory):
                return False
        elif text_of_arguments((value,)) != text_of_arguments((old,)):
            return False
        else:
            into: list[int] = []
            pack((value,), into)
            memory[place:place + len(into)] = into
    return True


def arguments(state_block, numbers):
    """A hook's arguments in memory: the state's `block`, and a fix's (numbers, arrays); all must live as long as they are used."""
    if WITHOUT_COMPILER:
        return (state_block, *numbers)
    into = [handle(state_block)]
    pack(numbers, into)
    return np.array(into, np.int64)


def handle(memory):
    """What stands for a block of memory in a call: its address."""
    return memory if WITHOUT_COMPILER else memory.ctypes.data


def text_of_type(kind) -> str:
    """Python text for the type of what can be packed; it may use ``types`` and ``import_module``.

    Raises
    ------
    TypeError
        It is something else than an array, a whole number of 8 bytes, a double or single, or a tuple of these.
    """
    if isinstance(kind, types.Array) and kind.layout == "C":
        return f"types.Array(types.{kind.dtype}, {kind.ndim}, 'C', readonly={not kind.mutable}, aligned={kind.aligned})"
    if isinstance(kind, types.BaseTuple):
        members, named = "".join(text_of_type(k) + ", " for k in kind.types), getattr(kind, "instance_class", None)
        owner = f", import_module({named.__module__!r}).{named.__qualname__}" if named else ""
        return f"types.BaseTuple.from_types(({members}){owner})"
    if kind in (types.int64, types.float64, types.float32):
        return f"types.{kind}"
    raise TypeError(f"what is called by address gets C-contiguous arrays, numbers, and tuples of them: {kind} is not")


def text_of_arguments(value) -> str:
    """`text_of_type` of a value's type; nothing where nothing is compiled."""
    if WITHOUT_COMPILER:
        return ""
    key = compute_fingerprint(value)
    if key not in _texts:
        _texts[key] = text_of_type(numba.typeof(value))
    return _texts[key]


_texts: dict[bytes, str] = {}


def _size(kind) -> int:
    """How many members of 8 bytes a value of that type has in memory."""
    if isinstance(kind, types.BaseTuple):
        return sum(map(_size, kind.types))
    return 5 + 2 * kind.ndim if isinstance(kind, types.Array) else 1


def _read(context, builder, first, at: int, kind, only=None):
    """The value of a type that begins at place `at`; of a tuple `only` some members, whose loads are all that is written."""
    whole = context.get_value_type(kind)
    if not isinstance(kind, types.BaseTuple | types.Array):
        return _load(builder, first, at, whole)
    value = ir.Constant(whole, None)      # zeros: an array that is not read has no owner to be counted
    if isinstance(kind, types.Array):
        for k, member in enumerate(whole.elements):
            if k >= OWNERS:      # nor has any other, as the compiler shall know: it leaves the counting out
                value = builder.insert_value(value, _load(builder, first, at + k, member), k)
                at += getattr(member, "count", 1) - 1
        return value
    for k, member in enumerate(kind.types):
        if only is None or k in only:
            value = builder.insert_value(value, _read(context, builder, first, at, member), k)
        at += _size(member)
    return value


def _load(builder, first, at: int, kind):
    """What has that type of LLVM and begins at place `at`."""
    return builder.load(builder.bitcast(builder.gep(first, [ir.Constant(ir.IntType(64), at)]), kind.as_pointer()))


def reader(kind, fields=None):
    """A function for compiled code that takes an address and returns the value of that type which is there; of a tuple with names only
    some `fields`, if given: writing out the rest takes the compiler its time."""
    only = None if fields is None else [kind.fields.index(name) for name in fields]

    @intrinsic
    def read(context, address):
        def generate(ctx, builder, signature, arguments):
            first = builder.inttoptr(arguments[0], ir.IntType(64).as_pointer())
            return impl_ret_borrowed(ctx, builder, kind, _read(ctx, builder, first, 0, kind, only))
        return kind(types.int64), generate
    return read


read_address, read_thread, read_numbers = (reader(k) for k in (types.int64, THREAD, NUMBERS))
AFTER_STATE, AFTER_NUMBERS = 8, 64      # where the fix's numbers and its arrays begin


def entry(**options):
    """Compile ``function(thread, arguments)`` so that it has an address."""
    def compiled(function):
        signature, options_ = types.void(types.int64, types.int64), {"nopython": True, "error_model": "numpy", **options}
        try:
            return cfunc(signature, cache=True, **options_)(function)
        except (OSError, RuntimeError):      # no room on the disk, or no file: compiled for this process only
            return cfunc(signature, **options_)(function)
    return compiled


def call(function, th, arguments):
    """Call a hook, in compiled code by its address."""
    function(th, *arguments)


@intrinsic
def _call(context, function, th, arguments):
    def generate(ctx, builder, signature, values):
        whole = ir.IntType(64)
        with builder.goto_entry_block():
            place = builder.alloca(values[1].type)
        builder.store(values[1], place)
        address = builder.inttoptr(values[0], ir.FunctionType(ir.VoidType(), [whole, whole]).as_pointer())
        builder.call(address, [builder.ptrtoint(place, whole), values[2]])
        return ctx.get_dummy_value()
    return types.void(types.int64, th, types.int64), generate


@overload(call, inline="always")
def _compiled_call(function, th, arguments):
    return lambda function, th, arguments: _call(function, th, arguments)


@njit(cache=True, nogil=True)
def act(kind, th, calls, starts):
    """Call all hooks of one kind: (function, arguments, every) of each, where the calls of each kind begin."""
    for k in range(starts[kind], starts[kind + 1]):
        if th.step % calls[k, 2] == 0:
            call(calls[k, 0], th, calls[k, 1])


@njit(cache=True, nogil=True)
def enter(function, th, arguments):
    """Call a hook from Python."""
    call(function, th, arguments)


@intrinsic
def _call_at(context, function, thread, arguments):
    def generate(ctx, builder, signature, values):
        whole = ir.IntType(64)
        builder.call(builder.inttoptr(values[0], ir.FunctionType(ir.VoidType(), [whole, whole]).as_pointer()), values[1:])
        return ctx.get_dummy_value()
    return types.void(types.int64, types.int64, types.int64), generate


@njit(cache=True, nogil=True)
def enter_at(function, thread, arguments):
    """Call from Python what takes the addresses of a thread and of its arguments."""
    _call_at(function, thread, arguments)
