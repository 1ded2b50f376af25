r"""The sum of lj/cut/soft up to cut_lj and coul/cut/soft up to cut_coul, with one lambda; one cutoff given means both."""
from __future__ import annotations

from asemd.pair import coul_cut_soft, lj_cut_soft
from asemd.pairstyle import pair_sum


def derived(c, settings):
    """What both parts need."""
    return {**lj_cut_soft.derived(c, {"n": settings["n"], "alpha": settings["alphaLJ"]}), **coul_cut_soft.derived(c, settings)}


pair_sum("lj/cut/coul/cut/soft", (lj_cut_soft.lj_cut_soft, "cut_lj"), (coul_cut_soft.coul_soft, "cut_coul"), cls=lj_cut_soft.SoftPair,
         settings="n alphaLJ alphaC cut_lj [cut_coul]", coeff="epsilon sigma lambda [cut_lj] [cut_coul]", derived=derived,
         rows="front core weight gap", defaults={"cut_coul": "cut_lj"}, mix={"epsilon": "sigma", "sigma": "distance"},
         tail=lj_cut_soft.tail, units={"epsilon": "energy", "alphaC": "distance^2"}, settings_example="2.0 0.5 5.0 8.0 10.0",
         example="0.1 3.0 0.7 7.0 9.0", see="LAMMPS manual, pair_style lj/cut/coul/cut/soft")
