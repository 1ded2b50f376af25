"""fix property/atom: what dumps, computes, variables, data and restart files say of every kind of property, as LAMMPS."""
from __future__ import annotations

import pytest
from wheel import ask, ran

from asemd.errors import InputError
from asemd.lammps import Lammps

SETUP = """clear
units lj
atom_style {style}
atom_modify map array
region b block 0 3 0 3 0 3
create_box 2 b
create_atoms 1 random 6 5 NULL
mass * 1.0
set atom 2*3 type 2
pair_style zero 1.0
pair_coeff * *"""
AGAIN = """write_data {e}.data nocoeff
clear
units lj
atom_style atomic
{fix}
read_data {e}.data fix p NULL {section}
pair_style zero 1.0
pair_coeff * *"""
RESTARTED = """write_restart {e}.rst
clear
read_restart {e}.rst
{fix}
pair_style zero 1.0
pair_coeff * *"""
DUMP = """dump d all custom 1 {e}.dump {columns}
dump_modify d sort id format float %.12g
run 0
undump d"""
ALL = "fix p all property/atom i_one d_two i2_a 2 d2_b 2 mol q rmass"
FILLED = "set atom * mass 2.0\nset atom 2*4 i_one 7 d_two 1.5 i2_a[1] 4 d2_b[2] 0.75 mol 2 charge 3.0\nset type 2 i2_a[2] -9 mass 4.5"
EVERY = "id i_one d_two i2_a[*] d2_b[*] mol q mass"
# style, commands, columns of the dump
CASES = {
    "mol": ("atomic", "fix p all property/atom mol\nset atom 2*4 mol 7", "id mol"),
    "mol of charged atoms": ("charge", "fix p all property/atom mol\nset atom * mol 3", "id mol q"),
    "rmass": ("atomic", "fix p all property/atom rmass\nset atom * mass 2.5\nset atom 3 mass 4.5", "id mass"),
    "every": ("atomic", f"{ALL}\n{FILLED}", EVERY),
    "two fixes": ("atomic", "fix p all property/atom i_one\nfix r all property/atom d_two writedata no ghost yes\n"
                  "set atom 2*4 i_one 7 d_two 1.5", "id i_one d_two"),
    "compute": ("atomic", f"{ALL}\n{FILLED}\ncompute c all property/atom i_one d_two i2_a[1] i2_a[2] d2_b[1] d2_b[2] mol q mass",
                "id c_c[*]"),
    "variables": ("atomic", f"{ALL}\n{FILLED}\nvariable v atom i_one+10*d_two+100*i2_a[1]+1000*d2_b[2]+d_two[3]\n"
                  "set group all d_two v_v d2_b[1] v_v i_one v_v", f"{EVERY} v_v"),
    "chunks": ("atomic", "fix p all property/atom mol\nset atom 1*3 mol 1\nset atom 4*6 mol 2\ncompute cc all chunk/atom molecule",
               "id mol c_cc"),
    "groups": ("atomic", "fix p all property/atom i_one\nset atom 2*4 i_one 1\nvariable g atom i_one==1\ngroup g variable g\n"
               "set group g i_one 5\nset region b type 2", "id type i_one"),
    "atoms leave and join": ("atomic", f"{ALL}\n{FILLED}\ngroup z id 3\ndelete_atoms group z\ncreate_atoms 1 single 1 1 1\n"
                             "set atom 6 mass 1.0", EVERY),
    "from a data file": ("atomic", f"{ALL}\n{FILLED}\n{AGAIN}".replace("{fix}", ALL).replace("{section}", "p"), EVERY),
    "molecules from a data file": ("atomic", f"fix p all property/atom mol\nset atom 2*4 mol 2\n{AGAIN}"
                                   .replace("{fix}", "fix p all property/atom mol").replace("{section}", "Molecules"), "id mol"),
    "from a restart file": ("atomic", f"{ALL}\n{FILLED}\n{RESTARTED}".replace("{fix}", ALL), EVERY),
}
WHEEL = """
lmp = start()
answer = {}
for name, lines in given["cases"].items():
    for line in lines:
        lmp.command(line)
    answer[name] = [open(folder / "x.dump").read(), open(folder / "x.end").read()]
lmp.close()
"""


