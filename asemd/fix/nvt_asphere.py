r"""Constant temperature for ellipsoids that turn: a Nose-Hoover chain for positions and angular momenta.

.. math:: \dot L = T - L\,\dot\eta_1, \qquad
          Q_1 \ddot\eta_1 = \sum_i m_i v_i^2 + \sum_i L_i \cdot I_i^{-1} L_i - f k_B T_0 - Q_1 \dot\eta_1 \dot\eta_2

with the other equations of `asemd.fix.nvt` and the orientations of `asemd.fix.nve_asphere`. The temperature is that of translation and
rotation (compute temp/asphere) unless ``fix_modify ID temp`` names another.

Source: G. J. Martyna, M. L. Klein, M. Tuckerman, J. Chem. Phys. 97, 2635 (1992); LAMMPS manual, fix nvt/asphere. Units: temperature, time.
"""
from __future__ import annotations

from asemd.compute.temp_asphere import TempAsphere
from asemd.fix.ellipsoids import EllipsoidBath, for_ellipsoids
from asemd.fix.nve_asphere import NVEAsphere
from asemd.fix.nvt import NVT
from asemd.fix.nvt_sphere import NVTSphere


class NVTAsphere(EllipsoidBath, NVT):
    """Time integration of ellipsoids at constant temperature.

    Parameters
    ----------
    group : str
        The atoms it moves; all need a shape.
    temperature, damping, chain, loops, drag
        As those of `asemd.fix.nvt.NVT`.

    Raises
    ------
    InputError
        As `asemd.fix.nvt.NVT`.

    Examples
    --------
    >>> NVTAsphere(temperature=1.0, damping=0.5)
    """

    style = "nvt/asphere"
    inner = NVEAsphere
    initial_integrate, outer_initial, final_integrate = (staticmethod(for_ellipsoids(h)) for h in (
        NVTSphere.initial_integrate, NVTSphere.outer_initial, NVTSphere.final_integrate))

    def __init__(self, group: str = "all", temperature=300.0, damping: float = 100.0, chain: int = 3, loops: int = 1, drag: float = 0.0):
        super().__init__(group, temperature, damping, chain, loops, drag)
        self.temp = TempAsphere(group)
