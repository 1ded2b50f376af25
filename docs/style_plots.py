"""Curves of the styles: energy and force along the coordinate a style depends on, as SVG that takes its text colour from the page.

Forces come from the same functions the kernels are made of; for atoms they are projected on the path along which the curve is drawn.
"""
from __future__ import annotations

import io
import math
import re
import tempfile
import warnings
from dataclasses import dataclass

import numpy as np
import style_scenes

from asemd import units
from asemd.kernels import bonded
from asemd.style import Style
from asemd.testing.styles import Sample, twin

INK = "#010203"                 # becomes the text colour of the page
COLOURS = ("#3b82c4", "#d9770e", "#2a9d6f", "#b565c8")      # to be read on white and on black
POINTS = 241
SYMBOLS = {"real": ("kcal/mol", "Å"), "metal": ("eV", "Å"), "lj": ("ε", "σ")}
# coefficients that show what a style can do, where scaling the energy does not
WORDS = {
    ("bond", "class2"): ["1.1 300 0 0", "1.1 300 -500 0", "1.1 300 -500 700"],
    ("bond", "fene"): ["30 1.5 1 1", "30 1.3 1 1", "30 1.5 0 1"], ("bond", "fene/expand"): ["30 1.5 1 1 0", "30 1.5 1 1 0.2"],
    ("bond", "fene/nm"): ["30 1.5 1 1.12246 12 6", "30 1.5 1 1.12246 9 6", "30 1.5 1 1.12246 6 3"],
    ("bond", "gaussian"): ["300 1 0.0128 0.375 1.37", "300 1 0.073 0.148 1.63", "300 2 0.0128 0.375 1.37 0.0730 0.148 1.63"],
    ("bond", "harmonic/shift"): ["10 0.8 1.3", "10 0.8 1.1", "5 0.8 1.3"],
    ("bond", "harmonic/shift/cut"): ["10 0.8 1.3", "10 0.8 1.1", "5 0.8 1.3"],
    ("bond", "morse"): ["80 1.2 1.5", "80 2.0 1.5", "40 1.2 1.5"], ("bond", "nonlinear"): ["100 1.1 1.4", "100 1.1 0.7"],
    ("bond", "table"): [], ("angle", "table"): [], ("dihedral", "table"): [], ("dihedral", "table/cut"): [], ("pair", "table"): [],
    ("bond", "bpm/spring"): ["1.0 0.4 0.1", "1.0 0.2 0.1"],
    ("angle", "charmm"): ["75 110.1 0 1.9", "75 110.1 50 1.9", "75 110.1 200 1.9"],
    ("angle", "cosine/periodic"): ["75 1 2", "75 -1 3", "75 1 4"], ("angle", "fourier/simple"): ["100 1 1", "100 -1 3", "100 -1 4"],
    ("angle", "cosine/shift/exp"): ["10 45 -2", "10 45 0", "10 45 2"], ("angle", "quartic"): ["129.2 56.9 0 0", "129.2 56.9 -25.9 -14.2"],
    ("angle", "cosine/squared/restricted"): ["75 110.1", "75 60"],
    ("angle", "mesocnt"): ["harmonic custom 400", "buckling custom 400 50 15"],
    ("angle", "gaussian"): ["300 1 0.0128 0.375 80", "300 1 0.073 0.148 123", "300 2 0.0128 0.375 80 0.073 0.148 123"],
    ("angle", "fourier"): ["75 1 0.5 0.3", "75 1 1 0", "75 1 0 1"], ("dihedral", "charmm"): ["1.2 1 180 0", "1.2 2 180 0", "1.2 3 0 0"],
    ("dihedral", "charmmfsw"): ["1.2 1 180 0", "1.2 2 180 0", "1.2 3 0 0"], ("dihedral", "harmonic"): ["80 1 1", "80 1 2", "80 -1 3"],
    ("dihedral", "cosine/shift/exp"): ["10 45 -3", "10 45 0", "10 45 3"],
    ("dihedral", "cosine/squared/restricted"): ["10 120", "10 60", "10 180"],
    ("dihedral", "opls"): ["1.74 0 0 0", "1.74 -0.157 0 0", "1.74 -0.157 0.279 0.9"], ("dihedral", "quadratic"): ["100 80", "100 -120"],
    ("dihedral", "multi/harmonic"): ["20 -10 0 0 0", "20 -10 5 0 0", "20 -10 5 7 -3"], ("dihedral", "nharmonic"): ["2 10 20", "3 10 20 30"],
    ("improper", "cvff"): ["80 1 1", "80 -1 2", "80 -1 4"], ("improper", "harmonic"): ["40 0", "40 10", "40 60"],
    ("improper", "umbrella"): ["100 0", "100 35", "100 60"], ("improper", "cossq"): ["4 0", "4 20", "4 60"],
    ("improper", "distharm"): ["25 0", "25 0.3"], ("improper", "sqdistharm"): ["25 0", "25 0.09", "25 0.2"],
    ("improper", "inversion/harmonic"): ["18.776 0", "18.776 12"], ("improper", "distance"): ["80 0", "80 30", "-20 60"],
    ("improper", "fourier"): ["3 1 0.5 0.7 0", "3 1 0.5 0.7 1", "3 1 -1 0 0"],
    ("pair", "coul/cut"): ["9.0", "6.0"], ("pair", "morse"): ["1 2 1.2 2.4", "1 4 1.2 2.4", "0.5 2 1.2 2.4"],
    ("pair", "lj/cut/coul/cut"): ["0.1 3.0 7 9", "2.0 3.0 7 9"], ("pair", "lj/charmm/coul/charmm"): ["0.1 3.0", "2.0 3.0"],
    ("pair", "lj/charmmfsw/coul/charmmfsh"): ["0.1 3.0", "2.0 3.0"], ("pair", "buck"): ["400 0.25 5 2.4", "400 0.25 10 2.4"],
    ("pair", "lj/spica"): ["lj9_6 0.1 3.0", "lj12_4 0.1 3.0", "lj12_6 0.1 3.0"],
    ("pair", "lj/sdk"): ["lj9_6 0.1 3.0", "lj12_4 0.1 3.0", "lj12_6 0.1 3.0"],
}
RANGES = {"fene": (0.8, 1.5), "fene/expand": (0.8, 1.75), "fene/nm": (0.85, 1.5), "quartic": (0.85, 1.4), "nonlinear": (0.02, 2.6),
          "harmonic/shift": (0.4, 1.6), "harmonic/shift/cut": (0.4, 1.6), "morse": (0.7, 5.0),
          "gaussian": (0.8, 2.2), "table": (0.25, 2.95),
          "bpm/spring": (0.5, 1.4), "harmonic/restrain": (0.5, 1.4), "lepton": (0.8, 1.5)}


