"""Section Ellipsoids of data files: diameters and orientations of the atoms whose flag in section Atoms is 1."""
from __future__ import annotations

import numpy as np

from asemd.atom_style import SHAPE, TURN, UPRIGHT
from asemd.quaternion import unit


def read_ellipsoids(reader, atoms: dict[str, np.ndarray], order: np.ndarray, where) -> dict[str, np.ndarray]:
    """Columns of shape and orientation (n,) for atoms as the file has them; points have shape 0.

    Parameters
    ----------
    reader : asemd.lammps.data._Reader
    atoms : dict
        Columns of section Atoms.
    order : (n,) int
        The atoms in order of id.
    where : callable
        Row of section Atoms -> line.

    Raises
    ------
    InputError
        Flags and lines that do not fit together, a shape or orientation that cannot be; names the line.
    """
    flag, n = atoms["ellipsoid"], len(order)
    wrong = (flag != 0) & (flag != 1)
    if wrong.any():
        row = int(np.argmax(wrong))
        raise reader.fail(f"Atoms section: the ellipsoid flag of atom {atoms['id'][row]:.0f} must be 0 or 1, got {flag[row]}", where(row))
    values = np.tile(np.concatenate([np.zeros(3), UPRIGHT]), (n, 1))
    found = np.zeros(n, bool)
    if "Ellipsoids" in reader.sections and (reader.number("ellipsoids") or reader.content(reader.sections["Ellipsoids"])):
        a, line = reader.table("Ellipsoids", ("id", *SHAPE, *TURN), reader.number("ellipsoids"))
        rows = order[reader.rows("Ellipsoids", a["id"][:, None], atoms["id"][order], line)[:, 0]]
        for k, row in enumerate(rows):
            if found[row]:
                raise reader.fail(f"Ellipsoids section: atom ID {atoms['id'][row]:.0f} appears twice", line(k))
            found[row] = True
        shape, turn = np.column_stack([a[c] for c in SHAPE]), np.column_stack([a[c] for c in TURN])
        for bad, message in ((flag[rows] == 0, "atom {} is a point: its ellipsoid flag in section Atoms is 0"),
                             ((shape <= 0.0).any(axis=1), "the diameters of atom {} must be positive"),
                             (~turn.any(axis=1), "the quaternion of atom {} must not be zero")):
            if bad.any():
                k = int(np.argmax(bad))
                raise reader.fail("Ellipsoids section: " + message.format(int(a["id"][k])), line(k))
        values[rows] = np.hstack([shape, unit(turn)])
    if (lost := (flag == 1) & ~found).any():
        row = int(np.argmax(lost))
        raise reader.fail(f"atom {atoms['id'][row]:.0f} is an ellipsoid, but section Ellipsoids has no line for it", where(row))
    return dict(zip((*SHAPE, *TURN), values.T))
