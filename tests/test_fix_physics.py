"""Fixes on free or tethered atoms, driven from Python: conservation, distributions, independence of threads."""
from __future__ import annotations

import threading

import numpy as np
import pytest
from numba import config

from asemd import fix
from asemd.box import Box
from asemd.compute.temp import Temp
from asemd.engine import Settings
from asemd.errors import InputError, SimulationError
from asemd.forcefield import Interactions
from asemd.kernels.state import Thread
from asemd.kernels.threads import barrier, reduce_sum
from asemd.loop import Loop
from asemd.system import System

compiled = pytest.mark.skipif(bool(config.DISABLE_JIT), reason="needs threads, or too slow without the compiler")


def gas(n=500, temperature=1.0, dimension=3, seed=1):
    """Atoms without interactions, units lj, two types."""
    rng = np.random.default_rng(seed)
    box = Box.from_lammps((0, 0, -0.5 if dimension == 2 else 0), (10, 10, 0.5 if dimension == 2 else 10))
    x = rng.uniform(0, 10, (n, 3))
    if dimension == 2:
        x[:, 2] = 0.0
    types = rng.integers(1, 3, n)
    mass = np.array([np.nan, 1.0, 4.0])
    v = rng.normal(0, 1, (n, 3)) * np.sqrt(temperature / mass[types])[:, None]
    return System(box, x, types, v=v, mass=mass, units="lj", dimension=dimension)


def loop(system, *fixes, threads=1, dt=0.01):
    groups = {"all": np.ones(system.n, bool), "heavy": system.type == 2}
    return Loop(system, Interactions(), Settings(threads=threads), list(fixes), groups, dt)


def run(a_loop, steps):
    a_loop.setup(a_loop.step, a_loop.step + steps)
    a_loop.advance(steps)
    a_loop.finish()
    return a_loop


def kinetic(system):
    return 0.5 * float((system.atom_masses()[:, None] * system.v**2).sum())


def test_nvt_conserves_energy_with_its_bath():
    system, nvt = gas(), fix.NVT(temperature=(1.0, 1.0), damping=0.5, chain=3)
    start, seen = kinetic(system), []
    for _ in range(5):
        run(loop(system, nvt), 50)
        seen.append((kinetic(system), kinetic(system) + nvt.scalar()))
    assert max(abs(k - start) for k, _ in seen) > 1e-3 * start
    assert all(total == pytest.approx(start, rel=1e-4) for _, total in seen)


def test_nvt_needs_no_group_all():
    system = gas()
    before = system.copy()
    run(loop(system, fix.NVT("heavy", temperature=2.0, damping=0.2)), 20)
    light = system.type == 1
    assert np.array_equal(system.v[light], before.v[light]) and np.array_equal(system.x[light], before.x[light])
    assert not np.array_equal(system.v[~light], before.v[~light])


@compiled
def test_langevin_reaches_its_temperature():
    system = gas(3000, temperature=0.2)
    run(loop(system, fix.NVE(), fix.Langevin(temperature=1.5, damping=0.2, seed=7)), 300)
    for kind, mass in ((1, 1.0), (2, 4.0)):
        v = system.v[system.type == kind]
        assert mass * (v**2).mean() == pytest.approx(1.5, rel=0.06)
        assert abs((v**4).mean() / (v**2).mean() ** 2 - 3.0) < 0.3      # a normal distribution


@compiled
def test_langevin_ramp_and_variable():
    ramp, follow = (gas(3000, temperature=1.0) for _ in range(2))
    run(loop(ramp, fix.NVE(), fix.Langevin(temperature=(1.0, 3.0), damping=0.05, seed=7)), 200)
    assert (ramp.atom_masses()[:, None] * ramp.v**2).mean() == pytest.approx(3.0, rel=0.1)
    per_atom = np.where(follow.type == 1, 0.5, 2.0)
    run(loop(follow, fix.NVE(), fix.Langevin(temperature=lambda _: per_atom, damping=0.05, seed=7)), 100)
    for kind, mass, target in ((1, 1.0, 0.5), (2, 4.0, 2.0)):
        assert mass * (follow.v[follow.type == kind] ** 2).mean() == pytest.approx(target, rel=0.1)


