r"""Second derivatives of the energy by strain: the Born term of the elastic constants.

.. math:: C_{ijkl} = \frac{\partial^2 U}{\partial \eta_{ij} \partial \eta_{kl}}, \qquad
   C^{pair}_{ijkl} = \sum_{pairs} \frac{1}{r^2} \left( U'' - \frac{U'}{r} \right) r_i r_j r_k r_l

by the Lagrangian strain, of all pairs, bonds, angles, dihedrals and impropers, of which some may be chosen. ``numdiff delta ID``: by
differences of the virial of a compute pressure instead, for styles that have no second derivatives.

Source: LAMMPS manual, compute born/matrix; Clavier et al., Comp. Phys. Commun. 286, 108674 (2023). Units: energy (divide by the volume for
elastic constants). Output: a vector of 21 in Voigt's notation: 11 22 33 44 55 66 12 13 14 15 16 23 24 25 26 34 35 36 45 46 56.

LAMMPS's analytic values of pairs (with U'' - 2 U' / r) and of dihedrals are not what its own ``numdiff`` finds; these are. ``-compat
lammps`` gives its values of pairs.
"""
from __future__ import annotations

import copy
from dataclasses import replace

import numpy as np

from asemd.compute import Compute
from asemd.compute._pairs import all_of, check_pairwise, half
from asemd.compute.pressure import Pressure
from asemd.curvatures import bonded_items, of_list, of_pairs
from asemd.engine import Engine
from asemd.errors import InputError, nearest
from asemd.term import BondedTerm, PairListTerm
from asemd.words import number, take

TERMS = ("pair", "bond", "angle", "dihedral", "improper")
VOIGT = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
ELEMENTS = tuple((i, i) for i in range(6)) + tuple((i, j) for i in range(6) for j in range(i + 1, 6))
UNIT = np.array([[(i, j) in ((a, b), (b, a)) and (1.0 if a == b else 0.5) for i in range(3) for j in range(3)]
                 for a, b in VOIGT], float).reshape(6, 3, 3)      # strains whose element ij is one
TWICE = np.einsum("sab,tbc->stac", UNIT, UNIT) + np.einsum("tab,sbc->stac", UNIT, UNIT)
ORDER = (0, 1, 2, 5, 4, 3)      # of the elements of VOIGT in virials: xx yy zz xy xz yz


class BornMatrix(Compute):
    """Born matrix.

    Parameters
    ----------
    group : str
        Pairs and items all of whose atoms belong to it count; with `delta` it makes no difference.
    terms : sequence of str, optional
        Some of pair, bond, angle, dihedral, improper; none: all.
    delta : float, optional
        Strain of central differences.
    pressure : asemd.compute.Pressure, optional
        Says which virial is differentiated.

    Raises
    ------
    InputError
        Unknown terms, terms and differences together, a strain that is not positive; (when it is evaluated) a style without second
        derivatives.
    """

    style = "born/matrix"
    extensive = False
    size = 21

    def __init__(self, group: str = "all", terms=(), delta: float | None = None, pressure: Pressure | None = None):
        super().__init__(group)
        for term in terms:
            if term not in TERMS:
                raise InputError(f"compute born/matrix: unknown keyword {term!r}{nearest(term, (*TERMS, 'numdiff'))}")
        if delta is not None and terms:
            raise InputError("compute born/matrix: numdiff cannot be mixed with other keywords")
        if delta is not None and delta <= 0.0:
            raise InputError(f"compute born/matrix numdiff: the strain must be positive, got {delta:g}")
        self.terms, self.delta = tuple(terms), delta
        self.pressure = pressure or Pressure(temperature=None, terms=["virial"])
        self.needs = self.pressure.needs if delta is not None else frozenset()

    @classmethod
    def from_lammps(cls, group, words, session):
        if not words or words[0] != "numdiff":
            if "numdiff" in words:
                raise InputError("compute born/matrix: numdiff cannot be mixed with other keywords")
            return cls(group, words)
        what, computes = "compute born/matrix numdiff", session.scene.computes
        delta, name = take(words[1:], 2, what)
        if len(words) > 3:
            raise InputError(f"{what}: unexpected word {words[3]!r}")
        if name not in computes:
            raise InputError(f"{what}: there is no compute {name}{nearest(name, computes)}")
        if not isinstance(computes[name], Pressure):
            raise InputError(f"{what}: compute {name} (style {computes[name].style}) does not compute a pressure")
        return cls(group, (), number(delta, what), computes[name])

    def to_lammps(self) -> list[str]:
        return list(self.terms) if self.delta is None else ["numdiff", repr(self.delta), self.pressure.id]

    def vector(self, state) -> np.ndarray:
        """(21,) elements of the matrix, energy units."""
        if state.engine is None:
            raise InputError("compute born/matrix needs the force field: use it in a run")
        whole = self._analytic(state) if self.delta is None else self._differences(state)
        return np.array([whole[i, j] for i, j in ELEMENTS])

    # ---- second derivatives of styles ---------------------------------------------------------------------------------------------------
    def _analytic(self, state) -> np.ndarray:
        engine, mask, chosen = state.engine, state.mask(self.group), self.terms or TERMS
        out = np.zeros((6, 6))
        if "pair" in chosen and engine.many_terms:
            raise InputError(f"compute born/matrix: pair style {engine.many_terms[0].style.name} has no second derivatives: use numdiff")
        if "pair" in chosen:
            check_pairwise(all_of(engine))
        if "pair" in chosen and engine.pair_terms:
            for d, b in _pairs(state, mask):
                add_pairs(out, d, b)
        for term in engine.terms:
            bonded_pairs = type(term) is PairListTerm and term.owner is None       # 1-4 pairs of dihedrals, ends of angles
            if bonded_pairs and ("dihedral" if term.pairs == "one_four" else "angle") in chosen:
                for atoms, d, _, b in of_list(engine, term):
                    inside = mask[atoms].all(axis=1)
                    add_pairs(out, d[inside], b[inside])
            elif isinstance(term, BondedTerm) and term.category in chosen:
                for atoms, _, v, gradient, inner in bonded_items(engine, term):
                    inside = mask[atoms].all(axis=1)
                    add_items(out, v[inside], gradient[inside], inner[inside])
            elif not isinstance(term, BondedTerm) and term.category in chosen and term.category != "pair" and not bonded_pairs:
                raise InputError(f"compute born/matrix: {term.category} style {term.style.name} has no second derivatives, use numdiff")
        return out

    # ---- differences of the virial ------------------------------------------------------------------------------------------------------
    def _differences(self, state) -> np.ndarray:
        """Derivatives of -W by a strain of one coordinate at a time, and what turns them into those by the Lagrangian strain.

        For what does not move with the atoms (kinetic part, tail, fixes) half of a shear counts along each coordinate, as in LAMMPS.
        """
        out = np.zeros((6, 6))
        moving = sum((v for name, v in state.result.virial_of.items() if name in self.pressure.terms and name != "fix"), np.zeros(6))
        still = self.pressure.vector(state) / self.pressure._per_volume(state) - moving
        for s, (k, l) in enumerate(VOIGT):
            there, back = (self._strained(state, k, l, sign * self.delta) for sign in (1.0, -1.0))
            out[s] = -(there - back)[list(ORDER)] / (2.0 * self.delta)
            for t, (m, n) in enumerate(VOIGT):
                for virial, a, b in ((_tensor(moving + 0.5 * still), k, l), (_tensor(0.5 * still), l, k)):
                    out[s, t] += (m == a) * virial[b, n] + (n == a) * virial[m, b]
        return out

    def _strained(self, state, k: int, l: int, delta: float) -> np.ndarray:
        """The virial of the interactions where coordinate k of all atoms and of the box has grown by delta times coordinate l."""
        strain = np.eye(3)
        strain[l, k] += delta
        system, box = copy.deepcopy(state.system), state.system.box
        system.x = system.x @ strain
        system.box = replace(box, cell=box.cell @ strain, origin=box.origin @ strain)
        result = Engine(system, state.engine.interactions, state.engine.settings).compute()
        return sum((v for name, v in result.virial_of.items() if name in self.pressure.terms), np.zeros(6))


