"""The time loop: conservation, restarts, threads, list builds, errors that name atoms, and trajectories of LAMMPS."""
from __future__ import annotations

import itertools
import os
import signal
import threading
import time

import both
import numpy as np
import pytest

from asemd import engine as engines
from asemd.box import Box
from asemd.engine import Settings
from asemd.errors import SimulationError
from asemd.fix import Fix
from asemd.fix.langevin import Langevin
from asemd.fix.nve import NVE
from asemd.forcefield import Interactions
from asemd.loop import Loop
from asemd.system import System
from asemd.topology import Topology

LJ = {"lj/cut 1.6": {(1, 1): (1.0, 1.0)}}
PRISM = np.array([[1.0, 0, 0], [0.2, 1.0, 0], [-0.1, 0.15, 1.0]])


def crystal(cells: int = 5, shape=None, temperature: float = 1.0, boundary=("pp", "pp", "pp"), density: float = 0.8442) -> System:
    """An fcc crystal of 4 cells^3 atoms with velocities; `shape` deforms it."""
    a = (4 / density) ** (1 / 3)
    s = np.array([(i + u, j + v, k + w) for i, j, k in itertools.product(range(cells), repeat=3)
                  for u, v, w in ((0, 0, 0), (0.5, 0.5, 0), (0.5, 0, 0.5), (0, 0.5, 0.5))]) + 0.25
    cell = a * cells * (np.eye(3) if shape is None else shape)
    v = np.random.default_rng(5).normal(0, np.sqrt(temperature), s.shape)
    return System(box=Box((0.3, -2.0, 1.0), cell, boundary), x=s / cells @ cell + (0.3, -2.0, 1.0), type=1, v=v - v.mean(0), units="lj",
                  mass=np.array([np.nan, 1.0]))


def chains(nchains: int = 10, length: int = 30, seed: int = 3) -> System:
    """Bead-spring chains that snake through a grid, bond length 0.97."""
    n = nchains * length
    m = int(np.ceil(n ** (1 / 3)))
    order = [(i, j if i % 2 == 0 else m - 1 - j, k if (i * m + j) % 2 == 0 else m - 1 - k)
             for i in range(m) for j in range(m) for k in range(m)][:n]
    rng = np.random.default_rng(seed)
    x = np.array(order, float) * 0.97 + rng.uniform(-0.02, 0.02, (n, 3))
    system = System(box=Box(np.zeros(3), np.eye(3) * (0.97 * m + 0.4)), x=x, type=1, v=rng.normal(0, 1, (n, 3)), units="lj",
                    mass=np.array([np.nan, 1.0]), molecule=np.arange(n) // length + 1,
                    topology=Topology(bonds=[(i, i + 1) for i in range(n - 1) if (i + 1) % length]))
    return system


CHAIN = dict(pair={"lj/cut 1.12": {(1, 1): (1.0, 1.0)}}, bond={"fene": {1: (30.0, 1.5, 1.0, 1.0)}}, special_bonds="fene", shift=True)


def loop_of(system: System, fixes=None, dt: float = 0.005, interactions=None, groups=None, **options) -> Loop:
    groups = {"all": np.ones(system.n, bool), **(groups or {})}
    return Loop(system, interactions or Interactions.build(pair=LJ, shift=True), Settings(**options), [NVE()] if fixes is None else fixes,
                groups, dt)


def total(loop: Loop) -> float:
    s = loop.system
    return loop.result.potential + 0.5 * float((s.atom_masses()[:, None] * s.v**2).sum())


class Watch(Fix):
    """A Python hook: makes the loop take the path through Python, and remembers steps."""

    style = "watch"

    def __init__(self, every: int = 1, hook: str = "post_force", action=None):
        super().__init__()
        self.every, self.seen, self.action = every, [], action
        setattr(self, hook, self._call)

    def _call(self, loop):
        self.seen.append(loop.step)
        if self.action:
            self.action(loop)


# ------------------------------------------------------------------------------------------------------------------ conservation ---

def drift(dt: float, interactions: Interactions, make) -> float:
    loop = loop_of(make(), dt=dt, interactions=interactions)
    loop.setup()
    energies = [total(loop)]
    for _ in range(20):
        loop.advance(round(0.05 / dt))
        energies.append(total(loop))
    return float(np.std(np.array(energies) - energies[0]))


