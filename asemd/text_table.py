"""Tables for people: drawn on a terminal, plain columns elsewhere."""
from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass, field


@dataclass
class Table:
    """A title, column names and rows of text; columns of numbers are set flush right.

    Parameters
    ----------
    title : str
    columns : sequence of str
    rows : list of sequences of str
    """

    title: str
    columns: Sequence[str]
    rows: list[Sequence[str]] = field(default_factory=list)

    def _right(self, k: int) -> bool:
        cells = [r[k] for r in self.rows if r[k]]
        return bool(cells) and all(_is_number(c) for c in cells)

    @property
    def has_numbers(self) -> bool:
        """Whether folding a cell would break a number in two."""
        return any(self._right(k) for k in range(len(self.columns)))

    @property
    def width(self) -> int:
        """Characters of the widest line when drawn."""
        return sum(max(len(r[k]) for r in [self.columns, *self.rows]) + 3 for k in range(len(self.columns)))

    def __str__(self) -> str:
        widths = [max(len(r[k]) for r in [self.columns, *self.rows]) for k in range(len(self.columns))]
        right = [self._right(k) for k in range(len(self.columns))]
        lines = [self.title] if self.title else []
        for row in [self.columns, *self.rows]:
            lines.append("  ".join(c.rjust(w) if r else c.ljust(w) for c, w, r in zip(row, widths, right)).rstrip())
        return "\n".join(lines)

    def rich(self):
        """The same as a `rich.table.Table`."""
        from rich.box import SIMPLE_HEAD
        from rich.table import Table as RichTable
        from rich.text import Text
        table = RichTable(title=self.title or None, title_justify="left", title_style="bold", box=SIMPLE_HEAD, pad_edge=False)
        for k, column in enumerate(self.columns):
            table.add_column(column, justify="right" if self._right(k) else "left", overflow="fold")
        for row in self.rows:
            table.add_row(*(Text(c) for c in row))
        return table


def _is_number(text: str) -> bool:
    try:
        float(text.rstrip("%"))
    except ValueError:
        return text in ("-", "yes", "no")
    return True


def show(parts: Sequence[Table | str]) -> None:
    """Print tables and paragraphs."""
    if sys.stdout.isatty():
        from rich.console import Console
        console = Console(highlight=False, markup=False)
        for k, part in enumerate(parts):
            if k and isinstance(part, str) and isinstance(parts[k - 1], str):
                console.print()
            drawn = isinstance(part, Table) and (part.width <= console.width or not part.has_numbers)
            console.print(part.rich() if drawn else str(part), soft_wrap=not drawn and isinstance(part, Table))
    else:
        print("\n\n".join(map(str, parts)), flush=True)
