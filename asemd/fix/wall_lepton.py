r"""Walls with any potential, given as a formula in the distance ``r`` and the cutoff ``rc``.

.. math:: E = U(r) - U(r_c)

Formulas may name variables of style equal (``v_name``), whose values are those at the start of a run.

Source: LAMMPS manual, fix wall/lepton. Arguments: face, position, expression, cutoff for each wall. Output: a scalar, the energy; a vector,
minus the force on each wall, and its virial is negative where that of other walls is positive: LAMMPS's signs.
"""
from __future__ import annotations

from functools import cache

import numpy as np

from asemd.errors import InputError
from asemd.expression import VARIABLE, Compiled, compiled_function, condense, differentiate
from asemd.expression_style import present, write
from asemd.fix import hook
from asemd.fix.wall import MOST, Wall, forces_with

SIGNS = (("total -= side * slope", "total += side * slope"), ("-= slope * r", "+= slope * r"))


@cache
def compiled_hook(source: str, arguments: tuple[str, ...]):
    """The energy and the hook for functions written as source, with LAMMPS's signs."""
    energy = compiled_function("lepton_energy", source)
    call = f"lepton_energy({', '.join(['r', *(f'p[at + {6 + k}]' for k in range(len(arguments)))])})"
    function = compiled_function("post_force", "def post_force(th, s, p, a):\n    lepton_forces(th, s, p, a)\n")
    return energy, hook(function, uses=[energy, forces_with("lepton_forces", call, SIGNS)]).__func__


class WallLepton(Wall):
    """Walls with a formula.

    Parameters
    ----------
    group : str
        The atoms that feel the walls.
    walls : mapping of str to sequence
        Face ``xlo`` to ``zhi`` -> position, expression in r and rc, cutoff, in units of the scene.
    pbc : bool
        Walls may stand in periodic directions.

    Examples
    --------
    >>> WallLepton(walls={"zlo": (0.0, "k*(r-rc)^2;k=100.0", 2.5)}).size
    1
    """

    style = "wall/lepton"
    names = ("expression",)
    kind = -1
    session = None

    def __init__(self, group: str = "all", walls=None, pbc: bool = False):
        super().__init__(group, walls, pbc)
        if not any(VARIABLE.search(w[1]) for w in self.walls.values()):
            self._compile()

    @classmethod
    def from_lammps(cls, group, words, session):
        fix = super().from_lammps(group, words, session)
        fix.session = session
        return fix

    @classmethod
    def read_coefficient(cls, word, name, what, session):
        text = condense(word)
        if not VARIABLE.search(text):
            expression(text, (), 1.0, what)
        return text

    def _compile(self) -> None:
        self.compiled: list[Compiled] = []
        for face, (_, text, cutoff) in self.walls.items():
            given: tuple = ()
            if VARIABLE.search(text):
                text, given = present(text, self.session.variables.value)
            self.compiled.append(expression(text, given, cutoff, f"fix wall/lepton {face}"))
        self.written = write("lepton_energy", "r", "r", [], self.compiled)
        if len(self.written.arguments) > MOST:
            raise InputError(f"fix wall/lepton: the expressions have more than {MOST} different numbers, write them with fewer")
        self.energy, self.post_force = compiled_hook(self.written.source, self.written.arguments)

    def hooks(self) -> dict[str, bool]:
        return {"post_force": True}

    def numbers(self, loop) -> list[float]:
        self._compile()
        return super().numbers(loop)

    def parameters(self, loop):
        self._compile()
        return super().parameters(loop)

    def block(self, m, face, values):
        place, _, cutoff = values
        constants = self.written.values(self.compiled[m])
        return super().block(m, face, [place, *(constants.get(name, 0.0) for name in self.written.arguments), cutoff])

    def energy_at(self, cutoff: float, block: np.ndarray) -> float:
        return float(self.energy(cutoff, *block[6:6 + len(self.written.arguments)])[0])


def expression(text: str, given: tuple, cutoff: float, what: str) -> Compiled:
    """The energy as a function of r, for a cutoff."""
    try:
        return differentiate(text + f";rc={cutoff!r}", "r", given)
    except InputError as e:
        raise InputError(f"{what}: {e.message}") from None
