"""Fixes that hold the molecules which other fixes put in: fix rigid/small and its relatives, fix shake and fix rattle."""
from __future__ import annotations

from asemd.errors import InputError, nearest

KEYWORDS = ("rigid", "shake")


def read(given: dict[str, list], what: str) -> tuple[str, str] | None:
    """The keyword ``rigid`` or ``shake`` and the id after it, if one was given.

    Raises
    ------
    InputError
        Both, or no molecule.
    """
    found = [key for key in KEYWORDS if key in given]
    if len(found) == 2:
        raise InputError(f"{what}: cannot use both rigid and shake")
    if found and "mol" not in given:
        raise InputError(f"{what}: cannot use {found[0]} and not molecule, give the keyword mol")
    return (found[0], given[found[0]][0]) if found else None


def find(loop, holder: tuple[str, str], template: str, what: str):
    """The fix that was named.

    Raises
    ------
    InputError
        There is none, it cannot hold molecules that come during a run, or it was told of other ones.
    """
    keyword, name = holder
    fix = next((f for f in loop.fixes if f.id == name), None)
    if fix is None:
        raise InputError(f"{what} {keyword}: there is no fix {name}{nearest(name, [f.id for f in loop.fixes])}")
    fits = fix.style in ("shake", "rattle") if keyword == "shake" else fix.style.startswith("rigid") and fix.style.endswith("/small")
    if not fits:
        raise InputError(f"{what} {keyword}: fix {name} has the style {fix.style}; it must be "
                         f"{'shake or rattle' if keyword == 'shake' else 'rigid/small or one of its relatives'}")
    if fix.template != template:
        raise InputError(f"{what} and fix {name} are not using the same molecule template: say mol {template} in both")
    return fix
