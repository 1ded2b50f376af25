"""The dynamics to be judged, and the records of potential energy, kinetic energy and volume that they give."""
from __future__ import annotations

import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from systems import HERE, LIQUIDS, prepare

from asemd.lammps import Lammps


@dataclass(frozen=True)
class Dynamics:
    """Commands of an ensemble (T, P, damp and slow are filled in), the degrees of freedom it leaves out, and whether it is a control."""

    commands: str
    momentum: int = 3           # 3 where the total momentum stays zero, 0 where friction and noise act on it
    constraints: int = 0        # of each molecule
    control: bool = False       # known not to sample its ensemble: the checks have to find that


STIR, SETTLE = 4000, 2000       # steps with friction and noise before a part of a run, and of its own dynamics before records
SHAKE = "fix bonds all shake 1e-6 100 0 b 1 a 1; "
DYNAMICS = {
    "nvt": Dynamics("fix 1 all nvt temp {T} {T} {damp}"),
    "npt": Dynamics("fix 1 all npt temp {T} {T} {damp} iso {P} {P} {slow}"),
    "temp/csvr": Dynamics("fix 1 all nve; fix 2 all temp/csvr {T} {T} {damp} {seed}"),
    # temp/csld scales its noise to the kinetic energy of the degrees of freedom that compute temp counts, 3 less than there are
    "temp/csld": Dynamics("fix 1 all nve; fix 2 all temp/csld {T} {T} {damp} {seed}"),
    "langevin": Dynamics("fix 1 all nve; fix 2 all langevin {T} {T} {damp} {seed}", momentum=0),
    "gjf": Dynamics("fix 1 all gjf {T} {T} {damp} {seed}", momentum=0),
    "baoab": Dynamics("fix 1 all baoab {T} {T} {damp} {seed}", momentum=0),
    "shake + nvt": Dynamics(SHAKE + "fix 1 all nvt temp {T} {T} {damp}", constraints=3),
    "shake + npt": Dynamics(SHAKE + "fix 1 all npt temp {T} {T} {damp} iso {P} {P} {slow}", constraints=3),
    "rigid/nvt/small": Dynamics("fix 1 all rigid/nvt/small molecule temp {T} {T} {damp}", constraints=3),
    "temp/berendsen": Dynamics("fix 1 all nve; fix 2 all temp/berendsen {T} {T} {damp}", control=True),
}


@dataclass(frozen=True)
class Run:
    """One simulation: a liquid, its dynamics, and which of the two temperatures and pressures."""

    liquid: str
    dynamics: str
    hot: int = 0
    dense: int = 0
    steps: int = 200000
    start: int = 20000

    @property
    def temperature(self) -> float:
        return LIQUIDS[self.liquid].temperatures[self.hot]

    @property
    def pressure(self) -> float:
        return LIQUIDS[self.liquid].pressures[self.dense]

    @property
    def freedom(self) -> int:
        """Degrees of freedom that carry kinetic energy."""
        liquid, dynamics = LIQUIDS[self.liquid], DYNAMICS[self.dynamics]
        return 3 * liquid.atoms - dynamics.constraints * liquid.molecules - dynamics.momentum

    @property
    def name(self) -> str:
        words = f"{self.liquid} {self.dynamics} {self.temperature:g}" + (f" {self.pressure:g}" if "npt" in self.dynamics else "")
        return words.replace(" + ", "-").replace("/", "-").replace(" ", "-")


def kept(run: Run, folder: Path) -> Path:
    """The file of the records of a run."""
    return folder / f"{run.name}.{run.steps}.npy"


def records(run: Run, folder: Path) -> np.ndarray:
    """Potential energy, kinetic energy, volume: one row each `every` steps after `start` steps; kept in a file of the folder."""
    path = kept(run, folder)
    if path.exists():
        return np.load(path)
    liquid, seed, log = LIQUIDS[run.liquid], zlib.crc32(run.name.encode()) % 90000 + 1, folder / f"{run.name}.log"
    (damp, slow), part = liquid.times, run.steps // liquid.parts
    commands = DYNAMICS[run.dynamics].commands.format(T=run.temperature, P=run.pressure, damp=damp, slow=slow, seed=seed)
    with Lammps(cmdargs=["-log", str(log), "-screen", "none", *prepare(run.liquid, folder)]) as lmp:
        lmp.file(str(HERE / liquid.script))
        lmp.command(f"velocity all create {run.temperature} {seed} mom yes rot no dist gaussian loop geom")
        lmp.commands_list(["thermo_style custom step pe ke vol", "thermo_modify format float %.12g norm no"])
        if liquid.parts == 1:
            lmp.commands_list([*commands.split("; "), f"run {run.start}", f"thermo {liquid.every}", f"run {part}"])
        for k in range(liquid.parts if liquid.parts > 1 else 0):
            lmp.commands_list(["fix 1 all nve", f"fix 2 all langevin {run.temperature} {run.temperature} {2 * damp} {seed + k}", "thermo 0",
                               f"run {STIR if k else run.start}", "unfix 2", "unfix 1", "velocity all zero linear", *commands.split("; "),
                               f"run {SETTLE}", f"thermo {liquid.every}", f"run {part}", "unfix 1"])
    rows = [line.split() for text in log.read_text().split(f"\nrun {part}\n")[1:] for line in text.split("\nLoop time")[0].splitlines()]
    table = np.array([r[1:] for r in rows if len(r) == 4 and r[0].isdigit()], float)
    np.save(path, table)
    return table


def inefficiency(x: np.ndarray, blocks: int = 32) -> int:
    """Rows between independent ones: how much the variance of the means of ever longer blocks exceeds that of independent rows."""
    worst, size = 1.0, 1
    while len(x) // size >= blocks:
        means = x[:len(x) // size * size].reshape(-1, size).mean(axis=1)
        worst, size = max(worst, size * means.var(ddof=1) / x.var()), 2 * size
    return int(np.ceil(worst))
