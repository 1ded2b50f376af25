"""``asemd check --run``: figures with known answers, what is found, what is left alone."""
from __future__ import annotations

import json
import math

import both
import numpy as np
import pytest
from test_watchdog import CRAMMED, MELT

import asemd
from asemd import cli
from asemd.check import experiment
from asemd.check.trial import bench
from asemd.report.copies import copied

DIMER = """units lj
atom_style bond
region box block 0 20 0 20 0 20
create_box 1 box bond/types 1 extra/bond/per/atom 1
mass 1 2.0
create_atoms 1 single 10 10 10
create_atoms 1 single 11 10 10
bond_style harmonic
bond_coeff 1 {k} 1.0
create_bonds single/bond 1 1 2
group one id 1
velocity one set 0.01 0 0
velocity all zero linear
fix 1 all nve
timestep {dt}
"""
AMPLE = 1000.0      # seconds: more than any of them takes, so that on a slow machine too nothing is left out
LATE = "neighbor 0.05 bin\nneigh_modify every 20 delay 0 check no\n"


def check(text: str, **options):
    options.setdefault("budget", AMPLE)
    return experiment.run(both.asemd(text).scene, **options)


@pytest.mark.parametrize("k", [1.0, 1e4])
def test_onset_of_a_harmonic_dimer(k):
    """omega dt = 2 with omega = sqrt(2 k / (m / 2)), to better than 1 %."""
    omega = math.sqrt(2.0 * k)
    report = check(DIMER.format(k=k, dt=0.1 / omega))
    found, = report.of("onset of instability")
    assert found.limit * omega == pytest.approx(2.0, rel=0.005) and found.severity == "ok"
    assert f"{2 / omega:.4g} (2/omega)" in found.message
    assert report.of("order of the integrator")[0].value == pytest.approx(2.0, abs=0.05)
    assert report.of("time reversal")[0].value < 1e-13
    assert ("missed pairs", "no pair interactions") in report.left_out


@pytest.mark.parametrize(("part", "severity"), [(0.15, "ok"), (0.6, "note"), (0.9, "warning"), (1.03, "error")])
def test_a_timestep_near_the_onset(part, severity):
    report = check(DIMER.format(k=50.0, dt=part * 0.2))
    found, = report.of("onset of instability")
    assert found.severity == severity and found.value == pytest.approx(part * 0.2)
    assert bool(found.advice) == (severity != "ok")
    if severity == "error":
        assert report.exit_status == 2 and ("energy", "the run comes apart") in report.left_out
        forced = check(DIMER.format(k=50.0, dt=part * 0.2), force=True)
        assert forced.of("onset of instability")[0].severity == "warning" and forced.exit_status == 0


def test_a_sound_melt():
    report = check(MELT.format(n=5, dt=0.005))
    assert report.of("order of the integrator")[0].value == pytest.approx(2.0, abs=0.2)
    assert report.of("time reversal")[0].value < 1e-10
    onset, = report.of("onset of instability")
    assert 0.02 < onset.limit < 0.045
    assert [f.severity for f in report] == ["ok"] * 5
    assert len(report.tables[0].rows) == 5 and "drifts by" in report.of("energy")[0].message


def test_a_skin_that_is_too_small():
    """Pairs that the list misses, and a path that does not lead back; with the same skin and checks all is well."""
    report = check(MELT.format(n=5, dt=0.005) + LATE)
    missed, = report.of("missed pairs")
    assert missed.severity == "warning" and missed.value > 0.1 and "check yes" in missed.advice
    assert report.of("time reversal")[0].severity == "warning"
    fine = check(MELT.format(n=5, dt=0.005) + "neighbor 0.05 bin\nneigh_modify every 1 delay 0 check yes\n")
    assert fine.of("missed pairs")[0].severity == fine.of("time reversal")[0].severity == "ok"


def test_the_recommended_skin_misses_nothing():
    advice = check(MELT.format(n=5, dt=0.002) + LATE).of("missed pairs")[0].advice
    skin = float(advice.split()[1])
    assert check(MELT.format(n=5, dt=0.002) + LATE.replace("0.05", str(skin))).of("missed pairs")[0].severity == "ok"


def test_energy_of_missed_pairs_is_that_of_a_complete_list():
    """The figure is the difference of two energies of one configuration."""
    from asemd.engine import Engine, Settings
    scene = both.asemd(MELT.format(n=5, dt=0.005) + LATE).scene
    b = bench(scene, None, None, 1, False, lambda *_: None)
    loop = b.loop(b.dt, b.scene.neighbor)
    loop.setup()
    own = loop.advance(19).potential
    whole = Engine(loop.system.copy(), loop.interactions, Settings(skin=1.5)).compute().potential
    fresh = Engine(b.scene.system.copy(), b.scene.interactions, Settings(skin=0.7))
    assert abs(own - whole) > 1e-3
    assert experiment._complete(fresh, loop.system) == pytest.approx(whole, rel=1e-12)


def test_forces_that_are_not_gradients(tmp_path):
    """A table whose forces are off by 2 %: the error does not fall with the timestep."""
    r = np.linspace(0.8, 2.5, 400)
    e, f = 4 * (r**-12 - r**-6), 24 * (2 * r**-13 - r**-7)
    rows = "\n".join(f"{k + 1} {a:.8f} {b:.12g} {c:.12g}" for k, (a, b, c) in enumerate(zip(r, e, 0.98 * f)))
    (tmp_path / "t.table").write_text(f"# table\n\nLJ\nN 400\n\n{rows}\n")
    text = MELT.format(n=5, dt=0.005).replace("pair_style lj/cut 2.5", "pair_style table linear 2000").replace(
        "pair_coeff 1 1 1.0 1.0", f"pair_coeff 1 1 {tmp_path / 't.table'} LJ 2.5")
    found, = check(text).of("order of the integrator")
    assert found.severity == "warning" and found.value < 1.5 and "gradient" in found.advice


