r"""Dumps write snapshots of atoms to files. One format, one file; each is a class built on `Dump`.

A caller writes a step with ``dump.write(snapshot, step)`` on the steps that ``dump.schedule`` names, and on the first step of a run
if ``dump.first``; ``dump.needs`` names what the force evaluation of such a step must provide. Files open at the first snapshot.
Atoms come in order of id unless ``dump_modify sort`` says otherwise. Boxes that are not in LAMMPS's frame are rotated into it.
"""
from __future__ import annotations

import contextlib
import copy
import operator
import re
from typing import IO, Any, ClassVar

import numpy as np

from asemd.dump import _binary
from asemd.dump._columns import COLUMNS, LABELS, View, column_of, kind_of
from asemd.dump._files import Series, is_compressed, open_binary
from asemd.dump._modify import Modify, conversions
from asemd.dump._schedule import Schedule
from asemd.errors import InputError

OPERATORS = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge, "==": operator.eq, "!=": operator.ne,
             "|^": lambda a, b: (a != 0) != (b != 0)}
DEFAULT = {"integer": "%d", "float": "%g", "string": "%s"}


class Dump(Modify):
    """Base class of dumps, and all of those that are text.

    Parameters
    ----------
    group : str
        The atoms written.
    every : int
        Interval, steps.
    path : str
        File; ``*`` becomes the step (one file per snapshot), ``%`` the process (0). Endings gz bz2 xz lzma zst lz4 compress, ``.bin``
        is LAMMPS's binary format.
    columns : list of str
        What each line holds, names as in ``dump custom``.
    variables : asemd.variable.Variables, optional
        Gives ``c_ID``, ``f_ID`` and ``v_name`` columns their values.
    regions : dict, optional
        Regions by name, for ``dump_modify region``.
    """

    style: ClassVar[str] = ""
    wildcards: ClassVar[str] = "*%"     # what the file name may hold
    binary: ClassVar[bool] = False      # whether there is a binary format too
    one_each: ClassVar[bool] = False    # whether a file holds one snapshot only
    id: str = ""
    label: str = "ATOMS"        # what the header calls the lines

    def __init__(self, group: str, every: int, path: str, columns: list[str], *, variables=None, regions=None):
        if every <= 0:
            raise InputError(f"dump {self.style}: the interval must be positive, got {every}")
        self._check_path(path)
        self.group, self.columns = group, columns
        self.files, self.schedule = Series(path), Schedule(every)
        self.variables, self.regions = variables, regions if regions is not None else {}
        self.first = self.append = self.image = self.unit = self.time = self.pbc = self.general = False
        self.flush = self.header = True
        self.sort, self.line, self.skip, self.refresh = "id", "", "", ""
        self.formats: dict[str | int, str] = {}
        self.element: list[str] = []
        self.names: dict[int, str] = {}
        self.thresholds: list[tuple[str, str, float | None]] = []       # None: the value at the last snapshot
        self._last: dict[int, dict[int, float]] = {}                    # number of a threshold -> id -> value at the last snapshot
        self.region: str = ""
        self.last_written: int | None = None
        self._file: IO[bytes] | None = None
        self._units_written = False
        for name in columns:
            self._check(name)

    @classmethod
    def from_lammps(cls, id: str, group: str, every: int, path: str, words: list[str], session) -> Dump:
        """Build from ``dump ID group style every path words...``."""
        cls.check_many(id, path)
        dump = cls(group, every, path, *cls.chosen(words), variables=session.variables, regions=session.scene.regions)
        dump.id = id
        return dump

    @classmethod
    def check_many(cls, id: str, path: str) -> None:
        """Styles with one file for each snapshot need a name that changes, except for the one snapshot of write_dump."""
        if cls.one_each and "*" not in path and id != "WRITE_DUMP":
            raise InputError(f"dump {cls.style} writes one file for each snapshot: the name {path} needs a *")

    @classmethod
    def chosen(cls, words: list[str]) -> tuple:
        """Arguments of the class from the words after the path."""
        if words:
            raise InputError(f"dump {cls.style} takes no more words, got {' '.join(words)}")
        return ()

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_file": None}

    @property
    def path(self) -> str:
        return self.files.path

    @property
    def every(self) -> int:
        return self.schedule.every

    @property
    def is_binary(self) -> bool:
        return self.path.endswith(".bin")

    def _check_path(self, path: str) -> None:
        for mark in "*%":
            if mark in path and mark not in self.wildcards:
                raise InputError(f"dump {self.style}: {mark} in the file name {path} is not possible: one file holds all snapshots"
                                 if mark == "*" else f"dump {self.style}: one file per processor (% in {path}) is not possible")
        if path.endswith(".bin") and not self.binary:
            raise InputError(f"dump {self.style}: there is no binary format, {path} cannot end in .bin")

    # ---- what is written
    def kind(self, name: str) -> str:
        """Whether a column is ``integer``, ``float`` or ``string``."""
        return kind_of(name)

    def _check(self, name: str) -> None:
        """Refuse columns that do not exist."""
        self.kind(name)
        if name[:2] in ("c_", "f_", "v_"):
            if self.variables is None:
                raise InputError(f"dump {self.style}: column {name} needs a session")
            source = re.sub(r"\[\d+\]$", "", name[2:])
            if name[0] == "v":
                self.variables.find(source)
            else:
                provider = self.variables.provider
                kind = "compute" if name[0] == "c" else "fix"
                if not provider.defined(kind, source):
                    raise InputError(f"dump {self.style}: there is no {kind} {source}")
                if not provider.has(name[0], source, "per_atom"):
                    raise InputError(f"dump {self.style}: {name} does not name values per atom")

    @property
    def needs(self) -> frozenset[str]:
        """What the force evaluation of a step that is dumped must provide, as in `asemd.compute.Compute.needs`."""
        if self.variables is None:
            return frozenset()
        used, found = {n for n in (*self.columns, *(t[0] for t in self.thresholds)) if n[:2] in ("c_", "v_")}, set()
        for name in used:
            names = {name} if name[0] == "c" else self.variables.references(name)
            for n in names:
                if n.startswith("c_"):
                    found |= self.variables.provider.source("c", re.sub(r"\[\d+\]$", "", n[2:])).needs
        return frozenset(found)

    def check_scene(self, system) -> None:
        """Raise `InputError` for what these atoms cannot give; before a run."""
        for name, there, what in (("q", system.q is not None, "charges"), ("mol", system.has_molecules, "molecules")):
            if name in self.columns and not there:
                raise InputError(f"dump: atom style {system.atom_style} has no {what} for the column {name}")

    def view(self, snapshot) -> View:
        """The atoms of this snapshot that are written, in order."""
        mask = snapshot.mask(self.group).copy()
        if self.region:
            if self.region not in self.regions:
                raise InputError(f"dump {self.id}: region {self.region} does not exist any more")
            mask &= self.regions[self.region].inside(snapshot.system.x)
        everything = View(snapshot, np.arange(len(mask)), self.element, self.variables)
        for k, (name, relation, value) in enumerate(self.thresholds):
            values = np.asarray(column_of(everything, name), float)
            mask &= OPERATORS[relation](values, value if value is not None else self._values_before(k, everything.id, values))
        if self.pbc:
            snapshot = _wrapped(snapshot)
        view = View(snapshot, np.flatnonzero(mask), self.element, self.variables, self.general)
        if self.sort == "off":
            return view
        order = np.argsort(view.id, kind="stable")
        if self.sort != "id":
            values = np.asarray(column_of(view, self.columns[abs(int(self.sort)) - 1]))[order]
            order = order[np.argsort(values if int(self.sort) > 0 else -values, kind="stable")]
        return View(snapshot, view.rows[order], self.element, self.variables, self.general)

    def _values_before(self, k: int, ids: np.ndarray, values: np.ndarray) -> np.ndarray:
        """What the atoms had at the last snapshot (now, if there was none); the values of now are kept for the next."""
        before = self._last.get(k, {})
        now = dict(zip(ids.tolist(), values.tolist()))
        self._last[k] = now
        return np.array([before.get(i, v) for i, v in now.items()])

    def format(self) -> str:
        """The format of one line, with its newline."""
        if self.line and not self.formats:
            return self.line + "\n"
        return " ".join(self.column_formats()) + "\n"

    def column_formats(self) -> list[str]:
        """The format of each column."""
        kinds, words = [self.kind(c) for c in self.columns], self.line.split()
        base = words if len(words) == len(kinds) else [DEFAULT[k] for k in kinds]
        return [self.formats.get(n, self.formats.get(k, b)) for n, (k, b) in enumerate(zip(kinds, base), 1)]

    def lines(self, view: View) -> str:
        """All lines of atoms."""
        columns = [column_of(view, c) for c in self.columns]
        form = self.format()
        used = columns[:conversions(form)]      # a line of dump atom may leave out the last columns
        return "".join([form % row for row in zip(*(c.tolist() if isinstance(c, np.ndarray) else c for c in used))])

    def column_names(self) -> list[str]:
        """What the header calls the columns."""
        return [self.names.get(k, c) for k, c in enumerate(self.columns, 1)]

    def head(self, snapshot, step: int, n: int) -> str:
        """Everything before the lines of atoms."""
        box, _ = frame(snapshot.system.box)
        bounds, word, text = bounds_of(box), "xy xz yz " if box.triclinic else "", ""
        if self.general:
            bounds, word = np.column_stack([vectors_of(snapshot.system), box.origin]), "abc origin "
        if self.needs_units():
            text = f"ITEM: UNITS\n{snapshot.system.units}\n"
        if self.time:
            text += f"ITEM: TIME\n{step * snapshot.dt:.16g}\n"
        label = self.label
        return (f"{text}ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF {label}\n{n}\nITEM: BOX BOUNDS {word}{' '.join(box.boundary)}\n"
                + "".join(" ".join(f"{v:.16e}" for v in row) + "\n" for row in bounds) + f"ITEM: {label} {' '.join(self.column_names())}\n")

    def needs_units(self) -> bool:
        """Whether the units are still to be written into this file."""
        wanted = self.unit and not self._units_written
        self._units_written |= wanted
        return wanted

    def foot(self) -> str:
        """Everything after the lines of atoms."""
        return ""

    def encode(self, snapshot, step: int, view: View) -> bytes:
        """A snapshot as it stands in the file."""
        if self.is_binary:
            box, _ = frame(snapshot.system.box)
            bounds = bounds_of(box)
            bounds = np.concatenate([bounds[:, :2].ravel(), bounds[:, 2:].ravel()])
            if self.general:
                bounds = np.append(vectors_of(snapshot.system), box.origin)
            columns = [column_of(view, "type" if self.kind(c) == "string" else c) for c in self.columns]
            return _binary.head(self.style, step, len(view.rows), box, bounds, self.column_names(), snapshot.system.units
                                if self.needs_units() else "", step * snapshot.dt if self.time else None) + _binary.body(columns)
        lines = self.lines(view)
        head = self.head(snapshot, step, len(view.rows)) if self.header else ""
        return (head + lines + self.foot()).encode()

    def write(self, snapshot, step: int) -> None:
        """Write one snapshot.

        Parameters
        ----------
        snapshot : asemd.engine.Snapshot
        step : int

        Raises
        ------
        InputError
            The file cannot be written.
        """
        if step < self.schedule.delay:
            return
        self.last_written = step
        if self.skip and self.variables.number(self.skip) != 0.0:
            return
        self.write_view(snapshot, step, self.view(snapshot))
        if self.refresh:
            self.variables.provider.source("c", self.refresh).refresh()

    def write_view(self, snapshot, step: int, view: View) -> None:
        """Write the chosen atoms of a snapshot."""
        if self.files.is_many:
            self._units_written = False
        data = self.encode(snapshot, step, view)
        path = self.files.name(step)
        try:
            if self._file is None:
                self._file = self.open(path)
            self._file.write(data)
            if self.files.is_many:
                self.close()
                self.files.written(path)
            elif self.flush:
                self._file.flush()
        except OSError as e:
            file, self._file = self._file, None         # what is left in its buffer cannot be written either
            if file is not None:
                with contextlib.suppress(OSError):
                    file.close()
            raise self.cannot_write(path, e) from None

    def open(self, path: str) -> IO[bytes]:
        """The file of a snapshot, ready to be written or continued."""
        return open_binary(path, self.append)

    def cannot_write(self, path: str, e: OSError) -> InputError:
        return InputError(f"dump {self.id or self.style}: cannot write {path}: {e.strerror or e}")

    def close(self) -> None:
        """Close the file; a later snapshot is appended to it."""
        if self._file is not None:
            try:
                self._file.close()
            except OSError as e:
                raise self.cannot_write(self.path, e) from None
            self._file, self.append = None, self.append or not self.files.is_many


