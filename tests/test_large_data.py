"""Large data files: all digits come back, memory stays bounded, progress is told. The times of a million atoms: benchmarks/data_file.py."""
from __future__ import annotations

import numpy as np
import pytest
from both import asemd

from asemd.lammps import session as sessions
from asemd.lammps.data import read_data
from asemd.lammps.data_lines import BLOCK, Lines
from asemd.lammps.data_write import write_data


@pytest.fixture(scope="module")
def chains(tmp_path_factory):
    import sys
    from pathlib import Path
    sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
    from tests.benchmarks.data_file import chains
    system = chains(30_000)
    path = tmp_path_factory.mktemp("large") / "chains.data"
    write_data(path, system)
    return system, path


def test_everything_comes_back(chains):
    system, path = chains
    told: list[tuple[int, int]] = []
    other = read_data(path, "real", "full", progress=lambda done, total: told.append((done, total))).system
    for name in ("id", "type", "x", "v", "q", "molecule", "image"):
        assert np.array_equal(getattr(other, name), getattr(system, name)), name
    assert other.topology == system.topology
    done, totals = zip(*told)
    assert list(done) == sorted(done) and set(totals) == {path.read_text().count("\n") + 1} and done[-1] <= totals[0]


def test_memory_of_reading(chains):
    import tracemalloc
    system, path = chains
    tracemalloc.start()
    read_data(path, "real", "full")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak / system.n < 1000.0


def test_labels_are_read_in_bulk(chains, tmp_path, monkeypatch):
    """Labels are looked up while the numbers are read: never line by line, and in no more memory."""
    import tracemalloc

    from asemd.lammps import data_table
    from tests.benchmarks.data_file import label
    monkeypatch.setattr(data_table, "_slowly", None)
    system, path = chains[0].copy(), tmp_path / "labels.data"
    label(system)
    write_data(path, system, types="labels")
    assert " O-x " in path.read_text() and " C-C-C " in path.read_text()
    tracemalloc.start()
    other = read_data(path, "real", "full").system
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert np.array_equal(other.type, system.type) and other.topology == system.topology and other.labels == system.labels
    assert peak / system.n < 1000.0


def test_writing_tells_its_progress(chains, tmp_path):
    system, told = chains[0], []
    write_data(tmp_path / "f", system, progress=lambda done, total: told.append((done, total)))
    assert told[-1][0] == told[-1][1] == 2 * system.n + len(system.topology.bonds) + len(system.topology.angles)


def test_progress_reaches_the_terminal(chains, monkeypatch, tmp_path):
    class Terminal:
        def __init__(self):
            self.calls = []

        def start(self, total, unit):
            self.calls.append(("start", total, unit))

        def update(self, done):
            self.calls.append(("update", done))

        def stop(self):
            self.calls.append(("stop",))
    session = asemd("units real\natom_style full\nbond_style zero\nangle_style zero")
    session.observer = terminal = Terminal()
    session.execute(f"read_data {chains[1]}")
    assert terminal.calls == []         # a small file
    monkeypatch.setattr(sessions, "LARGE", 1000)
    session.execute(f"write_data {tmp_path / 'again'} nocoeff")
    assert terminal.calls[0][0] == "start" and terminal.calls[0][2] == "lines"
    assert terminal.calls[-1] == ("stop",) and terminal.calls[-2][0] == "update"


def test_lines_of_a_text():
    text = "title\n\n  Atoms # full\n\n1 2\n\tBonds\n 3 4\nlast"
    lines = Lines(text.encode())
    assert list(lines) == text.split("\n") and len(lines) == 8 and lines[-1] == "last" and lines[1:4] == text.split("\n")[1:4]
    assert lines.beginning_with_letters(0).tolist() == [0, 2, 5, 7] and lines.beginning_with_letters(3).tolist() == [5, 7]
    many = Lines(("1 2 3\n" * (2 * BLOCK + 5)).encode())
    assert [len(b) for b in many.blocks(1, len(many) - 1)] == [BLOCK, BLOCK, 4] and many[BLOCK] == "1 2 3"
