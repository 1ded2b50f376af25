"""LAMMPS's tables of the part of 1/r that a long-range solver leaves, for an explicit ``pair_modify table N``, and of that of 1/r^6 for
``table/disp N``; with ``compat="lammps"`` those of 2^12 distances that LAMMPS takes without being asked.

Up to 2^N squared distances from ``tabinner`` on, or from less than that where both ends have the same leading bits, the bits of a number in
single precision but the leading ones being zero; lines between them, for energy, force and the bare 1/r that special pairs lose. Below
them the pair style's own function counts. Without the keyword the function is used everywhere, which is exact.
Source: Wolff and Rudd, Comput. Phys. Commun. 120, 20 (1999); LAMMPS manual, pair_modify.
"""
from __future__ import annotations

import copy
import math
from collections.abc import Callable
from functools import cache

import numpy as np

from asemd.errors import InputError
from asemd.pairstyle import PairStyle, make_part
from asemd.style import text_of

TABINNER = math.sqrt(2.0)
UNASKED = {"table": 12, "table/disp": 12}       # LAMMPS's defaults
SPLIT = {"table": {"g_ewald", "smooth0"}, "table/disp": {"g_ewald_6"}}     # what the solver splits by


class Bits:
    """The squared distances of a table from `inner` to `outer` of 2^bits entries."""

    def __init__(self, inner: float, outer: float, bits: int):
        if not inner < outer:
            raise InputError(f"pair_modify tabinner {inner:g} must be less than the Coulomb cutoff {outer:g}")
        lowest = math.frexp(inner * inner)[1] - 1
        exponent_bits = 0
        while exponent_bits <= 8 and 2.0 ** (2.0**exponent_bits) < outer * outer / 2.0**lowest:
            exponent_bits += 1
        mantissa_bits = bits - exponent_bits
        if exponent_bits > 8:
            raise InputError(f"pair_modify table: no table goes from {inner:g} to {outer:g}: choose cutoff and tabinner closer together, "
                             "or pair_modify table 0")
        if not 3 <= mantissa_bits <= 23:
            few = "few" if mantissa_bits < 3 else "many"
            raise InputError(f"pair_modify table {bits}: too {few} bits for a table from {inner:g} to {outer:g}")
        shift = 23 - mantissa_bits
        self.per_octave = float(1 << mantissa_bits)
        number, last = (int(np.float32(r * r).view(np.int32)) >> shift for r in (inner, outer))
        number += bool(np.int32(number << shift).view(np.float32) < inner * inner)
        if number >> bits == last >> bits:        # LAMMPS's entries are those of one block of numbers, from its start on
            number = number >> bits << bits
        self.r2 = ((number + np.arange(1 << bits)) << shift).astype(np.int32).view(np.float32)
        mantissa, exponent = math.frexp(float(self.r2[0]))
        self.first = (2.0 * mantissa - 1.0 + exponent) * self.per_octave


def of_dispersion(r2: np.ndarray, settings: dict, cut: float) -> np.ndarray:
    """Energy and force times distance, for a coefficient C6 of 1."""
    g2 = settings["g_ewald_6"] ** 2
    r2 = r2.astype(float)
    y = 1.0 / (g2 * r2)
    bell = g2**3 * y * np.exp(-g2 * r2)
    return np.stack([-bell * (0.5 + y * (1.0 + y)), -g2 * r2 * bell * (1.0 + y * (3.0 + y * (6.0 + y * 6.0)))])


def values(r2: np.ndarray, settings: dict, cut: float) -> np.ndarray:
    """Energy, force times distance and 1/r at squared distances in single precision, for charges whose product is 1."""
    from scipy.special import erfc
    r = np.sqrt(r2.astype(float))
    if "g_ewald" not in settings:      # of multilevel summation, nothing beyond the cutoff
        smooth, square = [settings[f"smooth{k}"] for k in range(6)], np.minimum(r, cut) ** 2
        slope = 2.0 * np.polyval([k * smooth[k] for k in range(5, 0, -1)], square)
        return np.where(r < cut, np.stack([1.0 / r - np.polyval(smooth[::-1], square), 1.0 / r + slope * square, 1.0 / r]),
                        np.stack([0.0 * r, 0.0 * r, 1.0 / r]))
    x = settings["g_ewald"] * r
    return np.stack([erfc(x) / r, (erfc(x) + 1.12837916709551 * x * np.exp(-x * x)) / r, 1.0 / r])


def nodes(bits: Bits, settings: dict, cut: float, values: Callable = values) -> np.ndarray:
    """(2^N, 8): value and rise to the next node of energy, force and 1/r; squared distance and inverse of that to the next one.

    (2^N, 6) of `values` that has no 1/r."""
    at = values(bits.r2, settings, cut)
    rise = np.append(np.diff(at, axis=1), np.zeros((len(at), 1)), axis=1)
    r2 = bits.r2.astype(float)
    inverse = np.append(1.0 / np.diff(r2), 0.0)
    end = float(np.float32(cut * cut))
    if end > r2[-1]:      # the last line ends at the cutoff
        rise[:, -1], inverse[-1] = values(np.array([end]), settings, cut)[:, 0] - at[:, -1], 1.0 / (end - r2[-1])
    return np.ascontiguousarray(np.stack([column for pair in zip(at, rise) for column in pair] + [r2, inverse], axis=1))


