"""``boundary x y z``: each p, s, f or m, once or for both faces."""
from __future__ import annotations

import re

from asemd.errors import InputError


def run(session, args):
    if len(args) != 3:
        raise InputError(f"boundary needs three words such as p p f, got {' '.join(args) or 'nothing'}")
    for word in args:
        if not re.fullmatch(r"p|pp|[sfm]{1,2}", word):
            raise InputError(f"boundary: {word!r} must be one of p s f m, or two of s f m; periodic faces come in pairs")
    session.scene.boundary = tuple(w * 2 if len(w) == 1 else w for w in args)
