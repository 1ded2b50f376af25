"""``lattice style scale keyword values ...``"""
from __future__ import annotations

from asemd.errors import InputError, nearest
from asemd.lattice import Lattice
from asemd.words import number, take, whole

KEYWORDS = {"origin": 3, "orient": 4, "spacing": 3, "a1": 3, "a2": 3, "a3": 3, "basis": 3, "triclinic/general": 0}


def run(session, args):
    scene = session.scene
    if len(args) < 2:
        raise InputError("lattice needs a style and a scale, for example: lattice fcc 0.8442")
    style, scale = args[0], number(args[1], "lattice: scale")
    options = {"origin": (0.0, 0.0, 0.0), "spacing": None}
    orient = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
    edges = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]
    basis = []
    words = args[2:]
    if style == "none" and words:
        raise InputError(f"lattice none takes a scale only, got {' '.join(words)}")
    while words:
        key = words[0]
        if key not in KEYWORDS:
            raise InputError(f"lattice: unknown keyword {key!r}{nearest(key, KEYWORDS)}")
        values = take(words[1:], KEYWORDS[key], f"lattice {key}")
        words = words[1 + len(values):]
        if key == "triclinic/general":
            options["general"] = True
            continue
        if key == "orient":
            if values[0] not in ("x", "y", "z"):
                raise InputError(f"lattice orient: the axis must be x, y or z, got {values[0]!r}")
            orient["xyz".index(values[0])] = tuple(whole(w, "lattice orient") for w in values[1:])
            continue
        vector = tuple(number(w, f"lattice {key}") for w in values)
        if key in ("a1", "a2", "a3", "basis") and style != "custom":
            raise InputError(f"lattice {style}: the keyword {key} belongs to style custom")
        if key == "basis":
            basis.append(vector)
        elif key[0] == "a":
            edges[int(key[1]) - 1] = vector
        else:
            options[key] = vector
    scene.lattice = Lattice(style, scale, density=scene.units == "lj", dimension=scene.dimension, orient=tuple(orient),
                            vectors=tuple(edges) if style == "custom" else None, basis=tuple(basis), **options)
    if style != "none":
        session.print(scene.lattice.text())
