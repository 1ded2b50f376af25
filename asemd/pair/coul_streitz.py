r"""$$E = \sum_i \left[ \chi q_i + \tfrac12 \eta q_i^2 \right] + C \sum_{i < j} \left[ q_i q_j \left( \frac{w(r)}{r} + f_{ij} \right)
+ q_i Z_j (a_i - f_{ij}) + q_j Z_i (a_j - f_{ij}) \right], \qquad a_i = - \left( \zeta_i + \frac1r \right) e^{-2 \zeta_i r}$$

Charges of Streitz and Mintmire: an effective nucleus Z and a cloud of charge, the density of a Slater 1s orbital with exponent zeta; a is
the energy of a cloud with a point charge without its part 1/r, f that of two clouds. Charges are those of the atoms.  With ``wolf alpha``
the part 1/r is that of coul/wolf, and a and f go to zero with their slopes at the cutoff. With ``ewald``, w is erfc(g r) with the g of the
``kspace_style``, which has the rest, and a and f end at the cutoff as they are. A line of the file is an element with chi, eta, gamma (0),
zeta and Z.  Streitz and Mintmire, Phys. Rev. B 50, 11996 (1994).

With ``wolf`` LAMMPS also moves the force to zero at the cutoff, so that it is not minus the gradient of its energy. Here it is;
``compat="lammps"`` gives LAMMPS's force. Digits get lost where two zeta are nearly but not exactly the same.
"""
from __future__ import annotations

import copy
import math
import warnings

import numpy as np

from asemd.errors import InputError, InputWarning
from asemd.kernels.manybody import add_virial, gather_near, scatter, share_pair
from asemd.manybody import ManyBody, element_of
from asemd.pair.coul_wolf import ROOT_PI
from asemd.pairstyle import PairTables
from asemd.potential_file import read_elements
from asemd.style import register

ENERGY = PER_ATOM = False
KINDS = ("wolf", "ewald")


def cloud_and_point(r, z):
    """The energy of a cloud with a point charge less 1/r, and its derivative."""
    e = math.exp(-2.0 * z * r)
    return -(z + 1.0 / r) * e, (2.0 * z * (z + 1.0 / r) + 1.0 / (r * r)) * e


def two_clouds(r, a, b):
    """The energy of two clouds less 1/r, and its derivative."""
    u = 1.0 / r
    ea = math.exp(-2.0 * a * r)
    if a == b:
        x = a * r
        return -ea * (u + a * (1.375 + x * (0.75 + x / 6.0))), ea * (u * u + 2.0 * a * u + a * a * (2.0 + x * (7.0 / 6.0 + x / 3.0)))
    eb = math.exp(-2.0 * b * r)
    sum2, gap = (a + b) * (a + b), a - b
    p = a * b**4 / (sum2 * gap * gap)
    q = b * a**4 / (sum2 * gap * gap)
    s = (3.0 * a * a * b**4 - b**6) / (sum2 * (a + b) * gap * gap * gap)
    t = (a**6 - 3.0 * b * b * a**4) / (sum2 * (a + b) * gap * gap * gap)
    return -ea * (p + s * u) - eb * (q + t * u), (ea * (2.0 * a * (p + s * u) + s * u * u) + eb * (2.0 * b * (q + t * u) + t * u * u))


def ionic_forces(x, f, q, type_of, first, middle, last, neighbors, codes, shifts, lo, hi, cut2, constants, arrays, near, types, slots,
                 grad, room, shared, qqr2e, acc, atom_energy, atom_virial, bad, meeting):
    """As `asemd.kernels.manybody.site_forces`, with the energy of each ion by itself."""
    ions, clouds, ends = arrays
    alpha, bell, cut, level, tilt = constants[0], constants[1], constants[2], constants[3], constants[4]
    for i in range(lo, hi):
        ti = type_of[i]
        if cut2[ti, ti] == 0.0:
            continue
        own = q[i] * (ions[ti, 0] + q[i] * (0.5 * ions[ti, 1] - qqr2e * constants[5]))
        if ENERGY:
            acc[1] += own
        if PER_ATOM:
            atom_energy[i] += own
        n = gather_near(i, first[i], middle[i], np.int64(0), x, type_of, neighbors, codes, shifts, cut2, near, types, slots)
        for k in range(n):
            r, j = math.sqrt(near[3, k]), types[k]
            if r == 0.0:
                grad[0, k], grad[1, k], grad[2, k] = 0.0, 0.0, 0.0
                if bad[0] == 0.0:
                    bad[0], bad[1], bad[2] = 1.0, i, math.inf
                continue
            gap, qj = r - cut, q[slots[k]]
            a, da = cloud_and_point(r, ions[ti, 2])
            b, db = cloud_and_point(r, ions[j, 2])
            c, dc = two_clouds(r, ions[ti, 2], ions[j, 2])
            a, da = a - clouds[ti, 0] - gap * clouds[ti, 1], da - clouds[ti, 1]
            b, db = b - clouds[j, 0] - gap * clouds[j, 1], db - clouds[j, 1]
            c, dc = c - ends[0, ti, j] - gap * ends[1, ti, j], dc - ends[1, ti, j]
            tail = math.erfc(alpha * r) / r
            qq, qa, qb = qqr2e * q[i] * qj, qqr2e * q[i] * ions[j, 3], qqr2e * qj * ions[ti, 3]
            e = qq * (tail - level + c) + qa * (a - c) + qb * (b - c)
            slope = qq * (dc + tilt - (tail + bell * math.exp(-alpha * alpha * near[3, k])) / r) + qa * (da - dc) + qb * (db - dc)
            g = slope / r
            grad[0, k], grad[1, k], grad[2, k] = g * near[0, k], g * near[1, k], g * near[2, k]
            if ENERGY:
                acc[1] += e
            if PER_ATOM:
                share_pair((atom_energy, atom_virial, np.int32(i), near, slots), k, e, grad[0, k], grad[1, k], grad[2, k])
        scatter(i, n, f, grad, slots)
        if ENERGY:
            add_virial(acc, n, near, grad)


