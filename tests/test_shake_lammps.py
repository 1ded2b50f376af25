"""Fix shake and rattle move atoms as LAMMPS does: every kind of cluster, several tolerances, with thermostats and minimisation."""
from __future__ import annotations

import numpy as np
import pytest
import shake_scene as scene
from shake_scene import ALL, NVE, VALUES
from wheel import ask, ran

PLAIN = ["run 0", "run 60", "run 40"]
SHORT, THREE = ["run 0", "run 30", "run 20"], "run_style respa 3 2 2 bond 1 angle 2 pair 3"
HALF = "region half block 0 6.5 INF INF INF INF"
ENERGIES = ("temp", "pe", "ebond", "eangle")      # LAMMPS counts half of the virial of springs
ADAPT = ["variable e equal 0.5+0.01*step", "fix a all adapt 1 pair lj/cut/coul/cut epsilon 1 3 v_e"]
CASES = {
    "all kinds": ([NVE, f"fix s all shake 1e-6 100 0 {ALL}"], PLAIN),
    "loose": ([NVE, f"fix s all shake 1e-3 5 0 {ALL}", "timestep 2"], PLAIN),
    "one iteration": ([NVE, f"fix s all shake 1e-4 1 0 {ALL}"], ["run 40"]),
    "frozen CH2": ([NVE, "fix s all shake 1e-5 20 0 b 1 2 a 1 2"], PLAIN),
    "types and masses": ([NVE, "fix s all shake 1e-5 20 0 t 2 a 1"], PLAIN),
    "masses": ([NVE, "fix s water shake 1e-5 20 0 m 1.0 a 1"], ["run 40"]),
    "nvt": (["fix 1 all nvt temp 300 300 50", f"fix s all shake 1e-5 20 0 {ALL}", "velocity all create 300 4711 dist gaussian"], PLAIN),
    "no virial": ([NVE, f"fix s all shake 1e-5 20 0 {ALL}", "fix_modify s virial no"], ["run 20"]),
    "unfix": ([NVE, f"fix s all shake 1e-5 20 0 {ALL}", "run 10", "unfix s"], ["run 20"]),
    "replaced": ([NVE, f"fix s all shake 1e-5 20 0 {ALL}", "run 10", "fix s all shake 1e-5 20 0 b 4"], ["run 20"]),
    "minimise": ([f"fix s all shake 1e-5 20 0 {ALL} kbond 2000.0", NVE], ["minimize 0 0 8 50"], ENERGIES),
    "minimise, run": ([f"fix s all shake 1e-5 20 0 {ALL} kbond 2000.0", NVE], ["minimize 0 0 8 50", "run 20"], ENERGIES),
    "minimise default": ([f"fix s all shake 1e-5 20 0 {ALL}", NVE, "run 0"], ["minimize 0 0 3 50"], ENERGIES),
    "minimise no energy": ([f"fix s all shake 1e-5 20 0 {ALL} kbond 500.0", "fix_modify s energy no virial no"], ["minimize 0 0 5 50"]),
    "rattle": ([NVE, f"fix s all rattle 1e-6 100 0 {ALL}"], PLAIN),
    "rattle loose": ([NVE, "fix s all rattle 1e-4 4 0 b 1 2 4 a 1 2", "timestep 2"], PLAIN),
    "rattle minimise": ([f"fix s all rattle 1e-5 20 0 {ALL} kbond 2000.0"], ["minimize 0 0 5 50"], ENERGIES),
    "ehex": ([NVE, f"fix s all shake 1e-6 100 0 {ALL}", "fix h all ehex 1 0.05 constrain"], ["run 0", "run 40"]),
    "ehex com": ([NVE, f"fix s all shake 1e-6 100 0 {ALL}", HALF, "fix h all ehex 2 -0.02 region half com constrain"], PLAIN),
    "ehex group": ([NVE, "fix s all shake 1e-6 100 0 b 1", "fix h water ehex 3 0.02 constrain com hex"], PLAIN),
    "ehex first": (["fix h all ehex 1 0.05 constrain", NVE, f"fix s all shake 1e-6 100 0 {ALL}"], ["run 0", "run 40"]),
    "ehex tilted": ([NVE, f"fix s all shake 1e-6 100 0 {ALL}", HALF, "fix h all ehex 1 0.02 region half com constrain"], ["run 40"]),
    "ehex rattle": ([NVE, f"fix s all rattle 1e-6 100 0 {ALL}", HALF, "fix h all ehex 2 0.05 region half com constrain"], PLAIN),
    "two levels": ([NVE, f"fix s all shake 1e-6 100 0 {ALL}", "run_style respa 2 2 bond 1 pair 2"], SHORT),
    "three levels": ([NVE, f"fix s all shake 1e-6 100 5 {ALL}", THREE, "group some id 1:30", "fix a some addforce 0.1 0 -0.1"], SHORT),
    "three levels, npt": ([f"fix s all shake 1e-6 100 0 {ALL}", "fix 1 all npt temp 300 300 50 iso 1 1 200", THREE], SHORT),
    "two levels, rattle": ([NVE, f"fix s all rattle 1e-6 100 0 {ALL}", "run_style respa 2 3 bond 1 angle 2"], SHORT),
    "three levels, rattle": ([NVE, f"fix s all rattle 1e-6 100 0 {ALL}", "fix_modify s virial no", THREE], SHORT),
    "levels, ehex": ([NVE, f"fix s all shake 1e-6 100 0 {ALL}", "fix h all ehex 3 0.05 constrain", THREE], SHORT),
    "tilted": ([NVE, f"fix s all shake 1e-6 100 0 {ALL}"], ["run 40"]),
    "adapt": ([NVE, f"fix s all shake 1e-6 100 0 {ALL}", *ADAPT], ["run 0", "run 20"]),
    "levels, adapt": ([NVE, f"fix s all shake 1e-6 100 0 {ALL}", *ADAPT, THREE], ["run 0", *SHORT]),
}


