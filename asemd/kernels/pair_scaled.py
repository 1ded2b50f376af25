"""Pair forces times a factor that may change from step to step.

The kernel of the style works on arrays of its own; what it found is added, times the factor, when it is done: a pass over the atoms, and
nothing in the loop over pairs. The constant ENERGY of the generated module is that of the kernel.
"""
from __future__ import annotations

from functools import cache

from asemd.kernels.generate import Builder

ENERGY = False
pair_forces = None


def scaled_forces(f, acc, factor, own, own_acc, arguments):
    """`f (3, cap)` and `acc (8,)` get ``factor[0]`` times what ``pair_forces(*arguments)`` adds to `own` and `own_acc`."""
    own[:] = 0.0
    own_acc[:] = 0.0
    pair_forces(*arguments)
    for d in range(3):
        whole, part = f[d], own[d]
        for k in range(part.shape[0]):
            whole[k] += factor[0] * part[k]
    if ENERGY:
        for k in range(8):
            acc[k] += factor[0] * own_acc[k]


@cache
def scaled(kernel, energy: bool):
    """The kernel that does what `kernel` does, times a factor."""
    plain = getattr(kernel, "py_func", kernel)
    b = Builder("pair forces times a factor")
    b.line(f"from {plain.__module__} import {plain.__name__} as pair_forces")
    b.constant("ENERGY", energy)
    b.function(scaled_forces, fast=True)
    return b.build().scaled_forces
