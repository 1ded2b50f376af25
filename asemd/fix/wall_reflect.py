r"""Mirrors: an atom that has crossed the plane comes back, its velocity turned.

.. math:: x \leftarrow 2 x_w - x, \qquad v \leftarrow -v

Source: LAMMPS manual, fix wall/reflect. Arguments: face and position (EDGE, a number or a variable) for each wall; ``units box`` or
``lattice``.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError, nearest
from asemd.fix import Fix, hook
from asemd.fix.formula import Value, write
from asemd.fix.wall import FACES, check_face, check_periodic, read_position
from asemd.words import choice, take


class WallReflect(Fix):
    """Reflecting walls.

    Parameters
    ----------
    group : str
        The atoms that they reflect.
    walls : mapping of str to float or callable
        Face ``xlo`` to ``zhi`` -> position, distance units of the scene; a function of the loop may return it.

    Raises
    ------
    InputError
        An unknown face, no walls, a wall in a periodic direction.
    """

    style = "wall/reflect"
    levels = "every"

    def __init__(self, group: str = "all", walls=None):
        super().__init__(group)
        self.walls: dict[str, Value] = {choice(face, FACES, "fix wall/reflect"): at for face, at in dict(walls or {}).items()}
        if not self.walls:
            raise InputError(f"fix wall/reflect: no walls defined, give one of {' '.join(FACES)}")
        self.words: list[str] = []
        self.p = np.zeros(1)
        if any(callable(v) for v in self.walls.values()):
            self.follows = "post_integrate"

    @classmethod
    def from_lammps(cls, group, words, session):
        given, positions, lattice = list(words), {}, True
        while words:
            word, what = words[0], f"fix wall/reflect {words[0]}"
            if word not in (*FACES, "units"):
                raise InputError(f"fix wall/reflect: unknown keyword {word!r}{nearest(word, (*FACES, 'units'))}")
            value = take(words[1:], 1, what)[0]
            if word == "units":
                lattice = choice(value, ("lattice", "box"), what) == "lattice"
            elif word in positions:
                raise InputError(f"{what} wall defined twice")
            else:
                check_face(cls.style, word, session)
                positions[word] = value
            words = words[2:]
        check_periodic(cls.style, positions, session.scene.need_system("fix wall/reflect").box)
        fix = cls(group, {face: read_position(face, word, lattice, session, f"fix wall/reflect {face}")
                          for face, word in positions.items()})
        fix.words = given
        return fix

    def to_lammps(self) -> list[str]:
        return list(self.words) or [w for face, v in self.walls.items() for w in (face, write(v))] + ["units", "box"]

    def parameters(self, loop) -> np.ndarray:
        check_periodic(self.style, self.walls, loop.system.box)
        self.p = np.array([loop.group_bit(self.group), *(w for face, at in self.walls.items() for w in
                          ("xyz".index(face[0]), -1.0 if face.endswith("lo") else 1.0, 0.0 if callable(at) else at))], dtype=float)
        return self.p

    def follow(self, loop) -> None:
        for m, at in enumerate(self.walls.values()):
            if callable(at):
                self.p[3 + 3 * m] = at(loop)

    @hook
    def post_integrate(th, s, p, a):
        bit = np.int32(np.int64(p[0]))
        for m in range((p.size - 1) // 3):
            d, side, at = int(p[1 + 3 * m]), p[2 + 3 * m], p[3 + 3 * m]
            for i in range(th.lo, th.hi):
                if s.mask[i] & bit != 0 and side * (s.x[d, i] - at) > 0.0:
                    s.x[d, i] = at + (at - s.x[d, i])
                    s.v[d, i] = -s.v[d, i]
