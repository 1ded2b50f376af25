"""``pair_style NAME args``, with the names of sub-styles after ``hybrid``; type labels among the words of four-site water."""
from __future__ import annotations

import re

from asemd.words import bounds

WATER = re.compile(r"(lj/cut/|(?P<long>lj/long/))?tip4p/(cut|long)(/soft)?(/omp|/opt)?")
KINDS = (("atom", "ntypes"), ("atom", "ntypes"), ("bond", "nbondtypes"), ("angle", "nangletypes"))


def run(session, args):
    scene = session.scene
    scene.interactions.set_style("pair", args if scene.system is None else _without_labels(args, scene.system))


def _without_labels(args: list[str], system) -> list[str]:
    """The words with numbers where the types of oxygen, hydrogen, O-H bond and H-O-H angle are labels."""
    out = list(args)
    for k, word in enumerate(args):
        found = WATER.fullmatch(word)
        for at, (kind, count) in enumerate(KINDS if found else (), k + (3 if found and found["long"] else 1)):
            if at < len(out) and out[at] in system.labels[kind].values():
                out[at] = str(bounds(out[at], 1, system.counts[count], "pair_style", system.labels[kind])[0])
    return out