def _tensor(six: np.ndarray) -> np.ndarray:
    """(3, 3) of the elements xx yy zz xy xz yz."""
    xx, yy, zz, xy, xz, yz = six
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _pairs(state, mask: np.ndarray):
    """Vectors (k, 3) of the pairs of a group and the second derivatives along them, see `asemd.curvatures.of_pairs`."""
    engine, system = state.engine, state.system
    found = half(state, max(float(t.tables.rows[t.cut_rows].max()) for t in engine.pair_terms) ** 0.5)
    found = found.take(mask[found.i] & mask[found.j])
    rules = engine.exclusions
    for term in engine.pair_terms:
        if np.ndim(term.use.factor) > 0:
            raise InputError(f"compute born/matrix: pair style {term.label} has a factor for each atom, so that there is no energy")
        p = found
        if term.molecules:
            p = p.take((rules.molecule[p.i] == rules.molecule[p.j]) == (term.molecules == "same"))
        lj, coul = term.weights(rules.weight_lj, rules.weight_coul, rules.keep)
        qq = np.zeros(len(p.i)) if system.q is None else engine.qqr2e * system.q[p.i] * system.q[p.j]
        for m, a, b in of_pairs(term.style, term.style.parts, term.tables, system.type[p.i], system.type[p.j], qq, p.r2,
                                (lj[p.kind], coul[p.kind]), whole=coul[0]):
            yield p.d[m], b - a / p.r2[m] if engine.interactions.compat == "lammps" else b


def add_pairs(out: np.ndarray, d: np.ndarray, b: np.ndarray) -> None:
    """Add what pairs with vectors (k, 3) contribute whose matrix by the vector is ``a I + b d d^T``."""
    products = np.stack([d[:, i] * d[:, j] for i, j in VOIGT])
    out += (products * b) @ products.T


def add_items(out: np.ndarray, v: np.ndarray, gradient: np.ndarray, inner: np.ndarray) -> None:
    """The vectors of a strained item are (1 + eta - eta^2 / 2) v up to a rotation."""
    moved = np.einsum("sab,mkb->mska", UNIT, v).reshape(len(v), 6, -1)
    out += np.einsum("msi,mij,mtj->st", moved, inner, moved, optimize=True)
    out -= 0.5 * np.einsum("stab,ab->st", TWICE, np.einsum("mka,mkb->ab", gradient, v))
