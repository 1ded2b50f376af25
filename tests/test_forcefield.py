"""Interactions: styles, coefficients, hybrids, modifiers, completeness, and writing them back."""
from __future__ import annotations

import copy
import importlib
import pickle
from contextlib import nullcontext
from types import SimpleNamespace

import numpy as np
import pytest
from test_pair_styles import ask_lammps

from asemd import units
from asemd.box import Box
from asemd.errors import InputError, InputWarning
from asemd.forcefield import CATEGORIES, Interactions
from asemd.system import System
from asemd.topology import Topology


def system(ntypes=3, q=True, topology=None, n=6, dimension=3, labels=None):
    types = np.arange(n, dtype=np.int32) % ntypes + 1
    counts = {"ntypes": ntypes, "nbondtypes": 2, "nangletypes": 2, "ndihedraltypes": 1, "nimpropertypes": 0}
    return System(box=Box.from_lammps((0, 0, 0), (10, 11, 12)), x=np.arange(3.0 * n).reshape(n, 3) % 10, type=types, counts=counts,
                  q=np.ones(n) if q else None, topology=topology or Topology(), labels=labels or {}, dimension=dimension, units="lj")


def made(style="lj/cut 2.5", *coeffs, category="pair", where=None, **options):
    out = Interactions(**options)
    out.set_style(category, style.split())
    for line in coeffs:
        out.set_coeff(category, line.split(), where or system())
    return out


def terms(interactions, ntypes=3):
    return {t.label: t for t in interactions.pair_terms(ntypes, units.get("lj"))}


# ----------------------------------------------------------------------------- styles ---

def test_same_pair_style_again_keeps_coefficients_and_resets_cutoffs():
    i = made("lj/cut 2.5", "* * 1 1 1.1")
    i.modify_pair(["shift", "yes"])
    i.set_style("pair", ["lj/cut", "3.0"])
    assert i.shift and i.uses["pair"][0].coeff[1, 2] == {"epsilon": 1.0, "sigma": 1.0} and i.cutoff(3, None) == 3.0
    i.set_style("pair", ["lj96/cut", "3.0"])
    assert not i.shift and not i.uses["pair"][0].coeff
    i = made("harmonic", "1 2.0 1.0", category="bond")
    i.set_style("bond", ["harmonic"])
    assert i.bond.coeff == {}


def test_none_and_names():
    i = made()
    assert i.style_name("pair") == "lj/cut" and i.style_name("bond") == "none" and i.bond is None and i.pair is i.uses["pair"][0]
    i.set_style("pair", ["none"])
    assert i.pair is None and i.pair_terms(3, None) == [] and i.cutoff(3, None) == 0.0
    with pytest.raises(InputError, match="takes no arguments"):
        i.set_style("pair", ["none", "3"])
    for words, message in (([], "needs the name"), (["lj/cutt", "2"], "did you mean lj/cut"), (["hybrid"], "sub-styles"),
                           (["hybrid", "3.0"], "unknown pair style '3.0'"), (["hybrid", "lj/cut", "2", "hybrid", "morse"], "cannot have"),
                           (["hybrid", "lj/cut", "2", "none"], "cannot have none"),
                           (["hybrid", "lj/cut", "2", "lj96/cutt", "3"], "unknown pair style 'lj96/cutt'.*did you mean lj96/cut"),
                           (["hybrid", "lj/cut", "2", "zero", "3", "full", "lj/cut"], "lj/cut needs cut")):
        with pytest.raises(InputError, match=message):
            i.set_style("pair", words)
    with pytest.raises(InputError, match="twice"):
        i.set_style("bond", ["hybrid", "harmonic", "harmonic"])


def test_accelerated_names_are_plain_ones():
    i = made("hybrid lj/cut/opt 2.5 morse/omp 2.0", "1 1 lj/cut/opt 1 1", "1 2 morse 1 1 1")
    assert [u.label for u in i.uses["pair"]] == ["lj/cut", "morse"] and i.uses["pair"][1].coeff.keys() == {(1, 2)}


