"""``bond_style NAME args``, with the names of sub-styles after ``hybrid``."""
from __future__ import annotations

from asemd.errors import InputError


def run(session, args):
    scene = session.scene
    scene.interactions.set_style("bond", args)
    uses = [use for use in scene.interactions.uses["bond"] if "store/local" in use.settings]
    if uses or any(hasattr(fix, "use") for fix in scene.fixes.values()):
        keep_broken(scene, uses)


def keep_broken(scene, uses) -> None:
    """The internal fixes of ``store/local``; those of a style that is gone go with it."""
    from asemd.bond.bpm_spring import ATTRIBUTES
    from asemd.fix.store_local import StoreLocal
    for id, fix in list(scene.fixes.items()):
        if isinstance(fix, StoreLocal):
            del scene.fixes[id]
    for use in uses:
        id = use.settings["store/local"][0]
        if id in scene.fixes:
            raise InputError(f"bond_style {use.style.name} store/local: there is a fix {id} already, choose another ID")
        scene.fixes[id] = StoreLocal(use, ATTRIBUTES)
