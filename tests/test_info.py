"""``info``: sections by their first letters, on the terminal unless a file is named."""
from __future__ import annotations

from pathlib import Path

import pytest
from both import asemd

from asemd.errors import InputError

BOX = """region b block 0 4 0 4 0 4
create_box 2 b
mass * 1
pair_style lj/cut 1.5
pair_coeff 1 1 1 1
group g type 1
variable v index a b
compute c all temp
"""


def told(line: str) -> str:
    session = asemd(BOX)
    session.told.clear()
    session.execute(line)
    return "".join(session.told)


@pytest.mark.parametrize("words, shown", [
    ("coeffs", ["     1      1: is set", "     1      2: is not set"]), ("gro", ["Group[ 1]: g (static)"]), ("var", ["v,", "def = a b"]),
    ("comp", ["c, style = temp"]), ("comm", ["Nprocs = 1"]), ("system memory", ["Boundary = p p p", "resident set size"]),
    ("styles region", ["block", "cylinder"]), ("all", ["System information", "FFT information", "Accelerator"]),
])
def test_sections(words, shown):
    text = told(f"info {words}")
    assert all(" ".join(s.split()) in " ".join(text.split()) for s in shown), text


def test_targets(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert told("info groups out overwrite a.txt") == "" and "Group[ 1]: g" in Path("a.txt").read_text()
    assert told("info groups out log") == ""


@pytest.mark.parametrize("line, message", [("info grps", "did you mean groups"), ("info out", "1 value"), ("info out paper", "screen log"),
                                           ("info groups out append none/x", "cannot write none/x")])
def test_mistakes(line, message):
    with pytest.raises(InputError, match=message):
        told(line)
