"""Energy of each sub-style of a hybrid angle style, as a global vector.

Source: LAMMPS manual, compute angle. Units: energy.
"""
from __future__ import annotations

from asemd.compute._sub_styles import SubStyles


class Angle(SubStyles):
    """Energies of the sub-styles of ``angle_style hybrid``; see `asemd.compute._sub_styles.SubStyles`."""

    style = category = "angle"
