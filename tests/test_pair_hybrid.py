"""Hybrid pair styles: weights of special pairs by sub-style, factors, molecules; LAMMPS's numbers, and mistakes."""
from __future__ import annotations

import numpy as np
import pytest
from bead_chain import COLUMNS, chain
from both import asemd, lines_of
from wheel import ask, ran

from asemd.errors import InputError

PAIRS = "pair_style hybrid/overlay lj/cut 6 coul/cut 5\npair_coeff * * lj/cut 0.1 2.5\npair_coeff * * coul/cut\n"
TWICE = "pair_style hybrid/overlay lj/cut 6 lj/cut 5\npair_coeff * * lj/cut 1 0.1 2.5\npair_coeff * * lj/cut 2 0.05 2\n"
COEFF = "pair_coeff * * lj/cut 0.1 2.5\npair_coeff * * coul/cut\n"
VARIABLES = ("variable s equal 0.1*step+0.3\nvariable rest equal 1-v_s\nvariable c equal 0.25\nvariable n internal 0.5\n"
             "variable a atom 0.1*id+0.01*step\n")
CASES = {
    "lj and coul": PAIRS + "pair_modify pair lj/cut special lj/coul 0 0.1 0.9",
    "coul": PAIRS + "pair_modify pair coul/cut special coul 0 0.1 0.9 shift yes",
    "twice said": PAIRS + "pair_modify pair lj/cut special lj 0 0 0.5 special coul 1 1 1\npair_modify pair coul/cut special lj 2 -1 7",
    "one of two": TWICE + "pair_modify pair lj/cut 2 special lj 0 0 0",
    "as common": "special_bonds lj/coul 0 0 0.5\n" + PAIRS + "pair_modify pair lj/cut special lj 0 0 0",
    "all or nothing": "special_bonds lj/coul 1e-50 0.5 1\n" + PAIRS + "pair_modify pair lj/cut special lj 1 0 1",
    "tally": PAIRS + "pair_modify pair lj/cut compute/tally no special lj 0 0 0",
    "tail of one": TWICE + "pair_modify pair lj/cut 1 tail yes",
    "tail taken away": TWICE + "pair_modify tail yes\npair_modify pair lj/cut 1 tail no",
    "tail given again": TWICE + "pair_modify pair lj/cut 2 tail no\npair_modify pair lj/cut 1 tail yes",
    "respa": PAIRS + "pair_modify pair lj/cut special lj 0 0.1 0.9\nrun_style respa 2 2 bond 1 pair 2",
    "numbers": "pair_style hybrid/scaled 0.5 lj/cut 6 -0.25 coul/cut 5\n" + COEFF,
    "off": "pair_style hybrid/scaled 1 lj/cut 6 0 coul/cut 5\n" + COEFF,
    "tail scaled": "pair_style hybrid/scaled 0.5 lj/cut 6 2 coul/cut 5\n" + COEFF + "pair_modify tail yes",
    "shift scaled": "pair_style hybrid/scaled 0.5 lj/cut 6 2 coul/cut 5\n" + COEFF + "pair_modify shift yes",
    "same style": "pair_style hybrid/scaled v_s lj/cut 6 v_rest lj/cut 5\npair_coeff * * lj/cut 1 0.1 2.5\npair_coeff * * lj/cut 2 0.2 2",
    "changing": "pair_style hybrid/scaled v_s lj/cut 6 v_c coul/cut 5\n" + COEFF,
    "internal": "pair_style hybrid/scaled v_n lj/cut 6 v_c coul/cut 5\n" + COEFF,
    "special and scaled": "pair_style hybrid/scaled v_s lj/cut 6 v_c coul/cut 5\n" + COEFF + "pair_modify pair lj/cut special lj 0 0.1 0.9",
    "some pairs": "pair_style hybrid/scaled v_s lj/cut 6 v_c coul/cut 5\npair_coeff * * lj/cut 0.1 2.5\npair_coeff 2 2 coul/cut\n"
                  "pair_coeff 1 1 none\npair_coeff 1 1 coul/cut",
    "scaled respa": "pair_style hybrid/scaled v_s lj/cut 6 v_c coul/cut 5\n" + COEFF + "run_style respa 2 2 hybrid 1 2",
    "molecules": "pair_style hybrid/molecular lj/cut 6 coul/cut 5\n" + COEFF,
    "molecules, twice": "pair_style hybrid/molecular lj/cut 6 lj/cut 8\npair_coeff * * lj/cut 1 0.1 2.5\npair_coeff 2 2 lj/cut 2 0.3 3",
    "by atom": "pair_style hybrid/scaled v_a lj/cut 6 v_c coul/cut 5\n" + COEFF,
}
THEIRS = """
import numpy as np
answer = {}
for name, lines in given["cases"].items():
    lmp = ran(lines)
    rows = []
    for run in ("run 0", "run 3"):
        lmp.command(run)
        rows.append({"thermo": [lmp.get_thermo(c) for c in given["columns"]], "f": np.array(lmp.gather_atoms("f", 1, 3)).tolist(),
                     "x": np.array(lmp.gather_atoms("x", 1, 3)).tolist()})
    answer[name] = rows
    lmp.close()
"""


