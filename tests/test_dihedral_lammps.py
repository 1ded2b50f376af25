"""Dihedral styles in whole scenes against LAMMPS: lists of coefficients, cross terms and their data files, hybrids, 1-4 pairs."""
from __future__ import annotations

import numpy as np
import pytest
from wheel import ask, ran, start

from asemd.errors import InputError

CLASS2 = ["75.0 169 45.0 10 24.0 40.0", "mbt 75 42 31 5.2", "ebt 75 42 31 65 42 -31 1.4 1.5", "at 75 42 31 75 -42 31 120 50",
          "aat 75 120 160", "bb13 75 1.4 1.3"]
HYBRID = [f"1 class2 {line}" for line in CLASS2] + ["2 harmonic 2 1 3"] + [f"3 class2 {line}" for line in reversed(CLASS2)]
LISTS = {
    "class2": [f"* {line}" for line in CLASS2],
    "hybrid harmonic class2": HYBRID,
    "fourier": ["1 3 -0.8462 3 0.0 7.5788 1 0 0.138 2 -180.0", "2 1 2 12 33.3", "3 2 1 0 10 3 6 90"],
    "nharmonic": ["1 3 1 2 3", "2 1 4", "3 8 1 2 3 4 5 6 7 8"],
    "spherical": ["1 1 286.1 1 124 1 1 90.0 0 1 90.0 0", "2 2 69.3 1 93.9 1 1 90 0 1 90 0 49.1 0 0 0 1 74.4 1 0 0 0",
                  "3 1 3 1.5 20 -0.8 2 30 0.3 0.5 40 2"],
    "quadratic": ["1 10 540", "2 10 -170", "3 10 180"], "helix": ["* 10 54 30"],
    "cosine/shift/exp": ["1 10 45 -3", "2 10 45 0.0005", "3 10 180 12"],
    "cosine/squared/restricted": ["1 10 0", "2 10 180", "3 10 -50"],
    "hybrid fourier spherical nharmonic": ["1 fourier 2 1.5 1 0 3 2 20", "2 nharmonic 2 1 3", "3 spherical 1 2 1 124 1 1 90 0 1 90 0"],
}
PAIRS = {      # pair style -> dihedral styles whose 1-4 pairs it knows
    "lj/charmm/coul/charmm 4 10": ["charmm"],
    "lj/charmmfsw/coul/charmmfsh 3 10": ["charmm", "charmmfsw"],
    "lj/charmmfsw/coul/charmmfsh 2 4 5": ["charmm", "charmmfsw"],
}


def data(path, charges, straight=False) -> str:
    """A random, or an exactly straight, chain of ten atoms with dihedrals of three types."""
    rng = np.random.default_rng(3)
    n, x = 10, np.zeros((10, 3))
    for i in range(1, n):
        step = rng.normal(size=3) * [0.4, 1, 1] + [1.0, 0, 0]
        x[i] = [1.5 * i, 0, 0] if straight else x[i - 1] + 1.6 * step / np.linalg.norm(step)
    lines = ["chain", "", f"{n} atoms", f"{n - 1} bonds", f"{n - 3} dihedrals", "1 atom types", "1 bond types", "3 dihedral types"]
    lines += [f"-30 30 {a}lo {a}hi" for a in "xyz"] + ["", "Masses", "", "1 12.0", "", "Atoms # full", ""]
    lines += [f"{i + 1} 1 1 {charges * (-1) ** i * (0.1 + 0.05 * i):.3f} {p[0]:.17g} {p[1]:.17g} {p[2]:.17g}" for i, p in enumerate(x)]
    lines += ["", "Bonds", "", *(f"{i} 1 {i} {i + 1}" for i in range(1, n))]
    lines += ["", "Dihedrals", "", *(f"{i} {i % 3 + 1} {i} {i + 1} {i + 2} {i + 3}" for i in range(1, n - 2))]
    path.write_text("\n".join(lines) + "\n")
    return str(path)


