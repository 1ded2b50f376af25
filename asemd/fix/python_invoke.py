"""Call a Python function every N steps: ``end_of_step`` with the running simulation, or ``post_force`` with it and the virial flag.

The function is one that the command ``python`` has made known; it may change positions and velocities at the end of a step, and forces
after they were computed. In Python the fix takes the function itself, which is called with the live `asemd.loop.Loop`.

Source: LAMMPS manual, fix python/invoke.
"""
from __future__ import annotations

from collections.abc import Callable

import numpy as np

from asemd.errors import InputError
from asemd.fix import Fix
from asemd.words import choice, exactly, whole

CALLBACKS = ("end_of_step", "post_force")


class PythonInvoke(Fix):
    """Call a function during a run.

    Parameters
    ----------
    group : str
        Has no effect.
    every : int
        Steps between two calls.
    callback : str
        ``end_of_step`` or ``post_force``.
    function : callable
        Called with the loop, whose ``system`` has the atoms.

    Raises
    ------
    InputError
        An interval below 1, an unknown callback.
    """

    style = "python/invoke"
    levels = "outermost"

    def __init__(self, group: str = "all", every: int = 1, callback: str = "end_of_step", function: Callable | None = None):
        super().__init__(group)
        if every < 1:
            raise InputError(f"fix python/invoke: N must be at least 1, got {every}")
        if not callable(function):
            raise InputError("fix python/invoke needs a function")
        self.every, self.callback, self.function = every, choice(callback, CALLBACKS, "fix python/invoke"), function

    @classmethod
    def from_lammps(cls, group, words, session):
        what = "fix python/invoke"
        every, callback, name = exactly(words, 3, f"{what} (N callback function)")
        session.refuse_if_safe(what)
        choice(callback, CALLBACKS, what)
        if not callable(session.python.names.get(name)):
            raise InputError(f"{what}: there is no Python function {name}, define it with the command python")

        def call(loop):
            session.look(loop)
            session.python.invoke(name, [0] if callback == "post_force" else [])
        fix = cls(group, whole(every, f"{what} N"), callback, call)
        fix.words = list(words)
        return fix

    def to_lammps(self) -> list[str]:
        if not hasattr(self, "words"):
            raise InputError("fix python/invoke: a function of Python cannot be written as a script")
        return self.words

    def hooks(self) -> dict[str, bool]:
        return {self.callback: False}

    def next_step(self, step: int) -> int:
        return super().next_end(step) if self.callback == "post_force" else 2**62

    def end_of_step(self, loop) -> None:
        """Call the function; the run goes on with the positions and velocities it leaves."""
        loop.sync_out()
        loop.system.step = loop.step
        self.function(loop)
        loop.sync_in()

    def post_force(self, loop) -> None:
        """Call the function; the step goes on with the forces it leaves."""
        if loop.step % self.every:
            return
        loop.sync_out()
        system = loop.system
        system.step = loop.step
        self.function(loop)
        rows = loop.state.row[:loop.nslots]
        slots = np.flatnonzero(rows >= 0)
        loop.state.f[:, slots] = system.f[rows[slots]].T
