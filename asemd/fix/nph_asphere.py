r"""Constant pressure and enthalpy for ellipsoids that turn: a Nose-Hoover chain coupled to the box.

The equations are those of `asemd.fix.npt_asphere` without the chain of the atoms.

Source: G. J. Martyna, D. J. Tobias, M. L. Klein, J. Chem. Phys. 101, 4177 (1994); LAMMPS manual, fix nph/asphere. Units: time, pressure.
"""
from __future__ import annotations

from asemd.compute.pressure import Pressure
from asemd.compute.temp_asphere import TempAsphere
from asemd.fix.ellipsoids import EllipsoidBath
from asemd.fix.nph import NPH
from asemd.fix.npt_asphere import InnerEllipsoids, NPTAsphere


class NPHAsphere(EllipsoidBath, NPH):
    """Time integration of ellipsoids at constant pressure and enthalpy.

    Parameters
    ----------
    group : str
        The atoms it moves; all need a shape. The pressure is that of all atoms.
    pressure, pressure_damping
        As those of `asemd.fix.nph.NPH`.
    **keywords
        The others of `asemd.fix.nph.NPH`.

    Raises
    ------
    InputError
        As `asemd.fix.nph.NPH`.

    Examples
    --------
    >>> NPHAsphere(pressure=1.0, pressure_damping=5.0, shape="aniso")
    """

    style = "nph/asphere"
    inner = InnerEllipsoids
    initial_integrate, outer_initial, final_integrate = (staticmethod(h) for h in (
        NPTAsphere.initial_integrate, NPTAsphere.outer_initial, NPTAsphere.final_integrate))

    def __init__(self, group: str = "all", pressure=0.0, pressure_damping: float = 1000.0, **keywords):
        super().__init__(group, pressure, pressure_damping, **keywords)
        self.temp = TempAsphere("all")
        self.press = Pressure("all", self.temp, ())