def scene(path, dihedral, coeff, pair="zero 8.0", pair_coeff="* *", special="lj/coul 0 0 0", units="lj") -> list[str]:
    return [f"units {units}", "atom_style full", "boundary f f f", f"pair_style {pair}", "bond_style zero nocoeff",
            f"dihedral_style {dihedral}", f"special_bonds {special}", f"read_data {path}", f"pair_coeff {pair_coeff}", "bond_coeff *",
            *(f"dihedral_coeff {line}" for line in coeff), "thermo_style custom step pe edihed evdwl ecoul", "thermo_modify norm no"]


WHEEL = """
answer = []
for lines in given["jobs"]:
    l = start()
    try:
        l.commands_list([*lines, "run 0"])
        answer.append({"forces": by_id(l, "f"), **{k: l.get_thermo(k) for k in ("edihed", "evdwl", "ecoul")}})
    except Exception as e:
        answer.append({"error": str(e)})
    l.close()
"""


def same(lines, want, switches=("-compat", "lammps")):
    assert "error" not in want, want["error"]
    with ran([*lines, "run 0"], *switches) as mine:
        forces = np.array(list(mine.gather_atoms("f", 1, 3))).reshape(-1, 3)
        assert np.abs(forces - want["forces"]).max() <= 5e-12 * np.abs(want["forces"]).max()
        for key in ("edihed", "evdwl", "ecoul"):
            assert mine.get_thermo(key) == pytest.approx(want[key], rel=5e-12, abs=1e-12)


def fails(lines, text):
    with start() as mine, pytest.raises(InputError, match=text):
        mine.commands_list([*lines, "run 0"])


@pytest.mark.filterwarnings("ignore")
def test_lists_and_cross_terms(tmp_path):
    path = data(tmp_path / "data.chain", 0)
    jobs = [scene(path, style, coeff) for style, coeff in LISTS.items()]
    for job, want in zip(jobs, ask(WHEEL, jobs=jobs), strict=True):
        same(job, want)


@pytest.mark.filterwarnings("ignore")
def test_energy_of_a_straight_chain(tmp_path):
    """There no torsion has an angle; LAMMPS's energies are those of 90 degrees, or means over a turn."""
    path = data(tmp_path / "data.chain", 0, straight=True)
    more = {"harmonic": ["1 2 1 3", "2 3 -1 2", "3 5 -1 0"], "charmm": ["1 1.2 3 180 0", "2 0.4 1 37 0", "3 5 0 60 0"],
            "opls": ["* 1.74 -0.157 0.279 0.9"], "multi/harmonic": ["* 20 -10 5 7 -3"], "lepton": ["* (phi-1)^2+sin(phi)"]}
    jobs = [scene(path, style, coeff) for style, coeff in (LISTS | more).items()]
    for job, want in zip(jobs, ask(WHEEL, jobs=jobs), strict=True):
        with ran([*job, "run 0"]) as mine:
            assert mine.get_thermo("edihed") == pytest.approx(want["edihed"], rel=1e-11, abs=1e-12), job


@pytest.mark.filterwarnings("ignore")
def test_pairs_of_the_ends(tmp_path):
    path, jobs = data(tmp_path / "data.chain", 1), []
    for pair, styles in PAIRS.items():
        for style in styles:
            for units in ("real", "lj"):
                coeff = ["1 1.2 3 180 0.7", "2 0.4 1 0 0.0", "3 0.8 2 37 1.0"]
                jobs.append(scene(path, style, coeff, pair, "1 1 0.1 1.5 0.05 1.2", "charmm", units))
    jobs.append(scene(path, "charmm", ["* 1.2 3 180 0"], "lj/charmm/coul/charmm 4 10", "1 1 0.1 1.5", "amber", "real"))
    for job, want in zip(jobs, ask(WHEEL, jobs=jobs), strict=True):
        same(job, want)