# ------------------------------------------------------------------------- coefficients ---

def test_ranges():
    i = made("lj/cut 2.5", "* * 1 1", "2* *2 2 1", "3 1 4 1")
    e = {k: c["epsilon"] for k, c in i.pair.coeff.items()}
    assert e == {(1, 1): 1, (1, 2): 1, (1, 3): 4, (2, 2): 2, (2, 3): 1, (3, 3): 1}
    i = made("harmonic", "* 1 1", "2* 3 1", category="bond")
    assert {t: c["K"] for t, c in i.bond.coeff.items()} == {1: 1, 2: 3}


@pytest.mark.parametrize("category, style, line, message", [
    ("bond", "harmonic", "3 1 1", "bond_coeff: bond type: 3 is outside the valid range 1 to 2"),
    ("bond", "harmonic", "x 1 1", "bond type.*'x'"), ("bond", "harmonic", "1 1", "bond_coeff harmonic needs K r0, got 1"),
    ("bond", "harmonic", "", "needs a bond type"), ("improper", "harmonic", "1 1 1", "no improper types"),
    ("pair", "lj/cut 2.5", "1", "two atom types"), ("pair", "lj/cut 2.5", "1 4 1 1", "atom type: 4"),
    ("pair", "lj/cut 2.5", "3* *2 1 1", "no pair of types"), ("pair", "lj/cut 2.5", "1 1 1 1 -2", "cutoff cut must not be negative"),
    ("pair", "lj/cut 2.5", "1 1 1 one", "sigma must be a number"),
    ("pair", "hybrid lj/cut 2.5", "1 1", "needs the name of a sub-style"),
    ("pair", "hybrid lj/cut 2.5", "1 1 lj/cut", "needs epsilon sigma"),
    ("pair", "hybrid lj/cut 2.5", "1 1 lj/cutt 1 1", "expected a sub-style.*did you mean lj/cut"),
    ("pair", "hybrid lj/cut 2.5", "1 1 none 1", "none takes no coefficients"),
    ("pair", "hybrid lj/cut 2.5", "1 1 skip", "expected a sub-style"),
    ("pair", "hybrid lj/cut 2.5 lj/cut 3", "1 1 lj/cut 1 1", "needs epsilon sigma"),
    ("pair", "hybrid lj/cut 2.5 lj/cut 3", "1 1 lj/cut 3 1 1", "number from 1 to 2"),
    ("bond", "hybrid harmonic", "1 skip", "expected a sub-style"),
])
def test_wrong_lines(category, style, line, message):
    with pytest.raises(InputError, match=message):
        made(style, line, category=category)


def test_before_style():
    with pytest.raises(InputError, match="bond_coeff command before bond_style is defined"):
        Interactions().set_coeff("bond", ["1", "1", "1"], system())


def test_labels():
    s = system(labels={"atom": {1: "C", 2: "H", 3: "O"}, "bond": {2: "C-H"}})
    i = made("lj/cut 2.5", "O C 1 1", where=s)
    assert list(i.pair.coeff) == [(1, 3)]
    i = made("harmonic", "C-H 3 1", category="bond", where=s)
    assert list(i.bond.coeff) == [2]
    with pytest.raises(InputError, match="did you mean C-H"):
        i.set_coeff("bond", ["C-N", "3", "1"], s)


# ------------------------------------------------------------------------------- hybrid ---

def test_hybrid_assigns_each_pair_to_one_style():
    i = made("hybrid lj/cut 2.5 lj/cut 3.0 coul/cut 4.0",
             "* * lj/cut 1 1 1", "2 2 lj/cut 2 2 1", "1 3 coul/cut", "2 3 none", "1 2 lj/cut 2 5 1")
    t = terms(i)
    assert t["lj/cut 1"].filled.keys() == {(1, 1), (3, 3)} and t["lj/cut 2"].filled.keys() == {(2, 2), (1, 2)}
    assert t["coul/cut"].filled.keys() == {(1, 3)} and t["lj/cut 2"].filled[1, 2]["epsilon"] == 5 and i.none["pair"] == {(2, 3)}
    assert t["lj/cut 1"].tables.rows[0, 2, 2] == 0.0
    i.set_coeff("pair", ["2", "3", "coul/cut"], system())
    assert terms(i)["coul/cut"].filled.keys() == {(1, 3), (2, 3)} and not i.none["pair"]


