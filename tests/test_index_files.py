"""Index files of GROMACS: what `group2ndx` writes LAMMPS writes too, and `ndx2group` reads it back."""
from __future__ import annotations

import numpy as np
import pytest
import wheel
from both import asemd

from asemd.errors import InputError

BOX = """region b block 0 40 0 1 0 1
create_box 2 b
lattice sc 1.0
create_atoms 1 box
mass * 1
group few id 3 5
group many id > 20
group nobody empty
"""
WRITTEN = "group2ndx all.ndx\ngroup2ndx two.ndx many few"
WHEEL = """
import os
os.chdir(given["folder"])
lmp = ran(given["text"])
answer = [Path(name).read_text() for name in ("all.ndx", "two.ndx")]
"""


def test_files_are_those_of_lammps(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    asemd(BOX + WRITTEN)
    ours = [(tmp_path / name).read_text() for name in ("all.ndx", "two.ndx")]
    (tmp_path / "wheel").mkdir()
    assert ours == wheel.ask(WHEEL, folder=str(tmp_path / "wheel"), text=BOX + WRITTEN)


def test_there_and_back(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    session = asemd(BOX + WRITTEN + "\ngroup few delete\ngroup many clear\ngroup many id 1\nndx2group all.ndx\nndx2group two.ndx few")
    groups, id = session.scene.groups, session.scene.system.id
    assert id[groups["few"]].tolist() == [3, 5]
    assert np.array_equal(groups["many"], (id > 20) | (id == 1)) and not groups["nobody"].any() and "System" not in groups


@pytest.mark.parametrize("line, message", [
    ("group2ndx", "1 value"), ("group2ndx a.ndx mayn", "did you mean many"), ("group2ndx none/a.ndx", "cannot write none/a.ndx"),
    ("ndx2group", "1 value"), ("ndx2group a.ndx", "cannot open a.ndx"), ("ndx2group two.ndx fwe", "did you mean few"),
    ("ndx2group early.ndx", "before the first.*early.ndx:1"), ("ndx2group text.ndx", "'x'.*text.ndx:2"),
])
def test_mistakes(line, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "early.ndx").write_text("1 2\n[ a ]\n")
    (tmp_path / "text.ndx").write_text("[ a ]\n1 x\n")
    session = asemd(BOX + WRITTEN)
    with pytest.raises(InputError, match=message):
        session.execute(line)
