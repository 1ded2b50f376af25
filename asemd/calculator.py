"""The force field as an ASE calculator: converts units once, keeps its engine and neighbour list while only positions change."""
from __future__ import annotations

import copy
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from ase.calculators.calculator import (
    Calculator,
    PropertyNotImplementedError,
    all_changes,
    external_calculators,
    register_calculator_class,
)

from asemd import recipe
from asemd import units as unit_styles
from asemd.atoms import Atoms, holds
from asemd.engine import Engine, Result, Settings
from asemd.errors import InputError, InputWarning
from asemd.forcefield import Interactions
from asemd.kspace import hold, tell_charge
from asemd.loads import Field, Load, Maps, Potential, constraints_of, loads_of, together
from asemd.native import by_elements, check_numbers, types_by_element, with_keys
from asemd.result import with_masks
from asemd.seen import GROUPS, check_finite, same, topology_of, turns_as_virials, typed, uses_charges, view
from asemd.system import System
from asemd.topology import Topology

VOIGT = [0, 1, 2, 5, 4, 3]      # LAMMPS xx yy zz xy xz yz -> ASE xx yy zz yz xz xy
BONDED = ("bond", "angle", "dihedral", "improper")


class ForceField(Calculator):
    """A LAMMPS force field for ``ase.Atoms``.

    Parameters
    ----------
    bond, angle, dihedral, improper, pair : mapping, optional
        Style -> coefficients by type, in ASE units (eV, Angstrom; angles in degrees), as `asemd.forcefield.Interactions.build` takes them:
        ``bond={"harmonic": {1: (10.0, 1.1)}}``, ``pair={"lj/cut 8.5": {("Ar", "Ar"): (0.0104, 3.4)}}``. Atom types are elements, or
        numbers: those of the array ``type`` if the atoms have one, else of the elements in alphabetical order.
    topology : Topology, optional
        Bonds, angles, ... of atoms that do not carry a topology of their own (`asemd.Atoms` do, and keep it when they are sliced).
    special_bonds : optional
        Weights of 1-2, 1-3, 1-4 pairs: words of the command, or a mapping with ``lj`` and ``coul``, three numbers each.
    skin : float, optional
        Extra distance of the neighbour list, Angstrom.
    threads : int
    precision : str
        ``double`` or ``mixed``.
    shift, tail, mix, dielectric, compat, kspace, kspace_modify
        As in LAMMPS's commands (``kspace="pppm 1e-4"``); ``compat="lammps"``: its tables of charges, and its forces also
        where they are no gradient of its energy.
    commands : str or sequence of str, optional
        In the place of all these: styles and coefficients as LAMMPS commands, whose numbers are in the unit style `units`.
    types : sequence of str, mapping or int, optional
        Elements in the order of their atom types, or element -> type, for atoms without the array ``type``; or how many there are.

    Raises
    ------
    InputError
        At the first evaluation too: coefficients or charges that are missing, a topology that does not fit the atoms.

    Notes
    -----
    Energies are totals in eV (``units lj`` numbers pass unchanged). `stress` is ASE's: positive under tension, order xx yy zz yz xz xy; it
    exists if the cell has three vectors. `energies` and `stresses` are LAMMPS's shares of each atom (equal parts of every term).
    """

    name = "asemd"
    implemented_properties = ["energy", "free_energy", "forces", "stress", "energies", "stresses"]
    nolabel = True

    def __init__(self, bond: Mapping | None = None, angle: Mapping | None = None, dihedral: Mapping | None = None,
                 improper: Mapping | None = None, pair: Mapping | None = None, *, topology: Topology | Mapping | None = None,
                 special_bonds=None, shift: bool = False, tail: bool = False, mix: str | None = None, dielectric: float = 1.0,
                 compat: str = "", kspace: str = "", kspace_modify: str = "", skin: float = 2.0, threads: int = 1, precision="double",
                 commands: str | Sequence[str] | None = None, units: str = "", types: Mapping | Sequence[str] | int | None = None,
                 from_script: Sequence[str] = ()):
        super().__init__()
        if from_script:
            raise InputError(f"{from_script[0]} comes from a script: make this calculator with asemd.read of that script")
        for name, value, known in (("precision", precision, ("double", "mixed")), ("compat", compat, ("lammps", ""))):
            if value not in known:
                raise InputError(f"{name} must be {' or '.join(known) if all(known) else 'lammps or nothing'}, got {value!r}")
        check_numbers(skin, threads, dielectric)
        given = dict(bond=bond, angle=angle, dihedral=dihedral, improper=improper, pair=pair)
        self.arguments = {category: with_keys(styles or {}) for category, styles in given.items()} | dict(
            special_bonds=special_bonds, shift=shift, tail=tail, mix=mix, dielectric=dielectric, compat=compat, kspace=kspace,
            kspace_modify=kspace_modify)
        self.interactions: Interactions | None = None
        self.topology = Topology(**topology) if isinstance(topology, Mapping) else topology
        self.natoms = 0                          # atoms that `topology` is for, once known
        self.types: list[str] = []               # elements in the order of their types
        self.units = "ase"
        self.like: System | None = None
        self.settings = Settings(skin=skin, threads=threads, precision=precision)
        self.bits: dict[str, int] = {}           # group -> bit in the atoms' array "groups"
        self.loads: list[Load | Field | Potential | Maps] = []
        self.left_out: list[str] = []
        self.scripted = False                    # made by `from_scene`
        self._engine: Engine | None = None
        self._seen: dict[str, np.ndarray | None] = {}
        self._seen_topology: Topology | None = None
        self.type_of, ntypes = recipe.numbers_of(types)
        if commands is not None:
            if given := [name for name, value in self.arguments.items() if value and value != 1.0 and name != "compat"]:
                raise InputError(f"{given[0]} cannot be given beside commands: write it as a command")
            recipe.take_commands(self, commands, units, ntypes, compat)
        elif units:
            raise InputError("units are for commands: other arguments are in ASE's units")

    # ---- from a script ------------------------------------------------------------------------------------------------------------------
    @classmethod
    def from_scene(cls, scene) -> ForceField:
        """The calculator of a scene that a script has built; `attach` also gives the atoms what it needs.

        Forces of fixes that are functions of positions (`asemd.loads`) are part of it; others are listed in `left_out`.
        """
        self = cls(threads=scene.threads, precision=scene.precision)
        self.arguments, self.interactions, self.units = {}, copy.deepcopy(scene.interactions), scene.system.units
        self.topology, self.like = scene.system.topology.copy(), scene.system.select(slice(0, 0))
        self.natoms, self.scripted = scene.system.n, True
        self.settings = replace(scene.neighbor, threads=scene.threads, precision=scene.precision)
        self.loads, self.left_out = loads_of(scene.fixes.values(), scene.system.n)
        names = {w for kind, *words in self.settings.exclude if kind != "type" for w in words}
        names |= {name for load in self.loads for name in load.groups}
        self.bits = {name: 1 << k for k, name in enumerate(sorted(names - {"all"}))}
        return self

    @classmethod
    def attach(cls, scene, atoms) -> ForceField:
        """Make the calculator of a scene and give it to the scene's atoms, with group bits and constraints (``fix setforce``)."""
        self = cls.from_scene(scene)
        if self.bits:
            bits = sum((scene.groups.mask(name).astype(np.int32) * bit for name, bit in self.bits.items()), np.zeros(len(atoms), np.int32))
            atoms.set_array(GROUPS, bits)
        constraints, left_out = constraints_of(scene.fixes.values(), scene.groups)
        atoms.set_constraint(constraints)
        self.left_out += left_out
        for text in self.left_out:
            warnings.warn(f"{text} is not part of the calculator", InputWarning, stacklevel=3)
        atoms.calc = self
        return self

    # ---- copies -------------------------------------------------------------------------------------------------------------------------
    def __getstate__(self):
        return {**self.__dict__, "_engine": None, "_seen": {}, "_seen_topology": None}

    def __deepcopy__(self, memo):
        new = object.__new__(type(self))
        memo[id(self)] = new
        for name, value in self.__getstate__().items():
            setattr(new, name, copy.deepcopy(value, memo))
        return new

    def copy(self) -> ForceField:
        """An independent calculator with the same force field."""
        return copy.deepcopy(self)

    def set(self, **kwargs):
        if kwargs:
            raise InputError(f"a ForceField cannot be changed ({', '.join(kwargs)}): make a new one")
        return {}

    def reset(self) -> None:
        """Forget the last evaluation."""
        self.atoms, self.results, self._seen = None, {}, {}

    def todict(self, skip_default: bool = True) -> dict:
        """The arguments, JSON-able; of a script's force field the commands that make it."""
        return recipe.as_dict(self)

    def commands(self) -> list[str]:
        """The force field as LAMMPS commands, in its own units."""
        return recipe.commands_of(self)

    def with_types(self, types: Mapping[str, int] | Sequence[str]) -> ForceField:
        """A copy that also takes atoms without the array ``type``: their types go by elements, `types` as in `ForceField`."""
        new = self.copy()
        new.type_of, _ = recipe.numbers_of(types)
        return new

    # ---- atoms -> system ----------------------------------------------------------------------------------------------------------------
    def _topology_of(self, atoms) -> Topology:
        made = self.interactions.uses if self.interactions else {}
        return topology_of(self, atoms, [c for c in BONDED if self.topology is None and (self.arguments.get(c) or made.get(c))])

    def _system(self, atoms) -> System:
        """The atoms in the units of the force field."""
        if getattr(atoms, "topology", None) is None and self.topology is None and holds(atoms.info):     # read from a file
            atoms = Atoms(atoms)
        atoms, types = typed(atoms, self.type_of), None
        check_finite(atoms)
        if "type" not in atoms.arrays:
            if self.like is not None:
                raise InputError("the atoms have no array 'type': a force field from a script goes by atom types, not by elements; use "
                                 "atoms that asemd.read gave, atoms.set_array('type', ...), types=['C', ...] or calc.with_types(['C'])")
            types = types_by_element(self.arguments["pair"], self.types, atoms)
        system = System.from_ase(atoms, types=types, units=self.units, like=self.like)
        system.topology = self._topology_of(atoms)
        if self.type_of and self.like is None:
            system.labels["atom"] = {number: symbol for symbol, number in self.type_of.items()}
        if self.interactions is None:
            self.interactions = Interactions.build(**self.arguments, labels=system.labels)
        if self.interactions.kspace != "none" and {"slab", "wire"} & set(self.interactions.kspace_modify):
            hold(system, atoms.cell)
        for use in self.interactions.uses["pair"]:
            if use.style.variant(use.settings).charged and system.q is None:
                raise InputError(f"pair style {use.style.name} needs charges: atoms.set_initial_charges(...)")
        for kind, n in recipe.type_counts(self.interactions, system.topology).items():
            system.counts[kind] = max(system.counts.get(kind, 0), n)
        missing = system.counts["ntypes"] + 1 - len(system.mass)
        if missing > 0:
            system.mass = np.concatenate([system.mass, np.full(missing, np.nan)])
        self.types = types or self.types
        return system

    def mask(self, atoms, group: str) -> np.ndarray:
        """(n,) bool: the atoms of a group that the force field knows.

        Raises
        ------
        InputError
            The atoms have lost the array ``groups``.
        """
        if group == "all":
            return np.ones(len(atoms), bool)
        if GROUPS not in atoms.arrays:
            raise InputError(f"the atoms have no array '{GROUPS}', which says who belongs to group {group}")
        return (atoms.arrays[GROUPS] & self.bits[group]) != 0

    def neighbor_settings(self, atoms) -> Settings:
        """The settings of engines for these atoms, exclusions with masks instead of group names."""
        return replace(self.settings, exclude=with_masks(self.settings.exclude, lambda group: self.mask(atoms, group)))

    @property
    def engine(self) -> Engine | None:
        """The compiled engine of the last evaluation."""
        return self._engine

    # ---- what has changed ---------------------------------------------------------------------------------------------------------------
    def _view(self, atoms) -> dict[str, np.ndarray | None]:
        masses = {"masses": atoms.arrays.get("masses")} if self.loads else {}       # springs share their force by mass
        return view(atoms, uses_charges(self.interactions, self.loads)) | masses

    def check_state(self, atoms, tol: float = 0.0) -> list[str]:
        """Names of what is not as it was at the last evaluation; besides ASE's: type, origin, image, groups, topology."""
        if not self._seen:
            return list(all_changes)
        changes = [name for name, array in self._view(atoms).items() if not same(array, self._seen[name])]
        topology = self.topology if (own := getattr(atoms, "topology", None)) is None else own
        return changes if topology == self._seen_topology else [*changes, "topology"]

    def get_property(self, name, atoms=None, allow_calculation=True):
        if name not in self.implemented_properties:
            raise PropertyNotImplementedError(f"{name} property not implemented")
        changes = [] if atoms is None else self.check_state(atoms)
        if changes:
            self.results = {}
        if name not in self.results:
            if not allow_calculation:
                return None
            self.calculate(self.atoms if atoms is None else atoms, [name], changes)
        if name not in self.results:
            raise PropertyNotImplementedError(f"{name} not present in this calculation: the cell has no volume")
        result = self.results[name]
        return result.copy() if isinstance(result, np.ndarray) else result

    def _prepare(self, atoms, changes: list[str]) -> None:
        """An engine that fits the atoms; updated when anything but positions changed."""
        if self._engine is not None and not set(changes) - {"positions", "image"}:
            return
        self._seen = {}
        known = list(self.types)
        system = self._system(atoms)
        try:
            self.interactions.check_complete(system)
        except InputError as e:
            told, self.types = by_elements(e, self.types, self.arguments.get("pair")), known
            raise told from None
        settings = self.neighbor_settings(atoms) if self.settings.exclude else self.settings
        if self._engine is None:
            self._engine = Engine(system, self.interactions, settings)
        else:
            self._engine.settings = settings
            self._engine.update(system)
        tell_charge(self._engine.solver)

    # ---- ASE ----------------------------------------------------------------------------------------------------------------------------
    def calculate(self, atoms=None, properties=None, system_changes=all_changes):
        atoms = self.atoms if atoms is None else atoms
        if atoms is None:
            raise InputError("this calculator has no atoms yet: give them, as in calc.get_potential_energy(atoms), or set atoms.calc")
        self.results = {}
        if not self._seen:
            system_changes = all_changes
        try:
            self._prepare(atoms, system_changes)
            distance = unit_styles.factor("distance", self.units)
            self._engine.move(atoms.positions if distance == 1.0 else atoms.positions / distance)
            result = self._engine.collect()
            if properties and ("energies" in properties or "stresses" in properties):
                self._engine.per_atom(result)
            self.results = self.convert(result, atoms, self._engine.system)
        except Exception:
            self._seen = {}
            raise
        self._remember(atoms, system_changes)

    def get_atomic_volumes(self) -> np.ndarray:
        """(n,) volumes that ASE refers the kinetic part of `stresses` to: that of the cell, whose shares they are."""
        return np.full(len(self.atoms), self.atoms.cell.volume)

    def get_hessian(self, atoms=None, numerical: bool = False):
        """Second derivatives of the energy, a sparse matrix (3 n, 3 n) in eV/Angstrom^2: see `asemd.hessian.of_calculator`."""
        from asemd.hessian import of_calculator
        return of_calculator(self, self.atoms if atoms is None else atoms, numerical)

    def get_elastic_constants(self, atoms=None, relaxed: bool = True, numerical: bool = False) -> np.ndarray:
        """Elastic constants (6, 6), xx yy zz yz xz xy, in eV/Angstrom^3: see `asemd.elastic.elastic_constants`."""
        from asemd.elastic import elastic_constants
        return elastic_constants(self, self.atoms if atoms is None else atoms, relaxed, numerical)

    def adopt(self, atoms, results: dict[str, Any]) -> None:
        """Take over results that the time loop has found for the atoms as they are now."""
        changes = self.check_state(atoms)
        if set(changes) - {"positions", "image"}:
            self._engine = None
        self.results = results
        self._remember(atoms, changes)

    def _remember(self, atoms, changes) -> None:
        """Keep what the results belong to."""
        if self._seen and self.atoms is not None and set(changes) <= {"positions"}:
            self._seen["positions"][:] = atoms.positions
            self.atoms.positions[:] = atoms.positions
            return
        self.atoms = atoms.copy()
        self._seen = {name: None if array is None else array.copy() for name, array in self._view(atoms).items()}
        topology = self.topology if (own := getattr(atoms, "topology", None)) is None else own
        self._seen_topology = None if topology is None else topology.copy()

    def convert(self, result: Result, atoms, system: System, of_loop: bool = False) -> dict[str, Any]:
        """A result of an engine for these atoms as ASE's properties, with the forces of fixes added.

        Parameters
        ----------
        result : Result
            In the units of the force field, without the loads.
        atoms, system : ase.Atoms, System
        of_loop : bool
            The loads acted as fixes when the result was made, and its virial has what they count there.

        Returns
        -------
        dict
            energy, free_energy, forces; stress if the cell has a volume; energies and stresses if the result has them.
        """
        u = {d: unit_styles.factor(d, self.units) for d in ("energy", "force", "distance")}
        energy, forces = result.potential, result.forces
        virial = result.virial + result.virial_of.get("tail", 0.0)
        shares, strains = np.zeros(len(atoms)), np.zeros((len(atoms), 6))
        if self.loads:
            shares, added, strains, of_fixes = together(self.loads, atoms, system, u["distance"], self.mask)
            energy, forces = energy + float(shares.sum()), forces + added
            virial = virial + strains.sum(axis=0) - (of_fixes if of_loop else 0.0)
        energy *= u["energy"]
        out = {"energy": energy, "free_energy": energy, "forces": forces * u["force"]}
        volume = atoms.cell.volume if atoms.cell.rank == 3 else 0.0
        if self.interactions.is_oriented:
            if of_loop:       # its torques may be those of fixes, too
                return out
            turns = turns_as_virials(system.extra["torque"])
            virial, strains = virial + turns.sum(axis=0), strains + turns
        if volume:
            out["stress"] = virial[VOIGT] * (-u["energy"] / volume)
        n = max(1, len(atoms))
        if result.energies is not None:
            out["energies"] = (result.energies + shares + result.energy["etail"] / n) * u["energy"]
            if volume:
                strains = result.virials + strains + result.virial_of.get("tail", np.zeros(6)) / n
                out["stresses"] = strains[:, VOIGT] * (-u["energy"] / volume)
        return out

    def __repr__(self) -> str:
        if self.interactions is None:
            parts = [f"{k}: {', '.join(v)}" for k, v in self.arguments.items() if isinstance(v, Mapping) and v]
        else:
            parts = [f"{k}: {', '.join(use.style.name for use in uses)}" for k, uses in self.interactions.uses.items() if uses]
        parts += [str(load) for load in self.loads] + [f"without {text}" for text in self.left_out]
        return f"ForceField({'; '.join(parts) or 'no styles'}; units {self.units})"


if "asemd" not in external_calculators:       # ase.calculators.calculator.get_calculator_class("asemd")
    register_calculator_class("asemd", ForceField)
