"""What the package physical_validation says of records: kinetic energies of one run, ratios of distributions of two."""
from __future__ import annotations

import contextlib
import io
import math
import os
import platform
import re
from pathlib import Path

import numpy as np
from dynamics import DYNAMICS, Run, inefficiency
from systems import LIQUIDS

from asemd import __version__, units

GROMACS = 6.022140857e-2        # physical_validation's factor between bar nm^3 and kJ/mol
SLOPE = re.compile(r"(\S+) +\+/- (\S+) +\| +(\S+)")
BLOCKS = 20
LIMIT = 3.5         # standard errors: of a hundred right numbers one is beyond it once in twenty tables


def simulation(run: Run, table: np.ndarray):
    """Rows of a run as physical_validation wants them."""
    import physical_validation as pv
    u, npt = units.get(LIQUIDS[run.liquid].units), "npt" in run.dynamics
    ours = pv.data.UnitData(kb=u.boltz, energy_conversion=1.0, length_conversion=1.0, volume_conversion=1.0, temperature_conversion=1.0,
                            pressure_conversion=1.0 / (GROMACS * u.nktv2p), time_conversion=1.0)
    atoms = LIQUIDS[run.liquid].atoms
    system = pv.data.SystemData(natoms=atoms, nconstraints=3 * atoms - run.freedom, ndof_reduction_tra=0, ndof_reduction_rot=0)
    where = {"pressure": run.pressure} if npt else {"volume": float(table[0, 2])}
    ensemble = pv.data.EnsembleData("NPT" if npt else "NVT", natoms=atoms, temperature=run.temperature, **where)
    seen = pv.data.ObservableData(potential_energy=table[:, 0], kinetic_energy=table[:, 1], volume=table[:, 2])
    return pv.data.SimulationData(units=ours, system=system, ensemble=ensemble, observables=seen)


def kinetic(run: Run, table: np.ndarray) -> dict:
    """The kinetic energies against the gamma distribution: temperatures by their mean and by their width, and how far off they are."""
    import physical_validation as pv
    table = table[::inefficiency(table[:, 1])]
    data, n, boltz = simulation(run, table), len(table), units.get(LIQUIDS[run.liquid].units).boltz
    options = {"verbosity": 0, "data_is_uncorrelated": True}
    off = pv.kinetic_energy.distribution(data, bootstrap_seed=1, **options)
    p = pv.kinetic_energy.distribution(data, strict=True, **options)
    mean, width = 2 * table[:, 1].mean() / (run.freedom * boltz), math.sqrt(2 / run.freedom) * table[:, 1].std(ddof=1) / boltz
    row = {"liquid": run.liquid, "dynamics": run.dynamics, "T": run.temperature, "freedom": run.freedom, "samples": n,
           "T of mean": mean, "error of mean": run.temperature * math.sqrt(2 / run.freedom / n), "T of width": width,
           "error of width": width / math.sqrt(2 * n), "off mean": float(off[0]), "off width": float(off[1]), "p": float(p)}
    return row | {"control": DYNAMICS[run.dynamics].control, "ok": bool(max(off) < LIMIT and p > 2e-4)}


def likelihood(first: np.ndarray, second: np.ndarray) -> float:
    """The slope of the logarithm of the ratio of two distributions by maximum likelihood: regression on which run a value comes from.

    As in physical_validation, values count where the distributions overlap.
    """
    low, high = max(first.min(), second.min()), min(first.max(), second.max())
    first, second = (v[(v >= low) & (v <= high)] for v in (first, second))
    x, y = np.concatenate([first, second]), np.repeat([0.0, 1.0], [len(first), len(second)])
    scale = x.std()
    rows, found = np.stack([np.ones(len(x)), (x - x.mean()) / scale]), np.zeros(2)
    for _ in range(50):
        p = 1 / (1 + np.exp(-found @ rows))
        step = np.linalg.solve(rows * (p * (1 - p)) @ rows.T, rows @ (y - p))
        found += step
        if abs(step).max() < 1e-9:
            break
    return float(found[1] / scale)


def jackknife(first: np.ndarray, second: np.ndarray) -> float:
    """Standard error of that slope: blocks in time left out one after the other, so that rows need not be independent."""
    variance = 0.0
    for mine, other, order in ((first, second, 1), (second, first, -1)):
        parts = np.array_split(mine, BLOCKS)
        left = [likelihood(*(np.concatenate(parts[:k] + parts[k + 1:]), other)[::order]) for k in range(BLOCKS)]
        variance += (BLOCKS - 1) * np.var(left)
    return math.sqrt(variance)


def ratio(first: Run, second: Run, tables) -> list[dict]:
    """The logarithm of the ratio of two distributions against its slope in energy, enthalpy or volume."""
    import physical_validation as pv
    npt, load, text = "npt" in first.dynamics, first.dense != second.dense, io.StringIO()
    with contextlib.redirect_stdout(text):
        pv.ensemble.check(simulation(first, tables[0]), simulation(second, tables[1]), verbosity=1, data_is_uncorrelated=True)
    slope, _, true = (float(v) for v in SLOPE.findall(text.getvalue())[0])
    weight = first.pressure / units.get(LIQUIDS[first.liquid].units).nktv2p if npt else 0.0
    values = [t[:, 2] if load else t[:, 0] + weight * t[:, 2] for t in tables]
    error = jackknife(*values) / abs(true)
    off = abs(slope / true - 1) / error
    return [{"liquid": first.liquid, "dynamics": first.dynamics, "quantity": "volume" if load else "enthalpy" if npt else "energy",
             "records": min(map(len, tables)), "samples": min(len(x) // inefficiency(x) for x in values), "slope": slope / true,
             "error": error, "off": off, "control": DYNAMICS[first.dynamics].control, "ok": bool(off < LIMIT)}]


def machine() -> str:
    """The machine in words."""
    info, model = Path("/proc/cpuinfo"), platform.processor() or platform.machine()
    if info.exists():
        model = next((line.split(":")[1].strip() for line in info.read_text().splitlines() if line.startswith("model name")), model)
    return f"{model}, {os.cpu_count()} cores, {platform.system()}, Python {platform.python_version()}, asemd {__version__}"
