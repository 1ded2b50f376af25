"""What a run writes: the log file, the terminal, the echo of commands, warnings, and the block of timings after a run."""
from __future__ import annotations

import contextlib
import sys
import time
import warnings
from collections.abc import Callable
from typing import TextIO

from asemd import __version__
from asemd.errors import InputError, InputWarning
from asemd.lammps.timer import Timer

LANGUAGE = "22 Jul 2025"        # the version of LAMMPS whose scripts are read
ECHO = ("none", "screen", "log", "both")
SECTIONS = ("Pair", "Bond", "Kspace", "Neigh", "Comm", "Output", "Modify")


class Log:
    """Text for the user, written to a file and to the terminal.

    Parameters
    ----------
    path : str or None
        Log file; None or ``none``: no file.
    screen : callable or None
        Takes finished text for the terminal; None: no terminal output.
    echo : str
        Where commands are echoed: none, screen, log, both.
    """

    def __init__(self, path: str | None = None, screen: Callable[[str], None] | None = None, echo: str = "log"):
        self.screen, self.file, self.path = screen, None, None
        self.set_echo(echo)
        self.unbuffered = False
        self.started = time.time()
        self.warnings, self.max_warnings = 0, 100
        self.warned: list[str] = []         # what was said
        if path and path != "none":
            self.open(path)
        self.to_file(f"LAMMPS ({LANGUAGE} - asemd {__version__})\n")       # readers of logs look for the first word
        self.to_screen(f"asemd {__version__} (LAMMPS input language)\n")

    def __getstate__(self):
        """Copies write nowhere, so that two sessions do not write to one file."""
        return {**self.__dict__, "file": None, "screen": None}

    def open(self, path: str, append: bool = False) -> None:
        """Write to another file from now on; ``none`` for none."""
        self.close()
        if path != "none":
            try:
                self.file: TextIO | None = open(path, "a" if append else "w", encoding="utf-8")
            except OSError as e:
                raise InputError(f"cannot open log file {path}: {e.strerror}; -log FILE puts it elsewhere, -log none: no file") from None
            self.path = path

    def set_echo(self, style: str) -> None:
        if style not in ECHO:
            raise InputError(f"echo must be one of {' '.join(ECHO)}, got {style!r}")
        self.echo_style = style

    def echo(self, text: str) -> None:
        """A command as it was read, or after a variable was replaced."""
        text = text.rstrip()
        if self.echo_style in ("log", "both"):
            self.to_file(text + "\n")
        if self.echo_style in ("screen", "both"):
            self.to_screen(text + "\n")

    def write(self, text: str) -> None:
        """Text for the log file and the terminal; brings its own newlines."""
        self.to_file(text)
        self.to_screen(text)

    def to_file(self, text: str) -> None:
        if self.file:
            try:
                self.file.write(text)
                if self.unbuffered:
                    self.file.flush()
            except OSError as e:
                raise self.cannot_write(e) from None

    def to_screen(self, text: str) -> None:
        if self.screen:
            self.screen(text)

    def flush(self) -> None:
        if self.file:
            try:
                self.file.flush()
            except OSError as e:
                raise self.cannot_write(e) from None

    def warn(self, message: str) -> None:
        """One line ``WARNING: ...`` here, and a Python warning."""
        message = " ".join(message.split())
        self.warnings += 1
        if self.warnings > self.max_warnings:
            return
        self.warned.append(message)
        self.write(f"WARNING: {message}\n")
        self.flush()
        warnings.warn(message, InputWarning, stacklevel=3)

    def close(self) -> None:
        """Finish the log file."""
        file, self.file = self.file, None
        if file:
            try:
                file.close()
            except OSError as e:
                raise self.cannot_write(e) from None

    def cannot_write(self, e: OSError) -> InputError:
        """The error for a full disk; nothing more is written, so that what is buffered does not raise it again."""
        file, self.file = self.file, None
        if file:
            with contextlib.suppress(OSError):
                file.close()
        return InputError(f"cannot write log file {self.path}: {e.strerror or e}")

    def total_time(self) -> str:
        seconds = int(time.time() - self.started)
        return f"Total wall time: {seconds // 3600}:{seconds // 60 % 60:02d}:{seconds % 60:02d}\n"