@dataclass
class Curve:
    """Energy and force over a coordinate; nan where the style is not defined."""

    label: str
    x: np.ndarray
    energy: np.ndarray
    force: np.ndarray
    theirs: np.ndarray | None = None       # LAMMPS's force where it is another one


# ------------------------------------------------------------------------------------------------- paths ---

def bond_path(r):
    return [(0, 0, 0), (r, 0, 0)]


def angle_path(theta):
    return [(1, 0, 0), (0, 0, 0), (math.cos(theta), math.sin(theta), 0)]


def torsion_path(phi):
    s, c = math.sin(math.radians(110)), math.cos(math.radians(110))
    return [(s, 0, c), (0, 0, 0), (0, 0, 1), (s * math.cos(phi), s * math.sin(phi), 1 - c)]


def height_path(d):
    return [(0.1, 0, d), (1, 0, 0), (-0.5, 0.87, 0), (-0.5, -0.87, 0)]


def elevation_path(omega):
    return [(0, 0, 0), (0.5, 0.87, 0), (0.5, -0.87, 0), (-math.cos(omega), 0, math.sin(omega))]


def direction_path(chi):
    return [(0, 0, 0), (1, 0, 0), (0, 0, 1), (math.cos(chi), math.sin(chi), 1)]


def path_of(s: Style):
    """Positions along the path, its range, the name of the coordinate, and whether it is an angle."""
    degrees = math.pi / 180.0
    if s.category == "bond":
        rest = style_scenes.distance(s)
        return bond_path, RANGES.get(s.name, (0.75 * rest, 1.35 * rest)), "r", False
    if s.category == "angle":
        return angle_path, (0.5 * degrees, 179.5 * degrees), "θ", True
    if s.category == "dihedral" or s.coordinates[0] in ("phi", "chi"):
        name = {"chi": "χ, with sign"}.get(s.coordinates[0], "φ")
        return torsion_path, (-179.5 * degrees, 179.5 * degrees), name, True
    if s.name in ("distance", "distharm", "sqdistharm"):
        return height_path, (-0.8, 0.8), "d", False
    if s.name == "cossq":
        return direction_path, (0.5 * degrees, 179.5 * degrees), "χ", True
    if s.centre == 2:
        def second(omega):
            x = elevation_path(omega)
            return [x[1], x[0], *x[2:]]
        return second, (-89.5 * degrees, 89.5 * degrees), "elevation of atom 4", True
    return elevation_path, (-89.5 * degrees, 89.5 * degrees), "elevation of atom 4", True


# ------------------------------------------------------------------------------------------------ curves ---

