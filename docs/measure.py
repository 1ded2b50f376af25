"""How far every force-field style is from LAMMPS, over random geometries: ``python docs/measure.py`` writes docs/measured/agreement.json.

For each style the scene of `style_scenes` is filled with twelve items (pairs, bonds, angles ...) far from each other, placed at random ten
times; asemd and LAMMPS run the same script. The pages of the styles show the numbers. ``python docs/measure.py "bond morse" ...`` measures
some styles again and keeps the others.
"""
from __future__ import annotations

import importlib.metadata
import json
import os
import platform
import sys
import tempfile
import warnings
import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE)]

import style_scenes  # noqa: E402
from style_scenes import Scene  # noqa: E402

from asemd import style as registry  # noqa: E402
from asemd.lammps import Lammps  # noqa: E402
from asemd.testing import oracle  # noqa: E402
from asemd.topology import ATOMS  # noqa: E402

FILE = HERE / "measured" / "agreement.json"
ITEMS, TIMES, GRID, SPACING = 12, 10, (3, 2, 2), 30.0
THEIRS = """
answer = []
for lines, places in given["jobs"]:
    lmp = start("-nocite")
    lmp.commands_list(lines)
    rows = []
    for x in places:
        lmp.scatter_atoms("x", 1, 3, (lmp_double * x.size)(*x.ravel()))
        lmp.command("run 0 post no")
        rows.append((lmp.get_thermo("pe"), by_id(lmp, "f")))
    answer.append([[e for e, _ in rows], np.array([f for _, f in rows])])
    lmp.close()
"""


def measured() -> list[tuple[str, str]]:
    """Styles with forces that are compared: not those made of others."""
    return [(c, n) for c, n in style_scenes.every_style()
            if n not in ("none", "zero", *style_scenes.HYBRIDS) and (c, n) != ("pair", "none")]


def places(category: str, name: str) -> np.ndarray:
    """Positions (TIMES, ITEMS * k, 3) of random items around the points of a grid."""
    style, rng = registry.find(category, name), np.random.default_rng(zlib.crc32(f"{category} {name}".encode()))
    k = ATOMS.get(category, 2)
    centres = (np.stack(np.meshgrid(*[np.arange(n) for n in GRID], indexing="ij"), -1).reshape(-1, 3) - (np.array(GRID) - 1) / 2) * SPACING
    lo, hi, length = 0.75, 1.3, 1.2
    if category in ("bond", "pair"):
        length = style_scenes.distance(style)
        lo, hi = 0.85, 1.15                 # no bond that may break does
    if category == "pair":
        settings = style.parse_settings(style.settings_example.split())
        cut = 2.5 if name == "table" else style.reach(style.parse_coeff(style_scenes.words_of(style)[0], settings), settings)
        lo, hi = 0.9, 0.99 * cut / length
    steps = rng.normal(size=(TIMES, ITEMS, k, 3))
    steps *= length * rng.uniform(lo, hi, (TIMES, ITEMS, k, 1)) / np.linalg.norm(steps, axis=3, keepdims=True)
    return (np.cumsum(steps, axis=2) + centres[None, :, None]).reshape(TIMES, ITEMS * k, 3)


def job(category: str, name: str) -> tuple[Scene, list[str], np.ndarray]:
    """The scene with many items, the lines of its script, and the places of its atoms."""
    scene, x = style_scenes.scene(category, name), places(category, name)
    scene = replace(scene, positions=[tuple(p) for p in x[0].tolist()], charges=scene.charges * ITEMS, size=60.0)
    lines = style_scenes.lammps(scene).replace("group second id 2\n", f"group second id 2:{2 * ITEMS}:2\n").splitlines()
    lines.insert(1, "neighbor 2.0 bin")
    if category == "angle" and name == "dipole":
        lines = [line.replace("set atom 1 dipole", "set group all dipole") for line in lines]
    return scene, [*lines[:-1], "thermo_modify norm no", lines[-1]], x


