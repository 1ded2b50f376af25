"""Looks after a run while it goes on: stops it when it has come apart, and says where, why and what to try.

It looks when the neighbour list is built and where compiled stretches end, and keeps the atoms of the last looks; `docs/check.md` has its
rules and why each of them is one that a sound run cannot break.
"""
from __future__ import annotations

import os
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from asemd.errors import Halted, InputError, LostAtoms, SimulationError
from asemd.result import Snapshot

if TYPE_CHECKING:
    from asemd.culprit import Item

SHARE = 500.0       # it waits this many times as long as its last look took: below 1 / SHARE of the run
FIRST = 5           # looks at the start of a run that it does not wait for: most of what goes wrong does so there
FREE = 10.0         # where there are bonds only, the reach is this many times the longest one
SLOW = 0.1          # of the length of `Watchdog.reach` per step: atoms of a good frame are slower
GROWTH = 10.0       # the kinetic energy is this many times that of the start, and
CREATED = 0.5       # this part of it came from nowhere
SILENT = ("ave/", "print", "store/", "vector", "halt", "property/")     # fixes that leave the motion alone, by what their names begin with


@dataclass
class Frame:
    """Atoms between two steps, as the slots of an engine have them; `slow`: no atom moves by more than `SLOW` of the reach per step.

    `id` is the very array of the system: it is another one when atoms have left or joined.
    """

    step: int
    id: np.ndarray
    x: np.ndarray
    v: np.ndarray
    row: np.ndarray
    image: np.ndarray
    box: object
    slow: bool = True

    def system(self, like):
        """A copy of the system `like`, of the same atoms, in this state, folded into the box."""
        out, there = like.copy(), self.row >= 0
        rows = self.row[there]
        out.x[rows], out.v[rows] = self.x[:, there].T, self.v[:, there].T
        out.image[:], out.box, out.step = self.image, self.box, self.step
        out.box.wrap(out.x, out.image)
        return out


@dataclass
class Verdict:
    """What the watchdog found when a run went wrong; the attribute `verdict` of the error.

    Attributes
    ----------
    step : int
        The step that could not be completed.
    what : str
        The error as it was raised.
    item : asemd.culprit.Item or None
        The interaction with the strongest pull on an atom in the last good state, if that is out of the ordinary.
    good : asemd.system.System or None
        The last good state; ``good.step`` is its step.
    path : str
        File with the last good state, empty if there is none.
    advice : list of str
        What to try.
    """

    step: int
    what: str
    item: Item | None = None
    good: object = None
    path: str = ""
    advice: list[str] = field(default_factory=list)


