"""The time loop as an ASE dynamics: the motion of ase.md, observers, files, fixes, constraints, restarts."""
from __future__ import annotations

import io
import os
import signal
import threading

import numpy as np
import pytest
from ase import units
from ase.calculators.emt import EMT
from ase.constraints import FixAtoms, FixBondLength, FixCartesian
from ase.io.trajectory import Trajectory
from ase.md.verlet import VelocityVerlet
from test_calculator import argon, read, script, waters

from asemd.dynamics import MolecularDynamics
from asemd.errors import InputError, SimulationError
from asemd.fix.langevin import Langevin
from asemd.fix.npt import NPT
from asemd.fix.nve import NVE
from asemd.fix.nvt import NVT

DT = 2 * units.fs


def hot_argon(temperature: float = 80.0, n: int = 3):
    atoms = argon(n)
    rng = np.random.default_rng(4)
    atoms.set_momenta(rng.normal(0, 1, (len(atoms), 3)) * np.sqrt(units.kB * temperature * atoms.get_masses())[:, None])
    return atoms


def hot_waters():
    atoms = waters(2)
    atoms.set_momenta(np.random.default_rng(4).normal(0, 1, (len(atoms), 3)) * np.sqrt(units.kB * 100 * atoms.get_masses())[:, None])
    return atoms


# ------------------------------------------------------------------------------------------------------------------------- motion ---

@pytest.mark.parametrize("make, dt", [(hot_argon, DT), (hot_waters, 0.25 * units.fs)])
def test_the_motion_of_ase(make, dt):
    ours, theirs = make(), make()
    MolecularDynamics(ours, dt).run(100)
    VelocityVerlet(theirs, dt).run(100)
    assert np.abs(ours.positions - theirs.positions).max() < 1e-10
    assert np.abs(ours.get_velocities() - theirs.get_velocities()).max() < 1e-10
    assert ours.get_potential_energy() == pytest.approx(theirs.get_potential_energy(), rel=1e-11)
    assert np.allclose(ours.get_forces(), theirs.get_forces(), atol=1e-9)
    assert np.allclose(ours.get_stress(), theirs.get_stress(), atol=1e-12)


@pytest.mark.parametrize("unit", ["real", "metal", "lj"])
def test_units_of_scripts(tmp_path, unit):
    ours, theirs = (read(tmp_path, script(unit)) for _ in range(2))
    dt = 0.5 * units.fs if unit != "lj" else 0.002
    for atoms in (ours, theirs):
        atoms.set_velocities(np.random.default_rng(1).normal(0, 0.002 if unit != "lj" else 1.0, (len(atoms), 3)))
    MolecularDynamics(ours, dt).run(50)
    VelocityVerlet(theirs, dt).run(50)
    # LAMMPS's constants, which the loop uses, differ from ASE's in the seventh digit
    assert np.abs(ours.positions - theirs.positions).max() < (1e-11 if unit == "lj" else 2e-7)
    assert ours.get_total_energy() == pytest.approx(theirs.get_total_energy(), rel=1e-6)


def test_positions_are_not_wrapped(tmp_path):
    """Atoms cross faces, also atoms that carry image flags from a script."""
    atoms = read(tmp_path, script("real"))
    assert atoms.arrays["image"].any()
    start = atoms.positions.copy()
    v = np.random.default_rng(1).normal(0, 0.05, (len(atoms), 3))
    atoms.set_velocities(v)
    seen = [start]
    dynamics = MolecularDynamics(atoms, 0.5 * units.fs)
    dynamics.attach(lambda: seen.append(atoms.positions.copy()), interval=5)
    dynamics.run(100)
    assert np.abs(np.diff(seen, axis=0)).max() < 1.0
    scaled = atoms.get_scaled_positions(wrap=False)
    assert (scaled < 0).any() and (scaled > 1).any()


def test_argon_at_rest_starts_from_zero_momenta():
    atoms = argon(2)
    MolecularDynamics(atoms, DT).run(5)
    assert atoms.get_kinetic_energy() > 0


# ---------------------------------------------------------------------------------------------------------------------- observers ---

