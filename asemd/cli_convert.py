"""The command ``asemd convert``: the same scene in another form."""
from __future__ import annotations

import warnings
from typing import Annotated

import typer

from asemd.errors import InputError, InputWarning
from asemd.lammps.switches import Switches, one_of


def convert(context: typer.Context,
            script: Annotated[str | None, typer.Argument(help="LAMMPS input script.")] = None,
            to: Annotated[str, typer.Option(help="lammps, python, ase or data.")] = "lammps",
            output: Annotated[str | None, typer.Option("--output", "-o", help="Folder (lammps, python) or file (ase, data); by default the "
                                                                              "folder converted or a file in it.")] = None,
            import_: Annotated[list[str] | None, typer.Option("--import", help="Python file with styles of your own.")] = None,
            ) -> int:
    """Write a script, as it stands before its first run, as LAMMPS script with data file, ASE script, ASE file or data file."""
    from asemd.cli import import_files
    from asemd.lammps.convert import FORMS
    from asemd.lammps.convert import convert as write
    switches: Switches = context.obj or Switches()
    form = one_of(to, FORMS, "--to")
    path = script or switches.input
    if path is None:
        raise InputError("asemd convert needs a script: asemd convert in.file --to lammps")
    import_files(import_)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", InputWarning)
        written = write(path, form, output, switches)
    for warning in caught:
        print(f"WARNING: {warning.message}")
    print(f"wrote {written}" + (f" (run it in {written.parent}, where its files are)" if form == "lammps" else ""))
    return 0

