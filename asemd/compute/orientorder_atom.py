r"""Bond-orientational order parameters of each atom (Steinhardt).

.. math:: Q_l = \sqrt{\frac{4\pi}{2l+1} \sum_m |\bar Y_{lm}|^2}, \qquad
   W_l = \frac{1}{\sqrt{2l+1}} \sum_{m_1+m_2+m_3=0}
   \begin{pmatrix} l & l & l \\ m_1 & m_2 & m_3 \end{pmatrix} \bar Y_{lm_1} \bar Y_{lm_2} \bar Y_{lm_3}, \qquad
   \hat W_l = \frac{\sqrt{2l+1}\, W_l}{(\sum_m |\bar Y_{lm}|^2)^{3/2}}

with the mean :math:`\bar Y_{lm}` of the spherical harmonics of the vectors from the nearest neighbours. Odd
:math:`W_l` are zero. Source: LAMMPS manual, compute
orientorder/atom; Steinhardt, Nelson, Ronchetti, Phys. Rev. B 28, 784 (1983). No units.
"""
from __future__ import annotations

from functools import cache
from math import factorial, pi

import numpy as np

from asemd.compute import Compute
from asemd.compute._pairs import force_cutoff, half, within_force_cutoff
from asemd.errors import InputError, nearest
from asemd.kernels import order
from asemd.words import number, take, whole, yes_no

KEYWORDS = ("nnn", "degrees", "wl", "wl/hat", "components", "cutoff", "chunksize")


@cache
def symbols(l: int) -> np.ndarray:
    """Wigner's 3j symbols (l l l; a-l b-l 2l-a-b) as (2l+1, 2l+1), by Racah's formula in whole numbers."""
    out = np.zeros((2 * l + 1, 2 * l + 1))
    triangle = factorial(l) ** 3 / factorial(3 * l + 1)
    for m1 in range(-l, l + 1):
        for m2 in range(max(-l, -l - m1), min(l, l - m1) + 1):
            m3 = -m1 - m2
            scale = 1
            for m in (m1, m2, m3):
                scale *= factorial(l + m) * factorial(l - m)
            low, high = max(0, -m1, m2), min(l, l - m1, l + m2)
            terms = [(1 if (k + m3) % 2 == 0 else -1) / (factorial(k) * factorial(l - k) * factorial(l - m1 - k) * factorial(l + m2 - k)
                     * factorial(k + m1) * factorial(k - m2)) for k in range(low, high + 1)]
            out[m1 + l, m2 + l] = (triangle * scale) ** 0.5 * sum(terms)
    return out


