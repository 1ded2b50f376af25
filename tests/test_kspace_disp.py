"""Dispersion without a cutoff and passed over charges: LAMMPS's numbers through runs, and what is refused."""
from __future__ import annotations

import pytest
from solvers import CHARGES, LJ, NVE, SCENE, TILT, compare, lammps_of, refused
from solvers import case as scene

BUCK = [f"pair_coeff {i} {j} {2000 + 300 * i * j} 0.25 {20 + 5 * i * j}" for i in (1, 2, 3) for j in range(i, 4)]
UNLIKE = ["pair_coeff 1 2 0.08 2.5", "pair_coeff 1 3 0.2 2.7"]       # C6 with eigenvalues of 1, -0.21 and 0.0006
TABLES = "pair_modify table 0 table/disp 0"
SPECIAL = "special_bonds lj 0 0.3 1 coul 0.2 0.5 0.9"
# splitting parameters are given below: the ones that a search finds are the same to 9 digits
FORCES = "force/disp/real 0.002 force/disp/kspace 0.004"
VALUES = ["elong", "evdwl", "ecoul", "pe", "press", "pxx", "pxy", "pyz"]
SHARES = ["compute e all pe/atom kspace", "compute em all reduce max c_e", "compute s all stress/atom NULL kspace",
          "compute sm all reduce max c_s[3] c_s[5]"]


def case(pair, *solver, coeff=LJ, box=(), mix="geometric", modify=TABLES):
    return scene(*box, *CHARGES, f"pair_style {pair}", f"{modify} mix {mix}", *coeff, *solver, SPECIAL, *SHARES, *NVE,
                 values=[*VALUES, "c_em", "c_sm[1]", "c_sm[2]"])


def npt(kind, **options):
    """Boxes that grow until they take more waves."""
    out = case("lj/long/coul/long long long 5.0", "kspace_style ewald/disp 1e-4", **options)
    out["commands"][-1] = f"fix 1 all npt temp 300 300 50 {kind} -20000 -20000 30"
    out["runs"] = ["run 10", "run 5"]
    return out


CASES = {
    "ewald/disp": case("lj/long/coul/long long long 5.0", "kspace_style ewald/disp 1e-4"),
    "ewald/disp arithmetic, triclinic": case("lj/long/coul/long long long 5.0", "kspace_style ewald/disp 1e-5", mix="arithmetic", box=TILT),
    **{f"ewald/disp, slab {word}": case("lj/long/coul/long long long 5.0", "kspace_style ewald/disp 1e-4", f"kspace_modify slab {word}")
       | {"boundary": "p p f", "runs": ["run 0"]} for word in ("3.0", "nozforce", "ew2d")},
    **{f"pppm/disp, slab {word}": case("lj/long/coul/long long long 5.0", "kspace_style pppm/disp 1e-4",
                                       f"kspace_modify slab {word} gewald 0.4 {FORCES}", box=["change_box all z delta -9 9"])
       | {"boundary": "p p f", "runs": ["run 0"]} for word in ("3.0", "nozforce", "ew2d")},
    "ewald/disp, npt": npt("iso"), "ewald/disp, npt, triclinic": npt("tri", box=TILT),
    "ewald/disp without charges": case("lj/long/coul/long long off 5.0", "kspace_style ewald/disp 1e-4"),
    "ewald/disp, Buckingham": case("buck/long/coul/long long long 5.0", "kspace_style ewald/disp 1e-4", coeff=BUCK),
    "a cutoff for dispersion": case("lj/long/coul/long cut long 4.5 5.0", "kspace_style ewald/disp 1e-4"),
    "Buckingham, cut": case("buck/long/coul/long cut long 4.5 5.0", "kspace_style pppm 1e-4", coeff=BUCK),
    "pppm/disp": case("lj/long/coul/long long long 5.0", "kspace_style pppm/disp 1e-4", f"kspace_modify gewald 0.4 {FORCES}"),
    "pppm/disp, dispersion off": case("lj/long/coul/long off long 5.0", "kspace_style pppm/disp 1e-4", "kspace_modify gewald 0.4"),
    "pppm/disp, dispersion off, two cutoffs": case("lj/long/coul/long off long 4.5 5.0", "kspace_style pppm/disp 1e-4",
                                                   "kspace_modify gewald 0.4"),
    "pppm/disp with nothing to do": case("lj/long/coul/long off off 5.0", "kspace_style pppm/disp 1e-4"),
    "pppm/disp, no overlap": case("lj/long/coul/long long long 5.0", "kspace_style pppm/disp 1e-4",
                                  "kspace_modify gewald 0.35 gewald/disp 0.4 mesh 3 8 10 mesh/disp 8 3 10 order 7 order/disp 6 overlap no"),
    "pppm/disp arithmetic": case("lj/long/coul/long long long 5.0", "kspace_style pppm/disp 1e-4",
                                 "kspace_modify gewald 0.35 gewald/disp 0.4 mesh/disp 8 6 10", mix="arithmetic"),
    "pppm/disp, C6 as given": case("lj/long/coul/long long off 5.0", "kspace_style pppm/disp 1e-4",
                                   f"kspace_modify {FORCES} mix/disp none", coeff=[*LJ, "pair_coeff 1 2 0.2 2.5"]),
    **{f"pppm/disp, {kept} of the C6": case(
        "lj/long/coul/long long long 5.0", "kspace_style pppm/disp 1e-4",
        f"kspace_modify gewald 0.35 gewald/disp 0.4 mesh/disp 8 6 10 mix/disp none {words}", coeff=[*LJ, *UNLIKE])
       for kept, words in (("all", "splittol 1e-4"), ("two", "splittol 1e-6 eigtol 0.05"), ("one", "eigtol 1e-6 splittol 0.6"))},
    **{f"tables, {name}": case("lj/long/coul/long long long 5.0", "kspace_style ewald/disp 1e-4", modify=f"pair_modify {words}")
       for name, words in (("both", "table 12 table/disp 12"), ("dispersion", "table 0 table/disp 10 tabinner/disp 2"),
                           ("inner", "table 9 tabinner 2.8 table/disp 8 tabinner/disp 2.8"), ("charges", "table 14 table/disp 0"))},
    "tables, Buckingham": case("buck/long/coul/long long long 5.0", "kspace_style ewald/disp 1e-4", coeff=BUCK,
                               modify="pair_modify table 12 table/disp 12"),
    "pppm/cg": case("lj/cut/coul/long 5.0", "set type 3 charge 0.01", "kspace_style pppm/cg 1e-4 0.1", modify="pair_modify table 0"),
    "tables beside a switch": case("lj/charmm/coul/long 4.0 5.0", "kspace_style ewald 1e-4", modify="pair_modify table 12"),
    "tables of cores and shells": case("lj/cut/coul/long/cs 5.0", "kspace_style ewald 1e-4", modify="pair_modify table 12 tabinner 2"),
    "powers of cores and shells": case("buck/coul/long/cs 5.0", "kspace_style ewald 1e-4", coeff=BUCK, modify="pair_modify table 0"),
}


