"""``dump ID group local/gz N file.gz ...``: dump local, compressed."""
from __future__ import annotations

from asemd.dump._compressed import Compressed
from asemd.dump.local import Local


class LocalGZ(Compressed, Local):
    """As `asemd.dump.local.Local`; the file name must end in ``.gz``."""

    style = "local/gz"
    KEYWORDS = {**Local.KEYWORDS, "compression_level": 1}
