"""Ids and types of the atoms of bonds, angles, dihedrals, impropers or neighbours, as local values.

Keywords of one kind go together: batom1 batom2 btype; aatom1 aatom2 aatom3 atype; datom1 .. datom4 dtype; iatom1 .. iatom4 itype;
natom1 natom2 ntype1 ntype2 (pairs of the neighbour list); patom1 patom2 ptype1 ptype2 (pairs within the cutoff of the pair style;
``cutoff radius``: pairs of spheres that touch).

Source: LAMMPS manual, compute property/local.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._local import local_items
from asemd.compute._neighbors import neighbors
from asemd.errors import InputError, nearest
from asemd.topology import ATOMS
from asemd.words import choice, take

KINDS = {kind[0]: kind for kind in ATOMS}
COLUMNS = {**{f"{k}atom{i}": kind for k, kind in KINDS.items() for i in range(1, ATOMS[kind] + 1)},
           **{f"{k}type": kind for k, kind in KINDS.items()},
           **{f"{k}{what}{i}": kind for k, kind in (("n", "neighbor"), ("p", "pair")) for what in ("atom", "type") for i in (1, 2)}}


class PropertyLocal(Compute):
    """Local ids and types.

    Parameters
    ----------
    group : str
        Items count whose atoms are all in it.
    keywords : sequence of str
        Keys of `COLUMNS`, all of one kind.
    scene : asemd.scene.Scene, optional
        Needed for pairs.
    cutoff : str
        ``type``: of the pair style; ``radius``: the sum of the radii. For patom and ptype.

    Raises
    ------
    InputError
        Keywords that are unknown or do not go together.
    """

    style = "property/local"

    def __init__(self, group: str = "all", keywords=(), scene=None, cutoff: str = "type"):
        super().__init__(group)
        if not keywords:
            raise InputError("compute property/local needs at least one attribute, for example: batom1 batom2 btype")
        for word in keywords:
            if word not in COLUMNS:
                raise InputError(f"compute property/local: unknown attribute {word!r}{nearest(word, COLUMNS)}")
        kinds = list(dict.fromkeys(COLUMNS[word] for word in keywords))
        if len(kinds) > 1:
            first, other = (next(w for w in keywords if COLUMNS[w] == kind) for kind in kinds[:2])
            raise InputError(f"compute property/local: {first} (of a {kinds[0]}) and {other} (of a {kinds[1]}) cannot go together")
        self.kind, self.keywords, self.cutoff, self.scene = kinds[0], list(keywords), cutoff, scene
        if self.kind in ("neighbor", "pair") and (scene is None or not scene.interactions.uses["pair"]):
            raise InputError(f"compute property/local: {keywords[0]} needs a pair style")
        if cutoff == "radius" and "radius" not in scene.system.extra:
            raise InputError(f"compute property/local: cutoff radius needs atoms with a radius, not atom_style {scene.system.atom_style}")

    @classmethod
    def from_lammps(cls, group, words, session):
        words, cutoff = list(words), "type"
        while "cutoff" in words:
            k = words.index("cutoff")
            cutoff = choice(take(words[k + 1:], 1, "compute property/local cutoff")[0], ("type", "radius"), "compute property/local cutoff")
            del words[k:k + 2]
        return cls(group, words, session.scene, cutoff)

    def to_lammps(self) -> list[str]:
        return [*self.keywords, *(["cutoff", "radius"] if self.cutoff == "radius" else [])]

    def local_columns(self):
        return len(self.keywords) if len(self.keywords) > 1 else 0

    def local(self, state) -> np.ndarray:
        """(m,) for one attribute, (m, k) for several; whole numbers."""
        system = state.system
        if self.kind in ("neighbor", "pair"):
            pairs = neighbors(state, self.group, self.kind == "pair", self.cutoff == "radius")
            atoms, types = np.column_stack([pairs.i, pairs.j]), None
        else:
            atoms, types = local_items(state, self.kind, self.group)
        out = []
        for word in self.keywords:
            if word[1:] == "type":
                out.append(types)
            else:
                out.append((system.id if word[1:5] == "atom" else system.type)[atoms[:, int(word[5]) - 1]])
        return np.asarray(out[0], float) if len(out) == 1 else np.column_stack(out).astype(float)
