"""``read_data file keyword args ...``"""
from __future__ import annotations

import time
import warnings
from dataclasses import dataclass, field, replace

import numpy as np

from asemd.errors import InputError, InputWarning, nearest
from asemd.lammps.command.create_box import describe
from asemd.lammps.data import DataFile, read_data
from asemd.lammps.data_format import COEFFS, TOPOLOGY
from asemd.lammps.live_coefficients import fill
from asemd.lammps.setup_log import report_special
from asemd.system import COUNTS, LABELLED, System
from asemd.topology import KINDS, Topology
from asemd.words import number, take, whole

EXTRA = {**{f"extra/{kind}/types": "ntypes" if kind == "atom" else f"n{kind}types" for kind in LABELLED},
         **{name.replace("_", "/"): name for name in COUNTS if name.startswith("extra_")}}
KEYWORDS = ("add", "offset", "shift", "group", "nocoeff", "fix", *EXTRA)


@dataclass
class _Options:
    add: list[str] = field(default_factory=list)        # ["append"], ["merge"] or [id offset, molecule offset]
    offset: list[int] = field(default_factory=lambda: [0] * len(LABELLED))
    shift: list[float] = field(default_factory=lambda: [0.0] * 3)
    group: str = ""
    nocoeff: bool = False
    extra: dict[str, int] = field(default_factory=dict)
    fixes: list[tuple[str, str, str]] = field(default_factory=list)


def run(session, args):
    started = time.perf_counter()
    scene, old = session.scene, session.scene.system
    path = take(args, 1, "read_data")[0]
    options = _read_options(args[1:])
    if old is not None and not options.add:
        raise InputError("read_data: the simulation box is defined already, use the keyword add or clear first")
    if old is None and options.add:
        raise InputError("read_data add: there is no simulation box to add to")
    for id, *_ in options.fixes:
        if id not in scene.fixes:
            raise InputError(f"read_data fix: there is no fix {id}{nearest(id, scene.fixes)}")
    session.print("Reading data file ...")
    with warnings.catch_warnings(record=True) as caught, session.progress("lines") as progress:
        warnings.simplefilter("always", InputWarning)
        fixes = [(id, header, id if section == "NULL" else section, hasattr(scene.fixes[id], "read_section"))
                 for id, header, section in options.fixes]
        data = read_data(path, scene.units, scene.atom_style, scene.boundary, scene.dimension, options.extra, old, options.shift, progress,
                         fixes)
    for warning in caught:
        session.warn(str(warning.message))
    smallest = data.system.id.min(initial=2**62)
    if old is None:
        new, scene.system, scene.order = data.system, data.system, data.order
        new.step = scene.first_step
        scene.special_room = new.counts["extra_special_per_atom"]
        scene.groups.resize(new.n)
        types = {kind: np.arange(_count(new, kind) + 1) for kind in LABELLED}
    else:
        types = _type_numbers(old, data, options)
        new = _renumbered(old, data.system, types, options)
        if old.image.any() and not np.array_equal(old.box.cell, new.box.cell):
            session.warn("read_data add: the box grows while atoms have image flags, their unwrapped positions change")
        _join(scene, old, new)
    scene.sync_groups()
    _read_for_fixes(scene, data, options, int(new.id.min()) - int(smallest) if old is not None and new.n else 0)
    if options.group:
        mask = np.isin(scene.system.id, new.id)
        scene.groups[options.group] = scene.groups.get(options.group, False) | mask
    if not options.nocoeff:
        _set_coefficients(session, data, types)
    session.stale()
    _report(session, data, new, started)


