"""The page of the ensembles: ``python docs/ensembles.py FOLDER`` writes docs/ensembles.md from what ``workflows/ensembles`` left in FOLDER.

The folder is that of ``run.py``; results of ``splitting.py`` are expected in it too. Numbers are kept in docs/measured/ensembles.json, so
that ``python docs/ensembles.py`` alone writes the page again.
"""
from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
KEPT, PAGE, PICTURES = HERE / "measured" / "ensembles.json", HERE / "ensembles.md", ("kinetic", "ratios", "splitting")
HEAD = """<!-- written by docs/ensembles.py; change the text there -->
# Ensembles

Does a thermostat or barostat give the distribution of its ensemble, not only the right mean? Two properties decide it without a reference
simulation. Kinetic energies follow a gamma distribution that is fixed by the temperature and the number of degrees of freedom. And two
runs of one system at two temperatures, or two pressures, have distributions whose ratio is an exponential with a known exponent: for
energies at constant volume

$$\\ln \\frac{P_2(U)}{P_1(U)} = (\\beta_1 - \\beta_2)\\, U + \\text{const},$$

for the enthalpy $U + P V$ at constant pressure the same, and for volumes at two pressures the slope $\\beta\\, (P_1 - P_2)$. The package
[physical_validation](https://physical-validation.readthedocs.io) (P. T. Merz, M. R. Shirts, PLOS ONE 13, e0202764 (2018)) makes these
tests; `workflows/ensembles` runs the systems:

```sh
pip install asemd[test]
python workflows/ensembles/run.py --quick        # seconds
python workflows/ensembles/run.py                # three quarters of an hour of processor time
python workflows/ensembles/splitting.py
pytest -m slow tests/test_ensembles.py           # the full run as a test
```

The systems are small, so that fluctuations are large and a degree of freedom that is counted wrongly is seen: 256 Lennard-Jones atoms
(density 0.7, cut and shifted at 2.5), a melt of 18 Kremer-Grest chains of 12 beads, 125 molecules of flexible (SPC/Fw) and of rigid water
(SPC/E, timestep 2 fs). Water has no long-range part here: charges are switched off smoothly at 5.5 Angstrom, which defines another liquid,
but one with an energy whose gradient acts; a plain cutoff would jump, and no dynamics samples a distribution of jumps. Kinetic energies
are thinned until their block means scatter like those of independent ones. The ratios use every record; their errors are jackknife ones
over twenty blocks in time of each run. *off* counts standard errors; up to {limit} is called ok.

Bonds of flexible water swing so fast that they exchange energy with the other motions only within some 200 ps: started from a lattice
under `fix nvt`, oxygen stays 40 K too hot and the bonds too cold for long, in LAMMPS as in asemd, and energies drift at a constant
temperature. Its runs are therefore made of twenty parts that begin with `fix langevin`, which acts on all motions at once; records come
from `nvt` or `npt` alone.
"""
KINETIC = """
## Kinetic energy

Temperatures as the mean and as the width of the kinetic energies show them; *p* belongs to the Kolmogorov-Smirnov test of the whole
distribution. Total momentum stays zero in nvt, npt and temp/csvr, which leaves three degrees of freedom out; in langevin, gjf and baoab it
does not. `temp/csld` gives the kinetic energy of three degrees less to all of them. Rigid molecules have six.
`temp/berendsen` is the control: its mean is right, its width is not, and has to be found.

`fix rigid/nvt/small` holds the temperature of the velocities between two steps, with 750 degrees of freedom (as in LAMMPS). At 2 fs the
temperature on the steps is below that by 0.9 % for rotations and 0.1 % for translations, and the three degrees of the total momentum stay
empty: together the temperature that is seen is 0.15 % low.

| system | dynamics | T | degrees | samples | T of the mean | T of the width | off (mean, width) | p | |
|---|---|---|---|---|---|---|---|---|---|
"""
RATIOS = """
![kinetic energies](images/ensembles-kinetic.png)

## Ratios of distributions

The slope found by maximum likelihood in units of the true one: in energy at two temperatures; at constant pressure in enthalpy at two
temperatures and in volume at two pressures. The control has to be found.

| system | dynamics | quantity | records | slope / true slope | off | |
|---|---|---|---|---|---|---|
"""
SPLITTING = """
![ratios](images/ensembles-ratios.png)

The lines have the true slope; only their height is fitted. Over all ratios but the control the squares of *off* add up to {squares}, where
{count} are expected. Flexible water at constant pressure is the weakest of them: 50 ps hold few independent energies and volumes.

## Langevin dynamics at large friction

Temperatures of positions and of velocities in units of the bath's. Oscillators: 3000 with $\\omega \\Delta t = 0.1$, positions by
$k \\langle x^2 \\rangle$. Liquid: 256 repulsive spheres at density 0.8 with $\\Delta t = 0.005$, positions by the configurational
temperature $\\langle (\\nabla U)^2 \\rangle / \\langle \\nabla^2 U \\rangle$. Wanted of `fix baoab` and `fix gjf` (half-step velocities),
up to $\\gamma \\Delta t = 2$: positions within 2 %, velocities within 1 %. Plain `fix langevin` is there for comparison; it is not stable
at 2. The band of the picture is 2 %. Standard errors are 0.2 % for the oscillators, 0.6 % for positions in the liquid.

| system | fix | gamma dt | positions | velocities | |
|---|---|---|---|---|---|
"""


