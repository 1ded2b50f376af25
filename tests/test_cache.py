"""Generated kernels on disk: found by other processes, made anew when text changes, safe with several writers; and no compiler at all."""
from __future__ import annotations

import json
import math
import os
import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import pytest

from asemd.kernels import bonded, generate
from asemd.style import Style

ROOT = Path(__file__).resolve().parents[1]
PROGRAM = """
import json
import math
import numpy as np
from asemd.box import Box
from asemd.engine import Settings
from asemd.fix.nve import NVE
from asemd.forcefield import Interactions
from asemd.kernels.generate import cache_dir
from asemd.loop import Loop
from asemd.system import System
from asemd.topology import Topology
x = np.array([[1.0, 1, 1], [2.1, 1, 1], [2.3, 2.2, 1.1], [4, 4, 4]])
system = System(box=Box(np.zeros(3), np.eye(3) * 6), x=x, type=1, units="lj", mass=np.array([np.nan, 1.0]),
                topology=Topology(bonds=[(0, 1), (1, 2)]))
interactions = Interactions.build(pair={"lj/cut 2.0": {(1, 1): (1.0, 1.0)}}, bond={"harmonic": {1: (30.0, 1.0)}},
                                  special_bonds={"lj": (0, 0.5, 0.5)})
loop = Loop(system, interactions, Settings(threads=2), [NVE()], {"all": np.ones(4, bool)}, 0.005)
start = loop.setup()
first = start.potential, start.forces.tolist(), start.virial.tolist()
loop.advance(5)
print(json.dumps({"first": first, "x": system.x.tolist(), "cache": str(cache_dir()), "threads": loop.engine.threads}))
"""


