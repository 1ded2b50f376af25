"""The keywords of ``dump_modify`` that several dumps share."""
from __future__ import annotations

import re
from typing import ClassVar

from asemd.errors import InputError, nearest
from asemd.words import number, take, whole, yes_no

CONVERSION = re.compile(r"%(?:%|[-+ 0#]*\d{0,3}(?:\.\d{1,3})?l*[diueEfFgGsxX])")
RELATIONS = ("<", "<=", ">", ">=", "==", "!=", "|^")
FITS = {"integer": "diuxX", "float": "eEfFgG", "string": "s"}
SELECT = {"element": 0, "refresh": 1, "region": 1, "thresh": 3, "triclinic/general": 1}


class Modify:
    """Reads the words of ``dump_modify`` into the attributes of a dump.

    A keyword ``key`` with values of its own kind is read by the method ``_modify_key``; the others are switches, yes or no.
    """

    by_column: ClassVar[bool] = True        # dump_modify format sets columns and kinds, not only line and none

    # keyword -> number of values
    KEYWORDS: ClassVar[dict[str, int]] = {
        "append": 1, "balance": 1, "buffer": 1, "colname": 2, "delay": 1, "every": 1, "every/time": 1, "fileper": 1, "first": 1, "flush": 1,
        "format": 2, "header": 1, "maxfiles": 1, "nfile": 1, "pad": 1, "pbc": 1, "skip": 1, "sort": 1, "time": 1, "units": 1}

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
            count = self.values_of(key, words[1:], session)
            values = take(words[1:], count, what)
            words = words[1 + count:]
            special = getattr(self, "_modify_" + key.replace("/", "_"), None)
            if special is not None:
                special(values, what, session)
            else:
                self._modify_flag(values, what, key)

    def values_of(self, key: str, words: list[str], session) -> int:
        """How many of the words belong to a keyword."""
        if key == "element":
            return session.scene.system.counts["ntypes"]
        if key in ("thresh", "format") and words[:1] == ["none"] or key == "colname" and words[:1] == ["default"]:
            return 1
        return self.KEYWORDS[key]

    def _modify_flag(self, values: list[str], what: str, key: str) -> None:
        value = yes_no(values[0], what)
        if key in ("buffer", "balance"):    # a snapshot is always written as a whole, by one process: nothing to choose
            return
        setattr(self, {"units": "unit"}.get(key, key), value)

    def _modify_colname(self, values, what, session):
        if values[0] == "default":
            self.names.clear()
            return
        column = self.columns.index(values[0]) + 1 if values[0] in self.columns else whole(values[0], what)
        column = self._column(column, what)
        self.names[column if column > 0 else len(self.columns) + 1 + column] = values[1]

    def _column(self, column: int, what: str) -> int:
        if not 1 <= abs(column) <= len(self.columns):
            raise InputError(f"{what}: there are {len(self.columns)} columns, got {column}")
        return column

    def _modify_delay(self, values, what, session):
        self.schedule.delay = whole(values[0], what)

    def _modify_element(self, values, what, session):
        self.element = list(values)

    def _modify_every(self, values, what, session):
        if values[0].startswith("v_"):
            self.schedule.variable, self.schedule.interval, self.schedule.timed = values[0][2:], 0.0, False
            return
        every = whole(values[0], what)
        if every <= 0:
            raise InputError(f"{what}: the interval must be positive, got {every}")
        self.schedule.every, self.schedule.variable, self.schedule.interval = every, "", 0.0

    def _modify_every_time(self, values, what, session):
        if values[0].startswith("v_"):
            self.schedule.variable, self.schedule.interval, self.schedule.timed = values[0][2:], 0.0, True
            return
        interval = number(values[0], what)
        if interval <= 0.0:
            raise InputError(f"{what}: the interval must be positive, got {values[0]}")
        self.schedule.interval, self.schedule.variable = interval, ""

    def _files(self, values, what) -> None:
        if "%" not in self.path:
            raise InputError(f"{what} needs a file name with %, which is {self.path}")
        if whole(values[0], what) <= 0:
            raise InputError(f"{what}: must be positive, got {values[0]}")

    def _modify_fileper(self, values, what, session):
        self._files(values, what)       # one process writes one file, however many were allowed

    def _modify_nfile(self, values, what, session):
        self._files(values, what)

    def _modify_format(self, values, what, session):
        which = values[0]
        if which == "none":
            self.formats, self.line = {}, ""
            return
        if which != "line" and not self.by_column:
            raise InputError(f"{what} {which}: dump style {self.style} takes only line and none")
        text = values[1]
        found = kinds_in(text)
        if "%" in CONVERSION.sub("", text):
            raise InputError(f"{what}: {text!r} is not a C format of numbers and strings")
        if which == "line":
            kinds = [self.kind(c) for c in self.columns]
            if self.by_column:      # a word for each column, further ones are not used
                if len(text.split()) < len(kinds):
                    raise InputError(f"{what} line: {len(text.split())} formats for {len(kinds)} columns: {text!r}")
                text = " ".join(text.split()[:len(kinds)])
                found = kinds_in(text)
            if (self.by_column and len(found) != len(kinds)) or len(found) > len(kinds) or \
                    not all(self.fits(n, c, k) for n, (c, k) in enumerate(zip(found, kinds))):
                raise InputError(f"{what} line: {text!r} does not fit the columns {' '.join(self.columns)}")
            self.line = text
            return
        if which in ("int", "float"):
            kind = key = {"int": "integer", "float": "float"}[which]
        else:
            key = self.columns.index(which) + 1 if which in self.columns else self._column(whole(which, what), what)
            kind = self.kind(self.columns[key - 1])
        if len(found) != 1 or found[0] not in FITS[kind]:
            raise InputError(f"{what} {which}: {text!r} is not a format for one {kind} value")
        self.formats[key] = text

    def fits(self, column: int, conversion: str, kind: str) -> bool:
        """Whether a conversion such as ``g`` writes a column (from 0) of this kind."""
        return conversion in FITS[kind]

    def _modify_maxfiles(self, values, what, session):
        if not self.files.is_many:
            raise InputError(f"{what} needs a file name with *, which is {self.path}")
        most = whole(values[0], what)
        if most < -1 or most == 0:
            raise InputError(f"{what}: must be positive, or -1 for all, got {most}")
        self.files.most = max(most, 0)

    def _modify_pad(self, values, what, session):
        self.files.pad = whole(values[0], what)
        if self.files.pad < 0:
            raise InputError(f"{what}: must not be negative, got {values[0]}")

    def _modify_refresh(self, values, what, session):
        id = values[0][2:]
        if values[0][:2] != "c_" or id not in session.scene.computes:
            raise InputError(f"{what}: there is no compute {values[0]!r}, give c_ID")
        if not hasattr(session.scene.computes[id], "refresh"):
            session.warn(f"{what}: compute {id} (style {session.scene.computes[id].style}) has no values that could be stored anew")
            return
        self.refresh = id

    def _modify_region(self, values, what, session):
        self.region = ""
        if values[0] != "none":
            session.scene.region(values[0], what)
            self.region = values[0]

    def _modify_skip(self, values, what, session):
        if not values[0].startswith("v_"):
            raise InputError(f"{what}: expected a variable, v_name, got {values[0]!r}")
        session.variables.find(values[0][2:])
        self.skip = values[0][2:]

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
        if self.kind(name) == "string" or relation not in RELATIONS:
            raise InputError(f"{what}: expected attribute, one of {' '.join(RELATIONS)} and a number or LAST, got {' '.join(values)}")
        self.thresholds.append((name, relation, None if limit == "LAST" else number(limit, what)))

    def _modify_triclinic_general(self, values, what, session):
        self.general = yes_no(values[0], what)
        if self.general and session.scene.system.rotation is None:
            self.general = False
            raise InputError(f"{what} cannot be used if the simulation box is not general triclinic")

    def _modify_types(self, values, what, session):
        if values[0] not in ("labels", "numeric"):
            raise InputError(f"{what}: expected labels or numeric, got {values[0]!r}")
        swap = {"type": "typelabel"} if values[0] == "labels" else {"typelabel": "type"}
        self.columns = [swap.get(c, c) for c in self.columns]


def kinds_in(text: str) -> list[str]:
    """The letters of the conversions in a format."""
    return [c[-1] for c in CONVERSION.findall(text) if c != "%%"]


def conversions(text: str) -> int:
    """How many values a format takes."""
    return len(kinds_in(text))


__all__ = ["SELECT", "Modify", "conversions"]
