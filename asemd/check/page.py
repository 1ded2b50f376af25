"""The pages of a check and of the battery: what `asemd check --html` writes."""
from __future__ import annotations

import os
import platform
import time

from asemd import __version__
from asemd.check.report import Report, row_of
from asemd.finding import SEVERITIES
from asemd.page import Page, Series

BY_TIMESTEP = "timestep"      # the first column of tables that are drawn, too


def page_of(report: Report, system=None) -> Page:
    """The page of a report; with `system` it shows the atoms.

    Parameters
    ----------
    report : Report
    system : asemd.system.System, optional

    Returns
    -------
    asemd.page.Page
    """
    page = _page(f"Check of {os.path.basename(report.source) or report.source}")
    page.facts({"Verdict": report.summary()} | {
        {"note": "Notes", "warning": "Warnings", "error": "Errors"}[s]: len(report.of_severity(s)) for s in SEVERITIES[1:]})
    for f in report.at_least("warning"):
        advice = f" What to do: {f.advice}." if f.advice else ""
        page.warning(f"{f.severity.upper()}, {row_of(f)[0]}: {f.message}{advice}")
    page.section("Findings")
    page.table(("check", "found", "value", "limit"), [row_of(f) for f in report])
    notes = [f"- **{row_of(f)[0]}**: {f.message}" + (f" {f.advice}." if f.advice else "") for f in report.of_severity("note")]
    if notes:
        page.text("\n".join(notes))
    for table in report.tables:
        page.section(table.title or "Numbers")
        _curve(page, table)
        page.table(table.columns, table.rows)
    if system is not None and system.n:
        page.section("Atoms")
        page.snapshot(system, note="As the script has them before its first run.")
    if report.left_out:
        page.section("Does not apply")
        page.table(("check", "why"), report.left_out)
    return page


def page_of_battery(result) -> Page:
    """The page of the battery, a `asemd.check.battery.result.Result`."""
    page = _page("Battery of stiff and extreme cases")
    page.facts({"Figures": len(result.lines), "Beyond their limits": len(result.failed), "Seconds": f"{result.seconds:.0f}",
                "LAMMPS": f"{result.version}, {'measured here' if result.live else 'recorded'}"})
    for line in result.failed:
        page.warning(f"FAILED {line.case}, {line.figure}: {line.meaning} {line.why}")
    page.section("Figures")
    page.text("Every figure is an error: smaller is better.")
    table = result.table()
    page.table(table.columns, table.rows)
    page.section("What they mean")
    page.table(("case", "figure", "meaning"), [(line.case, line.figure, line.meaning) for line in result.lines])
    return page


def _page(title: str) -> Page:
    return Page(title, " · ".join((time.strftime("%Y-%m-%d %H:%M"), platform.node(), f"asemd {__version__}")))


def _curve(page: Page, table) -> None:
    """Draw a table of runs by timestep: the fluctuation of the energy, whose slope is the order of the integrator."""
    if table.columns[0] != BY_TIMESTEP:
        return
    good = [(float(row[0]), float(row[1])) for row in table.rows if not row[-1] and float(row[1]) > 0.0]
    if len(good) > 1:
        x, y = zip(*good)
        square = Series("order 2", x, [y[-1] * (a / x[-1]) ** 2 for a in x])
        page.loglog("Fluctuation of the energy", [Series("measured", x, y), square], "timestep", "fluctuation")
