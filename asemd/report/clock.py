"""Wall time against a budget; compilation is counted apart, up to a bound."""
from __future__ import annotations

import time
from contextlib import contextmanager

from numba.core import event

COMPILING, PATIENCE = 60.0, 2.0     # compilation counts as used time from so many seconds on, or so many times the budget if that is more

WRITING, PART = 3.0, 0.25   # processor seconds that plots and pages take; part of the budget that they get at most


class Clock(event.TimingListener):
    """Counts from when it is made; within its ``with`` block compilation is listened to.

    Parameters
    ----------
    budget : float
        Seconds.

    Attributes
    ----------
    reserve : float
        Seconds of the budget that are kept for what comes after measuring: plots and pages.
    """

    KIND = "numba:compile"

    def __init__(self, budget: float):
        super().__init__()
        self.began, self.whole, self.besides, self.reserve = time.perf_counter(), budget, 0.0, 0.0

    def __enter__(self) -> Clock:
        event.register(self.KIND, self)
        return self

    def __exit__(self, *error) -> None:
        event.unregister(self.KIND, self)

    @property
    def budget(self) -> float:
        """Seconds for measuring."""
        return self.whole - self.reserve

    def keep(self, share: float) -> None:
        """Keep time for writing on a machine on which this program has that share of a core."""
        self.reserve = min(WRITING / max(share, 0.1), PART * self.whole)

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
        """Seconds since the start, without compilation up to its bound."""
        return time.perf_counter() - self.began - min(self.compiled, max(COMPILING, PATIENCE * self.whole))

    def left(self, part: float = 1.0) -> float:
        """Seconds until that part of the budget is used."""
        return part * self.budget - self.used

    @staticmethod
    def at(seconds: float) -> float:
        """Reading of ``time.perf_counter`` in that many seconds."""
        return time.perf_counter() + seconds
