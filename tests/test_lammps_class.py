"""The class with the methods of the ``lammps`` module."""
from __future__ import annotations

import ctypes

import numpy as np
import pytest
from lj_cell import BASE

from asemd.errors import InputError
from asemd.lammps import Lammps


@pytest.fixture
def lmp():
    with Lammps(cmdargs=["-screen", "none", "-log", "none", "-var", "T", "1.5"]) as session:
        session.commands_string(BASE)
        session.commands_list(["thermo_style custom step temp pe press", "compute pa all pe/atom", "run 10"])
        yield session


def test_thermo(lmp):
    assert lmp.get_thermo("temp") == pytest.approx(1.0849398, abs=1e-7)
    titles = {"Step": "step", "Temp": "temp", "PotEng": "pe", "Press": "press"}
    assert lmp.last_thermo() == {title: lmp.get_thermo(word) for title, word in titles.items()}
    assert lmp.last_thermo_step == 10 and not lmp.is_running
    with pytest.raises(InputError, match="did you mean temp"):
        lmp.get_thermo("tmp")


def test_gather_and_scatter_by_id(lmp):
    x = lmp.gather_atoms("x", 1, 3)
    assert isinstance(x, ctypes.Array) and len(x) == 96
    rows = np.argsort(lmp.scene.system.id)
    assert np.array_equal(np.array(x).reshape(-1, 3), lmp.scene.system.x[rows])
    subset = lmp.gather_atoms_subset("x", 1, 3, 2, [7, 3])
    assert list(subset) == list(x[18:21]) + list(x[6:9])
    pe = lmp.get_thermo("pe")
    for i in range(96):
        x[i] += 0.01
    lmp.scatter_atoms("x", 1, 3, x)
    lmp.command("run 0")
    assert lmp.get_thermo("pe") == pytest.approx(pe, rel=1e-12)
    lmp.scatter_atoms_subset("v", 1, 3, 1, [5], [9.0, 8.0, 7.0])
    assert list(lmp.gather_atoms_subset("v", 1, 3, 1, [5])) == [9.0, 8.0, 7.0]
    with pytest.raises(InputError):
        lmp.gather_atoms("x", 1, 1)
    with pytest.raises(InputError):
        lmp.gather_atoms("q", 1, 1)


def test_image_flags(lmp):
    assert lmp.encode_image_flags(1, -2, 3) == (513 | 510 << 10 | 515 << 20)
    assert lmp.decode_image_flags(lmp.encode_image_flags(1, -2, 3)) == [1, -2, 3]
    packed, full = lmp.gather_atoms("image", 0, 1), lmp.gather_atoms("image", 0, 3)
    assert lmp.decode_image_flags(packed[4]) == list(full[12:15])


def test_atoms_are_live(lmp):
    x = lmp.extract_atom("x")
    x[0][1] += 0.001
    assert lmp.numpy.extract_atom("x") is x or np.shares_memory(lmp.numpy.extract_atom("x"), x)
    assert lmp.extract_atom("type")[0] == 1 and lmp.extract_atom("mass")[1] == 1.0


def test_box_and_globals(lmp):
    lo, hi, xy, yz, xz, periodic, change = lmp.extract_box()
    assert lo == [0, 0, 0] and hi == pytest.approx([3.3591923827650145] * 3)
    assert (xy, yz, xz, change) == (0, 0, 0, 0) and periodic == [1, 1, 1]
    assert lmp.extract_global("ntimestep") == 10 and lmp.extract_global("boltz") == 1.0 and lmp.extract_global("nope") is None
    assert lmp.extract_setting("ntypes") == 1 and lmp.extract_setting("nope") == -1
    lmp.reset_box([0, 0, 0], [4, 4, 4], 0, 0, 0)
    lmp.command("run 0")
    assert lmp.get_thermo("vol") == 64.0


def test_computes_fixes_variables(lmp):
    lmp.commands_string("variable e equal pe\nvariable a atom x*2\nvariable s string abc\nrun 0")
    assert lmp.extract_compute("thermo_temp", 0, 0) == lmp.get_thermo("temp")
    assert lmp.extract_compute("thermo_press", 0, 1)[2] == lmp.get_thermo("pzz")
    assert lmp.extract_compute("thermo_press", 0, 3) == 6
    assert lmp.extract_compute("pa", 1, 1).sum() == pytest.approx(32 * lmp.get_thermo("pe"), rel=1e-12)
    assert lmp.extract_variable("e") == lmp.get_thermo("pe") and lmp.extract_variable("T") == "1.5"
    assert np.array_equal(lmp.extract_variable("a", "all"), 2 * lmp.extract_atom("x")[:, 0])
    assert lmp.set_variable("s", "7") == 0 and lmp.extract_variable("s") == "7" and lmp.set_variable("e", "7") == -1
    assert lmp.eval("2^3") == 8.0 and lmp.expand("T is ${T}") == "T is 1.5"
    with pytest.raises(InputError, match="no fix"):
        lmp.extract_fix("nope", 0, 0)


@pytest.mark.parametrize("category, name, there", [
    ("pair", "lj/cut", True), ("pair", "lj/cut/opt", True), ("pair", "nope", False), ("pair", "hybrid/overlay", True),
    ("bond", "harmonic", True),
    ("fix", "nve", True), ("fix", "thermostat", False), ("fix", "nve/limit", True), ("fix", "nve_limit", False),
    ("compute", "temp", True), ("atom", "full", True),
    ("atom", "nope", False), ("region", "block", True), ("command", "run", True), ("command", "nope", False), ("minimize", "cg", True),
    ("minimize", "_state", False),
    ("dump", "custom", True), ("kspace", "pppm", True), ("integrate", "verlet", True), ("nope", "nope", False)])
def test_has_style(lmp, category, name, there):
    assert lmp.has_style(category, name) is there


def test_every_listed_style_exists(lmp):
    for category in ("pair", "bond", "angle", "dihedral", "improper", "fix", "compute", "dump", "region", "minimize", "atom", "command"):
        styles = lmp.available_styles(category)
        assert styles and all(lmp.has_style(category, s) for s in styles)


def test_ids(lmp):
    assert lmp.available_ids("fix") == ["1"] and lmp.has_id("compute", "pa") and not lmp.has_id("group", "x")


def test_errors_carry_the_command(lmp):
    with pytest.raises(InputError, match="line 1: pair_coeff 1 1 x 1"):
        lmp.command("pair_coeff 1 1 x 1")


def test_quit_ends_the_text_only(lmp):
    lmp.commands_string("quit\nnonsense")
    assert lmp.get_natoms() == 32
