r"""$$E = D_0 \left[ e^{-2 \alpha (r - r_0)} - 2 e^{-\alpha (r - r_0)} \right] \cos^n (\theta + 180^\circ - \theta_0)$$

Hydrogen bonds as in hbond/dreiding/morse that are best at an angle of rest, see hbond/dreiding/lj/angleoffset, also for LAMMPS's forces.
Source: LAMMPS manual, pair_style hbond/dreiding/morse.
"""
from __future__ import annotations

from asemd.hydrogen_bond import hydrogen_bond
from asemd.pair.hbond_dreiding_morse import morse

hydrogen_bond("hbond/dreiding/morse/angleoffset", "D0 alpha r0", turned=True, doc=__doc__,
              units={"D0": "energy", "alpha": "1/distance", "r0": "distance"}, settings_example="2 9.0 11.0 90.0 170.0",
              example="2 i 3.88 1.7241379 2.9 2 8.0 9.5 85.0 120.0", see="LAMMPS manual, pair_style hbond/dreiding/morse")(morse)
