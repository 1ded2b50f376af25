"""A box that changes while the loop runs: what follows from its vectors, and how far its corners have moved since the list was built."""
from __future__ import annotations

import math

import numpy as np


def follow(box):
    """After ``box.vectors`` were changed: inverse, lengths, reduced vectors and image shifts, in place. One thread calls it."""
    v, c = box.vectors, box.cell
    volume = (v[0, 0] * (v[1, 1] * v[2, 2] - v[1, 2] * v[2, 1]) - v[0, 1] * (v[1, 0] * v[2, 2] - v[1, 2] * v[2, 0])
              + v[0, 2] * (v[1, 0] * v[2, 1] - v[1, 1] * v[2, 0]))
    r, m = c.reduced, box.reduction
    for i in range(3):
        c.lengths[i] = v[i, i]
        c.inverse_lengths[i] = 1.0 / v[i, i] if c.inverse_lengths[i] != 0.0 else 0.0
        j, k = (i + 1) % 3, (i + 2) % 3
        for d in range(3):      # columns of the inverse are cross products of the other two vectors
            e, f = (d + 1) % 3, (d + 2) % 3
            c.inverse[d, i] = box.periodic[i] * (v[j, e] * v[k, f] - v[j, f] * v[k, e]) / volume
            r[i, d] = m[i, 0] * v[0, d] + m[i, 1] * v[1, d] + m[i, 2] * v[2, d]
    largest = 0.0
    if box.periodic[0] * box.periodic[1] * box.periodic[2] != 0.0:
        volume = (r[0, 0] * (r[1, 1] * r[2, 2] - r[1, 2] * r[2, 1]) - r[0, 1] * (r[1, 0] * r[2, 2] - r[1, 2] * r[2, 0])
                  + r[0, 2] * (r[1, 0] * r[2, 1] - r[1, 1] * r[2, 0]))
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            length = 0.0
            for d in range(3):
                e, f = (d + 1) % 3, (d + 2) % 3
                c.reduced_inverse[d, i] = (r[j, e] * r[k, f] - r[j, f] * r[k, e]) / volume
                length += c.reduced_inverse[d, i] ** 2
            largest = max(largest, length)
    else:       # the periodic vectors alone: rows of the pseudo-inverse by Gram-Schmidt against the other periodic vector
        for i in range(3):
            if box.periodic[i] == 0.0:
                continue
            j = (i + 1) % 3 if box.periodic[(i + 1) % 3] != 0.0 else (i + 2) % 3
            along = (r[i, 0] * r[j, 0] + r[i, 1] * r[j, 1] + r[i, 2] * r[j, 2]) * box.periodic[j]
            along /= r[j, 0] ** 2 + r[j, 1] ** 2 + r[j, 2] ** 2
            p, q, s = r[i, 0] - along * r[j, 0], r[i, 1] - along * r[j, 1], r[i, 2] - along * r[j, 2]
            square = p * p + q * q + s * s
            c.reduced_inverse[0, i], c.reduced_inverse[1, i], c.reduced_inverse[2, i] = p / square, q / square, s / square
            largest = max(largest, 1.0 / square)
    if largest > 0.0:
        c.safe2[0] = 0.25 / largest
    for k in range(box.images.shape[0]):
        for d in range(3):
            box.shifts[k, d] = box.images[k, 0] * v[0, d] + box.images[k, 1] * v[1, d] + box.images[k, 2] * v[2, d]
    for k in range(box.shifts4.shape[0]):
        for d in range(3):
            box.shifts4[k, d] = box.shifts[k, d]
    for k in range(box.close_images.shape[0]):
        for d in range(3):
            box.close_shifts[k, d] = box.close_images[k, 0] * r[0, d] + box.close_images[k, 1] * r[1, d] + box.close_images[k, 2] * r[2, d]


def corner_moves(box):
    """The two largest distances, added, that corners of the box have moved since the list was built.

    Of a box that is not triclinic the distances of the lowest and the highest corner.
    This is LAMMPS's way, to the last bit, which decides when a list is built: a corner that sets a new record makes it forget the last one.
    """
    first, second, v, h, triclinic = 0.0, 0.0, box.vectors, box.held, box.triclinic[0] != 0.0
    for n in range(8):
        a, b, c = n & 1, (n >> 1) & 1, (n >> 2) & 1
        square = 0.0
        for d in range(3):
            now = v[0, d] * a + v[1, d] * b + v[2, d] * c + box.origin[d]
            move = now - (h[1, d] * a + h[2, d] * b + h[3, d] * c + h[0, d])
            square += move * move
        length = math.sqrt(square)
        if not triclinic:
            second += length if n == 0 or n == 7 else 0.0
        elif length > first:
            first = length
        elif length > second:
            second = length
    return first + second


def changed(state, vectors: np.ndarray, origin: np.ndarray) -> None:
    """Another box for a `State`, from Python: positions stay where they are."""
    state.box.vectors[:], state.box.origin[:] = vectors, origin
    follow(state.box)


follow.strict = corner_moves.strict = True       # the last bit decides when a list is built
