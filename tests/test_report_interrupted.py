"""asemd report after Ctrl-C, and when compilation takes long: what was measured is kept."""
from __future__ import annotations

import json
import signal
from types import SimpleNamespace

import pytest
from test_report import ENDLESS, MELT, stop_the_clock

import asemd
from asemd.report import clock, course, nve


@pytest.fixture
def melt(tmp_path):
    path = tmp_path / "in.melt"
    path.write_text(MELT)
    return path


@pytest.fixture
def stopped(monkeypatch):
    stop_the_clock(monkeypatch, 100)


def test_interrupted(melt, stopped):
    """What was measured before Ctrl-C is kept."""
    def tell(done, total, what):
        if what.startswith("timestep"):
            raise KeyboardInterrupt
    report = asemd.report(melt, ENDLESS, only=["timestep"], lammps=False, tell=tell)
    assert report.interrupted and report.script.seconds_per_step > 0.0 and report.curve("timestep").points == [report.script]


def test_interrupted_late(melt, stopped):
    """The advice then rests on what there is."""
    def tell(done, total, what):
        if what.startswith("precision mixed"):
            raise KeyboardInterrupt
    report = asemd.report(melt, ENDLESS, only=["timestep", "precision"], lammps=False, tell=tell)
    assert report.interrupted and len(report.curve("timestep").points) == 2
    if report.best is not None:
        assert report.gain > 1.0 and "faster" in report.recommendation


@pytest.mark.parametrize("at", [1, 3, 5])
def test_ctrl_c_anywhere(melt, tmp_path, stopped, monkeypatch, at):
    """Before anything is measured, between and within runs: the files are there, and say what they are."""
    count, run = [0], nve.run

    def hit(*args, **options):
        count[0] += 1
        if count[0] == at:
            raise KeyboardInterrupt
        return run(*args, **options)
    monkeypatch.setattr(nve, "run", hit)
    report = asemd.report(melt, ENDLESS, folder=tmp_path / "out", only=["skin"], lammps=False)
    assert report.interrupted and json.loads((tmp_path / "out" / "report.json").read_text())["interrupted"] is True
    assert "Interrupted" in (tmp_path / "out" / "report.md").read_text() and (tmp_path / "out" / "report.html").exists()
    if at < 5:
        assert report.recommendation == "Nothing was measured."


def test_ctrl_c_while_files_are_written():
    """The first one waits until they are complete, the second one does not."""
    with course.undisturbed() as asked:
        signal.raise_signal(signal.SIGINT)
    assert asked
    with pytest.raises(KeyboardInterrupt), course.undisturbed():
        signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGINT)


def test_compilation_is_bounded(monkeypatch):
    now = [0.0]
    monkeypatch.setattr(clock, "time", SimpleNamespace(perf_counter=lambda: now[0]))
    for budget, bound in ((10.0, clock.COMPILING), (100.0, clock.PATIENCE * 100.0)):
        now[0] = 0.0
        watch = clock.Clock(budget)
        watch.besides = now[0] = bound
        assert watch.used == 0.0
        watch.besides = now[0] = bound + 5.0
        assert watch.used == 5.0
        watch.reserve = 2.0
        assert watch.left() == budget - 7.0
