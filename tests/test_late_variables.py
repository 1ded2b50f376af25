"""Variables that fixes, computes and output go by may come after them, before the run."""
from __future__ import annotations

import pytest
from four_ions import FOUR_IONS
from wheel import ask, ran

from asemd.errors import InputError

SCENE = """units lj
atom_style full
region b block 0 9 0 9 0 9
create_box 2 b bond/types 1 extra/bond/per/atom 2 extra/special/per/atom 4
""" + FOUR_IONS + """bond_style harmonic
bond_coeff 1 1 1
create_bonds single/bond 1 1 2
pair_style lj/cut/coul/long 3
pair_coeff * * 1 1
pair_modify table 0
kspace_style ewald 1e-4
timestep 0.001
velocity all create 1 4711
"""
THEN = "\nvariable e equal 0.5+0.001*step\nvariable a atom 0.1*x\nvariable n equal step+1\nfix n all nve\nrun 2"
USERS = ["fix 1 all adapt 1 pair lj/cut/coul/long epsilon * * v_e", "fix 1 all adapt 1 kspace v_e",
         "fix 1 all adapt 1 bond harmonic k 1 v_e", "fix 1 all addforce v_e v_a 0",
         "fix 1 all setforce v_e v_a NULL", "fix 1 all aveforce v_e 0 0",
         "fix 1 all efield v_e v_a 0 energy v_a", "fix 1 all indent 10 sphere v_e v_e v_e v_e", "fix 1 all temp/berendsen v_e 1 1",
         "fix 1 all heat 1 v_e", "fix 1 all deform 1 x variable v_e v_e", "fix 1 all gravity v_e vector 1 0 0", "thermo v_n",
         "compute t all ti lj/cut/coul/long 1 v_e v_e kspace 1 v_e v_e\nfix 1 all ave/time 1 1 1 c_t",
         "compute t all fep 1 pair lj/cut/coul/long epsilon 1 2 v_e\nfix 1 all ave/time 1 1 1 c_t[1]"]
ASK = """
answer = []
for text in given["scripts"]:
    lmp = ran(text)
    answer.append([lmp.get_thermo("pe"), lmp.get_thermo("press"), lmp.extract_fix("1", 0, 0) if "ave/time" in text else 0.0])
    lmp.close()
"""


@pytest.fixture(scope="module")
def theirs():
    return dict(zip(USERS, ask(ASK, scripts=[SCENE + user + THEN for user in USERS]), strict=True))


@pytest.mark.parametrize("user", USERS)
def test_like_lammps(user, theirs):
    lmp = ran(SCENE + user + THEN)
    average = lmp.extract_fix("1", 0, 0) if "ave/time" in user else 0.0
    assert [lmp.get_thermo("pe"), lmp.get_thermo("press"), average] == pytest.approx(theirs[user], rel=1e-10)


def test_fix_adapt_before_its_pair_style():
    later = SCENE.replace("pair_style", "fix 1 all adapt 1 pair lj/cut/coul/long epsilon * * v_e\npair_style")
    assert ran(later + THEN).get_thermo("pe") == ran(SCENE + USERS[0] + THEN).get_thermo("pe")


@pytest.mark.parametrize("user, message", [
    ("fix 1 all addforce v_missing 0 0", r"fix 1 \(style addforce\): undefined variable missing"),
    ("fix 1 all adapt 1 kspace v_a", r"variable a has style atom, it must be equal"),
    ("fix 1 all adapt 1 pair lj/cut epsilon * * v_e", "no pair style 'lj/cut' in use"), ("thermo v_missing", "thermo: undefined variable"),
    ("dump d all atom 1 {}/d\ndump_modify d every v_missing", "dump d: undefined variable"),
    ("restart v_a {}/r", "restart: variable a must have style equal"),
    ("fix 1 all efield 1 v_a 0 energy v_e", r"fix 1 \(style efield\): variable e must be of style atom"),
    ("compute t all ti kspace 1 v_e v_a\nfix 1 all ave/time 1 1 1 c_t", "variable a has style atom where one number"),
])
def test_what_is_missing_or_of_another_style_is_told_when_the_run_begins(user, message, tmp_path):
    with pytest.raises(InputError, match=message):
        ran(SCENE + user.format(tmp_path) + THEN)
