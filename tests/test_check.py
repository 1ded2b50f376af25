"""asemd check: healthy scenes raise no alarm, a twin that is broken in one way is found by the check for it."""
from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import test_bad_input
from check_scenes import BUTANE, CHAIN, LJ, butane_data, chain_data

import asemd
from asemd import cli
from asemd.errors import AsemdError, InputError
from asemd.finding import Finding

ROOT = Path(__file__).resolve().parents[1]
DIMER = """units lj
atom_style bond
region b block 0 9 0 9 0 9
create_box 1 b bond/types 1 extra/bond/per/atom 2 extra/special/per/atom 2
create_atoms 1 single 4 4 4
create_atoms 1 single 5.1 4 4
mass 1 2.0
bond_style harmonic
bond_coeff 1 50.0 1.0
create_bonds single/bond 1 1 2
velocity all create 0.01 1
fix 1 all nve
timestep 0.19
run 5
"""
HARMONIC = BUTANE.replace("special_bonds amber", "special_bonds lj/coul 0 0 0.5")
MOVED = "set atom 2 x {} y 0.0 z 0.0\n"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "chain.data").write_text(chain_data())
    (tmp_path / "butane.data").write_text(butane_data())
    return tmp_path


def check(text: str, **options):
    Path("in.x").write_text(text)
    return asemd.check("in.x", **options)


def edit(text: str, *edits: tuple[str, str]) -> str:
    for old, new in edits:
        assert old in text
        text = text.replace(old, new)
    return text


SWITCHED = BUTANE.replace("lj/cut/coul/cut 10.0", "lj/charmm/coul/charmm 8.0 10.0")


@pytest.mark.parametrize("text", [LJ, CHAIN, SWITCHED], ids=["lj", "chain", "butane"])
def test_healthy_scenes_raise_no_alarm(folder, text):
    report = check(text)
    assert not report.at_least("note"), report
    assert {"atoms in the box", "time step", "fastest vibration", "overlaps", "first step", "units"} <= {f.name for f in report}


@pytest.mark.parametrize("name", ["lj-melt", "polymer-melt"])
def test_workflows_raise_no_alarm(folder, name):
    text = (ROOT / "workflows" / name / "in.melt").read_text().replace("melt.data", "chain.data")
    assert check(text).worst in ("ok", "note")


