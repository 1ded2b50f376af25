r"""The random numbers that depend only on a seed, on atom ids or on coordinates, equal to LAMMPS's to the last bit.

The generator is the minimal standard of Park and Miller [1]_, s <- 16807 s mod (2^31 - 1). Because s_k = 16807^k s mod (2^31 - 1),
a whole stretch of the sequence is one array operation. A seed per atom comes from a seed and the atom's position through
Jenkins's one-at-a-time hash [2]_.

References
----------
.. [1] S. K. Park, K. W. Miller, Commun. ACM 31, 1192 (1988).
.. [2] R. J. Jenkins, Dr. Dobb's Journal 22, 9 (1997).
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError

MODULUS = 2**31 - 1
MULTIPLIER = 16807
_powers = np.array([1], dtype=np.uint64)    # MULTIPLIER**k mod MODULUS, grown when needed


def powers(n: int) -> np.ndarray:
    """``16807**k mod (2^31 - 1)`` for k < n, (n,) uint64."""
    global _powers
    while len(_powers) < n:     # products of two numbers below 2^31 fit in 64 bits
        step = np.uint64(int(_powers[-1]) * MULTIPLIER % MODULUS)
        _powers = np.concatenate([_powers, _powers * step % np.uint64(MODULUS)])
    return _powers[:n]


def _unit(state: np.ndarray) -> np.ndarray:
    return state * (1.0 / MODULUS)


def _log(values: np.ndarray) -> np.ndarray:
    """The C library's logarithm: numpy's vector form may differ in the last bit."""
    return np.array([math.log(v) for v in values])


class ParkMiller:
    """One stream of random numbers.

    Parameters
    ----------
    seed : int
        A positive number.

    Raises
    ------
    InputError
        A seed that is not positive.
    """

    def __init__(self, seed: int):
        if seed <= 0:
            raise InputError(f"random seed must be a positive whole number, got {seed}")
        self.state = int(seed)
        self.saved: float | None = None

    def _states(self, n: int) -> np.ndarray:
        """The next n states, without advancing."""
        return powers(n + 1)[1:] * np.uint64(self.state % MODULUS) % np.uint64(MODULUS)

    def skip(self, n: int) -> None:
        """Throw away n uniform numbers."""
        self.state = self.state * pow(MULTIPLIER, n, MODULUS) % MODULUS

    def uniform(self, n: int | None = None) -> float | np.ndarray:
        """The next number in (0, 1), or the next n of them."""
        if n is None:
            self.state = self.state * MULTIPLIER % MODULUS
            return self.state * (1.0 / MODULUS)
        states = self._states(n)
        if len(states):
            self.state = int(states[-1])
        return _unit(states)

    def gaussian(self, n: int | None = None) -> float | np.ndarray:
        """The next number of mean 0 and variance 1, or the next n of them; polar method, one of each pair kept for the next call."""
        want = 1 if n is None else n
        out = [] if self.saved is None or want == 0 else [np.array([self.saved])]
        missing = want - len(out)
        if out:
            self.saved = None
        while missing > 0:
            need = (missing + 1) // 2
            tries = int(need * 1.3) + 16
            states = self._states(2 * tries)
            first, second, accepted = _polar(states[0::2], states[1::2])
            used = np.flatnonzero(accepted)[:need]
            tried = int(used[-1]) + 1 if len(used) == need else tries
            pairs = np.column_stack([second[used], first[used]]).ravel()
            self.state = int(states[2 * tried - 1])
            if len(pairs) > missing:
                self.saved, pairs = float(pairs[-1]), pairs[:-1]
            out.append(pairs)
            missing -= len(pairs)
        values = np.concatenate(out) if out else np.empty(0)
        return float(values[0]) if n is None else values


def _polar(state1: np.ndarray, state2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Gaussian pairs from two uniform numbers each, and which of them the polar method accepts."""
    v1, v2 = 2.0 * _unit(state1) - 1.0, 2.0 * _unit(state2) - 1.0
    rsq = v1 * v1 + v2 * v2
    accepted = (rsq < 1.0) & (rsq != 0.0)
    factor = np.zeros_like(rsq)
    r = rsq[accepted]
    factor[accepted] = np.sqrt(-2.0 * _log(r) / r)
    return v1 * factor, v2 * factor, accepted


def position_seeds(seed: int, x: np.ndarray) -> np.ndarray:
    """A state of the generator for every position, five draws after its seed.

    Parameters
    ----------
    seed : int
        Positive.
    x : (n, 3) float array

    Returns
    -------
    (n,) uint64
    """
    if seed <= 0:
        raise InputError(f"random seed must be a positive whole number, got {seed}")
    n = len(x)
    data = np.empty((n, 28), dtype=np.int8)
    data[:, :4] = np.frombuffer(np.int32(seed).tobytes(), dtype=np.int8)
    data[:, 4:] = np.ascontiguousarray(x, dtype="<f8").view(np.int8).reshape(n, 24)
    h = np.zeros(n, dtype=np.uint32)
    for byte in data.astype(np.int32).astype(np.uint32).T:      # a char is signed: sign-extended to 32 bits
        h += byte
        h += h << np.uint32(10)
        h ^= h >> np.uint32(6)
    h += h << np.uint32(3)
    h ^= h >> np.uint32(11)
    h += h << np.uint32(15)
    start = (h & np.uint32(0x7FFFFFF)).astype(np.uint64)
    start[start == 0] = 1
    return start * powers(6)[5] % np.uint64(MODULUS)


def uniform_at(states: np.ndarray, k: int) -> np.ndarray:
    """The next k uniform numbers of every state, (n, k)."""
    return _unit(states[:, None] * powers(k + 1)[1:] % np.uint64(MODULUS))


def gaussian_at(states: np.ndarray, k: int) -> np.ndarray:
    """The next k gaussian numbers of every state, (n, k)."""
    states = states.copy()
    jump = powers(3)
    out = np.empty((len(states), k + k % 2))
    for column in range(0, k, 2):
        left = np.arange(len(states))
        while len(left):
            s1 = states[left] * jump[1] % np.uint64(MODULUS)
            s2 = states[left] * jump[2] % np.uint64(MODULUS)
            states[left] = s2
            first, second, accepted = _polar(s1, s2)
            out[left[accepted], column] = second[accepted]
            out[left[accepted], column + 1] = first[accepted]
            left = left[~accepted]
    return out[:, :k]
