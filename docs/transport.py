"""The page of transport: ``python docs/transport.py FOLDER`` writes docs/transport.md from what the two workflows left in FOLDER.

``run.py`` of ``workflows/viscosity`` and of ``workflows/thermal_conductivity`` write folders of their names where they are started; FOLDER
is that place. Numbers are kept in docs/measured/transport.json, so that ``python docs/transport.py`` alone writes the page again.
"""
from __future__ import annotations

import datetime
import json
import math
import re
import shutil
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE), str(HERE.parent / "workflows" / "ensembles")]

from checks import machine  # noqa: E402

KEPT, PAGE = HERE / "measured" / "transport.json", HERE / "transport.md"
LOOP = re.compile(r"Loop time of (\S+) on \d+ procs for (\d+) steps with (\d+) atoms")
ROUTES = {"viscosity": {"sheared box": "shear", "exchange of momentum": "exchange", "cosine acceleration": "cosine",
                        "Green-Kubo": "green-kubo", "Einstein, same run": "green-kubo", "fix nvt/sllod (see README)": "sllod"},
          "thermal_conductivity": {"two Langevin layers": "langevin", "fix heat": "heat", "fix ehex": "ehex",
                                   "exchange of energy": "exchange", "Green-Kubo": "green-kubo"}}
ASIDE = ("Einstein, same run", "fix nvt/sllod (see README)")       # not in the mean: the same run once more, and what is known to be wrong
HEAD = """<!-- written by docs/transport.py; change the text there -->
# Viscosity and heat conductivity

Two workflows, [viscosity](../workflows/viscosity/README.md) and [thermal conductivity](../workflows/thermal_conductivity/README.md),
measure the transport coefficients of one Lennard-Jones liquid by routes that have nothing in common but the forces: equilibrium
fluctuations, a sheared box, an acceleration, exchanged momentum or energy, heated layers. Each route is a LAMMPS script. If they agree with
each other and with published values, then pressure, heat flux, correlations, and the fixes that drive and measure flows are right together.

State: density 0.6, temperature 1.35, `lj/cut 2.5`, timestep 0.005, as in LAMMPS's `examples/KAPPA`. Errors are standard errors over blocks.

```sh
python workflows/viscosity/run.py                   # {minutes[viscosity]} minutes below; --quick: seconds, to see it work
python workflows/thermal_conductivity/run.py        # {minutes[thermal_conductivity]} minutes
python docs/transport.py .                          # this page
```

Measured on {date}: {machine}. One thread; other work kept the machine busy.
"""
VISCOSITY = """
![viscosities, velocity profiles, Green-Kubo integral](images/viscosity.png)

{agree}

Two routes lie a little low for reasons of their own: the cosine measures at a finite wavelength, where the viscosity is about a percent
lower, and exchanged momentum heats the liquid between the layers, which gets thinner there; with twice the flux (`-var every 50`) the
viscosity comes out five percent too small. Published: M. Lautenschlaeger, H. Hasse, Fluid Phase Equilib. 482, 38 (2019), for the same
potential; G. Galliero, C. Boned, A. Baylaucq, Ind. Eng. Chem. Res. 44, 6963 (2005), for the full one; both are good to some percent.

`fix nvt/sllod` stands apart: its viscosity is too large by {sllod} %, and so is that of LAMMPS (22 Jul 2025), which gives 0.96 &pm;
0.02 with the same script; their trajectories are the same step for step. The reason is in the equations: velocities hold the flow
$u = \\dot\\gamma y$ already, so that an atom that moves along y loses $\\dot\\gamma p_y$ of its thermal velocity by itself; the fix takes
this term off once more, which adds about $\\rho k T$ times the relaxation time of the kinetic stress to the viscosity. The developers of
LAMMPS found that the dissipation of this integrator is not the work done (pull request 3582) and replaced it in later versions (pull
request 4781). Until asemd follows, shear as `in.shear` does: `fix deform ... remap v`, `fix nve`, and a thermostat whose temperature is
`compute temp/deform`. The first line of the table is that.
"""
CONDUCTIVITY = """
![conductivities, temperature profiles, Green-Kubo integral](images/thermal_conductivity.png)

{agree}

Published: the correlation of Lautenschlaeger and Hasse for the same potential; D. J. Evans, Phys. Rev. A 34, 1449 (1986), figure 1; the
README of LAMMPS's example finds 3.41, 3.39, 3.45 and 3.78 by its four scripts.
"""
END = """
## Observables

`tests/test_observables_mdanalysis.py` compares `compute msd`, `rdf`, `vacf`, the Green-Kubo integral of the latter and `fix ave/correlate`
with MDAnalysis and numpy on the dump of the same run: to round-off with numpy, to the single precision of its positions with MDAnalysis.
"""


