"""What the loop offers to fixes: the virial of a step, a box that changes, hooks in Python on some steps only."""
from __future__ import annotations

import numpy as np
import pytest
from both import asemd
from numpy.testing import assert_allclose
from test_loop import CHAIN, PRISM, chains, crystal, loop_of

from asemd.engine import Engine, Settings
from asemd.fix import Fix, hook
from asemd.fix.nve import NVE
from asemd.forcefield import Interactions
from asemd.kernels.box import follow
from asemd.kernels.threads import barrier


class Watch(Fix):
    """Keeps the virial of the terms and of fixes on one step in the midst of a run."""

    style = "watch"
    virial_every = 1

    def __init__(self, step: int):
        super().__init__()
        self.p = np.array([1.0, step, *np.zeros(6)])

    def parameters(self, loop):
        return self.p

    @hook
    def final_integrate(th, s, p, a):
        if th.tid == 0 and th.step == int(p[1]):
            for c in range(6):
                p[2 + c] = s.acc[:, :, 2 + c].sum()


@pytest.mark.parametrize("precision", ["double", "mixed"])
@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("scene", ["crystal", "prism", "chains", "small"])
def test_virial_in_the_midst_of_a_run(scene, threads, precision):
    """The kernel that gives the virial alone agrees with the one that gives energies, too."""
    system = {"crystal": crystal, "prism": lambda: crystal(shape=PRISM), "chains": chains, "small": lambda: crystal(3)}[scene]()
    inter = Interactions.build(**CHAIN) if scene == "chains" else None
    watch = Watch(7)
    loop = loop_of(system.copy(), [NVE(), watch], threads=threads, precision=precision, interactions=inter)
    loop.setup(0, 12)
    loop.advance(12)
    other = loop_of(system.copy(), threads=threads, precision=precision, interactions=inter)
    other.setup(0, 12)
    expected = other.advance(7).virial
    assert watch.p[2:] == pytest.approx(expected, rel=1e-10 if precision == "double" else 2e-4, abs=1e-3 if precision == "mixed" else 1e-9)


class Stretch(Fix):
    """Deforms the box and the atoms with it, each step."""

    style = "stretch"

    def __init__(self, shape: bool):
        super().__init__()
        self.box_moves = "shape" if shape else "size"
        self.shape = shape

    def parameters(self, loop):
        return np.array([1.0, 1.0 if self.shape else 0.0])

    @hook(uses=[follow])
    def post_integrate(th, s, p, a):
        barrier(th)
        v, o = s.box.vectors, s.box.origin
        for i in range(th.lo, th.hi):
            if p[1] != 0.0:
                s.x[0, i] += 0.002 * (s.x[1, i] - o[1])
            s.x[2, i] = o[2] + 1.001 * (s.x[2, i] - o[2])
        barrier(th)
        if th.tid == 0:
            if p[1] != 0.0:
                for k in range(3):
                    v[k, 0] += 0.002 * v[k, 1]
            for k in range(3):
                v[k, 2] *= 1.001
            follow(s.box)
        barrier(th)


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("shape", [False, True], ids=["size", "shape"])
@pytest.mark.parametrize("scene", ["crystal", "prism", "chains", "small", "slab", "few"])
def test_a_box_that_changes(scene, shape, threads):
    """Forces in the changed box are those of a fresh engine on the same atoms, and the system has the box."""
    if scene == "prism" and not shape:
        shape = True
    system = {"crystal": crystal, "prism": lambda: crystal(shape=PRISM), "chains": chains, "small": lambda: crystal(2),
              "slab": lambda: crystal(boundary=("pp", "pp", "ff")), "few": lambda: crystal(3, density=0.02)}[scene]()
    if scene == "slab":
        system.box.cell[2, 2] *= 1.5
    inter = Interactions.build(**CHAIN) if scene == "chains" else None
    volume = system.box.volume
    loop = loop_of(system, [NVE(), Stretch(shape)], dt=0.001, threads=threads, interactions=inter)
    loop.setup(0, 40)
    result = loop.advance(40)
    assert system.box.volume == pytest.approx(volume * 1.001**40, rel=1e-12)
    assert loop.engine.builds > 0
    fresh = Engine(system.copy(), loop.interactions, Settings()).compute()
    assert result.forces == pytest.approx(fresh.forces, rel=1e-9, abs=1e-8 * max(1.0, np.abs(fresh.forces).max()))
    assert result.virial == pytest.approx(fresh.virial, rel=1e-9, abs=1e-7)
    assert result.potential == pytest.approx(fresh.potential, rel=1e-11)


