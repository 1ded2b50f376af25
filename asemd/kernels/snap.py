"""Energy and gradient of a site of the spectral neighbour analysis potential; tables are those of `asemd.bispectrum`.

``room`` is one row of work space: coefficients of each element's density (real and imaginary parts of all), the derivatives of the energy
by them (the same), those of one neighbour, the sums Z of each pair of elements, components, their weights, the means of those, nodes of a
neural network and derivatives by them, and the coefficients of each neighbour. Of the coefficients of a neighbour only those with 2b <= j
are computed; the others mirror them.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.kernels.manybody import PER_ATOM, share_pair


def wigner(ar, ai, br, bi, twojmax, first, roots, room, u, v):
    """Coefficients of one neighbour, from place `u` (real) and `v` (imaginary) on."""
    room[u] = 1.0
    room[v] = 0.0
    for j in range(1, twojmax + 1):
        for b in range(j // 2 + 1):
            at = first[j] + b * (j + 1)
            room[u + at] = 0.0
            room[v + at] = 0.0
            mirrored = 2 * b == j
            below = first[j - 1] + (j - 1 - b if mirrored else b) * j
            for a in range(j):
                k = below + (j - 1 - a if mirrored else a)
                sign = -1.0 if mirrored and (a + b) % 2 == 1 else 1.0
                x = sign * room[u + k]
                y = (-sign if mirrored else sign) * room[v + k]
                p = roots[j - a, j - b]
                q = roots[a + 1, j - b]
                room[u + at + a] += p * (ar * x + ai * y)
                room[v + at + a] += p * (ar * y - ai * x)
                room[u + at + a + 1] = -q * (br * x + bi * y)
                room[v + at + a + 1] = -q * (br * y - bi * x)


def wigner_back(ar, ai, br, bi, twojmax, first, roots, room, u, v, du, dv):
    """Derivatives by ar, ai, br, bi from those by the coefficients of a neighbour, which are in `du` and `dv` and are overwritten."""
    dar, dai, dbr, dbi = 0.0, 0.0, 0.0, 0.0
    for j in range(twojmax, 0, -1):
        for b in range(j // 2 + 1):
            at = first[j] + b * (j + 1)
            mirrored = 2 * b == j
            below = first[j - 1] + (j - 1 - b if mirrored else b) * j
            for a in range(j):
                k = below + (j - 1 - a if mirrored else a)
                sign = -1.0 if mirrored and (a + b) % 2 == 1 else 1.0
                turned = -sign if mirrored else sign
                x = sign * room[u + k]
                y = turned * room[v + k]
                p = roots[j - a, j - b]
                q = roots[a + 1, j - b]
                gx = p * room[du + at + a]
                gy = p * room[dv + at + a]
                hx = q * room[du + at + a + 1]
                hy = q * room[dv + at + a + 1]
                dar += gx * x + gy * y
                dai += gx * y - gy * x
                dbr -= hx * x + hy * y
                dbi -= hx * y - hy * x
                room[du + k] += sign * (gx * ar - gy * ai - hx * br + hy * bi)
                room[dv + k] += turned * (gx * ai + gy * ar - hx * bi - hy * br)
    return dar, dai, dbr, dbi


def rotation(x, y, z, r, angle, slope):
    """The rotation that stands for a neighbour: Cayley-Klein numbers, and their common factor and z0 with derivatives by the distance."""
    z0 = r / math.tan(angle)
    dz0 = z0 / r - slope * (r * r + z0 * z0) / r
    w = 1.0 / math.sqrt(r * r + z0 * z0)
    return w * z0, -w * z, w * y, -w * x, w, -w * w * w * (r + z0 * dz0), z0, dz0


def taper(r, cut, rmin, switched, inner, width):
    """Weight of a neighbour by its distance, and the derivative; with a `width` it also goes to zero at short distances."""
    f, d = 1.0, 0.0
    if switched == 1.0 and r > rmin:
        w = math.pi / (cut - rmin)
        f, d = 0.5 * (math.cos((r - rmin) * w) + 1.0), -0.5 * math.sin((r - rmin) * w) * w
    if width > 0.0 and r < inner + width:
        if r <= inner - width:
            return 0.0, 0.0
        w = 0.5 * math.pi / width
        a = 0.5 * math.pi + (r - inner) * w
        s, ds = 0.5 * (1.0 - math.cos(a)), 0.5 * w * math.sin(a)
        return f * s, d * s + f * ds
    return f, d


def block_of(place, e1, e2, e3, elements):
    """Which triple of elements a derivative belongs to: those of the two factors, and that of the coefficient."""
    if place == 0:
        return (e1 * elements + e2) * elements + e3
    return (e3 * elements + e2) * elements + e1 if place == 1 else (e2 * elements + e3) * elements + e1


def polynomial(beta, room, b, w, n, quadratic):
    """Energy linear or quadratic in the n components at place `b`; its derivatives come to `w`."""
    energy = beta[0]
    for p in range(n):
        energy += beta[1 + p] * room[b + p]
        room[w + p] = beta[1 + p]
    if quadratic == 1.0:
        at = 1 + n
        for p in range(n):
            x = room[b + p]
            energy += 0.5 * beta[at] * x * x
            room[w + p] += beta[at] * x
            at += 1
            for q in range(p + 1, n):
                y = room[b + q]
                energy += beta[at] * x * y
                room[w + p] += beta[at] * y
                room[w + q] += beta[at] * x
                at += 1
    return energy


def network(net, layers, room, b, w, n, nodes, slopes, unit):
    """Energy by a neural network of the n components at place `b`; its derivatives come to `w`. `net`: what is subtracted from the
    components and what they are divided by, then of each node its bias and weights; `layers (m, 2)`: activation (linear, sigmoid, tanh,
    relu) and nodes; `nodes` and `slopes` are places for values of nodes and derivatives by them."""
    at, before, inputs = 2 * n, 0, n
    for layer in range(layers.shape[0]):
        start = before + (layers[layer - 1, 1] if layer > 0 else 0)
        for k in range(layers[layer, 1]):
            x = net[at]
            for p in range(inputs):
                x += net[at + 1 + p] * (room[nodes + before + p] if layer > 0 else (room[b + p] - net[p]) / net[n + p])
            at += inputs + 1
            kind = layers[layer, 0]
            if kind == 1:
                x = 1.0 / (1.0 + math.exp(-x))
            elif kind == 2:
                x = math.tanh(x)
            elif kind == 3:
                x = max(x, 0.0)
            room[nodes + start + k] = x
            room[slopes + start + k] = 0.0
        before, inputs = start, layers[layer, 1]
    last = before + layers[layers.shape[0] - 1, 1] - 1
    room[slopes + last] = unit
    for p in range(n):
        room[w + p] = 0.0
    start = before
    for back in range(layers.shape[0]):
        layer = layers.shape[0] - 1 - back
        inputs = layers[layer - 1, 1] if layer > 0 else n
        at -= layers[layer, 1] * (inputs + 1)
        before = start - (inputs if layer > 0 else 0)
        for k in range(layers[layer, 1]):
            x = room[nodes + start + k]
            d = room[slopes + start + k]
            kind = layers[layer, 0]
            if kind == 1:
                d *= x * (1.0 - x)
            elif kind == 2:
                d *= 1.0 - x * x
            elif kind == 3 and x <= 0.0:
                d = 0.0
            for p in range(inputs):
                c = net[at + k * (inputs + 1) + 1 + p]
                if layer > 0:
                    room[slopes + before + p] += d * c
                else:
                    room[w + p] += d * c / net[n + p]
        start = before
    return unit * room[nodes + last]


def snap(i, ti, n, m, near, types, room, grad, constants, arrays, shares):
    by_type, beta, equal, zero, first, weights, z, factors, products, strengths, roots, nets, layers = arrays
    twojmax, elements = int(constants[0]), int(constants[1])
    rcutfac, rfac, rmin, switched, all_self, quadratic = constants[2], constants[3], constants[4], constants[5], constants[6], constants[7]
    nu, nz, ncoeff = first[twojmax + 1], factors.shape[0], zero.shape[0]
    total = 0
    slopes = 2 * nu * elements
    du = 2 * slopes
    dv = du + nu
    zs = dv + nu
    component = zs + 2 * nz * elements * elements
    weight = component + ncoeff
    mean = weight + ncoeff
    nodes = mean + ncoeff
    width = 0
    for k in range(layers.shape[0]):
        width += layers[k, 1]
    own = nodes + 2 * width
    for k in range(du):
        room[k] = 0.0
    for e in range(elements):
        if all_self == 1.0 or e == by_type[ti, 0]:
            for j in range(twojmax + 1):
                for a in range(j // 2 + 1):
                    room[total + 2 * nu * e + first[j] + a * (j + 2)] = 1.0
    for k in range(n):
        t = types[k]
        r = math.sqrt(near[3, k])
        cut = (by_type[ti, 1] + by_type[t, 1]) * rcutfac
        slope = rfac * math.pi / (cut - rmin)
        ar, ai, br, bi, w, dw, z0, dz0 = rotation(near[0, k], near[1, k], near[2, k], r, (r - rmin) * slope, slope)
        u = own + 2 * nu * k
        wigner(ar, ai, br, bi, twojmax, first, roots, room, u, u + nu)
        f, df = taper(r, cut, rmin, switched, 0.5 * (by_type[ti, 3] + by_type[t, 3]), 0.5 * (by_type[ti, 4] + by_type[t, 4]))
        f *= by_type[t, 2]
        to = total + 2 * nu * int(by_type[t, 0])
        for p in range(2 * nu):
            room[to + p] += f * room[u + p]
    for e in range(elements):
        u = total + 2 * nu * e
        for j in range(1, twojmax + 1):
            for b in range(j // 2 + 1):
                for a in range(j + 1):
                    if 2 * b == j and a >= b:
                        continue
                    sign = -1.0 if (a + b) % 2 == 1 else 1.0
                    p = first[j] + b * (j + 1) + a
                    q = first[j] + (j - b) * (j + 1) + j - a
                    room[u + q] = sign * room[u + p]
                    room[u + nu + q] = -sign * room[u + nu + p]
    for p in range(ncoeff):
        room[component + p] = 0.0
    nb = ncoeff // (elements * elements * elements)
    for e1 in range(elements):
        for e2 in range(elements):
            u1, u2, to = total + 2 * nu * e1, total + 2 * nu * e2, zs + 2 * nz * (e1 * elements + e2)
            for k in range(nz):
                x, y = 0.0, 0.0
                for p in range(z[k, 3], z[k + 1, 3]):
                    c = strengths[p]
                    a = np.int64(products[p, 0])
                    b = np.int64(products[p, 1])
                    x += c * (room[u1 + a] * room[u2 + b] - room[u1 + nu + a] * room[u2 + nu + b])
                    y += c * (room[u1 + a] * room[u2 + nu + b] + room[u1 + nu + a] * room[u2 + b])
                room[to + 2 * k] = x
                room[to + 2 * k + 1] = y
                if z[k, 2] == 0:
                    s = weights[z[k, 0]]
                    for e3 in range(elements):
                        u3 = total + 2 * nu * e3 + z[k, 0]
                        room[component + ((e1 * elements + e2) * elements + e3) * nb + z[k, 1]] += s * (room[u3] * x + room[u3 + nu] * y)
    for p in range(ncoeff):
        if all_self == 1.0 or p // nb == int(by_type[ti, 0]) * (elements * elements + elements + 1):
            room[component + p] -= zero[p]
    if width > 0:
        energy = network(nets[ti], layers, room, component, weight, ncoeff, nodes, nodes + width, constants[8])
    else:
        energy = polynomial(beta[ti], room, component, weight, ncoeff, quadratic)
    same = equal.shape[1]
    for p in range(ncoeff):
        x = 0.0
        for k in range(same):
            x += room[weight + equal[p, k]]
        room[mean + p] = x / same
    for e1 in range(elements):
        for e2 in range(elements):
            to = zs + 2 * nz * (e1 * elements + e2)
            for k in range(nz):
                s = factors[k] * weights[z[k, 0]]
                for e3 in range(elements):
                    c = s * room[mean + block_of(z[k, 2], e1, e2, e3, elements) * nb + z[k, 1]]
                    u = slopes + 2 * nu * e3 + z[k, 0]
                    room[u] += c * room[to + 2 * k]
                    room[u + nu] += c * room[to + 2 * k + 1]
    if PER_ATOM:
        shares[0][shares[2]] += energy
    for k in range(n):
        t = types[k]
        r = math.sqrt(near[3, k])
        cut = (by_type[ti, 1] + by_type[t, 1]) * rcutfac
        slope = rfac * math.pi / (cut - rmin)
        dx, dy, dz = near[0, k], near[1, k], near[2, k]
        ar, ai, br, bi, w, dw, z0, dz0 = rotation(dx, dy, dz, r, (r - rmin) * slope, slope)
        f, df = taper(r, cut, rmin, switched, 0.5 * (by_type[ti, 3] + by_type[t, 3]), 0.5 * (by_type[ti, 4] + by_type[t, 4]))
        f *= by_type[t, 2]
        df *= by_type[t, 2]
        u, y = own + 2 * nu * k, slopes + 2 * nu * int(by_type[t, 0])
        s = 0.0
        for p in range(2 * nu):
            s += room[y + p] * room[u + p]
            room[du + p] = f * room[y + p]
        dar, dai, dbr, dbi = wigner_back(ar, ai, br, bi, twojmax, first, roots, room, u, u + nu, du, dv)
        along = (df * s + dar * (dw * z0 + w * dz0) - dai * dw * dz + dbr * dw * dy - dbi * dw * dx) / r
        gx = along * dx - w * dbi
        gy = along * dy + w * dbr
        gz = along * dz - w * dai
        grad[0, k] += gx
        grad[1, k] += gy
        grad[2, k] += gz
        if PER_ATOM:
            share_pair(shares, k, 0.0, gx, gy, gz)
    return energy


HELPERS = (wigner, wigner_back, rotation, taper, block_of, polynomial, network)
