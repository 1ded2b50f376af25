"""All benchmarks, as a Markdown table: ``python -m tests.benchmarks [--samples 7] [--threads 1 2] [--json results.json]``.

``--readme`` puts it into the README. On a processor with AVX-512, ``NUMBA_CPU_NAME=haswell python -m tests.benchmarks`` gives the figures
of one with AVX2.
"""
from __future__ import annotations

import argparse
import json
from pathlib import Path

from tests.benchmarks import compare, memory, neighbour, run_bonded, run_chain, run_eam, run_lj, run_small, scenes, startup, watchdog

README = scenes.ROOT / "README.md"
BEGIN, END = "<!-- benchmarks: begin -->", "<!-- benchmarks: end -->"
SCENES = (("LJ melt, 32,000 atoms", run_lj), ("bead-spring melt, 32,000 atoms", run_chain), ("copper (EAM), 32,000 atoms", run_eam),
          ("LJ, 500 atoms", run_small))
BONDED = {"chain": "bonded forces of the melt (31,680 FENE bonds)", "peptide": "bonded forces of peptides in water (37,552 items)"}


def rows(title: str, result: dict, key: str, unit: str) -> list[str]:
    """One row for each engine LAMMPS ran as, or one for asemd alone."""
    first, *others = result[key]
    ours = f"{result[key][first]['median']:.4g}"
    out = []
    for other in others:
        r = result["ratio"][other]
        out.append(f"| {title}, {first} | {ours} {unit} | {other}: {result[key][other]['median']:.4g} | "
                   f"{r['median']:.2f} [{r['q1']:.2f}, {r['q3']:.2f}] |")
    return out or [f"| {title}, {first} | {ours} {unit} | - | - |"]


def main() -> None:
    p = argparse.ArgumentParser(description="All benchmarks.")
    p.add_argument("--samples", type=int, default=7)
    p.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    p.add_argument("--json")
    p.add_argument("--readme", action="store_true", help="write the table into README.md")
    p.add_argument("--quick", action="store_true", help="short runs that only show that the scripts work")
    o = p.parse_args()
    short = {"steps": 20} if o.quick else {}
    samples = 2 if o.quick else o.samples
    results: dict = {"machine": compare.machine()}
    table = ["| scene | asemd | LAMMPS | times faster [quartiles] |", "|---|---|---|---|"]
    for threads in o.threads:
        for precision in ("double", "mixed"):
            for title, module in SCENES:
                if (module is run_small and threads > 1) or (module is not run_lj and precision == "mixed"):
                    continue
                result = module.measure(samples=samples, threads=threads, precision=precision, **short)
                results[f"{title}, {precision}, {threads}"] = result
                table += rows(title, result, "steps_per_second", "steps/s")
                print(table[-1], flush=True)
        for scene, title in BONDED.items():
            result = results[f"{title}, {threads}"] = run_bonded.measure(samples=samples, threads=threads, scene=scene, **short)
            table += rows(title, result, "ms_per_step", "ms")
            print(table[-1], flush=True)
    result = results["neighbour build"] = neighbour.measure(samples=samples)
    table += rows("neighbour list, 32,000 atoms", result, "ms_per_build", "ms")
    results["memory"], results["startup"] = memory.measure(samples=1 if o.quick else 3), startup.measure(2 if o.quick else 5)
    results["watchdog"] = watchdog.measure(2 if o.quick else 5, o.quick)
    others = [*compare.lines("watchdog, percent of the loop", results["watchdog"]),
              *compare.lines("memory", results["memory"]), *compare.lines("start-up", results["startup"])]
    text = "\n".join([*table, "", "Machine: " + ", ".join(f"{k} {v}" for k, v in results["machine"].items()) + ".", "",
                      "```text", *others, "```"])
    print("\n" + text)
    if o.readme:
        before, _, rest = README.read_text().partition(BEGIN)
        README.write_text(before + BEGIN + "\n" + text + "\n" + END + rest.partition(END)[2])
    if o.json:
        Path(o.json).write_text(json.dumps(results, indent=1))


if __name__ == "__main__":
    main()