def test_hybrid_mixes_within_one_sub_style_only():
    t = terms(made("hybrid lj/cut 2.5 lj96/cut 3.0", "1 1 lj/cut 1 1", "2 2 lj/cut 4 1", "3 3 lj96/cut 1 1", "1*2 3 none"))
    assert t["lj/cut"].filled[1, 2]["epsilon"] == 2.0
    i = made("hybrid lj/cut 2.5 lj96/cut 3.0", "1 1 lj/cut 1 1", "2 2 lj/cut 4 1", "3 3 lj96/cut 1 1")
    with pytest.raises(InputError, match="type pairs 1 3, 2 3 is missing"):
        i.pair_terms(3, None)


def test_overlay_adds_and_none_wipes():
    i = made("hybrid/overlay lj/cut 2.5 coul/cut 4.0",
             "* * lj/cut 1 1", "* * coul/cut", "1 2 none", "1 3 none", "1 3 coul/cut", "2 2 lj/cut 3 1")
    t = terms(i)
    assert t["lj/cut"].filled.keys() == {(1, 1), (2, 2), (2, 3), (3, 3)}
    assert t["coul/cut"].filled.keys() == {(1, 1), (1, 3), (2, 2), (2, 3), (3, 3)} and t["lj/cut"].filled[2, 2]["epsilon"] == 3
    i = made("hybrid/overlay lj/cut 2.5 coul/cut 4.0", "1 1 lj/cut 1 1", "1 1 coul/cut", "2 2 lj/cut 1 1", "2 2 coul/cut", where=system(2))
    with pytest.raises(InputError, match="1 2 is missing"):       # two sub-styles: not mixed
        i.pair_terms(2, None)


def test_hybrid_bonded():
    i = made("hybrid harmonic morse", "1 harmonic 1 1", "2 morse 1 1 1", "1 morse 2 1 1", category="bond")
    assert [sorted(u.coeff) for u in i.uses["bond"]] == [[], [1, 2]]
    with pytest.raises(InputError, match="sub-style harmonic is not used"):
        i.check_complete(system())
    i = made("hybrid harmonic charmm", "1 harmonic 1 90", "2 skip", "2 charmm 1 90 1 1", category="angle")
    assert [sorted(u.coeff) for u in i.uses["angle"]] == [[1], [2]]


# ----------------------------------------------------------------------------- modifiers ---

def test_pair_modify():
    i = made("hybrid lj/cut 2.5 lj96/cut 2.5", "* * lj/cut 1 1", "2 2 lj96/cut 1 1")
    i.modify_pair("mix arithmetic shift yes tail no table 12 tabinner 1.5 nofdotr neigh/trim no compute on".split())
    assert (i.mix, i.shift, i.tail, i.compute, i.table) == ("arithmetic", True, False, True, {"table": 12, "tabinner": 1.5})
    i.modify_pair("pair lj96/cut shift no".split())
    t = terms(i)
    assert t["lj/cut"].tables.rows[1, 1, 1] != 0.0 and t["lj96/cut"].tables.rows[1, 2, 2] == 0.0
    i.modify_pair(["shift", "yes"])       # for all again
    assert terms(i)["lj96/cut"].tables.rows[1, 2, 2] != 0.0
    i.modify_pair("pair lj/cut compute no".split())
    assert list(terms(i)) == ["lj96/cut"]
    i.modify_pair(["compute", "no"])
    assert terms(i) == {}


