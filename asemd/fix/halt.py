r"""Stop a run when a number passes a limit.

Every N steps an attribute is compared with a value by ``< > <= >= == != |^`` (one of both is zero): ``bondmax``, the length of the longest
bond; ``tlimit``, the seconds since the run began; ``diskfree``, the free space of the disk with `path`, in units of 2^20 bytes; or
``v_name``, a variable. When the comparison holds the run stops: with an error (``error hard``), in order so that the commands after it are
carried out but for runs and minimisations (``soft``), or in order for good (``continue``). It stops minimisations too. So that the clock
costs nothing ``tlimit`` looks at it at half of the expected time, then near the end of it, as LAMMPS does.

Source: LAMMPS manual, fix halt. Units: distance (bondmax).
"""
from __future__ import annotations

import operator as op
import os
import shutil
import time
from collections.abc import Callable

import numpy as np

from asemd.errors import Halted, InputError, nearest
from asemd.fix import Fix
from asemd.fix.values import needs_of, snapshot_of
from asemd.words import choice, number, take, whole, yes_no

OPERATORS: dict[str, Callable[[float, float], bool]] = {
    "<": op.lt, "<=": op.le, ">": op.gt, ">=": op.ge, "==": op.eq, "!=": op.ne, "|^": lambda a, b: (a == 0.0) != (b == 0.0)}
ATTRIBUTES = ("bondmax", "tlimit", "diskfree")
ERRORS = ("hard", "soft", "continue")
MEGABYTE = 2.0**20
FIRST_LOOK = 0.5        # of the time limit


def longest_bond(state) -> float:
    """Length of the longest bond that is not turned off; 0 without bonds."""
    system = state.system
    atoms, types = system.topology.items("bond")
    atoms = atoms[types > 0]
    if not len(atoms):
        return 0.0
    apart = system.box.minimum_image(system.x[atoms[:, 0]] - system.x[atoms[:, 1]])[0]
    return float(np.sqrt((apart * apart).sum(axis=1).max()))


class Halt(Fix):
    """Stop a run.

    Parameters
    ----------
    group : str
        Has no effect.
    every : int
        Steps between two looks.
    attribute : str or callable
        ``bondmax``, ``tlimit`` or ``diskfree``, or a function of a `asemd.engine.Snapshot`.
    operator : str
        One of ``< > <= >= == != |^``.
    value : float
        What the attribute is compared with.
    error : str
        ``hard``: an error; ``soft``: later runs of the script are skipped; ``continue``: they are not.
    message : bool
        Say why the run stopped.
    path : str
        A folder on the disk for ``diskfree``.

    Raises
    ------
    InputError
        An interval below 1, an unknown word, a path that does not exist.
    Halted
        The condition holds, with ``hard``.
    """

    style = "halt"
    minimizes = True

    def __init__(self, group: str = "all", every: int = 1, attribute="bondmax", operator: str = ">", value: float = 0.0,
                 error: str = "soft", message: bool = True, path: str = "."):
        super().__init__(group)
        if every < 1:
            raise InputError(f"fix halt: N must be at least 1, got {every}")
        if not callable(attribute) and attribute not in ATTRIBUTES:
            raise InputError(f"fix halt: the attribute must be bondmax, tlimit, diskfree or v_name, got {attribute}"
                             f"{nearest(attribute, ATTRIBUTES)}")
        self.interval, self.attribute, self.value = every, attribute, float(value)
        self.operator, self.error = choice(operator, OPERATORS, "fix halt operator"), choice(error, ERRORS, "fix halt error")
        self.message, self.path, self.word, self.session = message, path, attribute, None
        if attribute == "diskfree" and not os.path.exists(path):
            raise InputError(f"fix halt: there is no file or folder {path} whose disk could be looked at")
        self.began, self.first, self.ratio, self.at = 0.0, 0, FIRST_LOOK, every

    @classmethod
    def from_lammps(cls, group, words, session):
        what = "fix halt"
        every, attribute, operator, value = take(words, 4, f"{what} N attribute operator value")
        options, rest = {}, words[4:]
        while rest:
            keyword = choice(rest[0], ("error", "message", "path"), what)
            given = take(rest[1:], 1, f"{what} {keyword}")[0]
            options[keyword] = yes_no(given, f"{what} message") if keyword == "message" else given
            rest = rest[2:]
        if attribute.startswith("v_") and session.variables.find(attribute[2:]).style != "equal":
            raise InputError(f"{what}: {attribute} must be a variable of style equal")
        looked_at = (lambda _: session.variables.number(attribute[2:])) if attribute.startswith("v_") else attribute
        new = cls(group, whole(every, f"{what} N"), looked_at, operator, number(value, f"{what} value"), **options)
        new.word, new.session = attribute, session
        return new

    def to_lammps(self) -> list[str]:
        words = [str(self.interval), str(self.word), self.operator, repr(self.value), "error", self.error]
        return [*words, "message", "yes" if self.message else "no", "path", self.path]

    def setup(self, loop) -> None:
        self.began, self.first, self.ratio, self.at = time.monotonic(), loop.step, FIRST_LOOK, self._multiple(loop.step)
        if self.session is not None and str(self.word).startswith("v_"):
            self.needs = frozenset(needs_of([self.word], self.session))

    def _multiple(self, step: int) -> int:
        """The next multiple of the interval."""
        return (step // self.interval + 1) * self.interval

    def next_end(self, step: int) -> int:
        return self.at if self.attribute == "tlimit" and self.at > step else self._multiple(step)

    def _elapsed(self, step: int) -> float:
        """Seconds since the run began; when to look again is settled by them."""
        seconds = time.monotonic() - self.began
        self.at = self._multiple(step)
        if seconds < self.value:
            expected = self.first + int(self.ratio * self.value / max(seconds, 1e-9) * (step - self.first))
            self.at, self.ratio = max(self.at, self._multiple(expected)), 1.0
        return seconds

    def measure(self, loop) -> float:
        """The attribute now."""
        if self.attribute == "tlimit":
            return self._elapsed(loop.step)
        if self.attribute == "diskfree":
            return shutil.disk_usage(self.path).free / MEGABYTE
        if callable(self.attribute):
            return float(self.attribute(snapshot_of(loop, self.session, self.needs)))
        loop.sync_out()
        return longest_bond(loop)

    def end_of_step(self, loop) -> None:
        """Look, and stop the run if the condition holds."""
        now = self.measure(loop)
        if not OPERATORS[self.operator](now, self.value):
            return
        text = f"Fix halt condition for fix-id {self.id} met on step {loop.step} with value {repr(now).removesuffix('.0')}"
        if self.error == "hard":
            raise Halted(text)
        if self.message:
            loop.say(text)
        loop.halted = True
        if self.error == "soft" and self.session is not None:
            self.session.timer.expired = True
