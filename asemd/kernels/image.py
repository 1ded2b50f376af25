"""The closest periodic image of difference vectors, for cells along the axes and for cells of any shape."""
from __future__ import annotations

import numpy as np

from asemd.kernels.algebra import minus, product, store, triple

V1 = VECTORS = 0


def closest_orthogonal(dx, dy, dz, cell):
    """Closest image in a cell whose vectors lie along x, y and z; directions that are not periodic have inverse length 0."""
    length, inverse = cell.lengths, cell.inverse_lengths
    return (dx - length[0] * np.rint(dx * inverse[0]),
            dy - length[1] * np.rint(dy * inverse[1]),
            dz - length[2] * np.rint(dz * inverse[2]))


def closest_general(dx, dy, dz, cell):
    """Closest image in any cell: rounding in the reduced cell is right for short vectors, the neighbours decide for long ones."""
    a, inverse = cell.reduced, cell.reduced_inverse
    na = np.rint(dx * inverse[0, 0] + dy * inverse[1, 0] + dz * inverse[2, 0])
    nb = np.rint(dx * inverse[0, 1] + dy * inverse[1, 1] + dz * inverse[2, 1])
    nc = np.rint(dx * inverse[0, 2] + dy * inverse[1, 2] + dz * inverse[2, 2])
    dx -= na * a[0, 0] + nb * a[1, 0] + nc * a[2, 0]
    dy -= na * a[0, 1] + nb * a[1, 1] + nc * a[2, 1]
    dz -= na * a[0, 2] + nb * a[1, 2] + nc * a[2, 2]
    best = dx * dx + dy * dy + dz * dz
    if best <= cell.safe2[0]:
        return dx, dy, dz
    pa = 1 if inverse[0, 0] != 0.0 or inverse[1, 0] != 0.0 or inverse[2, 0] != 0.0 else 0
    pb = 1 if inverse[0, 1] != 0.0 or inverse[1, 1] != 0.0 or inverse[2, 1] != 0.0 else 0
    pc = 1 if inverse[0, 2] != 0.0 or inverse[1, 2] != 0.0 or inverse[2, 2] != 0.0 else 0
    bx, by, bz = dx, dy, dz
    for i in range(-pa, pa + 1):
        for j in range(-pb, pb + 1):
            for k in range(-pc, pc + 1):
                ex = dx + (i * a[0, 0] + j * a[1, 0] + k * a[2, 0])
                ey = dy + (i * a[0, 1] + j * a[1, 1] + k * a[2, 1])
                ez = dz + (i * a[0, 2] + j * a[1, 2] + k * a[2, 2])
                e2 = ex * ex + ey * ey + ez * ez
                if e2 < best:
                    best, bx, by, bz = e2, ex, ey, ez
    return bx, by, bz


def sides_orthogonal(cell):
    """What `from_block_orthogonal` needs of a cell."""
    return ((cell.lengths[0], cell.lengths[1], cell.lengths[2]),
            (cell.inverse_lengths[0], cell.inverse_lengths[1], cell.inverse_lengths[2]))


def from_block_orthogonal(b, row, k, sides):
    """A vector of a block (`asemd.kernels.block`), made the closest image as by `closest_orthogonal`."""
    d, length, inverse = triple(b, row, k), sides[0], sides[1]
    s = product(d, inverse)
    d = minus(d, product(length, (np.rint(s[0]), np.rint(s[1]), np.rint(s[2]))))
    store(b, row, k, d)
    return d


def sides_any(cell):
    """Nothing: images are found before, or not at all."""
    return 0


def from_block(b, row, k, sides):
    """A vector of a block as it is."""
    return triple(b, row, k)


def block_general(b, n, cell):
    """`closest_general` for the vectors of a block."""
    for c in range(VECTORS):
        for k in range(n):
            d = triple(b, V1 + 3 * c, k)
            store(b, V1 + 3 * c, k, closest_general(d[0], d[1], d[2], cell))
