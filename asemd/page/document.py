"""HTML around the parts of a page: template, tables, Markdown, packed libraries."""
from __future__ import annotations

import base64
import gzip
import html
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any

from asemd import __version__
from asemd.page.plot import THEMES, Plot

LIBRARIES = {"plot": ("vega.min.js", "vega-lite.min.js"), "snapshot": ("3Dmol-min.js",)}      # part -> files of the folder assets
NUMBER = re.compile(r"[-+]?(\d[\d,]*\.?\d*|\.\d+)([eE][-+]?\d+)?\s*[%x]?")


@dataclass
class Part:
    """One thing on a page; `body` is HTML."""

    kind: str
    title: str = ""
    body: str = ""
    note: str = ""
    wide: bool = False


def escape(text: Any) -> str:
    """Text for HTML."""
    return html.escape(str(text))


def markdown(text: str) -> str:
    """HTML of a Markdown text; HTML in it does not count."""
    from markdown_it import MarkdownIt
    return MarkdownIt("commonmark", {"html": False}).enable("table").render(text)


def tiles(facts: Mapping[str, Any]) -> str:
    """Name and value pairs."""
    return "".join(f"<div><dt>{escape(k)}</dt><dd>{escape(v)}</dd></div>" for k, v in facts.items())


def table(columns: Sequence[str], rows: Sequence[Sequence[Any]]) -> str:
    """An HTML table; columns of numbers are flush right."""
    text = [[escape(c) for c in row] for row in rows]
    right = [bool(text) and all(NUMBER.fullmatch(r[k].strip()) for r in text if r[k].strip()) and any(r[k].strip() for r in text)
             for k in range(len(columns))]
    style = [' class="number"' if r else "" for r in right]
    head = "".join(f"<th{s}>{escape(c)}</th>" for s, c in zip(style, columns))
    body = "".join("<tr>" + "".join(f"<td{s}>{c}</td>" for s, c in zip(style, row)) + "</tr>" for row in text)
    return f'<div class="scroll"><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'


def _json(data: Any) -> str:
    """JSON that may stand in a script element."""
    return json.dumps(data, separators=(",", ":"), ensure_ascii=False, allow_nan=False).replace("<", "\\u003c")


def figure(plot: Plot) -> str:
    """The place of a plot and its specification."""
    data = _json({"spec": plot.spec, "title": plot.title, "name": plot.name, "height": plot.height})
    return (f'<div class="figure" style="height:{plot.height}px" role="img" aria-label="{escape(plot.title)}">'
            f'<script type="application/json">{data}</script></div>')


def viewer(data: dict[str, Any]) -> str:
    """The place of a snapshot and its numbers."""
    return f'<div class="molecule"><script type="application/json">{_json(data)}</script></div>'


@cache
def _asset(name: str) -> bytes:
    return resources.files("asemd.page").joinpath("assets", name).read_bytes()


@cache
def _packed(name: str) -> str:
    return base64.b64encode(gzip.compress(_asset(name), 9, mtime=0)).decode("ascii")


def _body(parts: Sequence[Part]) -> tuple[str, list[tuple[str, str]]]:
    """The parts, and the sections among them: anchor and title."""
    out, sections = ['<div class="grid">'], []
    for part in parts:
        if part.kind == "section":
            anchor = f"section-{len(sections) + 1}"
            sections.append((anchor, part.title))
            out.append(f'</div><h2 id="{anchor}">{escape(part.title)}</h2><div class="grid">')
            continue
        if part.kind == "facts":
            out.append(f'<dl class="facts wide">{part.body}</dl>')
            continue
        title = f"<h3>{escape(part.title)}</h3>" if part.title else ""
        note = f'<p class="note">{escape(part.note)}</p>' if part.note else ""
        out.append(f'<section class="part {part.kind}{" wide" * part.wide}">{title}{part.body}{note}</section>')
    return "\n".join([*out, "</div>"]), sections


def render(title: str, subtitle: str, parts: Sequence[Part]) -> str:
    """The whole page."""
    body, sections = _body(parts)
    links = "".join(f'<a href="#{anchor}">{escape(name)}</a>' for anchor, name in sections)
    needed = [name for kind, names in LIBRARIES.items() if any(p.kind == kind for p in parts) for name in names]
    packed = "\n".join(f'<script type="application/gzip" data-library="{name}">{_packed(name)}</script>' for name in needed)
    licences = " ".join(_notice(name) for name in needed)
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<meta name="generator" content="asemd {__version__}">
<title>{escape(title)}</title>
<link rel="icon" href="data:,">
<style>{_asset("page.css").decode()}</style>
</head>
<body>
<header>
<div><h1>{escape(title)}</h1>{f"<p>{escape(subtitle)}</p>" if subtitle else ""}</div>
<button id="theme" type="button" aria-label="light or dark" title="light or dark"></button>
</header>
{f"<nav>{links}</nav>" if len(sections) > 1 else ""}
<main>
{body}
</main>
<footer>Made by asemd {__version__}. {licences}</footer>
<script type="application/json" id="themes">{_json(THEMES)}</script>
{packed}
<script>{_asset("page.js").decode()}</script>
</body>
</html>
"""


NOTICES = {"vega.min.js": "Plots by Vega 6.4.0", "vega-lite.min.js": "and Vega-Lite 6.4.3 (BSD-3-Clause, University of Washington).",
           "3Dmol-min.js": "Molecules by 3Dmol.js 2.5.5 (BSD-3-Clause, University of Pittsburgh)."}


def _notice(name: str) -> str:
    return NOTICES[name]
