"""The commands ``asemd validate plan symmetry styles doctor``: they look at things and run no simulation of the user's."""
from __future__ import annotations

import json
import sys
from typing import Annotated

import typer

from asemd.errors import InputError
from asemd.lammps.switches import Switches, one_of

Json = Annotated[bool, typer.Option("--json", help="Print JSON.")]
Tolerance = Annotated[float | None, typer.Option(help="Largest relative difference that counts as agreement [1e-9].", min=0.0)]
Script = Annotated[str | None, typer.Argument(help="LAMMPS input script.")]
Compat = Annotated[str | None, typer.Option(help="lammps: its tables of charges, its forces that are no gradient.")]
Precision = Annotated[str, typer.Option(help="double, or mixed: pair forces in single precision.")]
Import = Annotated[list[str] | None, typer.Option("--import", help="Python file with styles of your own.")]
Threads = Annotated[int, typer.Option(help="Number of threads.", min=1)]


def set_up(context: typer.Context, script: str | None, command: str, compat: str | None, precision: str,
           threads: int) -> tuple[str, Switches]:
    """The script and LAMMPS's switches with asemd's options added."""
    switches: Switches = context.obj or Switches()
    if compat is not None:
        switches.compat = one_of(compat, ("lammps",), "--compat")
    switches.precision, switches.threads = one_of(precision, ("double", "mixed"), "--precision"), threads
    path = script or switches.input
    if path is None:
        raise InputError(f"asemd {command} needs a script: asemd {command} in.file")
    return path, switches


def print_parts(parts, data: dict, as_json: bool) -> None:
    from asemd.text_table import show
    if as_json:
        print(json.dumps(data, indent=1))
    else:
        show(parts)


def validate(context: typer.Context, script: Script = None,
             steps: Annotated[int, typer.Option(help="Limit on the steps of every run.", min=0)] = 20,
             tolerance: Tolerance = None, compat: Compat = None, precision: Precision = "double", threads: Threads = 1,
             import_: Import = None, as_json: Json = False) -> int:
    """Compare a script's energies, forces, virials and thermo rows with real LAMMPS; exit status 1 if they disagree."""
    from asemd.testing.validate import validate as compare
    path, switches = set_up(context, script, "validate", compat, precision, threads)
    from asemd.cli import import_files
    import_files(import_)
    report = compare(path, steps=steps, tolerance=tolerance, precision=precision, threads=threads, switches=switches)
    print_parts(report.parts(), report.to_dict(), as_json)
    return 0 if report.ok else 1


def plan(context: typer.Context, script: Script = None, compat: Compat = None, precision: Precision = "double", threads: Threads = 1,
         import_: Import = None,
         calibrate: Annotated[bool, typer.Option("--calibrate", help="Measure the speed of this machine (up to a minute; it is kept), "
                                                 "for the expected steps per second.")] = False,
         as_json: Json = False) -> int:
    """Print what a script's scene needs, what it will cost, what is left out, and why; no step of it is run."""
    from asemd.lammps import calibration
    from asemd.lammps.plan import of_script
    path, switches = set_up(context, script, "plan", compat, precision, threads)
    from asemd.cli import import_files
    import_files(import_)
    found = of_script(path, switches)
    if calibrate:
        print("Measuring the speed of this machine: some seconds, up to a minute if kernels have to be compiled ...", file=sys.stderr)
        calibration.calibrate(threads, precision, again=True)
        found = of_script(path, switches)
    print_parts(found.parts(), found.to_dict(), as_json)
    return 0


def symmetry(context: typer.Context, script: Annotated[str | None, typer.Argument(help="LAMMPS input script or data file.")] = None,
             tolerance: Annotated[float, typer.Option(help="How far an atom may be from its place, Angstrom.")] = 1e-5,
             as_json: Json = False) -> int:
    """Print the space group of a script's atoms, by their types and bonds, as they stand before the first run."""
    from asemd.interop.symmetry import Symmetry
    from asemd.lammps import convert
    from asemd.lammps.read import head, is_data, read
    path, switches = set_up(context, script, "symmetry", None, "double", 1)
    found = Symmetry(read(path) if is_data(head(path)) else convert.read(path, switches), tolerance)
    print_parts(found.parts(), found.to_dict(), as_json)
    return 0


def styles(category: Annotated[str | None, typer.Argument(help="A category (pair, fix, ...).")] = None,
           word: Annotated[str, typer.Option(help="Only names with this text.")] = "",
           state: Annotated[str, typer.Option(help="Only done, partial, missing or extra.")] = "", as_json: Json = False) -> int:
    """List every LAMMPS name as done, partial or missing."""
    from asemd.lammps.coverage import coverage, parts, to_dict
    names = coverage(category, word, state)
    print_parts(parts(names, detailed=bool(category or word or state)), to_dict(names), as_json)
    return 0


def doctor(as_json: Json = False) -> int:
    """Print versions, the processor, the kernel cache and whether LAMMPS starts here; exit status 1 if something is wrong."""
    from asemd.doctor import examine, parts
    facts = examine()
    print_parts(parts(facts), {f.name: {"value": f.value, "ok": f.ok, "advice": f.advice} for f in facts}, as_json)
    return 0 if all(f.ok or f.optional for f in facts) else 1
