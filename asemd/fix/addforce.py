r"""Add a force to atoms.

.. math:: F_i \leftarrow F_i + f, \qquad E = -\sum_i f \cdot r_i, \qquad W_{ab} = \sum_i f_a r_{ib}

with unwrapped positions :math:`r`. The energy is the scalar of this fix; with ``energy v_name`` it is the sum of that atom-style variable.
``fix_modify ID energy yes`` and ``virial yes`` count it in the potential energy and the pressure (minimisation needs the first). It acts in
minimisation as well.

Source: LAMMPS manual, fix addforce. Units: force. Output: a scalar, the potential energy; a vector of 3, the total force on the group
before.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError, nearest
from asemd.fix import hook
from asemd.fix.applied_force import AppliedForce
from asemd.fix.forcing import tally, unwrapped
from asemd.fix.formula import Value, read, write
from asemd.kernels.threads import reduce_sum
from asemd.result import COMPONENTS
from asemd.words import whole, yes_no

KEYWORDS = ("every", "region", "energy")


class AddForce(AppliedForce):
    """Add a force.

    Parameters
    ----------
    group : str
        The atoms it acts on.
    force : sequence of 3 of float or callable
        Components in force units of the scene; a function of the loop returns one number or one per atom.
    region : Region, optional
        Only atoms inside it.
    every : int
        Steps between two additions.
    energy : callable, optional
        Function of the loop that returns the energy of each atom (n,), for forces that are not constant.

    Raises
    ------
    InputError
        A component is missing, `every` is below 1, or `energy` comes with a constant force.
    """

    style = "addforce"

    def __init__(self, group: str = "all", force=(0.0, 0.0, 0.0), region=None, every: int = 1, energy: Value | None = None):
        super().__init__(group, force, region)
        if any(f is None for f in self.force):
            raise InputError("fix addforce: every component must be a number or a variable; use 0 for none")
        if every < 1:
            raise InputError(f"fix addforce: every must be at least 1, got {every}")
        if energy is not None and not any(callable(f) for f in self.force):
            raise InputError("fix addforce: a constant force has its own energy, leave the keyword energy out")
        self.add_every, self.energy = every, energy
        self._loop, self._energy, self._stopped = None, 0.0, -1
        self._force, self._positions = np.zeros((0, 3)), np.zeros((0, 3))     # of the last addition, by atom row
        if every > 1:
            self.post_force = self._with_python

    @classmethod
    def from_lammps(cls, group, words, session):
        what = "fix addforce"
        if len(words) < 3:
            raise InputError(f"fix addforce needs fx fy fz, got {len(words)} values")
        force = [read(w, "fix addforce force", session) for w in words[:3]]
        options, name, words = {}, "", words[3:]
        while words:
            keyword = words[0]
            if keyword not in KEYWORDS:
                raise InputError(f"fix addforce: unknown keyword {keyword!r}{nearest(keyword, KEYWORDS)}")
            if len(words) < 2:
                raise InputError(f"fix addforce: {keyword} needs a value")
            if keyword == "every":
                options["every"] = whole(words[1], "fix addforce every")
            elif keyword == "region":
                options["region"], name = cls.read_region(words[1:], what, session), words[1]
            else:
                options["energy"] = read(words[1], "fix addforce energy", session)
                if not callable(options["energy"]):
                    raise InputError(f"fix addforce: energy needs an atom-style variable v_name, got {words[1]!r}")
            words = words[2:]
        fix = cls(group, force, **options)
        fix.region_id = name
        return fix

    def to_lammps(self) -> list[str]:
        words = [write(f) for f in self.force] + (["every", str(self.add_every)] if self.add_every > 1 else [])
        words += ["region", self.region_id] if self.region is not None else []
        return words + (["energy", write(self.energy)] if self.energy is not None else [])

    def parameters(self, loop) -> np.ndarray:
        p = np.array([loop.group_bit(self.group), *(0.0 if callable(f) else f for f in self.force), *self.before, self.thermo_virial],
                     dtype=float)
        self.before, self._loop, self._stopped = p[4:7], loop, -1
        return p

    @hook(uses=[unwrapped, tally])
    def post_force(th, s, p, a):
        bit, mask = np.int32(np.int64(p[0])), s.mask[th.lo:th.hi]
        for d in range(3):
            f, value, before = s.f[d, th.lo:th.hi], p[1 + d], 0.0
            for i in range(f.size):
                if mask[i] & bit != 0:
                    before += f[i]
                    f[i] += value
            before = reduce_sum(th, before)
            if th.tid == 0:
                p[4 + d] = before
        if p[7] != 0.0:
            for i in range(th.lo, th.hi):
                if s.mask[i] & bit != 0:
                    tally(th, s, i, p[1], p[2], p[3])

    def _with_python(self, loop) -> None:
        if loop.step % self.add_every:
            return
        slots, f = self.selected(loop), loop.state.f
        added = np.array(self.values(loop, slots)).reshape(3, -1)
        self.before[:] = f[:, slots].sum(axis=1)
        f[:, slots] += added
        loop.sync_out()
        rows, system = loop.state.row[slots], loop.system
        self._force = np.zeros((system.n, 3))
        self._force[rows] = added.T
        self._positions = system.box.unwrap(system.x, system.image)
        if self.thermo_virial:
            loop.state.virial[0] += self.virials(loop.snapshot()).sum(axis=0)
        if self.energy is None:
            self._energy = -float((self._force * self._positions).sum())
        else:
            self._energy = float(np.broadcast_to(self.energy(loop), system.n)[rows].sum())

    def _constant(self, system, mask: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.where(mask[:, None], np.array(self.force, float), 0.0), system.box.unwrap(system.x, system.image)

    def _is_constant(self) -> bool:
        return "post_force" not in vars(self)

    def finish(self, loop) -> None:
        self._energy, self._stopped = self.scalar(), loop.step      # what commands between runs do to positions does not change it

    def scalar(self) -> float:
        """The potential energy of the atoms in the added force, energy units."""
        if self._loop is not None and self._loop.step != self._stopped and self._is_constant():
            force, r = self._constant(self._loop.system, self._loop.groups[self.group])
            return -float((force * r).sum())
        return self._energy

    def virials(self, state) -> np.ndarray:
        """(n, 6) each atom's virial, xx yy zz xy xz yz, energy units; `state` is a `asemd.engine.Snapshot`."""
        force, r = self._constant(state.system, state.mask(self.group)) if self._is_constant() else (self._force, self._positions)
        return np.stack([force[:, i] * r[:, j] for i, j in COMPONENTS], axis=1)

    def modify_option(self, keyword, value, session):
        if keyword in ("energy", "virial"):
            setattr(self, f"thermo_{keyword}", yes_no(value, f"fix_modify {keyword}"))
            return True
        return super().modify_option(keyword, value, session)
