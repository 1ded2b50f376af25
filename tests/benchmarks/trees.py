"""What a change is worth: times of steps by two or more trees of the source, in turns.

``python -m tests.benchmarks.trees OLD NEW [--scenes lj water] [--precision mixed] [--processes 3] [--rounds 10]``: for each scene of the
table of speeds, the milliseconds of a step by each tree and how they compare to those of the first one, turn by turn. Where memory lies is
another chance in each process, so several of each are asked.
"""
from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.benchmarks import compare
from tests.benchmarks.cases import CASES

WORK = """
import sys, time
from asemd.lammps import Lammps
lmp = Lammps(cmdargs=["-screen", "none", "-log", "none", *sys.argv[3:]])
lmp.file(sys.argv[1])
lmp.command(f"run {sys.argv[2]}")
print("ready", flush=True)
for _ in sys.stdin:
    began = time.perf_counter()
    lmp.command(f"run {sys.argv[2]} pre no post no")
    print((time.perf_counter() - began) / int(sys.argv[2]), flush=True)
"""


def start(tree: Path, script: Path, steps: int, precision: str) -> subprocess.Popen:
    process = subprocess.Popen([sys.executable, "-c", WORK, str(script), str(steps), "-precision", precision], cwd=script.parent,
                               env={**os.environ, "PYTHONPATH": str(tree)}, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    if process.stdout.readline() != "ready\n":      # after the first run, which compiles
        raise SystemExit(f"{tree}: {script.name} does not run there")
    return process


def once(process: subprocess.Popen) -> float:
    process.stdin.write("\n")
    process.stdin.flush()
    return float(process.stdout.readline())


def measure(trees: list[Path], script: Path, steps: int, precision: str, processes: int, rounds: int) -> list[tuple[float, list[float]]]:
    """Of each tree the shortest seconds of a step, and of each process the median ratio to the first tree's."""
    found = [(float("inf"), []) for _ in trees]
    for _ in range(processes):
        working = [start(tree, script, steps, precision) for tree in trees]
        turns = [[once(p) for p in working] for _ in range(rounds)]
        for p in working:
            p.communicate()
        found = [(min(least, *mine), [*ratios, statistics.median(a / b[0] for a, b in zip(mine, turns))])
                 for (least, ratios), mine in zip(found, zip(*turns))]
    return found


def main() -> None:
    p = argparse.ArgumentParser(description=__doc__)
    p.add_argument("trees", nargs="+", type=Path, metavar="TREE")
    p.add_argument("--scenes", nargs="+", choices=list(CASES), default=["lj"], metavar="NAME")
    p.add_argument("--precision", choices=("double", "mixed"), default="double")
    p.add_argument("--processes", type=int, default=3)
    p.add_argument("--rounds", type=int, default=10)
    o = p.parse_args()
    print(", ".join(f"{k} {v}" for k, v in compare.machine().items()))
    with tempfile.TemporaryDirectory() as folder:
        for name in o.scenes:
            script = Path(folder) / f"in.{name.replace(' ', '-')}"
            script.write_text(CASES[name].script() + "\n")
            found = measure([tree.resolve() for tree in o.trees], script, CASES[name].steps, o.precision, o.processes, o.rounds)
            for tree, (least, ratios) in zip(o.trees, found):
                print(f"{name:12s} {str(tree):30s} {1e3 * least:9.3f} ms, times {statistics.median(ratios):.3f} "
                      f"[{min(ratios):.3f}, {max(ratios):.3f}]", flush=True)


if __name__ == "__main__":
    main()
