"""Commands that are about processors in LAMMPS: checked, and without effect."""
from __future__ import annotations

import pytest
from both import asemd

from asemd.errors import InputError

BOX = "region b block 0 4 0 4 0 4\ncreate_box 1 b\nmass 1 1\n"


def test_partition():
    session = asemd(BOX + "partition yes 1 create_atoms 1 single 1 1 1\npartition no 1 create_atoms 1 single 2 2 2\n"
                    "partition yes * create_atoms 1 single 3 3 3")
    assert session.scene.system.n == 2


def test_older_communicate():
    asemd(BOX + "communicate multi\ncommunicate single cutoff 5.0 vel yes group all")


@pytest.mark.parametrize("line, message", [
    ("partition yes 2 print x", "valid range 1 to 1"), ("partition maybe 1 print x", "yes or no"), ("partition yes 1", "3 values"),
    ("partition yes 1 prnt x", "did you mean print"), ("communicate", "1 value"), ("communicate fast", "single multi"),
    ("communicate single cutof 3", "did you mean cutoff"), ("communicate single cutoff", "1 value"),
    ("communicate single cutoff -1", "negative"),
])
def test_mistakes(line, message):
    with pytest.raises(InputError, match=message):
        asemd(BOX).execute(line)
