"""The command ``asemd check``."""
from __future__ import annotations

from typing import Annotated

import typer

from asemd.cli_inspect import Compat, Import, Json, Precision, Script, Threads, print_parts, set_up
from asemd.errors import InputError


def check(context: typer.Context, script: Script = None,
          run: Annotated[bool, typer.Option("--run", help="Short runs on copies: drift, reversibility, where it blows up.")] = False,
          budget: Annotated[float, typer.Option(help="Seconds for --run, without compilation.", min=1.0)] = 60.0,
          battery: Annotated[bool, typer.Option("--battery", help="Stiff and extreme cases with known answers; needs no script.")] = False,
          force: Annotated[bool, typer.Option("--force", help="A timestep that no integrator stands is a warning, not an error.")] = False,
          compat: Compat = None, precision: Precision = "double", threads: Threads = 1, import_: Import = None,
          html: Annotated[str | None, typer.Option(help="Write a page of it to look at or to mail.")] = None,
          as_json: Json = False) -> int:
    """Look for what may make a script's run unstable or wrong; exit status 0 when fine or with warnings, 2 on an error."""
    from asemd.cli import check_page, import_files
    if html:
        check_page(html)
    system = None
    if battery:
        if script or run:
            raise InputError("asemd check --battery has scenes of its own: it goes without a script and without --run")
        from asemd.check import battery as cases
        report = cases.run()
    else:
        from asemd.check import of_case
        from asemd.check.stages import of_script
        path, switches = set_up(context, script, "check", compat, precision, threads)
        import_files(import_)
        case = of_script(path, switches)
        case.force, system = force, case.system
        report = of_case(case, run, **({"budget": budget} if run else {}))
    if html:
        from asemd.check.page import page_of, page_of_battery
        (page_of_battery(report) if battery else page_of(report, system)).write(html)
    print_parts(report.parts(), report.to_dict(), as_json)
    return report.exit_status
