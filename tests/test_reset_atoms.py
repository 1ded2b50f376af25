"""reset_atoms id, mol, image against LAMMPS."""
from __future__ import annotations

import pytest
from both import asemd, assert_same, lammps

from asemd.errors import InputError

BOX = """
units lj
dimension {2}
atom_style bond
region b block {0}
create_box 1 b bond/types 1 extra/bond/per/atom 4 extra/special/per/atom 10
create_atoms 1 random {1} 77 NULL
mass 1 1
comm_modify cutoff 12
pair_style zero 4
pair_coeff * *
bond_style zero
bond_coeff 1
special_bonds lj/coul 1 1 1
"""
SMALL = BOX.format("0 10 0 10 0 10", 60, 3)
BONDED = SMALL + "\n".join(f"create_bonds single/bond 1 {a} {b}" for a, b in ((3, 7), (7, 2), (10, 20), (20, 15), (15, 40))) + "\n"
IMAGES = BONDED + "".join(f"set atom {a} image {x} {y} NULL\n" for a, x, y in (
    (3, 1, -3), (7, 0, 1), (2, 2, 4), (10, 0, -1), (20, 3, 0), (15, 0, 0), (40, 1, 0), (5, 7, -8)))
MOLECULES = BONDED + "set group all mol 3\nset atom 30 mol 50\ngroup h id 1:15\n"
CASES = {
    "ids": SMALL + "group g id 3 17 40\ndelete_atoms group g\nreset_atoms id",
    "sorted": SMALL + "reset_atoms id sort yes",
    "sorted flat box": BOX.format("0 10 0 4 0 7", 500, 3) + "reset_atoms id sort yes",
    "sorted in 2d": BOX.format("0 10 0 4 -0.5 0.5", 300, 2) + "reset_atoms id sort yes",
    "older": SMALL + "group g id 3 17 40\ndelete_atoms group g\nreset_atom_ids",
    "older molecules": MOLECULES + "reset_mol_ids all",
    "images": IMAGES + "reset_atoms image all",
    "images of a group": IMAGES + "group h id 1:15\nreset_atoms image h",
    **{f"molecules {words}": MOLECULES + f"reset_atoms mol {words}" for words in (
        "all", "all offset 10", "all single yes", "all single yes offset 10", "h", "h offset 0", "h offset 5 single yes", "h compress no",
        "h compress no single yes", "all compress no offset 7")},
}


@pytest.fixture(scope="module")
def theirs():
    return lammps(CASES)


@pytest.mark.filterwarnings("ignore::asemd.errors.InputWarning")
@pytest.mark.parametrize("name", CASES)
def test_same_atoms_as_lammps(theirs, name):
    assert_same(asemd(CASES[name]), theirs[name])


def test_long_chain():
    """A ring of atoms whose ids jump is one molecule."""
    from asemd.topology import Topology
    session = asemd(BOX.format("0 10 0 10 0 10", 1000, 3))
    session.scene.system.topology = Topology(bonds=[((i * 7) % 999, ((i + 1) * 7) % 999) for i in range(999)])
    session.execute("reset_atoms mol all single yes")
    assert session.scene.system.molecule[:999].tolist() == [1] * 999 and session.scene.system.molecule[999] == 2
    assert "number of new molecule IDs = 2" in "".join(session.told)


@pytest.mark.parametrize("line, message", [
    ("reset_atoms foo", "unknown property"), ("reset_atoms", "1 value"), ("reset_atoms mol", "1 value"),
    ("reset_atoms mol non", "unknown group"),
    ("reset_atoms mol all foo yes", "unknown keyword"), ("reset_atoms mol all single", "1 value"),
    ("reset_atoms mol all offset -2", "negative"),
    ("reset_atoms id sort", "1 value"), ("reset_atoms id sorted yes", "unknown keyword"), ("reset_atoms image", "1 value"),
    ("reset_atoms image all x", "no more words"),
])
def test_mistakes(line, message):
    with pytest.raises(InputError, match=message):
        asemd(SMALL).execute(line)
    with pytest.raises(InputError, match="no molecules"):
        asemd(SMALL.replace("atom_style bond", "").replace(" bond/types 1 extra/bond/per/atom 4 extra/special/per/atom 10", "").replace(
            "bond_style zero\nbond_coeff 1", "")).execute("reset_atoms mol all")
