"""``ndx2group file group-ID ...``: groups from an index file of GROMACS; none named: all of the file but ``System``.

Source: LAMMPS manual, ndx2group.
"""
from __future__ import annotations

import re

import numpy as np

from asemd.errors import InputError, Where, nearest
from asemd.words import take, whole


def run(session, args):
    scene = session.scene
    system = scene.need_system("ndx2group")
    scene.sync_groups()
    path = take(args, 1, "ndx2group")[0]
    sections = _read(path)
    session.print(f"Reading groups from index file {path}:")
    for name in args[1:] or [n for n in sections if n != "System"]:
        if name not in sections:
            raise InputError(f"ndx2group: {path} has no group {name}{nearest(name, sections)}")
        session.print(f" Processing group '{name}'")
        old = scene.groups[name] if name in scene.groups else np.zeros(system.n, bool)
        scene.groups[name] = old | np.isin(system.id, sections[name])


def _read(path: str) -> dict[str, list[int]]:
    """Atom ids by section."""
    sections: dict[str, list[int]] = {}
    ids = None
    try:
        with open(path, encoding="utf-8-sig") as f:
            for k, line in enumerate(f, 1):
                where = Where(path, k, line.strip())
                text = line.partition(";")[0].strip()
                title = re.fullmatch(r"\[\s*(\S.*?)\s*\]", text)
                if title:
                    ids = sections.setdefault(title[1], [])
                elif text:
                    if ids is None:
                        raise InputError("ndx2group: atoms before the first [ group ]", where)
                    try:
                        ids += [whole(word, "ndx2group: atom id") for word in text.split()]
                    except InputError as e:
                        raise e.at(where) from None
    except OSError as e:
        raise InputError(f"ndx2group: cannot open {path}: {e.strerror}") from None
    except UnicodeDecodeError:
        raise InputError(f"ndx2group: {path} is not a text file") from None
    return sections
