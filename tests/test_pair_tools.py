"""fix adapt, compute pair and pair_write on every registered two-body style, against LAMMPS."""
from __future__ import annotations

import json
import os
import subprocess
import sys

import numpy as np
import pytest
from wheel import ask, ran

from asemd import registry, style
from asemd.lammps import Lammps

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
compute one all pair {name}
thermo_style custom c_one evdwl ecoul
thermo_modify norm no
fix nve all nve
{then}
"""
CHANGE = """variable x equal 1.07
fix change all adapt 1 pair {name} {coefficient} 1 1 v_x scale yes
run 0 post no"""
WRITE = """run 0 post no
pair_write 1 2 12 r 1.1 4.9 {file} X 0.4 -0.6"""
SOLVERS = {"msm": "kspace_style msm 1e-4\nkspace_modify compute no cutoff/adjust no pressure/scalar no\npair_modify table 0",
           "ewald": "kspace_style ewald 1e-4\nkspace_modify gewald 0.3 compute no\npair_modify table 0"}
# LAMMPS goes on with what it had, all or part of it; whole numbers, which it takes for real ones
IDLE = {("lj/cubic", "sigma"), ("lj/long/coul/long", "epsilon"), ("lj/long/coul/long", "sigma"), ("coul/long/soft", "scale"),
        ("wf/cut", "nu"), ("wf/cut", "mu")}
CUTOFFS = {"harmonic/cut": ["cut"], **dict.fromkeys(("lj/cut/coul/cut", "lj/cut/coul/debye", "nm/cut/coul/cut"), ["cut_coul"])}
ENERGIES = """
import os
answer, error = {}, None
for name, lines in cases.items():
    file = lines[-1].split()[-4]
    lmp = start()
    try:
        for line in lines:
            lmp.command(line)
        answer[name] = [lmp.get_thermo("evdwl"), lmp.get_thermo("ecoul"), lmp.extract_compute("one", 0, 0)]
        if os.path.exists(file):
            rows = [line.split() for line in open(file)]
            answer[name] += [float(x) for row in rows if len(row) == 4 and row[0].isdigit() for x in row[1:]]
            os.remove(file)
    except Exception as e:
        answer[name] = str(e)
    lmp.close()
"""
THEIRS = "cases = given['cases']\n" + ENERGIES
OURS = """
import json, sys, warnings
from asemd.lammps import Lammps
warnings.simplefilter("ignore")
cases = json.load(sys.stdin)
start = lambda: Lammps(cmdargs=["-screen", "none", "-log", "none", "-compat", "lammps"])
""" + ENERGIES + "print(json.dumps(answer))"


def two_body(s) -> bool:
    """Whether the style's example stands by itself: numbers only, atoms with charges."""
    special = s.many or s.oriented or s.dielectric or "tip4p" in s.name or s.stirred or s.sized or not s.parts
    return not special and not any(p.unit in ("word", "file") for p in (*s.settings, *s.coeff))


def scenes(file: str) -> dict[str, list[str]]:
    """A change of every coefficient of every style by itself, and what pair_write makes of the style; of cutoffs those that LAMMPS changes
    without an accident."""
    out = {}
    for name in registry.names("pair"):
        s = style.find("pair", name)
        if not two_body(s):
            continue
        solver = next((text for kind, text in SOLVERS.items() if kind in s.solvers), "")
        if "ewald/disp" in s.solvers and name.split("/")[1] == "long":
            solver = solver.replace("ewald 1e-4", "ewald/disp 1e-4").replace("0.3", "0.3 gewald/disp 0.3") + " table/disp 0"
        scene = dict(name=name, settings=s.settings_example, coeff=f"pair_coeff * * {s.example}", solver=solver)
        out[name] = SCENE.format(**scene, then=WRITE.format(file=file)).splitlines()
        own = [p.name for p in s.coeff if not p.name.startswith(("cut", "inner", "outer"))]
        for p in CUTOFFS.get(name, ()):
            out[f"{name} {p}"] = SCENE.format(**scene, then=CHANGE.replace("1.07", "0.9").format(name=name, coefficient=p)).splitlines()
        for p in sorted({*own, *map(str.lower, own)}) + ["scale"] * s.scales:
            if (name, p) not in IDLE:
                out[f"{name} {p}"] = SCENE.format(**scene, then=CHANGE.format(name=name, coefficient=p)).splitlines()
    return out


