"""The figures of benchmarks that are kept, and the tables that the README and ``docs/speed.md`` make of them."""
from __future__ import annotations

import json

from tests.benchmarks import compare
from tests.benchmarks.scenes import ROOT

FILE = ROOT / "docs" / "measured" / "benchmarks.json"
README, SPEED = ROOT / "README.md", ROOT / "docs" / "speed.md"


def keep(new: dict) -> None:
    """Add results of this machine to those that are kept (``{"sizes": ..., "cases": {...}}``: those of the same names are replaced), and
    write the pages."""
    machine = compare.machine()
    found = json.loads(FILE.read_text()) if FILE.exists() else {}
    name = f"{machine['cpu']}, {machine['vectors']}"
    here = found.pop(name, {})
    for part, values in new.items():
        here[part] = {**here.get(part, {}), **values} if part != "sizes" else values
    here["machine"] = machine
    found = {name: here, **found}
    FILE.write_text(json.dumps(found, indent=1) + "\n")
    write(found)


def write(found: dict) -> None:
    """Put the tables between their marks: of all machines, the last one that was measured first; the README has its tables only."""
    first = next(iter(found))
    for path, machines in ((README, {first: found[first]}), (SPEED, found)):
        text = path.read_text()
        for part in ("cases", "sizes", "other"):
            begin, end = f"<!-- benchmarks {part}: begin -->", f"<!-- benchmarks {part}: end -->"
            lines = [line for here in machines.values() if part in here for line in ("", *table(part, here))]
            if begin in text and lines:
                before, _, rest = text.partition(begin)
                text = before + "\n".join([begin, *lines[1:], end]) + rest.partition(end)[2]
        path.write_text(text)


def table(part: str, here: dict) -> list[str]:
    """Of one machine."""
    from tests.benchmarks import cases, sizes
    if part == "other":
        lines = ["```text", *(line for name, values in here["other"].items() for line in compare.lines(name, values)), "```"]
    else:
        lines = {"cases": cases, "sizes": sizes}[part].table(here[part])
    return [*lines, "", "Machine: " + ", ".join(f"{k} {v}" for k, v in here["machine"].items()) + "."]
