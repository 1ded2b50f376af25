r"""What the Nose-Hoover barostats share in compiled code: the pressure, the box as a dynamical variable, its own thermostat chain.

The box matrix :math:`h` has the box vectors as columns. Each of its components that is controlled has a rate :math:`\dot\omega`,

.. math:: \dot h = \dot\omega\, h, \qquad
          W_i \ddot\omega_i = (P_i - P_0) V + \frac{1}{N d} \sum_i m_i v_i^2 - f^{dev}_i, \qquad
          W_i = (N + 1) k_B T_0 \tau_i^2

with :math:`f^{dev} = h \sigma h^T`, :math:`\sigma = V_0 h_0^{-1} (P^{target} - P_0) h_0^{-T}` where the target is not the same in all
directions. Components stand in Voigt's order here, xx yy zz yz xz xy.

Functions of this module get, beside ``th`` and ``s``, the arrays that `asemd.fix.nose_hoover.Barostat` makes:

- ``q``: 0 style (1 isotropic, 2 anisotropic, 3 with shear), 1 coupling (1 xyz, 2 xy, 3 yz, 4 xz), 2 mtk, 3 whether the target has a
  deviatoric part, 4 nreset, 5 atoms, 6 controlled lengths d, 7 nktv2p, 8 largest frequency, 9 drag, 10 loops and 11 length of the chain,
  12-14 fixed point, 15-17 whether xy xz yz follow the lengths, 18 volume at the start, 19 mean target pressure, 20 what the box adds to the
  friction of each atom, 21 bit of the atoms that are dilated, 22 tail correction times volume, 23 and 24 weights of the fixes' virial and
  of the kinetic part, 25 bit of the pressure's temperature, 26 dimension, 27 whether velocities must be measured again, 28 whether there
  is a thermostat, 29 trouble (1 tilted too far, 2 pressure not a number), 30 whether the box has another frame than LAMMPS's, 31 whether
  the last change sheared it, 32 volume, 33 whether the pressure has another temperature;
- ``b`` rows: 0 start, 1 stop, 2 frequency, 3 flag, 4 target, 5 pressure now, 6 omega, 7 its rate, 8 mass, 9 kinetic tensor, 10 that of the
  pressure (both xx yy zz xy xz yz), 11-13 origins before, between and after the two changes of a step, 14 factors of the velocities;
- ``e`` rows: position, rate, acceleration and mass of the chain;
- ``w``: the weight of each term in the pressure; ``m``: inverse of the first h, sigma, the matrices of the two changes, box vectors.

Source: G. J. Martyna, D. J. Tobias, M. L. Klein, J. Chem. Phys. 101, 4177 (1994); M. Parrinello, A. Rahman, J. Appl. Phys. 52, 7182 (1981);
M. E. Tuckerman et al., J. Phys. A 39, 5629 (2006); W. Shinoda, M. Shiga, M. Mikami, Phys. Rev. B 69, 134103 (2004).
"""
from __future__ import annotations

import math

import numpy as np

from asemd.kernels.threads import reduce_sum


def kinetic_tensor(th, s, bit, terms, unit, out):
    """Sum of m v v over a group into ``out``: xx yy zz, and xy xz yz with six terms. All threads call it; thread 0 writes."""
    mine = slice(th.lo, th.hi)
    mask, mass = s.mask[mine], s.mass[mine]
    for k in range(terms):
        first, second = k, k
        if k > 2:
            first, second = (0, 1) if k == 3 else (0, 2) if k == 4 else (1, 2)
        u, v = s.v[first, mine], s.v[second, mine]
        total = 0.0
        for i in range(u.size):
            total += mass[i] * u[i] * v[i] if mask[i] & bit != 0 else 0.0
        total = reduce_sum(th, total)
        if th.tid == 0:
            out[k] = unit * total


