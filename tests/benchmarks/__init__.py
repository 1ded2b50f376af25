"""Speed, start-up and memory, each beside LAMMPS in the same run: ``python -m tests.benchmarks``."""
