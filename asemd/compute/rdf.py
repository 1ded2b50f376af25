r"""Radial distribution function and coordination number of pairs of types.

.. math:: g(r) = \frac{\text{pairs between } r \text{ and } r + \Delta r}{N_i \rho_j \, V_\text{shell}}, \qquad
   c(r) = \frac{1}{N_i} \text{ pairs closer than } r + \Delta r

Partners that ``special_bonds`` takes out of the neighbour list are not counted. Source: LAMMPS manual, compute rdf.
Units: the first column is a distance.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._pairs import cluster_list, force_cutoff, half, in_slots, limits, of_slots, ordinary
from asemd.errors import InputError
from asemd.kernels import surroundings as loops
from asemd.words import bounds, number, take, whole


class RDF(Compute):
    """Radial distribution functions.

    Parameters
    ----------
    group : str
        Both atoms of a pair must be in it.
    bins : int
    pairs : sequence of (type or range, type or range)
        Central and other types, such as ``[(1, 2), ("1*3", "*")]``; none: all with all.
    cutoff : float, optional
        Where the bins end, in distance units; None: the largest cutoff of the pair style.

    Raises
    ------
    InputError
        Fewer than one bin, a cutoff that is not positive; types out of range (when it is evaluated).
    """

    style = "rdf"
    extensive = False

    def __init__(self, group: str = "all", bins: int = 100, pairs=(), cutoff: float | None = None):
        super().__init__(group)
        if bins < 1:
            raise InputError(f"compute rdf: the number of bins must be at least 1, got {bins}")
        if cutoff is not None and cutoff <= 0.0:
            raise InputError(f"compute rdf: cutoff must be positive, got {cutoff:g}")
        self.bins, self.pairs, self.cutoff = bins, [(str(a), str(b)) for a, b in pairs], cutoff

    @classmethod
    def from_lammps(cls, group, words, session):
        bins, rest, cutoff = whole(take(words, 1, "compute rdf")[0], "compute rdf: bins"), list(words[1:]), None
        if "cutoff" in rest:
            k = rest.index("cutoff")
            cutoff = number(take(rest[k + 1:], 1, "compute rdf cutoff")[0], "compute rdf cutoff")
            if rest[k + 2:]:
                raise InputError(f"compute rdf: unknown keyword {rest[k + 2]!r}")
            rest = rest[:k]
        if len(rest) % 2:
            raise InputError(f"compute rdf: types come in pairs, got {' '.join(rest)}")
        out = cls(group, bins, zip(rest[::2], rest[1::2], strict=True), cutoff)
        out._ranges(session.scene.need_system("compute rdf"))
        return out

    def to_lammps(self) -> list[str]:
        return [str(self.bins), *(w for pair in self.pairs for w in pair), *(["cutoff", repr(self.cutoff)] if self.cutoff else [])]

    def _ranges(self, system) -> list[tuple[tuple[int, int], tuple[int, int]]]:
        n, labels = system.counts["ntypes"], system.labels.get("atom")
        return [tuple(bounds(w, 1, n, "compute rdf: type", labels) for w in pair) for pair in self.pairs or [("*", "*")]]

    def histogram(self, state) -> tuple[np.ndarray, float]:
        """Counts (histograms, bins) of pairs, and the cutoff."""
        system = state.system
        cutoff = force_cutoff(state, "compute rdf") if self.cutoff is None else self.cutoff
        kind = np.where(state.mask(self.group), system.type, 0).astype(np.int32)
        met = self._met(state, kind, cutoff)
        met = met + met.transpose(1, 0, 2)      # centre first, then the other one
        ranges = self._ranges(system)
        return np.stack([met[i[0]:i[1] + 1, j[0]:j[1] + 1].sum(axis=(0, 1)) for i, j in ranges]), cutoff

    def _met(self, state, kind: np.ndarray, cutoff: float) -> np.ndarray:
        """How many pairs of each two kinds fall into each bin."""
        own, n, inverse = self.cutoff is not None, state.system.counts["ntypes"] + 1, self.bins / cutoff
        if limits(state, cutoff, own) is not None:
            p = half(state, cutoff, own=own)
            p = p.take(ordinary(state, p.kind))
            k = np.minimum(np.sqrt(p.r2) * inverse, self.bins).astype(np.int64)
            counts = np.bincount((kind[p.i].astype(np.int64) * n + kind[p.j]) * (self.bins + 1) + k, minlength=n * n * (self.bins + 1))
            return counts.reshape(n, n, -1)[:, :, :-1]
        clusters = cluster_list(state, cutoff)
        if clusters is None:
            f, counts = in_slots(state, cutoff), np.zeros((1, n, n, self.bins + 1), np.int64)
            keep = ordinary(state, f.code)
            loops.radial(f.x, of_slots(kind, f.row), f.i[keep], f.j[keep], f.code[keep], f.shifts, inverse, counts[0])
        else:
            engine, counts = state.engine, np.zeros((state.engine.threads, n, n, self.bins + 1), np.int64)
            s, kinds = engine.state, of_slots(kind, engine.state.row)

            def work(t):
                loops.radial_clusters(s.x, s.row, kinds, clusters.first[t], clusters.entries[t], clusters.own, clusters.span,
                                      clusters.bounds[t], clusters.bounds[t + 1], clusters.shifts, inverse, counts[t])
            engine.parallel(work)
        return counts.sum(axis=0)[:, :, :-1]

    def array_columns(self) -> int | None:
        return 1 + 2 * max(1, len(self.pairs))

    def array(self, state) -> np.ndarray:
        """(bins, 1 + 2 histograms): middle of the bin, then g(r) and coordination number of each pair of types."""
        counts, cutoff = self.histogram(state)
        system, bins, width = state.system, self.bins, cutoff / self.bins
        population = np.bincount(system.type[state.mask(self.group)], minlength=system.counts["ntypes"] + 1).astype(float)
        edges = np.arange(bins + 1) * width
        flat = system.dimension == 2
        volume = np.linalg.norm(np.cross(system.box.cell[0], system.box.cell[1])) if flat else system.box.volume
        shell = np.pi * np.diff(edges**2) / volume if flat else 4.0 * np.pi / 3.0 * np.diff(edges**3) / volume
        out = np.zeros((bins, 1 + 2 * len(counts)))
        out[:, 0] = (np.arange(bins) + 0.5) * width
        for k, ((i, j), count) in enumerate(zip(self._ranges(system), counts, strict=True)):
            centres, others = population[i[0]:i[1] + 1].sum(), population[j[0]:j[1] + 1].sum()
            both = population[max(i[0], j[0]):max(min(i[1], j[1]) + 1, max(i[0], j[0]))].sum()
            if centres > 0.0:
                share = others - both / centres
                out[:, 1 + 2 * k] = count / (shell * share * centres) if share != 0.0 else 0.0
                out[:, 2 + 2 * k] = np.cumsum(out[:, 1 + 2 * k] * shell * share)
        return out
