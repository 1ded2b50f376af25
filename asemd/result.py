"""What goes into a computation of forces besides the scene, and what comes out."""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from asemd import units as unit_styles

COMPONENTS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))     # of tensors given as six numbers: xx yy zz xy xz yz


def with_masks(rules: list, mask: Callable[[str], np.ndarray]) -> list:
    """The exclusions of a scene, which name groups, in the form of `Settings`; `mask` gives the atoms of a group.

    ``("outside", group)`` (``neigh_modify include``) leaves out every pair with an atom outside the group.
    """
    out = []
    for kind, *words in rules:
        masks = words if kind == "type" else [mask(w) for w in words]
        out.append(("group", ~masks[0], np.ones(len(masks[0]), bool)) if kind == "outside" else (kind, *masks))
    return out


@dataclass
class Settings:
    """How lists are built and forces computed.

    Parameters
    ----------
    skin : float
        Extra distance of the neighbour list.
    every, delay, check
        When to rebuild, as in ``neigh_modify``.
    exclude : list
        ``("type", i, j)``, ``("group", mask_i, mask_j)``, ``("molecule/intra", mask)``, ``("molecule/inter", mask)``; masks (n,) bool.
    threads : int
    precision : str
        ``double``, or ``mixed``: pair arithmetic in single precision, sums in double.
    lost, lost_bond : str
        What a run does with atoms beyond a fixed face, and when one of them is bonded to an atom that stays: ``error``, or ``warn`` and
        ``ignore``, which take them out of the system, as ``thermo_modify``.
    """

    skin: float = 0.3
    every: int = 1
    delay: int = 0
    check: bool = True
    exclude: list = field(default_factory=list)
    threads: int = 1
    precision: str = "double"
    lost: str = "error"
    lost_bond: str = "error"

    @property
    def outdated(self) -> bool:
        """Whether atoms may move by more than the skin before the list is rebuilt."""
        return not self.check or self.every > 1 or self.delay > 1


@dataclass
class Result:
    """Energies, forces, virial of one configuration, in the units of the system.

    `virial` (6,): xx yy zz xy xz yz, sum of r_i f_i over all terms (energy units, without tail corrections);
    `virial_of` and `energies_of`, `virials_of`: the same by category.
    """

    energy: dict[str, float]
    virial: np.ndarray
    virial_of: dict[str, np.ndarray]
    system: object = field(repr=False)
    energies: np.ndarray | None = None
    virials: np.ndarray | None = None
    energies_of: dict[str, np.ndarray] = field(default_factory=dict)
    virials_of: dict[str, np.ndarray] = field(default_factory=dict)

    def take_shares(self, other: Result) -> None:
        """Have the shares of another result of the same evaluation."""
        self.energies, self.energies_of, self.virials, self.virials_of = other.energies, other.energies_of, other.virials, other.virials_of

    @property
    def forces(self) -> np.ndarray:
        """(n, 3) by atom row, until the next computation."""
        return self.system.f

    @property
    def potential(self) -> float:
        return float(sum(self.energy.values()))


@dataclass
class Snapshot:
    """What computes, thermo output and dumps see of a step.

    `gone`: group -> how many of its atoms were lost since the run began; `fresh`: `result` is of this step; `engine`: who made `result`,
    with its neighbour list.
    """

    system: object
    result: Result
    groups: dict[str, np.ndarray]
    dt: float
    step: int = 0
    fixes: list = field(default_factory=list)
    gone: dict[str, int] = field(default_factory=dict)
    fresh: bool = True
    engine: object = field(default=None, repr=False, compare=False)

    def __getstate__(self):
        return {**self.__dict__, "engine": None}      # it holds compiled code

    @property
    def units(self):
        return unit_styles.get(self.system.units)

    @property
    def dimension(self) -> int:
        return self.system.dimension

    def mask(self, group: str) -> np.ndarray:
        return self.groups[group]
