"""Energy of each sub-style of a hybrid bond style, as a global vector.

Source: LAMMPS manual, compute bond. Units: energy.
"""
from __future__ import annotations

from asemd.compute._sub_styles import SubStyles


class Bond(SubStyles):
    """Energies of the sub-styles of ``bond_style hybrid``; see `asemd.compute._sub_styles.SubStyles`."""

    style = category = "bond"
