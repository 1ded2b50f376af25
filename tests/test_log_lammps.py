"""Whole logs: thermo blocks as LAMMPS writes them, readable by readers of LAMMPS's logs; where a log comes from."""
from __future__ import annotations

import hashlib
import re

import numpy as np
import pytest
from both import asemd, lines_of
from four_beads import COUNTS, ITEMS, TYPES
from wheel import ask

from asemd import __version__
from asemd.errors import InputError
from asemd.lammps.session import Session
from asemd.lammps.switches import Switches

SCRIPT = """
units metal
atom_style full
lattice fcc 3.9
region b prism 0 4 0 4 0 4 0.5 0.3 0.2
create_box 2 b bond/types 1 angle/types 1 dihedral/types 1 improper/types 1 extra/bond/per/atom 3
create_atoms 1 box
set atom 2*5 type 2
mass * 12.0107
velocity all create 300 1234 loop geom
pair_style lj/cut 4
pair_coeff * * 0.01 2.6
bond_style zero
bond_coeff *
fix 1 all nvt temp 300 300 0.1
compute t2 all temp
compute p2 all pressure t2
compute ke all ke
variable v equal step*2
thermo_style custom step elapsed elaplong dt time atoms temp press pe ke etotal evdwl ecoul epair ebond eangle edihed eimp emol elong etail
run 2
thermo_style custom step enthalpy ecouple econserve vol density lx ly lz xlo xhi ylo yhi zlo zhi xy xz yz xlat ylat zlat pxx pyy pzz pxy &
  pxz pyz fmax fnorm cella cellb cellc cellalpha cellbeta cellgamma nbuild ndanger bonds angles dihedrals impropers part avecx avecy avecz &
  bvecx bvecy bvecz cvecx cvecy cvecz
thermo_modify norm yes
run 2
thermo_style custom step temp c_ke c_p2[1] f_1 v_v c_p2[*] timeremain
thermo_modify norm yes format float %15.7f format int "%8d " colname 2 Temper colname c_ke KE format c_ke %9.3g
thermo_modify format -1 %5.1f colname -2 last
run 2
thermo_modify line yaml
run 2
thermo_modify line multi format none
run 2
thermo_style multi
run 1
thermo_style yaml
run 1
thermo_style one
thermo_modify temp t2 press p2 flush yes lost warn lost/bond ignore warn 5
thermo_modify format line "%d %g %g %g %g %g"
run 1
thermo_modify format 2 %20.15g
run 1
"""
THEIRS = """
import re
lmp = lammps(cmdargs=["-screen", "none", "-log", given["log"]])
for line in given["lines"]:
    lmp.command(line)
lmp.close()
answer = open(given["log"]).read()
"""
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")


def blocks(log: str) -> list[str]:
    """The lines between setup and summary of each run; without seconds."""
    found = re.findall(r"^Per MPI rank[^\n]*\n(.*?)^Loop time", log, re.M | re.S)
    return [re.sub(r"CPU = +\S+", "CPU", block) for block in found]


def our_log(folder, text: str) -> str:
    """The log of a script."""
    (folder / "in.x").write_text(text)
    session = Session(switches=Switches(screen="none", log=str(folder / "log.x")))
    try:
        session.file(folder / "in.x")
    finally:
        session.close()
    return (folder / "log.x").read_text()


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("logs")
    commands = " ".join(SCRIPT.split("&\n")).splitlines()
    theirs = ask(THEIRS, log=str(folder / "log.theirs"), lines=lines_of("\n".join(commands)))
    return blocks(theirs), blocks(our_log(folder, SCRIPT)), folder


def test_thermo_blocks(logs):
    theirs, ours, _ = logs
    assert len(theirs) == len(ours) == 9
    for their, our in zip(theirs, ours):
        a, b = ([float(n) for n in NUMBER.findall(text)] for text in (their, our))
        assert NUMBER.sub("0", re.sub(" +", " ", our)) == NUMBER.sub("0", re.sub(" +", " ", their))
        assert np.allclose(a, b, rtol=2e-6, atol=1e-9)
        assert [len(line) for line in their.splitlines()][:2] == [len(line) for line in our.splitlines()][:2]


def test_yaml_block_is_yaml(logs):
    yaml = pytest.importorskip("yaml")
    block = yaml.safe_load(logs[1][3].split("...")[0])
    assert block["keywords"][:3] == ["Step", "Temper", "KE"] and [row[0] for row in block["data"]] == [6, 8]


def test_tables_without_words(logs):
    """What pymatgen and lammps-logfile do: split the block at blanks."""
    for block in logs[1][:3]:
        title, *rows = (line.split() for line in block.splitlines())
        assert title[0] == "Step" and len(rows) == 2 and all(len(row) == len(title) for row in rows)
        assert np.isfinite(np.array(rows, float)).all()


