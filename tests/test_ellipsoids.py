"""Ellipsoids: data files, the command set, integrators and temperatures, against LAMMPS."""
from __future__ import annotations

import numpy as np
import pytest
from both import asemd, lines_of
from wheel import ask

from asemd.errors import InputError

SCENE = """
units lj
dimension {dimension}
atom_style hybrid ellipsoid dipole angle
lattice {lattice} 0.8
region b block 0 3 0 3 {height}
create_box 1 b angle/types 1 extra/angle/per/atom 3 extra/special/per/atom 6
create_atoms 1 box
set group all shape 0.7 0.9 1.2
set group all mass 1.3
set atom 2*20 shape 0.5 0.5 0.8
set group all quat/random 4711
set group all dipole/random 4711 0.6
set atom 1*9 angmom {angmom}
velocity all create 1.44 87287
group some id 1:4 6 9
group rest subtract all some
pair_style lj/cut 2.0
pair_coeff * * 1 1
angle_style zero
angle_coeff 1
compute t all temp/asphere
compute c all temp/com
compute b all temp/asphere bias c
compute r all temp/asphere dof rotate
compute e all erotate/asphere
compute h all temp
compute p all pressure h
timestep 0.004
"""
SOLID = {"dimension": 3, "lattice": "fcc", "height": "0 3", "angmom": "0.3 -0.7 1.2"}
FLAT = {"dimension": 2, "lattice": "sq", "height": "-0.5 0.5", "angmom": "0 0 0.2"}
FIELD, FLAT_FIELD, FLAT2 = "fix 8 all efield 0.7 -0.3 0.5", "fix 8 all efield 0.7 -0.3 0", "fix 9 all enforce2d"
T = "temp 1.44 2.0 0.1"
CASES = {
    "field": (SOLID, [FIELD, "fix 1 all nve/asphere"]),
    "two dimensions": (FLAT, [FLAT_FIELD, "fix 1 all nve/asphere", FLAT2]),
    "noforce": (SOLID, [FIELD, "fix 1 all nve/asphere/noforce"]),
    "levels": (SOLID, [FIELD, f"fix 1 all nvt/asphere {T}", "run_style respa 2 3 angle 1 pair 2"]),
    "nvt": (SOLID, [FIELD, f"fix 1 all nvt/asphere {T}"]),
    "nvt of a group": (SOLID, [FIELD, f"fix 1 some nvt/asphere {T} tchain 1 tloop 2 drag 0.3", "fix 2 rest nve/asphere"]),
    "nvt, bias": (SOLID, [FIELD, f"fix 1 all nvt/asphere {T}", "fix_modify 1 temp b"]),
    "nvt, rotation": (SOLID, [FIELD, f"fix 1 all nvt/asphere {T}", "fix_modify 1 temp r"]),
    "nvt, translation": (SOLID, [FIELD, f"fix 1 all nvt/asphere {T}", "fix_modify 1 temp h"]),
    "npt iso": (SOLID, [FIELD, f"fix 1 all npt/asphere {T} iso 0 2 0.5"]),
    "npt aniso": (SOLID, [FIELD, f"fix 1 all npt/asphere {T} aniso 0 2 0.5 drag 0.2 mtk no"]),
    "npt tri": (SOLID, ["change_box all triclinic", FIELD, f"fix 1 all npt/asphere {T} tri 0 2 0.5 nreset 2"]),
    "npt in two dimensions": (FLAT, [FLAT_FIELD, f"fix 1 all npt/asphere {T} iso 0 2 0.5", FLAT2]),
    "npt, bias": (SOLID, [FIELD, f"fix 1 all npt/asphere {T} iso 0 2 0.5", "fix_modify 1 temp b"]),
    "npt, another pressure": (SOLID, [FIELD, f"fix 1 all npt/asphere {T} iso 0 2 0.5", "fix_modify 1 press p"]),
    "npt on levels": (SOLID, [FIELD, f"fix 1 all npt/asphere {T} iso 0 2 0.5", "run_style respa 2 2 angle 1 pair 2"]),
    "nph": (SOLID, [FIELD, "fix 1 all nph/asphere aniso 0 2 0.5 ptemp 1.5 couple xy"]),
    "rigid": (SOLID, [FIELD, "fix 1 rest nve/asphere", "fix 2 some rigid single"]),
    "rigid/small": (SOLID, ["set group some mol 1", "comm_modify cutoff 4", FIELD, "fix 1 rest nve/asphere",
                            "fix 2 some rigid/small molecule"]),
    "rigid/npt": (SOLID, [FIELD, "fix 1 rest nve/asphere", "fix 2 some rigid/npt single temp 1 2 0.1 iso 0 1 0.5"]),
    "rigid/nve in two dimensions": (FLAT, ["group pair id 3:6", "group single subtract all pair", FLAT_FIELD, "fix 1 single nve/asphere",
                                           "fix 2 pair rigid/nve single", FLAT2]),
    "move rotate": (SOLID, ["fix 1 rest nve/asphere", "fix 2 some move rotate 1 1 1 0 0.4 1 2.0"]),
    "move transrot": (SOLID, ["fix 1 rest nve/asphere", "fix 2 some move transrot 0.1 0 0 1 1 1 0 0.4 1 2.0"]),
    "langevin without noise": (SOLID, [FIELD, "fix 1 all nve/asphere", "fix 2 all langevin 0 0 0.3 77 angmom 3.3 scale 1 1.7"]),
    "langevin, tally": (SOLID, [FIELD, "fix 1 all nve/asphere", "fix 2 some langevin 0 0 0.3 77 angmom 1 tally yes zero yes"]),
}
OUT = ("temp", "pe", "press", "pxy", *(f"c_{c}" for c in ("t", "b", "r", "e", "r[5]")), *(f"c_t[{k}]" for k in range(1, 7)), "lx", "xy")
NAMES = ("id", "quatw", "quati", "quatj", "quatk", "angmomx", "angmomy", "angmomz", "vx", "vy", "vz", "xu", "yu", "zu", "tqx", "tqy", "tqz",
         "shapex", "shapey", "shapez", "mass")
