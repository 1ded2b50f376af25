"""The scene: everything a script has said so far, as plain data that can be pickled, copied and written back."""
from __future__ import annotations

import importlib
from collections.abc import Iterator, MutableMapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from asemd import units
from asemd.engine import Settings
from asemd.errors import InputError, nearest
from asemd.forcefield import Interactions
from asemd.minimize import Options
from asemd.result import with_masks
from asemd.thermo import Thermo

if TYPE_CHECKING:
    from asemd.compute import Compute
    from asemd.fix import Fix
    from asemd.region import Region
    from asemd.system import System

MAX_GROUPS = 32
NEVER = 2**40       # steps


class GroupTable(MutableMapping):
    """Group name -> bool mask by atom row; ``all`` comes first, the position of a name is its bit.

    A deleted group leaves its bit free for the next one, as in LAMMPS.
    """

    def __init__(self, n: int = 0):
        self._slots: list[str | None] = ["all"]
        self._masks: dict[str, np.ndarray] = {"all": np.ones(n, bool)}

    def __getitem__(self, name: str) -> np.ndarray:
        try:
            return self._masks[name]
        except KeyError:
            raise KeyError(name) from None

    def __setitem__(self, name: str, mask: np.ndarray) -> None:
        mask = np.asarray(mask, bool)
        if name not in self._masks:
            if None in self._slots:
                self._slots[self._slots.index(None)] = name
            elif len(self._slots) == MAX_GROUPS:
                raise InputError(f"group {name}: there can be at most {MAX_GROUPS} groups, all included")
            else:
                self._slots.append(name)
        self._masks[name] = mask

    def __delitem__(self, name: str) -> None:
        if name == "all":
            raise InputError("group all cannot be deleted")
        del self._masks[name]
        self._slots[self._slots.index(name)] = None

    def __iter__(self) -> Iterator[str]:
        return (name for name in self._slots if name is not None)

    def __len__(self) -> int:
        return len(self._masks)

    def bit(self, name: str) -> int:
        """The bit of a group: 0 for ``all``."""
        return self._slots.index(name)

    def mask(self, name: str, command: str = "") -> np.ndarray:
        """The mask of a group.

        Raises
        ------
        InputError
            No group of that name; offers the nearest match.
        """
        if name not in self._masks:
            raise InputError(f"{command}{': ' if command else ''}unknown group {name!r}{nearest(name, self)}")
        return self._masks[name]

    def resize(self, n: int) -> None:
        """Make every mask `n` atoms long; atoms that are new belong to ``all`` only."""
        for name, mask in self._masks.items():
            grown = np.full(n, name == "all")
            grown[:min(n, mask.size)] = mask[:n]
            self._masks[name] = grown

    def select(self, index: np.ndarray) -> None:
        """Keep the atoms of `index` (rows or mask), in that order."""
        self._masks = {name: mask[index] for name, mask in self._masks.items()}


def default_computes() -> dict[str, Compute]:
    """``thermo_temp``, ``thermo_press`` and ``thermo_pe``, which every scene has."""
    from asemd.compute.pe import PE
    from asemd.compute.pressure import Pressure
    from asemd.compute.temp import Temp
    temp = Temp("all")
    computes = {"thermo_temp": temp, "thermo_press": Pressure("all", temp, ()), "thermo_pe": PE()}
    for name, compute in computes.items():
        compute.id = name
    return computes


