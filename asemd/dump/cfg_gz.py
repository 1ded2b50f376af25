"""``dump ID group cfg/gz N file.gz ...``: dump cfg, compressed."""
from __future__ import annotations

from asemd.dump._compressed import Compressed
from asemd.dump.cfg import CFG


class CFGGZ(Compressed, CFG):
    """As `asemd.dump.cfg.CFG`; the file name must end in ``.gz``."""

    style = "cfg/gz"
    KEYWORDS = {**CFG.KEYWORDS, "compression_level": 1}
