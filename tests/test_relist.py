"""Lists that the time loop builds by itself are those that Python builds."""
from __future__ import annotations

import os

import numpy as np
import pytest
from test_embedded import small
from test_loop import CHAIN, PRISM, chains, crystal, loop_of

from asemd import relist
from asemd.box import Box
from asemd.errors import SimulationError
from asemd.fix.langevin import Langevin
from asemd.fix.nve import NVE
from asemd.forcefield import Interactions
from asemd.system import System
from asemd.watchdog import FIRST

pytestmark = pytest.mark.skipif(bool(os.environ.get("NUMBA_DISABLE_JIT")), reason="nothing is compiled")
FULL = {"lj/cut 2.5": {(1, 1): (1.0, 1.0)}}
WEIGHTS = (0.0, 0.5, 1.0)


def embedded(folder, system):
    """The invented elements of `test_embedded`, both of them."""
    forces = Interactions()
    forces.set_style("pair", ["eam/alloy"])
    forces.set_coeff("pair", ["*", "*", str(small(folder)), "A", "B"], system)
    return forces


def alloy():
    """A warm crystal of two elements."""
    atoms = crystal(temperature=0.4, density=0.06)
    return System(box=atoms.box, x=atoms.x, type=1 + np.arange(atoms.n) % 2, v=5.0 * atoms.v, units="metal",
                  mass=np.array([np.nan, 10.0, 20.0]))


SCENES = {
    "atoms": (crystal, {}, {}),
    "embedded atoms": (alloy, embedded, dict(skin=0.2)),
    "tilted": (lambda: crystal(6, PRISM), {}, {}),
    "outdated": (crystal, {}, dict(every=20, check=False)),
    "mixed precision": (crystal, {}, dict(precision="mixed")),
    "chains": (chains, CHAIN, {}),
    "chains, partners left out": (chains, dict(CHAIN, pair=FULL), dict(skin=0.2)),
    "chains, partners with a weight": (chains, dict(CHAIN, pair=FULL, special_bonds=WEIGHTS), dict(skin=0.2)),
}


def moved(name: str, threads: int, folder):
    """A loop after some steps of a scene, and how many of its lists Python made."""
    make, interactions, options = SCENES[name]
    system = make()
    forces = interactions(folder, system) if callable(interactions) else Interactions.build(**interactions) if interactions else None
    loop = loop_of(system, [NVE(), Langevin("all", 1.0, 2.0, 77)], interactions=forces, threads=threads, **options)
    loop.watchdog.on = False
    loop.setup()
    count, rebuild = [0], loop.engine.rebuild

    def counted():
        count[0] += 1
        rebuild()
    loop.engine.rebuild = counted
    for steps in (70, 1, 59):
        loop.advance(steps)
    return loop, count[0]


@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize("name", SCENES)
def test_motion_has_the_same_digits(name, threads, monkeypatch, tmp_path):
    loop, made = moved(name, threads, tmp_path)
    monkeypatch.setattr(relist.Relist, "table", lambda *_: relist.NO_CALLS)
    other, all_made = moved(name, threads, tmp_path)
    assert loop.engine.builds == other.engine.builds == all_made > 4
    assert made <= 1        # where arrays must grow
    for field in ("x", "v", "f", "image"):
        np.testing.assert_array_equal(getattr(loop.system, field), getattr(other.system, field))
    assert loop.engine.pairs == other.engine.pairs
    assert loop.engine.timings["Neigh"] > 0.0


@pytest.mark.parametrize("sort", [0, 1000])
def test_fixes_that_wait_for_their_step_leave_lists_to_the_loop(sort):
    """Those before which a reservoir acts, too."""
    from asemd.fix.gcmc import GCMC
    fix = GCMC(every=50, exchanges=3, moves=3, kind=1, seed=7, temperature=1.4, mu=-3.0, displace=0.3)
    fix.storage.every = sort
    loop = loop_of(crystal(), [NVE(), fix])
    loop.watchdog.on = False
    loop.setup()
    before, made, rebuild = loop.engine.builds, [], loop.engine.rebuild

    def counted():
        made.append(loop.step)
        rebuild()
    loop.engine.rebuild = counted
    loop.advance(160)
    assert not made and loop.engine.builds - before > 9


