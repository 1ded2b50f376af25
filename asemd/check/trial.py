"""Short runs of copies of a scene at constant energy: what every experiment is made of."""
from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from asemd import units as unit_styles
from asemd.engine import Settings
from asemd.errors import InputError, SimulationError
from asemd.report import nve
from asemd.report.copies import copied
from asemd.scene import Scene

STRONG = 0.1            # of its length: an interaction that moves an atom further in one step must be relaxed first
ROOM = 293.0            # temperature of atoms at rest without a thermostat, K
FINER = 256.0           # how much shorter a timestep is that even steep forces stand
CONSTRAINING = ("enforce2d",)       # fixes that set forces to zero where nothing moves
BURST = 64              # steps
PIECE = 10              # steps between looks


@dataclass
class Bench:
    """A copy of a scene that experiments copy again, and what they may cost.

    Attributes
    ----------
    scene : Scene
        Prepared: velocities, pair energies shifted to zero at the cutoff, only fixes that act in a run at constant energy.
    dt : float
    tell : callable
        ``tell(fraction, what)`` shows progress.
    until : float
        When everything must be over, by ``time.perf_counter``.
    seconds_per_step, seconds_to_start : float
        Of a step with its part of looks at the energy, and of a run before its first step.
    notes : list of str
        What was changed of the scene, in plain words.
    """

    scene: Scene
    dt: float
    tell: Callable[[float, str], None]
    until: float = 0.0
    seconds_per_step: float = 0.0
    seconds_to_start: float = 0.0
    notes: list[str] = field(default_factory=list)

    @property
    def left(self) -> float:
        """Seconds that are left."""
        return self.until - time.perf_counter()

    def steps(self, wanted: int, fewest: int, share: float) -> int:
        """How many steps of one run fit into a share of the time that is left; 0 if not even the fewest do."""
        fit = int((share * self.left - self.seconds_to_start) / max(self.seconds_per_step, 1e-9))
        return min(wanted, fit) if fit >= fewest else 0

    @property
    def safe(self) -> Settings:
        """Neighbour settings that miss no pair."""
        return replace(self.scene.neighbor, every=1, delay=0, check=True)

    def loop(self, dt: float, settings: Settings | None = None):
        """A loop of a fresh copy at constant energy; by default with settings that miss no pair."""
        scene = copied(self.scene)
        scene.neighbor = settings or self.safe
        scene.list_once = scene.list_once and settings is not None
        loop = nve.make_loop(scene, nve.constant_energy(scene), dt, scene.respa)
        loop.warn = _silent
        return loop

    def kinetic(self, loop) -> float:
        """Kinetic energy of the atoms of a loop."""
        system = loop.system
        v2 = np.einsum("ij,ij->i", system.v, system.v)
        return 0.5 * loop.units.mvv2e * float(np.nan_to_num(system.atom_masses(), nan=1.0) @ v2)


def _silent(message: str) -> None:
    """Warnings of runs that are meant to fail are not shown."""


def bench(scene: Scene, dt: float | None, temperature: float | None, seed: int, relax: bool, tell) -> Bench:
    """Prepare a copy of a scene.

    Raises
    ------
    InputError
        Missing coefficients; atoms that cannot move.
    SimulationError
        The forces do not exist.
    """
    own = copied(scene)
    own.interactions.check_complete(own.system)
    found = Bench(own, own.dt if dt is None else float(dt), tell)
    if not found.dt > 0.0:
        raise InputError(f"experiments need a positive timestep, got {found.dt:g}")
    _leave_out(own, found.notes)
    nve.prepare(own)
    if temperature is not None:
        found.notes.append(f"velocities of temperature {temperature:g} (seed {seed})")
    elif not own.system.v.any():
        temperature = target(scene)
        found.notes.append(f"the atoms were at rest: velocities of temperature {temperature:g} (seed {seed})")
    if temperature is not None:
        nve.warm(own, temperature, seed)
    _hold(own)
    _relax(found, relax)
    if not _measure(found, found.dt):
        _measure(found, found.dt / FINER)
    return found


def _measure(bench: Bench, dt: float) -> bool:
    """Time a short run, compilation left out; False if it fails."""
    try:
        bench.loop(dt).setup(0, 10**9)
        began = time.perf_counter()
        loop = bench.loop(dt)
        loop.setup(loop.step, loop.step + 10**9)
        bench.seconds_to_start = time.perf_counter() - began
        loop.advance(2)
        began, done = time.perf_counter(), 0
        while time.perf_counter() - began < 0.1 and done < 200:
            loop.advance(PIECE)
            bench.kinetic(loop)
            done += PIECE
    except SimulationError:
        return False
    bench.seconds_per_step = (time.perf_counter() - began) / done
    return True


