r"""Constant pressure and enthalpy: a Nose-Hoover barostat without thermostat.

The equations are those of `asemd.fix.npt` without the chain of the atoms. Conserved: kinetic plus potential energy plus the scalar of this
fix. The masses of the box are set by the temperature at the start of the first run, or by ``ptemp``.

Source: G. J. Martyna, D. J. Tobias, M. L. Klein, J. Chem. Phys. 101, 4177 (1994); LAMMPS manual, fix nph. Units: time, pressure.
"""
from __future__ import annotations

from asemd.errors import InputError
from asemd.fix.nose_hoover_box import NoseHooverBox
from asemd.fix.npt import NPT, InnerLevel


class NPH(NoseHooverBox):
    """Time integration at constant pressure and enthalpy.

    Parameters
    ----------
    group : str
        The atoms it moves; the pressure is that of all atoms.
    pressure : float or (float, float)
        Target, or target at the start and at the end of a run, in pressure units of the scene.
    pressure_damping : float
        Relaxation time of the pressure, in time units of the scene; about 1000 timesteps is usual.
    **keywords
        The others of `asemd.fix.npt.NPT` but those of the thermostat.

    Raises
    ------
    InputError
        As `asemd.fix.npt.NPT`.

    Examples
    --------
    >>> NPH(pressure=1.0, pressure_damping=1000.0, shape="aniso")
    """

    style = "nph"
    inner = InnerLevel
    initial_integrate, outer_initial, final_integrate = (staticmethod(h) for h in (NPT.initial_integrate, NPT.outer_initial,
                                                                                   NPT.final_integrate))

    def __init__(self, group: str = "all", pressure=0.0, pressure_damping: float = 1000.0, **keywords):
        super().__init__(group, None, 1.0, pressure, pressure_damping, **keywords)

    @classmethod
    def from_lammps(cls, group, words, session):
        given = cls.read(words, session)
        if "temperature" in given:
            other = cls.style.replace("nph", "npt")
            raise InputError(f"fix {cls.style}: temp controls the temperature, which fix {cls.style} does not; use fix {other}")
        return cls.made(group, given, session)
