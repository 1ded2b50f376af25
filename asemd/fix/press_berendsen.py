r"""Berendsen barostat: lengths of the box relax exponentially to target pressures. Not a correct ensemble.

.. math:: L_i \leftarrow L_i \left( 1 - \frac{\Delta t}{\tau_i} \frac{P_{0,i} - P_i}{K} \right)^{1/3}

at the end of every step, about the middle of the box, with the bulk modulus :math:`K`; atoms go with the box. It does not integrate: use it
with fix nve and a thermostat, or fix nvt. The box must be orthogonal. The cube root is taken in two dimensions and of single lengths too,
as LAMMPS does.

Source: H. J. C. Berendsen, J. P. M. Postma, W. F. van Gunsteren, A. DiNola, J. R. Haak, J. Chem. Phys. 81, 3684 (1984); LAMMPS manual,
fix press/berendsen. Units: pressure, time.
"""
from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from asemd.compute.pressure import VIRIAL, Pressure, find_temperature
from asemd.compute.temp import Temp
from asemd.errors import InputError, SimulationError, nearest
from asemd.fix import Fix, hook
from asemd.fix.barostat import box_volume, kinetic_tensor, measure_pressure, take_along
from asemd.fix.measured import take_pressure, take_temperature
from asemd.fix.nose_hoover import COUPLINGS
from asemd.fix.nose_hoover_box import COUPLED, tail_virial
from asemd.kernels.box import follow
from asemd.kernels.threads import barrier
from asemd.words import choice, number, take

KEYWORDS = {**dict.fromkeys(("iso", "aniso", "x", "y", "z"), 3), **dict.fromkeys(("couple", "modulus", "dilate"), 1)}


def relax_box(th, s, p, q, b, change):
    """New lengths for the pressure in ``b[5]``; ``change``, ``b[11]`` and ``b[12]`` are for the atoms. One thread calls it."""
    done, v, o = 0.0, s.box.vectors, s.box.origin
    if th.end != th.begin:
        done = (th.step - th.begin) / (th.end - th.begin)
    for d in range(3):
        change[d, d], b[11, d] = 1.0, o[d]
        if b[3, d] != 0.0:
            target = b[0, d] + done * (b[1, d] - b[0, d])
            cube = 1.0 - th.dt * b[2, d] * (target - b[5, d]) / p[2]
            if cube > 0.0:
                change[d, d] = cube ** (1.0 / 3.0)
            else:
                q[29] = 1.0
            middle = o[d] + 0.5 * v[d, d]
            o[d] = middle + (o[d] - middle) * change[d, d]
            v[d, d] *= change[d, d]
        b[12, d] = o[d]
    follow(s.box)


