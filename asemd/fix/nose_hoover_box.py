"""Settings, outputs and state of the Nose-Hoover integrators that change the box; `asemd.fix.npt` has the formulas and what is compiled."""
from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from asemd.compute.pressure import VIRIAL, Pressure
from asemd.compute.temp import Temp
from asemd.errors import InputError, SimulationError
from asemd.fix.barostat import hold_box, target_pressure
from asemd.fix.measured import take_pressure
from asemd.fix.nose_hoover import COMPONENTS, COUPLINGS, SHORT, NoseHoover
from asemd.kernels.box import changed

COUPLED = {"xyz": "xyz", "xy": "xy", "yz": "yz", "xz": "xz", "none": ""}
TILTS = {"xy": 15, "xz": 16, "yz": 17}      # places of their flags in the numbers of the barostat
FLIP = 0.6              # of a length: a tilt beyond it is flipped
SMALLEST = 1e-6         # temperature that sets the masses of the box


def tail_virial(loop, press: Pressure) -> float:
    """The tail correction of a pressure, times the volume twice."""
    if not loop.interactions.tail or not loop.engine.pair_terms or "pair" not in press.terms:
        return 0.0
    volume = abs(float(np.linalg.det(loop.system.box.cell)))
    return loop.interactions.tail_correction(loop.system, loop.units)[1] * volume**2 / loop.units.nktv2p