class Watchdog:
    """The watchdog of one `asemd.loop.Loop`; as a context it turns errors of the run into full reports.

    Parameters
    ----------
    loop : asemd.loop.Loop

    Attributes
    ----------
    path : str
        Where the last good frame is written when a run fails; empty: nowhere.
    explains : bool
        False: it stops runs, but keeps no frames and adds nothing to errors (for runs that are meant to find out where they break).
    on : bool
        False: it does not look at all; to be set before the set-up of a run.
    save : callable
        Writes a system to a path; by default a text dump with all digits.
    seconds : float
        What it has cost so far.
    """

    def __init__(self, loop):
        self.loop, self.path, self.explains, self.on = loop, "", True, True
        self.save = self._dump
        self.frames: list[Frame] = []
        self._energies: tuple[float, float] | None = None       # total and kinetic, of the start
        self.seconds, self._next, self._next_energy = 0.0, 0.0, 0.0
        self._ids, self._spare, self._built, self.reach = None, 0, 0, np.inf
        self._limit, self._free = np.inf, False

    # ---- before the run -----------------------------------------------------------------------------------------------------------------
    def begin(self) -> None:
        """A run begins: its first frame is good, its energy is what later ones are compared with."""
        if not self.on:
            return
        loop, e = self.loop, self.loop.engine
        self.width = max(e.reach, *(1.0 / np.linalg.norm(np.linalg.inv(e.vectors), axis=0)))
        bond = _longest_bond(e.system)
        self.reach = (max(e.cutoff, bond) if e.has_pairs else 0.0) or FREE * max(bond, loop.settings.skin) or np.inf
        self._limit = min(self.reach, self.width) ** 2
        self._free = _conserving(loop)
        self.frames.clear()
        self._spare = FIRST
        self.again()

    def again(self) -> None:
        """A run goes on, perhaps with other velocities."""
        if not self.on:
            return
        loop = self.loop
        self.first = self._built = self._since = loop.step
        self._ids = loop.system.id
        self._energies, self._warned = None, False
        self._next = self._next_energy = 0.0
        self.energy(loop.result)
        self._timed(self._keep)

    # ---- during the run -----------------------------------------------------------------------------------------------------------------
    def before_build(self, compiled: bool) -> None:
        """Before a list is built: nobody crosses the whole box between two builds, nobody is too fast for the forces to matter.

        Raises
        ------
        SimulationError
        """
        e = self.loop.engine
        if not e.terms or not self.on:
            return
        if compiled and e.farthest[0] <= self._limit:      # the loop has measured it
            return
        squared = e.k.moved(e.state.x, e.held, e.ns)
        if not squared > self._limit:
            return              # a position that is not a number is reported by the build
        if squared > self.width**2:
            far = np.linalg.norm(e.state.x[:, :e.ns] - e.held[:, :e.ns], axis=0)
            slot = int(np.argmax(far))
            raise SimulationError(f"atom {self._id(slot)} moved {far[slot]:.4g} since the neighbour list was built, more than the width of "
                                  "the box: the time step is too long, or atoms are too close together")
        self._look_at_speed()

    def content(self) -> bool:
        """Whether `before_build` has nothing to say; after compiled steps that measured how far atoms have moved."""
        return not self.on or bool(self.loop.engine.farthest[0] <= self._limit)

    def glance(self) -> bool:
        """Before the loop builds a list by itself: whether a frame was due, and has been kept."""
        due = self.on and time.perf_counter() > self._next and self.content()
        if due:
            self._timed(self._keep)
        return due

    def patience(self) -> tuple[float, float]:
        """For lists that the loop builds by itself: the squared distance up to which `before_build` has nothing to say, and the seconds
        for which `after_build` has nothing to do."""
        return (self._limit, max(0.0, self._next - time.perf_counter())) if self.on else (np.inf, np.inf)

    def built(self, step: int) -> None:
        """The loop built lists by itself, the last one at that step; 0: none."""
        self._built = max(self._built, step)
        self._recognise()

    def after_build(self) -> None:
        """After a list was built: this is a good frame."""
        if not self.on:
            return
        self._built = self.loop.step
        self._recognise()
        if time.perf_counter() > self._next:
            self._timed(self._keep)

    def _recognise(self) -> None:
        """Where some atoms left or joined, with their energy; older frames are of other atoms."""
        if self._ids is not self.loop.system.id:
            self._ids, self._energies = self.loop.system.id, None

    def look(self) -> None:
        """Where a compiled stretch ends: velocities are numbers and no atom is too fast; constraints hold.

        Raises
        ------
        SimulationError
        """
        if self.on and time.perf_counter() > self._next:
            self._timed(self._look)

    def energy(self, result) -> None:
        """After a step whose energies are known.

        Raises
        ------
        SimulationError
            Energy came from nowhere.
        """
        if self._free and time.perf_counter() > self._next_energy:
            began = time.perf_counter()
            self._look_at_energy(result)
            now = time.perf_counter()
            self.seconds += now - began
            self._next_energy = now + 2.0 * SHARE * (now - began)

    def _timed(self, action) -> None:
        began = time.perf_counter()
        action()
        now = time.perf_counter()
        self.seconds += now - began
        self._spare -= 1
        self._next = now + SHARE * (now - began) if self._spare < 0 else 0.0

    def _look(self) -> None:
        e = self.loop.engine
        fastest = self._speeds().max(initial=0.0)
        if not np.isfinite(fastest) and not np.isfinite(e.state.v[:, :e.ns]).all():
            slot = int(np.argmin(np.isfinite(e.state.v[:, :e.ns]).all(axis=0)))
            raise SimulationError(f"atom {self._id(slot)}: velocity is not finite")
        if fastest * self.loop.dt**2 > self.reach**2:
            self._look_at_speed()
        for fix in self.loop.fixes:
            broken = fix.broken_constraint(self.loop)
            if broken:
                raise SimulationError(f"fix {fix.id} (style {fix.style}): {broken}")
        self._keep()

    def _speeds(self) -> np.ndarray:
        """Squared speeds of the slots."""
        e = self.loop.engine
        v = e.state.v[:, :e.ns]
        return np.einsum("di,di->i", v, v)

    def _look_at_speed(self) -> None:
        """An atom that flies and has flown further than the reach of all forces in each step feels none of them on its way."""
        loop, e = self.loop, self.loop.engine
        d = e.state.x[:, :e.ns] - e.held[:, :e.ns]
        steps = max(1, loop.step - self._built)
        per_step = np.minimum(np.sqrt(self._speeds()) * loop.dt, np.sqrt(np.einsum("di,di->i", d, d)) / steps)
        per_step[e.state.row[:e.ns] < 0] = 0.0
        if e.mode == "none":        # atoms without any bond may fly as they like
            bonded = np.zeros(e.system.n, bool)
            for _, atoms, _ in e.system.topology:
                bonded[atoms.ravel()] = True
            per_step[~bonded[np.maximum(e.state.row[:e.ns], 0)]] = 0.0
        slot = int(np.argmax(per_step))
        if per_step[slot] > self.reach:
            others = int(np.count_nonzero(per_step > self.reach)) - 1
            more = f" (and {others} more)" if others else ""
            raise SimulationError(f"atom {self._id(slot)}{more} moves {per_step[slot]:.4g} per step, further than the forces reach "
                                  f"({self.reach:.4g}): the run has come apart")

    def _look_at_energy(self, result) -> None:
        """In a run that conserves energy, most of a much larger kinetic energy cannot have come from nowhere, and then again.

        Once is worth a warning: atoms that overlapped at the start may have been thrown apart too hard, and the rest is sound.
        """
        loop, system = self.loop, self.loop.system
        if not self._free or result is None:
            return
        # not a dot product: BLAS would wake threads that spin on beside the next steps
        kinetic = 0.5 * loop.units.mvv2e * float(np.einsum("i,ij,ij->", loop.engine.mass_row, system.v, system.v))
        potential = result.potential - result.energy.get("etail", 0.0)
        if self._energies is None or not np.isfinite(self._energies[0]):
            self._energies, self._depth, self._since = (potential + kinetic, kinetic), abs(potential), loop.step
            return
        total, before = self._energies
        rise = potential + kinetic - total
        if rise > CREATED * kinetic and kinetic > GROWTH * before and rise > 0.1 * self._depth:
            text = (f"total energy rose by {rise:.4g} and kinetic energy from {before:.4g} to {kinetic:.4g} since step {self._since}, "
                    "though nothing does work on the atoms")
            if self._warned:
                raise SimulationError(f"{text}, and not for the first time")
            loop.warn(f"step {loop.step}: {text}: the time step is too long, or atoms overlapped")
            self._warned, self._since, self._energies = True, loop.step, (potential + kinetic, kinetic)

    def _id(self, slot: int) -> int:
        e = self.loop.engine
        return int(e.system.id[e.state.row[slot]])

    def _keep(self) -> None:
        """Keep this frame, and the last one before it in which no atom was too fast."""
        if not self.explains:
            return
        loop, e = self.loop, self.loop.engine
        s, image = e.state, e.system.image
        slow = bool(self._speeds().max(initial=0.0) * loop.dt**2 <= (SLOW * self.reach) ** 2)
        same = [f for f in self.frames if f.id is e.system.id]
        old = same.pop(0 if same[-1].slow else -1) if len(same) == 2 else None
        if old is not None and old.x.shape[1] == e.ns:
            for kept, now in ((old.x, s.x[:, :e.ns]), (old.v, s.v[:, :e.ns]), (old.row, s.row[:e.ns]), (old.image, image)):
                kept[:] = now
            old.step, old.box, old.slow = loop.step, e.system.box, slow
        else:
            arrays = (s.x[:, :e.ns].copy(), s.v[:, :e.ns].copy(), s.row[:e.ns].copy(), image.copy())
            old = Frame(loop.step, e.system.id, *arrays, e.system.box, slow)
        self.frames = [*same, old]

    # ---- when it went wrong -------------------------------------------------------------------------------------------------------------
    def __enter__(self) -> Watchdog:
        return self

    def __exit__(self, kind, error, trace) -> None:
        if isinstance(error, Halted):
            return
        if isinstance(error, SimulationError) and self.on and self.explains and not hasattr(error, "verdict"):
            self.explain(error)

    def good_frame(self) -> Frame | None:
        """The last frame that is sound: all numbers finite, and if possible no atom too fast."""
        sound = [f for f in self.frames if f.id is self.loop.system.id and np.isfinite(f.x).all() and np.isfinite(f.v).all()]
        return ([f for f in sound if f.slow] or sound or [None])[-1]

    def explain(self, error: SimulationError) -> None:
        """Add the interaction that went wrong, the last good frame and advice to an error of the run; writes the frame to `path`."""
        from asemd.culprit import advice, worst_item
        loop, frame = self.loop, self.good_frame()
        text = str(error)
        if not text.startswith("step "):
            text = f"step {loop.step}: {text}"
        error.verdict = verdict = Verdict(loop.step, text)
        if frame is not None:
            verdict.good = frame.system(loop.system)
            parts = []
            try:
                verdict.item = worst_item(verdict.good, loop.interactions, loop.settings, loop.dt, self.reach)
            except Exception as problem:        # noqa: BLE001  whatever it is must not hide why the run ended
                parts.append(f"no interaction could be named ({problem})")
            if verdict.item is not None:
                parts.append(f"strongest pull at step {frame.step}: {verdict.item}")
            parts += self._write(verdict)
            if not isinstance(error, LostAtoms) or verdict.item is not None:
                verdict.advice = advice(verdict.item, loop.dt, loop.step - self.first, _kinetic(verdict.good, loop.units),
                                        frame.step == self.first)
                parts.append(f"try {', or '.join(verdict.advice)}")
            text = "; ".join([text, *parts])
        error.args = (text,)

    def _write(self, verdict: Verdict) -> list[str]:
        """Write the last good state, whole or not at all; returns words about it."""
        if not self.path:
            return []
        base, ending = os.path.splitext(self.path)
        part = f"{base}.part{ending}"
        try:
            self.save(verdict.good, part)
            os.replace(part, self.path)
        except (OSError, InputError) as problem:
            return [f"the last good state could not be written: {problem}"]
        verdict.path = self.path
        return [f"last good state (step {verdict.good.step}): {self.path}"]

    def _dump(self, system, path: str) -> None:
        """A text dump that ``read_dump`` takes back to the last digit."""
        from asemd.dump.custom import Custom
        columns = ["id", *["mol"] * system.molecular, "type", *["q"] * system.has_charge, *"xyz", "ix", "iy", "iz", "vx", "vy", "vz"]
        dump = Custom("all", 1, path, columns)
        dump.formats["float"] = "%.17g"
        dump.write(Snapshot(system, None, {"all": np.ones(system.n, bool)}, self.loop.dt, system.step), system.step)
        dump.close()


def _kinetic(system, units) -> float:
    """Mean kinetic energy of an atom."""
    return 0.5 * units.mvv2e * float(np.mean(system.atom_masses() * (system.v**2).sum(axis=1)))


def _longest_bond(system) -> float:
    """The longest bond of a system, 0 without bonds."""
    atoms, types = system.topology.items("bond")
    atoms = atoms[types > 0]
    d = system.box.minimum_image(system.x[atoms[:, 0]] - system.x[atoms[:, 1]])[0]
    return float(np.sqrt((d * d).sum(axis=1).max(initial=0.0)))


def _conserving(loop) -> bool:
    """Whether the energy of a run is constant but for the errors of its integration."""
    movers = [f for f in loop.fixes if not f.style.startswith(SILENT)]
    return bool(movers) and all(f.style == "nve" for f in movers)
