"""What compiled code sees of a running simulation. Atoms live in *slots*, sorted in space; empty slots pad the clusters."""
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np


class State(NamedTuple):
    """Slot arrays; `cap` slots are allocated, `ns` are in use."""

    x: np.ndarray             # (3, cap) positions, wrapped at the last list build
    v: np.ndarray             # (3, cap)
    f: np.ndarray             # (3, cap) total force
    row: np.ndarray           # (cap,) int32 atom row, -1 for an empty slot
    type: np.ndarray          # (cap,) int32
    mass: np.ndarray          # (cap,) 1 for an empty slot
    inverse_mass: np.ndarray  # (cap,) ftm2v / mass, 0 for an empty slot
    q: np.ndarray             # (cap,) charges, 0 if there are none
    mask: np.ndarray          # (cap,) int32 group bits, 0 for an empty slot


def aligned(shape: tuple[int, ...], kind: type = np.float64) -> np.ndarray:
    """Zeros that begin at a cache line: vectors of 64 bytes that straddle two lines cost twice as much."""
    count, size = math.prod(shape), np.dtype(kind).itemsize
    raw = np.zeros(count * size + 64, np.uint8)
    at = -raw.ctypes.data % 64
    return raw[at:at + count * size].view(kind).reshape(shape)


def empty_state(capacity: int) -> State:
    """Slots without atoms."""
    x, v, f = aligned((3, capacity)), aligned((3, capacity)), aligned((3, capacity))
    row, types, mask = np.full(capacity, -1, np.int32), np.zeros(capacity, np.int32), np.zeros(capacity, np.int32)
    return State(x, v, f, row, types, np.ones(capacity), np.zeros(capacity), np.zeros(capacity), mask)


class Thread(NamedTuple):
    """One thread's view of one timestep."""

    tid: int
    nth: int
    lo: int
    hi: int
    step: int
    begin: int
    end: int
    dt: float
    sync: np.ndarray          # (8,) int64 barrier counter and generation
    scratch: np.ndarray       # (nth, 8) float64


class Cell(NamedTuple):
    """The periodic cell as compiled code sees it, in the user's frame. A non-periodic direction has inverse length and inverse row zero."""

    vectors: np.ndarray          # (3, 3) rows a b c
    inverse: np.ndarray          # (3, 3), fractional = d @ inverse, columns of non-periodic directions are zero
    lengths: np.ndarray          # (3,) edge lengths along x y z (axis-aligned cells)
    inverse_lengths: np.ndarray  # (3,) their inverses, 0 if not periodic
    reduced: np.ndarray          # (3, 3) Minkowski-reduced vectors of the periodic directions, for closest images in skewed cells
    reduced_inverse: np.ndarray  # (3, 3)
    safe2: float                 # squared distance below which the rounded image is surely the closest


def cell_arrays(vectors: np.ndarray, periodic: np.ndarray) -> Cell:
    """`Cell` of three edge vectors (rows) and three flags; vectors of non-periodic directions may be anything non-degenerate."""
    vectors = np.ascontiguousarray(vectors, dtype=float)
    periodic = np.asarray(periodic, dtype=bool)
    inverse = np.linalg.inv(vectors)
    reduced = vectors.copy()
    if periodic.any() and np.count_nonzero(vectors - np.diag(np.diag(vectors))):
        from ase.geometry import minkowski_reduce
        reduced = np.ascontiguousarray(minkowski_reduce(vectors, periodic)[0])
    reduced_inverse, safe = np.zeros((3, 3)), np.inf
    if periodic.any():      # from the periodic vectors alone: the others may be tilted
        reduced_inverse[:, periodic] = np.linalg.pinv(reduced[periodic])
        safe = 0.5 / np.linalg.norm(reduced_inverse[:, periodic], axis=0).max()
    diagonal = np.diag(vectors).copy()
    with np.errstate(divide="ignore"):
        inverse_lengths = np.where(periodic & (diagonal != 0), 1.0 / diagonal, 0.0)
    return Cell(vectors, np.ascontiguousarray(inverse * periodic), diagonal, inverse_lengths, reduced,
                reduced_inverse, float(safe * safe))
