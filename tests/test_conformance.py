"""LAMMPS's own force tests, from the folder that the environment variable ASEMD_CONFORMANCE names; skipped without it.

A case that passed before must pass: their names stand in ``conformance_passed.txt``, of which every sixth is run, all with ``-m slow``.
Those whose forces in LAMMPS are no gradients pass with ``-compat lammps``, which stands behind their names.
To record what passes now::

    ASEMD_CONFORMANCE=folder python tests/test_conformance.py
"""
from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
RECORD = HERE / "conformance_passed.txt"
CATEGORIES = "bond,angle,dihedral,improper,pair,kspace"
LIKE_LAMMPS = " -compat lammps"


def folder() -> Path | None:
    """The conformance folder; a relative path counts from the root of the repository."""
    name = os.environ.get("ASEMD_CONFORMANCE")
    if not name:
        return None
    path = Path(name)
    return path if path.is_absolute() else HERE.parent / path


def recorded() -> list[str]:
    lines = (line.partition("#")[0].strip() for line in RECORD.read_text().splitlines())
    return [line for line in lines if line]


def results(names: list[str] | None, switches: str = "") -> dict[str, dict]:
    """Run the cases of these names, or all of the open list; case -> its record."""
    where = folder()
    with tempfile.TemporaryDirectory() as tmp:
        cases, out = Path(tmp) / "cases.txt", Path(tmp) / "out.json"
        cases.write_text("\n".join(names) + "\n" if names is not None else (where / "open.txt").read_text())
        env = {**os.environ, "PYTHONPATH": os.pathsep.join([str(HERE.parent), os.environ.get("PYTHONPATH", "")])}
        command = [sys.executable, str(where / "conformance.py"), "--engine", "asemd", "--category", CATEGORIES, "--list", str(cases),
                   "--jobs", "2", "--nice", "0", "--json", str(out), *(["--engine-args", switches] if switches else [])]
        done = subprocess.run(command, env=env, capture_output=True, text=True, timeout=1500)
        assert out.exists(), done.stdout[-2000:] + done.stderr[-2000:]
        found = json.loads(out.read_text())
    found = found.get("results", found) if isinstance(found, dict) else found
    return {r["name"]: r for r in found} if isinstance(found, list) else found


def passed(record: dict) -> bool:
    return record.get("status_block") == "pass"


@pytest.mark.skipif(folder() is None, reason="ASEMD_CONFORMANCE names no folder")
@pytest.mark.parametrize("every", [6, pytest.param(1, marks=pytest.mark.slow)])
def test_what_passed_before_passes(every):
    failed = {}
    for switches in ("", LIKE_LAMMPS):
        names = [n.removesuffix(switches) for n in recorded()[::every] if n.endswith(LIKE_LAMMPS) == bool(switches)]
        now = results(names, switches)
        failed |= {n: now.get(n, {}).get("reason") or now.get(n, {}).get("status_block", "not run")
                   for n in names if not passed(now.get(n, {}))}
    assert not failed, failed


if __name__ == "__main__":
    good = [name for name, record in results(None).items() if passed(record)]
    good += [name + LIKE_LAMMPS for name, record in results(None, LIKE_LAMMPS).items() if passed(record) and name not in good]
    good.sort()
    RECORD.write_text("# cases that pass; written by `python tests/test_conformance.py`\n" + "\n".join(good) + "\n")
    print(f"{len(good)} cases pass, {RECORD.name} written")