def verdict(row: dict) -> str:
    if row["control"]:
        return "control: not seen" if row["ok"] else "control: found"
    return "ok" if row["ok"] else "**off**"


def page(result: dict) -> str:
    out = [HEAD.replace("{limit}", f"{result['limit']:g}"), f"\nMeasured on {result['date']}: {result['machine']}.\n", KINETIC]
    for r in result["kinetic"]:
        out.append(f"| {r['liquid']} | {r['dynamics']} | {r['T']:g} | {r['freedom']} | {r['samples']} | {r['T of mean']:#.4g} "
                   f"&pm; {r['error of mean']:.2g} | {r['T of width']:#.3g} &pm; {r['error of width']:.2g} | {r['off mean']:.1f}, "
                   f"{r['off width']:.1f} | {r['p']:.2g} | {verdict(r)} |\n")
    if result["missing"]:
        out.append(f"\nNot in this run: {', '.join(result['missing'])}.\n")
    out.append(RATIOS)
    for r in result["ratios"]:
        out.append(f"| {r['liquid']} | {r['dynamics']} | {r['quantity']} | {r['records']} | {r['slope']:.3f} &pm; {r['error']:.3f} | "
                   f"{r['off']:.1f} | {verdict(r)} |\n")
    off = [r["off"] for r in result["ratios"] if not r["control"]]
    out.append(SPLITTING.replace("{squares}", f"{sum(o * o for o in off):.0f}").replace("{count}", str(len(off))))
    for r in result["splitting"]:
        good = abs(r["positions"] - 1) < 0.02 and abs(r["velocities"] - 1) < 0.01
        out.append(f"| {r['system']} | {r['scheme']} | {r['gamma dt']:g} | {r['positions']:.3f} | {r['velocities']:.3f} | "
                   f"{'ok' if good else 'off' if r['scheme'] == 'langevin' else '**off**'} |\n")
    return "".join(out) + "\n![temperatures at large friction](images/ensembles-splitting.png)\n"


def main(folder: Path | None) -> None:
    if folder is not None:
        result = json.loads((folder / "result.json").read_text()) | {"splitting": json.loads((folder / "splitting.json").read_text())}
        KEPT.write_text(json.dumps(result, indent=1) + "\n")
        for name in PICTURES:
            shutil.copy(folder / f"{name}.png", HERE / "images" / f"ensembles-{name}.png")
    PAGE.write_text(page(json.loads(KEPT.read_text())))


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else None)
