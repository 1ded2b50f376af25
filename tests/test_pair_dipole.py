"""Charges with point dipoles: forces, torques, energies and stress of LAMMPS; the gradient; words."""
from __future__ import annotations

import inspect

import numpy as np
import pytest
from test_pair_coulomb import ours
from turning_atoms import assert_same, lammps
from wheel import ask, ran

from asemd.errors import InputError
from asemd.oriented_term import dipole_kernel
from asemd.pair.lj_cut_dipole_long import radial

COLUMNS = ("evdwl", "ecoul", "elong", "pxx", "pyy", "pzz", "pxy", "pxz", "pyz")
ATOMS = """units real
atom_style hybrid full sphere dipole
boundary p p {z}
region b block 0 11 -3 9 2 13.5
create_box 2 b bond/types 1 extra/bond/per/atom 4 extra/special/per/atom 20
mass * 10.0
create_atoms 1 random 20 1234 NULL overlap 1.4 maxtry 500
create_atoms 2 random 20 91 NULL overlap 1.4 maxtry 500
set type 1 charge {q}
set type 2 charge -{q}
set type 1 dipole/random 777 0.8
set type 2 dipole/random 77 1.3
bond_style zero
bond_coeff *
pair_style zero 5.0
pair_coeff * *
create_bonds many all all 1 1.3 2.1
special_bonds lj 0.1 0.25 0.5 coul 0.2 0.3 0.6
{pair}
thermo_style custom step {columns}
run 0
"""
LJ = "pair_coeff 1 1 0.1 2.0 4\npair_coeff 2 2 0.2 1.7\n"
SOLVER = "\nkspace_style ewald/dipole 1e-4"
CASES = {
    "lj/cut/dipole/cut": "pair_style lj/cut/dipole/cut 5 6\n" + LJ + "pair_modify shift yes mix arithmetic",
    "lj/cut/dipole/cut one": "pair_style lj/cut/dipole/cut 5\npair_coeff * * 0.1 2.0\npair_coeff 1 2 0.2 1.8 4 4.5",
    "lj/cut/dipole/cut many": "pair_style lj/cut/dipole/cut 4\npair_coeff * * 0.1 2.0\nreplicate 3 3 3",
    "lj/cut/dipole/cut scaled": "pair_style hybrid/scaled 0.7 lj/cut/dipole/cut 5 0.4 lj/cut 4\npair_coeff * * lj/cut/dipole/cut 0.1 2\n"
                                "pair_coeff 2 2 lj/cut 0.1 2",
    "lj/sf/dipole/sf": "pair_style lj/sf/dipole/sf 5 6\npair_coeff 1 1 0.1 2 5.2 5.5 scale 0.4\npair_coeff 2 2 0.2 1.7 4",
    "lj/sf/dipole/sf scale": "pair_style lj/sf/dipole/sf 5\npair_coeff * * 0.1 2\npair_coeff 1 2 0.2 1.7 scale 0.2\npair_modify shift yes",
    "lj/cut/dipole/long": "pair_style lj/cut/dipole/long 4 5\n" + LJ + SOLVER,
    "lj/cut/dipole/long table": "pair_style lj/cut/dipole/long 4 5\n" + LJ + SOLVER + "\npair_modify table 12",
    "lj/cut/dipole/long g": "pair_style lj/cut/dipole/long 5\n" + LJ + SOLVER + "\nkspace_modify gewald 0.4",
    "lj/cut/dipole/long slab": "pair_style lj/cut/dipole/long 4 5\n" + LJ + SOLVER
                               + "\nkspace_modify slab 3.0 gewald 0.35 kmax/ewald 5 6 14",
    "lj/cut/dipole/long slab ew2d": "pair_style lj/cut/dipole/long 4 5\n" + LJ + SOLVER
                                    + "\nkspace_modify slab ew2d gewald 0.35 kmax/ewald 5 6 14",
}
LONG = "pair_style lj/long/dipole/long {}\npair_coeff 1 1 0.1 2.0\npair_coeff 2 2 0.2 1.7\nkspace_style ewald/disp{} 1e-4"
CASES |= {
    "lj/long/dipole/long": LONG.format("long long 5", "/dipole"),
    "lj/long/dipole/long cut": LONG.format("cut long 4 5", "") + "\npair_modify shift yes\nkspace_modify gewald 0.4",
    "lj/long/dipole/long off": LONG.format("long off 4 5", ""),
    "lj/long/dipole/long uncharged": LONG.format("long long 5", "/dipole") + "\npair_modify mix arithmetic\nset group all charge 0",
    "lj/long/dipole/long slab ew2d": LONG.format("cut long 5", "/dipole") + "\nkspace_modify slab ew2d gewald 0.35 force 0.3",
    "lj/long/dipole/long slab": LONG.format("cut long 5", "/dipole") + "\nkspace_modify slab 3.0 gewald 0.35 force 0.3",
}


def script(name: str) -> str:
    long = "cut/dipole/long" in name
    return ATOMS.format(pair=CASES[name], q=0.0 if long else 0.7, z="f" if "slab" in name else "p", columns=" ".join(COLUMNS))


@pytest.fixture(scope="module")
def theirs():
    return lammps({name: script(name) for name in CASES}, COLUMNS)


@pytest.mark.part(5)
@pytest.mark.parametrize("name", CASES)
def test_like_lammps(theirs, name):
    expected = theirs[name]
    assert "error" not in expected, expected
    session = ours(script(name))
    if name == "lj/cut/dipole/long slab":      # LAMMPS adds a twelfth of this
        moment = session.scene.system.extra["mu"][:, 2].sum()
        expected["thermo"][2] += 11 / 12 * 2 * np.pi * session.loop.engine.qqr2e * moment**2 / (3 * 11 * 12 * 11.5)
    assert_same(session, expected, COLUMNS, 1e-11)


