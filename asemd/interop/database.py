"""``format="asemd-db"`` of ``ase.io``: databases and json files of ASE, with bonds, types and molecules as their data."""
from __future__ import annotations

import os
from collections.abc import Iterator, Sequence

from ase.db import connect

from asemd.atoms import Atoms


def read_asemd_db(path: str | os.PathLike, index=-1) -> Iterator[Atoms]:
    """`asemd.Atoms` of rows that `write_asemd_db` or ``db.write(atoms, data=atoms.info)`` wrote; the data of a row is their `info`."""
    index = index if isinstance(index, slice) else slice(index, index + 1 or None)
    with connect(os.fspath(path)) as db:
        for id in [row.id for row in db.select(include_data=False)][index]:
            row = db.get(id=id)
            atoms = row.toatoms()
            atoms.info = dict(row.data) | ({"key_value_pairs": row.key_value_pairs} if row.key_value_pairs else {})
            yield Atoms(atoms)


def write_asemd_db(path: str | os.PathLike, images: Sequence, append: bool = False) -> None:
    """A row for each of some atoms, with energy and forces where they are known; without `append` in a new file."""
    with connect(os.fspath(path), append=append) as db:
        for atoms in images:
            info = dict(atoms.info)
            db.write(atoms, key_value_pairs=info.pop("key_value_pairs", {}), data=info)
