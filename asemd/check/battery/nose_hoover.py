r"""A Nose-Hoover chain that is coupled far too tightly, and hardly at all.

The damping time :math:`\tau` goes from 5 to :math:`10^5` timesteps. The energy of atoms and chain together stays: its fluctuation is that
of velocity Verlet, a few 1e-4 of :math:`N k_B T` at this step, and that of the chain, of the order of :math:`(\Delta t / \tau)^2` in
:math:`k_B T` for each link; the limit is 1e-3 of :math:`N k_B T`. With :math:`\tau` of 5 and 30 steps the temperature is that asked for,
within four standard errors of a hundred samples, :math:`4 \sqrt{2 / f} / \sqrt{100}`, and scatters like that of the canonical ensemble,
:math:`\sqrt{2 / f}` for f degrees of freedom, within 0.4. With half a step even the chain's own steps are unstable: the run may end, but
not in silence.

Source: G. J. Martyna, M. L. Klein, M. Tuckerman, J. Chem. Phys. 97, 2635 (1992); M. E. Tuckerman, Statistical Mechanics (2010), ch. 4.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.check.battery import Figure, case, vectors
from asemd.check.battery.lj_melt import melt

DT, N = 0.005, 256
DAMPINGS = (5.0, 30.0, 1e3, 1e5)     # in timesteps
DOF = 3 * N - 3


def thermostatted(start, damping: float):
    session = melt(start, DT)
    session.commands_string(f"unfix 1\nfix 1 all nvt temp 1.0 1.0 {damping * DT!r}\nrun 0 post no")
    return session


def series(session) -> tuple[np.ndarray, np.ndarray]:
    """Conserved energy and temperature over 1000 steps, after 500."""
    session.command("run 500 pre no post no")
    energy, temperature = [], []
    for _ in range(100):
        session.command("run 10 pre no post no")
        energy.append(session.get_thermo("econserve"))
        temperature.append(session.get_thermo("temp"))
    return np.array(energy), np.array(temperature)


@case("Nose-Hoover chain",
      Figure("energy of atoms and chain, 5 to 1e5 steps", 1e-3, "root mean square of the conserved energy around its mean for damping "
             "times of 5 to 1e5 timesteps, in units of N kT"),
      Figure("temperature, 5 and 30 steps", 4.0 * math.sqrt(2.0 / DOF) / 10.0, "how far the mean temperature is from that asked for"),
      Figure("scatter of the temperature, 5 and 30 steps", 0.4, "how far the scatter of the temperature is from that of the canonical "
             "ensemble, relative to it; thermostats that only rescale have too little"),
      Figure("silent failures at half a step", 0.0, "whether a damping time of half a timestep ends in numbers that are none without a "
             "message"))
def nose_hoover(start):
    conserved, mean, scatter = 0.0, 0.0, 0.0
    for damping in DAMPINGS:
        energy, temperature = series(thermostatted(start, damping))
        conserved = max(conserved, float(energy.std()) / N)
        if damping <= 30.0:
            mean = max(mean, abs(float(temperature.mean()) - 1.0))
            scatter = max(scatter, abs(float(temperature.std()) / math.sqrt(2.0 / DOF) - 1.0))
    return {"energy of atoms and chain, 5 to 1e5 steps": conserved, "temperature, 5 and 30 steps": mean,
            "scatter of the temperature, 5 and 30 steps": scatter, "silent failures at half a step": silent(start)}


def silent(start) -> int:
    """1 if numbers that are none come without a message."""
    try:
        session = thermostatted(start, 0.5)
        session.command("run 500 pre no post no")
    except Exception:       # LAMMPS raises its own class
        return 0
    return 0 if np.isfinite(vectors(session, "v")).all() and math.isfinite(session.get_thermo("temp")) else 1
