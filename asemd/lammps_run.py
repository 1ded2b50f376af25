"""A scene in the hands of LAMMPS: the same script and data on any number of MPI ranks, the results as asemd has them."""
from __future__ import annotations

import os
import re
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from asemd import lammps_process, units
from asemd.errors import AsemdError, InputError, SimulationError, Where
from asemd.lammps import lex, script
from asemd.lammps.convert import to_lammps
from asemd.lammps.read import read
from asemd.lammps.record import Run
from asemd.lammps.switches import Switches
from asemd.scene import Scene
from asemd.testing.validate import validate
from asemd.thermo import KEYWORDS
from asemd.thermo_text import Output

TAIL = 1 << 16      # bytes at the end of a log in which the last command stands
COMMAND = re.compile(r"^\s*(run|minimize)\s+(.*)$", re.M)


@dataclass
class LammpsRun:
    """What LAMMPS did.

    Attributes
    ----------
    ranks : int
    version : int
        Of LAMMPS, as 20250722.
    agreement : str
        What the comparison before the run said; empty if there was none.
    runs : list of asemd.lammps.record.Run
        The thermo columns and rows of each run and minimisation, timings, counts of neighbour lists.
    output : str
        What LAMMPS printed.
    atoms : asemd.Atoms or None
        As they are at the end, in order of id and in ASE's units, with velocities, types and topology, in the frame that the scene had;
        without calculator. None where they were not asked for, or the script has no atoms.
    """

    ranks: int
    version: int = 0
    agreement: str = ""
    runs: list[Run] = field(default_factory=list)
    output: str = ""
    atoms: Any = None
    status: int = 0


def run_lammps(source, ranks: int = 1, *, steps: int | None = None, folder: str | os.PathLike = ".", check: bool = True,
               tolerance: float | None = None, compat: str = "", switches: Switches | None = None, atoms: bool = True,
               watcher: Any = None) -> LammpsRun:
    """Run a script or a scene on LAMMPS.

    Before that, energies, forces and virials of the first step are computed by asemd and by LAMMPS; the run begins only if they agree.

    Parameters
    ----------
    source : path or Scene
        A script goes to LAMMPS as it is, from the working directory. A scene is written into `folder` as ``in.scene`` and
        ``data.scene`` (`Scene.to_lammps`), with `steps`.
    ranks : int
        MPI ranks; one needs no ``mpiexec``.
    steps : int, optional
        For a scene.
    folder : path
        Where files of a scene go; LAMMPS runs in it.
    check : bool
        False: no comparison, and asemd does not read the script, so that it may hold what asemd does not have.
    tolerance : float, optional
        Largest relative difference that counts as agreement, 1e-9 by default.
    compat : str
        ``"lammps"``: compare with LAMMPS's own forces where they are not the gradient of its energy.
    switches : Switches, optional
        LAMMPS's command line.
    atoms : bool
        Whether the atoms at the end are wanted.
    watcher : object, optional
        Is told of the text and the progress: ``write(text)``, ``start(steps)``, ``update(done)``, ``stop()``.

    Returns
    -------
    LammpsRun

    Raises
    ------
    SimulationError
        The two programs do not agree on the first step, or LAMMPS stopped with an error.
    InputError
        A mistake in the script.
    OracleError
        LAMMPS or mpiexec is missing.
    """
    if ranks < 1:
        raise InputError(f"ranks must be at least 1, got {ranks}")
    if isinstance(source, Scene):
        return _scene(source, ranks, steps, Path(folder), check, tolerance, compat, atoms, watcher)
    if steps is not None:
        raise InputError("run_lammps: steps are for a scene, a script says itself how long it runs")
    lammps_process.check_ranks(ranks)
    switches = switches or Switches()
    found = LammpsRun(ranks)
    if check:
        try:
            report = validate(source, steps=None, tolerance=tolerance, compat=compat, switches=switches)
        except InputError as e:
            e.message += "; --no-check (check=False) hands the script over unread"
            raise
        found.agreement = agreement(report)
        if watcher is not None:
            watcher.write(found.agreement + "\n")
    return _carry_out(found, os.fspath(source), switches, None, atoms, watcher)


def agreement(report) -> str:
    """One line if the programs agree.

    Raises
    ------
    SimulationError
        They do not; it names what differs most.
    """
    if report.ok:
        return f"asemd and LAMMPS {report.version} agree on the first step: largest relative difference {report.worst:.1e}"
    if report.failures:
        raise SimulationError(report.failures[0])
    worst: Any = max([*report.energies, *report.forces], key=lambda row: max(row.error, getattr(row, "virial_error", 0.0)))
    if hasattr(worst, "asemd"):
        what = f"energy of {worst.term}: {worst.asemd:.10g} and {worst.lammps:.10g}"
    elif worst.error >= worst.virial_error:
        what = f"forces of {worst.term}: differ by up to {worst.worst:.3g}, the largest is {worst.largest:.6g}"
    else:
        k = int(np.argmax(np.abs(np.subtract(worst.virial_asemd, worst.virial_lammps))))
        what = f"pressure (virial of {worst.term}): {worst.virial_asemd[k]:.10g} and {worst.virial_lammps[k]:.10g}"
    meant = "; this one is meant (docs/differences.md), --compat lammps compares with LAMMPS's own forces" if report.documented else ""
    raise SimulationError(f"asemd and LAMMPS do not agree on the first step, {what} (relative {report.worst:.1e}, tolerance "
                          f"{report.tolerance:g}){meant}; nothing was run, --no-check (check=False) goes on all the same")


