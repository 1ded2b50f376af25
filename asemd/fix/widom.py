r"""Excess chemical potential by trial insertions of atoms or molecules that are taken back at once.

Every N steps M insertions are tried at random places, molecules in random orientations:

$$\mu_{ex} = -k_B T \ln \left\langle e^{-\Delta E / k_B T} \right\rangle$$

with the mean over the insertions of that step. Energies are those of pairs with the trial atoms; with ``full_energy`` those of the whole
system, of which only the difference is computed. The places are LAMMPS's.

Source: B. Widom, J. Chem. Phys. 39, 2808 (1963); D. Frenkel, B. Smit, Understanding Molecular Simulation, Academic Press (2002). Units:
temperature, energy. Output: a vector, excess chemical potential, mean of the exponential, volume of the region or box.
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.fix import NEVER, Fix
from asemd.fix.atom_order import AtomOrder
from asemd.fix.reservoir import Reservoir, check_scene, find_molecule, find_region, gas_type, read, region_volume
from asemd.random import ParkMiller
from asemd.words import number, take, whole

VALUES = {"mol": 1, "region": 1, "full_energy": 0, "charge": 1, "intra_energy": 1}


class Widom(Fix):
    """Trial insertions.

    Parameters
    ----------
    group : str
        The atoms that must belong to molecules if molecules are inserted.
    every : int
        Steps between two series.
    insertions : int
        In each series.
    kind : int
        Type of the atoms that are inserted; 0 with `molecule`.
    seed : int
        Positive.
    temperature : float
        Temperature units.
    molecule : Molecule, optional
        What is inserted instead of single atoms.
    region : Region, optional
        Where.
    full_energy : bool
        Energies of the whole system.
    charge : float, optional
        Of inserted atoms.
    intra_energy : float
        Energy of a molecule by itself, subtracted with `full_energy`, energy units.

    Raises
    ------
    InputError
        Numbers that make no sense, a region without end.
    """

    style = "widom"
    size = 3
    extensive = False
    what = "fix widom"
    overlap = 0.0

    def __init__(self, group: str = "all", every: int = 1, insertions: int = 1, kind: int = 0, seed: int = 1, temperature: float = 1.0,
                 molecule=None, region=None, full_energy: bool = False, charge: float | None = None, intra_energy: float = 0.0):
        super().__init__(group)
        if every < 1 or insertions < 0:
            raise InputError(f"fix widom: N must be at least 1 and M must not be negative, got {every} and {insertions}")
        if not temperature > 0.0:
            raise InputError(f"fix widom: T must be positive, got {temperature:g}")
        if molecule is not None and kind:
            raise InputError(f"fix widom mol: the atom type must be 0 with molecules, got {kind}")
        self.interval, self.insertions, self.kind, self.seed, self.temperature = every, insertions, kind, seed, temperature
        self.molecule, self.region, self.full_energy = molecule, region, full_energy
        self.charge, self.intra_energy, self.by_molecule = charge, intra_energy, molecule is not None
        self.random = ParkMiller(seed)
        self.volume = region_volume(region, self.random, self.what) if region is not None else 0.0
        self.mean, self.seen, self.beta = 0.0, 0.0, math.nan
        self.storage, self.as_lammps, self.held_tail = AtomOrder(0), False, None
        self.words: list[str] = []

    @classmethod
    def from_lammps(cls, group, words, session):
        every, insertions, kind, seed, temperature = take(words, 5, "fix widom N M type seed T")
        given, scene = read(words[5:], VALUES, cls.what), session.scene
        charge = number(given["charge"][0], "fix widom charge") if "charge" in given else None
        if charge is not None and scene.system.q is None:
            raise InputError("fix widom charge: the atoms have no charges; use atom_style charge or full")
        molecule = find_molecule(given.get("mol"), scene, cls.what)
        fix = cls(group, whole(every, "fix widom N"), whole(insertions, "fix widom M"), gas_type(kind, scene, molecule, cls.what),
                  whole(seed, "fix widom seed"), number(temperature, "fix widom T"), molecule,
                  find_region(given.get("region"), scene, cls.what), "full_energy" in given, charge,
                  number(given.get("intra_energy", ["0"])[0], "fix widom intra_energy"))
        fix.words, fix.next_reneighbor, fix.as_lammps = list(words), scene.step + 1, True
        return fix

    def to_lammps(self) -> list[str]:
        if not self.words:
            raise InputError("fix widom: this one was made in Python and has no script form")
        return self.words

    def setup(self, loop) -> None:
        check_scene(self, loop)
        self.beta = 1.0 / (loop.units.boltz * self.temperature)
        self.mean, self.seen = 0.0, self.volume if self.region is not None else loop.system.box.volume
        if self.next_reneighbor < 0:        # made in Python
            self.next_reneighbor = loop.step + 1

    def next_list(self, step: int) -> int:
        return NEVER

    def pre_exchange(self, loop) -> None:
        """On its steps: a series of insertions."""
        if loop.step != self.next_reneighbor:
            return
        self.next_reneighbor += self.interval
        if loop.engine.box_moves:
            loop.sync_out()
        self.mean = 0.0
        trial = Reservoir(self, loop)
        self.seen = trial.volume
        for k in range(self.insertions):
            at = trial.point()
            if at is None:
                break
            self.mean += (math.exp(-self.beta * min(trial.insertion_energy(at), 1e300)) - self.mean) / (k + 1)

    def vector(self, i: int) -> float:
        """1: excess chemical potential, 0 where no insertion had a finite energy; 2: mean of exp(-energy / kT); 3: volume."""
        if i not in (1, 2, 3):
            raise InputError(f"fix {self.id} (style {self.style}): its vector has 3 components, not {i}")
        return ((-math.log(self.mean) / self.beta if self.mean > 0.0 else 0.0), self.mean, self.seen)[i - 1]

    def state(self) -> dict:
        return {"random": self.random.state, "next": self.next_reneighbor, "mean": self.mean, "seen": self.seen, "beta": self.beta}

    def restore(self, state: dict) -> None:
        self.random.state, self.next_reneighbor = int(state["random"]), int(state["next"])
        self.mean, self.seen, self.beta = (float(state[k]) for k in ("mean", "seen", "beta"))


__all__ = ["Widom"]
