"""Kernels compiled by several processes at once."""
from __future__ import annotations

import os
import subprocess
import sys
import time

import numba
import pytest

from asemd.errors import InputError
from asemd.kernels import ahead, generate

SCRIPT = """units real
atom_style full
region box block 0 12 0 12 0 12
create_box 1 box bond/types 1 extra/bond/per/atom 2
lattice sc 3
create_atoms 1 box
displace_atoms all random 0.2 0.2 0.2 7
mass 1 20
set group all charge 0.1
pair_style lj/cut/coul/cut 4 5
pair_coeff 1 1 0.1 2.5
bond_style harmonic
bond_coeff 1 100 3
create_bonds many all all 1 2.8 3.0
special_bonds lj/coul 0 0 0.5
fix 1 all langevin 300 300 100 9
fix 2 all nve
run 10
"""
# of each compilation in this process, the name
RUN = """
import sys
from numba.core import event
from asemd.kernels import ahead, target
from asemd.lammps import Lammps

class Count(event.Listener):
    def on_start(self, event):
        names.append(event.data["dispatcher"].py_func.__name__)
    def on_end(self, event):
        pass

names = []
event.register("numba:compile", Count())
ahead.SERVE = sys.argv[1] or ahead.SERVE
lmp = Lammps(cmdargs=["-log", "none", "-screen", "none"])
lmp.commands_string(open("in.script").read())
print(repr(lmp.get_thermo("pe")), len(names), len(ahead.seen), sum(h.poll() is None for h in ahead.helpers))
ahead.stop()
assert not ahead.helpers
"""


def answer(folder, compilers: str, serve: str = "", **env: str) -> list[float]:
    (folder / "in.script").write_text(SCRIPT)
    env = {**os.environ, "ASEMD_CACHE_DIR": str(folder / "cache"), "ASEMD_COMPILERS": compilers, "NUMBA_DISABLE_JIT": "0", **env}
    done = subprocess.run([sys.executable, "-c", RUN, serve], cwd=folder, env=env, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return [float(word) for word in done.stdout.split()]


def code(folder) -> set[str]:
    return {f.name for f in (folder / "cache").rglob("*.nbi")}


def test_helpers_compile_the_same_code(tmp_path):
    alone, together = tmp_path / "alone", tmp_path / "together"
    alone.mkdir()
    together.mkdir()
    energy, all_, _, _ = answer(alone, "1")
    found, mine, _, helpers = answer(together, "3")
    assert found == energy and helpers == 2
    assert 0.3 * all_ < mine < 0.95 * all_      # the others were compiled by helpers
    assert code(together) == code(alone)
    assert answer(together, "3")[1::2] == [0, 0]      # all is there


def test_a_helper_without_work_ends():
    helper = subprocess.Popen([sys.executable, "-c", "from asemd.kernels import ahead; ahead.IDLE = 0.3; ahead.serve()"],
                              stdin=subprocess.PIPE)
    try:
        assert helper.wait(60) == 0
    finally:
        helper.kill()
        helper.stdin.close()


def test_a_helper_goes_on_after_an_error(tmp_path):
    env = {**os.environ, "ASEMD_CACHE_DIR": str(tmp_path)}
    done = subprocess.run([sys.executable, "-c", ahead.SERVE], input="k_not_there\nk_nor_this f !\n", env=env, capture_output=True,
                          text=True)
    assert done.returncode == 0 and done.stdout == "done\ndone\n" and done.stderr.count("k_not_there.py") == 1


def sources(prefix: str, lines: int, number: int) -> list[str]:
    """Modules whose function has many lines and an address."""
    out = []
    for k in range(number):
        b = generate.Builder(f"{prefix} {k}")
        b.line("from asemd.kernels.packed import entry")
        b.text("@entry()\ndef call(thread, arguments):\n    n = thread\n" + f"    n += arguments * {k}\n" * lines, jit=False)
        out.append(b.source())
    return out


@pytest.fixture
def empty(tmp_path, monkeypatch):
    """An empty cache, and no helpers yet; what was started."""
    before = str(generate.cache_dir())
    monkeypatch.setenv("ASEMD_CACHE_DIR", str(tmp_path))
    monkeypatch.setenv("ASEMD_COMPILERS", "2")
    monkeypatch.setattr(generate, "_dir", None)
    shared, begun, start = [], [], ahead._share
    monkeypatch.setattr(ahead, "_share", lambda jobs, others: (shared.append((list(jobs), others)), start(jobs, others)))
    launch = ahead._start
    monkeypatch.setattr(ahead, "_start", lambda: begun.append(launch()) or begun[-1])
    yield shared, begun
    ahead.stop()
    sys.modules[generate.PACKAGE].__path__[:] = [before]
    assert all(h.poll() is not None for h in begun)


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_only_what_pays(empty, monkeypatch):
    shared, begun = empty
    told = []
    monkeypatch.setattr(generate, "announce", lambda: told.append(1))
    ahead.together(sources("short", 10, 5))
    ahead.together(sources("one long", 1000, 1))
    assert not shared and not begun and not told
    many = sources("many", 200, 3)
    ahead.together(many)
    ahead.together(many)
    assert [(len(jobs), others) for jobs, others in shared] == [(3, 1)] and len(begun) == 1 and told == [1]
    monkeypatch.setenv("ASEMD_COMPILERS", "1")
    ahead.together(sources("alone", 200, 3))
    assert len(shared) == 1


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
@pytest.mark.parametrize("serve", ["raise SystemExit(1)", "import sys; sys.stdin.readline()", "print('done', flush=True)"])
def test_helpers_that_do_not_help(empty, monkeypatch, serve):
    monkeypatch.setattr(ahead, "SERVE", serve)
    texts = sources(serve, 200, 4)
    ahead.together(texts)
    assert len(empty[0]) == 1
    assert all(generate.load(text).call.address for text in texts)
    ahead.together(sources(f"{serve} again", 200, 2))
    assert len(empty[0]) == 2


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_no_more_processes(empty, monkeypatch):
    def refuse():
        raise BlockingIOError("resource temporarily unavailable")

    monkeypatch.setattr(ahead, "_start", refuse)
    texts = sources("no more processes", 200, 3)
    ahead.together(texts)
    assert len(empty[0]) == 1 and not ahead.helpers
    assert all(f"{generate.PACKAGE}.{generate.stem_of(text)}" in sys.modules for text in texts)      # compiled here


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_interrupted(empty, monkeypatch):
    shared, begun = empty

    def interrupt(job):
        raise KeyboardInterrupt

    monkeypatch.setattr(ahead, "do", interrupt)
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        ahead.together(sources("interrupted", 200, 6))
    assert len(begun) == 1 and begun[0].poll() is not None and not ahead.helpers and time.monotonic() - began < 30


def test_no_room_on_the_disk(empty, monkeypatch):
    def full(stem, text):
        raise OSError("no space left")

    monkeypatch.setattr(generate, "written", full)
    ahead.together(sources("no room", 200, 3))
    assert not empty[0]


def test_number_of_processes(monkeypatch):
    monkeypatch.delenv("ASEMD_COMPILERS", raising=False)
    assert 1 <= ahead.processes() <= ahead.MOST
    monkeypatch.setenv("ASEMD_COMPILERS", "7")
    assert ahead.processes() == 7
    monkeypatch.setattr(sys, "executable", "/usr/bin/editor")
    assert ahead.processes() == 1
    for wrong in ("0", "-1", "two", "1.5"):
        monkeypatch.setenv("ASEMD_COMPILERS", wrong)
        with pytest.raises(InputError, match="ASEMD_COMPILERS is a number of processes"):
            ahead.processes()
