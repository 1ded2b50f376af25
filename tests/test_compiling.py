"""What makes numba compile faster: the code stays the same, garbage is collected again afterwards."""
from __future__ import annotations

import gc
import json
import os
import platform
import re
import subprocess
import sys

import numba
import numpy as np
import pytest
from numba.core import analysis, errors
from numba.core.codegen import JITCPUCodegen
from numba.core.compiler import Flags
from numba.core.cpu_options import FastMathOptions

import asemd.kernels.target  # noqa: F401   which installs it
from asemd import style as registry
from asemd.kernels import compiling, generate, intermediate, pair

PROGRAM = """
import json
import math
import re
import sys

import numpy as np
from numba import njit
from numba.core.types.functions import BaseFunction

from asemd.kernels import compiling

if sys.argv[1] == "faster":
    compiling.install()
searches, search = 0, compiling.look_up

def counted(*arguments):
    global searches
    searches += 1
    return search(*arguments)

if sys.argv[1] == "faster":
    compiling.look_up = counted
else:
    BaseFunction.get_call_type = counted

@njit(fastmath=True)
def loose(a, b):
    return max(a, 2) + math.pow(b, 3) * round(a) + abs(b)

@njit
def strict(a, b):
    return max(a, 2) + math.pow(b, 3) * round(a) + abs(b)

@njit
def kernel(x, n):
    out = np.zeros((3, len(n)))
    for k in range(1, len(n), 2):
        i, j = n[k] & 3, n[k - 1] >> 2
        out[0, k] = loose(x[i], x[j]) - strict(x[j], x[i])
        out[1, k] = math.sqrt(x[i] * x[j]) if x[i] > x[j] and not i == 2 else -x[i] // 3 % 2
        out[2] += x[i] * 2
    return out[:2].sum(), out.T.copy(), min(n), float(n[0])

@njit
def assigned_again(x):
    total, last, n = 0.0, 1.0, 0
    while total < 10.0 and n < len(x):
        if x[n] > last:
            last = x[n]
            total = total + last
        elif x[n] < 0.0:
            total, last = last, total
            continue
        for k in range(n):
            part = x[k] if k & 1 else last
            if part > 3.0:
                break
            total = total - part
            y = x[k:].copy()
            last = last + y[0]
        n = n + 1
    return total, last, n

@njit
def yields(n, x):
    for k in range(n):
        part = x[k] * 2.0
        yield part
        part = part + 1.0
        yield part

@njit
def reads(n, x):
    total = 0.0
    for value in yields(n, x):
        total = total + value
    return total

kernel(np.arange(5.0), np.arange(5))
assert assigned_again(np.arange(7.0)) == assigned_again.py_func(np.arange(7.0))
assert reads(3, np.arange(7.0)) == 15.0

def code(f):      # what the function has, without wrappers; names are numbered, for they depend on options
    (text,) = f.inspect_asm().values()
    own = re.search(rf"^_ZN\\S*{f.__name__}\\S*:.*?^\\.Lfunc_end", text, re.M | re.S)[0]
    names = {}
    return re.sub(r"_ZN\\w+", lambda m: names.setdefault(m[0], f"name{len(names)}"), own)

print(json.dumps([searches, [code(f) for f in (loose, strict, kernel, assigned_again)]]))
"""
WRAPPERS = """
import sys

from numba import njit
from asemd.kernels.generate import Builder

b = Builder("a function and one that calls it")
b.text("def half(x):\\n    return 0.5 * x")
b.text("def quarter(x):\\n    return half(half(x))")
module = b.build()
if sys.argv[1] == "caller":
    assert module.quarter(3.0) == 0.75
    assert "wrapper" not in "".join(module.half.inspect_asm().values())
else:
    assert module.half(3.0) == 1.5
    stats = module.half.stats
    assert [sum(stats.cache_hits.values()), sum(stats.cache_misses.values())] == [1, int(sys.argv[2])]
    assert module.half(3) == 1.5 and len(module.half.signatures) == 2
    assert module.quarter(3.0) == 0.75
"""
LONG = """
import re
import sys
from pathlib import Path

from asemd.kernels import generate, target

def unlike(k):      # names of functions are numbered as they are compiled
    b = generate.Builder(f"number {k}")
    b.text(f"def other(x):\\n    return x + {k}")
    assert b.build().other(1) == 1 + k

long, short = generate.Builder("a long function"), generate.Builder("a short one")
long.text("def long(x):\\n" + "".join(f"    x = math.sin(x * {k}.5) + x / (x - 0.{k})\\n" for k in range(1, 90)) + "    return x")
short.text("def short(x):\\n    return x * x + 1.0")
long, short = long.build(), short.build()

def caller(k):
    b = generate.Builder(f"caller {k}")
    b.use(long, "long")
    b.use(short, "short")
    b.text(f"def caller(x):\\n    return long(short(x)) * {2.0 ** k}")
    return b.build().caller

for k in range(int(sys.argv[1])):
    unlike(k)
missing = int(sys.argv[2])
callers = [caller(int(k)) for k in sys.argv[3:]]
print(*[repr(f(0.3) / 2 ** int(k)) for f, k in zip(callers, sys.argv[3:])])
assert [sum(f.stats.cache_misses.values()) for f in callers] == [missing] * len(callers)
if missing:
    for f in callers:
        (code,) = f.inspect_asm().values()
        assert "6caller" in code and re.findall(r"^_ZN13asemd_kernels\\w*?\\d([a-z]+)B\\w+:", code, re.M) == ["caller"]
        (library,) = [one.library for one in f.overloads.values()]
        assert ["long" in name for name in library.calls] == [True]
else:
    assert not long.long.overloads      # it is there, but numba does not know it
for path in generate.cache_dir().glob(f"__pycache__/{long.__name__.split('.')[1]}*.nb?"):
    path.unlink()      # the next process that compiles a caller compiles this once more
"""

