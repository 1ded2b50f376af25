"""The battery of extreme cases: every figure is within its limit, and every one fails when something is wrong."""
from __future__ import annotations

import inspect
import json
import math
import re

import numpy as np
import pytest
from numba import config

from asemd.check import battery
from asemd.check.battery.result import Line, Result
from asemd.errors import InputError
from asemd.fix import hook
from asemd.fix.nve import NVE
from asemd.lammps import Lammps
from asemd.testing import oracle

CASES = battery.all_cases()
FIGURES = [(name, figure.name) for name, c in CASES.items() for figure in c.figures]
compiled = pytest.mark.skipif(bool(config.DISABLE_JIT), reason="too slow without the compiler")


def open_session() -> Lammps:
    return Lammps(cmdargs=["-screen", "none", "-log", "none"])


@compiled
@pytest.mark.parametrize("name", CASES)
def test_every_figure_is_within_its_limit(name):
    found = battery.measured(CASES[name], open_session)
    assert set(found) == {f.name for f in CASES[name].figures}, found
    for figure in CASES[name].figures:
        assert found[figure.name] <= figure.limit, figure.name


@pytest.mark.parametrize("name", CASES)
def test_cases_say_what_they_mean_and_where_limits_come_from(name):
    case = CASES[name]
    text = inspect.getmodule(case.measure).__doc__
    assert "Source:" in text and len(text) > 200 and case.figures
    assert all(f.limit >= 0.0 and len(f.meaning) > 40 for f in case.figures)


# ---------------------------------------------------------------------------------------------- what is wrong must be seen ---

class Planted:
    """A session of asemd in which some text of the commands, or some answer, is another one."""

    def __init__(self, old: str = "", new: str = "", wrong=None):
        self.session, self.old, self.new, self.wrong = open_session(), old, new, wrong or {}

    def edited(self, text: str) -> str:
        return re.sub(self.old, self.new, text, flags=re.M) if self.old else text

    def command(self, text):
        return self.wrong.get("command", Lammps.command)(self.session, self.edited(text))

    def commands_string(self, text):
        self.session.commands_string(self.edited(text))

    def gather_atoms(self, name, *shape):
        return self.wrong.get(name, lambda values: values)(np.array(self.session.gather_atoms(name, *shape), float))

    def get_thermo(self, name):
        return self.wrong.get("thermo", lambda session, name: session.get_thermo(name))(self.session, name)

    def __getattr__(self, name):
        return getattr(self.session, name)


def quiet(session, text):
    """Goes on after every error, in silence."""
    try:
        session.command(text)
    except Exception:
        session.scene.system.x[:] = math.nan
        session.scene.system.v[:] = math.nan


