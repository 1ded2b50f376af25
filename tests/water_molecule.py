"""Molecules of water for tests of templates: their files, and the box that they come into."""
from __future__ import annotations

from collections.abc import Sequence

BOX = """
units real
atom_style full
region box block 0 {width} 0 {width} 0 {width}
create_box 2 box bond/types 1 angle/types 1 extra/bond/per/atom 2 extra/angle/per/atom 2 extra/special/per/atom 4
mass 1 15.9994
mass 2 1.008
bond_style harmonic
bond_coeff 1 450 {bond}
angle_style harmonic
angle_coeff 1 55 {angle}
pair_style lj/cut/coul/cut {cut}
pair_coeff 1 1 0.155 3.166
pair_coeff * 2 0.0 1.0
molecule water water.mol
create_atoms 0 random {n} 4711 NULL mol water 993 overlap 2.2 maxtry 400
"""
HEAD = """{comment}water

3 atoms
2 bonds
1 angles
{more}
Coords

"""
BONDED = """
Bonds

1   1      1      2
2   1      1      3

Angles

1   1      2      1      3

Special Bond Counts

1 2 0 0
2 1 1 0
3 1 1 0

Special Bonds

1 2 3
2 1 3
3 1 2
"""
SHAKE = """
Shake Flags

1 1
2 1
3 1

Shake Atoms

1 1 2 3
2 1 2 3
3 1 2 3

Shake Bond Types

1 1 1 1
2 1 1 1
3 1 1 1
"""
TYPES = "\nTypes\n\n1 1\n2 2\n3 2\n"


def water(x: Sequence[Sequence[float]], charge: float = 0.4, shake: bool = False, types: str = TYPES, more: str = "",
          comment: str = "") -> str:
    """The file of a template: oxygen first.

    Parameters
    ----------
    x : (3, 3)
        Positions.
    charge : float
        Of a hydrogen atom.
    shake : bool
        With what holds bonds and angle.
    types, more, comment : str
        The section ``Types``, further lines of the header, what stands before the title.
    """
    coords = "".join(f"{k} {a} {b} {c}\n" for k, (a, b, c) in enumerate(x, 1))
    charges = f"\nCharges\n\n1 {-2.0 * charge}\n2 {charge}\n3 {charge}\n"
    return HEAD.format(comment=comment, more=more) + coords + types + charges + BONDED + SHAKE * shake
