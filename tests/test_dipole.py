"""Atoms with dipoles: angle_style dipole with its torques, atom styles dipole, sphere and hybrid, the commands and files that know them."""
from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest
from ase import Atoms
from wheel import ask, ran

from asemd import style as registry
from asemd.atom_style import bonded, columns
from asemd.atoms import Atoms as Bonded
from asemd.calculator import ForceField
from asemd.errors import InputError, SimulationError
from asemd.system import System
from asemd.topology import Topology

CELL = """units real
atom_style hybrid full sphere dipole
region b block -6 6 -6 6 -6 6
create_box 1 b bond/types 1 angle/types 2
mass 1 12.0
"""
DATA = """dipoles

4 atoms
1 atom types
2 angles
2 angle types

-6 6 xlo xhi
-6 6 ylo yhi
-6 6 zlo zhi

Masses

1 12.0

Atoms # hybrid

1 1 5.5 -5.2 0.3 1 0.1 1.5 0.4 0.3 -0.8 0.6
2 1 -5.6 -4.4 0.9 1 -0.1 0 2.0 0.5 0.1 0.2
3 1 -4.9 5.7 1.4 2 0.2 1.0 0.5 -0.4 0.4 0.1
4 1 -4.1 4.9 -0.5 2 0 1.0 0.5 1.0 0.0 -0.3

Velocities

1 0.1 0.2 0.3 1 2 3
2 0 0 0 0 0 0
3 0 0 0 0 0.5 0
4 0 0 0 0 0 0

Angles

1 1 1 2 3
2 2 3 1 4
"""
SCRIPT = """units real
atom_style hybrid full sphere dipole
bond_style zero
angle_style dipole
pair_style zero 4.0
special_bonds lj/coul 0 0 0.5
read_data {data}
pair_coeff * *
angle_coeff 1 75.0 110.1
angle_coeff 2 -20.0 0.0
"""


@pytest.fixture
def data(tmp_path):
    path = tmp_path / "dipole.data"
    path.write_text(DATA)
    return path


def test_columns():
    assert columns("dipole") == ("id", "type", "q", "x", "y", "z", "mux", "muy", "muz")
    assert columns("hybrid full sphere dipole") == (
        "id", "type", "x", "y", "z", "molecule", "q", "diameter", "density", "mux", "muy", "muz")
    assert columns("hybrid charge bond") == ("id", "type", "x", "y", "z", "q", "molecule")
    assert bonded("hybrid charge bond") == ("bond",) and bonded("hybrid dipole sphere") == ()


def test_agrees_with_lammps(data, tmp_path):
    ending = "thermo_modify norm no\nrun 0\nwrite_data {}\n"
    want = ask("""
l = ran(given["text"])
names = {"f": 3, "torque": 3, "mu": 4, "radius": 1, "rmass": 1, "omega": 3}
answer = {"energy": l.get_thermo("pe"), **{name: list(l.gather_atoms(name, 1, width)) for name, width in names.items()}}
""", text=SCRIPT.format(data=data) + ending.format(tmp_path / "lammps.data"))
    lmp = ran(SCRIPT.format(data=data) + ending.format(tmp_path / "asemd.data"))
    for name, width in (("f", 3), ("torque", 3), ("mu", 4), ("radius", 1), ("rmass", 1), ("omega", 3)):
        assert list(lmp.gather_atoms(name, 1, width)) == pytest.approx(want[name], rel=1e-12, abs=1e-12), name
    assert lmp.get_thermo("pe") == pytest.approx(want["energy"], rel=1e-12)
    # each program reads the other's file
    for out in ("lammps.data", "asemd.data"):
        again = ran(SCRIPT.format(data=tmp_path / out).replace("angle_coeff", "#")).scene.system
        for name in ("mu", "radius", "omega"):
            assert np.allclose(again.extra[name][np.argsort(again.id)], lmp.scene.system.extra[name], rtol=1e-14), name
        assert np.allclose(again.rmass[np.argsort(again.id)], lmp.scene.system.rmass, rtol=1e-14)


def energy(x, mu, K, gamma0):
    d = [mp.mpf(float(b)) - mp.mpf(float(a)) for a, b in zip(x[0], x[1])]
    m = [mp.mpf(float(v)) for v in mu]
    c = mp.fdot(d, m) / mp.sqrt(mp.fdot(d, d) * mp.fdot(m, m))
    return K * (c - mp.cos(mp.radians(gamma0))) ** 2


def setup(x, mu, K="75.0", gamma0="110.1"):
    lmp = ran(CELL + f"angle_style dipole\nangle_coeff * {K} {gamma0}\nbond_style zero\nbond_coeff * 1\n")
    system = lmp.scene.system
    system = system.append(System(box=system.box, x=np.asarray(x, float), type=1, units="real", atom_style=system.atom_style, rmass=1.0,
                                  extra={"mu": np.array([mu, [0, 0, 0]], float)}))
    system.topology.angles, system.topology.angle_types = np.array([[0, 1, 1]], np.int32), np.array([1], np.int32)
    from asemd.engine import Engine
    engine = Engine(system, lmp.scene.interactions)
    return system, engine, engine.compute()


