"""What fixes mean without dynamics: constant added forces have an energy, forces set to zero are constraints."""
from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from asemd.fix import Fix
from asemd.fix.addforce import AddForce
from asemd.fix.setforce import SetForce
from asemd.result import COMPONENTS


@dataclass(frozen=True)
class Load:
    """A constant force on each atom of a group: E = -f . r with unwrapped positions.

    Parameters
    ----------
    group : str
    force : (float, float, float)
        In force units of the scene.
    """

    group: str
    force: tuple[float, float, float]

    def act(self, x: np.ndarray, mask: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Energies (n,), forces (n, 3) and virials (n, 6; xx yy zz xy xz yz) of atoms at unwrapped positions `x (n, 3)`."""
        f = np.where(mask[:, None], np.array(self.force, float), 0.0)
        w = np.stack([0.5 * (f[:, a] * x[:, b] + f[:, b] * x[:, a]) for a, b in COMPONENTS], axis=1)
        return -(f * x).sum(axis=1), f, w

    def __str__(self) -> str:
        return f"addforce {self.force[0]:g} {self.force[1]:g} {self.force[2]:g} on group {self.group}"


def _named(fix: Fix) -> str:
    return f"fix {fix.id} ({fix.style})" if fix.id else f"fix {fix.style}"


def loads_of(fixes: Iterable[Fix]) -> tuple[list[Load], list[str]]:
    """Constant forces that fixes add, and the names of those that add forces which are not the gradient of an energy."""
    loads, left_out = [], []
    for fix in fixes:
        if isinstance(fix, AddForce):
            if fix.region is not None or fix.add_every > 1 or any(callable(f) for f in fix.force):
                left_out.append(f"{_named(fix)} with a force that is not constant")
            else:
                loads.append(Load(fix.group, tuple(float(f) for f in fix.force)))
    return loads, left_out


def constraints_of(fixes: Iterable[Fix], groups: Mapping[str, np.ndarray]) -> tuple[list, list[str]]:
    """ASE constraints for fixes that set forces to zero, and the names of those that set them to something else."""
    out, left_out = [], []
    for fix in fixes:
        if isinstance(fix, SetForce):
            from ase.constraints import FixAtoms, FixCartesian  # a quarter of a second that most scenes need not wait
            if fix.region is not None or any(f is not None and (callable(f) or f != 0.0) for f in fix.force):
                left_out.append(f"{_named(fix)} with a force that is not zero everywhere in its group")
                continue
            index, held = np.flatnonzero(groups[fix.group]), tuple(f is not None for f in fix.force)
            if len(index) and any(held):
                out.append(FixAtoms(index) if all(held) else FixCartesian(index, held))
    return out, left_out
