"""Fixes that find charges: like LAMMPS iteration by iteration, the same electronegativity for all atoms, bad input."""
from __future__ import annotations

import numpy as np
import pytest
from scripted import script, write_data
from solvers import LJ, NVE, case, compare, lammps_of
from wheel import ran, start

from asemd.errors import InputError
from asemd.fix import QEqFire, QEqPoint, QEqShielded
from asemd.lammps import Lammps

PARAMETERS = "# UNITS: real\n1*2 0.5 9.25 0.8 0.77 0.5\n2 5.27 15.4 0.7 0.74 0.4\n3 2.0 11.0 0.9 0.77 0.0\n"
OUT = ["compute q all property/atom q", "compute r all reduce sumsq c_q", "compute m all reduce max c_q"]
PAIR = ["pair_style lj/cut/coul/cut 5.0", *LJ, *OUT]
LONG = ["pair_style lj/cut/coul/long 5.0", "pair_modify table 0", *LJ, *OUT, "kspace_style pppm 1e-4",
        "kspace_modify gewald 0.4 mesh 10 10 10"]
CHARGED = ["set type 1 charge 0.3", "set type 2 charge -0.2", "set type 3 charge 0.1"]


def found(fix, *before, pairs=PAIR, runs=("run 0", "run 3", "run 4")):
    return case(*pairs, *before, f"fix 2 {fix} ", *NVE, values=["c_r", "c_m", "ecoul", "pe", "press"], runs=list(runs))


CASES = {
    "point, few iterations": found("all qeq/point 1 5.0 1e-20 4 QFILE warn no"),
    "point": found("all qeq/point 1 4.5 1e-6 100 QFILE"),
    "point, mesh": found("all qeq/point 1 5.0 1e-12 100 QFILE", *CHARGED, pairs=LONG, runs=["run 3", "run 3"]),
    "shielded, few iterations": found("all qeq/shielded 1 5.0 1e-20 4 QFILE"),
    "shielded, every other step": found("all qeq/shielded 2 5.0 1e-6 100 QFILE", runs=["run 3", "run 3"]),
    "slater, few iterations": found("all qeq/slater 1 5.0 1e-20 5 QFILE"),
    "slater": found("all qeq/slater 1 5.0 1e-8 100 QFILE alpha 0.3", runs=["run 0"]),
    "dynamic": found("all qeq/dynamic 1 5.0 1e-3 30 QFILE", *CHARGED),
    "dynamic, options": found("all qeq/dynamic 1 5.0 1e-3 30 QFILE qdamp 0.2 qstep 0.01"),
    "fire": found("all qeq/fire 1 5.0 1e-12 300 QFILE", *CHARGED, runs=["run 3"]),
}


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    path = tmp_path_factory.mktemp("qeq") / "par.qeq"
    path.write_text(PARAMETERS)
    return str(path)


@pytest.fixture(scope="module")
def lammps(tmp_path_factory, file):
    for c in CASES.values():
        c["commands"] = [line.replace("QFILE", file) for line in c["commands"]]
    return lammps_of(CASES, tmp_path_factory.mktemp("lammps"))


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", CASES)
def test_against_lammps(name, lammps):
    compare(name, CASES[name], lammps[name])


IONS = ["units metal", "atom_style charge", "atom_modify map array", "boundary f f f", "region b block 0 40 0 40 0 40", "create_box 2 b",
        *(f"create_atoms {t} single {x} {y} {z}" for t, x, y, z in ((1, 5, 5, 5), (2, 6.5, 5, 5), (2, 7, 6.5, 5.3), (1, 5.2, 7.1, 4.4),
                                                                   (2, 9, 9, 9))),
        "mass * 10", "pair_style coul/cut 10.0", "pair_coeff * *"]
TWO = {1: dict(chi=0.5, eta=7.25, gamma=0.8), 2: dict(chi=11.27, eta=15.4, gamma=0.7)}


