"""asemd and real LAMMPS, which has a process of its own, for tests that compare them."""
from __future__ import annotations

import inspect

import pytest

from asemd.lammps import Lammps
from asemd.testing import oracle


def start(*switches: str) -> Lammps:
    """A new session without log and screen."""
    return Lammps(cmdargs=["-screen", "none", "-log", "none", *switches])


def ran(script, *switches):
    """A new session that has executed a script: text, or its lines."""
    lmp = start(*switches)
    (lmp.commands_string if isinstance(script, str) else lmp.commands_list)(script)
    return lmp


def ask(script: str, **given):
    """Run `script`, which finds `given`, LAMMPS's `start()` and `ran()`, and sets `answer`; skips the test where LAMMPS does not start."""
    if not oracle.lammps_available():
        pytest.skip(oracle.why_not())
    return oracle.ask(inspect.getsource(ran) + script, timeout=120, **given)
