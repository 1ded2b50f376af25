"""The interaction that pulls hardest on an atom, for the report on a run that went wrong, and what to try against it."""
from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from asemd import units as unit_styles
from asemd.compute._items import evaluate
from asemd.errors import AsemdError
from asemd.hessian import ListEngine
from asemd.kernels.hooks import bound
from asemd.term import PairListTerm

UNUSUAL = 0.02          # of its length: how far the pull of an interaction moves an atom in one step, from which on it is named
MANY, FASTEST = 100_000, 20     # atoms
CANDIDATES = 200        # closest pairs that are looked at
STEP = 1e-4             # of differences, relative to the length of an item
EARLY = 1000            # steps: a kick that is far too large before was so at the start,
TOO_LARGE = 0.5         # which is this part of the item's length
PERIODS = 20            # steps per period of a vibration
SHORTER = "a shorter timestep (asemd check finds one)"
CLOSE = 15.0            # times the mean kinetic energy of an atom: pairs of that energy did not get there by themselves


@dataclass
class Item:
    """One pair, bond, angle, dihedral or improper.

    Attributes
    ----------
    kind, style : str
    type : int
        Of a bonded item; 0 for pairs.
    ids : tuple of int
    distance : float
        Between the two atoms of a pair or bond, else between the outer ones.
    energy, force : float
        The largest force on one of its atoms.
    kick : float
        How far its force moves an atom in one step, F dt^2 / m.
    period : float
        Of the vibration along its force, nan if there is none.
    """

    kind: str
    style: str
    type: int
    ids: tuple[int, ...]
    distance: float
    energy: float
    force: float
    kick: float
    period: float = math.nan

    def __str__(self) -> str:
        atoms = " ".join(map(str, self.ids))
        of_type = f" of type {self.type}" if self.type else ""
        length = f"r = {self.distance:.4g}, " if len(self.ids) == 2 else ""
        return f"{self.kind}{of_type} between atoms {atoms} ({self.style}, {length}energy {self.energy:.4g}, force {self.force:.4g})"


def worst_item(system, interactions, settings, dt: float, reach: float = math.inf) -> Item | None:
    """The interaction whose force moves an atom furthest in one step, or None if none does so to an unusual degree.

    Of many atoms only the fastest ones are looked at, with all that is closer to them than `reach`.

    Parameters
    ----------
    system : asemd.system.System
    interactions : asemd.forcefield.Interactions
    settings : asemd.result.Settings
    dt : float
        Time step, in the system's units.
    """
    if system.n > MANY and reach < math.inf:
        system, settings = _around_the_fastest(system, settings, reach)
    units = unit_styles.get(system.units)
    scale = units.ftm2v * dt * dt / system.atom_masses()
    found: list[Item] = []
    with np.errstate(all="ignore"):
        for kind, atoms, types in system.topology:
            for use in interactions.uses[kind]:
                mine = np.isin(types, list(use.coeff)) & (types > 0)
                if mine.any() and use.style.function is not None:
                    found += _bonded(system, use, kind, atoms[mine], types[mine], units, interactions.compat, scale)
        found += _pairs(system, interactions, settings, scale)
    found = [i for i in found if i.kick > UNUSUAL * max(i.distance, 1e-300)]
    return max(found, key=lambda i: i.kick, default=None)


def _around_the_fastest(system, settings, reach: float):
    """The fastest atoms and their surroundings."""
    near = np.zeros(system.n, bool)
    for row in np.argsort((system.v**2).sum(axis=1))[-FASTEST:]:
        near |= (system.box.minimum_image(system.x - system.x[row])[0] ** 2).sum(axis=1) <= reach * reach
    exclude = [(kind, *(m if kind == "type" else m[near] for m in masks)) for kind, *masks in settings.exclude]
    return system.select(near), replace(settings, exclude=exclude)


def _distance(system, a: int, b: int) -> float:
    return float(np.linalg.norm(system.box.minimum_image(system.x[[a]] - system.x[[b]])[0]))


def _bonded(system, use, kind: str, atoms, types, units, compat: str, scale) -> list[Item]:
    """The worst item of one bonded style."""
    try:
        energies, forces = evaluate(system, use, kind, atoms, types, units, compat)
    except AsemdError:
        return []           # a style that needs more than positions
    size = np.nan_to_num(np.linalg.norm(forces, axis=2), nan=np.inf)
    kick = (size * scale[atoms]).max(axis=1)
    m = int(np.argmax(kick))
    item = Item(kind, f"{kind}_style {use.style.name}", int(types[m]), tuple(int(i) for i in system.id[atoms[m]]),
                _distance(system, atoms[m, 0], atoms[m, -1]), float(energies[m]), float(size[m].max()), float(kick[m]))

    def force_at(shift: np.ndarray) -> np.ndarray:
        moved = system.copy()
        moved.x[atoms[m]] += shift
        return evaluate(moved, use, kind, atoms[m:m + 1], types[m:m + 1], units, compat)[1][0]
    if not use.style.history:
        item.period = _period(force_at, forces[m], system.atom_masses()[atoms[m]], item.distance, units)
    return [item]


