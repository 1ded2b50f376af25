"""What stands in a LAMMPS data file: header lines, sections and kinds of columns. Those of an atom style: `asemd.atom_style`."""
from __future__ import annotations

from asemd.atom_style import DIPOLE, MOMENTUM, SHAPE, SPHERE, SPIN, SURFACE, TURN

IMAGE = ("nx", "ny", "nz")

# column -> "id", "whole", "type" or "real"
KIND_OF = {"id": "id", "molecule": "whole", "type": "type", "q": "real", "x": "real", "y": "real", "z": "real", "nx": "whole",
           "ny": "whole", "nz": "whole", "vx": "real", "vy": "real", "vz": "real", "number": "whole", "atom1": "id",
           "atom2": "id", "atom3": "id", "atom4": "id", "ellipsoid": "whole",
           **dict.fromkeys((*DIPOLE, *SPIN, *SPHERE, *MOMENTUM, *SHAPE, *TURN, *SURFACE), "real")}

# header line -> number of values
HEADER = {
    **{word: 1 for word in ("atoms", "bonds", "angles", "dihedrals", "impropers", "atom types", "bond types", "angle types",
                            "dihedral types", "improper types", "extra bond per atom", "extra angle per atom", "extra dihedral per atom",
                            "extra improper per atom", "extra special per atom", "ellipsoids", "lines", "triangles", "bodies")},
    "xlo xhi": 2, "ylo yhi": 2, "zlo zhi": 2, "xy xz yz": 3, "avec": 3, "bvec": 3, "cvec": 3, "abc origin": 3,
}
REAL_HEADER = {word for word, n in HEADER.items() if n > 1}

TOPOLOGY = {"Bonds": "bond", "Angles": "angle", "Dihedrals": "dihedral", "Impropers": "improper"}
LABELS = {"Atom Type Labels": "atom", "Bond Type Labels": "bond", "Angle Type Labels": "angle", "Dihedral Type Labels": "dihedral",
          "Improper Type Labels": "improper"}

# section -> (category, word that marks the cross term in angle_coeff, dihedral_coeff, improper_coeff)
COEFFS = {
    "Pair Coeffs": ("pair", ""), "PairIJ Coeffs": ("pair", ""), "Bond Coeffs": ("bond", ""),
    "Angle Coeffs": ("angle", ""), "BondBond Coeffs": ("angle", "bb"), "BondAngle Coeffs": ("angle", "ba"),
    "UreyBradley Coeffs": ("angle", "ub"),
    "Dihedral Coeffs": ("dihedral", ""), "MiddleBondTorsion Coeffs": ("dihedral", "mbt"), "EndBondTorsion Coeffs": ("dihedral", "ebt"),
    "AngleTorsion Coeffs": ("dihedral", "at"), "AngleAngleTorsion Coeffs": ("dihedral", "aat"), "BondBond13 Coeffs": ("dihedral", "bb13"),
    "Improper Coeffs": ("improper", ""), "AngleAngle Coeffs": ("improper", "aa"),
}
UNSUPPORTED = {"Lines": "line", "Triangles": "tri", "Bodies": "body"}
SECTIONS = ("Masses", *LABELS, *COEFFS, "Atoms", "Velocities", "Ellipsoids", *TOPOLOGY, *UNSUPPORTED)
