r"""Angular distribution functions: how often angles between two neighbours occur at atoms.

Columns are the middle of the bin and for each triple of types the distribution of angles (its integral is 1), then how many there are per
central atom up to the end of the bin. Partners that ``special_bonds`` takes out of the neighbour list are not counted.
Source: LAMMPS manual, compute adf.
Units: degrees, radians or none for a cosine.
"""
from __future__ import annotations

import numpy as np

from asemd.compute import Compute
from asemd.compute._pairs import force_cutoff, half, ordinary
from asemd.errors import InputError
from asemd.kernels import surroundings as loops
from asemd.words import bounds, choice, number, take, whole

ORDINATES = {"degree": (0.0, 180.0), "radian": (0.0, np.pi), "cosine": (-1.0, 1.0)}


class ADF(Compute):
    """Angular distribution functions.

    Parameters
    ----------
    group : str
        All three atoms must be in it.
    bins : int
    triples : sequence of (type, type, type, inner, outer, inner, outer)
        Types (or ranges) of the central atom and of two neighbours, and between which distances each neighbour must be; none: all types,
        up to the cutoff of the pair style.
    ordinate : str
        degree, radian or cosine.

    Raises
    ------
    InputError
        Fewer than one bin, negative distances, or an outer one that is not beyond the inner one.
    """

    style = "adf"
    extensive = False

    def __init__(self, group: str = "all", bins: int = 180, triples=(), ordinate: str = "degree"):
        super().__init__(group)
        if bins < 1:
            raise InputError(f"compute adf: the number of bins must be at least 1, got {bins}")
        self.bins, self.ordinate = bins, choice(ordinate, ORDINATES, "compute adf ordinate")
        self.triples = [(*map(str, t[:3]), *map(float, t[3:])) for t in triples]
        for *_, a, b, c, d in self.triples:
            if not (0.0 <= a < b and 0.0 <= c < d):
                raise InputError(f"compute adf: outer distances must be beyond inner ones, which are not negative: {a:g} {b:g} {c:g} {d:g}")

    @classmethod
    def from_lammps(cls, group, words, session):
        bins, rest, ordinate = whole(take(words, 1, "compute adf")[0], "compute adf: bins"), list(words[1:]), "degree"
        if "ordinate" in rest:
            k = rest.index("ordinate")
            ordinate = take(rest[k + 1:], 1, "compute adf ordinate")[0]
            if rest[k + 2:]:
                raise InputError(f"compute adf: unknown keyword {rest[k + 2]!r}")
            rest = rest[:k]
        if len(rest) % 7:
            raise InputError(f"compute adf: each angle needs 7 values (three types, four distances), got {' '.join(rest)}")
        triples = [(*rest[k:k + 3], *(number(w, "compute adf: distance") for w in rest[k + 3:k + 7])) for k in range(0, len(rest), 7)]
        out = cls(group, bins, triples, ordinate)
        out._ranges(session.scene.need_system("compute adf"))
        return out

    def to_lammps(self) -> list[str]:
        return [str(self.bins), *(str(w) for t in self.triples for w in t), "ordinate", self.ordinate]

    def _ranges(self, system) -> np.ndarray:
        n, labels = system.counts["ntypes"], system.labels.get("atom")
        return np.array([[k for w in t[:3] for k in bounds(w, 1, n, "compute adf: type", labels)] for t in self.triples or [("*",) * 3]])

    def histogram(self, state) -> tuple[np.ndarray, np.ndarray]:
        """Counts (histograms, bins) of angles, and the central atoms (histograms,)."""
        system, mask = state.system, np.ascontiguousarray(state.mask(self.group))
        longest = force_cutoff(state, "compute adf")
        radii = np.array([t[3:] for t in self.triples] or [(0.0, longest, 0.0, longest)])
        reach = max(longest, float(radii.max()))
        pairs = half(state, reach * (1.0 + 1e-12), own=reach > longest)
        around = pairs.take(ordinary(state, pairs.kind)).around(system.n)
        counts, centres = np.zeros((len(radii), self.bins), np.int64), np.zeros(len(radii), np.int64)
        loops.angular(np.flatnonzero(mask), np.ascontiguousarray(system.type, np.int32), *around, mask, self._ranges(system), radii**2,
                      list(ORDINATES).index(self.ordinate), counts, centres)
        return counts, centres

    def array_columns(self) -> int | None:
        return 1 + 2 * max(1, len(self.triples))

    def array(self, state) -> np.ndarray:
        """(bins, 1 + 2 histograms)."""
        counts, centres = self.histogram(state)
        low, high = ORDINATES[self.ordinate]
        out = np.zeros((self.bins, 1 + 2 * len(counts)))
        out[:, 0] = low + (np.arange(self.bins) + 0.5) * ((high - low) / self.bins)
        for k, (count, n) in enumerate(zip(counts, centres, strict=True)):
            if count.any():
                out[:, 1 + 2 * k] = count / count.sum() / ((high - low) / self.bins)
                out[:, 2 + 2 * k] = np.cumsum(count) / n
        return out
