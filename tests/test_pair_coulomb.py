"""Pair styles with charges, compared with LAMMPS: energies, stress and forces of short chains whose partners have weights."""
from __future__ import annotations

import numpy as np
import pytest
from both import lines_of
from test_pair_hybrid import chain
from test_pair_styles import setup
from wheel import ask

from asemd import style
from asemd.lammps.session import Session
from asemd.lammps.switches import Switches

COLUMNS = ("evdwl", "ecoul", "etail", "pxx", "pyy", "pzz", "pxy", "pxz", "pyz")
HALF = "special_bonds lj/coul 0 0.3 0.5\n"
BORN = "pair_coeff * * 600 0.3 2.2 20 30\npair_coeff 1 2 500 0.3 2.1 10 5 4\n"
SOLVER = "\nkspace_style ewald 1e-4\nkspace_modify gewald 0.3 compute no\npair_modify table 0"
LJ = "pair_coeff 1 1 0.1 2.5\npair_coeff 2 2 0.3 2.2\n"
CASES = {      # name of the style, and what makes a case another one -> commands
    "coul/debye": "pair_style coul/debye 0.3 7\npair_coeff * *\npair_coeff 2 2 6",
    "lj/cut/coul/debye": "pair_style lj/cut/coul/debye 0.3 5 7\npair_coeff 1 1 0.1 2.5 4 6\npair_coeff 2 2 0.3 2.2\npair_modify shift yes",
    "lj/cut/coul/debye tail": "pair_style lj/cut/coul/debye 0.3 6\n" + LJ + "pair_modify tail yes mix sixthpower",
    "coul/dsf": "pair_style coul/dsf 0.2 7\npair_coeff * *",
    "coul/wolf": "pair_style coul/wolf 0.25 7\npair_coeff * *",
    "coul/wolf factor": "pair_style hybrid/scaled 0.7 coul/wolf 0.25 7 0.3 coul/dsf 0.1 5\npair_coeff * * coul/dsf\n"
            "pair_coeff 1 1 coul/wolf",
    "lj/cut/coul/dsf": "pair_style lj/cut/coul/dsf 0.1 5 7\n" + LJ + "dielectric 1.5",
    "lj/cut/coul/wolf": "pair_style lj/cut/coul/wolf 0.1 6\n" + LJ + "pair_modify shift yes",
    "born/coul/wolf": "pair_style born/coul/wolf 0.1 5 7\n" + BORN,
    "born/coul/dsf": "pair_style born/coul/dsf 0.1 5 7\n" + BORN,
    "buck6d/coul/gauss/dsf": "pair_style buck6d/coul/gauss/dsf 0.9 5 7\npair_coeff * * 10304 3.06 457.2 4.06 0.61\n"
            "pair_coeff 1 2 9000 2.9 400 3 0.5 6",
    "buck6d/coul/gauss/dsf unswitched": "pair_style buck6d/coul/gauss/dsf 1 5 7\npair_coeff * * 10304 3.06 457.2 4.06 0.61\n"
            "pair_modify shift yes",
    "lj/class2/coul/cut": "pair_style lj/class2/coul/cut 5 7\npair_coeff 1 1 0.1 2.5 4 6\npair_coeff 2 2 0.3 2.2\npair_modify tail yes",
    "nm/cut/coul/cut": "pair_style nm/cut/coul/cut 5 7\npair_coeff * * 0.1 3 9 6\npair_coeff 1 2 0.2 2.9 8 5 4 6\npair_modify tail yes",
    "lj/cut/coul/cut/soft": "pair_style lj/cut/coul/cut/soft 2 0.5 5 5 7\npair_coeff * * 0.1 2.5 0.7\npair_modify shift yes",
    "lj/cut/coul/cut/soft tail": "pair_style lj/cut/coul/cut/soft 1 0.5 5 7\npair_coeff * * 0.1 2.5 0.7\npair_modify tail yes",
    "lj/class2/coul/cut/soft": "pair_style lj/class2/coul/cut/soft 2 0.5 5 5 7\npair_coeff * * 0.1 2.5 0.7",
    "lj/gromacs/coul/gromacs": "pair_style lj/gromacs/coul/gromacs 4 5 5 7\n" + LJ,
    "coul/exclude": "pair_style coul/exclude 7\npair_coeff * *",
    "coul/long": "pair_style coul/long 7\npair_coeff * *" + SOLVER,
    "coul/long factor": "pair_style hybrid/scaled 0.7 coul/long 7 0.5 lj/cut 5\npair_coeff * * coul/long\n"
            "pair_coeff * * lj/cut 0.1 2" + SOLVER,
    "born/coul/long": "pair_style born/coul/long 5 7\n" + BORN + SOLVER,
    "buck/coul/long": "pair_style buck/coul/long 5 7\npair_coeff * * 1000 0.3 20\npair_modify tail yes" + SOLVER,
    "lj/class2/coul/long": "pair_style lj/class2/coul/long 5 7\n" + LJ + SOLVER,
    "nm/cut/coul/long": "pair_style nm/cut/coul/long 5 7\npair_coeff * * 0.1 3 9 6" + SOLVER,
    "lj/expand/coul/long": "pair_style lj/expand/coul/long 5 7\npair_coeff 1 1 0.1 2.5 0.3\npair_coeff 2 2 0.3 2.2 0.1 4" + SOLVER,
    "lj/charmm/coul/long": "pair_style lj/charmm/coul/long 4 5 7\n" + LJ + SOLVER,
    "lj/charmmfsw/coul/long": "pair_style lj/charmmfsw/coul/long 4 5 7\n" + LJ + SOLVER,
    "lj/spica/coul/long": "pair_style lj/spica/coul/long 5 7\npair_coeff * * lj9_6 0.1 2.5" + SOLVER,
    "lj/sdk/coul/long": "pair_style lj/sdk/coul/long 5 7\npair_coeff * * lj12_4 0.1 2.5 4" + SOLVER,
    "coul/long/soft": "pair_style coul/long/soft 2 5 7\npair_coeff * * 0.7" + SOLVER,
    "lj/cut/coul/long/soft": "pair_style lj/cut/coul/long/soft 2 0.5 5 5 7\npair_coeff * * 0.1 2.5 0.7" + SOLVER,
    "lj/class2/coul/long/soft": "pair_style lj/class2/coul/long/soft 2 0.5 5 5 7\npair_coeff * * 0.1 2.5 0.7" + SOLVER,
    "lj/charmm/coul/long/soft": "pair_style lj/charmm/coul/long/soft 2 0.5 5 4 5 7\npair_coeff * * 0.1 2.5 0.7" + SOLVER,
    "coul/wolf/cs": "pair_style coul/wolf/cs 0.25 7\npair_coeff * *",
    "born/coul/wolf/cs": "pair_style born/coul/wolf/cs 0.1 5 7\n" + BORN,
    "born/coul/dsf/cs": "pair_style born/coul/dsf/cs 0.1 5 7\n" + BORN,
    "coul/long/cs": "pair_style coul/long/cs 7\npair_coeff * *" + SOLVER,
    "born/coul/long/cs": "pair_style born/coul/long/cs 5 7\n" + BORN + SOLVER,
    "buck/coul/long/cs": "pair_style buck/coul/long/cs 5 7\npair_coeff * * 1000 0.3 20" + SOLVER,
    "lj/class2/coul/long/cs": "pair_style lj/class2/coul/long/cs 5 7\n" + LJ + SOLVER,
    "lj/cut/coul/long/cs": "pair_style lj/cut/coul/long/cs 5 7\n" + LJ + SOLVER,
    "lj/switch3/coulgauss/long": "pair_style lj/switch3/coulgauss/long 5 1.5\npair_coeff 1 1 0.1 2.5 1.2\n"
            "pair_coeff 2 2 0.3 2.2 0.7 4" + SOLVER,
    "mm3/switch3/coulgauss/long": "pair_style mm3/switch3/coulgauss/long 5 7 1.5\npair_coeff 1 1 0.1 2 1.2\n"
            "pair_coeff 2 2 0.3 1.9 0.7" + SOLVER,
    "coul/slater/long": "pair_style coul/slater/long 1.5 7\npair_coeff * *" + SOLVER,
    "buck6d/coul/gauss/long": "pair_style buck6d/coul/gauss/long 0.9 0.9 5 7\npair_coeff * * 10304 3.06 457.2 4.06 0.61\n"
            "pair_coeff 1 2 9000 2.9 400 3 0.5 6" + SOLVER,
    "buck6d/coul/gauss/long unswitched": "pair_style buck6d/coul/gauss/long 1 1 5\npair_coeff * * 10304 3.06 457.2 4.06 0.61" + SOLVER,
    "coul/long table": "pair_style coul/long 7\npair_coeff * *" + SOLVER[:-1] + "12",
    "coul/long/cs table": "pair_style coul/long/cs 7.1\npair_coeff * *" + SOLVER[:-1] + "14 tabinner 1.3",
    "buck/coul/long table": "pair_style buck/coul/long 5 6\npair_coeff * * 1000 0.3 20" + SOLVER[:-1] + "16",
    "lj/switch3/coulgauss/long table": "pair_style lj/switch3/coulgauss/long 5 1.5\npair_coeff * * 0.1 2.5 1.2" + SOLVER[:-1] + "10",
    "lepton/coul": "pair_style lepton/coul 7\npair_coeff * * 'qi*qj/r*exp(-0.3*r)'\npair_coeff 1 2 'qi*qj*(1/r-1/r^2)' 6",
    "lepton/coul solver": "pair_style lepton/coul 7 ewald\npair_coeff * * 'qi*qj/r*erfc(0.3*r)'"
                          "\nkspace_style ewald 1e-4\nkspace_modify gewald 0.3 compute no",
    "coul/cut/global": "pair_style coul/cut/global 7\npair_coeff * *",
    "coul/diel": "pair_style coul/diel 7\npair_coeff * * 78 2.5 0.8",
    "coul/slater/cut": "pair_style coul/slater/cut 2.5 7\npair_coeff * *\npair_coeff 1 1 6",
    "coul/shield": "pair_style coul/shield 7\npair_coeff * * 0.7",
    "coul/shield plain": "pair_style coul/shield 7 0\npair_coeff * * 0.7\npair_coeff 1 2 0.7 6",
    "coul/shield taper": "pair_style coul/shield 7 1\npair_coeff * * 0.7 6",
    "coul/cut/soft": "pair_style coul/cut/soft 2 5 7\npair_coeff * * 0.7\npair_coeff 2 2 0.7 6",
    "lj/charmm/coul/charmm/implicit": "pair_style lj/charmm/coul/charmm/implicit 4 6 5 7\n" + LJ,
    "buck/coul/cut": "pair_style buck/coul/cut 5 7\npair_coeff * * 1000 0.3 20\npair_coeff 1 2 900 0.25 10 4 6\npair_modify shift yes",
    "buck/coul/cut tail": "pair_style buck/coul/cut 5\npair_coeff * * 1000 0.3 20\npair_modify tail yes",
}
UNASKED = "tables unasked"        # LAMMPS has them where the input says nothing
CASES |= {f"{name} {UNASKED}": text.removesuffix("\npair_modify table 0") for name, text in CASES.items() if text.endswith("table 0")}
THEIRS = """
import numpy as np
answer = {}
for name, lines in given["cases"].items():
    lmp = start()
    try:
        for line in lines:
            lmp.command(line)
        answer[name] = {"thermo": [lmp.get_thermo(c) for c in given["columns"]], "f": np.array(lmp.gather_atoms("f", 1, 3))}
    except Exception as e:
        answer[name] = {"error": str(e)}
    lmp.close()
"""


