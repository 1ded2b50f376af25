"""Error against run time: what a scene's settings cost, and what they are worth: ``asemd.report(scene)``.

The module can be called like the function `report`. What it is made of: `asemd.report.nve` (short runs), `asemd.report.knob` (settings to
turn; styles and fixes may bring their own), `asemd.report.result` (all numbers).
"""
from __future__ import annotations

import sys
from types import ModuleType
from typing import Any

__all__ = ["report"]


def report(source, budget: float = 60.0, *, at: int | None = None, folder=None, apply=None, only=None, seed: int = 1,
           tolerance: float = 1e-5, lammps: bool = True, switches=None, tell=None):
    """Measure error and run time of a scene over the settings that trade one for the other.

    Parameters
    ----------
    source : path, asemd.scene.Scene or ase.Atoms
        A script is executed up to its last run, earlier runs cut to 1000 steps, without log, dumps and shell; atoms need
        `asemd.ForceField` as calculator. Nothing of it is changed.
    budget : float
        Wall time in seconds, compilation not counted.
    at : int, optional
        The run of the script to measure at, from 1, instead of the last one.
    folder : path, optional
        Where to write ``report.md``, ``.html``, ``.csv``, ``.json`` and the plots; by default nothing is written.
    apply : path, optional
        A script to write, with the recommended settings.
    only : sequence of str, optional
        Names of the knobs to turn; by default all.
    seed : int
        Of velocities that the scene does not have, and of directions in which derivatives are taken.
    tolerance : float
        Relative force error that counts as none.
    lammps : bool
        Compare with real LAMMPS where it is installed.
    switches : asemd.lammps.switches.Switches, optional
        LAMMPS's command line switches, for a script.
    tell : callable, optional
        ``tell(done, total, what)`` is told how far it is, in seconds.

    Returns
    -------
    asemd.report.result.Report
        ``print`` shows it; after Ctrl-C with what was measured until then, and ``interrupted`` set.

    Raises
    ------
    InputError
        A mistake in the script, missing coefficients, atoms without a force field, a budget below one second.

    Examples
    --------
    >>> found = asemd.report("in.melt", budget=30)
    >>> found.recommendation, found.curve("timestep").exponent
    """
    from asemd.report.course import carry_out
    return carry_out(source, budget, at, folder, apply, only, seed, tolerance, lammps, switches, tell)


class _Callable(ModuleType):
    """``asemd.report`` is a package and, as users expect, a function."""

    def __call__(self, *args: Any, **options: Any):
        return report(*args, **options)


_Callable.__call__.__doc__ = report.__doc__
sys.modules[__name__].__class__ = _Callable
