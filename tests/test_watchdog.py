"""The watchdog of runs: what it stops and how it tells, what it must leave alone, that it changes nothing."""
from __future__ import annotations

import math

import both
import numpy as np
import pytest
from ase import io, units
from wheel import ask, ran

import asemd
from asemd.box import Box
from asemd.culprit import Item, advice, worst_item
from asemd.engine import Settings
from asemd.errors import SimulationError
from asemd.fix.nve import NVE
from asemd.forcefield import Interactions
from asemd.lammps.dump_read import frames
from asemd.lammps.session import Session
from asemd.lammps.switches import Switches
from asemd.loop import Loop
from asemd.system import System
from asemd.topology import Topology

MELT = """units lj
lattice fcc 0.8442
region box block 0 {n} 0 {n} 0 {n}
create_box 1 box
create_atoms 1 box
mass 1 1.0
velocity all create 1.44 87287 loop geom
pair_style lj/cut 2.5
pair_coeff 1 1 1.0 1.0
fix 1 all nve
thermo 10
timestep {dt}
"""
CRAMMED = """units lj
region box block 0 8 0 8 0 8
create_box 1 box
create_atoms 1 random 300 1234 box
mass 1 1.0
velocity all create 1.0 87287
pair_style lj/cut 2.5
pair_coeff 1 1 1.0 1.0
timestep 0.003
thermo 20
"""


