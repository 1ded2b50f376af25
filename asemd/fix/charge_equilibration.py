r"""What fixes that find charges have in common: charges for which the electronegativity of all atoms of a group is the same.

.. math:: E(q) = \sum_i \left( \chi_i q_i + \tfrac12 \eta_i q_i^2 \right) + \sum_{i < j} J(r_{ij}) q_i q_j, \qquad
          \frac{\partial E}{\partial q_i} = \mu

for pairs within a cutoff. Atoms outside the group keep their charges and act on those of it (in LAMMPS only some do, and most fixes pass
over them). Forces and energies of a run are those of the
pair style for the charges; E itself is no part of them.

A. K. Rappe, W. A. Goddard, J. Phys. Chem. 95, 3358 (1991); A. Nakano, Comput. Phys. Commun. 104, 59 (1997).
"""
from __future__ import annotations

from abc import abstractmethod
from typing import Any, ClassVar

import numpy as np

from asemd.compute._pairs import half
from asemd.errors import InputError
from asemd.fix import Fix, sampled
from asemd.kspace.ewald import choose_waves
from asemd.population import recharge
from asemd.potential_file import PotentialFile, Record
from asemd.words import bounds, number, take, whole, yes_no

NAMES = "chi eta gamma zeta qcore"


class ChargeEquilibration(Fix):
    """Charges from their energy.

    Parameters
    ----------
    group : str
        The atoms whose charges are found.
    every : int
        Steps between two times.
    cutoff : float
        Of the interaction of two charges in their energy, distance units of the scene. Pairs are those of the pair style's neighbour list.
    tolerance : float
        How well.
    maxiter : int
        Iterations at most.
    parameters : str or mapping
        A file with lines ``type chi eta gamma zeta qcore``, or these numbers by type or by its label, which is an element in ASE.
    warn : bool
        Warn where `maxiter` iterations are not enough.

    Raises
    ------
    InputError
        Numbers out of range, a type without parameters; in a run: atoms without charges, no pair style.
    """

    levels = "outermost"
    minimizes = True
    restarts = ("peratom",)
    options: ClassVar[dict[str, int]] = {"warn": 1}

    def __init__(self, group: str = "all", every: int = 1, cutoff: float = 10.0, tolerance: float = 1e-6, maxiter: int = 200,
                 parameters: str | dict[int | str, dict[str, float]] | None = None, warn: bool = True):
        super().__init__(group)
        what = f"fix {self.style}"
        for name, value in (("Nevery", every), ("cutoff", cutoff), ("tolerance", tolerance), ("maxiter", maxiter)):
            if not value > 0:
                raise InputError(f"{what}: {name} must be positive, got {value:g}")
        self.find_every, self.maxiter, self.warn = int(every), int(maxiter), warn
        self.cutoff, self.tolerance = float(cutoff), float(tolerance)
        self.parameters_of = parameters
        self.history = np.zeros((0, 8))
        self.words: list[str] = []

    @classmethod
    def from_lammps(cls, group, words, session):
        what = f"fix {cls.style}"
        every, cutoff, tolerance, maxiter, file = take(list(words), 5, f"{what}: Nevery cutoff tolerance maxiter qfile")
        given = sampled.keywords(list(words[5:]), cls.options, what)
        fix = cls(group, whole(every, f"{what} Nevery"), number(cutoff, f"{what} cutoff"), number(tolerance, f"{what} tolerance"),
                  whole(maxiter, f"{what} maxiter"), file, **{k: cls.read_option(k, v[0]) for k, v in given.items()})
        fix.words = list(words)
        system = session.scene.need_system(what)
        fix.check(system, session.scene.interactions)
        if not session.scene.groups.mask(group, what).any():
            raise InputError(f"{what}: group {group} has no atoms")
        return fix

    @classmethod
    def read_option(cls, key: str, word: str):
        """The value of a keyword."""
        what = f"fix {cls.style} {key}"
        return yes_no(word, what) if key == "warn" else number(word, what)

    def to_lammps(self) -> list[str]:
        if not self.words:
            raise InputError(f"fix {self.style}: parameters from Python cannot be written as a script")
        return self.words

    def check(self, system, interactions) -> None:
        """Atoms must have charges, types parameters; these become arrays by type."""
        if system.q is None:
            raise InputError(f"fix {self.style} needs atom attribute q: use atom_style charge or full")
        ntypes = system.counts["ntypes"]
        found = self.from_pair_style(interactions) if isinstance(self.parameters_of, str) else self.parameters_of or {}
        if found is None:
            found = self.read(str(self.parameters_of), ntypes, system)
        self.of_type = {name: np.zeros(ntypes + 1) for name in NAMES.split()}
        for t in range(1, ntypes + 1):
            own = found.get(t, found.get(system.labels["atom"].get(t)))
            if own is None:
                raise InputError(f"fix {self.style}: atom type {t} has no parameters")
            for name, values in self.of_type.items():
                values[t] = own.get(name, 0.0)
            if problem := self.wrong({name: values[t] for name, values in self.of_type.items()}):
                raise InputError(f"fix {self.style}: atom type {t}: {problem}")

    def from_pair_style(self, interactions) -> dict[int, dict[str, float]] | None:
        """Parameters by type that a pair style has, if the word in the place of the file names one."""
        return None

    def wrong(self, numbers: dict[str, float]) -> str:
        """What is wrong with the parameters of a type."""
        return "" if numbers["eta"] > 0.0 else "eta must be positive"

    def read(self, name: str, ntypes: int, system) -> dict[int, dict[str, float]]:
        """Parameters by type from a file; a type may be a range, ``1*3``."""
        file, out = PotentialFile(name, f"fix {self.style}"), {}
        if file.units and file.units != system.units:
            raise file.error(f"the file is in {file.units} units, but {system.units} units are in use", 1)
        for line, text in file.lines:
            record = Record(text.split(), file.where(line), file.what)
            if len(record.words) != 6:
                raise file.error(f"a line needs a type and {NAMES}, got {len(record.words)} words", line)
            try:
                first, last = bounds(record.word("a type"), 1, ntypes, file.what, system.labels["atom"])
            except InputError as error:
                raise InputError(str(error), record.where) from None
            numbers = record.numbers(NAMES)
            for t in range(first, last + 1):
                out[t] = numbers
        return out

    # ---- hooks
    def atom_arrays(self, loop) -> np.ndarray:
        if len(self.history) != loop.system.n:
            self.history = np.zeros((loop.system.n, 8))
        return self.history

    def resize(self, loop) -> None:
        self.history = loop.fix_data[loop.fixes.index(self)][1] if len(loop.fix_data) > loop.fixes.index(self) else self.history

    def next_step(self, step: int) -> int:
        return step + 1 if self.minimizing else (step // self.find_every + 1) * self.find_every

    def setup_pre_force(self, loop) -> bool:
        """Charges before the first step."""
        self.check(loop.system, loop.interactions)
        if not loop.interactions.uses["pair"]:
            raise InputError(f"fix {self.style} needs a pair style, whose neighbour list it uses")
        if loop.step % self.find_every:
            return False
        self.find_charges(loop)
        choose_waves(loop.engine)
        return True

    def pre_force(self, loop) -> None:
        """New charges, where they are due."""
        if not self.minimizing or loop.trial_step % self.find_every == 0:
            self.find_charges(loop)

    def find_charges(self, loop) -> None:
        """Find the charges at the present positions and hand them over."""
        loop.sync_out()
        system, mask = loop.system, loop.groups[self.group]
        pairs = half(loop.snapshot(), self.cutoff)
        r, types = np.sqrt(pairs.r2), system.type
        numbers = {name: values[types] for name, values in self.of_type.items()}
        h, chi, diagonal = self.elements(loop, pairs.i, pairs.j, r, numbers)
        inside, outside = mask[pairs.i] & mask[pairs.j], mask[pairs.i] ^ mask[pairs.j]
        for a, b in ((pairs.i, pairs.j), (pairs.j, pairs.i)):
            acts = outside & mask[a]
            np.add.at(chi, a[acts], h[acts] * system.q[b[acts]])
        rows = np.flatnonzero(mask)
        place = np.cumsum(mask) - 1
        q = self.find(loop, rows, (place[pairs.i[inside]], place[pairs.j[inside]], h[inside], diagonal[rows]), chi[rows], numbers)
        self.hand_over(loop, rows, q)

    def elements(self, loop, i, j, r, numbers) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """J of pairs (m,), chi (n,) and the second derivative of the energy by each charge (n,)."""
        return 1.0 / r, numbers["chi"].copy(), numbers["eta"]

    @abstractmethod
    def find(self, loop, rows, matrix, chi, numbers: dict[str, Any]) -> np.ndarray:
        """Charges of the atoms `rows` (m,)."""

    def too_many(self, loop, error: float) -> None:
        """Say that the iterations have not been enough."""
        if self.warn:
            loop.warn(f"fix {self.style}: charges did not converge ({error:.3g}) within {self.maxiter} iterations at step {loop.step}")

    @staticmethod
    def hand_over(loop, rows: np.ndarray, q: np.ndarray) -> None:
        """From now on these are the charges."""
        loop.system.q[rows] = q
        recharge(loop)

    def state(self) -> dict:
        """The last charges, from which the next are guessed."""
        return {"history": self.history} if len(self.history) else {}

    def restore(self, state) -> None:
        self.history = np.array(state.get("history", self.history), float)
