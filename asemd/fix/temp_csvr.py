r"""Canonical sampling by velocity rescaling: one random factor for all velocities. It does not move atoms: use it with fix nve.

.. math:: v \leftarrow \alpha v, \qquad
          \alpha^2 = c + (1 - c) \frac{T_0}{f T} \sum_{i=1}^{f} R_i^2 + 2 R_1 \sqrt{c (1 - c) \frac{T_0}{f T}}, \qquad
          c = e^{-\Delta t / \tau}

at the end of every step, with f degrees of freedom and normal random numbers :math:`R_i`; the sum comes from a gamma distribution. The
random numbers are LAMMPS's.

Source: G. Bussi, D. Donadio, M. Parrinello, J. Chem. Phys. 126, 014101 (2007); LAMMPS manual, fix temp/csvr. Units: temperature, time.
Output: the scalar is the energy taken out of the atoms (thermo keywords ecouple, econserve).
"""
from __future__ import annotations

import math

from asemd.fix.temp_csld import TempCSLD as Stochastic
from asemd.fix.thermostat import scale_thermal
from asemd.marsaglia import Marsaglia


def gamma(random: Marsaglia, order: int) -> float:
    """A number with the gamma distribution of a whole order.

    Source: J. H. Ahrens, U. Dieter, Computing 12, 223 (1974).
    """
    if order < 6:
        product = 1.0
        for _ in range(order):
            product *= random.uniform()
        return -math.log(product) if order else 0.0
    while True:
        v1, v2 = random.uniform(), 2.0 * random.uniform() - 1.0
        if v1 * v1 + v2 * v2 > 1.0:
            continue
        slope, mean = v2 / v1, order - 1
        width = math.sqrt(2.0 * mean + 1.0)
        x = width * slope + mean
        if x <= 0.0:
            continue
        exponent = mean * math.log(x / mean) - width * slope
        if exponent < -700.0 or v1 < 0.00001:
            continue
        if random.uniform() <= (1.0 + slope * slope) * math.exp(exponent):
            return x


def squares(random: Marsaglia, count: int) -> float:
    """The sum of the squares of `count` normal numbers."""
    if count <= 0:
        return 0.0
    if count % 2 == 0:
        return 2.0 * gamma(random, count // 2)
    first = random.gaussian()
    return first * first + (2.0 * gamma(random, (count - 1) // 2) if count > 1 else 0.0)


class TempCSVR(Stochastic):
    """Stochastic velocity rescaling.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    temperature : float or (float, float) or callable
        Target, or target at the start and at the end of a run, in temperature units of the scene.
    damping : float
        Relaxation time, in time units of the scene.
    seed : int
        A positive number.

    Raises
    ------
    InputError
        A value out of its range.
    """

    style = "temp/csvr"

    def end_of_step(self, loop) -> None:
        """Scale the velocities by a random factor."""
        target = self.target(loop)
        loop.sync_out()
        state = loop.snapshot()
        dof, now = self.temp.dof(state), self.temp.scalar(state)
        if dof < 1.0 or now <= 0.0:
            return
        keep = math.exp(-loop.dt / self.damping)
        share = (1.0 - keep) * target / now / dof
        first = self.random.gaussian()
        square = keep + share * (first * first + squares(self.random, int(dof - 1.0))) + 2.0 * first * math.sqrt(keep * share)
        scale_thermal(loop, self.temp, self.group, math.sqrt(square))
        self.energy += 0.5 * loop.units.boltz * dof * now * (1.0 - square)
