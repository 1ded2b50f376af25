r"""Another name of ewald/disp: it sums charges, point dipoles and the attraction, as far as the pair style leaves them to it.

With dipoles the waves are those of $|\sum_i (q_i + i \vec p_i \cdot \vec k) e^{i \vec k \cdot \vec x_i}|^2$.
Source: A. Toukmaji, C. Sagui, J. Board, T. Darden, J. Chem. Phys. 113, 10913 (2000).
"""
from __future__ import annotations

from asemd.kspace.ewald_disp import EwaldDisp


class EwaldDispDipole(EwaldDisp):
    """``kspace_style ewald/disp/dipole accuracy``."""

    style = flag = "ewald/disp/dipole"
    partner = "lj/long/dipole/long"
