r"""Relax the box during a minimisation, towards an external pressure or stress.

.. math:: E = U + P_t (V - V_0) + \tfrac12 \operatorname{tr}(\sigma\, h\, h^T), \qquad
          -\frac{\partial E}{\partial s_x} = s_y s_z V_0 (P_{xx} - P_t) - \dots

The minimiser moves the lengths of the box in units of those of the reference box, and its tilts; P is the virial part of the pressure. The
reference box is that at the start of the minimisation; where targets are given one by one the present one every ``nreset`` iterations, if
that is asked for. Atoms go with the box. The last term of the energy is LAMMPS's; the forces on the box are of the form
:math:`\tfrac12 \operatorname{tr}(h\, \sigma\, h^T)`, which differs where the box is tilted.

Source: M. Parrinello, A. Rahman, J. Appl. Phys. 52, 7182 (1981); LAMMPS manual, fix box/relax. Units: pressure. Output: the scalar is the
energy :math:`E - U`.
"""
from __future__ import annotations

import numpy as np

from asemd.compute.pressure import Pressure, find_temperature
from asemd.compute.temp import Temp
from asemd.errors import InputError, SimulationError, nearest
from asemd.fix import Fix
from asemd.fix.measured import take_pressure, take_temperature
from asemd.words import choice, number, take, whole, yes_no

DIMENSIONS = ("x", "y", "z", "yz", "xz", "xy")
ENTRIES = ((0, 0), (1, 1), (2, 2), (2, 1), (2, 0), (1, 0))
VOIGT = (0, 1, 2, 5, 4, 3)      # of xx yy zz xy xz yz
SHARED = {"none": (), "xyz": (0, 1, 2), "xy": (0, 1), "yz": (1, 2), "xz": (0, 2)}
SCALED = {"scaleyz": 3, "scalexz": 4, "scalexy": 5}
KEYWORDS = ("iso", "aniso", "tri", *DIMENSIONS, "couple", "dilate", "vmax", "nreset", *SCALED, "fixedpoint")