def _leave_out(scene: Scene, notes: list[str]) -> None:
    """Only fixes that act at constant energy stay; `notes` tells which ones do not."""
    gone = [f for f in scene.fixes.values() if f.ecouple or (f.integrates and f.style != "nve") or _works(f)]
    for fix in gone:
        if fix.minimizes:
            del scene.fixes[fix.id]
    if gone:
        names = ", ".join(f"{f.id} ({f.style})" for f in gone)
        notes.append(f"constant energy: {'fix' if len(gone) == 1 else 'fixes'} {names} {'is' if len(gone) == 1 else 'are'} off")
    led = [f for f in scene.fixes.values() if f.style == "setforce"]
    if led:
        notes.append(f"atoms are held still where fix {', '.join(f.id for f in led)} (setforce) sets their force")
    if not any(f.integrates for f in scene.fixes.values()):
        notes.append("no fix moves the atoms: fix nve does")


def _works(fix) -> bool:
    """Whether a fix does work on the atoms that no energy accounts for."""
    if not fix.minimizes or fix.integrates or fix.style in CONSTRAINING or not {"post_force", "pre_force"} & set(fix.hooks()):
        return False
    changes = any(callable(f) for f in getattr(fix, "force", ())) or getattr(fix, "region", None) is not None
    return changes or (fix.style != "setforce" and not fix.modify_option("energy", "yes", None))


def _hold(scene: Scene) -> None:
    """Atoms whose force is set do not move in that direction, so that nothing works on the others."""
    for fix in scene.fixes.values():
        if fix.style == "setforce":
            held = [f is not None for f in fix.force]
            scene.system.v[np.ix_(scene.groups.mask(fix.group), held)] = 0.0
            fix.force = [0.0 if h else None for h in held]


def _relax(bench: Bench, wanted: bool) -> None:
    """Minimise the energy, if not wanted where atoms would be thrown apart at the start, whatever the timestep."""
    from asemd.culprit import worst_item
    scene, dt = bench.scene, bench.dt
    why = "as the script does"
    if not wanted:
        item = worst_item(scene.system, scene.interactions, scene.settings(), dt)
        if item is None or item.kick < STRONG * item.distance or not all(_bursts(bench, dt / f) for f in (16.0, FINER)):
            return
        why = f"for the forces are too strong for a run to begin with ({item})"
    from asemd.lammps.session import Session
    from asemd.lammps.switches import Switches
    own = copied(scene)
    own.fixes = {f.id or str(k): f for k, f in enumerate(own.fixes.values()) if f.minimizes}
    own.thermo.every = 0
    session = Session(scene=own, switches=Switches(log="none", screen="none"))
    session.warn = _silent
    session.call("minimize", ["1e-8", "1e-8", "1000", "5000"])
    own.system.step, own.system.v = scene.step, scene.system.v
    scene.system = own.system
    bench.notes.append(f"the energy was minimised first, {why}")


def _bursts(bench: Bench, dt: float) -> bool:
    """Whether a short run fails, or heats up by what its atoms release."""
    loop = bench.loop(dt)
    try:
        loop.setup(loop.step, loop.step + BURST)
        first = bench.kinetic(loop)
        loop.advance(BURST)
    except SimulationError:
        return True
    return not bench.kinetic(loop) <= 10.0 * first


def target(scene: Scene) -> float:
    """The temperature that the scene's first thermostat begins with; else 1 in ``units lj``, room temperature in others."""
    for fix in scene.fixes.values():
        start = getattr(fix, "start", None)
        if isinstance(start, (int, float)) and fix.ecouple and start > 0.0:
            return float(start)
    return 1.0 if scene.units == "lj" else ROOM


def comes_apart(bench: Bench, dt: float, steps: int, growth: float) -> bool:
    """Whether a run at constant energy fails, or its kinetic energy grows by this factor and half of it comes from nowhere.

    The kinetic energy of a stable harmonic vibration stays below the energy it began with, at any timestep; what atoms release when they
    relax does not come from nowhere. So nothing but growth without end is found.
    """
    loop = bench.loop(dt)
    try:
        result = loop.setup(loop.step, loop.step + steps)
        first = bench.kinetic(loop)
        begin = result.potential + first
        for done in range(0, steps, PIECE):
            result = loop.advance(min(PIECE, steps - done))
            now = bench.kinetic(loop)
            if not now <= growth * max(first, 1e-300) and not result.potential + now - begin <= 0.5 * now:
                return True
    except SimulationError:
        return True
    return False


def boltzmann(scene: Scene) -> float:
    """Boltzmann's constant of the scene."""
    return unit_styles.get(scene.units).boltz
