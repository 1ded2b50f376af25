"""Energy of each sub-style of a hybrid dihedral style, as a global vector.

Source: LAMMPS manual, compute dihedral. Units: energy.
"""
from __future__ import annotations

from asemd.compute._sub_styles import SubStyles


class Dihedral(SubStyles):
    """Energies of the sub-styles of ``dihedral_style hybrid``; see `asemd.compute._sub_styles.SubStyles`."""

    style = category = "dihedral"
