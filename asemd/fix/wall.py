r"""What flat walls share: six faces, positions and coefficients that may be variables, the energy of atoms at a distance r from a wall.

.. math:: E = U(r) - U(r_c) \;\; \text{for} \;\; 0 < r < r_c

The numbers of the hook: ``p[3]`` the energy, ``p[4:10]`` the forces on the walls, ``p[10]`` one more than the row of an atom that is not in
front of a wall, ``p[11]`` how many walls there are, then for each wall `WALL` numbers: the direction, -1 for a wall at the low end and 1
at the high end, its place, the cutoff, U at the cutoff, which potential it is, the coefficients.
"""
from __future__ import annotations

import inspect
import math
from collections.abc import Callable
from functools import cache
from typing import ClassVar

import numpy as np

from asemd.errors import InputError, SimulationError, nearest
from asemd.expression import compiled_function
from asemd.fix import hook
from asemd.fix.forcing import Forcing
from asemd.fix.formula import Value, read, write
from asemd.kernels.threads import barrier, reduce_sum
from asemd.words import choice, number, take, yes_no

FACES = ("xlo", "xhi", "ylo", "yhi", "zlo", "zhi")
WALL, FIRST = 24, 12
LJ93, LJ126, LJ1043, HARMONIC, MORSE, COLLOID, TABLE = range(7)
MOST = 18       # coefficients of a wall


def wall_energy(r, p, at, a):
    """Energy and slope of the potential whose kind is ``p[at + 5]`` and whose coefficients begin there after."""
    kind = p[at + 5]
    if kind <= 2.0:
        e, q = p[at + 6], p[at + 7] / r
        if kind == 0.0:
            q3 = q * q * q
            q9 = q3 * q3 * q3
            return e * (2.0 / 15.0 * q9 - q3), e * (3.0 * q3 - 1.2 * q9) / r
        if kind == 1.0:
            q6 = q * q * q * q * q * q
            return 4.0 * e * q6 * (q6 - 1.0), 24.0 * e * q6 * (1.0 - 2.0 * q6) / r
        q4 = q * q * q * q
        q10 = q4 * q4 * q * q
        root = math.sqrt(2.0)
        far = p[at + 7] / (r + 0.61 / root * p[at + 7])
        tail = root / 3.0 * far * far * far
        return (2.0 * math.pi * e * (0.4 * q10 - q4 - tail),
                2.0 * math.pi * e * (4.0 * (q4 - q10) / r + 3.0 * tail * far / p[at + 7]))
    if kind == 3.0:
        d = r - p[at + 3]
        return p[at + 6] * d * d, 2.0 * p[at + 6] * d
    if kind == 4.0:
        w = math.exp(-p[at + 7] * (r - p[at + 8]))
        return p[at + 6] * w * (w - 2.0), 2.0 * p[at + 6] * p[at + 7] * w * (1.0 - w)
    return 0.0, 0.0


def wall_forces(th, s, p, a):
    """Forces of all walls on a group; sums into ``p``."""
    bit = np.int32(np.int64(p[0]))
    count = int(p[11])
    energy = 0.0
    for m in range(count):
        at = 12 + 24 * m
        d, side, place, cut, shift = int(p[at]), p[at + 1], p[at + 2], p[at + 3], p[at + 4]
        total = 0.0
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                r = side * (place - s.x[d, i])
                if r < cut:
                    if r > 0.0:
                        e, slope = wall_energy(r, p, at, a)
                        energy += e - shift
                        s.f[d, i] += side * slope
                        total -= side * slope
                        if p[1] != 0.0:
                            s.virial[th.tid, d] -= slope * r
                    else:
                        p[10] = s.row[i] + 1.0
        total = reduce_sum(th, total)
        if th.tid == 0:
            p[4 + m] = total
    energy = reduce_sum(th, energy)
    if th.tid == 0:
        p[3] = energy
    barrier(th)


@cache
def forces_with(name: str, call: str, changes: tuple[tuple[str, str], ...] = ()) -> Callable:
    """`wall_forces` under another name, with another energy: `call` in the place of the call of `wall_energy`."""
    text = inspect.getsource(wall_forces).replace("wall_forces", name).replace("wall_energy(r, p, at, a)", call)
    for old, new in changes:
        text = text.replace(old, new)
    return compiled_function(name, text)


