"""``molecule ID file1 [offset|toff|boff|aoff|doff|ioff|scale values] [file2 ...]``: templates of molecules."""
from __future__ import annotations

import re
from collections.abc import Iterable

from asemd.errors import InputError
from asemd.lammps.molecule_file import Offsets, read
from asemd.molecule import Molecule
from asemd.system import LABELLED
from asemd.words import number, take, whole

ONE = dict(zip(("toff", "boff", "aoff", "doff", "ioff"), LABELLED))


def run(session, args):
    system = session.scene.need_system("molecule")
    name, path = take(args, 2, "molecule")[:2]
    check_id(session, name)
    files, words = [(path, Offsets())], list(args[2:])
    while words:
        key = words.pop(0)
        what, offsets = f"molecule {key}", files[-1][1]
        if key == "offset":
            values = [_offset(w, what) for w in take(words, len(LABELLED), what)]
            offsets.of = dict(zip(LABELLED, values))
            del words[:len(LABELLED)]
        elif key in ONE:
            offsets.of[ONE[key]] = _offset(take(words, 1, what)[0], what)
            del words[0]
        elif key == "scale":
            offsets.scale = number(take(words, 1, what)[0], what)
            if offsets.scale <= 0.0:
                raise InputError(f"{what}: the factor must be positive, got {words[0]}")
            del words[0]
        else:
            files.append((key, Offsets()))
    if any(any(offsets.of.values()) for _, offsets in files) and any(system.labels.values()):
        session.warn("molecule: offsets are added to numbers of types only, not to type labels")
    define(session, name, (read(path, system, offsets) for path, offsets in files))


def check_id(session, name: str) -> None:
    """Raise `InputError` unless a new template can have that ID."""
    if not re.fullmatch(r"\w+", name):
        raise InputError(f"molecule: ID {name!r} must have only letters, numbers and underscores")
    if name in session.scene.molecules:
        raise InputError(f"molecule: ID {name} is in use already")


def define(session, name: str, molecules: Iterable[Molecule]) -> None:
    """Define a template; every molecule is reported as soon as it is read."""
    templates = []
    for molecule in molecules:
        templates.append(molecule)
        _report(session, name, molecule)
    session.scene.molecules[name] = templates


def _offset(word: str, what: str) -> int:
    value = whole(word, what)
    if value < 0:
        raise InputError(f"{what}: must not be negative, got {word}")
    return value


def _report(session, name: str, molecule) -> None:
    lines = [f"Read molecule template {name}:", molecule.title, f"  {molecule.nmolecules} molecules",
             f"  {len(molecule.fragments)} fragments", "  0 bodies", f"  {molecule.natoms} atoms with max type {molecule.largest('atom')}"]
    lines += [f"  {count} {kind}s with max type {molecule.largest(kind)}" for kind, count in molecule.topology.counts().items()]
    session.print("\n".join(lines))
