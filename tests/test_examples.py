"""What every command of `asemd` makes of LAMMPS's own examples, from the folder that ASEMD_CONFORMANCE names; skipped without it."""
from __future__ import annotations

import shutil

import pytest
from test_conformance import folder

from asemd import cli

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
@pytest.mark.parametrize("command", ["run --dry", "plan", "cite", "convert --to data", "convert --to ase"])
@pytest.mark.parametrize("script", SCRIPTS, indirect=True)
def test_it_is_read(script, command, capsys):
    name, *options = command.split()
    assert cli.main([name, script, *options]) == 0, capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.skipif(not SCRIPTS, reason="ASEMD_CONFORMANCE names no folder with examples")
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("script", SCRIPTS, indirect=True)
def test_it_passes_the_check(script, capsys):
    assert cli.main(["check", script]) == 0, capsys.readouterr().out
