"""Water and ethanol in a periodic box: clusters of every kind for constraints; a script that asemd and LAMMPS both run."""
from __future__ import annotations

import numpy as np

LENGTH = 15.0
WATER = (np.array([[0, 0, 0], [0.98, 0.02, 0], [-0.27, 0.95, 0.01]]), [1, 2, 2], [(0, 1, 1), (0, 2, 1)], [(1, 0, 2, 1)],
         [-0.82, 0.41, 0.41])
ETHANOL = (np.array([[-1.2, -0.3, 0], [-1.2, -0.95, 0.87], [-1.2, -0.92, -0.9], [-2.1, 0.3, 0], [0.05, 0.55, 0], [0.1, 1.2, 0.88],
                     [0.1, 1.2, -0.9], [1.2, -0.2, 0], [2.0, 0.3, 0]]), [3, 2, 2, 2, 3, 2, 2, 1, 2],
           [(0, 1, 2), (0, 2, 2), (0, 3, 2), (0, 4, 3), (4, 5, 2), (4, 6, 2), (4, 7, 3), (7, 8, 4)],
           [(1, 0, 2, 2), (1, 0, 3, 2), (2, 0, 3, 2), (5, 4, 6, 2), (0, 4, 7, 3), (4, 7, 8, 3)],
           [-0.2, 0.06, 0.06, 0.06, 0.1, 0.06, 0.06, -0.6, 0.4])


def write_data(path, per_side: int = 3, ethanols: int = 6, length: float = LENGTH, offset: float = 0.5, tilt=()) -> None:
    """Molecules turned at random on a lattice, ids in no order, with velocities; with `offset` 0 some lie across faces of the box."""
    rng = np.random.default_rng(5)
    atoms, bonds, angles, n = [], [], [], 0
    sites = np.array([(i, j, k) for i in range(per_side) for j in range(per_side) for k in range(per_side)]) + offset
    for m, site in enumerate(sites * length / per_side, 1):
        x, types, pairs, triples, charges = ETHANOL if m % 4 == 0 and m // 4 <= ethanols else WATER
        q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        atoms += [(m, t, c, *(site + q @ y)) for t, c, y in zip(types, charges, x)]
        bonds += [(k, n + i, n + j) for i, j, k in pairs]
        angles += [(t, n + i, n + j, n + k) for i, j, k, t in triples]
        n += len(types)
    ids = rng.permutation(n) + 1
    v = rng.normal(0, 0.004, (n, 3))
    lines = ["water and ethanol", "", f"{n} atoms", f"{len(bonds)} bonds", f"{len(angles)} angles", "3 atom types", "4 bond types",
             "3 angle types", "", *(f"0 {length} {a}lo {a}hi" for a in "xyz"),
             *[" ".join(map(str, tilt)) + " xy xz yz"] * bool(tilt), "", "Masses", "", "1 15.9994", "2 1.008", "3 12.011", "",
             "Atoms # full", ""]
    lines += [f"{ids[i]} {m} {t} {c} {x:.15g} {y:.15g} {z:.15g}" for i, (m, t, c, x, y, z) in enumerate(atoms)]
    lines += ["", "Velocities", ""] + [f"{ids[i]} {v[i, 0]:.15g} {v[i, 1]:.15g} {v[i, 2]:.15g}" for i in range(n)]
    lines += ["", "Bonds", ""] + [f"{k + 1} {t} {ids[i]} {ids[j]}" for k, (t, i, j) in enumerate(bonds)]
    lines += ["", "Angles", ""] + [f"{k + 1} {t} {ids[i]} {ids[j]} {ids[m]}" for k, (t, i, j, m) in enumerate(angles)]
    path.write_text("\n".join(lines) + "\n")


SCRIPT = """
units real
atom_style full
atom_modify map array
pair_style lj/cut/coul/cut 5.2
bond_style harmonic
angle_style harmonic
read_data {data}
pair_coeff 1 1 0.1553 3.166
pair_coeff 2 2 0.02 1.5
pair_coeff 3 3 0.1 3.3
pair_modify shift yes
bond_coeff 1 450.0 1.0
bond_coeff 2 340.0 1.09
bond_coeff 3 310.0 1.5
bond_coeff 4 553.0 0.96
angle_coeff 1 55.0 109.47
angle_coeff 2 35.0 107.8
angle_coeff 3 50.0 109.5
special_bonds lj/coul 0 0 0.5
neighbor 1.0 bin
group water id {water}
thermo_style custom step temp pe ebond eangle etotal press pxx pyy pzz pxy pxz pyz
thermo_modify norm no
"""
VALUES = ("temp", "pe", "ebond", "eangle", "press", "pxx", "pyy", "pzz", "pxy", "pxz", "pyz")
ALL = "b 1 2 4 a 1"
NVE = "fix 1 all nve"

# text: LAMMPS's process runs it too
MEASURE = r'''
def measure(lmp, head, commands, runs, values):
    out = []
    for line in head.splitlines() + list(commands):
        if line.strip():
            lmp.command(line)
    for run in runs:
        lmp.command(run)
        arrays = [np.array(lmp.gather_atoms(name, 1, 3)).reshape(-1, 3) for name in ("x", "v", "f")]
        out.append([*arrays, np.array([lmp.get_thermo(name) for name in values])])
    return out
'''
ASK = MEASURE + '''
answer = {}
for name, (head, commands, runs, values) in given["cases"].items():
    lmp = start()
    answer[name] = measure(lmp, head, commands, runs, values)
    lmp.close()
'''


def head(data, water: str = "1:500") -> str:
    return SCRIPT.format(data=data, water=water)


def measure(*args, words=()):
    """What asemd makes of a case."""
    from asemd.lammps import Lammps
    scope: dict = {"np": np}
    exec(MEASURE, scope)
    lmp = Lammps(cmdargs=["-screen", "none", "-log", "none", *words])
    try:
        return scope["measure"](lmp, *args)
    finally:
        lmp.close()
