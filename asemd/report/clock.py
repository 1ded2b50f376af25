"""Wall time against a budget, compilation left out."""
from __future__ import annotations

import time
from contextlib import contextmanager

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
        self.began, self.budget, self.besides = time.perf_counter(), budget, 0.0

    def __enter__(self) -> Clock:
        event.register(self.KIND, self)
        return self

    def __exit__(self, *error) -> None:
        event.unregister(self.KIND, self)

    @property
    def compiled(self) -> float:
        """Seconds of compilation so far, with what goes with it in blocks of `warming`."""
        return (self.duration if self.done else 0.0) + self.besides

    @contextmanager
    def warming(self):
        """A block that is there to compile: if anything is compiled in it, all of it counts as compilation (linking, files)."""
        began, before = time.perf_counter(), self.compiled
        yield
        found = self.compiled - before
        if found > 0.0:
            self.besides += max(0.0, time.perf_counter() - began - found)

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
