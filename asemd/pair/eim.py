r"""Embedded-ion method for ionic compounds: atoms have charges by who their neighbours are, and an energy in each other's potential.

$$E=\tfrac12\sum_i\sum_{j\ne i}\phi_{ij}(r_{ij})+\tfrac12\sum_iq_i\sigma_i,\quad q_i=\sum_{j\ne i}\eta_{ji}(r_{ij}),\quad
\sigma_i=\sum_{j\ne i}q_j\psi_{ij}(r_{ij})$$
$$\eta_{ji}=A_\eta(\chi_j-\chi_i)f_c(r;r_{s,\eta},r_{c,\eta}),\quad\psi=A_\psi e^{-\zeta r}f_c(r;r_{s,\psi},r_{c,\psi})$$

and $\phi$ with two exponentials or two powers of the distance, less $q_{0,i}q_{0,j}\psi_{ij}$ of the charges q0 in the file. As in
LAMMPS the functions are tables of 5000 values, cubic in between.
The file has lines ``global:``, ``element:`` and ``pair:``; ``pair_coeff * * EL1 EL2 ... FILE`` names the elements first, then for each
type one of them.

Source: LAMMPS manual, pair_style eim; X. W. Zhou and F. P. Doty, Phys. Rev. B 78, 224307 (2008).
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError
from asemd.kernels.embedded_ion import interval, ion_forces
from asemd.manybody import ManyBody, element_of
from asemd.pairstyle import PairTables
from asemd.potential_file import Record, file_among
from asemd.splines import polynomials
from asemd.style import register

POINTS = 5000
CLOSEST = 0.2       # functions stay as they are there at shorter distances
NUMBERS = "rcut1 rcut2 Eb r0 alpha beta rcutq Asigma rq rcutsigma Ac zeta rs form"


def tapered(r, start, end, low, high):
    """The cutoff function between `start` and `end`; `low` and `high` are where erfc is looked at there."""
    from scipy.special import erfc
    a = (high - low) / (end - start) * (r - start) + low
    return (erfc(a) - math.erfc(high)) / (math.erfc(low) - math.erfc(high))


def functions(p, difference: float, edges, r: np.ndarray) -> np.ndarray:
    """eta, psi and phi (3, m) of a pair of elements at distances `r`; `difference` of the electronegativities, neighbour minus atom."""
    r = np.maximum(r, CLOSEST)
    eta = np.where(r < p["rcutq"], p["Asigma"] * difference * tapered(r, p["rq"], p["rcutq"], *edges), 0.0)
    psi = np.where(r < p["rcutsigma"], p["Ac"] * np.exp(-p["zeta"] * r) * tapered(r, p["rs"], p["rcutsigma"], *edges), 0.0)
    a, b = (p["Eb"] * p[name] / (p["beta"] - p["alpha"]) for name in ("alpha", "beta"))
    if p["form"] == 1.0:
        a, b = a * np.exp(-p["beta"] * (r / p["r0"] - 1.0)), b * np.exp(-p["alpha"] * (r / p["r0"] - 1.0))
    else:
        a, b = a * (p["r0"] / r) ** p["beta"], b * (p["r0"] / r) ** p["alpha"]
    attraction = np.where(r < p["rcut1"], a * tapered(r, p["r0"], p["rcut1"], *edges), 0.0)
    return np.stack([eta, psi, np.where(r < p["rcut2"], b * tapered(r, p["r0"], p["rcut2"], *edges), 0.0) - attraction])


class EmbeddedIon(ManyBody):
    """Style eim."""

    head_words = "EL1 EL2 ... FILE"
    half_list = True

    def head(self, words, what):
        return file_among(words, 1, what) + 1

    def head_for(self, files, elements):
        return [*elements, *files] if len(files) == 1 else list(files)

    def read_head(self, head, elements, settings):
        what = f"pair_coeff {self.name}"
        *listed, name = head
        if len(set(listed)) < len(listed):
            raise InputError(f"{what}: an element is there twice before the file: {' '.join(listed)}")
        for e in elements:
            if e not in listed:
                raise InputError(f"{what}: element {e} is not among those before the file, {' '.join(listed)}")
        data, file = super().read_head((name,), tuple(listed), settings)
        return data, file

    def read(self, file, elements, settings):
        found, words, start = {}, [], 0
        for number, line in file.lines:
            start = start if words else number
            words += line.split()
            if words[-1] == "&":
                words.pop()
                continue
            record, words = Record(words, file.where(start), file.what), []
            kind = record.word()
            if kind == "global:":
                found[kind] = record.numbers("division low high"), record.where
                continue
            if kind not in ("element:", "pair:"):
                raise InputError(f"{file.what}: a line must begin with global:, element: or pair:, got {kind!r}", record.where)
            key = tuple(record.word("an element") for _ in range(1 + (kind == "pair:")))
            if key in found:
                first = found[key][1]
                raise InputError(f"{file.what}: {kind} {' '.join(key)} is there twice, first at {first.file}:{first.line}", record.where)
            names = NUMBERS if kind == "pair:" else "number mass negativity ra ri cohesion q0"
            found[key] = found[key[::-1]] = record.numbers(names), record.where
        needed = ["global:", *((a,) for a in elements), *((a, b) for k, a in enumerate(elements) for b in elements[:k + 1])]
        for key in needed:
            if key not in found:
                says = key if isinstance(key, str) else f"{'pair' if len(key) == 2 else 'element'}: {' '.join(key)}"
                raise InputError(f"{file.what}: {file.name} has no line {says}")
        for key in needed:
            if len(key) == 2:
                self.check(*found[key], file.what)
        return {"elements": elements, **{key: found[key][0] for key in needed}}

    @staticmethod
    def check(p, where, what) -> None:
        """Refuse numbers of a pair that make no sense."""
        if p["form"] not in (1.0, 2.0) or p["alpha"] == p["beta"]:
            raise InputError(f"{what}: the form of a pair must be 1 or 2 and alpha unlike beta, got {p['form']:g}, {p['alpha']:g}, "
                             f"{p['beta']:g}", where)
        for name in ("r0", "rcut1", "rcut2"):
            if not p[name] > 0.0:
                raise InputError(f"{what}: {name} of a pair must be positive, got {p[name]:g}", where)

    def masses(self, coeff, i: int) -> float:
        """Mass of atom type `i` by the file."""
        return coeff["data"][(coeff["element"][i - 1],)]["mass"]

    def report(self, coeff):
        return [line.replace(f"{self.reads} ", "", 1) for line in super().report(coeff)]

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        element, c = element_of(filled, ntypes), next(iter(filled.values()))
        data, unit = c["data"], self.unit_factor(c, units)
        edges = data["global:"]["low"], data["global:"]["high"]
        named = data["elements"]
        pairs = {(a, b): data[(a, b) if (a, b) in data else (b, a)] for a in named for b in named}
        cuts = {key: max(p["rcut1"], p["rcut2"], p["rcutq"], p["rcutsigma"]) for key, p in pairs.items()}
        step = max(cuts.values()) / (POINTS - 1)
        r = np.arange(POINTS) * step
        rows, offset = np.zeros((1, ntypes + 1, ntypes + 1)), np.zeros((ntypes + 1, ntypes + 1), np.int64)
        at, blocks = {}, []
        for i, j in {key for pair in filled for key in (pair, pair[::-1])}:
            key = element[i], element[j]
            if key not in at:
                at[key] = len(blocks) * (POINTS - 1)
                a, b = (data[(e,)]["negativity"] for e in key)
                values = functions(pairs[key], b - a, edges, r) * np.array([[1.0], [unit], [unit]])
                values[2] -= data[(key[0],)]["q0"] * data[(key[1],)]["q0"] * values[1]
                blocks.append(polynomials(values, flat=True).swapaxes(0, 1).reshape(POINTS - 1, 12))
            offset[i, j] = at[key]
            rows[0, i, j] = cuts[key] ** 2
        return PairTables(rows, np.array([1.0 / step, POINTS - 2.0]), (np.concatenate(blocks), offset))


register(EmbeddedIon("eim", forces=ion_forces, helpers=(interval,), shares=2, doc=__doc__, example="Na Cl ffield.eim Na",
                     see="X. W. Zhou and F. P. Doty, Phys. Rev. B 78, 224307 (2008)"))