class PressBerendsen(Fix):
    """Weak coupling of the box to a pressure.

    Parameters
    ----------
    group : str
        The atoms that go with the box if `partial`; the pressure is that of all atoms.
    pressure : float or (float, float)
        Target, or target at the start and at the end of a run, in pressure units of the scene.
    damping : float
        Relaxation time, in time units of the scene, for a system with a bulk modulus of `modulus`.
    shape : str
        ``iso``: all lengths change together; ``aniso``: each by itself; ``none``: only `components`.
    components : mapping, optional
        Of x y z -> (start, stop, damping) in place of what `shape` says.
    couple : str, optional
        ``none xyz xy yz xz``: lengths that change together, with the mean of their pressures.
    modulus : float
        Bulk modulus, in pressure units.
    partial : bool
        Only the atoms of the group go with the box.

    Raises
    ------
    InputError
        A value out of its range; a direction that is not periodic, a triclinic box, coupled lengths with different targets.

    Examples
    --------
    >>> PressBerendsen(pressure=1.0, damping=1000.0, modulus=21000.0)
    """

    style = "press/berendsen"
    brings = ("temp", "press")
    box_moves = "size"
    virial_every = 1
    needs = frozenset({"virial"})

    def __init__(self, group: str = "all", pressure=0.0, damping: float = 1000.0, shape: str = "iso",
                 components: Mapping[str, tuple[float, float, float]] | None = None, couple: str | None = None, modulus: float = 10.0,
                 partial: bool = False):
        super().__init__(group)
        what = f"fix {self.style}"
        choice(shape, ("iso", "aniso", "none"), f"{what} shape")
        start, stop = pressure if isinstance(pressure, tuple) else (pressure, pressure)
        self.components = dict.fromkeys("xyz" if shape != "none" else "", (float(start), float(stop), float(damping)))
        for name, numbers in (components or {}).items():
            self.components[choice(name, "xyz", f"{what} component")] = tuple(float(n) for n in numbers)
        self.couple = choice(couple or ("xyz" if shape == "iso" else "none"), COUPLINGS, f"{what} couple")
        if not self.components:
            raise InputError(f"{what} needs a pressure to control: iso, aniso, x, y or z")
        for name, (_, _, time) in self.components.items():
            if not time > 0.0:
                raise InputError(f"{what}: the damping time of {name} must be positive, got {time:g}")
        if not modulus > 0.0:
            raise InputError(f"{what}: the modulus must be positive, got {modulus:g}")
        self.single, self.modulus, self.partial = set(components or {}), modulus, partial
        self.temp = Temp("all")
        self.press = Pressure("all", self.temp, ())
        self.q, self.b, self.w, self.change = np.zeros(34), np.zeros((13, 6)), np.zeros(1), np.eye(3)

    @classmethod
    def from_lammps(cls, group, words, session):
        components, single, given = {}, set(), {"couple": "none"}
        while words:
            keyword, what = words[0], f"fix {cls.style} {words[0]}"
            if keyword not in KEYWORDS:
                raise InputError(f"fix {cls.style}: unknown keyword {keyword!r}{nearest(keyword, KEYWORDS)}")
            values = take(words[1:], KEYWORDS[keyword], what)
            words = words[1 + len(values):]
            if keyword in ("iso", "aniso"):
                components.update(dict.fromkeys("xyz", tuple(number(w, what) for w in values)))
                given["couple"] = "xyz" if keyword == "iso" else "none"
            elif keyword in ("x", "y", "z"):
                components[keyword] = tuple(number(w, what) for w in values)
                single.add(keyword)
            elif keyword == "couple":
                given["couple"] = choice(values[0], COUPLINGS, what)
            elif keyword == "modulus":
                given["modulus"] = number(values[0], what)
            else:
                given["partial"] = choice(values[0], ("all", "partial"), what) == "partial"
        new = cls(group, shape="none", components=components, **given)
        new.single = single
        if session.scene.system is not None:
            new.controlled(session.scene.system)
        return new

    def to_lammps(self) -> list[str]:
        all_three = len(self.components) == 3       # in two dimensions z cannot be named
        words = ["aniso", *(repr(n) for n in self.components["z"])] if all_three else []
        words += [w for name in self.components if not all_three or name in self.single or self.components[name] != self.components["z"]
                  for w in (name, *(repr(n) for n in self.components[name]))]
        return [*words, "couple", self.couple, "modulus", repr(float(self.modulus)), "dilate", "partial" if self.partial else "all"]

    def controlled(self, system) -> dict[str, tuple[float, float, float]]:
        """The lengths that change in this system, with start, stop and damping time.

        Raises
        ------
        InputError
            The box cannot be changed that way.
        """
        what, flat, box = f"fix {self.style}", system.dimension == 2, system.box
        if flat and ("z" in self.single or self.couple in ("yz", "xz")):
            raise InputError(f"{what}: {'z' if 'z' in self.single else self.couple} has no place in two dimensions")
        components = {name: numbers for name, numbers in self.components.items() if not (flat and name == "z")}
        coupled = [axis for axis in COUPLED[self.couple] if not (flat and axis == "z")]
        for axis in coupled:
            if axis not in components:
                raise InputError(f"{what}: couple {self.couple} needs a target for {axis}")
        if len({components[axis] for axis in coupled}) > 1:
            raise InputError(f"{what}: coupled lengths ({self.couple}) need the same Pstart Pstop Pdamp")
        for axis in components:
            if not box.periodic["xyz".index(axis)]:
                raise InputError(f"{what}: {axis} needs a box that is periodic in {axis}")
        if box.triclinic or not box.is_lammps_frame:
            raise InputError(f"{what}: the box must be orthogonal, with its edges along x, y and z; use fix nph or npt for another")
        return components

    # ---- a run --------------------------------------------------------------------------------------------------------------------------
    def hooks(self) -> dict[str, bool]:
        vars(self).pop("end_of_step", None)
        if type(self.press.temperature or self.temp) is not Temp:
            self.end_of_step = self._in_python
        return super().hooks()

    def parameters(self, loop) -> np.ndarray:
        q, b, dimension = self.q, self.b, loop.system.dimension
        b[:5], q[:] = 0.0, 0.0
        for name, (start, stop, time) in self.controlled(loop.system).items():
            b[:4, "xyz".index(name)] = start, stop, 1.0 / time, 1.0
        one = self.couple == "xyz" or (dimension == 2 and self.couple == "xy")
        q[0], q[1], q[7], q[26] = 1.0 if one else 2.0, COUPLINGS.index(self.couple), loop.units.nktv2p, dimension
        q[23], q[24] = "fix" in self.press.terms, "ke" in self.press.terms
        q[25] = loop.group_bit((self.press.temperature or self.temp).group)
        self.resize(loop)
        return np.array([loop.group_bit(self.group if self.partial else "all"), loop.units.mvv2e, self.modulus])

    def resize(self, loop) -> None:
        self.q[22] = tail_virial(loop, self.press)

    def atom_arrays(self, loop) -> tuple[np.ndarray, ...]:
        """Not by atom: numbers as in `asemd.fix.barostat`, and by what the lengths change."""
        self.w = np.array([float(t.category in self.press.terms or t.category not in VIRIAL) for t in loop.engine.terms])
        return self.q, self.b, self.w, self.change

    @hook(uses=[kinetic_tensor, box_volume, measure_pressure, relax_box, take_along, follow])
    def end_of_step(th, s, p, a):
        q, b, w, change = a
        kinetic_tensor(th, s, np.int32(np.int64(q[25])), 3, p[1], b[10])
        if th.tid == 0:
            measure_pressure(s, q, b, w)
            relax_box(th, s, p, q, b, change)
        barrier(th)
        take_along(th, s, np.int32(np.int64(p[0])), b[11], change, b[12], False)

    def _in_python(self, loop) -> None:
        """One step with a kinetic part that compiled code does not measure."""
        loop.sync_out()
        state = loop.snapshot()
        measured = self.press.temperature or self.temp
        self.b[10] = measured.vector(state)[:6]
        if self.q[0] == 1.0:        # then LAMMPS takes the scalar, which counts degrees of freedom
            dimension = int(self.q[26])
            self.b[10, :dimension] = measured.dof(state) * state.units.boltz * measured.scalar(state) / dimension
        measure_pressure(loop.state, self.q, self.b, self.w)
        thread = loop._thread()
        relax_box(thread, loop.state, np.array([0.0, 0.0, self.modulus]), self.q, self.b, self.change)
        bit = loop.group_bit(self.group if self.partial else "all")
        take_along(thread, loop.state, np.int32(bit), self.b[11], self.change, self.b[12], False)

    def broken_constraint(self, loop) -> str:
        if self.q[29] == 1.0:
            return "the pressure is so far from its target that the box would have no length: Pdamp or modulus is too small"
        return "the pressure is not a number: the run has come apart" if self.q[29] == 2.0 else ""

    def finish(self, loop) -> None:
        broken = self.broken_constraint(loop)
        if broken:
            raise SimulationError(f"fix {self.id} (style {self.style}): {broken}")

    def modify_option(self, keyword, value, session):
        if keyword == "temp":
            take_temperature(self, find_temperature(value, session, "fix_modify temp"), session)
            return True
        if keyword == "press":
            take_pressure(self, value, session)
            return True
        return super().modify_option(keyword, value, session)