class Wall(Forcing):
    """Base class of flat walls.

    Parameters
    ----------
    group : str
        The atoms that feel the walls.
    walls : mapping of str to sequence
        Face ``xlo`` to ``zhi`` -> position, coefficients, cutoff; in distance units and those of the coefficients; all but the cutoff may
        be functions of the loop.
    pbc : bool
        Walls may stand in periodic directions.

    Raises
    ------
    InputError
        An unknown face, no walls, a wrong number of coefficients, a cutoff that is not positive.
    """

    told = 8
    first = 4
    modifies = ("energy", "virial")
    conservative = True
    names: ClassVar[tuple[str, ...]] = ("epsilon", "sigma")
    constants: ClassVar[int] = 0        # how many of the coefficients, from the last on, must be numbers
    kind: ClassVar[int] = LJ93

    def __init__(self, group: str = "all", walls=None, pbc: bool = False):
        super().__init__(group)
        self.walls: dict[str, tuple[Value, ...]] = {}
        self.pbc, self.words = pbc, []
        for face, values in dict(walls or {}).items():
            choice(face, FACES, f"fix {self.style}")
            if len(values) != len(self.names) + 2:
                raise InputError(f"fix {self.style} {face} needs a position, {' '.join(self.names)} and a cutoff, got {len(values)} values")
            self.check_cutoff(face, values[-1])
            self.walls[face] = tuple(values)
        if not self.walls:
            raise InputError(f"fix {self.style}: no walls defined, give one of {' '.join(FACES)}")
        if any(callable(v) for values in self.walls.values() for v in values):
            self.follows = "post_force"

    def check_cutoff(self, face: str, cutoff: float) -> None:
        if not cutoff > 0.0:
            raise InputError(f"fix {self.style}: the cutoff of wall {face} must be above 0, got {cutoff:g}")

    @property
    def size(self) -> int:
        """Elements of the vector: as many as walls."""
        return len(self.walls)

    # ---- words --------------------------------------------------------------------------------------------------------------------------
    @classmethod
    def from_lammps(cls, group, words, session):
        given_words, words = list(words), list(words)
        head = cls.read_head(words)
        walls, positions, options = {}, {}, {"units": "lattice", "pbc": False}
        while words:
            word, what = words[0], f"fix {cls.style} {words[0]}"
            if word in FACES:
                given = take(words[1:], len(cls.names) + 2, what)
                if word in walls:
                    raise InputError(f"{what} wall defined twice")
                check_face(cls.style, word, session)
                positions[word] = given[0]
                walls[word] = [cls.read_coefficient(w, n, what, session) for w, n in zip(given[1:-1], cls.names)]
                walls[word].append(number(given[-1], f"{what} cutoff"))
                words = words[1 + len(given):]
            elif word in ("units", "fld", "pbc"):
                value = take(words[1:], 1, what)[0]
                if word == "units":
                    options["units"] = choice(value, ("lattice", "box"), what)
                elif word == "pbc":
                    options["pbc"] = yes_no(value, what)
                elif yes_no(value, what):
                    raise InputError(f"{what} yes, for walls in the implicit solvent of fast lubrication dynamics, is not supported: "
                                     "leave it out")
                words = words[2:]
            else:
                raise InputError(f"fix {cls.style}: unknown keyword {word!r}{nearest(word, (*FACES, 'units', 'fld', 'pbc'))}")
        for face, word in positions.items():
            walls[face].insert(0, read_position(face, word, options["units"] == "lattice", session, f"fix {cls.style} {face}"))
        if not options["pbc"]:
            check_periodic(cls.style, walls, session.scene.system.box)
        fix = cls(group, walls, options["pbc"], **head)
        fix.words = given_words
        return fix

    @classmethod
    def read_head(cls, words: list[str]) -> dict:
        """Take words that stand before the walls from the list; further arguments of the class."""
        return {}

    @classmethod
    def read_coefficient(cls, word: str, name: str, what: str, session):
        return read(word, f"{what} {name}", session)

    def to_lammps(self) -> list[str]:
        if self.words:
            return list(self.words)
        words = self.head_words()
        for face, values in self.walls.items():
            words += [face, *(v if isinstance(v, str) else write(v) for v in values)]
        return [*words, "units", "box", *(["pbc", "yes"] if self.pbc else [])]

    def head_words(self) -> list[str]:
        return []

    # ---- numbers ------------------------------------------------------------------------------------------------------------------------
    def numbers(self, loop) -> list[float]:
        if not self.pbc:
            check_periodic(self.style, self.walls, loop.system.box)
        out = [float(len(self.walls))]
        for m, (face, values) in enumerate(self.walls.items()):
            out += self.block(m, face, [0.0 if callable(v) else v for v in values])
        return out

    def block(self, m: int, face: str, values: list[float]) -> list[float]:
        """The numbers of a wall."""
        place, *coefficients, cutoff = values
        head = ["xyz".index(face[0]), -1.0 if face.endswith("lo") else 1.0, place, cutoff, 0.0, self.kind]
        block = np.zeros(WALL)
        block[:6], block[6:6 + len(coefficients)] = head, coefficients
        block[4] = self.energy_at(cutoff, block)
        return block.tolist()

    def energy_at(self, cutoff: float, block: np.ndarray) -> float:
        return wall_energy(cutoff, block, 0, block)[0]

    def follow(self, loop) -> None:
        for m, (face, values) in enumerate(self.walls.items()):
            now = [v(loop) if callable(v) else v for v in values]
            if any(np.ndim(v) for v in now):
                raise InputError(f"fix {self.id} (style {self.style}): variables must be of style equal")
            at = FIRST + WALL * m
            self.p[at:at + WALL] = self.block(m, face, now)

    @hook(uses=[wall_energy, wall_forces])
    def post_force(th, s, p, a):
        wall_forces(th, s, p, a)

    def broken_constraint(self, loop) -> str:
        if self.p[10] == 0.0:
            return ""
        return f"atom {loop.system.id[int(self.p[10]) - 1]} is on the wall or behind it"

    def parameters(self, loop) -> np.ndarray:
        p = super().parameters(loop)
        p[10] = 0.0
        return p

    def setup(self, loop) -> None:
        """A run does not begin with atoms that the wall cannot see.

        Raises
        ------
        SimulationError
            Names the first such atom.
        """
        super().setup(loop)
        for m, face in enumerate(self.walls):
            d, side, place = self.p[FIRST + WALL * m:][:3]
            behind = loop.groups[self.group] & (side * (place - loop.system.x[:, int(d)]) <= 0.0)
            if behind.any():
                first = loop.system.id[int(np.argmax(behind))]
                raise SimulationError(f"fix {self.id} (style {self.style}): atom {first} is on the wall or behind it "
                                      f"({face}, {np.count_nonzero(behind)} in all)")

    def scalar(self) -> float:
        """Energy of atoms and walls, energy units."""
        return float(self.p[3])


