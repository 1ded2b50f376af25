r"""Bond-orientational order in layers, of each atom.

.. math:: q_n = \frac{1}{N} \sum_{j=1}^{N} e^{i n \theta_j}

with the angles of the vectors to the N nearest neighbours in the xy plane. Source: LAMMPS manual, compute hexorder/atom. No units.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._pairs import force_cutoff, half, within_force_cutoff
from asemd.compute.orientorder_atom import positive
from asemd.errors import InputError, nearest
from asemd.kernels import order
from asemd.words import number, take, whole

KEYWORDS = ("degree", "nnn", "cutoff")


class HexOrderAtom(Compute):
    """Order in layers.

    Parameters
    ----------
    group : str
        The atoms it reports; all atoms are neighbours.
    degree : int
        The n of the formula.
    neighbors : int or None
        How many of the nearest ones count; atoms with fewer have zeros. None: all within the cutoff.
    cutoff : float, optional
        Distance units; None: the largest cutoff of the pair style.

    Raises
    ------
    InputError
        A negative degree, or a cutoff that is not positive.
    """

    style = "hexorder/atom"

    def __init__(self, group: str = "all", degree: int = 6, neighbors: int | None = 6, cutoff: float | None = None):
        super().__init__(group)
        if degree < 0:
            raise InputError(f"compute hexorder/atom degree must not be negative, got {degree}")
        if cutoff is not None and cutoff <= 0.0:
            raise InputError(f"compute hexorder/atom cutoff must be positive, got {cutoff:g}")
        self.degree, self.count, self.cutoff = degree, neighbors or 0, cutoff

    @classmethod
    def from_lammps(cls, group, words, session):
        rest, given, what = list(words), {}, "compute hexorder/atom"
        while rest:
            word = rest.pop(0)
            if word not in KEYWORDS:
                raise InputError(f"{what}: unknown keyword {word!r}{nearest(word, KEYWORDS)}")
            value = take(rest, 1, f"{what} {word}")[0]
            rest.pop(0)
            if word == "nnn":
                given["neighbors"] = None if value == "NULL" else positive(value, f"{what} nnn")
            else:
                given[word] = whole(value, f"{what} degree") if word == "degree" else number(value, f"{what} cutoff")
        return cls(group, **given)

    def to_lammps(self) -> list[str]:
        cutoff = ["cutoff", repr(self.cutoff)] if self.cutoff is not None else []
        return ["degree", str(self.degree), "nnn", str(self.count or "NULL"), *cutoff]

    def per_atom_columns(self) -> int:
        return 2

    def per_atom(self, state) -> np.ndarray:
        """(n, 2) real and imaginary part; zero outside the group."""
        what = "compute hexorder/atom"
        reach = force_cutoff(state, what) if self.cutoff is None else within_force_cutoff(state, self.cutoff, what)
        start, _, vector, square = half(state, reach).around(state.system.n)
        out = np.zeros((state.system.n, 2))
        order.hexagonal(np.flatnonzero(state.mask(self.group)), start, vector, square, self.degree, self.count, out)
        return out
