"""What is known about one step of a run: the quantities behind thermo keywords, variables and the Python interface."""
from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from asemd.errors import InputError, NotYet, nearest


@dataclass
class Progress:
    """Where a run is: steps, and wall times in seconds."""

    begin: int = 0              # first step of this run
    first: int = 0              # first step of a series of runs (run ... start)
    last: int = 0
    stop: int | None = None     # last step of a series of runs (run ... stop), if not that of this run
    started: float = field(default_factory=time.perf_counter)
    previous: dict[str, tuple[float, int]] = field(default_factory=dict)      # time and step tpcpu and spcpu were asked for last
    builds: int = 0             # neighbour list counters when the run began
    dangerous: int = 0
    remaining: Callable[[], float] = float      # seconds to the limit of wall time; 0 without one

    def cpu(self) -> float:
        return time.perf_counter() - self.started


class Moment:
    """Everything known about one step; each compute is evaluated at most once.

    Parameters
    ----------
    scene : asemd.scene.Scene
    snapshot : asemd.engine.Snapshot or None
        None before the first run: then only the box and the counts are known.
    number : callable
        Name of a variable -> its value.
    progress : Progress
    counters : object with ``builds`` and ``dangerous``, optional
    """

    def __init__(self, scene, snapshot, number: Callable[[str], float], progress: Progress | None = None, counters=None):
        self.scene, self._snapshot, self.number = scene, snapshot, number
        self.progress, self.counters = progress or Progress(), counters
        self._cache: dict[tuple[str, str], Any] = {}

    def __getstate__(self):
        return {**self.__dict__, "counters": None}      # they are the engine's

    @property
    def system(self):
        return self.scene.need_system("thermo")

    @property
    def snapshot(self):
        if self._snapshot is None:
            raise NotYet("energies, forces and computes are not known before the first run: use run 0")
        return self._snapshot

    def _get(self, kind: str, id: str) -> Any:
        if (kind, id) not in self._cache:
            if id not in self.scene.computes:
                raise InputError(f"there is no compute {id}{nearest(id, self.scene.computes)}")
            compute, snapshot = self.scene.computes[id], self.snapshot
            if compute.needs and not snapshot.fresh:
                raise NotYet(f"compute {id}: energies and virial were not computed on step {snapshot.step}")
            for need in compute.needs & {"energies", "virials"}:
                if getattr(snapshot.result, need) is None:
                    raise NotYet(f"compute {id} was not evaluated on step {snapshot.step}: run 0 first, or use it in thermo or a dump")
            self._cache[kind, id] = getattr(compute, kind)(snapshot)
        return self._cache[kind, id]

    def scalar(self, id: str) -> float:
        return float(self._get("scalar", id))

    def vector(self, id: str) -> np.ndarray:
        return self._get("vector", id)

    def array(self, id: str) -> np.ndarray:
        return self._get("array", id)

    def per_atom(self, id: str) -> np.ndarray:
        return self._get("per_atom", id)

    def local(self, id: str) -> np.ndarray:
        return self._get("local", id)

    def forget(self) -> None:
        """Computes are evaluated again when they are asked for next."""
        self._cache.clear()

    def fix(self, id: str):
        if id not in self.scene.fixes:
            raise InputError(f"there is no fix {id}{nearest(id, self.scene.fixes)}")
        return self.scene.fixes[id]

    def energy(self, *keys: str) -> float:
        return float(sum(self.snapshot.result.energy.get(k, 0.0) for k in keys))

    def temperature(self) -> float:
        return self.scalar(self.scene.thermo.temp)

    def kinetic(self) -> float:
        """Kinetic energy by the temperature and its degrees of freedom."""
        compute, state = self.scene.computes[self.scene.thermo.temp], self.snapshot
        return 0.5 * compute.dof(state) * state.units.boltz * self.temperature()

    def potential(self) -> float:
        return self.scalar("thermo_pe")

    def pressure(self, i: int | None = None) -> float:
        id = self.scene.thermo.press
        return self.scalar(id) if i is None else float(self.vector(id)[i])

    def coupling(self) -> float:
        return float(sum(f.scalar() for f in self.scene.fixes.values() if f.ecouple))

    def volume(self) -> float:
        """Volume, or area in two dimensions."""
        box = self.system.box
        edges = np.diag(box.cell) if box.is_lammps_frame else None
        if self.scene.dimension == 3:
            return float(np.prod(edges)) if edges is not None else box.volume
        return float(edges[0] * edges[1]) if edges is not None else float(np.linalg.norm(np.cross(box.cell[0], box.cell[1])))

    def forces(self) -> np.ndarray:
        return self.snapshot.system.f
