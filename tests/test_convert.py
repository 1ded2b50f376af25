"""Scenes written in other forms: LAMMPS scripts that LAMMPS runs with the same numbers, ASE scripts and files, data files."""
from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import ase.io
import bonded_scene
import numpy as np
import pytest
from lj_cell import BASE
from wheel import ask, ran, start

import asemd
from asemd.cli import main
from asemd.errors import InputError

ROOT = Path(__file__).resolve().parents[1]
ROWS = """
import os
answer = {}
for name, place in given["folders"].items():
    os.chdir(place)
    l = start()
    l.file("in." + name)
    answer[name] = {"thermo": l.last_thermo(), "x": by_id(l, "x")}
    l.close()
"""
BONDED = "\n".join(bonded_scene.head("DATA", styles=bonded_scene.HYBRID) + bonded_scene.HYBRID_COEFF)
SPHEROIDS = """atom_style ellipsoid
lattice fcc 0.8442
region box block 0 2 0 2 0 2
create_box 1 box
create_atoms 1 box
set type 1 shape 1 1 1.2
set type 1 quat/random 5
velocity all create 1.44 87287 loop geom
pair_style gayberne 1 3 1 1.5
pair_coeff 1 1 1.0 0.9 1 1 0.5 0 0 0
fix 1 all npt/asphere temp 1 1 0.1 iso 0 0 1
"""
SCENES = {
    "melt": BASE + "variable t index 1.2\nfix 2 all temp/berendsen $t 1.0 0.5\nthermo_style custom step temp pe press\nrun 20",
    "groups": "newton on off\n" + BASE + "group a id 1:5\ngroup b id 9 20\nneigh_modify exclude group a b every 2 delay 4\n"
    "region r block 0 1 INF INF INF INF\nvariable f equal 0.1+0.001*step\nfix 3 a addforce v_f 0 0 region r\n"
    "compute k a ke\nthermo_style custom step pe c_k\nrun 10",
    "film": "boundary s p fs\n" + BASE + "velocity all create 0.1 5\nthermo_style custom step pe press vol xlo xhi zhi\nrun 4",
    "grains": "atom_style sphere\n" + BASE.replace("mass 1 1.0\n", "") + "set type 1 diameter 1.1\ncompute k all ke/atom\n"
    "dump d all custom 5 dump.grains id c_k\ndump_modify d sort id\nrun 10",
    "spheroids": SPHEROIDS + "compute k all erotate/asphere\nthermo_style custom step pe c_k press\nrun 10",
    "bonded": BONDED + "\nreset_timestep 30\ntimestep 0.5\nfix 1 all nvt temp 300 300 50\n"
    "thermo_style custom step temp pe ebond eangle press\nrun 10",
}


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("DATA").write_text(bonded_scene.data())
    for name, text in SCENES.items():
        Path(f"in.{name}").write_text(text + "\n")
    return tmp_path


def thermo(path: str) -> dict:
    with start() as lmp:
        lmp.file(path)
        order = np.argsort(lmp.scene.system.id)
        return {"thermo": lmp.last_thermo(), "x": lmp.scene.system.x[order]}


def test_lammps_runs_what_is_written(here):
    ours = {name: thermo(f"in.{name}") for name in SCENES}
    for name in SCENES:
        assert main(["convert", f"in.{name}", "--to", "lammps", "-o", f"{name}.out"]) == 0
        os.chdir(f"{name}.out")
        again = thermo(f"in.{name}")
        os.chdir("..")
        assert again["thermo"] == pytest.approx(ours[name]["thermo"], rel=1e-9)
    written = Path("grains.out/dump.grains")
    assert written.read_text() == Path("dump.grains").read_text() and not written.unlink()
    theirs = ask(ROWS, folders={name: str(here / f"{name}.out") for name in SCENES})
    assert written.read_text().count("ITEM: TIMESTEP") == 3
    for name in SCENES:
        for key, value in theirs[name]["thermo"].items():
            assert value == pytest.approx(ours[name]["thermo"][key], rel=1e-9, abs=1e-9), (name, key)
        assert np.abs(theirs[name]["x"] - ours[name]["x"]).max() < 1e-8


def test_scene_to_lammps(here):
    with ran(BASE + "fix 2 all langevin 1 1 0.3 123\ngroup a id 1:4\nfix 3 a setforce 0 NULL 0\nrun 5") as lmp:
        path = lmp.scene.to_lammps("deep/er", "x")
        assert path == Path("deep/er/in.x")
        lmp.commands_string("variable f equal 1\nfix 4 all addforce v_f 0 0")
        with pytest.raises(InputError, match="fix 4 .style addforce. uses v_f"):
            lmp.scene.to_lammps("other")
        os.chdir("deep/er")
        with start() as again:
            again.file("in.x")
            assert list(again.scene.fixes) == ["1", "2", "3"] and again.scene.step == 5 and again.scene.groups["a"].sum() == 4
            for l in (lmp, again):
                l.command("unfix 2")
                if l is lmp:
                    l.command("unfix 4")
                l.command("run 5")
            assert again.get_thermo("pe") == pytest.approx(lmp.get_thermo("pe"), rel=1e-11)


