"""Reading LAMMPS data files.

Sections are parsed in bulk; only when that fails are their lines looked at one by one, to find the faulty one (or to read type labels).
"""
from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from asemd import atom_style as atom_styles
from asemd.box import FARTHEST, Box
from asemd.errors import InputError, Where, nearest
from asemd.lammps.data_box import general_box, is_general, same_frame
from asemd.lammps.data_ellipsoids import read_ellipsoids
from asemd.lammps.data_format import COEFFS, IMAGE, KIND_OF, LABELS, REAL_HEADER, TOPOLOGY
from asemd.lammps.data_table import parse_table
from asemd.lammps.data_text import DataText
from asemd.system import System, id_range
from asemd.topology import ATOMS, Topology


@dataclass
class DataFile:
    """What a data file says.

    Attributes
    ----------
    system : System
        Atoms in order of id, inside the box.
    box : Box
        As the file has it, or together with the one it extends, before shrink-wrapped faces move to the atoms.
    coeffs : dict
        Section -> list of (place, words); types as numbers, without comments.
    styles_hint, headings, title, fix_lines, fix_headers, order
        Section -> style after ``#`` in its heading, its place; first line; ID of a fix -> (place, words) of lines; atom IDs as in the file.
    """

    system: System
    box: Box
    coeffs: dict[str, list[tuple[Where, list[str]]]] = field(default_factory=dict)
    styles_hint: dict[str, str] = field(default_factory=dict)
    headings: dict[str, Where] = field(default_factory=dict)
    title: str = ""
    fix_lines: dict[str, list[tuple[Where, list[str]]]] = field(default_factory=dict)
    fix_headers: dict[str, list[tuple[Where, list[str]]]] = field(default_factory=dict)
    order: np.ndarray | None = None


def read_data(path: str | os.PathLike, units: str = "lj", atom_style: str = "full", boundary: Sequence[str] = ("pp", "pp", "pp"),
              dimension: int = 3, extra: dict[str, int] | None = None, onto: System | None = None,
              shift: Sequence[float] = (0.0, 0.0, 0.0), progress: Callable[[int, int], None] | None = None,
              fixes: Sequence[tuple[str, str, str]] = ()) -> DataFile:
    """Read a data file (``.gz``: compressed).

    Parameters
    ----------
    units, atom_style, boundary, dimension
        As in the script: the file does not say them.
    extra : dict, optional
        Added to the numbers of the header: names of `System.counts`.
    onto : System, optional
        What the atoms will be added to: its box is extended by that of the file.
    shift : (3,) float
        Added to coordinates and box bounds.
    progress : callable, optional
        Told from time to time how many lines are read, and how many there are.
    fixes : see `DataText`

    Returns
    -------
    DataFile

    Raises
    ------
    InputError
        Missing file, or any fault of it; names line and ids.

    Warns
    -----
    InputWarning
        What is legal but hardly meant: a bond listed twice, image flags that tear bonds apart, style hints that differ.
    """
    if not atom_styles.known(atom_style):
        raise InputError(f"read_data: atom_style {atom_style} is not supported; use one of {' '.join(atom_styles.NAMES)}")
    return _Reader(path, units, atom_style, boundary, dimension, extra or {}, onto, np.asarray(shift, float), progress, fixes).read()


