"""``bond_style NAME args``, with the names of sub-styles after ``hybrid``."""
from __future__ import annotations

from asemd.errors import InputError


def run(session, args):
    scene = session.scene
    before, old = storing(scene), list(scene.interactions.uses["bond"])
    scene.interactions.set_style("bond", args)
    if session.loop is None:      # between read_restart and the first run: the file's reference lengths go to the style chosen again
        for use in scene.interactions.uses["bond"]:
            use.memory.update(next((o.memory for o in old if o.style is use.style and use.style.remembers == "bonds"), {}))
    after = storing(scene)
    if before or after:
        keep_broken(scene, after)


def storing(scene) -> list:
    """The styles with ``store/local``."""
    return [use for use in scene.interactions.uses["bond"] if "store/local" in use.settings]


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
