"""Commands that are about processors in LAMMPS: checked, and without effect."""
from __future__ import annotations

import pytest
from both import asemd
from wheel import ask, ran

from asemd.errors import InputError, InputWarning

BOX = "region b block 0 4 0 4 0 4\ncreate_box 1 b\nmass 1 1\n"


def test_partition():
    session = asemd(BOX + "partition yes 1 create_atoms 1 single 1 1 1\npartition no 1 create_atoms 1 single 2 2 2\n"
                    "partition yes * create_atoms 1 single 3 3 3")
    assert session.scene.system.n == 2


def test_older_communicate():
    asemd(BOX + "communicate multi\ncommunicate single cutoff 5.0 vel yes group all")


@pytest.mark.parametrize("words", ["1 1 1", "* 2 *", "* * * map xyz", "* * * grid twolevel 4 * * 1 file f",
                                   "2 2 2 grid numa part 1 2 multiple"])
def test_processors(words):
    asemd(f"processors {words}")


@pytest.mark.parametrize("words, message", [
    ("1 1", "3 values"), ("1 0 1", "positive"), ("1 1 1 mpa xyz", "did you mean map"), ("1 1 1 map xyx", "expected one of"),
    ("1 1 1 grid twolevel 4", "4 values"),
])
def test_wrong_processors(words, message):
    with pytest.raises(InputError, match=message):
        asemd(f"processors {words}")


@pytest.mark.parametrize("line, message", [
    ("partition yes 2 print x", "valid range 1 to 1"), ("partition maybe 1 print x", "yes or no"), ("partition yes 1", "3 values"),
    ("partition yes 1 prnt x", "did you mean print"), ("communicate", "1 value"), ("communicate fast", "single multi"),
    ("communicate single cutof 3", "did you mean cutoff"), ("communicate single cutoff", "1 value"),
    ("communicate single cutoff -1", "negative"),
])
def test_mistakes(line, message):
    with pytest.raises(InputError, match=message):
        asemd(BOX).execute(line)


def test_plugin():
    told = asemd("plugin list\nplugin clear\nplugin restore\nplugin unload pair morse2").told
    assert "".join(told).endswith("Currently loaded plugins: 0\nIgnoring unload of pair style morse2: not from a plugin\n")


@pytest.mark.parametrize("words, message", [
    ("load morse2.so", "plugin load morse2.so: plugins are compiled for LAMMPS.*--import"), ("load", "plugin load"), ("", "plugin needs"),
    ("unload pair", "2 values"), ("lst", "did you mean list"), ("list all", "1 value"),
])
def test_wrong_plugin(words, message):
    with pytest.raises(InputError, match=message):
        asemd(f"plugin {words}")


def test_atoms_without_ids():
    """Ids stay, which is told; where LAMMPS refuses the command, so does this."""
    with pytest.warns(InputWarning, match="atoms keep their ids"):
        assert asemd("atom_modify id no\n" + BOX + "create_atoms 1 single 1 1 1").scene.system.id.tolist() == [1]
    asemd("atom_style full\natom_modify id yes map hash")
    for text, message in (("atom_style full\natom_modify id no", "needs atom ids"), (BOX + "atom_modify id no", "before the box"),
                          (BOX + "atom_modify map hash", "before the box"), ("atom_modify id x", "yes or no")):
        with pytest.raises(InputError, match=message):
            asemd(text)


def test_momentum_of_no_atoms():
    """Refused where a run or minimisation starts; a dynamic group may be empty."""
    scene = BOX + ("create_atoms 1 single 1 1 1\npair_style lj/cut 1.0\npair_coeff 1 1 1 1\ngroup none empty\nfix 1 all nve\n"
                   "variable no atom 0\n")
    for action in ("run 1", "minimize 0 0 1 1"):
        with pytest.raises(InputError, match="fix 2 .style momentum.: group none has no atoms"):
            asemd(scene + f"fix 2 none momentum 1 linear 1 1 1\n{action}")
    asemd(scene + "group d dynamic all every 1 var no\nfix 2 d momentum 1 linear 1 1 1\nrun 1")