WATCH = f"compute q all property/atom {' '.join(NAMES)}"
SCRIPT = """
import numpy as np, os, tempfile
answer, files = {}, tempfile.mkdtemp()
os.chdir(files)
for name, lines in given["cases"].items():
    for file, text in given.get("files", {}).items():
        open(file, "w").write(text)
    lmp = start()
    try:
        for line in lines:
            if not line.startswith("write_data"):
                lmp.command(line)
        rows = np.array(lmp.numpy.extract_compute("q", 1, 2))
        if lines[-1].startswith("write_data"):      # of hybrids it changes masses by atom
            lmp.command(lines[-1])
        answer[name] = {"atoms": rows[np.argsort(rows[:, 0])].tolist(), "thermo": lmp.last_thermo()}
        if os.path.exists("some.data"):
            answer[name]["data"] = open("some.data").read()
            os.remove("some.data")
    except Exception as e:
        answer[name] = {"error": str(e)}
    lmp.close()
"""


def lines(name):
    scene, more = CASES[name]
    return [*lines_of(SCENE.format(**scene)), *more, "thermo_style custom step " + " ".join(OUT), WATCH,
            "dump q all custom 20 /dev/null c_q[1]", "run 20", "run 20"]


@pytest.fixture(scope="module")
def theirs():
    return ask(SCRIPT, cases={name: lines(name) for name in CASES})


def atoms_of(session):
    rows = session.moment.per_atom("q")
    return rows[np.argsort(rows[:, 0])]


@pytest.mark.part(6)
@pytest.mark.parametrize("name", CASES)
def test_trajectory_like_lammps(theirs, name):
    expected = theirs[name]
    assert "error" not in expected, expected
    session = asemd("\n".join(lines(name)))
    assert atoms_of(session) == pytest.approx(np.array(expected["atoms"]), rel=1e-11, abs=1e-11)
    for key, value in expected["thermo"].items():
        if key not in ("CPU", "Step"):
            assert session.last_thermo[key] == pytest.approx(value, rel=1e-10, abs=1e-10), key


def test_langevin_bath_has_its_temperature():
    scene = SCENE.format(**SOLID | {"height": "0 24"}).replace("lj/cut 2.0", "zero 1.0").replace("* * 1 1", "* *")
    session = asemd(scene + "fix 1 all nve/asphere\nfix 2 all langevin 1.5 1.5 0.1 77 angmom 3.3\nthermo_style custom c_r c_h\nrun 200")
    spread = (2.0 / (3 * 864)) ** 0.5
    assert session.last_thermo["c_r"] == pytest.approx(1.5, rel=4 * spread)
    assert session.last_thermo["c_h"] == pytest.approx(1.5, rel=4 * spread)