@pytest.fixture
def exact_erfc(monkeypatch):
    """The complementary error function in place of LAMMPS's approximation, whose force is not the gradient of its energy."""
    text = inspect.getsource(radial)
    line = next(line for line in text.splitlines() if line.lstrip().startswith("tail ="))
    monkeypatch.setattr(radial, "source", text.replace(line, "    tail = math.erfc(x)"), raising=False)
    dipole_kernel.cache_clear()
    yield
    dipole_kernel.cache_clear()


@pytest.mark.part(3)
@pytest.mark.parametrize("name", ["lj/cut/dipole/cut", "lj/sf/dipole/sf", "lj/cut/dipole/long g", "lj/cut/dipole/long slab",
                                  "lj/long/dipole/long", "lj/long/dipole/long slab"])
def test_forces_and_torques_are_the_gradient(name, exact_erfc):
    session = ours(script(name))
    engine, h = session.loop.engine, 1e-4
    system = session.scene.system
    result = engine.compute(energies=True, virials=True)
    assert result.energies.sum() == pytest.approx(result.potential, rel=1e-12)
    np.testing.assert_allclose(result.virials.sum(axis=0), result.virial, rtol=1e-10, atol=1e-9)
    force, torque, mu = system.f.copy(), system.extra["torque"].copy(), system.extra["mu"]
    tolerance = dict(rtol=1e-6, atol=1e-7 * np.abs(force).max())
    for atom in (0, 7):
        for axis in range(3):
            e = []
            for sign in (1, -1):
                system.x[atom, axis] += sign * h
                e.append(engine.compute().potential)
                system.x[atom, axis] -= sign * h
            np.testing.assert_allclose(-(e[0] - e[1]) / (2 * h), force[atom, axis], **tolerance)
            e, held = [], mu[atom].copy()
            for sign in (1, -1):
                turn = np.zeros(3)
                turn[axis] = sign * h
                angle = np.linalg.norm(turn)
                mu[atom] = (held * np.cos(angle) + np.cross(turn / angle, held) * np.sin(angle)
                            + turn / angle**2 * (turn @ held) * (1 - np.cos(angle)))
                e.append(engine.compute().potential)
            mu[atom] = held
            np.testing.assert_allclose(-(e[0] - e[1]) / (2 * h), torque[atom, axis], **tolerance)


@pytest.mark.parametrize("line, message", [
    ("pair_style lj/sf/dipole/sf 5\npair_coeff * * 1 1 scale", "scale needs a number"),
    ("pair_style lj/sf/dipole/sf 5\npair_coeff * * 1 1 scale 1 3", "nothing may follow scale"),
    ("pair_style lj/cut/dipole/cut 5\npair_coeff * * 1 1\ncompute 1 all pair/local eng\ndump 1 all local 1 /dev/null c_1\nrun 0",
     "orientation"),
    ("set type 1 charge 0.5\npair_style lj/cut/dipole/long 5\npair_coeff * * 1 1\nkspace_style ewald/dipole 1e-4\nrun 0",
     "without charges"),
    ("pair_style lj/cut/dipole/long 5\npair_coeff * * 1 1\nrun 0", "needs a kspace_style"),
    ("pair_style lj/cut/dipole/long 5\npair_coeff * * 1 1 3 3", "got 4 values"),
    ("pair_style lj/long/dipole/long cut cut 5", "coulomb must be long or off"),
    ("pair_style lj/long/dipole/long long long 5 6", "only one cutoff"),
    ("pair_style lj/long/dipole/long long long 5\npair_coeff * * 1 1\nrun 0", "needs a kspace_style, such as ewald/disp"),
    ("pair_style lj/cut/dipole/cut 5\npair_coeff * * 1 1\nspecial_bonds lj/coul 0 1 1\nbond_style special\n"
     "bond_coeff * 0.5 0.5\nrun 0", "cannot be used with pair"),
    ("pair_style lj/cut/dipole/cut 5\npair_coeff * * 1 1\ncompute 1 all born/matrix\nthermo_style custom c_1[1]\nrun 0",
     "orientation"),
    ("pair_style lj/cut/dipole/cut 5\npair_coeff * * 1 1\npair_write 1 1 10 r 1 2 file.table X", "orientation"),
])
def test_words(line, message):
    text = script("lj/cut/dipole/long").split("pair_style lj")[0]
    with pytest.raises(InputError, match=message):
        ours(text + line + "\n")


def test_atoms_without_dipoles_are_refused():
    text = "atom_style charge\nregion b block 0 9 0 9 0 9\ncreate_box 1 b\ncreate_atoms 1 random 3 12 NULL\nmass 1 1\n"
    with pytest.raises(InputError, match="needs atoms with charges and dipoles"):
        ours(text + "pair_style lj/cut/dipole/cut 3\npair_coeff * * 1 1\nrun 0\n")


def test_dispersion_has_no_table():
    """LAMMPS's default tables of dispersion, which ``-compat lammps`` has too, are not for this style; at this distance they would show."""
    lines = ["units real", "atom_style hybrid sphere dipole", "region b block 0 24 0 24 0 24", "create_box 1 b",
             "create_atoms 1 single 1 1 1", "create_atoms 1 single 1 1 4.8",
             "pair_style lj/long/dipole/long long off 9.0", "pair_coeff 1 1 0.1 3.0",
             "kspace_style ewald/disp 1e-4", "run 0"]
    want = ask("answer = ran(given['lines']).get_thermo('evdwl')", lines=lines)
    assert ran(lines, "-compat", "lammps").get_thermo("evdwl") == pytest.approx(want, rel=1e-10)