FRICTION = (r"fix 1 all nve", r"fix 1 all nve\nfix 9 all langevin 0 0 5 1")
SILENT = {"command": quiet, "thermo": lambda session, name: math.nan}
# figure -> how the session goes wrong: text to replace, by what, wrong answers
PLANTS = {
    ("FENE dumbbell", "extension under tension, 0.5 to 0.99 R0"): (r"^ *bond_coeff 1 30.0", "bond_coeff 1 29.9999"),
    ("FENE dumbbell", "energy after release from 0.99 R0"): (r"fix 1 all nve", r"fix 1 all nve\nfix 9 all langevin 0 0 0.5 1"),
    ("LJ melt", "exponent of the energy error, 0.0025 to 0.01"): FRICTION,
    ("LJ melt", "way back after 100 steps"): FRICTION,
    ("LJ melt", "silent failures at 0.02 and 0.03"): (r"timestep 0.0[23]", "timestep 0.9", SILENT),
    ("Langevin", "fix baoab: positions, gamma dt 1e-3 to 10"): (r"baoab 1 1", "baoab 1.3 1.3"),
    ("Langevin", "langevin gjf: positions, gamma dt 1e-3 to 10"): (r"langevin 1 1 (\S+) 4713 gjf", r"langevin 1.3 1.3 \1 4713 gjf"),
    ("Langevin", "langevin gjf vhalf: velocities"): ("vhalf", "vfull"),
    ("Langevin", "plain langevin against its own theory"): ("4713$", "4713 gjf vhalf"),
    ("Morse dissociation", "period at 0.9 of the depth"): (r"bond_coeff 1 10.0 2.0", "bond_coeff 1 10.0 2.001"),
    ("Morse dissociation", "speed of the parts, 1.01 of the depth"): (r"bond_coeff 1 10.0", "bond_coeff 1 10.01"),
    ("Nose-Hoover chain", "energy of atoms and chain, 5 to 1e5 steps"): (r"fix 1 all nvt (.*)$",
                                                                       r"fix 1 all nvt \1\nfix 9 all langevin 1 1 1 1"),
    ("Nose-Hoover chain", "temperature, 5 and 30 steps"): ("temp 1.0 1.0", "temp 1.1 1.1"),
    ("Nose-Hoover chain", "scatter of the temperature, 5 and 30 steps"): (r"nvt temp (.*)$", r"nve\nfix 9 all temp/berendsen \1"),
    ("Nose-Hoover chain", "silent failures at half a step"): ("", "", SILENT),
    ("a million images away", "energy and forces"): (r"move 16000000.0 0 0", "move 16000000.001 0 0"),
    ("a million images away", "unwrapped positions, box lengths"): ("", "", {"image": lambda i: i % 1024}),
    ("coincident atoms", "divergent energies without a word"): ("", "", SILENT),
    ("coincident atoms", "finite energies"): (r"soft 1.5", "soft 1.5\nspecial_bonds lj 0 0 0", {"f": lambda f: f + 1e-9}),
    ("flexible water", "longest stable timestep"): ("mass 2 1.008", "mass 2 1.012"),
    ("flexible water", "exponent of the energy error, 0.25 to 1 fs"): (r"fix 1 all nve", r"fix 1 all nve\nfix 9 all langevin 0 0 1000 1"),
    ("harmonic dimer", "frequency shift, omega dt 0.1 to 1.99"): (r"bond_coeff 1 100.0", "bond_coeff 1 100.0001"),
    ("harmonic dimer", "shadow energy, omega dt 0.1 to 1.99"): FRICTION,
    ("harmonic dimer", "onset of instability, omega dt"): (r"bond_coeff 1 100.0", "bond_coeff 1 100.5"),
    ("length scales 1e-3 and 1e3", "energy and forces"): (r"neighbor 0.000.* bin",
                                                          "neighbor 0.01 bin\npair_coeff * * 1.0000001 0.0009765625"),
    ("length scales 1e-3 and 1e3", "positions after 100 steps"): (r"timestep 4.0", "timestep 4.00001"),
    ("linear angles", "force 0.1 to 1e-8 from straight, as angle"): ("angle_coeff 1 50.0", "angle_coeff 1 50.0000001"),
    ("linear angles", "bending frequency of a linear molecule"): ("angle_coeff 1 50.0", "angle_coeff 1 50.001"),
    ("quartic breaking", "kinetic energy of the parts"): ("bond_coeff 1 1200.0 -0.55", "bond_coeff 1 1200.0 -0.56"),
    ("quartic breaking", "energy of the bond, before and after"): ("34.6878$", "34.6879"),
    ("tilted box", "energy and forces, 1 to 10 lengths"): (r"prism 0 8.0 0 8.0 0 8.0 9", "prism 0 8.0 0 8.0 0 8.0000001 9"),
    ("tilted box", "energy over 200 steps"): (r"prism 0 8.0 0 8.0 0 8.0 9", "prism 0 8.0 0 8.0 0 8.0000001 9"),
    ("trans torsions", "force 1 to 1e-6 degrees from trans, as angle"): ("dihedral_coeff 1 20.0 1 1", "dihedral_coeff 1 20.0000001 1 1"),
}


def test_every_figure_has_a_plant():
    assert set(PLANTS) == set(FIGURES)


@compiled
@pytest.mark.parametrize(("name", "figure"), FIGURES)
def test_every_figure_can_fail(name, figure):
    with pytest.MonkeyPatch.context() as patch:
        if name == "Langevin":       # the plants are gross: fewer springs and one friction show them
            module = inspect.getmodule(CASES[name].measure)
            patch.setattr(module, "DAMPINGS", (0.1,))
        found = battery.measured(CASES[name], lambda: Planted(*PLANTS[name, figure]))
    limit = next(f.limit for f in CASES[name].figures if f.name == figure)
    assert "error" not in found and not found[figure] <= limit, found