def test_observers_see_their_steps():
    atoms = hot_argon()
    dynamics = MolecularDynamics(atoms, DT)
    calls = {3: [], 7: [], -11: [], 0: []}
    for interval, seen in calls.items():
        dynamics.attach(lambda seen=seen: seen.append((dynamics.nsteps, atoms.positions.copy(), atoms.get_momenta(),
                                                       atoms.get_potential_energy(), atoms.get_forces())), interval=interval)
    dynamics.run(20)
    assert [s for s, *_ in calls[3]] == [0, 3, 6, 9, 12, 15, 18]
    assert [s for s, *_ in calls[7]] == [0, 7, 14]
    assert [s for s, *_ in calls[-11]] == [11] and [s for s, *_ in calls[0]] == [0]
    dynamics.run(10)
    assert [s for s, *_ in calls[3]][-4:] == [21, 24, 27, 30]
    other = hot_argon()
    reference = VelocityVerlet(other, DT)
    for step, x, p, e, f in calls[3]:
        reference.run(step - reference.nsteps)
        assert np.abs(x - other.positions).max() < 1e-10 and np.abs(p - other.get_momenta()).max() < 1e-8
        assert e == pytest.approx(other.get_potential_energy(), rel=1e-11)
        assert np.allclose(f, other.get_forces(), atol=1e-9)


def test_irun_yields_every_step():
    atoms = hot_argon()
    dynamics = MolecularDynamics(atoms, DT)
    steps, x = [], []
    for done in dynamics.irun(6):
        steps.append((dynamics.nsteps, done))
        x.append(atoms.positions.copy())
    assert steps == [(k, k == 6) for k in range(7)]
    other = hot_argon()
    for k, _ in enumerate(VelocityVerlet(other, DT).irun(6)):
        assert np.abs(x[k] - other.positions).max() < 1e-11


def test_steps_by_hand():
    ours, theirs = hot_argon(), hot_argon()
    dynamics = MolecularDynamics(ours, DT)
    for _ in range(5):
        dynamics.step()
    VelocityVerlet(theirs, DT).run(5)
    assert np.abs(ours.positions - theirs.positions).max() < 1e-11


def test_observers_may_change_the_atoms():
    def stop(atoms, dynamics):
        if dynamics.nsteps == 10:
            atoms.set_momenta(np.zeros((len(atoms), 3)))
            atoms.positions[0] += 0.05
    results = []
    for kind in (MolecularDynamics, VelocityVerlet):
        atoms = hot_argon()
        dynamics = kind(atoms, DT)
        dynamics.attach(stop, 5, atoms, dynamics)
        dynamics.run(20)
        results.append(atoms.positions.copy())
    assert np.abs(results[0] - results[1]).max() < 1e-10


def test_log_and_trajectory(tmp_path):
    logs = []
    for kind, name in ((MolecularDynamics, "ours"), (VelocityVerlet, "theirs")):
        atoms, log = hot_argon(), io.StringIO()
        with Trajectory(tmp_path / f"{name}.traj", "w", atoms) as trajectory:
            dynamics = kind(atoms, DT, logfile=log, loginterval=10)
            dynamics.attach(trajectory, interval=5)
            dynamics.run(20)
        logs.append(log.getvalue())
    assert logs[0] == logs[1] and len(logs[0].splitlines()) == 4
    ours, theirs = (list(Trajectory(tmp_path / f"{name}.traj")) for name in ("ours", "theirs"))
    assert len(ours) == len(theirs) == 5
    for a, b in zip(ours, theirs):
        assert np.abs(a.positions - b.positions).max() < 1e-10
        assert a.get_potential_energy() == pytest.approx(b.get_potential_energy(), rel=1e-11)
        assert np.allclose(a.get_forces(), b.get_forces(), atol=1e-9)


def test_observer_intervals_do_not_change_the_motion():
    results = []
    for interval in (1, 7, 1000):
        atoms = hot_argon()
        dynamics = MolecularDynamics(atoms, DT)
        dynamics.attach(lambda: None, interval)
        dynamics.run(50)
        results.append(atoms.positions.copy())
    assert np.abs(results[0] - results[1]).max() < 1e-10 and np.abs(results[0] - results[2]).max() < 1e-10


