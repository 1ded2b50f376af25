"""The pages of the styles: every example runs and both of its forms agree, measured numbers are there and
plausible, the page on own styles is true."""
from __future__ import annotations

import json
import math
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import asemd
from asemd import style as registry
from asemd.errors import InputError
from asemd.expression import condense, differentiate
from asemd.testing import oracle
from asemd.testing.styles import report_style
from asemd.user_styles import import_file

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "docs"))

import measure  # noqa: E402
import measure_speed  # noqa: E402
import style_formula  # noqa: E402
import style_pages  # noqa: E402
import style_plots  # noqa: E402
import style_scenes  # noqa: E402
import style_speed  # noqa: E402

STYLES = style_scenes.every_style()
KNOWN, SPEED = json.loads(measure.FILE.read_text()), json.loads(measure_speed.FILE.read_text())
ENV = {**os.environ, "PYTHONPATH": str(Path(asemd.__file__).parents[1])}
PAGE = ROOT / "docs" / "custom-style.md"
LARGEST = 1e-9          # relative difference from LAMMPS, which loses digits near straight and planar arrangements
# styles whose force, or a low derivative of it, has a corner within the range of a table; files have one at each of their values
CORNERS = ("bond harmonic/shift/cut", "angle mesocnt", "pair lj/charmm/coul/charmm", "pair lj/charmmfsw/coul/charmmfsh",
           "pair lj/cut/coul/cut", "pair soft")
TABULATED = [key.split(" ", 1) for key, entry in SPEED["styles"].items() if "table" not in entry["left out"]]
RUN = """
import contextlib, io, json, sys, warnings
warnings.simplefilter("ignore")
from asemd import units
from asemd.lammps import Lammps
answers = {}
for name, (python, script, unit) in json.load(sys.stdin).items():
    names, said = {}, io.StringIO()
    with contextlib.redirect_stdout(said):
        exec(python, names)
    with Lammps(cmdargs=["-screen", "none", "-log", "none"]) as lmp:
        lmp.commands_string(script)
        energy = lmp.get_thermo("pe") * units.factor("energy", unit)
    answers[name] = [names["energy"], energy, said.getvalue()]
print(json.dumps(answers))
"""