@pytest.mark.parametrize("which", ["atoms", "chains"])
def test_energy_error_falls_with_the_square_of_the_timestep(which):
    interactions = Interactions.build(pair={"lj/charmm/coul/charmm 1.3 1.8": {(1, 1): (1.0, 1.0)}}) if which == "atoms" else \
        Interactions.build(**CHAIN)
    make = (lambda: _charged(crystal(4, temperature=1.5))) if which == "atoms" else chains
    coarse, fine = drift(0.005, interactions, make), drift(0.0025, interactions, make)
    assert 2.5 < coarse / fine < 6.5
    assert coarse < 0.02 * make().n


def _charged(system: System) -> System:
    system.q = np.where(np.arange(system.n) % 2, 0.3, -0.3)
    return system


def test_momentum_is_conserved():
    system = crystal(4)
    loop = loop_of(system)
    loop.setup()
    loop.advance(100)
    assert np.abs(system.v.sum(0)).max() < 1e-11


# ------------------------------------------------------------------------------------------------- the same motion, other ways ---

@pytest.fixture(scope="module")
def reference():
    """200 steps of 500 atoms, run at once."""
    system = crystal(5)
    loop = loop_of(system)
    loop.setup(0, 200)
    loop.advance(200)
    return system, loop


def assert_same_motion(system: System, other: System, tolerance: float) -> None:
    x, y = (s.box.unwrap(s.x, s.image) for s in (system, other))
    assert np.abs(x - y).max() < tolerance
    assert np.abs(system.v - other.v).max() < 20 * tolerance


@pytest.mark.parametrize("pieces", [(100, 100), (1, 2, 3, 194), (50,) * 4])
def test_pieces_equal_the_whole(reference, pieces):
    system = crystal(5)
    loop = loop_of(system)
    loop.setup(0, 200)
    for steps in pieces:
        loop.advance(steps, virial=steps % 2 == 0)
    assert loop.step == 200
    assert_same_motion(system, reference[0], 1e-9)


@pytest.mark.parametrize("style", ["nve", "langevin", "chains"])
def test_digits_do_not_depend_on_where_a_run_is_cut(style):
    """Pieces end by the clock: two halves of a step in one pass and apart must round alike."""
    def positions(pieces):
        system = chains() if style == "chains" else crystal(5)
        fixes = [NVE(), Langevin(temperature=1.0, damping=1.0, seed=4)] if style == "langevin" else None
        loop = loop_of(system, fixes)
        loop.setup(0, 60)
        for steps in pieces:
            loop.advance(steps, virial=False)
        return np.concatenate([system.x, system.v])
    whole = positions([60])
    for pieces in ([20, 40], [1] * 60, [7, 13, 40]):
        assert np.array_equal(positions(pieces), whole), pieces


def test_energies_on_the_way_change_nothing(reference):
    system = crystal(5)
    loop = loop_of(system)
    loop.setup(0, 200)
    for _ in range(20):
        result = loop.advance(10, energies=True, virials=True)
        assert result.energies.sum() == pytest.approx(result.potential, rel=1e-11)
    assert_same_motion(system, reference[0], 1e-9)


@pytest.mark.parametrize("threads", [2, 3])
def test_threads_agree(reference, threads):
    system = crystal(5)
    loop = loop_of(system, threads=threads)
    loop.setup(0, 200)
    loop.advance(200)
    assert_same_motion(system, reference[0], 1e-8)
    assert loop.engine.builds == reference[1].engine.builds


def test_chains_on_threads_agree():
    systems = []
    for threads in (1, 2):
        system = chains()
        loop = loop_of(system, interactions=Interactions.build(**CHAIN), threads=threads)
        loop.setup()
        loop.advance(100)
        systems.append(system)
    assert_same_motion(*systems, 1e-10)


@pytest.mark.parametrize("hook", ["initial_integrate", "post_integrate", "pre_exchange", "pre_neighbor", "post_neighbor", "pre_force",
                                  "post_force", "final_integrate", "end_of_step"])
