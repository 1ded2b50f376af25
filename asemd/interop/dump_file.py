"""``format="asemd-dump"`` of ``ase.io``: LAMMPS's text dumps, with bonds and elements of the data file or script they belong to."""
from __future__ import annotations

import os
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice
from typing import Any

import numpy as np
from ase.calculators.singlepoint import SinglePointCalculator
from ase.data import chemical_symbols
from ase.symbols import symbols2numbers

from asemd import units as unit_styles
from asemd.atoms import Atoms, elements
from asemd.box import Box
from asemd.errors import InputError
from asemd.interop.data_file import with_elements
from asemd.lammps import read
from asemd.lammps.dump_read import Frame, frames

AXES = ("x", "y", "z")
TAKEN = {*AXES, *(a + s for a in AXES for s in ("s", "u", "su")), *("v" + a for a in AXES), *("f" + a for a in AXES),
         *("i" + a for a in AXES), "id", "type", "mol", "q", "element", "mass"}


def read_asemd_dump(path: str | os.PathLike, index=-1, data=None, units: str | None = None,
                    types: Mapping[str, int] | Sequence[str] | None = None) -> Iterator[Atoms]:
    """Snapshots of a text dump (also ``.gz``, ``.bz2``, ``.xz``), each in order of id.

    Parameters
    ----------
    path : path
    index : int or slice
        Which snapshots.
    data : path or ase.Atoms, optional
        Data file or script of the same atoms, or these atoms: bonds, elements, masses and what else the dump does not say are theirs.
        A snapshot may have some of the atoms only.
    units : str, optional
        Unit style of the dump; by default what it says itself, else that of `data`.
    types : sequence of str or mapping, optional
        Elements in the order of their types, or element -> type.

    Yields
    ------
    asemd.Atoms
        ``info["timestep"]``; forces, where the dump has them, as results; other columns of numbers as arrays.

    Raises
    ------
    InputError
        Errors of the files with their lines; units that nobody says; an atom that `data` does not have.
    """
    index = index if isinstance(index, slice) else slice(index, index + 1 or None)
    like, known = _like(data, units)
    for frame in chosen(frames(os.fspath(path), "native"), index):
        u = units or frame.units or known
        if not u:
            raise InputError(f"dump file {os.fspath(path)} does not say its units: give units=, as units='real'")
        yield _atoms(frame, like, u, types)


def chosen(found: Iterable, index: slice) -> Iterable:
    """Some of what comes one after the other; no more is kept than has to be."""
    ahead = all(k is None or k >= 0 for k in (index.start, index.stop, index.step))
    if ahead:
        return islice(found, index.start, index.stop, index.step)
    last = index.start is not None and index.start < 0 and (index.stop is None or index.stop < 0) and (index.step or 1) > 0
    return list(deque(found, -index.start if last else None))[index]


def _like(data, units: str | None) -> tuple[Atoms | None, str]:
    """The atoms that the dump is of, in order of id, and their unit style if that is known."""
    if data is None:
        return None, ""
    known = ""
    if isinstance(data, (str, os.PathLike)):
        lines = read.head(os.fspath(data))
        if read.is_data(lines):
            known = units or read.hint(lines[:1], r"units = (\w+)") or ""
            data = read.read(data, units=known or None)
        else:
            data = read.read(data)
    known = known or getattr(data.calc, "units", "")
    atoms = Atoms(data)
    atoms.calc = None
    if "id" not in atoms.arrays:
        atoms.set_array("id", np.arange(1, len(atoms) + 1))
    return atoms[np.argsort(atoms.arrays["id"], kind="stable")], "" if known == "ase" else known


