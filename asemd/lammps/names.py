"""Names of LAMMPS's commands, so that one that is not here yet is told from a misspelt one."""
from __future__ import annotations

COMMANDS = frozenset("""
angle_coeff angle_style angle_write atom_modify atom_style balance bond_coeff bond_style bond_write boundary box change_box clear
comm_modify comm_style compute compute_modify create_atoms create_bonds create_box delete_atoms delete_bonds dielectric
dihedral_coeff dihedral_style dihedral_write dimension displace_atoms dump dump_modify dynamical_matrix echo fitpod_command fix
fix_modify geturl group group2ndx hyper if improper_coeff improper_style include info jump kim kspace_modify kspace_style label
labelmap lattice log mass message min_modify min_style minimize molecule ndx2group neb neigh_modify neighbor newton next package
pair_coeff pair_modify pair_style pair_write partition plugin prd print processors python quit read_data read_dump read_restart
region replicate rerun reset_atoms reset_timestep restart run run_style server set shell special_bonds suffix tad temper
temper_grem temper_npt thermo thermo_modify thermo_style third_order timer timestep uncompute undump unfix units variable velocity
write_coeff write_data write_dump write_restart
""".split())
