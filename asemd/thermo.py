"""Thermodynamic output: which quantities, how they are evaluated on one step, and how a row of them is written.

Keywords, column names and formats are those of LAMMPS's ``thermo_style`` and ``thermo_modify``.
"""
from __future__ import annotations

import math
import re
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from asemd.errors import InputError, nearest
from asemd.moment import Moment

STYLES = {
    "one": "step temp epair emol etotal press",
    "yaml": "step temp ke pe ebond eangle edihed eimp evdwl ecoul elong press",
    "multi": "etotal ke temp pe ebond eangle edihed eimp evdwl ecoul elong press",
}
FLOAT, INTEGER = "%- 14.8g", "%10d "
MULTI_FLOAT, MULTI_INTEGER = "%14.4f", "%14d"
WIDTH = {"float": 14, "int": 11}
LENGTHS = frozenset("lhzj")     # C length modifiers, which Python's formats do not need


# computes and fixes whose values grow with the system and are divided by the number of atoms (thermo_modify norm), as baths' energies are
EXTENSIVE = ("pe", "ke", "bond", "angle", "dihedral", "improper", "addforce", "setforce", "nve/limit")


# ---------------------------------------------------------------- keywords ---

@dataclass(frozen=True)
class Keyword:
    """One thermo keyword: column name, function of a `Moment`, kind and whether it grows with the system."""

    column: str
    value: Callable[[Moment], float]
    kind: str = "float"
    extensive: bool = False
    needs: frozenset[str] = frozenset()


def _time(m: Moment) -> float:
    return m.scene.time(m.scene.step)


def _rate(m: Moment, name: str, per_step: float) -> float:
    p = m.progress
    now = (p.cpu(), m.scene.step)
    before, p.previous[name] = p.previous.get(name, (0.0, p.begin)), now
    return (now[1] - before[1]) * per_step / (now[0] - before[0]) if now[1] > before[1] and now[0] > before[0] else 0.0


def _remaining(m: Moment) -> float:
    p, done = m.progress, m.scene.step - m.progress.begin
    return p.cpu() * (p.last - m.scene.step) / done if done > 0 else 0.0


def _cpu(m: Moment) -> float:
    return m.progress.cpu() if m.scene.step > m.progress.begin else 0.0


def _usage(m: Moment) -> float:
    """Processor time of this process since the run began, percent of the wall time."""
    now = time.process_time()
    before, _ = m.progress.previous.setdefault("cpuuse", (now, m.scene.step))
    wall = m.progress.cpu()
    return 100.0 * (now - before) / wall if m.scene.step > m.progress.begin and wall > 0.0 else 0.0


def _density(m: Moment) -> float:
    from asemd import units
    return units.get(m.scene.units).mv2d * float(m.system.atom_masses().sum()) / m.volume()


def _angle(i: int, j: int) -> Callable[[Moment], float]:
    def angle(m: Moment) -> float:
        a, b = m.system.box.cell[i], m.system.box.cell[j]
        return math.degrees(math.atan2(float(np.linalg.norm(np.cross(a, b))), float(a @ b)))
    return angle


def _vector(i: int, j: int) -> Callable[[Moment], float]:
    def component(m: Moment) -> float:
        cell, rotation = m.system.box.cell, m.system.rotation
        return float((cell @ rotation.T)[i, j] if m.scene.thermo.general and rotation is not None else cell[i, j])
    return component


def _edge(i: int) -> Callable[[Moment], float]:
    return lambda m: float(np.linalg.norm(m.system.box.cell[i]))


def _lattice(i: int) -> Callable[[Moment], float]:
    return lambda m: float(m.scene.lattice.spacings[i]) if m.scene.lattice is not None else 1.0


def _counter(name: str) -> Callable[[Moment], int]:
    def count(m: Moment) -> int:
        return getattr(m.counters, name) - getattr(m.progress, name) if m.counters is not None else 0
    return count


def _integer(column: str, value: Callable[[Moment], int]) -> Keyword:
    return Keyword(column, value, "int")


def _energy(column: str, *keys: str) -> Keyword:
    return Keyword(column, lambda m: m.energy(*keys), extensive=True)


def _pressure(column: str, i: int | None) -> Keyword:
    return Keyword(column, lambda m: m.pressure(i), needs=frozenset({"virial"}))


