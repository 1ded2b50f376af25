"""Multilevel summation: LAMMPS's numbers for all orders and boundaries, the plain sum in an open box, what is refused."""
from __future__ import annotations

import numpy as np
import pytest
from solvers import LJ, NEUTRAL, NVE, SCENE, TILT, case, compare, lammps_of, refused
from wheel import ran

SHARES = ["compute e all pe/atom kspace", "compute em all reduce max c_e", "compute s all stress/atom NULL kspace",
          "compute sm all reduce max c_s[1] c_s[3]"]
VALUES = ["elong", "ecoul", "pe", "press", "pxx", "pxy", "pyz", "c_em", "c_sm[1]", "c_sm[2]"]
PAIRS = ["pair_style lj/cut/coul/msm 5.0", *LJ]


def msm(*more, accuracy=1e-3, box=(), boundary="p p p", style="msm", pairs=PAIRS, table=0, fixes=NVE):
    return case(*box, *NEUTRAL, *pairs, f"pair_modify table {table}", f"kspace_style {style} {accuracy}",
                "kspace_modify pressure/scalar no", *(f"kspace_modify {words}" for words in more), "special_bonds coul 0.2 0.5 1",
                "neigh_modify one 20000 page 400000", *SHARES, *fixes, values=VALUES, boundary=boundary)


WALLS = [*NVE, "fix w all wall/reflect xlo EDGE xhi EDGE ylo EDGE yhi EDGE zlo EDGE zhi EDGE"]
CASES = {
    "order 10": msm(),
    "order 8": msm("order 8"),
    "order 6, cutoff stays": msm("order 6 cutoff/adjust no", accuracy=1e-2),
    "order 4, triclinic": msm("order 4 cutoff/adjust no", accuracy=3e-2, box=TILT),
    "triclinic": msm("order 6", box=TILT),
    "a mesh that is rounded": msm("order 6 mesh 5 11 3"),
    "directions that end before others": msm("order 4 cutoff/adjust no mesh 2 4 16", box=["change_box all z scale 2"]),
    "the smallest mesh": msm("order 4 mesh 1 1 1"),
    "open": msm("order 4", boundary="f f f", fixes=WALLS),
    "open, directions that end before others": msm("order 4 cutoff/adjust no mesh 2 4 16", boundary="f f f", fixes=WALLS),
    "a slab": msm("order 4 cutoff/adjust no mesh 4 8 8", boundary="p p f", fixes=[*NVE, "fix w all wall/reflect zlo EDGE zhi EDGE"]),
    "faces that follow": msm("order 6", boundary="p s s", fixes=[*NVE, "timestep 0.001"]),
    "npt": msm("order 6", fixes=["fix 1 all npt temp 300 300 50 aniso 0 0 100"]),
    "tables": msm("order 6", table=12),
    "coul/msm": msm("order 6", "force 0.3", pairs=["pair_style coul/msm 5.0", "pair_coeff * *"]),
    "pair part alone": msm("compute no cutoff/adjust no order 8"),
    "msm/cg": msm("order 6", style="msm/cg", accuracy="1e-3 0.1", box=["set atom 1 charge 0.05"]),
    "adapted": msm("order 6", pairs=["pair_style coul/msm 5.0", "pair_coeff * *", "variable f equal 0.4+0.05*step"],
                   fixes=["fix f all adapt 1 pair coul/msm scale 1 * v_f kspace v_f", *NVE]),
}


@pytest.fixture(scope="module")
def lammps(tmp_path_factory):
    return lammps_of(CASES, tmp_path_factory.mktemp("msm"))


@pytest.mark.part(5)
@pytest.mark.parametrize("name", CASES)
def test_against_lammps(name, lammps):
    compare(name, CASES[name], lammps[name])


@pytest.mark.parametrize("order", [4, 6, 8, 10])
def test_weights_keep_polynomials(order):
    from asemd.kspace.msm import nodal, pieces
    t, points = np.linspace(0.0, 1.0, 9), np.arange(1 - order // 2, order // 2 + 1)
    weights = np.array([p(t) for p in pieces(order)])
    for power in range(order - 1):
        assert np.allclose((weights * points[:, None] ** float(power)).sum(axis=0), t**power, atol=1e-9)
    assert np.allclose(nodal(order, points[:, None].astype(float)[:, 0]), points == 0)
    slopes = [p.deriv() for p in pieces(order)]      # the same on both sides of a point
    assert np.allclose([s(1.0) for s in slopes[1:]], [s(0.0) for s in slopes[:-1]])


def test_open_box_is_the_plain_sum():
    rng = np.random.default_rng(1)
    x, q = rng.uniform(1.0, 19.0, (40, 3)), np.repeat([1.0, -1.0], 20)
    lmp = ran(["units real", "atom_style charge", "boundary f f f", "region b block 0 20 0 20 0 20", "create_box 2 b", "mass * 1.0"])
    lmp.create_atoms(40, list(range(1, 41)), [1] * 20 + [2] * 20, list(x.ravel()))
    lmp.commands_list(["set type 1 charge 1", "set type 2 charge -1", "pair_style coul/msm 8.0", "pair_coeff * *",
                       "kspace_style msm 1e-4", "run 0"])
    d = np.linalg.norm(x[:, None] - x[None], axis=-1) + np.eye(40)
    plain = 332.06371 * 0.5 * ((q[:, None] * q / d).sum() - 40.0)
    assert lmp.get_thermo("ecoul") + lmp.get_thermo("elong") == pytest.approx(plain, abs=0.05)
    f = np.array(lmp.gather_atoms("f", 1, 3)).reshape(-1, 3)
    exact = 332.06371 * ((q[:, None] * q / d**3)[..., None] * (x[:, None] - x[None])).sum(axis=1)
    assert np.sqrt(((f - exact) ** 2).sum(axis=1).mean()) < 2e-4 * 332.06371


@pytest.mark.parametrize("style", ["msm", "msm/cg"])
def test_no_charges_no_energy(style):
    lmp = ran([*SCENE, "set group all charge 0", "pair_style lj/cut/coul/msm 8.0", "pair_coeff * * 0.1 3.0", f"kspace_style {style} 1e-4",
               "run 0"])
    assert lmp.get_thermo("elong") == lmp.get_thermo("ecoul") == 0.0 != lmp.get_thermo("evdwl")
    lmp.commands_list(["set atom 1 charge 0.5", "set atom 2 charge -0.5", "run 0"])
    assert lmp.get_thermo("elong") < 0.0


MSM = ["set atom 2 charge -1", "pair_style coul/msm 6.0", "pair_coeff * *", "kspace_style msm 1e-4"]


@pytest.mark.parametrize("lines, message", [
    ([*MSM, "set atom 2 charge 1", "run 0"], "add up to 2"), ([*MSM, "kspace_modify order 5", "run 0"], "order must be 4, 6, 8 or 10"),
    ([*MSM, "kspace_modify slab 3.0", "run 0"], "does not take kspace_modify slab"), (["kspace_style msm/cg 1e-4 0.1 3"], "got 3 words"),
    ([*MSM, "pair_style coul/long 6.0", "pair_coeff * *", "run 0"], "needs a pair style that leaves it"),
    ([*MSM, "compute g all group/group all kspace yes", "thermo_style custom c_g", "run 0"], "does not work with kspace_style msm")])
def test_what_is_refused(lines, message):
    refused([*SCENE, *lines], message)
