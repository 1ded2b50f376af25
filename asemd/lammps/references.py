"""Computes and variables that others go by, looked up by their names when a run begins: one may be gone, or made anew."""
from __future__ import annotations

import re

from asemd.compute import Compute
from asemd.errors import InputError, nearest


def renew(session) -> None:
    """What goes by a compute goes by the one that has its ID now.

    Raises
    ------
    InputError
        There is none any more, or another kind of it; there is no variable of a name that a fix or output goes by.
    """
    scene = session.scene
    look_up(session)
    for kind, table in (("fix", scene.fixes), ("compute", scene.computes)):
        for owner in table.values():
            for name, held in list(vars(owner).items()):
                named = isinstance(held, Compute) and re.fullmatch(r"\w+", held.id)      # others are the owner's private ones
                if named and scene.computes.get(held.id) is not held:
                    try:
                        _replace(session, kind, owner, name, held)
                    except InputError as e:
                        raise e.at(session.places.get(f"{kind} {owner.id}")) from None
    for keyword in ("temp", "press"):
        id = getattr(scene.thermo, keyword)
        if id not in scene.computes:
            raise InputError(f"thermo_modify {keyword} {id}: there is no compute {id} any more{nearest(id, scene.computes)}")


def look_up(session) -> None:
    """Whether the variables are there that fixes, thermo output, dumps and restart files go by.

    Raises
    ------
    InputError
        One is not, or has no number.
    """
    scene = session.scene
    named = [(f"fix {f.id}", f"fix {f.id} (style {f.style})", name) for f in scene.fixes.values() for name in f.awaited]
    named += [("thermo", "thermo", scene.thermo.every)] if isinstance(scene.thermo.every, str) else []
    named += [(f"dump {d.id}", f"dump {d.id}", d.schedule.variable) for d in scene.dumps.values() if d.schedule.variable]
    named += [("restart", "restart", s.every) for s in scene.restarts.values() if isinstance(s.every, str)]
    for key, what, name in named:
        try:
            if session.variables.find(name).style != "equal" and key == "restart":
                raise InputError(f"variable {name} must have style equal")
        except InputError as e:
            raise InputError(f"{what}: {e.message}", session.places.get(key)) from None


def _replace(session, kind: str, owner, name: str, held: Compute) -> None:
    what, found = f"{kind} {owner.id} (style {owner.style})", session.scene.computes.get(held.id)
    if found is None:
        raise InputError(f"{what} goes by compute {held.id}, which is not there any more")
    if type(found) is type(held):
        setattr(owner, name, found)
    elif kind == "fix" and name in ("temp", "press"):
        owner.modify([name, held.id], session)
    elif hasattr(found, "dof") and hasattr(held, "dof"):
        setattr(owner, name, found)
    else:
        raise InputError(f"{what} goes by compute {held.id}, which has style {found.style} now, it had {held.style}")
