"""fix bond/swap makes the swaps that LAMMPS makes, whatever the order in which atoms and neighbours are looked at."""
from __future__ import annotations

import numpy as np
import pytest
from both import asemd, lines_of
from wheel import ask

from asemd.errors import InputError

MELT = """
units lj
{newton}
atom_style full
special_bonds lj/coul 0 1 1
pair_style {pair}
pair_modify shift yes
bond_style harmonic
{angle}
read_data {data}
pair_coeff * * 1 1
bond_coeff 1 5 0.97
bond_coeff 2 5 {length}
{coeff}
comm_modify cutoff 3.5
neighbor 0.4 {lists}
{more}
velocity all create 2.0 8731
compute t all temp
fix 1 all nve
fix 2 {group} bond/swap {every} {fraction} {cutoff} {seed}
timestep 0.003
thermo_modify norm no
run {steps}
"""
COMMON = {"newton": "", "pair": "lj/cut 1.12246", "angle": "angle_style harmonic", "coeff": "angle_coeff * 1 120", "lists": "bin",
          "more": "", "group": "all", "every": 1, "fraction": 0.5, "cutoff": 1.9, "seed": 598934, "steps": 40, "tilt": False, "length": 1.0}
UNSORTED = "atom_modify sort 0 0"
CASES = {
    "bins": {},
    "unsorted": {"more": UNSORTED},
    "no bins": {"lists": "nsq", "more": UNSORTED, "seed": 77},
    "all pairs": {"lists": "nsq", "pair": "lj/cut 2.5", "seed": 99},
    "sorted anew": {"more": "atom_modify sort 10 0.9", "steps": 60},
    "two runs": {"steps": "30\nrun 30", "fraction": 1.0},
    "newton off": {"newton": "newton off", "seed": 5, "length": 0.97},
    "bonds of both": {"newton": "newton on off", "more": UNSORTED, "length": 0.97},
    "every": {"every": 3, "more": "group chains id 1:120", "group": "chains", "cutoff": 2.2, "steps": 60},
    "no angles": {"angle": "", "coeff": "", "steps": 30},
    "tilted": {"tilt": True, "seed": 4},
    "excluded": {"more": "group few id 1:90:3\nneigh_modify exclude group few few", "seed": 31},
    "temperature": {"more": "compute warm all temp\ncompute_modify warm extra/dof -2000", "steps": "0\nfix_modify 2 temp warm\nrun 30"},
}
SCRIPT = """
import numpy as np
answer = {}
for name, lines in given["cases"].items():
    lmp = ran(lines)
    bonds = np.array(lmp.gather_bonds()[1]).reshape(-1, 3)
    answer[name] = {"x": by_id(lmp, "x").tolist(), "pe": lmp.get_thermo("pe"),
                    "vector": [lmp.extract_fix("2", 0, 1, i) for i in (0, 1)],
                    "bonds": sorted([int(min(b[1:])), int(max(b[1:]))] for b in bonds)}
    lmp.close()
"""


def write_chains(path, angles: bool, tilt: bool) -> str:
    """24 chains of 8 beads; molecule numbers count from both ends."""
    rng = np.random.default_rng(3)
    length, per = 7.2, 8
    x, number, bonds, bends = [], [], [], []
    for c in range(24):
        for m in range(per):
            x.append((0.1 + 0.88 * m, 0.4 + 1.35 * (c // 5) + 0.1 * (m % 2), 0.5 + 1.35 * (c % 5)))
            number.append(min(m, per - 1 - m) + 1)
            k = len(x)
            if m:
                bonds.append((k - 1, k) if (k + c) % 3 else (k, k - 1))
            if m > 1:
                bends.append((k - 2, k - 1, k))
    x = np.array(x) + rng.normal(0, 0.04, (len(x), 3))
    bends = bends if angles else []
    lines = ["chains", "", f"{len(x)} atoms", f"{len(bonds)} bonds", f"{len(bends)} angles", "1 atom types", "2 bond types"]
    lines += ["1 angle types"]
    lines += ["", *(f"0 {length} {a}lo {a}hi" for a in "xyz"), *["0.8 0.3 -0.5 xy xz yz"] * tilt, "", "Masses", "", "1 1", ""]
    lines += ["Atoms # full", ""]
    lines += [f"{i} {m} 1 0 {' '.join(map(repr, p.tolist()))}" for i, (m, p) in enumerate(zip(number, x), 1)]
    lines += ["", "Bonds", "", *(f"{i} {1 + i % 2} {a} {b}" for i, (a, b) in enumerate(bonds, 1))]
    lines += ["", "Angles", "", *(f"{i} 1 {a} {b} {c}" for i, (a, b, c) in enumerate(bends, 1))] * bool(bends)
    path.write_text("\n".join(lines) + "\n")
    return str(path)


def text(name: str, folder) -> str:
    words = COMMON | CASES.get(name, {})
    data = write_chains(folder / f"{name.replace(' ', '_')}.data", bool(words["angle"]), words["tilt"])
    return MELT.format(**words, data=data)


@pytest.fixture(scope="module")
def theirs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("swap")
    return ask(SCRIPT, cases={name: lines_of(text(name, folder)) for name in CASES})


@pytest.mark.parametrize("name", CASES)
def test_same_swaps_as_lammps(name, theirs, tmp_path):
    session, expected = asemd(text(name, tmp_path)), theirs[name]
    system, fix = session.scene.system, session.scene.fixes["2"]
    assert [fix.vector(i) for i in (1, 2)] == expected["vector"]
    assert sorted(sorted(pair) for pair in system.id[system.topology.bonds].tolist()) == expected["bonds"]
    assert system.x[np.argsort(system.id)] == pytest.approx(np.array(expected["x"]), abs=1e-10)
    assert session.moment.potential() == pytest.approx(expected["pe"], rel=1e-10)


def test_some_are_accepted(theirs):
    assert sum(case["vector"][0] > 0 for case in theirs.values()) >= 8
    assert sum(case["vector"][1] for case in theirs.values()) > sum(case["vector"][0] for case in theirs.values()) + 100


@pytest.mark.parametrize(("old", "new", "message"), [
    ("1.9 598934", "1.9", "needs 4 values"), ("1.9 598934", "1.9 0", "seed must be from 1"),
    ("swap 1 ", "swap 0 ", "Nevery must be at least 1"),
    (" 0.5 1.9", " 1.5 1.9", "fraction must be from 0 to 1"), ("lj/coul 0 1 1", "lj/coul 0 0 1", "special_bonds = 0,1,1"),
    ("angle_style harmonic", "angle_style harmonic\ndihedral_style harmonic", "dihedral or improper"),
])
def test_messages(old, new, message, tmp_path):
    with pytest.raises(InputError, match=message):
        asemd(text("bins", tmp_path).replace(old, new))


def test_round_trip(tmp_path):
    fix = asemd(text("bins", tmp_path).rpartition("run")[0]).scene.fixes["2"]
    assert fix.to_lammps() == ["1", "0.5", "1.9", "598934"]
