r"""Friction and noise of pair style dpd without its repulsion: a thermostat for another pair style, with ``pair_style hybrid/overlay``.

The temperature goes from Tstart to Tstop during a run.
"""
from __future__ import annotations

from asemd.pair.dpd import UNITS, NoisyPair, repulsion
from asemd.style import register


class ThermostatPair(NoisyPair):
    """The temperature follows a ramp."""

    temperatures = ("Tstart", "Tstop")


register(ThermostatPair("dpd/tstat", [(repulsion, "cut")], settings="Tstart Tstop cut seed", coeff="gamma [cut]", rows="a0", units=UNITS,
                        doc=__doc__, settings_example="1.0 1.0 2.5 34387", example="4.5 2.4", see="LAMMPS manual, pair_style dpd/tstat",
                        shifts=False))