# ---- files and commands -----------------------------------------------------------------------------------------------------------------
FILE = """ellipsoids

3 atoms
2 ellipsoids
1 atom types
{box}

Atoms

3 {three}
1 {one}
2 {two}

Velocities

1 0.1 0.2 0.3 {w1}
2 0 0 0.2 {w2}
3 0.5 0 0 {w3}

Ellipsoids

2 0.5 1.5 0.7 1 2 3 4
1 1 2 3 0.5 0.5 -0.5 0.5
"""
BOX = "0 4 xlo xhi\n0 4 ylo yhi\n0 4 zlo zhi"
GENERAL = "3 0 0 avec\n0.6 0 3 bvec\n0 -3 1 cvec"
SPINS = {"w1": "1 2 3", "w2": "-1 0 0.4", "w3": "0 0 0"}
PLAIN = dict(one="1 1 0.7 1 1 -1", two="1 1 1.2 2 0.4 1.2", three="1 0 3.3 2 0.4 0.2", **SPINS)
FILES = {
    "box.data": FILE.format(box=BOX, **(PLAIN | {"one": "1 1 0.7 1 1 1"})), "general.data": FILE.format(box=GENERAL, **PLAIN),
    "spheres.data": FILE.format(box=BOX, one="1 1 1 1 1 0.7 0.9", two="1 2 2 2 1 1.2 0.8", three="1 3 1 1 0 3.3 0",
                                **{k: f"{w} 0.3 0.2 0.1" for k, w in SPINS.items()}),
    "full.data": FILE.format(box=BOX, one="1 1 1 1 1 0.3 1 0.7", two="1 2 2 2 2 -0.3 1 1.2", three="1 3 1 1 0 0 0 3.3", **SPINS),
}
MOLECULE = "pair\n\n2 atoms\n\nCoords\n\n1 0 0 0\n2 1 0 0\n\nTypes\n\n1 1\n2 1\n\nMasses\n\n1 2.5\n2 1.5\n"
FILES["pair.mol"] = MOLECULE
READ = {"box": "ellipsoid", "general": "ellipsoid", "spheres": "hybrid ellipsoid sphere", "full": "hybrid full ellipsoid"}
MADE = """
region b block 0 4 0 4 0 4
create_box 1 b
create_atoms 1 random 6 77 NULL
set atom 1*3 shape 1 2 0.7
set atom 2 density 1.7
set atom 5 density 0.3
set atom 2 quat 1 0 2 40
set atom 3 quat/random 98
set atom 3 angmom 1 -2 0.4
displace_atoms all rotate 1 1 1 0 2 1 33
replicate 1 2 1
group odd id 1:12:5
delete_atoms group odd
"""
END = f"pair_style zero 2\npair_coeff * *\n{WATCH}\nthermo_style custom step temp\ndump q all custom 1 /dev/null c_q[1]\nrun 0\n" \
      "write_data some.data nocoeff"
DATA = {name: f"units lj\natom_style {style}\nread_data {name}.data\n{'mass 1 1' if 'full' in style else ''}\n" + END
        for name, style in READ.items()}
DATA |= {f"made, {style}": f"units lj\natom_style {style}\n{MADE}" + END
         for style in ("ellipsoid", "hybrid ellipsoid sphere", "hybrid sphere ellipsoid")}
DATA["of a molecule"] = """units lj
atom_style ellipsoid
region b block 0 8 0 8 0 8
create_box 1 b
molecule m pair.mol
create_atoms 0 single 2 2 2 mol m 123
create_atoms 1 single 5 5 5
set atom 2 shape 1 1 2
""" + END
DATA["made, flat"] = """units lj
dimension 2
atom_style ellipsoid
region b block 0 4 0 4 -0.5 0.5
create_box 1 b
create_atoms 1 random 6 77 NULL
set atom 1*3 shape 1 2 0.7
set atom 2 density/disc 1.7
set atom 1*2 quat/random 7
""" + END


@pytest.fixture(scope="module")
def files():
    return ask(SCRIPT, cases={name: lines_of(text) for name, text in DATA.items()}, files=FILES)


def numbers(text: str) -> dict[str, np.ndarray]:
    """Section -> rows of a data file in order of id."""
    out, name = {}, ""
    for line in text.splitlines()[2:]:
        words = line.split("#")[0].split()
        if words and words[0][0].isalpha():
            name = words[0]
        elif words and words[-1][0].isalpha():
            out[" ".join(words[1:])] = np.array([float(words[0])])
        elif words:
            out.setdefault(name, []).append([float(w) for w in words])
    return {k: np.array(v if isinstance(v, np.ndarray) else sorted(v)) for k, v in out.items()}