def ours(lines: list[str], x: np.ndarray, compat: bool) -> tuple[np.ndarray, np.ndarray]:
    """Energies (TIMES,) and forces (TIMES, n, 3) of asemd."""
    with Lammps(cmdargs=["-screen", "none", "-log", "none", *["-compat", "lammps"] * compat]) as lmp:
        lmp.commands_list(lines)
        energies, forces = [], []
        for place in x:
            lmp.scatter_atoms("x", 1, 3, place.ravel().tolist())
            lmp.command("run 0 post no")
            energies.append(lmp.get_thermo("pe"))
            forces.append(np.array(lmp.gather_atoms("f", 1, 3)).reshape(-1, 3))
    return np.array(energies), np.array(forces)


def difference(a, b) -> dict[str, float]:
    """Largest differences, relative to the energy and to the largest force of each geometry."""
    energy = np.abs(a[0] - b[0]) / np.maximum(np.abs(b[0]), 1e-300)
    force = np.abs(a[1] - b[1]).max(axis=(1, 2)) / np.maximum(np.abs(b[1]).max(axis=(1, 2)), 1e-300)
    return {"energy": float(f"{energy.max():.1e}"), "force": float(f"{force.max():.1e}")}


def has_twin(category: str, name: str) -> bool:
    """Whether LAMMPS's force of the style is not the gradient of its energy."""
    found = registry.find(category, name)
    return bool(found.lammps or getattr(found, "twin", None))


def measure(styles: list[tuple[str, str]]) -> dict[str, dict]:
    """``{"bond morse": {"commands": [...], "energy": ..., "force": ...}}``; for styles with a twin `gradient` has the differences without
    ``-compat lammps``."""
    out, here = {}, os.getcwd()
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        os.chdir(folder)
        try:
            for category in ("bond", "angle", "dihedral", "pair"):
                style_scenes.write_table(category, folder)
            jobs = [job(c, n) for c, n in styles]
            # LAMMPS has its own folder: tables are named by their whole path
            asked = [[line.replace(f"{s.table} ", f"{folder}/{s.table} ") if s.table else line for line in lines] for s, lines, _ in jobs]
            script = "from ctypes import c_double as lmp_double\n" + THEIRS
            theirs = oracle.ask(script, jobs=[[lines, x] for lines, (_, _, x) in zip(asked, jobs)], timeout=1200)
            for (c, n), (scene, lines, x), answer in zip(styles, jobs, theirs):
                want = np.array(answer[0]), np.array(answer[1])
                entry = {"units": scene.unit, "commands": scene.lines, **difference(ours(lines, x, True), want)}
                if has_twin(c, n):
                    entry["gradient"] = difference(ours(lines, x, False), want)
                out[f"{c} {n}"] = entry
        finally:
            os.chdir(here)
    return out


def machine() -> dict[str, str]:
    """Processor and versions."""
    info, model = Path("/proc/cpuinfo"), platform.processor() or platform.machine()
    if info.exists():
        model = next((line.split(":")[1].strip() for line in info.read_text().splitlines() if line.startswith("model name")), model)
    from asemd import __version__
    return {"cpu": model, "python": platform.python_version(), "asemd": __version__, "lammps": oracle.lammps_version() or "none",
            **{name: importlib.metadata.version(name) for name in ("numpy", "numba")}}


def main() -> int:
    given = [tuple(name.split(" ", 1)) for name in sys.argv[1:]]
    if not oracle.lammps_available():
        print(oracle.why_not())
        return 1
    known = json.loads(FILE.read_text())["styles"] if given and FILE.exists() else {}
    known |= measure(given or measured())
    FILE.parent.mkdir(exist_ok=True)
    rows = ",\n".join(f"  {json.dumps(name)}: {json.dumps(entry)}" for name, entry in sorted(known.items()))
    FILE.write_text(f'{{"machine": {json.dumps(machine())},\n "geometries": {ITEMS * TIMES},\n "styles": {{\n{rows}}}}}\n')
    return 0


if __name__ == "__main__":
    sys.exit(main())