def _read_for_fixes(scene, data: DataFile, options: _Options, offset: int) -> None:
    """Header lines and sections of fixes; `offset` is what was added to atom ids.

    Raises
    ------
    InputError
        A header line promises what is not there, or is without numbers.
    """
    for id, lines in data.fix_headers.items():
        if hasattr(scene.fixes[id], "read_header"):
            for where, words in lines:
                try:
                    scene.fixes[id].read_header(words)
                except InputError as e:
                    raise e.at(where) from None
    for id, *_ in options.fixes:
        lines, atoms = data.fix_lines.get(id, []), data.system.n
        if hasattr(scene.fixes[id], "properties") and lines and len(lines) % atoms:
            raise InputError(f"the section of fix {id} has {len(lines)} lines, but there are {atoms} atoms (truncated file?)", lines[-1][0])
        if id in data.fix_lines or getattr(scene.fixes[id], "promised", None):
            scene.fixes[id].read_section(scene.system, data.fix_lines.get(id, []), offset)


def _read_options(words: list[str]) -> _Options:
    out, given = _Options(), set()
    while words:
        key, *words = words
        what = f"read_data {key}"
        given.add(key)
        if key == "add":
            first = take(words, 1, what)[0]
            used = 1 if first in ("append", "merge") else 2
            out.add = take(words, used, what)
            if used == 2:
                out.add = [str(whole(w, what)) for w in out.add]
                if any(int(w) < 0 for w in out.add):
                    raise InputError(f"{what}: offsets must not be negative")
        elif key == "offset":
            used = len(LABELLED)
            out.offset = [whole(w, what) for w in take(words, used, what)]
            if min(out.offset) < 0:
                raise InputError(f"{what}: offsets must not be negative")
        elif key == "shift":
            used = 3
            out.shift = [number(w, what) for w in take(words, 3, what)]
        elif key == "group":
            used, out.group = 1, take(words, 1, what)[0]
        elif key == "nocoeff":
            used, out.nocoeff = 0, True
        elif key in EXTRA:
            used, out.extra[EXTRA[key]] = 1, whole(take(words, 1, what)[0], what)
            if out.extra[EXTRA[key]] < 0:
                raise InputError(f"{what}: must not be negative")
        elif key == "fix":
            used = 3
            out.fixes.append(tuple(take(words, 3, what)))
        else:
            raise InputError(f"read_data: unknown keyword {key!r}{nearest(key, KEYWORDS)}")
        words = words[used:]
    if not out.add and (wrong := given & {"offset", "shift"}):
        raise InputError(f"read_data {min(wrong)} needs the keyword add")
    if out.add and (wrong := given & set(EXTRA)):
        raise InputError(f"read_data {min(wrong)} is not possible with add: give it when the first file is read")
    return out


def _count(system: System, kind: str) -> int:
    return system.counts["ntypes" if kind == "atom" else f"n{kind}types"]


def _type_numbers(old: System, data: DataFile, options: _Options) -> dict[str, np.ndarray]:
    """For each kind the type of the system by type of the file: by label where both have labels, else by offset."""
    out = {}
    for kind, offset in zip(LABELLED, options.offset):
        n, labels = _count(data.system, kind), data.system.labels[kind]
        known = {label: t for t, label in old.labels[kind].items()}
        out[kind] = np.arange(n + 1) + offset
        if labels and known:
            for t, label in labels.items():
                if label not in known:
                    raise InputError(f"read_data add: {kind} type label {label} is not one of the system's{nearest(label, known)}")
                out[kind][t] = known[label]
        if n and out[kind][1:].max() > _count(old, kind):
            raise InputError(f"read_data add: the file needs {kind} type {out[kind][1:].max()}, the system has {_count(old, kind)}: "
                             f"use extra/{kind}/types when the first file is read")
    return out


def _renumbered(old: System, new: System, types: dict[str, np.ndarray], options: _Options) -> System:
    """The atoms of the file with the ids, molecules and types they have in the system."""
    if options.add == ["append"]:
        ids, molecules = int(old.id.max(initial=0)), int(old.molecule.max(initial=0))
    else:
        ids, molecules = (0, 0) if options.add == ["merge"] else map(int, options.add)
    twice = np.intersect1d(old.id, new.id + ids)
    if len(twice):
        raise InputError(f"read_data add: duplicate atom ID {twice[0]}, it exists already: use add append")
    mass = np.full(_count(old, "atom") + 1, np.nan)
    mass[types["atom"][1:]] = new.mass[1:]
    parts = {}
    for kind in KINDS:
        parts[f"{kind}s"], item_types = new.topology.items(kind)
        parts[f"{kind}_types"] = types[kind][item_types]
    labels = {kind: {int(types[kind][t]): label for t, label in new.labels[kind].items()} for kind in LABELLED}
    return replace(new, id=new.id + ids, molecule=new.molecule + (molecules if old.molecular else 0), type=types["atom"][new.type],
                   topology=Topology(**parts), mass=mass, labels=labels, counts=dict(old.counts))