def frame(box):
    """The box in LAMMPS's frame and the rotation into it, or None if it is there already."""
    return (box, None) if box.is_lammps_frame else box.to_lammps()


def vectors_of(system) -> np.ndarray:
    """Rows a b c of a general triclinic box, as they were given."""
    return system.box.cell @ system.rotation.T


def bounds_of(box) -> np.ndarray:
    """Rows lo hi for x, y, z; of a tilted box those of the upright box around it, with the tilt factors as third column."""
    lo, hi, (xy, xz, yz) = box.lo, box.hi, box.tilt
    bounds = np.column_stack([lo, hi])
    if not box.triclinic:
        return bounds
    bounds[0] += min(0.0, xy, xz, xy + xz), max(0.0, xy, xz, xy + xz)
    bounds[1] += min(0.0, yz), max(0.0, yz)
    return np.column_stack([bounds, (xy, xz, yz)])


def _wrapped(snapshot):
    """The snapshot with all atoms in the box."""
    out, out_system = copy.copy(snapshot), copy.copy(snapshot.system)
    out_system.x, out_system.image = snapshot.system.x.copy(), snapshot.system.image.copy()
    out_system.box.wrap(out_system.x, out_system.image)
    out.system = out_system
    return out


__all__ = ["COLUMNS", "LABELS", "OPERATORS", "Dump", "View", "bounds_of", "frame", "is_compressed"]
