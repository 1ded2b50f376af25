"""Pictures of the records: kinetic energies with the gamma distribution, logarithms of ratios with the slope that they must have."""
from __future__ import annotations

from pathlib import Path

import numpy as np
from dynamics import inefficiency
from scipy import stats
from systems import LIQUIDS

from asemd import units


def panels(count: int, most: int = 4):
    """A figure of small panels, those that are not needed taken out."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    width = min(count, most)
    rows = -(-count // width)
    figure, axes = plt.subplots(rows, width, figsize=(3.1 * width, 2.5 * rows), layout="constrained", squeeze=False)
    for a in axes.flat[count:]:
        a.remove()
    for a in axes.flat[:count]:
        a.tick_params(labelsize=7)
        a.xaxis.set_major_locator(plt.MaxNLocator(4))
    return figure, axes.flat


def kinetic(runs, path: Path) -> None:
    """Histograms of kinetic energies in units of their mean, and the distribution of as many degrees of freedom."""
    figure, axes = panels(len(runs))
    for (run, table), a in zip(runs, axes):
        half_kt = 0.5 * run.temperature * units.get(LIQUIDS[run.liquid].units).boltz
        x = table[::inefficiency(table[:, 1]), 1] / (run.freedom * half_kt)
        wanted = stats.gamma(run.freedom / 2, scale=2 / run.freedom)
        edge = np.linspace(*wanted.ppf([1e-4, 1 - 1e-4]), 25)
        a.hist(x, edge, density=True, color="#9ecae1")
        fine = np.linspace(edge[0], edge[-1], 200)
        a.plot(fine, wanted.pdf(fine), color="#d62728", lw=1.2)
        a.set_title(f"{run.liquid}, {run.dynamics}, T = {run.temperature:g}", fontsize=8)
        a.set_yticks([])
    figure.supxlabel("kinetic energy / mean of the ensemble", fontsize=9)
    figure.savefig(path, dpi=90)


def ratios(pairs, path: Path, bins: int = 16) -> None:
    """Logarithms of ratios of histograms in energy, enthalpy or volume."""
    figure, axes = panels(len(pairs))
    for ((one, two), tables), a in zip(pairs, axes):
        u, pressed = units.get(LIQUIDS[one.liquid].units), one.dense != two.dense
        beta = [1 / (u.boltz * r.temperature) for r in (one, two)]
        if pressed:
            x, slope, name = [t[:, 2] for t in tables], beta[0] * (one.pressure - two.pressure) / u.nktv2p, "volume"
        else:
            load = one.pressure / u.nktv2p if "npt" in one.dynamics else 0.0
            x, slope, name = [t[:, 0] + load * t[:, 2] for t in tables], beta[0] - beta[1], "enthalpy" if load else "energy"
        g = [max(inefficiency(t[:, 0]), inefficiency(c)) for t, c in zip(tables, x)]
        edge = np.linspace(max(c.min() for c in x), min(c.max() for c in x), bins + 1)
        count = np.array([np.histogram(c, edge)[0] for c in x], float)
        good = (count > 4 * np.array(g)[:, None]).all(axis=0)
        middle, n = ((edge[1:] + edge[:-1]) / 2)[good], count[:, good]
        y, error = np.log(n[1] / len(x[1]) / (n[0] / len(x[0]))), np.sqrt((np.array(g)[:, None] / n).sum(axis=0))
        a.errorbar(middle, y, error, fmt="o", ms=3, lw=1, color="#3182bd")
        a.plot(middle, np.average(y, weights=error**-2) + slope * (middle - np.average(middle, weights=error**-2)), color="#d62728", lw=1.2)
        a.set_title(f"{one.liquid}, {one.dynamics}", fontsize=8)
        real = LIQUIDS[one.liquid].units == "real"
        unit = ("Angstrom$^3$" if pressed else "kcal/mol") if real else ("$\\sigma^3$" if pressed else "$\\epsilon$")
        a.set_xlabel(f"{name} / {unit}", fontsize=7)
    figure.supylabel("ln of the ratio", fontsize=9)
    figure.savefig(path, dpi=90)
