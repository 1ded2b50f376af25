"""Constraints: what they hold, what they cost the energy, threads, SETTLE, ASE, and words that make no sense."""
from __future__ import annotations

import numpy as np
import pytest
import shake_scene as scene

from asemd.errors import InputError, InputWarning, SimulationError
from asemd.fix import constraint_clusters as cc
from asemd.fix.rattle import Rattle
from asemd.fix.shake import Shake
from asemd.lammps import Lammps

WATER = "b 1 a 1"


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    folder = tmp_path_factory.mktemp("shake")
    for name, offset in (("across", 0.0), ("inside", 0.5)):
        scene.write_data(folder / f"data.{name}", offset=offset)
    scene.write_data(folder / "data.water", ethanols=0)
    return folder


def start(path, *commands: str, switches=()) -> Lammps:
    lmp = Lammps(cmdargs=["-screen", "none", "-log", "none", *switches])
    for line in [*scene.head(path).splitlines(), *commands]:
        if line.strip():
            lmp.command(line)
    return lmp


def state(lmp) -> tuple[np.ndarray, np.ndarray]:
    return tuple(np.array(lmp.gather_atoms(name, 1, 3)).reshape(-1, 3) for name in ("x", "v"))


def droplet(path, dt: float, steps: int, fix: str) -> np.ndarray:
    """Total energies of a droplet of water without cutoffs, 20 of them."""
    lmp = start(path, "pair_style lj/cut/coul/cut 40.0", "pair_coeff 1 1 0.1553 3.166", "pair_coeff * 2*3 0.0 1.0",
                "change_box all boundary f f f", "change_box all x delta -100 100 y delta -100 100 z delta -100 100",
                "fix 1 all nve", f"fix s all {fix}", "velocity all create 150 1234", "timestep 0.5", "run 400",
                "velocity all scale 150", f"timestep {dt}", "run 20")
    energies = []
    for _ in range(20):
        lmp.command(f"run {steps // 20}")
        energies.append(lmp.get_thermo("etotal"))
    loop = lmp.session.loop
    assert loop.fixes[-1].constraint_error(loop) < 1e-6
    lmp.close()
    return np.array(energies)


@pytest.mark.parametrize("fix", [f"shake 1e-8 100 0 {WATER}", f"shake 1e-4 20 0 {WATER} settle yes", f"rattle 1e-8 100 0 {WATER}"])
def test_rigid_water_keeps_its_energy(fix, data):
    """At 2 fs: the error is of second order in the timestep, and no drift stands out of it."""
    fine, coarse = droplet(data / "data.water", 1.0, 800, fix), droplet(data / "data.water", 2.0, 400, fix)
    kinetic = 0.5 * 6 * 27 * 0.0019872067 * 150
    assert coarse.std() < 0.02 * kinetic
    assert abs(coarse[-5:].mean() - coarse[:5].mean()) < 0.02 * kinetic
    assert fine.std() < 0.5 * coarse.std()


@pytest.mark.parametrize("kind", ["shake", "rattle"])
def test_settle_is_the_limit_of_iterations(kind, data):
    """Solved in one go and iterated to the end: the same trajectory; the triangles are rigid to the last digits."""
    found = []
    for words in ("1e-14 500 0", "1e-3 1 0"):
        lmp = start(data / "data.across", "fix 1 all nve", f"fix s water {kind} {words} b 1 a 1" + " settle yes" * (words[:4] == "1e-3"),
                    "timestep 2.0", "run 40")
        found.append((*state(lmp), lmp.get_thermo("pxy")))
        lmp.close()
    (x, v, pxy), (x2, v2, pxy2) = found
    assert abs(x - x2).max() < 1e-9
    assert abs(v - v2).max() < 1e-9
    assert pxy == pytest.approx(pxy2, rel=1e-7)


@pytest.mark.parametrize("kind", ["shake", "rattle"])
def test_threads(kind, data):
    """Clusters split over threads: the same but for the order of sums."""
    found = []
    for switches in ((), ("-threads", "2")):
        lmp = start(data / "data.across", "fix 1 all nve", f"fix s all {kind} 1e-8 100 0 {scene.ALL}", "run 30", switches=switches)
        found.append((*state(lmp), lmp.get_thermo("press")))
        lmp.close()
    assert abs(found[0][0] - found[1][0]).max() < 1e-11
    assert abs(found[0][1] - found[1][1]).max() < 1e-12
    assert found[0][2] == pytest.approx(found[1][2], rel=1e-9)


