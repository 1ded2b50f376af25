"""The kernel cache: what is in it, filling it before a run, emptying it."""
from __future__ import annotations

import contextlib
import importlib
import os
import shutil
from dataclasses import dataclass
from pathlib import Path

from asemd.cache_folder import cache_folder
from asemd.errors import InputError
from asemd.kernels.generate import LIMIT_BYTES, cache_dir
from asemd.lammps.calibration import FILE
from asemd.lammps.session import ACTIONS, Session, Stop
from asemd.lammps.switches import Switches
from asemd.text_table import Table

STEPS = 2       # of every run: a step without and one with energies
LEFT_OUT = frozenset("dump dump_modify info restart undump write_data write_dump write_restart write_coeff".split())
MB = 2**20


@dataclass(frozen=True)
class Contents:
    """What the cache holds.

    Attributes
    ----------
    folder : Path
    modules : int
        Generated kernel modules.
    compiled, compiled_bytes : int
        Files of machine code for them.
    expressions : int
        Formulas whose derivatives are kept.
    measured : bool
        Whether the speed of this machine was measured (``asemd plan --calibrate``).
    size : int
        Bytes of all of it.
    limit : int
        Bytes of machine code beyond which the oldest goes.
    kept : bool
        False: the folder of the user cannot be written to, and this one goes with the process.
    """

    folder: Path
    modules: int
    compiled: int
    compiled_bytes: int
    expressions: int
    measured: bool
    size: int
    limit: int
    kept: bool

    def parts(self) -> list[Table | str]:
        """A table."""
        rows = [("folder", str(self.folder), "" if self.kept else "temporary: the cache folder of the user cannot be written to"),
                ("kernel modules", str(self.modules), ""),
                ("machine code", f"{self.compiled} files, {self.compiled_bytes / MB:.1f} MB",
                 f"beyond {self.limit / MB:.0f} MB the oldest goes"),
                ("formulas", str(self.expressions), "derivatives of lepton expressions"),
                ("speed of this machine", "measured" if self.measured else "not measured", "asemd plan --calibrate"),
                ("all", f"{self.size / MB:.1f} MB", "")]
        return [Table("", ("", "", ""), rows)]

    def to_dict(self) -> dict[str, object]:
        """Everything, JSON-able."""
        return {**vars(self), "folder": str(self.folder)}


def contents() -> Contents:
    """Look at the cache."""
    kernels = cache_dir()
    base = kernels.parent
    files = {f: size for part in _own(base) for f, size in _files(part).items()}
    code = [size for f, size in files.items() if f.suffix in (".nbi", ".nbc")]
    return Contents(base, sum(f.parent == kernels and f.suffix == ".py" for f in files), len(code), sum(code),
                    sum(f.parent.name == "expressions" for f in files), base / FILE in files, sum(files.values()), LIMIT_BYTES,
                    base == cache_folder())


def warm(path: str | os.PathLike, switches: Switches | None = None) -> int:
    """Compile what a script needs, by runs of two steps that write nothing; returns how many kernel modules are new.

    Raises
    ------
    AsemdError
        What would end the script.
    """
    before = contents().modules
    session = Warmer(switches)
    try:
        session.file(path)
    except Stop:
        session.label = None
    session.scene.need_system("cache warm")
    return contents().modules - before


def clear() -> Contents:
    """Delete what asemd keeps, and nothing else in that folder; returns what was there."""
    found = contents()
    try:
        for part in _own(found.folder):
            if part.is_dir():
                shutil.rmtree(part)
            else:
                part.unlink(missing_ok=True)
    except OSError as e:
        raise InputError(f"cannot empty the cache {found.folder}: {e.strerror or e}") from None
    return found


def _own(base: Path) -> list[Path]:
    """The folders and files of the cache: others may lie in a folder that somebody chose."""
    return [cache_dir(), base / "expressions", base / FILE]


def _files(path: Path) -> dict[Path, int]:
    found = {}
    for f in (path.rglob("*") if path.is_dir() else [path]):
        with contextlib.suppress(OSError):      # another process may just have dropped it
            if f.is_file():
                found[f] = f.stat().st_size
    return found


class Warmer(Session):
    """Executes a script without its output, each run for a few steps."""

    def __init__(self, switches: Switches | None = None):
        switches = switches or Switches()
        switches.cap = STEPS
        super().__init__(switches=switches, passive=True)

    def call(self, name, args) -> None:
        if name in LEFT_OUT:
            return
        if name in ACTIONS:
            self.scene.need_system(name)
            importlib.import_module(f"asemd.lammps.command.{name}").run(self, list(args))
            self.scene.sync_groups()
        else:
            super().call(name, args)
