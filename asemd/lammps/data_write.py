"""Writing LAMMPS data files: everything a system and its interactions say, with all digits."""
from __future__ import annotations

import gzip
import os
import warnings
from collections.abc import Callable, Iterable, Iterator

import numpy as np

from asemd import atom_style as atom_styles
from asemd.box import MARGIN, Box
from asemd.cross_terms import CrossTermStyle
from asemd.errors import InputError, InputWarning
from asemd.forcefield import Interactions
from asemd.lammps.data_format import COEFFS, IMAGE, LABELS, TOPOLOGY
from asemd.system import LABELLED, System

BLOCK = 1 << 14     # lines that are written together
MARKS = {category: {mark: name for name, (c, mark) in COEFFS.items() if c == category and mark}
         for category in ("angle", "dihedral", "improper")}


def write_data(path: str | os.PathLike, system: System, interactions: Interactions | None = None, *, pair: str = "ii",
               types: str = "numeric", labels: bool = True, general: bool = False, margins: bool = False,
               progress: Callable[[int, int], None] | None = None, fixes=()) -> None:
    """Write a data file; a path ending in ``.gz`` is compressed.

    Parameters
    ----------
    system : System
        Atoms are wrapped into the box; a box in another frame than LAMMPS's is rotated, with positions and velocities.
    interactions : Interactions, optional
        Its coefficients are written; by default none.
    pair : str
        ``ii``: a line for each atom type; ``ij``: a line for each pair of types, mixed ones included.
    types : str
        ``numeric``, or ``labels``: type labels instead of numbers in Atoms, Bonds, ... (of kinds where all types have one).
    labels : bool
        Whether sections of type labels are written.
    general : bool
        Box vectors, positions and velocities of a general triclinic box as it was given.
    margins : bool
        Whether shrink-wrapped faces are written such that they keep their margins when the file is read, see `keeping_margins`.
    progress : callable, optional
        Told from time to time how many lines are written, and how many there are.
    fixes : sequence of Fix
        Fixes that write lines of the header (``data_header``) or sections (``data_sections``: heading -> columns) of their own.

    Raises
    ------
    InputError
        What a data file cannot hold (masses by atom), missing masses, a path that cannot be written.

    Warns
    -----
    InputWarning
        Coefficients that a data file cannot hold (hybrid pair styles with several lines for one type), or does not (with ``ii`` those of
        unlike types), types without labels where ``labels`` are asked for.
    """
    if not atom_styles.known(system.atom_style):
        raise InputError(f"write_data: atom_style {system.atom_style} is not supported")
    written = {name for fix in fixes for name, _ in getattr(fix, "properties", ())}
    if system.rmass is not None and not atom_styles.has(system.atom_style, "density") and "rmass" not in written:
        raise InputError(f"write_data: atoms with their own masses cannot be written with atom_style {system.atom_style}")
    inside = _lammps_frame(system)
    if margins:
        inside.box = keeping_margins(inside.box, not inside.topology.is_empty)
    own = [fix.data_header(inside) for fix in fixes if hasattr(fix, "data_header")]
    parts = _file(_general_frame(inside) if general else inside, interactions, pair, types, labels, general, progress, own)
    path = os.fspath(path)
    try:
        with (gzip.open if path.endswith(".gz") else open)(path, "wt", encoding="utf-8") as f:
            for part in parts:
                f.write(part)
                f.write("\n")
            for fix in fixes:
                for heading, columns in fix.data_sections(inside).items():
                    f.writelines(f"{line}\n" for line in _section(heading, _table(columns, {}, _Told(None, 0))))
    except OSError as e:
        raise InputError(f"write_data: cannot write {path}: {e.strerror or e}") from None


def _general_frame(system: System) -> System:
    """The system turned back to where the general triclinic box was given."""
    out, back = system.copy(), system.rotation.T
    out.box = Box(system.box.origin, system.box.cell @ back, system.box.boundary, True)
    out.x, out.v = (system.x - system.box.origin) @ back + system.box.origin, system.v @ back
    out.extra |= atom_styles.rotated(system.extra, back)
    return out