def test_rattle_leaves_no_velocity_along_bonds(data):
    """Across faces of the box too."""
    lmp = start(data / "data.across", "fix 1 all nve", f"fix s all rattle 1e-10 100 0 {scene.ALL}", "run 20")
    system = lmp.session.scene.system
    fix = lmp.session.scene.fixes["s"]
    _, _, ends = fix.clusters.pairs()
    d = system.box.minimum_image(system.x[ends[:, 0]] - system.x[ends[:, 1]])[0]
    assert abs((d * (system.v[ends[:, 0]] - system.v[ends[:, 1]])).sum(axis=1)).max() < 1e-14
    assert fix.virials(lmp.session.loop.snapshot()).sum(axis=0) == pytest.approx(lmp.session.loop.result.virial_of["fix"], rel=1e-12)
    lmp.close()


@pytest.mark.parametrize("kind", ["shake", "rattle"])
def test_where_the_faces_of_the_box_are_does_not_matter(kind, data):
    """Molecules across them move as those inside; a second ``run 0`` changes nothing. (LAMMPS's rattle does depend on it.)"""
    found = []
    for name in ("across", "inside"):
        lmp = start(data / f"data.{name}", "fix 1 all nve", f"fix s all {kind} 1e-6 100 0 {scene.ALL}")
        seen = []
        for run in ("run 0", "run 0", "run 20"):
            lmp.command(run)
            seen.append((state(lmp)[1], lmp.get_thermo("press")))
        found.append(seen)
        lmp.close()
    for (v, press), (v2, press2) in zip(*found):
        assert abs(v - v2).max() < 1e-13
        assert press == pytest.approx(press2, rel=1e-9)
    assert kind == "shake" or abs(found[0][0][0] - found[0][1][0]).max() < 1e-9


def test_clusters(data):
    """Kinds, turned-off bonds that come back, degrees of freedom."""
    lmp = start(data / "data.across", f"fix s all shake 1e-4 20 0 {scene.ALL}")
    system, fix = lmp.session.scene.system, lmp.session.scene.fixes["s"]
    assert [fix.clusters.count(k) for k in (cc.PAIR, cc.TWO, cc.THREE, cc.ANGLE)] == [6, 6, 6, 21]
    assert (system.topology.bond_types < 0).sum() == 6 + 12 + 18 + 42
    assert (system.topology.angle_types < 0).sum() == 21
    assert fix.removed_dof(np.ones(system.n, bool)) == 6 + 12 + 18 + 63
    lmp.command("unfix s")
    assert (lmp.session.scene.system.topology.bond_types > 0).all()
    assert (lmp.session.scene.system.topology.angle_types > 0).all()
    lmp.close()


@pytest.mark.parametrize(("words", "message"), [
    ("1e-4 20 0 b 2 3", "has 4 bonds that are to be held"), ("1e-4 20 0 b 3 4", "clusters are connected: atoms"),
    ("1e-4 20 0 b 9", "no bond type 9"), ("1e-4 20 0 b 0", "no bond type 0"), ("1e-4 20 0 a 9", "no angle type 9"),
    ("1e-4 20 0 t 9", "no atom type 9"), ("1e-4 20 0 m 0.0", "must not be 0"), ("1e-4 20 0 b 1.5", "whole number"),
    ("1e-4 20 0", "needs tol iter N"), ("1e-4 20 0 b", "needs tol iter N"), ("1e-4 x 0 b 1", "whole number"),
    ("x 20 0 b 1", "expected a number"),
    ("1e-4 20 0 b 1 kbond", "1 value"), ("1e-4 20 0 b 1 kbond -3", "must not be negative"), ("1e-4 20 0 b 1 mol xx", "no molecule xx"),
    ("1e-4 20 0 b 1 kbond 3 a 1", "come before kbond"), ("1e-4 20 0 kbond 3", "to be held"), ("1e-4 20 0 x 3", "unknown keyword 'x'"),
    ("1e-4 20 0 b 1 store yes", "whole number"), ("1e-4 20 0 b 1 settle maybe", "yes or no"),
])
@pytest.mark.parametrize("kind", ["shake", "rattle"])
def test_bad_words(kind, words, message, data):
    session = start(data / "data.across").session
    with pytest.raises(InputError, match=message):
        session.execute(f"fix s all {kind} {words}")


