"""Do numbers look like those of other units? Judged from what atoms, bonds and temperatures are like, in Angstrom, eV, amu, e and K."""
from __future__ import annotations

import math

import numpy as np

from asemd import units as unit_styles
from asemd.check import pairs
from asemd.check.case import Case
from asemd.check.static import DoesNotApply, static
from asemd.finding import Finding

KB = unit_styles.get("ase").boltz
KCAL = unit_styles.factor("energy", "real")         # in eV
MASS, MASSES = 0.9, 1e6                             # amu
BOND = (0.65, 12.0)                                 # Angstrom, coarse-grained bonds included
CHEMICAL = (0.65, 1.7, 30.0)                        # length from, to, and mass of the heavier atom, of bonds that are surely covalent
FORCE = (100.0 * KCAL, 7000.0 * KCAL)               # eV/Angstrom^2, second derivatives of covalent bonds: torn H2 to triple bonds
SIZE = (0.8, 30.0)                                  # Angstrom, diameter of the largest atom
DEPTH = 4.0 * KCAL                                  # eV: van der Waals wells are not deeper; those of metals are
METAL = 1.0                                         # eV: nor are those of metals deeper than this
CUTOFF = (2.0, 100.0)                               # Angstrom
HOT, COLD = 20_000.0, 1.5                           # K
HOT_LJ = 50.0
DENSE = 30.0                                        # g/cm^3; iridium has 22.6
SOFT = "a number in eV where kcal/mol is meant (factor 23)?"
HARD = "a number in kcal/mol where eV is meant (factor 23), or in kJ/mol/nm^2 (factor 418)?"
CHARGE = 12.0                                       # e


@static("units")
def scales(case: Case) -> list[Finding]:
    """Reduced units have no scale but for the temperature; styles si, cgs, micro and nano are for grains, not atoms."""
    u = case.units.name
    if u == "lj":
        found = _reduced(case)
    elif u in ("real", "metal", "electron", "ase"):
        found = [f for part in (_masses, _sizes, _depths, _cutoff, _bonds, _temperature, _density, _charges) for f in part(case)]
    else:
        raise DoesNotApply(f"units {u} may be of any scale")
    return found or [Finding("ok", "units", f"Masses, lengths, energies and temperatures are of the scale that units {u} has.")]


def _warn(text: str, value, limit, advice: str, atoms=(), severity: str = "warning") -> Finding:
    return Finding(severity, "units", text, atoms, value, limit, advice)


def _reduced(case: Case) -> list[Finding]:
    t = case.temperature
    if t > HOT_LJ:
        return [_warn(f"Temperature {t:.4g} in units lj: that is {t:.4g} epsilon / kB.", t, HOT_LJ,
                      "in reduced units T = kB T / epsilon, near 1 for a liquid: were Kelvin meant?")]
    return []


def _masses(case: Case) -> list[Finding]:
    mass = case.masses * unit_styles.factor("mass", case.units.name)
    if mass.max(initial=1.0) < MASS:
        return [_warn(f"The heaviest atom has mass {mass.max():.3g} amu, less than hydrogen.", float(mass.max()), MASS,
                      "masses are in g/mol: 12.011 for carbon (kg/mol?)")]
    if mass.min(initial=1.0) > MASSES:
        return [_warn(f"The lightest atom has mass {mass.min():.3g} amu.", float(mass.min()), MASSES, "masses are in g/mol")]
    return []


def _contact(case: Case) -> dict[int, float]:
    """Diameter of each type in Angstrom: where two of them have the energy 1 kT."""
    kt = case.units.boltz * case.temperature
    walls = pairs.wall(case, (kt,)) if case.engine.pair_terms else {}
    length = unit_styles.factor("distance", case.units.name)
    return {i: r * length for (i, j), (r,) in walls.items() if i == j and r > 0.0}


def _sizes(case: Case) -> list[Finding]:
    sizes = _contact(case)
    if not sizes:
        return []
    largest, kind = max((r, t) for t, r in sizes.items())
    if largest < SIZE[0]:
        return [_warn(f"The largest atom (type {kind}) is {largest:.3g} Angstrom wide: atoms are 2 to 5.", largest, SIZE[0],
                      "sigma is in Angstrom here; a factor of 10 comes from nm")]
    if largest > SIZE[1]:
        return [_warn(f"Atoms of type {kind} are {largest:.3g} Angstrom wide.", largest, SIZE[1],
                      "sigma is in Angstrom here; a factor of 10 comes from nm", severity="note")]
    return []


