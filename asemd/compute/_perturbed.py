"""What the computes of free energy perturbation share: their output, and pair styles with other coefficients."""
from __future__ import annotations

import copy
import math
from dataclasses import replace

import numpy as np

from asemd.compute import Compute
from asemd.compute._pairs import all_of, check_pairwise
from asemd.errors import InputError, nearest
from asemd.words import bounds


class Perturbed(Compute):
    """Base class: (3,) energy of the perturbed system less that of the present one, Boltzmann factor, and a third number."""

    extensive = False
    size = 3
    temperature: float
    tail: bool

    def setup(self, state) -> None:
        """Refuse a tail correction that the pair style does not have."""
        if self.tail and not (state.engine and state.engine.interactions.tail):
            raise InputError(f"compute {self.style} tail yes: the pair style has no tail correction, use pair_modify tail yes")

    def boltzmann(self, state, energy: float) -> float:
        """The Boltzmann factor of an energy, infinite where it is too large for a number."""
        exponent = -energy / (state.units.boltz * self.temperature) if self.temperature else math.copysign(math.inf, -energy)
        return math.exp(exponent) if exponent < 709.0 else math.inf


def uses_of(interactions, category: str, style: str, name: str, what: str, cutoffs: bool = True) -> list:
    """The uses of a style, which must have a coefficient of that name that can change; cutoffs only where lists can.

    ``lj/cut:2`` is the second one of that name of a hybrid pair style.

    Raises
    ------
    InputError
        The style is not in use, or has no such coefficient.
    """
    uses = [u for u in interactions.uses[category] if style in (u.label, u.style.name)]
    plain, _, number = style.partition(":")
    if category == "pair" and number.isdigit():
        uses = [u for u in interactions.uses[category] if u.style.name == plain]
        uses = uses if len(uses) == 1 else [u for u in uses if u.label == f"{plain} {number}"]
    if not uses:
        known = [u.label for u in interactions.uses[category]]
        raise InputError(f"{what}: there is no {category} style {style!r} in use{nearest(style, known)}")
    known = [p.name for p in uses[0].style.coeff if p.unit not in ("word", "path", "integer") and (cutoffs or not p.name.startswith("cut"))]
    known += [*getattr(uses[0].style, "coefficients", ()), *["scale"] * getattr(uses[0].style, "scales", False)]
    if spelled(uses[0].style, name) not in known:
        raise InputError(f"{what}: {category} style {style} has no coefficient {name!r} that can change, it has "
                         f"{' '.join(known) or 'none'}")
    return uses


def spelled(style, name: str) -> str:
    """A coefficient's name as the style writes it, for one that may differ in the case of letters (LAMMPS: ``a`` for A)."""
    known = [p.name for p in style.coeff]
    return name if name in known else next((n for n in known if n.lower() == name.lower()), name)


def held(use, pair, name: str) -> tuple[dict, object, float] | None:
    """Where a coefficient of a pair of types stands: a mapping, the key there, and the value; None if the pair does not have it."""
    if name == "scale" and getattr(use.style, "scales", False):
        return use.coulomb, pair, use.coulomb.get(pair, 1.0)
    coeff = use.coeff.get(pair)
    if coeff is not None and name not in coeff and name.startswith("cut") and name in use.settings:
        return coeff, name, use.settings[name]
    return (coeff, name, coeff[name]) if name in (coeff or ()) else None


def perturbed_terms(state, changes, what: str) -> list:
    """Pair styles ready for kernels with numbers added to coefficients.

    Parameters
    ----------
    state : asemd.result.Snapshot
    changes : sequence of (style, coefficient, i, j, delta)
        Of pairs of types or ranges of them; coefficients that are mixed follow those they are mixed from.
    """
    system, old, n = state.system, state.engine.interactions, state.system.counts["ntypes"]
    new = copy.copy(old)
    new.uses = {**old.uses, "pair": [replace(use, coeff={key: dict(c) for key, c in use.coeff.items()}, coulomb=dict(use.coulomb))
                                      for use in old.uses["pair"]]}
    for use, before in zip(new.uses["pair"], old.uses["pair"], strict=True):
        use.factor = before.factor
    for style, name, i, j, delta in changes:
        (ilo, ihi), (jlo, jhi) = (bounds(t, 1, n, what, system.labels["atom"]) for t in (i, j))
        for use in uses_of(new, "pair", style, name, what, cutoffs=False):
            first, name = next(o for u, o in zip(new.uses["pair"], old.uses["pair"]) if u is use), spelled(use.style, name)
            for pair in [(a, b) for a in range(ilo, ihi + 1) for b in range(max(a, jlo), jhi + 1)]:
                if place := held(use, pair, name):
                    place[0][place[1]] = held(first, pair, name)[2] + delta
    check_pairwise(all_of(state.engine))
    terms = [t for t in new.pair_terms(n, state.units) if t.style.parts]
    for kind, *pair in state.engine.settings.exclude:
        if kind == "type":
            for t in terms:
                t.exclude(*pair)
    return terms


def touched(old: list, new: list) -> np.ndarray:
    """(ntypes+1, ntypes+1) whether a pair of types has other coefficients in the terms `new` than in `old`."""
    out = np.zeros(old[0].tables.rows.shape[1:], bool) if old else np.zeros((1, 1), bool)
    for a, b in zip(old, new, strict=True):
        same = a.style is b.style and a.tables.rows.shape == b.tables.rows.shape and not len(a.tables.arrays)
        out |= (a.tables.rows != b.tables.rows).any(axis=0) if same and np.array_equal(a.tables.constants, b.tables.constants) else True
    return out


def tail_energy(state, terms: list) -> float:
    """The tail correction of the energy."""
    return float(sum(term.tail(state.system, state.units)[0] for term in terms))