@pytest.mark.parametrize("words, message", [
    ("", "needs a keyword"), ("foo 1", "unknown pair_modify keyword 'foo'"), ("shfit yes", "did you mean shift"),
    ("shift", "needs 1 value"),
    ("shift maybe", "yes or no"), ("mix cubic", "expected one of geometric"), ("table x", "whole number"), ("table -1", "negative"),
    ("pair lj/cut shift yes", "hybrid"), ("special lj 0 0 0", "must stand first"),
])
def test_wrong_pair_modify(words, message):
    with pytest.raises(InputError, match=message):
        made().modify_pair(words.split())


@pytest.mark.parametrize("words, lj, coul", [
    ("amber", (0, 0, 0.5), (0, 0, 5 / 6)), ("charmm", (0, 0, 0), (0, 0, 0)), ("dreiding", (0, 0, 1), (0, 0, 1)),
    ("fene", (0, 1, 1), (0, 1, 1)), ("lj/coul 0 0.5 1", (0, 0.5, 1), (0, 0.5, 1)), ("lj 0.1 0.2 0.3", (0.1, 0.2, 0.3), (0, 0, 0)),
    ("coul 0.1 0.2 0.3", (0, 0, 0), (0.1, 0.2, 0.3)),
    ("fene lj 0 0 0.5", (0, 0, 0.5), (0, 1, 1)), ("lj 0 0 1 coul 0 0 0.5 extra 4", (0, 0, 1), (0, 0, 0.5)),
])
def test_special_bonds(words, lj, coul):
    i = Interactions(special_lj=(1, 1, 1), special_angle=True)
    i.set_special(words.split())
    assert (i.special_lj, i.special_coul, i.special_angle) == (lj, coul, False)


def test_special_bonds_angle_and_dihedral():
    i = Interactions()
    i.set_special("fene one/five no angle yes dihedral on".split())
    assert i.special_angle and i.special_dihedral
    top = Topology(bonds=[[0, 1], [1, 2], [2, 3]], angles=[[0, 1, 2]])
    pairs, kinds = i.special_pairs(system(topology=top))
    assert [(*p, k) for p, k in zip(pairs.tolist(), kinds.tolist(), strict=True)] == [(0, 1, 1), (0, 2, 2), (1, 2, 1), (2, 3, 1)]
    for words in ("", "foo", "lj 0 0", "lj 0 0 2", "lj 0 0 x", "angle", "angle maybe", "one/five yes", "one/five", "hybrid x"):
        with pytest.raises(InputError, match="special_bonds"):
            i.set_special(words.split())


# -------------------------------------------------------------------------- completeness ---

def test_check_complete():
    chain = Topology(bonds=[[0, 1], [1, 2]], bond_types=[1, 2], dihedrals=[[0, 1, 2, 3]], dihedral_types=[1])
    s = system(topology=chain)
    i = made("harmonic", "1 1 1", category="bond")
    with pytest.raises(InputError, match="All bond coeffs are not set: bond_coeff for bond type 2 is missing"):
        i.check_complete(s)
    i.set_coeff("bond", ["2", "1", "1"], s)
    i.check_complete(s)
    i.set_style("pair", ["lj/cut", "2.5"])
    i.set_coeff("pair", "1 1 1 1".split(), s)
    with pytest.raises(InputError, match="All pair coeffs are not set: pair_coeff for type pairs 1 2, 1 3, 2 2, 2 3, 3 3 is missing"):
        i.check_complete(s)
    i.set_coeff("pair", "* * 1 1".split(), s)
    i.check_complete(s)
    i.set_style("dihedral", ["charmm"])
    i.set_coeff("dihedral", "1 1 2 180 0.5".split(), s)
    with pytest.raises(InputError, match="needs a pair style with 1-4 coefficients"):
        i.check_complete(s)
    i.set_coeff("dihedral", "1 1 2 180 0.0".split(), s)
    i.check_complete(s)
    i.modify_pair("shift yes tail yes".split())
    with pytest.raises(InputError, match="shift and tail"):
        i.check_complete(s)
    i.modify_pair("shift no".split())
    with pytest.raises(InputError, match="two dimensions"):
        i.check_complete(system(topology=chain, dimension=2))


