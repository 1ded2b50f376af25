"""The script with the recommended settings."""
from __future__ import annotations

import os
from pathlib import Path

from asemd.errors import InputError
from asemd.lammps.convert import to_lammps
from asemd.report.copies import Reader, copied
from asemd.report.knob import all_knobs, clear_tables, execute, writes
from asemd.report.result import Report
from asemd.scene import Scene


def apply_to(report: Report, scene: Scene, reader: Reader | None, path: str | os.PathLike) -> Path:
    """Write the script with the recommended settings, given just before the run they were measured for.

    Parameters
    ----------
    report : Report
    scene : Scene
        The scene before anything was measured.
    reader : asemd.report.copies.Reader or None
        The script that was read; None writes the scene itself as a script with its data file.
    path : path
        The new script. Tables that it needs go into a folder beside it, ``NAME.tables``.

    Raises
    ------
    InputError
        Atoms without a script; the new script would overwrite the one it comes from, or the run stands in an included file; files cannot
        be written.
    """
    path = Path(path)
    if reader is None and scene.units == "ase":
        raise InputError("apply needs a LAMMPS script or a scene of one: atoms with a calculator of their own have no script")
    if reader is not None and reader.where is not None and os.path.realpath(reader.where.file) != os.path.realpath(report.source):
        raise InputError(f"apply: the run stands in {reader.where.file}, which {report.source} includes: apply it to that file by hand")
    if reader is not None and path.exists() and os.path.samefile(path, report.source):
        raise InputError(f"apply: {path} is the script itself: give another name")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        lines = added(report, scene, path)
        if reader is None:
            made = to_lammps(scene, path.parent, path.name)
            made.rename(path)
            lines = [*path.read_text(encoding="utf-8").splitlines(), *lines]
        else:
            old = Path(report.source).read_text(encoding="utf-8").splitlines()
            at = len(old) if reader.where is None else reader.where.line - 1
            lines = [*old[:at], *lines, *old[at:]]
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    except OSError as e:
        raise InputError(f"cannot write {path}: {e.strerror or e}") from None
    return path


def added(report: Report, scene: Scene, path: Path) -> list[str]:
    """The lines that set what is recommended; tables are written."""
    out = [f"# asemd report: {report.recommendation}"]
    if report.best is None:
        return out
    if report.options:
        out.append(f"# run it with: asemd run {' '.join(report.options)} {path}")
    knobs = {k.name: k for k in all_knobs(scene)}
    changed, folder = copied(scene), path.parent / f"{path.name}.tables"
    for name in sorted(report.best.settings, key=lambda n: knobs[n].order):
        commands = knobs[name].commands(changed, report.best.settings[name], str(folder))
        if any(map(writes, commands)):
            folder.mkdir(parents=True, exist_ok=True)
            clear_tables(commands)
        execute(changed, commands)
        out += [c for c in commands if not writes(c)]
    if report.best.dt != report.script.dt:
        out.append(f"# a step is now {report.best.dt:g} time units, it was {report.script.dt:g}: numbers of steps may be reduced")
    return out
