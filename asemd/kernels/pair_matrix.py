"""The sparse matrix of second derivatives of a sum over pairs, row by row.

The matrix of a pair by its vector d, from j to i, is K = ``a I + b d d^T``: K for both atoms with themselves, -K for one with the other.
Images of an atom with itself add nothing.
"""
from __future__ import annotations

from functools import cache

from asemd.kernels.generate import Builder


def arrange(i, j, start, place, order, column, pair):
    """Blocks off the diagonal by row, each row by column: two counting sorts. Returns how many places in the matrix they have.

    `i`, `j` (m,), `start` and `place` (n+1,); `order`, `column`, `pair` (2 m,): row r has the columns ``column[start[r]:start[r + 1]]``
    of the pairs ``pair[...]``, where columns may come twice.
    """
    n = start.shape[0] - 1
    for c in range(n + 1):
        start[c] = 0
    for p in range(i.shape[0]):
        if i[p] != j[p]:
            start[i[p] + 1] += 1
            start[j[p] + 1] += 1
    for c in range(n):
        start[c + 1] += start[c]
    for c in range(n):
        place[c] = start[c]
    for p in range(i.shape[0]):
        if i[p] != j[p]:
            order[place[j[p]]] = p
            place[j[p]] += 1
            order[place[i[p]]] = -1 - p
            place[i[p]] += 1
    for c in range(n):
        place[c] = start[c]
    for c in range(n):
        for k in range(start[c], start[c + 1]):
            p = order[k]
            r = i[p] if p >= 0 else j[-1 - p]
            column[place[r]] = c
            pair[place[r]] = p if p >= 0 else -1 - p
            place[r] += 1
    total = 0
    for r in range(n):
        for k in range(start[r], start[r + 1]):
            total += k == start[r] or column[k] != column[k - 1]
    return total


def fill(start, column, pair, d, a, b, first, columns, numbers):
    """Rows as `scipy.sparse.csr_matrix` has them, three to an atom: `first` (3 n + 1,), `columns` and `numbers` of the entries."""
    n = start.shape[0] - 1
    at = 0
    for r in range(n):
        blocks = 1
        for k in range(start[r], start[r + 1]):
            blocks += k == start[r] or column[k] != column[k - 1]
        width = 3 * blocks
        xx = yy = zz = xy = xz = yz = 0.0
        q = -3
        own = -1
        for k in range(start[r], start[r + 1]):
            c, p = column[k], pair[k]
            if k == start[r] or c != column[k - 1]:
                q += 3
                if own < 0 and c > r:
                    own = q
                    q += 3
                for u in range(3):
                    for v in range(3):
                        columns[at + u * width + q + v] = 3 * c + v
                        numbers[at + u * width + q + v] = 0.0
            x, y, z = d[p, 0], d[p, 1], d[p, 2]
            k0, k1, k2 = a[p] + b[p] * x * x, a[p] + b[p] * y * y, a[p] + b[p] * z * z
            k3, k4, k5 = b[p] * x * y, b[p] * x * z, b[p] * y * z
            xx += k0
            yy += k1
            zz += k2
            xy += k3
            xz += k4
            yz += k5
            to = at + q
            numbers[to] -= k0
            numbers[to + 1] -= k3
            numbers[to + 2] -= k4
            to += width
            numbers[to] -= k3
            numbers[to + 1] -= k1
            numbers[to + 2] -= k5
            to += width
            numbers[to] -= k4
            numbers[to + 1] -= k5
            numbers[to + 2] -= k2
        if own < 0:
            own = q + 3
        for u in range(3):
            first[3 * r + u] = at + u * width
            for v in range(3):
                columns[at + u * width + own + v] = 3 * r + v
        to = at + own
        numbers[to], numbers[to + 1], numbers[to + 2] = xx, xy, xz
        to += width
        numbers[to], numbers[to + 1], numbers[to + 2] = xy, yy, yz
        to += width
        numbers[to], numbers[to + 1], numbers[to + 2] = xz, yz, zz
        at += 3 * width
    first[3 * n] = at


@cache
def module():
    """The compiled functions."""
    b = Builder("second derivatives of pairs")
    for f in (arrange, fill):
        b.function(f)
    return b.build()
