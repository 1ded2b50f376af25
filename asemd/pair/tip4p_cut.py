r"""$$E = \frac{C q_i q_j}{\epsilon r_{ij}} \qquad r_{ij} < r_c$$

Charges of four-site water (TIP4P) and of other atoms: the charge of an oxygen atom is on a massless site M on the bisector of H-O-H, at
the distance qdist. The hydrogen atoms are those whose ids follow that of the oxygen atom. Source: LAMMPS manual, pair_style tip4p/cut;
W. L. Jorgensen et al., J. Chem. Phys. 79, 926 (1983).
"""
from __future__ import annotations

from asemd.pair.coul_cut import coul_cut
from asemd.tip4p import tip4p

tip4p("tip4p/cut", (coul_cut, "cut"), settings="cut", coeff="", settings_example="1 2 1 1 0.15 10.0", example="",
      see="LAMMPS manual, pair_style tip4p/cut")
