"""Sphinx: ``sphinx-build docs docs/_build`` (``pip install .[docs]``)."""
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE)]

import style_pages  # noqa: E402

from asemd import __version__  # noqa: E402

project = "asemd"
author = copyright = "asemd developers"
version = release = __version__
extensions = ["myst_parser", "sphinx.ext.mathjax", "sphinx.ext.autodoc", "sphinx.ext.autosummary", "sphinx.ext.napoleon"]
autosummary_generate = True
autosummary_ignore_module_all = False
autodoc_default_options = {"members": True}
autodoc_typehints = "none"          # signatures have them; the text says units and shapes
napoleon_google_docstring = False
napoleon_use_ivar = True
default_role = "literal"
myst_enable_extensions = ["dollarmath", "colon_fence"]
myst_heading_anchors = 3
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
exclude_patterns = ["_build"]
html_theme = "furo"
html_title = f"asemd {__version__}"
suppress_warnings = ["myst.xref_missing", "misc.highlighting_failure"]


def write_styles(app):
    """A page for each style, from the registry."""
    style_pages.write(HERE / style_pages.FOLDER)


def write_workflows(app):
    """A page for each workflow: its README."""
    folder = HERE / "workflows"
    folder.mkdir(exist_ok=True)
    names = {path.parent.name for path in HERE.parent.glob("workflows/*/README.md")}
    for name in names:
        style_pages.save(folder / f"{name}.md", f"```{{include}} ../../workflows/{name}/README.md\n```\n")
    for old in folder.glob("*.md"):
        if old.stem not in names:
            old.unlink()


def drop_old_reference(app):
    """Pages of names that api.md does not list any more."""
    listed = (HERE / "api.md").read_text().split()
    for page in (HERE / "api").glob("*.rst"):
        if page.stem not in listed:
            page.unlink()


def link_pages(app, docname, source):
    """The overviews of styles and workflows lead to their pages."""
    if docname == "styles":
        source[0] = style_pages.link(source[0])
    if docname == "workflows":
        source[0] = source[0].replace("](../workflows/", "](workflows/").replace("/README.md)", ".md)")


def setup(app):
    app.connect("builder-inited", write_styles)
    app.connect("builder-inited", write_workflows)
    app.connect("builder-inited", drop_old_reference, priority=400)     # before autosummary writes
    app.connect("source-read", link_pages)
    return {"parallel_read_safe": True}