class Scaled:
    """A variable in lattice spacings."""

    def __init__(self, value: Value, spacing: float):
        self.value, self.spacing = value, spacing

    def __call__(self, loop) -> float:
        return self.value(loop) * self.spacing


def check_face(style: str, face: str, session) -> None:
    """Walls along z are for three dimensions."""
    if face[0] == "z" and session.scene.need_system(f"fix {style}").dimension == 2:
        raise InputError(f"fix {style}: Cannot use wall {face} for a 2d simulation")


def check_periodic(style: str, faces, box) -> None:
    """Walls stand where the box ends."""
    for face in faces:
        if box.periodic["xyz".index(face[0])]:
            raise InputError(f"fix {style}: Cannot use {face} wall in periodic {face[0]} dimension: change the boundary"
                             + (", or say pbc yes" if style != "wall/reflect" else ""))


def read_position(face: str, word: str, lattice: bool, session, what: str) -> Value:
    """``EDGE``, a number in lattice spacings or distance units, or a variable."""
    scene, d = session.scene, "xyz".index(face[0])
    if word == "EDGE":
        box = scene.need_system(what).box
        return float(box.lo[d] if face.endswith("lo") else box.hi[d])
    value = read(word, f"{what} position", session)
    if not lattice or scene.lattice is None:
        return value
    spacing = float(scene.lattice.spacings[d])
    return Scaled(value, spacing) if callable(value) else value * spacing