class StreitzMintmire(ManyBody):
    """Ions with clouds of charge."""

    exact = True       # forces are the gradient

    def variant(self, settings, compat=""):
        if compat != "lammps":
            return self
        if "_twin" not in vars(self):
            self._twin = copy.copy(self)
            self._twin.exact = False
        return self._twin

    def needs(self, settings):
        return frozenset({"pppm", "ewald"} if settings["kind"] == "ewald" else ())

    def check_scene(self, interactions, system):
        super().check_scene(interactions, system)
        use = next(use for use in interactions.uses["pair"] if use.style is self)
        if use.settings["kind"] == "wolf" or set(interactions.special_coul) == {1.0} or not len(system.topology.items("bond")[0]):
            return
        if 0.0 in interactions.special_coul:
            raise InputError(f"pair style {self.name} with ewald knows no weights of bonded atoms: use special_bonds coul 1 1 1")
        warnings.warn(f"pair style {self.name} with ewald knows no weights of bonded atoms: special_bonds has no effect", InputWarning,
                      stacklevel=2)

    def parse_settings(self, words):
        values, what = super().parse_settings(words), f"pair_style {self.name}"
        if not values["cut"] > 0.0:
            raise InputError(f"{what}: the cutoff must be more than 0, got {values['cut']:g}")
        if values["kind"] not in KINDS:
            raise InputError(f"{what}: the sum must be wolf or ewald, got {values['kind']!r}")
        if (values["kind"] == "wolf") != ("alpha" in values):
            raise InputError(f"{what}: wolf needs alpha" if values["kind"] == "wolf" else f"{what}: ewald takes no alpha")
        return values

    def read(self, file, elements, settings):
        return read_elements(file, elements, "chi eta gamma zeta Z", check)

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        element, c, cut = element_of(filled, ntypes), next(iter(filled.values())), settings["cut"]
        self.unit_factor(c, units)
        rows, ions, clouds, ends = (np.zeros(shape) for shape in ((1, ntypes + 1, ntypes + 1), (ntypes + 1, 4), (ntypes + 1, 2),
                                                                  (2, ntypes + 1, ntypes + 1)))
        wolf = settings["kind"] == "wolf"
        for t, name in enumerate(element):
            if name is not None:
                ions[t] = [c["data"][name][n] for n in ("chi", "eta", "zeta", "Z")]
                clouds[t] = cloud_and_point(cut, ions[t, 2]) if wolf else 0.0
        for i, j in filled:
            rows[0, i, j] = rows[0, j, i] = cut * cut
            ends[:, i, j] = ends[:, j, i] = two_clouds(cut, ions[i, 2], ions[j, 2]) if wolf else 0.0
        alpha = settings["alpha"] if wolf else settings.get("g_ewald", 0.0)
        bell = 2.0 * alpha / ROOT_PI
        level, tilt, own = 0.0, 0.0, 0.0
        if wolf:
            level = math.erfc(alpha * cut) / cut
            tilt = 0.0 if self.exact else (level + bell * math.exp(-(alpha * cut) ** 2)) / cut
            own = 0.5 * level + alpha / ROOT_PI
        return PairTables(rows, np.array([alpha, bell, cut, level, tilt, own]), (ions, clouds, ends))


def check(p) -> str:
    """What is wrong with the numbers of an element."""
    if p["gamma"] != 0.0:
        return "gamma must be 0"
    return "eta and Z must not be negative, zeta must be positive" if min(p["eta"], p["Z"]) < 0.0 or not p["zeta"] > 0.0 else ""


style = register(StreitzMintmire("coul/streitz", forces=ionic_forces, helpers=(cloud_and_point, two_clouds), settings="cut kind [alpha]",
                                 units={"kind": "word", "alpha": "1/distance"}, settings_example="12.0 wolf 0.3",
                                 example="AlO.streitz Al O", converts=False, see="LAMMPS manual, pair_style coul/streitz"))
style.charged = True