def test_langevin_zero_keeps_the_momentum_and_tally_the_energy():
    system = gas(200)
    system.v -= np.average(system.v, axis=0, weights=system.atom_masses())
    start = kinetic(system)
    bath = fix.Langevin(temperature=3.0, damping=1e9, seed=5, zero=True, tally=True)
    bath.damping = 20.0
    a_loop = run(loop(system, fix.NVE(), bath, dt=0.001), 400)
    drag = 1.0 - np.exp(-a_loop.dt * 400 / 20.0)
    momentum = (system.atom_masses()[:, None] * system.v).sum(axis=0)
    assert abs(momentum).max() < 1e-9 * drag + 1e-10
    assert kinetic(system) - start == pytest.approx(-bath.scalar(), rel=1e-3)


@compiled
@pytest.mark.parametrize("make", [
    lambda: [fix.NVE(), fix.Langevin(temperature=1.5, damping=0.5, seed=3, zero=True, tally=True)],
    lambda: [fix.NVE(), fix.Langevin("heavy", temperature=1.5, damping=0.5, seed=3)],
    lambda: [fix.NVT("heavy", temperature=2.0, damping=0.2), fix.NVELimit(xmax=0.02)],
    lambda: [fix.NVE(), fix.TempBerendsen(temperature=2.0, damping=0.1), fix.AddForce("heavy", (0.1, 0.0, 0.2))],
    lambda: [fix.NVE(), fix.TempRescale(temperature=2.0, every=3), fix.SetForce("heavy", (0.1, None, 0.2))],
])
def test_threads_change_nothing(make):
    results = []
    for threads in (1, 3):
        system, fixes = gas(300), make()
        run(loop(system, *fixes, threads=threads), 20)
        results.append((system.x, system.v))
    for a, b in zip(*results, strict=True):
        assert np.allclose(a, b, rtol=1e-12, atol=1e-13)


def test_berendsen_relaxes_exponentially():
    system = gas(200, temperature=2.0)
    start = Temp().scalar(loop(system).snapshot())
    bath = fix.TempBerendsen(temperature=1.0, damping=0.5)
    energy = kinetic(system)
    a_loop = run(loop(system, fix.NVE(), bath, dt=0.001), 500)
    assert Temp().scalar(a_loop.snapshot()) - 1.0 == pytest.approx((start - 1.0) * (1.0 - 0.001 / 0.5) ** 500, rel=1e-9)
    assert kinetic(system) + bath.scalar() == pytest.approx(energy, rel=1e-12)


def test_rescale_hits_the_target_outside_its_window():
    system = gas(temperature=2.0)
    a_loop = run(loop(system, fix.NVE(), fix.TempRescale(temperature=1.0, every=5, window=0.1)), 4)
    assert Temp().scalar(a_loop.snapshot()) > 1.5
    run(a_loop, 1)
    assert Temp().scalar(a_loop.snapshot()) == pytest.approx(1.0, rel=1e-12)


def test_nothing_to_scale_is_an_error():
    system = gas()
    system.v[:] = 0.0
    with pytest.raises(SimulationError, match="temperature of group all was 0"):
        run(loop(system, fix.NVE(), fix.TempRescale(temperature=1.0)), 1)


def test_nve_limit_counts_and_limits():
    system, limit = gas(temperature=1.0), fix.NVELimit(xmax=0.005)
    before = system.x.copy()
    run(loop(system, limit), 1)
    moved = np.linalg.norm(system.box.unwrap(system.x, system.image) - before, axis=1)
    assert moved.max() == pytest.approx(0.005, rel=1e-9)
    shortened = np.count_nonzero(moved > 0.005 * (1 - 1e-9))
    assert 0 < shortened <= limit.scalar() <= 2 * shortened      # once or twice in a step