@pytest.mark.parametrize("name", DATA)
def test_files_and_commands_like_lammps(files, name, tmp_path, monkeypatch):
    expected = files[name]
    assert "error" not in expected, expected
    monkeypatch.chdir(tmp_path)
    for file, text in FILES.items():
        (tmp_path / file).write_text(text)
    session = asemd(DATA[name])
    assert atoms_of(session) == pytest.approx(np.array(expected["atoms"]), rel=1e-13, abs=1e-13)
    ours, wanted = numbers((tmp_path / "some.data").read_text()), numbers(expected["data"])
    for section in ("ellipsoids", "Atoms", "Velocities", "Ellipsoids"):
        assert ours[section] == pytest.approx(wanted[section], rel=1e-13, abs=1e-13), section
    (tmp_path / "theirs.data").write_text(expected["data"])
    again = asemd("\n".join([*DATA[name].split("\n")[:3 if "flat" in name else 2], "read_data theirs.data", END]))
    assert atoms_of(again) == pytest.approx(atoms_of(session), rel=1e-13, abs=1e-13)


@pytest.mark.parametrize(("old", "new", "said"), [
    ("2 ellipsoids", "1 ellipsoids", "extra line"), ("1 1 1 0.7", "1 1 2 0.7", "flag of atom 1 must be 0 or 1"),
    ("1 1 1 0.7", "1 1 0 0.7", "atom 1 is a point"), ("3 1 0 3.3", "3 1 1 3.3", "atom 3 is an ellipsoid, but"),
    ("2 0.5 1.5 0.7", "2 0.5 0 0.7", "diameters of atom 2"), ("1 2 3 0.5 0.5 -0.5 0.5", "1 2 3 0 0 0 0", "quaternion of atom 1"),
    ("2 0.5 1.5 0.7", "1 0.5 1.5 0.7", "appears twice"), ("2 0.5 1.5", "5 0.5 1.5", "atom ID 5 does not exist"),
    ("1 1 1 0.7", "1 1 1 -0.7", "invalid density"), ("0.5 1.5 0.7", "0.5 nan 0.7", "shapey of atom 2 is NaN"),
])
def test_faults_of_files_are_named(tmp_path, old, new, said):
    text = FILES["box.data"]
    assert old in text
    (tmp_path / "a.data").write_text(text.replace(old, new))
    with pytest.raises(InputError, match=said) as caught:
        asemd(f"units lj\natom_style ellipsoid\nread_data {tmp_path}/a.data")
    assert "a.data" in str(caught.value)


THREE = "\n".join(["region b block 0 4 0 4 0 4", "create_box 1 b", *(f"create_atoms 1 single {k} {k} {k}" for k in (1, 2, 3))])
PAIR = "pair_style zero 1\npair_coeff * *"


@pytest.mark.parametrize(("line", "said"), [
    ("set atom 3 quat 1 0 0 30", "atom 3 is a point"), ("set atom 1 shape 1 0 0", "must be positive"),
    ("set atom 1 shape -1 1 1", "must be positive"), ("set atom 1 quat 0 0 0 20", "axis must not be zero"),
    ("set atom 1 quat/random 0", "seed"), ("set atom 1 diameter 3", "no diameter"), ("set atom 1 omega 1 1 1", "no angular velocities"),
    ("fix 1 all nve/asphere\nrun 0", "atom 3 is a point"), ("fix 1 all nve/asphere 3", "no arguments"),
    ("fix 1 all nvt/asphere temp 1 1 1 update dipole", "is for spheres"), ("compute t all temp/asphere dof some", "one of all rotate"),
    ("compute t all temp/asphere\nrun 0", "atom 3 is a point"), ("compute t all temp/asphere bias thermo_temp", "removes no bias"),
    ("compute e all erotate/asphere 1", "no arguments"), ("fix 1 all langevin 1 1 1 7 angmom 1\nrun 0", "atom 3 is a point"),
    ("fix 1 all langevin 1 1 1 7 angmom 1 gjf vhalf", "does not go with gjf"), ("mass 1 1", "use set mass"),
    ("fix 1 all nve/sphere", "radius"),
])
def test_words(line, said):
    with pytest.raises(InputError, match=said):
        asemd(f"units lj\natom_style ellipsoid\n{THREE}\nset atom 1*2 shape 1 2 3\n{PAIR}\n{line}\n"
              f"thermo_style custom step {'c_t' if 'compute t' in line else 'pe'}\nrun 0")


@pytest.mark.parametrize("line", [
    "fix 1 all nve/asphere", "compute t all temp/asphere", "set atom 1 shape 1 1 1", "compute q all property/atom quatw",
    "compute e all erotate/asphere\nthermo_style custom c_e\nrun 0"])
def test_other_atom_styles_have_no_ellipsoids(line):
    with pytest.raises(InputError, match="ellipsoid|a shape"):
        asemd(f"units lj\n{THREE}\nmass 1 1\n{PAIR}\n{line}")