@pytest.mark.parametrize("tilt", [1.3, 1e-3, 1e-8, np.pi - 1e-8])
def test_forces_and_torques_keep_their_digits(tilt):
    """Minus the gradient of the energy, by 50 digits; the torque is mu times the gradient by mu."""
    x, mu = np.array([[0.2, -0.4, 0.1], [1.5, 0.7, -0.3]]), None
    d = (x[1] - x[0]) / np.linalg.norm(x[1] - x[0])
    side = np.cross(d, [0.3, 0.2, 0.9])
    mu = 0.8 * (np.cos(tilt) * d + np.sin(tilt) * side / np.linalg.norm(side))
    system, _, result = setup(x, mu)
    with mp.workdps(50):
        h = mp.mpf(10) ** -20

        def moved(a, k, s):
            return [[mp.mpf(float(v)) + s * h * (i == a and j == k) for j, v in enumerate(row)] for i, row in enumerate([*x, mu])]

        def exact(rows):
            d = [q - p for p, q in zip(rows[0], rows[1])]
            c = mp.fdot(d, rows[2]) / mp.sqrt(mp.fdot(d, d) * mp.fdot(rows[2], rows[2]))
            return 75 * (c - mp.cos(mp.mpf("110.1") * mp.pi / 180)) ** 2
        slope = [[float((exact(moved(a, k, 1)) - exact(moved(a, k, -1))) / (2 * h)) for k in range(3)] for a in range(3)]
    assert result.energy["eangle"] == pytest.approx(float(energy(x, mu, 75, mp.mpf("110.1"))), rel=1e-14)
    assert np.allclose(result.forces, -np.array(slope[:2]), rtol=0, atol=1e-13)
    assert np.allclose(system.extra["torque"][0], -np.cross(mu, slope[2]), rtol=0, atol=1e-13)
    # a couple that balances the torque
    assert np.allclose(np.cross(x[1] - x[0], result.forces[1]) + system.extra["torque"][0], 0.0, atol=1e-13)
    assert not result.virial.any()


def test_aligned_dipole_is_left_alone_and_none_is_reported():
    system, _, result = setup([[0, 0, 0], [1, 1, 0]], [2, 2, 0])
    assert not result.forces.any() and not system.extra["torque"].any() and result.energy["eangle"] > 0
    with pytest.raises(SimulationError, match="atom 1 has no dipole"):
        setup([[0, 0, 0], [1, 1, 0]], [0, 0, 0])
    with pytest.raises(SimulationError, match="same place"):
        setup([[0, 0, 0], [0, 0, 0]], [1, 0, 0])


@pytest.mark.parametrize("threads", [1, 2])
def test_a_run_moves_atoms_and_keeps_torques_right(data, threads):
    lmp = ran(SCRIPT.format(data=data) + "fix 1 all nve\ntimestep 0.5\nrun 20\nrun 0\n")
    system = lmp.scene.system
    lmp.scene.threads = threads
    torque = system.extra["torque"].copy()
    lmp.command("run 0")
    assert np.abs(torque).max() > 0.1 and np.allclose(lmp.scene.system.extra["torque"], torque, rtol=1e-11)


def test_style_without_dipoles_is_refused():
    atoms = "".join(f"create_atoms 1 single {x} 0\n" for x in ("0 0", "1 0", "1 1"))
    rest = "angle_style dipole\nangle_coeff * 1 2\ncreate_bonds single/angle 1 1 2 3\npair_style zero 4\npair_coeff * *\nrun 0\n"
    with pytest.raises(InputError, match="needs atoms with dipoles: use atom_style dipole"):
        ran(CELL.replace("hybrid full sphere dipole", "full") + atoms + rest)


def test_set():
    lmp = ran(CELL + "create_atoms 1 single 0 0 0\ncreate_atoms 1 single 1 0.2 0.1\nvariable a atom id\n"
              "set atom 1 dipole v_a 2 3\nset atom 2 dipole/random 4711 1.5\nset atom 2 diameter 3 density 2\n")
    system = lmp.scene.system
    assert system.extra["mu"][0].tolist() == [1, 2, 3]
    # the numbers of LAMMPS
    assert system.extra["mu"][1] == pytest.approx([1.05180757, 0.01678551, 1.06930776], abs=1e-8)
    assert system.extra["radius"].tolist() == [0.5, 1.5]
    assert system.rmass == pytest.approx([np.pi / 6, 2 * np.pi / 6 * 27])
    for words, text in (("dipole/random 1 0", "positive"), ("dipole 1 2", "set dipole"), ("density 0", "positive"),
                        ("diameter -1", "0 or more")):
        with pytest.raises(InputError, match=text):
            lmp.command(f"set atom * {words}")
    plain = ran(CELL.replace("hybrid full sphere dipole", "full") + "create_atoms 1 single 0 0 0\n")
    for words in ("dipole 1 2 3", "dipole/random 1 1", "diameter 1"):
        with pytest.raises(InputError, match="atom_style full has no"):
            plain.command(f"set atom * {words}")


