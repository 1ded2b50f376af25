"""Four ions of two types in a box, as lines of a script."""
FOUR_IONS = """create_atoms 1 single 1 1 1
create_atoms 1 single 2 2 2
create_atoms 2 single 2.2 3 2
create_atoms 2 single 4 3 2.5
mass * 1
set type 1 charge 0.5
set type 2 charge -0.5
"""