def along(s: Style, packed, path, values) -> tuple[np.ndarray, np.ndarray]:
    """Energy and force along a path of atoms."""
    loop = twin(s, energy=True, per_atom=True, periodic=False)["loop"]
    sample, step = Sample(s, packed), 1e-5
    energy, force = np.full(len(values), np.nan), np.full(len(values), np.nan)
    for k, v in enumerate(values):
        x = np.array(path(v), float).T.copy()
        answer = sample.run(x, loop)
        if not answer.bad[0]:
            move = (np.array(path(v + step)) - np.array(path(v - step))).T / (2.0 * step)
            energy[k], force[k] = answer.acc[0], (answer.forces * move).sum()
    return energy, force


def of_pair(s, settings, coeff, unit: str, charges, values, compat: str) -> tuple[np.ndarray, np.ndarray]:
    """Energy and force of a pair of atoms."""
    s = s.variant(settings, compat)
    if hasattr(s, "bind"):
        s = s.bind(settings, {(1, 1): coeff}, compat) or s
    tables = s.pack_pairs(settings, s.filled({(1, 1): coeff}, settings, 1), 1, units.get(unit))
    qq = units.get(unit).qqr2e * (charges[0] * charges[1] if charges else 0.0)
    energy, force = np.zeros(len(values)), np.zeros(len(values))
    for k, r in enumerate(values):
        row = constant = 0
        for part in s.parts:
            cut2, offset, *given = tables.rows[row:row + 2 + len(part.rows), 1, 1]
            numbers = tables.constants[constant:constant + len(part.constants)]
            row, constant = row + 2 + len(part.rows), constant + len(part.constants)
            if r * r < cut2:
                e, d = part.function(r * r if part.coordinate == "r2" else r, *[qq] * part.charged, *given, *numbers, *tables.arrays)
                energy[k] += e - offset
                force[k] -= d * 2.0 * r if part.coordinate == "r2" else d
    return energy, force


def lines_of(s: Style) -> list[str]:
    """Coefficient lines to be drawn."""
    if (s.category, s.name) in WORDS:
        return WORDS[s.category, s.name] or [" ".join(style_scenes.words_of(s)[0])]
    words = s.example.split()
    energies = [k for k, p in enumerate(s.coeff) if "energy" in p.unit and k < len(words)]
    plain = type(s).__name__ not in ("SeriesStyle", "CrossTermStyle", "ExpressionStyle", "PairExpression", "Spherical")
    if len(words) > 5 or not energies or not plain or "word" in [p.unit for p in s.coeff]:
        return [s.example]
    first = energies[0]
    return [" ".join([*words[:first], f"{factor * float(words[first]):g}", *words[first + 1:]]) for factor in (0.5, 1.0, 2.0)]


def other(theirs, force):
    """LAMMPS's force if one can see that it is another one."""
    if theirs is None or np.nanmax(np.abs(theirs - force)) < 2e-3 * np.nanmax(np.abs(force)):
        return None
    return theirs


def has_curves(s: Style) -> bool:
    """Whether the style has a function of its own."""
    return s.function is not None and s.name not in style_scenes.HYBRIDS


def curves(s: Style) -> list[Curve]:
    """Curves of a style; none for styles without a function of their own."""
    if not has_curves(s):
        return []
    unit, out = style_scenes.unit_of(s), []
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        settings = s.parse_settings(s.settings_example.split())
        if any(p.unit == "path" for p in s.coeff):
            style_scenes.write_table(s.category, folder)
        for line in lines_of(s):
            words = [f"{folder}/{w}" if w.endswith(".table") else w for w in line.split()]
            label = "" if folder in "".join(words) or len(line) > 44 else line
            coeff = s.parse_coeff(words, settings)
            if s.category == "pair":
                cut = 2.5 if s.name == "table" else s.reach(s.complete(coeff, settings), settings)
                lo = {"soft": 0.0, "table": 0.9}.get(s.name, 0.8 * style_scenes.distance(s))
                x = np.linspace(lo, 1.05 * cut if s.name != "table" else 0.999 * cut, POINTS)
                charges = style_scenes.scene("pair", s.name).charges
                e, f = of_pair(s, settings, coeff, unit, charges, x, "")
                theirs = of_pair(s, settings, coeff, unit, charges, x, "lammps")[1] if s.twin else None
                out.append(Curve(label, x, e, f, other(theirs, f)))
                continue
            mine, packed = s.bind(settings, {1: coeff}), s.pack(settings, {1: coeff}, 1, units.get(unit))
            if s.coordinates == ("gamma",):
                x = np.linspace(0.0, math.pi, POINTS)
                evaluate = twin(s, energy=True, per_atom=True, periodic=False)["evaluate"]
                pairs = np.array([evaluate(v, 1, packed.coeff, packed.arrays) for v in x])
                out.append(Curve(label, np.degrees(x), pairs[:, 0], -pairs[:, 1]))
                continue
            path, (lo, hi), _, angle = path_of(s)
            x = np.linspace(lo, hi, POINTS)
            e, f = along(mine, packed, path, x)
            theirs = along(s.bind(settings, {1: coeff}, "lammps"), packed, path, x)[1] if s.lammps else None
            out.append(Curve(label, np.degrees(x) if angle else x, e, f, other(theirs, f)))
    return out