BEFORE = """
import sys
from asemd.kernels import generate, target

keep = target.OwnCopies.serialize_using_object_code
if sys.argv[1] == "before":
    target.OwnCopies.serialize_using_object_code = lambda self: keep(self)[:3]
b = generate.Builder("what a former version compiled")
b.text("def half(x):\\n    return 0.5 * x")
module = b.build()
assert module.half(3.0) == 1.5
assert sum(module.half.stats.cache_hits.values()) == (sys.argv[1] == "now")
"""


def test_the_code_is_the_same_and_made_with_fewer_searches():
    env = {**os.environ, "NUMBA_DISABLE_JIT": "0"}
    (plain, theirs), (faster, ours) = (json.loads(subprocess.run([sys.executable, "-c", PROGRAM, how], capture_output=True, text=True,
                                                                 check=True, env=env).stdout) for how in ("plain", "faster"))
    assert len(theirs) == 4 and theirs == ours
    assert 0 < faster < 0.7 * plain


def test_functions_for_other_functions_can_be_called_later(tmp_path):
    env = {**os.environ, "NUMBA_DISABLE_JIT": "0", "ASEMD_CACHE_DIR": str(tmp_path)}
    for how in (["caller"], ["function", "1"], ["function", "0"]):
        subprocess.run([sys.executable, "-c", WRAPPERS, *how], check=True, env=env)


def test_long_functions_are_called_where_they_are(tmp_path):
    """Each caller has what it calls in the cache, whichever process compiled it, and under whichever name."""
    env = {**os.environ, "NUMBA_DISABLE_JIT": "0", "ASEMD_CACHE_DIR": str(tmp_path)}
    values = [subprocess.run([sys.executable, "-c", LONG, *words], check=True, env=env, capture_output=True, text=True).stdout.split()
              for words in (["0", "1", "1"], ["5", "1", "2"], ["0", "0", "1", "2"], ["0", "0", "2", "1"], ["0", "1", "3", "4"])]
    assert len({value for row in values for value in row}) == 1, values


def test_code_that_a_former_version_kept(tmp_path):
    env = {**os.environ, "NUMBA_DISABLE_JIT": "0", "ASEMD_CACHE_DIR": str(tmp_path)}
    for when in ("before", "now"):
        subprocess.run([sys.executable, "-c", BEFORE, when], check=True, env=env)


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_functions_are_compiled_again_with_a_wrapper():
    @numba.njit
    def half(x):
        return 0.5 * x

    @numba.njit
    def quarter(x):
        return half(half(x))

    assert quarter(3.0) == 0.75
    (first,) = half.overloads.values()
    assert not compiling.has_wrapper(first) and half.nopython_signatures
    assert half(3.0) == 1.5
    (second,) = half.overloads.values()
    assert compiling.has_wrapper(second) and half(5.0) == 2.5 and quarter(5.0) == 1.25


