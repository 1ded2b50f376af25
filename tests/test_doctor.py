"""asemd doctor: facts about the installation."""
from __future__ import annotations

import json
import os

import pytest

import asemd
from asemd import cli, doctor
from asemd.kernels import generate
from asemd.testing import oracle


def test_command(capsys):
    assert cli.main(["doctor"]) == 0
    out = capsys.readouterr().out
    assert "kernel cache" in out and "vectors" in out and out.rstrip().endswith("All fine.")
    assert cli.main(["doctor", "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert facts["asemd"]["value"] == asemd.__version__ and facts["LAMMPS"]["ok"] == oracle.lammps_available()
    assert facts["kernel cache"]["value"].startswith(str(generate.cache_dir()))


def test_problems_have_advice(monkeypatch, capsys):
    monkeypatch.setattr(doctor, "REQUIRED", ("numpy", "no-such-package"))
    monkeypatch.setattr(doctor, "OPTIONAL", ("neither-this",))
    assert cli.main(["doctor"]) == 1
    out = capsys.readouterr().out
    assert "pip install no-such-package" in out and "pip install neither-this (optional)" in out
    assert out.rstrip().endswith("To be mended: no-such-package")


def test_switched_off_compiler(monkeypatch):
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    assert not doctor._compiler().ok


@pytest.mark.skipif(not os.path.exists("/proc/self"), reason="needs a place where no folder can be made")
def test_unwritable_cache(monkeypatch):
    monkeypatch.setenv("ASEMD_CACHE_DIR", "/proc/nothing")
    monkeypatch.setattr(generate, "_dir", None)
    fact = doctor._cache()
    assert not fact.ok and "ASEMD_CACHE_DIR is not writable" in fact.advice