def test_origin(tmp_path):
    text = """
units lj
region b block 0 6 0 6 0 6
create_box 1 b
create_atoms 1 random 20 1234 NULL overlap 1.0 maxtry 100
mass 1 1.0
velocity all create 1.0 4711
pair_style lj/cut 2.5
pair_coeff 1 1 1 1
fix 1 all langevin 1 1 1 999
fix 2 all nve
run 2
run 2
"""
    log = our_log(tmp_path, text)
    found = [line for line in log.splitlines() if line.startswith("# asemd")]
    digest = hashlib.sha256(hashlib.sha256(text.encode()).hexdigest().encode()).hexdigest()
    assert found == [f"# asemd {__version__}; inputs in.x sha256 {digest}; seeds 1234 (create_atoms), 4711 (velocity), 999 (fix langevin)"]
    assert our_log(tmp_path, text.replace("999", "998")).split("sha256 ")[1][:64] != digest


def test_errors_and_warnings_name_the_place(tmp_path):
    with pytest.raises(InputError, match=r"in\.x:3: mass 1 1"):
        our_log(tmp_path, "units lj\n\nmass 1 1\n")
    log = our_log(tmp_path, "region b block 0 4 0 4 0 4\ncreate_box 1 b\ncreate_atoms 1 single 1 1 1\nmass 1 1\npair_style zero 1\n"
                            "pair_coeff * *\nrun 0\n")
    assert re.search(r"^WARNING: no fixes with time integration, atoms won't move \(\S*in\.x:7: run 0\)$", log, re.M)


def test_vectors_of_thermo_style():
    session = asemd("region b block 0 4 0 4 0 4\ncreate_box 1 b\nthermo_style custom step c_thermo_press[*] c_thermo_temp[2*3]")
    assert session.scene.thermo.words == ("step", *(f"c_thermo_press[{k}]" for k in range(1, 7)), "c_thermo_temp[2]", "c_thermo_temp[3]")


@pytest.mark.parametrize(("cells", "cutoff", "special"), [
    (2, 1.5, "lj 1 1 1"), (6, 2.5, "lj 1 1 1"), (6, 2.5, "lj 0 0 1"), (6, 2.5, "lj 0.5 0 1"), (8, 1.1, "lj 0 1 1"),
], ids=["plain", "clusters", "excluded", "weighted", "rows"])
def test_neighbour_counts(tmp_path, cells, cutoff, special):
    """As many pairs in the list as LAMMPS has."""
    text = f"""units lj
atom_style bond
lattice fcc 0.8442
region b block 0 {cells} 0 {cells} 0 {cells}
create_box 1 b bond/types 1 extra/bond/per/atom 12 extra/special/per/atom 200
create_atoms 1 box
mass 1 1
bond_style zero
bond_coeff *
pair_style lj/cut {cutoff}
pair_coeff 1 1 1 1
group few id <= 30
create_bonds many few few 1 1.0 1.2
special_bonds {special}
velocity all create 1.44 87287 loop geom
fix 1 all nve
run 30
"""
    theirs = ask(THEIRS, log=str(tmp_path / "log.theirs"), lines=lines_of(text))
    found = [re.findall(r"^(Total # of neighbors|Neighbor list builds) = (.*)", log, re.M)
             for log in (theirs, our_log(tmp_path, text))]
    assert len(found[0]) == 2 and found[0] == found[1]


