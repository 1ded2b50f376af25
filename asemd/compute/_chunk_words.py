"""The words of compute chunk/atom."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from asemd.compute._bins import DISCARD, Cylinder, Grid, Layers, Sphere, positive
from asemd.compute._inputs import Input
from asemd.errors import InputError, nearest
from asemd.words import choice, number, take, whole, yes_no

WHAT = "compute chunk/atom"
STYLES = ("type", "molecule", "bin/1d", "bin/2d", "bin/3d", "bin/sphere", "bin/cylinder")
KEYWORDS = {"region": 1, "nchunk": 1, "limit": 1, "ids": 1, "compress": 1, "discard": 1, "bound": 3, "pbc": 1, "units": 1}
ENDS = ("lower", "upper")


@dataclass
class Settings:
    """How atoms are numbered; `words` are the style's own, `bounds` the lowest and highest coordinate of bins along each axis."""

    style: str
    words: list[str] = field(default_factory=list)
    bins: Any = None
    source: Input | None = None
    region: Any = None
    nchunk: str = ""        # empty: what the style has by default
    limit: int = 0
    exact: bool = False
    limit_first: bool = False
    ids: str = "every"
    compress: bool = False
    discard: str = ""
    bounds: list = field(default_factory=lambda: [ENDS] * 3)
    pbc: bool = False
    units: str = "lattice"
    options: list[str] = field(default_factory=list)


def read(words: list[str], session) -> Settings:
    """The words after ``chunk/atom``.

    Raises
    ------
    InputError
        Unknown or missing words, words that do not go together.
    """
    style = take(words, 1, f"{WHAT} (style)")[0]
    reference = style[:2] in ("c_", "f_", "v_")
    if style not in STYLES and not reference:
        raise InputError(f"{WHAT}: unknown style {style!r}{nearest(style, STYLES)}")
    n = {"bin/1d": 3, "bin/2d": 6, "bin/3d": 9, "bin/sphere": 6, "bin/cylinder": 8}.get(style, 0)
    out = Settings(style, take(words[1:], n, f"{WHAT} {style}"))
    bins = style.startswith("bin/")
    if reference:
        out.source = Input(style, WHAT, session)
        out.source.must_give("per_atom")
    out.options = words[1 + n:]
    _options(out, session)
    out.discard = out.discard or ("mixed" if bins else "yes")
    scene = session.scene
    system = scene.need_system(WHAT)
    if style == "molecule" and not system.has_molecules:
        raise InputError(f"{WHAT} molecule: atom style {system.atom_style} has no molecules")
    if out.discard == "mixed" and not bins:
        raise InputError(f"{WHAT}: discard mixed is for bins only")
    if bins:
        if system.box.triclinic and out.units != "reduced":
            raise InputError(f"{WHAT}: bins in a triclinic box need units reduced")
        out.bins = _bins(out, scene)
    return out


def _options(out: Settings, session) -> None:
    words, order = out.options, []
    while words:
        key, what = words[0], f"{WHAT} {words[0]}"
        if key not in KEYWORDS:
            raise InputError(f"{WHAT}: unknown keyword {key!r}{nearest(key, KEYWORDS)}")
        values = take(words[1:], KEYWORDS[key], what)
        order.append(key)
        if key == "region":
            out.region = session.scene.region(values[0], WHAT)
        elif key == "nchunk":
            out.nchunk = choice(values[0], ("once", "every"), what)
        elif key == "limit":
            out.limit = whole(values[0], what)
            if out.limit < 0:
                raise InputError(f"{what}: must not be negative, got {out.limit}")
            if out.limit:
                values = take(words[1:], 2, f"{what} (N max or exact)")
                out.exact = choice(values[1], ("max", "exact"), what) == "exact"
            out.limit_first = not out.compress
        elif key == "ids":
            out.ids = choice(values[0], ("once", "nfreq", "every"), what)
        elif key in ("compress", "pbc"):
            setattr(out, key, yes_no(values[0], what))
        elif key == "discard":
            out.discard = choice(values[0], DISCARD, what)
        elif key == "bound":
            k = "xyz".index(choice(values[0], "xyz", what))
            out.bounds = [*out.bounds[:k], (values[1], values[2]), *out.bounds[k + 1:]]
        else:
            out.units = choice(values[0], ("lattice", "box", "reduced"), what)
        words = words[1 + len(values):]
    if "limit" in order and "compress" in order:
        out.limit_first = order.index("limit") < order.index("compress")


def _bins(out: Settings, scene):
    """The bins, whose lengths are in lattice spacings, 1 without a lattice, or as they are."""
    scale = scene.lattice.spacings if out.units == "lattice" and scene.lattice is not None else np.ones(3)
    what, words = f"{WHAT} {out.style}", out.words

    def end(word: str, k: int, names) -> str | float:
        return word if word in names else float(number(word, f"{WHAT} bound") * scale[k])
    out.bounds = [(end(lo, k, ("lower",)), end(hi, k, ("upper",))) for k, (lo, hi) in enumerate(out.bounds)]

    def layers(dim: str, origin: str, delta: str) -> Layers:
        k = "xyz".index(choice(dim, "xyz", what))
        if k == 2 and scene.dimension == 2:
            raise InputError(f"{what}: a 2d simulation has no bins along z")
        start = origin if origin in ("lower", "center", "upper") else float(number(origin, what) * scale[k])
        return Layers(k, start, positive(number(delta, what) * scale[k], what))
    if out.style == "bin/sphere":
        *origin, least, most = (number(w, what) for w in words[:5])
        return Sphere(np.array(origin) * scale, *_radii(least * scale[0], most * scale[0], words[5], what))
    if out.style == "bin/cylinder":
        along = layers(*words[:3])
        *origin, least, most = (number(w, what) for w in words[3:7])      # in the plane LAMMPS has no lattice spacings
        return Cylinder(along, origin, *_radii(least, most, words[7], what))
    grid = [layers(*words[k:k + 3]) for k in range(0, len(words), 3)]
    if len({layer.axis for layer in grid}) < len(grid):
        raise InputError(f"{what}: each direction can be given once")
    return Grid(grid)


def _radii(least: float, most: float, count: str, what: str) -> tuple[float, float, int]:
    bins = whole(count, what)
    if not 0.0 <= least < most:
        raise InputError(f"{what}: needs 0 <= rmin < rmax, got {least:g} and {most:g}")
    if bins < 1:
        raise InputError(f"{what}: needs at least 1 bin, got {bins}")
    return float(least), float(most), bins


def write(s: Settings) -> list[str]:
    """The words again."""
    return [s.style, *s.words, *s.options]
