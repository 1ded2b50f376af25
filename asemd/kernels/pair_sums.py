"""Energy and virial of pairs as eight numbers, in the order of a term's accumulators: vdwl coul xx yy zz xy xz yz.

Pasted into the pair kernels, where the compiler puts these small functions in place.
"""
from __future__ import annotations


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
