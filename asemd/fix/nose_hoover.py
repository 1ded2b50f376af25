r"""The Nose-Hoover integrators: their words, thermostat chain and outputs; `asemd.fix.npt` has those that change the box.

Keywords that belong to the barostat are read by all of them; a fix that controls no pressure takes no notice of those that do not ask for
one. `asemd.fix.nvt` has the formulas of the chain.
"""
from __future__ import annotations

import math
from functools import partial

import numpy as np

from asemd.compute.pressure import find_temperature
from asemd.errors import InputError, nearest
from asemd.fix.thermostat import Thermostat
from asemd.words import choice, number, take, whole, yes_no

HEADER = 16     # numbers before the chain: eta (n), its velocity (n + 1), acceleration (n), mass (n)
COMPONENTS = ("x", "y", "z", "yz", "xz", "xy")      # of the pressure, in Voigt's order
SHORT = {"iso": COMPONENTS[:3], "aniso": COMPONENTS[:3], "tri": COMPONENTS}
COUPLINGS = ("none", "xyz", "xy", "yz", "xz")
KEYWORDS = {"temp": 3, **dict.fromkeys((*SHORT, *COMPONENTS, "fixedpoint"), 3),
            **dict.fromkeys(("couple", "drag", "tchain", "tloop", "pchain", "ploop", "mtk", "nreset", "scalexy", "scaleyz", "scalexz",
                             "flip", "dilate", "ptemp", "update"), 1), "disc": 0}


def nose_hoover_chain(th, p):
    """Half a timestep of the chain; afterwards ``p[12]`` is the factor of the velocities and ``p[11]`` the temperature they then have.

    The masses of the chain follow the target temperature unless ``p[14]`` is set. ``p[15]`` are the degrees of freedom when the last half
    step ended: atoms that leave or join in between count for the temperature, but not yet for its target, as in LAMMPS.
    """
    dof, boltz, n, loops = p[2], p[3], int(p[9]), int(p[10])
    done = 0.0
    if th.end != th.begin:
        done = (th.step - th.begin) / (th.end - th.begin)
    target = p[5] + done * (p[6] - p[5])
    kt = boltz * target
    eta, rate, push, mass = p[16:16 + n], p[16 + n:17 + 2 * n], p[17 + 2 * n:17 + 3 * n], p[17 + 3 * n:17 + 4 * n]
    if p[14] == 0.0:
        for k in range(n):
            mass[k] = kt / (p[7] * p[7])
        mass[0] *= dof
    half, quarter, eighth = 0.5 * th.dt / loops, 0.25 * th.dt / loops, 0.125 * th.dt / loops
    drag = 1.0 - th.dt * p[7] * p[8] / loops
    push[0] = boltz * (dof * p[11] - p[15] * target) / mass[0] if dof > 0.0 else 0.0
    factor = 1.0
    for m in range(loops):
        for k in range(n - 1, -1, -1):
            slow = math.exp(-eighth * rate[k + 1])
            rate[k] = (rate[k] * slow + push[k] * quarter) * drag * slow
        scale = math.exp(-half * rate[0])
        factor *= scale
        if p.size > 17 + 4 * n:
            p[17 + 4 * n + m] = scale
        p[11] *= scale * scale
        push[0] = boltz * (dof * p[11] - p[15] * target) / mass[0] if dof > 0.0 else 0.0
        for k in range(n):
            eta[k] += half * rate[k]
        for k in range(n):
            slow = math.exp(-eighth * rate[k + 1])
            if k > 0:
                push[k] = (mass[k - 1] * rate[k - 1] * rate[k - 1] - kt) / mass[k]
                rate[k] *= slow
                rate[k] = (rate[k] + push[k] * quarter) * slow
            else:
                rate[k] *= slow
                rate[k] = (rate[k] + push[k] * quarter) * slow
    p[12], p[13], p[15] = factor, target, dof