def potentials(x, q, coupling):
    """What the energy of charges changes by with each charge."""
    kinds = np.array([1, 2, 2, 1, 2])
    chi, eta, gamma = (np.array([TWO[t][name] for t in kinds]) for name in ("chi", "eta", "gamma"))
    r = np.linalg.norm(x[:, None] - x[None], axis=-1)
    with np.errstate(divide="ignore"):
        j = np.where(r > 0.0, coupling(r, gamma[:, None] * gamma[None]), 0.0)
    return chi + eta * q + j @ q


def tapered(r, gamma):
    """The energy of two shielded charges with a cutoff of 8."""
    t = r / 8.0
    return 14.4 * (1 - 35 * t**4 + 84 * t**5 - 70 * t**6 + 20 * t**7) / np.cbrt(r**3 + gamma**-1.5) * (r < 8.0)


@pytest.mark.parametrize("fix, cut, coupling", [(QEqPoint, 8.0, lambda r, _: np.where(r < 8.0, 1.0 / r, 0.0)), (QEqShielded, 8.0, tapered),
                                                (QEqFire, 8.0, lambda r, _: np.where(r < 8.0, 1.0 / r, 0.0))])
def test_electronegativities_are_equal(fix, cut, coupling):
    """From Python; of a group in the field of the others, which keep their charges."""
    for group, members in (("all", range(5)), ("some", (0, 1, 2))):
        with ran([*IONS, "set atom 4*5 charge 0.3", "group some id 1:3"]) as lmp:
            scene = lmp.session.scene
            scene.fixes["q"] = made = fix(group, cutoff=cut, tolerance=1e-14, maxiter=2000, parameters=TWO)
            made.id = "q"
            lmp.command("run 0")
            q, x = np.array(lmp.gather_atoms("q", 1, 1)), np.array(lmp.gather_atoms("x", 1, 3)).reshape(-1, 3)
        mu = potentials(x, q, coupling)[list(members)]
        assert np.ptp(mu) < 1e-10 and abs(q[list(members)]).max() > 0.1
        assert q[list(members)].sum() == pytest.approx(0.6 if group == "all" and fix is QEqFire else 0.0, abs=1e-12)
        if group == "some":
            assert (q[3:] == 0.3).all()


def test_minimisation_keeps_electronegativities_equal():
    with ran(IONS) as lmp:
        scene = lmp.session.scene
        scene.fixes["q"] = made = QEqShielded("all", cutoff=8.0, tolerance=1e-14, parameters=TWO)
        made.id = "q"
        lmp.commands_list(["pair_style lj/cut/coul/cut 9.0", "pair_coeff * * 0.5 2.3", "minimize 0 0 5 20"])
        q, x = np.array(lmp.gather_atoms("q", 1, 1)), np.array(lmp.gather_atoms("x", 1, 3)).reshape(-1, 3)
        assert np.abs(x[0] - 5.0).max() > 1e-3
    assert np.ptp(potentials(x, q, tapered)) < 1e-9


@pytest.mark.filterwarnings("ignore")
def test_goes_on_from_a_restart_file(file, tmp_path):
    """The guesses of the next charges too."""
    write_data(tmp_path / "data", style="full")
    fixes = [f"fix 2 all qeq/shielded 1 5.0 1e-4 6 {file} warn no", *NVE]
    begin = script(tmp_path / "data", style="full").splitlines()
    with ran([*begin, *PAIR, *fixes, "run 5", f"write_restart {tmp_path / 'r'}", "run 4"]) as lmp:
        whole = [np.array(lmp.gather_atoms(name, 1, n)) for name, n in (("q", 1), ("x", 3), ("f", 3))]
    with ran([f"read_restart {tmp_path / 'r'}", *PAIR, *fixes, "run 4"]) as lmp:
        parts = [np.array(lmp.gather_atoms(name, 1, n)) for name, n in (("q", 1), ("x", 3), ("f", 3))]
    assert all(np.array_equal(a, b) for a, b in zip(whole, parts, strict=True))


