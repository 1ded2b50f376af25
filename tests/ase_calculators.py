"""A plugin of pytest that puts asemd's calculators in the place of ASE's, for ASE's own tests: see `tests/test_ase_tests.py`."""
from __future__ import annotations

import tempfile
from dataclasses import astuple

import ase.calculators.emt
import ase.calculators.lj
import ase.calculators.morse
import ase.calculators.tersoff
import numpy as np

from asemd import ForceField, Potential


class OneType(ForceField):
    """All atoms are of one type, whatever their element, as in ASE's pair potentials."""

    def __init__(self, *commands: str):
        super().__init__(commands=commands, units="metal", types=1, skin=0.3)

    def _system(self, atoms):
        atoms = atoms.copy()
        atoms.set_array("type", np.ones(len(atoms), int))
        atoms.set_initial_charges(np.zeros(len(atoms)))
        return super()._system(atoms)


class LennardJones(OneType):
    def __init__(self, epsilon=1.0, sigma=1.0, rc=None, ro=None, smooth=False):
        epsilon, sigma, rc = float(epsilon), float(sigma), float(3.0 * sigma if rc is None else rc)
        if smooth:
            style = f"lj/charmm/coul/charmm {0.66 * rc if ro is None else ro!r} {rc!r}"
        else:
            style = f"lj/cut {rc!r}"
        super().__init__(f"pair_style {style}", f"pair_coeff 1 1 {epsilon!r} {sigma!r}",
                         *([] if smooth else ["pair_modify shift yes"]))


class MorsePotential(OneType):
    def __init__(self, epsilon=1.0, r0=1.0, rho0=6.0, **_):
        epsilon, r0, rho0 = float(epsilon), float(r0), float(rho0)
        super().__init__(f"pair_style morse {2.7 * r0!r}", f"pair_coeff 1 1 {epsilon!r} {rho0 / r0!r} {r0!r}")


class Metal(OneType):
    """Stands for ASE's effective medium where tests want any metal at all."""

    def __init__(self, *_, **__):
        super().__init__("pair_style lj/cut 5.6", "pair_coeff 1 1 0.3 2.4", "pair_modify shift yes")


class Tersoff:
    """Makes a calculator of a file, or of ASE's parameters."""

    def __new__(cls, parameters):
        with tempfile.NamedTemporaryFile("w", suffix=".tersoff", delete=False) as file:
            for elements, values in parameters.items():
                file.write(" ".join(map(str, [*elements, *astuple(values)])) + "\n")
        return Potential(file.name)

    @staticmethod
    def from_lammps(path):
        return Potential(path)


ase.calculators.lj.LennardJones = LennardJones
ase.calculators.morse.MorsePotential = MorsePotential
ase.calculators.emt.EMT = Metal
ase.calculators.tersoff.Tersoff = Tersoff
