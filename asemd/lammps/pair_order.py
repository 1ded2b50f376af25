"""The order in which LAMMPS on one processor goes over pairs, periodic images included: pair styles draw random numbers in it."""
from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from asemd.fix import Fix
from asemd.fix.atom_order import ListOrder, _above

if TYPE_CHECKING:
    from asemd.lammps.session import Session
    from asemd.loop import Loop


class PairOrder(ListOrder):
    """Pairs of a half list from bins, in LAMMPS's order."""

    def arrange(self, loop: Loop, term) -> bool:
        """Make the pairs of a term those of the present positions, in this order; False if lists of this kind are not known.

        The term gets ``i, j, code, shifts`` as a plain list has them.
        """
        self.listed(loop)
        box, e = loop.system.box, loop.engine
        if not (self.bins and self.newton) or box.triclinic or not e.ortho:
            return False
        local = np.argsort(self.place)                     # rows in LAMMPS's order
        x, row, image = self._with_ghosts(self.x[local], e.reach, e.periodic, self.high - self.low)
        n = len(local)
        from scipy.spatial import cKDTree
        found = cKDTree(x[:n]).sparse_distance_matrix(cKDTree(x), e.reach * (1.0 + 1e-12), output_type="coo_matrix")
        i, j = found.row[found.row != found.col], found.col[found.row != found.col]
        bins = self._bin(loop, 0.5 * e.reach, x)
        bins[:n] = np.clip(bins[:n], 0, None)
        step = bins[j] - bins[i]
        same = ~step.any(axis=1)
        keep = np.where(same, np.where(j >= n, _above(x[j] - x[i]) | (x[j] == x[i]).all(axis=1), j > i), _above(step))
        i, j, step, same = i[keep], j[keep], step[keep], same[keep]
        order = np.lexsort((j, step[:, 0], step[:, 1], step[:, 2], ~same, i))
        i, j = i[order], j[order]
        known = {tuple(k): n for n, k in enumerate(np.rint(e.plain_shifts @ np.linalg.inv(e.vectors)).astype(int).tolist())}
        kinds, code = np.unique(image[j], axis=0, return_inverse=True)
        code = np.array([known[tuple(k)] for k in kinds.tolist()], int)[code.ravel()]
        term.shifts = e.plain_shifts        # they follow a box that moves
        slots = [np.ascontiguousarray(e.slot_of[local[row[a]]], np.int32) for a in (i, j)]
        s = e.state
        term.i, term.j, term.code = e.exclusions.mark(e.k, s.x, s.row, *slots, (4 * code).astype(np.int32), term.shifts, e.cell,
                                                      e.periodic)
        return True

    def _with_ghosts(self, x: np.ndarray, reach: float, periodic: np.ndarray, length: np.ndarray):
        """Atoms and images within `reach` of the box, in the order in which they are sent: positions, atoms, images (m, 3)."""
        row, image = np.arange(len(x)), np.zeros((len(x), 3), np.int64)
        for axis in range(3):
            if not periodic[axis]:
                continue
            first, last = 0, len(x)
            middle = 0.5 * (self.low[axis] + self.high[axis])
            for swap in range(int(reach / length[axis]) + 1):
                low = self.low[axis] + reach
                high = self.high[axis] - reach
                at = x[first:last, axis]
                left = np.flatnonzero((at >= (-np.inf if swap == 0 else middle)) & (at <= low)) + first
                right = np.flatnonzero((at >= high) & (at <= (np.inf if swap == 0 else middle))) + first
                for sent, way in ((left, 1), (right, -1)):
                    moved, new = x[sent].copy(), image[sent].copy()
                    moved[:, axis] += way * length[axis]
                    new[:, axis] += way
                    x, row, image = np.concatenate([x, moved]), np.concatenate([row, row[sent]]), np.concatenate([image, new])
                first, last = last, len(x)
        return x, row, image


class KeepsOrder(Fix):
    """Hands the order of pairs to the loop of each run."""

    style = "pair/order"
    levels = "outermost"

    def __init__(self, order: PairOrder):
        super().__init__("all")
        self.order = order

    def prepare(self, loop: Loop) -> None:
        self.order.due = loop.step
        loop.pair_order = self.order


def pair_order(session: Session) -> list[Fix]:
    """The fix that a run needs if a pair style draws random numbers."""
    scene = session.scene
    if not any(use.style.stirred for use in scene.interactions.uses["pair"]):
        return []
    if getattr(scene, "pair_order", None) is None:
        scene.pair_order = PairOrder(*scene.sort, scene.list_style != "nsq", scene.newton[0], scene.order)
    return [KeepsOrder(scene.pair_order)]

