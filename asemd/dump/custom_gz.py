"""``dump ID group custom/gz N file.gz ...``: dump custom, compressed."""
from __future__ import annotations

from asemd.dump._compressed import Compressed
from asemd.dump.custom import Custom


class CustomGZ(Compressed, Custom):
    """As `asemd.dump.custom.Custom`; the file name must end in ``.gz``."""

    style = "custom/gz"
    KEYWORDS = {**Custom.KEYWORDS, "compression_level": 1}
