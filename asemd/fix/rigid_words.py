"""Words of the fixes of rigid bodies: ``single | molecule | group N names | custom v_name`` and the keywords after them."""
from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from asemd.errors import InputError, nearest
from asemd.words import number, take, whole, yes_no

if TYPE_CHECKING:
    from asemd.fix.rigid import Rigid

KINDS = ("single", "molecule", "group", "custom")
KEYWORDS = ("force", "torque", "langevin", "temp", "tparam", "iso", "aniso", "x", "y", "z", "couple", "pchain", "dilate", "infile",
            "reinit", "gravity", "mol")
COUPLE = ("none", "xyz", "xy", "yz", "xz")


def bodies_from_words(cls: type[Rigid], words: list[str], session) -> tuple:
    """What the bodies are, the words that said so, and the words after them."""
    what = f"fix {cls.style}"
    kinds = ("molecule", "custom") if cls.small else KINDS
    if not words:
        raise InputError(f"{what} needs one of {' '.join(kinds)}")
    kind, rest = words[0], words[1:]
    if kind not in kinds:
        if cls.small and kind in KINDS:
            raise InputError(f"{what}: bodies are of kind molecule or custom, {kind} is for fix {cls.style.removesuffix('/small')}")
        raise InputError(f"{what}: expected one of {' '.join(kinds)}, got {kind!r}{nearest(kind, kinds)}")
    if kind == "molecule" and not session.scene.system.molecular:
        raise InputError(f"{what} molecule: atoms of style {session.scene.system.atom_style} have no molecules")
    if kind in ("single", "molecule"):
        return kind, [kind], rest
    if kind == "group":
        count = whole(take(rest, 1, f"{what} group")[0], f"{what} group")
        if count < 1:
            raise InputError(f"{what} group: needs one group or more, got {count}")
        names = take(rest[1:], count, f"{what} group")
        for name in names:
            session.scene.groups.mask(name, what)
        return list(names), [kind, str(count), *names], rest[1 + count:]
    word = take(rest, 1, f"{what} custom")[0]
    system = session.scene.system
    if word.startswith("v_"):
        if session.variables.find(word[2:]).style != "atom":
            raise InputError(f"{what} custom: variable {word[2:]} is not of style atom")
        values = session.variables.per_atom(word[2:], system.n)
    elif word.startswith("i_"):
        if word not in system.extra and word[2:] not in system.extra:
            raise InputError(f"{what} custom: atoms have no property {word}, define it with fix property/atom")
        values = system.extra.get(word, system.extra.get(word[2:]))
    else:
        raise InputError(f"{what} custom: expected i_name or v_name, got {word!r}")
    return np.asarray(values).astype(np.int64), [kind, word], rest[1:]


def options_from_words(cls: type[Rigid], words: list[str], session) -> dict:
    """Keyword arguments of the class."""
    out: dict = {}
    allowed = ["langevin", "infile", "reinit"] if not (cls.thermostats or cls.barostats) else ["infile", "reinit"]
    allowed += ["gravity", "mol"] if cls.small else ["force", "torque", "gravity"]
    allowed += ["temp", "tparam"] if cls.thermostats else []
    allowed += ["iso", "aniso", "x", "y", "z", "couple", "dilate"] if cls.barostats else []
    allowed += ["pchain"] if cls.barostats else []
    while words:
        keyword, what = words[0], f"fix {cls.style} {words[0]}"
        if keyword not in allowed:
            if keyword not in KEYWORDS:
                raise InputError(f"fix {cls.style}: unknown keyword {keyword!r}{nearest(keyword, allowed)}")
            raise InputError(f"fix {cls.style} does not take the keyword {keyword}")
        if keyword == "mol":
            name = take(words[1:], 1, what)[0]
            if name not in session.scene.molecules:
                raise InputError(f"{what}: there is no molecule {name}{nearest(name, session.scene.molecules)}")
            for one in session.scene.molecules[name]:
                one.check(session.scene.system, what)
                least = np.linalg.eigvalsh(one.body(np.ones(one.natoms))[2])[0]
                if one.inertia is not None and least < 0.0:
                    raise InputError(f"{what}: the molecule has a negative principal moment of inertia, {least:g}")
            out[keyword], used = name, 1
        elif keyword in ("force", "torque"):
            which, *flags = take(words[1:], 4, what)
            out.setdefault(keyword, []).append((which, tuple(_on_off(flag, what) for flag in flags)))
            used = 4
        elif keyword == "langevin":
            values = take(words[1:], 4, what)
            out[keyword] = (*(number(w, what) for w in values[:3]), whole(values[3], what))
            used = 4
        elif keyword == "temp":
            out["temperature"] = tuple(number(w, what) for w in take(words[1:], 2, what))
            out["damping"] = number(take(words[1:], 3, what)[2], what)
            used = 3
        elif keyword == "tparam":
            out["chain"], out["loops"], out["order"] = (whole(w, what) for w in take(words[1:], 3, what))
            used = 3
        elif keyword in ("iso", "aniso", "x", "y", "z"):
            values = tuple(number(w, what) for w in take(words[1:], 3, what))
            pressure = out.setdefault("pressure", {})
            for axis in "xyz" if keyword in ("iso", "aniso") else keyword:
                if axis != "z" or session.scene.dimension == 3 or keyword == "z":
                    pressure[axis] = values
            if keyword in ("iso", "aniso"):
                out["couple"] = "xyz" if keyword == "iso" else "none"
            used = 3
        elif keyword == "couple":
            value = take(words[1:], 1, what)[0]
            if value not in COUPLE:
                raise InputError(f"{what}: expected one of {' '.join(COUPLE)}, got {value!r}")
            out[keyword], used = value, 1
        elif keyword == "pchain":
            out["pressure_chain"], used = whole(take(words[1:], 1, what)[0], what), 1
        elif keyword == "dilate":
            name = take(words[1:], 1, what)[0]
            session.scene.groups.mask(name, what)
            out["dilate"], used = name, 1
        elif keyword in ("infile", "gravity"):
            out[keyword], used = take(words[1:], 1, what)[0], 1
            if keyword == "infile":     # what was said of reinit before does not count
                out.pop("reinit", None)
        else:
            out[keyword], used = yes_no(take(words[1:], 1, what)[0], what), 1
        words = words[1 + used:]
    return out


def _on_off(word: str, what: str) -> bool:
    return yes_no(word, what)


def words_of(fix: Rigid) -> list[str]:
    """The words of a script that make this fix again."""
    words = list(fix.kind_words)
    if not words:
        if not isinstance(fix.kind, str) and not fix.group_names:
            raise InputError(f"fix {fix.style}: bodies given by numbers have no words; use fix property/atom and custom i_name")
        words = ["group", str(len(fix.kind)), *fix.group_names] if fix.group_names else [str(fix.kind)]
    for keyword, settings in (("force", fix.force), ("torque", fix.torque)):
        for which, flags in settings:
            words += [keyword, str(which), *("on" if flag else "off" for flag in flags)]
    if fix.langevin is not None:
        words += ["langevin", *(repr(v) for v in fix.langevin)]
    if fix.infile:
        words += ["infile", fix.infile]
    if fix.gravity:
        words += ["gravity", fix.gravity]
    reinit = [] if fix.reinit == (fix.infile is None) else ["reinit", "yes" if fix.reinit else "no"]
    return words + reinit + fix.own_words()
