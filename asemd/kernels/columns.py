"""Columns of the neighbour list: how they are numbered, and which are near.

Atoms are stored column by column. Columns are counted in strips, `STRIP` of them beside each other, along the first cell vector, and then
the next strip: so atoms that are near each other are near in memory in large systems too (`docs/decisions/0018-strips-of-columns.md`).
Ordinary Python functions, which `asemd.neighbor` pastes and compiles.
"""
from __future__ import annotations

STRIP = 8


def column(a, b, nx, ny):
    """The number of a column: that in row `a` along the first cell vector and `b` along the second."""
    strip = b // STRIP
    return strip * STRIP * nx + a * min(STRIP, ny - strip * STRIP) + b - strip * STRIP


def stands(c, nx, ny):
    """Where the column with the number `c` stands: a and b of `column`."""
    strip = c // (STRIP * nx)
    within = c - strip * STRIP * nx
    across = min(STRIP, ny - strip * STRIP)
    return within // across, strip * STRIP + within % across


def near_columns(c, n, r, low, high, width, reach, periodic, index, image, gap2):
    """Columns within `reach` of the stretch low..high (fractional) along one direction: number, image and squared gap of each.

    Returns how many.
    """
    m = 0
    step = 1.0 / n
    for d in range(-r, r + 1):
        i = c + d
        s = 0
        if i < 0:
            i += n
            s = -1
        elif i >= n:
            i -= n
            s = 1
        if (s != 0 and not periodic) or i < 0 or i >= n:
            continue
        left = (c + d) * step
        gap = max(left - high, max(low - (left + step), 0.0)) * width
        if gap < reach:
            index[m] = i
            image[m] = s
            gap2[m] = gap * gap
            m += 1
    return m
