"""Three chains of four atoms with every kind of bonded item, for tests that compare asemd with LAMMPS; both engines run the same lines."""
from __future__ import annotations

import numpy as np

N = 12
EXTRA = "extra/bond/per/atom 9 extra/angle/per/atom 9 extra/dihedral/per/atom 9 extra/improper/per/atom 9 extra/special/per/atom 20"


def data(coefficients: str = "", types: int = 2, start: float = 11.0) -> str:
    """Text of a data file: three chains in a tilted box, across its periodic faces if they `start` at 11, with sections of coefficients."""
    rng = np.random.default_rng(5)
    at = np.arange(N)
    x = np.cumsum(np.where(at[:, None] % 4 == 0, [[0, 2.3, 2.0]], rng.normal(0, 0.25, (N, 3)) + [[0, 0.2, 0.1]]), axis=0)
    x[:, 0] = start + (at % 4) * 1.25 + rng.normal(0, 0.1, N)
    v = rng.normal(0, 0.01, (N, 3))
    bonds = [(1 + i % 2, i, i + 1) for i in range(1, N) if i % 4]
    angles = [(1 + i % 2, i, i + 1, i + 2) for i in range(1, N - 1) if i % 4 in (1, 2)]
    dihedrals = [(1 + (i > 4), i, i + 1, i + 2, i + 3) for i in range(1, N - 2) if i % 4 == 1]
    impropers = [(1 + (i > 4), i + 1, i, i + 2, i + 3) for i in range(1, N - 2) if i % 4 == 1]
    sections = {"Bonds": bonds, "Angles": angles, "Dihedrals": dihedrals, "Impropers": impropers}
    lines = ["chains", "", f"{N} atoms", "2 atom types"]
    for name, items in sections.items():
        lines += [f"{len(items)} {name.lower()}", f"{types} {name.lower()[:-1]} types"]
    lines += ["0 14 xlo xhi", "0 14 ylo yhi", "0 14 zlo zhi", "1.0 -0.5 0.7 xy xz yz", "", "Masses", "", "1 12.0", "2 1.0", coefficients,
              "Atoms # full", ""]
    lines += [f"{i + 1} {i // 4 + 1} {1 + i % 2} {0.1 * (-1)**i:.3g} {x[i, 0]:.15g} {x[i, 1]:.15g} {x[i, 2]:.15g} 0 0 0" for i in range(N)]
    lines += ["", "Velocities", "", *(f"{i + 1} {a:.15g} {b:.15g} {c:.15g}" for i, (a, b, c) in enumerate(v.tolist()))]
    for name, items in sections.items():
        lines += ["", name, "", *(f"{k} {' '.join(map(str, item))}" for k, item in enumerate(items, 1))]
    return "\n".join(lines) + "\n"


def head(path, special: str = "lj/coul 0 0 0.5", styles: str = "") -> list[str]:
    """The script up to and with read_data; `styles` replaces the bonded styles."""
    styles = styles or "bond_style harmonic\nangle_style harmonic\ndihedral_style harmonic\nimproper_style harmonic"
    return ["units real", "atom_style full", "atom_modify map array sort 0 0", "pair_style lj/cut 4.5", *styles.splitlines(),
            f"special_bonds {special}", f"read_data {path} {EXTRA}", "pair_coeff * * 0.1 2.0"]


SIMPLE = ["bond_coeff 1 100 1.3", "bond_coeff 2 200 1.2", "angle_coeff * 30 110", "dihedral_coeff * 1 1 3", "improper_coeff * 3 20"]
HYBRID = "bond_style hybrid harmonic morse\nangle_style hybrid harmonic charmm\ndihedral_style hybrid harmonic opls\n" \
         "improper_style hybrid harmonic cvff"
HYBRID_COEFF = ["bond_coeff 1 harmonic 100 1.3", "bond_coeff 2 morse 50 1.5 1.2", "angle_coeff 1 harmonic 30 110",
                "angle_coeff 2 charmm 20 100 5 2.4", "dihedral_coeff 1 opls 1 2 3 4", "dihedral_coeff 2 harmonic 1.5 -1 2",
                "improper_coeff 1 harmonic 3 20", "improper_coeff 2 cvff 1.5 -1 2"]