def test_hooks_in_python_change_nothing_and_come_at_their_steps(reference, hook):
    watch, system = Watch(5 if hook == "end_of_step" else 1, hook), crystal(5)
    loop = loop_of(system, [NVE(), watch])
    loop.setup(0, 200)
    watch.seen.clear()
    loop.advance(120)
    loop.advance(80)
    assert_same_motion(system, reference[0], 1e-9)
    assert loop.engine.builds == reference[1].engine.builds
    if hook == "end_of_step":
        assert watch.seen == list(range(5, 201, 5))
    elif hook in ("pre_exchange", "pre_neighbor", "post_neighbor"):
        assert len(watch.seen) == loop.engine.builds
    else:
        assert watch.seen == list(range(1, 201))


def test_the_plain_list_gives_the_same_motion(reference, monkeypatch):
    monkeypatch.setattr(engines, "SMALL", 10**9)
    system = crystal(5)
    loop = loop_of(system)
    assert loop.engine.mode == "plain"
    loop.setup(0, 200)
    loop.advance(200)
    assert_same_motion(system, reference[0], 1e-8)


def test_mixed_precision_stays_close(reference):
    system = crystal(5)
    loop = loop_of(system, precision="mixed")
    loop.setup()
    loop.advance(50)
    exact = crystal(5)
    other = loop_of(exact)
    other.setup()
    other.advance(50)
    x, y = (s.box.unwrap(s.x, s.image) for s in (system, exact))
    assert 0 < np.abs(x - y).max() < 1e-4


def test_time_reversal():
    system = crystal(4)
    x = system.x.copy()
    loop = loop_of(system)
    loop.setup()
    loop.advance(100)
    system.v *= -1
    loop.sync_in()
    loop.advance(100)
    assert np.abs(system.box.unwrap(system.x, system.image) - x).max() < 1e-9


def test_positions_unwrap_to_a_continuous_path():
    """Fast atoms cross faces; image flags follow."""
    system = crystal(4, shape=PRISM, temperature=6.0)
    loop = loop_of(system, dt=0.002)
    loop.setup()
    before = system.box.unwrap(system.x, system.image)
    for _ in range(40):
        loop.advance(10)
        now = system.box.unwrap(system.x, system.image)
        assert np.abs(now - before).max() < 0.5
        before = now
    assert system.image.any()


# ------------------------------------------------------------------------------------------------------------------- list builds ---

def test_check_no_builds_on_a_schedule():
    for every, delay, builds in ((10, 0, 10), (20, 0, 5), (10, 30, 3), (1, 50, 2)):
        loop = loop_of(crystal(4), every=every, delay=delay, check=False)
        loop.setup()
        loop.advance(100)
        assert loop.engine.builds == builds and loop.engine.dangerous == 0, (every, delay)


def test_check_yes_builds_when_half_the_skin_is_used():
    """A single moving atom: builds come when it has gone half the skin, and only at allowed steps."""
    for every, delay, expected, dangerous in ((1, 0, 6, 0), (4, 0, 8, 0), (1, 10, 10, 1), (4, 8, 8, 1), (5, 10, 10, 1)):
        system = crystal(4, temperature=0.0)
        system.x = system.x[:1]
        system = System(box=system.box, x=system.x, type=1, v=[[5.1, 0, 0]], units="lj", mass=np.array([np.nan, 1.0]))
        watch = Watch(hook="pre_neighbor")
        loop = loop_of(system, [NVE(), watch], every=every, delay=delay)
        loop.setup()
        loop.advance(expected)
        assert watch.seen == [expected], (every, delay)
        assert loop.engine.dangerous == dangerous, (every, delay)


def test_dangerous_builds_are_counted_alike():
    counts = []
    for fixes in ([NVE()], [NVE(), Watch()]):
        loop = loop_of(crystal(4, temperature=4.0), fixes, delay=25)
        loop.setup()
        loop.advance(100)
        counts.append((loop.engine.builds, loop.engine.dangerous))
    assert counts[0] == counts[1] == (4, 4)