@pytest.mark.filterwarnings("ignore")
def test_weights_ask_for_factors_of_zero_and_a_pair_style(tmp_path):
    path = data(tmp_path / "data.chain", 1)
    charmm, switched = "lj/charmm/coul/charmm 4 10", "lj/charmmfsw/coul/charmmfsh 4 10"
    wrong = [("charmm", charmm, "lj 0 0 0.5 coul 0 0 0", "special_bonds charmm"), ("charmm", charmm, "amber", "special_bonds charmm"),
             ("charmmfsw", switched, "coul 0 0 0.5", "special_bonds charmm"), ("charmm", "lj/cut 8", "charmm", "lj/charmm/coul/charmm"),
             ("charmmfsw", charmm, "charmm", "lj/charmmfsw/coul/charmmfsh")]
    coeff = ["1*2 1.2 3 180 0", "3 1.2 3 180 0.5"]
    jobs = [scene(path, style, coeff, pair, "1 1 0.1 1.5", special, "real") for style, pair, special, _ in wrong]
    for job, want, (*_, text) in zip(jobs, ask(WHEEL, jobs=jobs), wrong, strict=True):
        assert "error" in want
        fails(job, text)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("style", ["class2", "hybrid harmonic class2"])
def test_cross_terms_in_data_files(style, tmp_path):
    path, written = data(tmp_path / "data.chain", 0), tmp_path / "data.written"
    lines = scene(path, style, LISTS[style])
    with ran([*lines, "run 0", f"write_data {written}"]) as mine:
        energy = mine.get_thermo("edihed")
    assert written.read_text().count("skip") == (5 if "hybrid" in style else 0)
    again = [line.replace(str(path), str(written)) for line in lines if not line.startswith(("dihedral_coeff", "bond_coeff", "pair_coeff"))]
    want, = ask(WHEEL, jobs=[again])
    assert want["edihed"] == pytest.approx(energy, rel=1e-13)
    same(again, want)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("style", ["table/cut linear 100", "hybrid table/cut linear 100 class2"])
def test_the_cutoff_of_a_table_is_no_cross_term(style, tmp_path):
    """The mark aat of class2 is also a word of table/cut, whose coefficients stand in the main section."""
    path, written, table = data(tmp_path / "data.chain", 0), tmp_path / "data.written", tmp_path / "table.txt"
    phi = np.arange(0.0, 360.0, 3.0)
    rows = np.column_stack([phi, 1 + np.cos(np.radians(3 * phi)), np.radians(3 * np.sin(np.radians(3 * phi)))])
    table.write_text("\n".join([f"KEY\nN {len(phi)} DEGREES", "", *(f"{k} {a:.15g} {b:.15g} {c:.15g}" for k, (a, b, c) in
                                                                     enumerate(rows.tolist(), 1))]) + "\n")
    cut = f"aat 1.2 80 140 {table} KEY"
    hybrid = [f"1 table/cut {cut}", f"3 table/cut {cut}", *(f"2 class2 {line}" for line in CLASS2)]
    lines = hybrid if "hybrid" in style else [f"* {cut}"]
    lines = scene(path, style, lines)
    with ran([*lines, "run 0", f"write_data {written}"]) as mine:
        energy = mine.get_thermo("edihed")
    again = [line.replace(str(path), str(written)) for line in lines if not line.startswith(("dihedral_coeff", "bond_coeff", "pair_coeff"))]
    want, = ask(WHEEL, jobs=[again])
    assert energy != 0.0 and want["edihed"] == pytest.approx(energy, rel=1e-12)
    same(again, want)


@pytest.mark.filterwarnings("ignore")
def test_a_cross_term_is_missing(tmp_path):
    path = data(tmp_path / "data.chain", 0)
    fails(scene(path, "class2", LISTS["class2"][:-1]), "lacks bb13")
    fails(scene(path, "hybrid harmonic class2", HYBRID[1:]), "dihedral_coeff 1 of dihedral style class2 lacks")
