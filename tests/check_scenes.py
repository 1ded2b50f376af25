"""Healthy scenes for checks and reports, as scripts, and small edits that break them in one way each."""
from __future__ import annotations

import numpy as np

LJ = """units lj
lattice fcc 0.8442
region box block 0 4 0 4 0 4
create_box 1 box
create_atoms 1 box
mass 1 1.0
velocity all create 1.44 87287 loop geom
pair_style lj/cut 2.5
pair_coeff 1 1 1.0 1.0
fix 1 all nve
timestep 0.005
run 10
"""

CHAIN = """units lj
atom_style bond
special_bonds fene
bond_style fene
read_data chain.data
bond_coeff 1 30.0 1.5 1.0 1.0
neighbor 0.4 bin
pair_style lj/cut 1.12
pair_modify shift yes
pair_coeff 1 1 1.0 1.0
velocity all create 1.0 4711 loop geom
fix 1 all nve
fix 2 all langevin 1.0 1.0 10.0 904297
timestep 0.006
run 10
"""

BUTANE = """units real
atom_style full
special_bonds amber
bond_style harmonic
angle_style harmonic
dihedral_style charmm
pair_style lj/cut/coul/cut 10.0
read_data butane.data
pair_coeff 1 1 0.15 3.75
bond_coeff 1 260.0 1.54
angle_coeff 1 63.0 112.0
dihedral_coeff 1 1.4 3 0 0.0
velocity all create 300.0 4711 loop geom
fix 1 all nvt temp 300.0 300.0 100.0
timestep 1.0
run 10
"""


def chain_data(length: float = 0.97) -> str:
    """Straight chains of 10 beads in a periodic box; the first bond has another length."""
    beads, side = 10, 6
    x = [(b * 0.97 + 0.1, i * 1.3 + 0.1, j * 1.3 + 0.1) for i in range(side) for j in range(side) for b in range(beads)]
    x[0] = (x[1][0] - length, *x[0][1:])
    bonds = [(k, k + 1) for k in range(1, len(x)) if k % beads]
    return _data(x, 12.0, side * 1.3, bonds=bonds, masses=[1.0])


def butane_data(bend: float = 112.0, r: float = 1.54) -> str:
    """United-atom butane, all trans, on a grid 7 Angstrom apart."""
    half = np.radians(0.5 * bend)
    a, b = np.sin(half), np.cos(half)
    step = np.array([[0.0, 0.0, 0.0], [a, b, 0.0], [2 * a, 0.0, 0.0], [3 * a, b, 0.0]])
    phi = np.radians(7.0)       # not exactly flat
    turned = step.copy()
    turned[3] = [3 * a, b * np.cos(phi), b * np.sin(phi)]
    x = [tuple(np.array([i, j, k]) * [8.0, 7.0, 7.0] + 1.0 + r * p) for i in range(3) for j in range(3) for k in range(3) for p in turned]
    n = len(x)
    bonds = [(k, k + 1) for k in range(1, n) if k % 4]
    angles = [(k, k + 1, k + 2) for k in range(1, n - 1) if k % 4 in (1, 2)]
    dihedrals = [(k, k + 1, k + 2, k + 3) for k in range(1, n - 2) if k % 4 == 1]
    return _data(x, 24.0, 21.0, bonds=bonds, angles=angles, dihedrals=dihedrals, masses=[14.03], charges=[0.1, -0.1, 0.1, -0.1])


def _data(x, length: float, side: float, masses, charges=None, **items) -> str:
    lines = ["made for a test", "", f"{len(x)} atoms", "1 atom types"]
    for kind, found in items.items():
        lines += [f"{len(found)} {kind}", f"1 {kind[:-1]} types"]
    lines += [f"0 {length} xlo xhi", f"0 {side} ylo yhi", f"0 {side} zlo zhi", "", "Masses", ""]
    lines += [*(f"{k} {m}" for k, m in enumerate(masses, 1)), "", f"Atoms # {'full' if charges else 'bond'}", ""]
    for k, (a, b, c) in enumerate(x):
        q = f" {charges[k % len(charges)]}" if charges else ""
        lines.append(f"{k + 1} {k // (4 if charges else 10) + 1} 1{q} {a:.12g} {b:.12g} {c:.12g}")
    for kind, found in items.items():
        lines += ["", kind.capitalize(), "", *(f"{k} 1 {' '.join(map(str, item))}" for k, item in enumerate(found, 1))]
    return "\n".join(lines) + "\n"
