"""Scenes written in other forms: LAMMPS scripts that LAMMPS runs with the same numbers, ASE scripts and files, data files."""
from __future__ import annotations

import os
import runpy
import shutil
import subprocess
import sys
from pathlib import Path

import ase.io
import bonded_scene
import numpy as np
import pytest
import shake_scene
from lj_cell import BASE
from test_embedded import potentials  # noqa: F401
from wheel import ask, ran, start

import asemd
from asemd.cli import main
from asemd.errors import InputError
from asemd.lammps.convert import convert
from asemd.tabulated import packaged

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


def test_masses_are_not_those_of_a_potential_file(tmp_path, potentials, monkeypatch):  # noqa: F811
    """Whose pair_coeff sets masses, after those of the data file."""
    monkeypatch.setenv("LAMMPS_POTENTIALS", potentials)
    text = ("units metal\nlattice fcc 3.6\nregion b block 0 2 0 2 0 2\ncreate_box 1 b\ncreate_atoms 1 box\npair_style eam/alloy\n"
            "pair_coeff * * Cu_mishin1.eam.alloy Cu\nmass 1 65\nvelocity all create 300 1\nfix 1 all nve\n")
    with ran(text) as lmp:
        path = lmp.scene.to_lammps(tmp_path, "x")
        lmp.command("run 5")
        monkeypatch.chdir(tmp_path)
        with start() as again:
            again.file(str(path))
            again.command("run 5")
            assert again.scene.system.mass[1] == 65.0
            assert again.get_thermo("ke") == pytest.approx(lmp.get_thermo("ke"), rel=1e-12)


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


ARGON = """units metal
lattice fcc 5.3
region b block 1 3 0 2 0 2
create_box 1 b
create_atoms 1 box
mass 1 40
pair_style lj/cut 5
pair_coeff 1 1 0.01 3.4
group g id 1:9
group h subtract all g
variable v equal 0.01
region r sphere 8 2 2 4
velocity all create 30 4711 loop geom
"""
ALONE = ["npt temp 30 30 0.1 iso 0 0 1", "nph aniso 0 0 1", "nvt temp 30 30 0.1", "rigid group 2 g h", "rigid/nve single"]
WITH_NVE = """langevin 30 30 0.1 123; temp/csvr 30 30 0.1 123; temp/berendsen v_w 30 0.1; deform 1 x erate 0.01 remap x; spring/self 0.5
    indent 0.1 sphere 8 2 2 2; recenter INIT INIT INIT; ti/spring 1 2 2; accelerate/cos 0.01; addforce v_v 0 0 region r
    momentum 1 linear 1 1 1; setforce NULL 0 0; spring tether 1 9 2 2 0; spring couple h 1 1 1 1 0; store/state 0 x y z; viscous 0.01
    press/berendsen iso 0 0 1; drag 7 2 3 0.1 1; gravity 1 vector 0 0 -1; aveforce 0.1 NULL NULL; heat 1 0.1; addtorque 0.1 0 0
    smd cvel 1 0.1 tether 1 1 1 2; halt 3 tlimit > 1000"""
MOVED = ["move linear 1 0 0", "move rotate 8 3 3 0 0 1 2", "rigid single", "nve/limit 0.1"]
FILES = """units metal
atom_style full
lattice fcc 3.615
region box block 0 2 0 2 0 2
create_box 2 box bond/types 1 extra/bond/per/atom 2 extra/special/per/atom 2
create_atoms 1 box
mass 2 1
molecule pair deep/pair.mol
create_atoms 0 single 1 1 0.5 mol pair 5
pair_style hybrid eam table linear 100
pair_coeff 1 1 eam deep/Mine.eam
pair_coeff *2 2 table {here}/pot.table LJ
bond_style table linear 100
bond_coeff 1 bond.table B
fix 1 all nve
fix 2 all ave/time 1 1 1 c_thermo_temp file deep/t.txt
run 2
"""


