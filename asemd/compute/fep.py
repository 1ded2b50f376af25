r"""Energy of the system with other coefficients or charges, for free energy perturbation.

.. math:: \Delta F = -k_B T \ln \frac{\langle V e^{-\Delta U / k_B T} \rangle}{\langle V \rangle}, \qquad
   \Delta U = U(\lambda + \delta) - U(\lambda)

of the energies of pairs, and where charges change of the long-range solver. Words: the temperature T; ``pair STYLE COEFFICIENT I J
v_name`` and ``atom charge TYPE v_name`` (of atoms of the group) add the value of a variable; ``tail yes``: with the tail correction;
``volume yes``: the Boltzmann factor is multiplied by V.

Source: LAMMPS manual, compute fep; Zwanzig, J. Chem. Phys. 22, 1420 (1954). Output: a vector of 3: :math:`\Delta U` (energy),
:math:`e^{-\Delta U/k_B T}` (or times V), V.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._pairs import force_cutoff, half, interactions
from asemd.compute._perturbed import Perturbed, perturbed_terms, tail_energy, touched, uses_of
from asemd.errors import InputError, nearest
from asemd.kspace.term import KSpaceTerm
from asemd.own_term import own_terms
from asemd.words import bounds, number, take, yes_no

OPTIONS = ("tail", "volume")


class FEP(Perturbed):
    """Perturbation of coefficients and charges.

    Parameters
    ----------
    group : str
        The atoms whose charges are perturbed; perturbed coefficients count for all.
    temperature : float
        Of the Boltzmann factor, temperature units.
    pair : sequence of (style, coefficient, i, j, delta)
        `i` and `j`: types or ranges such as ``"*"``; `delta`: a number, or the name of an equal-style variable (``v_name``).
    charge : sequence of (type, delta)
    tail, volume : bool
        With the tail correction; the Boltzmann factor times the volume.
    variables : asemd.variable.Variables, optional
        Where the variables are.

    Raises
    ------
    InputError
        Nothing to perturb; variables that are missing or of another style.
    """

    style = "fep"

    def __init__(self, group: str = "all", temperature: float = 1.0, pair=(), charge=(), tail: bool = False, volume: bool = False,
                 variables=None):
        super().__init__(group)
        self.temperature, self.tail, self.volume, self.variables = float(temperature), tail, volume, variables
        self.pair = [(style, name, str(i), str(j), delta) for style, name, i, j, delta in pair]
        self.charge = [(str(t), delta) for t, delta in charge]
        if not self.pair and not self.charge:
            raise InputError("compute fep needs at least one of pair, atom")
        for *_, delta in [*self.pair, *self.charge]:
            later = isinstance(delta, str) and variables is not None and delta[2:] not in variables.table      # it may come before the run
            if isinstance(delta, str) and not later and (variables is None or variables.find(delta[2:]).style != "equal"):
                raise InputError(f"compute fep: variable {delta[2:]} must have the style equal")

    def __getstate__(self):
        return {**self.__dict__, "variables": None}

    @classmethod
    def from_lammps(cls, group, words, session):
        what, scene = "compute fep", session.scene
        temperature, rest, pair, charge = number(take(words, 1, what)[0], f"{what} temperature"), list(words[1:]), [], []
        system = scene.need_system(what)
        while rest and rest[0] not in OPTIONS:
            key, *rest = rest
            if key == "pair":
                style, name, i, j, delta = take(rest, 5, f"{what} pair")
                uses_of(scene.interactions, "pair", style, name, f"{what} pair", cutoffs=False)
                for t in (i, j):
                    bounds(t, 1, system.counts["ntypes"], f"{what} pair: type", system.labels["atom"])
                pair.append((style, name, i, j, _variable(delta)))
                rest = rest[5:]
            elif key == "atom":
                name, t, delta = take(rest, 3, f"{what} atom")
                if name != "charge":
                    raise InputError(f"{what} atom: {name!r} is unknown, it must be charge")
                if system.q is None:
                    raise InputError(f"{what} atom charge: atom_style {system.atom_style} has no charges")
                bounds(t, 1, system.counts["ntypes"], f"{what} atom: type", system.labels["atom"])
                charge.append((t, _variable(delta)))
                rest = rest[3:]
            else:
                raise InputError(f"{what}: unknown keyword {key!r}{nearest(key, ('pair', 'atom', *OPTIONS))}")
        given = {}
        while rest:
            if rest[0] not in OPTIONS:
                raise InputError(f"{what}: unknown keyword {rest[0]!r}{nearest(rest[0], OPTIONS)}")
            given[rest[0]] = yes_no(take(rest[1:], 1, f"{what} {rest[0]}")[0], f"{what} {rest[0]}")
            rest = rest[2:]
        return cls(group, temperature, pair, charge, variables=session.variables, **given)

    def to_lammps(self) -> list[str]:
        if not all(isinstance(change[-1], str) for change in (*self.pair, *self.charge)):
            raise InputError("compute fep: numbers cannot be written as a script, which wants variables")
        words = [word for change in self.pair for word in ("pair", *change)]
        words += [word for change in self.charge for word in ("atom", "charge", *change)]
        return [repr(self.temperature), *words, "tail", "yes" if self.tail else "no", "volume", "yes" if self.volume else "no"]

    def _number(self, delta) -> float:
        if not isinstance(delta, str):
            return float(delta)
        if self.variables is None:
            raise InputError(f"compute {self.id or 'fep'}: its variables need a session")
        return self.variables.number(delta[2:])

    def vector(self, state) -> np.ndarray:
        """(3,) energy difference, Boltzmann factor, volume."""
        system, energy, q = state.system, 0.0, None
        reach = force_cutoff(state, "compute fep")
        old = state.engine.pair_terms
        new = perturbed_terms(state, [(*change, self._number(delta)) for *change, delta in self.pair], "compute fep pair")
        if self.charge:
            q, mask = system.q.copy(), state.mask(self.group)
            for t, delta in self.charge:
                low, high = bounds(t, 1, system.counts["ntypes"], "compute fep atom: type", system.labels["atom"])
                q[mask & (low <= system.type) & (system.type <= high)] += self._number(delta)
        reach = max([reach, *(float(t.tables.rows[t.cut_rows].max()) ** 0.5 for t in new)])
        pairs, types = half(state, reach), touched(old, new)
        keep = types[system.type[pairs.i], system.type[pairs.j]]
        if q is not None:
            moved = q != system.q
            keep |= moved[pairs.i] | moved[pairs.j]
        pairs = pairs.take(keep)
        if len(pairs.i):
            energy = float((interactions(state, pairs, terms=new, charges=q)[0] - interactions(state, pairs)[0]).sum())
        if q is not None:
            energy += _of_charges(state, new, q) - _of_charges(state, old, system.q)
        if self.tail:
            energy += tail_energy(state, new) - tail_energy(state, old)
        volume = float(system.box.volume)
        return np.array([energy, self.boltzmann(state, energy) * (volume if self.volume else 1.0), volume])


def _of_charges(state, terms, q: np.ndarray) -> float:
    """What charges have besides the energies of pairs: by themselves, and by a long-range solver."""
    engine = state.engine
    alone = [t.of_charges(engine, q) for t in own_terms(terms, state.system.counts["ntypes"], engine.qqr2e)]
    return sum(alone) + sum(t.of_charges(engine, q, state.system.x)[0] for t in engine.terms if isinstance(t, KSpaceTerm))


def _variable(word: str) -> str:
    if not word.startswith("v_"):
        raise InputError(f"compute fep: the perturbation must be a variable v_name, got {word!r}")
    return word