KEYWORDS: dict[str, Keyword] = {
    "step": _integer("Step", lambda m: m.scene.step),
    "elapsed": _integer("Elapsed", lambda m: m.scene.step - m.progress.begin),
    "elaplong": _integer("Elaplong", lambda m: m.scene.step - m.progress.first),
    "dt": Keyword("Dt", lambda m: m.scene.dt),
    "time": Keyword("Time", _time),
    "cpu": Keyword("CPU", _cpu),
    "tpcpu": Keyword("T/CPU", lambda m: _rate(m, "tpcpu", m.scene.dt)),
    "spcpu": Keyword("S/CPU", lambda m: _rate(m, "spcpu", 1.0)),
    "cpuremain": Keyword("CPULeft", _remaining),
    "cpuuse": Keyword("%CPU", _usage),
    "timeremain": Keyword("TimeoutLeft", lambda m: m.progress.remaining()),
    "part": _integer("Part", lambda m: 0),
    "atoms": _integer("Atoms", lambda m: m.system.n),
    "temp": Keyword("Temp", Moment.temperature),
    "press": _pressure("Press", None),
    "pe": Keyword("PotEng", Moment.potential, extensive=True),
    "ke": Keyword("KinEng", Moment.kinetic, extensive=True),
    "etotal": Keyword("TotEng", lambda m: m.potential() + m.kinetic(), extensive=True),
    "evdwl": _energy("E_vdwl", "evdwl", "etail"),
    "ecoul": _energy("E_coul", "ecoul"),
    "epair": _energy("E_pair", "evdwl", "ecoul", "elong", "etail"),
    "ebond": _energy("E_bond", "ebond"),
    "eangle": _energy("E_angle", "eangle"),
    "edihed": _energy("E_dihed", "edihed"),
    "eimp": _energy("E_impro", "eimp"),
    "emol": _energy("E_mol", "ebond", "eangle", "edihed", "eimp"),
    "elong": _energy("E_long", "elong"),
    "etail": _energy("E_tail", "etail"),
    "enthalpy": Keyword("Enthalpy", lambda m: m.potential() + m.kinetic() + m.pressure() * m.volume() / m.snapshot.units.nktv2p,
                        extensive=True, needs=frozenset({"virial"})),
    "ecouple": Keyword("Ecouple", Moment.coupling, extensive=True),
    "econserve": Keyword("Econserve", lambda m: m.potential() + m.kinetic() + m.coupling(), extensive=True),
    "vol": Keyword("Volume", Moment.volume),
    "density": Keyword("Density", _density),
    "bonds": _integer("Bonds", lambda m: len(m.system.topology.bonds)),
    "angles": _integer("Angles", lambda m: len(m.system.topology.angles)),
    "dihedrals": _integer("Diheds", lambda m: len(m.system.topology.dihedrals)),
    "impropers": _integer("Impros", lambda m: len(m.system.topology.impropers)),
    "fmax": Keyword("Fmax", lambda m: float(np.abs(m.forces()).max(initial=0.0))),
    "fnorm": Keyword("Fnorm", lambda m: float(np.linalg.norm(m.forces()))),
    "nbuild": _integer("Nbuild", _counter("builds")),
    "ndanger": _integer("Ndanger", _counter("dangerous")),
    **{"l" + d: Keyword("L" + d, lambda m, i=i: float(m.system.box.cell[i, i])) for i, d in enumerate("xyz")},
    **{d + "lo": Keyword(d.upper() + "lo", lambda m, i=i: float(m.system.box.lo[i])) for i, d in enumerate("xyz")},
    **{d + "hi": Keyword(d.upper() + "hi", lambda m, i=i: float(m.system.box.hi[i])) for i, d in enumerate("xyz")},
    **{t: Keyword(t.capitalize(), lambda m, i=i: float(m.system.box.tilt[i])) for i, t in enumerate(("xy", "xz", "yz"))},
    **{d + "lat": Keyword(d.upper() + "lat", _lattice(i)) for i, d in enumerate("xyz")},
    **{"p" + t: _pressure("P" + t, i) for i, t in enumerate(("xx", "yy", "zz", "xy", "xz", "yz"))},
    **{f"{v}vec{d}": Keyword(f"{v.upper()}vec{d}", _vector(i, j))
       for i, v in enumerate("abc") for j, d in enumerate("xyz")},
    **{"cell" + v: Keyword("Cell" + v, _edge(i)) for i, v in enumerate("abc")},
    "cellalpha": Keyword("CellAlpha", _angle(1, 2)),
    "cellbeta": Keyword("CellBeta", _angle(0, 2)),
    "cellgamma": Keyword("CellGamma", _angle(0, 1)),
}
REFERENCE = re.compile(r"([cfv])_(\w+)(?:\[(\d+)\])?(?:\[(\d+)\])?")


