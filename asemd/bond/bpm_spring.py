r"""$$F = \left[ -k (r - r_0) - \gamma\, \hat r \cdot (v_1 - v_2) \right] w,
\qquad w = 1 - \left( \frac{r - r_0}{r_0 \epsilon_c} \right)^8, \qquad E = \tfrac{1}{2} k (r - r_0)^2$$

Damped spring of bonded-particle models that breaks for good at the strain $\epsilon_c$; $r_0$ is the length that a bond has at its first
force. With ``normalize yes`` k is divided by $r_0$, ``smooth no`` leaves w out. The energy is the one LAMMPS reports; it is not conserved.
With ``break no`` bonds hold at any strain. No bond breaks by the first forces of a run, before a step is made.
Source: Clemmer and Robbins, Phys. Rev. Lett. 129, 078002 (2022); LAMMPS manual, bond_style bpm/spring.
"""
from __future__ import annotations

import math

import numpy as np

from asemd.errors import InputError, nearest
from asemd.style import Packed, Parameter, Style, bond
from asemd.words import whole, yes_no

DEFAULTS = {"overlay/pair": False, "smooth": True, "normalize": False, "break": True}
ATTRIBUTES = ("time", "id1", "id2", "x", "y", "z", "x/ref", "y/ref", "z/ref")


class BPMSpring(Style):
    newton_bond = False      # LAMMPS wants newton bond off where broken bonds change the exclusions

    def parse_settings(self, words):
        out, words = dict(DEFAULTS), list(words)
        while words:
            key = words.pop(0)
            if key == "store/local":
                if len(words) < 2:
                    raise InputError("bond_style bpm/spring store/local needs the ID of a fix, an interval and attributes")
                interval, names = whole(words[1], "bond_style bpm/spring store/local"), []
                id, words = words[0], words[2:]
                while words and words[0] in ATTRIBUTES:
                    names.append(words.pop(0))
                if interval < 1 or not names:
                    raise InputError("bond_style bpm/spring store/local needs an interval of 1 or more and at least one attribute of "
                                     + " ".join(ATTRIBUTES))
                out[key] = (id, interval, *names)
            elif key in DEFAULTS and words:
                out[key] = yes_no(words.pop(0), f"bond_style bpm/spring {key}")
            elif key in DEFAULTS:
                raise InputError(f"bond_style bpm/spring {key} needs yes or no")
            else:
                known = [*DEFAULTS, "store/local"]
                raise InputError(f"bond_style bpm/spring: unknown keyword {key!r}, expected one of {' '.join(known)}{nearest(key, known)}")
        if out["smooth"] and not out["break"]:
            raise InputError("bond_style bpm/spring: break no needs smooth no, since smoothed forces end at the strain of breaking")
        return out

    def format_settings(self, settings):
        out = [w for key in DEFAULTS for w in (key, "yes" if settings[key] else "no")]
        return out + (["store/local", *map(str, settings["store/local"])] if "store/local" in settings else [])

    def check_scene(self, interactions, system):
        lj, coul = tuple(interactions.special_lj), tuple(interactions.special_coul)
        settings = next(use.settings for use in interactions.uses["bond"] if use.style is self)
        if settings["overlay/pair"]:
            if lj != (1.0, 1.0, 1.0) or coul != (1.0, 1.0, 1.0):
                raise InputError("bond_style bpm/spring overlay/pair yes needs special_bonds lj/coul 1 1 1")
        elif lj != (0.0, 1.0, 1.0) or (settings["break"] and coul != (1.0, 1.0, 1.0)):
            raise InputError("bond_style bpm/spring needs special_bonds lj 0 1 1 coul 1 1 1 (or overlay/pair yes and lj/coul 1 1 1)")

    def pack(self, settings, coeffs, ntypes, units):
        out = np.zeros((6, ntypes + 1))
        for t, c in coeffs.items():
            out[:, t] = c["k"], c["ecrit"], c["gamma"], settings["smooth"], settings["normalize"], settings["break"]
        return Packed(out)


def check(coeff, settings):
    if not coeff["ecrit"] > 0.0:
        raise InputError(f"bond_coeff bpm/spring: the critical strain ecrit must be > 0, got {coeff['ecrit']:g}")


COEFF = (Parameter("k", "force/distance"), Parameter("ecrit"), Parameter("gamma", "force/velocity"))


@bond("bpm/spring", cls=BPMSpring, coeff=COEFF, settings=(Parameter("keyword", "word", True),), example="1.0 0.4 0.1", check=check,
      settings_example="overlay/pair yes smooth no normalize yes break yes", breaks="removed", remembers="bonds",
      xfail=dict.fromkeys(("slope", "gradient", "virial"), "its force is smoothed and damped, its energy is not"),
      domain="its reference length must not be 0 (its atoms were at the same place)")
def bpm_spring(r, rate, reference, k: "force/distance", ecrit, gamma: "force/velocity", smooth, normalize, breaks):
    if reference == 0.0:
        return math.inf, math.inf
    dr = r - reference
    if breaks != 0.0 and abs(dr) / reference > ecrit:
        return math.nan, math.nan
    stiffness = k / reference if normalize != 0.0 else k
    slope = stiffness * dr + gamma * rate
    if smooth != 0.0:
        s = dr / (reference * ecrit)
        s2 = s * s
        slope *= (1.0 - s) * (1.0 + s) * (1.0 + s2) * (1.0 + s2 * s2)
    return 0.5 * stiffness * dr * dr, slope