def test_lists_that_outgrow_their_buffers():
    """Atoms that rush into a plane: the kernels for longer rows take over in the midst of a run."""
    n, edge = 1500, 16.0
    x = np.random.default_rng(1).uniform(0, edge, (n, 3))
    v = np.zeros((n, 3))
    v[:, 0] = -0.9 * (x[:, 0] - edge / 2)
    system = System(box=Box(np.zeros(3), np.eye(3) * edge), x=x, type=1, v=v, units="lj", mass=np.array([np.nan, 1.0]))
    inter = Interactions.build(pair={"soft 6.0": {(1, 1): (1e-9,)}})
    loop = loop_of(system, interactions=inter, dt=0.01)
    loop.setup()
    before = loop.engine.terms[0].row
    for _ in range(7):
        result = loop.advance(10)
        forces = system.f.copy()
        expected = engines.Engine(system, inter, Settings()).compute()
        np.testing.assert_allclose(result.potential, expected.potential, rtol=1e-12)
        np.testing.assert_allclose(forces, expected.forces, rtol=0, atol=1e-12 * abs(expected.forces).max())
    assert loop.engine.terms[0].row > before


# ------------------------------------------------------------------------------------------------------------------- boundaries ---

def test_atom_that_leaves_through_a_fixed_face_is_named():
    system = crystal(4, boundary=("pp", "ff", "pp"), temperature=0.1)
    system.id = system.id + 1000
    top = int(np.argmax(system.x[:, 1]))
    system.v[top] = (0, 60.0, 0)
    loop = loop_of(system)
    loop.setup()
    with pytest.raises(SimulationError, match=rf"step \d+: 1 atom lost: atom {top + 1001} at y = .* fixed boundary"):
        loop.advance(200)
    assert loop.step < 30 and np.isfinite(system.x).all()


def test_atoms_outside_a_fixed_box_at_the_start():
    system = crystal(4, boundary=("ff", "ff", "ff"))
    system.x[7, 2] = system.box.hi[2] + 3
    with pytest.raises(SimulationError, match="atom 8 at z"):
        loop_of(system).setup()


@pytest.mark.parametrize("boundary", ["s s s", "p s m", "fs p sf", "p mf fm"])
def test_shrink_wrapped_faces_follow_lammps(boundary):
    script = f"""
units lj
boundary {boundary}
lattice fcc 0.8442
region box block 0 5 0 5 0 4
create_box 1 box
region inner block 0.6 4.2 0.6 4.2 0.6 3.4
create_atoms 1 region inner
mass 1 1.0
velocity all create 0.7 87287 loop geom
pair_style lj/cut 1.8
pair_coeff 1 1 1.0 1.0
neighbor 0.3 bin
neigh_modify delay 0 every 1 check yes
fix 1 all nve
thermo_style custom step vol press pe
thermo_modify norm no
run 150
"""
    theirs = both.lammps({"x": script})["x"]
    session = both.asemd(script)
    both.assert_same(session, theirs, x=1e-9, v=1e-8)


# ----------------------------------------------------------------------------------------------------------------------- errors ---

def test_a_position_that_is_not_a_number_stops_the_run():
    system = crystal(4)
    system.id = system.id * 10

    def poison(loop):
        if loop.step == 30:
            loop.state.v[1, 5] = np.nan
    row = []
    loop = loop_of(system, [NVE(), Watch(hook="pre_force", action=poison)])
    loop.setup()
    row.append(int(loop.state.row[5]))
    with pytest.raises(SimulationError, match="not finite|NaN") as caught:
        loop.advance(100)
    assert "atom" in str(caught.value) and loop.step < 40


def test_a_velocity_that_is_not_a_number_is_found_in_compiled_steps():
    system = crystal(4)
    system.id = system.id * 10
    system.v[16, 1] = np.nan
    loop = loop_of(system)
    loop.setup()
    with pytest.raises(SimulationError, match="step 1: atom 170: position is not finite"):
        loop.advance(100)