class NoseHooverBox(NoseHoover):
    """Base class of `asemd.fix.npt.NPT` and `asemd.fix.nph.NPH`, whose arguments it has.

    Attributes
    ----------
    press : Pressure
        Measures the pressure; that of all atoms unless ``fix_modify ID press`` names another one.
    """

    virial_every = 1
    brings = ("temp", "press")

    def __init__(self, group: str = "all", temperature=300.0, damping: float = 100.0, pressure=0.0, pressure_damping: float = 1000.0,
                 shape: str = "iso", components: Mapping[str, tuple[float, float, float]] | None = None, couple: str | None = None,
                 chain: int = 3, loops: int = 1, pressure_chain: int = 3, pressure_loops: int = 1, drag: float = 0.0, mtk: bool = True,
                 nreset: int = 0, flip: bool = True, dilate: str = "all", fixed_point=None, scalexy: bool | None = None,
                 scaleyz: bool | None = None, scalexz: bool | None = None, ptemp: float | None = None):
        super().__init__(group, temperature, damping, chain, loops, drag)
        what = f"fix {self.style}"
        if shape not in (*SHORT, "none"):
            raise InputError(f"{what}: shape must be iso, aniso, tri or none, got {shape}")
        start, stop = pressure if isinstance(pressure, tuple) else (pressure, pressure)
        self.components = {name: (start, stop, pressure_damping) if name in COMPONENTS[:3] else (0.0, 0.0, pressure_damping)
                           for name in SHORT.get(shape, ())}
        self.single = [name for name in components or {} if name in COMPONENTS]
        for name, numbers in (components or {}).items():
            if name not in COMPONENTS:
                raise InputError(f"{what}: components of the pressure are {' '.join(COMPONENTS)}, got {name}")
            self.components[name] = tuple(float(n) for n in numbers)
        couple = couple or ("xyz" if shape == "iso" else "none")
        if not self.components:
            raise InputError(f"{what} needs a pressure to control: iso, aniso, tri, or x y z xy yz xz")
        if couple not in COUPLINGS:
            raise InputError(f"{what}: couple must be one of {' '.join(COUPLINGS)}, got {couple}")
        for name, (_, _, time) in self.components.items():
            if not time > 0.0:
                raise InputError(f"{what}: the damping time of {name} must be positive, got {time:g}")
        if min(pressure_chain, pressure_loops, nreset) < 0:
            raise InputError(f"{what}: pchain, ploop and nreset must not be negative")
        if pressure_chain and not pressure_loops:
            raise InputError(f"{what}: ploop must be at least 1")
        if ptemp is not None and not ptemp > 0.0:
            raise InputError(f"{what}: ptemp must be above 0, got {ptemp:g}")
        if ptemp is not None and self.thermal:
            raise InputError(f"{what}: ptemp has no place beside temp, which sets the masses of the box")
        self.shape, self.couple, self.deviatoric = shape, couple, bool(components)
        self.pressure_chain, self.pressure_loops, self.mtk, self.nreset = pressure_chain, pressure_loops, mtk, nreset
        self.flip, self.dilate, self.fixed_point, self.ptemp = flip, dilate, fixed_point, ptemp
        self.centred = fixed_point is None
        self.scale = {"xy": scalexy, "yz": scaleyz, "xz": scalexz}
        self.temp = Temp("all")
        self.press = Pressure("all", self.temp, ())
        self.q, self.b = np.zeros(34), np.zeros((15, 6))
        self.e, self.w, self.m = np.zeros((4, pressure_chain + 1)), np.zeros(1), np.zeros((5, 3, 3))
        self.reference_temperature = 0.0
        self.box_moves = "shape" if any(len(name) == 2 for name in self.components) else "size"
        self.ready = False

    @classmethod
    def made(cls, group: str, given: dict, session) -> NoseHooverBox:
        """The fix of the keywords that `read` returns, for the box that there is now."""
        given = dict(given)
        components, single = given.pop("components"), given.pop("single", [])
        deviatoric, shape = given.pop("deviatoric"), given.pop("shape", "none")
        new = cls(group, shape="none", components=components, **given)
        new.single, new.deviatoric, new.shape = single, deviatoric, shape
        system = session.scene.system
        if system is not None:
            new.settle(system)
        return new

    def to_lammps(self) -> list[str]:
        words = super().to_lammps()
        for name, numbers in self.components.items():
            words += [name, *(repr(n) for n in numbers)]
        words += ["couple", self.couple, "pchain", str(self.pressure_chain), "ploop", str(self.pressure_loops)]
        words += ["mtk", "no"] * (not self.mtk) + ["nreset", str(self.nreset)] * bool(self.nreset) + ["flip", "no"] * (not self.flip)
        words += ["dilate", self.dilate] * (self.dilate != "all") + ["ptemp", repr(self.ptemp)] * (self.ptemp is not None)
        words += [w for tilt, on in self.scale.items() if on is not None for w in (f"scale{tilt}", "yes" if on else "no")]
        return words + (["fixedpoint", *(repr(float(c)) for c in self.fixed_point)] if self.fixed_point is not None else [])

    def relaxation_times(self) -> list[tuple[str, float]]:
        """``temperature`` or ``pressure`` and each damping time, in time units of the scene."""
        times = [("temperature", self.damping)] if self.thermal else []
        return times + [("pressure", t) for t in sorted({time for _, _, time in self.components.values()})]

    # ---- the box it works on ------------------------------------------------------------------------------------------------------------
    def settle(self, system) -> None:
        """What depends on the box is settled, once.

        Raises
        ------
        InputError
            The box cannot be changed that way.
        """
        if self.ready:
            return
        box, what, flat = system.box, f"fix {self.style}", system.dimension == 2
        periodic = dict(zip("xyz", box.periodic))
        if flat:
            wrong = [name for name in self.single if name in ("z", "yz", "xz")]
            if wrong or self.couple in ("yz", "xz") or any(self.scale[tilt] for tilt in ("yz", "xz")):
                raise InputError(f"{what}: {(wrong or [self.couple])[0]} has no place in two dimensions")
            for name in ("z", "yz", "xz"):
                self.components.pop(name, None)
        self._check_coupling(what, flat)
        for name in self.components:
            axis = name[-1]
            if not periodic[axis]:
                raise InputError(f"{what}: {name} needs a box that is periodic in {axis}")
        tilts = [name for name in self.components if len(name) == 2]
        if tilts and not box.triclinic:
            raise InputError(f"{what}: {tilts[0]} needs a triclinic box; use change_box all triclinic before it")
        if not box.is_lammps_frame and (flat or set(self.components) != set("xyz") or self.couple != "xyz" or self.deviatoric):
            raise InputError(f"{what}: the box vectors must be in LAMMPS's frame (a along x, b in the xy plane) unless all lengths are "
                             "coupled")
        for tilt, value in zip(("xy", "xz", "yz"), box.tilt if box.is_lammps_frame else np.zeros(3)):
            axis = tilt[-1]
            if self.scale[tilt] is None:
                self.scale[tilt] = bool(value != 0.0 and periodic[axis] and self.shape != "tri" and tilt not in self.components
                                        and not (flat and axis == "z"))
            if self.scale[tilt] and not periodic[axis]:
                raise InputError(f"{what}: scale{tilt} needs a box that is periodic in {axis}")
            if self.scale[tilt] and tilt in self.components:
                raise InputError(f"{what}: a tilt is either controlled or scaled, not both: {tilt} and scale{tilt}")
        if self.fixed_point is None:
            centre = 0.5 * (box.lo + box.hi) if box.is_lammps_frame else box.origin + 0.5 * box.cell.sum(axis=0)
            self.fixed_point = tuple(float(c) for c in centre)
        self.style_number = 3 if tilts else 1 if self.couple == "xyz" or (flat and self.couple == "xy") else 2
        self.ready = True

    def _check_coupling(self, what: str, flat: bool) -> None:
        coupled = [axis for axis in COUPLED[self.couple] if not (flat and axis == "z")]
        missing = [axis for axis in coupled if axis not in self.components]
        if missing:
            raise InputError(f"{what}: couple {self.couple} needs a target for {missing[0]}")
        if len({self.components[axis] for axis in coupled}) > 1:
            raise InputError(f"{what}: coupled lengths ({self.couple}) need the same Pstart Pstop Pdamp")

    # ---- a run --------------------------------------------------------------------------------------------------------------------------
    @property
    def all_plain(self) -> bool:
        return self.plain and type(self.press.temperature or self.temp) is Temp

    def hooks(self) -> dict[str, bool]:
        hooks = super().hooks()
        if not self.flip or self.box_moves != "shape":
            del hooks["pre_exchange"]
        return hooks

    def parameters(self, loop) -> np.ndarray:
        p = super().parameters(loop)
        self.settle(loop.system)
        self.q, self.b = self.q.copy(), self.b.copy()
        q, b, u, dimension = self.q, self.b, loop.units, loop.system.dimension
        measured = self.press.temperature or self.temp
        others = [f for f in loop.fixes if f is not self and set(f.hooks()) - {"post_force", "pre_force"}]
        b[:5] = 0.0
        for name, numbers in self.components.items():
            b[:4, COMPONENTS.index(name)] = numbers[0], numbers[1], 1.0 / numbers[2], 1.0
        q[:14] = (self.style_number, COUPLINGS.index(self.couple), self.mtk, self.deviatoric, self.nreset, loop.system.n, b[3, :3].sum(),
                  u.nktv2p, b[2].max(), self.drag, self.pressure_loops, self.pressure_chain, *self.fixed_point[:2])
        q[14] = self.fixed_point[2]
        for tilt, at in TILTS.items():
            q[at] = bool(self.scale[tilt])
        q[21] = loop.group_bit(self.dilate)
        q[23], q[24] = "fix" in self.press.terms, "ke" in self.press.terms and p[2] > 0.0
        anew = bool(others) or self.group != self.temp.group or measured is not self.temp
        q[25:30] = loop.group_bit(measured.group), dimension, anew, self.thermal, 0.0
        q[30:32] = not loop.system.box.is_lammps_frame, loop.system.box.is_lammps_frame and loop.system.box.triclinic
        q[33] = measured is not self.temp
        self.resize(loop)
        return p

    def resize(self, loop) -> None:
        super().resize(loop)
        self.q[5] = loop.system.n
        self.q[22] = tail_virial(loop, self.press)

    def atom_arrays(self, loop) -> tuple[np.ndarray, ...]:
        """Not by atom: the numbers of the barostat, see `asemd.fix.barostat`."""
        self.w = np.array([float(t.category in self.press.terms or t.category not in VIRIAL) for t in loop.engine.terms])
        return self.q, self.b, self.e, self.w, self.m

    def reference(self, loop) -> float:
        return self.target(loop) if self.thermal else self.first_temperature(loop)

    def first_temperature(self, loop) -> float:
        """That at the start of the first run, or `ptemp`."""
        if self.reference_temperature == 0.0:
            self.reference_temperature = self.ptemp or self.temp.scalar(loop.snapshot())
            if self.reference_temperature < SMALLEST:
                raise InputError(f"fix {self.id} (style {self.style}): the temperature is zero and cannot set the masses of the box; "
                                 "give the atoms velocities, or ptemp")
        return self.reference_temperature

    def setup(self, loop) -> None:
        """Masses of the box and of its chain, targets, and where strain is counted from."""
        super().setup(loop)
        p, q, b, e, state = self.p, self.q, self.b, self.e, loop.state
        if q[18] == 0.0:
            hold_box(state, q, self.m)
        target_pressure(loop._thread(), state, q, b, self.m)
        kt, n = p[3] * p[13], self.pressure_chain
        controlled = b[3] != 0.0
        b[8] = 0.0
        b[8, controlled] = (q[5] + 1.0) * kt / b[2, controlled] ** 2
        if n:
            e[3, :n] = kt / q[8] ** 2
            e[2, 1:n] = (e[3, :n - 1] * e[1, :n - 1] ** 2 - kt) / e[3, 1:n]
        snapshot, measured = loop.snapshot(), self.press.temperature or self.temp
        self.m[4] = state.box.vectors
        if self.temp.style == "viscosity/cos" and self.q[0] != 1.0:
            raise InputError(f"fix {self.id} (style {self.style}): a temperature of style viscosity/cos goes with iso only")
        b[9], b[10] = self.temp.vector(snapshot)[:6], measured.vector(snapshot)[:6]
        q[32] = self._volume(state.box.vectors, q[26])

    @staticmethod
    def _volume(vectors: np.ndarray, dimension: float) -> float:
        return abs(float(np.linalg.det(vectors if dimension == 3 else vectors[:2, :2])))

    def pre_exchange(self, loop) -> None:
        """Before the list is built: a box that is tilted far becomes an equal one."""
        box, periodic = loop.state.box, loop.engine.periodic
        v = box.vectors.copy()
        if periodic[1] and not -FLIP * v[1, 1] <= v[2, 1] < FLIP * v[1, 1]:
            v[2] -= np.sign(v[2, 1]) * v[1]
        if periodic[0]:
            for row in (2, 1):
                if not -FLIP * v[0, 0] <= v[row, 0] < FLIP * v[0, 0]:
                    v[row] -= np.sign(v[row, 0]) * v[0]
        if not np.array_equal(v, box.vectors):
            turned = np.rint(box.vectors @ np.linalg.inv(v)).astype(loop.system.image.dtype)
            loop.system.image[:] = loop.system.image @ turned
            changed(loop.state, v, box.origin.copy())

    def broken_constraint(self, loop) -> str:
        if self.q[29] == 1.0:
            return "the box was tilted too far in one step: it is too far from equilibrium, or Pdamp is too short"
        return "the pressure is not a number: the run has come apart" if self.q[29] == 2.0 else ""

    def finish(self, loop) -> None:
        broken = self.broken_constraint(loop)
        if broken:
            raise SimulationError(f"fix {self.id} (style {self.style}): {broken}")

    # ---- outputs ------------------------------------------------------------------------------------------------------------------------
    def modify_option(self, keyword, value, session):
        if keyword == "press":
            take_pressure(self, value, session)
            return True
        return super().modify_option(keyword, value, session)

    def box_energies(self) -> list[np.ndarray]:
        """Potential and kinetic energies of the box and of its chain, then the strain energy, as LAMMPS's vector has them."""
        q, b, e, n = self.q, self.b, self.e, self.pressure_chain
        kt = self.p[3] * self.p[13]
        kinetic = 0.5 * b[8] * b[7] ** 2
        potential = np.where(np.arange(6) < 3, b[3], 0.0) * q[19] * (q[32] - q[18]) / (max(q[6], 1.0) * q[7])
        return [potential, kinetic, kt * e[0, :n], 0.5 * e[3, :n] * e[1, :n] ** 2]

    def strain(self) -> float:
        """Energy of the strain where targets differ between directions."""
        if not self.q[3]:
            return 0.0
        h = self.m[4].T
        return 0.5 * float(np.trace(self.m[1] @ h @ h.T)) / self.q[7]

    def scalar(self) -> float:
        """Energy of what atoms and box are coupled to, energy units."""
        potential, kinetic, chain, moving = self.box_energies()
        weight = float(self.b[3].sum())
        thermal = super().scalar() if self.thermal else 0.0
        box = sum(float(e.sum()) for e in (potential, kinetic, chain, moving))
        return thermal + box + (weight - 1.0) * float(chain[:1].sum()) + self.strain()

    def _of_box(self, values: np.ndarray, total: bool = False) -> np.ndarray:
        """The components that stand in the vector: one of an isotropic box, three, or six."""
        if self.style_number == 1:
            return values[:3].sum(keepdims=True) if total else values[:1]
        return values[:3 if self.style_number == 2 else 6]

    def elements(self) -> list[np.ndarray]:
        thermal = super().elements() if self.thermal else [np.zeros(0)] * 4
        potential, kinetic, chain, moving = self.box_energies()
        n = self.pressure_chain
        out = [*thermal[:2], self._of_box(self.b[6]), self._of_box(self.b[7]), self.e[0, :n], self.e[1, :n], *thermal[2:],
               self._of_box(potential, True), self._of_box(kinetic, True), chain, moving]
        return out + [np.array([self.strain()])] * self.deviatoric

    @property
    def size(self) -> int:
        box = {1: 1, 2: 3, 3: 6}[self.style_number] if self.ready else 6
        return 4 * (self.chain * self.thermal + self.pressure_chain + box) + self.deviatoric

    def state(self) -> dict:
        """The chains, the box's rates, and where strain is counted from."""
        own = {"omega": self.b[6].copy(), "omega_dot": self.b[7].copy(), "etap": self.e[0].copy(), "etap_dot": self.e[1].copy(),
               "volume": float(self.q[18]), "reference": float(self.reference_temperature), "box": self.m[0].copy(),
               "fixed_point": self.fixed_point}
        return (super().state() if self.thermal else {}) | own

    def restore(self, state: dict) -> None:
        super().restore(state)
        self.b[6], self.b[7] = state["omega"], state["omega_dot"]
        if len(state["etap"]) == self.pressure_chain + 1:
            self.e[0], self.e[1] = state["etap"], state["etap_dot"]
        self.q[18], self.reference_temperature, self.m[0] = state["volume"], state["reference"], state["box"]
        if self.centred and state.get("fixed_point"):       # the centre of the first box, to the last bit
            self.fixed_point = tuple(state["fixed_point"])
