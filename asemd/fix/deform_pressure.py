r"""Change the lengths and tilts of the box during a run, as fix deform, so that pressures come to what is wanted.

.. math:: \dot L = k\, (P - P_{target})\, L

with ``x pressure P k`` (that component of the pressure tensor) or ``x pressure/mean P k`` (the mean pressure); tilts follow the other
components. ``couple`` moves lengths together, by the mean of their components. ``box pressure P k`` scales the whole box besides what the
single lengths do, ``box volume`` keeps its volume. ``erate/rescale`` shears by a rate of the present length. ``max/rate`` limits rates,
``normalize/pressure`` counts differences in parts of the target. With ``vol/balance/p yes`` two lengths that keep the volume change by
rates of their own, :math:`e_1` and :math:`e_2`, such that their pressures become equal to first order; primes denote the step before:

.. math:: p_1 + \frac{p_1 - p_1'}{e_1'} e_1 = p_2 + \frac{p_2 - p_2'}{e_2'} e_2, \qquad (1 + e_1 \Delta t)(1 + e_2 \Delta t) V_3 = V

Here the third length makes the volume :math:`V_3` of `V`, and the first equation is taken with :math:`e_1 + e_2` of the second to first
order.

Source: LAMMPS manual, fix deform/pressure; X. Huang, dissertation, Imperial College London (2014) for vol/balance/p. Units: pressure,
1/(time pressure) (gains), 1/time (rates); others as fix deform.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from asemd.compute.pressure import Pressure, find_temperature
from asemd.compute.temp import Temp
from asemd.errors import InputError, nearest
from asemd.fix.deform import COUNTS, DIMENSIONS, ENTRY, Deform
from asemd.fix.formula import read
from asemd.fix.measured import take_pressure, take_temperature
from asemd.words import choice, number, take, whole, yes_no

STYLES = {"pressure": 2, "pressure/mean": 2, "erate/rescale": 1}
COUPLED = {"none": "", "xyz": "xyz", "xy": "xy", "yz": "yz", "xz": "xz"}
COMPONENT = {"x": 0, "y": 1, "z": 2, "xy": 3, "xz": 4, "yz": 5}
OWN = {"couple": 1, "max/rate": 1, "normalize/pressure": 1, "vol/balance/p": 1}
SCALABLE = ("vel", "erate", "trate", "wiggle", "volume")


class DeformPressure(Deform):
    """Deform the box by its pressure.

    Parameters
    ----------
    group, every, changes, remap, flip
        As `Deform`.
    controls : mapping
        ``x``, ``y``, ``z``, ``xy``, ``xz``, ``yz`` -> ``("pressure", target, gain)``, ``("pressure/mean", target, gain)`` for lengths,
        ``("erate/rescale", rate)`` for tilts; targets may be functions of the loop.
    box : sequence, optional
        ``("volume",)`` or ``("pressure", target, gain)``: what the whole box does.
    couple : str
        ``none``, ``xyz``, ``xy``, ``yz`` or ``xz``.
    max_rate : float
        Largest rate, 1/time; 0: no limit.
    normalize : bool
        Divide differences of pressure by the target.
    balance : bool
        Two lengths that keep the volume change such that their pressures become equal.

    Raises
    ------
    InputError
        Styles that do not go together, numbers that make no sense.
    """

    style = "deform/pressure"
    brings = ("temp", "press")
    needs = frozenset({"virial"})

    def __init__(self, group: str = "all", every: int = 1, changes: Mapping | None = None, remap: str = "x", flip: bool = True,
                 controls: Mapping | None = None, box=None, couple: str = "none", max_rate: float = 0.0, normalize: bool = False,
                 balance: bool = False):
        what = f"fix {self.style}"
        changes, controls = dict(changes or {}), dict(controls or {})
        for name, (style, *values) in controls.items():
            allowed = ("pressure", "pressure/mean") if len(name) == 1 else ("pressure", "erate/rescale")
            if len(values) != STYLES[choice(style, allowed, f"{what} {choice(name, DIMENSIONS, what)}")]:
                raise InputError(f"{what} {name} {style} needs {STYLES[style]} values, got {len(values)}")
        if max_rate < 0.0:
            raise InputError(f"{what} max/rate: the maximum strain rate must be positive, got {max_rate:g}")
        self._couple(choice(couple, COUPLED, f"{what} couple"), changes, controls)
        if box is not None:
            wrong = [n for n in "xyz" if n in changes and changes[n][0] not in SCALABLE]
            if wrong:
                raise InputError(f"{what}: box cannot be used with {wrong[0]} {changes[wrong[0]][0]}, only with pressure "
                                 f"{' '.join(SCALABLE)}")
        self.controls, self.box, self.couple = controls, box, couple
        self.max_rate, self.normalize, self.balance, self.before = max_rate, normalize, balance, np.zeros((2, 3))
        formulas = {name: ("variable", self._change(name), self._rate(name)) for name in controls}
        super().__init__(group, every, changes | formulas, remap, flip)
        self.end_of_step = self.by_formulas
        self.temp = Temp("all")
        self.press = Pressure("all", self.temp, ())
        self.own, self.added, self.speed, self.words = dict.fromkeys("xyz", 0.0), np.zeros(3), dict.fromkeys(DIMENSIONS, 0.0), []

    def _couple(self, couple: str, changes: dict, controls: dict) -> None:
        """Lengths that go together have one control."""
        axes, what = COUPLED[couple], f"fix {self.style} couple {couple}"
        if not axes:
            return
        given = [controls[a] for a in axes if a in controls]
        if any(a in changes for a in axes) or any(g[0] != "pressure" for g in given):
            raise InputError(f"{what}: Cannot couple non-pressure-controlled dimensions")
        if not given:
            raise InputError(f"{what}: Must specify deformation style for at least one coupled dimension")
        if any(g != given[0] for g in given):
            raise InputError(f"{what}: Coupled dimensions must have identical gain parameters")
        controls.update(dict.fromkeys(axes, given[0]))

    @classmethod
    def from_lammps(cls, group, words, session):
        what = f"fix {cls.style}"
        take(words, 1, f"{what} N")
        plain, controls, given, box, rest = [words[0]], {}, {}, None, list(words[1:])

        def value(name: str, style: str, found: list[str]) -> tuple:
            if style == "erate/rescale":
                return style, number(found[0], f"{what} {name}")
            return style, read(found[0], f"{what} {name} target", session), number(found[1], f"{what} {name} gain")
        while rest:
            key = rest[0]
            if key in DIMENSIONS or key == "box":
                style = take(rest[1:], 1, f"{what} {key}")[0]
                allowed = ("volume", "pressure") if key == "box" else (*COUNTS, *STYLES)
                n = STYLES.get(choice(style, allowed, f"{what} {key}"), COUNTS.get(style))
                found, after = rest[2:2 + n], rest[2 + n:]
                if key == "box":
                    box = (style,) if style == "volume" else value(key, style, take(found, n, f"{what} box pressure"))
                elif style in STYLES:
                    controls[key] = value(key, style, take(found, n, f"{what} {key} {style}"))
                else:
                    plain += rest[:2 + n]
                rest = after
            elif key in OWN:
                given[key] = take(rest[1:], 1, f"{what} {key}")[0]
                rest = rest[2:]
            elif key in ("remap", "flip", "units"):
                plain, rest = [*plain, *rest[:2]], rest[2:]
            else:
                raise InputError(f"{what}: unknown keyword {key!r}{nearest(key, (*OWN, 'box', *DIMENSIONS))}")
        limit = number(given["max/rate"], f"{what} max/rate") if "max/rate" in given else 0.0
        if "max/rate" in given and limit <= 0.0:
            raise InputError(f"{what} max/rate: the maximum strain rate must be a positive, non-zero value, got {limit:g}")
        changes, remap, flip = cls.read_plain(group, plain, controls, session)
        new = cls(group, whole(words[0], f"{what} N"), changes, remap, flip, controls, box, given.get("couple", "none"), limit,
                  *(yes_no(given.get(key, "no"), f"{what} {key}") for key in ("normalize/pressure", "vol/balance/p")))
        new.words = list(words)
        new.check_box(session.scene.system.box)
        return new

    @classmethod
    def read_plain(cls, group, words, controls, session) -> tuple[dict, str, bool]:
        """The words that fix deform has, too: changes, remap, flip."""
        standing = [w for name in controls if len(name) == 1 for w in (name, "vel", "0.0")]      # a volume needs lengths that change
        made = Deform.from_lammps(group, [words[0], *standing, *words[1:]], session)
        changes = {name: (c.how, *c.values) for name, c in made.changes.items() if name not in controls}
        return changes, made.remap, made.flip

    def to_lammps(self) -> list[str]:
        if not self.words:
            raise InputError("fix deform/pressure: this one was made in Python and has no script form")
        return self.words

    # ---- rates ------------------------------------------------------------------------------------------------------------------------
    def _limited(self, loop, target, gain: float, pressure: float) -> float:
        """The rate that a pressure asks for."""
        target = float(target(loop)) if callable(target) else target
        rate = gain * (pressure - target)
        if self.normalize:
            if target == 0.0 and not self.max_rate:
                raise InputError(f"fix {self.style}: Cannot normalize error for zero pressure without defining a max rate")
            rate = np.sign(rate) * self.max_rate if target == 0.0 else rate / abs(target)
        return float(np.clip(rate, -self.max_rate, self.max_rate)) if self.max_rate else rate

    def _change(self, name: str) -> Callable:
        """By how much a length or tilt differs from that at the start of the run, now."""
        def change(loop) -> float:
            style, *values = self.controls[name]
            p, k = self.p, 34 + 13 * DIMENSIONS.index(name)
            across = 1.0 if len(name) == 1 else float(np.diag(loop.state.box.vectors)["xyz".index(name[1])])
            if style == "erate/rescale":
                rate = values[0]
            else:
                rate = self._limited(loop, *values, self._pressure(name, style))
            self.speed[name] = rate * across
            now = float(loop.state.box.vectors[ENTRY[name]])
            if len(name) == 1:
                self.own[name] += loop.dt * rate * now
                return self.own[name]
            return now + loop.dt * rate * across - p[k + 1]
        return change

    def _rate(self, name: str) -> Callable:
        return lambda loop: self.speed[name]

    def _pressure(self, name: str, style: str) -> float:
        axes = COUPLED[self.couple]
        if style == "pressure/mean":
            return self.mean
        return float(np.mean([self.tensor[COMPONENT[a]] for a in axes]) if name in axes else self.tensor[COMPONENT[name]])

    def prepare(self, loop) -> None:
        super().prepare(loop)
        self.own, self.added = dict.fromkeys("xyz", 0.0), np.zeros(3)     # by what pressures change lengths themselves, and the whole box

    def by_formulas(self, loop) -> None:
        """`end_of_step` with the pressure of this step."""
        loop.sync_out()
        state = loop.snapshot()
        self.tensor, self.mean = self.press.vector(state), self.press.scalar(state)
        super().by_formulas(loop)

    def adjust(self, loop) -> None:
        now = np.diag(loop.state.box.vectors).copy()
        if self.balance:
            self._balance(now, loop.dt)
        if self.box is not None:
            self._scale_box(loop)
        self.before = np.stack([((self.p[15:18] - self.p[12:15]) / now - 1.0) / loop.dt, self.tensor[:3]])     # for the next time

    def _balance(self, now: np.ndarray, dt: float) -> None:
        """The two lengths that keep the volume, from the lengths `now`, the rates and pressures before, and the pressures now."""
        p, pair = self.p, [d for d, kept in self.kept.items() if kept[0] == 3]
        if not pair:
            return
        third = 3 - sum(pair)
        volume, length, first = np.prod(now), p[15 + third] - p[12 + third], p[41 + 13 * pair[0]]
        strained = length * np.prod(now[pair])
        (was1, was2), (p1, p2) = self.before[0, pair], self.tensor[pair]
        by1, by2 = self.tensor[pair] - self.before[1, pair]
        if length == now[third]:
            new = now[pair]
        elif was1 == 0.0 or was2 == 0.0 or (by1 == 0.0 and by2 == 0.0):      # nothing is known of how pressures answer
            new = np.sqrt(first * now[pair] / length / now[pair[::-1]])
        else:
            below = by2 + was2 * by1 / was1
            e1 = (by2 * (volume - strained) / (strained * dt) - was2 * (p1 - p2)) / below if below != 0.0 else was2
            e2 = _other_rate(e1, volume / strained, dt)
            if self.max_rate and max(abs(e1), abs(e2)) > self.max_rate:
                e1, e2 = self._capped(e1, e2, length > now[third], volume / strained, dt)
            new = now[pair] * (1.0 + dt * np.array([e1, e2]))
        middle = np.array([0.5 * (p[35 + 13 * d] + p[36 + 13 * d]) for d in pair])
        at = np.array(pair)
        p[3 + at] = (new / now[pair] - 1.0) / dt
        p[9 + at] = -0.5 * p[3 + at]
        p[12 + at], p[15 + at] = middle - 0.5 * new, middle + 0.5 * new

    def _capped(self, e1: float, e2: float, longer: bool, ratio: float, dt: float) -> tuple[float, float]:
        """Rates within the limit that keep the volume: of the larger one if it goes against the third length, else of the other."""
        larger = max(e1, e2, key=abs)
        against = (larger > 0.0) != longer and larger != 0.0
        sign = 1.0 if (larger > 0.0) == against else -1.0
        capped = sign * self.max_rate
        rates = capped, _other_rate(capped, ratio, dt)
        return rates if against == (abs(e1) > abs(e2)) else rates[::-1]

    def _scale_box(self, loop) -> None:
        p, start = self.p, self.p[34:34 + 39].reshape(3, 13)[:, 1:3]
        length = p[15:18] - p[12:15]
        if self.box[0] == "volume":
            scale = float(np.prod(start[:, 1] - start[:, 0]) / np.prod(length)) ** (1.0 / 3.0)
        else:
            added = length * loop.dt * self._limited(loop, *self.box[1:], self.mean)
            self.added += added
            # a length that nothing else changes is taken as it is now, the others as they would be without the scaling
            scale = 1.0 + np.array([(self.added if name in self.changes else added)[k] for k, name in enumerate("xyz")]) / length
        half, middle = 0.5 * length * scale, start.mean(axis=1)
        p[12:15], p[15:18] = middle - half, middle + half
        p[3:6] = (2.0 * half / np.diag(loop.state.box.vectors) - 1.0) / loop.dt
        p[9:12] = -0.5 * p[3:6]

    def state(self) -> dict:
        return super().state() | {"before": self.before}

    def restore(self, state: dict) -> None:
        super().restore(state)
        if "before" in state:
            self.before = np.array(state["before"], float).reshape(2, 3)

    def modify_option(self, keyword, value, session):
        if keyword == "temp":
            take_temperature(self, find_temperature(value, session, "fix_modify temp"), session)
            return True
        if keyword == "press":
            take_pressure(self, value, session)
            return True
        return super().modify_option(keyword, value, session)


def _other_rate(rate: float, ratio: float, dt: float) -> float:
    """The rate of a length that, with `rate` of another, changes the area of both by `ratio`."""
    return (ratio / (1.0 + rate * dt) - 1.0) / dt
