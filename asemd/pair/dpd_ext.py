r"""$$\vec f = \left[ A w - \gamma w_s^2 (\hat r \cdot \vec v) + \sigma w_s \zeta / \sqrt{\Delta t} \right] \hat r
    + (1 - \hat r \hat r^T) \left[ -\gamma_T w_T^2 \vec v + \sigma_T w_T \vec \zeta / \sqrt{\Delta t} \right]$$

Dissipative particle dynamics (dpd) with friction and noise across the line of centres too; the weights are w = 1 - r/rc to the powers
ws and wsT.  Junghans, Praprotnik and Kremer, Soft Matter 4, 156 (2008).
"""
from __future__ import annotations

from asemd.pair.dpd import UNITS, NoisyPair, repulsion
from asemd.style import register


class AcrossPair(NoisyPair):
    """Has friction and noise in all directions."""

    across = True


register(AcrossPair("dpd/ext", [(repulsion, "cut")], settings="temperature cut seed", coeff="a0 gamma gammaT ws wsT [cut]", units=UNITS,
                    doc=__doc__, settings_example="1.0 2.5 34387", example="25.0 4.5 53.0 0.5 0.5 2.4",
                    see="LAMMPS manual, pair_style dpd/ext", shifts=False))