@pytest.mark.parametrize("text, words, message", [
    ("1 0 7 1 1 0\n", "1 8 1e-6 100", "atom type 2 has no parameters"), ("1*2 0 -7 1 1 0\n", "1 8 1e-6 100", "eta must be positive"),
    ("1 0 7 1 1\n2 0 7\n", "1 8 1e-6 100", "got 5 words.*par.qeq:1"), ("3 0 7 1 1 0\n", "1 8 1e-6 100", "par.qeq:1"),
    ("1*2 0 7 0 1 0\n", "1 8 1e-6 100", "gamma must be positive"), ("# UNITS: real\n1*2 0 7 1 1 0\n", "1 8 1e-6 100", "in real units"),
    ("1*2 0 7 1 1 0\n", "0 8 1e-6 100", "Nevery must be positive"), ("1*2 0 7 1 1 0\n", "1 8 0 100", "tolerance must be positive"),
    ("1*2 0 7 1 1 0\n", "1 8 1e-6", "Nevery cutoff tolerance maxiter qfile"), (None, "1 8 1e-6 100", "par.qeq")])
def test_bad_input(text, words, message, tmp_path):
    if text is not None:
        (tmp_path / "par.qeq").write_text(text)
    with start() as lmp, pytest.raises(InputError, match=message):
        lmp.commands_list([*IONS, f"fix q all qeq/shielded {words} {tmp_path / 'par.qeq'}"])


def test_what_a_run_refuses(file, tmp_path):
    for before, message in ((["atom_style atomic"], "needs atom attribute q"), (["group none empty"], "has no atoms")):
        group = "none" if "empty" in before[0] else "all"
        lines = [before[0] if line.startswith("atom_style") and "atom_style" in before[0] else line for line in IONS[:-2]]
        (tmp_path / "two").write_text("1*2 0 7 1 1 0\n")
        with start() as lmp, pytest.raises(InputError, match=message):
            lmp.commands_list([*lines, *(before if group == "none" else []), f"fix q {group} qeq/point 1 8 1e-6 100 {tmp_path / 'two'}"])
    with start() as lmp, pytest.raises(InputError, match="needs pair_style coul/streitz"):
        lmp.commands_list([*IONS, "fix q all qeq/slater 1 8 1e-6 100 coul/streitz"])
    with start() as lmp, pytest.warns(UserWarning, match="did not converge"):
        lmp.commands_list([*IONS, f"fix q all qeq/point 1 8 1e-20 2 {tmp_path / 'two'}", "run 0"])


def test_streitz_mintmire_charges_minimise_the_energy(tmp_path):
    """With ``coul/streitz wolf`` and the same damping the charges are those of the least energy of the pair style."""
    (tmp_path / "AlO").write_text("Al 0.0 10.328655 0.0 0.968438 0.763905\nO 5.484763 14.035715 0.0 2.143957 0.0\n")
    lines = [*IONS[:-2], "pair_style coul/streitz 8.0 wolf 0.5", f"pair_coeff * * {tmp_path / 'AlO'} Al O"]
    lmp = Lammps(cmdargs=["-screen", "none", "-log", "none"])
    lmp.commands_list([*lines, "fix q all qeq/slater 1 8.0 1e-14 200 coul/streitz alpha 0.5", "run 0"])
    q = np.array(lmp.gather_atoms("q", 1, 1))
    lmp.commands_list(["unfix q"])

    def energy(charges):
        lmp.scatter_atoms("q", 1, 1, charges)
        lmp.command("run 0 post no")
        return lmp.get_thermo("pe")
    at = energy(q)
    for k in range(4):
        step = np.zeros(5)
        step[k], step[k + 1] = 0.01, -0.01
        up, down = energy(q + step), energy(q - step)
        assert up > at < down and abs(up - down) < 5e-3 * (up + down - 2.0 * at)
    lmp.close()
