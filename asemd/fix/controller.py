r"""Control a process variable by a control variable, with a PID loop.

.. math:: c \leftarrow c - \alpha \left( K_p \tau e + K_i \tau^2 \sum e + K_d \, \Delta e \right), \qquad e = p - p_0

every N steps, with :math:`\tau` = N timesteps, the process variable :math:`p`, its setpoint :math:`p_0` and the internal-style variable
:math:`c`, which other commands use. The first change of the error is 0.

Source: LAMMPS manual, fix controller. Output: a vector of 3, the changes of the control variable by the proportional, integral and
derivative term.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.fix import Fix
from asemd.fix.values import given, read, snapshot_of
from asemd.words import exactly, number, whole


class Controller(Fix):
    """A PID loop.

    Parameters
    ----------
    group : str
        Has no effect.
    every : int
        Steps between two changes.
    alpha, kp, ki, kd : float
        Factor of all terms, and of the proportional, integral and derivative one.
    process : Compute, (Compute, index) or callable
        Gives a number of a `asemd.engine.Snapshot`.
    setpoint : float
        What it is to be.
    control : callable
        Called with the new value of the control variable.
    value : float
        Value of the control variable at the beginning.

    Raises
    ------
    InputError
        An interval below 1.
    """

    style = "controller"
    session = None
    name = ""
    size = 3        # elements of the vector

    def __init__(self, group: str = "all", every: int = 1, alpha: float = 1.0, kp: float = 0.0, ki: float = 0.0, kd: float = 0.0,
                 process=None, setpoint: float = 0.0, control=None, value: float = 0.0):
        super().__init__(group)
        if every < 1:
            raise InputError(f"fix controller: Nevery must be at least 1, got {every}")
        if process is None:
            raise InputError("fix controller needs a process variable")
        self.every, self.alpha, self.kp, self.ki, self.kd = every, alpha, kp, ki, kd
        self.process, self.setpoint, self.control, self.value = given(process, 1), setpoint, control, float(value)
        self.error: float | None = None
        self.sum = 0.0
        self.terms = np.zeros(3)

    @classmethod
    def from_lammps(cls, group, words, session):
        what = "fix controller"
        exactly(words, 8, f"{what} (Nevery alpha Kp Ki Kd pvar setpoint cvar)")
        numbers = [number(w, f"{what} {n}") for w, n in zip(words[1:5], ("alpha", "Kp", "Ki", "Kd"))]
        if session.variables.find(words[7]).style != "internal":
            raise InputError(f"{what}: the control variable {words[7]} must be of style internal")
        process = read(words[5], session, what).check("scalar", what)
        fix = cls(group, whole(words[0], f"{what} Nevery"), *numbers, process, number(words[6], f"{what} setpoint"))
        fix.session, fix.name, fix.words = session, words[7], list(words)
        return fix

    def to_lammps(self) -> list[str]:
        if not hasattr(self, "words"):
            raise InputError("fix controller: Python functions cannot be written as a script")
        return self.words

    def setup(self, loop) -> None:
        self.needs = frozenset(self.process.needs())
        if self.session is not None:
            self.value = self.session.variables.number(self.name)

    def end_of_step(self, loop) -> None:
        """Change the control variable."""
        now = self.process.scalar(snapshot_of(loop, self.session, self.needs)) - self.setpoint
        change = 0.0 if self.error is None else now - self.error
        self.sum += now
        self.error, tau = now, self.every * loop.dt
        self.terms = -self.alpha * np.array([self.kp * tau * now, self.ki * tau**2 * self.sum, self.kd * change])
        self.value += float(self.terms[0])
        self.value += float(self.terms[1])
        self.value += float(self.terms[2])
        if self.session is not None:
            self.session.variables.set(self.name, repr(self.value))
        elif self.control is not None:
            self.control(self.value)

    def vector(self, i: int) -> float:
        """Changes by the proportional, integral and derivative term."""
        if not 1 <= i <= 3:
            raise InputError(f"fix {self.id} (style controller) has a vector of 3, there is no element {i}")
        return float(self.terms[i - 1])
