"""Long-range solvers: what a cutoff leaves out of an interaction that falls off slowly, one file for each ``kspace_style``.

A solver is made from the words of ``kspace_style`` and the keywords of ``kspace_modify`` (`asemd.kspace_settings`). Before a run, `solve`
gives it the charges and the box; it chooses its splitting parameter and mesh, and says them to the pair styles (`KSpace.constants`) whose
parts take ``g_ewald``. During the run it is a term like others (`KSpace.term`).

Whatever decides about digits is LAMMPS's: choice of the parameters, estimates of errors, constants.
"""
from __future__ import annotations

import math
import re
import warnings
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from asemd import words as read
from asemd.box import Box
from asemd.errors import InputError, InputWarning
from asemd.kspace_settings import DEFAULTS
from asemd.registry import class_of

__all__ = ["NEUTRAL", "KSpace", "hold", "solve", "tell_charge"]
CUT = re.compile("coul/(cut|debye|dsf|wolf|charmm|gromacs)")      # pair styles that leave nothing to a solver
NEUTRAL = 1e-5     # charges that add up to more are told of
MOST = 16384       # points of a mesh along an edge, as in LAMMPS
EXAMPLES = ("pppm", "ewald", "pppm/disp", "ewald/disp", "msm")      # the first one that fits is named in messages