@pytest.mark.parametrize(("commands", "message"), [
    (["fix s all shake 1e-4 20 0 b 1", "fix t all shake 1e-4 20 0 b 2"], "there can be only one"),
    (["fix h all ehex 1 0.1 constrain"], "constrain needs a fix shake or rattle"),
    (["bond_style none", "fix s all shake 1e-4 20 0 b 1"], "bond_style must be defined"),
    (["angle_style none", f"fix s all shake 1e-4 20 0 {WATER}"], "angle_style must be defined"),
    (["fix s all shake 1e-4 20 0 b 1", "timestep 0"], "with timestep 0 no force keeps the distances"),
    (["thermo_modify lost/bond ignore", "fix s all shake 1e-4 20 0 b 1 2 4", "delete_atoms group hydrogen"], "not all of them are there"),
])
def test_bad_runs(commands, message, data):
    session = start(data / "data.across", "fix 1 all nve", "group hydrogen id 1 2 3").session
    for command in commands:
        session.execute(command)
    with pytest.raises(InputError, match=message):
        session.execute("run 0")


def test_watchdog_names_a_broken_constraint(data):
    session = start(data / "data.water", "fix 1 all nve", "fix s all shake 1e-4 1 0 b 1 a 1", "timestep 8.0").session
    with pytest.raises(SimulationError):
        session.execute("run 300")


@pytest.mark.parametrize("cls", [Shake, Rattle])
def test_words_again(cls, data):
    words = "1e-05 20 0 b 1 2 a 1 t 2 m 1.008 kbond 500.0 settle yes".split()
    session = start(data / "data.across").session
    fix = cls.from_lammps("water", words, session)
    assert fix.to_lammps() == words
    with pytest.raises(InputError, match="to be held"):
        cls()


def test_with_ase(data):
    """The same fix under asemd.MolecularDynamics: bonds stay, the atoms' own topology is as before."""
    from ase import units

    import asemd
    lmp = start(data / "data.water")
    atoms = lmp.session.scene.to_atoms()
    lmp.command("fix water all shake 1e-4 100 0 b 1 a 1")
    with pytest.warns(InputWarning, match="fix water .shake., without which nothing holds its bonds and angles, is not part"):
        lmp.session.scene.to_atoms()
    before = atoms.topology.bond_types.copy()
    fixes = [asemd.fix.NVE(), Shake(tolerance=1e-7, iterations=100, bonds=[1], angles=[1])]
    md = asemd.MolecularDynamics(atoms, 2.0 * units.fs, fixes=fixes)
    md.run(20)
    bonds = atoms.topology.bonds
    d = atoms.get_positions()[bonds[:, 0]] - atoms.get_positions()[bonds[:, 1]]
    d -= scene.LENGTH * np.round(d / scene.LENGTH)
    assert np.linalg.norm(d, axis=1) == pytest.approx(1.0, abs=1e-6)
    assert np.array_equal(before, atoms.topology.bond_types)


def test_scripts_for_lammps(data):
    """What LAMMPS knows is written, what it does not is refused; it runs on levels."""
    session = start(data / "data.across", "fix 1 all nve", f"fix s all shake 1e-4 20 0 {WATER}").session
    from asemd.lammps import convert
    session.execute("run_style respa 2 2 bond 1 pair 2")
    session.execute(f"fix s all shake 1e-4 20 0 {WATER} settle yes")
    session.execute("run 2")
    assert session.loop.fixes[-1].constraint_error(session.loop) < 1e-13
    with pytest.raises(InputError, match="settle of fix s"):
        convert._of_lammps(session.scene)


def test_type_labels(data):
    """They stand for the types of bonds, angles and atoms."""
    found = []
    for words in ("b OH a HOH t C1", "b 1 a 1 t 2"):
        labels = "labelmap bond 1 OH", "labelmap angle 1 HOH", "labelmap atom 2 C1"
        lmp = start(data / "data.water", *labels, f"fix s all shake 1e-4 20 0 {words}")
        found.append(lmp.scene.fixes["s"].to_lammps())
    assert found[0] == found[1]
