"""The attraction -C6 / r^6 as a sum of products of numbers that each type of atoms has, for solvers that go beyond the cutoff."""
from __future__ import annotations

import math
import warnings

import numpy as np

from asemd.errors import InputError, InputWarning
from asemd.pairing import complete

DROPPED = 1e-4      # eigenvalues, as parts of the largest, whose loss is told


class Dispersion:
    """C6 of types i and j as the sum over m of ``signs[m] * factors[i, m] * factors[j, m]``.

    Parameters
    ----------
    rule : str
        ``geometric`` takes one number, the root of C6 of i-i; ``arithmetic`` mixes epsilon and sigma of i-i and j-j; ``none`` takes C6
        of all pairs of types as they are, less what `tolerance` drops.
    filled : mapping
        (i, j) -> complete coefficients of the pairs that have the attraction.
    derived : callable
        ``derived(coefficients, settings)["C6"]``.
    tolerance : float
        Eigenvalues of the matrix of C6 that are smaller than this part of the largest are left out. If one is left, mixing is geometric; if
        more are, arithmetic mixing takes them all nevertheless, as in LAMMPS.

    Attributes
    ----------
    factors (ntypes + 1, n), signs (n,), own (ntypes + 1,)
        `own`: C6 of a type with itself.
    """

    def __init__(self, rule: str, filled, derived, settings, ntypes: int, tolerance: float = 1e-15):
        self.rule, c6 = rule, np.zeros((ntypes + 1, ntypes + 1))
        for i, j in filled:
            a, b = filled.get((i, i)), filled.get((j, j))
            if rule == "none" or not a or not b:
                value = derived(filled[i, j], settings)["C6"]
            elif rule == "geometric":
                value = math.sqrt(abs(derived(a, settings)["C6"])) * math.sqrt(abs(derived(b, settings)["C6"]))
            elif "sigma" in a:
                mixed = {"epsilon": math.sqrt(a["epsilon"] * b["epsilon"]), "sigma": 0.5 * (a["sigma"] + b["sigma"])}
                value = derived(mixed, settings)["C6"]
            else:
                raise InputError("arithmetic mixing of dispersion needs a pair style with epsilon and sigma: use mix geometric")
            c6[i, j] = c6[j, i] = value
        self.own = np.diag(c6).copy()
        values, vectors = np.linalg.eigh(c6)
        part = abs(values) / (abs(values).max(initial=0.0) or 1.0)
        large = part > tolerance
        if rule == "geometric" or large.sum() == 1:
            self.factors, self.signs = np.sqrt(self.own)[:, None], np.ones(1)
        else:
            kept = large if rule == "none" else part > 1e-15
            self.factors, self.signs = np.ascontiguousarray(vectors[:, kept] * np.sqrt(abs(values[kept]))), np.sign(values[kept])
            self.own = self.factors**2 @ self.signs
        if rule != "geometric" and part[~large].max(initial=0.0) > DROPPED:
            warnings.warn(f"Estimated error in splitting of dispersion coeffs is {part[~large].max():.8g}", InputWarning, stacklevel=2)

    def sums(self, types) -> tuple[float, float, np.ndarray]:
        """Sum of C6 over all pairs of atoms, ordered and with themselves; over atoms with themselves; of each factor over atoms."""
        total = self.factors[types].sum(axis=0)
        return float(self.signs @ (total * total)), float(self.own[types].sum()), total


    def all_sums(self, types) -> np.ndarray:
        """The same as one array."""
        everyone, own, each = self.sums(types)
        return np.concatenate([[everyone, own], each])


def dispersion_of(uses, interactions, system, style: str, mix: str = "pair", tolerance: float = 0.0) -> tuple[Dispersion | None, list]:
    """The dispersion that pair styles leave to a solver, and its parts (`Use`, part); None if there is none; `mix` and `tolerance`
    as in ``kspace_modify mix/disp`` and ``splittol``.

    Raises
    ------
    InputError
        More than one pair style has it.
    """
    parts = [(use, part) for use in uses for part in use.style.variant(use.settings).parts if part.long and not part.charged]
    if not parts:
        return None, []
    if len(parts) > 1:
        raise InputError(f"kspace_style {style}: only one pair style can have a long-range dispersion")
    use = parts[0][0]
    rule = {"pair": interactions.modified(use, "mix") or use.style.mix_rule, "geom": "geometric"}.get(mix, mix)
    if rule == "sixthpower":      # its energies and distances have the geometric mean of C6
        rule = "geometric"
    filled = next(filled for other, filled in complete(interactions, system.counts["ntypes"]) if other is use)
    return Dispersion(rule, filled, use.style.derived, use.settings, system.counts["ntypes"], tolerance), parts