def box_volume(s, q):
    """The volume, or the area in two dimensions."""
    v = s.box.vectors
    if q[26] == 2.0:
        return abs(v[0, 0] * v[1, 1] - v[0, 1] * v[1, 0])
    return abs(v[0, 0] * (v[1, 1] * v[2, 2] - v[1, 2] * v[2, 1]) - v[0, 1] * (v[1, 0] * v[2, 2] - v[1, 2] * v[2, 0])
               + v[0, 2] * (v[1, 0] * v[2, 1] - v[1, 1] * v[2, 0]))


def measure_pressure(s, q, b, w):
    """The pressure of the present velocities and the last forces, with coupled components averaged, into ``b[5]``."""
    dimension, volume = int(q[26]), box_volume(s, q)
    total = np.empty(6)
    for c in range(6):
        total[c] = q[24] * b[10, c]
        for t in range(s.acc.shape[0]):
            for k in range(w.size):
                total[c] += w[k] * s.acc[t, k, 2 + c]
            total[c] += q[23] * s.virial[t, c]
        if c < 3:
            total[c] += q[22] / volume
    unit = q[7] / volume
    now = b[5]
    if q[0] == 1.0:
        now[0] = (total[0] + total[1] + (total[2] if dimension == 3 else 0.0)) / dimension * unit
        now[1] = now[2] = now[0]
    else:
        for c in range(3):
            now[c] = total[c] * unit
        now[3], now[4], now[5] = total[5] * unit, total[4] * unit, total[3] * unit
        if q[1] == 1.0:
            now[0] = (now[0] + now[1] + now[2]) / 3.0
            now[1] = now[2] = now[0]
        elif q[1] > 1.0:
            i, j = (0, 1) if q[1] == 2.0 else (1, 2) if q[1] == 3.0 else (0, 2)
            now[i] = 0.5 * (now[i] + now[j])
            now[j] = now[i]
    if not math.isfinite(now[0] + now[1] + now[2]):
        q[29] = 2.0
    q[32] = volume


def target_pressure(th, s, q, b, m):
    """Targets of this step; the tensor sigma where they differ."""
    done = 0.0
    if th.end != th.begin:
        done = (th.step - th.begin) / (th.end - th.begin)
    mean = 0.0
    for i in range(6):
        if b[3, i] != 0.0:
            b[4, i] = b[0, i] + done * (b[1, i] - b[0, i])
            if i < 3:
                mean += b[4, i]
    q[19] = mean / q[6] if q[6] > 0.0 else 0.0
    if q[3] == 0.0:
        return
    if q[4] > 0.0 and (th.step - th.begin) % int(q[4]) == 0:
        hold_box(s, q, m)
    h, sigma = m[0], m[1]
    t = np.zeros((3, 3))
    for i in range(3):
        t[i, i] = b[4, i] - q[19]
    t[1, 2] = t[2, 1] = b[4, 3]
    t[0, 2] = t[2, 0] = b[4, 4]
    t[0, 1] = t[1, 0] = b[4, 5]
    for i in range(3):
        for j in range(3):
            value = 0.0
            for k in range(3):
                for n in range(3):
                    value += h[i, k] * t[k, n] * h[j, n]
            sigma[i, j] = q[18] * value


def hold_box(s, q, m):
    """The present box becomes the one from which the strain is counted."""
    v, h = s.box.vectors, m[0]
    q[18] = box_volume(s, q)
    h[:] = 0.0
    h[0, 0], h[1, 1], h[2, 2] = 1.0 / v[0, 0], 1.0 / v[1, 1], 1.0 / v[2, 2]
    h[0, 1] = -v[1, 0] / (v[0, 0] * v[1, 1])
    h[1, 2] = -v[2, 1] / (v[1, 1] * v[2, 2])
    h[0, 2] = (v[2, 1] * v[1, 0] - v[1, 1] * v[2, 0]) / (v[0, 0] * v[1, 1] * v[2, 2])


