"""``kspace_style none``: there is no long-range solver yet, so every other style is refused with what to use instead."""
from __future__ import annotations

from collections.abc import Sequence

from asemd.errors import InputError, nearest
from asemd.registry import plain_name

PERIODIC = ("ewald", "ewald/disp", "ewald/dipole", "pppm", "pppm/cg", "pppm/disp", "pppm/tip4p", "pppm/disp/tip4p", "pppm/stagger",
            "pppm/dipole")
ANY_BOX = ("msm", "msm/cg", "scafacos")


def run(session, args):
    if not args:
        raise InputError("kspace_style needs the name of a style")
    name = plain_name(args[0])
    if name == "none":
        if len(args) > 1:
            raise InputError(f"kspace_style none takes no arguments, got {' '.join(args[1:])}")
        session.scene.interactions.kspace, session.scene.interactions.kspace_modify = "none", {}
        return
    scene = session.scene
    raise refusal(name, scene.system.box.boundary if scene.system is not None else scene.boundary)


def refusal(name: str, boundary: Sequence[str]) -> InputError:
    """Why there is no such style, or why it could not be used in a box with this boundary."""
    if name not in PERIODIC + ANY_BOX:
        return InputError(f"unknown kspace style {name!r}{nearest(name, ('none', *PERIODIC, *ANY_BOX))}")
    advice = "use a pair style with a Coulomb cutoff such as lj/cut/coul/cut"
    if name in PERIODIC and any(face not in ("p", "pp") for face in boundary):
        faces = " ".join(face[0] if face == 2 * face[0] else face for face in boundary)
        return InputError(f"kspace_style {name} needs a box that is periodic in all directions, here is boundary {faces}; "
                          f"asemd has no long-range solver yet: {advice}")
    return InputError(f"kspace_style {name} is not supported yet: asemd has no long-range solver; {advice}, or kspace_style none")
