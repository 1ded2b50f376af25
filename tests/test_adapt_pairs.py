"""fix adapt on the coefficients of every registered two-body style, against LAMMPS: which ones change, and the energies after that."""
from __future__ import annotations

import json
import os
import subprocess
import sys

import numpy as np
import pytest
from wheel import ask

from asemd import registry, style

SCENE = """units real
atom_style full
region b block 0 5.3 0 5.7 0 6.1
create_box 2 b
create_atoms 1 random 6 12345 b overlap 1.35 maxtry 1000
create_atoms 2 random 4 777 b overlap 1.35 maxtry 1000
mass * 12
set type 1 charge 0.4
set type 2 charge -0.6
pair_style {name} {settings}
{coeff}
{solver}
variable x equal {factor}
fix change all adapt 1 pair {name} {coefficient} 1 1 v_x scale yes
thermo_modify norm no
fix nve all nve
run 0 post no
"""
SOLVERS = {"msm": "kspace_style msm 1e-4\nkspace_modify compute no cutoff/adjust no pressure/scalar no\npair_modify table 0",
           "ewald": "kspace_style ewald 1e-4\nkspace_modify gewald 0.3 compute no\npair_modify table 0"}
# LAMMPS goes on with what it had, all or part of it; whole numbers, which it takes for real ones
IDLE = {("lj/cubic", "sigma"), ("lj/long/coul/long", "epsilon"), ("lj/long/coul/long", "sigma"), ("coul/long/soft", "scale"),
        ("wf/cut", "nu"), ("wf/cut", "mu")}
THEIRS = """
answer = {}
for name, lines in given["cases"].items():
    lmp = start()
    try:
        for line in lines:
            lmp.command(line)
        answer[name] = [lmp.get_thermo("evdwl"), lmp.get_thermo("ecoul")]
    except Exception as e:
        answer[name] = str(e)
    lmp.close()
"""
OURS = """
import json, sys, warnings
from asemd.lammps import Lammps
warnings.simplefilter("ignore")
answer = {}
for name, lines in json.load(sys.stdin).items():
    lmp = Lammps(cmdargs=["-screen", "none", "-log", "none"])
    try:
        lmp.commands_string("\\n".join(lines))
        answer[name] = [lmp.get_thermo("evdwl"), lmp.get_thermo("ecoul")]
    except Exception as e:
        answer[name] = str(e)
    lmp.close()
print(json.dumps(answer))
"""


def two_body(s) -> bool:
    """Whether the style's example stands by itself: numbers only, atoms with charges."""
    special = s.many or s.oriented or s.on_sites or s.stirred or s.sized or not s.parts
    return not special and not any(p.unit in ("word", "file") for p in (*s.settings, *s.coeff))


def scenes() -> dict[str, list[str]]:
    """Every coefficient of every style by itself; cutoffs, which asemd does not change, are left out."""
    out = {}
    for name in registry.names("pair"):
        s = style.find("pair", name)
        if not two_body(s):
            continue
        solver = next((text for kind, text in SOLVERS.items() if kind in s.solvers), "")
        if "ewald/disp" in s.solvers and name.split("/")[1] == "long":
            solver = solver.replace("ewald 1e-4", "ewald/disp 1e-4").replace("0.3", "0.3 gewald/disp 0.3") + " table/disp 0"
        coeff = f"pair_coeff * * {s.example}"
        own = [p.name for p in s.coeff if not p.name.startswith(("cut", "inner", "outer"))]
        for p in sorted({*own, *map(str.lower, own)}) + ["scale"] * s.scales:
            if (name, p) not in IDLE:
                out[f"{name} {p}"] = SCENE.format(name=name, settings=s.settings_example, coeff=coeff, solver=solver, coefficient=p,
                                                  factor=1.07).splitlines()
    return out


@pytest.fixture(scope="module")
def energies():
    cases = scenes()
    theirs = ask(THEIRS, cases=cases)
    taken = {name: lines for name, lines in cases.items() if not isinstance(theirs[name], str)}
    run = subprocess.run([sys.executable, "-c", OURS], input=json.dumps(taken), capture_output=True, text=True, check=True, timeout=300,
                         env={**os.environ, "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)})
    return theirs, json.loads(run.stdout)


def test_energies_after_a_change(energies):
    theirs, ours = energies
    wrong = []
    for name, mine in ours.items():
        scale = sum(map(abs, theirs[name]))
        if isinstance(mine, str) or not np.allclose(mine, theirs[name], rtol=0, atol=1e-10 * scale):
            wrong.append(f"{name}: {mine}, LAMMPS {theirs[name]}")
    assert not wrong, "\n".join(wrong)
    assert sum(any(e) for e in ours.values()) > 0.95 * len(ours) > 100, [n for n, e in ours.items() if not any(e)]
