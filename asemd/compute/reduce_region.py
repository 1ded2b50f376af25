r"""As compute reduce, of the atoms that are in a region now; local values all count.

Source: LAMMPS manual, compute reduce/region. Units: those of the input.
"""
from __future__ import annotations

from asemd.compute.reduce import Reduce
from asemd.words import take


class ReduceRegion(Reduce):
    """Reduction in a region.

    Parameters
    ----------
    group, mode, inputs, replace, kind
        As for `asemd.compute.reduce.Reduce`.
    region : asemd.region.Region
    """

    style = "reduce/region"

    def __init__(self, group: str = "all", mode: str = "sum", inputs=(), replace=None, kind: str = "", region=None):
        super().__init__(group, mode, inputs, replace, kind)
        self.region = region

    @classmethod
    def from_lammps(cls, group, words, session):
        region = session.scene.region(take(words, 1, "compute reduce/region (region-ID mode)")[0], "compute reduce/region")
        return cls._read(group, words[1:], session, region=region)

    def to_lammps(self) -> list[str]:
        return [self.region.id, *super().to_lammps()]

    def chosen(self, state):
        return state.mask(self.group) & self.region.inside(state.system.x)
