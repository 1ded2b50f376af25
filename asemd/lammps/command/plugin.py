"""``plugin list|clear|restore|load|unload``: there are never plugins, which are compiled for LAMMPS; new styles are Python files."""
from __future__ import annotations

from asemd.errors import InputError
from asemd.words import choice, exactly, take


def run(session, args):
    what = choice(take(args, 1, "plugin")[0], ("load", "unload", "list", "clear", "restore"), "plugin")
    if what == "load":
        file = take(args[1:], 1, "plugin load")[0]
        raise InputError(f"plugin load {file}: plugins are compiled for LAMMPS itself and cannot be loaded; write the style in a "
                         "Python file and use asemd run --import FILE.py")
    if what == "unload":
        category, style = exactly(args[1:], 2, "plugin unload")
        session.print(f"Ignoring unload of {category} style {style}: not from a plugin")
    else:
        exactly(args, 1, "plugin")
        if what == "list":
            session.print("Currently loaded plugins: 0")