@dataclass
class Scene:
    """System, interactions, groups, fixes, computes, outputs and settings.

    Attributes
    ----------
    system : System or None
        None before the box is defined.
    units, dimension, boundary, atom_style
        As given by the commands of these names; `boundary` is three two-letter strings such as ``"pp"``.
    interactions : asemd.forcefield.Interactions
    groups : GroupTable
    fixes, computes, dumps : dict
        By id, in order of definition; a re-used id keeps its place.
    dt : float
        Timestep in time units of the scene.
    """

    system: System | None = None
    units: str = "lj"
    dimension: int = 3
    boundary: tuple[str, str, str] = ("pp", "pp", "pp")
    atom_style: str = "atomic"
    interactions: Interactions = field(default_factory=Interactions)
    groups: GroupTable = field(default_factory=GroupTable)
    fixes: dict[str, Fix] = field(default_factory=dict)
    computes: dict[str, Compute] = field(default_factory=default_computes)
    dumps: dict[str, Any] = field(default_factory=dict)
    thermo: Thermo = field(default_factory=Thermo)
    dt: float = 0.005
    neighbor: Settings = field(default_factory=Settings)     # its exclusions name groups
    list_once: bool = False     # neigh_modify once
    list_style: str = "bin"     # as the command neighbor has it
    first_group: str = ""       # atom_modify first
    sort: tuple[int, float] = (1000, 0.0)       # atom_modify sort: steps, width of the bins
    order: np.ndarray | None = None     # atom IDs as a data file has them, LAMMPS's first order of atoms
    threads: int = 1
    precision: str = "double"
    compat: str = ""
    min_style: str = "cg"
    min_modify: Options = field(default_factory=Options)
    first_step: int = 0
    lattice: Any = None
    regions: dict[str, Any] = field(default_factory=dict)
    molecules: dict[str, Any] = field(default_factory=dict)      # templates: lists of asemd.molecule.Molecule
    dynamic_groups: dict[str, Any] = field(default_factory=dict)      # group -> fix that chooses its members
    seeds: dict[str, int] = field(default_factory=dict)
    respa: Any = None       # asemd.respa.Levels of run_style respa
    map_style: str | None = None
    newton: tuple[bool, bool] = (True, True)
    time_base: tuple[float, int] = (0.0, 0)     # simulation time at the step where the timestep last changed
    max_special: int = 1        # partners one to three bonds apart that LAMMPS would hold for each atom, as its logs tell
    special_room: int = 0       # what it would add to that, once
    restarts: dict[int, Any] = field(default_factory=dict)      # 1: a series of restart files, 2: two in turn
    restored: dict[str, Any] | None = None      # what a restart file has for fixes to come and for the first run

    @property
    def step(self) -> int:
        """The current timestep."""
        return self.system.step if self.system is not None else self.first_step

    @step.setter
    def step(self, value: int) -> None:
        self.first_step = int(value)
        if self.system is not None:
            self.system.step = int(value)

    def time(self, step: int) -> float:
        """Simulation time at a step, also if the timestep was changed on the way."""
        return self.time_base[0] + (step - self.time_base[1]) * self.dt

    def set_dt(self, dt: float) -> None:
        """Choose the timestep from now on."""
        self.time_base = (self.time(self.step), self.step)
        self.dt = dt

    def set_units(self, name: str) -> None:
        """Choose the unit style; timestep and skin go to its defaults."""
        u = units.get(name)
        self.units, self.dt, self.neighbor.skin = name, u.dt, u.skin

    def need_system(self, command: str) -> System:
        """The system, or an error that says the box is not there yet."""
        if self.system is None:
            raise InputError(f"{command} command before simulation box is defined: use read_data or create_box first")
        return self.system

    def region(self, id: str, what: str) -> Region:
        """The region of that ID; `what` names the command that asks.

        Raises
        ------
        InputError
            No region of that ID; offers the nearest match.
        """
        if id not in self.regions:
            raise InputError(f"{what}: unknown region {id!r}{nearest(id, self.regions)}")
        return self.regions[id]

    def add_fix(self, fix: Fix) -> None:
        """Take up a fix, which has its ID, with the computes that it brings, in the place of one that had the ID before.

        Raises
        ------
        InputError
            There are computes with such IDs.
        """
        brought = fix.own_computes()
        for id in brought:
            if id in self.computes and self.computes[id].maker != fix.id:
                raise InputError(f"fix {fix.id} (style {fix.style}) brings a compute {id}, but there is one already: uncompute "
                                 "it, or choose another ID for the fix")
        self._drop_computes(fix.id)
        for id, compute in brought.items():
            compute.id, compute.maker = id, fix.id
            self.computes[id] = compute
        self.fixes[fix.id] = fix

    def remove_fix(self, id: str) -> None:
        """Take a fix away, and what it brought and changed."""
        fix = self.fixes.pop(id)
        self._drop_computes(id)
        if self.system is not None:
            fix.detach(self.system)

    def _drop_computes(self, maker: str) -> None:
        for id in [id for id, compute in self.computes.items() if compute.maker == maker]:
            del self.computes[id]

    def sync_groups(self) -> None:
        """Fit the group masks to the number of atoms."""
        if self.system is not None and self.groups["all"].size != self.system.n:
            self.groups.resize(self.system.n)
        for fix in self.fixes.values() if self.system is not None else ():
            if hasattr(fix, "attach"):
                fix.attach(self.system)

    @property
    def box_changes(self) -> bool:
        """Whether the box can change during a run: shrink-wrapped faces, or a fix that changes it."""
        shrinks = self.system is not None and any(set(b) & set("sm") for b in self.system.box.boundary)
        return shrinks or any(f.box_moves for f in self.fixes.values())

    def settings(self) -> Settings:
        """The neighbour and threading settings in the form the engine takes."""
        exclude = with_masks(self.neighbor.exclude, lambda group: self.groups.mask(group, "neigh_modify"))
        every = NEVER if self.list_once else self.neighbor.every
        return replace(self.neighbor, every=every, exclude=exclude, threads=self.threads, precision=self.precision, lost=self.thermo.lost,
                       lost_bond=self.thermo.lost_bond)

    def to_lammps(self, folder, name: str = "scene"):
        """Write ``in.NAME`` and ``data.NAME``, see `asemd.lammps.convert.to_lammps`; returns the path of the script."""
        return importlib.import_module("asemd.lammps.convert").to_lammps(self, folder, name)     # of a higher floor, as commands are

    def to_atoms(self):
        """`asemd.system.Atoms` in order of id, with the force field as calculator."""
        from asemd.calculator import ForceField
        system = self.need_system("read")
        atoms = system.to_ase()
        ForceField.attach(self, atoms)
        return atoms