def keeping_margins(box: Box, bonds: bool) -> Box:
    """The box to write so that its reader ends with the margins of this one: with `bonds` he takes them from a box whose faces ``s`` moved.

    Directions with faces ``m``, and those whose atoms are farther apart than the initial bounds, stay as they are.
    """
    if box.initial is None or not box.is_lammps_frame:
        return box
    lo, hi = box.lo, box.hi
    for k, faces in enumerate(box.boundary):
        if "s" not in faces or "m" in faces:
            continue
        moving, first = np.array([face == "s" for face in faces]), box.initial[1, k] - box.initial[0, k]
        length = first / (1.0 + MARGIN * moving.sum() * bonds) * (1.0 + 1e-13)      # more than rounding, so that no atom is left outside
        middle = 0.5 * (lo[k] + hi[k])
        bounds = np.array([middle - 0.5 * length, middle + 0.5 * length] if moving.all() else [lo[k], lo[k] + length] if moving[1] else
                          [hi[k] - length, hi[k]])
        atoms, reader = np.array([lo[k], hi[k]]) + MARGIN * first * moving * (1, -1), bounds + MARGIN * length * moving * (-1, 1)
        if reader[0] <= atoms[0] and atoms[1] <= reader[1]:
            lo[k], hi[k] = bounds
    return Box.from_lammps(lo, hi, box.tilt, box.boundary, box.triclinic)


def _lammps_frame(system: System) -> System:
    out = system.copy()
    if not system.box.is_lammps_frame:
        out.box, rotation = system.box.to_lammps()
        out.x, out.v = (system.x - system.box.origin) @ rotation, system.v @ rotation
        out.extra |= atom_styles.rotated(system.extra, rotation)
    out.box.wrap(out.x, out.image)
    out.box = out.box.shrink_wrapped(out.x)
    return out


def _file(s: System, interactions: Interactions | None, pair: str, types: str, labels: bool, general: bool, progress,
          own: Iterable[str]) -> Iterator[str]:
    units = "" if s.units == "ase" else f", units = {s.units}"
    yield f"LAMMPS data file written by asemd, timestep = {s.step}{units}"
    yield ""
    yield f"{s.n} atoms"
    yield f"{s.counts['ntypes']} atom types"
    for section, kind in TOPOLOGY.items():
        if kind in atom_styles.bonded(s.atom_style) and s.counts[f"n{kind}types"]:
            yield f"{np.count_nonzero(s.topology.items(kind)[1]) + len(_torn(s, kind))} {section.lower()}"
            yield f"{s.counts[f'n{kind}types']} {kind} types"
    if atom_styles.has(s.atom_style, "ellipsoid"):
        yield f"{np.count_nonzero(s.extra['shape'][:, 0])} ellipsoids"
    yield from own
    yield ""
    yield from _box(s.box, general)
    names = {kind: {t: str(t) for t in range(1, _count(s, kind) + 1)} for kind in LABELLED}
    for section, kind in LABELS.items():
        if not s.labels[kind] or not _complete(s, kind, types):
            continue
        if labels:
            yield from _section(section, (f"{t} {label}" for t, label in sorted(s.labels[kind].items())))
        if types == "labels":
            names[kind] = s.labels[kind]
    if not np.isnan(s.mass[1:]).all():
        s.check_masses()
        yield from _section("Masses", (f"{t} {m!r}" for t, m in enumerate(s.mass[1:].tolist(), 1)))
    if interactions is not None:
        yield from _coefficients(interactions, s, pair)
    told = _Told(progress, 2 * s.n + sum(len(atoms) for _, atoms, _ in s.topology))
    if s.n:
        yield from _section(f"Atoms # {s.atom_style.split()[0]}", _table(_atoms(s), {"type": names["atom"]}, told))
        spins = {own[0]: name for name, own in atom_styles.SPINS.items()}
        v = np.hstack([s.v, *(s.extra[spins[c]] for c in atom_styles.velocity_columns(s.atom_style) if c in spins)])
        yield from _section("Velocities", _table({"id": s.id, **dict(enumerate(v.T))}, {}, told))
    if atom_styles.has(s.atom_style, "ellipsoid") and (solid := s.extra["shape"][:, 0] > 0.0).any():
        columns = [s.id[solid], *s.extra["shape"][solid].T, *s.extra["quaternions"][solid].T]
        yield from _section("Ellipsoids", _table(dict(enumerate(columns)), {}, told))
    for section, kind in TOPOLOGY.items():
        atoms, item_types = s.topology.items(kind)
        on = item_types != 0
        atoms, item_types = atoms[on], np.abs(item_types[on])       # turned off ones as if they were on
        ids = s.id[atoms]
        if torn := _torn(s, kind):
            ids = np.concatenate([ids, [item[2] for item in torn]])
            item_types = np.append(item_types, [abs(item[1]) for item in torn])
        if len(ids):
            columns = {"number": np.arange(1, len(ids) + 1), "type": item_types, **dict(enumerate(ids.T))}
            yield from _section(section, _table(columns, {"type": names[kind]}, told))


