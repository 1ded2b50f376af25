"""Do the ensembles hold? Kinetic energies, and ratios of distributions at two temperatures and pressures, with physical_validation.

python run.py [--quick] [--only WORDS] [--kept] [--processes 2] [--folder ensembles]
"""
from __future__ import annotations

import argparse
import csv
import datetime
import json
import os
import time
from multiprocessing import get_context
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

import checks  # noqa: E402
import dynamics  # noqa: E402
import pictures  # noqa: E402

NVT = ("nvt", "temp/csvr", "temp/csld", "langevin", "gjf", "baoab", "temp/berendsen")
STEPS = {("LJ liquid", d): 200000 for d in NVT} | {
    ("LJ liquid", "nvt"): 600000, ("LJ liquid", "temp/csvr"): 100000, ("LJ liquid", "temp/csld"): 40000, ("LJ liquid", "npt"): 200000,
    ("polymer melt", "nvt"): 600000, ("polymer melt", "npt"): 200000,
    ("rigid water", "shake + nvt"): 150000, ("rigid water", "rigid/nvt/small"): 100000, ("rigid water", "shake + npt"): 100000,
    ("flexible water", "nvt"): 200000, ("flexible water", "npt"): 400000}
QUICK = {("LJ liquid", "nvt"): 12000, ("LJ liquid", "langevin"): 12000, ("LJ liquid", "temp/berendsen"): 12000}


def simulate(task) -> tuple:
    """The records of one run; its own process."""
    begin = time.perf_counter()
    table = dynamics.records(*task)
    print(f"{task[0].name}: {time.perf_counter() - begin:.0f} s", flush=True)
    return task[0], table


def plan(steps: dict) -> list[list[dynamics.Run]]:
    """Of each ensemble two temperatures; at constant pressure two pressures too."""
    groups = []
    for (liquid, kind), n in steps.items():
        points = [(0, 0), (1, 0), (0, 1)] if "npt" in kind else [(0, 0), (1, 0)]
        groups.append([dynamics.Run(liquid, kind, hot, dense, n, max(4000, n // 8)) for hot, dense in points])
    return groups


def table(rows: list[dict], path: Path) -> str:
    """Rows as a CSV file, and as Markdown."""
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    shown = [k for k in rows[0] if k not in ("control", "ok")]
    lines = ["| " + " | ".join(shown) + " | |", "|" + "---|" * (len(shown) + 1)]
    for row in rows:
        verdict = ("ok" if row["ok"] else "**off**") if not row["control"] else "not seen" if row["ok"] else "found"
        lines.append("| " + " | ".join(f"{v:.4g}" if isinstance(v, float) else str(v) for v in map(row.get, shown)) + f" | {verdict} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    p = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    p.add_argument("--quick", action="store_true", help="seconds instead of minutes: three ensembles of the Lennard-Jones liquid")
    p.add_argument("--only", default="", help="ensembles whose name, such as 'LJ liquid nvt', has these words")
    p.add_argument("--kept", action="store_true", help="judge the runs whose records the folder has, simulate nothing")
    p.add_argument("--processes", type=int, default=2)
    p.add_argument("--folder", type=Path, default=Path("ensembles"))
    o = p.parse_args()
    folder = o.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    wanted = [g for g in plan(QUICK if o.quick else STEPS) if o.only in f"{g[0].liquid} {g[0].dynamics}"]
    groups = [g for g in wanted if not o.kept or all(dynamics.kept(run, folder).exists() for run in g)]
    with get_context("spawn").Pool(o.processes) as pool:
        found = dict(pool.map(simulate, [(run, folder) for g in groups for run in g], chunksize=1))
    kinetic = [checks.kinetic(run, found[run]) for g in groups for run in g if run.dense == 0]
    pairs = [(g[0], other) for g in groups for other in g[1:]]
    ratios = [row for pair in pairs for row in checks.ratio(*pair, [found[run] for run in pair])]
    about = {"machine": checks.machine(), "date": datetime.date.today().isoformat(), "limit": checks.LIMIT,
             "missing": [f"{g[0].liquid} {g[0].dynamics}" for g in wanted if g not in groups]}
    (folder / "result.json").write_text(json.dumps({"kinetic": kinetic, "ratios": ratios, **about}))
    texts = table(kinetic, folder / "kinetic.csv") + "\n" + table(ratios, folder / "ratios.csv")
    (folder / "results.md").write_text(texts)
    pictures.kinetic([(run, found[run]) for g in groups for run in g if run.dense == 0], folder / "kinetic.png")
    pictures.ratios([(pair, [found[run] for run in pair]) for pair in pairs], folder / "ratios.png")
    print(texts)


if __name__ == "__main__":
    main()
