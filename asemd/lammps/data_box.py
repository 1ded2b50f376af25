"""General triclinic boxes of data files: header lines avec, bvec, cvec, abc origin."""
from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from asemd.box import Box
from asemd.errors import InputError

VECTORS = ("avec", "bvec", "cvec")
OTHERS = ("xlo xhi", "ylo yhi", "zlo zhi", "xy xz yz")


def is_general(header: Mapping[str, object]) -> bool:
    """Whether the header speaks of box vectors."""
    return any(word in header for word in (*VECTORS, "abc origin"))


def general_box(header: Mapping[str, list[float]], boundary, dimension: int, shift: np.ndarray) -> tuple[Box, np.ndarray]:
    """The box in LAMMPS's frame, and the rotation into it.

    Raises
    ------
    InputError
        A missing vector, bounds besides, a left-handed box, vectors that do not fit two dimensions.
    """
    if not all(word in header for word in VECTORS):
        raise InputError("the header needs all of avec, bvec, cvec")
    if any(word in header for word in OTHERS):
        raise InputError("the header cannot have both lo, hi, tilt and the vectors avec, bvec, cvec of a box")
    origin = np.array(header.get("abc origin", [0.0, 0.0, 0.0 if dimension == 3 else -0.5]), float)
    cell = np.array([header[word] for word in VECTORS])
    if dimension == 2 and (cell[2].tolist() != [0.0, 0.0, 1.0] or origin[2] != -0.5):
        raise InputError("a general triclinic box in 2d needs cvec 0 0 1 and -0.5 as third number of abc origin")
    if dimension == 2 and cell[:2, 2].any():
        raise InputError("avec and bvec of a 2d system must lie in the plane")
    if np.linalg.det(cell) < 0.0:
        raise InputError("avec, bvec, cvec must be right-handed")
    return Box(origin + shift, cell, boundary).turned()


def same_frame(a: np.ndarray | None, b: np.ndarray | None) -> bool:
    """Whether atoms of boxes with these rotations can be put together."""
    return a is b or (a is not None and b is not None and np.allclose(a, b, rtol=0.0, atol=1e-12))
