"""A scene of short charged chains, whose partners keep weights."""
from __future__ import annotations

import numpy as np

COLUMNS = ("evdwl", "ecoul", "emol", "etail", "pxx", "pxy")


def chain(n_chains: int = 3, length: int = 6) -> str:
    """Commands that make short zigzag chains with charges, bonds and velocities."""
    out = ["units real", "atom_style full", "region b block 0 16 0 16 0 16",
           "create_box 2 b bond/types 1 extra/bond/per/atom 2 extra/special/per/atom 8", "mass * 12",
           "bond_style harmonic", "bond_coeff 1 100 1.5"]
    rng = np.random.default_rng(4)
    n = 0
    for c in range(n_chains):
        for k in range(length):
            n += 1
            x = np.array([3 + 1.4 * k, 4 + 3.5 * c + 0.6 * (k % 2), 8.0]) + rng.normal(0, 0.05, 3)
            out += [f"create_atoms {1 + k % 2} single {x[0]:.6f} {x[1]:.6f} {x[2]:.6f} units box", f"set atom {n} mol {c + 1}",
                    f"set atom {n} charge {[0.3, -0.3, 0.1][k % 3]}"]
    out += [f"create_bonds single/bond 1 {n} {n + 1} special no" for n in range(1, n_chains * length) if n % length]
    out += ["special_bonds lj 0.2 0.3 0.5 coul 0.1 0.4 0.6", "velocity all create 300 4829 loop geom", "fix 1 all nve",
            f"thermo_style custom {' '.join(COLUMNS)}"]
    return "\n".join(out) + "\n"
