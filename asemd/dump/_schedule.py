"""On which steps a dump is written: multiples of N, steps a variable gives, or equal intervals of time."""
from __future__ import annotations

import math

from asemd.errors import InputError

EARLY = 1e-3    # part of a timestep by which a time may be missed for rounding
NEVER = 2**62


class Schedule:
    """When a dump is due.

    Parameters
    ----------
    every : int
        Interval, steps.

    Attributes
    ----------
    variable : str
        Name of a variable that gives the next step, instead of `every`.
    timed : bool
        Whether it gives the next time instead.
    interval : float
        Interval in units of time, instead of `every`; 0 for none.
    delay : int
        No snapshot before this step.
    next : int
        The next step that is due, once `start` was called.
    """

    def __init__(self, every: int):
        self.every, self.variable, self.interval, self.delay = every, "", 0.0, 0
        self.timed = False
        self.next = NEVER
        self._time = 0.0        # time of the next snapshot

    def is_due(self, step: int, time: float, dt: float) -> bool:
        """Whether the first step of a run is written."""
        if self.variable:
            return False
        if self.interval:
            return abs(time - math.floor(time / self.interval + EARLY * dt / self.interval) * self.interval) < EARLY * dt
        return step % self.every == 0

    def start(self, step: int, time: float, dt: float, number) -> None:
        """A run begins: find the first step after `step`."""
        if self.interval:
            self._time = math.floor(time / self.interval + EARLY * dt / self.interval) * self.interval
        self.advance(step, time, dt, number)

    def advance(self, step: int, time: float, dt: float, number) -> None:
        """Find the next step after `step`.

        Parameters
        ----------
        number : callable
            Name of a variable -> its value.

        Raises
        ------
        InputError
            The variable names no later step.
        """
        if self.variable and self.timed:
            wanted = number(self.variable)
            if wanted <= time:
                raise InputError(f"dump_modify every/time v_{self.variable}: the variable gave {wanted:g}, which is not after {time:g}")
            self.next = step + max(1, math.ceil((wanted - time) / dt - EARLY))
        elif self.variable:
            self.next = int(number(self.variable))
            if self.next <= step:
                raise InputError(f"dump_modify every v_{self.variable}: the variable gave step {self.next}, which is not after step {step}")
        elif self.interval:
            wait = max(self.delay - step - 1, 0) * dt       # a snapshot at a time after this is written on or after the step of the delay
            self._time = max(self._time + self.interval, math.ceil((time + wait) / self.interval + EARLY) * self.interval)
            self.next = step + max(1, math.ceil((self._time - time) / dt - EARLY))
        else:
            first = max(step + 1, self.delay)
            self.next = -(-first // self.every) * self.every