def push_box(th, s, p, q, b, m):
    """Half a step of the box's rates, from the pressure in ``b[5]``; the factors of the velocities follow."""
    half, volume, rate, mass = 0.5 * th.dt, box_volume(s, q), b[7], b[8]
    drag = 1.0 - th.dt * q[8] * q[9] / q[10] if q[10] > 0.0 else 1.0
    extra = 0.0
    if q[2] != 0.0:
        if q[0] == 1.0:
            extra = p[2] * p[3] * p[11]
        else:
            for i in range(3):
                extra += b[9, i] * b[3, i]
        extra /= q[6] * q[5] if q[6] > 0.0 else 1.0
    m[4] = s.box.vectors
    q[20] = 0.0
    for i in range(6):
        if b[3, i] == 0.0:
            continue
        force = (b[5, i] - q[19]) * volume / q[7] + extra if i < 3 else b[5, i] * volume / q[7]
        if q[3] != 0.0:
            j, k = (i, i) if i < 3 else (1, 2) if i == 3 else (0, 2) if i == 4 else (0, 1)
            strain = 0.0
            for n in range(3):
                for o in range(3):
                    strain += s.box.vectors[n, j] * m[1, n, o] * s.box.vectors[o, k]
            force -= strain / q[7]
        rate[i] = (rate[i] + force / mass[i] * half) * drag
        if i < 3:
            q[20] += rate[i]
    q[20] = q[20] / (q[6] * q[5]) if q[2] != 0.0 and q[6] > 0.0 else 0.0
    for d in range(3):
        b[14, d] = math.exp(-0.25 * th.dt * (rate[d] + q[20]))


def barostat_chain(th, q, b, e, kt):
    """Half a step of the chain that thermostats the box."""
    n, loops, rate, mass = int(q[11]), int(q[10]), b[7], b[8]
    position, speed, push, weight = e[0], e[1], e[2], e[3]
    target, energy = 0.0, 0.0
    for i in range(6):
        if b[3, i] != 0.0:
            energy += mass[i] * rate[i] * rate[i]
            target += kt
    if q[0] == 1.0:
        target = kt
    push[0] = (energy - target) / weight[0]
    for _ in range(loops):
        half, quarter, eighth = 0.5 * th.dt / loops, 0.25 * th.dt / loops, 0.125 * th.dt / loops
        drag = 1.0 - th.dt * q[8] * q[9] / loops
        for k in range(n - 1, -1, -1):
            slow = math.exp(-eighth * speed[k + 1])
            speed[k] = (speed[k] * slow + push[k] * quarter) * drag * slow
        scale = math.exp(-half * speed[0])
        for k in range(n):
            position[k] += half * speed[k]
        energy = 0.0
        for i in range(6):
            if b[3, i] != 0.0:
                rate[i] *= scale
                energy += mass[i] * rate[i] * rate[i]
        push[0] = (energy - target) / weight[0]
        for k in range(n):
            slow = math.exp(-eighth * speed[k + 1])
            speed[k] *= slow
            if k > 0:
                push[k] = (weight[k - 1] * speed[k - 1] * speed[k - 1] - kt) / weight[k]
            speed[k] = (speed[k] + push[k] * quarter) * slow


def shear_box(half, q, b, v, ly, lz):
    """Part of the change of the tilts; ``ly`` and ``lz`` are lengths before the change, as in LAMMPS."""
    rate, flag = b[7], b[3]
    for turn in range(4):
        if flag[4] != 0.0 and (turn == 0 or turn == 3):
            grow = math.exp(0.125 * half * rate[0])
            v[2, 0] = (v[2, 0] * grow + 0.25 * half * (rate[5] * v[2, 1] + rate[4] * lz)) * grow
        elif flag[3] != 0.0 and turn == 1:
            grow = math.exp(0.25 * half * rate[1])
            v[2, 1] = (v[2, 1] * grow + 0.5 * half * rate[3] * lz) * grow
        elif flag[5] != 0.0 and turn == 2:
            grow = math.exp(0.25 * half * rate[0])
            v[1, 0] = (v[1, 0] * grow + 0.5 * half * rate[5] * ly) * grow


