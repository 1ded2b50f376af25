r"""Lennard-Jones of a fine-grained model (epsilonf, sigmaf) at short distances and of a coarse-grained one (epsilonc, sigmac) beyond.

$$\phi_x = 4\epsilon_x \left[ (\sigma_x/r)^{12} - (\sigma_x/r)^6 \right]$$

The force is that of phi_f below rsi and of phi_c between rso and rci; between rsi and rso it goes over from one to the other, between
rci and rco to zero, as a cubic polynomial in r. The derivatives of the forces are continuous too, but for that at rso, which comes with
the opposite sign, as in LAMMPS. The energy is that of phi_c between rso and rci, and continuous up to rco.
Chaimovich, Peter and Kremer, J. Chem. Phys. 143, 243107 (2015).
"""
from __future__ import annotations

import math

from asemd.errors import InputError
from asemd.pairstyle import PairStyle, mix_distance, pair

ENDS = ("rsi", "rso", "rci", "rco")


def force(epsilon, sigma, r):
    """Force and its derivative."""
    s6 = (sigma / r) ** 6
    return 24.0 * epsilon * s6 * (2.0 * s6 - 1.0) / r, -24.0 * epsilon * s6 * (26.0 * s6 - 7.0) / (r * r)


def energy(epsilon, sigma, r):
    s6 = (sigma / r) ** 6
    return 4.0 * epsilon * s6 * (s6 - 1.0)


def cubic(f0, g0, f1, g1, w):
    """Coefficients of the cubic polynomial in u, from 0 (where force and derivative by r are f1, g1) to w (where they are f0, g0)."""
    if w == 0.0:
        return 0.0, 0.0, 0.0, 0.0
    rise = (f0 - f1) / w
    return f1, -g1, (3.0 * rise + 2.0 * g1 + g0) / w, -(g0 + g1 + 2.0 * rise) / (w * w)


def area(coefficients, w):
    """Integral of the polynomial from 0 to w."""
    return sum(x * w ** (k + 1) / (k + 1) for k, x in enumerate(coefficients))


def derived(c, settings):
    """Polynomials of both transitions, the energies at their ends, and what is added to the energy of the fine model."""
    rsi, rso, rci, rco = (c[n] for n in ENDS)
    fine, coarse = (c["epsilonf"], c["sigmaf"]), (c["epsilonc"], c["sigmac"])
    f1, g1 = force(*coarse, rso)
    inner = cubic(*force(*fine, rsi), f1, -g1, rso - rsi)
    outer = cubic(*force(*coarse, rci), 0.0, 0.0, rco - rci)
    out = {"middle": energy(*coarse, rso), "end": energy(*coarse, rci) - area(outer, rco - rci)}
    out["lift"] = out["middle"] + area(inner, rso - rsi) - energy(*fine, rsi)
    return out | {f"s{k}": x for k, x in enumerate(inner)} | {f"c{k}": x for k, x in enumerate(outer)}


class RelResPair(PairStyle):
    """Checks the order of the four distances."""

    def parse_settings(self, words):
        return self.ordered(super().parse_settings(words), "pair_style")

    def parse_coeff(self, words, settings):
        if 4 < len(words) < 8:
            raise InputError(f"pair_coeff {self.name}: rsi rso rci rco come together, got {len(words) - 4} of them")
        return self.ordered(super().parse_coeff(words, settings), "pair_coeff")

    def ordered(self, values, command):
        ends = [values[n] for n in ENDS if n in values]
        if ends and not 0.0 < ends[0] <= ends[1] <= ends[2] <= ends[3]:
            raise InputError(f"{command} {self.name}: rsi rso rci rco must be more than 0 and not decrease, got {' '.join(map(str, ends))}")
        return values

    def reset_cutoffs(self, coeffs):
        return {pair_: {n: v for n, v in values.items() if n not in ENDS} for pair_, values in coeffs.items()}

    def mixed(self, a, b, rule):
        return super().mixed(a, b, rule) | {n: mix_distance(rule, a[n], b[n]) for n in ENDS}


def lj_relres_d2(r2, epsilonf, sigmaf, epsilonc, sigmac, rsi, rso, rci, rco, middle, end, lift, s0, s1, s2, s3, c0, c1, c2, c3):
    r = math.sqrt(r2)
    fine = r < rso
    if r >= (rsi if fine else rci):
        u = rso - r if fine else rco - r
        a, b, c, k = (s0, s1, s2, s3) if fine else (c0, c1, c2, c3)
        return 0.25 * (b + u * (2.0 * c + u * 3.0 * k) + (a + u * (b + u * (c + u * k))) / r) / r2
    epsilon, sigma = (epsilonf, sigmaf) if fine else (epsilonc, sigmac)
    u6 = (sigma * sigma / r2) ** 3
    return 24.0 * epsilon * u6 * (7.0 * u6 - 2.0) / (r2 * r2)


@pair("lj/relres", settings="rsi rso rci rco", coeff="epsilonf sigmaf epsilonc sigmac [rsi] [rso] [rci] [rco]", cut="rco", cls=RelResPair,
      derived=derived, rows="middle end lift s0 s1 s2 s3 c0 c1 c2 c3", units=dict.fromkeys(ENDS, "distance"),
      mix={"epsilonf": "sigmaf", "sigmaf": "distance", "epsilonc": "sigmac", "sigmac": "distance"}, settings_example="1.3 1.6 2.2 2.5",
      example="1.0 1.1 0.3 1.2 1.2 1.5 2.1 2.4", see="LAMMPS manual, pair_style lj/relres", d2=lj_relres_d2)
def lj_relres(r2, epsilonf: "energy", sigmaf: "distance", epsilonc: "energy", sigmac: "distance", rsi: "distance", rso: "distance",
              rci: "distance", rco: "distance", middle, end, lift, s0, s1, s2, s3, c0, c1, c2, c3):
    r2inv = 1.0 / r2
    r = math.sqrt(r2)
    fine = r < rso
    epsilon = epsilonf if fine else epsilonc
    sigma = sigmaf if fine else sigmac
    u2 = sigma * sigma * r2inv
    u6 = u2 * u2 * u2
    e = 4.0 * epsilon * u6 * (u6 - 1.0)
    d = -12.0 * epsilon * u6 * (2.0 * u6 - 1.0) * r2inv
    from_ = rsi if fine else rci
    u = rso - r if fine else rco - r
    a = s0 if fine else c0
    b = s1 if fine else c1
    c = s2 if fine else c2
    k = s3 if fine else c3
    bent = r >= from_
    far = (middle if fine else end) + u * (a + u * (0.5 * b + u * (0.33333333333333333 * c + u * 0.25 * k)))
    slope = -0.5 * (a + u * (b + u * (c + u * k))) * r * r2inv
    return (far if bent else (e + lift if fine else e)), (slope if bent else d)
