"""Arguments of fixes that may be a number or a variable (``v_name``)."""
from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from asemd.words import number

if TYPE_CHECKING:
    from asemd.loop import Loop

Value = float | Callable[["Loop"], float | np.ndarray]


class Formula:
    """A variable of style equal or atom as a function of the running simulation.

    Parameters
    ----------
    name : str
        Name of the variable, which must be there when a run begins.
    session
        Its ``variables`` evaluate it; its ``moment`` is what they see of computes.

    Raises
    ------
    InputError
        No variable of that name; while a fix is being defined that is told when a run begins, as in LAMMPS.
    """

    def __init__(self, name: str, session):
        if getattr(session, "awaited", None) is None:
            session.variables.find(name)
        else:
            session.awaited.append(name)
        self.name, self.session = name, session

    def __call__(self, loop: Loop) -> float | np.ndarray:
        """One number, or (n,) values by atom row."""
        variables = self.session.variables
        loop.sync_out()
        loop.system.step = loop.step
        self.session.look(loop)
        if variables.find(self.name).style == "atom":
            return variables.per_atom(self.name, loop.system.n)
        return variables.number(self.name)

    def __str__(self) -> str:
        return f"v_{self.name}"


def read(word: str, what: str, session) -> float | Formula:
    """A word of a script: a number, or ``v_name``."""
    return Formula(word[2:], session) if word.startswith("v_") else number(word, what)


def write(value: float | Formula | None) -> str:
    """The word again; a plain Python function has none and shows as its name."""
    if value is None:
        return "NULL"
    return str(value) if isinstance(value, Formula) else getattr(value, "__name__", None) or repr(float(value))
