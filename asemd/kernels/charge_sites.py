"""Forces on charges that are not on atoms but on massless sites, each a fixed combination of three atoms.

The kernel of the pair style or solver works on other positions, ``seen``, in which the sites stand for their oxygen atoms, and on forces of
its own; what acts on a site is shared by its three atoms as their positions make it.
"""
from __future__ import annotations

from functools import cache

from asemd.kernels.generate import Builder
from asemd.kernels.hooks import takes_thread
from asemd.kernels.threads import barrier

forces_on_sites = None
THREAD = False          # whether it takes the `Thread`, too


def place(x, first, last, site_of, hydrogens, images, half, vectors, seen):
    """Positions of slots first..last-1, those of the sites in the place of their first atoms.

    ``site_of (cap,)`` is the number of the site or -1, ``hydrogens (m, 2)`` the slots of the other two atoms, ``images (m, 2, 3)`` the
    multiples of the box vectors that bring them to the first one, `half` the weight of each of their vectors.
    """
    for i in range(first, last):
        m = site_of[i]
        for d in range(3):
            seen[d, i] = x[d, i]
        if m >= 0:
            for d in range(3):
                out = 0.0
                for k in range(2):
                    shift = images[m, k, 0] * vectors[0, d] + images[m, k, 1] * vectors[1, d] + images[m, k, 2] * vectors[2, d]
                    out += x[d, hydrogens[m, k]] + shift - x[d, i]
                seen[d, i] += half * out


def share(f, own, oxygens, hydrogens, half):
    """Add to `f` the forces `own`, those on sites to their atoms."""
    for m in range(oxygens.shape[0]):
        i, a, b = oxygens[m], hydrogens[m, 0], hydrogens[m, 1]
        for d in range(3):
            part = half * own[d, i]
            own[d, i] -= 2.0 * part
            own[d, a] += part
            own[d, b] += part
    for d in range(3):
        whole, mine = f[d], own[d]
        for k in range(mine.shape[0]):
            whole[k] += mine[k]


def with_sites(th, meeting, tid, x, f, site_of, oxygens, hydrogens, images, half, vectors, seen, own, arguments):
    """What ``forces_on_sites(*arguments)`` adds to `own`, at the positions `seen`, comes to the atoms of `f`."""
    n = x.shape[1]
    place(x, n * tid // meeting.nth, n * (tid + 1) // meeting.nth, site_of, hydrogens, images, half, vectors, seen)
    own[:] = 0.0
    barrier(meeting)
    if THREAD:
        forces_on_sites(th, *arguments)
    else:
        forces_on_sites(*arguments)
    share(f, own, oxygens, hydrogens, half)


@cache
def on_sites(kernel):
    """The kernel that does what `kernel` does, for charges on sites."""
    plain = getattr(kernel, "py_func", kernel)
    b = Builder("charges on massless sites")
    b.line("from asemd.kernels.threads import barrier")
    b.line(f"from {plain.__module__} import {plain.__name__} as forces_on_sites")
    b.constant("THREAD", takes_thread(kernel))
    for f in (place, share, with_sites):
        b.function(f)
    return b.build().with_sites
