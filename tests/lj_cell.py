"""A script that builds 32 atoms in a Lennard-Jones crystal."""
BASE = """units lj
lattice fcc 0.8442
region box block 0 2 0 2 0 2
create_box 1 box
create_atoms 1 box
mass 1 1.0
velocity all create 1.44 87287 loop geom
pair_style lj/cut 1.5
pair_coeff 1 1 1.0 1.0
fix 1 all nve
"""
