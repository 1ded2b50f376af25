"""What fixes that change forces by a compiled hook share: numbers that may be variables, a region, energy and virial for the totals.

The numbers of the hooks: ``p[0]`` the group bit, ``p[1]`` whether the virial counts, ``p[2]`` whether the per-atom numbers are in use, from
``p[3]`` on what the hook tells (`told` of them), then the values and what `numbers` returns. Per-atom numbers: column 0 says whether an
atom is in the region, the others are the values by atom.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from asemd.errors import InputError, nearest
from asemd.fix import Fix
from asemd.fix.formula import Value, read, write
from asemd.kernels.threads import reduce_sum
from asemd.words import take, yes_no

if TYPE_CHECKING:
    from asemd.loop import Loop


class Forcing(Fix):
    """Base class of fixes that change forces.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    values : sequence of float or callable or None
        Numbers, or functions of the loop that return one number or one per atom; None: not given.
    region : Region, optional
        Only atoms inside it.
    """

    minimizes = True
    levels = "one"
    extensive = True
    told: ClassVar[int] = 0          # how many numbers the hook tells
    size: ClassVar[int] = 0             # elements of the vector
    first: ClassVar[int] = 3            # where the vector begins in ``p``
    modifies: ClassVar[tuple[str, ...]] = ()    # of fix_modify: energy, virial
    by_atom: ClassVar[bool] = False     # whether a variable may be of style atom
    conservative: ClassVar[bool] = False    # forces are minus the gradient of `scalar`, unless numbers change

    def __init__(self, group: str = "all", values: tuple[Value | None, ...] = (), region=None):
        super().__init__(group)
        self.values, self.region, self.region_id = tuple(values), region, getattr(region, "id", "")
        self.p = np.zeros(3 + self.told)
        self.a: np.ndarray | None = None
        if region is not None or any(callable(v) for v in self.values):
            self.follows = "post_force"

    # ---- words --------------------------------------------------------------------------------------------------------------------------
    @classmethod
    def read_values(cls, words: list[str], names: str, session, null: bool = False) -> list[Value | None]:
        """One value for each of the blank-separated names: a number, v_name, or NULL if that is allowed."""
        names = names.split()
        if len(words) < len(names):
            raise InputError(f"fix {cls.style} needs {' '.join(names)}, got {len(words)} values")
        return [None if null and w == "NULL" else read(w, f"fix {cls.style} {n}", session) for w, n in zip(words, names)]

    @classmethod
    def read_keywords(cls, words: list[str], known: dict[str, Any], session) -> dict[str, Any]:
        """Keywords and their values; `known` has for each keyword a function of its values' words, or the number of these words.

        The keyword ``region`` becomes the region, with the ID that it has.
        """
        out: dict[str, Any] = {}
        while words:
            keyword, what = words[0], f"fix {cls.style} {words[0]}"
            if keyword not in known:
                raise InputError(f"fix {cls.style}: unknown keyword {keyword!r}{nearest(keyword, known)}")
            values = take(words[1:], 1, what)
            if keyword == "region":
                out[keyword] = session.scene.region(values[0], what)
                out["region_id"] = values[0]
            else:
                out[keyword] = known[keyword](values[0], what)
            words = words[2:]
        return out

    def region_words(self) -> list[str]:
        return ["region", self.region_id] if self.region is not None else []

    def value_words(self) -> list[str]:
        return [write(v) for v in self.values]

    # ---- numbers of the hooks -----------------------------------------------------------------------------------------------------------
    def numbers(self, loop: Loop) -> list[float]:
        """What stands in ``p`` after the values."""
        return []

    def parameters(self, loop: Loop) -> np.ndarray:
        told = self.p[3:3 + self.told]
        values = [0.0 if v is None or callable(v) else v for v in self.values]
        head = [loop.group_bit(self.group), self.thermo_virial, bool(self.uses_atoms())]
        self.p = np.array([*head, *told, *values, *self.numbers(loop)], float)
        return self.p

    def uses_atoms(self) -> bool:
        """Whether there are numbers by atom."""
        return self.region is not None or (self.by_atom and bool(self.follows))

    def atom_arrays(self, loop: Loop) -> np.ndarray | None:
        if not self.uses_atoms():
            return None
        self.a = np.zeros((loop.system.n, 1 + len(self.values)))
        self.a[:, 0] = 1.0
        for k, value in enumerate(self.values):
            if value is not None and not callable(value):
                self.a[:, 1 + k] = value
        return self.a

    def places(self, system) -> np.ndarray:
        """(n, 3) where the fix acts on each atom, distance units."""
        return system.x

    def follow(self, loop: Loop) -> None:
        if self.region is not None:
            loop.sync_out()
            self.region.see(loop)
            self.a[:, 0] = self.region.inside(self.places(loop.system))
        for k, value in enumerate(self.values):
            if callable(value):
                now = value(loop)
                if self.by_atom:
                    self.a[:, 1 + k] = now
                elif np.ndim(now):
                    raise InputError(f"fix {self.id} (style {self.style}): variable {write(value)} must be of style equal")
                else:
                    self.p[3 + self.told + k] = now

    def has_potential(self) -> bool:
        """Whether its forces are minus the gradient of `scalar`, a function of positions alone."""
        return self.conservative and not self.follows

    # ---- outputs ---------------------------------------------------------------------------------------------------------------------
    @property
    def outputs(self) -> set[str]:
        """Which of scalar and vector it has."""
        return ({"scalar"} if type(self).scalar is not Fix.scalar else set()) | ({"vector"} if self.size else set())

    def vector(self, i: int) -> float:
        if not self.size:
            return super().vector(i)
        if not 1 <= i <= self.size:
            raise InputError(f"fix {self.id} (style {self.style}): its vector has {self.size} components, not {i}")
        return float(self.p[self.first + i - 1])

    def modify_option(self, keyword, value, session):
        if keyword in self.modifies:
            setattr(self, f"thermo_{keyword}", yes_no(value, f"fix_modify {keyword}"))
            return True
        return super().modify_option(keyword, value, session)


def unwrapped(s, i, d):
    """Component `d` of the unwrapped position of a slot."""
    row, v = s.row[i], s.box.vectors
    return s.x[d, i] + s.image[row, 0] * v[0, d] + s.image[row, 1] * v[1, d] + s.image[row, 2] * v[2, d]


def tally(th, s, i, fx, fy, fz):
    """The virial of a force on a slot, with its unwrapped position."""
    x, y, z = unwrapped(s, i, 0), unwrapped(s, i, 1), unwrapped(s, i, 2)
    s.virial[th.tid, 0] += fx * x
    s.virial[th.tid, 1] += fy * y
    s.virial[th.tid, 2] += fz * z
    s.virial[th.tid, 3] += fx * y
    s.virial[th.tid, 4] += fx * z
    s.virial[th.tid, 5] += fy * z


def centre_of_mass(th, s, bit):
    """Mass and centre of the atoms of a group, with unwrapped positions: four numbers; the centre of nothing is 0."""
    mass, x, y, z = 0.0, 0.0, 0.0, 0.0
    for i in range(th.lo, th.hi):
        if s.mask[i] & bit != 0:
            mass += s.mass[i]
            x += s.mass[i] * unwrapped(s, i, 0)
            y += s.mass[i] * unwrapped(s, i, 1)
            z += s.mass[i] * unwrapped(s, i, 2)
    mass = reduce_sum(th, mass)
    x, y, z = reduce_sum(th, x), reduce_sum(th, y), reduce_sum(th, z)
    part = 1.0 / mass if mass > 0.0 else 0.0
    return mass, x * part, y * part, z * part
