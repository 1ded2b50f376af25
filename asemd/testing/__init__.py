"""Checks that ship: of styles, and of whole scenes against LAMMPS."""
from __future__ import annotations

import importlib
from typing import Any

_LAZY = {
    "check_style": "asemd.testing.styles",
    "report_style": "asemd.testing.styles",
    "ask": "asemd.testing.oracle",
    "lammps_available": "asemd.testing.oracle",
    "lammps_version": "asemd.testing.oracle",
    "OracleError": "asemd.testing.oracle",
}
__all__ = list(_LAZY)


def __getattr__(name: str) -> Any:
    if name not in _LAZY:
        raise AttributeError(f"module 'asemd.testing' has no attribute {name!r}")
    return getattr(importlib.import_module(_LAZY[name]), name)
