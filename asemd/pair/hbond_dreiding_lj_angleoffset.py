r"""$$E = \epsilon \left[ 5 \left( \frac{\sigma}{r} \right)^{12} - 6 \left( \frac{\sigma}{r} \right)^{10} \right]
\cos^n (\theta + 180^\circ - \theta_0)$$

Hydrogen bonds as in hbond/dreiding/lj that are best at an angle of rest (90 to 180 degrees) instead of a straight line. The angle cutoff
is for the angle in brackets. LAMMPS's forces for an angle of rest other than 180 degrees are not minus the gradient of its energy. Here
they are; ``compat="lammps"`` gives LAMMPS's. On a straight line, where such an energy has a cone, the angle makes no force.
Source: LAMMPS manual, pair_style hbond/dreiding/lj.
"""
from __future__ import annotations

from asemd.hydrogen_bond import hydrogen_bond
from asemd.pair.hbond_dreiding_lj import twelve_ten

hydrogen_bond("hbond/dreiding/lj/angleoffset", "epsilon sigma", turned=True, units={"epsilon": "energy", "sigma": "distance"}, doc=__doc__,
              settings_example="4 9.0 11.0 90.0 170.0", example="2 i 4.0 2.75 4 8.0 9.5 85.0 120.0",
              see="LAMMPS manual, pair_style hbond/dreiding/lj")(twelve_ten)
