"""``create_atoms type style args keyword values ...``"""
from __future__ import annotations

import math
import time
from dataclasses import dataclass, field

import numpy as np

from asemd.atom_style import fresh, has
from asemd.errors import InputError, nearest
from asemd.lammps import mesh
from asemd.lammps.command.create_box import check_number, describe
from asemd.lattice import Lattice
from asemd.marsaglia import Marsaglia
from asemd.molecule import Molecule, random_rotation, rotation, turned
from asemd.random import ParkMiller
from asemd.system import System
from asemd.words import bounds, choice, number, take, whole, yes_no

EPSILON = 1.0e-6        # part of the box by which lattice points may miss a periodic face
WARMUP = 30             # draws thrown away by style random
STYLES = {"box": 0, "region": 1, "single": 3, "random": 3, "mesh": 1}
VALUES = {"mol": 2, "basis": 2, "ratio": 2, "subset": 2, "remap": 1, "var": 1, "set": 2, "rotate": 4, "overlap": 1, "maxtry": 1,
          "meshmode": 2, "radscale": 1, "units": 1}
ONLY = {"meshmode": ("mesh",), "radscale": ("mesh",), "overlap": ("random",), "maxtry": ("random",), "var": ("box", "region", "random"),
        "set": ("box", "region", "random")}     # styles that a keyword is for; others take no notice of it where LAMMPS takes none
MESH = {"bisect": "recursive bisection", "qrand": "quasi-random"}
SEEDS = 900_000_000     # the largest of Marsaglia's generator


@dataclass
class _Options:
    basis: dict[int, int] = field(default_factory=dict)
    part: tuple[str, float, int] | None = None      # ratio or subset, how many, seed
    remap: bool = False
    lattice: bool = True
    maxtry: int = 1000
    variable: str = ""
    axes: dict[int, str] = field(default_factory=dict)      # direction -> internal variable that holds the coordinate
    template: Molecule | None = None
    turns: Marsaglia | None = None      # draws the rotations of molecules
    rotate: np.ndarray | None = None
    matrices: list[np.ndarray] = field(default_factory=list)       # the rotation of each molecule
    overlap: float | None = None
    meshmode: tuple[str, float] | None = None       # bisect and the largest radius, or qrand and the density
    radscale: float = 1.0


def run(session, args):
    started = time.perf_counter()
    scene, system = session.scene, session.scene.need_system("create_atoms")
    kind, style = take(args, 2, "create_atoms")[:2]
    if style not in STYLES:
        raise InputError(f"create_atoms: style {style!r} is unknown or not supported{nearest(style, STYLES)}; there are {' '.join(STYLES)}")
    values = take(args[2:], STYLES[style], f"create_atoms {style}")
    lattice = scene.lattice or Lattice()
    options = _options(session, args[2 + len(values):], system, lattice, style)
    kind = _type(kind, system, options.template)
    if options.template is not None:
        options.template.check(system, "create_atoms mol", kind)
    region = None
    if style in ("region", "random") and values[-1] != "NULL":
        region = scene.region(values[-1], f"create_atoms {style}")
    wanted = _test(session, options)
    radii = None
    if style == "mesh":
        x, radii = _mesh(session, values[0], system, options)
        types = np.full(len(x), kind)
    elif style == "single":
        x, types = _single(values, system, lattice, options, kind, wanted)
    elif style == "random":
        x, types = _random(session, values, system, region, lattice, options, kind, wanted)
    else:
        if lattice.general != (system.rotation is not None):
            raise InputError("create_atoms: a general triclinic box needs a lattice with triclinic/general, and such a lattice a box of "
                             "create_box NULL or read_data with avec, bvec, cvec")
        x, types = _lattice(system, lattice, region, options, kind, wanted, system.rotation)
    if options.template is not None:
        if x.ndim == 2:
            x = np.array([_molecule(point, options, system.dimension) for point in x]).reshape(-1, options.template.natoms, 3)
        new = options.template.copies(x, system, kind, options.matrices)
    else:
        new = System(box=system.box, x=x, type=types, units=system.units, dimension=system.dimension, counts=dict(system.counts),
                     **fresh(system.atom_style, len(x)))
    if radii is not None:
        if "radius" in new.extra:
            new.extra["radius"] = options.radscale * radii
        if new.molecular:
            new.molecule = np.ones(new.n, np.int64)      # one that is new: numbers follow those that are there
    scene.system = system.append(new)
    session.stale()
    session.print(f"Created {new.n} atoms")
    session.print(f"  using {'lattice' if options.lattice else 'box'} units in {describe(system.box)}")
    session.print(f"  create_atoms CPU = {time.perf_counter() - started:.3f} seconds")