def chain(stretch: float = 0.0, k: float = 100.0, dt: float = 0.01, n: int = 8, fixes=None, **options) -> Loop:
    """A loop of a straight chain of harmonic bonds; the one in the middle is `stretch` too long."""
    x = np.zeros((n, 3)) + 10.0
    x[:, 0] += np.arange(n) - n / 2
    x[n // 2:, 0] += stretch
    system = System(box=Box(np.zeros(3), np.eye(3) * 20.0), x=x, type=1, units="lj", mass=np.array([np.nan, 1.0]),
                    id=np.arange(n) + 101, topology=Topology(bonds=[(i, i + 1) for i in range(n - 1)]))
    inter = Interactions.build(bond={"harmonic": {1: (k, 1.0)}})
    return Loop(system, inter, Settings(**options), fixes or [NVE()], {"all": np.ones(n, bool)}, dt)


def failure(text: str, folder, log: str = "log.run") -> tuple[SimulationError, Session]:
    switches = Switches()
    switches.log = str(folder / log)
    session = Session(switches=switches, screen=None)
    with pytest.raises(SimulationError) as caught:
        session.commands(text)
    session.close()
    return caught.value, session


# --------------------------------------------------------------------------------------------------------------- what it stops ---

def test_overlapping_atoms(tmp_path):
    """The pair is named, the frame before the first step is written, the advice is to relax."""
    error, _ = failure(CRAMMED + "fix 1 all nve\nrun 500\n", tmp_path)
    v = error.verdict
    assert v.item.kind == "pair" and v.item.distance < 0.3 and v.item.energy > 1e6
    assert v.good.step == 0 and v.path == str(tmp_path / "log.run.last_good.dump")
    for words in ("step ", f"pair between atoms {v.item.ids[0]} {v.item.ids[1]} (pair_style lj/cut, r = ", "log.run.last_good.dump",
                  "try minimize", "overlap", "pair_style soft", "nve/limit"):
        assert words in str(error), words
    assert "timestep" not in str(error)     # no timestep helps there
    assert "\n" not in str(error)


def test_the_pair_is_that_of_a_brute_search(tmp_path):
    _, session = failure(CRAMMED + "fix 1 all nve\nrun 500\n", tmp_path)
    good = session.loop.watchdog.frames[0].system(session.scene.system)
    d = good.box.minimum_image((good.x[:, None] - good.x[None]).reshape(-1, 3))[0].reshape(300, 300, 3)
    r = np.linalg.norm(d, axis=2) + 9.0 * np.eye(300)
    i, j = np.unravel_index(np.argmin(r), r.shape)
    item = worst_item(good, session.scene.interactions, Settings(), 0.003)
    assert set(item.ids) == {good.id[i], good.id[j]}
    assert item.distance == pytest.approx(r[i, j], rel=1e-12)
    assert item.energy == pytest.approx(4 * (r[i, j]**-12 - r[i, j]**-6), rel=1e-10)
    assert item.force == pytest.approx(24 * (2 * r[i, j]**-13 - r[i, j]**-7), rel=1e-10)
    omega = math.sqrt(2 * 4 * (156 * r[i, j]**-14 - 42 * r[i, j]**-8))        # reduced mass 1/2
    assert item.period == pytest.approx(2 * math.pi / omega, rel=1e-4)


def test_many_atoms(tmp_path, monkeypatch):
    """Of many atoms the fastest and their surroundings are searched: here they hold the same pair."""
    from asemd import culprit
    session = both.asemd(CRAMMED + "fix 1 all nve\nrun 0\nvelocity all set 0 0 0\n")
    system, inter = session.scene.system, session.scene.interactions
    settings = Settings(exclude=[("group", np.zeros(300, bool), np.ones(300, bool))])
    whole = worst_item(system, inter, settings, 0.003)
    system.v[system.index_of(whole.ids)] = 1.0
    monkeypatch.setattr(culprit, "MANY", 100)
    part = worst_item(system, inter, settings, 0.003, 2.5)
    assert part.ids == whole.ids and part.energy == pytest.approx(whole.energy, rel=1e-10)


def test_a_report_that_fails_hides_nothing(tmp_path, monkeypatch):
    from asemd import culprit
    monkeypatch.setattr(culprit, "worst_item", lambda *_: 1 / 0)
    error, _ = failure(CRAMMED + "fix 1 all nve\nrun 500\n", tmp_path)
    assert "since the neighbour list was built" in str(error) and "(division by zero)" in str(error) and error.verdict.path


def test_the_last_good_state_goes_on(tmp_path):
    """The file holds the state to the last digit, and read_dump takes it."""
    error, session = failure(MELT.format(n=4, dt=0.05) + "run 400\n", tmp_path)
    good = error.verdict.good
    assert 0 <= good.step < error.verdict.step
    fresh = both.asemd(MELT.format(n=4, dt=0.002))
    fresh.call("read_dump", [error.verdict.path, str(good.step), *"x y z vx vy vz ix iy iz".split(), "box", "yes"])
    system = fresh.scene.system
    np.testing.assert_array_equal(system.x, good.x)
    np.testing.assert_array_equal(system.v, good.v)
    np.testing.assert_array_equal(system.image, good.image)
    fresh.call("run", ["10"])
    assert not list(tmp_path.glob("*.part*"))


def test_dumps_are_whole(tmp_path):
    """What was written before the run failed can be read, frame by frame."""
    error, session = failure(MELT.format(n=4, dt=0.03) + f"dump 1 all custom 1 {tmp_path}/d id x y z\nrun 2000\n", tmp_path)
    steps = [frame.step for frame in frames(f"{tmp_path}/d", "native")]
    assert steps == list(range(len(steps))) and steps[-1] >= error.verdict.step - 1 and error.verdict.good.step in steps


def test_a_timestep_far_too_long_in_a_melt(tmp_path):
    """Energy from nowhere: found long before anything is infinite; LAMMPS goes on with it, or loses atoms."""
    error, _ = failure(MELT.format(n=5, dt=0.05) + "run 1000\n", tmp_path)
    good = error.verdict.good
    assert error.verdict.step < 300 and "try a shorter timestep (asemd check finds one)" in str(error)
    assert np.abs(good.v).max() * 0.05 < 2.5 and error.verdict.item.energy < 1e4


def test_energy_from_nowhere_alone():
    """A harmonic bond just above its limit of stability: energy grows by a small factor in each step, no atom ever flies."""
    loop = chain(0.01, k=100.0, dt=2.0 / math.sqrt(400.0) * 1.005, n=2)
    told = []
    loop.warn = told.append
    loop.setup()
    with pytest.raises(SimulationError, match=r"total energy rose by .* not for the first time") as caught:
        for _ in range(200):
            loop.watchdog._next_energy = 0.0
            loop.advance(10)
    v = caught.value.verdict
    assert v.item.ids == (101, 102) and v.item.period == pytest.approx(2 * math.pi / 20.0, rel=1e-6)
    assert len(told) == 1 and "total energy rose" in told[0]
    assert any("vibrates with a period of 0.314, " in line and line.startswith("timestep 0.016") for line in v.advice)


def test_a_bond_beyond_its_length(tmp_path):
    """An error that a kernel raises gets the same treatment."""
    system = chain(n=2).system
    inter = Interactions.build(bond={"fene": {1: (30.0, 1.5, 1.0, 1.0)}})
    system.v[:, 0] = -15.0, 15.0
    loop = Loop(system, inter, Settings(), [NVE()], {"all": np.ones(2, bool)}, 0.01)
    loop.watchdog.path = str(tmp_path / "state.dump")
    loop.setup()
    with pytest.raises(SimulationError, match=r"step \d+: bond of type 1 between atoms 101 102 .* R0") as caught:
        loop.advance(100)
    assert "strongest pull" in str(caught.value) and "last good state (step" in str(caught.value)
    assert (tmp_path / "state.dump").read_text().startswith("ITEM: TIMESTEP")
    assert caught.value.verdict.item.ids == (101, 102)


def test_velocities_that_are_not_numbers_and_never_a_list():
    loop = chain(every=10**6)
    loop.setup()
    loop.advance(5)
    loop.state.v[1, 3] = np.nan
    loop.watchdog._next = 0.0
    with pytest.raises(SimulationError, match=r"step 6: .* atoms 10\d 10\d: .* not a number"):
        loop.advance(1)


class Rigid(NVE):
    """Stands for a fix with constraints."""

    broken = ""

    def broken_constraint(self, loop):
        return self.broken


def test_broken_constraints():
    fix = Rigid()
    fix.id = "7"
    loop = chain(fixes=[fix])
    loop.setup()
    loop.advance(10)
    fix.broken, loop.watchdog._next = "bond 101 102 is off by 0.3", 0.0
    with pytest.raises(SimulationError, match=r"step \d+: fix 7 \(style nve\): bond 101 102 is off by 0.3; last|bond 101 102 is off"):
        loop.advance(10)


def test_runs_of_atoms(tmp_path):
    atoms = asemd.Atoms("Ar2", [(0, 0, 0), (1.0, 0, 0)], cell=[20] * 3, pbc=True)
    atoms.calc = asemd.ForceField(bond={"harmonic": {1: (10.0, 1.0)}}, topology=Topology(bonds=[(0, 1)]))
    atoms.set_velocities([(0, 0, 0), (0.01, 0, 0)])
    dyn = asemd.MolecularDynamics(atoms, 200 * units.fs, logfile=str(tmp_path / "md.log"), loginterval=10)
    with pytest.raises(SimulationError, match="md.log.last_good.extxyz"):
        dyn.run(5000)
    saved = io.read(tmp_path / "md.log.last_good.extxyz")
    assert len(saved) == 2 and np.isfinite(saved.get_velocities()).all() and "step" in saved.info


# ------------------------------------------------------------------------------------------------------- what it leaves alone ---

def finishes(text: str) -> float:
    with ran(text) as own:
        return own.get_thermo("temp")


def wheel_finishes(text: str) -> float:
    return ask("""
l = ran(given["text"])
answer = l.get_thermo("temp")
""", text=text)


SANE = {
    "overlaps pushed apart": CRAMMED + "fix 1 all nve/limit 0.05\nrun 300\nunfix 1\nfix 1 all nve\nrun 100\n",
    "soft push off": CRAMMED.replace("lj/cut 2.5", "soft 1.1").replace("1.0 1.0", "60.0")
    + "fix 1 all nve\nfix 2 all langevin 1 1 0.1 5\nrun 300\n",
    "exothermic": MELT.format(n=4, dt=0.0005).replace("0.8442", "3.2").replace("create 1.44", "create 0.0001") + "run 600\n",
    "projectile": MELT.format(n=5, dt=0.0001) + "group one id 1\nvelocity one set 100.0 20.0 3.0\nrun 400\n",
    "heated": MELT.format(n=4, dt=0.001) + "fix 2 all langevin 500.0 500.0 0.02 7\nrun 300\n",
    "pulled": MELT.format(n=4, dt=0.002) + "fix 2 all addforce 200.0 0 0\nrun 300\n",
    "gas": MELT.format(n=5, dt=0.0005).replace("0.8442", "0.01") + "velocity all scale 400.0\nrun 300\n",
    "velocities set between runs": MELT.format(n=4, dt=0.001) + "run 50\nvelocity all scale 300.0\nrun 50 pre no\n",
}


@pytest.mark.parametrize("name", SANE)
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_sound_runs_go_on(name):
    """Hot, violent and pushed runs that LAMMPS completes."""
    assert math.isfinite(finishes(SANE[name]))


def test_hot_runs_are_as_in_lammps():
    for name in ("exothermic", "gas"):
        assert finishes(SANE[name]) == pytest.approx(wheel_finishes(SANE[name]), rel=1e-3)


def test_free_atoms_may_fly():
    loop = chain(n=2)
    loop.system.topology = Topology()
    loop.engine.update(loop.system)
    loop.system.v[0] = 900.0, 0.0, 0.0
    loop.setup()
    loop.advance(200)
    assert loop.system.image[0].any()


# ------------------------------------------------------------------------------------------------------------------ how it works ---

def test_it_changes_nothing():
    """The same digits with and without."""
    out = []
    for explains in (True, False):
        session = both.asemd(MELT.format(n=4, dt=0.005) + "run 0\n")
        loop = session.loop
        loop.watchdog.explains = explains
        loop.watchdog._next = 0.0 if explains else np.inf
        for _ in range(5):
            loop.advance(30)
            loop.watchdog._next = 0.0 if explains else np.inf
        out.append((loop.system.x.copy(), loop.system.v.copy()))
    np.testing.assert_array_equal(out[0], out[1])


def test_it_keeps_two_frames_and_waits():
    """After a look it waits 200 times as long as that took: half a percent at most."""
    session = both.asemd(MELT.format(n=4, dt=0.005) + "run 2000\n")
    dog = session.loop.watchdog
    assert len(dog.frames) == 2 and 0 < dog.frames[0].step < dog.frames[1].step <= 2000
    for frame in dog.frames:
        state = frame.system(session.scene.system)
        assert np.isfinite(state.x).all() and state.step == frame.step and state.x is not session.scene.system.x


def test_quiet_without_an_explanation():
    loop = chain(0.2, k=100.0, dt=0.2)
    loop.watchdog.explains = False
    loop.setup()
    with pytest.raises(SimulationError) as caught:
        loop.advance(1000)
    assert not loop.watchdog.frames and not hasattr(caught.value, "verdict") and "try" not in str(caught.value)


def test_advice():
    bond = Item("bond", "bond_style harmonic", 1, (1, 2), 1.0, 5.0, 100.0, 0.01, period=0.4)
    assert advice(bond, 0.1, 5000, 1.0) == ["timestep 0.02 (this bond vibrates with a period of 0.4, 4 steps)"]
    pair = Item("pair", "pair_style lj/cut", 0, (1, 2), 0.1, 1e9, 1e11, 1e6, period=1e-6)
    near, far = advice(pair, 0.004, 3, 1.0), advice(pair, 0.004, 10**6, 1.0)
    assert near[0].startswith("minimize") and "overlap" in near[0] and not any("timestep" in a for a in near)
    assert far == advice(None, 1.0, 0, 1.0) == ["a shorter timestep (asemd check finds one)"]


def test_the_timestep_that_check_finds_holds(tmp_path):
    """What the message of a run advises is the estimate of the check, which holds at once."""
    path = tmp_path / "in.melt"
    path.write_text(MELT.format(n=5, dt=0.5) + "run 200\n")
    error, _ = failure(path.read_text(), tmp_path)
    assert "asemd check finds one" in str(error)
    told = asemd.check(path).of("time step")[0].advice
    Session(screen=None).commands(MELT.format(n=5, dt=float(told.split("a timestep of ")[1].split()[0])) + "run 200\n")


@pytest.mark.parametrize("cells", [5, 1])
def test_atoms_in_one_place(tmp_path, cells):
    """The step is named, and what the message advises helps; minimize would end with the same error."""
    text = MELT.format(n=cells, dt=0.005).replace("velocity", "create_atoms 1 single 0 0 0\nvelocity", 1)
    for command in ("run 10\n", "minimize 0 0 10 100\n"):
        error, _ = failure(text + command, tmp_path)
        assert str(error).startswith("step 0: ") and "delete one of them (delete_atoms overlap) or move it (displace_atoms)" in str(error)
    for mended in ("delete_atoms overlap 0.3 all all", "group one id 1\ndisplace_atoms one move 0.4 0.4 0"):
        Session(screen=None).commands(f"{text}{mended}\nminimize 0 0 100 1000\nrun 10\n")


def test_switched_off(tmp_path):
    """Nothing is stopped, kept or written: the same run ends by itself, or where numbers are none."""
    from asemd.cli import main
    script = tmp_path / "in.fast"
    script.write_text(MELT.format(n=4, dt=0.05) + "run 400\n")
    log = tmp_path / "log"
    assert main(["run", str(script), "--quiet", "--log", str(log)]) == 1 and (tmp_path / "log.last_good.dump").exists()
    assert "run has come apart" in log.read_text() or "since the neighbour list" in log.read_text()
    (tmp_path / "log.last_good.dump").unlink()
    main(["run", str(script), "--quiet", "--log", str(log), "--no-watchdog"])
    assert "come apart" not in log.read_text() and not (tmp_path / "log.last_good.dump").exists()
    with ran(MELT.format(n=3, dt=0.004) + "run 10", "-watchdog", "no") as lmp:
        dog = lmp.session.loop.watchdog
        assert not dog.on and not dog.frames and dog.seconds == 0.0


def test_atoms_of_which_all_pairs_are_excluded_may_fly():
    lmp = ran("region b block 0 9 0 9 0 9\ncreate_box 1 b\ncreate_atoms 1 single 1 1 1\ncreate_atoms 1 single 2 2 2\nmass 1 1\n"
              "velocity all create 1 4711\npair_style lj/cut 2\npair_coeff * * 1 1\nneigh_modify exclude type 1 1\nfix 1 all nve\nrun 3")
    assert lmp.get_thermo("pe") == 0.0


@pytest.mark.parametrize("skin", [0.3, 0.0])
@pytest.mark.parametrize("size", [1, 3])
def test_atoms_without_forces_fly_freely(skin, size):
    """A pair style whose cutoffs are 0 reaches nowhere, and no atom flies too far."""
    with ran(f"units lj\nlattice fcc 0.8\nregion b block 0 {size} 0 {size} 0 {size}\ncreate_box 1 b\ncreate_atoms 1 box\nmass 1 1.0\n"
             f"velocity all create 1.0 4711\nneighbor {skin} bin\npair_style lj/cut 2.5\npair_coeff 1 1 1 1 0.0\nfix 1 all nve\n"
             "run 0\nrun 30") as lmp:
        assert lmp.get_thermo("pe") == 0.0 and lmp.get_thermo("temp") == pytest.approx(1.0, rel=1e-12)
