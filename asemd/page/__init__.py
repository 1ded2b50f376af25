"""Pages to look at and to mail: one HTML file with text, tables, curves and a molecule that turns, which needs no network.

The curves are Vega-Lite specifications, drawn in the page by Vega; the molecules are drawn by 3Dmol.js. Both travel in the file, packed.
Static versions of the plots (`Plot.save`) need the Python package vl-convert-python (``pip install asemd[pages]``).
"""
from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from asemd.errors import InputError
from asemd.page import document
from asemd.page.plot import Plot, Series, bar_plot, curve_plot, loglog_plot
from asemd.page.snapshot import describe

__all__ = ["Page", "Plot", "Series"]


class Page:
    """One self-contained HTML page, built from the top down.

    Parameters
    ----------
    title : str
    subtitle : str
        One line under the title: what was done, when, on which machine.

    Attributes
    ----------
    plots : list of Plot
        Every curve, log-log and bar plot so far; each can be saved as SVG or PNG.

    Examples
    --------
    >>> page = Page("Melt", "LJ, 4000 atoms")
    >>> page.section("Thermo")
    >>> plot = page.curve("Temperature", [0, 10, 20], [1.44, 0.91, 0.87], "step", "T")
    >>> page.plots == [plot]
    True
    """

    def __init__(self, title: str, subtitle: str = ""):
        self.title, self.subtitle = title, subtitle
        self.parts: list[document.Part] = []
        self.plots: list[Plot] = []

    def section(self, title: str) -> None:
        """Begin a section: a heading, which the contents at the top of the page link to."""
        self.parts.append(document.Part("section", title))

    def text(self, markdown: str) -> None:
        """Add a text in Markdown (CommonMark with tables); HTML in it is shown as it is typed."""
        self.parts.append(document.Part("text", "", document.markdown(markdown), wide=True))

    def warning(self, message: str) -> None:
        """Add a box that stands out, with plain text."""
        self.parts.append(document.Part("warning", "", document.escape(message), wide=True))

    def facts(self, facts: Mapping[str, Any]) -> None:
        """Add a row of tiles: name -> short value."""
        self.parts.append(document.Part("facts", "", document.tiles(facts), wide=True))

    def table(self, columns: Sequence[str], rows: Sequence[Sequence[Any]], title: str = "", note: str = "") -> None:
        """Add a table; cells are written with ``str``, numbers flush right.

        Parameters
        ----------
        columns : sequence of str
        rows : sequence of sequences
            Each as long as `columns`.
        title, note : str
            Above and below the table.

        Raises
        ------
        InputError
            A row with more or fewer cells than there are columns.
        """
        for row in rows:
            if len(row) != len(columns):
                raise InputError(f"table {title or columns[0]!r}: a row has {len(row)} cells for {len(columns)} columns")
        self.parts.append(document.Part("table", title, document.table(columns, rows), note, wide=True))

    def curve(self, title: str, x, y, xlabel: str = "", ylabel: str = "", *, band: Mapping[str, tuple] | None = None,
              limits: tuple[float, float] | None = None, wide: bool = False, note: str = "") -> Plot:
        """Add curves over a common axis.

        Parameters
        ----------
        title : str
        x : (n,) array
        y : (n,) array or mapping of name -> (n,) array
            nan leaves a gap. Long curves are thinned; their extremes stay.
        xlabel, ylabel : str
            With units.
        band : mapping, optional
            Name of a curve -> (low (n,), high (n,)), drawn as a shade.
        limits : (low, high), optional
            What the axis of y shows; curves are cut off there.
        wide : bool
            As wide as the page, instead of two in a row.
        note : str
            A line under the plot.
        """
        curves = y if isinstance(y, Mapping) else {ylabel or title: y}
        curves = {name: np.asarray(values, float) for name, values in curves.items()}
        return self._plot(curve_plot(title, np.asarray(x, float), curves, xlabel, ylabel, band, limits), wide, note)

    def loglog(self, title: str, series: Sequence[Series], xlabel: str = "", ylabel: str = "", *, front: bool = False,
               floor: float | None = None, here: tuple[float, float, str] | None = None, wide: bool = True, note: str = "") -> Plot:
        """Add a plot with logarithmic axes, such as error against run time.

        Parameters
        ----------
        title : str
        series : sequence of Series
        xlabel, ylabel : str
            With units.
        front : bool
            Mark the Pareto front over all series: the points which no other point beats in both x and y.
        floor : float, optional
            Values of y below it are within the sampling noise: that region is shaded.
        here : (x, y, text), optional
            A point that is named in the plot, such as the settings in use.
        wide : bool
            As wide as the page, instead of two in a row.
        note : str
            A line under the plot.

        Raises
        ------
        InputError
            No point is positive in both x and y.
        """
        return self._plot(loglog_plot(title, series, xlabel, ylabel, front, floor, here), wide, note)

    def bars(self, title: str, values: Mapping[str, float], xlabel: str = "", *, wide: bool = False, note: str = "") -> Plot:
        """Add horizontal bars, one for each name."""
        return self._plot(bar_plot(title, values, xlabel), wide, note)

    def _plot(self, plot: Plot, wide: bool, note: str) -> Plot:
        plot.name = f"{len(self.plots) + 1:02d}-{plot.name}"
        self.plots.append(plot)
        self.parts.append(document.Part("plot", plot.title, document.figure(plot), note, wide))
        return plot

    def snapshot(self, system, title: str = "", *, note: str = "", wide: bool = True) -> None:
        """Add atoms, bonds and box, to turn with mouse or finger.

        Parameters
        ----------
        system : asemd.System or ase.Atoms
            Elements have their colours where type labels or masses tell them, else each type has its own. Atoms are shown in the box, and
            bonds that cross its periodic faces end half-way on both sides. Of more than 100,000 atoms a part is shown.
        title, note : str
        wide : bool
            As wide as the page, instead of two in a row.
        """
        self.parts.append(document.Part("snapshot", title, document.viewer(describe(system)), note, wide))

    def html(self) -> str:
        """The page as text."""
        return document.render(self.title, self.subtitle, self.parts)

    def write(self, path: str | os.PathLike) -> Path:
        """Write the page to a file; returns its path.

        Raises
        ------
        InputError
            The file cannot be written.
        """
        path = Path(path)
        try:
            path.write_text(self.html(), encoding="utf-8")
        except OSError as e:
            raise InputError(f"cannot write {path}: {e.strerror}") from None
        return path

    def save_plots(self, folder: str | os.PathLike, formats: Sequence[str] = ("svg", "png")) -> list[Path]:
        """Write every plot into a folder, as ``01-name.svg`` and so on; returns the paths. See `Plot.save`."""
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        return [plot.save(folder / f"{plot.name}.{form}") for plot in self.plots for form in formats]