@pytest.mark.parametrize("name", ["melt", "bonded"])
def test_python(here, name):
    assert main(["convert", f"in.{name}", "--to", "python", "-o", "out"]) == 0
    done = subprocess.run([sys.executable, f"out/{name}.py"], capture_output=True, text=True, env={**os.environ, "PYTHONPATH": str(ROOT)})
    assert done.returncode == 0, done.stderr
    words = done.stdout.splitlines()[-1].split()
    assert float(words[2]) == pytest.approx(thermo_energy(f"in.{name}"), rel=1e-8)


def thermo_energy(path: str) -> float:
    """Potential energy of all atoms after the script, ASE units."""
    from asemd import units
    with start() as lmp:
        lmp.file(path)
        lmp.command("thermo_modify norm no")
        return lmp.get_thermo("pe") * units.factor("energy", lmp.scene.units)


@pytest.mark.parametrize("ending", ["extxyz", "traj", "json"])
def test_ase(here, ending):
    assert main(["convert", "in.melt", "--to", "ase", "-o", f"melt.{ending}"]) == 0
    atoms, read = ase.io.read(f"melt.{ending}"), asemd.read("in.melt")
    assert np.allclose(atoms.positions, read.positions, atol=1e-7) and np.allclose(atoms.cell, read.cell)
    assert atoms.get_potential_energy() == pytest.approx(read.get_potential_energy(), rel=1e-7)
    assert ending != "extxyz" or np.array_equal(atoms.arrays["type"], read.arrays["type"])      # others keep what ASE knows only


def test_data(here):
    assert main(["convert", "in.melt", "--to", "data", "-o", "d"]) == 0
    assert np.allclose(asemd.read("d", units="lj").positions, asemd.read("in.melt").positions, atol=1e-12)
    assert "Pair Coeffs # lj/cut" in Path("d").read_text()


def test_nothing_that_is_there_is_overwritten(here):
    """By default everything goes into one folder under names that differ; an existing folder gets the file under such a name."""
    Path("data.melt").write_text("precious")
    for form in ("lammps", "python", "ase", "data"):
        assert main(["convert", "in.melt", "--to", form]) == 0
    assert Path("data.melt").read_text() == "precious"
    names = {p.name for p in Path("converted").iterdir()}
    assert names == {"in.melt", "data.melt", "melt.py", "in.melt_atoms", "data.melt_atoms", "melt.extxyz", "melt.data"}
    assert "\nrun " in Path("converted/in.melt").read_text()
    Path("folder").mkdir()
    for form in ("ase", "data"):
        assert main(["convert", "in.melt", "--to", form, "-o", "folder"]) == 0
    assert {p.name for p in Path("folder").iterdir()} == {"melt.extxyz", "melt.data"}


@pytest.mark.parametrize(("words", "message"), [
    (["in.melt", "--to", "ase", "-o", "nothing"], "ending that says the format"),
    (["in.melt", "--to", "pdf"], "--to must be one of lammps python ase data"), ([], "asemd convert needs a script"),
    (["in.none"], "cannot open input script in.none"),
    (["in.melt", "--to", "ase", "-o", "a.nonsense"], "ASE knows no format for a.nonsense"),
    (["in.melt", "-o", "DATA/x"], "cannot write DATA/x"), (["in.empty"], "simulation box"),
])
def test_mistakes(here, capsys, words, message):
    Path("in.empty").write_text("units lj\n")
    assert main(["convert", *words]) == 1
    assert message in capsys.readouterr().err


def test_style_of_ones_own(tmp_path, monkeypatch):
    """``--import`` of convert: the Python script that is written imports the file too."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "own.py").write_text("from asemd.style import bond\n\n\n@bond('own/square', example='3 1')\n"
                                     "def square(r, K: 'energy/distance^2', r0: 'distance'):\n"
                                     "    return K * (r - r0) ** 2, 2 * K * (r - r0)\n")
    (tmp_path / "in.own").write_text("atom_style bond\nregion b block 0 5 0 5 0 5\ncreate_box 1 b bond/types 1 extra/bond/per/atom 1\n"
                                     "mass 1 1\ncreate_atoms 1 single 1 1 1\ncreate_atoms 1 single 3 1 1\nbond_style own/square\n"
                                     "bond_coeff 1 3 1\ncreate_bonds single/bond 1 1 2\nfix 1 all nve\nrun 2\n")
    for words in (["-m", "asemd", "convert", "in.own", "--to", "python", "--import", "own.py"], ["converted/own.py"]):
        done = subprocess.run([sys.executable, *words], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
    assert "potential energy 3.0" in done.stdout
