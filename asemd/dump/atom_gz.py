"""``dump ID group atom/gz N file.gz ...``: dump atom, compressed."""
from __future__ import annotations

from asemd.dump._compressed import Compressed
from asemd.dump.atom import Atom


class AtomGZ(Compressed, Atom):
    """As `asemd.dump.atom.Atom`; the file name must end in ``.gz``."""

    style = "atom/gz"
    KEYWORDS = {**Atom.KEYWORDS, "compression_level": 1}
