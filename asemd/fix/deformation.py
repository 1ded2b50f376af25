"""The box of fix deform as a function of the step: compiled within the time loop, plain Python where formulas are asked.

Dimensions are numbered 0 x, 1 y, 2 z, 3 yz, 4 xz, 5 xy. The numbers ``p`` of the fix: 0 group bit, 1 whether positions follow, 3:9 rates
of the six lengths and tilts, 9:12 rates of the lower faces, 12:15 new lower and 15:18 new upper faces, 18:21 new tilts (yz xz xy), 21:30
the inverse of the old box, 30:33 its origin. From 34 on 13 numbers for each dimension: kind, start (lower face or tilt), start (upper
face), end (twice), rate or amplitude, period, first volume, how a volume is kept and by which two dimensions, change and rate by variables.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.kernels.target import njit

NONE, LINEAR, TRUE, VOLUME, WIGGLE, VARIABLE = range(6)
ROWS, WIDTH = 34, 13


def new_box(step, begin, end, dt, p, vectors, origin):
    """Faces and tilts of this step into ``p[12:21]``, rates into ``p[3:12]``."""
    done = 0.0
    if step != begin and end != begin:
        done = (step - begin) / (end - begin)
    time = (step - begin) * dt
    for i in range(3):
        r = p[34 + 13 * i:47 + 13 * i]
        kind = int(r[0])
        half, middle = 0.5 * (r[2] - r[1]), 0.5 * (r[1] + r[2])
        if kind == 0:
            p[12 + i], p[15 + i] = origin[i], origin[i] + vectors[i, i]
        elif kind == 1:
            p[12 + i], p[15 + i] = r[1] + done * (r[3] - r[1]), r[2] + done * (r[4] - r[2])
        elif kind == 2:
            half *= math.exp(r[5] * time)
            p[12 + i], p[15 + i] = middle - half, middle + half
            p[3 + i] = r[5] * vectors[i, i]
            p[9 + i] = -0.5 * p[3 + i]
        elif kind == 4:
            angle = 2.0 * math.pi * time / r[6]
            p[12 + i], p[15 + i] = r[1] - 0.5 * r[5] * math.sin(angle), r[2] + 0.5 * r[5] * math.sin(angle)
            p[3 + i] = 2.0 * math.pi / r[6] * r[5] * math.cos(angle)
            p[9 + i] = -0.5 * p[3 + i]
        elif kind == 5:
            p[12 + i], p[15 + i] = r[1] - 0.5 * r[11], r[2] + 0.5 * r[11]
            p[3 + i], p[9 + i] = r[12], -0.5 * r[12]
    for i in range(3):
        r = p[34 + 13 * i:47 + 13 * i]
        if int(r[0]) == 3:
            a, b = int(r[9]), int(r[10])
            first = p[15 + a] - p[12 + a]
            start = p[36 + 13 * b] - p[35 + 13 * b]
            if r[8] == 1.0:
                half = 0.5 * (r[7] / first / start)
            elif r[8] == 2.0:
                half = 0.5 * (r[7] / first / (p[15 + b] - p[12 + b]))
            else:
                half = 0.5 * math.sqrt(r[7] * (r[2] - r[1]) / first / start)
            middle = 0.5 * (r[1] + r[2])
            p[3 + i] = (2.0 * half / vectors[i, i] - 1.0) / dt
            p[9 + i] = -0.5 * p[3 + i]
            p[12 + i], p[15 + i] = middle - half, middle + half
    for i in range(3, 6):
        r = p[34 + 13 * i:47 + 13 * i]
        kind = int(r[0])
        row, column = (2, 1) if i == 3 else ((2, 0) if i == 4 else (1, 0))
        now = vectors[row, column]
        tilt = now
        if kind == 1:
            tilt = r[1] + done * (r[3] - r[1])
        elif kind == 2:
            tilt = r[1] * math.exp(r[5] * time)
            p[3 + i] = r[5] * now
        elif kind == 4:
            angle = 2.0 * math.pi * time / r[6]
            tilt = r[1] + r[5] * math.sin(angle)
            p[3 + i] = 2.0 * math.pi / r[6] * r[5] * math.cos(angle)
        elif kind == 5:
            tilt = r[1] + r[11]
            p[3 + i] = r[12]
        if kind != 0:       # of the equivalent tilts the one closest to the present
            length, ratio = p[15 + column] - p[12 + column], now / vectors[column, column]
            while tilt / length - ratio > 0.0:
                tilt -= length
            while tilt / length - ratio < 0.0:
                tilt += length
            if abs(tilt / length - 1.0 - ratio) < abs(tilt / length - ratio):
                tilt -= length
        p[15 + i] = tilt


def take_box(p, vectors, origin):
    """The box that `new_box` found into `vectors` and `origin`."""
    for i in range(3):
        origin[i] = p[12 + i]
        vectors[i, i] = p[15 + i] - p[12 + i]
    vectors[2, 1], vectors[2, 0], vectors[1, 0] = p[18], p[19], p[20]


def transform(s, p, lo, hi):
    """Positions of the group go from the old box to the new one with their fractional coordinates."""
    bit, mine = np.int32(np.int64(p[0])), slice(lo, hi)
    mask, x, y, z = s.mask[mine], s.x[0, mine], s.x[1, mine], s.x[2, mine]
    for i in range(mask.size):
        if mask[i] & bit != 0:
            dx, dy, dz = x[i] - p[30], y[i] - p[31], z[i] - p[32]
            a = p[21] * dx + p[24] * dy + p[27] * dz
            b = p[25] * dy + p[28] * dz
            c = p[29] * dz
            x[i] = (p[15] - p[12]) * a + p[20] * b + p[19] * c + p[12]
            y[i] = (p[16] - p[13]) * b + p[18] * c + p[13]
            z[i] = (p[17] - p[14]) * c + p[14]


def remember(p, v, origin):
    """The inverse of the present box and its origin into ``p[21:33]``; the box is in LAMMPS's frame."""
    for k in range(9):
        p[21 + k] = 0.0
    p[21], p[25], p[29] = 1.0 / v[0, 0], 1.0 / v[1, 1], 1.0 / v[2, 2]
    p[24] = -v[1, 0] / (v[0, 0] * v[1, 1])
    p[27] = (v[2, 1] * v[1, 0] - v[1, 1] * v[2, 0]) / (v[0, 0] * v[1, 1] * v[2, 2])
    p[28] = -v[2, 1] / (v[1, 1] * v[2, 2])
    for k in range(3):
        p[30 + k] = origin[k]


def move(s, p, slots: int) -> None:
    """`transform` with numpy."""
    inside = np.flatnonzero(s.mask[:slots] & int(p[0]))
    a = (s.x[:, inside] - p[30:33, None]).T @ p[21:30].reshape(3, 3)
    new = np.array([[p[15] - p[12], 0.0, 0.0], [p[20], p[16] - p[13], 0.0], [p[19], p[18], p[17] - p[14]]])
    s.x[:, inside] = (a @ new + p[12:15]).T


new_box.strict = take_box.strict = True       # the last bit decides when a list is built
_new_box, _take_box = njit(cache=True)(new_box), njit(cache=True)(take_box)


@njit(cache=True)
def next_flip(step, every, last, begin, end, dt, p, vectors, origin, periodic):
    """The first step up to `last` that leaves a tilt of more than half a periodic length, or -1; `p`, `vectors`, `origin` change."""
    s = (step // every + 1) * every
    while s <= last:
        _new_box(s, begin, end, dt, p, vectors, origin)
        _take_box(p, vectors, origin)
        for row in range(1, 3):
            for column in range(row):
                if periodic[column] and abs(vectors[row, column] * (1.0 / vectors[column, column])) > 0.5:
                    return s
        s += every
    return -1
