"""Distances, energies and forces of pairs within the cutoff of the pair style, as local values.

Rows are those of compute property/local with patom1 patom2; dx dy dz point from the second atom to the first, fx fy fz is the force on the
first. Partners that ``special_bonds`` takes out of the neighbour list are not among them.

Source: LAMMPS manual, compute pair/local. Units: distance, energy, force.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._neighbors import neighbors
from asemd.compute._pairs import interactions
from asemd.errors import InputError, nearest
from asemd.words import choice, take

KEYWORDS = ("dist", "dx", "dy", "dz", "eng", "force", "fx", "fy", "fz")


class PairLocal(Compute):
    """Local values of pairs.

    Parameters
    ----------
    group : str
        Pairs count whose atoms are both in it.
    keywords : sequence of str
        Some of dist, dx, dy, dz, eng, force, fx, fy, fz.
    cutoff : str
        ``type``: of the pair style; ``radius``: the sum of the radii.

    Raises
    ------
    InputError
        No or unknown keywords; radii that atoms do not have; forces that do not belong to an energy.
    """

    style = "pair/local"

    def __init__(self, group: str = "all", keywords=("dist",), cutoff: str = "type"):
        super().__init__(group)
        if not keywords:
            raise InputError(f"compute pair/local needs at least one of {' '.join(KEYWORDS)}")
        for word in keywords:
            if word[:1] == "p" and word[1:].isdigit():
                raise InputError(f"compute pair/local: no pair style has an extra quantity {word}")
            if word not in KEYWORDS:
                raise InputError(f"compute pair/local: unknown keyword {word!r}{nearest(word, KEYWORDS)}")
        self.keywords, self.cutoff = list(keywords), choice(cutoff, ("type", "radius"), "compute pair/local cutoff")

    @classmethod
    def from_lammps(cls, group, words, session):
        words, cutoff, scene = list(words), "type", session.scene
        if "cutoff" in words:
            k = words.index("cutoff")
            cutoff = take(words[k + 1:], 1, "compute pair/local cutoff")[0]
            del words[k:k + 2]
        out = cls(group, words, cutoff)
        if cutoff == "radius" and "radius" not in scene.need_system("compute pair/local").extra:
            raise InputError(f"compute pair/local: cutoff radius needs atoms with a radius, not atom_style {scene.atom_style}")
        return out

    def to_lammps(self) -> list[str]:
        return [*self.keywords, *(["cutoff", "radius"] if self.cutoff == "radius" else [])]

    def local_columns(self):
        return len(self.keywords) if len(self.keywords) > 1 else 0

    def local(self, state) -> np.ndarray:
        """(m,) for one keyword, (m, k) for several."""
        if state.engine is None or not state.engine.interactions.uses["pair"]:
            raise InputError("compute pair/local needs a pair style")
        p = neighbors(state, self.group, True, self.cutoff == "radius")
        r = np.sqrt(p.r2)
        columns = {"dist": r, **{f"d{a}": p.d[:, k] for k, a in enumerate("xyz")}}
        if set(self.keywords) - set(columns):
            energy, force = interactions(state, p, single=True)
            columns |= {"eng": energy, "force": (force * p.d).sum(axis=1) / r, **{f"f{a}": force[:, k] for k, a in enumerate("xyz")}}
        out = [columns[k] for k in self.keywords]
        return np.asarray(out[0] if len(out) == 1 else np.column_stack(out), float)
