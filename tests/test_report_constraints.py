"""asemd report of scenes with constraints: forces are those of the force field, and what is held is no matter of tables or temperatures."""
from __future__ import annotations

import math

import numpy as np
import pytest
from shake_scene import head, write_data
from test_report import ENDLESS, stop_the_clock

import asemd
from asemd.engine import Engine
from asemd.fix.shake import Shake
from asemd.report import nve
from asemd.report.constraints import field_forces
from asemd.report.copies import load


@pytest.fixture(scope="module")
def water(tmp_path_factory):
    """The text of a script with water and ethanol; the bonds of hydrogen and the angle of water are held."""
    folder = tmp_path_factory.mktemp("water")
    write_data(folder / "water.data")
    path = folder / "in.water"
    path.write_text(f"{head(folder / 'water.data')}timestep 1.0\nfix 2 all shake 1e-5 100 0 b 1 2 4 a 1\nfix 1 all nve\nrun 10\n")
    return path


def test_forces_and_temperatures(water, monkeypatch):
    stop_the_clock(monkeypatch, 40)
    report = asemd.report(water, ENDLESS, only=["precision", "bond-table", "angle-table", "tolerance"], lammps=False)
    assert report.script.force_error < 1e-12
    assert all(math.isnan(p.configurational) and math.isnan(p.temperature_offset) for p in report.points)
    assert any(note.startswith("No configurational temperature: fix 2 (shake) holds distances") for note in report.notes)
    for kind in ("bond", "angle"):
        assert report.left_out[f"{kind}-table"].startswith(f"fix 2 (shake) holds {kind}s")
    assert report.curve("tolerance").points


@pytest.mark.parametrize("style", ["verlet", "respa 2 2 bond 1 angle 1 pair 2"])
def test_forces_of_the_field(water, tmp_path, style):
    """They are those without constraints, and looking at them does not change the run."""
    (tmp_path / "in.water").write_text(water.read_text().replace("run 10", f"run_style {style}\nrun 10"))
    scene = load(tmp_path / "in.water")
    found = []

    def look(k, loop, result):
        found.append((loop.system.x.copy(), loop.system.f.copy(), field_forces(loop).copy()))
    series = nve.run(scene, steps=6, samples=3, shift=False, observe=look)
    assert not series.failed
    for x, held, field in found[1:]:
        system = scene.system.copy()
        system.x[:] = x
        exact = Engine(system, scene.interactions, scene.settings()).compute().forces
        assert np.abs(field - exact).max() < 1e-9 * np.abs(exact).max()
        assert np.abs(held - exact).max() > 0.01 * np.abs(exact).max()
    alone = nve.run(scene, steps=6, samples=3, shift=False)
    assert np.array_equal(alone.system.x, series.system.x) and np.array_equal(alone.system.v, series.system.v)


def test_fixes_of_ones_own(water, tmp_path, monkeypatch):
    """A fix that is added in Python finds what it holds at the beginning of a run; the reference knows it too."""
    text = water.read_text().replace("fix 2 all shake 1e-5 100 0 b 1 2 4 a 1\n", "")
    (tmp_path / "in.water").write_text(text)
    scene = load(tmp_path / "in.water")
    shake = Shake(bonds=[1, 2, 4], angles=[1], tolerance=1e-5, iterations=100)
    shake.id = "2"
    scene.fixes["2"] = shake
    stop_the_clock(monkeypatch, 40)
    report = asemd.report(scene, ENDLESS, only=["precision"], lammps=False)
    assert report.script.force_error < 1e-12
    assert not shake.lasting and (scene.system.topology.bond_types > 0).all()
