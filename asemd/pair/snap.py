r"""Spectral neighbour analysis potential (SNAP): the energy of an atom is linear, or quadratic, in the bispectrum of its neighbours.

$$E=\sum_i\Big[\beta_0+\boldsymbol\beta\cdot\mathbf B_i+\tfrac12\mathbf B_i^T\boldsymbol\alpha\,\mathbf B_i\Big],\quad
B_{j_1j_2j}=\sum u^{j*}\,H\,u^{j_1}u^{j_2},\quad u^j=w_0\,\mathbf 1+\sum_{k\ne i}w_kf_c(r_{ik})\,U^j(\mathbf r_{ik})$$

``pair_coeff * * COEFFICIENTS PARAMETERS`` and an element for each type. The core repulsion is another style, as in
``pair_style hybrid/overlay zbl 4.0 4.8 snap``. With ``chemflag 1`` elements have densities of their own, and components are those of
triples of elements in the order in which ``pair_coeff`` first names them, as in LAMMPS: name them in the order of the file. Our force is
the gradient also where coefficients of components that are equal by symmetry differ by more than rounding; ``compat="lammps"`` takes one of
them.

Source: LAMMPS manual, pair_style snap; Thompson, Swiler, Trott, Foiles and Tucker, J. Comp. Phys. 285, 316 (2015); Wood and Thompson,
J. Chem. Phys. 148, 241721 (2018); Cusentino, Wood and Thompson, J. Phys. Chem. A 124, 5456 (2020).
"""
from __future__ import annotations

import copy
from itertools import permutations
from types import MappingProxyType

import numpy as np

from asemd.bispectrum import bispectrum
from asemd.errors import InputError, nearest
from asemd.kernels.snap import HELPERS, snap
from asemd.manybody import ManyBody, element_of
from asemd.pairstyle import PairTables
from asemd.potential_file import PotentialFile, Record
from asemd.style import register

DEFAULTS = {"rfac0": 0.99363, "rmin0": 0.0, "switchflag": 1, "bzeroflag": 1, "quadraticflag": 0, "chemflag": 0, "bnormflag": 0,
            "wselfallflag": 0, "switchinnerflag": 0, "chunksize": 32768, "parallelthresh": 8192}
ROUNDED = 1e-9      # coefficients of equal components that differ by less, of the largest, count as equal
DESCRIBED = ("nelems", "elems", "radelems", "welems")      # of descriptor files (mliap)
FLAGS = ("switchflag", "bzeroflag", "quadraticflag", "chemflag", "bnormflag", "wselfallflag", "switchinnerflag")


def read_parameters(file: PotentialFile, count: int = 0) -> dict:
    """Keywords of a parameter file for `count` elements; without a number those of a descriptor file, which has the elements too.

    Raises
    ------
    InputError
        An unknown keyword, a value that makes no sense, one that is missing; the message names file and line.
    """
    found: dict = {}
    for number, line in file.lines:
        record = Record(line.split(), file.where(number), file.what)
        keyword = record.word()
        known = ("rcutfac", "twojmax", "sinner", "dinner", *DEFAULTS, *(() if count else DESCRIBED))
        if keyword not in known:
            raise file.error(f"unknown keyword {keyword!r}{nearest(keyword, known)}", number)
        if keyword in ("sinner", "dinner", "radelems", "welems"):
            found[keyword] = [record.number(keyword) for _ in range(count or found.get("nelems", 0))]
        elif keyword == "elems":
            found[keyword] = tuple(record.word(keyword) for _ in range(found.get("nelems", 0)))
        elif keyword in ("rcutfac", "rfac0", "rmin0"):
            found[keyword] = record.number(keyword)
        else:
            found[keyword] = record.whole(keyword)
        if keyword in FLAGS and found[keyword] not in (0, 1):
            raise file.error(f"{keyword} must be 0 or 1, got {found[keyword]}", number)
        if len(record.words) > record.at:
            raise file.error(f"a word too many after {keyword}: {record.words[record.at]}", number)
    for keyword in ("rcutfac", "twojmax", *(() if count else DESCRIBED), *(("sinner", "dinner") if found.get("switchinnerflag") else ())):
        if keyword not in found:
            raise InputError(f"{file.what}: {file.name} has no {keyword}")
    if not (found["rcutfac"] > 0.0 and 0 <= found["twojmax"] <= 20):
        raise InputError(f"{file.what}: {file.name}: rcutfac must be positive and twojmax 0 to 20, got {found['rcutfac']:g} and "
                         f"{found['twojmax']}")
    return {**DEFAULTS, **found}


def read_coefficients(file: PotentialFile, elements) -> dict[str, tuple[float, float, np.ndarray]]:
    """Radius, weight and coefficients of the elements of a file, in its order; of those that are not in `elements` the name only."""
    lines = iter(file.lines)

    def record(what: str) -> Record:
        number, line = next(lines, (0, ""))
        if not number:
            raise file.error(f"the file ends before {what}", len(file.raw))
        return Record(line.split(), file.where(number), file.what)

    head = record("the numbers of elements and coefficients")
    count, each = head.whole("the number of elements"), head.whole("the number of coefficients")
    out = {}
    for _ in range(count):
        head = record("an element")
        name = head.word("an element")
        radius, weight = head.number("the radius"), head.number("the weight")
        values = np.array([record(f"coefficient {k + 1} of {name}").number("a coefficient") for k in range(each)])
        if name in elements and name not in out:
            out[name] = radius, weight, values
    missing = [e for e in elements if e not in out]
    if missing:
        raise InputError(f"{file.what}: {file.name} has no element {' '.join(missing)}")
    return out


