"""``neigh_modify keyword values ...``: when lists are rebuilt and which pairs are left out."""
from __future__ import annotations

from asemd.errors import InputError, nearest
from asemd.words import bounds, choice, number, take, whole, yes_no

KEYWORDS = ("delay", "every", "check", "once", "cluster", "include", "exclude", "page", "one", "binsize", "collection/type",
            "collection/interval")


def run(session, args):
    settings, words = session.scene.neighbor, list(take(args, 2, "neigh_modify") and args)
    while words:
        key = words.pop(0)
        if key not in KEYWORDS:
            raise InputError(f"neigh_modify: unknown keyword {key!r}{nearest(key, KEYWORDS)}")
        what = f"neigh_modify {key}"
        if key == "exclude":
            del words[:exclude(session, words)]
            continue
        value = take(words, 1, what)[0]
        del words[0]
        if key in ("every", "delay"):
            count = whole(value, what)
            if count < (key == "every"):
                raise InputError(f"{what}: must be {'positive' if key == 'every' else 'zero or positive'}, got {value}")
            setattr(settings, key, count)
        elif key == "check":
            settings.check = yes_no(value, what)
        elif key == "once":
            session.scene.list_once = yes_no(value, what)
        elif key == "include":
            if value != "all":
                raise InputError("neigh_modify include is not supported for other groups than all: use neigh_modify exclude group")
        elif key == "cluster":
            yes_no(value, what)
        elif key in ("page", "one"):
            whole(value, what)          # sizes of LAMMPS's buffers; lists here grow as needed
        elif key == "binsize":
            number(value, what)
        else:
            raise InputError(f"{what} is not supported: remove it, the lists are the same without it")


def exclude(session, words) -> int:
    """Read one exclusion; the number of words it used."""
    what = "neigh_modify exclude"
    kind = choice(take(words, 1, what)[0], ("type", "group", "molecule", "molecule/intra", "molecule/inter", "none"), what)
    scene = session.scene
    if kind == "none":
        scene.neighbor.exclude.clear()
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
