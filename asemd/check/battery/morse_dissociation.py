r"""A Morse bond that swings just below its dissociation energy, and one that breaks just above it.

With :math:`E = D (1 - e^{-\alpha (r - r_0)})^2` and energy :math:`\epsilon D` the period is
:math:`2 \pi / (\alpha \sqrt{2 D / \mu} \sqrt{1 - \epsilon})`, and for :math:`\epsilon > 1` the atoms part with the speed
:math:`\sqrt{2 (\epsilon - 1) D / \mu}`. Velocity Verlet moves as if the energy were
:math:`H + \tfrac{\Delta t^2}{12} \tfrac{p^2}{\mu^2} V'' - \tfrac{\Delta t^2}{24 \mu} V'^2`, which at the rest length is more by the part
:math:`(\omega_0 \Delta t)^2 / 6`: with :math:`\omega_0 \Delta t` = 0.01 that moves the period at :math:`\epsilon` = 0.9 by 7.5e-5 and the
speed at :math:`\epsilon` = 1.01 by 8.4e-4. The limits are 1e-4 and 1e-3.

Source: P. M. Morse, Phys. Rev. 34, 57 (1929); E. Hairer, C. Lubich, G. Wanner, Acta Numerica 12, 399 (2003), for the energy near which
Verlet moves.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.check.battery import Figure, case, vectors

D, ALPHA, REST = 10.0, 2.0, 1.0
OMEGA = ALPHA * math.sqrt(2.0 * D / 0.5)        # of small swings; the reduced mass of two atoms of mass 1 is 0.5
DT = 0.01 / OMEGA


def dimer(start, energy: float):
    """Atoms at the rest length that move apart with that energy."""
    session, speed = start(), math.sqrt(energy)       # of each atom: 2 times 1/2 m v^2
    session.commands_string(f"""
        units lj
        atom_style bond
        atom_modify map array
        boundary f f f
        region box block -40 40 -10 10 -10 10
        create_box 2 box bond/types 1 extra/bond/per/atom 1
        mass * 1.0
        create_atoms 1 single {-0.5 * REST!r} 0 0
        create_atoms 2 single {0.5 * REST!r} 0 0
        pair_style zero 5.0
        pair_coeff * *
        bond_style morse
        bond_coeff 1 {D} {ALPHA} {REST}
        create_bonds single/bond 1 1 2
        group left type 1
        group right type 2
        velocity left set {-speed!r} 0 0
        velocity right set {speed!r} 0 0
        neighbor 1.0 bin
        fix 1 all nve
        timestep {DT!r}
        run 0""")
    return session


def crossings(session, count: int, stride: int = 20) -> np.ndarray:
    """Times at which the bond passes its rest length on its way out."""
    found, t = [], 0.0
    before = speed_before = 0.0
    while len(found) < count and t < 1e4 * DT * stride:
        session.command(f"run {stride} pre no post no")
        x, v = vectors(session, "x"), vectors(session, "v")
        t += stride * DT
        q, speed = x[1, 0] - x[0, 0] - REST, v[1, 0] - v[0, 0]
        if before < 0.0 <= q:
            found.append(_root(t - stride * DT, stride * DT, before, q, speed_before, speed))
        before, speed_before = q, speed
    return np.array(found)


def _root(t: float, dt: float, a: float, b: float, va: float, vb: float) -> float:
    """Zero of the cubic with these ends and slopes, which is within (stride omega dt)^4 of the motion."""
    low, high = 0.0, 1.0
    for _ in range(60):
        s = 0.5 * (low + high)
        value = (1 + 2 * s) * (1 - s) ** 2 * a + s * s * (3 - 2 * s) * b + dt * (s * (1 - s) ** 2 * va - s * s * (1 - s) * vb)
        low, high = (s, high) if value < 0.0 else (low, s)
    return t + low * dt


@case("Morse dissociation",
      Figure("period at 0.9 of the depth", 1e-4, "relative error of the period of a bond that holds 0.9 of its dissociation energy"),
      Figure("speed of the parts, 1.01 of the depth", 1e-3, "relative error of the speed at which the atoms part if they had one hundredth "
             "more energy than the bond holds"))
def morse_dissociation(start):
    times = crossings(dimer(start, 0.9 * D), 6, stride=5)
    period = 2.0 * math.pi / (OMEGA * math.sqrt(1.0 - 0.9))
    session = dimer(start, 1.01 * D)
    session.command("run 20000 post no")
    v = vectors(session, "v")
    return {"period at 0.9 of the depth": abs(np.diff(times).mean() / period - 1.0) if len(times) == 6 else math.inf,
            "speed of the parts, 1.01 of the depth": abs((v[1, 0] - v[0, 0]) / math.sqrt(2.0 * 0.01 * D / 0.5) - 1.0)}