class KSpace(ABC):
    """A long-range solver.

    Parameters
    ----------
    accuracy : float
        Wanted root mean square error of forces, relative to the force between two unit charges one Angstrom apart.
    modify : mapping, optional
        Keywords of ``kspace_modify`` with their values; those left out have their defaults.

    Attributes
    ----------
    g_ewald : float
        Splitting parameter, 1/distance, after `prepare`.
    n, qsum, qsqsum, q2, prd, upright, volume
        After `prepare`: atoms, sum of charges and of their squares, the latter in energy times distance, edge lengths, vectors (in LAMMPS's
        frame) and volume of the box, its third vector stretched for slabs, the others for wires.
    skin : float
        Of the neighbour list.
    """

    style = ""
    flag = ""                   # what a pair style must have in `solvers` to work with this one
    partner = "lj/cut/coul/long"
    takes_slab = True
    takes_wire = False
    nozforce = 2.0              # what kernels are told of ``slab nozforce``: no force along z
    ew2d = 0.0                  # and of ``slab ew2d``: no correction of a slab, as for solvers of electrodes, which make their own
    adds = True                 # it has energy and forces
    groups = False              # compute group/group can ask for the interaction of two groups
    least = 0.0                 # charges not above are passed over
    coulomb = True              # a pair style leaves it the Coulomb interaction
    usual_order = 5             # of the interpolation, where kspace_modify says none
    g_ewald = skin = 0.0

    def __init__(self, accuracy: float, modify: Mapping[str, Any] | None = None):
        self.accuracy_relative = float(accuracy)
        self.given = dict(modify or {})
        self.modify = {**DEFAULTS, "order": self.usual_order, **self.given}

    @classmethod
    def from_words(cls, words: Sequence[str], modify: Mapping[str, Any] | None = None) -> KSpace:
        """The solver that ``kspace_style NAME WORDS`` asks for.

        Raises
        ------
        InputError
            A wrong number of words, an accuracy that is not a positive number.
        """
        if len(words) != 1:
            raise InputError(f"kspace_style {cls.style} needs one number, the accuracy, got {len(words)} words")
        return cls(cls.read_accuracy(words[0]), modify)

    @classmethod
    def read_accuracy(cls, word: str) -> float:
        """A positive number, at most 1."""
        value = abs(read.number(word, f"kspace_style {cls.style}: accuracy"))
        if value == 0.0:
            raise InputError(f"kspace_style {cls.style}: the accuracy must not be 0")
        if value > 1.0:
            raise InputError(f"kspace_style {cls.style}: the relative accuracy must be at most 1, got {word}")
        return value

    # ------------------------------------------------------------------------------------------------------ what a scene needs
    def check(self, system) -> None:
        """Whether this solver can work in that box.

        Raises
        ------
        InputError
            Two dimensions, no charges, a box that is not periodic as it must be.
        """
        name, periodic = f"kspace_style {self.style}", np.array(system.box.periodic, bool)
        if system.dimension == 2:
            raise InputError(f"{name} needs three dimensions, this scene has two")
        if system.q is None and self.coulomb:
            raise InputError(f"{name} needs atom attribute q: use atom_style charge or full")
        if self.wire:
            if not self.takes_wire:
                raise InputError(f"{name} does not take kspace_modify wire; ewald and pppm do")
            if self.slab is not None:
                raise InputError(f"{name} takes kspace_modify slab or wire, not both")
            if not periodic[2] or any(tuple(b) != ("f", "f") for b in system.box.boundary[:2]):
                raise InputError(f"{name} with kspace_modify wire needs boundary f f p (of ase.Atoms pbc = 0 0 1), "
                                 f"here it is {' '.join(system.box.boundary)}")
            if self._tilted(system):
                raise InputError(f"{name}: kspace_modify wire needs a box that is not triclinic")
            if abs(system.q.sum()) > 1e-5:
                raise InputError(f"{name}: with kspace_modify wire charges must add up to 0, here they add up to {system.q.sum():g}")
            return
        if self.slab is not None:
            if not self.takes_slab:
                raise InputError(f"{name} does not take kspace_modify slab")
            if not periodic[:2].all() or tuple(system.box.boundary[2]) != ("f", "f"):
                raise InputError(f"{name} with kspace_modify slab needs boundary p p f (of ase.Atoms pbc = 1 1 0), "
                                 f"here it is {' '.join(system.box.boundary)}")
            if np.count_nonzero(system.box.cell[2, :2]) or np.count_nonzero(system.box.cell[:2, 2]):
                raise InputError(f"{name}: kspace_modify slab needs a third box vector along z and the others across it")
        elif not periodic.all():
            raise InputError(f"{name} needs a box that is periodic in all directions, here is boundary {' '.join(system.box.boundary)}; "
                             "for slabs use boundary p p f and kspace_modify slab 3.0, for wires boundary f f p and kspace_modify wire "
                             "3.0, or msm for any boundary")

    @staticmethod
    def _tilted(system) -> bool:
        return bool(system.box.triclinic) or bool(np.count_nonzero(system.box.cell - np.diag(np.diag(system.box.cell))))

    @property
    def slab(self) -> float | str | None:
        """Extended volume of a slab, ``nozforce``, ``ew2d``, or None."""
        value = self.modify["slab"]
        return value if "slab" in self.given and value != 1.0 else None

    @property
    def wire(self) -> bool:
        """Whether the box is periodic along a wire only."""
        return "wire" in self.given

    @property
    def stretch(self) -> np.ndarray:
        """By what each vector is longer for the solver (3,)."""
        across = self.modify["wire"]
        return np.array([across, across, self.slab if isinstance(self.slab, float) else 1.0])

    def prepare(self, system, interactions, units, cutoff: float) -> None:
        """Take charges and box, choose parameters.

        Parameters
        ----------
        cutoff : float
            Of the pair style's Coulomb part.
        """
        self.check(system)
        if self.slab == "ew2d":
            warnings.warn(f"kspace_style {self.style}: slab ew2d is for solvers of electrodes, this one does not sum in two dimensions; "
                          "slab 3.0 comes close to that", InputWarning, stacklevel=2)
        self.cutoff, self.scale = float(cutoff), interactions.coulomb_constant(units) / interactions.dielectric
        self.count(system)
        self.factor = interactions.kspace_factor
        upright = system.box.to_lammps()[0].cell
        self.inner = np.diag(upright).copy()          # without the empty volume of slabs and wires
        self.prd, self.upright = self.inner * self.stretch, upright * self.stretch[:, None]
        self.volume = float(self.prd.prod())
        two_charges = interactions.coulomb_constant(units) * units.qelectron**2 / units.angstrom**2
        self.two_charges = two_charges
        self.accuracy = self.modify["force"] if self.modify["force"] >= 0.0 else self.accuracy_relative * two_charges
        if self.modify["gewald"] < 0.0:
            raise InputError(f"kspace_modify gewald must not be negative, got {self.modify['gewald']:g}")
        try:
            self.g_ewald = self.modify["gewald"] or self.first_guess()
            self.choose(system)
        except ArithmeticError:
            raise self.impossible(self.q2) from None

    def tilted(self, mesh) -> np.ndarray:
        """Mesh points (3,) along the vectors of a tilted box, from those along x, y and z; not rounded to whole numbers."""
        return (np.abs(self.upright) * (np.asarray(mesh) / self.prd)).sum(axis=1)       # a product of matrices may have other last bits

    def count(self, system) -> None:
        """Take the sums over atoms that there are now, as LAMMPS does within a run; parameters stay."""
        q = np.asarray(system.q if self.coulomb else np.zeros(system.n), float)
        self.n, self.qsum, self.qsqsum = max(system.n, 1), float(q.sum()), float(q @ q)
        self.q2 = self.charge_squares(system, q) * self.scale

    def charge_squares(self, system, q: np.ndarray) -> float:
        """The sum of squared charges that estimates of errors take."""
        return self.qsqsum

    def first_guess(self) -> float:
        """The splitting parameter that makes the error of the pair part the one asked for.

        Raises
        ------
        InputError
            There is no charge, or no accuracy.
        """
        if self.accuracy <= 0.0:
            raise InputError(f"kspace_style {self.style}: the accuracy must be positive")
        if self.q2 == 0.0:
            raise InputError(f"kspace_style {self.style}: all charges are 0; give kspace_modify gewald, or use no kspace_style")
        g = self.share_of_error(self.q2)
        return (1.35 - 0.15 * math.log(self.accuracy)) / self.cutoff if g >= 1.0 else math.sqrt(-math.log(g)) / self.cutoff

    def share_of_error(self, squares: float) -> float:
        """The accuracy in units of the error that the pair part would make without splitting; `squares` as `q2`.

        Raises
        ------
        InputError
            It has no logarithm.
        """
        error = 2.0 * squares
        share = self.accuracy * math.sqrt(self.n * self.cutoff * self.inner.prod()) / error if math.isfinite(error) else 0.0
        if not 0.0 < share < math.inf:
            raise self.impossible(squares)
        return share

    def impossible(self, squares: float) -> InputError:
        """The message where numbers are too large or too small."""
        return InputError(f"kspace_style {self.style}: could not compute g_ewald and mesh for accuracy {self.accuracy_relative:g}, Coulomb "
                          f"cutoff {self.cutoff:g}, a sum of squared charges or dipoles of {squares:g} (in energy) and box lengths "
                          f"{' '.join(f'{x:g}' for x in self.prd)}: check these numbers and kspace_modify")

    def too_large(self, mesh=()) -> InputError:
        """The message where a mesh, of one or three numbers, or without them a sum over waves does not fit into memory."""
        needs = f"mesh {' '.join(map(str, mesh))}{' along an edge' * (len(mesh) == 1)}" if len(mesh) else "sum over waves"
        return InputError(f"kspace_style {self.style}: the {needs} for accuracy {self.accuracy_relative:g} and Coulomb cutoff "
                          f"{self.cutoff:g} is too large; use a lower accuracy, a larger Coulomb cutoff, or kspace_modify")

    @abstractmethod
    def choose(self, system) -> None:
        """Vectors or mesh for the accuracy."""

    @property
    def constants(self) -> dict[str, float]:
        """What pair styles take besides their own settings."""
        return {"g_ewald": self.g_ewald}

    @property
    def real_error(self) -> float:
        """Estimated error of forces that the pair part makes."""
        x = self.g_ewald * self.cutoff
        return 2.0 * self.q2 * math.exp(-x * x) / math.sqrt(self.n * self.cutoff * self.volume)

    def lines(self) -> list[str]:
        """What LAMMPS's log says of the solver."""
        return []

    @abstractmethod
    def terms(self, engine) -> list:
        """The `asemd.term.Term` of this solver, or several."""

    def serves(self, use) -> bool:
        """Whether that pair style may stand beside the solver."""
        return self.flag in use.style.works_with(use.settings)

    def take(self, uses, interactions, system) -> float:
        """Look at the pair styles that leave their long-range part to this solver; returns the cutoff of that part.

        Raises
        ------
        InputError
            Cutoffs of several pair styles differ.
        """
        whole = [use.settings["cut"] for use in uses if not use.style.parts]      # no sum of parts, with one cutoff
        whole += [cut for use in uses if use.style.from_files for cut in use.style.long_cutoffs(use)]
        return self.one_cutoff(whole + [use.settings[part.cut] for use in uses for part in use.style.variant(use.settings).parts
                                        if part.long or (part.charged and not use.style.solvers)])

    def cutoff_of(self, parts) -> float:
        """The cutoff that all of these parts have, pairs of a `Use` and a part of its style."""
        return self.one_cutoff([use.settings[part.cut] for use, part in parts])

    def one_cutoff(self, values) -> float:
        """The cutoff that all of these are."""
        cutoffs = {float(value) for value in values}
        if len(cutoffs) > 1:
            raise InputError(f"Coulomb cutoffs of the sub-styles differ ({', '.join(f'{c:g}' for c in sorted(cutoffs))}): "
                             f"kspace_style {self.style} needs one")
        return cutoffs.pop()


