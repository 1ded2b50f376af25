r"""$$\vec F_i = \epsilon_i \tilde q_i \sum_j \frac{C \tilde q_j}{r^3} (\vec x_i - \vec x_j), \qquad
    E = \sum_{i < j} \frac{\epsilon_i + \epsilon_j}{2} \frac{C \tilde q_i \tilde q_j}{r}, \qquad \tilde q = q / \epsilon, \quad r < r_c$$

Charges of which each stands in a medium of its own, with the dielectric constant that the atom has (atom_style dielectric). The field of a
charge is weakened by the medium it is in, and acts on the whole charge of another one. Where two constants differ, the forces on the two
atoms are not opposite; they are the gradient of the energy where all are the same.
Source: T. D. Nguyen, H. Li, D. Bagchi, F. J. Solis, M. Olvera de la Cruz, Comput. Phys. Commun. 241, 80 (2019).
"""
from __future__ import annotations

from asemd.dielectric_pairs import DielectricPair
from asemd.pair.coul_cut import coul_cut
from asemd.pairstyle import pair_sum

pair_sum("coul/cut/dielectric", (coul_cut, "cut"), cls=DielectricPair, scales=True, settings="cut", coeff="[cut]", mix={"cut": "distance"},
         settings_example="10.0", example="9.0")