def test_options_of_functions():
    def flags(**values):
        out = Flags()
        for name, value in values.items():
            setattr(out, name, value)
        return out
    same = flags(nrt=True), flags(nrt=True, noalias=False), flags(nrt=True, fastmath=FastMathOptions(False))
    assert len(set(same)) == 1 and len({hash(f) for f in same}) == 1
    others = flags(), flags(noalias=True), flags(nrt=True, error_model="numpy"), flags(nrt=True, fastmath=FastMathOptions(True))
    assert len({same[0], *others}) == 5 and len({hash(f) for f in others}) > 2
    assert flags() != 1


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_garbage_is_collected_afterwards(monkeypatch):
    """Of functions, and of those that have an address, as most of what a step does."""
    seen = []
    monkeypatch.setattr(compiling, "compile_core", lambda *a, of=compiling.compile_core: seen.append(gc.isenabled()) or of(*a))

    @numba.njit
    def good(x):
        return x + 1.0

    @numba.njit
    def bad(x):
        return good(x) + "1"

    try:
        for on in (True, False):
            (gc.enable if on else gc.disable)()
            with pytest.raises(errors.TypingError):
                bad(1 if on else 1.0)
            assert gc.isenabled() == on
            assert numba.cfunc("float64(float64)")(lambda x: x + 2.0).ctypes(1.0) == 3.0
            assert gc.isenabled() == on
    finally:
        gc.enable()
    assert len(seen) == 6 and not any(seen)


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_lifetimes_are_worked_out_where_they_are_needed(monkeypatch):
    """Three times, for letting variables go, and not after each pass; those at the entry of blocks for code with Python's objects only."""
    seen = []
    for work in (analysis.compute_live_map, analysis.compute_live_variables):
        monkeypatch.setattr(analysis, work.__name__, lambda *a, of=work: seen.append(of.__name__) or of(*a))

    def total(x):
        out = 0
        for k in range(len(x)):
            part = x[k]
            if part == 2:
                continue
            out = out + part
        return out

    assert numba.njit(total)((1, 2, 3)) == 4 and seen == ["compute_live_map"] * 3
    seen.clear()
    assert numba.jit(total, forceobj=True, looplift=False)([1, 2, 3]) == 4 and "compute_live_variables" in seen


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_code_is_optimised_once(monkeypatch):
    """And as far as in two rounds: the sum goes by vectors, what is called is put in place, and references are not counted."""
    seen = []
    monkeypatch.setattr(JITCPUCodegen, "_module_pass_manager",
                        lambda self, of=JITCPUCodegen._module_pass_manager, **how: seen.append(how) or of(self, **how))

    @numba.njit(fastmath=True)
    def inside(x, k):
        return x[k] * x[k]

    @numba.njit(fastmath=True)
    def total(x):
        out = 0.0
        for k in range(len(x)):
            out += inside(x, k)
        return out

    assert total(np.arange(5.0)) == 30.0 and seen == [{}, {}]
    (code,) = total.inspect_asm().values()
    own = code[code.index("5total"):code.index(".Lfunc_end0")]
    if platform.machine() in ("x86_64", "AMD64"):
        assert re.search(r"v?(mul|fn?madd\d+)pd\b", own)
    assert "NRT_" not in own and "6inside" not in own


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_blocks_without_a_variable_are_passed(monkeypatch):
    passed = []
    monkeypatch.setattr(intermediate, "rewrite_all",
                        lambda blocks, *a, of=intermediate.rewrite_all: passed.extend(blocks) or of(blocks, *a))
    lines = "".join(f"    for k in range(n):\n        a{k} = 0.0\n        if k > {k}:\n            a{k} = 1.0\n        out = out + a{k}\n"
                    for k in range(20))
    names: dict = {}
    exec(f"def steps(n):\n    out = 0.0\n{lines}    return out", names)
    assert numba.njit(names["steps"])(4) == names["steps"](4) == 6.0
    # some 80 blocks and 21 variables that are assigned again, each with two passes
    assert 0 < len(passed) < 700


def test_kernels_have_functions_in_common():
    """With and without special pairs, pruned or not, for two styles: what is alike is compiled once."""
    def made(name, rows, **how):
        style = registry.find("pair", name)
        return pair.cluster_kernel(style, (False,) * rows, 608, **{**dict(energy=True, exclude=False, single=False), **how})[1]

    plain, special, pruned, morse = made("lj/cut", 4), made("lj/cut", 4, exclude=True), made("lj/cut", 4, pruned=True), made("morse", 5)
    for name in ("pair_energy", "coefficients", "inner_two" if hasattr(plain, "inner_two") else "inner_one"):
        assert getattr(plain, name) is getattr(special, name) is getattr(pruned, name), name
    assert plain.cluster_forces is not special.cluster_forces and plain.pair_energy is not morse.pair_energy
    assert plain.vector_root is morse.vector_root
    assert plain.pair_energy is not made("lj/cut", 4, single=True).pair_energy


def test_a_function_apart_has_what_it_needs():
    b = generate.Builder("two functions")
    b.constant("TWO", 2.0)
    b.text("def twice(x):\n    return TWO * x", apart=True)
    b.text("def four(x):\n    return twice(twice(x))", apart=True)
    b.text("def near(x):\n    return x + 1.0")
    b.text("def last(x):\n    return near(four(x))", apart=True)      # needs what is not apart, and stays
    module = b.build()
    assert module.last(1.5) == 7.0
    names = [f.__module__ for f in (module.twice, module.four, module.near, module.last)]
    assert len(set(names)) == 3 and names[2] == names[3] == module.__name__
    short = generate.Builder("one that lacks something")
    short.text("def five(x):\n    return nowhere(x)", apart=True)
    with pytest.raises(NameError, match="five needs nowhere"):
        short.build()