def test_energies_and_tables(tmp_path):
    cases = scenes(str(tmp_path / "file.table"))
    theirs = ask(THEIRS, cases=cases)
    taken = {name: lines for name, lines in cases.items() if not isinstance(theirs[name], str)}
    run = subprocess.run([sys.executable, "-c", OURS], input=json.dumps(taken), capture_output=True, text=True, check=True, timeout=300,
                         env={**os.environ, "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)})
    ours, wrong = json.loads(run.stdout), []
    for name, mine in ours.items():
        want = np.array(theirs[name])
        if isinstance(mine, str) or not np.allclose(mine, want, rtol=1e-9, atol=1e-10 * np.abs(want[:3]).max()):
            wrong.append(f"{name}: {mine if isinstance(mine, str) else mine[:3]}, LAMMPS {theirs[name][:3]}")
    assert not wrong, "\n".join(wrong)
    assert sum(e[2] != 0.0 for e in ours.values()) > 0.95 * len(ours) > 200, [n for n, e in ours.items() if e[2] == 0.0]
    assert sum(len(e) == 3 + 36 for e in ours.values()) > 70


@pytest.mark.parametrize("change", ["harmonic/cut cut", "lj/cut/coul/cut cut_coul", "lj/cut cut"])
def test_larger_cutoff(change):
    """Lists grow with the cutoff, and energies are those of a style that had it from the beginning; afterwards it is as before."""
    name, coefficient = change.split()
    given = {"harmonic/cut": "30.0 {}", "lj/cut/coul/cut": "0.2 1.2 2.0 {}", "lj/cut": "0.1 1.2 {}"}[name]
    settings = "" if name == "harmonic/cut" else "2.0"
    adapt = f"variable c equal 1.5+step\nfix change all adapt 1 pair {name} {coefficient} * * v_c reset yes"
    scene = SCENE.format(name=name, settings=settings, coeff="pair_coeff * * " + given, solver="", then="timestep 0")
    want = [ran(scene.format(cut) + "run 0 post no").get_thermo("pe") for cut in (1.5, 4.5)]
    lmp = ran(scene.format(1.5) + adapt + "\nrun 3 post no")
    assert lmp.get_thermo("pe") == pytest.approx(want[1], rel=1e-13)
    lmp.commands_string("unfix change\nrun 0 post no")
    assert lmp.get_thermo("pe") == pytest.approx(want[0], rel=1e-13) and want[0] != want[1]


@pytest.mark.parametrize("precision", ["double", "mixed"])
def test_coefficients_that_leave_single_precision(precision):
    """Powers of coefficients too small for single precision take another formula, and another kernel."""
    lmp = Lammps(cmdargs=["-screen", "none", "-log", "none", "-precision", precision])
    lmp.commands_string("""units lj
lattice fcc 0.8442
region b block 0 4 0 4 0 4
create_box 1 b
create_atoms 1 box
mass 1 1
displace_atoms all random 0.1 0.1 0.1 4711
pair_style lj/cut 2.5
pair_coeff 1 1 1.0 1.0
fix move all nve
run 0 post no""")
    energy = lmp.get_thermo("pe")
    lmp.commands_string("""variable e equal 1.0*(step<1)+1.0e-24*(step>0)
fix a all adapt 1 pair lj/cut epsilon 1 1 v_e
timestep 0.0
run 2 post no""")
    assert lmp.get_thermo("pe") == pytest.approx(1e-24 * energy, rel=1e-6 if precision == "mixed" else 1e-12, abs=0.0)