def _atoms(frame: Frame, like: Atoms | None, units: str, types) -> Atoms:
    u = {name: unit_styles.factor(name, units) for name in ("distance", "velocity", "force", "charge", "mass")}
    n = len(frame.rows)
    ids = frame.column("id").astype(np.int64) if "id" in frame.columns else np.arange(1, n + 1)
    if "id" not in frame.columns and like is not None and n != len(like):
        raise InputError(f"dump file: step {frame.step} has no column id and {n} atoms, data has {len(like)}").at(frame.where)
    order = np.argsort(ids, kind="stable")
    columns = {name: frame.column(name)[order] for name in frame.columns if name != "element" and _numbers(frame, name)}
    kind = columns["type"].astype(np.int64) if "type" in columns else None
    if like is None:
        atoms = Atoms(numbers=_elements(frame, order, kind, columns.get("mass", np.full(n, np.nan)) * u["mass"], units))
        if "mass" in columns:
            atoms.set_masses(columns["mass"] * u["mass"])
    else:
        atoms = like[_rows(frame, ids[order], like.arrays["id"])]
    atoms.set_array("id", ids[order], int)
    for array, values in (("type", kind), ("mol-id", columns.get("mol"))):
        if values is not None:
            atoms.set_array(array, values.astype(np.int64))
    if types is not None:
        if "type" not in atoms.arrays:
            raise InputError("dump file: types say what element a type is, but there is no column type").at(frame.where)
        with_elements(atoms, types)
    _place(atoms, frame, columns, u["distance"])
    for prefix, take in (("v", lambda v: atoms.set_velocities(v * u["velocity"])),
                         ("f", lambda f: setattr(atoms, "calc", SinglePointCalculator(atoms, forces=f * u["force"])))):
        if all(prefix + a in columns for a in AXES):
            take(np.column_stack([columns[prefix + a] for a in AXES]))
    if "q" in columns:
        charges = columns["q"] * u["charge"]
        atoms.set_initial_charges(charges)
    for name in columns:
        if name not in TAKEN:
            atoms.set_array(name, columns[name])
    atoms.info["timestep"] = frame.step
    return atoms


def _numbers(frame: Frame, name: str) -> bool:
    """Whether a column that is not of LAMMPS's own names holds numbers."""
    if name in TAKEN or not frame.rows:
        return True
    try:
        float(frame.rows[0][frame.columns.index(name)])
    except ValueError:
        return False
    return True


def _elements(frame: Frame, order: np.ndarray, kind, masses: np.ndarray, units: str) -> Any:
    """Elements as the dump says them, else by masses, else X."""
    if "element" in frame.columns:
        k = frame.columns.index("element")
        names = [frame.rows[i][k] for i in order]
        return symbols2numbers([name if name in chemical_symbols else "X" for name in names])
    return elements(np.ones(len(order), int) if kind is None else kind, masses, {}, guess=units != "lj")


def _rows(frame: Frame, ids: np.ndarray, known: np.ndarray) -> np.ndarray:
    at = np.minimum(np.searchsorted(known, ids), max(len(known) - 1, 0))
    wrong = ids if not len(known) else ids[known[at] != ids]
    if len(wrong):
        raise InputError(f"dump file: step {frame.step} has atom {wrong[0]}, data does not").at(frame.where)
    return at


def _place(atoms: Atoms, frame: Frame, columns: dict[str, np.ndarray], length: float) -> None:
    """Cell, positions and image flags of a snapshot."""
    lo, hi, tilt = frame.corners()
    boundary = frame.boundary or ("pp", "pp", "pp")
    box = Box.from_lammps(lo, hi, tilt, boundary, bool(tilt.any()))
    suffix = next((s for s in ("", "s", "u", "su") if all(a + s in columns for a in AXES)), None)
    if suffix is None:
        raise InputError(f"dump file: there are no columns x y z (or xs, xu, xsu); there are {' '.join(frame.columns)}").at(frame.where)
    x = np.column_stack([columns[a + suffix] for a in AXES])
    x = lo + x @ box.cell if "s" in suffix else x
    atoms.set_cell(box.cell * length, scale_atoms=False)
    atoms.set_celldisp(lo * length)
    atoms.set_pbc(box.periodic)
    atoms.set_positions(x * length, apply_constraint=False)
    image = np.zeros((len(atoms), 3), np.int32)
    if all("i" + a in columns for a in AXES) and "u" not in suffix:
        image = np.column_stack([columns["i" + a] for a in AXES]).astype(np.int32)
    atoms.set_array("image", image)