def test_python_with_any_fix(here, monkeypatch):
    """The script that is written ends where the script it is of ends, whatever fixes it has; the corner of a cell stays where it is."""
    fixes = [f"fix 1 all {words}" for words in ALONE]
    fixes += [f"variable w equal 30\nfix 1 all nve\nfix 2 g {words.strip()}" for words in WITH_NVE.replace("\n", ";").split(";")]
    fixes += [f"fix 1 g {words}\nfix 2 h nve" for words in MOVED]
    fixes.append("compute t g temp\nfix 1 all nvt temp 30 30 0.1\nfix_modify 1 temp t")
    for text in fixes:
        Path("in.c").write_text(f"{ARGON}{text}\nrun 3\n")
        path = here / convert("in.c", "python", "out")
        atoms = runpy.run_path(str(path))["atoms"]
        os.chdir(here)
        with start() as lmp:
            lmp.commands_list(["include in.c", "thermo_modify norm no"])
            there, box, energy = lmp.scene.system.x, lmp.scene.system.box, lmp.get_thermo("pe")
        distance = (atoms.positions - atoms.positions[0] - there + there[0]) @ box.inverse
        assert np.abs(distance - np.round(distance)).max() < 1e-12 and np.abs(atoms.cell.array - box.cell).max() < 1e-12, text
        assert atoms.get_potential_energy() == pytest.approx(energy, rel=1e-12), text


def test_python_of_held_bonds(here):
    """Bonds that a fix holds are on in the data file and are turned off when the fix is made."""
    shake_scene.write_data(here / "data.x")
    Path("in.w").write_text(shake_scene.SCRIPT.format(data="data.x", water="1:3") +
                            "fix h all shake 1e-4 100 0 b 1 4 a 1\nfix 1 all nve\nrun 3\n")
    energy = thermo_energy("in.w")
    found = runpy.run_path(str(here / convert("in.w", "python", "out")))
    assert found["atoms"].get_potential_energy() == pytest.approx(energy, rel=1e-12)
    assert (found["atoms"].topology.bond_types > 0).all()


@pytest.fixture
def files(here):
    """A script that reads files of several folders."""
    Path("deep").mkdir()
    shutil.copyfile(packaged()[0] / "Cu_u3.eam", "deep/Mine.eam")
    Path("deep/pair.mol").write_text("two\n\n2 atoms\n1 bonds\n\nCoords\n\n1 0 0 0\n2 1 0 0\n\nTypes\n\n1 2\n2 2\n\nBonds\n\n1 1 1 2\n")
    for name, title in (("pot.table", "LJ\nN 40"), ("bond.table", "B\nN 40")):
        rows = [f"{k + 1} {0.1 + 0.1 * k:.6f} {(k / 10 - 1) ** 2:.6f} {-(k / 10 - 1) / 0.5:.6f}" for k in range(40)]
        Path(name).write_text(title + "\n\n" + "\n".join(rows) + "\n")
    Path("in.f").write_text(FILES.format(here=here))
    return here


@pytest.mark.skipif(not packaged(), reason="no potential files")
def test_files_go_along(files, monkeypatch, capsys):
    energy = thermo_energy("in.f")
    Path("converted").mkdir()
    Path("converted/Mine.eam").write_text("another file of that name")
    written = {"in.f", "data.f", "1_Mine.eam", "Mine.eam", "pair.mol", "pot.table", "bond.table", "deep"}
    assert main(["convert", "in.f"]) == 0 and "run it in converted" in capsys.readouterr().out
    assert {p.name for p in Path("converted").iterdir()} == written and Path("converted/Mine.eam").read_text().startswith("another")
    assert main(["convert", "in.f", "-o", "."]) == 0 and not Path("pair.mol").exists()        # here all names hold
    assert "deep/Mine.eam" in Path("in.f").read_text()
    script = convert("in.f", "python", "out")
    assert main(["convert", "in.f"]) == 0 and {p.name for p in Path("converted").iterdir()} == written
    shutil.rmtree("deep")
    shutil.move("out", "elsewhere")
    for name in ("pot.table", "bond.table"):
        Path(name).unlink()
    done = subprocess.run([sys.executable, f"elsewhere/{script.name}"], capture_output=True, text=True)
    assert done.returncode == 0 and float(done.stdout.split()[-3]) == pytest.approx(energy, rel=1e-9), done.stderr
    Path("elsewhere/bond.table").unlink()
    done = subprocess.run([sys.executable, f"elsewhere/{script.name}"], capture_output=True, text=True)
    assert done.returncode == 1 and done.stderr.startswith("ERROR: ") and done.stderr.count("\n") == 1 and "bond.table" in done.stderr
    monkeypatch.chdir("converted")
    assert ask("lmp = start()\nlmp.file('in.f')\nanswer = lmp.get_thermo('pe')\nlmp.close()") == pytest.approx(energy, rel=1e-8)