def ours(text: str, compat: str = ""):
    switches = Switches()
    switches.log, switches.compat = "none", compat
    session = Session(switches=switches, screen=lambda text: None)
    session.commands("\n".join(lines_of(text)) + "\n")
    return session


def script(name: str, special: str) -> str:
    return chain() + special + CASES[name] + "\ndisplace_atoms all random 0.1 0.1 0.1 4711\nrun 0\n"


@pytest.fixture(scope="module")
def theirs():
    return ask(THEIRS, cases={f"{name}|{special}": lines_of(script(name, special)) for name in CASES for special in ("", HALF)},
               columns=COLUMNS)


@pytest.mark.part(10)
@pytest.mark.parametrize("special", ["", HALF], ids=["weights", "left out"])
@pytest.mark.parametrize("name", CASES)
def test_like_lammps(theirs, name, special):
    expected = theirs[f"{name}|{special}"]
    assert "error" not in expected, expected
    twin = style.find("pair", name.split()[0]).twin is not None
    session = ours(script(name, special), "lammps" if twin or UNASKED in name else "")
    system = session.scene.system
    other = np.reshape(expected["f"], (-1, 3))
    atol = (1e-11 if "/cs" in name else 1e-12) * np.abs(other).max()
    np.testing.assert_allclose(system.f[np.argsort(system.id)], other, rtol=0, atol=atol)
    row = [session.variables.evaluate(c) for c in COLUMNS]
    np.testing.assert_allclose(row, expected["thermo"], rtol=1e-11, atol=1e-11)


