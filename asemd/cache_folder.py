"""Where asemd keeps what it need not make twice."""
from __future__ import annotations

import os
import sys
from pathlib import Path


def cache_folder() -> Path:
    """``ASEMD_CACHE_DIR``, else ``asemd`` in the user's cache folder."""
    wanted = os.environ.get("ASEMD_CACHE_DIR")
    if wanted:
        return Path(wanted)
    base = os.environ.get("XDG_CACHE_HOME") or (os.environ.get("LOCALAPPDATA") if os.name == "nt" else None) \
        or (Path.home() / ("Library/Caches" if sys.platform == "darwin" else ".cache"))
    return Path(base) / "asemd"
