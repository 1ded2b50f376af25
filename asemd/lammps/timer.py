"""The settings of the command ``timer``: what the table after a run shows, and the limit of wall time."""
from __future__ import annotations

import time
from dataclasses import dataclass

STYLES = ("off", "loop", "normal", "full")
MODES = ("sync", "nosync")


@dataclass
class Timer:
    """Settings and the state of the limit.

    Attributes
    ----------
    style, mode : str
    every : int
        Steps or iterations between two looks at the clock.
    seconds : float or None
        The limit; None without one.
    expired : bool
        The limit was reached: runs and minimisations are skipped.
    """

    style: str = "normal"
    mode: str = "nosync"
    every: int = 10
    seconds: float | None = None
    expired: bool = False
    started: float = 0.0

    def limit(self, seconds: float | None) -> None:
        """Set the limit, from now on; None takes it away."""
        self.seconds, self.expired, self.started = seconds, seconds == 0.0, time.monotonic()

    def remaining(self) -> float:
        """Seconds that are left; 0 without a limit and after it was reached."""
        return 0.0 if self.seconds is None or self.expired else self.started + self.seconds - time.monotonic()

    def check(self, steps: int) -> bool:
        """Look at the clock if it is time for that after so many steps of a run; whether it has to stop."""
        if self.seconds is not None and steps % self.every == 0 and self.remaining() < 0.0:
            self.expired = True
        return self.expired

    def pause(self, steps: int) -> int:
        """How many steps there are to the next look at the clock, after so many steps of a run."""
        return self.every - steps % self.every if self.seconds is not None else 2**62

    def __str__(self) -> str:
        left = "off"
        if self.seconds is not None:
            minutes, seconds = divmod(int(self.seconds), 60)
            left = f"{minutes // 60:02d}:{minutes % 60:02d}:{seconds:02d}"
        return f"style={self.style}  mode={self.mode}  timeout={left}"
