"""Threads that run one compiled kernel together."""
from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor


class Team:
    """Runs ``work(tid)`` on `threads` threads at once, the caller's being number 0; kernels release the interpreter lock."""

    def __init__(self, threads: int):
        self.threads = threads
        self._pool: ThreadPoolExecutor | None = None

    def __call__(self, work: Callable[[int], None]) -> None:
        if self.threads == 1:
            work(0)
            return
        if self._pool is None:
            self._pool = ThreadPoolExecutor(self.threads - 1)
        futures = [self._pool.submit(work, t) for t in range(1, self.threads)]
        work(0)
        for f in futures:
            f.result()
