"""Files of rigid bodies: what infile makes of them, what is written beside restart files, against LAMMPS; a run goes on from them."""
from __future__ import annotations

import numpy as np
import pytest
from both import ATOMS, asemd, lines_of
from scripted import LENGTH, script, write_data
from wheel import ask

from asemd.errors import InputError

BODY = "3 50.0 3.0 4.0 5.0 10.0 11.0 12.0 0.5 0.2 0.1 0.001 0.0 0.0 0.01 0.02 0.03 0 0 0"
AWAY = BODY.replace(" 3.0 4.0 5.0 ", " 13.0 4.0 -5.0 ").replace(" 0 0 0", " 1 -1 0")      # it comes into the box
FILES = {"one": f"# bodies\n\n1\n{BODY}\n", "away": f"1\n{AWAY} # far\nmore lines do not count\n", "none": "0\n"}
CASES = {
    "rigid": "rigid molecule infile one",
    "rigid, outside": "rigid molecule infile away",
    "rigid, taken anew": "rigid molecule infile one reinit yes",
    "rigid, groups": "rigid group 3 g1 g2 g3 infile one",
    "small, none": "rigid/small molecule infile none",
    "nvt small": "rigid/nvt/small molecule temp 300 300 20 infile one",
}
RUNS = "run 10\nrun 10\nwrite_restart r"
SCRIPT = ATOMS + """
import os
os.chdir(given["folder"])
answer = {}
for name, lines in given["cases"].items():
    lmp = ran(lines)
    answer[name] = atoms_of(lmp, ("x", "v")) | {"file": open("r.rigid").read()}
    lmp.close()
"""


def scene(folder, fix: str, runs: str = RUNS) -> str:
    """The liquid of chains; names of files and groups are those of `folder`."""
    words = " ".join(str(folder / w) if w in FILES else w for w in fix.split())
    groups = "\n".join(f"group g{k} id {4 * k - 3}:{4 * k}" for k in (1, 2, 3))
    return f"{script(folder / 'data')}{groups}\nneigh_modify exclude molecule/intra all\ncomm_modify cutoff 11.5\nfix 1 all {words}\n{runs}"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("bodies")
    write_data(folder / "data")
    for name, text in FILES.items():
        (folder / name).write_text(text)
    return folder


@pytest.fixture(scope="module")
def theirs(folder):
    return ask(SCRIPT, folder=str(folder), cases={name: lines_of(scene(folder, fix)) for name, fix in CASES.items()})


def table(text: str) -> np.ndarray:
    """The numbers of a file of bodies."""
    lines = [line.split() for line in text.splitlines() if line.strip() and not line.startswith("#")]
    assert len(lines) == int(lines[0][0]) + 1
    numbers = np.array(sorted([float(w) for w in line] for line in lines[1:]))
    numbers[:, 2:5] += LENGTH * numbers[:, 17:]         # unwrapped
    return numbers[:, :17]


@pytest.mark.parametrize("name", CASES)
def test_like_lammps(name, folder, theirs, tmp_path, monkeypatch):
    """Atoms after two runs, and the file beside the restart file."""
    monkeypatch.chdir(tmp_path)
    system = asemd(scene(folder, CASES[name])).scene.system
    for key in ("x", "v"):
        theirs_ = np.array(theirs[name][key])
        away = getattr(system, key)[np.argsort(system.id)] - theirs_
        away -= LENGTH * np.rint(away / LENGTH)     # LAMMPS has put atoms back into the box
        assert abs(away).max() < 1e-11 * abs(theirs_).max(), key
    if "anew" in name:      # write_restart of LAMMPS puts the centres back to where they were at first
        return
    a, b = table((tmp_path / "r.rigid").read_text()), table(theirs[name]["file"])
    assert a == pytest.approx(b, rel=1e-10, abs=1e-10)


def test_without_infile_there_is_no_file(folder, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    asemd(scene(folder, "rigid molecule", "write_restart r"))
    assert [p.name for p in tmp_path.glob("r*")] == ["r"]


def test_before_the_first_run(folder, tmp_path, monkeypatch):
    """It has the bodies of the file as they are, and all digits."""
    monkeypatch.chdir(tmp_path)
    asemd(scene(folder, "rigid molecule infile one", "write_restart r"))
    assert table((tmp_path / "r.rigid").read_text())[2] == pytest.approx([float(w) for w in BODY.split()][:17], rel=1e-15,
                                                                                               abs=1e-15)


@pytest.mark.parametrize(("style", "off"), [("rigid molecule", 0.0), ("rigid/nvt/small molecule temp 300 300 20", 0.0),
                                            ("rigid/npt/small molecule temp 300 300 20 iso 0 0 100", 1e-13)])
def test_a_run_goes_on(style, off, folder, tmp_path, monkeypatch):
    """From a restart file in the midst of a run and the file beside it, bit for bit (the order of atoms in a list depends on the box at
    the start); another file counts."""
    monkeypatch.chdir(tmp_path)
    whole = asemd(scene(folder, f"{style} infile one", "restart 10 r.*\nrun 20"))
    again = f"read_restart r.10\nneigh_modify exclude molecule/intra all\nfix 1 all {style} infile "
    part = asemd(f"{again}r.10.rigid\nrun 10")
    for key in ("x", "v"):
        assert abs(getattr(part.scene.system, key) - getattr(whole.scene.system, key)).max() <= off, key
    assert abs(part.scene.system.box.cell - whole.scene.system.box.cell).max() <= off
    (tmp_path / "changed").write_text((tmp_path / "r.10.rigid").read_text().replace("3 5.0000000000000000e+01", "3 6.0e+01"))
    part = asemd(f"{again}changed\nrun 0")
    assert part.scene.fixes["1"].bodies.mass[2] == 60.0


@pytest.mark.parametrize(("text", "said"), [
    ("", "bad is empty"),
    ("x\n", r"expected the number of bodies .*bad:1"),
    ("-1\n", r"expected the number of bodies .*bad:1"),
    (f"# two\n2\n{BODY}\n", r"2 bodies are announced and 1 follow .*bad:2"),
    (f"1\n{BODY} 7\n", r"expected 20 values .*, got 21 .*bad:2"),
    (f"1\n{BODY.replace('11.0', 'x')}\n", r"expected a number, got 'x' .*bad:2"),
    (f"1\n{BODY.replace('11.0', 'nan')}\n", r"expected a finite number, got 'nan' .*bad:2"),
    (f"1\n{BODY.replace(' 0 0 0', ' 0 0 0.5')}\n", r"whole number, got '0.5' .*bad:2"),
    (f"1\n3{BODY}\n", r"there is no rigid body with ID 33 .*bad:2"),
    (f"2\n{BODY}\n{BODY}\n", r"body 3 comes twice .*bad:3"),
    (f"1\n{BODY.replace('50.0', '-50.0')}\n", r"mass of body 3 must be positive, got -50 .*bad:2"),
    (f"1\n{BODY.replace('10.0 11.0', '10.0 -11.0')}\n", r"body 3 has a negative principal moment .*bad:2"),
    (None, "cannot read .*bad: No such file"),
])
def test_mistakes(text, said, folder, tmp_path):
    if text is not None:
        (tmp_path / "bad").write_text(text)
    with pytest.raises(InputError, match=said):
        asemd(scene(folder, f"rigid molecule infile {tmp_path / 'bad'}", "run 0"))
