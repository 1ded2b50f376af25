r"""Multi-state modified embedded-atom method (MS-MEAM): MEAM whose densities of order 1 to 3 are differences of two sets.

$$\Gamma_i=\sum_{h=1}^3\frac{(\rho_i^{(h)})^2-(\tilde\rho_i^{(h)})^2}{(\rho_i^{(0)})^2}$$

The second set has its own $\tilde\beta^{(h)}$ and $\tilde t^{(h)}$, b1m to b3m and t1m to t3m of the library; everything else is as in
`pair meam`. The default of ``ialloy`` is 1: densities have their t in them. With another ialloy they have not, but in LAMMPS's force they
do (``compat="lammps"``); ours is the gradient of the energy. With ``mixture_ref_t = 1`` the background density of an atom is made of the
sums of t of its neighbours weighted with their densities, where `pair meam` has means (of zeros for ialloy 2): so LAMMPS has it, but its
force lacks the derivative of these sums.

Source: LAMMPS manual, pair_style meam/ms; Baskes, Muralidharan, Stan, Valone and Cherne, JOM 55, 41 (2003).
"""
from __future__ import annotations

from asemd.pair.meam import ModifiedEmbedded
from asemd.style import register

register(ModifiedEmbedded("meam/ms", True, doc=__doc__, example="library.msmeam H Ga4 HGa.msmeam H",
                          see="M. I. Baskes, K. Muralidharan, M. Stan, S. M. Valone and F. J. Cherne, JOM 55, 41 (2003)"))