def solve(system, interactions, units, skin: float, kept: KSpace | None = None) -> KSpace | None:
    """The solver of a scene, ready; None without ``kspace_style``. `interactions.long_range` gets what pair styles must know; `skin` is
    that of the neighbour list. A solver that is `kept` in the midst of a run counts atoms and charges anew, and no more.

    Raises
    ------
    InputError
        Solver and pair styles do not belong together, cutoffs of several pair styles differ, the box does not fit.
    """
    if kept is not None:
        kept.count(system)
        return kept
    interactions.long_range = {}
    uses = [use for use in interactions.uses["pair"] if use.style.needs(use.settings)]
    if interactions.kspace == "none":
        if uses:
            needed = uses[0].style.needs(uses[0].settings)
            example = next((name for name in EXAMPLES if name in needed), min(needed))
            raise InputError(f"pair style {uses[0].style.name} needs a kspace_style, such as {example} 1.0e-4")
        return None
    name, *words = interactions.kspace.split()
    solver = class_of("kspace", name, KSpace).from_words(words, interactions.kspace_modify)
    mine = [use for use in interactions.uses["pair"] if solver.serves(use)]
    if not mine:
        raise InputError(f"kspace_style {name} needs a pair style that leaves it the long-range part, such as {solver.partner}")
    twice = [use.label for use in interactions.uses["pair"] if solver.adds and CUT.search(use.style.name)]
    if twice:
        long = "coul/msm" if solver.flag == "msm" else "coul/long"
        warnings.warn(f"pair style {twice[0]} has all of the Coulomb energy of its pairs, of which kspace_style {name} has a part too: "
                      f"charges count twice; use {long} for all pairs", InputWarning, stacklevel=2)
    solver.skin = skin
    solver.prepare(system, interactions, units, solver.take(mine, interactions, system))
    interactions.long_range = solver.constants
    return solver


