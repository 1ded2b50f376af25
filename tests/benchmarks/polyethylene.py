"""A data file of polyethylene: all-trans chains C40H82 in their orthorhombic crystal, 32,208 atoms by default."""
from __future__ import annotations

from pathlib import Path

import numpy as np

A, B, C = 7.48, 4.96, 2.547          # crystal axes, angstrom (Bunn 1939); two chains and two CH2 along C
BOND, HALF_CC, CH = 1.53, 0.4235, 1.09


def chain(carbons: int) -> tuple[np.ndarray, list[int], list[tuple[int, int]]]:
    """Places, types (1: C, 2: H) and bonds of one chain along z, its plane x z."""
    x, types, bonds, back = [], [], [], []
    for k in range(carbons):
        side = 1.0 if k % 2 else -1.0
        here = np.array([side * HALF_CC, 0.0, k * C / 2])
        back.append(len(x))
        x.append(here)
        types.append(1)
        hydrogens = [np.array([side * 0.58, s * 0.82, 0.0]) for s in (1.0, -1.0)]
        if k in (0, carbons - 1):
            hydrogens.append(np.array([-side * 0.45, 0.0, -0.9 if k == 0 else 0.9]))
        for h in hydrogens:
            bonds.append((back[-1], len(x)))
            x.append(here + CH * h / np.linalg.norm(h))
            types.append(2)
    return np.array(x), types, bonds + list(zip(back, back[1:]))


def write(path: Path, cells: tuple[int, int] = (11, 12), carbons: int = 40) -> None:
    """The data file, with bonds, angles and torsions; bond type 2 is C-H."""
    x, types, bonds = chain(carbons)
    near: list[list[int]] = [[] for _ in x]
    for i, j in bonds:
        near[i].append(j)
        near[j].append(i)
    angles = [(i, j, k) for j, around in enumerate(near) for n, i in enumerate(around) for k in around[n + 1:]]
    torsions = [(i, j, k, m) for j, k in bonds for i in near[j] if i != k for m in near[k] if m not in (i, j)]
    items = {"Bonds": (bonds, lambda i, j: 1 if types[i] == types[j] else 2),
             "Angles": (angles, lambda i, j, k: types[i] + types[k] - 1),
             "Dihedrals": (torsions, lambda i, j, k, m: types[i] + types[m] - 1)}
    atoms, lines = [], {name: [] for name in items}
    for cell in np.ndindex(*cells):
        for half, turn in ((0.0, 48.0), (0.5, -48.0)):
            cos, sin = np.cos(np.radians(turn)), np.sin(np.radians(turn))
            first, molecule = len(atoms), len(atoms) // len(x) + 1
            place = x @ np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])
            place += ((cell[0] + half + 0.25) * A, (cell[1] + half + 0.25) * B, 2.0)
            atoms += [f"{first + i} {molecule} {t} {a:.6f} {b:.6f} {c:.6f}" for i, (t, (a, b, c)) in enumerate(zip(types, place), 1)]
            for name, (found, kind) in items.items():
                lines[name] += [f"{len(lines[name]) + n + 1} {kind(*item)} " + " ".join(str(first + i + 1) for i in item)
                                for n, item in enumerate(found)]
    length = carbons * C / 2 + 4.0
    head = [f"{len(atoms)} atoms", *(f"{len(found)} {name.lower()}" for name, found in lines.items()), "2 atom types", "2 bond types",
            "3 angle types", "3 dihedral types", f"0.0 {cells[0] * A} xlo xhi", f"0.0 {cells[1] * B} ylo yhi", f"0.0 {length} zlo zhi"]
    body = ["Masses", "", "1 12.011", "2 1.008", "", "Atoms # molecular", "", *atoms]
    for name, found in lines.items():
        body += ["", name, "", *found]
    path.write_text("\n".join(["polyethylene", "", *head, "", *body]) + "\n")