def _type(word: str, system, template: Molecule | None = None) -> int:
    """The atom type, or what is added to the types of a molecule."""
    if "*" in word:
        raise InputError(f"create_atoms needs one atom type, got {word}")
    if template is not None and word not in system.labels["atom"].values():
        return whole(word, "create_atoms: atom type")
    first, _ = bounds(word, 1, system.counts["ntypes"], "create_atoms: atom type", system.labels["atom"])
    return first


def _options(session, words: list[str], system, lattice: Lattice, style: str) -> _Options:
    out = _Options()
    while words:
        key, what = words[0], f"create_atoms {words[0]}"
        if key not in VALUES:
            raise InputError(f"create_atoms: unknown keyword {key!r}{nearest(key, VALUES)}")
        values = take(words[1:], VALUES[key], what)
        if style not in ONLY.get(key, STYLES):
            raise InputError(f"{what} is only for style {' '.join(ONLY[key])}, not for {style}")
        if key == "basis":
            number_of_basis = 0 if lattice.style == "none" else len(lattice.basis)
            basis = whole(values[0], what)
            if not 1 <= basis <= number_of_basis:
                raise InputError(f"{what}: the lattice has {number_of_basis} basis atoms, got {basis}")
            out.basis[basis - 1] = _type(values[1], system)
        elif key == "remap":
            out.remap = yes_no(values[0], what)
        elif key == "units":
            out.lattice = choice(values[0], ("lattice", "box"), what) == "lattice"
        elif key == "maxtry":
            out.maxtry = _positive(whole(values[0], what), what)
        elif key == "overlap":
            out.overlap = number(values[0], what)
            if out.overlap < 0.0:
                raise InputError(f"{what}: the distance must not be negative, got {values[0]}")
        elif key == "meshmode":
            out.meshmode = choice(values[0], MESH, what), _positive(number(values[1], what), what)
        elif key == "radscale":
            if not has(system.atom_style, "diameter"):
                raise InputError(f"{what}: atoms of style {system.atom_style} have no radius")
            out.radscale = _positive(number(values[0], what), what)
        elif key in ("ratio", "subset"):
            out.part = _part(key, values, what)
        elif key == "var":
            session.variables.find(values[0])
            out.variable = values[0]
        elif key == "set":
            out.axes["xyz".index(choice(values[0], "xyz", what))] = _internal(session, values[1], what)
        elif key == "mol":
            out.template, out.turns = _template(session, values[0], what), Marsaglia(_seed(values[1], what))
        else:
            out.rotate = _rotation(values, system.dimension, what)
        words = words[1 + len(values):]
    if bool(out.variable) != bool(out.axes):
        raise InputError(f"create_atoms {'var' if out.variable else 'set'}: the keywords var and set must be given together")
    return out


def _positive(value, what: str):
    if value <= 0:
        raise InputError(f"{what}: must be positive, got {value}")
    return value


def _seed(word: str, what: str) -> int:
    seed = whole(word, f"{what}: seed")
    if not 0 < seed <= SEEDS:
        raise InputError(f"{what}: the seed must be from 1 to {SEEDS}, got {word}")
    return seed


def _part(key: str, values: list[str], what: str) -> tuple[str, float, int]:
    amount = number(values[0], what) if key == "ratio" else whole(values[0], what)
    if key == "ratio" and amount > 1.0:
        raise InputError(f"{what}: the fraction must be from 0 to 1, got {values[0]}")
    return key, _positive(amount, what), _seed(values[1], what)


def _internal(session, name: str, what: str) -> str:
    table = session.variables.table
    if name not in table:
        session.variables.define(name, "internal", ["0.0"])
    elif table[name].style != "internal":
        raise InputError(f"{what}: variable {name} has style {table[name].style}, it must have style internal")
    return name


