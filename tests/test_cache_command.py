"""asemd cache: show, warm, clear."""
from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from lj_cell import BASE

import asemd

ENV = {**os.environ, "PYTHONPATH": str(Path(asemd.__file__).parents[1])}


def asemd_cache(*words: str, cwd: Path, cache: Path | None = None) -> subprocess.CompletedProcess:
    env = ENV | ({"ASEMD_CACHE_DIR": str(cache)} if cache else {})
    return subprocess.run([sys.executable, "-m", "asemd.cli", "cache", *words], env=env, cwd=cwd, capture_output=True, text=True,
                          stdin=subprocess.DEVNULL, timeout=600)


def test_warm_compiles_what_a_run_needs(tmp_path):
    """Into the cache of all tests, where little is missing; nothing else is written, and a run adds nothing to it."""
    (tmp_path / "in.x").write_text(BASE + "thermo 2\ndump d all atom 1 d.txt\nrun 100\nwrite_data end\n")
    done = asemd_cache("warm", "in.x", cwd=tmp_path)
    assert done.returncode == 0 and done.stdout.startswith("in.x is ready to run"), done.stderr
    assert os.listdir(tmp_path) == ["in.x"]
    shown = json.loads(asemd_cache("show", "--json", cwd=tmp_path).stdout)
    assert shown["modules"] > 0 and shown["compiled"] > 0 and shown["kept"]
    run = subprocess.run([sys.executable, "-m", "asemd.cli", "run", "in.x", "--quiet"], env=ENV | {"NUMBA_DEBUG_CACHE": "1"}, cwd=tmp_path,
                         timeout=600, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    assert "data loaded from" in run.stdout and "data saved to" not in run.stdout


def test_clear_deletes_what_is_its_own(tmp_path):
    cache = tmp_path / "cache"
    (cache / "asemd_kernels" / "__pycache__").mkdir(parents=True)
    (cache / "expressions").mkdir()
    for name in ("asemd_kernels/k_1.py", "asemd_kernels/__pycache__/k_1.nbi", "expressions/a.json", "calibration.json", "mine.txt"):
        (cache / name).write_text("12345")
    shown = json.loads(asemd_cache("--json", cwd=tmp_path, cache=cache).stdout)
    assert (shown["modules"], shown["compiled"], shown["expressions"], shown["measured"], shown["size"]) == (1, 1, 1, True, 20)
    asked = asemd_cache("clear", cwd=tmp_path, cache=cache)
    assert asked.returncode == 1 and "add --yes" in asked.stderr and (cache / "calibration.json").exists()
    assert asemd_cache("clear", "--yes", cwd=tmp_path, cache=cache).returncode == 0
    assert [p.name for p in cache.rglob("*") if p.is_file()] == ["mine.txt"]


@pytest.mark.parametrize("words, message", [("empty", "must be one of show warm clear"), ("warm", "needs a script"),
                                            ("clear in.x --yes", "takes no script")])
def test_bad_words(tmp_path, words, message):
    done = asemd_cache(*words.split(), cwd=tmp_path)
    assert done.returncode == 1 and message in done.stderr
