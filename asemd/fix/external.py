r"""Forces from another program: added after all interactions, by a Python function or from an array.

.. math:: F_i \leftarrow F_i + F_i^{ext}

``pf/callback Ncall Napply`` calls the function of `asemd.lammps.Lammps.set_fix_external_callback` every Ncall steps, ``pf/array Napply``
takes what `fix_external_get_force` gives; the forces are added every Napply steps. The scalar of this fix is the energy that was set,
elements of its vector those that were set.

Source: LAMMPS manual, fix external. Units: force, energy.
"""
from __future__ import annotations

from collections.abc import Callable

import numpy as np

from asemd.errors import InputError
from asemd.fix import Fix
from asemd.words import choice, take, whole


class External(Fix):
    """Forces from outside.

    Parameters
    ----------
    group : str
        The atoms whose forces are changed.
    call, apply : int
        Steps between calls of the function (0: there is none, the array is used), and between additions.

    Raises
    ------
    InputError
        Intervals below 1.
    """

    style = "external"
    minimizes = True

    def __init__(self, group: str = "all", call: int = 1, apply: int = 1):
        super().__init__(group)
        if call < 0 or apply < 1:
            raise InputError(f"fix external: Ncall and Napply must be at least 1, got {call} and {apply}")
        self.call, self.apply = call, apply
        self.energy, self.values, self.given = 0.0, np.zeros(0), np.zeros((0, 3))
        self.callback: Callable | None = None
        self.caller = None

    @classmethod
    def from_lammps(cls, group, words, session):
        mode = choice(take(words, 1, "fix external")[0], ("pf/callback", "pf/array"), "fix external")
        count = 2 if mode == "pf/callback" else 1
        if len(words) != 1 + count:
            need = "Ncall Napply" if count == 2 else "Napply"
            raise InputError(f"fix external {mode} needs {need}, got {' '.join(words[1:]) or 'nothing'}")
        numbers = [whole(w, f"fix external {mode}") for w in words[1:]]
        if min(numbers) < 1:
            raise InputError(f"fix external {mode}: intervals must be at least 1, got {min(numbers)}")
        return cls(group, numbers[0] if count == 2 else 0, numbers[-1])

    def to_lammps(self) -> list[str]:
        return ["pf/callback", str(self.call), str(self.apply)] if self.call else ["pf/array", str(self.apply)]

    def set_callback(self, function: Callable, caller=None) -> None:
        """The function ``f([caller,] step, nlocal, ids, x, f)``; `caller` is handed over unless it is None."""
        self.callback, self.caller = function, caller

    def forces(self, system) -> np.ndarray:
        """(n, 3) array of the forces to be added, by row."""
        if len(self.given) != system.n:
            self.given = np.zeros((system.n, 3))
        return self.given

    def setup(self, loop) -> None:
        if self.call and self.callback is None:
            raise InputError(f"fix {self.id} (style external) pf/callback has no function: use set_fix_external_callback")
        self._first = loop.step

    def post_force(self, loop) -> None:
        """Ask for forces, add them."""
        system, step = loop.system, loop.step
        loop.sync_out()
        f = self.forces(system)
        if self.call and (step % self.call == 0 or step == self._first):
            before = [] if self.caller is None else [self.caller]
            self.callback(*before, step, system.n, system.id, system.x, f)
        if step % self.apply == 0 or step == self._first:
            mask = loop.groups[self.group]
            system.f[mask] += f[mask]
            loop.state.f[:, loop.engine.slot_of] = system.f.T

    def set_virial(self, virial) -> None:
        raise InputError(f"fix {self.id} (style external): a virial of external forces is not supported")

    def scalar(self) -> float:
        return self.energy

    @property
    def size(self) -> int:
        """How many elements the vector has."""
        return len(self.values)

    def vector(self, i: int) -> float:
        if not 1 <= i <= len(self.values):
            raise InputError(f"fix {self.id} (style external) has {len(self.values)} vector elements, not {i}")
        return float(self.values[i - 1])

    def modify_option(self, keyword, value, session):
        if keyword == "energy" and value in ("yes", "on", "true"):
            self.thermo_energy = True
            return True
        return super().modify_option(keyword, value, session)
