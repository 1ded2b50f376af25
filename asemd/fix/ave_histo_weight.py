r"""Histogram of values with weights, averaged over time: as fix ave/histo, but each value adds its weight to its bin instead of one.

Source: LAMMPS manual, fix ave/histo/weight. Output: as fix ave/histo, with sums of weights for counts.
"""
from __future__ import annotations

from asemd.fix.ave_histo import AveHisto


class AveHistoWeight(AveHisto):
    """Histogram of weighted values; of the two values the second one is the weight. Parameters as in `asemd.fix.AveHisto`."""

    style = "ave/histo/weight"
    weighted = True