CHAIN = f"""4-chain

{COUNTS}2 atom types
{TYPES}0 10 xlo xhi
0 10 ylo yhi
0 10 zlo zhi

Masses

1 12
2 12

Atoms # full

1 1 1 0 1.0 1 1
2 1 1 0 2.0 1.3 1
3 1 2 0 3.0 1 1
4 1 2 0 4.0 1.2 1.4

Velocities

1 0 0 0
2 0 0 0
3 0 0 0
4 0 0 0

{ITEMS}"""
MADE_READY = """
units real
atom_style full
special_bonds lj 0 0.3 0.5 coul 0 0 0.25 angle yes dihedral yes
pair_style lj/cut 4
pair_modify mix arithmetic
bond_style harmonic
angle_style harmonic
dihedral_style harmonic
read_data chain.data extra/bond/per/atom 2 extra/angle/per/atom 1 extra/special/per/atom 3 extra/atom/types 1
mass 3 12
pair_coeff 1 1 0.1 2.0
pair_coeff 2 2 0.1 2.5
pair_coeff 3 3 0.1 2.5
pair_coeff 1 3 0.1 2.5
bond_coeff 1 200 1
angle_coeff 1 50 120
dihedral_coeff 1 1 1 2
fix 1 all nve
replicate 2 1 1
run 1
write_data out.data pair ij
delete_bonds all bond 1
delete_bonds all bond 1 undo special
special_bonds lj 0 0.5 1 coul 0 0 1 angle yes dihedral no
special_bonds lj 0.1 1 1 coul 0.2 1 1
special_bonds lj 0 1 1 coul 0.5 1 0.123456789
create_bonds single/bond 1 1 5
create_bonds single/angle 1 1 2 3 special no
pair_modify mix sixthpower
run 0
write_restart out.restart
reset_atoms id
reset_atoms mol all
delete_atoms overlap 0.01 all all
write_coeff coeff.txt
bond_write 1 10 0.5 1.5 bond.txt B
read_data chain.data add append shift 0 4 0
pair_style hybrid lj/cut 4 soft 3
pair_coeff 1 1 lj/cut 0.1 2
pair_coeff 2 2 lj/cut 0.1 2
pair_coeff 3 3 soft 1
pair_coeff 1*2 3 soft 1
run 0
pair_style hybrid/overlay lj/cut 4 soft 3
pair_coeff * * lj/cut 0.1 2
pair_coeff 1 1 soft 1
pair_coeff 2 2 soft 1
run 0
pair_style hybrid/overlay lj/cut 4 eam
pair_coeff * * lj/cut 0.1 2
pair_coeff 1 1 eam Cu_u3.eam
pair_coeff 2 2 eam Cu_u3.eam
pair_coeff 1 2 none
run 0
pair_style lj/class2 4
pair_modify mix arithmetic
pair_coeff 1 1 0.1 2
pair_coeff 2 2 0.1 2
pair_coeff 3 3 0.1 2
run 0
special_bonds fene
create_bonds many all all 1 0.1 0.2
clear
atom_style full
pair_style lj/cut 4
bond_style harmonic
angle_style harmonic
dihedral_style harmonic
read_restart out.restart
run 0
clear
atom_style bond
region b block 0 5 0 5 0 5
create_box 1 b bond/types 1 extra/bond/per/atom 2 extra/special/per/atom 3
mass 1 1
create_atoms 1 single 1 1 1
create_atoms 1 single 2 1 1
create_bonds single/bond 1 1 2
replicate 1 1 2
write_data none.data
"""
LINE = re.compile(r"(Finding|System init|Generated|Ave special|Neighbor list info|Reading data file|  +\d+ = max|  restoring|"
                  r"  (special bond factors|update|master list|reading|scanning|orthogonal|\d+ = )|"
                  r"  \d+ (atoms|velocities|bonds|angles|dihedrals)$)")


def test_lines_of_the_setup(tmp_path, monkeypatch):
    """Data files, bonded partners, mixed coefficients: what LAMMPS says of them, with its counts. It describes its list more often."""
    logs = []
    for name in ("theirs", "ours"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "chain.data").write_text(CHAIN)
    monkeypatch.chdir(tmp_path / "theirs")
    folder = str(tmp_path / "theirs")
    lines = [*lines_of(MADE_READY), "log none"]
    logs.append(ask("import os; os.chdir(given['folder'])\n" + THEIRS, folder=folder, log="log.theirs", lines=lines))
    monkeypatch.chdir(tmp_path / "ours")
    logs.append(our_log(tmp_path / "ours", MADE_READY))
    of_list = ("Neighbor list info", "  update", "  master list")
    theirs, ours = ([line.rstrip() for line in log.splitlines() if LINE.match(line)] for log in logs)
    plain = [[line for line in lines if not line.startswith(of_list)] for lines in (theirs, ours)]
    assert plain[1] == plain[0] and len(plain[0]) > 150
    lists = [list(dict.fromkeys(line for line in lines if line.startswith(of_list))) for lines in (theirs, ours)]
    assert lists[0] == lists[1]


def test_list_is_described_when_it_changes(tmp_path):
    text = "units lj\nregion b block 0 6 0 6 0 6\ncreate_box 1 b\ncreate_atoms 1 random 20 1234 NULL overlap 1.0 maxtry 100\nmass 1 1\n" \
           "pair_style lj/cut 2.5\npair_coeff 1 1 1 1\nfix 1 all nve\nrun 1\nrun 1\nneigh_modify every 5 delay 10\nrun 1\n"
    found = re.findall(r"^  update: .*", our_log(tmp_path, text), re.M)
    assert found == ["  update: every = 1 steps, delay = 0 steps, check = yes", "  update: every = 5 steps, delay = 10 steps, check = yes"]