def test_colliding_atoms_stop_the_run():
    """Two atoms shot at each other with a step far too long: whatever happens, the run does not go on with infinite numbers."""
    system = crystal(4, temperature=0.1)
    system.v[:] = np.random.default_rng(1).normal(0, 300, system.v.shape)
    loop = loop_of(system, dt=0.5)
    loop.setup()
    try:
        loop.advance(300)
    except SimulationError as error:
        assert "atom" in str(error)
    assert np.isfinite(loop.result.potential)


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("python", [False, True])
def test_fene_bond_beyond_its_length_names_step_and_atoms(threads, python):
    system = chains()
    system.id = system.id + 7000
    system.v[:] = 0
    system.v[40], system.v[41] = (0, 0, -20.0), (0, 0, 20.0)
    if system.x[41, 2] < system.x[40, 2]:
        system.v[40:42] *= -1
    loop = loop_of(system, [NVE()] + [Watch()] * python, interactions=Interactions.build(**CHAIN), threads=threads)
    loop.setup()
    with pytest.raises(SimulationError, match=r"step \d+: bond of type 1 between atoms 704\d 704\d .*fene: r = 1\.[5-9]"):
        loop.advance(500)
    assert 1 < loop.step < 20
    assert np.isfinite(system.x).all()


def test_interrupt_leaves_a_consistent_state():
    """Ctrl-C during compiled steps: the exception arrives between stretches, the step count fits the positions, the run can go on."""
    system = crystal(5)
    loop = loop_of(system)
    loop.setup(0, 10**9)
    loop.advance(50)
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    began = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        loop.advance(10**6)
    assert time.perf_counter() - began < 20
    stopped = loop.step
    assert 50 < stopped < 10**6
    x, v = system.x.copy(), system.v.copy()
    loop.sync_out()
    assert np.array_equal(x, system.x) and np.array_equal(v, system.v)
    loop.advance(20)
    assert loop.step == stopped + 20
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    energy = total(loop)
    fresh = loop_of(crystal(5))
    fresh.setup()
    assert energy == pytest.approx(total(fresh), abs=0.05 * system.n)


# ---------------------------------------------------------------------------------------------------------------------- LAMMPS ---

def data_file(path, system: System, bonded: bool) -> str:
    lo, hi, tilt = system.box.lo, system.box.hi, system.box.tilt
    lines = ["made by a test", "", f"{system.n} atoms", "1 atom types"] + [f"{len(system.topology.bonds)} bonds", "1 bond types"] * bonded
    lines += [f"{a:.17g} {b:.17g} {c}lo {c}hi" for a, b, c in zip(lo, hi, "xyz")]
    if any(tilt):
        lines += [" ".join(f"{t:.17g}" for t in tilt) + " xy xz yz"]
    lines += ["", "Masses", "", "1 1.0", "", "Atoms", ""]
    lines += [f"{i + 1} {'1 ' * bonded}1 {x:.17g} {y:.17g} {z:.17g}" for i, (x, y, z) in enumerate(system.x)]
    lines += ["", "Velocities", ""] + [f"{i + 1} {x:.17g} {y:.17g} {z:.17g}" for i, (x, y, z) in enumerate(system.v)]
    if bonded:
        lines += ["", "Bonds", ""] + [f"{k + 1} 1 {i + 1} {j + 1}" for k, (i, j) in enumerate(system.topology.bonds)]
    path.write_text("\n".join(lines) + "\n")
    return str(path)


def test_trajectories_of_lammps(tmp_path):
    systems = {"lj 500": crystal(5), "lj 864": crystal(6), "lj 500 triclinic": crystal(5, shape=PRISM),
               "lj 864 triclinic": crystal(6, shape=PRISM), "small": crystal(2), "chains": chains()}
    scripts = {}
    for name, system in systems.items():
        bonded = name == "chains"
        path = data_file(tmp_path / f"{name.replace(' ', '_')}.data", system, bonded)
        style = "bond_style fene\nspecial_bonds fene\n" if bonded else ""
        cut, coeff = (1.12, "bond_coeff 1 30 1.5 1 1\n") if bonded else (2.5, "")
        scripts[name] = f"""
units lj
atom_style {'bond' if bonded else 'atomic'}
atom_modify map array
{style}pair_style lj/cut {cut}
read_data {path}
pair_modify shift yes
pair_coeff 1 1 1 1
{coeff}neighbor 0.3 bin
neigh_modify delay 0 every 1 check yes
fix 1 all nve
run 100
"""
    theirs = both.lammps(scripts)
    for name, script in scripts.items():
        both.assert_same(both.asemd(script), theirs[name], x=1e-9, v=2e-8)
