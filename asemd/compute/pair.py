"""Energy of one pair style, such as a sub-style of a hybrid: all of it, or its van der Waals or Coulomb part.

Pair style gauss also gives a vector of one number: how many pairs are closer than 1/sqrt(2 B), where the force is largest (occupied sites);
hbond/dreiding/lj and morse one of two numbers: hydrogen bonds, and their energy; rebo and airebo one of three: energies of bonds,
dispersion and torsion.

Source: LAMMPS manual, compute pair. Units: energy.
"""
from __future__ import annotations

import numpy as np

from asemd.atom_shares import Room
from asemd.compute import Compute
from asemd.compute._pairs import half
from asemd.errors import InputError, nearest
from asemd.kernels.hooks import bound
from asemd.registry import find, plain_name
from asemd.term import FactorTerm
from asemd.words import choice, take, whole

PARTS = {"epair": ("evdwl", "ecoul"), "evdwl": ("evdwl",), "ecoul": ("ecoul",)}


class Pair(Compute):
    """Energy of a pair style.

    Parameters
    ----------
    group : str
        Makes no difference: all pairs count.
    name : str
        A pair style in use.
    number : int, optional
        Which one, from 1, if a hybrid has it several times.
    part : str
        epair, evdwl or ecoul.

    Raises
    ------
    InputError
        Another part; (when it is evaluated) the style is not in use, or several times.
    """

    style = "pair"
    extensive = True
    needs = frozenset({"energy"})

    def __init__(self, group: str = "all", name: str = "", number: int | None = None, part: str = "epair"):
        super().__init__(group)
        self.name, self.number, self.part = plain_name(name), number, choice(part, PARTS, "compute pair")

    @classmethod
    def from_lammps(cls, group, words, session):
        name, rest, number, part = take(words, 1, "compute pair")[0], list(words[1:]), None, "epair"
        if rest and rest[0].lstrip("-").isdigit():
            number = whole(rest.pop(0), "compute pair: number of the sub-style")
        if rest:
            part = rest.pop(0)
        if rest:
            raise InputError(f"compute pair: unexpected word {rest[0]!r}")
        out = cls(group, name, number, part)
        out.chosen(session.scene.interactions)
        return out

    def to_lammps(self) -> list[str]:
        return [self.name, *([str(self.number)] if self.number else []), self.part]

    def chosen(self, interactions):
        """The `asemd.uses.Use`, or None for everything."""
        uses = interactions.uses["pair"]
        if self.name == interactions.style_name("pair") and uses:
            return None
        mine = [use for use in uses if use.style.name == self.name]
        if not mine:
            raise InputError(f"compute pair: pair style {self.name} is not in use{nearest(self.name, [u.style.name for u in uses])}")
        if self.number is None and len(mine) > 1 or self.number is not None and not 1 <= self.number <= len(mine):
            raise InputError(f"compute pair: pair style {self.name} is in use {len(mine)} times: say which one, from 1 to {len(mine)}")
        return mine[(self.number or 1) - 1]

    @property
    def size(self) -> int:
        """Elements of the vector, 0 for none."""
        if self.name == "gauss" or self.name.startswith("hybrid") or not self.name:
            return int(self.name == "gauss")
        return find("pair", self.name).extra

    def vector(self, state) -> np.ndarray:
        """Of gauss how many pairs are within the width of their well; of other styles what their terms say."""
        if not self.size:
            return super().vector(state)
        use, n = self.chosen(state.engine.interactions), state.system.counts["ntypes"]
        if self.name != "gauss":
            return sum(t.extra() for t in state.engine.terms if hasattr(t, "extra") and use in (None, t.owner.use))
        within = np.zeros((n + 1, n + 1))
        for term in state.engine.pair_terms:
            if term.style.name == "gauss" and use in (None, term.use):
                for (i, j), c in term.filled.items():
                    within[i, j] = within[j, i] = min(0.5 / c["b"], c["cut"] ** 2) if c["b"] > 0.0 else c["cut"] ** 2
        pairs = half(state, float(within.max()) ** 0.5)
        kind = state.system.type
        return np.array([float((pairs.r2 < within[kind[pairs.i], kind[pairs.j]]).sum())])

    def scalar(self, state) -> float:
        """The energy, without the tail correction and the factors of ``hybrid/scaled``."""
        engine = state.engine
        use = self.chosen(engine.interactions)
        if use is None:
            return float(sum(state.result.energy[key] for key in PARTS[self.part]))
        columns = [("evdwl", "ecoul").index(key) for key in PARTS[self.part]]
        mine = [t for t in engine.terms if getattr(getattr(t, "owner", None), "use", None) is use]
        return float(sum(_own_sums(engine, t)[columns].sum() for t in mine))


def _own_sums(engine, term) -> np.ndarray:
    """(8,) the energies of a term of the last evaluation, without its factor."""
    factor, sums = term.owner.use.factor, engine.acc[:, term.index].sum(axis=0)
    if term.owner.is_plain or np.ndim(factor) > 0:
        return sums
    if isinstance(term, FactorTerm):
        return term.own_acc.sum(axis=0)
    return sums / factor if factor != 0.0 else _without_factor(engine, term)


def _without_factor(engine, term) -> np.ndarray:
    """Energies of a term whose factor is 0: once more with another one, into arrays that nobody reads."""
    use, kept = term.owner.use, (engine.buffers, engine.acc, engine.atom_energy, engine.atom_virial)
    engine.buffers, engine.acc, engine.atom_energy, engine.atom_virial = Room(engine).columns(engine)
    use.factor = 1.0
    try:
        term.scale(engine)
        kernel = term.kernel(True, False)
        for tid in range(engine.threads):
            bound(kernel, term.arguments(engine, tid), 1)()
        return engine.acc[:, term.index].sum(axis=0)
    finally:
        engine.buffers, engine.acc, engine.atom_energy, engine.atom_virial = kept
        use.factor = 0.0
        term.scale(engine)
