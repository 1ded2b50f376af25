"""From pair styles and coefficients to tables for all pairs of types; what is missing is said here."""
from __future__ import annotations

import warnings
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from asemd import coulomb_scale, coulomb_table, modifiers
from asemd.errors import InputError, InputWarning
from asemd.pairstyle import PairStyle, PairTables, missing_pairs

if TYPE_CHECKING:
    from asemd.charge_sites import ChargeSites
    from asemd.forcefield import Interactions
    from asemd.uses import Use

NO_REPULSION = "angle style {} takes the repulsion of its ends from a pair style such as lj/spica: use one, or give repulsion = 0"


@dataclass
class PairTerm:
    """A pair style ready for kernels.

    Attributes
    ----------
    style : PairStyle
        The style whose parts are computed.
    tables : PairTables
    filled : dict
        (i, j) -> complete coefficients, mixed ones included.
    molecules : str
        ``same`` or ``other``: only pairs of atoms of one molecule, or of two.
    sites : asemd.charge_sites.ChargeSites, optional
        Where charges are that are not on their atoms; `margin` is by how much atoms may be farther apart than two of them.
    """

    use: Use
    style: PairStyle
    tables: PairTables
    filled: dict[tuple[int, int], dict[str, Any]]
    label: str
    has_tail: bool
    molecules: str = ""
    sites: ChargeSites | None = None
    margin: float = 0.0

    @property
    def is_plain(self) -> bool:
        """Whether there is no factor."""
        return not isinstance(self.use.scale, str) and self.use.scale == 1.0

    def weights(self, lj: np.ndarray, coul: np.ndarray, keep: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
        """The weights of kinds of pairs, (5,) each, as they are for this style; `keep (5,)`: the kinds in the list, if not by weights."""
        if self.style.all_or_nothing:
            lj = coul = ((lj != 0.0) | (coul != 0.0) if keep is None else keep).astype(float)
        out = []
        for name, weight in (("lj", lj), ("coul", coul)):
            weight = weight.copy()
            if name in self.use.special:
                weight[1:4] = self.use.special[name]
            out.append(weight * self.use.factor if np.ndim(self.use.factor) == 0 else weight)
        return tuple(out)

    @property
    def cut_rows(self) -> list[int]:
        """Which rows of the tables are squared cutoffs: the first one of each part."""
        if not self.style.parts:
            return [0]
        lengths = [2 + len(part.rows) for part in self.style.parts]
        return [sum(lengths[:k]) for k in range(len(lengths))]

    def exclude(self, i: int, j: int) -> None:
        """Take a pair of types out."""
        self.tables.rows[self.cut_rows, i, j] = self.tables.rows[self.cut_rows, j, i] = 0.0

    def tail(self, system, units, types: range | None = None) -> tuple[float, float]:
        """Long-range correction of this term: energy, and pressure in the pressure units of the scene; zero without ``tail yes``.

        With `types` that of pairs one of whose atoms, or both, are of these.
        """
        if not self.has_tail or self.style.tail is None:
            return 0.0, 0.0
        count = np.bincount(system.type, minlength=system.counts["ntypes"] + 1)
        energy = pressure = 0.0
        for (i, j), c in self.filled.items():
            cut = self.style.cutoffs(c, self.use.settings)[0]
            pairs = float(count[i]) * float(count[j]) * (1.0 if i == j else 2.0)
            if cut > 0.0 and pairs and (types is None or i in types or j in types):
                try:
                    e, p = self.style.tail(c, cut)
                except ZeroDivisionError:
                    raise InputError(f"pair_modify tail yes: the energy of pair style {self.style.name} beyond the cutoff of types {i} {j} "
                                     "is infinite, for an exponent is 3") from None
                energy, pressure = energy + pairs * e, pressure + pairs * p
        volume = system.box.volume
        return energy / volume, pressure / volume**2 * units.nktv2p


def assignment(interactions: Interactions, ntypes: int) -> list[set[tuple[int, int]]]:
    """The pairs of types that each sub-style of a hybrid serves.

    A pair i-j without coefficients goes to the sub-style of i-i and j-j, if both have the same one and no other.

    Raises
    ------
    InputError
        A pair belongs to no sub-style.
    """
    uses, none = interactions.uses["pair"], interactions.none["pair"]
    served: list[set[tuple[int, int]]] = [set() for _ in uses]
    missing = []
    for i in range(1, ntypes + 1):
        for j in range(i, ntypes + 1):
            owners = [k for k, use in enumerate(uses) if (i, j) in use.coeff]
            if not owners and (i, j) not in none:
                a, b = ([k for k, use in enumerate(uses) if (t, t) in use.coeff] for t in (i, j))
                if i == j or len(a) != 1 or a != b:
                    missing.append((i, j))
                owners = a
            for k in owners:
                served[k].add((i, j))
    if missing:
        raise InputError(missing_pairs(missing))
    return served


def complete(interactions: Interactions, ntypes: int) -> list[tuple[Use, dict[tuple[int, int], dict[str, Any]]]]:
    """Each pair style with complete coefficients of the pairs it serves."""
    uses = interactions.uses["pair"]
    served = assignment(interactions, ntypes) if interactions.hybrid["pair"] else [None] * len(uses)
    return [(use, use.style.filled(use.coeff, use.settings, ntypes, interactions.modified(use, "mix"), only))
            for use, only in zip(uses, served, strict=True)]


def make_terms(interactions: Interactions, ntypes: int, units, idle: bool = False) -> list[PairTerm]:
    """See `asemd.forcefield.Interactions.pair_terms`; `idle` styles are those with ``pair_modify compute no``."""
    out = []
    for k, (use, filled) in enumerate(complete(interactions, ntypes)):
        if idle or interactions.modified(use, "compute"):
            shift, tail = interactions.modified(use, "shift"), interactions.modified(use, "tail")
            for style in use.style.variant(use.settings, interactions.compat).pieces():
                style = style.bind(use.settings, filled)
                molecules = ("same", "other")[k] if interactions.hybrid["pair"] == "hybrid/molecular" else style.molecules
                settings = {**use.settings, **interactions.long_range} if style.solvers or style.needs(use.settings) else use.settings
                arrays: tuple = ()
                table = coulomb_table.in_use(interactions.table, interactions.compat)
                if known := frozenset(key for key, of in coulomb_table.SPLIT.items() if table.get(key) and of & settings.keys()):
                    style = coulomb_table.tabled(style, known)
                    settings, arrays = coulomb_table.settings_of(
                        style, settings, table, interactions.coulomb_constant(units) / interactions.dielectric)
                if use.coulomb:
                    style, filled = coulomb_scale.factored(style), coulomb_scale.with_factors(filled, use.coulomb)
                tables = style.pack_pairs(settings, filled, ntypes, replace(units, qqr2e=interactions.coulomb_constant(units)), shift)
                tables = replace(tables, arrays=tables.arrays + arrays)
                out.append(PairTerm(use, style, tables, filled, use.label, tail, molecules))
                if style.on_sites:
                    out[-1].sites, out[-1].margin = style.sites(use.settings, interactions), 2.0 * use.settings["qdist"]
    return out


def reach(interactions: Interactions, ntypes: int) -> float:
    """The largest distance at which a pair style wants to know about pairs."""
    return max((use.style.reach(c, use.settings) for use, filled in complete(interactions, ntypes) for c in filled.values()), default=0.0)


def check_complete(interactions: Interactions, system) -> None:
    """Whether a run can start: every type in use has coefficients, and the styles get what they need.

    Warns (`asemd.errors.InputWarning`) where ``pair_modify tail yes`` has no effect.

    Raises
    ------
    InputError
        Coefficients are missing, a sub-style of a hybrid is not used, atoms have no charges, the dihedral style wants 1-4 coefficients that
        the pair style does not have, shift and tail are both on, tail in two dimensions.
    """
    for category, uses in interactions.uses.items():
        if category != "pair" and uses:
            known = interactions.none[category].union(*(use.coeff for use in uses))
            missing = sorted({abs(int(t)) for t in np.unique(system.topology.items(category)[1])} - known - {0})
            if missing:
                raise InputError(f"All {category} coeffs are not set: {category}_coeff for {category} type "
                                 f"{', '.join(map(str, missing))} is missing")
            for use in uses:
                for t, coeff in use.coeff.items():
                    if marks := use.style.missing(coeff):
                        raise InputError(f"All {category} coeffs are not set: {category}_coeff {t} of {category} style {use.style.name} "
                                         f"lacks {' and '.join(marks)}")
        if interactions.hybrid[category]:
            for use in uses:
                if not use.coeff:
                    raise InputError(f"{category}_style {interactions.hybrid[category]}: sub-style {use.label} is not used by any "
                                     f"{category}_coeff: leave it out")
        for use in uses:
            use.style.check_scene(interactions, system)
    interactions.learn(system)
    complete(interactions, system.counts["ntypes"])
    modifiers.check_special(interactions)
    if interactions.hybrid["pair"] == "hybrid/molecular" and not system.molecular:
        raise InputError("pair_style hybrid/molecular needs an atom_style with molecule numbers, such as full")
    for use in interactions.uses["pair"]:
        if use.style.variant(use.settings).charged and system.q is None:
            raise InputError(f"pair style {use.style.name} needs atom attribute q: use atom_style charge or full")
        if use.style.charged and not use.style.dielectric and "epsilon" in system.extra:
            raise InputError(f"pair style {use.style.name} knows nothing of the dielectric constants that atoms of style "
                             f"{system.atom_style} have: use one for them, such as coul/cut/dielectric")
        if interactions.modified(use, "tail"):
            if interactions.modified(use, "shift"):
                raise InputError("pair_modify shift and tail cannot both be yes")
            if system.dimension == 2:
                raise InputError("pair_modify tail yes cannot be used in two dimensions")
            if use.style.tail is None and use.style.parts:
                warnings.warn(f"pair_modify tail yes has no effect on pair style {use.style.name}", InputWarning, stacklevel=2)
    for use in interactions.uses["angle"]:
        switch = getattr(use.style, "repulsion", "")
        if switch and any(c[switch] for c in use.coeff.values()):
            if not any(hasattr(u.style, "repulsion") for u in interactions.uses["pair"]):
                raise InputError(NO_REPULSION.format(use.style.name))
