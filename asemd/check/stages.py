"""Scripts as cases: what stands before the first run, nothing executed but the reading."""
from __future__ import annotations

from asemd.check.case import Case, of_scene
from asemd.lammps.driver import check as check_run
from asemd.lammps.session import Session, Stop


class Reading(Session):
    """Goes through a script up to its first run; minimisations are passed over."""

    def __init__(self, switches=None):
        super().__init__(switches=switches, passive=True)
        self.relaxes = False

    def call(self, name: str, args) -> None:
        if name == "minimize":
            self.scene.need_system(name)
            self.relaxes = True
        else:
            super().call(name, args)


def of_script(path: str, switches=None) -> Case:
    """The case of a script's first run."""
    session = Reading(switches)
    try:
        session.file(path)
    except Stop:
        session.label = None
    session.scene.need_system("check")
    check_run(session)
    case = of_scene(session.scene, path)
    case.relaxes = session.relaxes
    return case