def parse_reference(word: str) -> tuple[str, str, list[int]] | None:
    """``c_ID[1][2]`` -> ("c", "ID", [1, 2]); None if it is not a reference."""
    match = REFERENCE.fullmatch(word)
    return (match[1], match[2], [int(g) for g in match.groups()[2:] if g]) if match else None


def value_of(moment: Moment, kind: str, id: str, index: list[int]) -> float:
    """Global value ``c_ID[i][j]``, ``f_ID[i][j]`` or ``v_name``; indices from 1.

    Raises
    ------
    InputError
        No such compute, fix, variable or element.
    """
    if kind == "v":
        return moment.number(id, *index)
    if kind == "f":
        fix = moment.fix(id)
        if len(index) == 2:
            return float(fix.array(index[0], index[1])) if hasattr(fix, "array") else _missing("fix", id, index)
        return float(fix.vector(index[0]) if index else fix.scalar())
    if not index:
        return moment.scalar(id)
    values = np.asarray(moment.vector(id) if len(index) == 1 else moment.array(id))
    if any(not 1 <= i <= n for i, n in zip(index, values.shape)):
        _missing("compute", id, index)
    return float(values[tuple(i - 1 for i in index)])


def _missing(what: str, id: str, index: list[int]):
    raise InputError(f"{what} {id} has no element {''.join(f'[{i}]' for i in index)}")


def known(word: str) -> bool:
    """Whether a word is a thermo keyword or a reference."""
    return word in KEYWORDS or parse_reference(word) is not None


def evaluate(moment: Moment, word: str, norm: bool) -> float:
    """The value of a keyword or reference; extensive ones per atom if `norm`."""
    keyword = KEYWORDS.get(word)
    if keyword is not None:
        value = keyword.value(moment)
        extensive = keyword.extensive
    else:
        reference = parse_reference(word)
        if reference is None:
            raise InputError(f"unknown thermo keyword {word!r}{nearest(word, KEYWORDS)}")
        value = value_of(moment, *reference)
        source = {"c": moment.scene.computes, "f": moment.scene.fixes, "v": {}}[reference[0]].get(reference[1])
        if reference[0] == "c" and len(reference[2]) == 1 and getattr(source, "style", "").startswith("temp"):
            extensive = True        # the kinetic energies of the tensor; temperatures, also those of an array, are not
        elif hasattr(source, "extensive_at"):
            extensive = source.extensive_at(reference[2])
        else:
            extensive = bool(getattr(source, "extensive", getattr(source, "ecouple", False) or getattr(source, "style", "") in EXTENSIVE))
    return value / moment.system.n if norm and extensive and moment.system.n else value


# ------------------------------------------------------------------ format ---

def c_format(form: str, value: float) -> str:
    """printf of one number; integers may be written with a format for floats and the other way round."""
    if not LENGTHS.isdisjoint(form):
        form = re.sub(r"(?<=[\d%.+\- #])[lhzj]+(?=[diugGeEfF])", "", form)
    return form % value


