"""Wall time against a budget, compilation left out."""
from __future__ import annotations

import time

from numba.core import event


class Clock(event.TimingListener):
    """Counts from when it is made; within its ``with`` block compilation is listened to.

    Parameters
    ----------
    budget : float
        Seconds.
    """

    KIND = "numba:compile"

    def __init__(self, budget: float):
        super().__init__()
        self.began, self.budget = time.perf_counter(), budget

    def __enter__(self) -> Clock:
        event.register(self.KIND, self)
        return self

    def __exit__(self, *error) -> None:
        event.unregister(self.KIND, self)

    @property
    def compiled(self) -> float:
        """Seconds of compilation so far."""
        return self.duration if self.done else 0.0

    @property
    def used(self) -> float:
        """Seconds since the start, without compilation."""
        return time.perf_counter() - self.began - self.compiled

    def left(self, part: float = 1.0) -> float:
        """Seconds until that part of the budget is used."""
        return part * self.budget - self.used

    @staticmethod
    def at(seconds: float) -> float:
        """Reading of ``time.perf_counter`` in that many seconds."""
        return time.perf_counter() + seconds