def _depths(case: Case) -> list[Finding]:
    energy, wells = unit_styles.factor("energy", case.units.name), []
    for term in case.engine.pair_terms:
        for (i, j), c in term.filled.items():
            if i == j and isinstance(c.get("epsilon"), float):
                wells.append((c["epsilon"] * energy, i))
    deepest, kind = max(wells, default=(0.0, 0))
    if deepest > DEPTH:
        other = "kcal/mol" if case.units.name == "metal" else "K, or kJ/mol"
        text = f"epsilon of type {kind} is {deepest:.3g} eV = {deepest / KCAL:.3g} kcal/mol = {deepest / KB:.4g} K"
        return [_warn(f"{text}: far deeper than van der Waals attraction.", deepest / energy, DEPTH / energy,
                      f"a number in {other}? (metals may have this)", severity="note" if deepest < METAL else "warning")]
    if 0.0 < deepest < 1e-6:
        return [_warn(f"The deepest well (type {kind}) is {deepest:.2g} eV: nothing is attracted at any temperature.", deepest / energy,
                      1e-6 / energy, "a factor of 23 comes from eV and kcal/mol, 1000 from kJ and J", severity="note")]
    return []


def _cutoff(case: Case) -> list[Finding]:
    if not case.engine.pair_terms or not case.engine.cutoff:
        return []
    cut = case.engine.cutoff * unit_styles.factor("distance", case.units.name)
    if not CUTOFF[0] <= cut <= CUTOFF[1]:
        return [_warn(f"The cutoff is {cut:.3g} Angstrom.", case.engine.cutoff, f"{CUTOFF[0]:g} to {CUTOFF[1]:g} Angstrom",
                      "8 to 12 Angstrom are usual; a factor of 10 comes from nm")]
    return []


def _bonds(case: Case) -> list[Finding]:
    """Rest lengths, and force constants of bonds that are surely covalent."""
    found, u = [], case.units.name
    length, stiff = unit_styles.factor("distance", u), unit_styles.factor("energy/distance^2", u)
    amu = unit_styles.factor("mass", u)
    for items in case.items:
        if items.category != "bond" or items.column("r") is None:
            continue
        for kind in np.unique(items.types):
            rest = items.rest(int(kind))
            mine = np.flatnonzero(items.types == kind)
            if not math.isfinite(rest) or rest <= 0.0:
                continue
            angstrom = rest * length
            what = f"Bond type {kind} ({items.style.name})"
            if not BOND[0] <= angstrom <= BOND[1]:
                found.append(_warn(f"{what} has the rest length {angstrom:.3g} Angstrom.", rest, f"{BOND[0]} to {BOND[1]}",
                                   "bonds are 1 to 2 Angstrom long; a factor of 10 comes from nm"))
                continue
            masses = case.masses[items.atoms[mine]] * amu
            k = float(np.median(items.omega[mine] ** 2 / (1.0 / case.masses[items.atoms[mine]]).sum(axis=1))) / case.units.ftm2v * stiff
            chemical = CHEMICAL[0] <= angstrom <= CHEMICAL[1] and masses.max() <= CHEMICAL[2]
            if chemical and k > 0.0 and not FORCE[0] <= k <= FORCE[1]:
                soft = k < FORCE[0]
                text = (f"{what}, {angstrom:.3g} Angstrom long, has the force constant E'' = {k / KCAL:.4g} kcal/mol/Angstrom^2: covalent "
                        "bonds have 300 to 3000.")
                soft = k < FORCE[0]
                found.append(_warn(text, k / stiff, (FORCE[0] if soft else FORCE[1]) / stiff, SOFT if soft else HARD,
                                   case.ids(items.atoms[mine[0]])))
    return found


def _temperature(case: Case) -> list[Finding]:
    t = case.temperature
    if t > HOT:
        return [_warn(f"The temperature is {t:.4g} K.", t, HOT, "velocities in other units (Angstrom/fs, Angstrom/ps), or other masses?")]
    if t < COLD:
        return [_warn(f"The highest temperature in the scene is {t:.4g} K.", t, COLD,
                      f"units {case.units.name} has Kelvin: was a reduced temperature meant?", severity="note")]
    return []


def _density(case: Case) -> list[Finding]:
    """Positions in nm make a box that is 1000 times too dense."""
    system, u = case.system, case.units.name
    if not system.box.periodic.all() or system.n < 20 or system.dimension != 3:
        return []
    amu, volume = float(case.masses.sum()) * unit_styles.factor("mass", u), system.box.volume * unit_styles.factor("distance", u) ** 3
    density = amu / volume * 1.66053907
    if density > DENSE:
        return [_warn(f"The density is {density:.4g} g/cm^3, more than any matter.", density, DENSE,
                      "is the box in Angstrom? positions in nm make 1000 times the density")]
    return []


def _charges(case: Case) -> list[Finding]:
    if case.system.q is None or not len(case.system.q):
        return []
    q = np.abs(case.system.q) * unit_styles.factor("charge", case.units.name)
    if q.max() > CHARGE:
        worst = int(np.argmax(q))
        return [_warn(f"Atom {case.ids(worst)[0]} has the charge {case.system.q[worst]:g}.", float(q.max()), CHARGE,
                      "charges are in units of the electron's", case.ids(worst))]
    return []
