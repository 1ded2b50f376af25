r"""Grand canonical Monte Carlo: atoms or molecules are exchanged with an ideal gas reservoir and moved, with or without dynamics.

Every N steps X exchanges (insertions and deletions in equal parts) and M moves (translations, for molecules also rotations) are tried.
With :math:`\beta = 1 / k_B T`, thermal wavelength :math:`\Lambda` (1 in units lj) and n gas atoms in volume V, acceptance is

$$z = e^{\beta\mu} / \Lambda^3,\quad P_{insert} = \frac{z V}{n + 1} e^{-\beta \Delta E},\quad
P_{delete} = \frac{n}{z V} e^{-\beta \Delta E},\quad P_{move} = e^{-\beta \Delta E}$$

with :math:`z = \beta \phi P` if a pressure P (and fugacity coefficient :math:`\phi`) is given. Energies are those of pairs with the trial
atoms; with ``full_energy`` those of the whole system, of which only the difference is computed. Random numbers, their order and the order
in which atoms are chosen are LAMMPS's of one process, so that the same moves are accepted.

In a script all is as LAMMPS does it: without ``full_energy`` only images of atoms within cutoff and skin of the box count (let the skin be
at least ``displace``), gas atoms of other types have the energy of the exchanged type, and inserted atoms have no charge once they are
there; in a region the newest molecule is neither moved nor deleted; a tail correction follows a deletion late; single atoms of molecules
(``mcmoves``) have no energy without ``full_energy``; new bodies of fix rigid/small (``rigid``) are put beside their atoms by the
geometric centre of the template file, so that file should have it at the origin, and the last of them is not deleted. Made in Python, the
fix has none of these.

If the gas feels a long-range solver, each attempt solves for all atoms anew, with the parameters that the solver has in this run; with
potentials of many bodies (eam), orientations, charges on sites (tip4p) or dielectrics it computes all energies anew.

Molecules that fix rigid/small or fix shake holds are exchanged (not moved) with ``rigid`` or ``shake`` and the ID of that fix, which must
name the same template (``mol``).

Source: D. Frenkel, B. Smit, Understanding Molecular Simulation, Academic Press (2002); LAMMPS manual, fix gcmc. Units: temperature, energy,
distance, degrees. Output: a vector, attempts and successes of translations, insertions, deletions and rotations.
"""
from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from asemd.errors import InputError
from asemd.fix import Fix
from asemd.fix import holder as holders
from asemd.fix.atom_order import AtomOrder, sort_if_due, storage_of
from asemd.fix.gcmc_moves import Moves
from asemd.fix.reservoir import check_scene, find_molecule, find_region, gas_type, read, region_volume
from asemd.random import ParkMiller
from asemd.words import bounds, number, take, whole

VALUES = {"mol": 1, "mcmoves": 3, "region": 1, "maxangle": 1, "pressure": 1, "fugacity_coeff": 1, "full_energy": 0, "charge": 1,
          "group": 1, "grouptype": 2, "intra_energy": 1, "tfac_insert": 1, "overlap_cutoff": 1, "min": 1, "max": 1, "rigid": 1, "shake": 1}
NUMBERS = ("maxangle", "pressure", "fugacity_coeff", "charge", "intra_energy", "tfac_insert", "overlap_cutoff")


