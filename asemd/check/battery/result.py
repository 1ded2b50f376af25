"""What the battery found: lines with figure, limit, LAMMPS's figure and verdict, as a table, as sentences and as JSON."""
from __future__ import annotations

import math
import shutil
import textwrap
from dataclasses import asdict, dataclass
from typing import Any

from asemd.text_table import Table

FAILED = 2


@dataclass
class Line:
    """One figure of one case.

    Attributes
    ----------
    case, figure : str
    limit : float
        From theory: what the figure may be at most.
    value : float or None
        asemd's; None: there is none, `why` says why.
    meaning : str
    lammps : float or None
        LAMMPS's figure; None: it has none, `lammps_why` says why if it is known.
    seconds : float
        Processor time of the whole case.
    """

    case: str
    figure: str
    limit: float
    value: float | None
    meaning: str
    why: str = ""
    lammps: float | None = None
    lammps_why: str = ""
    seconds: float = 0.0

    @property
    def ok(self) -> bool:
        """Within the limit; nothing and nan are not."""
        return self.value is not None and self.value <= self.limit


@dataclass
class Result:
    """The battery; ``print(result)`` shows it.

    Attributes
    ----------
    lines : list of Line
    version : str
        Of LAMMPS.
    live : bool
        Its figures were measured now, on this machine; otherwise they are recorded ones.
    seconds : float
        Wall time.
    """

    lines: list[Line]
    version: str
    live: bool
    seconds: float

    @property
    def ok(self) -> bool:
        """Every figure is within its limit."""
        return all(line.ok for line in self.lines)

    @property
    def exit_status(self) -> int:
        """0, or 2 if a figure is beyond its limit."""
        return 0 if self.ok else FAILED

    @property
    def failed(self) -> list[Line]:
        return [line for line in self.lines if not line.ok]

    def table(self) -> Table:
        """The figures."""
        rows, last = [], ""
        for line in self.lines:
            rows.append(("" if line.case == last else line.case, line.figure, number(line.value, line.why), number(line.limit),
                         number(line.lammps, line.lammps_why), "ok" if line.ok else "FAILED"))
            last = line.case
        return Table("", ("case", "figure", "asemd", "limit", "LAMMPS", "verdict"), rows)

    def parts(self, width: int = 0) -> list[Table | str]:
        """The table, and in words: what failed, then what each figure means."""
        width = width or min(100, shutil.get_terminal_size((100, 24)).columns)
        bad = len(self.failed)
        verdict = f"{bad} beyond the limit" if bad else "all within their limits"
        head = f"Battery: {len(self.lines)} figures, {verdict} ({self.seconds:.0f} s). LAMMPS {self.version}, " \
               f"{'measured here' if self.live else 'recorded'}. Every figure is an error: smaller is better."
        out: list[Table | str] = [textwrap.fill(head, width), self.table()]
        for line in self.failed:
            value = f"the figure is {number(line.value)}, the limit {number(line.limit)}" if line.value is not None else \
                    f"no figure: {line.why or 'it was not measured'}"
            out.append(textwrap.fill(f"FAILED   {line.case}, {line.figure}: {value}. {line.meaning}", width, subsequent_indent=" " * 9))
        stopped = dict.fromkeys(f"{line.case} ({line.lammps_why})" for line in self.lines if line.lammps is None and line.lammps_why)
        if stopped:
            out.append(textwrap.fill(f"LAMMPS stopped in: {'; '.join(stopped)}", width, subsequent_indent="  "))
        out.append("\n".join(textwrap.fill(f"{line.case}, {line.figure}: {line.meaning}", width, subsequent_indent="  ")
                             for line in self.lines))
        return out

    def __str__(self) -> str:
        return "\n\n".join(map(str, self.parts()))

    def to_dict(self) -> dict[str, Any]:
        """Everything, JSON-able; numbers that are not finite are words."""
        def plain(value):
            return str(value) if isinstance(value, float) and not math.isfinite(value) else value
        lines = [{key: plain(value) for key, value in asdict(line).items()} | {"ok": line.ok} for line in self.lines]
        return {"ok": self.ok, "exit_status": self.exit_status, "lammps": self.version, "lammps_measured_here": self.live,
                "seconds": self.seconds, "figures": lines}


def number(value: float | None, why: str = "") -> str:
    """A figure as text."""
    if value is None:
        return "stopped" if why else "-"
    return f"{value:.2g}"