@pytest.mark.parametrize(("text", "message"), [
    ("fix 1 all nve\nfix 2 all evaporate 2 1 b 123", "after fix 2 .style evaporate. there may be other atoms.*--to lammps"),
    ("fix 1 all nve\nrun_style respa 2 2 pair 1", "run_style respa has no form under ASE"),
    ("fix 1 all nve\nvariable f equal 1+step\npair_style hybrid/scaled v_f lj/cut 5\npair_coeff 1 1 lj/cut 0.01 3.4",
     "variable f of the force field changes during the run"),
])
def test_python_refuses_what_ase_cannot_follow(here, text, message):
    Path("in.c").write_text(f"{ARGON}{text}\nrun 3\n")
    with pytest.raises(InputError, match=message):
        convert("in.c", "python", "out")
    assert not Path("out").exists()


def test_python_of_friction_and_noise(here):
    """Energies and forces that take a run are those of the dynamics, whose log begins with the start."""
    Path("in.d").write_text("units lj\ncomm_modify vel yes\nlattice fcc 3.0\nregion b block 0 3 0 3 0 3\ncreate_box 1 b\n"
                            "create_atoms 1 box\nmass 1 1.0\nvelocity all create 1 4711\npair_style dpd 1.0 1.0 34387\n"
                            "pair_coeff 1 1 25.0 4.5\nfix 1 all nve\ntimestep 0.01\nrun 4\n")
    atoms = runpy.run_path(str(here / convert("in.d", "python", "out")))["atoms"]
    assert atoms.get_forces().shape == (108, 3) and atoms.get_potential_energy() > 0.0
    os.chdir(here)
    again, rows = asemd.read("in.d"), []
    md = asemd.MolecularDynamics(again, 0.01)
    md.attach(lambda: rows.append((again.get_potential_energy(), np.abs(again.get_forces()).max())), interval=2)
    md.run(4)
    assert again.get_potential_energy() == atoms.get_potential_energy() == rows[-1][0] and len(set(rows)) == 3
    Path("in.s").write_text(Path("in.d").read_text().partition("fix")[0])
    assert len(runpy.run_path(str(here / convert("in.s", "python", "still")))["atoms"]) == 108


def test_variables_of_the_force_field_go_along(here):
    """As factors and in expressions, whose variables stand before the coefficients and may change behind them."""
    text = """variable f equal 0.3
variable k equal 2*v_f
pair_style hybrid/scaled v_f lj/cut 6.0 0.4 lepton 6.0
pair_coeff * * lj/cut 0.01 3.4
pair_coeff * * lepton "4*eps*((3.3/r)^12-(3.3/r)^6);eps=0.02*v_k"
variable f equal 0.5
fix 1 all nve
run 3
"""
    Path("in.c").write_text(ARGON + text)
    energy = thermo_energy("in.c")
    atoms = runpy.run_path(str(here / convert("in.c", "python", "out")))["atoms"]
    os.chdir(here)
    assert atoms.get_potential_energy() == pytest.approx(energy, rel=1e-12)
    assert convert("in.c", "lammps", "plain").name == "in.c"
    os.chdir("plain")
    assert thermo_energy("in.c") == pytest.approx(energy, rel=1e-12)
    with ran(ARGON + text) as lmp, pytest.raises(InputError, match="hybrid/scaled uses v_f, which only a script can give"):
        lmp.scene.to_lammps("other")


def thermo_energy(path: str) -> float:
    """Potential energy of all atoms after the script, ASE units."""
    from asemd import units
    with start() as lmp:
        lmp.file(path)
        lmp.command("thermo_modify norm no")
        return lmp.get_thermo("pe") * units.factor("energy", lmp.scene.units)


@pytest.mark.parametrize("name", ["melt.extxyz", "melt.traj", "melt.json", "in.melt.xyz", "melt.extxyz.gz"])
def test_ase(here, name):
    assert main(["convert", "in.melt", "--to", "ase", "-o", name]) == 0
    os.rename(name, name := name.removeprefix("in."))
    atoms, read = ase.io.read(name), asemd.read("in.melt")
    assert np.allclose(atoms.positions, read.positions, atol=1e-7) and np.allclose(atoms.cell, read.cell)
    assert atoms.get_potential_energy() == pytest.approx(read.get_potential_energy(), rel=1e-7)
    assert "extxyz" not in name or np.array_equal(atoms.arrays["type"], read.arrays["type"])      # others keep what ASE knows only


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