def to_stdout(text: str) -> None:
    """The plain terminal."""
    sys.stdout.write(text)
    sys.stdout.flush()


def loop_line(seconds: float, steps: int, atoms: int) -> str:
    """``Loop time of ...``, as log readers expect it."""
    return f"Loop time of {seconds:g} on 1 procs for {steps} steps with {atoms} atoms\n"


def performance(seconds: float, steps: int, atoms: int, dt: float, units: str, femtosecond: float) -> str:
    """``Performance: ...`` in ns/day, hours/ns or tau/day, steps and atom-steps per second; empty where no time passes."""
    if seconds <= 0.0 or steps <= 0 or dt == 0.0:
        return ""
    rate = steps / seconds
    atom_rate, prefix = rate * atoms, ""
    for factor, name in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
        if atom_rate >= factor:
            atom_rate, prefix = atom_rate / factor, name
            break
    if units == "lj":
        speed = f"{86400.0 * rate * dt:.3f} tau/day"
    else:
        day = 86400.0 * rate * dt / femtosecond / 1e6
        speed = f"{day:.3f} ns/day, {24.0 / day:.3f} hours/ns"
    return f"Performance: {speed}, {rate:.3f} timesteps/s, {atom_rate:.3f} {prefix}atom-step/s\n"


def timing_table(total: float, timings: dict[str, float], present: tuple[str, ...], timer: Timer) -> str:
    """``MPI task timing breakdown`` and an empty line; `timings` in seconds by section, `present` those to show."""
    if timer.style in ("off", "loop"):
        return ""
    full = timer.style == "full"
    lines = ["MPI task timing breakdown:", f"Section |  min time  |  avg time  |  max time  |%varavg|{'  %CPU |' if full else ''} %total",
             "-" * (71 if full else 63)]
    cpu, none = (" 100.0 |", f"{'':7}|") if full else ("", "")
    if timer.mode == "sync":
        present = *present, "Sync"
    spent = 0.0
    for name in (*SECTIONS, "Sync"):
        if name in present:
            t = timings.get(name, 0.0)
            spent += t
            cell = f"{t:<10.5g}"
            lines.append(f"{name:<8}| {cell} | {cell} | {cell} |{0.0:6.1f} |{cpu}{_percent(t, total):6.2f}")
    rest = max(total - spent, 0.0)
    lines.append(f"{'Other':<8}| {'':10} | {rest:<10.4g} | {'':10} |{'':6} |{none}{_percent(rest, total):6.2f}")
    return "\n".join(lines) + "\n\n"


def _percent(part: float, total: float) -> float:
    return 100.0 * part / total if total > 0.0 else 0.0


def counts(local: int, ghost: int, neighbors: int, special: float | None, builds: int, dangerous: int | None) -> str:
    """The block of atom and neighbour counts; `special` bonded partners per atom (None: no bonds), `dangerous` None: not checked."""
    lines = []
    for title, n in (("Nlocal:", local), ("Nghost:", ghost), ("Neighs:", neighbors)):
        lines += [f"{title}{n:>15g} ave {n:>11g} max {n:>11g} min", "Histogram: 1 0 0 0 0 0 0 0 0 0"]
    lines += ["", f"Total # of neighbors = {neighbors}"]
    if local:
        lines.append(f"Ave neighs/atom = {neighbors / local:.8g}")
    if special is not None:
        lines.append(f"Ave special neighs/atom = {special:.8g}")
    lines.append(f"Neighbor list builds = {builds}")
    lines.append("Dangerous builds not checked" if dangerous is None else f"Dangerous builds = {dangerous}")
    return "\n".join(lines) + "\n"
