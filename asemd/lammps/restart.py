"""What a restart file keeps of a session, when it is written, and how a session takes it up again.

Kept are, as in LAMMPS: units, dimension, boundaries, atom style, newton, box, atoms with velocities and image flags, topology, type
labels, groups, force field with all coefficients, special bonds, timestep and its size, and what fixes remember (see
`asemd.fix.Fix.state`); beyond LAMMPS: neighbour settings, tables of bonds that remember or broke, and in files written during a run
the state between two steps (`asemd.lammps.checkpoint`). Not kept: fixes themselves, computes, dumps, regions, variables, thermo settings
and exclusions of the neighbour list.
"""
from __future__ import annotations

import os
import re
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from asemd import __version__
from asemd.errors import InputError
from asemd.forcefield import CATEGORIES, Interactions
from asemd.lammps import checkpoint, restart_file
from asemd.lammps.command.create_box import describe
from asemd.lammps.setup_log import report_special
from asemd.style import find
from asemd.system import System
from asemd.topology import Topology
from asemd.uses import Use

NEIGHBOR = ("skin", "every", "delay", "check")


@dataclass
class Schedule:
    """``restart N file`` or ``restart N file1 file2``.

    Attributes
    ----------
    every : int or str
        Steps, or the name of a variable that gives the next step.
    names : tuple of str
        One name for a series of files, or two that are written in turn.
    written : int
        Number of files so far.
    last : (int, str)
        Step and name of the last file.
    upcoming : int
        The next step, by the variable.
    """

    every: int | str
    names: tuple[str, ...]
    written: int = 0
    last: tuple[int, str] = (-1, "")
    upcoming: int = -1

    def path(self, step: int) -> str:
        """The name of the next file."""
        if len(self.names) == 2:
            return file_name(self.names[self.written % 2], step)
        name = self.names[0]
        return file_name(name if "*" in name else f"{name}.*", step)

    def next(self, step: int, number) -> int:
        """The next step after `step` on which it is due; `number` gives the value of a variable."""
        if isinstance(self.every, int):
            return (step // self.every + 1) * self.every
        if self.upcoming <= step:
            self.upcoming = int(number(self.every))
            if self.upcoming <= step:
                raise InputError(f"restart v_{self.every}: variable {self.every} gave step {self.upcoming}, which is not after step {step}")
        return self.upcoming

    def due(self, step: int) -> bool:
        return step % self.every == 0 if isinstance(self.every, int) else step == self.upcoming


def file_name(name: str, step: int) -> str:
    """``*`` becomes the step; ``%``, which stands for the number of a process, ``base``: there is one file."""
    return name.replace("*", str(step), 1).replace("%", "base")


def newest(pattern: str) -> str:
    """The file with the largest step for ``*`` in the name.

    Raises
    ------
    InputError
        There is none.
    """
    folder, name = os.path.split(pattern.replace("%", "base"))
    if "*" in folder:
        raise InputError(f"read_restart {pattern}: * can stand in the name of the file only, not of its folder")
    if "*" not in name:
        return os.path.join(folder, name)
    before, after = name.split("*", 1)
    try:
        names = os.listdir(folder or ".")
    except OSError as e:
        raise InputError(f"read_restart {pattern}: cannot look into folder {folder or '.'}: {e.strerror}") from None
    found = [(int(m[1]), n) for n in names if (m := re.fullmatch(re.escape(before) + r"(\d+)" + re.escape(after), n))]
    if not found:
        raise InputError(f"read_restart {pattern}: there is no such file with a step in place of *")
    return os.path.join(folder, max(found)[1])


# ---- writing ------------------------------------------------------------------------------------------------------------------------


def contents(session, state: dict[str, Any] | None = None) -> dict[str, Any]:
    """Everything a restart file keeps; `state` is that of `checkpoint.take`."""
    scene, system = session.scene, session.scene.need_system("write_restart")
    kept = ("units", "dimension", "boundary", "atom_style", "newton", "map_style", "dt", "time_base", "max_special")
    fixes = [{"id": f.id, "style": f.style, "group": f.group, "words": [str(w) for w in f.to_lammps()], "state": f.state(),
              "restarts": list(f.restarts)} for f in scene.fixes.values()]
    return {"asemd": __version__, "step": scene.step, "scene": {name: getattr(scene, name) for name in kept},
            "neighbor": {name: getattr(scene.neighbor, name) for name in NEIGHBOR}, "exclusions": len(scene.neighbor.exclude),
            "system": {f.name: getattr(system, f.name) for f in fields(system) if f.name not in ("topology", "f")},
            "topology": system.topology.as_dict(), "interactions": force_field(scene.interactions),
            "groups": {name: {"bit": scene.groups.bit(name), "mask": mask} for name, mask in scene.groups.items()},
            "fixes": fixes, "state": state}


def force_field(interactions: Interactions) -> dict[str, Any]:
    """Interactions as plain data."""
    out = {f.name: getattr(interactions, f.name) for f in fields(interactions) if f.name not in ("uses", "compat", "compute")}
    names = ("settings", "coeff", "label", "modify", "special", "scale", "coulomb", "memory")
    out["uses"] = {category: [{"style": use.style.name, **{n: getattr(use, n) for n in names}} for use in uses]
                   for category, uses in interactions.uses.items()}
    for use in out["uses"]["pair"]:         # what is left out of one run counts again in others, as in LAMMPS
        use["modify"] = {name: value for name, value in use["modify"].items() if name != "compute"}
    # potential files are not kept, as in LAMMPS: the script gives the style (a sub-style's or a table's coefficients) again
    for use in out["uses"]["pair"]:
        style = find("pair", use["style"])
        use["coeff"] = use["coeff"] if style.restarts and not style.from_files else {}
    if not out["hybrid"]["pair"]:
        out["uses"]["pair"] = [use for use in out["uses"]["pair"] if find("pair", use["style"]).restarts]
    return out


def write(session, path: str, state: dict[str, Any] | None = None) -> None:
    """Write a restart file of the session."""
    restart_file.save(path, contents(session, state))
    for fix in session.scene.fixes.values():
        fix.write_beside(path, session.scene.system, session.scene.step)


def write_due(session, step: int, alone: np.ndarray | None = None, all_of_them: bool = False) -> None:
    """Write the files that are due at this step; `alone` is what `checkpoint.renew` gave, None in a minimisation."""
    wanted = [s for s in session.scene.restarts.values() if all_of_them or s.due(step)]
    state = checkpoint.take(session.loop, alone) if wanted and alone is not None else None
    for schedule in wanted:
        path = schedule.path(step)
        if schedule.last != (step, path):
            write(session, path, state)
            schedule.written += 1
            schedule.last = step, schedule.path(step) if len(schedule.names) == 1 else ""


def due(session, step: int) -> bool:
    """Whether a file is to be written at this step of a run."""
    return any(s.due(step) for s in session.scene.restarts.values())


def check_folders(session) -> None:
    """Refuse a run whose restart files cannot be written, before it begins."""
    for schedule in session.scene.restarts.values():
        for name in schedule.names:
            folder = os.path.dirname(name) or "."
            if not os.path.isdir(folder) or not os.access(folder, os.W_OK):
                why = "cannot be written" if os.path.isdir(folder) else "does not exist"
                raise InputError(f"restart {schedule.every} {' '.join(schedule.names)}: folder {folder} {why}")


def next_step(session, step: int) -> int:
    """The next step of a run with a restart file; beyond every run without."""
    return min((s.next(step, session.variables.number) for s in session.scene.restarts.values()), default=2**62)


# ---- reading ------------------------------------------------------------------------------------------------------------------------


def take_up(session, document: dict[str, Any]) -> None:
    """Make the session's scene what the file says; the scene has no atoms yet."""
    scene, given = session.scene, document["scene"]
    for name, default in (("boundary", ("pp", "pp", "pp")), ("newton", (True, True))):
        if getattr(scene, name) not in (default, given[name]):
            session.warn(f"read_restart: the file has other {name} settings, which are used")
    session.print(f"  restart file = asemd {document['asemd']}, asemd = {__version__}")
    session.print(f"  restoring atom style {given['atom_style']} from restart")
    for name, value in given.items():
        setattr(scene, name, value)
    for name, value in document["neighbor"].items():
        setattr(scene.neighbor, name, value)
    scene.system = System(**document["system"], topology=Topology(**document["topology"]))
    scene.system.topology.frozen = None         # partners are listed anew, as LAMMPS does
    scene.first_step = document["step"]
    session.print(f"  {describe(scene.system.box)}")
    session.print("  1 by 1 by 1 MPI processor grid")
    scene.interactions = interactions(document["interactions"], scene.interactions.compat)
    for category in ("pair", *(c for c in CATEGORIES if c != "pair")):
        if scene.interactions.uses[category]:
            session.print(f"  restoring {category} style {scene.interactions.style_name(category)} from restart")
    restore_groups(scene, document["groups"])
    session.print(f"  {scene.system.n} atoms")
    for kind, count in scene.system.topology.counts().items():
        if count:
            session.print(f"  {count} {kind}s")
    report_special(session)
    fixes = [{"restarts": ["global"], **f} for f in document["fixes"]]
    scene.restored = {"fixes": [f for f in fixes if f["state"] or "peratom" in f["restarts"]], "state": document["state"]}
    if document["exclusions"]:
        session.warn("read_restart: neigh_modify exclude is not kept in restart files, give it again where it is still wanted")


def interactions(kept: dict[str, Any], compat: str) -> Interactions:
    """The force field of `force_field`."""
    uses = {category: [Use(style=find(category, use.pop("style")), **use) for use in found] for category, found in kept.pop("uses").items()}
    return Interactions(uses=uses, compat=compat, **kept)


def restore_groups(scene, kept: dict[str, Any]) -> None:
    """Groups with the bits they had."""
    groups = scene.groups
    groups.resize(scene.system.n)
    by_bit = {g["bit"]: (name, g["mask"]) for name, g in kept.items()}
    free = []
    for bit in range(1, max(by_bit) + 1):
        name, mask = by_bit.get(bit, (f"free{bit}", np.zeros(scene.system.n, bool)))
        groups[name] = mask
        if bit not in by_bit:
            free.append(name)
    for name in free:
        del groups[name]


def restore_fix(session, fix) -> None:
    """Give a fix that was just defined what the fix of its ID and style remembered."""
    kept = session.scene.restored
    found = [f for f in kept["fixes"] if f["id"] == fix.id and f["style"] == fix.style] if kept else []
    if found:
        for kind in found[0]["restarts"]:
            session.print(f"Resetting {kind} fix info from restart file:\n  fix style: {fix.style}, fix ID: {fix.id}")
        fix.restore(found[0]["state"])
        found[0]["used"] = True


def first_run(session) -> dict[str, Any] | None:
    """Called when a run begins: what nobody took up is forgotten.

    Returns
    -------
    dict or None
        The state between two steps, if the file has one and the atoms are still those of the file.
    """
    kept, session.scene.restored = session.scene.restored, None
    if kept is None:
        return None
    for kind in ("global", "peratom"):
        fixes = [f for f in kept["fixes"] if kind in f["restarts"]]
        unused = [f for f in fixes if "used" not in f]
        if unused:
            session.print(f"Unused restart file {kind} fix info:")
            for f in unused:
                session.print(f"  fix style: {f['style']}, fix ID: {f['id']}")
        elif fixes:
            session.print(f"All restart file {kind} fix info was re-assigned")
    state = kept["state"]
    return state if state and checkpoint.digest(session.scene.system) == state["atoms"] else None
