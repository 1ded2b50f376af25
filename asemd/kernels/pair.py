"""Compiled pair kernels of a style: one for the cluster list, one for plain pair lists, made for exactly the variant a scene needs."""
from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cache

import numpy as np

from asemd.kernels import bond_history, coefficient_rows, pair_cluster, pair_list, pair_shares, pair_sums, prune, vector_math
from asemd.kernels.generate import Builder
from asemd.kernels.target import lanes, many_registers
from asemd.pairstyle import SCALE, PairStyle
from asemd.style import operations, text_of

SHORT = 20               # operations in the formulas
ROWS = (608, 1120, 2144, 4192, 8288, 16480, 32864)


def row_length(neighbours: int) -> int:
    """Buffer row for clusters with that many neighbours; not a power of two, to spare the cache's sets."""
    for r in ROWS:
        if neighbours <= most_neighbours(r):
            return r
    raise ValueError(f"{neighbours} neighbours per cluster exceed the largest buffer")


def most_neighbours(row: int) -> int:
    """How many neighbours of a cluster a buffer row holds."""
    return row - 2 * pair_cluster.CLUSTER - 16


def _paste_style(b: Builder, parts, real: bool, vector: bool) -> list[str]:
    """Paste the formulas of the parts; returns their names."""
    names = []
    for k, part in enumerate(parts):
        name = f"part{k}_{re.sub(r'[^0-9a-zA-Z]', '_', part.function.__name__)}"
        b.function(part.function, name, fast=vector, real=real, vector=vector, inline=vector)
        names.append(name)
    return names


def _share(piece: str, numbers: str, first: int) -> list[str]:
    """Lines that compute ``share``, what a piece of a split force has of the whole at that distance: 1, between its limits smoothly to 0.

    From ``numbers[first]`` on stand six numbers: where the inner piece begins to go over into the next one and the inverse of how long
    that takes, the same for the piece before the outer one, and the squared distances between which this piece is not 0.
    """
    lines = ["    w = math.sqrt(r2)", "    share = real(1)"]
    for at, rises, falls in ((first, "middle", "inner"), (first + 2, "outer", "middle")):
        if piece in (rises, falls):
            lines.append(f"    t = min(max((w - {numbers}[{at}]) * {numbers}[{at + 1}], real(0)), real(1))")
            lines.append("    t = t * t * (real(3) - real(2) * t)")
            lines.append(f"    share = share * {'t' if piece == rises else '(real(1) - t)'}")
    return lines


def _adapter(parts, names: Sequence[str], uniform: Sequence[bool], energy: bool, piece: str = "") -> str:
    """``pair_force`` or ``pair_energy``: every part masked by its cutoff. Uniform rows come from the tuple `p`, others from the buffer."""
    where: list[str] = []
    for u in uniform:
        where.append(f"p[{sum(1 for w in where if w[0] == 'p')}]" if u else f"b[place(o + {sum(1 for w in where if w[0] == 'b')} * ROW)]")
    at_constant = sum(uniform)
    lines = [f"def pair_{'energy' if energy else 'force'}(r2, ir2, ir, qq, p, b, o, meet):"]
    if any(part.coordinate == "r" for part in parts):
        lines.append("    r = r2 * ir")
    row, total, vdwl, coul = 0, [], [], []
    for k, (part, name) in enumerate(zip(parts, names)):
        cut2, offset = where[row], where[row + 1]
        args = (["r2", "ir2", "ir"] if part.coordinate == "r2" else ["r"]) + ["qq"] * part.charged + where[row + 2:row + 2 + len(part.rows)]
        args += [f"p[{at_constant + i}]" for i in range(len(part.constants))]
        at_constant += len(part.constants)
        row += 2 + len(part.rows)
        lines.append(f"    e{k}, d{k} = {name}({', '.join(args)})")
        lines.append(f"    m{k} = (r2 < {cut2}) & meet")
        lines.append(f"    f{k} = " + (f"real(-2) * d{k}" if part.coordinate == "r2" else f"-d{k} * ir"))
        lines.append(f"    f{k} = f{k} if m{k} else real(0)")
        total.append(f"f{k}")
        if energy:
            lines.append(f"    e{k} = e{k} - {offset} if m{k} else real(0)")
            (coul if part.charged else vdwl).append(f"e{k}")
    force = " + ".join(total) or "real(0)"
    if piece:
        lines += _share(piece, "p", at_constant)
        force = f"({force}) * share"
    if energy:
        lines.append(f"    return {force}, {' + '.join(vdwl) or 'real(0)'}, {' + '.join(coul) or 'real(0)'}")
    else:
        lines.append(f"    return {force}")
    return "\n".join(lines)


