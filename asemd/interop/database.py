"""``format="asemd-db"`` of ``ase.io``: databases and json files of ASE, with bonds, types and all arrays as their data."""
from __future__ import annotations

import os
from collections.abc import Iterator, Sequence

import numpy as np
from ase.db import connect

from asemd.atoms import OF_ASE, Atoms


def read_asemd_db(path: str | os.PathLike, index=-1) -> Iterator[Atoms]:
    """`asemd.Atoms` of rows that `write_asemd_db` or ``db.write(atoms, data=atoms.info)`` wrote; the data of a row is their `info`."""
    index = index if isinstance(index, slice) else slice(index, index + 1 or None)
    with connect(os.fspath(path)) as db:
        for id in [row.id for row in db.select(include_data=False)][index]:
            row = db.get(id=id)
            atoms = row.toatoms()
            data = dict(row.data)
            for name, array in data.pop("arrays", {}).items():
                atoms.set_array(name, np.asarray(array))
            atoms.info = data | ({"key_value_pairs": row.key_value_pairs} if row.key_value_pairs else {})
            yield Atoms(atoms)


def write_asemd_db(path: str | os.PathLike, images: Sequence, append: bool = False) -> None:
    """A row for each of some atoms, with energy and forces where they are known; without `append` in a new file."""
    with connect(os.fspath(path), append=append) as db:
        for atoms in images:
            info = dict(atoms.info)
            arrays = {name: array for name, array in atoms.arrays.items() if name not in OF_ASE}
            db.write(atoms, key_value_pairs=info.pop("key_value_pairs", {}), data=info | ({"arrays": arrays} if arrays else {}))
