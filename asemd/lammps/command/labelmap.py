"""``labelmap kind number label ...``, ``labelmap clear``, ``labelmap write file``"""
from __future__ import annotations

import re

from asemd.errors import InputError
from asemd.words import choice, exactly, take, whole

KINDS = ("atom", "bond", "angle", "dihedral", "improper")


def run(session, args):
    system = session.scene.need_system("labelmap")
    kind = choice(take(args, 1, "labelmap")[0], (*KINDS, "clear", "write"), "labelmap")
    if kind == "clear":
        exactly(args[1:], 0, "labelmap clear")
        for labels in system.labels.values():
            labels.clear()
        return
    if kind == "write":
        _write(exactly(args[1:], 1, "labelmap write")[0], system)
        return
    words = args[1:]
    if not words or len(words) % 2:
        raise InputError(f"labelmap {kind} needs pairs of a type and its label")
    count = system.counts["ntypes" if kind == "atom" else f"n{kind}types"]
    labels = dict(system.labels[kind])
    for number, label in zip(words[::2], words[1::2]):
        number = whole(number, f"labelmap {kind}")
        if not 1 <= number <= count:
            raise InputError(f"labelmap {kind}: type {number} is outside the valid range 1 to {count}")
        label = label.strip()       # LAMMPS writes blanks inside the quotes
        if re.match(r"[\d*#]", label) or len(label.split()) != 1:
            raise InputError(f"labelmap {kind}: label {label!r} of type {number} must be one word that does not start with a digit, * or #")
        labels[number] = label
    if len(set(labels.values())) < len(labels):
        twice = next(v for v in labels.values() if list(labels.values()).count(v) > 1)
        raise InputError(f"labelmap {kind}: label {twice} stands for two types")
    system.labels[kind].update(labels)


def _write(path: str, system) -> None:
    lines = [f"labelmap {kind} " + " ".join(f'{n} """{label}"""' for n, label in sorted(labels.items()))
             for kind, labels in system.labels.items() if labels]
    try:
        with open(path, "w", encoding="utf-8") as file:
            file.writelines(line + "\n" for line in lines)
    except OSError as e:
        raise InputError(f"labelmap write: cannot write {path}: {e.strerror}") from None
