"""What a comparison with LAMMPS found: energies, forces, virials and thermo rows, as data and as text."""
from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any

from asemd.testing.thermo_rows import Cell
from asemd.text_table import Table

VIRIAL = ("xx", "yy", "zz", "xy", "xz", "yz")


@dataclass
class Energy:
    """One energy, in units of the scene; `error` relative to its size (at least a thousandth of all energies)."""

    term: str
    asemd: float
    lammps: float
    error: float


@dataclass
class Force:
    """Forces and virial of one category of terms, or of all.

    `largest` is the largest force component of LAMMPS, `worst` and `rms` the differences (force units), `error` is `worst` relative to
    `scale`; `virial_asemd`, `virial_lammps` (6,): xx yy zz xy xz yz, energy units, `virial_error` relative to the size of the virials.
    """

    term: str
    largest: float
    worst: float
    rms: float
    error: float
    virial_asemd: list[float]
    virial_lammps: list[float]
    virial_error: float


@dataclass
class Report:
    """The result of `validate`; ``print(report)`` shows it.

    Attributes
    ----------
    source : str
    atoms : int
    units : str
    version : str
        Of LAMMPS.
    tolerance : float
        Largest relative difference that counts as agreement.
    scale : float
        What force differences are relative to: the largest force, or the force that the virial of an atom means if that is larger.
    energies, forces, rows : list
        Rows of the three tables.
    notes : list of str
        What was not compared, and why.
    documented : list of str
        Differences to LAMMPS that are meant; for those that say so ``compat="lammps"`` takes LAMMPS's side.
    failures : list of str
        What ended one of the programs.
    """

    source: str
    atoms: int
    units: str
    version: str
    tolerance: float
    scale: float
    energies: list[Energy] = field(default_factory=list)
    forces: list[Force] = field(default_factory=list)
    rows: list[Cell] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    documented: list[str] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)

    def _errors(self) -> list[tuple[float, str]]:
        """All relative differences, and of what; of equal ones the first counts."""
        return [*((f.error, f"forces of {f.term}") for f in self.forces), *((f.virial_error, f"virial of {f.term}") for f in self.forces),
                *((e.error, f"energy of {e.term}") for e in self.energies),
                *((r.error, f"{r.column} at step {r.step} of run {r.run + 1}") for r in self.rows)]

    @property
    def worst(self) -> float:
        """The largest relative difference."""
        return max((error for error, _ in self._errors()), default=0.0)

    @property
    def worst_term(self) -> str:
        """What differs most; empty if nothing was compared."""
        return max(self._errors(), key=lambda of: of[0], default=(0.0, ""))[1]

    @property
    def ok(self) -> bool:
        """Whether asemd and LAMMPS agree."""
        return not self.failures and self.worst <= self.tolerance

    def parts(self) -> list[Table | str]:
        """Tables and paragraphs, in order."""
        out: list[Table | str] = [f"{self.source}: {self.atoms} atoms, units {self.units}, asemd and LAMMPS {self.version}"]
        table = Table("Energies at the first step", ("term", "asemd", "LAMMPS", "difference", "relative"))
        for e in self.energies:
            table.rows.append((e.term, f"{e.asemd:.15g}", f"{e.lammps:.15g}", f"{e.asemd - e.lammps:.2g}", f"{e.error:.1e}"))
        if self.forces:
            out.append(table)
            out.append(Table("Forces and virials at the first step",
                             ("term", "largest force", "max difference", "rms difference", "relative", "virial difference", "relative"),
                             [(f.term, f"{f.largest:.6g}", f"{f.worst:.2g}", f"{f.rms:.2g}", f"{f.error:.1e}",
                               f"{max(abs(a - b) for a, b in zip(f.virial_asemd, f.virial_lammps)):.2g}", f"{f.virial_error:.1e}")
                              for f in self.forces]))
            ours, theirs = self.forces[-1].virial_asemd, self.forces[-1].virial_lammps
            out.append(Table("Virial of all terms", ("", *VIRIAL), [
                ("asemd", *(f"{v:.10g}" for v in ours)), ("LAMMPS", *(f"{v:.10g}" for v in theirs)),
                ("difference", *(f"{a - b:.2g}" for a, b in zip(ours, theirs)))]))
        out += self._row_tables()
        out += [f"Note: {n}" for n in self.notes] + [f"Documented difference: {d}" for d in self.documented] + self.failures
        return [*out, self.verdict]

    def _row_tables(self) -> list[Table]:
        tables = []
        for run in dict.fromkeys(r.run for r in self.rows):
            cells = [r for r in self.rows if r.run == run]
            columns = list(dict.fromkeys(c.column for c in cells))
            table = Table(f"Thermo rows of run {run + 1}", ("Step", "", *columns))
            for step in dict.fromkeys(c.step for c in cells):
                row = {c.column: c for c in cells if c.step == step}
                for name in ("asemd", "LAMMPS", "relative"):
                    table.rows.append((str(step) if name == "asemd" else "", name, *(_shown(row.get(c), name) for c in columns)))
            tables.append(table)
        return tables

    @property
    def verdict(self) -> str:
        """The last line."""
        if self.failures:
            return "DISAGREE: the two programs did not both get to the end"
        text = f"the largest relative difference is {self.worst:.1e}"
        if self.ok:
            return f"AGREE: {text}, the tolerance {self.tolerance:g}"
        switch = "; --compat lammps compares with LAMMPS's own forces" if any("--compat lammps" in d for d in self.documented) else ""
        return f"DISAGREE: {text} ({self.worst_term}), the tolerance {self.tolerance:g}{switch}"

    def __str__(self) -> str:
        return "\n\n".join(map(str, self.parts()))

    def to_dict(self) -> dict[str, Any]:
        """Everything, JSON-able."""
        return {"ok": self.ok, "worst": self.worst, "verdict": self.verdict, **asdict(self)}


def _shown(cell: Cell | None, name: str) -> str:
    return "" if cell is None else f"{cell.error:.0e}" if name == "relative" else f"{getattr(cell, name.lower()):.10g}"
