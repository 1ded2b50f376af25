"""Seconds of fresh processes: importing asemd, from process start to the first forces of in.lj (32,000 atoms), cold and warm, and what
kernels of one more bonded style take where one of its kind is there already; first runs of scripts with kernels compiled by one process and
by several."""
from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.benchmarks import compare, scenes

FIRST_FORCE = "import asemd; atoms = asemd.read('in.lj'); atoms.get_forces()"
ONE_MORE = """
import time
from asemd import units
from asemd.style import find
from asemd.testing.styles import Sample, sample
x = None
for category, name in (("bond", "harmonic"), ("bond", "morse")):
    style = find(category, name)
    coeff = style.parse_coeff(style.example.split(), {})
    one = Sample(style, style.pack({}, {1: coeff}, 1, units.get("lj")), x if x is not None else sample(style).x)
    x, began = one.x, time.process_time()
    for energy in (False, True):      # both kernels that a run has
        one.run(energy=energy, per_atom=False)
print(time.process_time() - began)
"""


def seconds(code: str, folder: str, cache: str, compilers: str = "") -> float:
    """Wall time of one process; `compilers`: how many processes compile, empty for what asemd does by itself."""
    env = {**compare.environment(), "ASEMD_CACHE_DIR": cache, "ASEMD_COMPILERS": compilers}
    began = time.perf_counter()
    subprocess.run([sys.executable, "-c", code], check=True, cwd=folder, env=env)
    return time.perf_counter() - began


def one_more(folder: str, samples: int) -> dict:
    """Processor time of bond style morse after harmonic: with an empty cache, and from the cache."""
    out: dict[str, list[float]] = {"one more style, cold": [], "one more style, warm": []}
    for k in range(samples):
        env = {**compare.environment(), "ASEMD_CACHE_DIR": str(Path(folder) / f"more{k}")}
        for values in out.values():
            values.append(float(subprocess.check_output([sys.executable, "-c", ONE_MORE], env=env)))
    return {name: compare.spread(values) for name, values in out.items()}


def first_runs(folder: str, samples: int) -> dict:
    """Twenty steps of Lennard-Jones atoms, and of water with charges on a mesh, with an empty cache."""
    scripts = {"LJ": scenes.lj(), "water": scenes.water("1 1 1")}
    out: dict[str, list[float]] = {f"first run, {name}, compiled by {how}": [] for name in scripts for how in ("one", "several")}
    for name, text in scripts.items():
        (Path(folder) / f"in.{name}").write_text(text + "run 20\n")
        code = f"import sys; sys.argv[1:] = ['run', 'in.{name}', '--quiet']; from asemd.cli import entry; entry()"
        for k in range(samples):
            for how, compilers in (("one", "1"), ("several", "")):
                out[f"first run, {name}, compiled by {how}"].append(seconds(code, folder, str(Path(folder) / f"{name}{how}{k}"), compilers))
    return {name: compare.spread(values) for name, values in out.items()}


def compiled(cache: str) -> set[tuple[str, int]]:
    """Files of machine code and when they were written."""
    return {(str(p), os.stat(p).st_mtime_ns) for p in Path(cache).rglob("*.nb[ci]")}


def measure(samples: int = 5) -> dict:
    """Medians; the cold numbers start with an empty cache each time."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "in.lj").write_text(scenes.lj() + "run 0\n")
        warm = str(Path(folder) / "cache")
        cold = [seconds(FIRST_FORCE, folder, str(Path(folder) / f"cold{k}")) for k in range(min(samples, 3))]
        seconds(FIRST_FORCE, folder, warm)
        before = compiled(warm)
        times = {"empty python": "pass", "import asemd": "import asemd", "import ase": "import ase", "first force, warm": FIRST_FORCE}
        seen = {name: [] for name in times}
        for _ in range(samples):
            for name, code in times.items():
                seen[name].append(seconds(code, folder, warm))
        after = compiled(warm)
        more = one_more(folder, min(samples, 3)) | first_runs(folder, min(samples, 3))
    out = {name: compare.spread(values) for name, values in seen.items()} | more
    out["first force, cold"] = compare.spread(cold)
    extra = out["import asemd"]["median"] - out["empty python"]["median"]
    return {"seconds": out, "import asemd, more than empty": extra, "kernels cached": len(before),
            "compiled by later processes": len(after - before)}


if __name__ == "__main__":
    o = compare.arguments(__doc__, samples=5).parse_args()
    compare.show(__doc__, measure(o.samples), o.json)
