"""Ctrl-C while compiled steps are under way."""
from __future__ import annotations

import signal
import threading


class Interrupt:
    """Keeps Ctrl-C back while steps are under way: `asked` tells that it came. A handler of the caller's own is left alone."""

    def __enter__(self) -> Interrupt:
        self.asked = False
        mine = threading.current_thread() is threading.main_thread() and signal.getsignal(signal.SIGINT) is signal.default_int_handler
        self._before = signal.signal(signal.SIGINT, self._ask) if mine else None
        return self

    def _ask(self, number, frame) -> None:
        self.asked = True

    def __exit__(self, *error) -> None:
        if self._before is not None:
            signal.signal(signal.SIGINT, self._before)
