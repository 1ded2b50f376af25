"""What data files of a chain of four atoms have in common: counts and bonded items."""
COUNTS = "4 atoms\n3 bonds\n2 angles\n1 dihedrals\n"
TYPES = "1 bond types\n1 angle types\n1 dihedral types\n"
ITEMS = """Bonds

1 1 1 2
2 1 2 3
3 1 3 4

Angles

1 1 1 2 3
2 1 2 3 4

Dihedrals

1 1 1 2 3 4
"""
