"""The system: atoms as plain arrays, their box and their topology."""
from __future__ import annotations

import copy
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING

import numpy as np

from asemd import units as unit_styles
from asemd.atom_style import UNITS, bonded, with_orientations
from asemd.box import Box
from asemd.errors import InputError, InputWarning
from asemd.late import late_arrays
from asemd.topology import KINDS, Topology, rows_of

if TYPE_CHECKING:
    from asemd.atoms import Atoms

COUNTS = ("ntypes", *(f"n{kind}types" for kind in KINDS), *(f"extra_{kind}_per_atom" for kind in (*KINDS, "special")))
LABELLED = ("atom", *KINDS)


def __getattr__(name: str):
    if name == "Atoms":           # ASE is imported only by those who use it
        from asemd.atoms import Atoms
        return Atoms
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


@late_arrays("x", "v", "f")       # within a run
@dataclass(eq=False)
class System:
    """Atoms in a fixed order (rows count from 0), in the units of one unit style.

    Parameters
    ----------
    box : Box
    x : (n, 3) float
        Positions, as the box holds them; ``box.unwrap(x, image)`` are the unwrapped ones.
    type : (n,) int32
        Atom types, counted from 1.
    id : (n,) int64, optional
        Atom ids; 1 to n if not given.
    image : (n, 3) int32, optional
    v, f : (n, 3) float, optional
        Velocities and forces.
    molecule : (n,) int64, optional
        Molecule ids, 0 for none.
    q : (n,) float, optional
        Charges; None if the atom style has none.
    mass : (ntypes + 1,) float, optional
        By type; nan: not set, entry 0 unused.
    rmass : (n,) float, optional
        Masses by atom; None: by type.
    topology : Topology, optional
    counts : dict, optional
        ``ntypes nbondtypes nangletypes ndihedraltypes nimpropertypes`` and ``extra_bond_per_atom`` ... ``extra_special_per_atom``; what is
        missing follows from the arrays.
    labels : dict, optional
        Type labels: kind (atom bond angle dihedral improper) -> {type: label}.
    units, atom_style, dimension, step, extra (further per-atom arrays (n, ...) by name)
    torn : list of (kind, type, ids)
        Bonded items that lost atoms but are still listed with those that stayed, the first of the ids of a bond, the second of others.
    rotation : (3, 3) float, optional
        For a general triclinic box, which LAMMPS turns into its own frame: ``x = (x_general - box.origin) @ rotation + box.origin``.
    """

    box: Box
    x: np.ndarray
    type: np.ndarray
    id: np.ndarray | None = None
    image: np.ndarray | None = None
    v: np.ndarray | None = None
    f: np.ndarray | None = None
    molecule: np.ndarray | None = None
    q: np.ndarray | None = None
    mass: np.ndarray | None = None
    rmass: np.ndarray | None = None
    topology: Topology = field(default_factory=Topology)
    counts: dict[str, int] = field(default_factory=dict)
    labels: dict[str, dict[int, str]] = field(default_factory=dict)
    units: str = "lj"
    atom_style: str = "atomic"
    dimension: int = 3
    step: int = 0
    extra: dict[str, np.ndarray] = field(default_factory=dict)
    rotation: np.ndarray | None = None
    torn: list = field(default_factory=list)

    def __post_init__(self):
        self.x = np.ascontiguousarray(self.x, float).reshape(-1, 3)
        n = len(self.x)
        self.type = np.array(np.broadcast_to(self.type, n), np.int32)
        self.id = np.arange(1, n + 1, dtype=np.int64) if self.id is None else np.array(self.id, np.int64)
        self.image = np.zeros((n, 3), np.int32) if self.image is None else np.array(self.image, np.int32)
        self.v, self.f = (np.zeros((n, 3)) if a is None else np.array(a, float) for a in (self.v, self.f))
        self.molecule = np.zeros(n, np.int64) if self.molecule is None else np.array(self.molecule, np.int64)
        self.q = None if self.q is None else np.array(np.broadcast_to(self.q, n), float)
        self.rmass = None if self.rmass is None else np.array(np.broadcast_to(self.rmass, n), float)
        largest = {"ntypes": self.type, **{f"n{kind}types": types for kind, _, types in self.topology}}
        self.counts = {name: int(np.max(largest[name], initial=0)) if name in largest else 0 for name in COUNTS} | self.counts
        if self.mass is None:
            self.mass = np.full(self.counts["ntypes"] + 1, np.nan)
        unset = max(0, self.counts["ntypes"] + 1 - len(self.mass))
        self.mass = np.concatenate([np.array(self.mass, float), np.full(unset, np.nan)])
        self.labels = {kind: dict(self.labels.get(kind, {})) for kind in LABELLED}
        for name in ("id", "image", "v", "f", "molecule", "q", "rmass"):
            a = getattr(self, name)
            if a is not None and len(a) != n:
                raise ValueError(f"{name} has {len(a)} rows, x has {n}")

    def __repr__(self) -> str:
        return f"System({self.n} atoms, {self.counts['ntypes']} types, {self.topology}, units {self.units}, atom_style {self.atom_style})"

    @property
    def n(self) -> int:
        """Number of atoms."""
        return len(self.id)

    @property
    def has_charge(self) -> bool:
        """True if the atoms have charges (which may be zero)."""
        return self.q is not None

    @property
    def molecular(self) -> bool:
        """True if the atom style has molecule ids and bonds."""
        return bool(bonded(self.atom_style)) or not self.topology.is_empty

    has_molecules = property(lambda self: self.molecular or bool(self.counts.get("molecules")), doc="True if the atoms have molecule ids.")

    def copy(self) -> System:
        return copy.deepcopy(self)

    def per_atom(self) -> dict[str, np.ndarray]:
        """Every per-atom array that exists, by name; those of `extra` too."""
        names = ("id", "type", "x", "image", "v", "f", "molecule", "q", "rmass")
        return {n: getattr(self, n) for n in names if getattr(self, n) is not None} | self.extra

    def _with(self, arrays: Mapping[str, np.ndarray], **other) -> System:
        """This system with other per-atom arrays."""
        own = {f.name for f in fields(self)}
        kept = {name: copy.deepcopy(getattr(self, name)) for name in own - {"extra"} - set(arrays) - set(other)}
        extra = {name: array for name, array in arrays.items() if name not in own}
        return System(**kept, **{name: array for name, array in arrays.items() if name in own}, extra=extra, **other)

    # ---- atoms
    def select(self, index) -> System:
        """The atoms of a slice, mask or list of rows, in that order; bonded items that lose an atom go."""
        rows = rows_of(index, self.n)
        return self._with({name: a[rows] for name, a in self.per_atom().items()}, topology=self.topology.select(rows, self.n))

    def append(self, other: System, keep_ids: bool = False) -> System:
        """This system with the atoms of another one behind, in this one's box.

        Parameters
        ----------
        other : System
            In the same units; per-atom arrays only one of the two has are zero in the other.
        keep_ids : bool
            By default ids and molecule ids of `other` are raised by the largest ones of this system; True keeps them.

        Raises
        ------
        InputError
            Different units, or an id that both have.
        """
        if other.units != self.units:
            raise InputError(f"cannot append a system in units {other.units} to one in units {self.units}")
        a, b = self.per_atom(), dict(other.per_atom())
        if not keep_ids:
            b["id"] = b["id"] + self.id.max(initial=0)
            b["molecule"] = np.where(b["molecule"] > 0, b["molecule"] + self.molecule.max(initial=0), 0)
        elif np.isin(other.id, self.id).any():
            raise InputError(f"atom ID {other.id[np.isin(other.id, self.id)][0]} exists in both systems")
        if "rmass" in a or "rmass" in b:
            a.setdefault("rmass", self.atom_masses())
            b.setdefault("rmass", other.atom_masses())
        joined = {}
        for name in [*a, *(k for k in b if k not in a)]:
            like = a.get(name, b.get(name))
            parts = [s.get(name, np.zeros((m, *like.shape[1:]), like.dtype)) for s, m in ((a, self.n), (b, other.n))]
            joined[name] = np.concatenate(parts)
        counts = {name: max(self.counts[name], other.counts.get(name, 0)) for name in self.counts}
        mass = np.full(counts["ntypes"] + 1, np.nan)
        for s in (other, self):
            known = np.isfinite(s.mass)
            mass[:len(s.mass)][known] = s.mass[known]
        labels = {kind: {**other.labels[kind], **self.labels[kind]} for kind in LABELLED}
        return self._with(joined, topology=self.topology.concatenate(other.topology.shift(self.n)), counts=counts, mass=mass, labels=labels)

    def replicate(self, nx: int, ny: int, nz: int, bond_periodic: bool = False) -> System:
        """Copies of the system side by side, as LAMMPS's replicate command makes them.

        Copy (i, j, k) has ids raised by ``(k * ny * nx + j * nx + i)`` times the largest id (molecule ids likewise); x runs fastest.
        Atoms are unwrapped by their image flags first, so that bonds across a periodic face reach the right copy.

        Parameters
        ----------
        nx, ny, nz : int
            Copies along a, b, c.
        bond_periodic : bool
            As LAMMPS's ``bond/periodic``: image flags are dropped and every bond connects nearest images, which is right also for
            molecules that close on themselves through the periodic box.

        Raises
        ------
        InputError
            Counts below 1, or copies along z of a 2d system.
        """
        times = np.array([nx, ny, nz])
        if (times < 1).any():
            raise InputError(f"replicate needs counts of at least 1, got {nx} {ny} {nz}")
        if self.dimension == 2 and nz != 1:
            raise InputError("a 2d system cannot be replicated in z: nz must be 1")
        box, copies = self.box.replicate(nx, ny, nz), int(times.prod())
        k, j, i = (a.ravel() for a in np.meshgrid(range(nz), range(ny), range(nx), indexing="ij"))
        shift = np.column_stack([i, j, k]) @ self.box.cell
        x = self.x.copy()
        if bond_periodic:
            self.box.wrap(x, np.zeros_like(self.image))
            top = self.topology.repeat_periodic(self.n, times[::-1], _reversed(self.box), x)
        else:
            self.check_images(stacklevel=3)
            x = self.box.unwrap(x, self.image)
            top = self.topology.repeat(self.n, copies)
        arrays = {name: np.tile(a, (copies, *(1,) * (a.ndim - 1))) for name, a in self.per_atom().items()}
        number = np.repeat(np.arange(copies), self.n)
        arrays["x"] = (x[None] + shift[:, None]).reshape(-1, 3)
        arrays["image"] = np.zeros((self.n * copies, 3), np.int32)
        arrays["id"] = arrays["id"] + number * self.id.max(initial=0)
        if self.molecular:
            m = arrays["molecule"]      # 0 means no molecule and stays
            arrays["molecule"] = np.where(m > 0, m + number * self.molecule.max(initial=0), 0)
        box.wrap(arrays["x"], arrays["image"])
        return self._with(arrays, box=box, topology=top)

    def atom_masses(self) -> np.ndarray:
        """(n,) masses; nan where none is set."""
        return self.rmass if self.rmass is not None else self.mass.take(self.type)

    def check_masses(self) -> None:
        """Make sure that every atom type has a mass.

        Raises
        ------
        InputError
            Names the types without one.
        """
        missing = [] if self.rmass is not None else np.flatnonzero(np.isnan(self.mass[1:])) + 1
        if len(missing):
            named = ", ".join(str(t) for t in missing[:10]) + (", ..." if len(missing) > 10 else "")
            raise InputError(f"no mass for atom type{'s' * (len(missing) > 1)} {named}: use the mass command or a Masses section")

    def index_of(self, ids) -> np.ndarray:
        """Rows of atom ids.

        Raises
        ------
        InputError
            An id that does not exist; says which do.
        """
        ids = np.atleast_1d(np.asarray(ids, np.int64))
        order = np.argsort(self.id, kind="stable")
        at = np.searchsorted(self.id, ids, sorter=order)
        rows = order[np.minimum(at, max(self.n - 1, 0))] if self.n else np.zeros(len(ids), np.int64)
        bad = self.id[rows] != ids if self.n else np.ones(len(ids), bool)
        if bad.any():
            raise InputError(f"atom ID {ids[bad][0]} does not exist ({id_range(self.id)})")
        return rows

    def image_conflicts(self) -> np.ndarray:
        """Rows of the bonds whose atoms the image flags put farther apart than half the periodic box."""
        bonds = self.topology.bonds
        if not len(bonds) or not self.box.periodic.any():
            return np.zeros(0, np.int64)
        x = self.box.unwrap(self.x, self.image)
        d = x[bonds[:, 1]] - x[bonds[:, 0]]
        s = d @ self.box.inverse
        return np.flatnonzero(((np.abs(s) > 0.5) & self.box.periodic).any(axis=1))

    def check_images(self, stacklevel: int = 2) -> None:
        """Warn (`asemd.errors.InputWarning`) if image flags tear bonds apart."""
        bad = self.image_conflicts()
        if len(bad):
            i, j = self.topology.bonds[bad[0]]
            x = self.box.unwrap(self.x[[i, j]], self.image[[i, j]])
            apart = float(np.linalg.norm(x[1] - x[0]))
            more = f" and {len(bad) - 1} more" if len(bad) > 1 else ""
            warnings.warn(f"inconsistent image flags: bond {bad[0] + 1} (atoms {self.id[i]}-{self.id[j]}){more}: image flags put the atoms "
                          f"{apart:g} apart, more than half the box", InputWarning, stacklevel=stacklevel + 1)

    # ---- ASE
    @classmethod
    def from_ase(cls, atoms, types: Sequence[str] | None = None, units: str = "ase", like: System | None = None) -> System:
        """A system from ``ase.Atoms``; rows keep their order.

        Parameters
        ----------
        atoms : ase.Atoms
            Its arrays ``id``, ``type``, ``mol-id``, ``image``, ``initial_charges``, ``masses``, ``momenta``, ``mu`` (dipoles),
            ``radius``, ``omega`` (spheres), ``shape``, ``quaternions``, ``angmom`` (diameters, orientations w i j k and angular momenta of
            ellipsoids; shape 0 is a point) and its ``topology`` (see `asemd.atoms.Atoms`) are used where they exist.
        types : sequence of str, optional
            Chemical symbols in the order of type numbers. By default the array ``type`` gives the numbers, or else the sorted symbols.
        units : str
            Unit style of the system; numbers are converted from ASE's.
        like : System, optional
            Where atom style, dimension, labels and numbers of types come from.

        Raises
        ------
        InputError
            A symbol that is not among `types`, ids that are not unique, a periodic direction without cell vector.
        """
        u = {d: unit_styles.factor(d, units) for d in ("distance", "mass", "velocity", "charge")}
        x, arrays, labels = atoms.get_positions() / u["distance"], atoms.arrays, {}
        symbols = atoms.get_chemical_symbols()
        if types is None and "type" in arrays:
            number = np.array(arrays["type"], np.int32)
            if number.min(initial=1) < 1:       # ASE's append and extend fill up with zeros
                raise InputError(f"atoms[{number.argmin()}] has the type {number.min()}: set atoms.arrays['type'], types count from 1")
            for t, s in zip(number, symbols):
                labels.setdefault(int(t), s)
            labels = labels if len(set(labels.values())) == len(labels) else {}
        else:
            types = sorted(set(symbols)) if types is None else list(types)
            if unknown := sorted(set(symbols) - set(types)):
                raise InputError(f"element {unknown[0]} is not among the types {' '.join(types)}")
            labels = {t: s for t, s in enumerate(types, 1)}
            number = np.array([types.index(s) + 1 for s in symbols], np.int32)
        top = getattr(atoms, "topology", None)
        ids = arrays.get("id")
        if ids is not None and len(np.unique(ids)) != len(ids):
            raise InputError("atoms.arrays['id'] has an id twice")
        box = Box.from_ase(np.asarray(atoms.cell) / u["distance"], atoms.pbc, np.ravel(atoms.get_celldisp()) / u["distance"], x)
        counts = dict(like.counts) if like is not None else {}
        counts["ntypes"] = int(max(counts.get("ntypes", 0), len(labels) if types is not None else 0, number.max(initial=0)))
        atom_mass = atoms.get_masses() / u["mass"]
        mass = np.full(counts["ntypes"] + 1, np.nan)
        if like is not None:
            mass[:len(like.mass)] = like.mass
        mass[number[::-1]] = atom_mass[::-1]
        momenta = arrays.get("momenta")
        system = cls(box=box, x=x, type=number, id=ids, image=arrays.get("image"), units=units, mass=mass, counts=counts,
                     v=None if momenta is None else atoms.get_velocities() / u["velocity"], molecule=arrays.get("mol-id"),
                     q=arrays["initial_charges"] / u["charge"] if "initial_charges" in arrays else None,
                     rmass=None if np.array_equal(mass[number], atom_mass) else atom_mass,
                     extra={name: arrays[name] / unit_styles.factor(d, units) for name, d in UNITS.items() if name in arrays},
                     topology=Topology() if top is None else top.copy(), labels=like.labels if like is not None else {"atom": labels},
                     dimension=like.dimension if like is not None else 3)
        bonded = not system.topology.is_empty
        system.atom_style = like.atom_style if like is not None else {
            (False, False): "atomic", (False, True): "charge", (True, False): "molecular", (True, True): "full"}[bonded, system.has_charge]
        if "shape" in system.extra:
            system.extra, system.rmass = with_orientations(system.extra), atom_mass
            if like is None:
                system.atom_style = "ellipsoid" if system.atom_style == "atomic" else f"hybrid {system.atom_style} ellipsoid"
        box.wrap(system.x, system.image)
        return system

    def to_ase(self) -> Atoms:
        """`asemd.atoms.Atoms` in ASE's units, rows in the same order.

        Positions are those of `x`, with the image flags in the array ``image``; further arrays are those that `from_ase` takes, and where
        atoms turn ``torque``. The origin of the box becomes celldisp. Elements come from type labels, else from masses, else X.
        """
        from asemd.atoms import Atoms, elements
        u = {d: unit_styles.factor(d, self.units) for d in ("distance", "mass", "velocity", "charge")}
        masses = self.atom_masses() * u["mass"]
        numbers = elements(self.type, masses, self.labels["atom"], guess=self.units != "lj")
        extra = {name: a * unit_styles.factor(UNITS.get(name, ""), self.units) for name, a in self.extra.items()}
        atoms = Atoms(numbers=numbers, positions=self.x * u["distance"], cell=self.box.cell * u["distance"], pbc=self.box.periodic,
                      celldisp=self.box.origin * u["distance"], topology=self.topology.copy())
        if np.isfinite(masses).all():
            atoms.set_masses(masses)
        for name, array in (("id", self.id), ("type", self.type), ("mol-id", self.molecule), ("image", self.image), *extra.items()):
            atoms.set_array(name, array)
        if self.q is not None:
            atoms.set_initial_charges(self.q * u["charge"])
        if self.v.any():
            atoms.set_velocities(self.v * u["velocity"])
        return atoms


def id_range(ids: np.ndarray) -> str:
    """``file has IDs 1-4``, in words that fit into a message."""
    ids = np.sort(ids)
    if not len(ids):
        return "there are no atoms"
    gaps = "" if ids[-1] - ids[0] + 1 == len(ids) else ", with gaps"
    return f"file has IDs {ids[0]}-{ids[-1]}{gaps}"


def _reversed(box: Box) -> Box:
    """The box with its vectors in the order c, b, a, so that copies along a are numbered fastest."""
    return Box(box.origin, box.cell[::-1], box.boundary[::-1])
