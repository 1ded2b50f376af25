r"""Derivative of the energy by a coupling parameter, for thermodynamic integration.

.. math:: \frac{dU}{d\lambda} = \sum \frac{U_s}{f(\lambda)} \frac{df}{d\lambda}

summed over terms: pair styles whose energy :math:`U_s` is scaled by :math:`f(\lambda)` (as with fix adapt), the long-range solver, and the
tail correction. Of pair styles and solver count the shares of the atoms of some types, of the tail correction all pairs with an atom of
these types. A term whose f is zero counts as zero.

LAMMPS has the same tail correction for types up to the last one (``tail 2*``) if all pairs of types have a pair_coeff of their own; for
others it adds what was left over from another pair of types.

Source: LAMMPS manual, compute ti; Eike and Maginn, J. Chem. Phys. 124, 164503 (2006). Units: energy.
"""
from __future__ import annotations

from asemd.compute import Compute
from asemd.compute._pairs import force_cutoff, half, interactions
from asemd.errors import InputError, nearest
from asemd.registry import plain_name
from asemd.words import bounds, take


class TI(Compute):
    """Derivative by a coupling parameter.

    Parameters
    ----------
    group : str
        Makes no difference.
    terms : sequence of (name, types, f, slope)
        Pair style, ``tail`` or ``kspace``, type or range, names of equal-style variables (``v_name``).
    variables : asemd.variable.Variables
        Where they are.

    Raises
    ------
    InputError
        No terms; variables that are missing or of another style; a pair style that is not in use (when it is evaluated).
    """

    style = "ti"
    extensive = True
    needs = frozenset({"energy"})

    def __init__(self, group: str = "all", terms=(), variables=None):
        super().__init__(group)
        if not terms:
            raise InputError("compute ti needs at least one term: pair style, types, v_name1, v_name2")
        if any(name == "kspace" for name, *_ in terms):
            self.needs = self.needs | {"energies"}
        self.terms, self.variables = [(plain_name(name), str(types), f, slope) for name, types, f, slope in terms], variables
        for *_, f, slope in self.terms:
            for word in (f, slope):
                if not word.startswith("v_"):
                    raise InputError(f"compute ti: expected a variable v_name, got {word!r}")
                later = variables is not None and word[2:] not in variables.table      # it may come before the run
                if not later and (variables is None or variables.find(word[2:]).style != "equal"):
                    raise InputError(f"compute ti: variable {word[2:]} must have the style equal")

    def __getstate__(self):
        return {**self.__dict__, "variables": None}

    @classmethod
    def from_lammps(cls, group, words, session):
        if len(words) % 4:
            raise InputError(f"compute ti: each term needs 4 words (pair style, types, v_name1, v_name2), got {' '.join(words)}")
        terms = [take(words[k:], 4, "compute ti") for k in range(0, len(words), 4)]
        out = cls(group, terms, session.variables)
        for name, types, *_ in out.terms:
            if name not in ("tail", "kspace"):
                _chosen(session.scene.interactions, name)
            _types(session.scene.need_system("compute ti"), types)
        return out

    def to_lammps(self) -> list[str]:
        return [word for term in self.terms for word in term]

    def setup(self, state) -> None:
        """Refuse a long-range part that is not there."""
        if any(name == "kspace" for name, *_ in self.terms) and (state.engine is None or state.engine.solver is None):
            raise InputError("compute ti kspace needs a kspace_style")

    def scalar(self, state) -> float:
        """dU/dlambda."""
        if self.variables is None:
            raise InputError(f"compute {self.id or 'ti'}: its variables need a session")
        total, pairs = 0.0, None
        for name, types, f, slope in self.terms:
            scale, change = self.variables.number(f[2:]), self.variables.number(slope[2:])
            if scale == 0.0:
                continue
            low, high = _types(state.system, types)
            if name == "tail":
                energy = state.engine.interactions.tail_correction(state.system, state.units, range(low, high + 1))[0]
            elif name == "kspace":
                inside = (low <= state.system.type) & (state.system.type <= high)
                energy = state.result.energy["elong"] if inside.all() else float(state.result.energies_of["kspace"][inside].sum())
            else:
                if pairs is None:
                    pairs = half(state, force_cutoff(state, "compute ti"))
                uses = _chosen(state.engine.interactions, name)
                values, _ = interactions(state, pairs, only=lambda term, uses=uses: any(term.use is use for use in uses))
                inside = (low <= state.system.type) & (state.system.type <= high)
                energy = float((0.5 * values * (inside[pairs.i].astype(float) + inside[pairs.j])).sum())
            total += energy / scale * change
        return total


def _types(system, word: str) -> tuple[int, int]:
    return bounds(word, 1, system.counts["ntypes"], "compute ti: type", system.labels.get("atom"))


def _chosen(interactions, name: str) -> list:
    """The pair styles of that name; all of them for that of the hybrid."""
    uses = interactions.uses["pair"]
    mine = [use for use in uses if use.style.name == name or name == interactions.style_name("pair")]
    if not mine:
        raise InputError(f"compute ti: pair style {name} is not in use{nearest(name, [use.style.name for use in uses])}")
    return mine
