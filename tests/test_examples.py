"""What every command of `asemd` makes of LAMMPS's own examples, from the folder that ASEMD_CONFORMANCE names; skipped without it."""
from __future__ import annotations

import shutil

import pytest
from test_conformance import folder

from asemd import cli
from asemd.testing import oracle

EXAMPLES = folder() / "files" / "examples" if folder() else None
SCRIPTS = sorted(str(p.relative_to(EXAMPLES)) for p in EXAMPLES.rglob("in.*")) if EXAMPLES and EXAMPLES.is_dir() else []


@pytest.fixture
def script(request, tmp_path, monkeypatch):
    path = EXAMPLES / request.param
    shutil.copytree(path.parent, tmp_path / "example")
    monkeypatch.chdir(tmp_path / "example")
    return path.name


@pytest.mark.skipif(not SCRIPTS, reason="ASEMD_CONFORMANCE names no folder with examples")
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("command", ["run --dry", "plan", "cite", "convert --to data"])
@pytest.mark.parametrize("script", SCRIPTS, indirect=True)
def test_it_is_read(script, command, capsys):
    name, *options = command.split()
    assert cli.main([name, script, *options]) == 0, capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.skipif(not SCRIPTS, reason="ASEMD_CONFORMANCE names no folder with examples")
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("command", ["check", "convert --to ase"])
@pytest.mark.parametrize("script", SCRIPTS, indirect=True)
def test_it_is_computed(script, command, capsys):
    name, *options = command.split()
    assert cli.main([name, script, *options]) == 0, capsys.readouterr()


# finite differences, whose last digits the two programs do not share
NOISE = {"numdiff/in.numdiff"}


@pytest.mark.slow
@pytest.mark.skipif(not SCRIPTS or not oracle.lammps_available(), reason="needs LAMMPS, and ASEMD_CONFORMANCE a folder with examples")
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("script", [s for s in SCRIPTS if s not in NOISE], indirect=True)
def test_it_agrees_with_lammps(script, capsys):
    assert cli.main(["validate", script, "--steps", "5", "--compat", "lammps"]) == 0, capsys.readouterr().out