# -------------------------------------------------------------------------------------------------------------------------- fixes ---

def nvt():
    return NVT(temperature=(60.0, 60.0), damping=5.0)


def test_runs_in_pieces_continue():
    for fixes in (lambda: None, lambda: [nvt()], lambda: [NVE(), Langevin(temperature=60.0, damping=20.0, seed=5)]):
        results = []
        for pieces in ((60,), (20, 40), (1, 58, 1)):
            atoms = hot_argon()
            dynamics = MolecularDynamics(atoms, DT, fixes())
            for steps in pieces:
                dynamics.run(steps)
            assert dynamics.nsteps == 60
            results.append(atoms.positions.copy())
        assert np.abs(results[0] - results[1]).max() < 1e-9
        assert np.abs(results[0] - results[2]).max() < 1e-9


def test_thermostats_reach_their_temperature():
    for fixes in ([NVT(temperature=(40.0, 40.0), damping=200 * units.fs)],
                  [NVE(), Langevin(temperature=40.0, damping=200 * units.fs, seed=3)]):
        atoms = hot_argon(20.0, 4)
        dynamics = MolecularDynamics(atoms, 4 * units.fs, fixes)
        dynamics.run(300)
        seen = []
        dynamics.attach(lambda atoms=atoms, seen=seen: seen.append(atoms.get_temperature()), interval=10)
        dynamics.run(600)
        assert np.mean(seen) == pytest.approx(40.0, abs=4.0)


def test_forces_are_those_of_the_force_field_not_of_the_thermostat():
    atoms = hot_argon()
    MolecularDynamics(atoms, DT, [NVE(), Langevin(temperature=300.0, damping=1.0, seed=3)]).run(5)
    forces, energy, stress = atoms.get_forces(), atoms.get_potential_energy(), atoms.get_stress()
    other = argon()
    other.positions = atoms.positions
    assert np.allclose(forces, other.get_forces(), atol=1e-10)
    assert energy == pytest.approx(other.get_potential_energy(), rel=1e-11)
    assert np.allclose(stress, other.get_stress(), atol=1e-12)


def test_groups():
    atoms = hot_argon()
    some = np.arange(len(atoms)) < 50
    x = atoms.positions.copy()
    MolecularDynamics(atoms, DT, [NVE("some")], groups={"some": some}).run(10)
    assert np.all(np.abs(atoms.positions - x)[some].max(axis=1) > 0) and np.array_equal(atoms.positions[~some], x[~some])


def test_constraints_act_as_in_ase():
    constraints = [FixAtoms([0, 5, 9]), FixCartesian([20, 21], (True, False, True))]
    results = []
    for kind in (MolecularDynamics, VelocityVerlet):
        atoms = hot_argon()
        atoms.set_constraint(constraints)
        atoms.set_momenta(atoms.get_momenta())
        kind(atoms, DT).run(40)
        results.append((atoms.positions.copy(), atoms.get_momenta(), atoms.get_forces()))
    for a, b in zip(*results):
        assert np.allclose(a, b, rtol=0, atol=1e-9)
    assert np.array_equal(results[0][0][[0, 5, 9]], hot_argon().positions[[0, 5, 9]])


def test_forces_of_fixes_in_the_calculator_act(tmp_path):
    more = "fix 1 two addforce 0.5 0 -1\nfix 2 low setforce 0 0 0"
    results = []
    for kind in (MolecularDynamics, VelocityVerlet):
        atoms = read(tmp_path, script("real", more))
        kind(atoms, 0.5 * units.fs).run(40)
        results.append((atoms.positions.copy(), atoms.get_forces(), atoms.get_stress(), np.array(atoms.get_potential_energy())))
    for a, b in zip(*results):
        assert np.allclose(a, b, rtol=1e-6, atol=1e-6)


# ------------------------------------------------------------------------------------------------------------------------- errors ---