def launch(program: str, cache: Path | None = None, **env: str) -> subprocess.Popen:
    inherited = {k: v for k, v in os.environ.items() if k not in ("NUMBA_DISABLE_JIT", "ASEMD_CACHE_DIR")}
    environment = inherited | {"PYTHONPATH": str(ROOT)} | env
    if cache is not None:
        environment["ASEMD_CACHE_DIR"] = str(cache)
    return subprocess.Popen([sys.executable, "-c", textwrap.dedent(program)], env=environment, text=True,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def answer(process: subprocess.Popen):
    out, err = process.communicate(timeout=200)
    assert process.returncode == 0, err[-2000:]
    return json.loads(out.splitlines()[-1])


def test_full_disk(tmp_path):
    """No file may grow beyond a few bytes: compiled for this process only."""
    # Python itself would leave cut-off bytecode of asemd behind, which no later process can read
    limits = "import resource, sys\nsys.dont_write_bytecode = True\nresource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))\n"
    cache = tmp_path / "cache"
    tight, free = launch(limits + PROGRAM, cache), launch(PROGRAM, tmp_path / "free")
    result, expected = answer(tight), answer(free)
    assert result["first"] == expected["first"] and result["x"] == expected["x"]
    assert not [f for f in cache.rglob("*") if f.is_file() and f.stat().st_size and f.suffix != ".nbi"]


@pytest.fixture(scope="module")
def cold(tmp_path_factory):
    """Two processes at once that find an empty cache."""
    cache = tmp_path_factory.mktemp("cache")
    processes = [launch(PROGRAM, cache) for _ in range(2)]
    return cache, [answer(p) for p in processes]


def files(cache: Path) -> dict[str, int]:
    return {str(p.relative_to(cache)): p.stat().st_mtime_ns for p in cache.rglob("*") if p.is_file()}


def same(a: dict, b: dict) -> None:
    assert a["first"][0] == pytest.approx(b["first"][0], rel=1e-13)
    for k in (1, 2):
        np.testing.assert_allclose(a["first"][k], b["first"][k], rtol=1e-12, atol=1e-11)
    np.testing.assert_allclose(a["x"], b["x"], rtol=0, atol=1e-12)


def test_processes_at_once_on_a_cold_cache(cold):
    cache, (one, two) = cold
    same(one, two)
    assert Path(one["cache"]) == cache / generate.PACKAGE
    assert not list(cache.rglob("*.tmp"))


def test_the_next_process_compiles_nothing(cold):
    cache, (one, _) = cold
    before = files(cache)
    assert any(name.endswith(".nbc") for name in before)
    watch = "import numba\nfrom numba.core import event\nrecorder = event.RecordingListener()\nevent.register('numba:compile', recorder)\n"
    again = answer(launch(watch + PROGRAM + "\nprint(json.dumps(len(recorder.buffer)))", cache))
    own = {k: v for k, v in files(cache).items() if not k.endswith(".pyc")}
    assert own == {k: v for k, v in before.items() if not k.endswith(".pyc")}
    assert again == 0


def test_without_the_compiler(cold):
    """NUMBA_DISABLE_JIT=1: the same numbers from plain Python, on one thread."""
    cache, (one, _) = cold
    plain = answer(launch(PROGRAM, cache, NUMBA_DISABLE_JIT="1"))
    same(plain, one)
    assert plain["threads"] == 1 and one["threads"] == 2


STYLE = """
    import json, sys
    import numpy as np
    sys.path.insert(0, {folder!r})
    import spring
    from asemd.kernels import bonded
    from asemd.kernels.state import cell_arrays
    from asemd.style import find
    kernel = bonded.kernel(find("bond", "spring"), energy=True, per_atom=False, periodic=False, orthogonal=True)
    x, f, acc, one = np.array([[0.0, 2.0], [0, 0], [0, 0]]), np.zeros((3, 2)), np.zeros(8), np.zeros((6, 1))
    items, types, cell = np.array([[0, 1]], np.int32), np.ones(1, np.int32), cell_arrays(np.eye(3), np.zeros(3, bool))
    kernel(x, f, items, types, cell, np.array([[0.0, 3.0]]), (), 0, 1, acc, np.zeros(1), one, np.zeros(4))
    print(json.dumps(acc[0]))
"""


def test_an_edited_style_is_compiled_anew(tmp_path):
    module = tmp_path / "spring.py"
    text = ("from asemd.style import bond\n\n\n@bond('spring', example='1.0')\ndef spring(r, K: 'energy/distance^2'):\n"
            "    return {} * K * r * r, 2 * K * r\n")
    results = []
    for factor in ("1.0", "1.0", "5.0"):
        module.write_text(text.format(factor))
        results.append(answer(launch(STYLE.format(folder=str(tmp_path)), tmp_path / "cache", PYTHONDONTWRITEBYTECODE="1")))
    assert results == [12.0, 12.0, 60.0]
    written = list((tmp_path / "cache" / generate.PACKAGE).glob("k_*.py"))
    assert len(written) == 4      # two versions of the style, the loop over bonds, the same by address


def test_text_names_the_module(monkeypatch):
    def one(r, K: "energy/distance^2"):
        return K * r, K

    def two(r, K: "energy/distance^2"):
        return K * r * 1.0, K
    texts = [bonded.source(Style("bond", "test", f), energy=True).source() for f in (one, two)]
    assert texts[0] != texts[1]
    b = generate.Builder("a test")
    b.text("def f(x):\n    return x + 1", jit=False)
    c = generate.Builder("a test")
    c.text("def f(x):\n    return x + 2", jit=False)
    assert b.build() is b.build() and b.build().__name__ != c.build().__name__
    assert b.build().f(1) == 2 and c.build().f(1) == 3


def test_an_edited_module_that_kernels_import_makes_new_kernels(monkeypatch):
    text = "from asemd.kernels.fuse import madd\n\n\ndef f():\n    return 1\n"
    before = generate.load(text).__name__
    real = generate._source_of
    monkeypatch.setattr(generate, "_source_of", lambda name: real(name) + "# edited\n")
    assert generate.load(text).__name__ != before


def test_arithmetic_does_not_depend_on_who_calls_first():
    """numba hands the freedom to reorder down to what a function calls, unless that says otherwise."""
    b = generate.Builder("a test of strict arithmetic")
    b.text("def strict(x):\n    return (x + 1e17) - 1e17", cache=False)
    b.text("def free(x):\n    return strict(x)", f"fastmath={generate.FAST}", cache=False)
    module = b.build()
    assert module.free(3.0) == module.strict(3.0) == 0.0


def test_an_unusable_folder_falls_back(tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    program = """
        import json
        from asemd.kernels.generate import Builder, cache_dir
        b = Builder("a test")
        b.text("def f(x):\\n    return x + 1", jit=False)
        print(json.dumps([str(cache_dir()), b.build().f(1)]))
    """
    folder, value = answer(launch(program, blocked))
    assert value == 2 and str(blocked) not in folder and Path(folder).name == generate.PACKAGE
    folder, value = answer(launch(program, tmp_path / "new" / "folder"))
    assert value == 2 and Path(folder) == tmp_path / "new" / "folder" / generate.PACKAGE


def test_the_folder_stays_bounded(tmp_path, monkeypatch):
    monkeypatch.setattr(generate, "LIMIT_BYTES", 3000)
    compiled = tmp_path / "__pycache__"
    compiled.mkdir()
    for k in range(6):
        (compiled / f"k{k}.nbc").write_bytes(b"x" * 1000)
        os.utime(compiled / f"k{k}.nbc", (1000 + k, 1000 + k))
    generate._trim(tmp_path)
    assert sorted(p.name for p in compiled.iterdir()) == ["k3.nbc", "k4.nbc", "k5.nbc"]


def many(x, out):
    """Too long to become a part of what calls it."""
    for k in range(out.shape[0]):
        a = math.exp(-k * 0.1) + math.sin(x + k)
        b = math.exp(-a * a) * math.cos(a - k)
        c = math.sin(b - a) / (1.0 + a * a) + math.atan2(a, b)
        out[k] = a * b + c * math.cos(x)
        for j in range(3):
            d = math.sin(c * j) + math.cos(b) * math.exp(-c * c)
            out[k] += math.sin(d) * a + b * c - d / (2.0 + math.cos(d)) * math.log(1.0 + d * d)


def twice(x, out):
    many(x, out)
    many(x + out[0], out[1:])
    many(x - out[0], out[2:])


COPIES = f"""
import json, sys
import numpy as np
sys.path.insert(0, {str(ROOT / "tests")!r})
from test_cache import many, twice
from asemd.kernels import generate
b = generate.Builder("copies")
b.function(many, fast=True)
b.function(twice, fast=True)
b.text("def thrice(x, out):\\n    twice(x, out)\\n    return np.zeros(3)")
module, out = b.build(), np.zeros(5)
module.thrice(0.3, out)
libraries = [overload.library for f in (module.thrice, module.twice) for overload in f.overloads.values()]
print(json.dumps([[[f.name, f.linkage.name] for l in libraries for f in l._final_module.functions if not f.is_declaration],
                  [name for l in libraries for name in l.calls]]))
"""


def test_code_calls_what_is_there_once_or_its_own_copies(tmp_path):
    """Not copies that were loaded first, which may be rounded otherwise: the last bit would depend on what else was run before."""
    functions, calls = answer(launch(COPIES, tmp_path))
    assert "internal" in {linkage for _, linkage in functions} and "linkonce_odr" not in {linkage for _, linkage in functions}
    assert not any("many" in name for name, _ in functions) and sum("many" in name for name in calls) == 1


def test_the_first_compilation_is_announced(tmp_path):
    """Once in a process that compiles, and not at all in the next one, which finds its code on the disk."""
    program = """
    import json
    from asemd.kernels import generate
    said = []
    generate.announce = lambda: said.append(len(said))
    values = []
    for k in (3, 4):
        b = generate.Builder("a test")
        b.text(f"def times(x):\\n    return {k} * x")
        values.append(b.build().times(2))
    print(json.dumps([said, values]))
    """
    assert answer(launch(program, tmp_path)) == [[0], [6, 8]]
    assert answer(launch(program, tmp_path)) == [[], [6, 8]]
