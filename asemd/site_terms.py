"""Terms whose charges are on massless sites, see `asemd.charge_sites`."""
from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from asemd.cluster_term import PairTerm
from asemd.kernels.charge_sites import on_sites
from asemd.kernels.state import aligned
from asemd.term import PairListTerm, PairRowsTerm

if TYPE_CHECKING:
    from asemd.charge_sites import ChargeSites


class Sighted:
    """An engine as a term on sites sees it: positions with sites, and forces on them."""

    def __init__(self, engine, seen: np.ndarray, own: np.ndarray):
        self._engine, self.state, self.buffers = engine, engine.state._replace(x=seen), own

    def __getattr__(self, name):
        return getattr(self._engine, name)


class OnSites:
    """What terms whose charges are on sites have in common; before the class of the term that they are otherwise."""

    sites: ChargeSites
    _atoms: np.ndarray | None = None
    _seen = _on_sites = np.zeros((0, 0))

    def kernel(self, *arguments, **options):
        return on_sites(super().kernel(*arguments, **options))

    def rebuild(self, engine):
        super().rebuild(engine)
        state, system = engine.state, engine.system
        capacity = state.x.shape[1]
        if self._atoms is None or self._of is not system.id:
            self._atoms, self._of = self.sites.atoms(system), system.id
        slots = engine.slot_of[self._atoms]
        slots = slots[np.argsort(slots[:, 0], kind="stable")]
        self.oxygens, self.hydrogens = np.ascontiguousarray(slots[:, 0], np.int64), np.ascontiguousarray(slots[:, 1:], np.int64)
        d = state.x.T[self.hydrogens] - state.x.T[self.oxygens][:, None, :]
        self.site_images = np.where(engine.periodic, -np.rint(d @ engine.inverse), 0.0)
        self.site_of = np.full(capacity, -1, np.int64)
        self.site_of[self.oxygens] = np.arange(len(slots))
        if self._seen.shape[1] != capacity:
            self._seen = aligned((3, capacity))
        if self._on_sites.shape != engine.buffers.shape:
            self._on_sites = aligned(engine.buffers.shape)
        self.half = 0.5 * self.sites.share

    def sighted(self, engine) -> Sighted:
        """The engine as this term sees it."""
        return Sighted(engine, self._seen, self._on_sites)

    def arguments(self, engine, tid):
        return (engine.meeting, tid, engine.state.x, engine.buffers[tid], self.site_of, self.oxygens, self.hydrogens, self.site_images,
                self.half, engine.state.box.vectors, self._seen, self._on_sites[tid], super().arguments(self.sighted(engine), tid))

    def hand_over(self, engine, energy: np.ndarray, virial: np.ndarray) -> None:
        """Shares of energy (n,) and virial (n, 6), if any, of the sites, by row of their oxygen atoms, go to the three atoms."""
        oxygen, *hydrogens = self._atoms.T
        for a in (a for a in (energy, virial) if len(a)):
            part = self.half * a[oxygen]
            a[oxygen] -= 2.0 * part
            for row in hydrogens:
                a[row] += part


class ClusterOnSites(OnSites, PairTerm):
    """Pairs of sites over clusters."""


class RowsOnSites(OnSites, PairRowsTerm):
    """Pairs of sites over rows of single atoms."""


class ListOnSites(OnSites, PairListTerm):
    """Pairs of sites over plain pairs."""


ON_SITES = {PairTerm: ClusterOnSites, PairRowsTerm: RowsOnSites, PairListTerm: ListOnSites}


def made(kind: type, sites: ChargeSites | None, *arguments, **options):
    """A pair term of that kind, acting on sites if there are any."""
    if sites is None:
        return kind(*arguments, **options)
    term = ON_SITES[kind](*arguments, **options)
    term.sites = sites
    return term
