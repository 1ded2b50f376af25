"""Compiled hooks: functions they share, and their arguments in memory."""
from __future__ import annotations

import importlib
import os
import pkgutil
import subprocess
import sys
import types
from typing import NamedTuple

import numba
import numpy as np
import pytest
from lj_cell import BASE
from wheel import ran

import asemd.fix as fixes
from asemd.kernels import packed
from asemd.kernels.generate import Builder
from asemd.kernels.hooks import shared
from asemd.style import text_of


def test_functions_that_a_hook_uses_have_names_of_their_own():
    """A hook is a module of its own with what it uses: one function for a name."""
    names = set()
    for module in pkgutil.iter_modules(fixes.__path__):
        for kind in vars(importlib.import_module(f"asemd.fix.{module.name}")).values():
            for hook in vars(kind).values() if isinstance(kind, type) else ():
                found = {}
                for helper in getattr(getattr(hook, "__func__", hook), "uses", ()):
                    other = found.setdefault(helper.__name__, helper)
                    assert text_of(other) == text_of(helper), f"{helper.__name__} of {other.__module__} and {helper.__module__}"
                names |= set(found)
    assert len(names) > 10


def test_two_functions_of_one_name_are_refused():
    def twice(x):
        return 2.0 * x
    first = twice

    def twice(x):      # noqa: F811
        return x + x

    def user(x):
        return twice(x)
    shared(user, (first, first))
    with pytest.raises(NameError, match="two functions named twice"):
        shared(user, (first, twice))
    b = Builder("two of a name")
    b.function(first)
    b.function(first)
    with pytest.raises(NameError, match="two functions named twice"):
        b.function(twice)
    assert b.source().count("import twice") == 1


def test_what_a_function_calls_must_be_there():
    """Compiled or not, and before anything runs."""
    def half(x):
        return 0.5 * x

    def quarter(x):
        return half(half(x))
    b = Builder("without half")
    b.function(quarter)
    with pytest.raises(NameError, match="quarter needs half, which this module of kernels lacks"):
        b.build()
    b.function(half)
    assert b.build().quarter(2.0) == 0.5


def test_memory_has_the_layout_of_the_compiler():
    """What is packed by Python is read back by compiled code, member by member."""
    x = np.arange(12.0).reshape(3, 4)
    rows = np.arange(5, dtype=np.int32)
    every_second = np.arange(9.0)[::2].copy()
    numbers = (np.float32(0.25), np.float32(-3.0), -7, 1e300)
    kind = numba.typeof((x, (rows, every_second), numbers))
    source = packed.text_of_type(kind)
    read = packed.reader(eval(source, {"types": numba.types}))
    memory: list[int] = []
    packed.pack((x, (rows, every_second), numbers), memory)
    block = np.array(memory, np.int64)

    @numba.njit
    def look(address):
        a, (b, c), d = read(address)
        a[1, 2] = -1.0
        return a.sum(), a.shape, b[3], b.size, c[4], c.strides[0], d
    assert look(block.ctypes.data) == (66.0 - 6.0 - 1.0, (3, 4), 3, 5, 8.0, 8, (0.25, -3.0, -7, 1e300))
    assert x[1, 2] == -1.0


def _copied(thread, arguments):
    out, bytes_, floats = read(arguments)      # noqa: F821
    for k in range(len(out)):
        out[k] = taken(bytes_, floats, k)      # noqa: F821


@pytest.mark.skipif(packed.WITHOUT_COMPILER, reason="nothing is compiled")
def test_references_to_arrays_are_not_counted():
    """What is handed on from memory has no owner: no call in a loop counts references, and no array is taken for another."""
    @numba.njit(no_cpython_wrapper=True)
    def taken(bytes_, floats, k):
        return bytes_[k] + floats[1][k, 0]

    values = np.zeros(3), np.arange(3, dtype=np.uint8), (2.0, np.arange(6.0).reshape(3, 2))
    block = packed.Block(values)
    read = packed.reader(numba.typeof(values))
    code = types.FunctionType(_copied.__code__, {"read": read, "taken": taken})
    call = numba.cfunc(numba.void(numba.int64, numba.int64))(code)
    packed.enter_at(call.address, 0, packed.handle(block.memory))
    assert values[0].tolist() == [0.0, 3.0, 6.0]
    text = call._library.get_llvm_str()
    assert "@NRT_incref" not in text and "@NRT_decref" not in text


def test_memory_takes_other_values_of_the_same_types():
    x, y = np.arange(3.0), np.arange(4.0)
    block = packed.Block((x, (1, y), 2.5))
    memory = block.memory
    assert block.take((x, (7, x), 0.5)) and block.memory is memory
    assert memory.tolist() == packed.block((x, (7, x), 0.5)).tolist()
    for other in ((x, (7, x)), (x, (7, x.astype(np.float32)), 0.5), (x, x, 0.5), (x, (7, x, x), 0.5), (x, (7.0, x), 0.5)):
        assert not packed.Block((x, (7, x), 0.5)).take(other)


class Pair(NamedTuple):
    left: np.ndarray
    right: np.ndarray


def test_hooks_take_named_tuples():
    pair = Pair(np.arange(3.0), np.arange(4.0))
    kind = numba.typeof(pair)
    assert eval(packed.text_of_type(kind), {"types": numba.types, "import_module": importlib.import_module}) == kind


def test_state_and_numbers_are_as_packed():
    lmp = ran(BASE + "run 1")
    loop = lmp.session.loop
    assert numba.typeof(loop.state) == packed.STATE and numba.typeof(loop._thread()) == packed.THREAD
    with pytest.raises(TypeError, match="C-contiguous arrays"):
        packed.text_of_type(numba.typeof("x"))
    with pytest.raises(ValueError, match="contiguous"):
        packed.pack((np.zeros((3, 3))[:, :2],), [])


@pytest.mark.parametrize("fix", ["wall/lepton xlo -1.0 k*(r-rc)^2;k=2 2.5", "rigid/nvt molecule temp 1.0 1.0 0.1"])
def test_without_compiler_hooks_find_what_they_use(fix):
    """What stands in `uses` need not be a name of the module of the hook."""
    lines = ["units lj", "atom_style molecular", "boundary f p p", "lattice sc 0.5", "region r block 0 3 0 3 0 3", "create_box 1 r",
             "create_atoms 1 box", "set type 1 mol 1", "mass 1 1", "pair_style zero 1.5", "pair_coeff * *", "velocity all create 1.0 7",
             f"fix 1 all {fix}", *(["fix 2 all nve"] if "wall" in fix else []), "run 2"]
    code = "import sys; from asemd.lammps import Lammps; lmp = Lammps(cmdargs=['-screen', 'none', '-log', 'none']); " \
           f"lmp.commands_list({lines!r}); print(sum(abs(v) for v in lmp.gather_atoms('x', 1, 3)))"
    done = subprocess.run([sys.executable, "-W", "ignore", "-c", code], capture_output=True, text=True,
                          env={**os.environ, "NUMBA_DISABLE_JIT": "1"})
    assert done.returncode == 0, done.stderr[-1000:]
    assert 0.0 < float(done.stdout) < 1000.0
