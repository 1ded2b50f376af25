"""Thermo rows of asemd and of LAMMPS, column by column."""
from __future__ import annotations

from dataclasses import dataclass

from asemd import units as unit_styles
from asemd.system import System
from asemd.testing.lammps_side import ROWS
from asemd.testing.oracle import ask

FAMILIES = dict.fromkeys(("PotEng", "KinEng", "TotEng", "Enthalpy", "Ecouple", "Econserve"), "energy") | dict.fromkeys(
    ("Press", "Pxx", "Pyy", "Pzz", "Pxy", "Pxz", "Pyz"), "pressure") | {"Temp": "temperature", "Fmax": "force", "Fnorm": "force"}
CLOCK = frozenset(("CPU", "T/CPU", "S/CPU", "CPULeft", "TimeoutLeft", "Nbuild", "Ndanger", "Part"))


@dataclass
class Cell:
    """One column of one thermo row."""

    run: int
    step: int
    column: str
    asemd: float
    lammps: float
    error: float


def compare(report, session, switches: list[str], least: dict[str, float]) -> None:
    """Let LAMMPS carry out the commands of a `Recorder` and add what differs to the report; `least` is of `floors`."""
    theirs = ask(ROWS, commands=session.commands, switches=switches, timeout=3600)
    if "error" in theirs and "compatible time" in theirs["error"] and theirs["command"] in session.runs:
        report.notes.append(f"LAMMPS ends shortened runs ({theirs['command']}) between two results of an average: {theirs['error']}")
    elif "error" in theirs:
        report.failures.append(f"LAMMPS stopped at {theirs['command']!r}: {theirs['error']}")
    pairs = _paired(session.rows, theirs["rows"])
    if len(pairs) < len(session.rows) and "error" not in theirs:
        report.notes.append(f"{len(session.rows) - len(pairs)} thermo rows of asemd have no row of LAMMPS to compare with (a minimisation "
                            "that ends elsewhere)")
    columns = {c for *_, a, b in pairs for c in a if c in b} - CLOCK - {"Step"}
    sizes = {c: max((abs(float(r[c])) for *_, a, b in pairs for r in (a, b) if c in r), default=0.0) for c in columns}
    for column in columns:        # a small number among energies (pressures) is as uncertain as a large one
        family = FAMILIES.get(column, "energy" if column.startswith("E_") else column)
        sizes[column] = max(sizes[column], 1e-3 * least.get(family, 0.0))
    for run, step, a, b in pairs:
        for column, value in a.items():
            if column in columns and column in b:
                x, y = float(value), float(b[column])
                report.rows.append(Cell(run, step, column, x, y, relative(x, y, sizes[column])))


def _paired(ours: list, theirs: list) -> list[tuple[int, int, dict, dict]]:
    """Run, step and rows of the same step; by their order where LAMMPS's have no column Step, if they are equally many."""
    out = []
    for run in dict.fromkeys(run for run, *_ in ours):
        mine, other = [row for row in ours if row[0] == run], [row for of, row in theirs if of == run]
        if all("Step" in row for row in other):
            by_step = {int(row["Step"]): row for row in other}
            out += [(*row, by_step[row[1]]) for row in mine if row[1] in by_step]
        elif len(mine) == len(other):
            out += [(*a, b) for a, b in zip(mine, other)]
    return out


def floors(system: System, norm: bool, energies: float, virials: float, force: float) -> dict[str, float]:
    """Sizes of energies, pressures, temperatures and forces of a scene: what small values of thermo columns are compared with."""
    u, n = unit_styles.get(system.units), max(system.n, 1)
    return {"energy": energies / n if norm else energies, "pressure": virials / system.box.volume * u.nktv2p,
            "temperature": energies / n / u.boltz, "force": force}


def relative(a: float, b: float, scale: float) -> float:
    """Difference by size; infinite if one of the two is not a number."""
    if a != a or b != b:
        return 0.0 if a != a and b != b else float("inf")
    return abs(a - b) / max(scale, 1e-300)