def tell_charge(solver: KSpace | None) -> None:
    """Warn of charges that do not add up to 0: with a solver the box has a uniform charge that neutralises them."""
    if solver is not None and solver.coulomb and abs(solver.qsum) > NEUTRAL:
        warnings.warn(f"System is not charge neutral, net charge = {solver.qsum:.8g}", InputWarning, stacklevel=3)


def hold(system, cell) -> None:
    """The box of atoms from ASE becomes one for slabs or wires: faces that are not periodic stay where the cell has them.

    Parameters
    ----------
    system : System
    cell : (3, 3) array
        As ASE has it: a vector that is zero has no face.

    Raises
    ------
    InputError
        A cell vector is zero, an atom is outside of the cell.
    """
    box, zero = system.box, ~np.any(cell, axis=1)
    if zero.any():
        raise InputError(f"kspace_modify slab and wire need three cell vectors, {'abc'[int(np.argmax(zero))]} is zero: give the cell the "
                         "height of the slab, for example by atoms.center(vacuum=5, axis=2)")
    system.box = box = Box(box.origin, box.cell, tuple("pp" if p else "ff" for p in box.periodic))
    out = box.beyond(system.x)
    if out.any():
        k, axis = np.argwhere(out)[0]
        raise InputError(f"kspace_modify slab and wire need all atoms inside of the cell: atom {system.id[k]} is outside of it along "
                         f"{'abc'[axis]}; move the atoms, for example by atoms.center(axis={axis}), or make the cell larger")