def _period(force_at, force: np.ndarray, masses: np.ndarray, length: float, units) -> float:
    """Period of the vibration along the accelerations by `force (k, 3)`: omega^2 = - u . dF/du / sum of m u^2."""
    way = force / masses[:, None]
    norm = np.abs(way).max()
    if not (np.isfinite(norm) and norm > 0.0):
        return math.nan
    way /= norm
    h = STEP * length
    slope = ((force_at(h * way) - force_at(-h * way)) * way).sum() / (2.0 * h)
    square = -slope * units.ftm2v / (masses[:, None] * way * way).sum()
    return 2.0 * math.pi / math.sqrt(square) if square > 0.0 and math.isfinite(square) else math.nan


def _pairs(system, interactions, settings, scale) -> list[Item]:
    """The worst pair of each pair style, among those that are closest."""
    moved = system.copy()
    try:
        engine = ListEngine(moved, interactions, replace(settings, threads=1, precision="double", lost="ignore"))
        engine.load()
    except AsemdError:
        return []
    found = []
    for term in engine.terms:
        if type(term) is PairListTerm and len(term.i):
            found += _closest(engine, term, scale)
    return found


def _closest(engine, term: PairListTerm, scale) -> list[Item]:
    """The worst one of the closest pairs of a term."""
    system, state, kernel = engine.system, engine.state, term.kernel(True, False)
    arguments = list(term.arguments(engine, 0))
    d = state.x[:, term.i] - state.x[:, term.j] - term.shifts[term.code >> 2].T
    r = np.sqrt((d * d).sum(axis=0))
    near = np.argsort(r, kind="stable")[:CANDIDATES]

    def single(m: int) -> tuple[float, np.ndarray]:
        engine.acc[:], engine.bad[:] = 0.0, 0.0
        i, j = term.i[m], term.j[m]
        engine.buffers[0][:, [i, j]] = 0.0
        arguments[10:12] = m, m + 1
        bound(kernel, tuple(arguments), 1)()
        return float(engine.acc[0, term.index, :2].sum()), engine.buffers[0, :3][:, [i, j]].T.copy()
    best, item = -1.0, None
    for m in near.tolist():
        energy, force = single(m)
        rows = state.row[[term.i[m], term.j[m]]]
        size = np.nan_to_num(np.linalg.norm(force, axis=1), nan=np.inf)
        kick = float((size * scale[rows]).max())
        if kick > best:
            best, ids = kick, sorted(int(k) for k in system.id[rows])
            item, at = Item("pair", f"pair_style {term.style.name}", 0, tuple(ids), float(r[m]), energy, float(size.max()), kick), m
    if item is None or not math.isfinite(item.force):
        return [item] if item else []
    slots = [term.i[at], term.j[at]]

    def force_at(shift: np.ndarray) -> np.ndarray:
        before = state.x[:, slots].copy()
        state.x[:, slots] += shift.T
        out = single(at)[1]
        state.x[:, slots] = before
        return out
    item.period = _period(force_at, single(at)[1], system.atom_masses()[state.row[slots]], item.distance, engine.units)
    return [item]


def advice(item: Item | None, dt: float, steps: int, kinetic: float, start: bool = True) -> list[str]:
    """What to try when a run came apart.

    Parameters
    ----------
    item : Item or None
        What `worst_item` found.
    dt : float
        Time step of the run.
    steps : int
        Steps since the run began.
    kinetic : float
        Mean kinetic energy of an atom in the last good state.
    start : bool
        Whether that is the state before the first step, so that the timestep has not made it.
    """
    early = item is not None and steps < EARLY and not item.kick < TOO_LARGE * item.distance
    if early and item.kind == "pair" and not item.energy < CLOSE * kinetic:
        return [f"minimize before the run, because atoms {' and '.join(map(str, item.ids))} overlap",
                "a soft start: pair_style soft, or fix nve/limit, for the first steps", *[SHORTER] * (not start)]
    shorter = SHORTER
    if item is not None and item.kind != "pair" and math.isfinite(item.period):
        shorter = (f"timestep {min(max(item.period / PERIODS, dt / PERIODS), dt / 2.0):.2g} (this {item.kind} vibrates with a period of "
                   f"{item.period:.3g}, {item.period / dt:.3g} steps)")
    out = [shorter]
    if early:
        out.insert(0, "minimize before the run, or fix nve/limit for its first steps: atoms start too close together, or bonds too long")
    return out
