"""Lengths, energies, forces and kinetic energies of single bonds, as local values.

Keywords: dist dx dy dz (vector from atom 2 to atom 1), engpot force fx fy fz (force on atom 1; ``force`` is positive if they repel each
other), engvib engrot engtrans (kinetic energy of vibration, rotation and translation of the two atoms), omega (angular velocity), velvib
(velocity along the bond, positive if it grows), b1 (reference length of bond style bpm/spring), v_name with ``set dist variable``.
Turned off bonds have energy and force 0.
Of a bond across a periodic face LAMMPS takes the motion along the line through the whole box; here it is along the bond.

Source: LAMMPS manual, compute bond/local.
"""
from __future__ import annotations

from functools import cached_property

import numpy as np

from asemd.bond_term import present
from asemd.compute._local import Geometry, Local
from asemd.errors import InputError

XYZ = {"x": 0, "y": 1, "z": 2}


class Bonds:
    """Columns from a `Geometry` of bonds."""

    def __init__(self, geometry: Geometry):
        self.g = geometry
        self.d = geometry.between(0, 1)
        self.dist = np.sqrt(np.einsum("ij,ij->i", self.d, self.d))

    @cached_property
    def along(self) -> np.ndarray:
        """(m, 3) unit vectors."""
        return self.d / np.where(self.dist > 0.0, self.dist, 1.0)[:, None]

    def force(self) -> np.ndarray:
        """Force on atom 1, (m, 3)."""
        return self.g.evaluated()[1][:, 0]

    def motion(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Masses of the atoms (m, 2), velocity of their centre and of atom 1 against atom 2 (m, 3), its part along the bond (m,)."""
        system = self.g.state.system
        m, v = system.atom_masses()[self.g.atoms], system.v[self.g.atoms]
        relative = v[:, 0] - v[:, 1]
        centre = (m[:, :, None] * v).sum(axis=1) / m.sum(axis=1)[:, None]
        return m, centre, relative, (relative * self.along).sum(axis=1)

    def kinetic(self, which: str) -> np.ndarray:
        m, centre, relative, along = self.motion()
        half = 0.5 * self.g.state.units.mvv2e
        if which == "engtrans":
            return half * m.sum(axis=1) * (centre**2).sum(axis=1)
        across = (np.cross(self.along, relative) ** 2).sum(axis=1)
        return half * m.prod(axis=1) / m.sum(axis=1) * (along**2 if which == "engvib" else across)

    def omega(self) -> np.ndarray:
        across = np.sqrt((np.cross(self.along, self.motion()[2]) ** 2).sum(axis=1))
        return across / np.where(self.dist > 0.0, self.dist, np.inf)


def bonds(g: Geometry) -> Bonds:
    """Those of a geometry, made once."""
    if "bonds" not in g.known:
        g.known["bonds"] = Bonds(g)
    return g.known["bonds"]


def reference(g: Geometry) -> np.ndarray:
    """The lengths that bonds of styles that remember them had at first; 0 for others."""
    uses = [use for use in g.interactions.uses["bond"] if use.style.remembers == "bonds"]
    if not uses:
        raise InputError(f"compute bond/local: bond style {g.interactions.style_name('bond')} has no extra quantity b1")
    out = np.zeros(len(g.atoms))
    for use in uses:
        mine = np.isin(g.types, list(use.coeff))
        out[mine] = present(use, g.state.system, g.atoms[mine])[0][:, 0]
    return out


class BondLocal(Local):
    """Local values of bonds; arguments as in `asemd.compute._local.Local`."""

    style, kind, given = "bond/local", "bond", "dist"
    columns = {
        "dist": lambda g: bonds(g).dist,
        **{f"d{a}": lambda g, k=k: bonds(g).d[:, k] for a, k in XYZ.items()},
        "engpot": Geometry.energy,
        "force": lambda g: (bonds(g).force() * bonds(g).along).sum(axis=1),
        **{f"f{a}": lambda g, k=k: bonds(g).force()[:, k] for a, k in XYZ.items()},
        **{name: lambda g, name=name: bonds(g).kinetic(name) for name in ("engvib", "engrot", "engtrans")},
        "omega": lambda g: bonds(g).omega(),
        "velvib": lambda g: bonds(g).motion()[3],
        "b1": reference,
    }

    def unknown(self, word):
        if word[:1] == "b" and word[1:].isdigit():
            return InputError(f"compute bond/local: no bond style has an extra quantity {word}, only b1 exists")
        return super().unknown(word)