MELT = """
lattice fcc 0.8442
region b block 0 3 0 3 0 3
create_box 1 b
create_atoms 1 box
mass 1 1.0
velocity all create 1.44 87287 loop geom
pair_style lj/cut 2.5
pair_coeff 1 1 1.0 1.0
neigh_modify delay 50 every 50
fix 1 all nve
fix 2 all balance 5 1.05 shift xyz 10 1.05 weight group 1 all 1.0
"""
ASKED = """
l = start()
l.commands_string(given["text"])
answer = {"x": list(l.gather_atoms("x", 1, 3)), "image": list(l.gather_atoms("image", 0, 3)),
          "row": [l.last_thermo()[name] for name in ("f_2", "f_2[1]", "f_2[2]", "f_2[3]")]}
"""


@pytest.mark.parametrize("words", ["1.1 shift xyz 10 1.05 out f", "1.0 x uniform y 0.5 0.7 z 0.2", "1.1 rcb weight group 1 all 1 sort no",
                                   "1.1 rcb weight time 0.5 weight neigh 0.5 weight var x weight store w"])
def test_balance(words):
    asemd(BOX + f"balance {words}")


@pytest.mark.parametrize("command", [
    "balance 1.05 shift xx 2 1.0", "balance 1.05 rcb wait 1", "balance 1.05 rcb weight time x", "fix 1 all balance 5 0.5 rcb",
    "fix 1 all balance -1 1.5 rcb", "fix 1 all balance 1 1.5 shift x 0 1.0", "fix 1 all balance 1 1.5 rcb weight group 2 all",
])
def test_wrong_balance(command):
    with pytest.raises(InputError, match="balance"):
        asemd(BOX + command)


def test_fix_balance_asks_for_lists():
    """Its outputs, and lists on its steps: atoms that left the box are wrapped then."""
    script = MELT + "thermo_style custom step f_2 f_2[1] f_2[2] f_2[3]\nrun 13\nrun 9"
    theirs, ours = ask(ASKED, text=script), ran(script)
    assert list(ours.gather_atoms("image", 0, 3)) == theirs["image"]
    assert list(ours.gather_atoms("x", 1, 3)) == pytest.approx(theirs["x"], rel=1e-9, abs=1e-9)
    assert [ours.last_thermo()[name] for name in ("f_2", "f_2[1]", "f_2[2]", "f_2[3]")] == theirs["row"] == [0.0, 108.0, 0.0, 0.0]


SETTLED = """
l = start()
l.commands_string(given["text"])
answer = {"x": list(l.gather_atoms("x", 1, 3)), "image": list(l.gather_atoms("image", 0, 3)), "lz": l.get_thermo("lz")}
"""


@pytest.mark.parametrize("command", ["write_data out.data", "write_restart out.restart", "balance 1.0 shift x 1 1.0", "reset_atoms id",
                                     "write_coeff out.coeff"])
def test_state_after_files(command, tmp_path, monkeypatch):
    """Atoms are within the box, and open faces close to them, once the state was written; a later random displacement depends on it."""
    monkeypatch.chdir(tmp_path)
    script = MELT.replace("lattice fcc", "boundary p p s\natom_modify map array sort 0 0\nlattice fcc").split("fix 2")[0]
    script = script.replace("every 50", "every 50\nneighbor 1.0 bin") + f"run 17\n{command}\n"
    theirs, ours = ask(SETTLED, text=script), ran(script)
    assert list(ours.gather_atoms("image", 0, 3)) == theirs["image"]
    assert list(ours.gather_atoms("x", 1, 3)) == pytest.approx(theirs["x"], rel=1e-9, abs=1e-9)
    assert ours.get_thermo("lz") == pytest.approx(theirs["lz"], rel=1e-12)