# twin, check that finds it, severity, atoms it names first, words of the message
BROKEN = {
    "timestep too long": (edit(LJ, ("timestep 0.005", "timestep 0.03")), "time step", "warning", (), "its frequency is off by 8."),
    "timestep not stable": (edit(LJ, ("timestep 0.005", "timestep 0.06")), "time step", "error", (), "beyond period / pi"),
    "bonds not stable": (edit(CHAIN, ("timestep 0.006", "timestep 0.05")), "time step", "error", None, "bond type 1 (fene)"),
    "Lanczos finds it too": (edit(CHAIN, ("timestep 0.006", "timestep 0.05")), "fastest vibration", "error", None, "grows without bounds"),
    "timestep of picoseconds": (edit(BUTANE, ("timestep 1.0", "timestep 0.001")), "time step", "note", None, "usual in units real: 1.0"),
    "two atoms near": (edit(LJ, ("run 10", MOVED.format("0.3") + "run 10")), "overlaps", "error", (1, 2), "1-2 at distance"),
    "two atoms in one place": (edit(LJ, ("run 10", MOVED.format("0.0") + "run 10")), "overlaps", "error", (1, 2), "distance 0"),
    "a collision too close": (edit(LJ, ("run 10", MOVED.format("0.75") + "run 10")), "overlaps", "warning", (1, 2), "kT"),
    "large force": (edit(LJ, ("run 10", MOVED.format("0.3") + "run 10")), "first step", "error", None, "in a single step"),
    "atom outside": (edit(LJ, ("units lj", "units lj\nboundary p p f"), ("run 10", "set atom 7 z -0.5\nrun 10")), "atoms in the box",
                     "error", (7,), "outside the fixed faces along z"),
    "cutoff in the well": (edit(LJ, ("lj/cut 2.5", "lj/cut 1.3")), "jump at the cutoff", "warning", (), "pair_modify shift yes"),
    "shifted in the well": (edit(LJ, ("lj/cut 2.5", "lj/cut 1.3"), ("run 10", "pair_modify shift yes\nrun 10")), "jump at the cutoff",
                            "note", (), "energy of types 1 and 1 does not jump"),
    "small box": (edit(LJ, ("0 4 0 4 0 4", "0 2 0 2 0 2"), ("lj/cut 2.5", "lj/cut 3.5")), "box and cutoff", "warning", (), "and itself"),
    "short damping": (edit(BUTANE, ("300.0 100.0", "300.0 5.0")), "temperature damping", "warning", (), "5 steps"),
    "no damping time": (edit(BUTANE, ("300.0 100.0", "300.0 1.0")), "temperature damping", "error", (), "too short"),
    "friction": (edit(CHAIN, ("1.0 10.0", "1.0 0.02")), "temperature damping", "warning", (), "friction of a step is 30 %"),
    "friction that turns round": (edit(CHAIN, ("1.0 10.0", "1.0 0.002")), "temperature damping", "error", (), "turns velocities round"),
    "exclusions of fene": (edit(CHAIN, ("special_bonds fene", "special_bonds lj/coul 1 1 1"), ("lj/cut 1.12", "lj/cut 2.5"),
                                ("1 1 1.0 1.0\nvel", "1 1 5.0 1.05\nvel")), "exclusions", "warning", None, "special_bonds for them is 1"),
    "exclusions of molecules": (edit(HARMONIC, ("lj/coul 0 0", "lj/coul 1 1")), "exclusions", "warning", None, "bonded pairs"),
    "sigma in nm": (edit(BUTANE, ("0.15 3.75", "0.15 0.375")), "units", "warning", (), "factor of 10 comes from nm"),
    "epsilon in K": (edit(BUTANE, ("0.15 3.75", "75.0 3.75")), "units", "warning", (), "deeper than van der Waals"),
    "cutoff in nm": (edit(BUTANE, ("cut 10.0", "cut 1.0")), "units", "warning", (), "The cutoff is 1 Angstrom"),
    "bond in nm": (edit(BUTANE, ("260.0 1.54", "260.0 0.154")), "units", "warning", (), "0.154 Angstrom"),
    "bond in nm, seen on the structure": (edit(BUTANE, ("260.0 1.54", "260.0 0.154")), "rest lengths", "warning", None, "a factor of 10"),
    "constant in eV": (edit(BUTANE, ("260.0 1.54", "11.3 1.54")), "units", "warning", None, "eV where kcal/mol is meant"),
    "constant in kJ and nm": (edit(BUTANE, ("260.0 1.54", "224262.0 1.54")), "units", "warning", None, "kJ/mol/nm^2"),
    "angle in radians": (edit(BUTANE, ("63.0 112.0", "63.0 1.9548")), "rest angles", "warning", None, "112"),
    "reduced temperature": (edit(BUTANE, ("create 300.0", "create 1.0"), ("300.0 300.0", "1.0 1.0")), "units", "note", (), "reduced"),
    "Kelvin in lj": (edit(LJ, ("create 1.44", "create 300.0")), "units", "warning", (), "were Kelvin meant"),
    "no integrator": (edit(LJ, ("fix 1 all nve", "")), "script", "note", (), "won't move"),
    "two integrators": (edit(LJ, ("run 10", "fix 2 all nve\nrun 10")), "script", "warning", (), "more than once"),
    "a later run": (LJ + "timestep 0.03\nrun 10\n", "time step", "warning", (), "its frequency is off by 8."),
    "kcal in metal": (edit(BUTANE, ("units real", "units metal"), ("timestep 1.0", "timestep 0.0001"), ("300.0 100.0", "300.0 0.1"),
                           ("0.15 3.75", "0.0065 3.75")), "units", "warning", None, "factor 23"),
    "respa in tune": (edit(BUTANE, ("timestep 1.0", "timestep 12.0\nrun_style respa 2 12 bond 1 angle 1 dihedral 1 pair 2"),
                           ("nvt temp 300.0 300.0 100.0", "nve")), "r-RESPA", "warning", None, "in tune"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_broken_twins_are_found(folder, name):
    text, what, severity, atoms, words = BROKEN[name]
    found = [f for f in check(text).of(what) if f.rank]
    assert found, name
    worst = max(found, key=lambda f: f.rank)
    assert worst.severity == severity and words in worst.message + worst.advice, worst
    assert atoms is None or worst.atoms[:len(atoms)] == atoms


def test_integrators_that_stand_any_friction(folder):
    text = edit(CHAIN, ("fix 1 all nve\n", ""), ("langevin 1.0 1.0 10.0", "baoab 1.0 1.0 0.002"))
    assert check(text).of("temperature damping")[0].severity == "note"
    text = edit(CHAIN, ("1.0 10.0 904297", "1.0 0.02 904297 gjf vhalf"))
    assert check(text).of("temperature damping")[0].severity == "ok"


def test_damping_times_of_barostats(folder):
    text = edit(BUTANE, ("nvt temp 300.0 300.0 100.0", "npt temp 300.0 300.0 100.0 iso 0 0 60.0"))
    report = check(text)
    found = [*report.of("temperature damping"), *report.of("pressure damping")]
    assert [f.severity for f in found] == ["ok", "warning"] and "pressure with a damping time of 60" in found[1].message


def test_scaling_of_velocities_has_no_damping_time(folder):
    text = edit(BUTANE, ("nvt temp 300.0 300.0 100.0", "nve"), ("run 10", "fix 2 all temp/rescale 1 300 300 1.0 1.0\nrun 10"))
    assert not check(text).of("temperature damping")
    berendsen = check(edit(text, ("temp/rescale 1 300 300 1.0 1.0", "temp/berendsen 300 300 5.0")))
    assert berendsen.of("temperature damping")[0].severity == "warning"


def test_exclusions_by_neigh_modify_are_seen(folder):
    text = edit(HARMONIC, ("lj/coul 0 0", "lj/coul 1 1"))
    assert check(text).of("exclusions")[0].severity == "warning"
    assert not check(edit(text, ("run 10", "neigh_modify exclude molecule/intra all\nrun 10"))).of("exclusions")[0].rank


def test_where_a_script_helps_itself_there_is_no_alarm(folder):
    near = edit(LJ, ("run 10", MOVED.format("0.3") + "run 10"))
    for text in (edit(near, ("run 10", "minimize 1e-4 1e-6 10 100\nrun 10")), edit(near, ("all nve", "all nve/limit 0.05"))):
        report = check(text)
        assert report.of("overlaps")[0].severity == "note" and report.ok, report


@pytest.mark.parametrize("length, severity", [(1.2, "ok"), (1.42, "warning"), (1.6, "error")])
def test_fene_limit(folder, length, severity):
    (folder / "chain.data").write_text(chain_data(length))
    report = check(CHAIN)
    finding = report.of("bond limits")[0]
    assert finding.severity == severity and report.exit_status == 2 * (severity == "error")
    if severity != "ok":
        assert finding.atoms == (1, 2) and finding.value == pytest.approx(length)


def test_bonds_that_break_are_a_note(folder):
    (folder / "chain.data").write_text(chain_data(1.25))
    quartic = edit(CHAIN, ("special_bonds fene\nbond_style fene", "special_bonds lj/coul 1 1 1\nbond_style quartic"),
                   ("30.0 1.5 1.0 1.0", "1200 -0.55 0.25 1.3 34.6878"))
    found = check(quartic).of("bond limits")
    assert found[0].severity == "note" and found[0].atoms == (1, 2) and "breaks at 1.3" in found[0].message


def test_a_table_that_ends_too_soon(folder):
    def table(end: float) -> None:
        r = np.linspace(1.2, end, 50)
        rows = "\n".join(f"{k} {a:.6f} {260 * (a - 1.54)**2:.9g} {-520 * (a - 1.54):.9g}" for k, a in enumerate(r, 1))
        (folder / "t.txt").write_text(f"CC\nN 50 EQ 1.54\n\n{rows}\n")
    text = edit(BUTANE, ("bond_style harmonic", "bond_style table spline 100"), ("1 260.0 1.54", "1 t.txt CC"))
    table(2.2)
    assert not check(text).of("bond limits")[0].rank
    table(1.6)
    finding = check(text).of("bond limits")[0]
    assert finding.severity == "warning" and "costs only 1.6 kT" in finding.message


@pytest.mark.parametrize("rest, bend, severity", [(112.0, 179.5, "warning"), (180.0, 179.5, "ok"), (170.0, 179.5, "note"),
                                                  (112.0, 112.0, "ok")])
def test_straight_angles(folder, rest, bend, severity):
    (folder / "butane.data").write_text(butane_data(bend))
    report = check(edit(BUTANE, ("63.0 112.0", f"63.0 {rest}")))
    finding = report.of("straight angles")[0]
    assert finding.severity == severity
    assert severity == "ok" or (len(finding.atoms) == 3 and finding.value == pytest.approx(bend, abs=0.01))


def test_torsions_on_a_line(folder):
    (folder / "butane.data").write_text(butane_data(177.0))
    finding = check(BUTANE).of("torsions on a line")[0]
    assert finding.severity == "warning" and len(finding.atoms) == 4 and finding.value == pytest.approx(3.0, abs=0.01)
    weak = check(edit(BUTANE, ("1.4 3 0 0.0", "0.0 3 0 0.0")))
    assert not weak.of("torsions on a line")[0].rank       # nobody cares about a torsion without force


def test_phase_in_radians(folder):
    text = edit(BUTANE, ("dihedral_style charmm", "dihedral_style nharmonic"), ("1.4 3 0 0.0", "2 1.0 0.5"))
    assert not check(text).of("phases")
    text = edit(BUTANE, ("dihedral_style charmm", "dihedral_style quadratic"), ("1.4 3 0 0.0", "5.0 {}"))
    assert not check(text.format(120.0)).of("phases")[0].rank
    assert "120 degrees" in check(text.format(2.0944)).of("phases")[0].message


def test_net_charge(folder):
    assert not check(BUTANE).of("net charge")[0].rank
    assert check(edit(BUTANE, ("run 10", "set atom 1 charge 1.0\nrun 10"))).of("net charge")[0].severity == "note"


def test_force_turns_the_error_into_a_warning(folder):
    report = check(edit(LJ, ("timestep 0.005", "timestep 0.06")), force=True)
    assert report.of("time step")[0].severity == "warning" and report.ok


def test_jumps_are_those_of_the_formulas(folder):
    """Of energy and force, and of charges, which count with the dielectric constant."""
    text = edit(LJ, ("lj/cut 2.5", "lj/cut 1.3"))
    found = check(text).of("jump at the cutoff")[0]
    assert float(found.value.split()[0]) == pytest.approx(4 * (1.3**-6 - 1.3**-12) / 1.44, rel=0.02)
    charged = edit(LJ, ("units lj", "units lj\natom_style charge\ndielectric 4.0"), ("lj/cut 2.5", "lj/cut/coul/cut 2.5"),
                   ("run 10", "set type 1 charge 2.0\nrun 10"))
    found = check(charged).of("jump at the cutoff")[0]
    assert float(found.value.split()[0]) == pytest.approx((4.0 / 4.0 / 2.5 - 0.0163) / 1.44, rel=0.02)
    assert found.severity == "warning" and "charges that end at a cutoff" in found.advice
    smooth = edit(charged, ("lj/cut/coul/cut 2.5", "lj/charmm/coul/charmm 2.0 2.5"))
    assert check(smooth).of("jump at the cutoff")[0].severity == "ok"


@pytest.mark.parametrize(("part", "severity"), [(1.0, "ok"), (1.06, "note")])
def test_the_step_that_is_advised_is_fine(folder, part, severity):
    """Its digits are rounded up here and down there."""
    dt = part * float(f"{2 * np.pi / (2 * 50.0) ** 0.5 / 20:.2g}")
    assert check(edit(DIMER, ("timestep 0.19", f"timestep {dt}"))).of("time step")[0].severity == severity


def test_causes_come_first(folder):
    """A bond near its limit is stiff: the timestep is not what is wrong."""
    report = check(edit(LJ, ("create 1.44", "create 300.0"), ("timestep 0.005", "timestep 0.02")))
    assert report.at_least("note")[0].name == "units" and report.worst == "error"


def test_the_frequency_is_right(folder):
    """A dimer: omega = sqrt(k / mu), by the force constant and by Lanczos; the limit is 2 / omega."""
    report = check(DIMER)
    omega = (2 * 50.0 / 1.0) ** 0.5
    one, two = report.of("time step")[0], report.of("fastest vibration")[0]
    assert one.severity == "warning"
    assert one.limit == pytest.approx(2 * np.pi / omega / 10, rel=1e-6) and one.atoms == (1, 2)
    assert two.limit == pytest.approx(2 / omega, rel=1e-6)
    assert check(edit(DIMER, ("0.19", "0.21"))).worst == "error"


def test_exact_and_numerical_spectrum_agree(folder, monkeypatch):
    exact = check(BUTANE).of("fastest vibration")[0]
    monkeypatch.setattr("asemd.check.spectrum.EXACT", 0)
    other = check(BUTANE).of("fastest vibration")[0]
    assert "exact" in exact.message and "differences" in other.message
    assert other.limit == pytest.approx(exact.limit, rel=2e-3)


def test_three_kinds_of_source(folder):
    Path("in.x").write_text(LJ)
    script = asemd.check("in.x")
    with asemd.Lammps(cmdargs=["-screen", "none", "-log", "none"]) as lammps:
        lammps.commands_string(edit(LJ, ("run 10\n", "")))
        scene = asemd.check(lammps.scene)
        before = lammps.scene.system.x.copy()
        asemd.check(lammps.scene)
        assert (lammps.scene.system.x == before).all() and lammps.scene.system.n == 256
    assert [f.name for f in script] == [f.name for f in scene]
    atoms = asemd.read("in.x")
    report = asemd.check(atoms)
    assert report.of("time step")[0].value.startswith("period") and report.ok
    assert asemd.check(atoms, dt=0.06).of("time step")[0].severity == "error"
    with pytest.raises(InputError, match="asemd.ForceField"):
        from ase.build import bulk
        asemd.check(bulk("Ar"))


def test_command(folder, capsys):
    Path("in.x").write_text(LJ)
    assert cli.main(["check", "in.x"]) == 0
    out = capsys.readouterr().out
    assert "Check of in.x:" in out and "time step" in out
    assert sorted(p.name for p in folder.glob("*")) == ["butane.data", "chain.data", "in.x"]
    Path("in.x").write_text(edit(LJ, ("timestep 0.005", "timestep 0.06")))
    assert cli.main(["check", "in.x"]) == 2 and "ERROR    time step:" in capsys.readouterr().out
    assert cli.main(["check", "in.x", "--json"]) == 2
    data = json.loads(capsys.readouterr().out)
    assert data["worst"] == "error" and {f["name"] for f in data["findings"]} >= {"time step", "overlaps"}
    assert cli.main(["check", "in.x", "--force"]) == 0
    Path("in.x").write_text(edit(LJ, ("run 10", MOVED.format("0.0") + "run 10")))
    for more in ([], ["--json"], ["--force"], ["--run", "--budget", "1"]):
        assert cli.main(["check", "in.x", *more]) == 2
    capsys.readouterr()
    Path("in.x").write_text(LJ.replace("units lj", "units l"))
    assert cli.main(["check", "in.x"]) == 1 and "in.x:1" in capsys.readouterr().err
    assert cli.main(["check", "in.x", "--battery"]) == 1 and "without a script" in capsys.readouterr().err
    assert cli.main(["check"]) == 1


def test_fixes_bring_checks_of_their_own(folder, monkeypatch):
    from asemd.fix.nve import NVE
    monkeypatch.setattr(NVE, "check_stability", lambda self, case: [Finding("warning", "fix nve", "is lonely")], raising=False)
    assert check(LJ).of("fix nve")[0].message == "is lonely"


def test_package_and_function_have_one_name(folder):
    """Whatever is imported first."""
    Path("in.x").write_text(LJ)
    for first in ("import asemd.check.report", "from asemd import check"):
        code = f"{first}\nimport asemd\nassert asemd.check('in.x').ok\nfrom asemd import check\nassert check('in.x').ok"
        subprocess.run([sys.executable, "-c", code], check=True, timeout=600, env={**os.environ, "PYTHONPATH": str(ROOT)})


def test_later_lines_do_not_hide_the_first_run(folder):
    report = check(LJ + "fix 9 all nonsense\nrun 10\n")
    assert report.of("time step") and "unknown fix style 'nonsense'" in report.of("script")[0].message
    report = check(edit(LJ, ("run 10", "run 0\nrun 10\ntimestep 0.03\nrun 5")))
    assert [f.severity for f in report.of("time step")] == ["ok", "warning"] and report.of("time step")[1].where == "run of line 15"
    with pytest.raises(InputError, match="nonsense"):
        check(edit(LJ, ("run 10", "fix 9 all nonsense\nrun 10")))


def test_a_script_that_begins_anew(folder):
    report = check(LJ + "write_restart r.end\nclear\nread_restart r.end\nrun 10\n")
    assert report.worst == "ok" and report.of("time step")


def test_forces_of_a_run_alone(folder):
    """Friction and noise."""
    report = check(edit(LJ, ("pair_style lj/cut 2.5", "pair_style dpd 1.0 1.5 4711"), ("pair_coeff 1 1 1.0 1.0", "pair_coeff 1 1 3.0 1.0")))
    assert report.ok and not report.of("first step")


def test_one_atom_and_none(folder):
    one = edit(LJ, ("create_atoms 1 box", "create_atoms 1 single 1 1 1"), ("velocity all create 1.44 87287 loop geom", ""))
    report = check(one)
    assert report.worst == "ok" and not report.of("time step")
    report = check(edit(one, ("create_atoms 1 single 1 1 1", "")))
    assert [f.message for f in report] == ["There are no atoms."] and report.ok


def test_mistakes_in_the_script_are_all_told(folder):
    with pytest.raises(InputError, match="pair_coeff"):
        check(edit(LJ, ("pair_coeff 1 1 1.0 1.0", "")))
    with pytest.raises(InputError, match="box"):
        check("units lj\n")


def test_the_page_names_every_check(folder):
    from asemd.check.static import CHECKS, DoesNotApply, all_checks
    page = (ROOT / "docs" / "check.md").read_text()
    for name in all_checks():
        assert name in page, name
    block = page[page.index("from asemd.check.static import DoesNotApply"):]
    exec(block[:block.index("```")], {})
    try:
        assert check(LJ).of("momentum")[0].severity == "ok"
        with pytest.raises(DoesNotApply):
            CHECKS["momentum"](type("Case", (), {"masses": np.ones(1), "system": type("S", (), {"v": np.zeros((1, 3))})}))
    finally:
        del CHECKS["momentum"]


def test_tabulated_pairs_collide_like_others(folder):
    r = np.linspace(0.7, 2.5, 1000)
    rows = "\n".join(f"{k} {a:.9f} {4 * (a**-12 - a**-6):.12g} {24 * (2 * a**-13 - a**-7):.12g}" for k, a in enumerate(r, 1))
    (folder / "p.txt").write_text(f"LJ\nN 1000 R 0.7 2.5\n\n{rows}\n")
    table = check(edit(LJ, ("lj/cut 2.5", "table linear 4000"), ("1 1 1.0 1.0", "1 1 p.txt LJ 2.5")))
    assert not table.at_least("warning")
    assert table.of("time step")[0].limit == pytest.approx(check(LJ).of("time step")[0].limit, rel=0.03)


def test_argon_in_metal_units(folder):
    text = edit(LJ, ("units lj", "units metal"), ("fcc 0.8442", "fcc 5.4"), ("mass 1 1.0", "mass 1 39.948"), ("create 1.44", "create 90.0"),
                ("1 1 1.0 1.0", "1 1 0.0104 3.4"), ("lj/cut 2.5", "lj/cut 8.5"), ("timestep 0.005", "timestep 0.005"))
    assert not check(text).at_least("note")
    assert check(edit(text, ("0.0104", "0.24"))).of("units")[0].severity == "note"     # kcal/mol, or a metal
    assert "1000 times the density" in check(edit(text, ("fcc 5.4", "fcc 0.54"), ("cut 8.5", "cut 2.1"))).of("units")[0].advice


def test_respa_has_the_step_of_its_level(folder):
    text = edit(BUTANE, ("nvt temp 300.0 300.0 100.0", "nve"), ("timestep 1.0", "timestep 4.0"))
    assert check(text).of("time step")[0].severity == "warning"
    inner = check(edit(text, ("timestep 4.0", "timestep 4.0\nrun_style respa 2 4 bond 1 angle 1 dihedral 1 pair 2")))
    assert not inner.of("time step")[0].rank and inner.of("time step")[0].value == pytest.approx(1.0) and not inner.of("r-RESPA")[0].rank


def test_frozen_and_held_bonds_do_not_vibrate(folder, monkeypatch):
    text = edit(CHAIN, ("timestep 0.006", "timestep 0.05"), ("fix 1 all nve", "group none empty\nfix 1 none nve"))
    assert not check(text).of("time step") and not check(text).of("fastest vibration")
    from asemd.fix.nve import NVE
    held = edit(CHAIN, ("timestep 0.006", "timestep 0.03"))
    assert "bond type 1" in check(held).of("time step")[0].message
    free = check(held).of("fastest vibration")[0].limit
    monkeypatch.setattr(NVE, "constrained_items", lambda self, system, kind, atoms: np.full(len(atoms), kind == "bond"), raising=False)
    report = check(held)
    assert not report.of("time step")
    slow = report.of("fastest vibration")[0]        # its limit is period / 20 now, before it was period / pi
    assert 20 * slow.limit > 3 * np.pi * free and "differences" not in slow.message


def test_scenes_with_mistakes_end_in_one_message(folder):
    """Whatever is wrong with a scene, a check ends with a report or with an error that asemd raises on purpose."""
    for case in [c for c in test_bad_input.CASES if c.expect != "error" or "timestep" in c.name or "skin" in c.name][::2]:
        test_bad_input.write(case, folder)
        try:
            assert asemd.check("in.scene").findings
        except AsemdError as e:
            assert "\n" not in str(e), case.name


def test_atoms_in_one_place(folder):
    """Nothing but the user parts them: neither a minimisation nor a limit of steps."""
    for text in (LJ, edit(LJ, ("run 10", "minimize 0 0 10 100\nrun 10")), edit(LJ, ("fix 1 all nve", "fix 1 all nve/limit 0.1"))):
        found = check(edit(text, ("mass 1", "create_atoms 1 single 0 0 0\nmass 1"))).of("overlaps")[0]
        assert found.severity == "error" and "delete_atoms overlap" in found.advice and "neither minimize nor" in found.advice


def test_forces_of_many_bodies(folder):
    """What is left out says why, and the box is looked at."""
    text = edit(LJ, ("pair_style lj/cut 2.5", "pair_style atm 3.5 1.5"), ("pair_coeff 1 1 1.0 1.0", "pair_coeff * * * 0.1"))
    report = check(text)
    left = dict(report.left_out)
    for name in ("overlaps", "jump at the cutoff"):
        assert left[name].startswith("atm: many-body forces are no sum over pairs; first step and fastest vibration")
    assert report.of("box and cutoff") and report.of("first step") and report.of("fastest vibration")
    assert check(edit(text, ("0 4 0 4 0 4", "0 2 0 2 0 2"))).of("box and cutoff")[0].severity == "warning"
