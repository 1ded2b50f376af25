"""The temperature and the pressure that a fix goes by.

They are computes of its own, ``ID_temp`` and ``ID_press``, unless ``fix_modify`` names others.
"""
from __future__ import annotations

from asemd.compute import Compute
from asemd.compute.pressure import find_pressure
from asemd.fix import Fix


def _instead(fix: Fix, name: str, found: Compute, session) -> None:
    """`found` becomes the compute that the fix has as `name`; one that it brought itself is gone then."""
    held, computes = getattr(fix, name), session.scene.computes
    if held is not found and held.maker and computes.get(held.id) is held and held.maker == fix.id:
        del computes[held.id]
    setattr(fix, name, found)


def take_temperature(fix: Fix, found: Compute, session, pressure: bool = True) -> None:
    """``fix_modify ID temp``: the pressure that the fix goes by is then of this temperature, too, as in LAMMPS."""
    _instead(fix, "temp", found, session)
    if pressure and isinstance(getattr(fix, "press", None), Compute):
        fix.press.temperature = found


def take_pressure(fix: Fix, value: str, session) -> None:
    """``fix_modify ID press``."""
    _instead(fix, "press", find_pressure(value, session, "fix_modify press"), session)
