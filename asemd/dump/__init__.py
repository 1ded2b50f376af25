r"""Dumps write snapshots of atoms to text files. One format, one file; each is a class built on `Dump`.

A caller writes a step with ``dump.write(snapshot, step)`` when ``step`` is a multiple of ``dump.every``, and on the first step of a run
if ``dump.first``; ``dump.needs`` names what the force evaluation of such a step must provide. Files open at the first snapshot.
Atoms come in order of id unless ``dump_modify sort`` says otherwise. Boxes that are not in LAMMPS's frame are rotated into it.
"""
from __future__ import annotations

import gzip
import operator
import re
from typing import IO, Any, ClassVar

import numpy as np

from asemd.dump._columns import COLUMNS, LABELS, View, column_of, kind_of
from asemd.errors import InputError, nearest
from asemd.words import number, take, whole, yes_no

OPERATORS = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge, "==": operator.eq, "!=": operator.ne,
             "|^": lambda a, b: (a != 0) != (b != 0)}
DEFAULT = {"integer": "%d", "float": "%g", "string": "%s"}
CONVERSION = re.compile(r"%(?:%|[-+ 0#]*\d*(?:\.\d+)?l*[diueEfFgGsxX])")


class Dump:
    """Base class of text dumps.

    Parameters
    ----------
    group : str
        The atoms written.
    every : int
        Interval, steps.
    path : str
        File; ``*`` becomes the step (one file per snapshot), ``.gz`` at the end compresses.
    columns : list of str
        What each line holds, names as in ``dump custom``.
    variables : asemd.variable.Variables, optional
        Gives ``c_ID``, ``f_ID`` and ``v_name`` columns their values.
    regions : dict, optional
        Regions by name, for ``dump_modify region``.
    """

    style: ClassVar[str] = ""
    id: str = ""
    label: str = "ATOMS"        # what the header calls the lines

    def __init__(self, group: str, every: int, path: str, columns: list[str], *, variables=None, regions=None):
        if every <= 0:
            raise InputError(f"dump {self.style}: the interval must be positive, got {every}")
        if "%" in path:
            raise InputError(f"dump {self.style}: one file per processor (% in {path}) is not supported, use a plain file name")
        if path.endswith((".bin", ".zst")):
            raise InputError(f"dump {self.style}: {path[-4:]} files are not supported, use plain text or .gz")
        self.group, self.every, self.path, self.columns = group, every, path, columns
        self.variables, self.regions = variables, regions if regions is not None else {}
        self.first = self.append = self.image = self.unit = self.time = False
        self.flush = self.header = True
        self.delay, self.pad, self.sort, self.line = 0, 0, "id", ""
        self.formats: dict[str | int, str] = {}
        self.element: list[str] = []
        self.names: dict[int, str] = {}
        self.thresholds: list[tuple[str, str, float]] = []
        self.region: str = ""
        self.last_written: int | None = None
        self._file: IO[str] | None = None
        self._units_written = False
        for name in columns:
            self._check(name)

    @classmethod
    def from_lammps(cls, id: str, group: str, every: int, path: str, words: list[str], session) -> Dump:
        """Build from ``dump ID group style every path words...``."""
        dump = cls(group, every, path, *cls.chosen(words), variables=session.variables, regions=session.scene.regions)
        dump.id = id
        return dump

    @classmethod
    def chosen(cls, words: list[str]) -> tuple:
        """Arguments of the class from the words after the path."""
        if words:
            raise InputError(f"dump {cls.style} takes no more words, got {' '.join(words)}")
        return ()

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_file": None, "variables": None}

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
                if not provider.exists("compute" if name[0] == "c" else "fix", source) or not provider.is_per_atom(name[0], source):
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

    def view(self, snapshot) -> View:
        """The atoms of this snapshot that are written, in order."""
        mask = snapshot.mask(self.group).copy()
        if self.region:
            if self.region not in self.regions:
                raise InputError(f"dump {self.id}: region {self.region} does not exist any more")
            mask &= self.regions[self.region].inside(snapshot.system.x)
        rows = np.flatnonzero(mask)
        everything = View(snapshot, rows, self.element, self.variables)
        for name, relation, value in self.thresholds:
            rows = rows[OPERATORS[relation](column_of(View(snapshot, rows, self.element, self.variables), name), value)]
        everything = View(snapshot, rows, self.element, self.variables)
        if self.sort == "off":
            return everything
        order = np.argsort(everything.id, kind="stable")
        if self.sort != "id":
            values = np.asarray(column_of(everything, self.columns[abs(int(self.sort)) - 1]))[order]
            order = order[np.argsort(values if int(self.sort) > 0 else -values, kind="stable")]
        return View(snapshot, rows[order], self.element, self.variables)

    def format(self) -> str:
        """The format of one line, with its newline."""
        if self.line and not self.formats:
            return self.line + "\n"
        kinds, words = [self.kind(c) for c in self.columns], self.line.split()
        base = words if len(words) == len(kinds) else [DEFAULT[k] for k in kinds]
        return " ".join(self.formats.get(n, self.formats.get(k, b)) for n, (k, b) in enumerate(zip(kinds, base), 1)) + "\n"

    def lines(self, view: View) -> str:
        """All lines of atoms."""
        columns = [column_of(view, c) for c in self.columns]
        form = self.format()
        return "".join([form % row for row in zip(*(c.tolist() if isinstance(c, np.ndarray) else c for c in columns))])

    def head(self, snapshot, step: int, n: int) -> str:
        """Everything before the lines of atoms."""
        box, _ = _frame(snapshot.system.box)
        lo, hi, (xy, xz, yz) = box.lo, box.hi, box.tilt
        bounds, word = np.column_stack([lo, hi]), ""
        if box.triclinic:       # bounds of the tilted box, and its tilt factors
            bounds[0] += min(0.0, xy, xz, xy + xz), max(0.0, xy, xz, xy + xz)
            bounds[1] += min(0.0, yz), max(0.0, yz)
            bounds, word = np.column_stack([bounds, (xy, xz, yz)]), "xy xz yz "
        text = ""
        if self.unit and not self._units_written:
            text, self._units_written = f"ITEM: UNITS\n{snapshot.system.units}\n", True
        if self.time:
            text += f"ITEM: TIME\n{step * snapshot.dt:.16g}\n"
        names = " ".join(self.names.get(k, c) for k, c in enumerate(self.columns, 1))
        label = self.label
        return (f"{text}ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF {label}\n{n}\nITEM: BOX BOUNDS {word}{' '.join(box.boundary)}\n"
                + "".join(" ".join(f"{v:.16e}" for v in row) + "\n" for row in bounds) + f"ITEM: {label} {names}\n")

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
        if step < self.delay:
            return
        view = self.view(snapshot)
        lines = self.lines(view)
        self._open(step)
        head = self.head(snapshot, step, len(view.rows)) if self.header else ""
        self._file.write(head + lines)
        if "*" in self.path:
            self.close()
        elif self.flush:
            self._file.flush()
        self.last_written = step

    def _open(self, step: int) -> None:
        if self._file is not None:
            return
        path = self.path.replace("*", str(step).zfill(self.pad))
        mode = "a" if self.append else "w"
        if "*" in self.path:
            self._units_written = False
        try:
            self._file = gzip.open(path, mode + "t", encoding="utf-8") if path.endswith(".gz") else open(path, mode, encoding="utf-8")
        except OSError as e:
            raise InputError(f"dump {self.id or self.style}: cannot write {path}: {e.strerror}") from None

    def close(self) -> None:
        """Close the file; a later snapshot is appended to it."""
        if self._file is not None:
            self._file.close()
            self._file, self.append = None, self.append or "*" not in self.path

    # ---- dump_modify
    KEYWORDS = {"append": 1, "buffer": 1, "colname": 2, "delay": 1, "element": 0, "every": 1, "first": 1, "flush": 1, "format": 2,
                "header": 1, "pad": 1, "region": 1, "sort": 1, "thresh": 3, "time": 1, "types": 1, "units": 1}

    def modify(self, words: list[str], session) -> None:
        """The words of ``dump_modify ID words...``.

        Raises
        ------
        InputError
            Unknown or unsupported keyword, wrong value.
        """
        if not words:
            raise InputError("dump_modify needs a keyword")
        while words:
            key, what = words[0], f"dump_modify {words[0]}"
            if key not in self.KEYWORDS:
                raise InputError(f"dump_modify: keyword {key!r} is not supported by dump style {self.style}{nearest(key, self.KEYWORDS)}")
            count = self.KEYWORDS[key]
            if key == "element":
                count = session.scene.system.counts["ntypes"]
            elif key == "thresh" and words[1:2] == ["none"] or key == "format" and words[1:2] == ["none"]:
                count = 1
            elif key == "colname" and words[1:2] == ["default"]:
                count = 1
            values = take(words[1:], count, what)
            words = words[1 + count:]
            special = getattr(self, "_modify_" + key, None)
            if special is not None:
                special(values, what, session)
            else:
                self._modify_flag(values, what, key)

    def _modify_flag(self, values: list[str], what: str, key: str) -> None:
        value = yes_no(values[0], what)
        if key == "buffer":     # output is always buffered until a snapshot is complete: nothing to choose
            return
        setattr(self, {"units": "unit"}.get(key, key), value)

    def _modify_colname(self, values, what, session):
        if values[0] == "default":
            self.names.clear()
            return
        column = self.columns.index(values[0]) + 1 if values[0] in self.columns else whole(values[0], what)
        self.names[self._column(column, what)] = values[1]

    def _column(self, column: int, what: str) -> int:
        if not 1 <= abs(column) <= len(self.columns):
            raise InputError(f"{what}: there are {len(self.columns)} columns, got {column}")
        return column

    def _modify_delay(self, values, what, session):
        self.delay = whole(values[0], what)

    def _modify_element(self, values, what, session):
        self.element = list(values)

    def _modify_every(self, values, what, session):
        if values[0].startswith("v_"):
            raise InputError(f"{what}: a variable interval is not supported, give a number of steps")
        every = whole(values[0], what)
        if every <= 0:
            raise InputError(f"{what}: the interval must be positive, got {every}")
        self.every = every

    def _modify_format(self, values, what, session):
        which = values[0]
        if which == "none":
            self.formats, self.line = {}, ""
            return
        text = values[1]
        found = [c[-1] for c in CONVERSION.findall(text) if c != "%%"]
        if "%" in CONVERSION.sub("", text):
            raise InputError(f"{what}: {text!r} is not a C format of numbers and strings")
        if which == "line":
            kinds = [self.kind(c) for c in self.columns]
            if len(found) < len(kinds):
                raise InputError(f"{what} line: {len(found)} formats for {len(kinds)} columns: {text!r}")
            if len(found) > len(kinds) or any(not _fits(c, k) for c, k in zip(found, kinds)):
                raise InputError(f"{what} line: {text!r} does not fit the columns {' '.join(self.columns)}")
            self.line = text
            return
        if which in ("int", "float"):
            kind = key = {"int": "integer", "float": "float"}[which]
        else:
            key = self.columns.index(which) + 1 if which in self.columns else self._column(whole(which, what), what)
            kind = self.kind(self.columns[key - 1])
        if len(found) != 1 or not _fits(found[0], kind):
            raise InputError(f"{what} {which}: {text!r} is not a format for one {kind} value")
        self.formats[key] = text

    def _modify_pad(self, values, what, session):
        self.pad = max(0, whole(values[0], what))

    def _modify_region(self, values, what, session):
        self.region = ""
        if values[0] != "none":
            session.scene.region(values[0], what)
            self.region = values[0]

    def _modify_sort(self, values, what, session):
        if values[0] not in ("off", "id"):
            column = self._column(whole(values[0], what), what)
            if self.kind(self.columns[abs(column) - 1]) == "string":
                raise InputError(f"{what}: column {abs(column)} ({self.columns[abs(column) - 1]}) is not a number")
        self.sort = values[0]

    def _modify_thresh(self, values, what, session):
        if values[0] == "none":
            self.thresholds = []
            return
        name, relation, limit = values
        self._check(name)
        if self.kind(name) == "string" or relation not in OPERATORS:
            raise InputError(f"{what}: expected attribute, one of {' '.join(OPERATORS)} and a number, got {' '.join(values)}")
        self.thresholds.append((name, relation, number(limit, what)))

    def _modify_types(self, values, what, session):
        if values[0] not in ("labels", "numeric"):
            raise InputError(f"{what}: expected labels or numeric, got {values[0]!r}")
        swap = {"type": "typelabel"} if values[0] == "labels" else {"typelabel": "type"}
        self.columns = [swap.get(c, c) for c in self.columns]


def _fits(conversion: str, kind: str) -> bool:
    return conversion in {"integer": "diuxX", "float": "eEfFgG", "string": "s"}[kind]


def _frame(box):
    """The box in LAMMPS's frame and the rotation into it, or None if it is there already."""
    return (box, None) if box.is_lammps_frame else box.to_lammps()


__all__ = ["COLUMNS", "LABELS", "Dump", "View"]
