r"""Computes are observers. One compute, one file; each is a plain class whose methods take a `asemd.engine.Snapshot`.

``needs`` says what the force evaluation must provide on the steps it is used: any of ``energy``, ``virial``, ``energies`` (per atom),
``virials`` (per atom). A compute that builds on another one takes it as an argument (pressure takes a temperature compute).

``asemd.compute.PEAtom`` is the class in ``asemd/compute/pe_atom.py``, imported when asked for; `find` goes by the LAMMPS name.
"""
from __future__ import annotations

from typing import ClassVar

import numpy as np

from asemd.errors import InputError
from asemd.registry import class_called, class_of, remember
from asemd.words import number, yes_no


class Compute:
    """Base class of computes.

    Parameters
    ----------
    group : str
        Name of the group it looks at.

    Attributes
    ----------
    bias : bool
        A temperature that takes a part of the velocities away first, see `asemd.compute.temp.Temp.remove_bias`.
    maker : str
        ID of the fix that brought it; empty for those that a script defined.
    extra_dof, dynamic : float or None, bool
        ``compute_modify ID extra/dof N`` and ``dynamic/dof yes``, which every compute takes; temperatures use them.
    """

    style: ClassVar[str] = ""
    needs: frozenset[str] = frozenset()
    bias: bool = False
    id: str = ""
    maker: str = ""
    extra_dof: float | None = None
    dynamic: bool = False

    def __init_subclass__(cls, **keywords):
        super().__init_subclass__(**keywords)
        remember("compute", cls)

    def __init__(self, group: str = "all"):
        self.group = group

    @classmethod
    def from_lammps(cls, group: str, words: list[str], session) -> Compute:
        """Build from the words after the style's name in ``compute ID group style words...``."""
        if words:
            raise InputError(f"compute {cls.style} takes no arguments, got {' '.join(words)}")
        return cls(group=group)

    def to_lammps(self) -> list[str]:
        return []

    def setup(self, state) -> None:
        """Called at the start of every run of a script, after the first forces."""

    def scalar(self, state) -> float:
        raise InputError(f"compute {self.id} (style {self.style}) has no global scalar")

    def vector(self, state) -> np.ndarray:
        raise InputError(f"compute {self.id} (style {self.style}) has no global vector")

    def array(self, state) -> np.ndarray:
        raise InputError(f"compute {self.id} (style {self.style}) has no global array")

    def array_columns(self) -> int | None:
        """How many columns `array` has, which is known before a run; None if there is no array."""
        return None

    def per_atom(self, state) -> np.ndarray:
        """(n,) or (n, k), by atom row; zero outside the group."""
        raise InputError(f"compute {self.id} (style {self.style}) has no per-atom values")

    def local(self, state) -> np.ndarray:
        """(m,) or (m, k): a row for each bond, angle, pair ..."""
        raise InputError(f"compute {self.id} (style {self.style}) has no local values")

    def local_columns(self) -> int | None:
        """How many columns `local` has, 0 if it is a vector; None if there are no local values."""
        return None

    def modify(self, words: list[str], session) -> None:
        """``compute_modify`` words: pairs of keyword and value."""
        if len(words) % 2 or not words:
            raise InputError(f"compute_modify: needs pairs of keyword and value, got {' '.join(words) or 'nothing'}")
        for keyword, value in zip(words[::2], words[1::2], strict=True):
            what = f"compute_modify {keyword}"
            if keyword in ("extra/dof", "extra"):
                self.extra_dof = number(value, what)
            elif keyword in ("dynamic/dof", "dynamic"):
                self.dynamic = yes_no(value, what)
            else:
                raise InputError(f"compute_modify: compute {self.id} (style {self.style}) does not take {keyword!r}")


def find(name: str) -> type[Compute]:
    """The class of a LAMMPS compute style; raises `InputError` with the nearest match."""
    return class_of("compute", name, Compute)


def __getattr__(name: str) -> type[Compute]:
    return class_called("compute", name, Compute)
