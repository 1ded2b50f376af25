r"""An electric field on four-site water: the charge of an oxygen atom is on the massless site M.

.. math:: x_M = x_O + \tfrac{a}{2} (d_1 + d_2), \qquad F_M = q_O E, \qquad F_O \leftarrow F_O + (1 - a) F_M,
          \qquad F_H \leftarrow F_H + q_H E + \tfrac{a}{2} F_M

with :math:`d_1, d_2` the vectors from O to its two H atoms, and a from the TIP4P pair style. Energy, torque and virial are those of charges
at M and H. A site is in the group if its O atom is, and in the region if M is there; its H atoms take their part of the force anyway. Atoms
that are not of such molecules, dipoles, variables and outputs: as fix efield. Fields of style atom are taken at the atoms, that at O for M,
as in LAMMPS, and there is no keyword potential.

Source: LAMMPS manual, fix efield/tip4p. Units: force/charge (V/Angstrom in units real and metal). Output: a scalar, the energy; a vector of
3, the total force of the field.
"""
from __future__ import annotations

import numpy as np

from asemd.charge_sites import ChargeSites
from asemd.errors import InputError
from asemd.fix import hook
from asemd.fix.efield import EField, turn
from asemd.fix.forcing import unwrapped
from asemd.fix.restrain import away
from asemd.kernels.image import closest_general
from asemd.kernels.threads import reduce_sum
from asemd.tip4p import TIP4P


class EFieldTIP4P(EField):
    """An electric field on four-site water.

    Parameters
    ----------
    group, field, region, energy
        As `asemd.fix.EField`.

    Raises
    ------
    InputError
        As `asemd.fix.EField`; a potential; at the start of a run, atoms without charges, or no pair style of TIP4P.
    """

    style = "efield/tip4p"

    def __init__(self, group: str = "all", field=(0.0, 0.0, 0.0), region=None, energy=None, potential=None):
        if potential is not None:
            raise InputError("Fix efield/tip4p does not support the potential keyword: give the energy of each atom, keyword energy")
        super().__init__(group, field, region, energy)
        self.oxygens, self.kin = np.zeros((0, 3), np.int64), np.zeros((0, 2), np.int64)
        self.half = 0.0

    def sites(self, loop) -> ChargeSites:
        """Where the pair style has its charges."""
        for use in loop.interactions.uses["pair"]:
            if isinstance(use.style, TIP4P):
                return use.style.sites(use.settings, loop.interactions)
        raise InputError("Fix efield/tip4p needs a pair style of TIP4P, such as tip4p/cut or lj/cut/tip4p/long")

    def numbers(self, loop) -> list[float]:
        if loop.system.q is None:
            raise InputError("Fix efield/tip4p requires atom attribute q: use an atom style with charges")
        self.half = 0.5 * self.sites(loop).share
        return [*super().numbers(loop), self.half]

    def atom_arrays(self, loop) -> tuple[np.ndarray, ...]:
        self.oxygens, self.kin = self.sites(loop).atoms(loop.system), np.full((loop.system.n, 2), -1)
        oxygen, *hydrogens = self.oxygens.T
        for k, rows in enumerate(hydrogens):
            self.kin[oxygen, k], self.kin[rows, 0] = rows, oxygen
        return (*super().atom_arrays(loop), self.kin)

    def places(self, system) -> np.ndarray:
        """(n, 3) positions of atoms, those of M for oxygen atoms, distance units."""
        x, (oxygen, *hydrogens) = system.x.copy(), self.oxygens.T
        for rows in hydrogens:
            x[oxygen] += self.half * system.box.minimum_image(system.x[rows] - system.x[oxygen])[0]
        return x

    @hook(uses=[unwrapped, closest_general, away, turn])
    def post_force(th, s, p, a):
        bit, some, unit, dipoles, constant = np.int32(np.int64(p[0])), p[2] != 0.0, p[10], p[11] != 0.0, p[12] != 0.0
        mode, half = p[13], p[14]
        own, mu, kin = a
        ex, ey, ez = p[7], p[8], p[9]
        energy, tx, ty, tz = 0.0, 0.0, 0.0, 0.0
        for i in range(th.lo, th.hi):
            row = s.row[i]
            if row < 0:
                continue
            first, second = kin[row, 0], kin[row, 1]
            if first >= 0 and second < 0 and s.mask[s.slot[first]] & bit != 0 and (not some or own[first, 0] != 0.0):
                q = half * unit * s.q[s.slot[first]]        # a hydrogen atom and its part of the site
                if some:
                    ex, ey, ez = own[first, 1], own[first, 2], own[first, 3]
                s.f[0, i] += q * ex
                s.f[1, i] += q * ey
                s.f[2, i] += q * ez
            if s.mask[i] & bit == 0 or (some and own[row, 0] == 0.0):
                continue
            if some:
                ex, ey, ez = own[row, 1], own[row, 2], own[row, 3]
            q = unit * s.q[i]
            fx, fy, fz = q * ex, q * ey, q * ez
            part = 1.0 - 2.0 * half if second >= 0 else 1.0
            s.f[0, i] += part * fx
            s.f[1, i] += part * fy
            s.f[2, i] += part * fz
            tx += fx
            ty += fy
            tz += fz
            if mode == 1.0:
                energy += own[row, 4]
            if constant:
                x, y, z = unwrapped(s, i, 0), unwrapped(s, i, 1), unwrapped(s, i, 2)
                if second >= 0:
                    ax, ay, az = away(s, s.slot[first], i)
                    bx, by, bz = away(s, s.slot[second], i)
                    x, y, z = x + half * (ax + bx), y + half * (ay + by), z + half * (az + bz)
                energy -= fx * x + fy * y + fz * z
                if p[1] != 0.0:
                    s.virial[th.tid, 0] += fx * x
                    s.virial[th.tid, 1] += fy * y
                    s.virial[th.tid, 2] += fz * z
                    s.virial[th.tid, 3] += fx * y
                    s.virial[th.tid, 4] += fx * z
                    s.virial[th.tid, 5] += fy * z
            if dipoles:
                turn(s, i, mu[row, 0], mu[row, 1], mu[row, 2], unit * ex, unit * ey, unit * ez)
                if constant:
                    energy -= unit * (ex * mu[row, 0] + ey * mu[row, 1] + ez * mu[row, 2])
        energy = reduce_sum(th, energy)
        tx, ty, tz = reduce_sum(th, tx), reduce_sum(th, ty), reduce_sum(th, tz)
        if th.tid == 0:
            p[3], p[4], p[5], p[6] = energy, tx, ty, tz
