"""``dump ID group image N file colour diameter keywords...``: a rendered picture of the atoms every N steps.

Spheres and bonds are exact, lit by three lights, faded with depth and smoothed at the edges. Keywords: LAMMPS manual, dump image.
"""
from __future__ import annotations

from itertools import combinations

import numpy as np

from asemd.dump import Dump, View, frame, is_compressed
from asemd.dump._camera import CORNERS, Camera
from asemd.dump._colours import TYPES, ColourMap, element_colour, element_diameter, rgb
from asemd.dump._columns import column_of
from asemd.dump._files import open_binary
from asemd.dump._modify import SELECT
from asemd.errors import InputError, nearest
from asemd.words import bounds, number, take, whole, yes_no

KEYWORDS = ("atom", "adiam", "bond", "size", "view", "center", "up", "zoom", "persp", "box", "axes", "subbox", "shiny", "fsaa", "ssao")
OTHER = ("line", "tri", "ellipsoid", "body", "grid", "region", "fix", "compute")
EDGES = [(i, j) for i, j in combinations(range(8), 2) if np.abs(CORNERS[i] - CORNERS[j]).sum() == 1]
AXES = ("red", "green", "blue")


class Image(Dump):
    """One picture for each snapshot: png, jpg or ppm by the ending of the name."""

    style = "image"
    wildcards = "*"
    one_each = True
    KEYWORDS = {**{k: n for k, n in Dump.KEYWORDS.items() if k not in ("append", "colname", "format", "header", "sort", "time", "units")},
                **SELECT, "acolor": 2, "adiam": 2, "amap": 0, "backcolor": 1, "bcolor": 2, "bdiam": 2, "boxcolor": 1, "color": 4}

    def __init__(self, group: str, every: int, path: str, colour: str, diameter: str, *, variables=None, regions=None):
        columns = [c for c in (colour, diameter) if c not in ("type", "element")]
        super().__init__(group, every, path, columns, variables=variables, regions=regions)
        self.colour, self.diameter, self.adiam = colour, diameter, 0.0
        self.width, self.height, self.samples = 512, 512, 2
        self.atoms, self.bonds, self.shiny, self.occlusion = True, None, 1.0, 0.0
        self.box, self.axes = 0.02, (0.0, 0.0)      # diameters (and length), parts of the box
        self.camera: Camera | None = None
        self.words: list[str] = []
        self.map = ColourMap()
        self.own: dict[str, tuple] = {}
        self.atom_colour: dict[int, tuple] = {}
        self.bond_colour: dict[int, tuple] = {}
        self.atom_size: dict[int, float] = {}
        self.bond_size: dict[int, float] = {}
        self.background, self.box_colour = (0.0, 0.0, 0.0), rgb("yellow", TYPES, "boxcolor")

    @classmethod
    def from_lammps(cls, id, group, every, path, words, session):
        cls.check_many(id, path)
        colour, diameter = take(words, 2, f"dump {cls.style}")
        dump = cls(group, every, path, colour, diameter, variables=session.variables, regions=session.scene.regions)
        dump.id = id
        flat = session.scene.dimension == 2
        dump.camera = Camera(*((("0", "0"), ("0.5", "0.5", "0.5"), False, ("0", "1", "0")) if flat else ()))
        dump.read(words[2:])
        return dump

    # ---- words
    def read(self, words: list[str]) -> None:
        """Keywords of the dump command."""
        words = list(words)
        while words:
            key = words.pop(0)
            what = f"dump {self.style} {key}"
            if key in OTHER:
                raise InputError(f"{what} is not supported: atoms and bonds are drawn")
            if key not in KEYWORDS:
                raise InputError(f"dump {self.style}: unknown keyword {key!r}{nearest(key, KEYWORDS)}")
            if key in ("view", "center", "up", "zoom"):
                used = self.camera.read(key, words, self.variables, what)
            else:
                used = getattr(self, "_read_" + key)(words, what)
            del words[:used]

    def _read_atom(self, words, what) -> int:
        self.atoms = yes_no(take(words, 1, what)[0], what)
        return 1

    def _read_adiam(self, words, what) -> int:
        self.adiam = _positive(take(words, 1, what)[0], what)
        return 1

    def _read_bond(self, words, what) -> int:
        colour, width = take(words, 2, what)
        if colour not in ("atom", "type", "none"):
            raise InputError(f"{what}: the colour must be atom, type or none, got {colour!r}")
        if width not in ("atom", "type", "none"):
            _positive(width, what)
        self.bonds = (colour, width)
        return 2

    def _read_size(self, words, what) -> int:
        self.width, self.height = (whole(w, what) for w in take(words, 2, what))
        if not (0 < self.width <= 16384 and 0 < self.height <= 16384):
            raise InputError(f"{what}: expected a width and height in pixels, up to 16384, got {words[0]} {words[1]}")
        return 2

    def _read_persp(self, words, what) -> int:
        if number(take(words, 1, what)[0], what) != 0.0:
            raise InputError(f"{what}: pictures are parallel projections, without perspective: leave the keyword out")
        return 1

    def _read_box(self, words, what) -> int:
        flag, diameter = take(words, 2, what)
        self.box = _length(diameter, what) if yes_no(flag, what) else 0.0
        return 2

    def _read_subbox(self, words, what) -> int:     # one process: its part is the box
        flag, diameter = take(words, 2, what)
        self.box = max(self.box, _length(diameter, what) if yes_no(flag, what) else 0.0)
        return 2

    def _read_axes(self, words, what) -> int:
        flag, length, diameter = take(words, 3, what)
        self.axes = (_length(length, what), _length(diameter, what)) if yes_no(flag, what) else (0.0, 0.0)
        return 3

    def _read_shiny(self, words, what) -> int:
        self.shiny = _fraction(take(words, 1, what)[0], what)
        return 1

    def _read_fsaa(self, words, what) -> int:
        self.samples = 3 if yes_no(take(words, 1, what)[0], what) else 2
        return 1

    def _read_ssao(self, words, what) -> int:
        flag, seed, strength = take(words, 3, what)
        if whole(seed, what) <= 0:      # for the form only: the shading is computed, not drawn at random
            raise InputError(f"{what}: the seed must be positive, got {seed}")
        self.occlusion = _fraction(strength, what) if yes_no(flag, what) else 0.0
        return 3

    # ---- dump_modify
    def values_of(self, key, words, session):
        if key == "amap":
            return ColourMap.from_words(words, self.own, "dump_modify amap")[1]
        return super().values_of(key, words, session)

    def _each_type(self, word, kind, what, session) -> range:
        system = session.scene.system
        count = system.counts["ntypes" if kind == "atom" else "nbondtypes"]
        first, last = bounds(word, 1, count, what, system.labels.get(kind))
        return range(first, last + 1)

    def _colours(self, values, kind, what, session) -> dict[int, tuple]:
        names = [rgb(name, self.own, what) for name in values[1].split("/")]
        return {t: names[k % len(names)] for k, t in enumerate(self._each_type(values[0], kind, what, session))}

    def _modify_acolor(self, values, what, session):
        self.atom_colour |= self._colours(values, "atom", what, session)

    def _modify_bcolor(self, values, what, session):
        self.bond_colour |= self._colours(values, "bond", what, session)

    def _modify_adiam(self, values, what, session):
        self.atom_size |= dict.fromkeys(self._each_type(values[0], "atom", what, session), _positive(values[1], what))

    def _modify_bdiam(self, values, what, session):
        self.bond_size |= dict.fromkeys(self._each_type(values[0], "bond", what, session), _positive(values[1], what))

    def _modify_amap(self, values, what, session):
        self.map = ColourMap.from_words(values, self.own, what)[0]

    def _modify_backcolor(self, values, what, session):
        self.background = rgb(values[0], self.own, what)

    def _modify_boxcolor(self, values, what, session):
        self.box_colour = rgb(values[0], self.own, what)

    def _modify_color(self, values, what, session):
        self.own[values[0]] = tuple(_fraction(v, what) for v in values[1:])

    # ---- the picture
    def _type_colours(self, types: np.ndarray, chosen: dict[int, tuple]) -> np.ndarray:
        default = list(TYPES.values())
        table = {t: chosen.get(t, default[(t - 1) % len(default)]) for t in np.unique(types).tolist()}
        return np.array([table[t] for t in types.tolist()]).reshape(-1, 3)

    def colours(self, view: View) -> np.ndarray:
        """Colours (n, 3) of the atoms."""
        if self.colour == "type":
            return self._type_colours(view.system.type[view.rows], self.atom_colour)
        if self.colour == "element":
            names = view.element()
            table = {name: element_colour(name, f"dump {self.style}") for name in set(names)}
            return np.array([table[name] for name in names]).reshape(-1, 3)
        return self.map(np.asarray(column_of(view, self.colour), float))

    def diameters(self, view: View) -> np.ndarray:
        """Diameters (n,) of the atoms."""
        if self.adiam:
            return np.full(len(view.rows), self.adiam)
        if self.diameter == "type":
            return np.array([self.atom_size.get(t, 1.0) for t in view.system.type[view.rows].tolist()])
        if self.diameter == "element":
            names = view.element()
            table = {name: element_diameter(name, f"dump {self.style}") for name in set(names)}
            return np.array([table[name] for name in names])
        return np.maximum(np.asarray(column_of(view, self.diameter), float), 0.0)

    def bars(self, view: View, colours: np.ndarray, diameters: np.ndarray):
        """Both halves of every bond: starts, ends, diameters, colours, and which halves end freely, at a periodic boundary."""
        colour, width = self.bonds or ("atom", "0.5")
        top = view.system.topology
        at = np.full(view.system.n, -1)
        at[view.rows] = np.arange(len(view.rows))
        pairs, types = at[top.bonds].reshape(-1, 2), np.abs(top.bond_types)
        keep = (pairs >= 0).all(axis=1) & (top.bond_types > 0)
        pairs, types = pairs[keep], types[keep]
        if "none" in (colour, width) or not len(pairs):
            return (np.zeros((0, 3)),) * 2 + (np.zeros(0), np.zeros((0, 3)), np.zeros(0, bool))
        i, j = pairs.T
        box, x = view.box, view.x
        d = (x[j] - x[i]) @ box.inverse
        shift = np.where(box.periodic, np.rint(d), 0.0)
        d, free = (d - shift) @ box.cell, shift.any(axis=1)
        thick = {"atom": np.minimum(diameters[i], diameters[j]), "type": np.array([self.bond_size.get(t, 0.5) for t in types.tolist()])}
        thick = thick[width] if width in thick else np.full(len(types), float(width))
        paint = (colours[i], colours[j]) if colour == "atom" else (self._type_colours(types, self.bond_colour),) * 2
        return (np.concatenate([x[i], x[j]]), np.concatenate([x[i] + 0.5 * d, x[j] - 0.5 * d]), np.concatenate([thick, thick]),
                np.concatenate(paint), np.concatenate([free, free]))

    def lines(self, box) -> tuple:
        """Edges of the box and axes: starts, ends, diameters, colours."""
        short = float(np.linalg.norm(box.cell[:2 if self.flat else 3], axis=1).min())
        corners = box.origin + CORNERS @ box.cell
        edges = [e for e in EDGES if not self.flat or CORNERS[e[0], 2] == CORNERS[e[1], 2] == 0.0]
        start, end, thick, paint = [], [], [], []
        if self.box > 0.0:
            start += [corners[i] for i, _ in edges]
            end += [corners[j] for _, j in edges]
            thick += [self.box * short] * len(edges)
            paint += [self.box_colour] * len(edges)
        if self.axes[0] > 0.0:
            origin = box.origin - 0.1 * (box.cell[:2] if self.flat else box.cell).sum(axis=0)
            for k in range(2 if self.flat else 3):
                start.append(origin)
                end.append(origin + self.axes[0] * box.cell[k])
                thick.append(self.axes[1] * short)
                paint.append(TYPES[AXES[k]])
        return np.array(start).reshape(-1, 3), np.array(end).reshape(-1, 3), np.array(thick), np.array(paint).reshape(-1, 3)

    def picture(self, snapshot, view: View) -> np.ndarray:
        """The picture, (height, width, 3) bytes."""
        from asemd.dump._render import Look, Objects, render
        self.flat = snapshot.dimension == 2
        box, _ = frame(snapshot.system.box)
        colours, diameters = self.colours(view), self.diameters(view)
        place, scale = (self.camera or Camera()).place(box, self.width, self.height, self.variables)
        *bars, free = self.bars(view, colours, diameters)
        start, end, thick, paint = (np.concatenate(parts) for parts in zip(bars, self.lines(box)))
        shown = diameters > 0.0 if self.atoms else np.zeros(len(diameters), bool)
        # rounded ends of everything that is not inside an atom
        bare = np.ones(len(start), bool)
        bare[:len(free)] = not self.atoms
        flat, last = np.zeros(len(start), bool), bare.copy()
        flat[:len(free)], last[:len(free)] = free, bare[:len(free)] & ~free
        balls = [(view.x[shown], diameters[shown], colours[shown]), (start[bare], thick[bare], paint[bare]),
                 (end[last], thick[last], paint[last])]
        centre, size, colour = (np.concatenate(parts) for parts in zip(*balls))
        objects = Objects(place(centre), 0.5 * scale * size, colour, place(start), place(end), 0.5 * scale * thick, paint, flat)
        fading = 0.4 if np.mean(self.background) < 0.5 else 0.06     # mixed as light, where white outweighs colours
        look = Look(np.array(self.background), self.shiny, self.occlusion, fading, self.samples)
        return render(self.width, self.height, objects, look)

    def write_view(self, snapshot, step, view):
        from PIL import Image as Picture
        picture, path = Picture.fromarray(self.picture(snapshot, view)), self.files.name(step)
        ending = path.rsplit(".", 1)[-1].lower()
        kind = {"png": "PNG", "jpg": "JPEG", "jpeg": "JPEG"}.get(ending, "PPM")
        try:
            with (open_binary(path) if is_compressed(path) else open(path, "wb")) as f:
                picture.save(f, kind, **({"quality": 95} if kind == "JPEG" else {}))
        except OSError as e:
            raise self.cannot_write(path, e) from None
        self.files.written(path)


def _positive(word: str, what: str) -> float:
    value = number(word, what)
    if value <= 0.0:
        raise InputError(f"{what}: must be positive, got {word}")
    return value


def _length(word: str, what: str) -> float:
    """A part of the length of the box."""
    value = number(word, what)
    if value < 0.0:
        raise InputError(f"{what}: must not be negative, got {word}")
    return value


def _fraction(word: str, what: str) -> float:
    value = number(word, what)
    if not 0.0 <= value <= 1.0:
        raise InputError(f"{what}: expected a number from 0 to 1, got {word}")
    return value


__all__ = ["Image"]