class SNAP(ManyBody):
    """Style snap."""

    head_words = "COEFFICIENTS PARAMETERS"
    coefficients: tuple[str, ...] = ("scale",)      # what ``fix adapt`` may change; of types with themselves it counts
    flat_room = True
    kernel_constants = MappingProxyType({"ALONE": True})
    like_lammps = False

    def variant(self, settings, compat=""):
        if compat != "lammps":
            return self
        if "_twin" not in vars(self):
            self._twin = copy.copy(self)
            self._twin.like_lammps = True
        return self._twin

    def head(self, words, what):
        return 2

    def head_for(self, files, elements):
        return [files[0], files[0].removesuffix("coeff") + "param"] if len(files) == 1 else list(files)

    def read(self, file, elements, settings):
        return read_coefficients(file, elements)

    def read_head(self, head, elements, settings):
        data, file = super().read_head(head[:1], elements, settings)
        second = PotentialFile(head[1], file.what)
        p = read_parameters(second, len(elements))
        tables = bispectrum(p["twojmax"], bool(p["bnormflag"]))
        count = len(tables.components) * (len(elements) ** 3 if p["chemflag"] else 1)
        if p["quadraticflag"]:
            count += count * (count + 1) // 2
        for e in elements:
            if len(data[e][2]) != count + 1:
                raise InputError(f"{file.what}: {file.name} has {len(data[e][2])} coefficients for {e}, but twojmax and flags of "
                                 f"{second.name} ask for {count + 1}")
        return {"elements": elements, "by_element": data, "parameters": p, "files": (file, second), "tables": tables}, file

    def join(self, old, new):
        return {**new, "scale": 1.0}

    def report(self, coeff):
        data = coeff["data"]
        first, second = ([f"Reading potential file {f.name} with DATE: {f.date}"] if f.date else [] for f in data["files"])
        shown = [f"SNAP Element = {e}, Radius {r:g}, Weight {w:g} " for e, (r, w, _) in data["by_element"].items()]
        return first + shown + second + [f"SNAP keyword {' '.join(line.split())} " for _, line in data["files"][1].lines]

    def room_for(self, tables, width):
        twojmax, elements = int(tables.constants[0]), int(tables.constants[1])
        _, _, _, zero, first, _, _, factors, _, _, _, _, layers = tables.arrays
        nu = int(first[twojmax + 1])
        numbers = 2 * int(layers[:, 1].sum()) + 4 * nu * elements + 2 * nu + 2 * len(factors) * elements**2 + 3 * len(zero) + 2 * nu * width
        return -(-numbers // width) + 1

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        element, c = element_of(filled, ntypes), next(iter(filled.values()))
        data, unit = c["data"], self.unit_factor(c, units)
        p, tables, named = data["parameters"], data["tables"], data["elements"]
        chem = len(named) if p["chemflag"] else 1
        by_type, rows = np.zeros((ntypes + 1, 5)), np.zeros((1, ntypes + 1, ntypes + 1))
        beta = np.zeros((ntypes + 1, len(data["by_element"][named[0]][2])))
        net, layers = data.get("net", {}), data.get("layers", np.zeros((0, 2), np.int64))
        nets = np.zeros((ntypes + 1, len(next(iter(net.values()), ()))))
        for t, e in enumerate(element):
            if e is None:
                continue
            if net:
                nets[t] = net[e]
            radius, weight, values = data["by_element"][e]
            k = named.index(e)
            inner = [p["sinner"][k], p["dinner"][k]] if p["switchinnerflag"] else [0.0, 0.0]
            by_type[t] = [k if p["chemflag"] else 0, radius, weight, *inner]
            beta[t] = unit * filled.get((t, t), {}).get("scale", 1.0) * values
        for i, j in filled:
            rows[0, i, j] = rows[0, j, i] = ((by_type[i, 1] + by_type[j, 1]) * p["rcutfac"]) ** 2
        each = np.arange(chem**3 * len(tables.components))[:, None]
        equal = equals(tables.components, chem) if chem > 1 and not self.like_lammps else each
        linear = beta[:, 1:]
        if linear.shape[1] == len(each) and np.abs(linear[:, equal].mean(axis=2) - linear).max() <= ROUNDED * np.abs(linear).max():
            equal = each
        zero = np.tile([float(p["bzeroflag"]) * (1.0 if p["bnormflag"] else j + 1.0) for _, _, j in tables.components], chem**3)
        constants = [p["twojmax"], chem, p["rcutfac"], p["rfac0"], p["rmin0"], p["switchflag"], p["wselfallflag"], p["quadraticflag"],
                     unit]
        return PairTables(rows, np.array(constants, float), (by_type, beta, equal, zero, tables.first, tables.weights, tables.z,
                                                             tables.factors, tables.products, tables.strengths, tables.roots, nets,
                                                             layers))


def equals(components, elements: int) -> np.ndarray:
    """Of each component of a triple of elements six that are equal to it, itself and others in turn (n, 6): where two j are equal the
    elements that belong to them may change places."""
    n = len(components)
    place = np.arange(elements**3 * n).reshape(elements, elements, elements, n)
    out = np.empty((elements, elements, elements, n, 6), np.int64)
    for k, js in enumerate(components):
        same = [order for order in permutations(range(3)) if tuple(js[a] for a in order) == js]
        for c in range(6):
            out[..., k, c] = place[..., k].transpose(same[c % len(same)])
    return out.reshape(-1, 6)


register(SNAP("snap", site=snap, helpers=HELPERS, converts=False, doc=__doc__, example="Ta06A.snapcoeff Ta06A.snapparam Ta",
              see="A. P. Thompson, L. P. Swiler, C. R. Trott, S. M. Foiles and G. J. Tucker, J. Comp. Phys. 285, 316 (2015)"))
