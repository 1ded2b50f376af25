"""The stream of random numbers of `asemd.marsaglia` in compiled code."""
from __future__ import annotations

import math
from functools import cache
from types import ModuleType

import numpy as np

from asemd.kernels.generate import Builder


def uniform(stream):
    """The next number; `stream (102,)`: 97 numbers, c, two places, and a saved normal number behind its flag."""
    i = int(stream[98])
    j = int(stream[99])
    value = stream[i] - stream[j]
    if value < 0.0:
        value += 1.0
    stream[i] = value
    stream[98] = i - 1 if i > 0 else 96
    stream[99] = j - 1 if j > 0 else 96
    c = stream[97] - 7654321.0 / 16777216.0
    if c < 0.0:
        c += 16777213.0 / 16777216.0
    stream[97] = c
    value -= c
    return value + 1.0 if value < 0.0 else value


def gaussian(stream):
    """The next normal number, by the polar method."""
    if stream[100] > 0.0:
        stream[100] = 0.0
        return stream[101]
    while True:
        a = 2.0 * uniform(stream) - 1.0
        b = 2.0 * uniform(stream) - 1.0
        square = a * a + b * b
        if 0.0 < square < 1.0:
            break
    factor = math.sqrt(-2.0 * math.log(square) / square)
    stream[100] = 1.0
    stream[101] = a * factor
    return b * factor


def fill(stream, out):
    """The next `out (n,)` normal numbers."""
    for i in range(len(out)):
        out[i] = gaussian(stream)


@cache
def module() -> ModuleType:
    """Compiled `fill`."""
    b = Builder("normal numbers of a stream")
    for f in (uniform, gaussian, fill):
        b.function(f)
    return b.build()


def normals(random, n: int) -> np.ndarray:
    """(n,) the next normal numbers of a `asemd.marsaglia.Marsaglia`."""
    stream, out = np.array(random.stream()), np.empty(n)
    module().fill(stream, out)
    random.take(stream.tolist())
    return out