def paste_pairs(b: Builder, parts) -> None:
    """``pair_energy`` of the parts for pairs in vector code, whose coefficients stand in columns of a work space, ROW numbers each, from
    place `o` on; `p` are the constants."""
    b.line("from asemd.kernels.fuse import madd, rough_roots")
    vector_math.paste_roots(b)
    vector_math.paste(b)
    names = _paste_style(b, parts, False, True)
    b.text(_adapter(parts, names, [False] * sum(2 + len(part.rows) for part in parts), True), "forceinline=True", apart=True)


def takes_roots(style: PairStyle) -> bool:
    """Whether formulas take the distance, not only its square."""
    return any(part.coordinate == "r" or "math.sqrt(r2" in text_of(part.function) for part in style.parts)


def two_at_a_time(style: PairStyle) -> bool:
    """Whether two atoms of a cluster run over its neighbours together, which halves loads and stores and takes twice the registers.

    Where there are few of these, short formulas lose more by numbers that do not fit into them (decision 14).
    """
    return many_registers() or not short(style)


def short(style: PairStyle) -> bool:
    """Whether the formulas are of one uncharged part that takes the square of the distance, and a few operations."""
    return not (style.charged or takes_roots(style)) and operations(*style.functions()) <= SHORT


def _over_clusters(title: str, style: PairStyle, uniform: Sequence[bool], single: bool, energy: bool, piece: str,
                   constants: dict) -> Builder:
    """What kernels over cluster lists have in common: constants, the style's formulas, coefficients of the neighbours."""
    b = Builder(f"pair {style.name}: {title}")
    b.line("from asemd.kernels.fuse import madd, rough_roots")
    b.line("from asemd.kernels.gather import fetch8, gather8, give8, scatter8, take8")
    b.line("place = np.uint64")
    b.line("real = np.float32" if single else "real = np.float64")
    for name, value in constants.items():
        b.constant(name, value)
    b.constant("ROOT", takes_roots(style))
    b.constant("ROUGH", not single and takes_roots(style))
    vector_math.paste_roots(b, single)
    if any(re.search(r"\b(math|np)\.(exp|log|erfc|pow|sin|cos)\b", s) for s in map(text_of, style.functions())):
        vector_math.paste(b, single)
    names = _paste_style(b, style.parts, single, True)
    b.text(_adapter(style.parts, names, uniform, energy, piece), "forceinline=True, fastmath={'contract', 'reassoc', 'nsz', 'arcp'}",
           apart=True)
    varying = len(uniform) - sum(uniform)
    if varying:
        if coefficient_rows.WIDE:
            b.line("from asemd.kernels.coefficient_rows import MOST, choose_rows")
        lines = ["def fill_rows(b, full, rows, t, types, base):"]
        for block in range(-(-varying // 4)):
            lines += [f"    table, at = rows[{block}, t], base + {4 * block} * ROW"]
            for halves, up_to in ((1, "MOST // 2"), (2, "MOST")) if coefficient_rows.WIDE else ():
                lines += [f"    {'if' if halves == 1 else 'elif'} table.shape[0] <= {up_to}:",
                          f"        choose_rows(b, at, ROW, table, types, full, {min(varying - 4 * block, 4)}, {halves})"]
            lines += ["    else:" if coefficient_rows.WIDE else "    if True:", "        for k in range(0, full, 8):",
                      "            gather8(b, at + k, ROW, table, types, k, 0.0, 0.0, 0.0, table, SLOT_BITS, False, "
                      f"{3 if varying >= 4 * block + 4 else 0})"]
        b.text("\n".join(lines), apart=True)
    return b


@cache
def cluster_kernel(style: PairStyle, uniform: tuple[bool, ...], row: int, *, energy: bool, exclude: bool, single: bool,
                   outdated: bool = False, piece: str = "", virial: bool = False, pruned: bool = False):
    """The kernel over cluster lists.

    Parameters
    ----------
    uniform : tuple of bool
        For each coefficient row whether it is the same for all type pairs; such rows become scalars.
    row : int
        Buffer row length, from `row_length`.
    single : bool
        Pair arithmetic in single precision (sums stay in double).
    outdated : bool
        The list may be older than the skin allows; pairs beyond its reach when it was built do not interact.
    piece : str
        ``inner``, ``middle`` or ``outer``: only this part of the force; the constants end with the six numbers of `_share`.
    virial : bool
        The virial without the energy.
    pruned : bool
        The list is a part of another one, made anew when due (`asemd.kernels.prune`).
    """
    varying = len(uniform) - sum(uniform)
    paired = two_at_a_time(style)
    b = _over_clusters("cluster list", style, uniform, single, energy, piece,
                       dict(CLUSTER=pair_cluster.CLUSTER, ROW=row, WIDTH=lanes(single), NROWS=buffer_rows(varying),
                            SETS=pair_cluster.SETS, ENERGY=energy, VIRIAL=virial, CHARGED=style.charged, CHARGE_ROW=6 * style.charged,
                            SHARE=not single, PAIRED=paired, VARYING=bool(varying), EXCLUDE=exclude, OUTDATED=outdated,
                            HIDE=False, PRUNED=pruned, SLOT_BITS=pair_cluster.SLOT_BITS))
    if pruned:
        b.use(prune.module(), "renew")
    pair_sums.use(b, "eight", "plus", "add", fast=True)
    if varying:
        b.function(pair_cluster.coefficients, fast=True, inline=True)
    inner = pair_cluster.inner_two if paired else pair_cluster.inner_one
    in_line = many_registers() and short(style)      # longer ones do not fit into the registers with what is around them
    b.function(inner, fast=True, inline=in_line)
    if paired:
        b.function(pair_cluster.one_pair, fast=True)
    if outdated:
        b.constants["HIDE"] = True
        b.function(inner, "two_hidden" if paired else "one_hidden", fast=True, inline=in_line)
    b.function(pair_cluster.cluster_forces, fast=True)
    module = b.build()
    return module.cluster_forces, module


@cache
def shares_kernel(style: PairStyle, uniform: tuple[bool, ...], row: int, *, energies: bool, virials: bool, exclude: bool, outdated: bool):
    """The kernel over cluster lists that makes each atom's share of energies, virials or both; arguments as of `cluster_kernel`."""
    varying = len(uniform) - sum(uniform)
    nrows = buffer_rows(varying)
    b = _over_clusters("shares of atoms", style, uniform, False, True, "",
                       dict(CLUSTER=pair_cluster.CLUSTER, ROW=row, WIDTH=lanes(False), NROWS=nrows, SHARE=7 + 2 * nrows, ENERGIES=energies,
                            VIRIALS=virials, CHARGED=style.charged, CHARGE_ROW=6 * style.charged, VARYING=bool(varying), EXCLUDE=exclude,
                            OUTDATED=outdated, HIDE=False, SLOT_BITS=pair_cluster.SLOT_BITS))
    for f in (pair_shares.both, pair_shares.give, pair_shares.share_pair, pair_shares.shares_two):
        b.function(f, fast=True)
    if outdated:
        b.constants["HIDE"] = True
        b.function(pair_shares.shares_two, "shares_hidden", fast=True)
    b.function(pair_shares.cluster_shares, fast=True)
    return b.build().cluster_shares


def cluster_tuple(rows: np.ndarray, constants: np.ndarray, uniform: Sequence[bool], single: bool) -> tuple:
    """The scalars ``p`` of a cluster kernel: uniform rows, then constants, in the working precision."""
    real = np.float32 if single else np.float64
    values = [rows[k, 1, 1] for k, u in enumerate(uniform) if u] + list(constants)
    return tuple(real(v) for v in values) or (real(0),)


def buffer_rows(varying: int) -> int:
    """Rows of the buffer for the coefficients of one atom: they come by fours, or by threes for the rest."""
    return varying // 4 * 4 + 3 * (varying % 4 > 0)


def varying_rows(rows: np.ndarray, uniform: Sequence[bool]) -> np.ndarray:
    """The rows that are not uniform, four to a place (m, ntypes + 1, ntypes + 1, 4)."""
    chosen = [r for r, same in zip(rows, uniform) if not same]
    out = np.zeros((max(1, -(-len(chosen) // 4)), *rows.shape[1:], 4))
    for k, r in enumerate(chosen):
        out[k // 4, :, :, k % 4] = r
    return out


def uniform_rows(rows: np.ndarray) -> tuple[bool, ...]:
    """Which rows hold one value for all type pairs (type 0 is unused)."""
    return tuple(bool(np.all(r[1:, 1:] == r[1, 1])) for r in rows)


def _core(parts) -> str:
    """The squared distance as parts without charges take it, to which LAMMPS adds in special pairs of cores and shells; else empty."""
    at = 0
    for part in parts:
        if hasattr(part.function, "core"):
            until = getattr(part.function, "core_until", "")
            within = f" and r2 <= constants[{at + part.constants.index(until)}]" if until else ""
            return f"r2 + ({part.function.core} if coul != whole{within} else 0.0)"
        at += len(part.constants)
    return ""


def paste_one(b: Builder, style, parts, piece: str = "", apart: bool = False) -> None:
    """``pair_energy_one`` of the parts: force/r and both energies of one pair; `apart`: forces without and with charges by themselves."""
    names = _paste_style(b, parts, False, False)
    radii = ["radius_i", "radius_j"] * any(p.sized for p in parts)
    taken = ", ".join(["r2", "qq", "lj", "coul", "whole", "rows", "constants", "arrays", "ti", "tj", *radii])
    lines = [f"def pair_energy_one({taken}):", "    fp, fc, ev, ec = 0.0, 0.0, 0.0, 0.0" if apart else "    fp, ev, ec = 0.0, 0.0, 0.0"]
    if any(p.coordinate == "r" for p in parts):
        lines.append("    r = math.sqrt(r2)")
    row = constant = array = 0
    core = _core(parts)
    if piece:
        limits = sum(len(p.constants) for p in parts) + 4
        lines += [f"    if r2 <= constants[{limits}] or r2 >= constants[{limits + 1}]:", "        return fp, ev, ec"]
    for k, (part, name) in enumerate(zip(parts, names)):
        args = [part.coordinate] + ["qq"] * part.charged + radii * part.sized
        args += [f"rows[{row + 2 + i}, ti, tj]" for i in range(len(part.rows))]
        args += [f"constants[{constant + i}]" for i in range(len(part.constants))]
        args += [f"arrays[{array + i}]" for i in range(len(part.arrays))]
        w, force = "coul" if part.charged else "lj", "fc" if apart and part.charged else "fp"
        slope = f"-2.0 * d{k}" if part.coordinate == "r2" else f"(-d{k} / r if r > 0.0 else (0.0 if abs(d{k}) < np.inf else np.inf))"
        if part.long:
            factor = f" * rows[{row + 1 + len(part.rows)}, ti, tj]" if SCALE in part.rows else ""
            bare, power = ((f"qq{factor} / math.sqrt(r2)", "bare") if part.charged
                           else (f"-rows[{row + 2}, ti, tj] / (r2 * r2 * r2)", "6.0 * bare"))
            near = getattr(part.function, "special", None)
            if near is not None:
                b.function(near, f"special_{name}")
                lines += [f"    if coul != whole and r2 < rows[{row}, ti, tj]:",
                          f"        e{k}, d{k} = special_{name}({', '.join(args)}, 1.0 - coul / whole)",
                          f"        {force} += whole * {slope}",
                          f"        ec += whole * e{k}"]
            lines += [f"    {'if' if near is None else 'elif'} r2 < rows[{row}, ti, tj]:",
                      f"        e{k}, d{k} = {name}({', '.join(args)})",
                      f"        bare = (whole - {w}) * {bare} if {w} != whole else 0.0",
                      f"        {force} += whole * {slope} - ({power} / r2 if bare != 0.0 else 0.0)",
                      f"        {'ec' if part.charged else 'ev'} += whole * e{k} - bare"]
        else:
            if core:
                twin = getattr(part.function, "near", None)       # powers of the greater distance, other functions of r
                args[0] = core if part.coordinate == "r2" else "r"
                slope = slope if part.coordinate == "r2" else f"{slope} * (r2 / ({core}))"
                if twin is not None:
                    args.insert(1, core)
                    name = b.function(twin, f"near_{name}")
            counted = "whole" if style.unweighted else w
            lines += [f"    if {counted} != 0.0 and r2 < rows[{row}, ti, tj]:",
                      f"        e{k}, d{k} = {name}({', '.join(args)})",
                      f"        {force} += {w} * {slope}",
                      f"        {'ec' if part.charged else 'ev'} += {counted} * (e{k} - rows[{row + 1}, ti, tj])"]
        row += 2 + len(part.rows)
        constant += len(part.constants)
        array += len(part.arrays)
    if piece:
        lines += [*_share(piece, "constants", constant), "    fp *= share"]
    lines.append("    return fp, fc, ev, ec" if apart else "    return fp, ev, ec")
    b.text("\n".join(lines), apart=True)


@cache
def list_kernel(style, parts, *, wanted: bool, broken: bool = False, factor: bool = False, piece: str = ""):
    """The kernel over plain pair lists, with the `Thread` first; `parts` are the style's own or its 1-4 parts; `wanted`: energies or
    shares; `broken`: pairs of bonds, see `bond_history`; `factor`: atoms have a factor each, the last of `arrays`.

    `piece` as in `cluster_kernel`.
    """
    b = Builder(f"pair {style.name}: plain list")
    b.line("real = np.float64")
    charged, sized = any(p.charged for p in parts), any(p.sized for p in parts)
    for name, value in dict(WANTED=wanted, CHARGED=charged, FACTOR=factor,
                            SIZED=sized).items():
        b.constant(name, value)
    paste_one(b, style, parts, piece)
    pair_sums.use(b, "eight", "add", "halve")
    b.function(pair_list.list_forces)
    if broken:
        b.function(bond_history.broken_pairs)
    module = b.build()
    return (module.broken_pairs if broken else module.list_forces), module


@cache
def rows_kernel(style, uniform: tuple[bool, ...], *, energy: bool, piece: str = "", shares: bool = False):
    """The kernel over rows of single atoms, for sparse systems and tables; `uniform` and `piece` as in `cluster_kernel`; `shares`: that of
    each atom's share of energy and virial."""
    b = Builder(f"pair {style.name}: rows of atoms")
    b.line("real = np.float64")
    b.line("place = np.uint64")
    for name, value in dict(ROOM=pair_list.ROOM, AT_ONCE=pair_list.AT_ONCE,
                            ENERGY=energy, CHARGED=style.charged, CHECK=any(part.arrays for part in style.parts)).items():
        b.constant(name, value)
    names = _paste_style(b, style.parts, False, False)
    where = [f"p[{sum(uniform[:k])}]" if u else f"rows[{k}, ti, tj]" for k, u in enumerate(uniform)]
    cuts, row, constant, array = [], 0, sum(uniform), 0
    lines = ["def pair_of(r2, qq, p, rows, arrays, ti, tj):", "    fp, ev, ec = 0.0, 0.0, 0.0"]
    if any(p.coordinate == "r" for p in style.parts):
        lines.append("    r = math.sqrt(r2)")
    for k, (part, name) in enumerate(zip(style.parts, names)):
        args = [part.coordinate] + ["qq"] * part.charged + where[row + 2:row + 2 + len(part.rows)]
        args += [f"p[{constant + i}]" for i in range(len(part.constants))]
        args += [f"arrays[{array + i}]" for i in range(len(part.arrays))]
        slope = f"-2.0 * d{k}" if part.coordinate == "r2" else f"-d{k} / r"
        lines += [f"    if r2 < {where[row]}:", f"        e{k}, d{k} = {name}({', '.join(args)})", f"        fp += {slope}",
                  f"        {'ec' if part.charged else 'ev'} += e{k} - {where[row + 1]}"]
        cuts.append(where[row])
        row += 2 + len(part.rows)
        constant += len(part.constants)
        array += len(part.arrays)
    if piece:
        lines += [*_share(piece, "p", constant), "    fp *= share"]
    b.text("\n".join([*lines, "    return fp, ev, ec"]), apart=True)
    cut = cuts[0] if len(cuts) == 1 else f"max({', '.join(cuts)})"
    if piece:
        cut = f"min({cut}, p[{constant + 5}])"
    b.text(f"def furthest(p, rows, ti, tj):\n    return {cut}", apart=True)
    if shares:
        b.function(pair_shares.row_shares, fast=True)
        module = b.build()
        return module.row_shares, module
    pair_sums.use(b, "eight", "add", fast=True)
    for f in (pair_list.pairs_at_once, pair_list.row_forces):
        b.function(f, fast=True)
    module = b.build()
    return module.row_forces, module