def dilate_box(th, s, q, b, m, turn):
    """Half a step of the box; `turn` is 0 before and 1 after the atoms move. The matrix that takes atoms along is ``m[2 + turn]``."""
    v, o, rate, flag, half, change = s.box.vectors, s.box.origin, b[7], b[3], 0.5 * th.dt, m[2 + turn]
    for i in range(6):
        b[6, i] += half * rate[i]
    for d in range(3):
        b[11 + turn, d] = o[d]
    change[:] = 0.0
    if q[30] != 0.0:
        grow = math.exp(half * rate[0])
        for d in range(3):
            o[d] = (o[d] - q[12 + d]) * grow + q[12 + d]
            change[d, d] = grow
            for i in range(3):
                v[i, d] *= grow
            b[12 + turn, d] = o[d]
        return
    lx, ly, lz, xy, xz, yz = v[0, 0], v[1, 1], v[2, 2], v[1, 0], v[2, 0], v[2, 1]
    if q[0] == 3.0:
        shear_box(half, q, b, v, ly, lz)
    for d in range(3):
        if flag[d] != 0.0:
            grow = math.exp(half * rate[d])
            o[d] = (o[d] - q[12 + d]) * grow + q[12 + d]
            v[d, d] *= grow
            if d == 1 and q[15] != 0.0:
                v[1, 0] *= grow
            if d == 2 and q[16] != 0.0:
                v[2, 0] *= grow
            if d == 2 and q[17] != 0.0:
                v[2, 1] *= grow
    if q[0] == 3.0:
        shear_box(half, q, b, v, ly, lz)
        if abs(v[2, 1]) > 1.5 * v[1, 1] or abs(v[2, 0]) > 1.5 * v[0, 0] or abs(v[1, 0]) > 1.5 * v[0, 0]:
            q[29] = 1.0
    change[0, 0], change[1, 1], change[2, 2] = v[0, 0] / lx, v[1, 1] / ly, v[2, 2] / lz
    if q[31] != 0.0:
        change[0, 1] = (v[1, 0] - change[0, 0] * xy) / ly
        change[1, 2] = (v[2, 1] - change[1, 1] * yz) / lz
        change[0, 2] = (v[2, 0] - change[0, 0] * xz - change[0, 1] * yz) / lz
    for d in range(3):
        b[12 + turn, d] = o[d]


def take_along(th, s, bit, before, change, after, shear):
    """Atoms follow the box."""
    mine = slice(th.lo, th.hi)
    mask, x, y, z = s.mask[mine], s.x[0, mine], s.x[1, mine], s.x[2, mine]
    for i in range(x.size):
        if mask[i] & bit != 0:
            c = z[i] - before[2]
            d = y[i] - before[1]
            e = x[i] - before[0]
            if shear:
                e = change[0, 0] * e + change[0, 1] * d + change[0, 2] * c
                d = change[1, 1] * d + change[1, 2] * c
            else:
                e, d = change[0, 0] * e, change[1, 1] * d
            x[i], y[i], z[i] = after[0] + e, after[1] + d, after[2] + change[2, 2] * c


def drag_velocities(th, s, bit, b, shear):
    """A quarter step of the friction by the box, twice, with the shear in between."""
    mine, rate = slice(th.lo, th.hi), b[7]
    mask, x, y, z = s.mask[mine], s.v[0, mine], s.v[1, mine], s.v[2, mine]
    f, g, h = b[14, 0], b[14, 1], b[14, 2]
    if shear:
        xy, xz, yz = 0.5 * th.dt * rate[5], 0.5 * th.dt * rate[4], 0.5 * th.dt * rate[3]
        for i in range(x.size):
            if mask[i] & bit != 0:
                u, v, w = x[i] * f, y[i] * g, z[i] * h
                x[i], y[i], z[i] = (u - v * xy - w * xz) * f, (v - w * yz) * g, w * h
    else:
        f, g, h = f * f, g * g, h * h
        for i in range(x.size):
            if mask[i] & bit != 0:
                x[i], y[i], z[i] = x[i] * f, y[i] * g, z[i] * h
