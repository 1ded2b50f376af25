"""What compiled code sees of a running simulation. Atoms live in *slots*, sorted in space; empty slots pad the clusters."""
from __future__ import annotations

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