@pytest.mark.parametrize("category", style_scenes.CATEGORIES)
def test_every_example_runs_and_both_forms_agree(category, tmp_path):
    """Without the compiler, which would take longer than these few atoms."""
    jobs = {}
    for c, name in STYLES:
        if c == category:
            scene = style_scenes.scene(c, name)
            jobs[name] = style_scenes.python(scene), style_scenes.lammps(scene), scene.unit
    done = subprocess.run([sys.executable, "-c", RUN], input=json.dumps(jobs), env={**ENV, "NUMBA_DISABLE_JIT": "1"}, cwd=tmp_path,
                          capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr[-2000:]
    answers = json.loads(done.stdout)
    assert set(answers) == set(jobs)
    for name, (mine, script, said) in answers.items():
        # coefficients in eV have six digits; charmmfsh has a Coulomb constant of its own in units real
        assert mine == pytest.approx(script, rel=3e-5 if "charmmfsh" in name else 1e-5, abs=1e-6), name
        assert said.startswith(f"{mine:.8g}"), name
        assert mine != 0.0 or name in ("zero", "none"), f"{name}: the example shows nothing"


@pytest.mark.parametrize(("category", "name"), STYLES)
def test_page(category, name):
    text = style_pages.page(category, name, KNOWN, {f"{category} {name}": "1 eV"}, speed=SPEED, plot="plot.svg")
    assert text.startswith(f"# {category} {name}\n") and "```python" in text and f"{category}_style {name}" in text
    if (category, name) not in measure.measured():
        return
    style = registry.find(category, name)
    assert "$$" in text or category == "pair"
    for p in (*style.settings, *style.coeff):
        assert f"| `{p.name}` | " in text, p.name
    assert "## Error against time" in text and ":file: plot.svg" in text and f'measure_speed.py "{category} {name}"' in text
    assert "## Agreement with LAMMPS" in text and ("--compat lammps" in text) == measure.has_twin(category, name)


def test_units_of_coefficients():
    assert style_pages.unit_text("energy/distance^2", "real") == "kcal/mol/Å²" and style_pages.unit_text("1/distance", "metal") == "1/Å"
    assert style_pages.unit_text("energy*distance^6", "ase") == "eV Å⁶" and style_pages.unit_text("angle", "real") == "degrees"
    row, = (line for line in style_pages.coefficient_table(registry.find("bond", "harmonic").coeff) if "`K`" in line)
    assert row.split(" | ")[-1] == "0.0433641 |"


def test_measured_numbers_are_those_of_the_present_examples():
    """A new style, or a new example, has to be measured: ``python docs/measure.py "bond NAME"``."""
    for category, name in measure.measured():
        entry = KNOWN["styles"].get(f"{category} {name}")
        assert entry, f'run python docs/measure.py "{category} {name}"'
        assert entry["commands"] == style_scenes.scene(category, name).lines, f'run python docs/measure.py "{category} {name}"'
        assert max(entry["energy"], entry["force"]) < LARGEST, (category, name)
    assert set(KNOWN["styles"]) == {f"{c} {n}" for c, n in measure.measured()} and KNOWN["geometries"] >= 100


def test_measuring_again_gives_the_same():
    if not oracle.lammps_available():
        pytest.skip(oracle.why_not())
    chosen = [("bond", "morse"), ("improper", "cossq"), ("pair", "lj/cut")]
    for name, entry in measure.measure(chosen).items():
        assert max(entry["energy"], entry["force"]) < LARGEST
        if "gradient" in entry:
            assert entry["gradient"]["force"] > 0.1 and entry["gradient"]["energy"] < LARGEST, name


@pytest.mark.parametrize(("category", "name"), [("bond", "fene"), ("improper", "cossq"), ("pair", "lj/charmm/coul/charmm")])
def test_curves(category, name):
    pytest.importorskip("matplotlib")
    style = registry.find(category, name)
    first = style_plots.svg(style)
    assert first == style_plots.svg(style), "the picture must not change from one build to the next"
    assert "currentColor" in first and "#000000" not in first and "<?xml" not in first and first.startswith("<svg")
    assert "force (" in first and len(first) < 60_000
    assert ("LAMMPS" in first) == measure.has_twin(category, name)
    assert (style_plots.outside(style) != "") == (name == "fene")


# ------------------------------------------------------------------ error against time ---

@pytest.mark.parametrize(("category", "name"), measure_speed.measured())
def test_speed_of_every_style_is_known(category, name):
    """Each variant has a point or a reason; numbers are those of the present example."""
    again = f'run {measure_speed.COMMAND} "{category} {name}"'
    entry = SPEED["styles"].get(f"{category} {name}")
    assert entry and entry["commands"] == style_scenes.scene(category, name).lines, again
    assert entry["items"] >= 2000 and entry["variants"]["double"]["error"] == 0.0
    for variant in ("mixed", "table", "lepton"):
        points = [v for v in entry["variants"] if v.startswith(variant)]
        reason = entry["left out"].get(variant, "")
        assert bool(points) != bool(reason) and len(points) in (0, 1, 6) and "/" not in reason.replace(name, ""), (variant, points, reason)
    for variant, v in entry["variants"].items():
        low, middle, high = v["ns"]
        assert 0.1 < low <= middle <= high < 2000.0, variant
    errors = {n: v["error"] for n, v in entry["variants"].items()}
    assert 1e-9 < errors.get("mixed", 1e-7) < 1e-5 and errors.get("lepton", 0.0) < 1e-13


def test_speed_has_no_other_styles():
    assert set(SPEED["styles"]) == {f"{c} {n}" for c, n in measure_speed.measured()} and SPEED["machine"]["cpu"]


@pytest.mark.parametrize(("category", "name"), TABULATED)
def test_errors_of_tables_fall_as_theory_says(category, name):
    """With about the square of the spacing for linear tables and the fourth power or faster for splines, down to rounding; slower where the
    force has a corner, and at once to rounding where it is a polynomial."""
    errors = {n: v["error"] for n, v in SPEED["styles"][f"{category} {name}"]["variants"].items()}
    for kind, order in (("linear", 2.0), ("spline", 4.0)):
        e = [errors[f"table {kind} {n}"] for n in measure_speed.TABLES]
        if f"{category} {name}" in CORNERS or name.startswith("table"):
            # linear tables of dihedrals read the file's forces, splines take the slope of the energy
            assert e[2] < 0.2 * e[0] or (category, kind) == ("dihedral", "linear"), (kind, e)
            continue
        for a, b in zip(e, e[1:]):
            seen = math.log(a / b) / math.log(5.0)
            assert b < 5e-11 or order - 0.8 < seen and (seen < order + 0.5 or kind == "spline"), (kind, e)


def test_measuring_a_style_again(monkeypatch):
    monkeypatch.setattr(measure_speed, "ROUNDS", 2)
    known, entry = SPEED["styles"]["bond fene"], measure_speed.measure("bond", "fene")
    assert entry["left out"] == known["left out"] and list(entry["variants"]) == list(known["variants"])
    for n in ("table linear 200", "table linear 5000", "table spline 200"):
        assert entry["variants"][n]["error"] == pytest.approx(known["variants"][n]["error"], rel=0.05)


def formula_value(text: str, x: float) -> float:
    return differentiate(condense(text), "x", ()).value(x)


def test_formula_of_a_function():
    """Comparisons that go one way on all values leave no trace, others become select; helpers are followed."""
    def half(x):
        return 0.5 * x

    def energy(x, k):
        if x > 10.0:
            return math.inf
        if x < 1.0:
            return half(k) * math.expm1(x)
        return k * abs(x - 2.0) if x <= 1.5 else math.copysign(k, -x) / x**2

    values = np.linspace(0.3, 2.7, 101)
    plain = style_formula.traced(energy)
    text = style_formula.expression(lambda x: plain(x, 3.0), "x", values)
    assert "select" in text and "inf" not in text
    for x in (0.3, 0.99, 1.2, 1.51, 2.6):
        assert formula_value(text, x) == pytest.approx(energy(x, 3.0), rel=1e-14)
    assert "select" not in style_formula.expression(lambda x: plain(x, 3.0), "x", values[values > 1.6])


@pytest.mark.parametrize(("function", "reason"), [
    (lambda x: [1.0, 2.0][int(x)], "more than arithmetic"), (math.gamma, "not one of lepton's"), (lambda x: math.inf * x, "not finite"),
    (lambda x: 1.0 if x == 1.0 else x, "equality")])
def test_functions_without_a_formula(function, reason):
    plain = style_formula.Functions().gamma if function is math.gamma else function
    with pytest.raises(style_formula.Untraceable, match=reason):
        style_formula.expression(plain, "x", np.linspace(0.0, 2.0, 5))


@pytest.mark.parametrize(("category", "name"), [("bond", "morse"), ("improper", "cossq"), ("pair", "lj/cut")])
def test_plot_of_error_against_time(category, name):
    pytest.importorskip("matplotlib")
    entry = SPEED["styles"][f"{category} {name}"]
    first = style_speed.svg(category, name, entry)
    assert first == style_speed.svg(category, name, entry) and first.startswith("<svg") and len(first) < 60_000
    assert "currentColor" in first and "#000000" not in first
    assert all(kind in first for kind in style_speed.kinds(entry)) and "relative error of the force" in first


def test_reading_of_the_plot():
    def entry(**others):
        times = {"double": (0.0, [9.0, 10.0, 11.0]), **others}
        return {"variants": {n: {"error": e, "ns": ns} for n, (e, ns) in times.items()}}
    read = style_speed.reading
    assert "nothing else to compare" in read("bond", entry())
    assert read("angle", entry()).startswith("Double precision takes 10 ns for an angle;")
    assert read("bond", entry(lepton=(0.0, [8.0, 8.5, 9.5]))).endswith("nothing else is faster.")
    text = read("pair", entry(mixed=(2e-7, [4.0, 5.0, 6.0]), lepton=(1e-16, [7.0, 8.0, 8.5])))
    assert "Faster: lepton (1.2 times as fast, error 1e-16); fastest: mixed (2 times as fast, error 2e-07)." in text


def test_sphinx_builds_without_warnings(tmp_path):
    for package in ("sphinx", "myst_parser", "matplotlib"):
        pytest.importorskip(package)
    words = ["-q", "-W", "--keep-going", "-D", "html_theme=basic", "-d", tmp_path / "trees", ROOT / "docs", tmp_path / "site"]
    done = subprocess.run([sys.executable, "-m", "sphinx", *map(str, words)], capture_output=True, text=True,
                          env={**ENV, "NUMBA_DISABLE_JIT": "1"}, timeout=600)
    assert done.returncode == 0 and not done.stderr.strip(), done.stderr[-3000:]
    text = (tmp_path / "site" / "styles" / "bond-fene.html").read_text()
    assert text.count("<svg") >= 2 and "Error against time of bond style fene" in text
    assert "kcal/mol" in text and "21.468258" in text


# ------------------------------------------------------------------ the page on own styles ---

def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", PAGE.read_text(), re.S | re.M)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("own")
    (path / "my_styles.py").write_text(blocks("python")[0])
    (path / "in.pair").write_text(blocks("lammps")[0])
    (path / "page.py").write_text("\n".join(blocks("python")[1:]))
    return path


def python(folder, *words: str) -> subprocess.CompletedProcess:
    return subprocess.run([sys.executable, *words], cwd=folder, env=ENV, capture_output=True, text=True, timeout=300)


def test_page_on_own_styles(folder):
    assert "`my_styles.py`" in PAGE.read_text() and len(blocks("python")[0].strip().splitlines()) <= 12
    done = python(folder, "page.py")
    assert done.returncode == 0, done.stderr[-2000:]
    assert done.stdout == "".join(blocks("text"))


def test_command_with_own_styles(folder):
    command, = blocks("sh")
    done = python(folder, "-m", "asemd.cli", *command.split()[1:])
    assert done.returncode == 0, done.stderr
    rows = [line.split() for line in done.stdout.splitlines() if re.match(r" +\d+ +[\d.]+ ", line)]
    assert [int(r[0]) for r in rows] == [0, 50, 100] and all(float(r[4]) == pytest.approx(2.0, rel=1e-4) for r in rows)
    done = python(folder, "-m", "asemd.cli", "run", "in.pair")
    assert done.returncode == 1 and "unknown bond style 'flat/bottom'" in done.stderr


@pytest.mark.parametrize(("text", "message"), [
    (None, "no such file"), ("x = 1\ny = x +\n", "SyntaxError: invalid syntax"), ("a = 1\nb = a / 0\n", "division by zero"),
    ("from asemd.style import bond\n@bond('harmonic')\ndef own(r, K: 'energy'):\n    return K * r, K\n", "bond style harmonic already")])
def test_files_that_cannot_be_imported(text, message, tmp_path, monkeypatch):
    monkeypatch.delitem(sys.modules, "imported_wrong_styles", raising=False)      # that of another of these tests
    file = tmp_path / "wrong_styles.py"
    if text is not None:
        file.write_text(text)
    with pytest.raises(InputError, match=message) as error:
        import_file(str(file))
    if "Error" in message or "zero" in message:
        assert error.value.where.line == 2
    assert "imported_wrong_styles" not in sys.modules or "already" in message
    assert registry.find("bond", "harmonic").function.__module__ == "asemd.bond.harmonic"


def test_report_names_what_is_left_out():
    text = report_style(registry.find("bond", "bpm/spring"))
    assert re.search(r"gradient +left out +its force is smoothed", text) and "text       passed" in text and "FAILED" not in text
