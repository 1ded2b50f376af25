r"""Reference structures of the modified embedded-atom method, and the pair potential that follows from them.

The energy of a reference structure as a function of its nearest distance is Rose's; with the embedding energies of its atoms that gives
$\phi$, for the structure's first neighbours [1]_ and, where second neighbours interact, as a series over them [2]_.

.. [1] Baskes, Phys. Rev. B 46, 2727 (1992); Huang, Ghoniem, Wong and Baskes, Modelling Simul. Mater. Sci. Eng. 3, 615 (1995)
.. [2] Lee and Baskes, Phys. Rev. B 62, 8564 (2000)
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError
from asemd.meam_file import NEIGHBORS, Parameters

POINTS = 1000       # of the table of phi, which reaches a tenth beyond the cutoff
# lattice -> number of second neighbours, their distance by that of the first, how many first neighbours screen them
SECOND = {"fcc": (6, math.sqrt(2.0), 4), "bcc": (6, 2.0 / math.sqrt(3.0), 4), "hcp": (6, math.sqrt(2.0), 4), "sc": (12, math.sqrt(2.0), 2),
          "b1": (12, math.sqrt(2.0), 2), "dia": (12, math.sqrt(8.0 / 3.0), 1), "dia3": (12, math.sqrt(11.0 / 3.0), 4),
          "l12": (6, math.sqrt(2.0), 4), "b2": (6, 2.0 / math.sqrt(3.0), 4)}
ZBL = ((0.028171, 0.20162), (0.28022, 0.40290), (0.50986, 0.94229), (0.18175, 3.1998))
EV_ANGSTROM = 14.3997


def smooth(x):
    """The cutoff function of densities and screening: 0 up to x = 0, 1 from 1 on."""
    x = np.clip(x, 0.0, 1.0)
    return (1.0 - (1.0 - x) ** 4) ** 2


def correction(gamma, ibar: float, factor: float):
    """G(gamma)."""
    if ibar == 1.0:
        return np.exp(0.5 * gamma)
    if ibar == 3.0:
        return 2.0 / (1.0 + np.exp(-gamma))
    if ibar == -5.0:
        return np.sign(1.0 + gamma) * np.sqrt(np.abs(1.0 + gamma))
    point = -factor / (factor + 1.0)
    low = gamma < point
    below = np.sqrt((point / np.where(low, gamma, point)) ** factor / (factor + 1.0))
    return np.where(low, below, np.sqrt(np.where(low, 0.0, 1.0 + gamma)))


def zbl(r, z1: float, z2: float):
    """The universal repulsion of nuclei; at r = 0 without its pole, as in LAMMPS."""
    a = 0.4685 / (z1**0.23 + z2**0.23)
    screened = sum(c * np.exp(-d * r / a) for c, d in ZBL)
    at_zero = r == 0.0
    return np.where(at_zero, screened, screened * z1 * z2 * EV_ANGSTROM / np.where(at_zero, 1.0, r))


class Reference:
    """Energies of the reference structures of a set of elements; `second` for meam/ms."""

    def __init__(self, p: Parameters, second: bool):
        self.p, self.second = p, second
        self.rho_ref = np.array([self._reference_density(a) for a in range(len(p.elements))])

    def shape(self, lattice: str, a: int, b: int) -> np.ndarray:
        """Sums of the squared densities of order 1 to 3 over the neighbours in a lattice."""
        half = math.radians(self.p.theta[a, b]) / 2.0
        s, c = math.sin(half), math.cos(half)
        if lattice == "hcp":
            return np.array([0.0, 0.0, 1.0 / 3.0])
        if lattice in ("dia", "dia3", "ch4"):
            return np.array([0.0, 0.0, 32.0 / 9.0])
        if lattice == "dim":
            return np.array([1.0, 2.0 / 3.0, 0.4])
        if lattice == "lin":
            return np.array([0.0, 8.0 / 3.0, 0.0])
        if lattice in ("zig", "tri"):
            first = 4.0 * c**2
            return np.array([first, 4.0 * (c**4 + s**4 - 1.0 / 3.0), 4.0 * c**2 * (3.0 * s**4 + c**4) - 0.6 * first])
        return np.zeros(3)

    def seconds(self, lattice: str, low: float, high: float, theta: float) -> tuple[int, float, float]:
        """Second neighbours in a lattice: how many, at which distance, and how much of them is left by the first ones."""
        if lattice in SECOND:
            count, ratio, screens = SECOND[lattice]
            if lattice in ("dia", "dia3") and low < 0.500001:
                raise InputError("second neighbours in a diamond lattice need a Cmin above 0.5")
        else:
            ratio = 2.0 * math.sin(math.radians(theta) / 2.0)
            count, screens = {"zig": (2, 1), "tri": (1, 2)}.get(lattice, (0, 0))
        if not count:
            return 0, 1.0, 0.0
        c = 1.0 if lattice == "dia3" else 4.0 / ratio**2 - 1.0
        return count, ratio, float(smooth((c - low) / (high - low))) ** screens

    def seconds_of(self, a: int, b: int, like: int, other: int) -> tuple[int, float, float]:
        """Those of the structure of a and b that are atoms `like` with an atom `other` between them."""
        p = self.p
        return self.seconds(p.lattce[a, b], p.Cmin[like, like, other], p.Cmax[like, like, other], p.theta[a, b])

    def screened(self, i: int, j: int, k: int) -> float:
        """Screening of i and j by k where the three are a right angle."""
        low, high = self.p.Cmin[i, j, k], self.p.Cmax[i, j, k]
        return float(smooth((1.0 - low) / (high - low)))

    def _reference_density(self, a: int) -> float:
        p = self.p
        z, g = NEIGHBORS[p.lattce[a, a]], 1.0
        if p.ibar[a] > 0:
            gamma = (p.t[a] * self.shape(p.lattce[a, a], a, a)).sum() / z**2
            g = float(correction(gamma, p.ibar[a], p.gsmooth_factor))
        rho = p.rho0[a] * z
        if p.nn2[a, a] == 1:
            count, ratio, left = self.seconds_of(a, a, a, a)
            rho += count * p.rho0[a] * math.exp(-p.beta[a, 0] * (ratio - 1.0)) * left
        return rho * g

    def decays(self, r, a: int, minus: bool = False) -> list[np.ndarray]:
        """Densities of order 0 to 3 that an atom makes at a distance; of meam/ms times t, and with `minus` those of the second set."""
        p = self.p
        betas = [p.beta[a, 0], *(p.beta_m[a] if minus else p.beta[a, 1:])]
        weights = [1.0, *((p.t_m[a] if minus else p.t[a]) if self.second else np.ones(3))]
        return [w * p.rho0[a] * np.exp(-b * (r / p.re[a, a] - 1.0)) for w, b in zip(weights, betas)]

    def densities(self, r, a: int, b: int, minus: bool = False):
        """Densities at an atom a and at an atom b of their structure: order 0 and squares of 1 to 3, (4, m) each."""
        p, lattice = self.p, self.p.lattce[a, b]
        of_a, of_b = self.decays(r, a, minus), self.decays(r, b, minus)
        z, none = NEIGHBORS[lattice], np.zeros_like(r)
        at_a, at_b = [z * of_b[0], none, none, none], [z * of_a[0], none, none, none]
        if minus and lattice in ("ch4", "lin", "zig", "tri"):      # as LAMMPS has it
            return at_a, at_b
        if lattice in ("hcp", "dia", "dia3", "dim", "lin", "zig"):
            shape = self.shape(lattice, a, b)
            at_a[1:], at_b[1:] = ([s * d * d for s, d in zip(shape, of[1:])] for of in (of_b, of_a))
        elif lattice == "tri":
            at_a[0] = of_b[0]
            at_b[1:] = [s * d * d for s, d in zip(self.shape("tri", a, b), of_a[1:])]
            at_a[1:] = [s * d * d for s, d in zip((1.0, 2.0 / 3.0, 0.4), of_b[1:])]
        elif lattice == "ch4":      # a is the atom in the middle
            at_b[0] = of_a[0]
            at_b[1:] = [s * d * d for s, d in zip(self.shape("dim", a, b), of_a[1:])]
            at_a[1:] = [s * d * d for s, d in zip(self.shape("ch4", a, b), of_b[1:])]
        elif lattice == "c11":
            at_a, at_b = of_a, of_b
        elif lattice == "l12":
            at_a[0], at_b[0] = 8.0 * of_a[0] + 4.0 * of_b[0], 12.0 * of_a[0]
            if p.ialloy == 1 and not self.second:
                ta, tb = p.t[a, 1], p.t[b, 1]
                total = 8.0 * of_a[0] * ta**2 + 4.0 * of_b[0] * tb**2
                square = 8.0 / 3.0 * (of_a[2] * ta - of_b[2] * tb) ** 2
                at_a[2] = np.where(total > 0.0, square / np.where(total > 0.0, total, 1.0) * at_a[0], square)
            else:
                at_a[2] = 8.0 / 3.0 * (of_a[2] - of_b[2]) ** 2
        if p.nn2[a, b] == 1:
            count, ratio, left = self.seconds_of(a, b, a, b)
            far_a, far_b = self.decays(ratio * r, a)[0], self.decays(ratio * r, b)[0]
            if lattice == "l12":
                at_a[0] = at_a[0] + 6.0 * self.screened(a, a, a) ** 2 * self.screened(a, a, b) ** 2 * far_a
                at_b[0] = at_b[0] + 6.0 * self.screened(b, b, a) ** 4 * far_b
            else:
                at_a[0] = at_a[0] + count * left * far_a
                count, _, left = self.seconds_of(a, b, b, a)
                at_b[0] = at_b[0] + count * left * far_b
        return at_a, at_b

    def means(self, r, a: int, b: int, at_a, at_b):
        """Averages of t1 to t3 at a and at b in their structure."""
        p, lattice = self.p, self.p.lattce[a, b]
        if p.ialloy == 2:
            return p.t[a], p.t[b]
        if lattice == "c11":
            mean = [(ta * at_a[0] + tb * at_b[0]) / (at_a[0] + at_b[0]) for ta, tb in zip(p.t[a], p.t[b])]
            return mean, mean
        if lattice == "l12":
            of_a, of_b = self.decays(r, a)[0], self.decays(r, b)[0]
            total = 8.0 * of_a + 4.0 * of_b
            return [(8.0 * ta * of_a + 4.0 * tb * of_b) / total for ta, tb in zip(p.t[a], p.t[b])], p.t[a]
        return p.t[b], p.t[a]

    def reduced(self, a: int, at, t, less):
        """Density of an atom by its background; `less`: of meam/ms what the second set takes off."""
        p = self.p
        z, shape = NEIGHBORS[p.lattce[a, a]], self.shape(p.lattce[a, a], a, a)
        if p.mixture_ref_t == 1:
            gamma = sum(s * mean for s, mean in zip(shape, t)) / z**2
            background = p.rho0[a] * z * (correction(gamma, p.ibar[a], p.gsmooth_factor) if p.ibar[a] > 0 else 1.0)
        else:
            background = p.rho0[a] * z if p.bkgd_dyn == 1 else self.rho_ref[a]
        some = at[0] >= 1e-14
        total = sum(at[1:]) - sum(less[1:]) if self.second else sum(mean * d for mean, d in zip(t, at[1:]))
        gamma = np.where(some, total / np.where(some, at[0], 1.0) ** 2, 0.0)
        return at[0] / background * correction(gamma, p.ibar[a], p.gsmooth_factor)

    def layered(self, a: int, b: int, at_a, at_b, t_a, t_b):
        """Densities in c11 by their backgrounds."""
        def mixed(x, y, t):
            return np.sqrt((5.0 * (x[0] + y[0])) ** 2 + t[0] * (y[1] - x[1]) ** 2 + t[1] / 6.0 * (y[2] + x[2]) ** 2
                           + 121.0 / 40.0 * t[2] * (y[3] - x[3]) ** 2)

        def single(x, t):
            return np.sqrt((10.0 * x[0]) ** 2 + 2.0 / 3.0 * t[1] * x[2] ** 2)

        if self.p.lattce[a, a] == "dia":
            return mixed(at_a, at_b, t_a), single(at_a, t_a)
        return single(at_b, t_b), mixed(at_b, at_a, t_b)

    def embedding(self, a: int, rho):
        depth = self.p.A[a] * self.p.Ec[a, a]
        positive = rho > 0.0
        below = -depth * rho if self.p.emb_lin_neg == 1 else 0.0
        return np.where(positive, depth * rho * np.log(np.where(positive, rho, 1.0)), below)

    def rose(self, r, a: int, b: int):
        """Energy per atom of the reference structure."""
        p, form = self.p, self.p.erose_form
        x = p.alpha[a, b] * (r / p.re[a, b] - 1.0)
        a3 = np.where(x >= 0.0, p.attrac[a, b], p.repuls[a, b])
        safe = np.where(r > 0.0, r, 1.0)
        if form == 1:
            cubic = (-p.attrac[a, b] + p.repuls[a, b] / safe) * x**3
        else:
            cubic = a3 * x**3 / (1.0 if form == 2 else safe / p.re[a, b])
        return np.where(r > 0.0, -p.Ec[a, b] * (1.0 + x + cubic) * np.exp(-x), 0.0)

    def phi(self, r, a: int, b: int):
        """The pair potential for first neighbours, before the series over second ones."""
        p, lattice = self.p, self.p.lattce[a, b]
        at_a, at_b = self.densities(r, a, b)
        some = ~((at_a[0] <= 1e-14) & (at_b[0] <= 1e-14)) & (r != 0.0)
        out = np.zeros_like(r)
        if not some.any():
            return out
        if not some.all():
            out[some] = self.phi(r[some], a, b)
            return out
        t_a, t_b = self.means(r, a, b, at_a, at_b)
        if lattice == "c11":
            rho_a, rho_b = self.layered(a, b, at_a, at_b, t_a, t_b)
        else:
            less_a, less_b = self.densities(r, a, b, True) if self.second else (None, None)
            rho_a, rho_b = self.reduced(a, at_a, t_a, less_a), self.reduced(b, at_b, t_b, less_b)
        f_a, f_b, e, z = self.embedding(a, rho_a), self.embedding(b, rho_b), self.rose(r, a, b), NEIGHBORS[lattice]
        if lattice == "c11":
            if p.lattce[a, a] == "dia":
                return (3.0 * e - f_b - 2.0 * f_a - 5.0 * self.phi(r, a, a)) / z
            return (3.0 * e - f_a - 2.0 * f_b - 5.0 * self.phi(r, b, b)) / z
        if lattice == "l12":
            count, ratio, left = self.seconds(p.lattce[a, a], p.Cmin[a, a, a], p.Cmax[a, a, a], p.theta[a, b])
            like = self.phi(r, a, a) + self.series(r, a, a, count, ratio, left)
            return e / 3.0 - f_a / 4.0 - f_b / 12.0 - like
        if lattice == "ch4":
            return (5.0 * e - f_a - 4.0 * f_b) / 4.0
        if lattice == "tri":
            out = (3.0 * e - 2.0 * f_a - f_b) / z
        else:
            out = (2.0 * e - f_a - f_b) / z
        if lattice in ("tri", "zig") and a != b:
            far = 2.0 * math.sin(math.radians(p.theta[a, b]) / 2.0) * r
            out = out - self.screened(a, a, b) * self.phi(far, a, a) / z
            if lattice == "zig":
                out = out - self.screened(b, b, a) * self.phi(far, b, b) / z
        return out

    def series(self, r, a: int, b: int, count: int, ratio: float, left: float):
        """What second neighbours add to phi: a series over chains of them."""
        out = np.zeros_like(r)
        if left > 0.0:
            weight = -count * left / NEIGHBORS[self.p.lattce[a, b]]
            going = np.ones(r.shape, bool)
            for n in range(1, 11):
                term = weight**n * self.phi(r * ratio**n, a, b)
                going &= (np.abs(term) >= 1e-20) & np.isfinite(term)
                out += np.where(going, term, 0.0)
        return out

    def like(self, r, a: int):
        """Phi of an element with its second neighbours."""
        return self.phi(r, a, a) + self.series(r, a, a, *self.seconds_of(a, a, a, a))

    def table(self, a: int, b: int) -> tuple[np.ndarray, float]:
        """Values of phi, and their distance."""
        p, step = self.p, 1.1 * self.p.rc / POINTS
        r = np.arange(POINTS) * step
        lattice, out = p.lattce[a, b], self.phi(r, a, b)
        if p.nn2[a, b] == 1:
            count, ratio, left = self.seconds_of(a, b, a, b)
            if lattice in ("b1", "b2", "dia"):
                z, far = NEIGHBORS[lattice], r * ratio
                back, _, left_b = self.seconds_of(a, b, b, a)
                out = out - count * left / (2.0 * z) * self.like(far, a) - back * left_b / (2.0 * z) * self.like(far, b)
            elif lattice == "l12":
                far = r * ratio
                out = out - 0.75 * self.screened(a, a, a) ** 2 * self.screened(a, a, b) ** 2 * self.like(far, a) \
                    - 0.25 * self.screened(b, b, a) ** 4 * self.like(far, b)
            else:
                out = out + self.series(r, a, b, count, ratio, left)
        if p.zbl[a, b] == 1:
            x = p.alpha[a, b] * (r / p.re[a, b] - 1.0)
            share = smooth(1.0 - (x + 1.0) / (-3.0 + 1.0))
            close = zbl(r, p.number[a], p.number[b])
            out = np.where(x <= -3.0, close, np.where(x < -1.0, share * out + (1.0 - share) * close, out))
        return out, step