class BoxRelax(Fix):
    """Box relaxation for `minimize`.

    Parameters
    ----------
    group : str
        The atoms that go with the box if `partial`.
    targets : mapping
        ``x``, ``y``, ``z``, ``yz``, ``xz``, ``xy`` -> target pressure, in pressure units; others stay.
    couple : str
        ``none``, ``xyz``, ``xy``, ``yz``, ``xz``: lengths that change together.
    vmax : float
        Largest change of a length in one iteration, as a fraction.
    nreset : int
        Iterations after which the present box becomes the reference; 0: never.
    scale : mapping
        ``yz``, ``xz``, ``xy`` -> whether the tilt keeps its ratio to the length; by default those that are not targets and not zero do.
    fixedpoint : (3,) array, optional
        The point that does not move; the middle of the box by default.
    partial : bool
        Only the atoms of the group go with the box.
    deviatoric : bool
        Whether the stress has parts that are no pressure: targets given one by one.

    Raises
    ------
    InputError
        Coupled targets that differ, a number out of its range.
    """

    style = "box/relax"
    brings = ("temp", "press")
    minimizes = True
    extensive = False
    flat = False                    # whether the system is two-dimensional, known with the reference box

    def __init__(self, group: str = "all", targets=None, couple: str = "none", vmax: float = 1e-4, nreset: int = 0, scale=None,
                 fixedpoint=None, partial: bool = False, deviatoric: bool = True):
        super().__init__(group)
        self.targets = dict(targets or {})
        if not self.targets:
            raise InputError("fix box/relax needs a target pressure: iso, aniso, tri, x, y, z, xy, xz or yz")
        if not vmax > 0.0 or nreset < 0:
            raise InputError(f"fix box/relax: vmax must be positive and nreset not negative, got {vmax:g} and {nreset}")
        self.couple, self.vmax, self.nreset, self.partial, self.deviatoric = couple, vmax, nreset, partial, deviatoric
        self.scale, self.fixedpoint = dict(scale or {}), None if fixedpoint is None else np.array(fixedpoint, float)
        shared = {self.targets.get("xyz"[k]) for k in SHARED[choice(couple, SHARED, "fix box/relax couple")]}
        if None in shared:
            raise InputError(f"fix box/relax: couple {couple} needs a target pressure for each of these lengths")
        if len(shared) > 1:
            raise InputError(f"fix box/relax: lengths coupled by {couple} need the same target pressure")
        self.temp = Temp("all")
        self.press = Pressure("all", self.temp, ("virial",))
        self.box_moves = "shape" if any(len(name) == 2 for name in self.targets) else "size"
        self.energy = 0.0

    @classmethod
    def from_lammps(cls, group, words, session):
        targets, options, scale = {}, {"couple": "none", "deviatoric": False}, {}
        system = session.scene.system
        flat = system.dimension == 2
        while words:
            keyword, what = words[0], f"fix box/relax {words[0]}"
            if keyword not in KEYWORDS:
                raise InputError(f"fix box/relax: unknown keyword {keyword!r}{nearest(keyword, KEYWORDS)}")
            values = take(words[1:], 3 if keyword == "fixedpoint" else 1, what)
            words = words[1 + len(values):]
            if keyword in ("iso", "aniso", "tri"):
                targets.update(dict.fromkeys(("x", "y") if flat else ("x", "y", "z"), number(values[0], what)))
                options["couple"] = "xyz" if keyword == "iso" else "none"
                if keyword == "tri":
                    targets.update(dict.fromkeys(("xy",) if flat else ("yz", "xz", "xy"), 0.0))
                    scale.update({"yz": False, "xz": False, "xy": False})
            elif keyword in DIMENSIONS:
                if flat and "z" in keyword:
                    raise InputError(f"{what}: not in two dimensions")
                targets[keyword], options["deviatoric"] = number(values[0], what), True
                if len(keyword) == 2:
                    scale[keyword] = False
            elif keyword == "couple":
                options["couple"] = choice(values[0], SHARED, what)
            elif keyword == "dilate":
                options["partial"] = choice(values[0], ("all", "partial"), what) == "partial"
            elif keyword == "vmax":
                options["vmax"] = number(values[0], what)
            elif keyword == "nreset":
                options["nreset"] = whole(values[0], what)
            elif keyword == "fixedpoint":
                options["fixedpoint"] = [number(w, what) for w in values]
            else:
                scale[keyword[5:]] = yes_no(values[0], what)
        if flat and options["couple"] == "xyz":
            options["couple"] = "xy"
        new = cls(group, targets, scale=scale, **options)
        new.check_box(system.box)
        return new

    def to_lammps(self) -> list[str]:
        words = [w for name in DIMENSIONS if name in self.targets for w in (name, repr(float(self.targets[name])))]
        words += ["couple", self.couple, "dilate", "partial" if self.partial else "all", "vmax", repr(self.vmax)]
        words += ["nreset", str(self.nreset)]
        words += [w for name, yes in self.scale.items() for w in (f"scale{name}", "yes" if yes else "no")]
        return words + (["fixedpoint", *(repr(float(c)) for c in self.fixedpoint)] if self.fixedpoint is not None else [])

    def check_box(self, box) -> None:
        """Whether the box can be relaxed so; defaults that depend on it are settled.

        Raises
        ------
        InputError
            A direction that is not periodic, a tilt of a box that is not triclinic, a tilt both relaxed and scaled.
        """
        for name in self.targets:
            for axis in name:
                if not box.periodic["xyz".index(axis)] and (len(name) == 1 or axis == name[1]):
                    raise InputError(f"fix box/relax {name}: direction {axis} is not periodic")
            if len(name) == 2 and not box.triclinic:
                raise InputError(f"fix box/relax {name}: needs a triclinic box, use change_box all triclinic")
        for name, k in (("yz", 3), ("xz", 4), ("xy", 5)):
            along = "xyz".index(name[1])
            self.scale.setdefault(name, bool(box.periodic[along] and box.cell[ENTRIES[k]] != 0.0))
            if self.scale[name] and name in self.targets:
                raise InputError(f"fix box/relax: {name} cannot be relaxed and scaled")
            if self.scale[name] and not box.periodic[along]:
                raise InputError(f"fix box/relax scale{name}: direction {name[1]} is not periodic")
        if self.fixedpoint is None:
            self.fixedpoint = box.origin + 0.5 * np.diag(box.cell)

    def modify_option(self, keyword, value, session):
        if keyword in ("temp", "press"):
            if keyword == "press":
                take_pressure(self, value, session)
            else:
                take_temperature(self, find_temperature(value, session, "fix_modify temp"), session)
            return True
        return super().modify_option(keyword, value, session)

    # ---- what the minimiser sees --------------------------------------------------------------------------------------------------------
    @property
    def uniform(self) -> bool:
        """One scale for all lengths of the box."""
        return self.couple == ("xy" if self.flat else "xyz") and self.box_moves == "size"

    def count(self) -> int:
        """How many more degrees of freedom the minimiser has."""
        return 1 if self.uniform else 6 if self.box_moves == "shape" else 3

    def set_reference(self, system, nktv2p: float, begin: bool = False) -> None:
        """The present box is the reference; at the beginning of a minimisation also the unit of lengths, which stays."""
        h = system.box.cell.T.copy()       # columns are the vectors, as in the formulas
        self.reference, self.pv2e = np.diag(h).copy(), 1.0 / nktv2p
        self.flat = system.dimension == 2
        if self.flat:
            self.reference[2] = 1.0
        self.volume = float(np.prod(self.reference))
        if begin:
            self.unit, self.h0 = self.reference, system.box.cell.copy()
        lengths = [self.targets[a] for a in "xyz" if a in self.targets]
        self.hydrostatic = float(np.mean(lengths)) if lengths else 0.0
        t = np.zeros((3, 3))
        for k, name in enumerate(DIMENSIONS):
            if name in self.targets:
                i, j = ENTRIES[k]
                t[i, j] = t[j, i] = self.targets[name] - (self.hydrostatic if k < 3 else 0.0)
        inverse = np.linalg.inv(h)
        t[1, 1] -= t[1, 2] * inverse[1, 2] * self.unit[1]       # so that the off-diagonal part of the stress is the one asked for
        t[0, 1] -= t[0, 2] * inverse[1, 2] * self.unit[1]
        t[1, 0] = t[0, 1]
        t[0, 0] -= t[0, 1] * inverse[0, 1] * self.unit[0] + t[0, 2] * inverse[0, 2] * self.unit[0]
        self.sigma = self.volume * self.pv2e * inverse @ t @ inverse.T

    def new_box(self, cell, origin, change) -> tuple[np.ndarray, np.ndarray]:
        """Cell and origin after a change, from those at the start of a line search."""
        new, low = cell.copy(), origin.copy()
        for k in range(3):
            if "xyz"[k] not in self.targets:
                continue
            part = (change[0] if self.uniform else change[k]) * self.unit[k] / cell[k, k]
            high = origin[k] + cell[k, k]
            low[k], high = low[k] + (low[k] - self.fixedpoint[k]) * part, high + (high - self.fixedpoint[k]) * part
            if not low[k] < high:
                raise SimulationError(f"fix {self.id} (style box/relax): the box would have no length along {'xyz'[k]}; use a smaller vmax")
            new[k, k] = high - low[k]
        for k, name in enumerate(DIMENSIONS[3:], 3):
            entry = ENTRIES[k]
            if self.scale[name]:
                new[entry] = new[entry[0], entry[0]] * self.h0[entry] / self.h0[entry[0], entry[0]]
            elif name in self.targets:
                new[entry] = cell[entry] + change[k] * self.reference[entry[1]]
        return new, low

    def look(self, snapshot) -> tuple[float, np.ndarray]:
        """Energy, and forces on the further degrees of freedom (`count`,)."""
        cell, first = snapshot.system.box.cell, self.reference
        scale = np.where([a in self.targets for a in "xyz"], np.diag(cell) / first, 1.0)
        if self.flat:
            scale[2] = 1.0
        if self.uniform:
            s, d = scale[0], 2 if self.flat else 3
            self.energy = self.hydrostatic * (s**d - 1.0) * self.volume * self.pv2e
            return self.energy, np.array([d * s ** (d - 1) * self.volume * (self.press.scalar(snapshot) - self.hydrostatic) * self.pv2e])
        now = self.press.vector(snapshot)[list(VOIGT)]
        shared = list(SHARED[self.couple])
        if shared:
            now[shared] = now[shared].mean()
        self.energy = self.hydrostatic * (scale.prod() - 1.0) * self.volume * self.pv2e
        h = cell.T
        lengths = scale * first
        force = np.zeros(self.count())
        stress = self.sigma if self.deviatoric else np.zeros((3, 3))
        inner = h @ stress
        for k, name in enumerate(DIMENSIONS[:len(force)]):
            if name not in self.targets:
                continue
            row, column = ENTRIES[k]
            if k < 3:
                force[k] = scale.prod() / scale[k] * self.volume * (now[k] - self.hydrostatic) * self.pv2e
            else:
                force[k] = lengths.prod() / lengths[row] * first[column] * now[k] * self.pv2e
            force[k] -= inner[column, row] * first[column]
        self.energy += 0.5 * float(np.trace(stress @ h @ h.T))
        return self.energy, force

    def longest(self, direction) -> float:
        """The longest step along a direction of the further degrees of freedom."""
        largest = float(np.abs(direction).max(initial=0.0))
        return min(1.0, self.vmax / largest) if largest > 0.0 else 1.0

    def scalar(self) -> float:
        """Energy of the pressure, and of the strain if there is one, energy units."""
        return self.energy