class _Reader(DataText):
    """The values of one file, section by section."""

    def __init__(self, path, units, atom_style, boundary, dimension, extra, onto, shift, progress, fixes):
        super().__init__(path, atom_style, fixes)
        self.units, self.boundary, self.dimension = units, boundary, dimension
        self.extra, self.onto, self.shift = extra, onto, shift
        self.labels: dict[str, dict[int, str]] = {}
        self.told = progress and (lambda line: progress(line, len(self.lines)))

    def read(self) -> DataFile:
        for section, kind in LABELS.items():
            if section in self.sections:
                self.labels[kind] = self.read_labels(section, kind)
        counts = {"ntypes": self.number("atom types")} | {f"n{kind}types": self.number(f"{kind} types") for kind in ATOMS}
        counts |= {f"extra_{kind}_per_atom": self.number(f"extra {kind} per atom") for kind in (*ATOMS, "special")}
        self.types = {"atom": counts["ntypes"], **{kind: counts[f"n{kind}types"] for kind in ATOMS}}
        counts = {name: n + self.extra.get(name, 0) for name, n in counts.items()}
        box, rotation = self.read_box()
        system = self.read_atoms(box, rotation, counts, self.read_masses(counts["ntypes"]))
        headings = {s.name: self.where(s.line) for s in self.sections.values()}
        coeffs = {name: self.read_coeffs(name) for name in self.sections if name in COEFFS}
        self.check_hints(self.units)
        return DataFile(system, self.whole, coeffs, {s.name: s.hint for s in self.sections.values() if s.hint}, headings,
                        self.lines[0].strip(), self.fix_lines(), self.fix_headers(), self.order)

    def read_box(self) -> tuple[Box, np.ndarray | None]:
        """The box of the file, and for general vectors the rotation into LAMMPS's frame."""
        head = self.header
        try:
            if is_general(head):
                return general_box(head, self.boundary, self.dimension, self.shift)
            missing = [f"{a}lo {a}hi" for a in "xyz"[:self.dimension] if f"{a}lo {a}hi" not in head]
            if missing and self.number("atoms"):
                self.warn(f"the header has no line {' and no line '.join(missing)}: the box goes from -0.5 to 0.5 there",
                          self.header_line["atoms"])
            bounds = np.array([head.get(f"{a}lo {a}hi", [-0.5, 0.5]) for a in "xyz"]) + self.shift[:, None]
            box = Box.from_lammps(*bounds.T, head.get("xy xz yz", (0, 0, 0)), self.boundary, triclinic="xy xz yz" in head)
        except InputError as e:
            line = next((self.header_line[f"{a}lo {a}hi"] for a in "xyz" if f"{a}lo" in e.message and f"{a}lo {a}hi" in head),
                        self.header_line.get("avec", max((self.header_line[w] for w in head if w in REAL_HEADER), default=0)))
            raise e.at(self.where(line)) from None
        if self.dimension == 2 and not box.lo[2] < 0.0 < box.hi[2]:
            raise self.fail("zlo and zhi of a 2d system must lie on both sides of 0", self.header_line.get("zlo zhi", 0))
        if self.dimension == 2 and box.tilt[1:].any():
            raise self.fail("xz and yz of a 2d system must be 0", self.header_line["xy xz yz"])
        return box, None

    def union(self, box: Box) -> Box:
        """The box of the file together with that of the system the atoms are added to."""
        old = self.onto.box
        if not old.is_lammps_frame or not np.array_equal(old.tilt, box.tilt):
            raise self.fail("read_data add: the tilt factors of both boxes must be equal", self.header_line.get("xy xz yz"))
        return Box.from_lammps(np.minimum(old.lo, box.lo), np.maximum(old.hi, box.hi), old.tilt, old.boundary, old.triclinic)

    def table(self, section: str, columns: Sequence[str], count: int, kind: str = "atom", optional: Sequence[str] = ()):
        """Columns of a section as arrays, and a function row -> line index."""
        s = self.sections[section]
        try:
            values, where = parse_table(self.lines, s.first, s.last, columns, {c: KIND_OF[c] for c in (*columns, *optional)}, optional,
                                        self.labels.get(kind, {}), self.told)
        except InputError as e:
            style = f" (atom_style {self.atom_style})" if section == "Atoms" else ""
            raise self.fail(f"{section} section: {e.message}{style}", e.line) from None
        n = len(values[columns[0]])
        if n > count:
            raise self.fail(f"{section} section: extra line, the header says {count} (there are {n})", where(count))
        if n < count:
            raise self.fail(f"{section} section has {n} line{'s' * (n != 1)}, the header says {count} (truncated file?)",
                            where(n - 1) if n else s.line)
        for name, array in values.items():
            if array.dtype == float and not np.isfinite(array).all():
                row = int(np.argmin(np.isfinite(array)))
                what = {"q": "charge"}.get(name, ("velocity " if name[0] == "v" else "coordinate " if name in "xyz" else "") + name)
                what += f" of atom {values['id'][row]}" if "id" in values else ""
                raise self.fail(f"{section} section: {what} is {'NaN' if np.isnan(array[row]) else 'infinite'}, not a number", where(row))
        return values, where

    def in_range(self, section: str, types: np.ndarray, kind: str, where) -> None:
        most = self.types[kind]
        bad = (types < 1) | (types > most)
        if bad.any():
            row = int(np.argmax(bad))
            valid = f"1-{most}" if most else f'none: the header has no "{kind} types" line'
            raise self.fail(f"{section} section: {kind} type {types[row]} is out of range ({valid})", where(row))

    def read_labels(self, section: str, kind: str) -> dict[int, str]:
        out: dict[int, str] = {}
        count, s = self.number(f"{kind} types"), self.sections[section]
        for i in self.content(s):
            words = self.lines[i].split("#", 1)[0].split()
            if len(words) != 2 or not words[0].isdigit():
                raise self.fail(f"{section} section: expected a type number and a label", i)
            t, label = int(words[0]), words[1]
            if not 1 <= t <= count:
                raise self.fail(f"{section} section: {kind} type {t} is out of range (1-{count})", i)
            if label[0].isdigit() or label[0] in "#*":
                raise self.fail(f"{section} section: label {label!r} must not begin with a digit, # or *", i)
            if t in out or label in out.values():
                raise self.fail(f"{section} section: {f'type {t}' if t in out else f'label {label}'} appears twice", i)
            out[t] = label
        if len(out) != count:
            raise self.fail(f"{section} section has {len(out)} lines, the header says {count} {kind} types", s.line)
        return out

    def type_number(self, section: str, word: str, kind: str, index: int) -> int:
        known = {label: t for t, label in self.labels.get(kind, {}).items()}
        if word in known:
            return known[word]
        try:
            t = int(word)
        except ValueError:
            raise self.fail(f"{section} section: expected an {kind} type, got {word!r}{nearest(word, known)}", index) from None
        self.in_range(section, np.array([t]), kind, lambda _: index)
        return t

    def read_masses(self, ntypes: int) -> np.ndarray:
        mass = np.full(ntypes + 1, np.nan)
        if "Masses" not in self.sections:
            return mass
        section = self.sections["Masses"]
        for i in self.content(section):
            words = self.lines[i].split("#", 1)[0].split()
            if len(words) != 2:
                raise self.fail(f"Masses section: expected an atom type and a mass, got {len(words)} words", i)
            t = self.type_number("Masses", words[0], "atom", i)
            try:
                value = float(words[1])
            except ValueError:
                raise self.fail(f"Masses section: expected a mass, got {words[1]!r}", i) from None
            if not 0.0 < value < np.inf:
                raise self.fail(f"Masses section: the mass of type {t} must be a positive number, got {words[1]}", i)
            if not np.isnan(mass[t]):
                raise self.fail(f"Masses section: type {t} appears twice", i)
            mass[t] = value
        missing = np.flatnonzero(np.isnan(mass[1:self.types["atom"] + 1])) + 1
        if len(missing):
            raise self.fail(f"Masses section has no mass for atom type {missing[0]} of {self.types['atom']}", section.line)
        return mass

    def read_atoms(self, box: Box, rotation: np.ndarray | None, counts: dict[str, int], mass: np.ndarray) -> System:
        columns, n = atom_styles.columns(self.atom_style), self.number("atoms")
        if n or ("Atoms" in self.sections and self.content(self.sections["Atoms"])):
            a, where = self.table("Atoms", columns, n, optional=IMAGE)
        else:
            a, where = {c: np.zeros(0) for c in columns}, None
        ids = self.order = a["id"].astype(np.int64)
        order = np.argsort(ids, kind="stable")
        ids = ids[order]
        line = {} if n == 0 else (lambda row: where(int(order[row])))     # line of an atom in order of id
        if n and ids[0] < 1:
            raise self.fail(f"Atoms section: atom ID {ids[0]} must be positive", line(0))
        twice = np.flatnonzero(ids[1:] == ids[:-1])
        if len(twice):
            first, second = sorted((line(twice[0]), line(twice[0] + 1)))
            raise self.fail(f"Atoms section: duplicate atom ID {ids[twice[0]]} on lines {first + 1} and {second + 1}", second)
        self.in_range("Atoms", a["type"], "atom", where)
        x = np.column_stack([a[c] for c in "xyz"])[order] + self.shift
        image = np.zeros((n, 3), np.int32)
        flagged = n > 0 and "nx" in a
        if flagged:
            image[:] = np.clip(np.column_stack([a[c] for c in IMAGE])[order], -2**31 + 1, 2**31 - 1)
            self.drop_flags(image, box, line)
        if rotation is not None:
            x = (x - box.origin) @ rotation + box.origin
        if self.onto is not None and not same_frame(rotation, self.onto.rotation):
            raise self.fail("read_data add: box vectors must be those of the first file", self.header_line.get("avec"))
        whole = self.whole = box if self.onto is None else self.union(box)
        if rotation is None:
            whole = whole.widened()
            if any(self.number(kind + "s") for kind in ATOMS):
                whole.initial = np.array([whole.lo, whole.hi])      # LAMMPS reads files with bonds twice
        self.check_inside(x, ids, whole, line)
        far = (np.abs(whole.fractional(x)) + np.abs(image.astype(float)) > FARTHEST) & whole.periodic
        if far.any():
            row = int(np.argmax(far.any(axis=1)))
            raise self.fail(f"atom {ids[row]} is more than {FARTHEST:g} boxes away", line(row))
        v, spin = self.read_velocities(ids)
        a |= read_ellipsoids(self, a, order, where) if "ellipsoid" in a else {}
        try:
            extra = atom_styles.properties({name: array[order] for name, array in a.items()}, spin)
        except InputError as e:
            raise self.fail(f"Atoms section: {e.message}", line(e.row)) from None
        rmass = extra.pop("rmass", None)
        if rotation is not None:
            v, extra = v @ rotation, extra | atom_styles.rotated(extra, rotation)
        whole.remap(x, image)
        top = self.read_topology(ids)
        system = System(
            box=whole.shrink_wrapped(x), x=x, id=ids, type=a["type"][order], image=image, v=v, mass=mass, topology=top, counts=counts,
            molecule=a["molecule"][order] if "molecule" in a else None, q=a["q"][order] if "q" in a else None, labels=self.labels,
            units=self.units, atom_style=self.atom_style, dimension=self.dimension, rmass=rmass, rotation=rotation,
            extra={name: np.ascontiguousarray(values) for name, values in extra.items()})
        if flagged and self.onto is None:
            self.check_images(system, line)
        return system

    def drop_flags(self, image: np.ndarray, box: Box, line) -> None:
        useless = (image != 0) & ~box.periodic
        if useless.any():
            row = int(np.argmax(useless.any(axis=1)))
            axis = "xyz"[int(np.argmax(useless[row]))]
            self.warn(f"Atoms section: image flags in the non-periodic direction {axis} are set to 0", line(row))
            image[useless] = 0

    def check_inside(self, x, ids, box: Box, line) -> None:
        """Atoms must be inside the faces that are not periodic."""
        s = box.fractional(x)
        open_above = np.array([b[1] == "f" for b in box.boundary])
        outside = ~box.periodic & ((s < 0.0) | np.where(open_above, s >= 1.0, s > 1.0))
        if outside.any():
            row = int(np.argmax(outside.any(axis=1)))
            k = int(np.argmax(outside[row]))
            more = int(outside.any(axis=1).sum()) - 1
            kind, file = {"f": "fixed"}.get(box.boundary[k][0], "shrink-wrapped"), self.whole
            raise self.fail(f"atom {ids[row]} at {'xyz'[k]}={x[row, k]:g} is outside the {kind} box [{file.lo[k]:g}, {file.hi[k]:g}]"
                            + (f", and {more} more" if more else ""), line(row))

    def check_images(self, system: System, line) -> None:
        bad = system.image_conflicts()
        if not len(bad):
            return
        i, j = system.topology.bonds[bad[0]]
        far = system.box.unwrap(system.x[[i, j]], system.image[[i, j]])
        suspect = i if np.abs(system.image[i]).sum() > np.abs(system.image[j]).sum() else j
        more = f", and {len(bad) - 1} more" if len(bad) > 1 else ""
        self.warn(f"inconsistent image flags: bond {bad[0] + 1} (atoms {system.id[i]}-{system.id[j]}): image flags put the atoms "
                  f"{np.linalg.norm(far[1] - far[0]):g} apart, more than half the box{more}", line(suspect))

    def read_velocities(self, ids: np.ndarray) -> tuple[np.ndarray, dict[str, np.ndarray]]:
        """Velocities, and angular velocities or momenta where atoms have them."""
        columns = atom_styles.velocity_columns(self.atom_style)
        v = np.zeros((len(ids), len(columns) - 1))
        spin = {name: v[:, columns.index(own[0]) - 1:][:, :3] for name, own in atom_styles.SPINS.items() if own[0] in columns}
        if "Velocities" not in self.sections:
            return v[:, :3], spin
        a, where = self.table("Velocities", columns, len(ids))
        rows = self.rows("Velocities", a["id"][:, None], ids, where)[:, 0]
        order = np.argsort(rows, kind="stable")
        twice = np.flatnonzero(np.diff(rows[order]) == 0)
        if len(twice):
            twin = order[twice[0]:twice[0] + 2]
            lines = " and ".join(str(where(int(r)) + 1) for r in twin)
            raise self.fail(f"Velocities section: atom ID {ids[rows[twin[0]]]} appears on lines {lines}", where(int(twin[1])))
        v[rows] = np.column_stack([a[c] for c in columns[1:]])
        return v[:, :3], spin

    def rows(self, section: str, atoms: np.ndarray, ids: np.ndarray, where) -> np.ndarray:
        """Rows of atom ids (m, k)."""
        at = np.minimum(np.searchsorted(ids, atoms), max(len(ids) - 1, 0))
        bad = ids[at] != atoms if len(ids) else np.ones(atoms.shape, bool)
        if bad.any():
            row = int(np.argmax(bad.any(axis=1)))
            raise self.fail(f"{section} section: atom ID {atoms[row][bad[row]][0]} does not exist ({id_range(ids)})", where(row))
        return at

    def read_topology(self, ids: np.ndarray) -> Topology:
        parts = {}
        for section, kind in TOPOLOGY.items():
            n = self.number(kind + "s")
            if section not in self.sections or not n:
                continue
            columns = ("number", "type", *(f"atom{k}" for k in range(1, ATOMS[kind] + 1)))
            a, where = self.table(section, columns, n, kind)
            self.in_range(section, a["type"], kind, where)
            atoms = np.column_stack([a[c] for c in columns[2:]])
            rows = self.rows(section, atoms, ids, where)
            same = (np.diff(np.sort(rows, axis=1), axis=1) == 0).any(axis=1)
            if same.any():
                row = int(np.argmax(same))
                raise self.fail(f"{section} section: an atom appears twice in {kind} {'-'.join(map(str, atoms[row]))}", where(row))
            self.check_twice(section, kind, atoms, a["type"], where)
            parts[kind + "s"], parts[kind + "_types"] = rows, a["type"]
        return Topology(**parts)

    def check_twice(self, section: str, kind: str, atoms: np.ndarray, types: np.ndarray, where) -> None:
        """Warn of an item listed twice; of dihedrals and impropers only with the same type (sums of terms are usual)."""
        flip = atoms[:, 0] > atoms[:, -1] if kind != "improper" else np.zeros(len(atoms), bool)
        key = np.where(flip[:, None], atoms[:, ::-1], atoms)
        if kind in ("dihedral", "improper"):
            key = np.column_stack([key, types])
        order = np.lexsort(key.T[::-1])
        twice = np.flatnonzero((np.diff(key[order], axis=0) == 0).all(axis=1))
        if len(twice):
            first, second = (int(r) for r in order[twice[0]:twice[0] + 2])
            pair = "pair" if kind == "bond" else kind
            more = f", and {len(twice) - 1} more" if len(twice) > 1 else ""
            self.warn(f"{section} section: {pair} {'-'.join(map(str, key[first][:ATOMS[kind]]))} listed twice (lines {where(first) + 1}, "
                      f"{where(second) + 1}): duplicate {kind}, it counts double{more}", where(second))

    def read_coeffs(self, name: str) -> list[tuple[Where, list[str]]]:
        category, mark = COEFFS[name]
        kind = "atom" if category == "pair" else category
        ntypes, pairs = self.types[kind], name == "PairIJ Coeffs"
        out, seen = [], {}
        for i in self.content(self.sections[name]):
            words = self.lines[i].split("#", 1)[0].split()
            if len(words) < 1 + pairs:
                raise self.fail(f"{name} section: expected two atom types", i)
            types = [self.type_number(name, w, kind, i) for w in words[:1 + pairs]]
            key = tuple(sorted(types))
            if key in seen:
                raise self.fail(f"{name} section: {kind} type {' '.join(map(str, types))} appears on lines {seen[key] + 1} and {i + 1}", i)
            seen[key] = i
            out.append((self.where(i), [*map(str, types), *words[1 + pairs:]]))
        want = ntypes * (ntypes + 1) // 2 if pairs else ntypes
        if len(out) != want:
            raise self.fail(f"{name} section has {len(out)} line{'s' * (len(out) != 1)}, but {want} {'pairs of ' * pairs}{kind} types need "
                            f"{'a line' if want == 1 else 'lines'}", self.sections[name].line)
        return out
