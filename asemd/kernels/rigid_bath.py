r"""Nose-Hoover chains and the barostat of rigid bodies, compiled.

Numbers ``p`` from 16 on: 16 thermostat (1 or 0), 17 barostat, 18 19 temperature at start and stop, 20 thermostat frequency, 21 chain
length, 22 sub-steps, 23 order, 24 25 degrees of freedom of translation and rotation, 26 boltz, 27 target temperature, 28 29 twice the
kinetic energy of translation and rotation, 30 mean strain rate over degrees of freedom, 31 coupling (0 none, 1 xyz, 2 xy, 3 yz, 4 xz), 32
one scalar pressure, 33 number of directions, 34:37 which, 37:40 40:43 pressures at start and stop, 43:46 frequencies, 46:49 logarithms of
the lengths, 49:52 their rates, 52:55 their masses, 55 largest frequency, 56 length of the barostat's chain, 57 nktv2p, 58 tail of the
virial times volume, 59 group bit of the atoms that are scaled, 60 that of the temperature, 61:64 target pressures, 64 their mean, 66:71
weights of the Suzuki-Yoshida sub-steps. From 80 on the chains of translation, rotation and barostat: positions, rates, accelerations and
masses of each.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.kernels.box import follow
from asemd.kernels.threads import barrier


def body_sinh_ratio(y):
    """sinh(y) / y by its series."""
    y2 = y * y
    return 1.0 + y2 / 6.0 * (1.0 + y2 / 20.0 * (1.0 + y2 / 42.0 * (1.0 + y2 / 72.0)))


def body_slowing(p, half, slow):
    """What is left of velocities (3) and of the momentum conjugate to q after the time `half` with the chains and the strain rates."""
    n = int(p[21])
    slow[:] = 1.0
    if p[16] != 0.0:
        slow[:3], slow[3] = math.exp(-half * p[80 + n]), math.exp(-half * p[80 + 5 * n])
    if p[17] != 0.0:
        for d in range(3):
            slow[d] *= math.exp(-half * (p[49 + d] + p[30]))
        slow[3] *= math.exp(-half * p[33] * p[30])


def body_ramp(th, start, stop):
    """A target of this step."""
    if th.end == th.begin:
        return start
    return start + (th.step - th.begin) / (th.end - th.begin) * (stop - start)


def body_inward(p, at, n, w, share):
    """Half a sub-step of the rates of a chain from its end to its beginning."""
    rate, push = p[at + n:at + 2 * n], p[at + 2 * n:at + 3 * n]
    rate[n - 1] += 0.5 * w * push[n - 1]
    for k in range(n - 2, -1, -1):
        y = 0.25 * w * rate[k + 1]
        slow = math.exp(-share * y)
        rate[k] = rate[k] * slow * slow + 0.5 * w * push[k] * slow * body_sinh_ratio(y)


def body_outward(p, at, n, w, share, kt):
    """The other half, from the beginning to the end."""
    rate, push, mass = p[at + n:at + 2 * n], p[at + 2 * n:at + 3 * n], p[at + 3 * n:at + 4 * n]
    for k in range(n - 1):
        y = 0.25 * w * rate[k + 1]
        slow = math.exp(-share * y)
        rate[k] = rate[k] * slow * slow + 0.5 * w * push[k] * slow * body_sinh_ratio(y)
        push[k + 1] = (mass[k] * rate[k] * rate[k] - kt) / mass[k + 1]
    rate[n - 1] += 0.5 * w * push[n - 1]


def body_thermostat_step(th, p, at, dof, twice):
    """One timestep of the chain at ``p[at]`` for `dof` degrees of freedom with `twice` their kinetic energy."""
    n, loops, kt = int(p[21]), int(p[22]), p[26] * p[27]
    rate, push, mass = p[at + n:at + 2 * n], p[at + 2 * n:at + 3 * n], p[at + 3 * n:at + 4 * n]
    for k in range(n):
        mass[k] = kt / (p[20] * p[20])
    mass[0] *= dof
    for k in range(1, n):
        push[k] = (mass[k - 1] * rate[k - 1] * rate[k - 1] - kt) / mass[k]
    push[0] = (twice - dof * kt) / mass[0]
    for _ in range(loops):
        for j in range(int(p[23])):
            w = p[66 + j] * th.dt / loops
            body_inward(p, at, n, w, 1.0)
            for k in range(n):
                p[at + k] += w * rate[k]
            for k in range(1, n):
                push[k] = (mass[k - 1] * rate[k - 1] * rate[k - 1] - kt) / mass[k]
            body_outward(p, at, n, w, 1.0, kt)


def body_barostat_step(th, p):
    """One timestep of the chain of the barostat."""
    at, n, loops, kt = 80 + 8 * int(p[21]), int(p[56]), int(p[22]), p[26] * p[27]
    rate, push, mass = p[at + n:at + 2 * n], p[at + 2 * n:at + 3 * n], p[at + 3 * n:at + 4 * n]
    dimension = p[11]
    for k in range(n):
        mass[k] = kt / (p[55] * p[55])
    mass[0] *= dimension * dimension
    for k in range(1, n):
        push[k] = (mass[k - 1] * rate[k - 1] * rate[k - 1] - kt) / mass[k]
    twice = 0.0
    for d in range(3):
        if p[34 + d] != 0.0:
            p[52 + d] = (p[24] + p[25] + dimension) * kt / (p[43 + d] * p[43 + d])
            twice += p[52 + d] * p[49 + d] * p[49 + d]
    push[0] = (twice / p[33] - kt) / mass[0]
    for _ in range(loops):
        for j in range(int(p[23])):
            w = p[66 + j] * th.dt / loops
            body_inward(p, at, n, w, 0.5)
            for k in range(n):
                p[at + k] += w * rate[k]
            for k in range(1, n):
                push[k] = (mass[k - 1] * rate[k - 1] * rate[k - 1] - kt) / mass[k]
            body_outward(p, at, n, w, 0.5, kt)


def body_push_box(th, s, p, kinetic, half):
    """Half a timestep of the strain rates by the pressure; `kinetic (3,)` is the sum of m v v, energy units. One thread calls it."""
    h, planar = s.box.vectors, p[11] == 2.0
    volume = h[0, 0] * h[1, 1] * (1.0 if planar else h[2, 2])
    pressure = p[72:75]
    for d in range(3):
        total = kinetic[d] + p[58] / volume
        for t in range(s.virial.shape[0]):
            total += s.virial[t, d]
            for k in range(s.acc.shape[1]):
                total += s.acc[t, k, 2 + d]
        pressure[d] = total / volume * p[57]
    body_couple_pressure(p, pressure)
    p[64] = 0.0
    for d in range(3):
        if p[34 + d] != 0.0:
            p[61 + d] = body_ramp(th, p[37 + d], p[40 + d])
            p[64] += p[61 + d] / p[33]
    body_strain(p, pressure, volume, half)


def body_couple_pressure(p, pressure):
    """Coupled directions feel the mean of their pressures."""
    kind = int(p[31])
    if p[32] != 0.0:
        mean = (pressure[0] + pressure[1] + (pressure[2] if p[11] == 3.0 else 0.0)) / p[11]
        pressure[0] = pressure[1] = pressure[2] = mean
    elif kind == 1:
        pressure[0] = pressure[1] = pressure[2] = (pressure[0] + pressure[1] + pressure[2]) / 3.0
    elif kind == 2:
        pressure[0] = pressure[1] = 0.5 * (pressure[0] + pressure[1])
    elif kind == 3:
        pressure[1] = pressure[2] = 0.5 * (pressure[1] + pressure[2])
    elif kind == 4:
        pressure[0] = pressure[2] = 0.5 * (pressure[0] + pressure[2])


def body_strain(p, pressure, volume, half):
    """The change of the strain rates; ``p[28]`` and ``p[29]`` are in units of mass and velocity."""
    dof, slow = p[24] + p[25], math.exp(-half * p[80 + 8 * int(p[21]) + int(p[56])])
    p[30] = 0.0
    for d in range(3):
        if p[34 + d] != 0.0:
            force = (pressure[d] - p[64]) * volume / p[57] + (p[28] + p[29]) * p[12] / dof
            p[49 + d] = (p[49 + d] + half * force / p[52 + d]) * slow
            p[30] += p[49 + d] / dof


def body_scale_box(th, s, p, half):
    """Half a timestep of the box about its centre, and of the atoms in it. All threads call it."""
    h, o, bit, mine = s.box.vectors, s.box.origin, np.int32(np.int64(p[59])), slice(th.lo, th.hi)
    f0, f1, f2 = math.exp(half * p[49]), math.exp(half * p[50]), math.exp(half * p[51])
    c0, c1, c2 = o[0] + 0.5 * h[0, 0], o[1] + 0.5 * h[1, 1], o[2] + 0.5 * h[2, 2]
    barrier(th)
    if th.tid == 0:
        for d in range(3):
            p[46 + d] += half * p[49 + d]
        h[0, 0] *= f0
        h[1, 1] *= f1
        h[2, 2] *= f2
        o[0], o[1], o[2] = c0 - 0.5 * h[0, 0], c1 - 0.5 * h[1, 1], c2 - 0.5 * h[2, 2]
        follow(s.box)
    mask = s.mask[mine]
    x, y, z = s.x[0, mine], s.x[1, mine], s.x[2, mine]
    for i in range(x.size):
        if mask[i] & bit != 0:
            x[i] = c0 + (x[i] - c0) * f0
            y[i] = c1 + (y[i] - c1) * f1
            z[i] = c2 + (z[i] - c2) * f2
    barrier(th)