def special_long(r2, qq, g_ewald, start2, per_octave, first, nodes, off):
    single = np.float64(np.float32(r2))
    mantissa, exponent = math.frexp(single)
    k = min(max(int((2.0 * mantissa - 1.0 + exponent) * per_octave - first), 0), nodes.shape[0] - 1)
    b = (single - nodes[k, 6]) * nodes[k, 7]
    if r2 > start2:
        bare = off * (nodes[k, 4] + b * nodes[k, 5]) if off != 0.0 else 0.0
        return qq * (nodes[k, 0] + b * nodes[k, 1] - bare), -0.5 * qq * (nodes[k, 2] + b * nodes[k, 3] - bare) / r2
    r = math.sqrt(r2)
    x = g_ewald * r
    gauss = math.exp(-x * x)
    t = 1.0 / (1.0 + 0.3275911 * x)
    tail = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429)))) * gauss - off
    return qq / r * tail, -0.5 * qq / r * (tail + 1.12837917 * x * gauss) / r2


def coul_long_cs_table(r2, qq, g_ewald, start2, per_octave, first, nodes: "array"):
    single = np.float64(np.float32(r2))
    mantissa, exponent = math.frexp(single)
    k = min(max(int((2.0 * mantissa - 1.0 + exponent) * per_octave - first), 0), nodes.shape[0] - 1)
    b = (single - nodes[k, 6]) * nodes[k, 7]
    if r2 > start2:
        return qq * (nodes[k, 0] + b * nodes[k, 1]), -0.5 * qq * (nodes[k, 2] + b * nodes[k, 3]) / r2
    r = math.sqrt(r2 + 1e-20)
    x = g_ewald * r
    gauss = math.exp(-x * x)
    t = 1.0 / (1.0 + 0.995473818 * x)
    u = 1.0 - t
    p = -0.1335096380159268 + u * (-0.257839507 + u * (-0.137203639 + u * (-0.00888822059 + u * (-0.00580844129 + u * 0.114652755))))
    tail = t * (1.0 + p * u) * gauss
    return qq / r * tail, -0.5 * qq / r * (tail + 1.12837917 * x * gauss) / (r2 + 1e-20)


def special_cs(r2, qq, g_ewald, start2, per_octave, first, nodes, off):
    single = np.float64(np.float32(r2))
    mantissa, exponent = math.frexp(single)
    k = min(max(int((2.0 * mantissa - 1.0 + exponent) * per_octave - first), 0), nodes.shape[0] - 1)
    b = (single - nodes[k, 6]) * nodes[k, 7]
    if r2 > start2:
        bare = off * (nodes[k, 4] + b * nodes[k, 5])
        return qq * (nodes[k, 0] + b * nodes[k, 1] - bare), -0.5 * qq * (nodes[k, 2] + b * nodes[k, 3] - bare) / r2
    r = math.sqrt(r2 + 1e-20) + 1e-6
    x = g_ewald * r
    gauss = math.exp(-x * x)
    t = 1.0 / (1.0 + 0.995473818 * x)
    u = 1.0 - t
    p = -0.1335096380159268 + u * (-0.257839507 + u * (-0.137203639 + u * (-0.00888822059 + u * (-0.00580844129 + u * 0.114652755))))
    tail = t * (1.0 + p * u) * gauss - off
    return qq / r * tail, -0.5 * qq / r * (tail + 1.12837917 * x * gauss) / (r2 + 1e-12)


def special_msm(r2, qq, smooth0, smooth1, smooth2, smooth3, smooth4, smooth5, start2, per_octave, first, nodes, off):
    single = np.float64(np.float32(r2))
    mantissa, exponent = math.frexp(single)
    k = min(max(int((2.0 * mantissa - 1.0 + exponent) * per_octave - first), 0), nodes.shape[0] - 1)
    b = (single - nodes[k, 6]) * nodes[k, 7]
    if r2 > start2:
        bare = off * (nodes[k, 4] + b * nodes[k, 5]) if off != 0.0 else 0.0
        return qq * (nodes[k, 0] + b * nodes[k, 1] - bare), -0.5 * qq * (nodes[k, 2] + b * nodes[k, 3] - bare) / r2
    bare = (1.0 - off) * qq / math.sqrt(r2)
    smooth = smooth0 + r2 * (smooth1 + r2 * (smooth2 + r2 * (smooth3 + r2 * (smooth4 + r2 * smooth5))))
    slope = smooth1 + r2 * (2.0 * smooth2 + r2 * (3.0 * smooth3 + r2 * (4.0 * smooth4 + r2 * 5.0 * smooth5)))
    return bare - qq * smooth, -0.5 * bare / r2 - qq * slope


