"""Thermo rows and timings out of what LAMMPS prints, line by line."""
from __future__ import annotations

import re

from asemd.lammps.record import Run
from asemd.thermo import KEYWORDS

WORDS = {keyword.column: word for word, keyword in KEYWORDS.items()}
LOOP = re.compile(r"Loop time of (\S+) on (\d+) procs? for (\d+) steps with (\d+) atoms")
FACTS = {"unit style": ("units", str), "current step": ("begin", int), "time step": ("dt", float)}
MULTI = re.compile(r"-+ Step\s+(\d+) -+ CPU =\s*(\S+)")
PAIR = re.compile(r"(\S+)\s*=\s*(\S+)")
AFTER = {"Neighbor list builds = ": "builds", "Dangerous builds = ": "dangerous"}


class Output:
    """Reads the text of a LAMMPS process as it comes.

    Attributes
    ----------
    runs : list of asemd.lammps.record.Run
        Each run or minimisation with its thermo columns and rows, as many digits as were printed. Whether energies are per atom is not in
        the text: `normalised` is what the unit style means; what the text does not tell (`conserved`, `leaks`) is empty.
    step : int or None
        Of the last row.
    """

    def __init__(self) -> None:
        self.runs: list[Run] = []
        self.step: int | None = None
        self._kind, self._facts = "run", {"units": "lj", "begin": 0, "dt": 0.0}
        self._expects = self._running = False
        self._form = ""
        self._block: dict[str, float] = {}

    def feed(self, line: str) -> str:
        """Take one line; returns ``"row"``, ``"start"``, ``"end"`` or an empty string, what it was."""
        text = line.strip()
        if text.startswith("Setting up ") and text.endswith(" ..."):
            self._kind = "minimize" if "minimization" in text else "run"
        elif (fact := text.partition(":")[0].strip().lower()) in FACTS and not self._running:
            name, convert = FACTS[fact]
            self._facts[name] = convert(text.partition(":")[2].split()[0])
        elif text.startswith("Per MPI rank memory"):
            self._expects = True
        elif found := LOOP.match(text):
            return self._end(found)
        elif self._running:
            return self._row(text)
        elif self._is_heading(text):
            return self._start(text)
        elif self.runs:
            self._after(text)
        return ""

    def _is_heading(self, text: str) -> bool:
        if not text or text.startswith("WARNING"):
            return False
        return self._expects or (text.split()[0] == "Step" and len(text.split()) > 1) or bool(MULTI.match(text))

    def _start(self, text: str) -> str:
        self._form = "yaml" if text.startswith(("---", "keywords:")) and not MULTI.match(text) else "multi" if MULTI.match(text) else "one"
        self._expects, self._running = False, True
        f = self._facts
        self.runs.append(Run(self._kind, [], [], f["begin"], f["dt"], 0, f["units"] == "lj", f["units"]))
        if self._form == "one":
            self._columns(text.split())
        else:
            self._row(text)
        return "start"

    def _columns(self, titles: list[str]) -> None:
        self.runs[-1].titles, self.runs[-1].keywords = titles, [WORDS.get(t, t) for t in titles]

    def _row(self, text: str) -> str:
        run = self.runs[-1]
        if self._form == "multi":
            return self._lines(text)
        if self._form == "yaml":
            if text.startswith("keywords:"):
                self._columns(re.findall(r"'([^']*)'", text))
            if not text.startswith("- ["):
                return ""
            words = [w.strip() for w in text[3:].rstrip("] ").split(",") if w.strip()]
        else:
            words = text.split()
        if len(words) != len(run.titles):
            return ""
        try:
            run.rows.append([float(w) for w in words])
        except ValueError:
            return ""
        return self._told(run)

    def _lines(self, text: str) -> str:
        """``thermo_style multi``: a row is a block of lines."""
        if found := MULTI.match(text):
            self._flush()
            self._block = {"Step": float(found[1]), "CPU": float(found[2])}
            self.step = int(found[1])
            return "row"
        for title, value in PAIR.findall(text) if self._block else ():
            try:
                self._block[title] = float(value)
            except ValueError:
                return ""       # text of the script in between
        return ""

    def _flush(self) -> None:
        if self._block:
            run = self.runs[-1]
            if not run.titles:
                self._columns(list(self._block))
            run.rows.append([self._block.get(t, float("nan")) for t in run.titles])
        self._block = {}

    def _told(self, run: Run) -> str:
        if "Step" in run.titles:
            self.step = int(run.rows[-1][run.titles.index("Step")])
        return "row"

    def _end(self, found: re.Match) -> str:
        self._flush()
        self._running = False
        if self.runs:
            run = self.runs[-1]
            run.seconds, run.steps, run.atoms = float(found[1]), int(found[3]), int(found[4])
            self._facts["begin"] = run.begin + run.steps
        return "end"

    def _after(self, text: str) -> None:
        run = self.runs[-1]
        for start, name in AFTER.items():
            if text.startswith(start):
                setattr(run, name, int(text.removeprefix(start)))
        cells = [c.strip() for c in text.split("|")]
        if len(cells) >= 6 and re.fullmatch(r"[A-Z]\w+", cells[0]) and cells[0] != "Section":
            try:
                run.timings[cells[0]] = float(cells[2])
            except ValueError:
                return