def outside(s: Style) -> str:
    """The message for the first point of the curve where the style is not defined, "" if there is none."""
    if s.category == "pair" or s.function is None or not s.domain:
        return ""
    for curve in curves(s)[-1:]:
        gone = curve.x[~np.isfinite(curve.energy)]
        if len(gone):
            value = gone[0] if s.category == "bond" else math.radians(gone[0])
            ids = range(1, 1 + {"bond": 2, "angle": 3}.get(s.category, 4))
            return bonded.describe(s, value, ids, 1)
    return ""


# ----------------------------------------------------------------------------------------------- figures ---

def limits(values: np.ndarray) -> tuple[float, float]:
    """The range of an axis: all of a bounded curve, the part with the structure of one that diverges."""
    v = values[np.isfinite(values)]
    lo, hi = v.min(), v.max()
    a, b = np.percentile(v, (12, 88))
    if hi - lo > 4.0 * (b - a):
        a, b = np.percentile(v, (25, 75))
        lo, hi = max(lo, a - 2.0 * (b - a)), min(hi, b + 2.0 * (b - a))
    edge = max(0.06 * (hi - lo), 0.02 * max(abs(lo), abs(hi)), 1e-12)
    return lo - edge, hi + edge


def figure(s: Style, target: str = "svg") -> bytes:
    """Energy and force side by side."""
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    drawn = curves(s)
    energy, length = SYMBOLS[style_scenes.unit_of(s)]
    name, angle = ("r", False) if s.category == "pair" else ("γ", True) if s.coordinates == ("gamma",) else path_of(s)[2:]
    settings = {"svg.fonttype": "none", "svg.hashsalt": s.name, "font.size": 9, "font.family": "sans-serif", "axes.spines.top": False,
                "axes.spines.right": False, "lines.linewidth": 1.6, "legend.frameon": False, "legend.fontsize": 8,
                **dict.fromkeys(("text.color", "axes.edgecolor", "axes.labelcolor", "xtick.color", "ytick.color"), INK)}
    with pyplot.rc_context(settings):
        picture, (left, right) = pyplot.subplots(1, 2, figsize=(7.4, 2.8), layout="constrained")
        other_forces = [c for c in drawn if c.theirs is not None]
        for k, c in enumerate(drawn):
            left.plot(c.x, c.energy, color=COLOURS[k % 4], label=c.label)
            right.plot(c.x, c.force, color=COLOURS[k % 4])
            if c.theirs is not None:
                right.plot(c.x, c.theirs, color=COLOURS[k % 4], ls=":", label="LAMMPS's force" if c is other_forces[0] else None)
        left.set_ylim(limits(np.concatenate([c.energy for c in drawn])))
        right.set_ylim(limits(np.concatenate([c.force for c in drawn])))
        for axes in (left, right):
            axes.set_xlabel(f"{name} (degrees)" if angle else f"{name} ({length})")
            axes.patch.set_alpha(0.0)
            axes.axhline(0.0, color="#808080", lw=0.6, zorder=0)
            if angle:
                first = drawn[0].x[0]
                ends = (0, 180) if first >= 0 else (-180, 180) if first < -91 else (-90, 90)
                axes.set_xticks(np.linspace(*ends, 5))
        left.set_ylabel(f"E ({energy})")
        right.set_ylabel(f"force ({energy}/{'rad' if angle else length})")
        named = [h for axes in (left, right) for h in axes.get_legend_handles_labels()[0]]
        if len(named) > 1:
            picture.legend(handles=named, loc="outside upper center", ncols=len(named))
        out = io.BytesIO()
        vector = target == "svg"
        picture.savefig(out, format=target, dpi=110, transparent=vector, metadata={"Date": None, "Creator": None} if vector else {})
        pyplot.close(picture)
    return out.getvalue()


def svg(s: Style) -> str:
    """The figure as an element of a page."""
    text = figure(s).decode()
    text = text[text.index("<svg"):].replace(INK, "currentColor")
    text = re.sub(r"<metadata>.*?</metadata>\s*", "", text, flags=re.S)
    text = text.replace("*{stroke", "svg *{stroke")
    title = f"Energy and force of {s.category} style {s.name}"
    size = 'style="width: 100%; height: auto; max-width: 46rem" role="img"'
    return re.sub(r'width="[\d.]+pt" height="[\d.]+pt"', f'{size} aria-label="{title}"', text, count=1)
