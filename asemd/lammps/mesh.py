"""Triangles of STL files, and points spread over them: ``create_atoms mesh``.

Sources: the LAMMPS manual page of ``create_atoms``; M. Roberts, Evenly distributing points in a triangle (2019), for quasi-random ones.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.words import number

# multiples of these numbers modulo 1 cover the unit square evenly; with as many digits as LAMMPS has
STEPS = (0.5698403, 0.7548777)
BINARY = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("flags", "<u2")])
HEADER = 84     # bytes before the triangles of a binary file
FACET = ("facet normal", "outer loop", "vertex", "vertex", "vertex", "endloop", "endfacet")


def read_stl(path: str) -> tuple[str, str, np.ndarray]:
    """Name, kind (text or binary) and triangles (n, 3, 3) of an STL file.

    Raises
    ------
    InputError
        No such file, or not an STL file; names the line of a text file.
    """
    try:
        with open(path, "rb") as f:
            raw = f.read()
    except OSError as e:
        raise InputError(f"create_atoms mesh: cannot open STL file {path}: {e.strerror}") from None
    size = int.from_bytes(raw[HEADER - 4:HEADER], "little")
    if len(raw) >= HEADER and len(raw) == HEADER + size * BINARY.itemsize:
        title = raw[:HEADER - 4].split(b"\0")[0].decode("latin-1").split()
        return " ".join(title), "binary", np.frombuffer(raw, BINARY, offset=HEADER)["corners"].astype(float)
    if not raw.lstrip().startswith(b"solid"):
        raise InputError(f"create_atoms mesh: {path} is no STL file, or it is truncated")
    return _text(path, raw.decode("utf-8", "replace"))


def _text(path: str, text: str) -> tuple[str, str, np.ndarray]:
    lines = [(k, line.split()) for k, line in enumerate(text.split("\n"), 1) if line.strip()]
    name, at, triangles = " ".join(lines[0][1][1:]), 1, []
    while at < len(lines) and lines[at][1][0] != "endsolid":
        corners = []
        for k, expected in enumerate(FACET):
            line, words = lines[at + k] if at + k < len(lines) else (len(text.split("\n")), [])
            count = 3 if expected in ("facet normal", "vertex") else 0
            form = expected.split()
            try:
                values = [number(w, "") for w in words[len(form):]]
            except InputError:
                values = []
            if words[:len(form)] != form or len(values) != count:
                wanted = f"{expected!r}{f' and {count} numbers' * (count > 0)}"
                raise InputError(f"create_atoms mesh: expected {wanted} in line {line} of {path}, "
                                 f"got {' '.join(words) or 'the end of the file'!r}")
            if expected == "vertex":
                corners.append(values)
        triangles.append(corners)
        at += len(FACET)
    return name, "text", np.array(triangles, float).reshape(-1, 3, 3)


def _apex(corners: np.ndarray, order: tuple[int, int, int]) -> int:
    """The corner across from the longest side; of equal ones the first in that order."""
    sides = corners[[2, 0, 1]] - corners[[1, 2, 0]]
    return max(order, key=(sides * sides).sum(axis=1).__getitem__)


def bisected(triangle: np.ndarray, threshold: float) -> tuple[list[np.ndarray], list[float]]:
    """Centres and radii of the parts of a triangle (3, 3), cut in half across their longest side until no radius exceeds the threshold.

    The radius of a part is the mean distance of its corners from its centre.
    """
    centres, radii, todo = [], [], [triangle]
    while todo:
        corners = todo.pop()
        centre = corners.sum(axis=0) / 3.0
        radius = float(np.sqrt(((corners - centre)**2).sum(axis=1)).sum() / 3.0)
        if radius <= threshold:
            centres.append(centre)
            radii.append(radius)
            continue
        apex = _apex(corners, (2, 0, 1))
        begin, end = (apex + 1) % 3, (apex + 2) % 3
        middle = 0.5 * (corners[begin] + corners[end])
        first, second = corners.copy(), corners.copy()
        first[begin], second[end] = middle, middle
        todo += [second, first]
    return centres, radii


def quasirandom(triangle: np.ndarray, density: float) -> tuple[np.ndarray, list[float]]:
    """As few points as give the density, spread evenly over a triangle (3, 3), and the radius of a disc of one share of its area."""
    apex = _apex(triangle, (0, 1, 2))
    corner, a, b = triangle[list(((0, 1, 2), (1, 0, 2), (2, 1, 0))[apex])]
    area = 0.5 * float(np.linalg.norm(np.cross(a - corner, b - corner)))
    count = int(np.ceil(density * area))
    u, v = (0.5 + np.outer(STEPS, np.arange(1, count + 1))) % 1.0
    outside = u + v > 1.0
    u, v = np.where(outside, 1.0 - u, u), np.where(outside, 1.0 - v, v)
    points = corner + u[:, None] * (a - corner) + v[:, None] * (b - corner)
    return points, [float(np.sqrt(area / (np.pi * max(1, count))))] * count