@pytest.fixture(scope="module")
def lammps(tmp_path_factory):
    return lammps_of(CASES, tmp_path_factory.mktemp("kspace"))


@pytest.mark.part(6)
@pytest.mark.parametrize("name", CASES)
def test_against_lammps(name, lammps):
    compare(name, CASES[name], lammps[name])


LONG = ["pair_style lj/long/coul/long long long 6.0", "pair_coeff * * 0.1 2.0"]


@pytest.mark.parametrize("lines, message", [
    (["pair_style lj/long/coul/long long cut 6.0"], "coulomb must be long or off"),
    (["pair_style lj/long/coul/long none long 6.0"], "dispersion must be long, cut or off"),
    (["pair_style buck/long/coul/long off long 6.0"], "dispersion must be long or cut"),
    (["pair_style lj/long/dipole/long off long 6.0"], "write cut long"),
    (["pair_style lj/long/coul/long off long 6.0", "pair_coeff * * 0.1 2.0", "run 0"], "needs a kspace_style, such as pppm/disp"),
    (["pair_style lj/long/coul/long off long 6.0", "pair_coeff * * 0.1 2.0", "kspace_style pppm 1e-4", "run 0"], "pppm needs a pair style"),
    (["pair_style buck/long/coul/long long long 6.0 5.0"], "only one cutoff"),
    (["pair_style lj/long/coul/long long off"], "needs dispersion coulomb cut_lj"),
    ([*LONG, "run 0"], "needs a kspace_style, such as pppm/disp"),
    ([*LONG, "kspace_style pppm 1e-4", "run 0"], "needs a pair style that leaves it"),
    ([*LONG, "kspace_style pppm/disp 1e-4", "run 0"], "needs its accuracy for dispersion"),
    ([*LONG, "kspace_style ewald/disp 0.1", "run 0"], "too low"),
    ([*LONG, "kspace_style pppm/disp 1e-4", "kspace_modify eigtol 1.5"], "eigtol: must be smaller than 1"),
    (["kspace_style pppm/cg 1e-4 0.1 3"], "smallest charge, got 3 words")])
def test_what_is_refused(lines, message):
    refused([*SCENE, *lines], message)
