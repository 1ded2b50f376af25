"""``create_box N region-ID keyword values ...``"""
from __future__ import annotations

import os

import numpy as np

from asemd.atom_style import bonded, fresh
from asemd.box import Box
from asemd.errors import InputError, nearest
from asemd.region.prism import Prism
from asemd.system import COUNTS, System
from asemd.words import number, take, whole

KEYWORDS = {**{f"{kind}/types": f"n{kind}types" for kind in ("bond", "angle", "dihedral", "improper")},
            **{name.replace("_", "/"): name for name in COUNTS if name.startswith("extra_")}}

MOST_ATOMS = 2**31 - 1      # LAMMPS's largest id
ATOM_BYTES = 100            # positions, velocities, forces, image flags, id, type of an atom


def run(session, args):
    scene = session.scene
    if scene.system is not None:
        raise InputError("create_box: the simulation box is defined already, use clear first")
    count, name = take(args, 2, "create_box")[:2]
    counts = {"ntypes": whole(count, "create_box: number of atom types")}
    if counts["ntypes"] < 1:
        raise InputError(f"create_box: the number of atom types must be positive, got {count}")
    words = args[2:]
    rotation = None
    if name == "NULL":
        box, rotation = _general(scene, take(words, 6, "create_box NULL"))
        words = words[6:]
    else:
        box = _box(scene, scene.region(name, "create_box"))
    while words:
        key, what = words[0], f"create_box {words[0]}"
        if key not in KEYWORDS:
            raise InputError(f"create_box: unknown keyword {key!r}{nearest(key, KEYWORDS)}")
        if not bonded(scene.atom_style):
            raise InputError(f"{what}: atom_style {scene.atom_style} has no bonds")
        value = whole(take(words[1:], 1, what)[0], what)
        if value < 0:
            raise InputError(f"{what}: must not be negative, got {value}")
        counts[KEYWORDS[key]], words = value, words[2:]
    empty = np.zeros(0)
    scene.system = System(box=box, x=np.zeros((0, 3)), type=empty, counts=counts, units=scene.units,
                          dimension=scene.dimension, step=scene.step, rotation=rotation, **fresh(scene.atom_style, 0))
    scene.special_room = scene.system.counts["extra_special_per_atom"]
    scene.max_special = 1 + scene.special_room
    session.print(f"Created {describe(scene.system.box)}")
    session.print("  1 by 1 by 1 MPI processor grid")
    scene.system.box = scene.system.box.widened()


def _general(scene, words: list[str]) -> tuple[Box, np.ndarray]:
    """The general triclinic box of edges ``alo ahi blo bhi clo chi`` along the vectors of the lattice, in LAMMPS's frame; the rotation."""
    lattice, what = scene.lattice, "create_box NULL"
    if lattice is None or not lattice.general:
        raise InputError(f"{what}: a general triclinic box needs a lattice with the keyword triclinic/general before")
    ends = np.array([number(w, what) for w in words]).reshape(3, 2)
    edges = lattice.primitive.T * lattice.factor
    for (lo, hi), axis in zip(ends, "abc"):
        if not lo < hi:
            raise InputError(f"{what}: {axis}lo {lo:g} must be less than {axis}hi {hi:g}")
    if scene.dimension == 2 and tuple(ends[2]) != (-0.5, 0.5):
        raise InputError(f"{what}: clo and chi of a 2d box must be -0.5 and 0.5, got {ends[2, 0]:g} and {ends[2, 1]:g}")
    return Box(ends[:, 0] @ edges, (ends[:, 1] - ends[:, 0])[:, None] * edges, scene.boundary).turned()


def _box(scene, region) -> Box:
    extent = region.extent()
    if extent is None:
        raise InputError(f"create_box: region {region.id} has no bounds (side out, or a plane), use a block or prism")
    tilt, lo, hi = (0.0, 0.0, 0.0), *extent
    triclinic = isinstance(region, Prism)
    if triclinic:
        tilt, lo, hi = region.tilt, region.lo, region.hi
        for value, name in zip(tilt, ("xy", "xz", "yz")):
            if scene.dimension == 2 and value and name != "xy":
                raise InputError(f"create_box: a 2d box must have {name} = 0")
    if scene.dimension == 2 and not (lo[2] < 0.0 < hi[2]):
        raise InputError(f"create_box: a 2d box must have z = 0 between zlo {lo[2]:g} and zhi {hi[2]:g}")
    return Box.from_lammps(lo, hi, tilt, scene.boundary, triclinic)


def describe(box: Box) -> str:
    """The box as logs have it."""
    lo, hi, tilt = (" ".join(f"{v:.8g}" for v in values) for values in (box.lo, box.hi, box.tilt))
    return f"triclinic box = ({lo}) to ({hi}) with tilt ({tilt})" if box.triclinic else f"orthogonal box = ({lo}) to ({hi})"


def check_number(n: int, what: str) -> None:
    """Whether so many atoms can be numbered and held.

    Raises
    ------
    InputError
        Too many; the message starts with `what`.
    """
    if n > MOST_ATOMS:
        raise InputError(f"{what}: {n} atoms are too many, ids go up to {MOST_ATOMS}")
    try:
        memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):       # a system that does not say
        return
    if n * ATOM_BYTES > memory > 0:
        raise InputError(f"{what}: {n} atoms are too many for the memory of this computer, {memory / 2**30:.3g} GB")
