r"""Change coefficients and properties of atoms during a run, as fix adapt does; charges and diameters go by atom type.

For free energies: with ``after yes`` values change in the step after each multiple of N, so that averages over N steps belong to one value.

Source: LAMMPS manual, fix adapt/fep. Arguments: N, then ``pair style coefficient I J v_name``, ``kspace v_name``, ``atom charge|diameter I
v_name``; reset, scale, after.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.fix.adapt import Adapt
from asemd.words import bounds, choice, take, whole, yes_no

ARRAYS = {"charge": lambda system: system.q, "diameter": lambda system: 2.0 * system.extra["radius"]}

LENGTHS = {"pair": 5, "kspace": 1, "atom": 3, "scale": 1, "reset": 1, "after": 1}


class ByType(list):
    """Values of all atoms from (first type, last type, function of the loop)."""

    def __init__(self, name: str, scale: bool, parts):
        super().__init__(parts)
        self.name, self.scale = name, scale

    def __call__(self, loop) -> np.ndarray:
        """(n,) values; of other types the present ones, or factors of 1."""
        kinds = loop.system.type
        out = np.ones(loop.system.n) if self.scale else np.array(ARRAYS[self.name](loop.system), float)
        for first, last, value in self:
            out = np.where((kinds >= first) & (kinds <= last), value(loop), out)
        return out


class AdaptFep(Adapt):
    """Fix adapt with properties by atom type.

    Parameters
    ----------
    group : str
        The atoms whose charges or diameters change.
    every : int
        Steps between two changes; 0: only at the start of a run.
    pair, charge, diameter, kspace, scale, reset
        As of `asemd.fix.Adapt`.
    after : bool
        Change in the step after each multiple of `every`.

    Raises
    ------
    InputError
        As of `asemd.fix.Adapt`.
    """

    style = "adapt/fep"

    def __init__(self, group: str = "all", every: int = 1, pair=(), charge=None, diameter=None, kspace=None, scale: bool = False,
                 reset: bool = False, after: bool = False):
        super().__init__(group, every, pair=pair, charge=charge, diameter=diameter, kspace=kspace, scale=scale, reset=reset)
        self.after = after and every > 1

    @classmethod
    def from_lammps(cls, group, words, session):
        what, system = "fix adapt/fep", session.scene.need_system("fix adapt/fep")
        given, rest, by_type = {"every": whole(take(words, 1, what)[0], f"{what} N")}, list(words[1:]), {}
        while rest:
            keyword = choice(rest[0], LENGTHS, f"{what} keyword")
            values = take(rest[1:], LENGTHS[keyword], f"{what} {keyword}")
            rest = rest[1 + len(values):]
            if keyword == "pair":
                for word in values[2:4]:
                    bounds(word, 1, system.counts["ntypes"], f"{what} pair", system.labels["atom"])
                given.setdefault("pair", []).append((*values[:4], cls._variable(values[4], session)))
            elif keyword == "kspace":
                given["kspace"] = cls._variable(values[0], session)
            elif keyword == "atom":
                name, kinds, value = values
                if (system.q if choice(name, ARRAYS, f"{what} atom") == "charge" else system.extra.get("radius")) is None:
                    raise InputError(f"{what} atom {name}: atom_style {system.atom_style} has no {name}")
                kinds = bounds(kinds, 1, system.counts["ntypes"], f"{what} atom", system.labels["atom"])
                by_type.setdefault(name, []).append((*kinds, cls._variable(value, session)))
            else:
                given[keyword] = yes_no(values[0], f"{what} {keyword}")
        fix = cls(group, **given, **{name: ByType(name, given.get("scale", False), parts) for name, parts in by_type.items()})
        fix.words = list(words)
        fix._check(session.scene.interactions)
        return fix

    def next_step(self, step: int) -> int:
        return 1 + max(super().next_step(step - 1), self.adapt_every) if self.after else super().next_step(step)