@dataclass
class Thermo:
    """Settings of thermo, thermo_style and thermo_modify."""

    style: str = "one"
    words: tuple[str, ...] = tuple(STYLES["one"].split())
    every: int | str = 0                   # 0: first and last step only; text: name of a variable
    line: str = "one"
    norm: bool | None = None               # None: yes for units lj
    lost: str = "error"
    lost_bond: str = "error"
    lost_told: bool = False                # the user knows that atoms were lost
    flush: bool = False
    general: bool = False                  # box vectors as they were given, for a general triclinic box
    temp: str = "thermo_temp"
    press: str = "thermo_press"
    format_line: tuple[str, ...] = ()
    format_kind: dict[str, str] = field(default_factory=dict)      # int, float
    format_word: dict[str, str] = field(default_factory=dict)      # by keyword
    format_column: dict[int, str] = field(default_factory=dict)    # from 1
    names: dict[int | str, str] = field(default_factory=dict)      # colname by column from 1, or by keyword

    def set_style(self, style: str, words: Sequence[str]) -> None:
        """``thermo_style``: everything that thermo_modify set goes back to its default.

        Raises
        ------
        InputError
            Unknown style or keyword.
        """
        if style not in ("one", "multi", "yaml", "custom"):
            raise InputError(f"unknown thermo_style {style!r}{nearest(style, ['one', 'multi', 'yaml', 'custom'])}")
        if style != "custom" and words:
            raise InputError(f"thermo_style {style} takes no arguments, got {' '.join(words)}")
        if style == "custom" and not words:
            raise InputError("thermo_style custom needs at least one keyword")
        for word in words:
            if not known(word):
                raise InputError(f"unknown thermo keyword {word!r} in thermo_style custom{nearest(word, KEYWORDS)}")
        fresh = Thermo(style=style, words=tuple(words) or tuple(STYLES.get(style, "").split()), every=self.every,
                       line=style if style in ("multi", "yaml") else "one")
        self.__dict__.update(fresh.__dict__)

    def columns(self, box_changes: bool = False) -> list[str]:
        """Keywords of the columns; styles one and multi get the volume when the box changes."""
        return [*self.words, "vol"] if box_changes and self.style != "custom" else list(self.words)

    def is_normalised(self, units: str) -> bool:
        return self.norm if self.norm is not None else units == "lj"

    def name(self, column: int, word: str) -> str:
        """Title of a column (from 1)."""
        if column in self.names or word in self.names:
            return self.names.get(column, self.names.get(word, ""))
        return KEYWORDS[word].column if word in KEYWORDS else word

    def kind(self, word: str) -> str:
        return KEYWORDS[word].kind if word in KEYWORDS else "float"

    def format(self, column: int, word: str) -> str:
        """The printf format of a column (from 1)."""
        kind = self.kind(word)
        default = {"one": {"int": INTEGER, "float": FLOAT}, "multi": {"int": MULTI_INTEGER, "float": MULTI_FLOAT},
                   "yaml": {"int": "%d", "float": "%.15g"}}[self.line][kind]
        if self.format_line:
            default = self.format_line[column - 1]
        return self.format_column.get(column) or self.format_word.get(word) or self.format_kind.get(kind) or default

    def header(self, words: Sequence[str]) -> str:
        """What is printed before the first row, without the last newline."""
        titles = [self.name(k, w) for k, w in enumerate(words, 1)]
        if self.line == "multi":
            return ""
        if self.line == "yaml":
            return "---\nkeywords: [" + "".join(f"'{t}', " for t in titles) + "]\ndata:"
        return " ".join(_centre(t, WIDTH[self.kind(w)]) for t, w in zip(titles, words))

    def footer(self) -> str:
        return "..." if self.line == "yaml" else ""

    def row(self, words: Sequence[str], values: Sequence[float], step: int = 0, cpu: float = 0.0) -> str:
        """One row, without the last newline."""
        if self.format_line and len(self.format_line) < len(words):
            raise InputError(f"thermo_modify format line has {len(self.format_line)} formats for {len(words)} columns")
        cells = [self._cell(k, w, v) for k, (w, v) in enumerate(zip(words, values), 1)]
        if self.line == "yaml":
            return "  - [" + "".join(f"{c}, " for c in cells) + "]"
        if self.line == "one":
            return " ".join(cells)
        text = f"------------ Step {step:14d} ----- CPU = {cpu:12.7g} (sec) -------------"
        for k, (word, cell) in enumerate(zip(words, cells)):
            text += ("\n" if k % 3 == 0 else "") + f"{self.name(k + 1, word):<8} = {cell} "
        return text[:-1]

    def _cell(self, column: int, word: str, value: float) -> str:
        form = self.format(column, word)
        try:
            return c_format(form, int(value) if self.kind(word) == "int" else value)
        except (TypeError, ValueError, OverflowError):
            raise InputError(f"thermo_modify format {form!r} does not fit column {column} ({word} = {value})") from None

    def needs(self, words: Sequence[str], computes: Mapping[str, Any], references: Callable[[str], set[str]]) -> set[str]:
        """What the force evaluation must give for a row (virial, energies, virials).

        Parameters
        ----------
        references : callable
            Formula -> every name it uses, for columns ``v_name``.
        """
        found: set[str] = set()
        names = {n for w in words for n in (references(w) if w.startswith("v_") else {w.partition("[")[0]})}
        for name in names:
            if name in KEYWORDS:
                found |= KEYWORDS[name].needs
            elif name.startswith("c_") and name[2:] in computes:
                found |= computes[name[2:]].needs
        return found


def _centre(text: str, width: int) -> str:
    left = max(width - len(text), 0) // 2
    return " " * left + text + " " * max(width - len(text) - left, 0)
