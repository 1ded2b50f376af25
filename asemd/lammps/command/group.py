"""``group ID style args``"""
from __future__ import annotations

import re

import numpy as np

from asemd.errors import InputError, nearest
from asemd.fix.dynamic_group import DynamicGroup
from asemd.words import exactly, take, whole

LOGICAL = {"<": np.less, ">": np.greater, "<=": np.less_equal, ">=": np.greater_equal, "==": np.equal, "!=": np.not_equal, "<>": None}
STYLES = ("delete", "clear", "empty", "region", "id", "type", "molecule", "variable", "include", "subtract", "union", "intersect",
          "dynamic", "static")
DYNAMIC = ("region", "var", "property", "every")


def run(session, args):
    scene = session.scene
    system = scene.need_system("group")
    scene.sync_groups()
    name, style = take(args, 2, "group")[:2]
    words, groups, what = args[2:], scene.groups, f"group {name} {style}"
    if style not in STYLES:
        raise InputError(f"group {name}: unknown style {style!r}{nearest(style, STYLES)}")
    if not re.fullmatch(r"\S+", name):
        raise InputError(f"group name {name!r} must not have spaces")
    if style in ("delete", "clear"):
        _remove(scene, name, style, what)
        return
    if style == "dynamic":
        dynamic_group(session, name, words, what)
        return
    old = groups[name] if name in groups else np.zeros(system.n, bool)
    if style == "static":
        exactly(words, 0, what)
        session.scene.dynamic_groups.pop(name, None)
    groups[name] = old | _members(session, system, old, style, words, what)
    changes = name in scene.dynamic_groups
    session.print(f"dynamic group {name} defined" if changes else f"{int(groups[name].sum())} atoms in group {name}")


def _remove(scene, name: str, style: str, what: str) -> None:
    groups = scene.groups
    if name == "all":
        raise InputError(f"{what}: the group all cannot be changed")
    if name not in groups:
        raise InputError(f"{what}: there is no such group{nearest(name, groups)}")
    if style == "clear":
        groups[name] = np.zeros(scene.system.n, bool)
        return
    for kind, table in (("fix", scene.fixes), ("compute", scene.computes), ("dump", scene.dumps)):
        for id, user in table.items():
            if getattr(user, "group", None) == name:
                raise InputError(f"{what}: {kind} {id} uses this group, remove it first")
    for other, fix in scene.dynamic_groups.items():
        if fix.group == name:
            raise InputError(f"{what}: the dynamic group {other} takes its members from it")
    scene.dynamic_groups.pop(name, None)
    del groups[name]


def dynamic_group(session, name: str, words: list[str], what: str) -> None:
    """``group ID dynamic parent keyword value ...``: members are chosen when a run begins."""
    scene = session.scene
    parent = take(words, 1, what)[0]
    scene.groups.mask(parent, what)
    if name == "all" or parent == name or parent in scene.dynamic_groups:
        raise InputError(f"{what}: the group and its parent {parent} must be two, the first not all, the second not dynamic")
    take(words[1:], 1, what)
    given: dict[str, str] = {}
    for key, value in zip(words[1::2], [*words[2::2], None]):
        if key not in DYNAMIC:
            raise InputError(f"{what}: unknown keyword {key!r}{nearest(key, DYNAMIC)}, there are {' '.join(DYNAMIC)}")
        given[key] = take([value] if value is not None else [], 1, f"{what} {key}")[0]
    every = whole(given.get("every", "1"), f"{what} every")
    if every < 1:
        raise InputError(f"{what} every: must be positive, got {every}")
    if "region" in given:
        scene.region(given["region"], what)
    if "var" in given:
        session.variables.find(given["var"])
    vector = None
    if "property" in given:
        vector = next((k + given["property"] for k in ("i_", "d_") if k + given["property"] in scene.system.extra), None)
        if vector is None:
            raise InputError(f"{what}: atoms have no property {given['property']}, define it with fix property/atom")
    if name not in scene.groups:
        scene.groups[name] = np.zeros(scene.system.n, bool)
    scene.dynamic_groups[name] = DynamicGroup(name, parent, session, given.get("region"), given.get("var"), vector, every)
    session.print(f"dynamic group {name} defined")


def _members(session, system, old: np.ndarray, style: str, words: list[str], what: str) -> np.ndarray:
    scene = session.scene
    if style in ("empty", "static"):
        exactly(words, 0, what)
        return np.zeros(system.n, bool)
    take(words, 1, what)
    if style == "region":
        exactly(words, 1, what)
        return scene.region(words[0], what).inside(system.x)
    if style == "variable":
        variable = exactly(words, 1, what)[0].removeprefix("v_")
        if session.variables.find(variable).style not in ("atom", "atomfile"):
            raise InputError(f"{what}: variable {variable} must be of style atom or atomfile")
        return session.variables.per_atom(variable, system.n) != 0.0
    if style == "include":
        if words[0] != "molecule":
            raise InputError(f"{what}: expected molecule, got {words[0]!r}")
        _need_molecules(system, what)
        return np.isin(system.molecule, system.molecule[old & (system.molecule > 0)])
    if style in ("subtract", "union", "intersect"):
        masks = [scene.groups.mask(w, what) for w in words]
        for word in words:
            if word in scene.dynamic_groups:
                raise InputError(f"{what}: the group {word} changes by itself, make it static first")
        take(words, 1 if style == "union" else 2, what)
        if style == "subtract":
            return masks[0] & ~np.logical_or.reduce([np.zeros(system.n, bool), *masks[1:]])
        return (np.logical_or if style == "union" else np.logical_and).reduce(masks)
    if style == "molecule":
        _need_molecules(system, what)
    labels = system.labels["atom"] if style == "type" else {}
    return _selected(getattr(system, style), words, labels, what)


def _need_molecules(system, what: str) -> None:
    if not system.has_molecules:
        raise InputError(f"{what}: atom_style {system.atom_style} has no molecules")


def _selected(values: np.ndarray, words: list[str], labels: dict[int, str], what: str) -> np.ndarray:
    """Which values a list of numbers, labels and sequences A:B:C names, or a comparison."""
    if words[0] in LOGICAL:
        need = 2 if words[0] == "<>" else 1
        limits = [_number(w, labels, what) for w in take(words[1:], need, what)]
        if len(words) != 1 + need:
            raise InputError(f"{what} {words[0]} needs {need} value{'s' * (need > 1)}, got {len(words) - 1}")
        if words[0] == "<>":
            return (values >= limits[0]) & (values <= limits[1])
        return LOGICAL[words[0]](values, limits[0])
    found = np.zeros(len(values), bool)
    for word in words:
        sequence = re.fullmatch(r"(-?\d+):(-?\d+)(?::(\d+))?", word)
        if sequence:
            first, last, step = int(sequence[1]), int(sequence[2]), int(sequence[3] or 1)
            if step < 1:
                raise InputError(f"{what}: {word} is not a sequence start:end:step")
            found |= (values >= first) & (values <= last) & ((values - first) % step == 0)
        else:
            found |= values == _number(word, labels, what)
    return found


def _number(word: str, labels: dict[int, str], what: str) -> int:
    for number, label in labels.items():
        if label == word:
            return number
    if labels and not re.match(r"[-+\d]", word):
        raise InputError(f"{what}: {word} is no type label{nearest(word, labels.values())}")
    return whole(word, what)
