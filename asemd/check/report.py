"""The report of a check: its findings as a table and as sentences, as JSON, and as an exit status."""
from __future__ import annotations

import math
import shutil
import textwrap
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from typing import Any

from asemd.finding import SEVERITIES, Finding
from asemd.text_table import Table

FAILED = 2
CAUSES = ("units", "bond limits", "exclusions", "rest lengths")      # other findings, errors too, may follow from these
WIDTH = 100


@dataclass
class Report:
    """What a check of a scene, an experiment or the battery found; ``print(report)`` shows it.

    Attributes
    ----------
    source : str
        The scene.
    findings : list of Finding
        In the order of the checks.
    left_out : list of (str, str)
        Checks that do not apply, and why.
    tables : list of asemd.text_table.Table
        Further numbers, shown after the findings.
    """

    source: str
    findings: list[Finding] = field(default_factory=list)
    left_out: list[tuple[str, str]] = field(default_factory=list)
    tables: list[Table] = field(default_factory=list)

    def __iter__(self):
        return iter(self.findings)

    def __len__(self) -> int:
        return len(self.findings)

    def extend(self, other: Report | Iterable[Finding]) -> None:
        """Add the findings of another report, or single ones."""
        self.findings += list(other)
        if isinstance(other, Report):
            self.left_out += other.left_out
            self.tables += other.tables

    def of(self, name: str) -> list[Finding]:
        """The findings of one check."""
        return [f for f in self.findings if f.name == name]

    def of_severity(self, severity: str) -> list[Finding]:
        """The findings of one severity."""
        return [f for f in self.findings if f.severity == severity]

    def at_least(self, severity: str) -> list[Finding]:
        """Findings of this severity or a worse one, the worst first; before them warnings of what may have caused them."""
        rank, worst = SEVERITIES.index(severity), max((f.rank for f in self.findings), default=0)

        def order(f: Finding) -> tuple[int, bool]:
            cause = f.name in CAUSES and f.severity == "warning"
            return -worst if cause else -f.rank, not cause
        return sorted((f for f in self.findings if f.rank >= rank), key=order)

    @property
    def worst(self) -> str:
        """The worst severity; ``ok`` without findings."""
        return max((f.severity for f in self.findings), key=SEVERITIES.index, default="ok")

    @property
    def ok(self) -> bool:
        """No error among the findings."""
        return self.worst != "error"

    @property
    def exit_status(self) -> int:
        """0 when fine or with warnings, 2 on an error."""
        return 0 if self.ok else FAILED

    def summary(self) -> str:
        """How many of each: ``1 error, 2 warnings``."""
        count = {s: sum(f.severity == s for f in self.findings) for s in SEVERITIES}
        words = [f"{count[s]} {s}{'s' * (count[s] != 1)}" for s in reversed(SEVERITIES[1:]) if count[s]]
        return ", ".join([*words, f"{count['ok']} fine"] if count["ok"] else words) or "nothing was checked"

    def parts(self, width: int = 0) -> list[Table | str]:
        """A table with a row for each finding, what is worth reading about them in sentences, further tables."""
        width = width or min(WIDTH, shutil.get_terminal_size((WIDTH, 24)).columns)
        table = Table("", ("check", "found", "value", "limit"), [row_of(f) for f in self.findings])
        out: list[Table | str] = [f"Check of {self.source}: {self.summary()}", table] if self.findings else [f"Check of {self.source}"]
        out += [_paragraph(f, width) for f in self.at_least("note")]
        if self.left_out:
            text = "; ".join(f"{name} ({why})" for name, why in self.left_out)
            out.append(textwrap.fill(f"Does not apply: {text}.", width, subsequent_indent="  ", break_long_words=False))
        return [*out, *self.tables]

    def __str__(self) -> str:
        return "\n\n".join(map(str, self.parts()))

    def to_dict(self) -> dict[str, Any]:
        """Everything, JSON-able; numbers that are not finite are None."""
        return {"source": self.source, "worst": self.worst, "exit_status": self.exit_status,
                "findings": [asdict(f) | {"value": _plain(f.value), "limit": _plain(f.limit)} for f in self.findings],
                "left_out": [{"name": name, "why": why} for name, why in self.left_out],
                "tables": [{"title": t.title, "columns": list(t.columns), "rows": [list(r) for r in t.rows]} for t in self.tables]}


def row_of(f: Finding) -> tuple[str, str, str, str]:
    """A finding as a row: check, found, value, limit."""
    return _name(f), "ok" if f.severity == "ok" else f.severity.upper(), _text(f.value), _text(f.limit)


def _name(f: Finding) -> str:
    return f"{f.name} ({f.where})" if f.where else f.name


def _text(value: float | str | None) -> str:
    return "" if value is None else value if isinstance(value, str) else f"{value:.4g}"


def _plain(value):
    if value is None or isinstance(value, str):
        return value
    return float(value) if math.isfinite(value) else None


def _paragraph(f: Finding, width: int) -> str:
    head = f"{f.severity.upper():8} "
    lines = textwrap.wrap(f"{_name(f)}: {f.message}", width - len(head), break_long_words=False)
    if f.advice:
        lines += textwrap.wrap(f"What to do: {f.advice}", width - len(head), break_long_words=False)
    return head + ("\n" + " " * len(head)).join(lines)