def _torn(s: System, kind: str) -> list:
    """Items of a kind that lack atoms, but not the one they are written with."""
    here = set(s.id.tolist()) if s.torn else ()
    return [item for item in s.torn if item[0] == kind and item[1] != 0 and (item[2][0] if kind == "bond" else item[2][1]) in here]


def _box(box, general: bool) -> Iterator[str]:
    if general:
        for numbers, name in zip([*box.cell.tolist(), box.origin.tolist()], ("avec", "bvec", "cvec", "abc origin")):
            yield f"{' '.join(map(repr, numbers))} {name}"
        return
    for axis, lo, hi in zip("xyz", box.lo.tolist(), box.hi.tolist()):
        yield f"{lo!r} {hi!r} {axis}lo {axis}hi"
    if box.triclinic:
        yield " ".join(map(repr, box.tilt.tolist())) + " xy xz yz"


def _count(s: System, kind: str) -> int:
    return s.counts["ntypes" if kind == "atom" else f"n{kind}types"]


def _complete(s: System, kind: str, types: str) -> bool:
    """Whether each type has a label that can stand in a file: such files are read only where all have one."""
    missing = [t for t in range(1, _count(s, kind) + 1) if "#" in s.labels[kind].get(t, "#")]
    if missing and types == "labels":
        warnings.warn(f"write_data: {kind} type {missing[0]} has no label that a data file can hold: numbers are written for {kind} types",
                      InputWarning, stacklevel=2)
    return not missing


def _section(heading: str, lines: Iterable[str]) -> Iterator[str]:
    yield ""
    yield heading
    yield ""
    yield from lines


class _Told:
    """Counts lines for the one who waits."""

    def __init__(self, progress, total: int):
        self.progress, self.total, self.done = progress, total, 0

    def add(self, lines: int) -> None:
        self.done += lines
        if self.progress is not None:
            self.progress(self.done, self.total)


def _table(columns: dict[object, np.ndarray], names: dict[str, dict[int, str]], told: _Told) -> Iterator[str]:
    """Rows of numbers, many lines at a time; real numbers with all their digits, `names` instead of the numbers of some columns."""
    form = " ".join("%s" if c in names else "%r" for c in columns)
    n = len(next(iter(columns.values())))
    for k in range(0, n, BLOCK):
        block = [values[k:k + BLOCK].tolist() for values in columns.values()]
        block = [[names[c][t] for t in values] if c in names else values for c, values in zip(columns, block)]
        yield "\n".join([form % row for row in zip(*block)])
        told.add(len(block[0]))


