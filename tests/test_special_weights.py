"""lj/smooth/linear and lj/sf: LAMMPS has two energies of special pairs, and forces that belong to one of them."""
from __future__ import annotations

import numpy as np
import pytest
from bead_chain import chain
from wheel import ask, ran

WEIGHTS = {"partly": "0.3 0.2 0.5", "excluded": "1e-50 1e-50 0.5"}
STYLES = ("lj/smooth/linear", "lj/sf")
ASK = """
answer = {}
for name, lines in given["cases"].items():
    lmp = ran(lines)
    answer[name] = [lmp.extract_variable(v) for v in "sge"], [list(lmp.gather_atoms(key, 1, 3)) for key in "xf"]
    lmp.close()
"""


def script(style: str, weights: str) -> str:
    return chain() + (f"special_bonds lj {weights} coul 1 1 1\npair_style {style} 6\npair_coeff * * 0.1 2.5\n"
                      "compute l all pair/local eng\ncompute s all reduce sum c_l inputs local\ncompute g all group/group all\n"
                      "variable s equal c_s\nvariable g equal c_g\nvariable e equal evdwl\nthermo_style custom evdwl c_s c_g\nrun 20")


@pytest.fixture(scope="module")
def theirs():
    return ask(ASK, cases={f"{style} {name}": script(style, w) for style in STYLES for name, w in WEIGHTS.items()})


@pytest.mark.parametrize("name", WEIGHTS)
@pytest.mark.parametrize("style", STYLES)
def test_the_energy_is_that_of_single_pairs_and_of_the_forces(style, name, theirs):
    (pairs, groups, added), atoms = theirs[f"{style} {name}"]
    lmp = ran(script(style, WEIGHTS[name]))
    assert [lmp.extract_variable(v) for v in "sge"] == pytest.approx([pairs, groups, pairs], rel=1e-11)
    assert abs(added) > 2 * abs(pairs)             # what LAMMPS adds up is another number
    for key, values in zip("xf", atoms, strict=True):
        assert np.array(lmp.gather_atoms(key, 1, 3)) == pytest.approx(np.array(values), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("name", WEIGHTS)
def test_lammps_numbers_of_each(name, theirs):
    lmp = ran(script("lj/sf", WEIGHTS[name]), "-compat", "lammps")
    assert [lmp.extract_variable(v) for v in "sge"] == pytest.approx(theirs[f"lj/sf {name}"][0], rel=1e-11)
