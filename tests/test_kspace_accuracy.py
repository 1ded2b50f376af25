"""Errors of forces of solvers in water against an Ewald sum of ten digits: within what is asked for, and about what is expected."""
from __future__ import annotations

import math
import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from asemd.lammps import Lammps

UNIT = 332.06371        # force of two elementary charges 1 Angstrom apart, of which accuracies are parts


@cache
def water() -> tuple[str, ...]:
    """The script of 648 atoms of water up to its first run, without a solver; molecules are not held rigid."""
    with pytest.MonkeyPatch.context() as path:
        path.syspath_prepend(str(Path(__file__).resolve().parents[1]))
        from tests.benchmarks import scenes
    lines = scenes.water("1 1 1", 6).splitlines()
    return tuple(line for line in lines if line.split()[:1] not in (["kspace_style"], ["run"], ["minimize"]) and " shake " not in line)


def forces(folder, style: str, solver: str, modify: str = "") -> tuple[np.ndarray, float]:
    """Forces `(n, 3)`, and the error that the log expects."""
    log = folder / "log"
    lmp = Lammps(cmdargs=["-screen", "none", "-log", str(log)])
    for line in water():
        lmp.command(re.sub(r"^(pair_style \S*coul)/long", rf"\1/{style}", line))
    lmp.command(f"kspace_style {solver}")
    if modify:
        lmp.command(f"kspace_modify {modify}")
    lmp.command("run 0")
    f = np.array(lmp.gather_atoms("f", 1, 3)).reshape(-1, 3)
    lmp.close()
    return f, float(re.findall(r"estimated absolute RMS force accuracy = (\S+)", log.read_text())[-1])


@pytest.fixture(scope="module")
def exact(tmp_path_factory) -> np.ndarray:
    return forces(tmp_path_factory.mktemp("ewald"), "long", "ewald 1e-10")[0]


@pytest.mark.parametrize("style, solver, modify", [
    ("long", "ewald 1e-4", ""), ("long", "ewald 1e-6", ""), ("long", "pppm 1e-3", ""), ("long", "pppm 1e-4", ""), ("long", "pppm 1e-5", ""),
    ("long", "pppm 1e-6", ""), ("long", "pppm 1e-4", "diff ad"), ("long", "pppm 1e-4", "order 7"), ("long", "pppm/cg 1e-4", ""),
    ("long", "pppm/stagger 1e-4", ""), ("msm", "msm 1e-3", ""), ("msm", "msm 1e-4", "")])
def test_errors_of_forces(tmp_path, exact, style, solver, modify):
    f, expected = forces(tmp_path, style, solver, modify)
    error = math.sqrt(((f - exact) ** 2).sum(axis=1).mean())
    print(f"{solver} {modify}: {error:.3g} of {UNIT * float(solver.split()[1]):.3g} asked, {expected:.3g} expected")
    assert error < UNIT * float(solver.split()[1])
    # the estimate of msm, LAMMPS's too, takes the worst place of an atom between points of its grids
    assert expected / (10 if style == "msm" else 3) < error < 2 * expected
