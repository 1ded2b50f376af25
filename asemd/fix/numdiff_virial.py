r"""The virial by finite differences of the energy, to check that of a model.

.. math:: P_{ab} = -\frac{1}{V} \frac{E(+\epsilon) - E(-\epsilon)}{2 \epsilon}, \qquad r_a \leftarrow r_a \pm \epsilon\, r_b

for all atoms and the box; of all interactions, without other fixes. Twelve energies of a system that is built anew each time.

Source: LAMMPS manual, fix numdiff/virial. Arguments: N, the steps between two computations, and the strain delta. Units: pressure. Output:
a vector of 6: xx yy zz yz xz xy.
"""
from __future__ import annotations

import copy
from dataclasses import replace

import numpy as np

from asemd.errors import InputError
from asemd.fix.numdiff import NumDiff

PAIRS = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))


class NumDiffVirial(NumDiff):
    """Numerical virial.

    Parameters
    ----------
    group : str
        All atoms.
    every : int
        Steps between two computations.
    delta : float
        Strain.

    Raises
    ------
    InputError
        Another group, `every` below 1, `delta` not positive.
    """

    style = "numdiff/virial"
    outputs = frozenset({"vector"})
    size = 6

    def __init__(self, group: str = "all", every: int = 1, delta: float = 1e-4):
        if group != "all":
            raise InputError(f"fix numdiff/virial must use group all, got {group}")
        super().__init__(group, every, delta)
        self.values = np.zeros(6)

    def _differentiate(self, loop) -> None:
        from asemd.engine import Engine
        loop.sync_out()
        box = loop.system.box
        volume = abs(np.linalg.det(box.cell)) if loop.system.dimension == 3 else np.linalg.norm(np.cross(box.cell[0], box.cell[1]))
        for k, (a, b) in enumerate(PAIRS):
            energies = []
            for sign in (1.0, -1.0):
                strain = np.eye(3)
                strain[b, a] += sign * self.delta
                system = copy.deepcopy(loop.system)
                system.x = system.x @ strain
                system.box = replace(box, cell=box.cell @ strain, origin=box.origin @ strain)
                engine = Engine(system, loop.interactions, loop.settings)
                energies.append(engine.compute().potential)
            self.values[k] = -(energies[0] - energies[1]) / (2.0 * self.delta * volume) * loop.units.nktv2p

    def vector(self, i: int) -> float:
        """Component `i` (1 to 6) of the virial, pressure units."""
        if not 1 <= i <= 6:
            raise InputError(f"fix {self.id} (style numdiff/virial): its vector has 6 components, not {i}")
        return float(self.values[i - 1])
