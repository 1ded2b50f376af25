"""What asks for parts of a long-range solver or scales it: compute group/group and ti, fix adapt; LAMMPS's numbers."""
from __future__ import annotations

import pytest
from solvers import CHARGES, NVE, SCENE, TILT, case, compare, lammps_of, refused

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


TABLE0 = ["pair_modify table 0"]
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
    "coul/slater/cut": scaled("coul/slater/cut", "1.5 5.5"),
}


@pytest.fixture(scope="module")
def lammps(tmp_path_factory):
    return lammps_of(CASES, tmp_path_factory.mktemp("groups"))


@pytest.mark.part(8)
@pytest.mark.parametrize("name", CASES)
def test_against_lammps(name, lammps):
    compare(name, CASES[name], lammps[name])


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
    refused([*SCENE, "variable f equal 1.0", "pair_style coul/long 6.0", "pair_coeff * *", "kspace_style pppm 1e-4", *lines], message)
