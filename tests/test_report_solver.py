"""asemd report of scenes with a long-range solver: its accuracy, the cutoff of charges, the mesh."""
from __future__ import annotations

import pytest
from test_report import ENDLESS, point, stop_the_clock

import asemd
from asemd.report import advice, plots
from asemd.report.apply import apply_to
from asemd.report.copies import copied, load, read
from asemd.report.knob import all_knobs

IONS = """
units real
atom_style charge
lattice sc 3.5
region box block 0 6 0 6 0 6
create_box 2 box
create_atoms 1 box
set type 1 type/ratio 2 0.5 8
set type 1 charge 0.5
set type 2 charge -0.5
mass * 30
displace_atoms all random 0.3 0.3 0.3 8
pair_style {pair}
pair_coeff * * 0.3 2.8
kspace_style {solver}
velocity all create 300 8
fix 1 all nve
timestep 1
run 10
"""
NAMES = ("accuracy", "coulomb-cutoff", "mesh")


def scene(tmp_path, pair="lj/cut/coul/long 7.0 8.0", solver="pppm 1e-4"):
    path = tmp_path / "in.ions"
    path.write_text(IONS.format(pair=pair, solver=solver))
    return path


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    path = scene(tmp_path_factory.mktemp("ions"))
    with pytest.MonkeyPatch.context() as patch:
        stop_the_clock(patch, 20)
        return path, asemd.report(path, ENDLESS, only=NAMES, lammps=False)


def test_errors_follow_the_accuracy(found):
    errors = {p.label: p.force_error for p in found[1].curve("accuracy").points}
    assert errors["1e-05"] < 0.3 * errors["0.0001"] < 0.1 * errors["0.001"] < 0.03 * errors["0.01"]
    assert errors["1e-05"] > 1e-7
    own = next(p for p in found[1].curve("accuracy").points if p.own)
    assert own.given_error == pytest.approx(own.force_error, rel=0.3)
    assert all(p.given_error == pytest.approx(own.given_error) for name in NAMES for p in found[1].curve(name).points)


def test_the_accuracy_stays_with_the_cutoff(found):
    """As large as that of the script's settings, within what the estimates of errors leave open."""
    curve = found[1].curve("coulomb-cutoff")
    assert [p.label for p in curve.points] == ["6.4", "7.2", "8", "9.6", "11.2"] and curve.unit == "distance"
    for p in [*curve.points, *found[1].curve("mesh").points]:
        assert 0.1 * p.given_error < p.force_error < 3.0 * p.given_error
    assert {p.label for p in found[1].curve("mesh").points} >= {"order 5 ik", "order 5 ad", "order 7 ik"}


def test_pictures_compare_with_what_the_script_misses(found):
    report = found[1]
    picture = next(p for p in plots.pictures(report) if p.name == "force-error")
    assert picture.script[1] == pytest.approx(max(p.given_error for p in report.points), rel=1e-6)


def test_what_the_script_misses_is_no_objection():
    script, same = point("script", 2.0), point("same", 1.0, force_error=1e-3, given_error=1e-3)
    worse = point("worse", 1.0, force_error=2e-3, given_error=1e-3)
    assert not advice.objections(same, script) and "force error" in advice.objections(worse, script)[0]
    advice.mark_front([script, same, worse], script)
    assert same.pareto and not script.pareto


def test_the_script_that_is_written(found, tmp_path):
    path, report = found
    for name, line in (("accuracy", "kspace_style pppm 1e-05"), ("coulomb-cutoff", "pair_style lj/cut/coul/long 7.0 9.6"),
                       ("mesh", "kspace_modify order 7 diff ik")):
        labels = {"accuracy": "1e-05", "coulomb-cutoff": "9.6", "mesh": "order 7 ik"}
        report.best = next(p for p in report.curve(name).points if p.label == labels[name])
        new = apply_to(report, copied(load(path)), read(str(path), None, 1), tmp_path / f"in.{name}")
        assert line in new.read_text().splitlines()
        load(new)
    report.best = None


@pytest.mark.parametrize(("pair", "solver", "left_out"), [
    ("lj/cut 8.0", "none", {name: "no kspace_style" for name in NAMES}),
    ("lj/cut/coul/long 7.0 8.0", "zero 1e-4", {name: "kspace_style zero adds nothing" for name in NAMES}),
    ("lj/cut/coul/long 7.0 8.0", "ewald 1e-4", {"mesh": "kspace_style ewald has no such mesh"}),
    ("lj/cut/coul/long 7.0 8.0", "pppm 1e-4\nkspace_modify mesh 8 8 8", {"accuracy": "kspace_modify mesh stands for the accuracy"}),
    ("lj/cut/coul/long 7.0 8.0", "pppm 1e-4\nkspace_modify compute no", {name: "kspace_modify compute no" for name in NAMES}),
    ("lj/cut/coul/msm 7.0 8.0", "msm 1e-3", {"coulomb-cutoff": "msm chooses the cutoff by itself (kspace_modify cutoff/adjust)",
                                             "mesh": "kspace_style msm has no such mesh"}),
])
def test_scenes_without(pair, solver, left_out, tmp_path):
    given = load(scene(tmp_path, pair, solver))
    knobs = {k.name: k for k in all_knobs(given)}
    assert {name: why for name in NAMES if (why := knobs[name].needs(given))} == left_out


def test_solvers_may_bring_knobs(tmp_path, monkeypatch):
    """Those of one's own, as styles and fixes do."""
    from asemd.kspace.ewald import Ewald

    class Waves:
        name, title, order = "waves", "waves", 90

        def values(self, scene):
            return [1]

        def current(self, scene):
            return None
    monkeypatch.setattr(Ewald, "knobs", (Waves,), raising=False)
    assert "waves" in {k.name for k in all_knobs(load(scene(tmp_path, solver="ewald 1e-4")))}