class OrientOrderAtom(Compute):
    """Bond-orientational order.

    Parameters
    ----------
    group : str
        The atoms it reports; all atoms are neighbours.
    degrees : sequence of int
        The values of l.
    neighbors : int or None
        How many of the nearest ones count; atoms with fewer have zeros. None: all within the cutoff.
    cutoff : float, optional
        Distance units; None: the largest cutoff of the pair style.
    wl, wl_hat : bool
        Third-order invariants too.
    components : int, optional
        This degree's normalised harmonics too, real and imaginary parts from m = -l to l.

    Raises
    ------
    InputError
        No or negative degrees, or components of a degree that is not among them.
    """

    style = "orientorder/atom"

    def __init__(self, group: str = "all", degrees=(4, 6, 8, 10, 12), neighbors: int | None = 12, cutoff: float | None = None,
                 wl: bool = False, wl_hat: bool = False, components: int | None = None):
        super().__init__(group)
        self.degrees, self.count, self.cutoff = list(degrees), neighbors or 0, cutoff
        self.wl, self.wl_hat, self.components = wl, wl_hat, components
        if not self.degrees or min(self.degrees) < 0:
            raise InputError(f"compute orientorder/atom degrees: whole numbers that are not negative, got {self.degrees}")
        if self.count < 0:
            raise InputError(f"compute orientorder/atom nnn must be positive or NULL, got {self.count}")
        if components is not None and components not in self.degrees:
            raise InputError(f"compute orientorder/atom components {components} is not one of the degrees {' '.join(map(str, degrees))}")
        if cutoff is not None and cutoff <= 0.0:
            raise InputError(f"compute orientorder/atom cutoff must be positive, got {cutoff:g}")

    @classmethod
    def from_lammps(cls, group, words, session):
        rest, given, what = list(words), {}, "compute orientorder/atom"
        while rest:
            word = rest.pop(0)
            if word not in KEYWORDS:
                raise InputError(f"{what}: unknown keyword {word!r}{nearest(word, KEYWORDS)}")
            value = take(rest, 1, f"{what} {word}")[0]
            rest.pop(0)
            if word == "nnn":
                given["neighbors"] = None if value == "NULL" else positive(value, f"{what} nnn")
            elif word == "degrees":
                n = positive(value, f"{what} degrees")
                given["degrees"] = [whole(w, f"{what} degrees") for w in take(rest, n, f"{what} degrees {n}")]
                rest = rest[n:]
            elif word in ("wl", "wl/hat"):
                given[word.replace("/", "_")] = yes_no(value, f"{what} {word}")
            elif word == "cutoff":
                given["cutoff"] = number(value, f"{what} cutoff")
            elif word == "chunksize":
                positive(value, f"{what} chunksize")      # memory of accelerators, which changes no number
            else:
                given["components"] = whole(value, f"{what} components")
        return cls(group, **given)

    def to_lammps(self) -> list[str]:
        out = ["nnn", str(self.count or "NULL"), "degrees", str(len(self.degrees)), *map(str, self.degrees)]
        out += ["wl", "yes"] * self.wl + ["wl/hat", "yes"] * self.wl_hat
        out += ["components", str(self.components)] if self.components is not None else []
        return out + (["cutoff", repr(self.cutoff)] if self.cutoff is not None else [])

    def per_atom_columns(self) -> int:
        extra = 2 * (2 * self.components + 1) if self.components is not None else 0
        return len(self.degrees) * (1 + self.wl + self.wl_hat) + extra

    def reach(self, state) -> float:
        """The distance within which neighbours count."""
        return force_cutoff(state, "compute orientorder/atom") if self.cutoff is None else \
            within_force_cutoff(state, self.cutoff, "compute orientorder/atom")

    def harmonics(self, state, atoms: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Mean harmonics (n, degrees, 2 lmax + 1), and whether an atom has enough neighbours (n,)."""
        n = state.system.n
        start, _, vector, square = half(state, self.reach(state)).around(n)
        out, enough = np.zeros((n, len(self.degrees), 2 * max(self.degrees) + 1), complex), np.zeros(n, bool)
        order.harmonics(atoms, start, vector, square, np.array(self.degrees), self.count, out, enough)
        return out, enough

    def unit_harmonics(self, state) -> np.ndarray:
        """(n, 2l+1) normalised mean harmonics of the degree of `components`; zero outside the group."""
        q, _ = self.harmonics(state, np.flatnonzero(state.mask(self.group)))
        return self._unit(q)

    def _unit(self, q) -> np.ndarray:
        k = self.degrees.index(self.components)
        q = q[:, k, :2 * self.components + 1]
        size = np.sqrt((np.abs(q) ** 2).sum(axis=1))
        return q / np.where(size > 1e-15, size, np.inf)[:, None]

    def per_atom(self, state) -> np.ndarray:
        """(n, columns): Q of each degree, then W, then W hat, then the components; zero outside the group."""
        atoms, n = np.flatnonzero(state.mask(self.group)), state.system.n
        q, _ = self.harmonics(state, atoms)
        norm2 = (np.abs(q) ** 2).sum(axis=2)
        l = np.array(self.degrees)
        columns = [np.sqrt(4.0 * pi / (2 * l + 1) * norm2)]
        if self.wl or self.wl_hat:
            w = np.zeros((n, len(l)))
            for k, degree in enumerate(self.degrees):
                order.third_order(atoms, np.ascontiguousarray(q[:, k, :2 * degree + 1]), degree, symbols(degree), w[:, k])
            columns += [w / np.sqrt(2 * l + 1)] * self.wl + [w / np.where(norm2 > 1e-30, norm2, np.inf) ** 1.5] * self.wl_hat
        if self.components is not None:
            unit = self._unit(q)
            columns.append(np.stack([unit.real, unit.imag], axis=2).reshape(n, -1))
        return np.concatenate(columns, axis=1)


def positive(word: str, what: str) -> int:
    value = whole(word, what)
    if value < 1:
        raise InputError(f"{what} must be positive, got {value}")
    return value