class Euler(NVE):
    """The whole kick after the move: an integrator of first order."""

    final_initial = None

    @hook
    def initial_integrate(th, s, p, a):
        for d in range(3):
            for i in range(th.lo, th.hi):
                s.x[d, i] += th.dt * s.v[d, i]

    @hook
    def final_integrate(th, s, p, a):
        for d in range(3):
            for i in range(th.lo, th.hi):
                s.v[d, i] += 1.001 * th.dt * s.inverse_mass[i] * s.f[d, i]


@compiled
def test_a_wrong_integrator_is_seen(monkeypatch):
    monkeypatch.setattr(NVE, "initial_integrate", Euler.initial_integrate)
    monkeypatch.setattr(NVE, "final_integrate", Euler.final_integrate)
    monkeypatch.delattr(NVE, "final_initial")
    result = battery.run(["harmonic dimer"], lammps=False)
    assert {line.figure.split(",")[0] for line in result.failed} >= {"frequency shift", "shadow energy"}
    assert not result.ok and result.exit_status == 2 and "FAILED" in str(result)


# ------------------------------------------------------------------------------------------------------------ the report ---

def test_names_are_words_of_the_cases():
    assert [c.name for c in battery.chosen(["angles", "HARMONIC"])] == ["harmonic dimer", "linear angles"]
    with pytest.raises(InputError, match="did you mean LJ melt"):
        battery.run(["LJ meld"])


def test_the_result_as_text_and_json(tmp_path):
    calls = []
    result = battery.run(["linear angles"], lammps=False, progress=lambda *told: calls.append(told))
    assert result.ok and result.exit_status == 0 and not result.live
    assert calls == [("linear angles", 0, 2), ("the same with LAMMPS", 1, 2)]
    text = str(result)
    for word in ("linear angles", "bending frequency", "1e-06", "0.59", "20250722, recorded", "ok"):
        assert word in text
    data = json.loads(json.dumps(result.to_dict(), allow_nan=False))
    assert data["ok"] and len(data["figures"]) == 2 and data["figures"][1]["lammps"] == pytest.approx(0.589)


def test_nothing_and_nan_fail():
    lines = [Line("a", "b", 1.0, value, "c") for value in (None, math.nan, math.inf, 1.1, 1.0)]
    assert [line.ok for line in lines] == [False, False, False, False, True]
    result = Result(lines, "1", False, 0.0)
    assert len(result.failed) == 4 and "no figure" in str(result)
    json.dumps(result.to_dict(), allow_nan=False)


def test_a_case_that_stops_is_told(monkeypatch):
    def stops(start):
        raise ValueError("first line\nsecond line")
    case = CASES["linear angles"]
    monkeypatch.setitem(battery.CASES, "linear angles", battery.Case("linear angles", stops, case.figures))
    result = battery.run(["linear angles"], lammps=False)
    assert not result.ok and "first line" in str(result) and "second line" not in str(result)


def test_recorded_figures_belong_to_the_cases():
    version, figures, live = battery.beside(list(CASES), False)
    assert not live and re.fullmatch(r"\d{8}", version) and set(figures) == set(CASES)
    for name, found in figures.items():
        names = {f.name for f in CASES[name].figures}
        assert set(found) == {"error"} or names - set(found) <= {"fix baoab: positions, gamma dt 1e-3 to 10"}
        assert set(found) <= names | {"error"}


def test_recorded_figures_are_those_of_lammps():
    if not oracle.lammps_available():
        pytest.skip(oracle.why_not())
    names = ["harmonic dimer", "linear angles", "tilted box"]
    version, found = battery.from_lammps(names)
    recorded_version, recorded, _ = battery.beside(names, False)
    if version != recorded_version:
        pytest.skip("another version of LAMMPS than the recorded one")
    assert "Lost atoms" in found["tilted box"]["error"] and "Lost atoms" in recorded["tilted box"]["error"]
    for name in names[:2]:
        assert set(found[name]) == set(recorded[name])
        for figure, value in found[name].items():
            assert value < 1e-9 or value == pytest.approx(recorded[name][figure], rel=0.05), figure


@compiled
def test_the_command(capsys, monkeypatch):
    from asemd.cli import main
    original = battery.run
    monkeypatch.setattr(battery, "run", lambda: original(["linear angles"], lammps=False))
    assert main(["check", "--battery", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["ok"]
    assert main(["check", "--battery"]) == 0
    assert "linear angles" in capsys.readouterr().out