def commands(name, place):
    style, text, columns = CASES[name]
    lines = "\n".join([SETUP.format(style=style), text, DUMP.replace("{columns}", columns), "write_data {e}.end nocoeff"])
    return lines.replace("{e}", f"{place}/x").split("\n")


def numbers(text, after):
    """Rows of numbers behind the last heading, in the order of ids; what else is there."""
    rows, words = [], []
    for line in text[text.rindex(after):].split("\n")[1:]:
        try:
            rows.append([float(w) for w in line.split()])
        except ValueError:
            words.append(line.strip())
    return sorted(r for r in rows if r), [w for w in words if w]


@pytest.fixture(scope="module")
def expected(tmp_path_factory):
    place = tmp_path_factory.mktemp("wheel")
    return ask(WHEEL.replace("folder /", "Path(given['place']) /"), cases={name: commands(name, place) for name in CASES}, place=str(place))


@pytest.mark.parametrize("name", CASES)
def test_like_lammps(name, expected, tmp_path):
    ran(commands(name, tmp_path))
    for file, after, want in (("x.dump", "ITEM: ATOMS", expected[name][0]), ("x.end", "Velocities", expected[name][1])):
        assert numbers((tmp_path / file).read_text(), after) == numbers(want, after)


def test_restart_files_are_told_of_in_the_log(tmp_path):
    lmp = Lammps(cmdargs=["-screen", "none", "-log", str(tmp_path / "log")])
    fixes = ["fix p all property/atom i_one", "fix m all move linear 0 0 0", "fix s all spring/self 1.0"]
    lmp.commands_list([*SETUP.format(style="atomic").split("\n"), *fixes, f"write_restart {tmp_path}/r", "clear",
                       f"read_restart {tmp_path}/r", *fixes[:2], "pair_style zero 1.0", "pair_coeff * *", "run 0"])
    lmp.close()
    lines = [line.strip() for line in (tmp_path / "log").read_text().split("\n") if "fix info" in line or "fix style" in line]
    move, own, spring = "fix style: move, fix ID: m", "fix style: property/atom, fix ID: p", "fix style: spring/self, fix ID: s"
    assert lines == ["Resetting peratom fix info from restart file:", own, "Resetting global fix info from restart file:", move,
                     "Resetting peratom fix info from restart file:", move, "All restart file global fix info was re-assigned",
                     "Unused restart file peratom fix info:", spring]


def test_sections_that_do_not_fit(tmp_path):
    start, fix = SETUP.format(style="atomic").split("\n"), "fix p all property/atom i_one d_two"
    lmp = ran([*start, fix, f"write_data {tmp_path}/x.data nocoeff"])
    text = (tmp_path / "x.data").read_text()
    head, section = text.split("p # i_one d_two")
    for wrong, message in ((section.replace("6 0 0.0\n", ""), "has 5 lines, but there are 6 atoms"), (section.replace("6 0 0.0", "9 0 0.0"),
                           "atom ID 9 does not exist"), (section.replace("6 0 0.0", "6 0"), "has 2 words, not 3"),
                           (section.replace("6 0 0.0", "6 0.5 0.0"), "0.5")):
        (tmp_path / "wrong.data").write_text(head + "p # i_one d_two" + wrong)
        with pytest.raises(InputError, match=message):
            lmp.commands_list(["clear", "atom_style atomic", fix, f"read_data {tmp_path}/wrong.data fix p NULL p"])


def test_added_files_find_their_atoms(tmp_path):
    """Ids in the section of an added file are raised as those of its atoms."""
    start, fix = SETUP.format(style="atomic").split("\n"), "fix p all property/atom i_one d_two"
    lmp = ran([*start, fix, "set atom 2 i_one 5 d_two 0.5", f"write_data {tmp_path}/x.data nocoeff", "set atom 2 i_one 8",
               f"read_data {tmp_path}/x.data add append fix p NULL p"])
    system = lmp.scene.system
    assert system.extra["i_one"][system.index_of([2, 8])].tolist() == [8, 5]
    assert system.extra["d_two"].tolist() == [0, 0.5, 0, 0, 0, 0] * 2