def dispersion_table(r2, C6, g_ewald_6, start2_disp, per_octave_disp, first_disp, nodes_disp: "array"):
    single = np.float64(np.float32(r2))
    mantissa, exponent = math.frexp(single)
    k = min(max(int((2.0 * mantissa - 1.0 + exponent) * per_octave_disp - first_disp), 0), nodes_disp.shape[0] - 1)
    b = (r2 - nodes_disp[k, 4]) * nodes_disp[k, 5]
    if r2 > start2_disp:
        return C6 * (nodes_disp[k, 0] + b * nodes_disp[k, 1]), -0.5 * C6 * (nodes_disp[k, 2] + b * nodes_disp[k, 3]) / r2
    g2 = g_ewald_6 * g_ewald_6
    u = g2 * r2
    y = 1.0 / u
    bell = C6 * g2 * g2 * g2 * y * math.exp(-u)
    return -bell * (0.5 + y * (1.0 + y)), g2 * bell * (0.5 + y * (1.5 + y * (3.0 + 3.0 * y)))


def written(name: str, head: str, body: str) -> Callable:
    """A function of text, as the generated kernels take it."""
    source = f"def {name}({head}):\n{body}"
    scope = {"__name__": __name__, "math": math, "np": np}
    exec(source, scope)
    scope[name].source = source
    return scope[name]


def ordinary(special: Callable, name: str) -> Callable:
    """The formula of ordinary pairs: that of special ones, which lose the part `off` of their bare energy, for `off` 0."""
    head, body = text_of(special).split("):\n", 1)
    arguments = head[head.index("(") + 1:].removesuffix(", nodes, off")
    return written(name, f"{arguments}, nodes: 'array'", f"    off = 0.0\n{body}")


def between(special: Callable, name: str) -> Callable:
    """The same as LAMMPS has it in its long/coul/long styles: what special pairs lose is rounded to single precision, squared distances
    between two nodes are not."""
    head, body = text_of(special).split("):\n", 1)
    lost = "off * (nodes[k, 4] + b * nodes[k, 5])"
    body = body.replace("b = (single", "b = (r2").replace(lost, f"np.float64(np.float32(qqrd2e * {lost})) / qqrd2e")
    return written(name, head[head.index("(") + 1:].replace("nodes, off", "qqrd2e, nodes, off"), body)


special_between = between(special_long, "special_between")
coul_between_table = ordinary(special_between, "coul_between_table")
coul_long_table, coul_msm_table = ordinary(special_long, "coul_long_table"), ordinary(special_msm, "coul_msm_table")
for function, near, solvers in ((coul_long_table, special_long, ("pppm", "ewald")), (coul_long_cs_table, special_cs, ("pppm", "ewald")),
                                (coul_between_table, special_between, ("pppm", "ewald")), (coul_msm_table, special_msm, ("msm",))):
    function.long, function.special, function.solvers = True, near, solvers
dispersion_table.long, dispersion_table.solvers, dispersion_table.values = True, ("ewald/disp", "pppm/disp"), of_dispersion
coul_long_cs_table.core, coul_long_cs_table.core_until = 1e-12, "start2"


def keyword(part) -> str:
    """The keyword of ``pair_modify`` that gives a part a table."""
    return "table" if part.charged else "table/disp"


@cache
def tabled(style: PairStyle, keywords: frozenset[str]) -> PairStyle:
    """The style with tables in place of the parts that have them; itself if none has.

    Parameters
    ----------
    keywords : frozenset of str
        ``table`` or ``table/disp``, those in use.
    """
    looked_up = [part for part in style.parts if hasattr(part.function, "table") and keyword(part) in keywords]
    if style.oriented or not style.takes_tables or not looked_up:
        return style
    twin = copy.copy(style)
    twin.parts = tuple(make_part(style.tables.get(part.function, part.function.table), part.cut, part.rows) if part in looked_up else part
                       for part in style.parts)
    return twin


def in_use(table: dict, compat: str) -> dict:
    """The settings of ``pair_modify`` with LAMMPS's defaults, where these are wanted."""
    return {**UNASKED, **table} if compat == "lammps" else table


def without(interactions) -> list[str]:
    """Commands for LAMMPS after which it computes what it has in tables and what is computed here."""
    asked = in_use(interactions.table, interactions.compat)
    off = [w for key in UNASKED if key not in asked for w in (key, "0")]
    return [" ".join(["pair_modify", *off])] if off and interactions.needs_solver else []


def settings_of(style: PairStyle, settings: dict, table: dict, qqrd2e: float) -> tuple[dict, tuple[np.ndarray, ...]]:
    """Settings with what the functions take as numbers, and the nodes; `qqrd2e` is the energy of unit charges at unit distance.

    Raises
    ------
    InputError
        The range does not fit into so many bits.
    """
    settings, arrays = {**settings, "qqrd2e": qqrd2e}, []
    for part in style.parts:
        if part.arrays:
            key, end = keyword(part), "" if part.charged else "_disp"
            cut = float(settings[part.cut])
            bits = Bits(table.get(key.replace("table", "tabinner"), TABINNER), cut, int(table[key]))
            settings |= {f"start2{end}": float(bits.r2[0]), f"per_octave{end}": bits.per_octave, f"first{end}": bits.first}
            arrays.append(nodes(bits, settings, cut, getattr(part.function, "values", values)))
    return settings, tuple(arrays)
