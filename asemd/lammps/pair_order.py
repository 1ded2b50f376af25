"""The order in which LAMMPS on one processor goes over pairs, periodic images included: pair styles draw random numbers in it."""
from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from asemd.fix import Fix
from asemd.fix.atom_order import ListOrder, bin_counts
from asemd.kernels import half_list

if TYPE_CHECKING:
    from asemd.lammps.session import Session
    from asemd.loop import Loop


def codes(image: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Four times the place of each image (m, 3) among the known ones; -4 for others, which no pair needs."""
    most = int(np.abs(image).max(initial=0))
    wide = 2 * most + 1
    table = np.full(wide**3, -4, np.int32)
    near = np.flatnonzero((np.abs(known) <= most).all(axis=1))
    weights = np.array([wide * wide, wide, 1])
    table[(known[near] + most) @ weights] = 4 * near
    return table[(image + most) @ weights]


class PairOrder(ListOrder):
    """Pairs of a half list from bins, in LAMMPS's order."""

    guess = 0       # how many pairs there may be

    def arrange(self, loop: Loop) -> bool:
        """Make the pairs of the present positions, in this order, as the engine's plain list; False if lists of this kind are not known."""
        self.listed(loop)
        box, e = loop.system.box, loop.engine
        if not (self.bins and self.newton) or box.triclinic or not e.ortho:
            return False
        if e.mode == "cluster":
            e.list.see(e.cell, e.periodic)
        self.guess = self.guess or int(2.1 * e.reach**3 * len(self.x) ** 2 / e.volume)
        x, row, image = half_list.with_images(self.x[self.stored], e.reach, e.periodic, self.low, self.high)
        code = codes(image, np.rint(e.list.shifts @ np.linalg.inv(e.vectors)).astype(np.int64))
        length = self.high - self.low
        width = length / bin_counts(length, 0.5 * e.reach, loop.system.dimension)
        slot = e.slot_of[self.stored[row]].astype(np.int32)
        found = half_list.pairs(x, len(self.x), self._bin(loop, 0.5 * e.reach, x), width, e.reach * (1.0 + 1e-12), slot, code, self.guess)
        self.guess = len(found[0])
        e.mark(*found, e.list.shifts)
        return True


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