def _template(session, name: str, what: str) -> Molecule:
    molecules = session.scene.molecules
    if name not in molecules:
        raise InputError(f"{what}: there is no molecule {name}{nearest(name, molecules)}")
    if len(molecules[name]) > 1:
        session.warn(f"{what}: molecule {name} was read from several files, only the first is used")
    return molecules[name][0]


def _rotation(values: list[str], dimension: int, what: str) -> np.ndarray:
    angle, *axis = (number(w, what) for w in values)
    if not any(axis):
        raise InputError(f"{what}: the axis must not be zero")
    if dimension == 2 and (axis[0] or axis[1]):
        raise InputError(f"{what}: in a 2d simulation the axis must be along z")
    scale = 1.0 / math.sqrt(sum(a * a for a in axis))
    return rotation([a * scale for a in axis], angle * math.pi / 180.0)


def _molecule(centre: np.ndarray, options: _Options, dimension: int) -> np.ndarray:
    """Positions of a molecule about a centre, turned as asked or at random."""
    matrix = random_rotation(options.turns, dimension) if options.rotate is None else options.rotate
    options.matrices.append(matrix)
    return turned(matrix, options.template.centred) + centre


def _test(session, options: _Options):
    """Which of some points the variable wants, as a function (n, 3) -> (n,) bool; None without variable."""
    if not options.variable:
        return None
    variables = session.variables

    def wanted(x: np.ndarray) -> np.ndarray:
        out = np.zeros(len(x), bool)
        for row, point in enumerate(x):
            for axis, name in options.axes.items():
                variables.set(name, repr(float(point[axis])))
            out[row] = variables.number(options.variable) != 0.0
        return out
    return wanted


def _inside(x: np.ndarray, box, below: float = 0.0, above: float = 0.0) -> np.ndarray:
    """Which points are in the box; along periodic directions its faces are moved down by parts of its length."""
    coordinates, lo, hi = x, box.lo, box.hi
    if box.triclinic:
        coordinates, lo, hi = box.fractional(x), np.zeros(3), np.ones(3)
    length = np.where(box.periodic, hi - lo, 0.0)
    return ((coordinates >= lo - below * length) & (coordinates < hi - above * length)).all(axis=1)


def _lattice(system, lattice: Lattice, region, options: _Options, kind: int, wanted, general=None):
    """The lattice points in the box: exactly one of two that face each other across a periodic boundary.

    The points of a general triclinic box are turned by `general` into LAMMPS's frame.
    """
    box = system.box
    corners = np.array([(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)]) @ box.cell
    corners = box.origin + (corners if general is None else corners @ general.T)
    types = np.full(max(1, 0 if lattice.style == "none" else len(lattice.basis)), kind)
    for n, t in options.basis.items():
        types[n] = t
    xs, ts = [np.zeros((0, 3))], [np.zeros(0, int)]
    for x, basis in lattice.points(corners.min(axis=0), corners.max(axis=0)):
        if general is not None:
            x = box.origin + (x - box.origin) @ general
        keep = np.flatnonzero(_inside(x, box, EPSILON, 2.0 * EPSILON))
        if region is not None:
            keep = keep[region.inside(x[keep])]
        if wanted is not None:
            keep = keep[wanted(x[keep])]
        xs.append(x[keep])
        ts.append(types[basis[keep]])
    x, types = np.concatenate(xs), np.concatenate(ts)
    if options.part is not None:
        key, amount, seed = options.part
        count = int(amount if key == "subset" else amount * len(x))
        if count > len(x):
            raise InputError(f"create_atoms subset: {count} of {len(x)} lattice points are wanted")
        rows = Marsaglia(seed).subset(len(x), count)
        x, types = x[rows], types[rows]
    return x, types


def _single(values, system, lattice, options: _Options, kind, wanted):
    x = np.array([[number(w, "create_atoms single") for w in values]])
    if options.lattice:
        x *= lattice.spacings
    if system.dimension == 2 and x[0, 2] != 0.0:
        raise InputError(f"create_atoms single: z must be 0 in a 2d simulation, got {values[2]}")
    if options.remap:
        system.box.wrap(x, np.zeros((1, 3), np.int32))      # the image flags of the new atom stay 0
    keep = _inside(x, system.box)
    if wanted is not None:
        keep &= wanted(x)
    return x[keep], np.full(int(keep.sum()), kind)


