"""The figures of benchmarks that are kept, and the tables that the README and ``docs/speed.md`` make of them."""
from __future__ import annotations

import json

from tests.benchmarks import compare
from tests.benchmarks.scenes import ROOT

FILE = ROOT / "docs" / "measured" / "benchmarks.json"
README, SPEED = ROOT / "README.md", ROOT / "docs" / "speed.md"


def keep(new: dict) -> None:
    """Add results to those that are kept (``{"sizes": ..., "cases": {...}}``: those of the same names are replaced), write the pages."""
    found = json.loads(FILE.read_text()) if FILE.exists() else {}
    for part, values in new.items():
        found[part] = {**found.get(part, {}), **values} if part != "sizes" else values
    found["machine"] = compare.machine()
    FILE.write_text(json.dumps(found, indent=1) + "\n")
    write(found)


def write(found: dict) -> None:
    """Put the tables between their marks."""
    from tests.benchmarks import cases, sizes
    tables = {}
    if "cases" in found:
        tables["cases"] = cases.table(found["cases"])
    if "other" in found:
        tables["other"] = ["```text", *(line for name, values in found["other"].items() for line in compare.lines(name, values)), "```"]
    if "sizes" in found:
        tables["sizes"] = sizes.table(found["sizes"])
    machine = "Machine: " + ", ".join(f"{k} {v}" for k, v in found["machine"].items()) + "."
    for path in (README, SPEED):
        text = path.read_text()
        for name, lines in tables.items():
            begin, end = f"<!-- benchmarks {name}: begin -->", f"<!-- benchmarks {name}: end -->"
            if begin in text:
                before, _, rest = text.partition(begin)
                text = before + "\n".join([begin, *lines, "", machine, end]) + rest.partition(end)[2]
        path.write_text(text)
