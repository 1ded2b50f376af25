"""Pruned lists: never a pair too few, while atoms and box move, with exclusions, several threads, outdated lists and both precisions."""
from __future__ import annotations

import numpy as np
import pytest
from wheel import ran

from asemd.engine import Engine, Settings
from asemd.kernels import cluster_rows
from asemd.pruned import PrunedList

SCRIPT = """
units real
atom_style full
region b prism 0 18 0 17 0 19 {tilt}
create_box 2 b bond/types 1 extra/bond/per/atom 2 extra/special/per/atom 4
mass * 12.0
create_atoms 1 random 260 7 NULL overlap 1.3
create_atoms 2 random 260 9 NULL overlap 1.3
set type 1 charge 0.4
set type 2 charge -0.4
bond_style harmonic
bond_coeff 1 10.0 1.5
special_bonds lj/coul 0.0 1.0 1.0
create_bonds many all all 1 0.5 1.7
pair_style lj/cut/coul/long 6.0
pair_coeff 1 1 0.1 1.2
pair_coeff 2 2 0.05 1.5
kspace_style ewald 1e-4
neighbor 2.0 bin
neigh_modify {modify}
"""
TILTS = {"orthogonal": "0 0 0", "triclinic": "3 -2 2"}


@pytest.fixture
def always(monkeypatch):
    """Lists are pruned whether it pays or not."""
    monkeypatch.setattr(PrunedList, "pays", staticmethod(lambda *_: True))


def scene(tilt: str, modify: str = "every 1 delay 0"):
    return ran(SCRIPT.format(tilt=TILTS[tilt], modify=modify))


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("tilt", list(TILTS))
@pytest.mark.parametrize("precision", ["double", "mixed"])
def test_no_pair_is_missed(always, tilt, threads, precision):
    s = scene(tilt).session.scene
    engine = Engine(s.system, s.interactions, Settings(skin=2.0, threads=threads, precision=precision))
    other = Engine(s.system, s.interactions, Settings(skin=0.3))
    term = next(t for t in engine.terms if hasattr(t, "pruned"))
    rng = np.random.default_rng(3)
    x = s.system.x.copy()
    builds = evaluations = 0
    for step in range(14):
        x = x + rng.normal(scale=0.3 if step == 9 else 0.05, size=x.shape)
        engine.move(x)
        mine = engine.collect()
        f, e = mine.forces.copy(), dict(mine.energy)
        builds, evaluations = engine.builds, evaluations + 1
        other.load()
        other.forces(True)
        exact = other.collect()
        size = np.abs(exact.forces).max()
        tolerance = 1e-12 if precision == "double" else 2e-5
        assert np.abs(f - exact.forces).max() < tolerance * size, step
        assert e["ecoul"] == pytest.approx(exact.energy["ecoul"], rel=100 * tolerance)
    assert builds < term.pruned.renewals < evaluations + builds and builds < evaluations


@pytest.mark.parametrize("commands", [
    "fix 1 all nve\nvelocity all create 300 4\nrun 20",
    "fix 1 all npt temp 300 300 50 aniso 2000 2000 100\nvelocity all create 300 4\nrun 20",
    "fix 1 all nve\nfix 2 all deform 1 x scale 0.97 xy erate 0.002 remap v\nvelocity all create 300 4\nrun 20",
    "fix 1 all nve\nneigh_modify delay 8 every 4\nvelocity all create 1500 4\nrun 20",
    "fix 1 all nve\nneigh_modify check no every 10 delay 0\nvelocity all create 1500 4\nrun 20",
    "min_style cg\nminimize 1e-4 1e-6 15 100",
], ids=["nve", "npt", "deform", "delay", "no check", "minimize"])
def test_the_same_run(monkeypatch, commands):
    tilt = "triclinic" if "deform" in commands else "orthogonal"
    found = []
    for prune in (True, False):
        monkeypatch.setattr(PrunedList, "pays", staticmethod(lambda *_, prune=prune: prune))
        lmp = scene(tilt)
        lmp.commands_string("minimize 1e-2 1e-2 30 100\n" + commands)
        s = lmp.session.scene.system
        order = np.argsort(s.id)
        found.append((s.x[order].copy(), lmp.get_thermo("pe"), lmp.get_thermo("press")))
        terms = [t for t in lmp.session.loop.engine.terms if hasattr(t, "pruned")] if lmp.session.loop else []
        assert all((t.pruned is not None) == prune for t in terms)
    (x, pe, press), (y, pe2, press2) = found
    assert np.abs(x - y).max() < 1e-7
    assert pe == pytest.approx(pe2, rel=1e-9) and press == pytest.approx(press2, rel=1e-6, abs=1e-4)


@pytest.mark.parametrize("edge", ["18 0 17 0 19", "13 0 12.5 0 14"])
@pytest.mark.parametrize("tilt", list(TILTS))
def test_both_ways_to_find_excluded_entries(tilt, edge, monkeypatch):
    """Partners looked for one by one, and by a table of the row; a small cell has several images of an atom in a row."""
    small = edge[:2] == "13"
    text = SCRIPT.replace("18 0 17 0 19", edge).replace("random 260", "random 110" if small else "random 260")
    s = ran(text.format(tilt="0.5 -0.5 0.4" if small and tilt != "orthogonal" else TILTS[tilt], modify="every 1 delay 0")).session.scene
    engine = Engine(s.system, s.interactions, Settings(skin=2.0))
    engine.compute()
    made, found = engine.list, []
    partners = engine.exclusions.partners if engine.exclusions.partners is not None else engine.exclusions.left_out
    for few in (cluster_rows.FEW, -1):
        monkeypatch.setattr(cluster_rows, "FEW", max(few, 0))
        first, excluded = np.zeros_like(made.excluded_first[0]), np.zeros_like(made.excluded[0])
        where, earlier = np.zeros(engine.state.x.shape[1], np.int64), np.zeros(4096, np.int64)
        n = cluster_rows.exclude(engine.slot_of, engine.state.row, *partners[:2], 0, int(made.bounds[1]), made.first[0], made.entries[0],
                                 made.own, first, excluded, where, earlier, engine.state.x, made.shifts, np.eye(3), False)
        found.append((n, first.tolist(), [sorted(excluded[a:b].tolist()) for a, b in zip(first, first[1:]) if b > a]))
    assert found[0] == found[1] and found[0][0] > 10
