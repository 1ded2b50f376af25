"""``thermo_modify keyword values ...``"""
from __future__ import annotations

import re

from asemd.errors import InputError, nearest
from asemd.thermo import KEYWORDS as WORDS
from asemd.thermo import known
from asemd.words import choice, take, whole, yes_no

KEYWORDS = ("lost", "lost/bond", "warn", "norm", "flush", "line", "format", "temp", "press", "colname", "triclinic/general")
FORMAT = re.compile(r"[^%]*%[-+ 0#]*\d{0,3}(\.\d{1,3})?(ll|l|h|z|j)*[diugGeEfF][^%]*")


def run(session, args):
    scene, words = session.scene, list(args)
    scene.need_system("thermo_modify") if "temp" in words or "press" in words else take(words, 1, "thermo_modify")
    thermo = scene.thermo
    while words:
        key = words.pop(0)
        if key not in KEYWORDS:
            raise InputError(f"thermo_modify: unknown or unsupported keyword {key!r}{nearest(key, KEYWORDS)}")
        what = f"thermo_modify {key}"
        value = take(words, 1, what)[0]
        if key in ("format", "colname"):
            del words[:(set_format if key == "format" else set_name)(thermo, words)]
            continue
        del words[0]
        if key in ("lost", "lost/bond"):
            setattr(thermo, key.replace("/", "_"), choice(value, ("ignore", "warn", "error"), what))
        elif key == "warn":
            set_warn(session, value)
        elif key in ("norm", "flush"):
            setattr(thermo, key, yes_no(value, what))
        elif key == "line":
            thermo.line = choice(value, ("one", "multi", "yaml"), what)
        elif key == "temp":
            set_temp(scene, value)
            if scene.computes[value].group != "all":
                session.warn("Temperature for thermo pressure is not for group all")
        elif key == "press":
            thermo.press = _compute(scene, value, "pressure", what)
        else:
            thermo.general = yes_no(value, what)
            if thermo.general and (scene.system is None or scene.system.rotation is None):
                thermo.general = False
                raise InputError("thermo_modify triclinic/general cannot be used if the simulation box is not general triclinic")


def set_format(thermo, words: list[str]) -> int:
    """``format line|int|float|none|M|keyword string``; the number of words used."""
    kind = words[0]
    if kind == "none":
        thermo.format_line = ()
        for table in (thermo.format_kind, thermo.format_word, thermo.format_column):
            table.clear()
        return 1
    text = take(words, 2, "thermo_modify format")[1]
    if kind == "line":
        thermo.format_line = tuple(text.split())
        if len(thermo.format_line) < len(thermo.words):
            raise InputError(f"thermo_modify format line has {len(thermo.format_line)} formats for {len(thermo.words)} columns")
        for form in thermo.format_line:
            _check(form)
        return 2
    _check(text)
    if kind == "int" and not re.search(r"%[-+ 0#]*\d{0,3}(\.\d{1,3})?(ll|l|h|z|j)*[diu]", text):
        raise InputError(f"thermo_modify format int: {text!r} is not a format of a whole number such as %8d")
    if kind in ("int", "float"):
        thermo.format_kind[kind] = text
    elif re.fullmatch(r"-?\d+", kind):
        thermo.format_column[_column(thermo, kind)] = text
    elif kind in thermo.words or known(kind):
        thermo.format_word[kind] = text
    else:
        raise InputError(f"thermo_modify format: unknown keyword {kind!r}{nearest(kind, [*WORDS, 'line', 'int', 'float', 'none'])}")
    return 2


def _check(form: str) -> None:
    if not FORMAT.fullmatch(form):
        raise InputError(f"thermo_modify format: {form!r} is not a format of one number such as %12.6f")


def _column(thermo, word: str) -> int:
    k = whole(word, "thermo_modify")
    k = k if k > 0 else len(thermo.words) + 1 + k
    if not 1 <= k <= len(thermo.words):
        raise InputError(f"thermo_modify: there is no column {word}, the row has {len(thermo.words)}")
    return k


def set_name(thermo, words: list[str]) -> int:
    """``colname ID string`` or ``colname default``; the number of words used."""
    if words[0] == "default":
        thermo.names.clear()
        return 1
    name = take(words, 2, "thermo_modify colname")[1]
    if re.fullmatch(r"-?\d+", words[0]):
        thermo.names[_column(thermo, words[0])] = name
    elif known(words[0]):
        thermo.names[words[0]] = name
    else:
        raise InputError(f"thermo_modify colname: unknown keyword {words[0]!r}{nearest(words[0], WORDS)}")
    return 2


def set_warn(session, value: str) -> None:
    """``warn ignore|reset|default|N``: how many warnings are shown."""
    log = session.log
    if value == "reset":
        log.warnings = 0
    elif value == "ignore":
        log.max_warnings = 0
    elif value == "default":
        log.max_warnings = 100
    else:
        log.max_warnings = whole(value, "thermo_modify warn")


def set_temp(scene, value: str) -> None:
    """Use another temperature compute, also for the pressure."""
    scene.thermo.temp = _compute(scene, value, "temperature", "thermo_modify temp")
    pressure = scene.computes[scene.thermo.press]
    if hasattr(pressure, "temperature"):
        pressure.temperature = scene.computes[value]


def _compute(scene, id: str, kind: str, what: str) -> str:
    if id not in scene.computes:
        raise InputError(f"{what}: there is no compute {id}{nearest(id, scene.computes)}")
    compute = scene.computes[id]
    if not (hasattr(compute, "dof") if kind == "temperature" else compute.style == "pressure"):
        raise InputError(f"{what}: compute {id} (style {compute.style}) does not compute a {kind}")
    return id
