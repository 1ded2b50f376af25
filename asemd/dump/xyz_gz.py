"""``dump ID group xyz/gz N file.gz ...``: dump xyz, compressed."""
from __future__ import annotations

from asemd.dump._compressed import Compressed
from asemd.dump.xyz import XYZ


class XYZGZ(Compressed, XYZ):
    """As `asemd.dump.xyz.XYZ`; the file name must end in ``.gz``."""

    style = "xyz/gz"
    KEYWORDS = {**XYZ.KEYWORDS, "compression_level": 1}
