"""Random numbers are drawn in LAMMPS's order of atoms: that of the file, sorted into bins at the start of a run."""
from __future__ import annotations

import numpy as np
import pytest
from wheel import ask, ran

RUN = """
import os
os.chdir(given["folder"])
lmp = ran(given["lines"])
n = lmp.extract_setting("nlocal")
answer = {"ids": np.array(lmp.numpy.extract_atom("id"))[:n], "v": by_id(lmp, "v"), "energy": lmp.extract_fix("b", 0, 0)}
"""


@pytest.mark.parametrize("sort", ["", "atom_modify sort 0 0", "atom_modify sort 3 2.5"])
def test_a_bath_of_atoms_in_any_order(tmp_path, monkeypatch, sort):
    monkeypatch.chdir(tmp_path)
    rng = np.random.default_rng(11)
    ids, x = rng.permutation(60) + 1, rng.random((60, 3)) * 12.0
    atoms = [f"{i} 1 {' '.join(repr(float(c)) for c in row)}" for i, row in zip(ids, x)]
    (tmp_path / "data.mixed").write_text("\n".join(["mixed", "", "60 atoms", "1 atom types", "0 12 xlo xhi", "0 12 ylo yhi", "0 12 zlo zhi",
                                                   "", "Masses", "", "1 2.0", "", "Atoms # atomic", "", *atoms, ""]))
    script = f"""units lj
{sort}
read_data data.mixed
pair_style zero 3.0
pair_coeff * *
velocity all create 1.0 4711 loop all
fix a all nve
fix b all temp/csld 1.0 2.0 0.5 777
run 5
run 2
"""
    theirs = ask(RUN, folder=str(tmp_path), lines=script)
    lmp = ran(script)
    bath = lmp.session.scene.fixes["b"]
    np.testing.assert_array_equal(lmp.session.scene.system.id[np.argsort(bath.storage.place)], theirs["ids"])
    np.testing.assert_allclose(lmp.session.scene.system.v, theirs["v"], rtol=1e-10, atol=1e-12)
    assert bath.scalar() == pytest.approx(theirs["energy"], rel=1e-10)