def test_added_force_is_minus_the_gradient_of_its_energy():
    system, push = gas(50), fix.AddForce("heavy", (0.3, -0.2, 0.1))
    a_loop = loop(system, fix.NVE(), push)
    start = kinetic(system)
    a_loop.setup(0, 100)
    before = push.scalar()
    a_loop.advance(100)
    assert kinetic(system) - start == pytest.approx(before - push.scalar(), rel=1e-9)


def test_momentum_stops_drift_and_rotation_and_keeps_the_energy():
    system = gas(40)
    energy = kinetic(system)
    run(loop(system, fix.NVE(), fix.Momentum(every=1, linear=(1, 1, 1), angular=True, rescale=True)), 1)
    mass, r = system.atom_masses()[:, None], system.box.unwrap(system.x, system.image)
    r = r - (mass * r).sum(axis=0) / mass.sum()
    assert abs((mass * system.v).sum(axis=0)).max() < 1e-10
    assert abs((mass * np.cross(r, system.v)).sum(axis=0)).max() < 1e-9
    assert kinetic(system) == pytest.approx(energy, rel=1e-12)


def test_rotation_of_atoms_on_a_line():
    system = gas(2)
    run(loop(system, fix.NVE(), fix.Momentum(every=1, linear=(1, 1, 1), angular=True)), 1)
    r = system.box.unwrap(system.x, system.image)
    assert np.isfinite(system.v).all() and abs(np.cross(r[1] - r[0], system.v[1] - system.v[0])).max() < 1e-10


def test_region_and_python_function():
    class Left:
        def inside(self, x):
            return x[:, 0] < 5.0
    system = gas(100)
    system.v[:] = 0.0
    a_loop = loop(system, fix.NVE(), fix.SetForce(force=(None, lambda loop: 1.0 + loop.step, 0.0), region=Left()))
    a_loop.setup(0, 1)
    left = system.x[:, 0] < 5.0
    assert np.array_equal(a_loop.state.f[1][:a_loop.nslots][a_loop.state.row[:a_loop.nslots] >= 0],
                          np.where(left, 1.0, 0.0)[a_loop.state.row[:a_loop.nslots][a_loop.state.row[:a_loop.nslots] >= 0]])


def test_enforce2d_is_for_two_dimensions():
    with pytest.raises(InputError, match="two dimensions"):
        run(loop(gas(), fix.NVE(), fix.Enforce2D()), 1)
    flat = gas(dimension=2)
    flat.v[:, 2] = 1.0
    run(loop(flat, fix.NVE(), fix.Enforce2D()), 3)
    assert abs(flat.x[:, 2]).max() < 0.02 and not flat.v[:, 2].any()


def test_degrees_of_freedom():
    state = loop(gas(10)).snapshot()
    assert Temp().dof(state) == 27.0
    assert Temp(extra_dof=0.0).dof(state) == 30.0
    one = loop(gas(1)).snapshot()
    assert Temp().scalar(one) == 0.0
    with pytest.raises(InputError, match="degrees of freedom"):
        Temp(extra_dof=5.0).dof(one)


@compiled
def test_barrier_and_sum_with_threads():
    from numba import njit

    @njit(nogil=True)
    def work(th, rounds):
        total = 0.0
        for k in range(rounds):
            total += reduce_sum(th, 1.0 / (th.tid + 1 + k))
            barrier(th)
        return total
    nth, out = 3, {}
    sync, scratch = np.zeros(8, np.int64), np.zeros((nth, 8))

    def start(tid):
        out[tid] = work(Thread(tid, nth, 0, 0, 0, 0, 0, 0.1, sync, scratch), 200)
    threads = [threading.Thread(target=start, args=(tid,)) for tid in range(nth)]
    for t in threads:
        t.start()
    for t in threads:
        t.join(60)
    expected = 0.0
    for k in range(200):
        expected += sum(1.0 / (tid + 1 + k) for tid in range(nth))
    assert out[0] == out[1] == out[2] == pytest.approx(expected, rel=1e-12)
