"""Sphinx: ``sphinx-build docs docs/_build`` (``pip install .[docs]``)."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from asemd import __version__  # noqa: E402

project = "asemd"
author = copyright = "asemd developers"
version = release = __version__
extensions = ["myst_parser", "sphinx.ext.mathjax"]
myst_enable_extensions = ["dollarmath", "colon_fence"]
myst_heading_anchors = 3
source_suffix = {".md": "markdown"}
exclude_patterns = ["_build"]
html_theme = "furo"
html_title = f"asemd {__version__}"
suppress_warnings = ["myst.xref_missing", "misc.highlighting_failure"]
