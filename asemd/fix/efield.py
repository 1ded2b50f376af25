r"""A uniform electric field on charges and dipoles, or one that varies in space and time.

.. math:: F_i \leftarrow F_i + q_i E, \qquad T_i \leftarrow T_i + \mu_i \times E,
          \qquad E_{pot} = -\sum_i (q_i\, E \cdot r_i + \mu_i \cdot E)

with unwrapped positions. Components may be variables; then ``energy v_name`` gives the energy of each atom or ``potential v_name`` the
potential at each atom, of which the energy is the charge times that; without them it is 0. Variables of style atom are not for dipoles.
The virial (``fix_modify ID virial yes``) is that of a constant field, as in LAMMPS.

Source: LAMMPS manual, fix efield. Units: force/charge (V/Angstrom in units real and metal). Output: a scalar, the energy; a vector of 3,
the total force of the field.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError
from asemd.fix import hook
from asemd.fix.forcing import Forcing, tally, unwrapped
from asemd.fix.formula import Formula, Value, read, write
from asemd.kernels.threads import reduce_sum
from asemd.result import COMPONENTS


def turn(s, i, mx, my, mz, ex, ey, ez):
    """Add to a slot the torque of a field on a dipole."""
    s.torque[0, i] += ez * my - ey * mz
    s.torque[1, i] += ex * mz - ez * mx
    s.torque[2, i] += ey * mx - ex * my


class EField(Forcing):
    """An electric field.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    field : sequence of 3 of float or callable
        Components, in units of the scene; a function of the loop returns one number or one per atom.
    region : Region, optional
        Only atoms inside it.
    energy, potential : callable, optional
        Function of the loop that returns the energy of each atom, or the potential at it, (n,); for a field that is not constant.

    Raises
    ------
    InputError
        Both functions, or one of them with a constant field; at the start of a run, atoms without charges and dipoles.
    """

    style = "efield"
    told, size, first = 4, 3, 4
    modifies = ("energy", "virial")
    by_atom = True

    def __init__(self, group: str = "all", field=(0.0, 0.0, 0.0), region=None, energy: Value | None = None, potential: Value | None = None):
        if len(field) != 3:
            raise InputError(f"fix efield: a field has 3 components, got {len(field)}")
        if energy is not None and potential is not None:
            raise InputError("Must not use energy and potential keywords at the same time with fix efield")
        if (energy is not None or potential is not None) and not any(callable(v) for v in field):
            raise InputError(f"Cannot use variable {'potential' if energy is None else 'energy'} with constant efield in fix efield")
        super().__init__(group, field, region)
        self.energy, self.potential = energy, potential
        self.constant = not any(callable(v) for v in field)

    @classmethod
    def from_lammps(cls, group, words, session):
        field = cls.read_values(words, "ex ey ez", session)

        def atom_style(word, what):
            value = read(word, what, session)
            if not callable(value) or (value.name in session.variables.table and not per_atom(value)):
                raise InputError(f"{what}: needs a variable of style atom, v_name, got {word!r}")
            return value
        options = cls.read_keywords(words[3:], {"region": None, "energy": atom_style, "potential": atom_style}, session)
        name = options.pop("region_id", "")
        fix = cls(group, field, **options)
        fix.region_id = name
        return fix

    def to_lammps(self) -> list[str]:
        more = [("energy", self.energy), ("potential", self.potential)]
        return self.value_words() + self.region_words() + [w for key, v in more if v is not None for w in (key, write(v))]

    def numbers(self, loop) -> list[float]:
        system = loop.system
        charged, dipoles = system.q is not None, has_dipoles(system)
        if not charged and not dipoles:
            raise InputError("Fix efield requires atom attribute q or mu: use an atom style with charges or dipoles")
        for value in (self.energy, self.potential):
            if isinstance(value, Formula) and not per_atom(value):
                raise InputError(f"fix {self.id} (style {self.style}): variable {value.name} must be of style atom")
        return [loop.units.qe2f, dipoles, self.constant, bool(self.energy) + 2.0 * bool(self.potential)]

    def uses_atoms(self) -> bool:
        return bool(self.follows)

    def atom_arrays(self, loop) -> tuple[np.ndarray, ...]:
        own, extra = super().atom_arrays(loop), loop.system.extra
        nothing = np.zeros((1, 3))
        if own is not None:
            own = self.a = np.column_stack([own, np.zeros(len(own))])
        return (np.zeros((1, 5)) if own is None else own, extra.get("mu", nothing))

    def follow(self, loop) -> None:
        super().follow(loop)
        if has_dipoles(loop.system) and any(np.ptp(self.a[:, 1 + k]) > 0.0 for k, v in enumerate(self.values) if callable(v)):
            raise InputError(f"fix {self.id} (style efield): variables of style atom are not for dipoles")
        if self.energy is not None or self.potential is not None:
            self.a[:, 4] = (self.energy or self.potential)(loop)

    @hook(uses=[unwrapped, tally, turn])
    def post_force(th, s, p, a):
        bit, some, unit, dipoles, constant, mode = np.int32(np.int64(p[0])), p[2] != 0.0, p[10], p[11] != 0.0, p[12] != 0.0, p[13]
        own, mu = a
        ex, ey, ez = p[7], p[8], p[9]
        energy, x, y, z = 0.0, 0.0, 0.0, 0.0
        for i in range(th.lo, th.hi):
            if s.mask[i] & bit != 0:
                row = s.row[i]
                if some:
                    if own[row, 0] == 0.0:
                        continue
                    ex, ey, ez = own[row, 1], own[row, 2], own[row, 3]
                q = unit * s.q[i]
                fx, fy, fz = q * ex, q * ey, q * ez
                s.f[0, i] += fx
                s.f[1, i] += fy
                s.f[2, i] += fz
                x += fx
                y += fy
                z += fz
                if mode == 1.0:
                    energy += own[row, 4]
                elif mode == 2.0:
                    energy += q * own[row, 4]
                if constant:
                    energy -= fx * unwrapped(s, i, 0) + fy * unwrapped(s, i, 1) + fz * unwrapped(s, i, 2)
                    if p[1] != 0.0:
                        tally(th, s, i, fx, fy, fz)
                if dipoles:
                    turn(s, i, mu[row, 0], mu[row, 1], mu[row, 2], unit * ex, unit * ey, unit * ez)
                    if constant:
                        energy -= unit * (ex * mu[row, 0] + ey * mu[row, 1] + ez * mu[row, 2])
        energy = reduce_sum(th, energy)
        x, y, z = reduce_sum(th, x), reduce_sum(th, y), reduce_sum(th, z)
        if th.tid == 0:
            p[3], p[4], p[5], p[6] = energy, x, y, z

    def scalar(self) -> float:
        """Energy in the field, energy units."""
        return float(self.p[3])

    def virials(self, state) -> np.ndarray:
        """(n, 6) each atom's virial, xx yy zz xy xz yz, energy units; `state` is a `asemd.engine.Snapshot`."""
        system = state.system
        if not self.constant or system.q is None:
            return np.zeros((system.n, 6))
        acts = state.mask(self.group) if self.a is None else state.mask(self.group) & (self.a[:, 0] != 0.0)
        force = state.units.qe2f * np.where(acts, system.q, 0.0)[:, None] * np.array(self.values)
        r = system.box.unwrap(self.places(system), system.image)
        return np.stack([force[:, i] * r[:, j] for i, j in COMPONENTS], axis=1)


def per_atom(value: Formula) -> bool:
    """Whether the variable has a value for each atom."""
    return value.session.variables.find(value.name).style in ("atom", "atomfile")


def has_dipoles(system) -> bool:
    """Whether a field turns the atoms: what those of style dielectric have are normals of surfaces."""
    return "mu" in system.extra and "epsilon" not in system.extra