def _atoms(s: System) -> dict[str, np.ndarray]:
    known = {"id": s.id, "molecule": s.molecule, "type": s.type, "q": s.q if s.q is not None else np.zeros(s.n), **dict(zip("xyz", s.x.T))}
    if "mu" in s.extra:
        known |= dict(zip(atom_styles.DIPOLE, s.extra["mu"].T))
    known |= {c: s.extra[c] for c in atom_styles.SURFACE if c in s.extra}
    if s.rmass is not None:
        known["density"] = s.rmass
    if "radius" in s.extra:
        known |= {"diameter": 2.0 * s.extra["radius"], "density": known["density"] / atom_styles.volume(s.extra["radius"])}
    if "shape" in s.extra:
        known |= {"ellipsoid": (s.extra["shape"][:, 0] > 0.0).astype(int),
                  "density": known["density"] / atom_styles.ellipsoid_volume(s.extra["shape"])}
    return {c: known[c] for c in atom_styles.columns(s.atom_style)} | dict(zip(IMAGE, s.image.T))


def _coefficients(interactions: Interactions, s: System, pair: str) -> Iterator[str]:
    for category in ("pair", *TOPOLOGY.values()):
        style = interactions.style_name(category)
        if style == "none" or not _count(s, "atom" if category == "pair" else category):
            continue
        if category == "pair" and any(use.style.many for use in interactions.uses["pair"]):      # potential files are not in data files
            continue
        if style == "bpm/spring":      # as in LAMMPS, whose scripts choose this style after read_data
            continue
        if category == "pair":
            sections = _pair_sections(interactions, s, pair)
        else:
            sections = _bonded_sections(interactions, category, _count(s, category))
        want = _count(s, "atom" if category == "pair" else category)
        for name, lines in sections.items():
            need = want * (want + 1) // 2 if name == "PairIJ Coeffs" else want
            if len(lines) == need and len({tuple(line[:1 + (name == "PairIJ Coeffs")]) for line in lines}) == need:
                yield from _section(f"{name} # {style}", map(" ".join, lines))
            elif lines or style != "zero":
                warnings.warn(f"write_data: section {name} is left out, it would need one line for each of {need} types or pairs of types "
                              f"and {category}_style {style} has {len(lines)}: repeat its {category}_coeff commands in the script",
                              InputWarning, stacklevel=2)


def _bonded_sections(interactions: Interactions, category: str, count: int) -> dict[str, list[list[str]]]:
    """Lines by section: those with the mark of a cross term go to the section of that term, without the mark.

    In a hybrid the sections of cross terms say ``skip`` for the types of other styles, so that they have a line for each type.
    """
    main = f"{category.capitalize()} Coeffs"
    out: dict[str, list[list[str]]] = {main: []}
    at = 2 if interactions.hybrid[category] else 1
    crossed = {str(key) for use in interactions.uses[category] if isinstance(use.style, CrossTermStyle) for key in use.coeff}
    for line in interactions.coeff_lines(category):
        mark = line[at] if line[0] in crossed and len(line) > at else ""        # a table/cut line has a word aat that is no such mark
        name = MARKS.get(category, {}).get(mark, main)
        out.setdefault(name, []).append(line if name == main else [*line[:at], *line[at + 1:]])
    for name, lines in out.items():
        if interactions.hybrid[category] and name != main:
            known = {line[0] for line in lines}
            lines += [[str(t), "skip"] for t in range(1, count + 1) if str(t) not in known]
            lines.sort(key=lambda line: int(line[0]))
    return out


def _pair_sections(interactions: Interactions, s: System, pair: str) -> dict[str, list[list[str]]]:
    lines = interactions.coeff_lines("pair")
    if pair == "ii":
        if unlike := sum(line[0] != line[1] for line in lines):
            warnings.warn(f"write_data: {unlike} pair_coeff{'s' * (unlike > 1)} of unlike types {'are' if unlike > 1 else 'is'} not in the "
                          "file: use pair ij, or repeat the commands in the script", InputWarning, stacklevel=2)
        return {"Pair Coeffs": [[line[0], *line[2:]] for line in lines if line[0] == line[1]]}
    if not interactions.hybrid["pair"]:
        use = interactions.uses["pair"][0]
        filled = use.style.filled(use.coeff, use.settings, s.counts["ntypes"], interactions.modified(use, "mix"))
        lines = [[str(i), str(j), *use.style.format_coeff(c)] for (i, j), c in sorted(filled.items())]
    return {"PairIJ Coeffs": lines}
