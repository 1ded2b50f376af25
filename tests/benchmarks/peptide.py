"""A data file like that of LAMMPS's ``examples/peptide``: a helix of twelve residues in 640 molecules of water, each with its own place.

Bonds, angles and torsions follow from who is bound to whom; their types are the names of their atoms, their resting values those of the
helix as it is built. For the bonded terms alone: charges are zero, molecules may overlap. With charges it is meant to be relaxed and
pressed into a smaller box first; atoms are then like those of common force fields for proteins and water.
"""
from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np

# atom, its predecessors (bond, angle, torsion; "-" in front: in the residue before), length, angle, torsion
RESIDUE = (("N", "-C -CA -N", 1.34, 116.0, -47.0), ("CA", "N -C -CA", 1.46, 122.0, 180.0), ("H", "N -C -CA", 1.0, 119.0, 0.0),
           ("C", "CA N -C", 1.53, 111.0, -57.0), ("CB", "CA N -C", 1.54, 110.0, 180.0), ("HA", "CA N -C", 1.08, 108.0, 62.0),
           ("O", "C CA N", 1.23, 121.0, 133.0))
MASS = {"C": 12.011, "H": 1.008, "N": 14.007, "O": 15.999}
BOX = 40.0
# charge; epsilon and sigma, those of 1-4 partners too
CHARGED = {"N": -0.47, "CA": 0.07, "H": 0.31, "C": 0.51, "CB": 0.0, "HA": 0.09, "O": -0.51, "OW": -0.834, "HW": 0.417}
LJ = {"N": "0.2 3.296 0.2 2.762", "CA": "0.02 4.054 0.01 3.385", "H": "0.046 0.4 0.046 0.4", "C": "0.11 3.564 0.11 3.564",
      "CB": "0.08 3.671 0.01 3.385", "HA": "0.022 2.352 0.022 2.352", "O": "0.12 3.029 0.12 2.495", "OW": "0.1521 3.1507 0.1521 3.1507",
      "HW": "0.046 0.4 0.046 0.4"}


def _next(a, b, c, length, angle, torsion):
    """The place at a distance from a, an angle to b and a torsion to c."""
    u = (a - b) / np.linalg.norm(a - b)
    n = np.cross(b - c, u)
    n /= np.linalg.norm(n)
    angle, torsion = np.radians((angle, torsion))
    return a - length * np.cos(angle) * u + length * np.sin(angle) * (np.cos(torsion) * np.cross(n, u) + np.sin(torsion) * n)


def helix(residues: int) -> tuple[list[str], np.ndarray, list]:
    """Names, places and bonds of a chain."""
    where = {"-N": np.array([0.0, 1.4, 0.0]), "-CA": np.zeros(3), "-C": np.array([1.5, 0.0, 0.0])}
    names, x, bonds, index = [], [], [], {}
    for _ in range(residues):
        for name, before, *internal in RESIDUE:
            a, b, c = before.split()
            where[name] = _next(where[a], where[b], where[c], *internal)
            if a in index:
                bonds.append((index[a], len(x)))
            index[name] = len(x)
            names.append(name)
            x.append(where[name])
        where = {f"-{n}": where[n] for n in ("N", "CA", "C")}
        index = {f"-{n}": index[n] for n in ("N", "CA", "C")}
    return names, np.array(x), bonds


def system(residues: int = 12, waters: int = 640):
    """Names, places, molecules, and the items of the four categories."""
    names, x, bonds = helix(residues)
    x, molecule = [*(x + BOX / 2 - x.mean(axis=0))], [1] * len(x)
    for k, place in enumerate(itertools.islice(np.ndindex(9, 9, 9), waters)):
        first = len(x)
        x += [o := (np.array(place) + 0.5) * BOX / 9, o + (0.97, 0.0, 0.0), o + (-0.24, 0.94, 0.0)]
        names, molecule = [*names, "OW", "HW", "HW"], molecule + [k + 2] * 3
        bonds += [(first, first + 1), (first, first + 2)]
    near = [[] for _ in x]
    for i, j in bonds:
        near[i].append(j)
        near[j].append(i)
    angles = [(i, j, k) for j, around in enumerate(near) for i, k in itertools.combinations(around, 2)]
    dihedrals = [(i, j, k, l) for j, k in bonds for i in near[j] if i != k for l in near[k] if l not in (j, i)]
    impropers = [(j, *around) for j, around in enumerate(near) if len(around) == 3 and names[j] in ("C", "N")]
    return names, np.array(x), molecule, {"Bond": bonds, "Angle": angles, "Dihedral": dihedrals, "Improper": impropers}


def coefficients(kind: str, x: np.ndarray) -> str:
    """A line for a type, at rest where an item of it is."""
    d = np.diff(x, axis=0)
    if kind == "Bond":
        return f"340.0 {np.linalg.norm(d[0]):.4f}"
    if kind == "Angle":
        cosine = -d[0] @ d[1] / np.linalg.norm(d[0]) / np.linalg.norm(d[1])
        return f"50.0 {np.degrees(np.arccos(cosine)):.3f} 10.0 {np.linalg.norm(x[2] - x[0]):.4f}"
    n, m = np.cross(d[0], d[1]), np.cross(d[1], d[2])
    torsion = np.degrees(np.arctan2(np.cross(n, m) @ d[1] / np.linalg.norm(d[1]), n @ m))
    return "0.2 3 180 {weight}" if kind == "Dihedral" else f"120.0 {abs(torsion):.3f}"


def write(path: Path, charged: bool = False) -> dict[str, list[int]]:
    """The data file; returns the types of bonds of hydrogen atoms and of angles of water, by category."""
    names, x, molecule, items = system()
    atom_types = sorted(set(names))
    head, body = [f"{len(x)} atoms", f"{len(atom_types)} atom types"], []
    body += ["Masses", "", *(f"{t} {MASS[n[0]]}" for t, n in enumerate(atom_types, 1)), ""]
    if charged:
        body += ["Pair Coeffs", "", *(f"{t} {LJ[n]}" for t, n in enumerate(atom_types, 1)), ""]
    body += ["Atoms # full", ""]
    rigid: dict[str, list[int]] = {}
    for i, (name, m, place) in enumerate(zip(names, molecule, x), 1):
        body.append(f"{i} {m} {atom_types.index(name) + 1} {CHARGED[name] if charged else 0.0} " + " ".join(f"{p:.6f}" for p in place))
    for kind, found in items.items():
        labels = [min(words, words[::-1]) for words in (tuple(names[i] for i in item) for item in found)]
        example = {label: item for label, item in zip(labels[::-1], found[::-1])}
        types = {label: t for t, label in enumerate(sorted(example), 1)}
        head += [f"{len(found)} {kind.lower()}s", f"{len(types)} {kind.lower()} types"]
        body += ["", f"{kind} Coeffs", "", *(f"{t} {coefficients(kind, x[list(example[label])])}".format(weight=float(charged))
                                               for label, t in types.items())]
        rigid[kind] = [t for label, t in types.items() if {"Bond": "H" in (label[0][0], label[1][0]), "Angle": label[1] == "OW"}.get(kind)]
        body += ["", f"{kind}s", ""]
        body += [f"{n} {types[label]} " + " ".join(str(i + 1) for i in item) for n, (label, item) in enumerate(zip(labels, found), 1)]
    head += [f"0.0 {BOX} {d}lo {d}hi" for d in "xyz"]
    path.write_text("\n".join(["helix in water", "", *head, "", *body]) + "\n")
    return {"b": rigid["Bond"], "a": rigid["Angle"]}
