"""Papers of the methods that a script uses: `asemd cite`. The papers are in ``references.csv``, each with the styles it belongs to."""
from __future__ import annotations

import csv
import os
import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from functools import cache
from pathlib import Path
from typing import Any

import asemd
from asemd import registry
from asemd.errors import InputError
from asemd.lammps import catalog
from asemd.lammps.dry import DrySession
from asemd.lammps.script import STYLED
from asemd.lammps.switches import Switches
from asemd.registry import plain_name
from asemd.tabulated import find_file
from asemd.text_table import Table

SAID = {"minimize": "min_style"}        # category of asemd -> its name in references.csv where they differ
LINE = 400      # characters of the first line of a potential file that are shown
SPECIAL = str.maketrans({"é": r"{\'e}", "í": r"{\'i}", "ó": r"{\'o}", "á": r"{\'a}", "ö": r'{\"o}', "ü": r'{\"u}', "ä": r'{\"a}',
                         "ø": r"{\o}", "Å": r"{\AA}"})


@dataclass(frozen=True)
class Paper:
    """One row of the table; `styles` are patterns of ``category:name``."""

    key: str
    authors: str
    journal: str
    volume: str
    page: str
    year: str
    doi: str
    styles: str

    def belongs_to(self, style: str) -> bool:
        """Whether it is cited for a style, ``category:name``."""
        return any(fnmatchcase(style, pattern) for pattern in self.styles.split())

    def __str__(self) -> str:
        where = ", ".join(part for part in (f"{self.journal} {self.volume}".strip(), self.page) if part)
        known = f"{self.authors.replace(' and others', ' et al.')}, {where} ({self.year})"
        return f"{known}, https://doi.org/{self.doi}" if self.doi else known

    def bibtex(self) -> str:
        """The entry for BibTeX; titles are where the DOI leads."""
        names = " and ".join(_last_first(a.strip()) for a in self.authors.replace(" and others", ", others").split(","))
        kind, where = ("article", "journal") if self.volume else ("inproceedings", "booktitle") if self.page else ("book", "title")
        fields = {"author": names, where: self.journal, "volume": self.volume, "pages": self.page.replace("-", "--"), "year": self.year,
                  "doi": self.doi}
        lines = [f"  {name} = {{{value if name == 'doi' else value.translate(SPECIAL)}}}," for name, value in fields.items() if value]
        return "\n".join([f"@{kind}{{{self.key},", *lines, "}"])


@dataclass
class Citations:
    """What to cite.

    Attributes
    ----------
    papers : dict of str to list of Paper
        By what they are for: ``asemd``, ``LAMMPS``, ``pair_style tersoff``, ``fix nvt`` ...
    files : dict of str to str
        Potential files and what their first lines say.
    without : list of str
        Styles in use for which the table has no paper.
    """

    papers: dict[str, list[Paper]] = field(default_factory=dict)
    files: dict[str, str] = field(default_factory=dict)
    without: list[str] = field(default_factory=list)

    def parts(self) -> list[Table | str]:
        """Tables and paragraphs, in order."""
        out: list[Table | str] = [f"asemd {asemd.__version__}, the program itself: name it with its version"]
        out += ["\n".join([what, *(f"  {paper}" for paper in papers)]) for what, papers in self.papers.items()]
        out += ["\n".join(["Potential files, by their first lines", *(f"  {name}: {line}" for name, line in self.files.items())])] \
            if self.files else []
        return [*out, *([f"Without a paper in asemd's table: {', '.join(self.without)}"] if self.without else [])]

    def bibtex(self) -> str:
        """Every paper once, the potential files as comments."""
        program = f"@software{{asemd,\n  title = {{asemd: LAMMPS input scripts as ASE objects}},\n  version = {{{asemd.__version__}}},\n}}"
        papers = {paper.key: paper for found in self.papers.values() for paper in found}
        notes = [f"% potential file {name}: {line}" for name, line in self.files.items()]
        return "\n\n".join([program, *(paper.bibtex() for paper in papers.values()), *notes])

    def to_dict(self) -> dict[str, Any]:
        """Everything, JSON-able."""
        return {"papers": {what: [vars(p) for p in papers] for what, papers in self.papers.items()}, "files": self.files,
                "without": self.without}