class Diary(Fix):
    """Notes on which steps its hooks in Python were called."""

    style = "diary"

    def __init__(self, every: int, within: int = 0):
        super().__init__()
        self.every, self.within = every, within
        self.ends: list[int] = []
        self.steps: list[int] = []
        self.lists: list[int] = []
        self.energies: list[float] = []
        self.needs = frozenset({"energy"})
        if not within:
            self.post_force = None

    def hooks(self):
        return {name: kind for name, kind in super().hooks().items() if getattr(self, name) is not None}

    def next_step(self, step):
        return (step // self.within + 1) * self.within

    def post_force(self, loop):
        self.steps.append(loop.step)

    def pre_exchange(self, loop):
        self.lists.append(loop.step)

    def end_of_step(self, loop):
        assert loop.snapshot().fresh
        self.ends.append(loop.step)
        self.energies.append(loop.result.potential)


def test_hooks_in_python_only_when_due():
    """The steps between are compiled; energies asked for are those of the step; the trajectory is that without the fix."""
    diary = Diary(every=10, within=7)
    loop = loop_of(crystal(), [NVE(), diary])
    made_in_python = []
    step = loop._python_step
    loop._python_step = lambda energy, shares: (step(energy, shares), made_in_python.append(loop.step))
    loop.setup(0, 45)
    diary.steps.clear()
    loop.advance(45)
    assert diary.ends == [10, 20, 30, 40]
    assert diary.steps == made_in_python == [7, 14, 21, 28, 35, 42]
    assert diary.lists
    plain = loop_of(crystal())
    plain.setup(0, 45)
    energies = [plain.advance(10).potential for _ in range(4)]
    assert diary.energies == pytest.approx(energies, rel=1e-12)
    plain.advance(5)
    assert loop.system.x == pytest.approx(plain.system.x, abs=1e-11)


def test_a_list_build_asked_for():
    """A fix names the step on which it wants the list built, and acts before it."""
    diary = Diary(every=1000)
    diary.next_reneighbor = 3
    loop = loop_of(crystal(), [NVE(), diary])
    loop.setup(0, 5)
    loop.advance(5)
    assert diary.lists[0] == 3


@pytest.mark.parametrize("integrate", ["run_style verlet", "run_style respa 2 2"])
def test_a_box_that_becomes_narrower_than_the_reach_of_the_forces(integrate):
    session = asemd(f"""
        units lj
        lattice fcc 0.8
        region box block 0 3 0 3 0 3
        create_box 1 box
        create_atoms 1 box
        mass 1 1
        velocity all create 0.5 4711
        pair_style lj/cut 1.5
        pair_coeff 1 1 0.05 0.6
        neigh_modify every 1 delay 0
        {integrate}
        fix 1 all nve
        fix 2 all deform 1 z scale 0.3 remap x
        timestep 0.001
        run 400""")
    loop = session.loop
    loop.sync_out()
    assert loop.engine.mode == "plain" and loop.engine.widths[2] < loop.engine.reach
    loop.engine.forces(True)
    mine, fresh = loop.engine.collect(), Engine(loop.system.select(np.arange(loop.system.n)), loop.interactions, Settings()).compute()
    assert mine.potential == pytest.approx(fresh.potential, rel=1e-12)
    assert_allclose(mine.forces, fresh.forces, rtol=0, atol=1e-10 * np.abs(fresh.forces).max())


def test_empty_slots_stay_where_the_box_moves():
    """They are no reason to build a list."""
    session = asemd("""
        units lj
        lattice fcc 0.8
        region box block 0 4 0 4 0 4
        create_box 1 box
        create_atoms 1 box
        mass 1 1
        velocity all create 1.0 4711
        pair_style lj/cut 1.5
        pair_coeff 1 1 1 1
        fix 1 all npt temp 1 1 0.3 iso 0 3 1
        run 3""")
    e = session.loop.engine
    empty = e.state.row[:e.ns] < 0
    assert e.mode == "cluster" and empty.any()
    assert np.array_equal(e.state.x[:, :e.ns][:, empty], e.held[:, :e.ns][:, empty])
