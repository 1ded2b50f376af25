"""Scripts as cases: each run of a script is one; nothing is executed but the reading."""
from __future__ import annotations

import copy
import json
from dataclasses import replace

from asemd.check.case import Case, of_scene
from asemd.errors import InputError
from asemd.lammps import script
from asemd.lammps.command.minimize import Minimization
from asemd.lammps.driver import check_integration
from asemd.lammps.dry import DrySession

MOST = 12       # runs that are looked at


class Reading(DrySession):
    """Goes through a script as ``asemd run --dry`` does, and keeps what each run would begin with.

    Attributes
    ----------
    cases : list of Case
        One for every run with another timestep, force field, fixes or levels than the ones before.
    empty : Case or None
        A run of no steps, of use if there is no other.
    blocking : list of InputError
        Problems of the script before its first run; those after it are told as warnings.
    """

    def __init__(self, switches=None):
        super().__init__(switches)
        self.cases: list[Case] = []
        self.relaxes = False
        self._seen: set[str] = set()
        self.empty: Case | None = None
        self.blocking: list[InputError] = []

    def drive(self, driver) -> None:
        super().drive(driver)
        if isinstance(driver, Minimization):
            self.relaxes = True
        elif not self.cases:
            check_integration(self)
            self.blocking = self._problems_so_far()
            case = self._case() or self.empty
            if driver.plan.steps:
                self.cases.append(case)
            else:
                self.empty = case
        elif len(self.cases) < MOST and not self._problems_so_far():
            case = self._case()
            if case is not None:
                self.cases.append(case)

    def _problems_so_far(self) -> list[InputError]:
        """Problems but those of lines after the present one, which the first look at the script found."""
        here = self._position
        return [p for p in self.problems if not (here and p.where and p.where.file == here.file and p.where.line > here.line)]

    def _case(self) -> Case | None:
        """The run that begins now; None if there was one like it."""
        scene = self.scene
        inter = scene.interactions
        words = [[f.id, f.style, f.group, *map(str, f.to_lammps())] for f in scene.fixes.values()]
        forces = [[c, inter.style_line(c), inter.coeff_lines(c)] for c in inter.uses] + inter.modify_lines() + [inter.special_line()]
        mark = json.dumps([scene.dt, words, forces, repr(scene.respa)], default=str)
        if mark in self._seen:
            return None
        self._seen.add(mark)
        place = self._position
        mine = replace(scene, system=scene.system.copy(), interactions=copy.deepcopy(inter), groups=copy.deepcopy(scene.groups),
                       fixes=dict(scene.fixes), computes=dict(scene.computes), dumps={}, restarts={}, neighbor=replace(scene.neighbor))
        case = of_scene(mine, place.file if place else "")
        case.relaxes = self.relaxes
        case.where = f"run of line {place.line}" if place else "a later run"
        return case


def of_script(path: str, switches=None) -> Case:
    """The case of a script's first run; the runs after it that differ are its `later`.

    Raises
    ------
    InputError
        The script has mistakes, or no run and no box.
    """
    session = Reading(switches)
    session.rehearse(path)
    has_run = bool(session.cases or session.empty)
    script.raise_problems(session.blocking if has_run else session.problems)
    if not has_run:
        session.scene.need_system("check")
    cases = session.cases or [session.empty or session._case()]
    case = cases[0]
    case.source, case.where = path, ""
    case.warnings = [*session.notes, *(f"after the first run: {p}" for p in session.problems)]
    case.later = cases[1:]
    for other in case.later:
        other.source = path
    return case
