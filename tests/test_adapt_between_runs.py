"""``fix adapt`` over several runs: what coefficients and factors are when a run begins, what is reset, what restart files keep."""
from __future__ import annotations

import pytest
from four_ions import FOUR_IONS
from wheel import ask, ran, start

from asemd.errors import InputError

SCENE = """atom_style charge
region b block 0 9 0 9 0 9
create_box 2 b
""" + FOUR_IONS + """variable e equal 0.4
variable g equal 0.7
variable s equal 0.5+0.1*step
timestep 0.001
"""
OUT = "fix n all nve\nthermo_style custom step pe elong\nthermo_modify norm no\n"
EWALD = "pair_modify table 0\nkspace_style ewald 1e-4\n"
STYLES = {"coul/debye": "0.3 4", "coul/cut": "4", "coul/slater/cut": "1.2 4", "coul/long": "4", "lj/cut": "3"}
CASES = {}
for name, words in STYLES.items():
    key, solver = ("epsilon" if name == "lj/cut" else "scale"), EWALD * name.endswith("long")
    coeff = "pair_coeff * *" + " 1 1" * (name == "lj/cut")
    first = f"pair_style {name} {words}\n{coeff}\n{solver}{OUT}"
    some = f"fix a all adapt 0 pair {name} {key} 1 2 v_e pair {name} {key} * 1 v_g"
    CASES |= {
        f"{name}, new coefficients": [first + some, "run 1", "unfix a\nrun 1", coeff.replace("* *", "1 1") + "\nrun 1", coeff + "\nrun 1"],
        f"{name}, the style again": [first + some, "run 1", f"unfix a\npair_style {name} {words}\nrun 1"],
        f"{name}, restart": [first + some, "run 1", f"write_restart FILE\nclear\nread_restart FILE\n{solver}{OUT}run 1"],
        f"{name}, two fixes": [first + f"fix a all adapt 1 pair {name} {key} * * v_e scale yes reset yes\n"
                               f"fix b all adapt 1 pair {name} {key} 1 1 v_s scale yes reset yes", "run 1", "unfix a\nrun 1",
                               "unfix b\nrun 1"]}
charged = f"pair_style coul/long 4\npair_coeff * *\n{EWALD}{OUT}"
for reset in ("yes", "no"):
    for n in (0, 1):
        CASES[f"solver, every {n}, reset {reset}"] = [
            charged + f"fix a all adapt {n} kspace v_e pair coul/long scale * * v_g reset {reset}",
            "run 1", "run 2 pre no", "run 1", "unfix a\nrun 1"]
        CASES[f"charges, every {n}, reset {reset}"] = [
            charged + f"fix a all adapt {n} atom charge v_e reset {reset}", "run 1", "run 2 pre no", "run 1"]
HYBRID = ("pair_style hybrid/overlay lj/cut 3 lj/cut 4 coul/cut 4\npair_coeff * * lj/cut 1 1 1\npair_coeff * * lj/cut 2 0.5 1.2\n"
          f"pair_coeff * * coul/cut\n{OUT}fix a all adapt 1 ")
CASES |= {f"sub-style, {words}": [HYBRID + words, "run 1"] for words in (
    "pair lj/cut:1 epsilon * * v_e", "pair lj/cut:2 epsilon 1 2 v_e pair lj/cut:1 sigma * 1 v_g scale yes",
    "pair coul/cut:1 scale * * v_e")}
MEASURE = """
def measure(lmp, scene, texts):
    out = []
    for text in [scene + texts[0], *texts[1:]]:
        lmp.commands_string(text)
        out += [lmp.get_thermo("pe"), lmp.get_thermo("elong"), *lmp.gather_atoms("f", 1, 3)] if "run" in text else []
    lmp.close()
    return out
"""


def texts_of(name, folder):
    return [text.replace("FILE", str(folder / "r.x")) for text in CASES[name]]


@pytest.fixture(scope="module")
def theirs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lammps")
    cases = {name: texts_of(name, folder) for name in CASES}
    return ask(MEASURE + "answer = {name: measure(start(), given['scene'], t) for name, t in given['cases'].items()}", scene=SCENE,
               cases=cases)


@pytest.mark.parametrize("name", CASES)
def test_like_lammps(name, theirs, tmp_path):
    found = {}
    exec(MEASURE, found)
    got, want = found["measure"](start(), SCENE, texts_of(name, tmp_path)), theirs[name]
    assert got == pytest.approx(want, rel=1e-9, abs=1e-9 * max(map(abs, want)))


def test_a_sub_style_that_is_not_there():
    with pytest.raises(InputError, match="no pair style 'lj/cut:3' in use"):
        ran(SCENE + HYBRID + "pair lj/cut:3 epsilon * * v_e")
