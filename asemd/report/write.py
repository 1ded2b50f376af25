"""A report as a folder: Markdown, HTML, CSV, JSON, plots."""
from __future__ import annotations

import math
from pathlib import Path

from asemd.errors import InputError
from asemd.report import advice, plots, text
from asemd.report.result import Report
from asemd.text_table import Table


def write(report: Report, folder: str | Path, system=None, until: float = math.inf) -> Path:
    """Write everything into a folder, which is made if it is not there.

    Parameters
    ----------
    report : Report
    folder : path
    system : asemd.system.System, optional
        Shown on the page.
    until : float
        Reading of ``time.perf_counter`` from which on no more plots are drawn; the report then says which are missing.

    Returns
    -------
    Path
        The folder.

    Raises
    ------
    InputError
        The folder cannot be written; matplotlib is not installed.
    """
    folder = Path(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        report.folder = str(folder)
        report.write_json(folder / "report.json")
        report.write_csv(folder / "report.csv")
        names, missing = plots.draw(report, folder, until)
        if missing:
            report.notes.append(f"Not drawn, for the budget was used: {', '.join(missing)}.")
            report.write_json(folder / "report.json")
        (folder / "report.md").write_text(markdown(report, names), encoding="utf-8")
    except OSError as e:
        raise InputError(f"cannot write {folder}: {e.strerror or e}") from None
    page(report, system).write(folder / "report.html")
    return folder


def markdown(report: Report, names: list[str]) -> str:
    """The report as Markdown, with the plots of these names."""
    out = ["# Error against run time", ""]
    first = True
    for part in text.parts(report, brief=False):
        if isinstance(part, Table):
            out += _markdown_table(part)
            continue
        out += [f"**{part}**" if part == report.recommendation else _escaped(part), ""]
        if part == report.recommendation and first:
            first = False
            out += [f"![{name}]({name}.svg)" for name in names if name.startswith("time-")] + [""]
    out += ["## Plots of single knobs", "", *(f"![{name}]({name}.svg)" for name in names if name.startswith("knob-")), ""]
    return "\n".join(out)


def _escaped(words: str) -> str:
    return words.replace("*", "\\*").replace("|", "\\|").replace("<", "&lt;")


def _markdown_table(table: Table) -> list[str]:
    rows = ["| " + " | ".join(_escaped(c) for c in row) + " |" for row in table.rows]
    return [f"## {table.title}", "", "| " + " | ".join(table.columns) + " |", "|" + " --- |" * len(table.columns), *rows, ""]


def page(report: Report, system=None):
    """The report as `asemd.page.Page`."""
    from asemd.page import Page
    from asemd.page import Series as Drawn
    facts = text.facts(report)
    out = Page("Error against run time", facts[0])
    out.facts({"Atoms": report.atoms, "Script": f"{text.cost(report.script)} us/step", **_gain(report),
               "Budget": f"{report.budget:g} s", "Used": f"{report.seconds:.0f} s"})
    if report.interrupted:
        out.warning("Interrupted: this is what was measured until then.")
    out.text(f"**{_escaped(report.recommendation)}**")
    lines = [line for line in (text.order_line(report), text.wheel_line(report)) if line]
    if report.options and report.best:
        lines.insert(0, f"Run it with `asemd run {' '.join(report.options)} SCRIPT`.")
    if lines:
        out.text("\n\n".join(_escaped(line) for line in lines))
    drawn = plots.pictures(report)
    if drawn:
        out.section("Error against run time")
    for picture in drawn:
        series = [Drawn(line.name + f" ({line.remark})" * line.model, *_sorted(line)) for line in picture.lines]
        here = (*picture.script, "script") if picture.script else None
        floor = picture.tie[1] if picture.tie and picture.name in plots.FLOORS else None
        out.loglog(picture.title, series, picture.xlabel, picture.ylabel, front=True, floor=floor, here=here)
    out.section("Knob by knob")
    for part in text.parts(report, brief=False):
        if isinstance(part, Table):
            out.table(part.columns, part.rows, part.title)
    out.section("How it was measured")
    skip = {report.recommendation, *lines}
    out.text("\n\n".join(_escaped(part) for part in text.parts(report) if isinstance(part, str) and part not in skip))
    if system is not None:
        out.section("The scene")
        out.snapshot(system)
    return out


def _sorted(line: plots.Line):
    """Values by growing run time, as `asemd.page.Series` takes them: x, y, low, high, labels."""
    order = sorted(range(len(line.x)), key=line.x.__getitem__)
    return [line.x[k] for k in order], [line.y[k] for k in order], None, None, [line.labels[k] for k in order]


def _gain(report: Report) -> dict[str, str]:
    return {"Recommended": f"{report.gain:.2f}x faster"} if report.best and report.gain > advice.FASTER else {}