def test_arrays_that_are_too_small_grow():
    """Atoms that rush into a plane: rows get longer, and Python makes some of the lists."""
    n, edge = 1500, 16.0
    x = np.random.default_rng(1).uniform(0, edge, (n, 3))
    v = np.zeros((n, 3))
    v[:, 0] = -0.9 * (x[:, 0] - edge / 2)

    def system():
        return System(box=Box(np.zeros(3), np.eye(3) * edge), x=x.copy(), type=1, v=v.copy(), units="lj",
                      mass=np.array([np.nan, 1.0]))
    loop = loop_of(system(), interactions=Interactions.build(pair={"soft 6.0": {(1, 1): (1e-9,)}}), dt=0.01)
    loop.watchdog.on = False
    loop.setup()
    before, made, rebuild = loop.engine.terms[0].row, [0], loop.engine.rebuild

    def counted():
        made[0] += 1
        rebuild()
    loop.engine.rebuild = counted
    loop.advance(70)
    assert loop.engine.terms[0].row > before
    assert 0 < made[0] < loop.engine.builds


def test_slots_that_are_too_few_become_more():
    """Atoms of a line that rush into groups: clusters end with each group."""
    z = np.arange(400) + 0.5
    v = np.zeros((400, 3))
    v[:, 2] = 4.5 - z % 9
    system = System(box=Box(np.zeros(3), np.diag([6.0, 6.0, 400.0])), x=np.column_stack([np.full((400, 2), 3.0), z]), type=1, v=v,
                    units="lj", mass=np.array([np.nan, 1.0]))
    loop = loop_of(system, interactions=Interactions.build(pair={"soft 1.7": {(1, 1): (1e-9,)}}), dt=0.01)
    loop.watchdog.on = False
    loop.setup()
    before, builds = loop.engine.list.capacity, loop.engine.builds
    loop.advance(80)
    assert loop.engine.builds > builds + 4 and loop.engine.list.capacity > before + 100
    made = loop.engine.pairs
    loop.engine.load()
    assert loop.engine.pairs == made


def test_fixes_that_have_to_do_with_lists_keep_them_in_python():
    class Looks(NVE):
        seen = 0

        def post_neighbor(self, loop):
            self.seen += 1
    fix = Looks()
    loop = loop_of(crystal(), [fix])
    loop.setup()
    fix.seen = 0
    loop.advance(100)
    assert fix.seen == loop.engine.builds > 4


def test_the_watchdog_looks_in_between():
    """Its frames do not grow old where lists are built without it."""
    loop = loop_of(crystal())
    loop.setup()
    loop.advance(30)
    assert loop.watchdog.patience()[0] < np.inf
    loop.watchdog._next = 0.0       # its time has come
    steps = [f.step for f in loop.watchdog.frames]
    loop.advance(60)
    assert max(f.step for f in loop.watchdog.frames) > max(steps)


def test_the_first_frames_of_a_run_leave_lists_to_the_loop():
    loop = loop_of(crystal(temperature=2.0), skin=0.1)
    loop.setup()
    made, rebuild = [], loop.engine.rebuild
    loop.engine.rebuild = lambda: (made.append(loop.step), rebuild())
    loop.advance(30)
    kept = {f.step for f in loop.watchdog.frames} - {0}
    assert not made and loop.engine.builds > FIRST and len(kept) > 0 and loop.watchdog._spare <= 0


def test_a_frame_that_is_kept_before_a_list_is_folded_into_the_box():
    loop = loop_of(crystal(temperature=2.0), skin=0.1)
    loop.setup()
    loop.engine.state.x[0, :loop.engine.ns] += 2.0      # before anybody folds them
    loop.watchdog._keep()
    good, box = loop.watchdog.frames[-1].system(loop.system), loop.system.box
    inside = box.fractional(good.x)
    assert (inside >= 0.0).all() and (inside < 1.0).all() and good.image.any()
    np.testing.assert_allclose(box.unwrap(good.x, good.image), box.unwrap(loop.system.x, loop.system.image) + [2.0, 0.0, 0.0], atol=1e-12)


def test_a_term_whose_rebuild_does_more_is_for_python():
    class Term:
        def rebuild(self, engine): ...

        def relisted(self, engine): ...

    class More(Term):
        def rebuild(self, engine): ...
    assert relist.follows(Term()) and not relist.follows(More()) and not relist.follows(object())


def test_a_position_that_is_not_a_number_is_found():
    loop = loop_of(crystal())
    loop.watchdog.on = False
    loop.setup()
    loop.advance(10)
    loop.state.x[1, 7] = np.nan
    with pytest.raises(SimulationError, match="not finite|NaN"):
        loop.advance(50)


def test_rows_have_room_for_all_slots(tmp_path):
    """Lists that follow may have more slots than the first one: atoms that leave a column make another one longer."""
    loop, _ = moved("chains", 1, tmp_path)
    engine = loop.engine
    assert engine.rows and all(rows.start.shape[1] > engine.state.x.shape[1] >= engine.list.capacity for rows in engine.rows.values())