def test_what_it_does_not_take():
    atoms = hot_argon()
    atoms.set_constraint(FixBondLength(0, 1))
    with pytest.raises(InputError, match="FixBondLength"):
        MolecularDynamics(atoms, DT)
    atoms.set_constraint()
    atoms.calc = EMT()
    with pytest.raises(InputError, match="ForceField"):
        MolecularDynamics(atoms, DT)
    atoms = hot_argon()
    with pytest.raises(InputError, match="unknown group 'none'"):
        MolecularDynamics(atoms, DT, [NVE("none")]).run(1)


def test_an_explosion_leaves_the_last_good_atoms():
    atoms = hot_argon()
    dynamics = MolecularDynamics(atoms, DT)
    dynamics.run(10)
    x = atoms.positions.copy()
    atoms.set_momenta(atoms.get_momenta() * np.nan)
    with pytest.raises(SimulationError, match="step 11"):
        dynamics.run(100)
    assert np.array_equal(atoms.positions, x) and dynamics.nsteps == 10
    atoms.set_momenta(np.zeros((len(atoms), 3)))
    dynamics.run(10)
    assert dynamics.nsteps == 20


@pytest.mark.parametrize("looked", [False, True])
def test_changes_between_runs_count(looked):
    """Also after an evaluation that has made the calculator's results those of the changed atoms."""
    for change in (lambda a, d: a.set_masses(3.0 * a.get_masses()), lambda a, d: a.set_pbc((True, True, False)),
                   lambda a, d: a.set_momenta(0.5 * a.get_momenta()), lambda a, d: a.rattle(0.02, seed=1),
                   lambda a, d: a.set_cell(a.cell.array * 1.01, scale_atoms=True), lambda a, d: setattr(d, "dt", 0.5 * DT),
                   lambda a, d: a.set_constraint(FixAtoms([3, 4]))):
        results = []
        for kind in (MolecularDynamics, VelocityVerlet):
            atoms = hot_argon()
            dynamics = kind(atoms, DT)
            dynamics.run(10)
            change(atoms, dynamics)
            atoms.set_momenta(atoms.get_momenta())
            if looked:
                atoms.get_potential_energy()
            dynamics.run(10)
            results.append(np.concatenate([atoms.positions, atoms.get_momenta()]))
        assert np.abs(results[0] - results[1]).max() < 1e-10


def test_results_after_a_run_that_changed_the_cell():
    """Atoms are moved afterwards: the engine must have their cell."""
    atoms = hot_argon()
    atoms.get_potential_energy()
    MolecularDynamics(atoms, DT, fixes=[NPT(temperature=80.0, damping=100.0, pressure=0.01, pressure_damping=500.0)]).run(100)
    other = atoms.copy()
    other.calc = argon().calc
    for shift in (0.0, 0.1):
        for a in (atoms, other):
            a.positions[0, 0] += shift
        assert atoms.get_potential_energies().sum() == pytest.approx(other.get_potential_energy(), rel=1e-11)
        assert np.allclose(atoms.get_stress(), other.get_stress(), rtol=1e-9, atol=1e-14)


def test_steps_that_are_no_whole_number():
    steps = []
    for kind in (MolecularDynamics, VelocityVerlet):
        dynamics = kind(hot_argon(), DT)
        dynamics.run(2.5)
        steps.append(dynamics.nsteps)
    assert steps[0] == steps[1] == 3


def test_fixes_may_be_exchanged():
    atoms = hot_argon()
    dynamics = MolecularDynamics(atoms, DT)
    dynamics.run(10)
    energy = atoms.get_total_energy()
    dynamics.fixes = [NVE(), Langevin(temperature=1.0, damping=50.0, seed=1)]
    dynamics.run(50)
    assert atoms.get_total_energy() < energy - 0.05
    atoms.calc = argon().calc
    dynamics.run(10)
    assert dynamics.nsteps == 70


def test_interrupt_leaves_the_last_complete_step():
    atoms = hot_argon()
    dynamics = MolecularDynamics(atoms, DT)
    dynamics.run(1)
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        dynamics.run(10**6)
    steps = dynamics.nsteps
    assert 1 < steps < 10**6
    energy = atoms.get_total_energy()
    dynamics.run(10)
    assert dynamics.nsteps == steps + 10
    assert energy == pytest.approx(hot_argon().get_total_energy(), rel=0.05)     # the cutoff is sharp
