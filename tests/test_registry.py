"""Styles are found by their LAMMPS names, and what is not there is said in one line."""
from __future__ import annotations

import subprocess
import sys

import pytest

import asemd.compute
import asemd.fix
from asemd import registry
from asemd.errors import InputError


@pytest.mark.parametrize("category, name, module", [
    ("pair", "lj/cut/coul/long", "asemd.pair.lj_cut_coul_long"), ("bond", "harmonic/shift/cut", "asemd.bond.harmonic_shift_cut"),
    ("fix", "efield/tip4p", "asemd.fix.efield_tip4p"), ("improper", "inversion/harmonic", "asemd.improper.inversion_harmonic"),
])
def test_path_follows_from_the_name(category, name, module):
    assert registry.module_of(category, name) == module


@pytest.mark.parametrize("category", ["bond", "angle", "dihedral", "improper", "pair"])
def test_every_style_is_in_the_file_of_its_name(category):
    for name in registry.names(category):
        style = registry.find(category, name)
        assert (style.category, style.name) == (category, name)
        assert registry.exists(category, name)
        assert sys.modules[registry.module_of(category, name)]


@pytest.mark.parametrize("package, base", [(asemd.fix, asemd.fix.Fix), (asemd.compute, asemd.compute.Compute)])
def test_every_class_goes_by_both_names(package, base):
    names = registry.class_names(package.__name__.removeprefix("asemd."), base)
    assert len(names) == len(set(names)) > 50
    for name in names:
        found = package.find(name)
        assert found.style == name and getattr(package, found.__name__) is found
        assert found.__name__.lower() == name.replace("/", "").replace("_", "")


@pytest.mark.parametrize("suffix", registry.ACCELERATED)
def test_accelerated_names_are_those_of_the_style(suffix):
    assert registry.find("pair", "lj/cut" + suffix) is registry.find("pair", "lj/cut")
    assert asemd.fix.find("nvt" + suffix) is asemd.fix.find("nvt")


@pytest.mark.parametrize("search, message", [
    (lambda: registry.find("bond", "harmonc"), "unknown bond style 'harmonc'.*did you mean harmonic"),
    (lambda: registry.find("pair", "../cli"), "unknown pair style"), (lambda: registry.find("pair", ""), "unknown pair style"),
    (lambda: registry.find("bond", "oxdna/fene"), "finite size"), (lambda: registry.find("angle", "mwlc"), "not supported yet: run"),
    (lambda: asemd.fix.find("efeld"), "unknown fix style 'efeld'.*did you mean efield"), (lambda: asemd.fix.find("forcing"), "unknown fix"),
    (lambda: registry.find("pair", "agni"), "pair style agni of LAMMPS is not supported yet: run"),
    (lambda: registry.find("pair", "meam/c"), "pair style meam/c has another name in LAMMPS now: use meam"),
    (lambda: asemd.fix.find("ttm/mod"), "fix style ttm/mod of LAMMPS is not supported yet: run"),
])
def test_what_is_not_there(search, message):
    with pytest.raises(InputError, match=message) as error:
        search()
    assert "\n" not in str(error.value)


def test_names_of_no_class():
    for name in ("EFeld", "Forcing", "_hidden"):
        with pytest.raises(AttributeError):
            getattr(asemd.fix, name)
    assert not registry.exists("pair", "lj/cut/nothing") and not registry.exists("pair", "0")


def test_one_style_is_one_file():
    """Asking for a style imports its file and no other one of its kind that it does not use."""
    code = "import sys; from asemd.style import find; find('bond', 'harmonic'); " \
           "print([m for m in sys.modules if m.startswith('asemd.bond.') or m.startswith('asemd.pair.')])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "['asemd.bond.harmonic']"
