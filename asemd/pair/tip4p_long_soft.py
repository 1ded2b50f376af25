r"""coul/long/soft for charges of four-site water (TIP4P), with kspace_style pppm/tip4p: the charge of an oxygen atom is on a massless site,
see tip4p/cut. Forces and ``compat="lammps"`` as in coul/long/soft. Source: LAMMPS manual, pair_style lj/cut/tip4p/long/soft.
"""
from __future__ import annotations

from asemd.pair.coul_cut_soft import derived
from asemd.pair.coul_long_soft import coul_long_soft, coul_long_soft_lammps
from asemd.tip4p import TIP4PSoft, tip4p

OPTIONS = dict(settings="n alphaC cut", coeff="lambda", derived=derived, rows="weight gap", mix={"lambda": "distance"},
               units={"alphaC": "distance^2"}, settings_example="1 2 1 1 0.15 2.0 5.0 10.0", example="0.8",
               see="LAMMPS manual, pair_style tip4p/long/soft")
style = tip4p("tip4p/long/soft", (coul_long_soft, "cut"), cls=TIP4PSoft, **OPTIONS)
style.twin = TIP4PSoft("tip4p/long/soft", [(coul_long_soft_lammps, "cut")], doc=__doc__, **OPTIONS)