@pytest.mark.parametrize("name", ["coul/debye", "coul/shield plain"])
def test_many_atoms_are_the_same(name):
    """Clusters, and special pairs one by one, give what the plain list of few atoms gives."""
    check_many(name)


def check_many(name):
    small, large = (ours(chain() + CASES[name] + f"\n{more}\nrun 0") for more in ("print x", "replicate 3 3 3"))
    assert large.loop.engine.mode == "cluster" and small.loop.engine.mode == "plain"
    sums = [s.variables.evaluate("evdwl+ecoul") for s in (small, large)]
    assert 27 * sums[0] == pytest.approx(sums[1], rel=1e-11)
    forces = [s.scene.system.f[np.argsort(s.scene.system.id)] for s in (small, large)]
    np.testing.assert_allclose(forces[0], forces[1][:len(forces[0])], rtol=0, atol=1e-11 * np.abs(forces[0]).max())


@pytest.mark.parametrize("name", [n for n in style.names("pair") if (s := style.find("pair", n)).parts and s.charged and not s.many])
def test_second_derivatives(name):
    """Those of each part that has them are differences of the first ones (those of LAMMPS's erfc are good to 1e-5)."""
    s = style.find("pair", name)
    s, tables, _ = setup(name, s.settings_example, {(1, 1): s.example}, ntypes=1)
    row = constant = 0
    for part in s.parts:
        cut2, _, *values = tables.rows[row:row + 2 + len(part.rows), 1, 1]
        numbers = tables.constants[constant:constant + len(part.constants)]
        row, constant = row + 2 + len(part.rows), constant + len(part.constants)
        given = [-302.0] * part.charged + values + list(numbers)
        for r in np.array([0.13, 0.35, 0.6, 0.75, 0.95]) * cut2**0.5 if getattr(part.function, "d2", None) else ():
            x = r * r if part.coordinate == "r2" else r
            slopes = [part.function(x * (1.0 + 1e-5 * k), *given)[1] for k in (-2, -1, 0, 1, 2)]
            want = (slopes[0] - 8.0 * slopes[1] + 8.0 * slopes[3] - slopes[4]) / (12e-5 * x)
            scale = abs(want) + abs(slopes[2]) / x
            assert abs(part.function.d2(x, *given) - want) <= (3e-5 if "gradient" in s.xfail else 1e-6) * scale, (part.function, r)