def _last_first(name: str) -> str:
    """A name for BibTeX, which would take the ``III`` at the end of one for the surname."""
    given, _, end = name.rpartition(" ")
    first, _, last = given.rpartition(" ")
    return f"{last}, {end}, {first}" if end in ("Jr.", "III") else name


@cache
def table() -> tuple[Paper, ...]:
    """All papers."""
    with open(Path(asemd.__file__).parent / "references.csv", newline="", encoding="utf-8") as f:
        return tuple(Paper(**row) for row in csv.DictReader(f, delimiter="|", quoting=csv.QUOTE_NONE))


class Noter(DrySession):
    """Goes through a whole script, runs nothing, and notes its styles and potential files."""

    def __init__(self, switches: Switches | None = None):
        super().__init__(switches)
        self.styles: dict[tuple[str, str], None] = {}
        self.named: dict[str, None] = {}

    def call(self, name: str, args) -> None:
        if name in STYLED and len(args) >= STYLED[name][1]:
            self._note(*_style(name, list(args)))
        elif name == "minimize":
            self._note(("minimize", self.scene.min_style))
        elif name == "run_style" and args:
            self._note(("run_style", args[0]))
        elif name == "kspace_modify" and "slab" in args:
            self._note(("kspace_modify", "slab"))
        elif name == "pair_coeff":
            self.named.update(dict.fromkeys(args))
        super().call(name, args)

    def _note(self, *found: tuple[str, str]) -> None:
        self.styles.update(dict.fromkeys((category, plain_name(style)) for category, style in found))


def _style(command: str, args: list[str]) -> list[tuple[str, str]]:
    """Category and name of the styles in a command; of a hybrid style those that it is made of."""
    category, at = STYLED[command]
    found = [(category, args[at - 1])]
    if category in catalog.FORCE_FIELD and args[0].startswith("hybrid"):
        found = [(category, w) for w in args[1:] if w[:1].isalpha() and catalog.exists(category, w)]
    if category == "fix" and "settle" in args:
        found.append((category, f"{args[2]}:settle"))
    return found


def cite(path: str | os.PathLike, switches: Switches | None = None, lammps: bool = False) -> Citations:
    """What a script should cite.

    Parameters
    ----------
    path : path
        A LAMMPS script; every command of it is read, no step is run.
    switches : Switches, optional
    lammps : bool
        Whether LAMMPS runs it.

    Returns
    -------
    Citations

    Raises
    ------
    InputError
        A mistake in the script.
    """
    session = Noter(switches)
    session.rehearse(path)
    if session.problems:
        raise session.problems[0]
    return of_styles(session.styles, session.named, lammps)


def of_styles(styles: Iterable[tuple[str, str]], words: Iterable[str] = (), lammps: bool = False) -> Citations:
    """The same of pairs (category, name), and words of ``pair_coeff`` among which file names are."""
    out = Citations()
    own = [p for p in table() if p.belongs_to("asemd")]
    out.papers["asemd rests on"] = own
    if lammps:
        out.papers["LAMMPS"] = [p for p in table() if p.belongs_to("lammps")]
    for category, name in styles:
        category = SAID.get(category, category)
        said = f"{category}_style {name}" if category in (*catalog.FORCE_FIELD, "kspace") else f"{category} {name.replace(':', ' ')}"
        found = [p for p in table() if p.belongs_to(f"{category}:{name}")]
        if found:
            out.papers[said] = found
        elif category in catalog.FORCE_FIELD and name not in catalog.WRAPPERS and name != "zero":
            out.without.append(said + _said_by_style(category, name))
    for word in words:
        if line := first_line(word):
            out.files[os.path.basename(word)] = line
    return out


def _said_by_style(category: str, name: str) -> str:
    """The source that the style itself names, if it is a paper."""
    try:
        see = registry.find(category, name).see
    except InputError:
        return ""
    return f" ({see})" if re.search(r"\(\d{4}\)", see or "") else ""


def first_line(name: str) -> str:
    """What the first line of a potential file says of itself; empty if it is no such file."""
    try:
        path = find_file(name, "cite")
        with open(path, encoding="utf-8", errors="replace") as f:
            line = f.readline(10 * LINE).strip().lstrip("#").strip()
    except (InputError, OSError):
        return ""
    return (line.partition("CITATION:")[2].strip() or line)[:LINE]
