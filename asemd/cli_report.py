"""The command ``asemd report``."""
from __future__ import annotations

import json
import sys
from typing import Annotated

import typer

from asemd.errors import InputError
from asemd.lammps.switches import Switches, one_of

INTERRUPTED = 130


def report(context: typer.Context,
           script: Annotated[str | None, typer.Argument(help="LAMMPS input script.")] = None,
           budget: Annotated[float, typer.Option(help="Wall time in seconds, compilation not counted.", min=1.0)] = 60.0,
           at: Annotated[int | None, typer.Option(help="The run of the script to measure at, from 1 [the last one].", min=1)] = None,
           folder: Annotated[str | None, typer.Option(help="Where the report goes [report-NAME].")] = None,
           apply: Annotated[str | None, typer.Option(help="Write the script with the recommended settings.")] = None,
           knob: Annotated[list[str] | None, typer.Option(help="Turn only this knob (may be given several times).")] = None,
           seed: Annotated[int, typer.Option(help="Of everything random.", min=0)] = 1,
           tolerance: Annotated[float, typer.Option(help="Relative force error that counts as none.")] = 1e-5,
           lammps: Annotated[bool, typer.Option("--lammps/--no-lammps", help="Compare with real LAMMPS if it is installed.")] = True,
           threads: Annotated[int, typer.Option(help="Number of threads.", min=1)] = 1,
           precision: Annotated[str, typer.Option(help="double, or mixed: pair forces in single precision.")] = "double",
           compat: Annotated[str | None, typer.Option(help="lammps: its tables of charges, its forces that are no gradient.")] = None,
           import_: Annotated[list[str] | None, typer.Option("--import", help="Python file with styles of your own.")] = None,
           as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False) -> int:
    """Measure error against run time over the settings that trade one for the other, and recommend; writes a folder with plots."""
    from asemd.cli import import_files
    from asemd.report import report as measure
    from asemd.report.course import name_of
    from asemd.report.text import parts
    from asemd.text_table import show
    switches: Switches = context.obj or Switches()
    if compat is not None:
        switches.compat = one_of(compat, ("lammps",), "--compat")
    switches.precision, switches.threads = one_of(precision, ("double", "mixed"), "--precision"), threads
    path = script or switches.input
    if path is None:
        raise InputError("asemd report needs a script: asemd report in.file")
    import_files(import_)
    with Bar(budget) as bar:
        found = measure(path, budget, at=at, folder=folder or f"report-{name_of(path)}", apply=apply, only=knob or None, seed=seed,
                        tolerance=tolerance, lammps=lammps, switches=switches, tell=bar.tell)
    if as_json:
        print(json.dumps(found.to_dict(), indent=1))
    else:
        show([*parts(found), f"Written: {found.folder}/report.html, report.md, report.csv, report.json and plots"
              + (f"; {apply}" if apply else "")])
    return INTERRUPTED if found.interrupted else 0


class Bar:
    """A progress bar with the time that is left, where there is a terminal."""

    def __init__(self, budget: float):
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
        self.progress = Progress(BarColumn(), TextColumn("{task.percentage:3.0f}%"), TimeElapsedColumn(), TextColumn("of"),
                                 TimeRemainingColumn(), TextColumn("{task.description}"), console=Console(stderr=True), transient=True,
                                 disable=not sys.stderr.isatty())
        self.task = self.progress.add_task("reading the script", total=budget)

    def tell(self, done: float, total: float, what: str) -> None:
        """That many seconds of the total are used."""
        self.progress.update(self.task, completed=done, total=total, description=what)

    def __enter__(self):
        self.progress.start()
        return self

    def __exit__(self, *error) -> None:
        self.progress.stop()
