"""``neigh_modify keyword values ...``: when lists are rebuilt and which pairs are left out."""
from __future__ import annotations

from itertools import pairwise

from asemd.errors import InputError, nearest
from asemd.words import bounds, choice, number, take, whole, yes_no

KEYWORDS = ("delay", "every", "check", "once", "cluster", "include", "exclude", "page", "one", "binsize", "collection/type",
            "collection/interval")


def run(session, args):
    scene, words = session.scene, list(args)
    settings = scene.neighbor
    while words:
        key = words.pop(0)
        if key not in KEYWORDS:
            raise InputError(f"neigh_modify: unknown keyword {key!r}{nearest(key, KEYWORDS)}")
        what = f"neigh_modify {key}"
        if key == "exclude" or key.startswith("collection"):
            del words[:exclude(session, words) if key == "exclude" else collection(scene, key, words)]
            continue
        value = take(words, 1, what)[0]
        del words[0]
        if key in ("every", "delay"):
            count = whole(value, what)
            if count < (key == "every"):
                raise InputError(f"{what}: must be {'positive' if key == 'every' else 'zero or positive'}, got {value}")
            setattr(settings, key, count)
            session.remember("neigh_modify")
        elif key == "check":
            settings.check = yes_no(value, what)
        elif key == "once":
            scene.list_once = yes_no(value, what)
        elif key == "include":
            include(scene, value)
        elif key == "cluster":
            yes_no(value, what)
        elif key in ("page", "one"):
            if whole(value, what) < 1:      # sizes of LAMMPS's buffers; lists here grow as needed
                raise InputError(f"{what}: must be positive, got {value}")
        else:
            number(value, what)


def include(scene, group: str) -> None:
    """Pairs only among the atoms of a group."""
    what = "neigh_modify include"
    if scene.system is None:
        if group != "all":
            raise InputError(f"{what}: unknown group {group!r}, groups come after the box")
        return
    scene.groups.mask(group, what)
    if group != (scene.first_group or "all"):
        raise InputError(f"{what} {group}: the group must be that of atom_modify first, {scene.first_group or 'which was not given'}")
    others = [rule for rule in scene.neighbor.exclude if rule[0] != "outside"]
    scene.neighbor.exclude[:] = others if group == "all" else [*others, ("outside", group)]


def collection(scene, key: str, words: list[str]) -> int:
    """Check a division into collections, which changes how LAMMPS searches but not what it finds; the number of words it used."""
    what = f"neigh_modify {key}"
    if scene.list_style != "multi":
        raise InputError(f"{what} is for neighbor lists of style multi: use the command neighbor before")
    count = whole(take(words, 1, what)[0], what)
    if count < 1:
        raise InputError(f"{what}: the number of collections must be positive, got {words[0]}")
    values = take(words[1:], count, what)
    if key == "collection/interval":
        if any(a >= b for a, b in pairwise(number(v, what) for v in values)):
            raise InputError(f"{what}: the intervals must become larger, got {' '.join(values)}")
        return 1 + count
    system, seen = scene.need_system(what), set()
    ntypes, labels = system.counts["ntypes"], system.labels.get("atom", {})
    for part in ",".join(values).split(","):
        low, high = bounds(part, 1, ntypes, what, labels)
        types = set(range(low, high + 1))
        if types & seen:
            raise InputError(f"{what}: atom type {min(types & seen)} is in two collections")
        seen |= types
    missing = set(range(1, ntypes + 1)) - seen
    if missing:
        raise InputError(f"{what}: atom type {min(missing)} is in no collection")
    return 1 + count


def exclude(session, words) -> int:
    """Read one exclusion; the number of words it used."""
    what = "neigh_modify exclude"
    kind = choice(take(words, 1, what)[0], ("type", "group", "molecule", "molecule/intra", "molecule/inter", "none"), what)
    scene = session.scene
    if kind == "none":
        scene.neighbor.exclude[:] = [rule for rule in scene.neighbor.exclude if rule[0] == "outside"]
        return 1
    system = scene.need_system("neigh_modify exclude")
    if kind == "type":
        ntypes, labels = system.counts["ntypes"], system.labels.get("atom", {})
        ranges = [bounds(w, 1, ntypes, f"{what} type", labels) for w in take(words[1:], 2, f"{what} type")]
        for i in range(ranges[0][0], ranges[0][1] + 1):
            for j in range(ranges[1][0], ranges[1][1] + 1):
                scene.neighbor.exclude.append(("type", i, j))
        return 3
    groups = take(words[1:], 2 if kind == "group" else 1, f"{what} {kind}")
    for group in groups:
        scene.groups.mask(group, what)
    scene.neighbor.exclude.append(("molecule/intra" if kind == "molecule" else kind, *groups))
    return 1 + len(groups)