def _random(session, values, system, region, lattice, options: _Options, kind: int, wanted):
    """Uniform in the box that encloses box and region, until a point lies in both and far enough from all atoms."""
    n = whole(values[0], "create_atoms random: number of atoms")
    if n < 0:
        raise InputError(f"create_atoms random: the number of atoms must not be negative, got {n}")
    check_number(n, "create_atoms random")
    generator, box = ParkMiller(whole(values[1], "create_atoms random: seed")), system.box
    generator.skip(WARMUP)
    corners = box.origin + np.array([(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)]) @ box.cell
    lo, hi = corners.min(axis=0), corners.max(axis=0)
    if region is not None and region.extent() is not None:
        lo, hi = np.maximum(lo, region.extent()[0]), np.minimum(hi, region.extent()[1])
        if np.any(lo > hi):
            raise InputError(f"create_atoms random: region {region.id} does not overlap the box")
    crowd = None
    if options.overlap is not None:
        crowd = _Crowd(system, options.overlap * (lattice.spacings[0] if options.lattice else 1.0))
    found, atoms, tries, outside = [], 0, 0, 0
    while atoms < n:
        x = lo + generator.uniform(3 * max(64, n - atoms)).reshape(-1, 3) * (hi - lo)
        if system.dimension == 2:
            x[:, 2] = 0.0
        inside = _inside(x, box)        # a point on an upper face counts but is not placed
        good = inside.copy() if box.triclinic else np.ones(len(x), bool)
        if region is not None:
            good &= region.inside(x)
        for row, point in enumerate(x):
            if atoms == n:
                break
            tries += 1
            if good[row] and (wanted is None or wanted(x[row:row + 1])[0]):
                point = _molecule(point, options, system.dimension) if options.template is not None else point
                accepted = crowd is None or crowd.takes(point, join=inside[row])
                if accepted:
                    tries = options.maxtry
                    outside += not inside[row]
                if accepted and inside[row]:
                    found.append(point)
                elif options.template is not None:
                    options.matrices.pop()
            if tries == options.maxtry:      # on to the next atom, whether this one was placed or not
                atoms, tries = atoms + 1, 0
    if len(found) + outside < n:
        session.warn(f"Only inserted {len(found)} particles out of {n}")
    x = np.array(found).reshape(-1, *((options.template.natoms,) if options.template is not None else ()), 3)
    return x, np.full(len(x), kind)


def _mesh(session, path: str, system, options: _Options) -> tuple[np.ndarray, np.ndarray]:
    """Points on the triangles of an STL file, and their radii."""
    if options.lattice:
        raise InputError("create_atoms mesh: the keyword units box is needed")
    name, kind, triangles = mesh.read_stl(path)
    mode, value = options.meshmode or ("bisect", 1.0)
    parts = [(mesh.bisected if mode == "bisect" else mesh.quasirandom)(triangle, value) for triangle in triangles]
    x = np.concatenate([np.zeros((0, 3)), *(np.reshape(points, (-1, 3)) for points, _ in parts)])
    radii = np.concatenate([[], *(r for _, r in parts)])
    keep = _inside(x, system.box)
    session.print(f"Reading STL object {name} from {kind} file {path}")
    each = keep.sum() / max(1, len(triangles))
    session.print(f"  read {len(triangles)} triangles with {each:.2f} atoms per triangle added in {MESH[mode]} mode")
    return x[keep], radii[keep]


class _Crowd:
    """Atoms, old and new, that keep a distance from new ones."""

    def __init__(self, system, distance: float):
        self.box, self.limit, self.x, self.n = system.box, distance * distance, system.x.copy(), system.n

    def takes(self, new: np.ndarray, join: bool = True) -> bool:
        """Whether new atoms (3,) or (m, 3) are far enough from all; if so they join, if they shall."""
        new = new.reshape(-1, 3)
        if self.n:
            d = (new[:, None] - self.x[None, :self.n]).reshape(-1, 3)
            near, _ = self.box.minimum_image(d)
            if ((near * near).sum(axis=1) < self.limit).any():
                return False
        if not join:
            return True
        if self.n + len(new) > len(self.x):
            self.x = np.concatenate([self.x[:self.n], np.zeros((max(64, self.n, len(new)), 3))])
        self.x[self.n:self.n + len(new)] = new
        self.n += len(new)
        return True
