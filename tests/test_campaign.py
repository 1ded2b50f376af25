"""Campaigns: many runs in one database, on any executor, resumed after a kill."""
from __future__ import annotations

import os
import sqlite3
import subprocess
import sys
import time
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import closing
from pathlib import Path

import pytest
from ase import Atoms
from ase.db import connect
from lj_cell import BASE

import asemd
from asemd.errors import InputError

CALLS: list = []


def square(x, y=1, **more):
    CALLS.append((x, y))
    if x < 0:
        raise ValueError("x is\nnegative")
    return Atoms("H", positions=[[x, y, 0]]), {"area": float(x * y), "T": 2.0, "list": [1, x]}


def deadly(x):
    if x == 2:
        os._exit(1)
    return {"x2": x * x}


def test_a_function_over_a_grid(tmp_path):
    CALLS.clear()
    told = []
    found = asemd.campaign(square, {"x": [1, 2, -1], "y": [3, 4]}, tmp_path / "a.db", tell=lambda *n: told.append(n))
    assert CALLS == [(1, 3), (1, 4), (2, 3), (2, 4), (-1, 3), (-1, 4)] and told == [(k, 6) for k in range(1, 7)]
    assert found.column("area") == [3.0, 4.0, 6.0, 8.0] and len(found.failed) == 2
    assert found.failed[0]["error"] == "ValueError: x is negative" and found.rows[3]["results"]["list"] == [1, 2]
    text = str(found.table())
    assert "area" in text and "ValueError" in text and "list" not in text.splitlines()[1]
    with connect(tmp_path / "a.db") as db:
        row, = db.select(x=2, y=4, state="done")
        assert row.toatoms().positions[0].tolist() == [2, 4, 0] and row.area == 8.0
    found.plot("x", "area", tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 2000
    with pytest.raises(InputError, match="'are'.*did you mean area"):
        found.column("are")


def test_what_is_done_is_not_run_again(tmp_path):
    asemd.campaign(square, [{"x": 1}, {"x": -1}], tmp_path / "a.db")
    CALLS.clear()
    found = asemd.campaign(square, [{"x": 5}, {"x": 1}, {"x": -1}], tmp_path / "a.db")
    assert CALLS == [(5, 1), (-1, 1)] and [row["parameters"]["x"] for row in found.rows] == [5, 1, -1]       # failed ones are tried again
    with connect(tmp_path / "a.db") as db:
        assert db.count() == 3


def test_scripts_in_other_processes(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "in.x").write_text("variable t index 1.0\n" + BASE + "velocity all scale $t\nthermo 2\nrun 2\n")
    with ProcessPoolExecutor(2) as pool:
        found = asemd.campaign("in.x", {"t": [0.5, 1.5]}, "a.db", executor=pool)
    assert not found.failed, found.failed
    assert found.column("t") == [0.5, 1.5] and found.column("Step") == [2, 2] and found.column("Temp")[0] < found.column("Temp")[1]
    with connect("a.db") as db:
        assert all(len(row.toatoms()) == 32 for row in db.select())
    assert sorted(os.listdir()) == ["a.db", "in.x"]
    with pytest.raises(InputError, match="cannot open nothing"):
        asemd.campaign("nothing", {}, "a.db")
    with pytest.raises(InputError, match="mapping"):
        asemd.campaign(square, [1, 2], "a.db")


def test_anything_with_submit(tmp_path):
    """As Parsl's executors: an object of another kind whose futures are those of `concurrent.futures`, but cannot be cancelled."""
    class Held(Future):
        def cancel(self):
            raise NotImplementedError

    class Own:
        def submit(self, function, *arguments):
            future = Held()
            future.set_result(function(*arguments))
            return future
    for k, executor in enumerate((Own(), ThreadPoolExecutor(2))):
        found = asemd.campaign(square, {"x": [1, 2]}, tmp_path / f"{k}.db", executor=executor)
        assert found.column("area") == [1.0, 2.0]


PARSL = """
import asemd, job
from parsl import Config
from parsl.concurrent import ParslPoolExecutor
from parsl.executors import HighThroughputExecutor
from parsl.providers import LocalProvider
here = HighThroughputExecutor(label="here", address="127.0.0.1", max_workers_per_node=2, encrypted=False, provider=LocalProvider())
with ParslPoolExecutor(config=Config(executors=[here], run_dir="runs", usage_tracking=0)) as pool:
    found = asemd.campaign(job.square, {"x": [1, 2, -1]}, "a.db", executor=pool)
print(found.column("area"), [row["error"] for row in found.failed])
"""


def test_parsl(tmp_path):
    """Worker processes of Parsl on this machine, as it starts them on a cluster."""
    pytest.importorskip("parsl")
    (tmp_path / "job.py").write_text("def square(x):\n    if x < 0:\n        raise ValueError('negative')\n    return {'area': x * x}\n")
    env = {**os.environ, "PYTHONPATH": os.pathsep.join([str(Path(asemd.__file__).parents[1]), str(tmp_path)]),
           "PATH": os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])}
    done = subprocess.run([sys.executable, "-c", PARSL], cwd=tmp_path, env=env, capture_output=True, text=True, timeout=300)
    assert done.stdout.strip() == "[1, 4] ['ValueError: negative']", done.stdout + done.stderr[-3000:]


def test_a_process_that_dies(tmp_path):
    with ProcessPoolExecutor(1) as pool:
        found = asemd.campaign(deadly, {"x": [1, 2, 3]}, tmp_path / "a.db", executor=pool)
    assert found.rows[0]["results"] == {"x2": 1} and all("BrokenProcessPool" in row["error"] for row in found.failed)
    assert asemd.campaign(deadly, {"x": [1, 3]}, tmp_path / "a.db").column("x2") == [1, 9]


def rows_of(database):
    """Rows that are there, read only: `ase.db.connect` would make the tables, at the same time as the campaign does."""
    try:
        with closing(sqlite3.connect(f"file:{database}?mode=ro", uri=True)) as open_one:
            return open_one.execute("SELECT COUNT(*) FROM systems").fetchone()[0]
    except sqlite3.OperationalError:     # no file or no table yet, or the campaign is writing
        return 0


def test_a_killed_campaign_goes_on(tmp_path):
    program = "import asemd, time\ndef slow(x):\n    time.sleep(0.0 if x < 2 else 100.0)\n    return {'y': x}\n"
    (tmp_path / "slow.py").write_text(program)
    env = {**os.environ, "PYTHONPATH": os.pathsep.join([str(Path(asemd.__file__).parents[1]), str(tmp_path)])}
    run = "import asemd, slow; asemd.campaign(slow.slow, {'x': [0, 1, 2, 3]}, 'a.db')"
    process = subprocess.Popen([sys.executable, "-c", run], env=env, cwd=tmp_path)
    end = time.time() + 120
    while time.time() < end:
        time.sleep(0.2)
        if rows_of(tmp_path / "a.db") == 2:
            break
    process.kill()
    process.wait()
    (tmp_path / "slow.py").write_text(program.replace("100.0", "0.0").replace("'y': x", "'y': 10 * x"))
    rest = "; print(asemd.campaign(slow.slow, {'x': [0, 1, 2, 3]}, 'a.db').column('y'))"
    out = subprocess.run([sys.executable, "-c", "import asemd, slow" + rest], env=env, cwd=tmp_path, capture_output=True, text=True)
    assert out.stdout.split("\n")[0] == "[0, 1, 20, 30]", out.stderr
