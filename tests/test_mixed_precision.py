"""Mixed precision: which pair styles have it, and what is said of those that have not."""
from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from asemd import registry
from asemd.cluster_term import has_single, in_double
from asemd.engine import Engine
from asemd.errors import InputWarning
from asemd.lammps import Lammps
from asemd.report.copies import load
from asemd.report.knobs.precision import Precision

ACCURACY = Path(__file__).resolve().parents[1] / "docs" / "accuracy.md"
HEAD = """units lj
atom_style atomic
lattice fcc 0.8442
region box block 0 5 0 5 0 5
create_box 2 box
create_atoms 1 box
set type 1 type/fraction 2 0.5 12
mass * 1.0
displace_atoms all random 0.05 0.05 0.05 3
"""
LJ = "pair_style lj/cut 2.5\npair_coeff * * 1.0 1.0\n"
ATM = "pair_style hybrid/overlay lj/cut 2.5 atm 2.5 1.5\npair_coeff * * lj/cut 1.0 1.0\npair_coeff * * atm * 0.01\n"
ALONE = "pair_style atm 2.5 1.5\npair_coeff * * * 0.01\n"


def mixed(path, commands: str, size: str = "5"):
    """The scene of a script that asks for mixed precision."""
    path.write_text(HEAD.replace("0 5 0 5 0 5", f"0 {size} " * 3) + commands)
    scene = load(path)
    scene.precision = "mixed"
    return scene


@pytest.mark.parametrize("commands, names, why, left", [
    (LJ, [], "", False), (ATM, ["atm"], "no kernel in single precision", False), (ALONE, ["atm"], "no kernel in single precision", True)])
def test_what_stays(tmp_path, commands, names, why, left):
    """What is said to stay in double precision is what has the same forces in both."""
    scene = mixed(tmp_path / "in.scene", commands)
    engine = Engine(scene.system.copy(), scene.interactions, scene.settings())
    found, reason = in_double(engine)
    assert found == names and (reason == why or not names)
    assert bool(Precision().needs(scene)) == left
    forces = engine.compute().forces
    scene.precision = "double"
    exact = Engine(scene.system.copy(), scene.interactions, scene.settings()).compute().forces
    assert (np.abs(forces - exact).max() < 1e-12 * np.abs(exact).max()) == left      # the order of sums may be another one


def test_small_scenes(tmp_path):
    scene = mixed(tmp_path / "in.scene", LJ, "1")
    names, why = in_double(Engine(scene.system, scene.interactions, scene.settings()))
    assert names == ["lj/cut"] and why and why in Precision().needs(scene)


@pytest.mark.parametrize("commands, warned", [(LJ, 0), (ATM, 1)])
def test_a_run_says_it_once(commands, warned):
    lmp = Lammps(cmdargs=["-screen", "none", "-log", "none", "-precision", "mixed"])
    with pytest.warns(InputWarning) as caught:
        lmp.commands_string(HEAD + commands + "run 0\nrun 0\n")
    lmp.close()
    said = [str(w.message) for w in caught if "mixed precision" in str(w.message)]
    assert said == ["mixed precision: pair style atm stays in double precision (no kernel in single precision)"] * warned


def test_the_list_of_the_documentation():
    listed = re.search(r"<!-- double: begin -->(.*?)<!-- double: end -->", ACCURACY.read_text(), re.S).group(1)
    without = {name for name in registry.names("pair") if not has_single(registry.known["pair", name])}
    assert set(re.findall("`(.*?)`", listed)) == {n for n in without if not n.startswith("hybrid") and n not in ("none", "zero")}
