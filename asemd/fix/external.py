r"""Forces from another program: added after all interactions, by a Python function or from an array.

.. math:: F_i \leftarrow F_i + F_i^{ext}

``pf/callback Ncall Napply`` calls the function of `asemd.lammps.Lammps.set_fix_external_callback` every Ncall steps, ``pf/array Napply``
takes what `fix_external_get_force` gives; the forces are added every Napply steps. The scalar of this fix is the energy that was set,
elements of its vector those that were set.

The energy counts as potential energy, and the virial that was set counts on the steps on which forces are added (``fix_modify energy no``,
``virial no``: not). Energies and virials by atom, for computes pe/atom and stress/atom, are those that the function sets for its step; they
are zero on steps without a call.

Source: LAMMPS manual, fix external. Units: force, energy; virials in units of pressure times volume as energies.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from asemd.errors import InputError
from asemd.fix import Fix
from asemd.words import choice, take, whole, yes_no


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
    thermo_energy = thermo_virial = True

    def __init__(self, group: str = "all", call: int = 1, apply: int = 1):
        super().__init__(group)
        if call < 0 or apply < 1:
            raise InputError(f"fix external: Ncall and Napply must be at least 1, got {call} and {apply}")
        self.call, self.apply = call, apply
        self.energy, self.values, self.given = 0.0, np.zeros(0), np.zeros((0, 3))
        self.virial, self._energies, self._virials = np.zeros(6), np.zeros(0), np.zeros((0, 6))
        self.callback: Callable | None = None
        self.caller, self.asking = None, False      # asking: the function is at work

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
        self._begun = False

    def post_force(self, loop) -> None:
        """Ask for forces, add them."""
        system, step = loop.system, loop.trial_step if self.minimizing and self._begun else loop.step
        self._begun = True
        loop.sync_out()
        f = self.forces(system)
        self._energies, self._virials = np.zeros(system.n), np.zeros((system.n, 6))
        if self.call and step % self.call == 0:
            before = [] if self.caller is None else [self.caller]
            self.asking = True
            try:
                self.callback(*before, step, system.n, system.id, system.x, f)
            finally:
                self.asking = False
        if step % self.apply == 0:
            mask = loop.groups[self.group]
            system.f[mask] += f[mask]
            loop.state.f[:, loop.engine.slot_of] = system.f.T
            if self.thermo_virial:
                loop.state.virial[0] += self.virial

    def set_virial(self, virial: Sequence[float]) -> None:
        """(6,) xx yy zz xy xz yz of all external forces, energy units."""
        self.virial = _numbers(virial, (6,), f"fix {self.id} (style external): a virial")

    def set_energies(self, energies: Sequence[float]) -> None:
        """(n,) energies by row; for the step whose forces are asked for."""
        self._energies = _numbers(energies, self._energies.shape, f"fix {self.id} (style external): energies by atom")

    def set_virials(self, virials: Sequence[Sequence[float]]) -> None:
        """(n, 6) virials by row, xx yy zz xy xz yz, energy units; for the step whose forces are asked for."""
        self._virials = _numbers(virials, self._virials.shape, f"fix {self.id} (style external): virials by atom")

    def energies(self, state) -> np.ndarray:
        """(n,) energies that were set, zero without a call."""
        n = state.system.n
        return self._energies if len(self._energies) == n else np.zeros(n)

    def virials(self, state) -> np.ndarray:
        n = state.system.n
        return self._virials if len(self._virials) == n else np.zeros((n, 6))

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
        if keyword in ("energy", "virial"):
            setattr(self, f"thermo_{keyword}", yes_no(value, f"fix_modify {keyword}"))
            return True
        return super().modify_option(keyword, value, session)


def _numbers(values, shape: tuple[int, ...], what: str) -> np.ndarray:
    try:
        out = np.array(values, float)
    except (TypeError, ValueError):
        raise InputError(f"{what} must be numbers") from None
    if out.shape != shape:
        raise InputError(f"{what} must have the shape {shape}, got {out.shape}")
    return out
