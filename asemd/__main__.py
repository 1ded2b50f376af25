"""``python -m asemd``, the same as ``asemd``."""
from asemd.cli import entry

entry()