def _scene(scene: Scene, ranks: int, steps: int | None, folder: Path, check: bool, tolerance: float | None, compat: str, atoms: bool,
           watcher: Any) -> LammpsRun:
    system = scene.need_system("run_lammps")
    if steps is None or steps < 0:
        raise InputError(f"run_lammps: a scene needs steps, a number of at least 0, got {steps}")
    if system.units == "ase":
        raise InputError("run_lammps: a scene in ASE's units has no timestep of LAMMPS's: choose units metal for it")
    lammps_process.check_ranks(ranks)
    found = LammpsRun(ranks)
    if check:
        found.agreement = agreement(validate(scene, tolerance=tolerance, compat=compat))
        if watcher is not None:
            watcher.write(found.agreement + "\n")
    path = to_lammps(scene, folder)
    words = [w for w in scene.thermo.words if w in KEYWORDS]      # the script has no computes and variables
    every = scene.thermo.every if isinstance(scene.thermo.every, int) else 0
    with open(path, "a", encoding="utf-8") as f:
        f.write("".join(line + "\n" for line in (*([f"thermo_style custom {' '.join(words)}"] if words else []), f"thermo {every}",
                                                 f"run {steps}")))
    found = _carry_out(found, path.name, Switches(), folder, atoms, watcher)
    if found.atoms is not None:
        _turn_back(found.atoms, system)
    return found


def _turn_back(atoms, system) -> None:
    """From LAMMPS's frame into that of the scene."""
    if system.box.is_lammps_frame:
        return
    rotation = system.box.to_lammps()[1].T
    velocities = atoms.get_velocities()
    inside = atoms.positions - atoms.get_celldisp().reshape(3)
    origin = system.box.origin * units.factor("distance", system.units)
    atoms.set_cell(atoms.cell.array @ rotation)
    atoms.set_celldisp(origin)
    atoms.positions = inside @ rotation + origin
    if velocities is not None:
        atoms.set_velocities(velocities @ rotation)


def _carry_out(found: LammpsRun, path: str, switches: Switches, cwd: Path | None, atoms: bool, watcher: Any) -> LammpsRun:
    telling = _Telling(watcher, Path(cwd or ".") / (switches.log or "log.lammps"))
    with tempfile.TemporaryDirectory(prefix="asemd-run-") as name:
        data = os.path.join(name, "final.data") if atoms else ""
        try:
            answer = lammps_process.run(path, Path(name), ranks=found.ranks, switches=words_of(switches), data=data, tell=telling, cwd=cwd)
        except lammps_process.LammpsError as e:
            raise placed(e, os.path.join(cwd, path) if cwd else path) from None
        finally:
            telling.stop()
        found.version, found.status = answer.get("version", 0), answer.get("quit", 0)
        found.runs, found.output = telling.output.runs, "".join(telling.lines)
        if data and os.path.exists(data):
            found.atoms = read(data)
    return found


def words_of(switches: Switches) -> list[str]:
    """The command line for LAMMPS."""
    out = ["-nonbuf"]
    for name, values in switches.variables:
        out += ["-var", name, *values]
    for name in ("log", "screen", "echo"):
        value = getattr(switches, name)
        if value is not None:
            out += [f"-{name}", value]
    for package in switches.package:
        out += ["-package", *package.split()]
    return [*out, *(["-suffix", *switches.suffix.split()] if switches.suffix else []), *(["-nocite"] if switches.nocite else [])]


def placed(error: lammps_process.LammpsError, path: str) -> AsemdError:
    """The error of LAMMPS with file and line, found by the text of the line that it names where no other line reads the same."""
    if not error.line:
        return SimulationError(str(error))
    wanted = " ".join(error.line.split())
    found = [where for where in _lines(path, set()) if where.text.partition("#")[0].split() == wanted.partition("#")[0].split()]
    if len({(w.file, w.line) for w in found}) == 1:
        return InputError(str(error), found[0])
    return SimulationError(f"{error} (at the command: {wanted})")


def _lines(path: str, seen: set[str]) -> list[Where]:
    """The lines of a script and of those that it includes."""
    if path in seen or not os.path.isfile(path):
        return []
    seen.add(path)
    out = []
    for command in script.read(path):
        out.append(command.where)
        words = lex.strip_comment(command.text).split() if '"' not in command.text else []
        if len(words) == 2 and words[0] == "include":
            out += _lines(words[1], seen)
    return out


class _Telling:
    """Hears LAMMPS line by line and tells the watcher of text and progress."""

    def __init__(self, watcher: Any, log: Path):
        self.watcher, self.log, self.output = watcher, log, Output()
        self.lines: list[str] = []
        self.begun = False

    def __call__(self, line: str) -> None:
        self.lines.append(line)
        what = self.output.feed(line)
        if self.watcher is None:
            return
        if what == "end":
            self.stop()
        self.watcher.write(line)
        if what == "start" and (total := self.total()):
            self.begun = True
            self.watcher.start(total)
        if what == "row" and self.begun and self.output.step is not None:
            self.watcher.update(self.output.step - self.output.runs[-1].begin)

    def total(self) -> int:
        """Steps of the run that begins, out of the echo of its command in the log; 0 if it is not there."""
        try:
            with open(self.log, "rb") as f:
                f.seek(max(0, os.path.getsize(self.log) - TAIL))
                text = f.read().decode(errors="replace")
        except OSError:
            return 0
        commands = COMMAND.findall(text)
        if not commands:
            return 0
        name, words = commands[-1][0], commands[-1][1].split()
        at = 0 if name == "run" else 2
        steps = int(words[at]) if len(words) > at and words[at].isdigit() else 0
        return max(0, steps - self.output.runs[-1].begin) if "upto" in words else steps

    def stop(self) -> None:
        """The run is over."""
        if self.begun:
            self.begun = False
            self.watcher.stop()
