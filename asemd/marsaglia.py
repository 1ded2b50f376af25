"""The universal random number generator of Marsaglia, Zaman and Tsang, which the functions of variables draw from.

Source: G. Marsaglia, A. Zaman, W. W. Tsang, Statistics & Probability Letters 9, 35 (1990).
"""
from __future__ import annotations

import math

UNIT = 2.0**-24


class Marsaglia:
    """One stream; `seed` is a positive whole number below 900,000,001."""

    def __init__(self, seed: int):
        ij, kl = divmod(seed - 1, 30082)
        i, j, k, m = ij // 177 % 177 + 2, ij % 177 + 2, kl // 169 % 178 + 1, kl % 169
        self._u = []
        for _ in range(97):
            bits, weight = 0.0, 0.5
            for _ in range(24):
                i, j, k = j, k, i * j % 179 * k % 179
                m = (53 * m + 1) % 169
                if m * k % 64 >= 32:
                    bits += weight
                weight *= 0.5
            self._u.append(bits)
        self._c, self._i, self._j = 362436.0 * UNIT, 96, 32
        self._saved: float | None = None
        self.uniform()

    def uniform(self) -> float:
        """The next number between 0 and 1."""
        u = self._u
        value = u[self._i] - u[self._j]
        value += value < 0.0
        u[self._i] = value
        self._i, self._j = (self._i - 1) % 97, (self._j - 1) % 97
        self._c -= 7654321.0 * UNIT
        if self._c < 0.0:
            self._c += 16777213.0 * UNIT
        value -= self._c
        return value + (value < 0.0)

    def gaussian(self) -> float:
        """The next number of the standard normal distribution (polar method)."""
        if self._saved is not None:
            value, self._saved = self._saved, None
            return value
        while True:
            a, b = 2.0 * self.uniform() - 1.0, 2.0 * self.uniform() - 1.0
            square = a * a + b * b
            if 0.0 < square < 1.0:
                break
        factor = math.sqrt(-2.0 * math.log(square) / square)
        self._saved = a * factor
        return b * factor

    def stream(self) -> list[float]:
        """Where it is, as compiled code keeps it: 97 numbers, c, two places, whether a normal number is left, and that."""
        return [*self._u, self._c, self._i, self._j, float(self._saved is not None), self._saved or 0.0]

    def take(self, stream: list[float]) -> None:
        """Go on from there."""
        self._u, (c, i, j, left, saved) = stream[:97], stream[97:]
        self._c, self._i, self._j, self._saved = c, int(i), int(j), saved if left else None

    def subset(self, n: int, k: int) -> list[int]:
        """`k` of the numbers 0 to n - 1, in ascending order.

        Every candidate is taken with equal probability so that about the right number results; then only the ones looked at last are
        looked at again, to add or remove what is missing or too many.
        """
        marked, candidates, count = [False] * n, (list(range(n)), []), 0
        while count != k:
            mark = count < k
            pool = candidates[not mark]
            chance = min(max(abs(k - count) / len(pool), 0.01), 0.99)
            kept: tuple[list[int], list[int]] = ([], [])
            for i in pool:
                if self.uniform() < chance:
                    marked[i] = mark
                    count += 1 if mark else -1
                kept[marked[i]].append(i)
            candidates = kept
        return [i for i in range(n) if marked[i]]
