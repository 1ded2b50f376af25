"""LAMMPS's unit styles with LAMMPS's own constants, and the one conversion to ASE's units.

The constants are those of LAMMPS (22 Jul 2025), digit by digit: inside a scene they make results comparable with LAMMPS; several
differ from CODATA in the sixth digit. At the border to ASE, `factor` uses ASE's constants (CODATA 2014).
"""
from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache

from asemd.errors import InputError, nearest


@dataclass(frozen=True)
class Units:
    """Constants of one unit style, under LAMMPS's names; a constant LAMMPS does not define for a style is 0.

    Attributes
    ----------
    boltz, hplanck
        Boltzmann's constant (energy/temperature) and Planck's constant (energy*time).
    mvv2e, ftm2v, mv2d
        mass*velocity^2 to energy; force*time/mass to velocity; mass/volume to density.
    nktv2p
        energy/volume to pressure.
    qqr2e, qe2f
        charge^2/distance to energy; charge*electric field to force.
    vxmu2f, xxt2kmu
        velocity*distance*viscosity to force; distance^2/time to kinematic viscosity.
    e_mass, hhmrr2e, mvh2r
        Electron mass, hbar^2/(mass*distance^2) to energy, mass*velocity/hbar to 1/distance.
    angstrom, femtosecond, qelectron
        One Angstrom, one femtosecond, one elementary charge in this style.
    dt, skin
        Default timestep and neighbour skin.
    """

    name: str
    boltz: float
    hplanck: float
    mvv2e: float
    ftm2v: float
    mv2d: float
    nktv2p: float
    qqr2e: float
    qe2f: float
    vxmu2f: float
    xxt2kmu: float
    e_mass: float
    hhmrr2e: float
    mvh2r: float
    angstrom: float
    femtosecond: float
    qelectron: float
    dt: float
    skin: float


# ASE's units: eV, Angstrom, amu, elementary charge, and the time that follows, Angstrom sqrt(amu/eV); CODATA 2014 as in ase.units.
_E, _AMU, _KB, _H, _NA, _C = 1.6021766208e-19, 1.660539040e-27, 1.38064852e-23, 6.626070040e-34, 6.022140857e23, 299792458.0
_SECOND = 1e10 * (_E / _AMU) ** 0.5
_FS = 1e-15 * _SECOND
_BOHR = 0.5291772105638411
_HARTREE = 27.211386024367243

_TABLE = (
    Units("lj", 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.005, 0.3),
    Units("real", 0.0019872067, 95.306976368, 2390.0573615334906, 0.00041839999997254776, 1.6605389210321897, 68568.415, 332.06371,
          23.060549, 14393.264316, 0.1, 0.0005446169970987488, 0.0957018663603261, 1.5339009481951, 1.0, 1.0, 1.0, 1.0, 2.0),
    Units("metal", 8.617343e-05, 0.004135667403, 0.00010364269, 9648.533823273016, 1.6605389210321897, 1602176.5, 14.399645, 1.0,
          0.6241509647, 0.0001, 0.0, 0.0, 0.0, 1.0, 0.001, 1.0, 0.001, 2.0),
    Units("si", 1.3806504e-23, 6.62606896e-34, 1.0, 1.0, 1.0, 1.0, 8987600000.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1e-10, 1e-15,
          1.6021765e-19, 1e-08, 0.001),
    Units("cgs", 1.3806504e-16, 6.62606896e-27, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1e-08, 1e-15, 4.8032044e-10, 1e-08,
          0.1),
    Units("electron", 3.16681534e-06, 0.1519829846, 1.06657236, 0.937582899, 1.0, 29421010800000.0, 1.0, 1.94469051e-10, 33.9893149,
          0.0313796367, 0.0, 0.0, 0.0, 1.88972612, 1.0, 1.0, 0.001, 2.0),
    Units("micro", 1.3806504e-08, 6.62606896e-13, 1.0, 1.0, 1.0, 1.0, 8987556.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0001, 1e-09,
          1.6021765e-07, 2.0, 0.1),
    Units("nano", 0.013806504, 0.000662606896, 1.0, 1.0, 1.0, 1.0, 230.7078669, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.1, 1e-06, 1.0, 0.00045,
          0.1),
    Units("ase", _KB / _E, _H / _E * _SECOND, 1.0, 1.0, 1.0, 1.0, _HARTREE * _BOHR, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, _FS, 1.0, _FS,
          2.0),
)
STYLES = {u.name: u for u in _TABLE}
LAMMPS_STYLES = tuple(name for name in STYLES if name != "ase")
# names of the units of length and time
NAMES = {"lj": ("sigma", "tau"), "real": ("Angstrom", "fs"), "metal": ("Angstrom", "ps"), "si": ("m", "s"), "cgs": ("cm", "s"),
         "electron": ("Bohr", "fs"), "micro": ("micrometre", "microsecond"), "nano": ("nm", "ns"),
         "ase": ("Angstrom", "Angstrom sqrt(amu/eV)")}


