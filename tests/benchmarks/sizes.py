"""Cost of an atom from 1,000 to 2,000,000 of them: nanoseconds of the time loop per atom and step, bytes of memory per atom. LJ melt.

``python -m tests.benchmarks.sizes [--largest 500000] [--docs]``: each size in processes of its own, all of them in turns, so that a busy
moment hits all sizes alike. Memory is what a process holds at most beyond that of the smallest scene.
"""
from __future__ import annotations

import json
import tempfile
from pathlib import Path

from tests.benchmarks import compare, page, scenes
from tests.benchmarks.lean import largest_memory

CELLS = ((5, 5, 10), (10, 10, 10), (20, 20, 20), (32, 32, 32), (50, 50, 50), (79, 79, 80))      # 4 atoms each
PERIOD = 20            # steps between two lists


def steps_for(atoms: int, work: float) -> int:
    """Steps of a stretch, whole periods of the list, about `work` atoms times steps."""
    return max(1, round(work / atoms / PERIOD)) * PERIOD


def measure(samples: int = 5, threads: int = 1, precision: str = "double", largest: int = 2_000_000, work: float = 2e7) -> dict:
    """By number of atoms: ``ns`` of an atom and step and ``memory`` (MB) by engine, ``ratio`` of the other engines to asemd."""
    sizes = [(4 * a * b * c, (a, b, c)) for a, b, c in CELLS if 4 * a * b * c <= largest]
    who = compare.contenders(threads, precision)[:2]
    running: dict[tuple[int, str], compare.Running] = {}
    ns: dict[tuple[int, str], list[float]] = {}
    with tempfile.TemporaryDirectory() as tmp:
        try:
            for atoms, cells in sizes:
                for c in who:
                    folder = Path(tmp) / str(len(running))
                    folder.mkdir()
                    r = running[atoms, c.name] = compare.Running(c, folder)
                    r.do([*scenes.lj(cells).splitlines(), f"run {min(steps_for(atoms, work), 5 * PERIOD)}"])
            for _ in range(samples):
                for (atoms, name), r in running.items():
                    steps = steps_for(atoms, work)
                    ns.setdefault((atoms, name), []).append(1e9 * r.do([f"run {steps} pre no post no"])["seconds"] / steps / atoms)
            memory = {key: largest_memory(r.process.pid) for key, r in running.items()}
        finally:
            for r in running.values():
                r.stop()
    names = [c.name for c in who]
    return {str(n): {"ns": {name: compare.spread(ns[n, name]) for name in names}, "memory": {name: memory[n, name] for name in names},
                     "ratio": {name: compare.spread([b / a for a, b in zip(ns[n, names[0]], ns[n, name])]) for name in names[1:]}}
            for n, _ in sizes}


def flatness(result: dict) -> float:
    """Largest cost of an atom in terms of the smallest, of asemd."""
    values = [next(iter(r["ns"].values()))["median"] for r in result.values()]
    return max(values) / min(values)


def table(result: dict) -> list[str]:
    """Markdown."""
    first = next(iter(result.values()))
    ours = next(iter(first["ns"]))
    lines = ["| atoms | ns per atom and step | atoms times steps a second | bytes per atom | LAMMPS, ns | bytes per atom | times faster |",
             "|---:|---:|---:|---:|---:|---:|---:|"]
    def held(atoms: int, r: dict, name: str) -> str:
        """Bytes of an atom beyond what the smallest scene holds; small ones do not tell."""
        more = atoms - int(next(iter(result)))
        return f"{1e6 * (r['memory'][name] - first['memory'][name]) / more:.0f}" if atoms > 10**5 else "-"
    for atoms, r in result.items():
        ns, n = r["ns"][ours]["median"], int(atoms)
        words = [f"{n:,}", f"{ns:.1f}", f"{1e9 / ns:.3g}", held(n, r, ours)]
        for name, ratio in r["ratio"].items():
            words += [f"{r['ns'][name]['median']:.1f}", held(n, r, name), f"{ratio['median']:.2f} [{ratio['q1']:.2f}, {ratio['q3']:.2f}]"]
        lines.append(f"| {' | '.join(words + ['-'] * (7 - len(words)))} |")
    return [*lines, "", f"The dearest atom of asemd costs {flatness(result):.2f} times the cheapest ({ours})."]


if __name__ == "__main__":
    p = compare.arguments(__doc__.splitlines()[0], samples=5, steps=0)
    p.add_argument("--largest", type=int, default=2_000_000, help="leave larger scenes out")
    p.add_argument("--work", type=float, default=2e7, help="atoms times steps of a stretch")
    p.add_argument("--docs", action="store_true", help="keep the figures and put the table into docs/speed.md")
    o = p.parse_args()
    found = measure(o.samples, o.threads, o.precision, o.largest, o.work)
    print(*table(found), sep="\n")
    if o.json:
        Path(o.json).write_text(json.dumps({"machine": compare.machine(), "sizes": found}, indent=1) + "\n")
    if o.docs:
        page.keep({"sizes": found})