def test_charges_are_needed():
    for style, coeff in (("coul/cut 3", "* *"), ("lj/cut/coul/cut 3", "* * 1 1"), ("lj/charmm/coul/charmm 2 3", "* * 1 1"),
                         ("lepton/coul 3", "* * qi*qj/r")):
        i = made(style, coeff)
        i.check_complete(system())
        with pytest.raises(InputError, match=f"pair style {style.split()[0]} needs atom attribute q: use atom_style charge or full"):
            i.check_complete(system(q=False))


def test_tail_where_there_is_none_warns():
    i = made("morse 2.5", "* * 1 1 1")
    i.modify_pair(["tail", "yes"])
    with pytest.warns(InputWarning, match="no effect on pair style morse"):
        i.check_complete(system())


# ------------------------------------------------------------------------------- engines ---

def test_terms_follow_modifiers_and_compat():
    i = made("lj/charmm/coul/charmm 2 3", "1 1 1 1", "2 2 4 2", "3 3 1 1")
    assert terms(i)["lj/charmm/coul/charmm"].filled[1, 2]["sigma"] == 1.5      # arithmetic is this style's own rule
    i.modify_pair(["mix", "geometric"])
    t = terms(i)["lj/charmm/coul/charmm"]
    assert t.filled[1, 2]["sigma"] == 2**0.5 and t.style is i.pair.style
    i.compat = "lammps"
    assert terms(i)["lj/charmm/coul/charmm"].style is i.pair.style.twin


def test_tail_counts_pairs():
    s = system()
    i = made("lj/cut 2.5", "* * 1 1", "1 2 3 1.5 2.0")
    assert i.tail_correction(s, units.get("lj")) == (0.0, 0.0)
    i.modify_pair(["tail", "yes"])
    style, v = i.pair.style, s.box.volume
    one, other = style.tail({"epsilon": 1.0, "sigma": 1.0}, 2.5), style.tail({"epsilon": 3.0, "sigma": 1.5}, 2.0)
    want = [(4 * 7 * a + 8 * b) for a, b in zip(one, other, strict=True)]       # two atoms of each of three types
    assert i.tail_correction(s, units.get("lj")) == pytest.approx((want[0] / v, want[1] / v**2), rel=1e-14)
    assert i.tail_correction(s, units.get("real"))[1] == pytest.approx(want[1] / v**2 * units.get("real").nktv2p, rel=1e-14)


# --------------------------------------------------------------------------- written back ---

@pytest.mark.parametrize("style, coeffs", [
    ("lj/cut 2.5", ["* * 0.1 1", "1 2 1 1 3.0"]), ("zero 3.0 nocoeff", ["* *"]), ("lj/charmm/coul/charmm 2 3 1 4", ["1*3 1*3 1 1 2 2"]),
    ("hybrid lj/cut 2.5 lj/cut 3.0 morse 1.0", ["* * lj/cut 1 1 1", "1 2 lj/cut 2 1 1", "2 3 morse 1 1 1", "1 3 none"]),
    ("hybrid/overlay lj/cut 2.5 coul/cut 3.0", ["* * lj/cut 1 1", "* * coul/cut", "1 2 none", "1 3 coul/cut 2.5"]),
])
def test_round_trip(style, coeffs):
    s = system()
    i = made(style, *coeffs)
    i.set_style("bond", ["hybrid", "harmonic", "morse"])
    i.set_coeff("bond", "1 harmonic 1 1.5".split(), s)
    i.set_coeff("bond", "2 morse 1 1 0.1".split(), s)
    i.set_special("lj 0 0.1 0.3 coul 0 0 0.8333333333333334 angle yes".split())
    i.modify_pair("shift yes mix sixthpower table 10".split())
    again = Interactions()
    for category in CATEGORIES:
        again.set_style(category, i.style_line(category))
        for line in i.coeff_lines(category):
            again.set_coeff(category, line, s)
    again.set_special(i.special_line())
    for line in i.modify_lines():
        again.modify_pair(line)
    assert again == i
    assert pickle.loads(pickle.dumps(i)) == i and copy.deepcopy(i) == i
    other = copy.deepcopy(i)
    other.set_coeff("bond", "1 harmonic 9 9".split(), s)
    assert other != i and other.uses["bond"][0].style is i.uses["bond"][0].style