def test_dump_columns(data, tmp_path):
    names = "mux muy muz mu tqx tqy tqz omegax omegay omegaz radius diameter"
    lmp = ran(SCRIPT.format(data=data) + f"dump 1 all custom 1 {tmp_path / 'd'} id {names}\n"
              "dump_modify 1 sort id format float %.17g\nrun 0\n")
    values = np.loadtxt((tmp_path / "d").read_text().splitlines()[9:])
    extra = lmp.scene.system.extra
    assert np.array_equal(values[:, 1:4], extra["mu"]) and np.array_equal(values[:, 5:8], extra["torque"])
    assert np.array_equal(values[:, 8:11], extra["omega"]) and np.array_equal(values[:, 12], 2 * extra["radius"])
    assert values[:, 4] == pytest.approx(np.linalg.norm(extra["mu"], axis=1))


def test_arrays_follow_the_atoms(data):
    lmp = ran(SCRIPT.format(data=data) + "run 0\n")
    s = lmp.scene.system
    back = s.select([2, 0])
    assert np.array_equal(back.extra["mu"], s.extra["mu"][[2, 0]])
    big = s.replicate(2, 1, 1)
    assert np.array_equal(big.extra["mu"], np.tile(s.extra["mu"], (2, 1))) and len(big.extra["torque"]) == 8
    lmp.command("replicate 1 2 1 bond/periodic")
    lmp.command("run 0")
    assert lmp.scene.system.extra["torque"][:4] == pytest.approx(s.extra["torque"], rel=1e-12, abs=1e-12)


def test_ase_atoms_carry_dipoles(data):
    lmp = ran(SCRIPT.format(data=data) + "run 0\n")
    atoms = lmp.scene.to_atoms()
    assert atoms.arrays["mu"] == pytest.approx(lmp.scene.system.extra["mu"])            # e Angstrom in both
    before = atoms.get_potential_energy()
    assert before == pytest.approx(lmp.get_thermo("pe") * 0.0433641, rel=1e-5)
    forces = atoms.get_forces()
    atoms.arrays["mu"][0] *= -1.0
    assert atoms.get_potential_energy() != pytest.approx(before)
    atoms.arrays["mu"][0] *= -1.0
    assert np.allclose(atoms.get_forces(), forces, atol=1e-15)
    assert len(atoms[[0, 1]].arrays["mu"]) == 2


def test_from_python():
    atoms = Bonded(Atoms("OOO", positions=[[0, 0, 0], [1.2, 0, 0], [5.0, 5.0, 0]], cell=[20, 20, 20], pbc=True))
    atoms.topology = Topology(angles=np.array([[0, 1, 2]], np.int32), angle_types=np.array([1], np.int32))
    atoms.calc = ForceField(angle={"dipole": {1: (2.0, 0.0)}})
    atoms.set_array("mu", np.array([[0.0, 0.3, 0.0], [0, 0, 0], [0, 0, 0]]))
    assert atoms.get_potential_energy() == pytest.approx(2.0)
    assert atoms.get_forces()[1] == pytest.approx([0, 2 * 2.0 / 1.2, 0])
    atoms.set_array("mu", np.array([[0.3, 0.3, 0.0], [0, 0, 0], [0, 0, 0]]))
    assert atoms.get_potential_energy() == pytest.approx(2.0 * (np.sqrt(0.5) - 1.0) ** 2)


@pytest.mark.parametrize(("words", "text"), [
    ("hybrid", "names of its sub-styles"), ("hybrid full full", "twice"), ("hybrid full ful", "full"),
    ("hybrid full hybrid", "cannot have"),
    ("dipole 1", "takes no arguments")])
def test_refused_atom_styles(words, text):
    with pytest.raises(InputError, match=text):
        ran(f"atom_style {words}\n")


@pytest.mark.parametrize(("old", "new", "text"), [("1.5 0.4", "-1.5 0.4", "invalid diameter"), ("1.5 0.4", "1.5 0", "invalid density"),
                                                  ("0.3 -0.8 0.6", "0.3 -0.8", "expected 12")])
def test_refused_lines(data, old, new, text):
    data.write_text(DATA.replace(old, new))
    with pytest.raises(InputError, match=text + r".*dipole.data:18"):
        ran(SCRIPT.format(data=data))


def test_coefficients():
    style = registry.find("angle", "dipole")
    assert style.parse_coeff(["6", "2.1"], {}) == {"K": 6.0, "gamma0": 2.1}
    with pytest.raises(InputError, match="needs K gamma0"):
        style.parse_coeff(["6"], {})