@pytest.fixture(scope="module")
def theirs():
    return ask(THEIRS, cases={name: lines_of(chain() + VARIABLES + text) for name, text in CASES.items()}, columns=COLUMNS)


@pytest.mark.parametrize("name", CASES)
def test_like_lammps(theirs, name):
    session = asemd(chain() + VARIABLES + CASES[name])
    for run, expected in zip(("run 0", "run 3"), theirs[name]):
        session.execute(run)
        system = session.scene.system
        order = np.argsort(system.id)
        for mine, other in ((system.x[order], expected["x"]), (system.f[order], expected["f"])):
            other = np.reshape(other, (-1, 3))
            np.testing.assert_allclose(mine, other, rtol=0, atol=1e-11 * np.abs(other).max())
        row = [session.variables.evaluate(c) for c in COLUMNS]
        count = len(COLUMNS) if name != "by atom" else 4        # forces that are not opposite: LAMMPS's virial depends on the origin
        np.testing.assert_allclose(row[:count], expected["thermo"][:count], rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("name", ["special and scaled", "molecules", "one of two", "numbers"])
def test_shares_of_atoms_add_up(name):
    session = asemd(chain() + VARIABLES + CASES[name] + "\ncompute p all pe/atom pair\nrun 2")
    values = session.variables.provider.source("c", "p").per_atom(session.moment.snapshot)
    assert values.sum() == pytest.approx(session.variables.evaluate("evdwl+ecoul"), rel=1e-12)


def test_large_systems_are_the_same():
    """The lists of many atoms, whose special pairs are one by one, give what the plain list of few gives."""
    for name in ("lj and coul", "numbers", "molecules", "special and scaled", "molecules, twice"):
        small, large = (asemd(chain() + VARIABLES + CASES[name] + f"\n{more}\nrun 0") for more in ("print x", "replicate 4 4 4"))
        assert large.loop.engine.mode == "cluster" and small.loop.engine.mode == "plain"
        sums = [s.variables.evaluate("evdwl+ecoul") for s in (small, large)]
        assert 64 * sums[0] == pytest.approx(sums[1], rel=1e-11)


@pytest.mark.parametrize("name", ["numbers", "special and scaled", "molecules", "molecules, twice", "scaled respa", "by atom"])
def test_large_systems_move_like_lammps(name):
    """Factors and molecules over the lists of many atoms, on the way too: positions after some steps, and the last row."""
    script = chain() + VARIABLES + CASES[name] + "\nreplicate 3 3 3\nvelocity all create 300 77 loop geom\nneigh_modify delay 0 every 1"
    session = asemd(script)
    theirs = ask(THEIRS, cases={name: lines_of(script)}, columns=COLUMNS)[name]
    for run, expected in zip(("run 0", "run 3"), theirs):
        session.execute(run)
        system = session.scene.system
        x = np.reshape(expected["x"], (-1, 3))
        np.testing.assert_allclose(system.x[np.argsort(system.id)], x, rtol=0, atol=1e-11 * np.abs(x).max())
        count = len(COLUMNS) if name != "by atom" else 4
        row = [session.variables.evaluate(c) for c in COLUMNS]
        np.testing.assert_allclose(row[:count], expected["thermo"][:count], rtol=1e-9, atol=1e-9)
    assert session.loop.engine.mode == "cluster" and session.loop.engine.expanded == (name == "by atom")


@pytest.mark.parametrize("name", ["off", "special and scaled", "starting"])
@pytest.mark.parametrize("size", ["", "\nreplicate 3 3 3"])
def test_energy_of_a_sub_style_has_no_factor(name, size):
    """As thermodynamic integration takes it, at a factor of 0 too."""
    cases = CASES | {"starting": "variable up equal 0.25*step\npair_style hybrid/scaled v_up lj/cut 6 1 coul/cut 5\n" + COEFF}
    computes = "\ncompute a all pair lj/cut\ncompute b all pair coul/cut ecoul\nthermo_style custom step c_a c_b\nrun 0"
    script = chain() + VARIABLES + cases[name] + size + computes
    session = asemd(script)
    theirs = ask("""
lmp, answer = ran(given["lines"]), []
for run in ("run 0", "run 3"):
    lmp.command(run)
    answer += [lmp.last_thermo()[c] for c in ("c_a", "c_b")]
""", lines=lines_of(script))
    ours = []
    for run in ("run 0", "run 3"):
        session.execute(run)
        ours += [session.variables.evaluate(c) for c in ("c_a", "c_b")]
    np.testing.assert_allclose(ours, theirs, rtol=1e-9)
    assert all(ours)


def test_factors_that_follow_positions_see_atoms_inside_the_box():
    """Runs that follow one another begin with atoms inside the periodic box, and so do their factors."""
    text = ("variable p atom 0.3+0.05*x\npair_style hybrid/scaled v_p lj/cut 6 1 coul/cut 5\n" + COEFF
            + "displace_atoms all move -3.1 0 0 units box\nvelocity all set -0.02 0 0")
    session = asemd(chain() + text)
    theirs = ask(THEIRS.replace('"run 0", "run 3"', '"run 2", "run 9", "run 4"'), cases={"x": lines_of(chain() + text)},
                 columns=COLUMNS)["x"]
    for run, expected in zip(("run 2", "run 9", "run 4"), theirs):
        session.execute(run)
        x = np.reshape(expected["x"], (-1, 3))
        np.testing.assert_allclose(session.scene.system.x[np.argsort(session.scene.system.id)], x, rtol=0, atol=1e-10)


def test_written_and_read_again(tmp_path):
    """Scripts, restart files and the terms made of them have the factors and the weights."""
    session = asemd(chain() + VARIABLES + CASES["special and scaled"] + f"\nrun 0\nwrite_restart {tmp_path}/r")
    inter = session.scene.interactions
    assert inter.style_line("pair") == "hybrid/scaled v_s lj/cut 6.0 v_c coul/cut 5.0".split()
    assert inter.modify_lines()[-1] == "pair lj/cut special lj 0.0 0.1 0.9".split()
    again = asemd(VARIABLES + f"read_restart {tmp_path}/r\nrun 0")
    assert [u.special for u in again.scene.interactions.uses["pair"]] == [{"lj": (0.0, 0.1, 0.9)}, {}]
    assert again.variables.evaluate("pe") == session.variables.evaluate("pe")


def test_minimisation_sees_the_step():
    session = asemd(chain() + VARIABLES + CASES["changing"] + "\nminimize 0 0 4 40")
    assert session.scene.interactions.uses["pair"][0].factor == pytest.approx(0.1 * session.scene.step + 0.3)


@pytest.mark.parametrize("lines, message", [
    (PAIRS + "pair_modify special lj 0 0 0", "must stand first"),
    (PAIRS + "pair_modify pair lj/cut shift yes special lj 0 0 0", "must stand first"),
    (PAIRS + "pair_modify pair lj/cut special foo 0 0 0", "expected one of lj coul"),
    (PAIRS + "pair_modify pair lj/cut special lj 0 0", "4 values"),
    (PAIRS + "pair_modify pair lj/cut special lj 0 0 a", "number"), (PAIRS + "pair_modify pair morse special lj 0 0 0", "morse"),
    (PAIRS + "pair_modify pair lj/cut compute/tally maybe", "yes or no"),
    (PAIRS + "pair_modify pair lj/cut shift yes pair coul/cut shift no", "first"),
    (PAIRS + "special_bonds lj 0 0 0.5\npair_modify pair lj/cut special lj 0.5 0 0.5\nrun 0", "1-2 pairs is incompatible"),
    (PAIRS + "special_bonds lj/coul 0 0 1\npair_modify pair lj/cut special coul 0 0 0.5\nrun 0", "special coul.*1-4 pairs is incompatible"),
    ("pair_style hybrid/scaled", "sub-styles"), ("pair_style hybrid/scaled 0.5", "must follow the factor"),
    ("pair_style hybrid/scaled lj/cut 6 0.5 coul/cut 5", "a factor stands before"),
    ("pair_style hybrid/scaled 0.5 lj/cut 6 coul/cut 5", "needs cut"),
    ("pair_style hybrid/scaled 0.5 lj/cut coul/cut 5", "must stand before coul/cut"),
    ("pair_style hybrid/scaled 1 none 1 lj/cut 5", "cannot have none"),
    ("pair_style hybrid/scaled 1 hybrid 1 lj/cut 5", "cannot have hybrid"), ("bond_style hybrid/scaled 1 harmonic", "did you mean hybrid"),
    ("pair_style hybrid/scaled v_no lj/cut 6 1 coul/cut 5\n" + COEFF + "run 0", "undefined variable"),
    ("variable i index 0.5\npair_style hybrid/scaled v_i lj/cut 6 1 coul/cut 5\n" + COEFF + "run 0", "index, it must be equal"),
    ("pair_style hybrid/molecular lj/cut 6", "two sub-styles"), ("pair_style hybrid/molecular lj/cut 6 coul/cut 5 morse 3", "got 3"),
])
def test_mistakes(lines, message):
    with pytest.raises(InputError, match=message):
        asemd(chain(1, 4) + lines)


def test_molecules_are_needed():
    with pytest.raises(InputError, match="molecule numbers"):
        asemd("region b block 0 8 0 8 0 8\ncreate_box 1 b\nmass 1 1\npair_style hybrid/molecular lj/cut 3 lj/cut 3\n"
              "pair_coeff 1 1 lj/cut 1 1 1\npair_coeff 1 1 lj/cut 2 1 1\nrun 0")


SUB_STYLES = """
variable zero equal 0
variable atoms atom 0.1*x
variable step equal step
compute p all pair lj/cut
compute q all pair coul/cut epair
compute r all pair lj/cut ecoul
variable p equal c_p
variable q equal c_q
variable r equal c_r
thermo_style custom c_p c_q c_r
run 1
"""


def test_energies_of_sub_styles_are_those_without_their_factors():
    factors = [("0.5", "2"), ("0", "-1"), ("v_zero", "v_step"), ("v_atoms", "1"), ("1", "v_atoms")]
    scripts = [chain() + SUB_STYLES.replace("compute p", f"pair_style hybrid/scaled {a} lj/cut 6 {b} coul/cut 5\n{COEFF}compute p")
               for a, b in factors]
    theirs = ask("answer = []\nfor s in given['scripts']:\n    lmp = ran(s)\n    answer.append([lmp.extract_variable(v) for v in 'pqr'])\n"
                 "    lmp.close()", scripts=scripts)
    for script, want in zip(scripts, theirs, strict=True):
        assert [ran(script).extract_variable(v) for v in "pqr"] == pytest.approx(want, rel=1e-11)
    both = chain() + SUB_STYLES.replace("pair lj/cut", "pair lj/cut/coul/cut").replace(
        "compute p", "pair_style hybrid/scaled 0 lj/cut/coul/cut 6 1 coul/cut 5\npair_coeff * * lj/cut/coul/cut 0.1 2\n"
                     "pair_coeff * * coul/cut\ncompute p")
    with pytest.raises(InputError, match="there is epair only"):
        ran(both)


def test_special_pairs_of_zbl_beside_a_solver():
    script = chain() + ("special_bonds lj/coul 0 0 0.5\npair_style hybrid/overlay zbl 3 4 coul/long 6\npair_coeff * * zbl 6 6\n"
                        "pair_coeff * * coul/long\npair_modify table 0\nkspace_style ewald 1e-4\ncompute p all pair zbl\n"
                        "compute g all group/group all\nvariable p equal c_p\nvariable g equal c_g\nthermo_style custom c_p c_g\nrun 1")
    script = script.replace("pair_coeff * * zbl 6 6", "pair_coeff 1 1 zbl 6 6\npair_coeff 2 2 zbl 8 8")
    theirs = ask("lmp = ran(given['lines'])\nanswer = [lmp.extract_variable(v) for v in 'pg'], list(lmp.gather_atoms('f', 1, 3))",
                 lines=script)
    lmp = ran(script)
    assert [lmp.extract_variable(v) for v in "pg"] == pytest.approx(theirs[0], rel=1e-10)
    assert list(lmp.gather_atoms("f", 1, 3)) == pytest.approx(theirs[1], rel=1e-9, abs=1e-9 * max(theirs[1]))


def test_shifted_forces_of_special_pairs_with_a_factor():
    script = chain() + ("special_bonds lj 0.3 0.0 0.5 coul 1 1 1\npair_style hybrid/scaled 0.5 lj/sf 6 2 coul/cut 5\n"
                        "pair_coeff * * lj/sf 0.1 2.5\npair_coeff * * coul/cut\ncompute e all pe/atom pair\ncompute s all reduce sum c_e\n"
                        "variable s equal c_s\nvariable e equal evdwl\nthermo_style custom evdwl c_s\nrun 1")
    theirs = ask("lmp = ran(given['lines'])\nanswer = [lmp.extract_variable(v) for v in 'se']", lines=script)
    lmp = ran(script, "-compat", "lammps")
    assert [lmp.extract_variable(v) for v in "se"] == pytest.approx(theirs, rel=1e-11)


BONDED = """units real
atom_style full
region b block 0 12 0 12 0 12
create_box 2 b bond/types 1 extra/bond/per/atom 2 extra/special/per/atom 4
create_atoms 1 single 5 5 5
create_atoms 2 single 6 5 5
create_atoms 1 single 7.9 5.2 5.1
create_atoms 2 single 8.3 6.0 5.2
mass * 10
set type 1 charge 0.4
set type 2 charge -0.4
bond_style harmonic
bond_coeff 1 10 1
special_bonds lj/coul 0 0 1
create_bonds single/bond 1 1 2
create_bonds single/bond 1 3 4
variable r equal 0.4+0.1*step
pair_style hybrid/scaled v_r {}
pair_coeff * * lj/cut 0.1 2
fix 1 all nve
thermo_style custom step pe evdwl
run 4
"""


def test_own_energies_and_hydrogen_bonds_follow_a_factor():
    scripts = [BONDED.format(words).replace("fix 1", f"pair_coeff {coeff}\nfix 1") for words, coeff in (
        ("coul/dsf 0.2 6 1.0 lj/cut 6", "* * coul/dsf"), ("coul/wolf 0.2 6 1.0 lj/cut 6", "* * coul/wolf"),
        ("hbond/dreiding/lj 4 6 7 90 1.0 lj/cut 6", "1 1 hbond/dreiding/lj 2 i 4.0 2.75"))]
    theirs = ask("answer = []\nfor s in given['scripts']:\n    lmp = ran(s)\n"
                 "    answer.append([lmp.get_thermo('pe'), *lmp.gather_atoms('f', 1, 3)])\n    lmp.close()", scripts=scripts)
    for script, want in zip(scripts, theirs, strict=True):
        lmp = ran(script, "-compat", "lammps")
        assert [lmp.get_thermo("pe"), *lmp.gather_atoms("f", 1, 3)] == pytest.approx(want, rel=1e-9)


def test_zbl_beside_a_style_with_the_constant_of_charmm():
    script = chain() + ("pair_style hybrid/overlay zbl 3 4 lj/charmmfsw/coul/charmmfsh 5 6\npair_coeff 1 1 zbl 6 6\n"
                        "pair_coeff 2 2 zbl 8 8\npair_coeff * * lj/charmmfsw/coul/charmmfsh 0.1 2\ncompute p all pair zbl\n"
                        "variable p equal c_p\n"
                        "thermo_style custom c_p\nrun 0")
    theirs = ask("answer = ran(given['lines']).extract_variable('p')", lines=script)
    assert ran(script).extract_variable("p") == pytest.approx(theirs, rel=1e-11)
