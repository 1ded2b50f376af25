"""Write docs/styles.md and docs/coverage.md from the registry: ``python docs/generate.py``; with ``--check`` only compare.

Nothing in the two pages is written by hand: the text of a style is the docstring of its file, its syntax comes from its parameters.
"""
from __future__ import annotations

import argparse
import importlib
import inspect
import re
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

from asemd import style  # noqa: E402
from asemd.lammps import catalog  # noqa: E402

FORCE_FIELD = ("bond", "angle", "dihedral", "improper", "pair")
OTHERS = ("fix", "compute", "dump", "region", "minimize")
NOTE = "<!-- written by docs/generate.py; change the docstrings instead -->\n"


def markdown(text: str) -> str:
    """A docstring as Markdown: its mathematics and code in the spelling of this format."""
    text = inspect.cleandoc(text)
    text = re.sub(r"\.\. math::(?P<m>(?: .*)?(?:\n(?: +.*|(?=\n)))*)", lambda m: "$$\n" + inspect.cleandoc(m["m"]).strip() + "\n$$\n", text)
    text = re.sub(r":math:`([^`]*)`", r"$\1$", text)
    text = re.sub(r"^References\n-+$", "References:\n", text, flags=re.M)
    text = re.sub(r"^\.\. \[(\d+)\] ", r"- [\1] ", text, flags=re.M)
    text = re.sub(r"\[(\d+)\]_", r"[\1]", text)
    text = re.sub(r"::\n\n((?:    .*\n?|\n)+)", lambda m: ":\n\n```text\n" + inspect.cleandoc(m[1]) + "\n```\n", text)
    return text.replace("``", "`")


def words(parameters) -> str:
    return " ".join(f"[{p.name}]" if p.optional else p.name for p in parameters)


def units_of(parameters) -> str:
    """`K` (energy/distance^2), ..."""
    known = {"angle": "degrees", "integer": "whole number", "word": "word", "path": "file", "": "number"}
    return ", ".join(f"`{p.name}` ({known.get(p.unit, p.unit)})" for p in parameters)


def force_field_style(s: style.Style) -> list[str]:
    """The page of one bonded or pair style."""
    category = s.category
    module = sys.modules[style.module_of(category, s.name)]
    out = [f"### {category} {s.name}", "", markdown(s.doc or inspect.getdoc(module) or ""), ""]
    many = getattr(s, "many", False) and s.elements
    keys = "* * " if many else "i j " if category == "pair" else "type "
    syntax = [f"{category}_style {s.name} {words(s.settings)}".rstrip()]
    if s.coeff:
        syntax.append(f"{category}_coeff {keys}{words(s.coeff)}{' ...' * many}")
    out += ["```lammps", *syntax, "```", ""]
    if s.settings or s.coeff:
        out += [units_of([*s.settings, *s.coeff]) + ".", ""]
    if s.domain:
        out += [f"Domain: {s.domain}.", ""]
    if s.example:
        types = "* *" if many else "1 1" if category == "pair" else "1"
        lines = [f"{category}_style {s.name} {s.settings_example}".rstrip(), f"{category}_coeff {types} {s.example}"]
        out += ["Example:", "", "```lammps", *lines, "```", ""]
    if s.see and s.see not in s.doc:
        out += [f"Source: {s.see}.", ""]
    for reason in dict.fromkeys(s.xfail.values()):
        checks = ", ".join(f"`{c}`" for c, r in s.xfail.items() if r == reason)
        out += [f"Not checked by {checks}: {reason}.", ""]
    return out


def styles_page() -> str:
    """Every style with its formula, syntax and units."""
    out = ["# Styles", NOTE, "Names, words and units are LAMMPS's. Words in brackets may be left out.", ""]
    for category in FORCE_FIELD:
        out += [f"## {category}_style", ""]
        if category == "pair":
            out += ["Some pair styles have a page with measured agreement and error against time; measuring one takes minutes. Energies of",
                    "every two-body style, `fix adapt`, `compute pair` and `pair_write` of it are compared with LAMMPS by the tests.", ""]
        for name in catalog.names(category):
            if name in catalog.WRAPPERS or name.startswith("hybrid/"):
                module = importlib.import_module(style.module_of(category, name))
                out += [f"### {category} {name}", "", markdown(inspect.getdoc(module) or ""), ""]
            else:
                out += force_field_style(style.find(category, name))
    for category in OTHERS:
        out += [f"## {'min_style' if category == 'minimize' else category}", ""]
        for name in catalog.names(category):
            module = importlib.import_module(style.module_of(category, name))
            out += [f"### {category if category != 'minimize' else 'min_style'} {name}", "", markdown(inspect.getdoc(module) or ""), ""]
    return re.sub(r"\n{3,}", "\n\n", "\n".join(out)).rstrip() + "\n"


def coverage_page() -> str:
    """Every name of LAMMPS's manual: done, partial or missing."""
    from asemd.lammps.coverage import coverage
    by_category: dict[str, list] = {}
    for entry in coverage():
        by_category.setdefault(entry.category, []).append(entry)
    out = ["# Coverage", NOTE, "Every name of the manuals of LAMMPS (22 July 2025) and LIGGGHTS; `asemd styles` prints the same.", "",
           "| category | done | partial | missing |", "|---|---|---|---|"]
    for category, entries in by_category.items():
        count = {state: sum(e.state == state for e in entries) for state in ("done", "partial", "missing")}
        out.append(f"| [{category}](#{category}) | {count['done']} | {count['partial']} | {count['missing']} |")
    for category, entries in by_category.items():
        out += ["", f"## {category}", ""]
        for state in ("done", "partial", "missing", "extra"):
            chosen = [e for e in entries if e.state == state]
            if chosen and state == "partial":
                out += ["Partial:", "", *(f"- `{e.style}`: {e.note}" for e in chosen), ""]
            elif chosen:
                title = {"done": "Done", "missing": "Missing", "extra": "Beyond the list"}[state]
                out += [f"{title}: " + ", ".join(f"`{e.style}`" for e in chosen) + ".", ""]
    return re.sub(r"\n{3,}", "\n\n", "\n".join(out)).rstrip() + "\n"


PAGES = {"styles.md": styles_page, "coverage.md": coverage_page}


def main() -> int:
    p = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    p.add_argument("--check", action="store_true", help="write nothing; status 1 if a page is out of date")
    check = p.parse_args().check
    stale = []
    for name, page in PAGES.items():
        text, path = page(), HERE / name
        if not path.exists() or path.read_text() != text:
            stale.append(name)
            if not check:
                path.write_text(text)
    if check and stale:
        print(f"out of date: {', '.join(stale)}; run python docs/generate.py")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
