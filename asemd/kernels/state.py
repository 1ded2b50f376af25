"""What compiled code sees of a running simulation. Atoms live in *slots*, sorted in space; empty slots pad the clusters."""
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np


class Cell(NamedTuple):
    """The periodic cell as compiled code sees it, in the user's frame. A non-periodic direction has inverse length and inverse row zero."""

    vectors: np.ndarray          # (3, 3) rows a b c
    inverse: np.ndarray          # (3, 3), fractional = d @ inverse, columns of non-periodic directions are zero
    lengths: np.ndarray          # (3,) edge lengths along x y z (axis-aligned cells)
    inverse_lengths: np.ndarray  # (3,) their inverses, 0 if not periodic
    reduced: np.ndarray          # (3, 3) Minkowski-reduced vectors of the periodic directions, for closest images in skewed cells
    reduced_inverse: np.ndarray  # (3, 3)
    safe2: np.ndarray            # (1,) squared distance below which the rounded image is surely the closest


class BoxState(NamedTuple):
    """The box of a running simulation. A fix that changes it writes `vectors` and `origin`, then `asemd.kernels.box.follow`."""

    vectors: np.ndarray       # (3, 3) rows a b c; the array of `cell`, too
    origin: np.ndarray        # (3,)
    periodic: np.ndarray      # (3,) 1 or 0
    cell: Cell
    reduction: np.ndarray     # (3, 3) whole numbers: ``reduction @ vectors`` are the reduced vectors
    images: np.ndarray        # (m, 3) whole numbers: the images of the neighbour list
    shifts: np.ndarray        # (m, 3) ``images @ vectors``
    shifts4: np.ndarray       # (m, 4) the same with a column of zeros; (0, 4) where no kernel takes it
    close_images: np.ndarray      # (m, 3) whole numbers: the images of special pairs
    close_shifts: np.ndarray      # (m, 3) ``close_images @ reduced``
    held: np.ndarray          # (4, 3) origin and vectors when the list was built
    triclinic: np.ndarray     # (1,) 1 or 0


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
    slot: np.ndarray          # (n,) int32 the slot of each atom row
    image: np.ndarray         # (n, 3) int32 image flags by atom row; ``x + image @ box.vectors`` is the unwrapped position
    acc: np.ndarray           # (nth, terms, 8) energies and virials of the terms, on steps that compute them: e e xx yy zz xy xz yz
    virial: np.ndarray        # (nth, 6) what fixes add to the virial of this step: xx yy zz xy xz yz
    torque: np.ndarray        # (3, cap) total torque; (0, cap) where atoms neither turn nor have dipoles
    box: BoxState


def aligned(shape: tuple[int, ...], kind: type = np.float64) -> np.ndarray:
    """Zeros that begin at a cache line: vectors of 64 bytes that straddle two lines cost twice as much."""
    count, size = math.prod(shape), np.dtype(kind).itemsize
    raw = np.zeros(count * size + 64, np.uint8)
    at = -raw.ctypes.data % 64
    return raw[at:at + count * size].view(kind).reshape(shape)


def empty_state(capacity: int, slot: np.ndarray, image: np.ndarray, acc: np.ndarray, box: BoxState) -> State:
    """Slots without atoms."""
    x, v, f = aligned((3, capacity)), aligned((3, capacity)), aligned((3, capacity))
    row, types, mask = np.full(capacity, -1, np.int32), np.zeros(capacity, np.int32), np.zeros(capacity, np.int32)
    return State(x, v, f, row, types, np.ones(capacity), np.zeros(capacity), np.zeros(capacity), mask, slot, image, acc,
                 np.zeros((len(acc), 6)), np.zeros((0, capacity)), box)


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
    level: int = 0            # what terms are asked for: forces, 1 energy and virial too, 2 the shares of atoms as well


class Meeting(NamedTuple):
    """Where the threads that compute one term meet: what `asemd.kernels.threads.barrier` takes inside a term's kernel."""

    nth: int
    sync: np.ndarray          # (8,) int64 barrier counter, of the terms alone


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
                reduced_inverse, np.array([safe * safe]))
