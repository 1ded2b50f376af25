r"""Whether an atom of the group has moved farther than a threshold since the last event.

The reference is set by what looks for events (`EventDisplace.store`). The scalar is 1 if any atom is farther away from it than the
threshold, else 0; without a reference 0.

Source: LAMMPS manual, compute event/displace. Units: none; the threshold is a distance.
"""
from __future__ import annotations

from asemd.compute import Compute
from asemd.compute._original import Original, unwrapped
from asemd.errors import InputError
from asemd.words import exactly, number


class EventDisplace(Compute):
    """Detector of events.

    Parameters
    ----------
    group : str
        The atoms it looks at.
    threshold : float
        Distance units.

    Raises
    ------
    InputError
        A threshold that is not positive.
    """

    style = "event/displace"

    def __init__(self, group: str = "all", threshold: float = 1.0):
        super().__init__(group)
        if not threshold > 0.0:
            raise InputError(f"compute event/displace: the threshold must be positive, got {threshold:g}")
        self.threshold = threshold
        self.original: Original | None = None

    @classmethod
    def from_lammps(cls, group, words, session):
        return cls(group, number(exactly(words, 1, "compute event/displace (threshold)")[0], "compute event/displace"))

    def to_lammps(self) -> list[str]:
        return [repr(self.threshold)]

    def store(self, system) -> None:
        """The positions of now are the reference."""
        self.original = Original(system, unwrapped(system))

    def scalar(self, state) -> float:
        """1 or 0."""
        system, now = state.system, unwrapped(state.system)
        if self.original is None:
            return 0.0
        d = (now - self.original.of(system, now))[state.mask(self.group)]
        return float(((d * d).sum(axis=1) > self.threshold**2).any())
