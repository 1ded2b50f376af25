"""asemd and LAMMPS on every script of a folder, as a campaign: what was compared is in a database and is not compared again.

python run.py [--inputs FOLDER] [--steps 20] [--processes 2] [--folder validation]
"""
from __future__ import annotations

import argparse
import hashlib
import json
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

import asemd

HERE = Path(__file__).parent


def compare(path: str, steps: int, sha256: str) -> dict:
    """The largest relative differences of one script: energies, forces and virials of its first step, rows of its runs."""
    report = asemd.validate(path, steps=steps)
    return {"atoms": report.atoms, "energy": max((e.error for e in report.energies), default=0.0),
            "force": max((f.error for f in report.forces), default=0.0),
            "virial": max((f.virial_error for f in report.forces), default=0.0),
            "rows": max((r.error for r in report.rows), default=0.0), "agree": "yes" if report.ok else "no"}


def picture(found, path: Path) -> None:
    """Relative differences of each script, on a logarithmic scale; exact agreement is drawn at 1e-17."""
    from matplotlib.figure import Figure
    names = [Path(p).name for p in found.column("path")]
    figure = Figure(figsize=(6.4, 1.5 + 0.3 * len(names)), layout="constrained")
    axes = figure.subplots()
    for what, mark in zip(("energy", "force", "virial", "rows"), "osd^"):
        axes.semilogx(np.maximum(found.column(what), 1e-17), range(len(names)), mark, label=what, alpha=0.7)
    axes.axvline(1e-9, color="grey", linewidth=1)
    axes.set_yticks(range(len(names)), names)
    axes.set_xlabel("largest relative difference")
    axes.legend()
    figure.savefig(path)


def main() -> None:
    p = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    p.add_argument("--inputs", type=Path, default=HERE / "inputs")
    p.add_argument("--steps", type=int, default=20)
    p.add_argument("--processes", type=int, default=1)
    p.add_argument("--folder", type=Path, default=Path("validation"))
    options = p.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    # a script that was changed is another parameter: it is compared again
    runs = [{"path": str(f), "steps": options.steps, "sha256": hashlib.sha256(f.read_bytes()).hexdigest()[:12]}
            for f in sorted(options.inputs.glob("in.*"))]
    database = options.folder / "validation.db"
    if options.processes > 1:
        with ProcessPoolExecutor(options.processes) as pool:
            found = asemd.campaign(compare, runs, database, executor=pool)
    else:
        found = asemd.campaign(compare, runs, database)
    print(found.table())
    picture(found, options.folder / "validation.png")
    (options.folder / "result.json").write_text(json.dumps(found.rows, indent=1))


if __name__ == "__main__":
    main()
