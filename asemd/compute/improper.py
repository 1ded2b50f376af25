"""Energy of each sub-style of a hybrid improper style, as a global vector.

Source: LAMMPS manual, compute improper. Units: energy.
"""
from __future__ import annotations

from asemd.compute._sub_styles import SubStyles


class Improper(SubStyles):
    """Energies of the sub-styles of ``improper_style hybrid``; see `asemd.compute._sub_styles.SubStyles`."""

    style = category = "improper"
