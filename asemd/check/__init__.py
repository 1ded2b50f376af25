"""Stability of a scene: ``asemd.check(scene)`` before a run, by experiment (`asemd.check.experiment`), and the battery of extreme cases.

The module can be called like the function `check`.
"""
from __future__ import annotations

import sys
from dataclasses import replace
from types import ModuleType
from typing import Any

from asemd.check.report import Report
from asemd.finding import Finding

OF_SETTINGS = ("damping", "r-RESPA", "time step", "units")     # checks of the later runs of a script, too: they ask for no positions
__all__ = ["Finding", "Report", "check"]


def check(source, *, run: bool = False, force: bool = False, dt: float | None = None, **options: Any) -> Report:
    """Look for what may make a run unstable, or its numbers wrong.

    Parameters
    ----------
    source : path, asemd.scene.Scene or ase.Atoms
        A script is executed up to its first run; atoms need `asemd.ForceField` as calculator. Nothing of it is changed.
    run : bool
        Short runs on copies besides: drift, reversibility, onset of instability.
    force : bool
        A timestep at which no integrator is stable is a warning, not an error.
    dt : float, optional
        Another timestep than the scene's, in its units (for atoms: of the force field).
    options
        Of `asemd.check.experiment.run`.

    Returns
    -------
    Report
        ``print`` shows it; ``report.ok``, ``report.findings``, ``report.to_dict()``.

    Raises
    ------
    InputError
        A mistake in the script, missing coefficients, atoms without a force field.
    """
    from asemd.check.case import case_of
    return of_case(case_of(source, force, dt), run, **options)


def of_case(case, run: bool = False, **options: Any) -> Report:
    """The report of a `asemd.check.case.Case`."""
    from asemd.check.static import DoesNotApply, all_checks
    report = Report(case.source)
    if not case.system.n:
        report.extend([Finding("note", "atoms in the box", "There are no atoms.")])
        return report
    for name, function in all_checks().items():
        try:
            report.extend(function(case))
        except DoesNotApply as why:
            report.left_out.append((name, str(why)))
        for other in case.later if name in OF_SETTINGS else ():
            other.force = case.force
            try:
                report.extend(replace(f, where=other.where) for f in function(other) if f.rank)
            except DoesNotApply:
                continue        # the first run says why
    if run:
        from asemd.check import experiment
        report.extend(experiment.run(case.scene, **{"dt": case.dt, "force": case.force, "relax": case.relaxes, **options}))
    return report


class _Callable(ModuleType):
    """``asemd.check`` is a package and, as users expect, a function."""

    def __call__(self, *args: Any, **options: Any) -> Report:
        return check(*args, **options)


_Callable.__call__.__doc__ = check.__doc__
sys.modules[__name__].__class__ = _Callable
