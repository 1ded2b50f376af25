"""compute stress/mop and stress/mop/profile count what goes through planes as LAMMPS does, and agree with the virial."""
from __future__ import annotations

import numpy as np
import pytest
from both import asemd, lines_of
from test_bond_swap import write_chains
from wheel import ask

from asemd.errors import InputError

MELT = """
units {units}
boundary {boundary}
atom_style full
special_bonds {special}
pair_style {pair}
bond_style harmonic
angle_style harmonic
dihedral_style opls
read_data {data}
pair_coeff * * 1 1
bond_coeff * 50 0.97
angle_coeff * 3 120
dihedral_coeff * 1 0.5 0.3 0.2
velocity all create 4.0 8731
group some id 1:110
fix 1 all nve
timestep {dt}
compute m {compute}
thermo_style custom step temp {shown}
thermo_modify norm no
run {steps}
"""
COMMON = {"units": "lj", "boundary": "p p p", "special": "lj/coul 0 1 1", "pair": "lj/cut 2.0", "dt": 0.003, "steps": "0\nrun 7"}
CASES = {
    "everything": "all stress/mop x 3.0 total conf kin pair bond angle dihedral",
    "center": "all stress/mop z center pair bond angle dihedral",
    "upper": "all stress/mop y upper conf total",
    "lower": "all stress/mop x lower total",
    "image": "all stress/mop x 8.0 total",
    "group": "some stress/mop y 2.2 total pair bond",
    "weighted": "all stress/mop x 1.1 pair total",
    "profile": "all stress/mop/profile x lower 0.25 total kin",
    "profile center": "all stress/mop/profile z center 0.4 conf kin",
    "profile upper": "some stress/mop/profile y upper 0.7 pair bond angle",
    "profile kin": "all stress/mop/profile z 0.53 0.11 kin dihedral",
    "open": "all stress/mop/profile x lower 0.3 total kin",
    "real": "all stress/mop/profile y lower 0.3 total kin",
}
CHANGES = {"weighted": {"special": "lj/coul 0.5 0.3 0.7"}, "open": {"boundary": "f p p"}, "real": {"units": "real", "dt": 0.5}}
SCRIPT = """
import numpy as np
answer = {}
for name, lines in given["cases"].items():
    lmp = ran(lines)
    answer[name] = np.array(lmp.numpy.extract_compute("m", 0, 2 if "profile" in str(lines) else 1)).tolist()
    lmp.close()
"""


def chains(path) -> str:
    """Chains with angles and dihedrals."""
    write_chains(path, True, False)
    text = path.read_text()
    new = [(k, k + 1, k + 2, k + 3) for c in range(24) for k in range(8 * c + 1, 8 * c + 6)]
    text = text.replace("1 angle types", f"1 angle types\n{len(new)} dihedrals\n1 dihedral types").replace("0 7.2 xlo", "-0.1 7.1 xlo")
    path.write_text(text + "\nDihedrals\n\n" + "".join(f"{k} 1 {' '.join(map(str, d))}\n" for k, d in enumerate(new, 1)))
    return str(path)


def text(name: str, data: str) -> str:
    compute = CASES.get(name, name)
    shown = "c_m[1][1]" if "profile" in compute else "c_m[1]"
    return MELT.format(**COMMON | CHANGES.get(name, {}), compute=compute, shown=shown, data=data)


@pytest.fixture(scope="module")
def data(tmp_path_factory) -> str:
    return chains(tmp_path_factory.mktemp("mop") / "data")


@pytest.fixture(scope="module")
def theirs(data):
    return ask(SCRIPT, cases={name: lines_of(text(name, data)) for name in CASES})


@pytest.mark.parametrize("name", CASES)
def test_like_lammps(name, theirs, data):
    session, expected = asemd(text(name, data)), np.array(theirs[name])
    got = session.moment.array("m") if "profile" in name or name in ("open", "real") else session.moment.vector("m")
    assert got.shape == expected.shape
    assert got == pytest.approx(expected, rel=1e-9, abs=1e-9 * np.abs(expected).max())
    assert np.abs(expected).max() > 0.0


def test_mean_over_planes_is_the_virial(data):
    """The mean over many planes is the pressure from the virial: forces and their lever arms."""
    session = asemd(text("all stress/mop/profile z lower 0.002 conf", data).replace("run 7", ""))
    columns, box = session.moment.array("m"), session.scene.system.box
    result, units = session.loop.result, session.loop.units
    expected = units.nktv2p * result.virial[[4, 5, 2]] / box.volume
    assert columns[:, 1:].mean(axis=0) == pytest.approx(expected, abs=0.02 * np.abs(expected).max())


@pytest.mark.parametrize(("compute", "message"), [
    ("all stress/mop x 3.0", "needs 3 values"), ("all stress/mop q 1 total", "one of x y z"), ("all stress/mop x a total", "number"),
    ("all stress/mop x 3 totl", "did you mean total"), ("all stress/mop/profile x lower 1.0", "needs 4 values"),
    ("all stress/mop/profile x 9 1.0 kin", "out of bounds"), ("all stress/mop/profile x lower 0 kin", "above 0"),
    ("all stress/mop/profile x lower 1 kin units reduced", "unknown keyword 'units'"),
])
def test_messages(compute, message, data):
    with pytest.raises(InputError, match=message):
        asemd(text(compute, data))


def test_boxes_that_change(data):
    lines = text("center", data)
    with pytest.raises(InputError, match="fixed simulation box"):
        asemd(lines.replace("fix 1 all nve", "fix 1 all npt temp 1 1 1 iso 0 0 1"))
    with pytest.raises(InputError, match="triclinic"):
        asemd(lines.replace("compute m", "change_box all triclinic\ncompute m"))


def test_round_trip(data):
    session = asemd(text("profile", data).rpartition("run 0")[0])
    assert session.scene.computes["m"].to_lammps() == "x lower 0.25 total kin".split()
