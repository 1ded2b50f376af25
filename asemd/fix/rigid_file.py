"""Files of rigid bodies: read by the keyword ``infile``, and written beside restart files by fixes that have this keyword.

A line with the number of bodies, then one line for each: its ID, mass, centre of mass, moments of inertia xx yy zz xy xz yz about it,
velocity, angular momentum and image flags. IDs are molecule IDs where molecules are bodies, else numbers from 1. Bodies that are not in the
file are made of their atoms.

Source: LAMMPS manual, fix rigid.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError, Where
from asemd.fix.rigid_bodies import Members, follow
from asemd.kernels.rigid import Bodies
from asemd.words import number, whole

COLUMNS = "ID mass x y z ixx iyy izz ixy ixz iyz vx vy vz lx ly lz ix iy iz"
CLOSE = 1e-9        # bodies of a file that differ by less from those of a run are the same


def read(path: str, style: str, labels: np.ndarray) -> dict[int, np.ndarray]:
    """ID -> the 19 numbers of a body; `labels` are the IDs that there are.

    Raises
    ------
    InputError
        A file that is not of this form, an ID that is no body's or comes twice, a mass or moments that no body can have.
    """
    what = f"fix {style} infile"
    try:
        with open(path) as file:
            lines = [(Where(path, k, line), line.split("#")[0].split()) for k, line in enumerate(file, 1)]
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{what}: cannot read {path}: {getattr(error, 'strerror', '') or 'it is no text'}") from None
    lines = [(where, words) for where, words in lines if words]
    if not lines:
        raise InputError(f"{what}: {path} is empty, its first line is the number of bodies")
    where, words = lines[0]
    if len(words) != 1 or not words[0].isdigit():
        raise InputError(f"{what}: expected the number of bodies", where)
    count, out = int(words[0]), {}
    if len(lines) - 1 < count:
        raise InputError(f"{what}: {count} bodies are announced and {len(lines) - 1} follow", where)
    known = set(labels.tolist())
    for where, words in lines[1:1 + count]:
        try:
            label, values = _body(words, what)
            if label not in known:
                raise InputError(f"{what}: there is no rigid body with ID {label}")
            if label in out:
                raise InputError(f"{what}: body {label} comes twice")
        except InputError as error:
            raise error.at(where) from None
        out[label] = values
    return out


def _body(words: list[str], what: str) -> tuple[int, np.ndarray]:
    """ID and numbers of one line."""
    if len(words) != 20:
        raise InputError(f"{what}: expected 20 values ({COLUMNS}), got {len(words)}")
    label, images = whole(words[0], what), [whole(w, what) for w in words[17:]]
    values = np.array([*(number(w, what) for w in words[1:17]), *images])
    if not values[0] > 0.0:
        raise InputError(f"{what}: the mass of body {label} must be positive, got {values[0]:g}")
    xx, yy, zz, xy, xz, yz = values[4:10]
    least = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if least[0] < -1e-7 * abs(least).max():
        raise InputError(f"{what}: body {label} has a negative principal moment of inertia, {least[0]:g}")
    return label, values


def inertia(b: Bodies) -> np.ndarray:
    """(nb, 3, 3) moments of inertia of the bodies about the axes of space."""
    return np.einsum("nka,nk,nkb->nab", b.axes, b.moments, b.axes)


def write(path: str, b: Bodies, members: Members, title: str) -> None:
    """Write the bodies with all their digits; `title` is a comment."""
    tensors, lines = inertia(b), [f"# {title}", f"# {COLUMNS}", "", str(members.count)]
    for k, label in enumerate(members.label):
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = tensors[k]
        values = [b.mass[k], *b.x[k], xx, yy, zz, xy, xz, yz, *b.v[k], *b.momentum[k]]
        lines.append(" ".join([str(label), *(f"{value:.16e}" for value in values), *(str(int(i)) for i in b.image[k])]))
    try:
        with open(path, "w") as file:
            file.write("\n".join(lines) + "\n")
    except OSError as error:
        raise InputError(f"cannot write the file of rigid bodies {path}: {error.strerror}") from None


def same(a: Bodies, b: Bodies) -> bool:
    """Whether the bodies `a` are the bodies `b`, but for rounding and a box that has changed."""
    if len(a.mass) != len(b.mass):
        return False
    b = Bodies(*(array.copy() for array in b))
    if len(a.mass):
        follow(b, a.box[0, :3], a.box[0, 3:].reshape(3, 3))
    pairs = [(getattr(a, name), getattr(b, name)) for name in ("mass", "x", "v", "momentum", "image")] + [(inertia(a), inertia(b))]
    return all(abs(p - q).max(initial=0.0) <= CLOSE * abs(q).max(initial=0.0) for p, q in pairs)
