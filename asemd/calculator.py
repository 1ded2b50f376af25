"""The force field as an ASE calculator: converts units once, keeps its engine while only positions change."""
from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from ase.calculators.calculator import Calculator, all_changes

from asemd import units as unit_styles
from asemd.engine import Engine, Settings
from asemd.errors import InputError
from asemd.forcefield import Interactions
from asemd.system import System
from asemd.topology import Topology

VOIGT = [0, 1, 2, 5, 4, 3]      # LAMMPS xx yy zz xy xz yz -> ASE xx yy zz yz xz xy


class ForceField(Calculator):
    """A LAMMPS force field for ``ase.Atoms``.

    Parameters
    ----------
    bond, angle, dihedral, improper, pair : mapping, optional
        Style -> coefficients by type, in ASE units (eV, Angstrom; angles in degrees), as `asemd.forcefield.Interactions.build` takes them:
        ``bond={"harmonic": {1: (10.0, 1.1)}}``, ``pair={"lj/cut 8.5": {(1, 1): (0.0104, 3.4)}}``. Types are numbers or labels (elements).
    topology : Topology, optional
        Bonds, angles, ... of atoms that do not carry a topology of their own (`asemd.Atoms` do, and keep it when they are sliced).
    special_bonds : optional
        Weights of 1-2, 1-3, 1-4 pairs: three numbers, or a mapping with ``lj`` and ``coul``.
    skin : float, optional
        Extra distance of the neighbour list, Angstrom.
    threads : int
    precision : str
        ``double`` or ``mixed``.
    shift, tail, mix
        As in ``pair_modify``.

    Notes
    -----
    Energies are totals in eV (``units lj`` numbers pass unchanged). `stress` is ASE's: positive under tension, order xx yy zz yz xz xy; it
    exists if the cell has three vectors. `energies` and `stresses` are LAMMPS's shares of each atom (equal parts of every term).
    """

    implemented_properties = ["energy", "free_energy", "forces", "stress", "energies", "stresses"]
    nolabel = True

    def __init__(self, bond: Mapping | None = None, angle: Mapping | None = None, dihedral: Mapping | None = None,
                 improper: Mapping | None = None, pair: Mapping | None = None, *, topology: Topology | None = None, special_bonds=None,
                 shift: bool = False, tail: bool = False, mix: str | None = None, dielectric: float = 1.0, skin: float = 2.0,
                 threads: int = 1, precision: str = "double"):
        super().__init__()
        if precision not in ("double", "mixed"):
            raise InputError(f"precision must be double or mixed, got {precision!r}")
        self.arguments = dict(bond=bond or {}, angle=angle or {}, dihedral=dihedral or {}, improper=improper or {}, pair=pair or {},
                              special_bonds=special_bonds, shift=shift, tail=tail, mix=mix, dielectric=dielectric)
        self.interactions: Interactions | None = None
        self.topology = topology
        self.units = "ase"
        self.like: System | None = None
        self.settings = Settings(skin=skin, threads=threads, precision=precision)
        self._engine: Engine | None = None
        self._seen: tuple = ()

    @classmethod
    def from_scene(cls, scene) -> ForceField:
        """The calculator of a scene that a script has built."""
        self = cls(skin=scene.neighbor.skin if hasattr(scene, "neighbor") else 2.0)
        self.arguments = {}
        self.interactions, self.units = copy.deepcopy(scene.interactions), scene.system.units
        self.topology, self.like = scene.system.topology, scene.system.select(slice(0, 0))
        self.settings = replace(scene.neighbor, exclude=[e for e in scene.neighbor.exclude if e[0] == "type"], threads=scene.threads,
                                precision=scene.precision)
        return self

    def __getstate__(self):
        return {**self.__dict__, "_engine": None, "_seen": ()}

    def __deepcopy__(self, memo):
        new = object.__new__(type(self))
        memo[id(self)] = new
        for name, value in self.__getstate__().items():
            setattr(new, name, copy.deepcopy(value, memo))
        return new

    def copy(self) -> ForceField:
        """An independent calculator with the same force field."""
        return copy.deepcopy(self)

    def todict(self, skip_default: bool = True) -> dict:
        """The arguments, JSON-able."""
        return {k: v for k, v in self.arguments.items() if v} | {"skin": self.settings.skin, "precision": self.settings.precision}

    # ---- engine -------------------------------------------------------------------------------------------------------------------------
    def _system(self, atoms) -> System:
        system = System.from_ase(atoms, units=self.units, like=self.like)
        if getattr(atoms, "topology", None) is None and self.topology is not None:
            largest = max((int(items.max()) for _, items, _ in self.topology if len(items)), default=-1)
            if largest >= len(atoms):
                raise InputError(f"the topology names atom {largest}, but there are {len(atoms)} atoms: use asemd.Atoms, whose topology "
                                 "follows slices and copies, or hand a new topology to the calculator")
            system.topology = self.topology
        if self.interactions is None:
            self.interactions = Interactions.build(**self.arguments, labels=system.labels)
        for kind, n in self._type_counts().items():
            system.counts[kind] = max(system.counts.get(kind, 0), n)
        missing = system.counts["ntypes"] + 1 - len(system.mass)
        if missing > 0:
            system.mass = np.concatenate([system.mass, np.full(missing, np.nan)])
        return system

    def _type_counts(self) -> dict[str, int]:
        out = {}
        for category, uses in self.interactions.uses.items():
            for use in uses:
                keys = [k if isinstance(k, int) else max(k) for k in use.coeff]
                name = "ntypes" if category == "pair" else f"n{category}types"
                out[name] = max([out.get(name, 0), *keys])
        return out

    def _prepare(self, atoms) -> None:
        """An engine that fits the atoms; made anew when anything but positions changed."""
        top = getattr(atoms, "topology", None) or self.topology
        seen = (atoms.numbers.tobytes(), atoms.arrays.get("type", atoms.numbers).tobytes(), atoms.cell.array.tobytes(), atoms.pbc.tobytes(),
                np.asarray(atoms.get_celldisp()).tobytes(), atoms.get_initial_charges().tobytes(), id(top), top)
        same = self._engine is not None and len(seen) == len(self._seen) and all(
            a is b if k == 7 else a == b for k, (a, b) in enumerate(zip(seen, self._seen)))
        if same:
            return
        system = self._system(atoms)
        self.interactions.check_complete(system)
        if self._engine is None:
            self._engine = Engine(system, self.interactions, self.settings)
        else:
            self._engine.update(system)
        self._seen = seen

    @property
    def engine(self) -> Engine | None:
        """The compiled engine of the last evaluation."""
        return self._engine

    # ---- ASE ----------------------------------------------------------------------------------------------------------------------------
    def calculate(self, atoms=None, properties=None, system_changes=all_changes):
        super().calculate(atoms, properties, system_changes)
        properties = properties or ["energy"]
        self._prepare(self.atoms)
        e, u = self._engine, {d: unit_styles.factor(d, self.units) for d in ("distance", "energy", "force")}
        e.move(self.atoms.positions / u["distance"])
        result = e.collect()
        energy = result.potential * u["energy"]
        self.results = {"energy": energy, "free_energy": energy, "forces": result.forces * u["force"]}
        volume = self.atoms.get_volume() if self.atoms.cell.rank == 3 else None
        virial = result.virial + result.virial_of.get("tail", 0.0)
        if volume:
            self.results["stress"] = -virial[VOIGT] * u["energy"] / volume
        if "energies" in properties or "stresses" in properties:
            e.per_atom(result)
            self.results["energies"] = result.energies * u["energy"] + result.energy["etail"] * u["energy"] / len(self.atoms)
            if volume:
                tail = result.virial_of.get("tail", np.zeros(6)) / len(self.atoms)
                self.results["stresses"] = -(result.virials + tail)[:, VOIGT] * u["energy"] / volume

    def __repr__(self) -> str:
        if self.interactions is None:
            parts = [f"{k}: {', '.join(v)}" for k, v in self.arguments.items() if isinstance(v, Mapping) and v]
        else:
            parts = [f"{k}: {', '.join(use.style.name for use in uses)}" for k, uses in self.interactions.uses.items() if uses]
        return f"ForceField({'; '.join(parts) or 'no styles'}; units {self.units})"
