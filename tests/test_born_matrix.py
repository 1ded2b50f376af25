"""Compute born/matrix: LAMMPS's values where they are the second derivatives of its energy, differences of the virial elsewhere."""
from __future__ import annotations

import numpy as np
import pytest
from wheel import ask, ran

from asemd.errors import InputError

LENGTH, MOLECULES = 14.0, 10
STYLES = {
    "bond harmonic": "bond_style harmonic\nbond_coeff 1 30 1.4", "bond morse": "bond_style morse\nbond_coeff 1 30 1 1.4",
    "bond fene": "bond_style fene\nbond_coeff 1 30 3 0.1 1.4", "angle harmonic": "angle_style harmonic\nangle_coeff 1 20 100",
    "angle cosine": "angle_style cosine\nangle_coeff 1 20", "dihedral opls": "dihedral_style opls\ndihedral_coeff 1 2 1 2 0.5",
    "improper harmonic": "improper_style harmonic\nimproper_coeff 1 20 30",
    "pair morse": "pair_style morse 6.9\npair_coeff 1 1 0.5 2.4 1.2",
}
SAME = ("bond harmonic", "bond morse", "bond fene", "angle harmonic", "angle cosine")       # LAMMPS has these right
CRYSTAL = """
units lj
lattice fcc 1.0
region b prism 0 3 0 3 0 4 0.4 0.2 -0.3
create_box 2 b
create_atoms 1 box
set group all type/fraction 2 0.4 123
mass * 1
displace_atoms all random 0.07 0.05 0.06 421
velocity all create 1.0 4321
pair_style lj/cut 1.9
pair_coeff 1 1 1 1
pair_coeff 2 2 0.7 0.9
group some type 1
compute whole all pressure thermo_temp
compute f all born/matrix
compute g some born/matrix pair
compute h all born/matrix numdiff 1e-5 whole
thermo_modify norm no
thermo_style custom step pe c_f[1] c_g[1] c_h[1]
"""
THEIRS = """
def value(name):
    found = lmp.extract_compute(name, 0, 1)
    return [found[k] for k in range(21)]

answer = {}
for name, (lines, names) in given["scenes"].items():
    lmp = ran(lines)
    answer[name] = {k: np.array(value(k)) for k in names}
    lmp.close()
"""


def write_chains(path) -> None:
    """Chains of five atoms that bend and turn."""
    rng = np.random.default_rng(3)
    x = []
    for _ in range(MOLECULES):
        p, d = rng.uniform(0, LENGTH, 3), rng.normal(size=3)
        for _ in range(5):
            x.append(p)
            d = d / np.linalg.norm(d) + 0.6 * rng.normal(size=3)
            p = p + 1.4 * rng.uniform(0.9, 1.1) * d / np.linalg.norm(d)
    items = {name: [tuple(range(1 + s + k, 1 + s + k + size)) for s in range(0, 5 * MOLECULES, 5) for k in range(6 - size)]
             for name, size in (("bond", 2), ("angle", 3), ("dihedral", 4), ("improper", 4))}
    lines = ["chains", "", f"{len(x)} atoms", "1 atom types", *(f"{len(v)} {k}s\n1 {k} types" for k, v in items.items()),
             *(f"0 {LENGTH} {a}lo {a}hi" for a in "xyz"), "", "Masses", "", "1 12", "", "Atoms # molecular", ""]
    lines += [f"{k + 1} {k // 5 + 1} 1 {p[0]:.17g} {p[1]:.17g} {p[2]:.17g}" for k, p in enumerate(x)]
    for name, rows in items.items():
        lines += ["", f"{name.title()}s", "", *(f"{k + 1} 1 {' '.join(map(str, row))}" for k, row in enumerate(rows))]
    path.write_text("\n".join(lines) + "\n")


def prepare(data, style: str) -> tuple[list[str], list[str]]:
    bonded = ("bond", "angle", "dihedral", "improper")
    lines = ["units real", "atom_style molecular", "pair_style zero 4.0", *(f"{c}_style zero" for c in bonded), f"read_data {data}",
             "pair_coeff * *", *(f"{c}_coeff *" for c in bonded)]
    lines += [*STYLES[style].splitlines(), "group part id 1:23 31:48", "compute vir all pressure NULL virial", "thermo_modify norm no"]
    computes = {"h": "all born/matrix numdiff 1e-5 vir"}
    if style in SAME:
        computes |= {"f": f"all born/matrix {style.split()[0]}", "g": f"part born/matrix {style.split()[0]}"}
    lines += [f"compute {k} {v}" for k, v in computes.items()]
    return [*lines, "thermo_style custom step pe " + " ".join(f"c_{k}[1]" for k in computes), "run 0"], list(computes)


@pytest.fixture(scope="module")
def scenes(tmp_path_factory):
    data = tmp_path_factory.mktemp("born") / "chains.data"
    write_chains(data)
    lines = [line for line in CRYSTAL.splitlines() if line]
    return {style: prepare(data, style) for style in STYLES} | {"crystal": ([*lines, "run 0"], ["f", "g", "h"])}


@pytest.fixture(scope="module")
def theirs(scenes):
    return ask(THEIRS, scenes=scenes)


def close(a, b, tolerance):
    np.testing.assert_allclose(a, b, rtol=0, atol=tolerance * np.abs(b).max())


@pytest.mark.parametrize("style", STYLES)
def test_bonded_and_pair(style, scenes, theirs):
    """Differences as LAMMPS's; second derivatives agree with them."""
    lines, names = scenes[style]
    lmp = ran(lines)
    for k in names:
        close(lmp.extract_compute(k, 0, 1), theirs[style][k], 1e-7 if k == "h" else 1e-12)
    lmp.command("compute own all born/matrix")
    close(lmp.extract_compute("own", 0, 1), theirs[style]["h"], 1e-7)
    lmp.close()


def test_crystal(scenes, theirs):
    """LAMMPS's own values of pairs by -compat lammps; the pressure with its kinetic part enters those of numdiff."""
    lmp = ran(scenes["crystal"][0], "-compat", "lammps")
    for k in "fgh":
        close(lmp.extract_compute(k, 0, 1), theirs["crystal"][k], 1e-7 if k == "h" else 1e-12)
    lmp.close()


@pytest.mark.parametrize(("words", "message"), [
    ("pears", "did you mean pair"), ("numdiff 1e-4", "needs 2 values"), ("numdiff 0 vir", "must be positive"),
    ("numdiff 1e-4 thermo_temp", "does not compute a pressure"), ("numdiff 1e-4 vit", "did you mean vir"),
    ("numdiff 1e-4 vir pair", "unexpected word"), ("pair numdiff 1e-4 vir", "cannot be mixed"),
])
def test_mistakes(words, message):
    lmp = ran(["units lj", "region b block 0 5 0 5 0 5", "create_box 1 b", "compute vir all pressure NULL virial"])
    with pytest.raises(InputError, match=message):
        lmp.command(f"compute wrong all born/matrix {words}")
    lmp.close()


def test_style_without_second_derivatives():
    lmp = ran(["units lj", "region b block 0 5 0 5 0 5", "create_box 1 b", "create_atoms 1 single 1 1 1", "create_atoms 1 single 2 1 1",
               "mass * 1", "pair_style dpd 1.0 2.0 123", "pair_coeff 1 1 1 1", "compute f all born/matrix", "run 0"])
    with pytest.raises(InputError, match="pair style dpd"):
        lmp.extract_compute("f", 0, 1)
    lmp.close()
