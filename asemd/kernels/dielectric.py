"""A solver of charges used for charges of which each stands in a medium of its own.

The solver's own kernel is called with charges divided by the dielectric constants, and forces are multiplied by these. Where energies are
wanted it is called again: with the charges themselves for the energy, and with the sum of both for the virial, which is that of the forces:
a product of the two, and so half of what the sum has more than both alone.
"""
from __future__ import annotations

from functools import cache

from asemd.kernels.generate import Builder

ENERGY = PER_ATOM = False
solver = None


def dielectric_field(f, q, epsilon, lo, hi, mean, charges, own, own_acc, own_energy, own_virial, scaled, plain, both, acc, energy, virial):
    """Slots lo..hi-1 of a thread. `scaled`, `plain`, `both`: the solver's arguments for the three sets of charges, in which `charges
    (3, cap)` stand for charges, `own (3, cap)` for forces, `own_acc (3, 8)`, `own_energy (3, cap)` and `own_virial (3, 6, cap)` for sums;
    `mean`: dielectric constant of the energy."""
    for i in range(lo, hi):
        charges[0, i] = q[i] / epsilon[i]
        charges[1, i] = q[i]
        charges[2, i] = charges[0, i] + q[i]
    own[:] = 0.0
    if ENERGY:
        own_acc[:] = 0.0
    if PER_ATOM:
        own_energy[:] = 0.0
        own_virial[:] = 0.0
    solver(*scaled)
    for d in range(3):
        for i in range(lo, hi):
            f[d, i] += epsilon[i] * own[d, i]
    if ENERGY:
        solver(*plain)
        solver(*both)
        acc[0] += own_acc[1, 0] / mean
        for k in range(2, 8):
            acc[k] += 0.5 * (own_acc[2, k] - own_acc[1, k] - own_acc[0, k])
    if PER_ATOM:
        for i in range(lo, hi):
            energy[i] += own_energy[1, i] / mean
            for k in range(6):
                virial[k, i] += 0.5 * (own_virial[2, k, i] - own_virial[1, k, i] - own_virial[0, k, i])


@cache
def around(kernel, level: int):
    """`dielectric_field` around the kernel of a solver; `level`: see `asemd.kspace.term.KSpaceTerm`."""
    plain = getattr(kernel, "py_func", kernel)
    b = Builder("charges in different media")
    b.line(f"from {plain.__module__} import {plain.__name__} as solver")
    b.constant("ENERGY", level > 0)
    b.constant("PER_ATOM", level > 1)
    b.function(dielectric_field)
    return b.build().dielectric_field