@pytest.fixture(scope="module")
def cases(tmp_path_factory):
    return scripts(tmp_path_factory.mktemp("shake"))


def scripts(folder) -> dict[str, tuple]:
    """The cases; across faces of the box LAMMPS counts springs twice and forgets velocities of rattle, so those are for shake only."""
    tilt = (3.0, -2.0, 1.0)
    for name, offset, tilts in (("across", 0.0, ()), ("inside", 0.5, ()), ("tilted", 0.0, tilt)):
        scene.write_data(folder / f"data.{name}", offset=offset, tilt=tilts)
    out = {}
    for name, (commands, runs, *values) in CASES.items():
        data = "tilted" if "tilted" in name else "inside" if "rattle" in name or "minimise" in name else "across"
        out[name] = (scene.head(folder / f"data.{data}"), commands, runs, *(values or [VALUES]))
    return out


@pytest.fixture(scope="module")
def expected(cases):
    return ask(scene.ASK, cases=cases)


@pytest.mark.parametrize("name", CASES)
def test_like_lammps(name, cases, expected):
    words = ("-compat", "lammps") if name.endswith("levels, rattle") else ()
    for stretch, (ours, theirs) in enumerate(zip(scene.measure(*cases[name], words=words), expected[name], strict=True)):
        for what, a, b in zip("xvf", ours, theirs):
            limit = 1e-8 if "default" in name else 3e-11     # very stiff springs
            assert abs(a - b).max() <= limit * abs(b).max(), (what, stretch)
        for formula, a, b in zip(cases[name][3], ours[3], theirs[3], strict=True):
            assert a == pytest.approx(b, rel=1e-8, abs=1e-6), (formula, stretch)


def test_rattle_on_levels(cases, expected):
    """By default only forces and pressure differ from LAMMPS's: those are of the motion, close to those without levels."""
    name = "three levels, rattle"
    head, commands, *_ = cases[name]
    commands = [c for c in commands if "virial no" not in c]
    plain = [c for c in commands if "respa" not in c]
    runs = ["run 30"]
    (ours,), (theirs,), (single,) = (scene.measure(head, c, runs, VALUES, words=w)
                                     for c, w in ((commands, ()), (commands, ("-compat", "lammps")), (plain, ())))
    for a, b in zip(ours[:2], theirs[:2]):
        assert abs(a - b).max() < 1e-9 * abs(b).max()
    press = VALUES.index("press")
    assert abs(ours[3][press] - single[3][press]) < 0.5 * abs(theirs[3][press] - single[3][press])


def test_virials_of_atoms(cases):
    """Each atom's share in the virial of its cluster."""
    lines = [line for line in cases["all kinds"][0].splitlines() if line.strip()]
    lines += [NVE, f"fix s all shake 1e-6 100 0 {ALL}", "compute s all stress/atom NULL virial", "thermo 10", "run 10"]
    theirs = ask("""
lmp = ran(given["lines"])
answer = np.array(lmp.gather("c_s", 1, 6)).reshape(-1, 6)
""", lines=lines)
    lmp = ran(lines)
    seen = lmp.session.moment.snapshot
    ours = lmp.session.scene.computes["s"].per_atom(seen)[np.argsort(seen.system.id)]
    lmp.close()
    assert abs(ours - theirs).max() < 1e-11 * abs(theirs).max()
