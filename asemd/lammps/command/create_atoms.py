"""``create_atoms type style args keyword values ...``"""
from __future__ import annotations

import time

import numpy as np

from asemd.atom_style import fresh
from asemd.errors import InputError, nearest
from asemd.lammps.command.create_box import describe
from asemd.lattice import Lattice
from asemd.random import ParkMiller
from asemd.system import System
from asemd.words import bounds, choice, number, take, whole, yes_no

EPSILON = 1.0e-6        # part of the box by which lattice points may miss a periodic face
WARMUP = 30             # draws thrown away by style random
STYLES = {"box": 0, "region": 1, "single": 3, "random": 3}
REFUSED = ("mol", "rotate", "overlap", "ratio", "subset", "var", "set")


def run(session, args):
    started = time.perf_counter()
    scene, system = session.scene, session.scene.need_system("create_atoms")
    kind, style = take(args, 2, "create_atoms")[:2]
    if style not in STYLES:
        raise InputError(f"create_atoms: style {style!r} is unknown or not supported{nearest(style, STYLES)}; there are {' '.join(STYLES)}")
    kind = _type(kind, system)
    values = take(args[2:], STYLES[style], f"create_atoms {style}")
    lattice = scene.lattice or Lattice()
    options = _options(args[2 + len(values):], system, lattice)
    region = None
    if style in ("region", "random") and values[-1] != "NULL":
        region = scene.region(values[-1], f"create_atoms {style}")
    if style == "single":
        x, types = _single(values, system, lattice, options, kind)
    elif style == "random":
        x, types = _random(values, system, region, options["maxtry"], kind)
    else:
        x, types = _lattice(system, lattice, region, options["basis"], kind)
    new = System(box=system.box, x=x, type=types, units=system.units, dimension=system.dimension, counts=dict(system.counts),
                 **fresh(system.atom_style, len(x)))
    scene.system = system.append(new)
    session.stale()
    session.print(f"Created {len(x)} atoms")
    session.print(f"  using {'lattice' if options['lattice'] else 'box'} units in {describe(system.box)}")
    session.print(f"  create_atoms CPU = {time.perf_counter() - started:.3f} seconds")


def _type(word: str, system) -> int:
    if "*" in word:
        raise InputError(f"create_atoms needs one atom type, got {word}")
    first, _ = bounds(word, 1, system.counts["ntypes"], "create_atoms: atom type", system.labels["atom"])
    return first


def _options(words: list[str], system, lattice: Lattice) -> dict:
    out = {"basis": {}, "remap": False, "lattice": True, "maxtry": 1000}
    while words:
        key, what = words[0], f"create_atoms {words[0]}"
        if key in REFUSED:
            raise InputError(f"{what} is not supported; supported keywords: basis remap units maxtry")
        if key not in ("basis", "remap", "units", "maxtry"):
            raise InputError(f"create_atoms: unknown keyword {key!r}{nearest(key, ('basis', 'remap', 'units', 'maxtry'))}")
        values = take(words[1:], 2 if key == "basis" else 1, what)
        if key == "basis":
            number_of_basis = 0 if lattice.style == "none" else len(lattice.basis)
            basis = whole(values[0], what)
            if not 1 <= basis <= number_of_basis:
                raise InputError(f"{what}: the lattice has {number_of_basis} basis atoms, got {basis}")
            out["basis"][basis - 1] = _type(values[1], system)
        elif key == "remap":
            out["remap"] = yes_no(values[0], what)
        elif key == "units":
            out["lattice"] = choice(values[0], ("lattice", "box"), what) == "lattice"
        else:
            out["maxtry"] = whole(values[0], what)
        words = words[1 + len(values):]
    return out


def _inside(x: np.ndarray, box, below: float = 0.0, above: float = 0.0) -> np.ndarray:
    """Which points are in the box; along periodic directions its faces are moved down by parts of its length."""
    coordinates, lo, hi = x, box.lo, box.hi
    if box.triclinic:
        coordinates, lo, hi = box.fractional(x), np.zeros(3), np.ones(3)
    length = np.where(box.periodic, hi - lo, 0.0)
    return ((coordinates >= lo - below * length) & (coordinates < hi - above * length)).all(axis=1)


def _lattice(system, lattice: Lattice, region, basis_types: dict[int, int], kind: int):
    """The lattice points in the box: exactly one of two that face each other across a periodic boundary."""
    box = system.box
    corners = box.origin + np.array([(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)]) @ box.cell
    types = np.full(max(1, 0 if lattice.style == "none" else len(lattice.basis)), kind)
    for n, t in basis_types.items():
        types[n] = t
    xs, ts = [np.zeros((0, 3))], [np.zeros(0, int)]
    for x, basis in lattice.points(corners.min(axis=0), corners.max(axis=0)):
        keep = np.flatnonzero(_inside(x, box, EPSILON, 2.0 * EPSILON))
        if region is not None:
            keep = keep[region.inside(x[keep])]
        xs.append(x[keep])
        ts.append(types[basis[keep]])
    x = np.concatenate(xs)
    return x, np.concatenate(ts)


def _single(values, system, lattice, options, kind):
    x = np.array([[number(w, "create_atoms single") for w in values]])
    if options["lattice"]:
        x *= lattice.spacings
    if system.dimension == 2 and x[0, 2] != 0.0:
        raise InputError(f"create_atoms single: z must be 0 in a 2d simulation, got {values[2]}")
    if options["remap"]:
        system.box.wrap(x, np.zeros((1, 3), np.int32))      # the image flags of the new atom stay 0
    keep = _inside(x, system.box)
    return x[keep], np.full(int(keep.sum()), kind)


def _random(values, system, region, maxtry: int, kind: int):
    """Uniform in the box that encloses box and region, until a point lies in both."""
    n = whole(values[0], "create_atoms random: number of atoms")
    if n < 0:
        raise InputError(f"create_atoms random: the number of atoms must not be negative, got {n}")
    generator, box = ParkMiller(whole(values[1], "create_atoms random: seed")), system.box
    generator.skip(WARMUP)
    corners = box.origin + np.array([(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)]) @ box.cell
    lo, hi = corners.min(axis=0), corners.max(axis=0)
    if region is not None and region.extent() is not None:
        lo, hi = np.maximum(lo, region.extent()[0]), np.minimum(hi, region.extent()[1])
        if np.any(lo > hi):
            raise InputError(f"create_atoms random: region {region.id} does not overlap the box")
    found, failed = [], 0
    while len(found) < n:
        x = lo + generator.uniform(3 * max(64, n - len(found))).reshape(-1, 3) * (hi - lo)
        if system.dimension == 2:
            x[:, 2] = 0.0
        good = _inside(x, box) if box.triclinic else np.ones(len(x), bool)
        if region is not None:
            good &= region.inside(x)
        for row in np.flatnonzero(good):
            found.append(x[row])
        failed = 0 if good.any() else failed + len(x)
        if failed >= maxtry:
            raise InputError(f"create_atoms random: no point found in {failed} tries, is the region in the box?")
    x = np.array(found[:n]).reshape(-1, 3)
    return x, np.full(len(x), kind)