def read(folder: Path) -> dict:
    """Values, errors, numbers of atoms, steps and seconds of one workflow."""
    rows, spent, published = [], {}, []
    values = json.loads((folder / "result.json").read_text())
    for line in (folder / "result.csv").read_text().splitlines()[1:]:
        method, value, error = line.rsplit(",", 2)
        if not error:
            published.append([method.strip('"'), float(value)])
    for method, route in ROUTES[folder.name].items():
        loops = LOOP.findall((folder / f"log.{route}").read_text())
        spent[route] = sum(float(seconds) for seconds, _, _ in loops)
        value, error = values[method]
        rows.append({"method": method, "value": value, "error": error, "atoms": int(loops[-1][2]), "steps": int(loops[-1][1])})
    return {"rows": rows, "published": published, "minutes": math.ceil(sum(spent.values()) / 60)}


def mean(rows: list[dict]) -> tuple[float, float]:
    """Mean weighted by errors, and its error."""
    weights = [1 / r["error"] ** 2 for r in rows]
    return sum(w * r["value"] for w, r in zip(weights, rows)) / sum(weights), sum(weights) ** -0.5


def agreement(part: dict) -> str:
    """How far independent routes are from their common mean, and this mean from what was published."""
    rows = [r for r in part["rows"] if r["method"] not in ASIDE]
    value, error = mean(rows)
    others = [(r, mean([o for o in rows if o is not r])) for r in rows]
    worst, row = max(((abs(r["value"] - v) / math.hypot(r["error"], e), r) for r, (v, e) in others), key=lambda pair: pair[0])
    away = ", ".join(f"{100 * (value / known - 1):+.1f} % from {name}" for name, known in part["published"])
    return (f"Mean of the {len(rows)} independent routes, weighted by their errors: {value:.3f} &pm; {error:.3f}; {away}.\n"
            f"The route farthest from the mean of the others is \"{row['method']}\", by {worst:.1f} standard errors.")


def table(part: dict, symbol: str) -> str:
    lines = [f"| method | {symbol} | atoms | steps |", "|---|---|---|---|"]
    lines += [f"| {r['method']} | {r['value']:.3f} &pm; {r['error']:.3f} | {r['atoms']} | {r['steps']} |" for r in part["rows"]]
    return "\n".join(lines + [f"| {name} | {value:.2f} | | |" for name, value in part["published"]]) + "\n"


def page(result: dict) -> str:
    eta, kappa = result["viscosity"], result["thermal_conductivity"]
    sllod = next(r["value"] for r in eta["rows"] if "sllod" in r["method"])
    right = mean([r for r in eta["rows"] if r["method"] not in ASIDE])[0]
    return "".join([
        HEAD.format(minutes={name: result[name]["minutes"] for name in ROUTES}, date=result["date"], machine=result["machine"]),
        "\n## Viscosity\n\n", table(eta, "$\\eta$"),
        VISCOSITY.replace("{agree}", agreement(eta)).replace("{sllod}", f"{100 * (sllod / right - 1):.0f}"),
        "\n## Heat conductivity\n\n", table(kappa, "$\\kappa$"), CONDUCTIVITY.replace("{agree}", agreement(kappa)), END])


def main(place: Path | None) -> None:
    if place is not None:
        result = {name: read(place / name) for name in ROUTES}
        day = datetime.date.fromtimestamp((place / "viscosity" / "result.json").stat().st_mtime)
        KEPT.write_text(json.dumps(result | {"date": day.isoformat(), "machine": machine()}, indent=1) + "\n")
        for name in ROUTES:
            shutil.copy(place / name / f"{name}.png", HERE / "images" / f"{name}.png")
    PAGE.write_text(page(json.loads(KEPT.read_text())))


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else None)
