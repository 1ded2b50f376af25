r"""Random numbers for compiled loops: a pure function of (seed, step, row, k), so nothing is stored and threads cannot disturb one another.

The keys are folded into 64 bits one after the other, each time through the finaliser of splitmix64 [1]_, which passes BigCrush on plain
counters. There are no branches and the part of seed and step does not depend on the atom: compilers hoist it and vectorise the rest.
`row` is the number of the atom, `k` (0 to 7) tells the draws of one atom and step apart. Integers wrap, on purpose.

References
----------
.. [1] G. L. Steele, D. Lea, C. H. Flood, OOPSLA 2014, 453 (2014).
"""
from __future__ import annotations

import math
import os

import numpy as np

if os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):
    np.seterr(over="ignore")    # numpy warns where compiled integers wrap silently


def uniform(seed, step, row, k):
    """A number in [0, 1), 53 bits."""
    z = np.uint64(seed) * np.uint64(0xD1342543DE82EF95) + np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    z = (z ^ (z >> np.uint64(31))) + np.uint64(step) * np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    z = (z ^ (z >> np.uint64(31))) + (np.uint64(row) * np.uint64(8) + np.uint64(k)) * np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    z = z ^ (z >> np.uint64(31))
    return np.float64(z >> np.uint64(11)) * 1.1102230246251565e-16


def normal(seed, step, row, k):
    """A number of mean 0 and variance 1 (Box and Muller); `k` is 0 to 3, and it uses the draws 2 k and 2 k + 1 of `uniform`."""
    u = 1.0 - uniform(seed, step, row, 2 * k)
    w = uniform(seed, step, row, 2 * k + 1)
    return math.sqrt(-2.0 * math.log(u)) * math.cos(6.283185307179586 * w)