def get(name: str) -> Units:
    """The constants of a unit style.

    Parameters
    ----------
    name : str
        lj, real, metal, si, cgs, electron, micro, nano, or ase.

    Raises
    ------
    InputError
        Unknown style; the message offers the nearest match.
    """
    if name not in STYLES:
        raise InputError(f"unknown units style {name!r}{nearest(name, STYLES)}")
    return STYLES[name]


def _base(**given: float) -> dict[str, float]:
    """Factors of all base words from those that a style defines on its own; the rest follows from mass, distance, time and charge."""
    e = given.setdefault("energy", given["mass"] * given["distance"] ** 2 / given["time"] ** 2)
    d, t = given["distance"], given["time"]
    out = {"angle": 1.0, "temperature": 1.0, "velocity": d / t, "force": e / d, "pressure": e / d**3, "density": given["mass"] / d**3,
           "dipole": given["charge"] * d, "electric_field": e / d / given["charge"], "viscosity": e * t / d**3}
    return out | given


_PASCAL = 1e-30 / _E
_POISE = 0.1 * _PASCAL * _SECOND
_KCAL = 4184.0 / _NA / _E
_STATCOULOMB = 0.1 / _C / _E
_GRAM_PER_CM3 = 1e-27 / _AMU
_VOLT_PER_METRE = 1e-10
_BASES = {
    "lj": dict.fromkeys(("energy distance angle mass time charge temperature velocity force pressure density dipole electric_field "
                         "viscosity").split(), 1.0),
    "real": _base(mass=1.0, distance=1.0, time=_FS, charge=1.0, energy=_KCAL, pressure=101325.0 * _PASCAL, density=_GRAM_PER_CM3,
                  viscosity=_POISE, electric_field=1.0),
    "metal": _base(mass=1.0, distance=1.0, time=1e3 * _FS, charge=1.0, energy=1.0, pressure=1e5 * _PASCAL, density=_GRAM_PER_CM3,
                   viscosity=_POISE),
    "si": _base(mass=1.0 / _AMU, distance=1e10, time=_SECOND, charge=1.0 / _E, electric_field=_VOLT_PER_METRE),
    "cgs": _base(mass=1e-3 / _AMU, distance=1e8, time=_SECOND, charge=_STATCOULOMB, electric_field=_C * 1e-4 * _VOLT_PER_METRE),
    # the velocity of style electron is Bohr/fs: that is what LAMMPS's constants and its time integration imply
    "electron": _base(mass=1.0, distance=_BOHR, time=_FS, charge=1.0, energy=_HARTREE, pressure=_PASCAL, dipole=1e-21 / _C / _E * 1e10,
                      electric_field=1e2 * _VOLT_PER_METRE),
    # the field of styles micro and nano is force/charge, as LAMMPS's qe2f = 1 implies (its manual says V/um and V/nm)
    "micro": _base(mass=1e-15 / _AMU, distance=1e4, time=1e-6 * _SECOND, charge=1e-12 / _E),
    "nano": _base(mass=1e-21 / _AMU, distance=10.0, time=1e-9 * _SECOND, charge=1.0),
    "ase": _base(mass=1.0, distance=1.0, time=1.0, charge=1.0, energy=1.0),
}
DIMENSIONS = tuple(_BASES["lj"])
_TOKEN = re.compile(r"\s*([*/]?)\s*([A-Za-z_]+|1)\s*(?:\^\s*(-?\d+(?:\.\d+)?))?\s*")


def name(base: str, style: str) -> str:
    """The name of the unit of ``distance`` or ``time`` of a unit style: ``Angstrom``, ``fs``."""
    return NAMES[style][base == "time"]


@cache
def factor(dimension: str, units: str) -> float:
    """The factor that turns a number in a unit style into ASE's units.

    Parameters
    ----------
    dimension : str
        Words energy distance angle mass time charge temperature pressure velocity force density dipole electric_field viscosity
        (or 1), combined with ``*``, ``/`` and ``^n`` from left to right: ``"energy/distance^2"``. Empty: a bare number. An angle is in
        radians on both sides.
    units : str
        Unit style of the number; ``lj`` has the factor 1 for everything.

    Returns
    -------
    float

    Raises
    ------
    InputError
        Unknown unit style, or a dimension that cannot be read.
    """
    base = _BASES[get(units).name]
    value, at = 1.0, 0
    text = dimension.strip()
    while at < len(text):
        m = _TOKEN.match(text, at)
        if not m or (at == 0) != (m[1] == ""):
            raise InputError(f"cannot read the dimension {dimension!r}: expected words joined by * / ^")
        if m[2] != "1" and m[2] not in base:
            raise InputError(f"unknown word {m[2]!r} in dimension {dimension!r}{nearest(m[2], base)}")
        term = (1.0 if m[2] == "1" else base[m[2]]) ** float(m[3] or 1)
        value = value / term if m[1] == "/" else value * term
        at = m.end()
    return value
