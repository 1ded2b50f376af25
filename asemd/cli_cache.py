"""The commands ``asemd cache`` and ``asemd cite``."""
from __future__ import annotations

import sys
from typing import Annotated

import typer

from asemd.cli_inspect import Import, Json, Precision, Script, Threads, print_parts, set_up
from asemd.errors import InputError
from asemd.lammps.switches import one_of

ACTIONS = ("show", "warm", "clear")


def cache(context: typer.Context,
          action: Annotated[str, typer.Argument(help="show, warm or clear.")] = "show", script: Script = None,
          yes: Annotated[bool, typer.Option("--yes", help="Clear without asking.")] = False,
          precision: Precision = "double", threads: Threads = 1, import_: Import = None, as_json: Json = False) -> int:
    """Show the cache of compiled kernels, fill it with what a script needs (asemd cache warm in.file), or clear it."""
    from asemd import cache as kernels
    from asemd.cli import import_files
    one_of(action, ACTIONS, "asemd cache")
    if script is not None and action != "warm":
        raise InputError(f"asemd cache {action} takes no script, got {script}")
    if action == "warm":
        path, switches = set_up(context, script, "cache warm", None, precision, threads)
        import_files(import_)
        new = kernels.warm(path, switches)
        print(f"{path} is ready to run: {new} kernel modules are new" if new else f"{path} is ready to run: nothing was missing")
        return 0
    found = kernels.contents()
    if action == "show":
        print_parts(found.parts(), found.to_dict(), as_json)
        return 0
    what = f"{found.modules} kernel modules and what else asemd keeps, {found.size / kernels.MB:.1f} MB, in {found.folder}"
    if not yes:
        if not sys.stdin.isatty():
            raise InputError(f"asemd cache clear would delete {what}: add --yes")
        if input(f"Delete {what}? [y/N] ").strip().lower() not in ("y", "yes"):
            print("nothing was deleted")
            return 0
    kernels.clear()
    print(f"deleted {what}")
    return 0


def cite(context: typer.Context, script: Script = None,
         bibtex: Annotated[bool, typer.Option("--bibtex", help="Print entries for BibTeX.")] = False,
         engine: Annotated[str, typer.Option(help="asemd, or lammps: LAMMPS's own paper too.")] = "asemd",
         import_: Import = None, as_json: Json = False) -> int:
    """Print the papers of the methods that a script uses, and what its potential files say of themselves; nothing is run."""
    from asemd.citations import cite as find
    from asemd.cli import import_files
    path, switches = set_up(context, script, "cite", None, "double", 1)
    import_files(import_)
    found = find(path, switches, one_of(engine, ("asemd", "lammps"), "--engine") == "lammps")
    if bibtex and as_json:
        raise InputError("asemd cite: --bibtex or --json, not both")
    if bibtex:
        print(found.bibtex())
    else:
        print_parts(found.parts(), found.to_dict(), as_json)
    return 0

