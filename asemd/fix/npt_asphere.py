r"""Constant temperature and pressure for ellipsoids that turn: Nose-Hoover chains coupled to atoms, their rotation, and the box.

The equations are those of `asemd.fix.npt`; angular momenta feel the torques and the chain of the atoms, not the box,

.. math:: \dot L_i = T_i - L_i\,\dot\eta_1

and the energy of rotation counts in temperature and pressure as in compute temp/asphere. Orientations turn as in `asemd.fix.nve_asphere`.

Source: G. J. Martyna, D. J. Tobias, M. L. Klein, J. Chem. Phys. 101, 4177 (1994); LAMMPS manual, fix npt/asphere. Units: temperature, time,
pressure.
"""
from __future__ import annotations

from asemd.compute.pressure import Pressure
from asemd.compute.temp_asphere import TempAsphere
from asemd.fix.ellipsoids import EllipsoidBath, for_ellipsoids
from asemd.fix.npt import NPT
from asemd.fix.npt_sphere import InnerSpheres, NPTSphere


class InnerEllipsoids:
    """What moves ellipsoids and box on the inner levels of several."""

    initial_integrate, final_integrate = (staticmethod(for_ellipsoids(h)) for h in (
        InnerSpheres.initial_integrate, InnerSpheres.final_integrate))


class NPTAsphere(EllipsoidBath, NPT):
    """Time integration of ellipsoids at constant temperature and pressure.

    Parameters
    ----------
    group : str
        The atoms it moves; all need a shape. Temperature and pressure are those of all atoms.
    temperature : float or (float, float)
        Target, or target at the start and at the end of a run, in temperature units of the scene.
    damping : float
        Relaxation time of the temperature, in time units of the scene.
    pressure, pressure_damping
        As those of `asemd.fix.npt.NPT`.
    **keywords
        The others of `asemd.fix.npt.NPT`.

    Raises
    ------
    InputError
        As `asemd.fix.npt.NPT`.

    Examples
    --------
    >>> NPTAsphere(temperature=1.0, damping=0.5, pressure=1.0, pressure_damping=5.0)
    """

    style = "npt/asphere"
    inner = InnerEllipsoids
    initial_integrate, outer_initial, final_integrate = (staticmethod(for_ellipsoids(h)) for h in (
        NPTSphere.initial_integrate, NPTSphere.outer_initial, NPTSphere.final_integrate))

    def __init__(self, group: str = "all", temperature=300.0, damping: float = 100.0, pressure=0.0, pressure_damping: float = 1000.0,
                 **keywords):
        super().__init__(group, temperature, damping, pressure, pressure_damping, **keywords)
        self.temp = TempAsphere("all")
        self.press = Pressure("all", self.temp, ())
