"""On which side of a plane an atom is, with twice the digits of a double: for atoms that are nearly in it."""
from __future__ import annotations


def low(p, a, b):
    """What the rounding of the product p = a b left out (Dekker, Numer. Math. 18, 224 (1971))."""
    s, t = 134217729.0 * a, 134217729.0 * b
    s, t = s - (s - a), t - (t - b)
    return ((s * t - p) + s * (b - t) + (a - s) * t) + (a - s) * (b - t)


def tail(d, a, b):
    """What the rounding of the difference d = a - b left out; 0 if d is something else (the image of a difference)."""
    p = a - d
    return (a - (d + p)) + (p - b) if a - b == d else 0.0


def volume(fx, fy, fz, gx, gy, gz, hx, hy, hz):
    """f . (g x h); 0 where it is not larger than the rounding of twice the digits."""
    total = rest = size = 0.0
    for k in range(3):
        a, p, q, s, t = (fx, gy, hz, gz, hy) if k == 0 else (fy, gz, hx, gx, hz) if k == 1 else (fz, gx, hy, gy, hx)
        u, w = p * q, s * t
        d = u - w
        e = tail(d, u, w) + (low(u, p, q) - low(w, s, t))
        v = a * d
        rest += low(v, a, d) + a * e
        more = total + v
        rest += tail(more, total, -v)
        total = more
        size += abs(a) * (abs(u) + abs(w))
    total += rest
    return total if abs(total) > 1e-30 * size else 0.0


def lost(d, x, i, j):
    """What the rounding of the vector d from atom j to atom i of positions (3, n) left out."""
    return tail(d[0], x[0, i], x[0, j]), tail(d[1], x[1, i], x[1, j]), tail(d[2], x[2, i], x[2, j])


def exact_volume(f, g, h, u, v, w):
    """(f + u) . (g + v) x (h + w) with vectors u, v, w far smaller than f, g, h."""
    whole = volume(f[0], f[1], f[2], g[0], g[1], g[2], h[0], h[1], h[2])
    p = u[0] * (g[1] * h[2] - g[2] * h[1]) + u[1] * (g[2] * h[0] - g[0] * h[2]) + u[2] * (g[0] * h[1] - g[1] * h[0])
    q = v[0] * (h[1] * f[2] - h[2] * f[1]) + v[1] * (h[2] * f[0] - h[0] * f[2]) + v[2] * (h[0] * f[1] - h[1] * f[0])
    r = w[0] * (f[1] * g[2] - f[2] * g[1]) + w[1] * (f[2] * g[0] - f[0] * g[2]) + w[2] * (f[0] * g[1] - f[1] * g[0])
    return whole + (p + q + r)


FUNCTIONS = (low, tail, volume, lost, exact_volume)
