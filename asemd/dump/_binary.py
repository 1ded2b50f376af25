"""Snapshots as LAMMPS's binary dump files have them, which its tool ``binary2txt`` turns into text."""
from __future__ import annotations

import struct

import numpy as np

MAGIC = {"atom": b"DUMPATOM", "custom": b"DUMPCUSTOM"}
FACES = "pfsm"


def head(style: str, step: int, n: int, box, bounds: np.ndarray, columns: list[str], units: str, time: float | None) -> bytes:
    """Everything before the numbers.

    Parameters
    ----------
    bounds : (6,), (9,) or (12,) float
        xlo xhi ylo yhi zlo zhi (of the box around a tilted box), and its tilt factors; of a general triclinic box its vectors and origin.
    units : str
        Written if not empty.
    time : float or None
        Written if not None.
    """
    magic, names = MAGIC[style], " ".join(columns).encode()
    faces = [FACES.index(c) for pair in box.boundary for c in pair]
    parts = [struct.pack("=q", -len(magic)), magic, struct.pack("=2i2q", 1, 2, step, n), struct.pack("=7i", len(bounds) // 3 - 2, *faces),
             struct.pack(f"={len(bounds)}d", *bounds), struct.pack("=2i", len(columns), len(units)), units.encode(),
             b"\0" if time is None else struct.pack("=bd", 1, time), struct.pack("=i", len(names)), names, struct.pack("=i", 1)]
    return b"".join(parts)


def body(columns: list[np.ndarray]) -> bytes:
    """All numbers, an atom after the other."""
    table = np.column_stack([np.asarray(c, float) for c in columns]) if columns else np.zeros((0, 0))
    return struct.pack("=i", table.size) + np.ascontiguousarray(table).tobytes()
