"""Molecules that come and go while fix rigid/small or fix shake holds them, against LAMMPS."""
from __future__ import annotations

import re

import numpy as np
import pytest
from both import ATOMS, asemd, lines_of
from water_molecule import BOX, water
from wheel import ask

from asemd.errors import InputError

SCENE = BOX.format(width=20, n="{n}", bond=1.0, angle=109.47, cut=8.0) + """
region slab block 2 18 2 18 2 18
velocity all create 300 4711
group more type 1 2
{fixes}
thermo_style custom step atoms pe temp press
thermo_modify norm no
{runs}
"""
BENT = ((0.0, 0.0, 0.0), (0.816497, 0.57735, 0.0), (-0.816497, 0.57735, 0.0))
MASSES = "\nMasses\n\n1 20.0\n2 3.0\n3 5.0\n"
GIVEN = "30.0 mass\n0.1 0.2 0.05 com\n3.0 4.0 5.0 0.2 0.1 0.3 inertia"
HEAVY, OWN = water(BENT) + MASSES, water(BENT).replace("1 angles\n", f"1 angles\n{GIVEN}\n")
FILES = {"heavy.mol": HEAVY, "own.mol": OWN}        # masses and inertia of bodies that are not those of the atoms
HELD, BARE = water(BENT, shake=True), water(BENT)
DEPOSIT = "fix d more deposit 3 0 5 4711 region slab near 2.0 attempt 100 mol water vx -0.01 0.01 vz -0.01 0.01 "
GCMC = "compute_modify thermo_temp dynamic/dof yes\nfix d more gcmc 2 30 0 0 29494 400.0 -7.0 0.0 mol water tfac_insert 1.6 "
SHAKE = "\nfix s all shake 1e-7 100 0 b 1 a 1 mol water\nfix 1 all nve"
SMALL = "\nfix s all rigid/small molecule mol water"
CASES = {
    "deposit shake": (DEPOSIT + "shake s" + SHAKE, "run 12"),
    "deposit rigid, two runs": (DEPOSIT + "rigid s" + SMALL, "run 7\nrun 5"),
    "deposit rigid/nve": (DEPOSIT + "rigid s" + SMALL.replace("small", "nve/small"), "run 12"),
    "deposit rigid/nvt": (DEPOSIT + "rigid s\nfix s all rigid/nvt/small molecule temp 300 300 50 mol water", "run 12"),
    "gcmc shake": (GCMC + "shake s" + SHAKE, "run 8"),
    "gcmc shake, full energy": (GCMC + "full_energy shake s" + SHAKE, "run 5"),
    "gcmc rigid": (GCMC + "rigid s" + SMALL, "run 6\nrun 2"),
    **{f"{what} rigid {name}": (f"molecule {name} {name}.mol\n" + (fix + "rigid s" + SMALL).replace("mol water", f"mol {name}"), run)
       for name in ("heavy", "own") for what, fix, run in (("deposit", DEPOSIT, "run 12"), ("gcmc", GCMC, "run 4"))},
    "gcmc rigid from nothing": ("delete_atoms group all\n" + GCMC + "rigid s" + SMALL, "run 6"),
    "gcmc rigid/nvt": (GCMC + "rigid s\nfix s all rigid/nvt/small molecule temp 300 300 50 mol water", "run 6"),
}
SCRIPT = ATOMS + """
answer = {}
for name, lines in given["cases"].items():
    lmp = ran(lines)
    answer[name] = atoms_of(lmp, ("id", "x", "v"))
    answer[name]["thermo"] = [lmp.get_thermo(key) for key in ("pe", "temp", "press")]
    lmp.close()
"""


def scene(name: str) -> str:
    fixes, runs = CASES[name]
    return SCENE.format(n=20, fixes=fixes, runs=runs)


@pytest.fixture(scope="module")
def theirs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("held")
    for mol, text in (FILES | {"water.mol": HELD}).items():
        (folder / mol).write_text(text)
    return ask(SCRIPT, cases={name: lines_of(re.sub(r"(\w+\.mol)", rf"{folder}/\1", scene(name))) for name in CASES})


@pytest.mark.parametrize("name", CASES)
def test_like_lammps(name, theirs, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for mol, content in (FILES | {"water.mol": HELD}).items():
        (tmp_path / mol).write_text(content)
    session, expected = asemd(scene(name)), theirs[name]
    system = session.scene.system
    order = np.argsort(system.id)
    assert system.id[order].tolist() == expected["id"]
    assert system.x[order] == pytest.approx(np.array(expected["x"]), abs=1e-6)
    assert system.v[order] == pytest.approx(np.array(expected["v"]), abs=1e-8)
    row = [session.moment.potential(), session.moment.temperature(), session.moment.pressure()]
    assert row == pytest.approx(expected["thermo"], rel=1e-5)


@pytest.mark.parametrize(("fixes", "said"), [
    (DEPOSIT + "rigid s shake s", "both rigid and shake"),
    (DEPOSIT.replace("mol water ", "") + "rigid s", "cannot use rigid and not molecule"),
    (DEPOSIT + "rigid s", "there is no fix s"),
    (DEPOSIT + "rigid 1\nfix 1 all nve", "has the style nve"),
    (DEPOSIT + "shake s" + SMALL, "has the style rigid/small"),
    (DEPOSIT + "rigid s\nfix s all rigid/small molecule", "not using the same molecule template"),
    ("fix s all rigid/small molecule mol fire", "there is no molecule fire"),
    ("fix s all rigid molecule mol water", "does not take the keyword mol"),
    ("fix s all rigid/small molecule mol hollow", "mol: the molecule has a negative principal moment of inertia, -4"),
    ("fix s all shake 1e-4 20 0 b 1 a 1 mol bare", "must have shake info"),
    (GCMC.replace("30 0 0", "30 5 0") + "rigid s", "cannot use rigid with MC moves"),
])
def test_mistakes(fixes, said, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "water.mol").write_text(HELD)
    (tmp_path / "bare.mol").write_text(BARE)
    (tmp_path / "hollow.mol").write_text(OWN.replace("3.0 4.0 5.0", "3.0 -4.0 5.0"))
    with pytest.raises(InputError, match=said):
        asemd(SCENE.format(n=5, fixes="molecule bare bare.mol\nmolecule hollow hollow.mol\n" + fixes, runs="run 0"))
