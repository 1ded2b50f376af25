"""The scenes of the table of speeds: whole time loops, parts of a step from the timing tables of both logs, the neighbour list.

Each is measured beside the variants of LAMMPS in the same run, in turns; the table has the fastest of them.
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from tests.benchmarks import compare, neighbour, run_silicon, scenes

SMALL = "delay 0 every 1 check yes"


@dataclass
class Case:
    """`script` makes the commands; `part`: word of the timing table ("" the whole loop); `precisions` asemd runs in."""

    title: str
    script: Callable[[], str]
    steps: int
    part: str = ""
    precisions: tuple[str, ...] = ("double",)


CASES = {
    "lj": Case("LJ melt, 32,000 atoms", scenes.lj, 100, precisions=("double", "mixed")),
    "chain": Case("bead-spring melt, 32,000 atoms", scenes.chain, 100),
    "eam": Case("copper (EAM), 32,000 atoms", scenes.eam, 50),
    "protein": Case("peptides in water, PPPM and SHAKE, 32,064 atoms", scenes.protein, 25),
    "water": Case("rigid water, PPPM 1e-4 and SHAKE, 31,944 atoms", scenes.water, 25, precisions=("double", "mixed")),
    "sw": Case("silicon (Stillinger-Weber), 32,768 atoms", lambda: run_silicon.scene("sw"), 50),
    "tersoff": Case("silicon (Tersoff), 32,768 atoms", lambda: run_silicon.scene("tersoff"), 50),
    "charmm": Case("pair forces of the peptides (lj/charmm/coul/long)", scenes.protein, 25, "Pair"),
    "pppm": Case("PPPM of the water", scenes.water, 25, "Kspace", ("double", "mixed")),
    "bonds": Case("bonded forces of the melt (31,680 FENE bonds)", scenes.chain, 100, "Bond"),
    "bonded": Case("bonded forces of peptides in water (37,552 items)", scenes.peptide, 100, "Bond"),
    "small lj": Case("LJ, 500 atoms", lambda: scenes.lj((5, 5, 5), SMALL), 5000),
    "small chain": Case("bead-spring melt, 500 atoms", lambda: scenes.chain(5, 100), 5000),
    "small eam": Case("copper (EAM), 500 atoms", lambda: scenes.eam((5, 5, 5)), 2000),
    "small water": Case("rigid water, PPPM and SHAKE, 648 atoms", lambda: scenes.water("1 1 1", 6), 500),
    "small sw": Case("silicon (Stillinger-Weber), 512 atoms", lambda: run_silicon.scene("sw", 4), 2000),
    "small tersoff": Case("silicon (Tersoff), 512 atoms", lambda: run_silicon.scene("tersoff", 4), 1000),
}
NEIGHBOUR = "neighbour"
NAMES = (*CASES, NEIGHBOUR)


def measure(name: str, threads: int = 1, samples: int = 7, quick: bool = False) -> dict:
    """By title of the row: ``unit``, ``values`` by engine, ``ratio`` of the others to asemd."""
    if name == NEIGHBOUR:
        result = neighbour.measure(samples, 20 if quick else 100, threads)
        return {f"neighbour list, 32,000 atoms, double, {threads}": {"unit": "ms", "values": result["ms_per_build"],
                                                                     "ratio": result["ratio"]}}
    case, out = CASES[name], {}
    steps = max(1, case.steps // 10) if quick else case.steps
    ours = [compare.contenders(threads, precision)[0] for precision in case.precisions]
    theirs, script = compare.contenders(threads, every=True)[1:], case.script()
    if case.part:
        numbers = compare.from_logs(ours + theirs, script, steps, samples, lambda log: compare.part_of_log(log, case.part, steps))
    else:
        numbers = compare.alternate(ours + theirs, script, steps, samples)
    for precision, one in zip(case.precisions, ours):
        found = {c.name: numbers[c.name] for c in (one, *theirs)}
        values, ratio = compare.ratios(found)
        if not case.part:
            values = compare.rates(found, steps)["steps_per_second"]
        out[f"{case.title}, {precision}, {threads}"] = {"unit": "ms" if case.part else "steps/s", "values": values, "ratio": ratio}
    return out


def row(title: str, result: dict) -> str:
    """A line of the table; LAMMPS's fastest variant."""
    ours = next(iter(result["values"].values()))["median"]
    name, precision, threads = title.rsplit(", ", 2)
    words = [name, precision, threads, f"{ours:.4g} {result['unit']}"]
    if result["ratio"]:
        best = min(result["ratio"], key=lambda other: result["ratio"][other]["median"])
        r = result["ratio"][best]
        words += [f"{result['values'][best]['median']:.4g}", f"`{best.removeprefix('LAMMPS ')}`",
                  f"{r['median']:.2f} [{r['q1']:.2f}, {r['q3']:.2f}]"]
    else:
        words += ["-"] * 3
    return f"| {' | '.join(words)} |"


def table(results: dict) -> list[str]:
    """Markdown, in the order of `CASES`, one thread first."""
    titles = [case.title for case in CASES.values()]

    def place(title: str) -> tuple:
        name, precision, threads = title.rsplit(", ", 2)
        return int(threads), titles.index(name) if name in titles else len(titles), precision
    return ["| scene | precision | threads | asemd | LAMMPS | fastest with | times faster [quartiles] |", "|---|---|---|---|---|---|---|",
            *(row(title, results[title]) for title in sorted(results, key=place))]