def test_build():
    i = Interactions.build(bond={"harmonic": {1: (5.0, 1.1), 2: {"K": 3, "r0": 1.0}}}, pair={"lj/cut 10.0": {(1, 1): (0.01, 3.4)}},
                           angle={"harmonic": {1: "2.0 109.5"}}, special_bonds="amber", mix="arithmetic", shift=True)
    assert i.bond.coeff == {1: {"K": 5.0, "r0": 1.1}, 2: {"K": 3.0, "r0": 1.0}} and i.angle.coeff[1] == {"K": 2.0, "theta0": 109.5}
    assert i.pair.settings == {"cut": 10.0} and i.special_lj == (0, 0, 0.5) and i.mix == "arithmetic" and i.shift
    same = Interactions.build(pair={"lj/cut": {"settings": (10.0,), "coeff": {("C", "C"): (0.01, 3.4)}}}, labels={"atom": {1: "C"}},
                              special_bonds={"lj": (0, 0, 0.5), "coul": (0, 0, 0.8), "angle": True})
    assert same.pair == i.pair and same.special_coul == (0, 0, 0.8) and same.special_angle
    apart = Interactions.build(pair={"lj/cut 10.0": {(1, 1): (1, 1), (2, 2): (1, 1)}, "morse 5.0": {(2, 1): (1, 1, 1)}})
    assert apart.hybrid["pair"] == "hybrid" and apart.uses["pair"][1].coeff.keys() == {(1, 2)}
    both = Interactions.build(pair={"lj/cut 10.0": {(1, 1): (1, 1)}, "coul/cut 8.0": {(1, 1): ()}})
    assert both.hybrid["pair"] == "hybrid/overlay" and len(both.pair_terms(1, units.get("real"))) == 2
    twice = Interactions.build(pair={"lj/cut 10.0": {1: (1, 1)}, "lj/cut 8.0": {2: (1, 1), (1, 2): (np.float64(2), 1)}})
    assert [u.label for u in twice.uses["pair"]] == ["lj/cut 1", "lj/cut 2"] and twice.cutoff(2, units.get("real")) == 10.0


@pytest.mark.parametrize("given, message", [
    (dict(bond={"harmonc": {1: (1, 1)}}), "did you mean harmonic"), (dict(bond={"harmonic": {1: (1,)}}), "needs K r0"),
    (dict(bond={"harmonic": {0: (1, 1)}}), "whole numbers from 1"), (dict(bond={"harmonic": {"A": (1, 1)}}), "unknown bond type label 'A'"),
    (dict(bond="harmonic"), "needs a mapping from style"), (dict(bond={"harmonic": (1, 2)}), "mapping from type to values"),
    (dict(angle={"class2": {1: {"theta0": 109}}}), "class2 needs theta0 K2 K3 K4, got 1 value$"),
    (dict(angle={"class2": {1: dict(theta0=9, K2=1, K3=2, K4=3, M=1)}}), "class2 bb needs M bb_r1 bb_r2, got 1 value$"),
    (dict(bond={"harmonic": {1: {"K": 1, "r": 1}}}), "no coefficient 'r'"), (dict(bond={"harmonic": {1: {"r0": 1}}}), "in order"),
    (dict(pair={"lj/cut": {(1, 1): (1, 1)}}), "needs cut"), (dict(pair={"lj/cut 3": {(1, 1, 1): (1, 1)}}), "pair of atom types"),
    (dict(mix="foo"), "expected one of"), (dict(special_bonds="foo"), "unknown special_bonds keyword"),
])
def test_wrong_build(given, message):
    with pytest.raises(InputError, match=message):
        Interactions.build(**given)


# ------------------------------------------------------------------------------ commands ---

