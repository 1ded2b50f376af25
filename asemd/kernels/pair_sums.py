"""Energy and virial of pairs as eight numbers, in the order of a term's accumulators: vdwl coul xx yy zz xy xz yz; shares of both atoms.

Compiled once; the compiler puts these small functions in place in the kernels that call them.
"""
from __future__ import annotations

from functools import cache
from types import ModuleType

from asemd.kernels.generate import FAST, Builder, plain_source
from asemd.kernels.hooks import INNER


def eight(ev, ec, dx, dy, dz, fx, fy, fz):
    """Energies and virial of one pair: its vector d and the force f on its first atom."""
    return ev, ec, dx * fx, dy * fy, dz * fz, dx * fy, dx * fz, dy * fz


def plus(a, b):
    return a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3], a[4] + b[4], a[5] + b[5], a[6] + b[6], a[7] + b[7]


def add(acc, a):
    """Add to the accumulators of a term."""
    acc[0] += a[0]
    acc[1] += a[1]
    acc[2] += a[2]
    acc[3] += a[3]
    acc[4] += a[4]
    acc[5] += a[5]
    acc[6] += a[6]
    acc[7] += a[7]


def halve(atom_energy, atom_virial, i, j, e, dx, dy, dz, fx, fy, fz):
    """Half of a pair's energy and virial to each of its slots i and j: the vector d from j to i and the force f on i."""
    for s in (i, j):
        atom_energy[s] += 0.5 * e
        atom_virial[0, s] += 0.5 * dx * fx
        atom_virial[1, s] += 0.5 * dy * fy
        atom_virial[2, s] += 0.5 * dz * fz
        atom_virial[3, s] += 0.5 * dx * fy
        atom_virial[4, s] += 0.5 * dx * fz
        atom_virial[5, s] += 0.5 * dy * fz


@cache
def module(fast: bool) -> ModuleType:
    """These functions, compiled; `fast`: sums may be reordered."""
    b = Builder("sums over pairs")
    for f in (eight, plus, add, halve):
        b.text(plain_source(f), f"{INNER}, fastmath={FAST}" if fast else INNER)
    return b.build()


def use(b: Builder, *names: str, fast: bool = False) -> None:
    """Let a kernel call some of them."""
    for name in names:
        b.use(module(fast), name)