class GCMC(Fix):
    """Exchange with a reservoir.

    Parameters
    ----------
    group : str
        The gas: what may go or be moved; inserted atoms belong to it.
    every : int
        Steps between two series.
    exchanges, moves : int
        Attempts in each series, on average.
    kind : int
        Type of the atoms that are inserted; 0 with `molecule`.
    seed : int
        Positive.
    temperature : float
        Of the reservoir, temperature units.
    mu : float
        Chemical potential, energy units.
    displace : float
        Longest translation, distance units.
    molecule : Molecule, optional
        What is exchanged instead of single atoms.
    chances : sequence of 3 float, optional
        How often atoms are moved, molecules moved and molecules turned; by default atoms, or molecules in equal parts.
    region : Region, optional
        Where exchanges and moves take place.
    max_angle : float
        Largest rotation, degrees.
    pressure : float, optional
        Of the reservoir, pressure units; takes the place of `mu`.
    fugacity : float
        Its fugacity coefficient.
    full_energy : bool
        Energies of the whole system decide.
    charge : float, optional
        Of inserted atoms.
    groups : sequence of str
        Groups that inserted atoms belong to besides.
    type_groups : sequence of (int, str)
        The same for atoms of a type.
    intra_energy : float
        Energy of a molecule by itself, subtracted with `full_energy`, energy units.
    velocity_factor : float
        Temperature of inserted atoms over that of the reservoir.
    overlap : float
        Positions nearer to an atom are refused, distance units.
    least, most : int
        Limits of the number of gas atoms.
    holder : (str, str), optional
        ``rigid`` or ``shake`` and the id of the fix of such a style that holds the molecules, whose `template` is that of this one; they
        are not moved then.

    Raises
    ------
    InputError
        Numbers that make no sense, a region without end.
    """

    style = "gcmc"
    size = 8
    extensive = False
    what = "fix gcmc"

    def __init__(self, group: str = "all", every: int = 1, exchanges: int = 0, moves: int = 0, kind: int = 0, seed: int = 1,
                 temperature: float = 1.0, mu: float = 0.0, displace: float = 0.0, molecule=None, chances: Sequence[float] | None = None,
                 region=None, max_angle: float = 10.0, pressure: float | None = None, fugacity: float = 1.0, full_energy: bool = False,
                 charge: float | None = None, groups: Sequence[str] = (), type_groups: Sequence[tuple[int, str]] = (),
                 intra_energy: float = 0.0, velocity_factor: float = 1.0, overlap: float = 0.0, least: int = -1, most: int = 2**31 - 1,
                 holder: tuple[str, str] | None = None):
        super().__init__(group)
        if every < 1 or exchanges < 0 or moves < 0:
            raise InputError(f"fix gcmc: N must be at least 1, X and M must not be negative, got {every} {exchanges} {moves}")
        if not temperature > 0.0 or displace < 0.0 or overlap < 0.0 or velocity_factor < 0.0:
            raise InputError("fix gcmc: T must be positive; displace, overlap_cutoff and tfac_insert must not be negative")
        if chances is not None and (min(chances) < 0.0 or not sum(chances) > 0.0):
            raise InputError("fix gcmc mcmoves: must not be negative, and one must be positive")
        if molecule is not None and kind:
            raise InputError(f"fix gcmc mol: the atom type must be 0 with molecules, got {kind}")
        if holder is not None and moves > 0:
            raise InputError(f"fix gcmc: cannot use {holder[0]} with MC moves: M must be 0, got {moves}")
        self.interval, self.exchanges, self.moves, self.kind, self.seed = every, exchanges, moves, kind, seed
        self.temperature, self.mu, self.displace, self.molecule = temperature, mu, displace, molecule
        self.region, self.max_angle, self.reservoir_pressure, self.fugacity = region, max_angle, pressure, fugacity
        self.full_energy, self.charge, self.groups, self.type_groups = full_energy, charge, tuple(groups), tuple(type_groups)
        self.intra_energy, self.velocity_factor, self.overlap = intra_energy, velocity_factor, overlap
        self.least, self.most = least, most
        self.by_molecule = molecule is not None or (chances is not None and moves > 0 and (chances[1] > 0.0 or chances[2] > 0.0))
        usual = (1.0, 0.0, 0.0) if molecule is None else (0.0, 0.5, 0.5)
        self.chances = usual if chances is None else tuple(c / sum(chances) for c in chances)
        self.random, self.other = ParkMiller(seed), ParkMiller(seed)      # of all processes together, and of one of them
        self.volume = region_volume(region, self.random, self.what) if region is not None else 0.0
        self.counts = np.zeros(8)
        self.storage = AtomOrder()
        self.as_lammps = False      # to the last of its peculiarities, which are named above
        self.held_tail: float | None = None
        self.words: list[str] = []
        self.holder, self.template, self.holds = holder, "", None

    @classmethod
    def from_lammps(cls, group, words, session):
        every, exchanges, moves, kind, seed, temperature, mu, displace = take(words, 8, "fix gcmc N X M type seed T mu displace")
        given = read(words[8:], VALUES, cls.what)
        scene, numbers = session.scene, {k: number(given[k][0], f"fix gcmc {k}") for k in NUMBERS if k in given}
        charged = numbers.get("charge")
        if charged is not None and scene.system.q is None:
            raise InputError("fix gcmc charge: the atoms have no charges; use atom_style charge or full")
        for name in [*(g[0] for g in given.get("groups", [])), *(g[1] for g in given.get("grouptypes", []))]:
            scene.groups.mask(name, "fix gcmc group")
        molecule = find_molecule(given.get("mol"), scene, cls.what)
        types, labels = scene.system.counts["ntypes"], scene.system.labels["atom"]
        fix = cls(group, whole(every, "fix gcmc N"), whole(exchanges, "fix gcmc X"), whole(moves, "fix gcmc M"),
                  gas_type(kind, scene, molecule, cls.what), whole(seed, "fix gcmc seed"), number(temperature, "fix gcmc T"),
                  number(mu, "fix gcmc mu"), number(displace, "fix gcmc displace"), molecule,
                  [number(w, "fix gcmc mcmoves") for w in given["mcmoves"]] if "mcmoves" in given else None,
                  find_region(given.get("region"), scene, cls.what), numbers.get("maxangle", 10.0), numbers.get("pressure"),
                  numbers.get("fugacity_coeff", 1.0), "full_energy" in given, charged, [g[0] for g in given.get("groups", [])],
                  [(bounds(t, 1, types, "fix gcmc grouptype", labels)[0], g) for t, g in given.get("grouptypes", [])],
                  numbers.get("intra_energy", 0.0), numbers.get("tfac_insert", 1.0), numbers.get("overlap_cutoff", 0.0),
                  whole(given["min"][0], "fix gcmc min") if "min" in given else -1,
                  whole(given["max"][0], "fix gcmc max") if "max" in given else 2**31 - 1,
                  holders.read(given, cls.what))
        fix.template = given.get("mol", [""])[0]
        fix.words, fix.next_reneighbor, fix.as_lammps = list(words), scene.step + 1, True
        fix.storage = AtomOrder(*scene.sort, scene.order)
        if group == "all":
            session.warn("fix gcmc is applied to group all: every atom may go or be moved")
        if charged and not fix.full_energy:
            session.warn("fix gcmc charge: inserted atoms lose their charge, as in LAMMPS, unless full_energy is given too")
        return fix

    def to_lammps(self) -> list[str]:
        if not self.words:
            raise InputError("fix gcmc: this one was made in Python and has no script form")
        return self.words

    def setup(self, loop) -> None:
        units, gas = loop.units, check_scene(self, loop)
        self.gas_mass, self.beta = gas, 1.0 / (units.boltz * self.temperature)
        self.storage = storage_of(loop, self.storage)
        self.storage.sort(loop)
        if self.reservoir_pressure is not None:
            self.activity = self.reservoir_pressure * self.fugacity * self.beta / units.nktv2p
        else:
            wavelength = 1.0
            if loop.system.units != "lj":
                wavelength = math.sqrt(units.hplanck**2 / (2.0 * math.pi * gas * units.mvv2e * units.boltz * self.temperature))
            self.activity = math.exp(self.beta * self.mu) / wavelength**3
        self.speed = math.sqrt(units.boltz * self.temperature * self.velocity_factor / gas / units.mvv2e)
        self.held_tail = None
        self.holds = holders.find(loop, self.holder, self.template, self.what) if self.holder else None
        if self.next_reneighbor < 0:        # made in Python
            self.next_reneighbor = loop.step + 1

    def next_list(self, step: int) -> int:
        return max(step + 1, self.storage.due)

    def pre_exchange(self, loop) -> None:
        """On its steps: a series of attempts."""
        if loop.step == self.next_reneighbor:
            if self.by_molecule or loop.engine.box_moves:
                loop.sync_out()
            moves = Moves(self, loop)
            moves.series()
            moves.carry_over()
            self.held_tail = moves.tail.held
            self.next_reneighbor += self.interval
        sort_if_due(loop, self.storage, self)

    def vector(self, i: int) -> float:
        """1, 2: attempts and successes of translations; 3, 4: of insertions; 5, 6: of deletions; 7, 8: of rotations."""
        if not 1 <= i <= 8:
            raise InputError(f"fix {self.id} (style {self.style}): its vector has 8 components, not {i}")
        return float(self.counts[i - 1])

    def state(self) -> dict:
        return {"random": [self.random.state, self.other.state], "saved": [self.random.saved, self.other.saved],
                "counts": self.counts, "next": self.next_reneighbor, "ids": self.storage.ids, "due": self.storage.due}

    def restore(self, state: dict) -> None:
        for stream, number_, saved in zip((self.random, self.other), state["random"], state["saved"]):
            stream.state, stream.saved = int(number_), None if saved is None else float(saved)
        self.counts, self.next_reneighbor = np.array(state["counts"], float), int(state["next"])
        self.storage.ids, self.storage.due = np.array(state["ids"], np.int64), int(state["due"])


__all__ = ["GCMC"]
