"""Computes and variables that computes, fixes and thermo output go by, looked up when a run begins: one may be gone, or made anew."""
from __future__ import annotations

import re

from asemd.compute import Compute
from asemd.errors import InputError, nearest
from asemd.fix.formula import names_of


def renew(session) -> None:
    """What goes by a compute goes by the one that has its ID now.

    Raises
    ------
    InputError
        There is none any more, or another kind of it; a variable that a fix goes by is not defined.
    """
    scene = session.scene
    for id, fix in scene.fixes.items():
        for name in names_of(fix):
            if name not in session.variables.table:
                raise InputError(f"fix {id} (style {fix.style}): undefined variable {name}{nearest(name, session.variables.table)}",
                                 session.places.get(f"fix {id}"))
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
