r"""Constant pressure and enthalpy for spheres that turn: a Nose-Hoover barostat without thermostat.

The equations are those of `asemd.fix.npt_sphere` without the chain of the atoms.

Source: G. J. Martyna, D. J. Tobias, M. L. Klein, J. Chem. Phys. 101, 4177 (1994); LAMMPS manual, fix nph/sphere. Units: time, pressure.
"""
from __future__ import annotations

from asemd.compute.pressure import Pressure
from asemd.compute.temp_sphere import TempSphere
from asemd.fix.nph import NPH
from asemd.fix.npt_sphere import InnerSpheres, NPTSphere
from asemd.fix.sphere_bath import SphereBath


class NPHSphere(SphereBath, NPH):
    """Time integration of spheres at constant pressure and enthalpy.

    Parameters
    ----------
    group : str
        The atoms it moves; all need a radius. The pressure is that of all atoms.
    pressure, pressure_damping
        As those of `asemd.fix.nph.NPH`.
    dipole : str
        ``dipole`` or ``dipole/dlm``: dipoles turn along; empty: they stay.
    disc : bool
        Discs in two dimensions: another moment of inertia.
    **keywords
        The others of `asemd.fix.nph.NPH`.

    Raises
    ------
    InputError
        As `asemd.fix.nph.NPH`; an unknown way of turning dipoles.

    Examples
    --------
    >>> NPHSphere(pressure=1.0, pressure_damping=5.0, shape="aniso")
    """

    style = "nph/sphere"
    inner = InnerSpheres
    initial_integrate, outer_initial, final_integrate = (staticmethod(h) for h in (
        NPTSphere.initial_integrate, NPTSphere.outer_initial, NPTSphere.final_integrate))

    def __init__(self, group: str = "all", pressure=0.0, pressure_damping: float = 1000.0, dipole: str = "", disc: bool = False,
                 **keywords):
        super().__init__(group, pressure, pressure_damping, **keywords)
        self.set_turning(dipole, disc)
        self.temp = TempSphere("all")
        self.press = Pressure("all", self.temp, ())
