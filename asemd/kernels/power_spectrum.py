"""Energy and gradient of a site with the components of the smooth SO(3) power spectrum; tables are those of `asemd.power_spectrum`.

``room`` is one row of work space: the coefficients of the density, derivatives of the energy by them, components, derivatives by them,
nodes of a neural network and derivatives by them, the solid harmonics of one neighbour, derivatives by its harmonics and by its distance,
and the radial functions of each neighbour and their slopes.
"""
from __future__ import annotations

from asemd.kernels.manybody import PER_ATOM, share_pair
from asemd.kernels.snap import network, polynomial


def solid_harmonics(x, y, z, lmax, room, at):
    """Real and imaginary part of (x + iy)^m, times d^m P_l / dt^m (t = z / r) times r^(l - m), at places l (l + 1) + m and - m."""
    s = x * x + y * y + z * z
    room[at] = 1.0
    for l in range(1, lmax + 1):
        here, below, far = at + l * (l + 1), at + l * (l - 1), at + (l - 1) * (l - 2)
        room[here] = ((2 * l - 1) * z * room[below] - ((l - 1) * s * room[far] if l > 1 else 0.0)) / l
        for m in range(1, l):
            c, d = (2 * l - 1) * z, (l + m - 1) * s
            room[here + m] = (c * room[below + m] - (d * room[far + m] if m < l - 1 else 0.0)) / (l - m)
            room[here - m] = (c * room[below - m] - (d * room[far - m] if m < l - 1 else 0.0)) / (l - m)
        c, d = room[below + l - 1], room[below - l + 1] if l > 1 else 0.0
        room[here + l] = (2 * l - 1) * (x * c - y * d)
        room[here - l] = (2 * l - 1) * (x * d + y * c)


def harmonic_slope(room, at, l, m):
    """Derivatives of the harmonic of l and m (negative: the imaginary part) by x, y, z, from those of l - 1."""
    below = at + l * (l - 1)
    k = abs(m)
    gz = (l + k) * room[below + m] if k < l else 0.0
    if m == 0:
        return (-room[below + 1] if l > 1 else 0.0), (-room[below - 1] if l > 1 else 0.0), gz
    sign = 1.0 if m > 0 else -1.0
    # what raises m, and what lowers it
    up, across = (room[below + m + int(sign)], room[below - m - int(sign)]) if k + 1 < l else (0.0, 0.0)
    down = room[below + m - int(sign)] if k > 1 or m > 0 else 0.0
    turned = room[below - m + int(sign)] if k > 1 or m < 0 else 0.0
    c = 0.5 * (l + k) * (l + k - 1)
    return c * down - 0.5 * up, sign * (-c * turned - 0.5 * across), gz


def spectrum(i, ti, n, m, near, types, room, grad, constants, arrays, shares):
    by_type, beta, pairs, strengths, radial, nets, layers = arrays
    lmax, per_interval, quadratic = int(constants[0]), constants[1], constants[2]
    nlm, nq, groups = strengths.shape[0], radial.shape[2], pairs.shape[0]
    lines = lmax + 1
    nmax, ncoeff = nq // lines, groups * lines
    slopes = nmax * nlm
    component = 2 * slopes
    weight = component + ncoeff
    nodes = weight + ncoeff
    width = 0
    for k in range(layers.shape[0]):
        width += layers[k, 1]
    harmonic = nodes + 2 * width
    along = harmonic + nlm
    own = along + 2 * nlm
    for k in range(component):
        room[k] = 0.0
    for k in range(n):
        w = by_type[types[k], 1]
        q = own + 2 * nq * k
        u = near[3, k] * per_interval
        cell = min(int(u), radial.shape[0] - 1)
        u -= cell
        for p in range(nq):
            a, b, c, d = radial[cell, 0, p], radial[cell, 1, p], radial[cell, 2, p], radial[cell, 3, p]
            e = radial[cell, 4, p]
            room[q + p] = w * (((((a * u + b) * u + c) * u + d) * u + e) * u + radial[cell, 5, p])
            room[q + nq + p] = 2.0 * per_interval * w * ((((5.0 * a * u + 4.0 * b) * u + 3.0 * c) * u + 2.0 * d) * u + e)
        solid_harmonics(near[0, k], near[1, k], near[2, k], lmax, room, harmonic)
        for r in range(nmax):
            for l in range(lines):
                a = room[q + r * lines + l]
                for p in range(l * l, (l + 1) * (l + 1)):
                    room[r * nlm + p] += a * room[harmonic + p]
    for g in range(groups):
        a, b = nlm * pairs[g, 0], nlm * pairs[g, 1]
        for l in range(lines):
            x = 0.0
            for p in range(l * l, (l + 1) * (l + 1)):
                x += strengths[p] * room[a + p] * room[b + p]
            room[component + g * lines + l] = x
    if width > 0:
        energy = network(nets[ti], layers, room, component, weight, ncoeff, nodes, nodes + width, constants[3])
    else:
        energy = polynomial(beta[ti], room, component, weight, ncoeff, quadratic)
    for g in range(groups):
        a, b = nlm * pairs[g, 0], nlm * pairs[g, 1]
        for l in range(lines):
            x = room[weight + g * lines + l]
            for p in range(l * l, (l + 1) * (l + 1)):
                room[slopes + a + p] += x * strengths[p] * room[b + p]
                room[slopes + b + p] += x * strengths[p] * room[a + p]
    if PER_ATOM:
        shares[0][shares[2]] += energy
    for k in range(n):
        x, y, z = near[0, k], near[1, k], near[2, k]
        q = own + 2 * nq * k
        solid_harmonics(x, y, z, lmax, room, harmonic)
        for p in range(2 * nlm):
            room[along + p] = 0.0
        for r in range(nmax):
            for l in range(lines):
                a, b = room[q + r * lines + l], room[q + nq + r * lines + l]
                for p in range(l * l, (l + 1) * (l + 1)):
                    c = room[slopes + r * nlm + p]
                    room[along + p] += a * c
                    room[along + nlm + p] += b * c
        outward, gx, gy, gz = 0.0, 0.0, 0.0, 0.0
        for p in range(nlm):
            outward += room[along + nlm + p] * room[harmonic + p]
        for l in range(1, lines):
            for o in range(-l, l + 1):
                a = room[along + l * (l + 1) + o]
                dx, dy, dz = harmonic_slope(room, harmonic, l, o)
                gx += a * dx
                gy += a * dy
                gz += a * dz
        gx += outward * x
        gy += outward * y
        gz += outward * z
        grad[0, k] += gx
        grad[1, k] += gy
        grad[2, k] += gz
        if PER_ATOM:
            share_pair(shares, k, 0.0, gx, gy, gz)
    return energy


HELPERS = (solid_harmonics, harmonic_slope, polynomial, network)
