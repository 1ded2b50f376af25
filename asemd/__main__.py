"""``python -m asemd``: the command line."""
from asemd.cli import entry

entry()