def command(name, text, scene):
    session = SimpleNamespace(scene=scene, passive=True, passing_warnings=nullcontext, variables=SimpleNamespace(value=None), loop=None)
    importlib.import_module(f"asemd.lammps.command.{name}").run(session, text.split())


def test_commands():
    scene = SimpleNamespace(interactions=Interactions(), system=system(), boundary=("pp", "pp", "fs"), need_system=lambda name: system())
    for name, text in (("pair_style", "lj/cut 2.5"), ("pair_coeff", "* * 1 1"), ("pair_modify", "shift yes"), ("special_bonds", "fene"),
                       ("bond_style", "harmonic"), ("bond_coeff", "1 1 1"), ("angle_style", "harmonic"), ("angle_coeff", "2 1 90"),
                       ("dihedral_style", "harmonic"), ("dihedral_coeff", "1 1 1 2"), ("improper_style", "none"), ("dielectric", "2.0"),
                       ("kspace_style", "none")):
        command(name, text, scene)
    i = scene.interactions
    assert i.shift and i.dielectric == 2.0 and i.special_lj == (0, 1, 1) and i.bond.coeff[1]["K"] == 1.0 and i.angle.coeff.keys() == {2}
    scene.system = None
    for name, text, message in (("kspace_style", "pppm", "needs one number"), ("kspace_style", "pppm x", "accuracy"),
                                ("kspace_style", "pppn", "did you mean pppm"), ("kspace_style", "", "name"),
                                ("kspace_modify", "order 5", "before a kspace_style"), ("kspace_modify", "ordr 5", "did you mean order"),
                                ("dielectric", "0", "must not be 0"), ("dielectric", "x", "number"), ("dielectric", "", "one value"),
                                ("improper_coeff", "1 1 1", "before improper_style")):
        with pytest.raises(InputError, match=message):
            command(name, text, scene)


# -------------------------------------------------------------------------------- LAMMPS ---

def test_hybrids_against_lammps(tmp_path):
    """Which style a pair gets, and what it is then."""
    cases = [("hybrid lj/cut 9.0", ["1 1 lj/cut 0.1 3.0", "2 2 lj/cut 0.2 2.0"]),
             ("hybrid lj/cut 9.0 coul/cut 8.0", ["* * lj/cut 0.1 3.0", "1 2 coul/cut"]),
             ("hybrid/overlay lj/cut 9.0 coul/cut 8.0", ["* * lj/cut 0.1 3.0", "1 2 coul/cut"]),
             ("hybrid/overlay lj/cut 9.0 coul/cut 8.0", ["* * lj/cut 0.1 3.0", "* * coul/cut 7.0", "1 2 none", "1 2 coul/cut"]),
             ("hybrid lj/cut 9.0 lj/cut 7.0", ["1 1 lj/cut 1 0.1 3.0", "2 2 lj/cut 2 0.1 3.0", "1 2 lj/cut 2 0.3 2.0"])]
    modify = ["pair_modify mix sixthpower shift yes"]
    distances = [1.9, 2.7, 6.5, 7.5, 8.5, 9.5]
    jobs = [([f"pair_style {style}", *modify, *(f"pair_coeff {c}" for c in coeffs)], distances) for style, coeffs in cases]
    for (style, coeffs), got in zip(cases, ask_lammps(jobs, tmp_path), strict=True):
        i = made(style, *coeffs, where=system(2))
        i.modify_pair(modify[0].split()[1:])
        for k, r in enumerate(got["r"]):
            energy = 0.0
            for term in i.pair_terms(2, units.get("real")):
                row = 0
                for part in term.style.parts:
                    cut2, offset, *values = term.tables.rows[row:row + 2 + len(part.rows), 1, 2]
                    row += 2 + len(part.rows)
                    if r * r < cut2:
                        energy += part.function(r * r, *[got["qqr2e"] * 0.7 * -1.3] * part.charged, *values)[0] - offset
            assert energy == pytest.approx(got["e"][k], rel=1e-12, abs=1e-14), (style, r)
