"""One thing that a check of a scene has found; styles and fixes make them too."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

SEVERITIES = ("ok", "note", "warning", "error")


@dataclass
class Finding:
    """What one check found.

    Parameters
    ----------
    severity : str
        ``ok``; ``note``: good to know; ``warning``: probably not meant, or not accurate; ``error``: the run will fail or its numbers
        will be wrong.
    name : str
        The check, in plain words: ``time step``.
    message : str
        One or two sentences; atoms by id.
    atoms : sequence of int
        Ids of the atoms it is about, the worst first.
    value, limit : float or str, optional
        The figure and what it was judged by, in units of the scene; text where a number alone says too little.
    advice : str
        What to do.
    where : str
        The part of a script it is about: ``run of line 31``; empty: the first run.
    """

    severity: str
    name: str
    message: str
    atoms: Sequence[int] = ()
    value: float | str | None = None
    limit: float | str | None = None
    advice: str = ""
    where: str = ""

    def __post_init__(self):
        if self.severity not in SEVERITIES:
            raise ValueError(f"severity must be one of {' '.join(SEVERITIES)}, got {self.severity!r}")
        self.atoms = tuple(int(i) for i in self.atoms)

    @property
    def rank(self) -> int:
        """0 for ``ok`` to 3 for ``error``."""
        return SEVERITIES.index(self.severity)