class NoseHoover(Thermostat):
    """Base class: a chain with two half steps around the Verlet step.

    Parameters
    ----------
    group : str
        The atoms it moves.
    temperature : float or (float, float) or None
        Target, or target at the start and at the end of a run, in temperature units of the scene; None: no thermostat.
    damping : float
        Relaxation time, in time units of the scene; about 100 timesteps is usual.
    chain, loops : int
        Length of the chain, and its sub-steps.
    drag : float
        Damps oscillations of the chain; 0 is the true ensemble.

    Raises
    ------
    InputError
        A temperature or damping time that is not positive, a chain or loop count below 1, a negative drag.
    """

    integrates = True
    levels = "every"
    brings = ("temp",)
    takes_bias = True
    kinds = ("temp", "temp/com", "temp/partial", "temp/profile", "temp/ramp", "temp/rotate",
             "temp/sphere", "temp/asphere", "viscosity/cos", "temp/region", "temp/deform", "temp/cs")      # of the temperature it takes
    turns = False       # whether it moves bodies that turn: fixes nvt/sphere, nvt/asphere ...

    def modify_option(self, keyword, value, session):
        if keyword == "temp" and find_temperature(value, session, "fix_modify temp").style not in self.kinds:
            raise InputError(f"fix_modify temp: fix {self.style} takes a compute of style {', '.join(self.kinds)}; {value} has style "
                             f"{session.scene.computes[value].style}")
        return super().modify_option(keyword, value, session)

    @property
    def all_plain(self) -> bool:
        """Whether compiled hooks can measure all that it needs."""
        return self.plain

    def hooks(self) -> dict[str, bool]:
        for name in ("initial_integrate", "final_integrate"):
            vars(self).pop(name, None)
        if not self.all_plain:
            from asemd.fix import nose_hoover_biased as biased
            self.initial_integrate, self.final_integrate = partial(biased.begin, self), partial(biased.end, self)
        return super().hooks()

    def __init__(self, group: str = "all", temperature=300.0, damping: float = 100.0, chain: int = 3, loops: int = 1, drag: float = 0.0):
        self.thermal = temperature is not None
        super().__init__(group, 1.0 if temperature is None else temperature, damping)
        if callable(self.start) or min(self.start, self.stop) <= 0.0:
            raise InputError(f"fix {self.style}: target temperatures must be numbers above 0")
        if chain < 1 or loops < 1:
            raise InputError(f"fix {self.style}: tchain and tloop must be at least 1, got {chain} and {loops}")
        if drag < 0.0:
            raise InputError(f"fix {self.style}: drag must not be negative, got {drag:g}")
        self.chain, self.loops, self.drag = chain, loops, drag
        self.p = np.zeros(HEADER + 4 * chain + 1)

    @classmethod
    def read(cls, words: list[str], session) -> dict:
        """The keywords of a script as arguments; those of the barostat by their own names.

        Raises
        ------
        InputError
            An unknown keyword, missing or wrong values.
        """
        out: dict = {"components": {}, "couple": "none", "deviatoric": False}
        while words:
            keyword, words = words[0], words[1:]
            what = f"fix {cls.style} {keyword}"
            if keyword not in KEYWORDS:
                raise InputError(f"fix {cls.style}: unknown keyword {keyword!r}{nearest(keyword, KEYWORDS)}")
            values = take(words, KEYWORDS[keyword], what)
            words = words[len(values):]
            if keyword == "temp":
                start, stop, out["damping"] = (number(w, what) for w in values)
                out["temperature"] = start, stop
            elif keyword in SHORT or keyword in COMPONENTS:
                numbers = tuple(number(w, what) for w in values)
                for name in SHORT.get(keyword, (keyword,)):
                    out["components"][name] = (0.0, 0.0, numbers[2]) if keyword == "tri" and name in COMPONENTS[3:] else numbers
                if keyword in SHORT:
                    out["couple"], out["shape"] = "xyz" if keyword == "iso" else "none", keyword
                else:
                    out["deviatoric"] = True
                    out.setdefault("single", []).append(keyword)
            elif keyword == "couple":
                out["couple"] = choice(values[0], COUPLINGS, what)
            elif keyword in ("drag", "ptemp"):
                out[keyword] = number(values[0], what)
            elif keyword == "fixedpoint":
                out["fixed_point"] = tuple(number(w, what) for w in values)
            elif keyword in ("mtk", "flip", "scalexy", "scaleyz", "scalexz"):
                out[keyword] = yes_no(values[0], what)
            elif keyword == "dilate":
                session.scene.groups.mask(values[0], what)
                out["dilate"] = values[0]
            elif keyword in ("update", "disc"):
                if not cls.turns:
                    raise InputError(f"{what} is for spheres that turn, which need fix {cls.style}/sphere")
                out["dipole" if keyword == "update" else "disc"] = values[0] if values else True
            else:
                names = {"tchain": "chain", "tloop": "loops", "pchain": "pressure_chain", "ploop": "pressure_loops"}
                out[names.get(keyword, keyword)] = whole(values[0], what)
        return out

    def to_lammps(self) -> list[str]:
        words = ["temp", repr(self.start), repr(self.stop), repr(self.damping), "tchain", str(self.chain), "tloop", str(self.loops)]
        return (words if self.thermal else []) + (["drag", repr(self.drag)] if self.drag else [])

    def parameters(self, loop) -> np.ndarray:
        if not self.all_plain and hasattr(loop, "levels"):
            raise InputError(f"fix {self.id} (style {self.style}): under run_style respa the temperature must be a compute of style temp")
        self.p = self.p.copy()
        self.p[:11] = (loop.group_bit(self.group), loop.group_bit(self.temp.group), self.temp.dof(loop), loop.units.boltz, loop.units.mvv2e,
                       self.start, self.stop, 1.0 / self.damping, self.drag, self.chain, self.loops)
        return self.p

    def resize(self, loop) -> None:
        self.p[2] = self.temp.dof(loop)

    def setup(self, loop) -> None:
        """The chain's masses and accelerations for the temperature at the start of the run."""
        n, p = self.chain, self.p
        p[11:14], p[15] = (self.temp.scalar(loop.snapshot()), 1.0, self.reference(loop)), p[2]
        rate, push, mass = p[HEADER + n:HEADER + 2 * n], p[HEADER + 2 * n + 1:HEADER + 3 * n + 1], p[HEADER + 3 * n + 1:HEADER + 4 * n + 1]
        mass[:] = p[3] * p[13] * self.damping**2
        mass[0] *= p[2]
        if n > 1:
            push[1:] = (mass[:-1] * rate[:-1] ** 2 - p[3] * p[13]) / mass[1:]

    def reference(self, loop) -> float:
        """The temperature that sets the masses."""
        return self.target(loop)

    # ---- outputs ------------------------------------------------------------------------------------------------------------------------
    def chain_energies(self) -> tuple[np.ndarray, np.ndarray]:
        """Potential and kinetic energies of the links of the chain."""
        n, p = self.chain, self.p
        eta, rate, mass = p[HEADER:HEADER + n], p[HEADER + n:HEADER + 2 * n], p[HEADER + 3 * n + 1:HEADER + 4 * n + 1]
        potential = p[3] * p[13] * eta
        potential[0] *= p[15]
        return potential, 0.5 * mass * rate * rate

    def extensive_at(self, index) -> bool:
        """Whether ``thermo_modify norm yes`` divides an output by the number of atoms: the energy, not the elements of the vector."""
        return not index

    def scalar(self) -> float:
        """Energy of what the atoms are coupled to, energy units."""
        return float(sum(e.sum() for e in self.chain_energies()))

    def elements(self) -> list[np.ndarray]:
        """The parts of the vector: positions and velocities, then potential and kinetic energies."""
        at = HEADER + self.chain
        return [self.p[HEADER:at], self.p[at:at + self.chain], *self.chain_energies()]

    @property
    def size(self) -> int:
        """Elements of the vector."""
        return 4 * self.chain

    def vector(self, i: int) -> float:
        """Element `i`, from 1, of the positions and velocities of the chain, and of its potential and kinetic energies."""
        if not 1 <= i <= self.size:
            raise InputError(f"fix {self.id} (style {self.style}): the vector has {self.size} elements")
        return float(np.concatenate(self.elements())[i - 1])

    def state(self) -> dict:
        """Positions and velocities of the chain."""
        return {"eta": self.p[HEADER:HEADER + self.chain].copy(), "eta_dot": self.p[HEADER + self.chain:HEADER + 2 * self.chain].copy()}

    def restore(self, state: dict) -> None:
        """Of a chain of another length nothing is taken."""
        if len(state.get("eta", ())) == self.chain:
            self.p[HEADER:HEADER + self.chain] = state["eta"]
            self.p[HEADER + self.chain:HEADER + 2 * self.chain] = state["eta_dot"]