def test_scenes_without_a_run_of_their_own():
    """Atoms at rest, overlapping, without a fix: the notes say what was done."""
    report = check(CRAMMED.replace("velocity all create 1.0 87287\n", ""))
    note, = report.of("experiments")
    for words in ("no fix moves the atoms", "at rest: velocities of temperature 1 (seed 1)", "the energy was minimised first, for the"):
        assert words in note.message, note.message
    assert report.ok and report.of("order of the integrator")[0].value == pytest.approx(2.0, abs=0.2)


def test_thermostats_are_off_and_give_the_temperature():
    text = MELT.format(n=4, dt=0.004).replace("velocity", "# velocity").replace("fix 1 all nve", "fix 1 all nvt temp 1.7 1.7 0.4")
    report = check(text)
    note, = report.of("experiments")
    assert "fix 1 (nvt) is off" in note.message and "temperature 1.7" in note.message and report.ok


def test_the_scene_stays_as_it_is(tmp_path, monkeypatch):
    """No file, no changed number, and the same findings again."""
    monkeypatch.chdir(tmp_path)
    text = MELT.format(n=4, dt=0.005) + f"dump 1 all atom 1 {tmp_path}/d\nrestart 1 {tmp_path}/r\n"
    scene = both.asemd(text).scene
    before = copied(scene)
    found = [experiment.run(scene, budget=AMPLE, seed=3) for _ in range(2)]
    for a, b in ((scene.system.x, before.system.x), (scene.system.v, before.system.v), (scene.system.image, before.system.image)):
        np.testing.assert_array_equal(a, b)
    assert scene.step == 0 and scene.dt == 0.005 and list(scene.dumps) == ["1"] and list(scene.fixes) == ["1"]
    assert not scene.interactions.shift and not list(tmp_path.iterdir())
    assert [(f.name, f.value, f.limit) for f in found[0]] == [(f.name, f.value, f.limit) for f in found[1]]


def test_budget_and_progress():
    """What does not fit is left out, and the report says so."""
    seen = []
    report = check(MELT.format(n=8, dt=0.005), budget=1e-3, progress=lambda fraction, what: seen.append((fraction, what)))
    names = {"onset of instability", "order of the integrator", "time reversal", "missed pairs"}
    assert {name for name, why in report.left_out if "budget" in why} == names
    assert seen[-1] == (1.0, "done") and [f for f, _ in seen] == sorted(f for f, _ in seen)


def test_no_run_is_possible():
    text = DIMER.format(k=1.0, dt=0.1).replace("harmonic", "fene").replace("bond_coeff 1 1.0 1.0", "bond_coeff 1 30 0.9 1 1")
    report = check(text)
    found, = report.findings
    assert found.severity == "error" and "No run is possible" in found.message and "fene" in found.message


def test_two_timestep_levels():
    """Levels are kept; the order is that of the outermost step."""
    text = DIMER.format(k=50.0, dt=0.02).replace("bond_style", "pair_style soft 2.5\npair_coeff 1 1 1.0\nbond_style")
    text += "run_style respa 2 4 bond 1 pair 2\n"
    report = check(text)
    assert report.of("order of the integrator")[0].value == pytest.approx(2.0, abs=0.3)
    assert report.of("onset of instability")[0].limit > 1.5 * 0.2


def test_command_line(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "in.melt").write_text(MELT.format(n=4, dt=0.005) + "run 10\n")
    assert cli.main(["check", "in.melt", "--run", "--budget", str(AMPLE), "--json"]) == 0
    names = {f["name"] for f in json.loads(capsys.readouterr().out)["findings"]}
    assert {"onset of instability", "order of the integrator", "energy", "time reversal", "missed pairs"} <= names
    assert [p.name for p in tmp_path.iterdir()] == ["in.melt"]


def test_atoms():
    atoms = asemd.Atoms("Ar2", [(0, 0, 0), (1.0, 0, 0)], cell=[20] * 3, pbc=True)
    atoms.calc = asemd.ForceField(bond={"harmonic": {1: (10.0, 1.0)}}, topology=asemd.Topology(bonds=[(0, 1)]))
    omega = math.sqrt(2 * 10.0 / (39.948 / 2))
    report = asemd.check(atoms, run=True, dt=0.1 / omega, budget=AMPLE)
    assert report.of("onset of instability")[0].limit * omega == pytest.approx(2.0, rel=0.01)


def test_walls_that_move_and_forces_that_work():
    """What pushes the atoms is held still or left out, so that energy is conserved and the order can be seen."""
    text = MELT.format(n=4, dt=0.004) + """region top block INF INF 5 INF INF INF
group top region top
velocity top set 1.0 0 0
fix 2 top setforce 0 NULL NULL
variable push equal 3*sin(step)
fix 3 all addforce v_push 0 0
"""
    report = check(text)
    note, = report.of("experiments")
    assert "fix 3 (addforce) is off" in note.message and "held still where fix 2 (setforce)" in note.message
    assert report.of("order of the integrator")[0].value == pytest.approx(2.0, abs=0.2) and report.ok


def test_constant_forces_stay():
    report = check(MELT.format(n=4, dt=0.004) + "fix 2 all addforce 0.5 0 0\n")
    assert not report.of("experiments") and report.of("order of the integrator")[0].value == pytest.approx(2.0, abs=0.2)
