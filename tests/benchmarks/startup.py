"""Seconds of fresh processes: importing asemd, and from process start to the first forces of in.lj (32,000 atoms), cold and warm."""
from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.benchmarks import compare, scenes

FIRST_FORCE = "import asemd; atoms = asemd.read('in.lj'); atoms.get_forces()"


def seconds(code: str, folder: str, cache: str) -> float:
    """Wall time of one process."""
    env = {**compare.environment(), "ASEMD_CACHE_DIR": cache}
    began = time.perf_counter()
    subprocess.run([sys.executable, "-c", code], check=True, cwd=folder, env=env)
    return time.perf_counter() - began


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
    out = {name: compare.spread(values) for name, values in seen.items()}
    out["first force, cold"] = compare.spread(cold)
    extra = out["import asemd"]["median"] - out["empty python"]["median"]
    return {"seconds": out, "import asemd, more than empty": extra, "kernels cached": len(before),
            "compiled by later processes": len(after - before)}


if __name__ == "__main__":
    o = compare.arguments(__doc__, samples=5).parse_args()
    compare.show(__doc__, measure(o.samples), o.json)
