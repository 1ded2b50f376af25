"""What fixes mean without dynamics: forces that are functions of positions have an energy, forces set to zero are constraints."""
from __future__ import annotations

import copy
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from asemd import units
from asemd.errors import InputError, SimulationError
from asemd.fix import Fix
from asemd.fix.addforce import AddForce
from asemd.fix.cmap import CMAP
from asemd.fix.efield import EField, has_dipoles
from asemd.fix.enforce2d import Enforce2D
from asemd.fix.forcing import Forcing
from asemd.fix.lineforce import LineForce
from asemd.fix.planeforce import PlaneForce
from asemd.fix.setforce import SetForce
from asemd.fix.shake import Shake
from asemd.kernels import correction_map
from asemd.kernels.hooks import Calls
from asemd.kernels.state import BoxState, State, Thread, cell_arrays, empty_state
from asemd.result import COMPONENTS
from asemd.system import System
from asemd.topology import CROSSTERM

FRICTION = ("viscous", "viscous/sphere", "recenter")      # no forces of positions: left out as thermostats are
OTHERS = ("accelerate/cos", "adapt", "external", "python/invoke", "qeq/", "rigid", "spring/chunk", "ti/spring")     # beginnings of names


def pulled(f: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Energies (n,), forces and virials (n, 6) of atoms at `x (n, 3)` that constant forces `f (n, 3)` pull."""
    return -(f * x).sum(axis=1), f, np.stack([0.5 * (f[:, a] * x[:, b] + f[:, b] * x[:, a]) for a, b in COMPONENTS], axis=1)


@dataclass(frozen=True)
class Load:
    """A constant force on each atom of a group: E = -f . r with unwrapped positions.

    Parameters
    ----------
    group : str
    force : (float, float, float)
        In force units of the scene.
    """

    group: str
    force: tuple[float, float, float]
    in_virial = False       # whether the fix counts in the virial of a run

    def fix(self, group: str) -> Fix:
        """The fix that does the same in a run."""
        return AddForce(group, self.force)

    @property
    def groups(self) -> tuple[str, ...]:
        """The groups whose masks `act` takes."""
        return (self.group,)

    def act(self, x: np.ndarray, system: System, mask: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Energies (n,), forces (n, 3) and virials (n, 6; xx yy zz xy xz yz) of atoms at unwrapped positions `x (n, 3)`; all else is that
        of the system."""
        return pulled(np.where(mask[:, None], np.array(self.force, float), 0.0), x)

    def __str__(self) -> str:
        return f"addforce {self.force[0]:g} {self.force[1]:g} {self.force[2]:g} on group {self.group}"


@dataclass(frozen=True)
class Field:
    """A constant electric field on the charges and dipoles of a group: E = -(q r + mu) . field with unwrapped positions.

    Parameters
    ----------
    group : str
    field : (float, float, float)
        In the units of `asemd.fix.EField`.
    """

    group: str
    field: tuple[float, float, float]
    in_virial = False

    def fix(self, group: str) -> Fix:
        """The fix that does the same in a run."""
        return EField(group, self.field)

    @property
    def groups(self) -> tuple[str, ...]:
        """As `Load.groups`."""
        return (self.group,)

    def act(self, x: np.ndarray, system: System, mask: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """As `Load.act`."""
        dipoles, field = has_dipoles(system), units.get(system.units).qe2f * np.array(self.field, float)
        if system.q is None and not dipoles:
            raise InputError("an electric field needs charges or dipoles: atoms.set_initial_charges(...)")
        energies, f, w = pulled(np.where(mask, 0.0 if system.q is None else system.q, 0.0)[:, None] * field, x)
        return energies - np.where(mask, system.extra["mu"] @ field, 0.0) if dipoles else energies, f, w

    def __str__(self) -> str:
        return f"efield {self.field[0]:g} {self.field[1]:g} {self.field[2]:g} on group {self.group}"


class Potential:
    """Springs, restraints, indenters and walls: a fix whose hook gives forces that are minus the gradient of its scalar.

    What each atom has of energy and virial is an equal part. The virial is what the fix counts in a run: walls one with the distance from
    the wall, the others none.

    Parameters
    ----------
    fix : Forcing
    natoms : int
        How many atoms it is for.
    """

    in_virial = False

    def __init__(self, fix: Forcing, natoms: int):
        self._fix, self.natoms = copy.deepcopy(fix), natoms
        if fix.style == "restrain":     # whose atoms are named by their ids
            self._fix.group = "all"
        self.group = self._fix.group
        self._fix.thermo_virial = "virial" in fix.modifies

    @property
    def groups(self) -> tuple[str, ...]:
        """As `Load.groups`."""
        return (self.group, couple) if (couple := getattr(self._fix, "couple", "")) else (self.group,)

    def fix(self, *groups: str) -> Fix:
        """The fix that does the same in a run."""
        new = copy.deepcopy(self._fix)
        new.thermo_virial, new.group = False, groups[0]
        if len(groups) > 1:
            new.couple = groups[1]
        return new

    def act(self, x: np.ndarray, system: System, *masks: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """As `Load.act`."""
        if system.n != self.natoms:
            raise InputError(f"fix {self._fix.style} of the calculator is for {self.natoms} atoms, not for {system.n}")
        fix, still = self._fix, Still(system, dict(zip(self.groups, masks)))
        state, th = still.state(x), Thread(0, 1, 0, system.n, 0, 0, 0, 0.0, np.zeros(8, np.int64), np.zeros((1, 8)))
        p, a = np.ascontiguousarray(fix.parameters(still), float), fix.atom_arrays(still)
        a = a if isinstance(a, tuple) else np.zeros((1, 1)) if a is None else np.ascontiguousarray(a, float)
        Calls([{"post_force": fix.post_force}], [1], ()).call(0, "post_force", th, state, ((p, a),), keep=False)
        if problem := fix.broken_constraint(still):
            raise SimulationError(f"fix {fix.style}: {problem}")
        part = masks[0] / max(1, np.count_nonzero(masks[0]))
        return fix.scalar() * part, np.ascontiguousarray(state.f.T), part[:, None] * state.virial[0]

    def __str__(self) -> str:
        return " ".join([self._fix.style, *self._fix.to_lammps(), "on group", self.group])


class Still:
    """Atoms as the hooks of a fix see them, without a loop.

    Parameters
    ----------
    system : System
    groups : dict of str to (n,) bool
    """

    def __init__(self, system: System, groups: dict[str, np.ndarray]):
        self.system, self.groups, self.units = system, groups, units.get(system.units)

    def group_bit(self, name: str) -> int:
        """The bit of a group in the masks of the atoms."""
        return 1 << list(self.groups).index(name)

    def state(self, x: np.ndarray) -> State:
        """Slots in the order of the atoms, which are at unwrapped positions `x (n, 3)`."""
        system, box, n, none = self.system, self.system.box, self.system.n, np.zeros((0, 3))
        at, image = x.copy(), np.zeros((n, 3), np.int32)
        box.wrap(at, image)
        cell = cell_arrays(box.cell, box.periodic)
        live = BoxState(cell.vectors, np.array(box.origin), box.periodic.astype(float), cell, np.eye(3), none, none, np.zeros((0, 4)),
                        none, none, np.vstack([box.origin, box.cell]), np.array([float(box.triclinic)]))
        state = empty_state(n, np.arange(n, dtype=np.int32), image, np.zeros((1, 0, 8)), live)
        state.x[:], state.row[:], state.type[:], state.mass[:] = at.T, np.arange(n), system.type, system.atom_masses()
        state.q[:] = 0.0 if system.q is None else system.q
        for name, mask in self.groups.items():
            state.mask[mask] |= self.group_bit(name)
        return state


@dataclass(frozen=True, eq=False)
class Maps:
    """Correction maps (m, 24, 24) for the cross terms of the atoms, see `asemd.fix.CMAP`.

    Parameters
    ----------
    maps : (m, 24, 24) array
        In energy units of the scene.
    """

    maps: np.ndarray
    group, groups = "all", ("all",)
    in_virial = True

    def fix(self, group: str) -> Fix:
        """The fix that does the same in a run."""
        return CMAP(self.maps, group)

    def items(self, x: np.ndarray, system: System, only: slice = slice(None)) -> tuple[np.ndarray, np.ndarray]:
        """Atoms (m, 5) of some cross terms and their energies, virials and forces (m, 22)."""
        box, given = system.box, system.topology.items(CROSSTERM)
        items, types = (np.ascontiguousarray(a[only], np.int32) for a in given)
        wrong = types[(types < 1) | (types > len(self.maps))]
        if len(wrong):
            raise InputError(f"a cross term has correction map {wrong[0]}, there are {len(self.maps)}")
        out = np.zeros((len(items), correction_map.OUT))
        correction_map.evaluator()(np.ascontiguousarray(x.T), np.arange(len(x), dtype=np.int32), cell_arrays(box.cell, box.periodic), items,
                                   types, correction_map.with_slopes(self.maps), out, np.zeros((2, 4, 3)), 0, len(items))
        return items, out

    def act(self, x: np.ndarray, system: System, mask: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """As `Load.act`; the five atoms of a cross term have equal shares of energy and virial."""
        items, out = self.items(x, system)
        shares, forces = np.zeros((len(x), 7)), np.zeros((len(x), 3))
        for k, atoms in enumerate(items.T):
            np.add.at(shares, atoms, 0.2 * out[:, :7])
            np.add.at(forces, atoms, out[:, 7 + 3 * k:10 + 3 * k])
        return shares[:, 0], forces, shares[:, 1:]

    def __str__(self) -> str:
        return f"cmap with {len(self.maps)} maps"


def _named(fix: Fix) -> str:
    return f"fix {fix.id} ({fix.style})" if fix.id else f"fix {fix.style}"


def loads_of(fixes: Iterable[Fix], natoms: int) -> tuple[list[Load | Field | Potential | Maps], list[str]]:
    """Forces of fixes that are functions of positions, and the names of fixes whose forces are not the gradient of an energy."""
    loads, left_out = [], []
    for fix in fixes:
        constant = isinstance(fix, AddForce | EField) and fix.region is None and not fix.follows
        if isinstance(fix, AddForce):
            if not constant or fix.add_every > 1 or any(callable(f) for f in fix.force):
                left_out.append(f"{_named(fix)} with a force that is not constant")
            else:
                loads.append(Load(fix.group, tuple(float(f) for f in fix.force)))
        elif isinstance(fix, CMAP):
            loads.append(Maps(fix.maps))
        elif isinstance(fix, EField) and fix.style == "efield":
            if constant:
                loads.append(Field(fix.group, tuple(float(v) for v in fix.values)))
            else:
                left_out.append(f"{_named(fix)} with a field that is not constant")
        elif isinstance(fix, Forcing) and fix.has_potential():
            loads.append(Potential(fix, natoms))
        elif isinstance(fix, Shake):
            left_out.append(f"{_named(fix)}, without which nothing holds its bonds and angles,")
        elif isinstance(fix, Forcing) and fix.style not in FRICTION:
            left_out.append(_named(fix))
        elif fix.style.startswith(OTHERS) and getattr(fix, "callback", "") != "end_of_step":
            left_out.append(_named(fix))
    return loads, left_out


def together(loads: Iterable[Load | Field | Potential | Maps], atoms, system: System, unit: float,
             mask: Callable) -> tuple[np.ndarray, ...]:
    """What loads do to ``ase.Atoms``, in the units of the force field.

    Parameters
    ----------
    system : System
        The same atoms, maybe elsewhere, in the units of the force field.
    unit : float
        The unit of length, in Angstrom.
    mask : callable
        ``mask(atoms, group)``: (n,) bool.

    Returns
    -------
    energies (n,), forces (n, 3), virials (n, 6) by atom; virial (6,) of those whose fixes count in the virial of a run
    """
    x = (atoms.positions + (atoms.arrays["image"] @ atoms.cell.array if "image" in atoms.arrays else 0.0)) / unit
    energies, forces, virials, counted = np.zeros(len(x)), np.zeros((len(x), 3)), np.zeros((len(x), 6)), np.zeros(6)
    for load in loads:
        e, f, w = load.act(x, system, *(mask(atoms, group) for group in load.groups))
        energies, forces, virials = energies + e, forces + f, virials + w
        counted += load.in_virial * w.sum(axis=0)
    return energies, forces, virials, counted


def constraints_of(fixes: Iterable[Fix], groups: Mapping[str, np.ndarray]) -> tuple[list, list[str]]:
    """ASE constraints for fixes that set forces, or components of them, to zero, and the names of those that set them to something else."""
    out, left_out = [], []
    for fix in fixes:
        if isinstance(fix, SetForce) and (fix.region is not None or any(f is not None and (callable(f) or f != 0.0) for f in fix.force)):
            left_out.append(f"{_named(fix)} with a force that is not zero everywhere in its group")
        elif isinstance(fix, SetForce | LineForce | Enforce2D) and len(index := np.flatnonzero(groups[fix.group])):
            out += _constraint(fix, index)
    return out, left_out


def _constraint(fix: SetForce | LineForce | Enforce2D, index: np.ndarray) -> list:
    """What holds atoms as the fix does."""
    from ase.constraints import FixAtoms, FixCartesian, FixedLine, FixedPlane  # a quarter of a second that most scenes need not wait
    if isinstance(fix, LineForce):
        across = isinstance(fix, PlaneForce)
        if np.count_nonzero(fix.direction) > 1:
            return [(FixedPlane if across else FixedLine)(index, fix.direction)]
        held = (fix.direction != 0.0) == across
    else:
        held = np.array([False, False, True] if isinstance(fix, Enforce2D) else [f is not None for f in fix.force])
    return [FixAtoms(index) if held.all() else FixCartesian(index, held)] if held.any() else []
