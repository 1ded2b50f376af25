"""What the runs of a session showed, kept for those who look back: thermo rows, the conserved quantity, timings."""
from __future__ import annotations

import time
from dataclasses import dataclass, field

from asemd.errors import NotYet
from asemd.thermo import evaluate

CONSERVED = ("time", "econserve", "temp")       # evaluated with every thermo row, asked for or not


@dataclass
class Run:
    """One ``run`` or ``minimize``.

    Attributes
    ----------
    kind : str
        The command.
    keywords, titles : list of str
        The thermo columns.
    rows : list of list of float
    conserved : list of (time, energy, temperature)
        Of each row, in units of the scene: potential and kinetic energy with that of heat baths, of all atoms.
    begin, steps, atoms : int
    seconds, dt : float
    timings : dict of str to float
        Seconds by section.
    builds, dangerous : int
        Of neighbour lists.
    normalised : bool
        Whether energies in the rows are per atom.
    leaks : list of str
        Fixes that give or take energy which nobody counts.
    """

    kind: str
    keywords: list[str]
    titles: list[str]
    begin: int
    dt: float
    atoms: int
    normalised: bool
    units: str
    dof: float = 0.0
    rows: list[list[float]] = field(default_factory=list)
    conserved: list[tuple[float, ...]] = field(default_factory=list)
    steps: int = 0
    seconds: float = 0.0
    timings: dict[str, float] = field(default_factory=dict)
    builds: int = 0
    dangerous: int = 0
    leaks: list[str] = field(default_factory=list)


class Record:
    """Runs of a session, in order; the driver of a run tells it about rows and the end."""

    def __init__(self):
        self.runs: list[Run] = []
        self._of = None
        self.started = time.perf_counter()

    def row(self, driver, values: list[float]) -> None:
        """A thermo row was written."""
        scene, moment = driver.scene, driver.session.moment
        if self._of is not driver:
            self._of = driver
            thermo = scene.thermo
            self.runs.append(Run(driver.kind, list(driver.words), [thermo.name(k, w) for k, w in enumerate(driver.words, 1)], scene.step,
                                 scene.dt, scene.system.n, thermo.is_normalised(scene.units), scene.units, leaks=_leaks(scene)))
        run = self.runs[-1]
        run.rows.append([float(v) for v in values])
        if driver.kind == "run":
            try:
                run.dof = float(scene.computes[scene.thermo.temp].dof(moment.snapshot))
                run.conserved.append(tuple(evaluate(moment, word, False) for word in CONSERVED))
            except NotYet:
                run.conserved.append((float("nan"),) * len(CONSERVED))

    def ended(self, driver, steps: int, seconds: float, timings: dict[str, float]) -> None:
        """A run is over; what it spent."""
        if self._of is driver:
            run, engine = self.runs[-1], driver.session.loop.engine if driver.session.loop else None
            run.steps, run.seconds, run.timings = steps, seconds, dict(timings)
            if engine is not None:
                run.builds, run.dangerous = engine.builds - driver.progress.builds, engine.dangerous - driver.progress.dangerous

    @property
    def seconds(self) -> float:
        """Wall time since the record began."""
        return time.perf_counter() - self.started


def _leaks(scene) -> list[str]:
    moving = {"initial_integrate", "post_force", "final_integrate"}
    conserving = ("nve", "enforce2d")
    return [f"fix {id} ({fix.style})" for id, fix in scene.fixes.items() if moving & set(fix.hooks())
            and not ((fix.ecouple and getattr(fix, "tally", True)) or fix.thermo_energy or fix.style in conserving)]
