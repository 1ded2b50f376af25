"""asemd: LAMMPS input scripts as ASE objects."""
__version__ = "0.1.0"
