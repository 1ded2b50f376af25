"""What ``[*]`` stands for is known before the first run."""
from __future__ import annotations

import importlib
import pkgutil

import pytest
from both import asemd

import asemd.compute as computes
from asemd.compute import Compute

SCENE = """
units lj
atom_style molecular
lattice fcc 0.8442
region b block 0 3 0 3 0 3
create_box 2 b
create_atoms 1 box
mass * 1
velocity all create 1.44 87287
pair_style lj/cut 2.5
pair_coeff * * 1 1
compute chunks all chunk/atom bin/1d z lower 0.5 units box
compute x all property/atom x y
compute r all rdf 20
fix 1 all nve
"""
ARRAYS = {
    "rdf 20": 3, "rdf 20 1 1 1 2": 5, "adf 10": 3, "com/chunk chunks": 3, "vcm/chunk chunks": 3, "gyration/chunk chunks tensor": 6,
    "gyration/shape/chunk g": 6, "inertia/chunk chunks": 6, "msd/chunk chunks": 4, "vacf/chunk chunks": 4, "omega/chunk chunks": 3,
    "angmom/chunk chunks": 3, "torque/chunk chunks": 3, "property/chunk chunks count coord1": 2, "temp/chunk chunks temp kecom": 2,
    "reduce/chunk chunks sum c_x[1] c_x[2]": 2, "temp/profile 1 1 1 z 4 out bin": 2, "slice 1 6 1 c_r[1] c_r[2]": 2}


def test_every_array_says_how_wide_it_is():
    for module in pkgutil.iter_modules(computes.__path__):
        for found in vars(importlib.import_module(f"asemd.compute.{module.name}")).values():
            if isinstance(found, type) and issubclass(found, Compute) and found.array is not Compute.array:
                assert found.array_columns is not Compute.array_columns, found.style


@pytest.mark.parametrize("words", ARRAYS)
def test_columns(words):
    script = SCENE + ("compute g all gyration/chunk chunks tensor\n" if words.endswith(" g") else "")
    session = asemd(script + f"compute c all {words}\nfix 2 all ave/time 5 1 5 c_c[*] mode vector\nrun 5")
    assert session.scene.computes["c"].array_columns() == ARRAYS[words]
    assert session.moment.array("c").shape[1] == ARRAYS[words]
    assert len([w for w in session.scene.fixes["2"].to_lammps() if w.startswith("c_c[")]) in (1, ARRAYS[words])