def _join(scene, old: System, new: System) -> None:
    base = replace(old, box=new.box, mass=np.where(np.isnan(new.mass), old.mass, new.mass))
    joined = base.append(new, keep_ids=True)
    order = np.argsort(joined.id, kind="stable")
    scene.system = joined.select(order)
    scene.system.box = new.box.shrink_wrapped(scene.system.x)
    scene.system.topology.frozen = None
    scene.groups.resize(joined.n)
    scene.groups.select(order)


def _set_coefficients(session, data: DataFile, types: dict[str, np.ndarray]) -> None:
    system, interactions = session.scene.system, session.scene.interactions
    for section, lines in data.coeffs.items():
        category, mark = COEFFS[section]
        kind, heading = "atom" if category == "pair" else category, data.headings[section]
        name = interactions.style_name(category)
        if name == "none":
            raise InputError(f"must define {category}_style before {section} (or use read_data nocoeff)").at(heading)
        hint = data.styles_hint.get(section, name)
        if hint != name:
            session.warn(f"{category} style {hint} in the data file differs from the current {category}_style {name} ({heading})")
        for where, words in lines:
            try:
                interactions.set_coeff(category, _coeff_words(section, mark, words, types[kind]), system)
            except InputError as e:
                raise e.at(where) from None
    fill(session)


def _coeff_words(section: str, mark: str, words: list[str], types: np.ndarray) -> list[str]:
    """A line of a section as the words of the ``*_coeff`` command."""
    width = 2 if section == "PairIJ Coeffs" else 1
    numbers, rest = [str(types[int(w)]) for w in words[:width]], words[width:]
    if section == "Pair Coeffs":
        numbers *= 2
    if mark:
        at = 1 if rest and rest[0][0].islower() else 0      # in a hybrid the name of the sub-style comes first
        rest = [*rest[:at], mark, *rest[at:]] if rest[:1] != ["skip"] else rest
    return [*numbers, *rest]


def _report(session, data: DataFile, new: System, started: float) -> None:
    """What was read; a file with bonds is told as LAMMPS reads it, twice."""
    box = f"  {describe(data.box)}\n  1 by 1 by 1 MPI processor grid"
    sections = [(s, TOPOLOGY[s]) for s in data.headings if s in TOPOLOGY and len(new.topology.items(TOPOLOGY[s])[0])]
    lines = [box, "  reading atoms ...", f"  {new.n} atoms"]
    if "Velocities" in data.headings:
        lines += ["  reading velocities ...", f"  {new.n} velocities"]
    for name, kind in sections:
        lines += [f"  scanning {name.lower()} ...", f"  {_most(session.scene, new, kind)} = max {kind}s/atom"]
    if sections:
        lines.append(box)
    for name, kind in sections:
        lines += [f"  reading {name.lower()} ...", f"  {len(new.topology.items(kind)[0])} {kind}s"]
    session.print("\n".join(lines))
    report_special(session)
    session.print(f"  read_data CPU = {time.perf_counter() - started:.3f} seconds")


def _most(scene, new: System, kind: str) -> int:
    """Items that LAMMPS would hold for one atom: with newton on each belongs to one of its atoms."""
    atoms = new.topology.items(kind)[0]
    holders = atoms[:, 0 if kind == "bond" else 1] if scene.newton[1] else atoms
    return int(np.bincount(holders.ravel()).max()) + (new.counts[f"extra_{kind}_per_atom"] if new is scene.system else 0)
