"""Long-range solvers: LAMMPS's numbers through runs, shares of atoms, threads, gradients, a Madelung constant, and what is refused."""
from __future__ import annotations

import math

import numpy as np
import pytest
from ase import Atoms
from solvers import CHARGES, LJ, NEUTRAL, NVE, SCENE, TILT, compare, lammps_of, refused
from solvers import case as scene
from wheel import ran, start

from asemd import units
from asemd.engine import Engine, Settings
from asemd.registry import class_of

PAIRS = ["pair_style lj/cut/coul/long 5.0 5.5", "pair_modify table 0", *LJ]
SHARES = ["compute e all pe/atom kspace", "compute es all reduce sum c_e", "compute em all reduce max c_e",
          "compute s all stress/atom NULL kspace",
          "compute ss all reduce sum c_s[1] c_s[5]", "compute sm all reduce max c_s[3]"]
VALUES = ["elong", "ecoul", "pe", "press", "pxx", "pxy", "pyz"]


def case(solver, *more, fixes=NVE, box=(), boundary="p p p", values=(), runs=("run 4", "run 4"), pairs=PAIRS):
    return scene(*box, *CHARGES, *pairs, *solver, *more, *fixes, values=[*VALUES, *values], runs=runs, boundary=boundary)


CASES = {
    # the first: in a process that had other scenes before LAMMPS has other numbers for it
    "ewald triclinic, kmax": case(["kspace_style ewald 1e-5", "kspace_modify kmax/ewald 7 4 3"], box=TILT),
    "pppm": case(["kspace_style pppm 1e-4"]),
    "pppm order 3": case(["kspace_style pppm 1e-5", "kspace_modify order 3"]),
    "pppm order 6, mesh and splitting given": case(["kspace_style pppm 1e-4", "kspace_modify order 6 mesh 9 10 12 gewald 0.33"]),
    "pppm force": case(["kspace_style pppm 1e-4", "kspace_modify force 0.01"]),
    "pppm ad": case(["kspace_style pppm 1e-4", "kspace_modify diff ad gewald 0.4 mesh 12 12 10 order 4"]),
    "pppm triclinic": case(["kspace_style pppm 1e-4"], box=TILT),
    "pppm slab": case(["kspace_style pppm 1e-4", "kspace_modify slab 3.0"], boundary="p p f",
                      fixes=[*NVE, "fix w all wall/reflect zlo EDGE zhi EDGE"]),
    "pppm slab, a coarse mesh": case(["kspace_style pppm 1e-4", "kspace_modify slab 3.0 mesh 6 6 6 gewald 0.5"], boundary="p p f",
                                     fixes=[*NVE, "fix w all wall/reflect zlo EDGE zhi EDGE"]),
    **{f"{name}, slab ew2d": case([f"kspace_style {name.split()[0]} 1e-4", "kspace_modify slab ew2d", *more], boundary="p p f",
                                  box=["change_box all z delta -9 9"], runs=["run 0"])
       for name, more in (("pppm", ()), ("pppm ad", ("kspace_modify diff ad gewald 0.4 mesh 12 12 10 order 4",)), ("ewald", ()),
                          ("pppm/stagger", ("kspace_modify gewald 0.4 mesh 8 9 10",)), ("pppm/cg", ()))},
    "pppm shares": case(["kspace_style pppm 1e-4"], *SHARES, values=["c_es", "c_em", "c_ss[1]", "c_ss[2]", "c_sm"]),
    **{f"pppm, no overlap, {name}": case(["kspace_style pppm 1e-4", f"kspace_modify gewald 0.3 order 7 overlap no mesh {mesh}"], *more,
                                         box=box)
       for name, mesh, more, box in (("order stays", "4 8 9", (), ()), ("a wide skin", "8 4 9", ("neighbor 6.0 bin",), ()),
                                     ("two lower", "9 8 3", (), ()), ("triclinic", "8 3 8", ("neighbor 4.0 bin",), TILT))},
    "pppm/stagger, no overlap": case(["kspace_style pppm/stagger 1e-4", "kspace_modify gewald 0.3 order 7 overlap no mesh 3 8 9"]),
    "pppm npt": case(["kspace_style pppm 1e-4"], fixes=["fix 1 all npt temp 300 300 50 iso 0 0 100"]),
    "pppm npt triclinic": case(["kspace_style pppm 1e-4"], fixes=["fix 1 all npt temp 300 300 50 tri 0 0 100"], box=TILT),
    "pppm dielectric": case(["kspace_style pppm 1e-4", "dielectric 2.5"]),
    "compute no": case(["kspace_style pppm 1e-4", "kspace_modify compute no"]),
    "weights of special pairs": case(["kspace_style pppm 1e-4", "special_bonds lj 0 0.3 1 coul 0.2 0.5 0.9"]),
    "pppm/stagger": case(["kspace_style pppm/stagger 1e-4", "kspace_modify gewald 0.4 mesh 8 9 10"], *SHARES,
                         values=["c_es", "c_em", "c_ss[1]", "c_ss[2]", "c_sm"]),
    "pppm/stagger, a coarse mesh of its own": case(["kspace_style pppm/stagger 1e-2"]),
    "pppm/stagger ad": case(["kspace_style pppm/stagger 1e-4", "kspace_modify gewald 0.4 mesh 8 9 10 diff ad order 4"]),
    "ewald": case(["kspace_style ewald 1e-4"]),
    "ewald triclinic, shares": case(["kspace_style ewald 1e-5"], *SHARES, box=TILT, values=["c_es", "c_em", "c_ss[1]", "c_ss[2]", "c_sm"]),
    "ewald kmax": case(["kspace_style ewald 1e-5", "kspace_modify kmax/ewald 4 5 6"]),
    "ewald slab": case(["kspace_style ewald 1e-4", "kspace_modify slab 2.5"], boundary="p p f",
                       fixes=[*NVE, "fix w all wall/reflect zlo EDGE zhi EDGE"]),
    "ewald npt": case(["kspace_style ewald 1e-4"], fixes=["fix 1 all npt temp 300 300 50 aniso 0 0 100"]),
    "hybrid": case(["kspace_style pppm 1e-4"], pairs=[
        "pair_style hybrid/overlay lj/cut 5.0 coul/long 5.5", "pair_modify table 0", "pair_coeff * * coul/long",
        "pair_coeff 1 1 lj/cut 0.1 2.6", "pair_coeff 2 2 lj/cut 0.05 2.2", "pair_coeff 3 3 lj/cut 0.15 2.8"]),
}
WIRE = dict(boundary="f f p", fixes=[*NVE, "fix w all wall/reflect xlo EDGE xhi EDGE ylo EDGE yhi EDGE"])
WIRES = {
    "pppm wire": case([*NEUTRAL, "kspace_style pppm 1e-4", "kspace_modify wire 3.0"], **WIRE),
    "ewald wire": case([*NEUTRAL, "kspace_style ewald 1e-4", "kspace_modify wire 2.5"], **WIRE),
}


@pytest.fixture(scope="module")
def lammps(tmp_path_factory):
    """LAMMPS takes wires only in its solvers for electrodes, which are the same where there are none."""
    folder = tmp_path_factory.mktemp("kspace")
    wires = {name: given | {"commands": [c.replace("pppm 1", "pppm/electrode 1").replace("ewald 1", "ewald/electrode 1")
                                         for c in given["commands"]]} for name, given in WIRES.items()}
    found = lammps_of(CASES | wires, folder)
    for name, given in wires.items():
        WIRES[name]["data"] = given["data"]
    return found


@pytest.mark.part(5)
@pytest.mark.parametrize("name", CASES)
def test_against_lammps(name, lammps):
    compare(name, CASES[name], lammps[name])


@pytest.mark.parametrize("name", WIRES)
def test_wires_against_lammps(name, lammps):
    compare(name, WIRES[name], lammps[name])


# ------------------------------------------------------------------------------------------------------------ without LAMMPS

SCRIPT = """units real
atom_style charge
region b prism 0 24 0 22 0 26 {tilt}
create_box 2 b
mass * 20.0
create_atoms 1 random 400 7 NULL overlap 1.2
create_atoms 2 random 400 9 NULL overlap 1.2
set type 1 charge 0.5
set type 2 charge -0.5
pair_style lj/cut/coul/long 6.0 7.0
pair_coeff * * 0.05 1.5
kspace_style {solver}
neighbor 1.0 bin
"""


def engine(solver: str, tilt: str = "0 0 0", **settings) -> Engine:
    lmp = ran(SCRIPT.format(solver=solver, tilt=tilt))
    scene = lmp.session.scene
    return Engine(scene.system, scene.interactions, Settings(skin=1.0, **settings))


@pytest.mark.parametrize("solver", ["pppm 1e-4", "ewald 1e-4"])
@pytest.mark.parametrize("tilt", ["0 0 0", "4 -3 2"])
def test_threads_and_gradient(solver, tilt):
    one = engine(solver, tilt)
    a = one.compute(energies=True, virials=True)
    b = engine(solver, tilt, threads=2).compute(energies=True, virials=True)
    assert one.mode == "cluster"
    size = np.abs(a.forces).max()
    assert np.abs(a.forces - b.forces).max() < 1e-11 * size and a.energy["elong"] == pytest.approx(b.energy["elong"], rel=1e-11)
    assert a.energies_of["kspace"].sum() == pytest.approx(a.energy["elong"], rel=1e-11)
    assert np.allclose(a.virials_of["kspace"].sum(axis=0), a.virial_of["kspace"], rtol=1e-9, atol=1e-8 * np.abs(a.virial).max())
    # the slope of the energy: LAMMPS's erfc has errors of 1e-7 of a pair's force; the energy on a mesh depends on where an atom
    # lies between its points, which derivatives by waves leave out: several times the error that the solver expects
    total, h, x, force = {}, 1e-3, one.system.x.copy(), a.forces[5, 1]      # `a` is renewed by what follows
    for sign in (1, -1):
        moved = x.copy()
        moved[5, 1] += sign * h
        one.move(moved)
        total[sign] = sum(one.collect().energy.values())
    expected = 5 * one.solver.mesh_error if solver.startswith("pppm") else 1e-4
    assert -(total[1] - total[-1]) / (2 * h) == pytest.approx(force, abs=expected)


def test_solvers_agree_with_each_other():
    forces = {s: engine(s).compute().forces for s in ("ewald 1e-7", "pppm 1e-6", "pppm 1e-4")}
    exact = forces["ewald 1e-7"]
    for s, accuracy in (("pppm 1e-6", 1e-6), ("pppm 1e-4", 1e-4)):
        error = math.sqrt(((forces[s] - exact) ** 2).sum(axis=1).mean())
        assert error < 332.06371 * accuracy, s


@pytest.mark.parametrize("solver", ["pppm 1e-6", "ewald 1e-6"])
def test_wires(solver):
    """Hardly any trace of the empty space around a wire, across which only quadrupoles reach; shares of atoms add up; forces are the slope
    of the energy."""
    def of(across: str):
        script = SCRIPT.replace("prism 0 24 0 22 0 26 {tilt}", "block 0 10 0 10 0 20").replace("random 400", "random 40")
        lmp = ran(script.format(solver=solver) + f"kspace_modify wire {across}\nchange_box all boundary f f p")
        scene = lmp.session.scene
        return Engine(scene.system, scene.interactions, Settings(skin=1.0))
    near, far = of("5.0"), of("8.0")
    a = near.compute(energies=True, virials=True)
    b = far.compute()
    size, dipole = np.abs(a.forces).max(), near.system.q @ near.system.x
    taken_off = math.pi * 332.06371 * dipole[:2] @ dipole[:2] / (25 * 10 * 10 * 20)
    assert taken_off > 0.5 and abs(a.energy["elong"] + a.energy["ecoul"] - b.energy["elong"] - b.energy["ecoul"]) < 0.1 * taken_off
    assert np.abs(a.forces - b.forces).max() < 1e-3 * size
    assert a.energies_of["kspace"].sum() == pytest.approx(a.energy["elong"], rel=1e-11)
    total, h, x, force = {}, 1e-3, near.system.x.copy(), a.forces[5, 1]
    for sign in (1, -1):
        moved = x.copy()
        moved[5, 1] += sign * h
        near.move(moved)
        total[sign] = sum(near.collect().energy.values())
    assert -(total[1] - total[-1]) / (2 * h) == pytest.approx(force, abs=20 * near.solver.accuracy)


def rocksalt(solver: str, repeat: int = 2):
    a = 5.64
    basis = [(0, 0, 0), (0.5, 0.5, 0), (0.5, 0, 0.5), (0, 0.5, 0.5), (0.5, 0, 0), (0, 0.5, 0), (0, 0, 0.5), (0.5, 0.5, 0.5)]
    atoms = Atoms("Na4Cl4", scaled_positions=basis, cell=[a, a, a], pbc=True).repeat(repeat)
    edge = f"0 {repeat * a}"
    lmp = ran(["units real", "atom_style charge", f"region b block {edge} {edge} {edge}", "create_box 2 b", "mass * 1.0"])
    kinds = [1 if s == "Na" else 2 for s in atoms.symbols]
    lmp.create_atoms(len(atoms), list(range(1, len(atoms) + 1)), kinds, list(atoms.positions.ravel()))
    for c in ("set type 1 charge 1", "set type 2 charge -1", "pair_style coul/long 5.6", "pair_coeff * *", f"kspace_style {solver}",
              "run 0"):
        lmp.command(c)
    return lmp.get_thermo("ecoul") + lmp.get_thermo("elong"), len(atoms), a


def test_madelung_constant():
    e, n, a = rocksalt("ewald 1e-6")
    assert e / (n / 2) == pytest.approx(-1.747564594633 * 332.06371 / (a / 2), rel=3e-6)      # LAMMPS's erfc is good to 1.5e-7 of a pair


def test_from_ase():
    """Rock salt with a solver given in Python: forces vanish, ASE's stress is the slope of the energy, commands and files bring it back."""
    from asemd import ForceField
    a = 5.64
    atoms = Atoms("NaClNaClNaClNaCl", scaled_positions=[(0, 0, 0), (0.5, 0, 0), (0.5, 0.5, 0), (0, 0.5, 0), (0.5, 0, 0.5), (0, 0, 0.5),
                                                        (0, 0.5, 0.5), (0.5, 0.5, 0.5)], cell=[a] * 3, pbc=True).repeat(2)
    atoms.set_initial_charges([1.0 if s == "Na" else -1.0 for s in atoms.symbols])
    pairs = {("Na", "Na"): (0.2637, 0.317, 2.340, 1.0486, -0.4993), ("Cl", "Cl"): (0.1580, 0.317, 3.170, 72.4022, -145.4285),
             ("Cl", "Na"): (0.2110, 0.317, 2.755, 6.9906, -8.6757)}
    force_field = ForceField(pair={"born/coul/long 5.5": pairs}, kspace="pppm 1.0e-6", kspace_modify="order 6")
    atoms.calc = force_field
    energy = atoms.get_potential_energy()
    assert energy / len(atoms) == pytest.approx(-4.02, abs=0.05) and np.abs(atoms.get_forces()).max() < 1e-5      # of the mesh
    assert force_field.commands()[-2:] == ["kspace_style pppm 1.0e-6", "kspace_modify order 6"]
    again = atoms.copy()
    again.calc = ForceField(**{k: v for k, v in force_field.todict().items() if k in ("pair", "kspace", "kspace_modify", "skin")})
    assert again.get_potential_energy() == pytest.approx(energy, rel=1e-12)


@pytest.mark.parametrize("boundary, modify, across", [("p p f", "slab 3.0", (2,)), ("f f p", "wire 3.0", (0, 1))])
def test_slabs_and_wires_from_ase(boundary, modify, across, tmp_path):
    """Atoms that a script gives have the script's energy; a calculator made in Python too. What cannot be a slab or wire is refused."""
    from asemd import ForceField, InputError, read
    script = SCRIPT.replace("prism 0 24 0 22 0 26 {tilt}", "block 0 14 0 12 0 20").replace("random 400", "random 40")
    (tmp_path / "in").write_text(script.format(solver="pppm 1e-5") + f"kspace_modify {modify}\nchange_box all boundary {boundary}\nrun 0\n")
    atoms, lmp = read(tmp_path / "in"), start()
    lmp.file(str(tmp_path / "in"))
    kcal = units.factor("energy", "real")
    assert atoms.get_potential_energy() / kcal == pytest.approx(lmp.get_thermo("pe"), rel=1e-12)
    made = atoms.copy()
    made.calc = ForceField(pair={"lj/cut/coul/long 6.0 7.0": {(1, 1): (0.05 * kcal, 1.5), (2, 2): (0.05 * kcal, 1.5)}},
                           kspace="pppm 1e-5", kspace_modify=modify)
    assert np.allclose(made.get_forces(), atoms.get_forces(), rtol=0, atol=1e-4)      # the mesh's: other constants
    whole, flat, gone = made.copy(), made.copy(), made.copy()
    whole.pbc = True
    flat.cell[across[0]] = 0.0
    gone.positions[3, across[0]] += 50.0
    for wrong, message in ((whole, f"needs boundary {boundary} .*pbc ="), (flat, f"three cell vectors, {'abc'[across[0]]} is zero"),
                           (gone, f"atom 4 is outside of it along {'abc'[across[0]]}")):
        wrong.calc = made.calc.copy()
        with pytest.raises(InputError, match=message):
            wrong.get_potential_energy()


def test_choices_without_a_scene():
    pppm = class_of("kspace", "pppm", object)
    from asemd.kspace.pppm import aliases, pieces, with_small_factors
    assert [with_small_factors(n) for n in (7, 11, 13, 31)] == [8, 12, 15, 32]
    for order in range(2, 8):
        t = np.linspace(-0.5, 0.5, 7)
        values = np.array([np.polyval(p[::-1], t) for p in pieces(order)])
        assert np.allclose(values.sum(axis=0), 1.0, atol=1e-14) and (values > -1e-15).all()
        assert aliases(order)[0] == pytest.approx(1.0)
    assert pppm.from_words(["1e-4"]).accuracy_relative == 1e-4


@pytest.mark.parametrize("lines, message", [
    (["kspace_style pppm"], "needs one number"), (["kspace_style pppm 0"], "must not be 0"), (["kspace_style pppm many"], "accuracy"),
    (["kspace_style pppm 1e-4", "kspace_modify order 8", "run 0"], "order must be 2 to 7"),
    (["kspace_style pppm 1e-4", "kspace_modify order 4 minorder 5", "run 0"], "less than kspace_modify minorder 5"),
    (["kspace_style pppm 1e-4", "kspace_modify mesh 3 8 8 order 7 minorder 6 overlap no", "run 0"], "coarse for order 6, and minorder 6"),
    (["kspace_style pppm 1e-4", "kspace_modify wire 3.0", "run 0"], "boundary f f p"),
    (["change_box all boundary f f p", "kspace_style pppm 1e-4", "kspace_modify wire 3.0", "run 0"], "must add up to 0.* 2 "),
    (["change_box all boundary f f p", "kspace_style pppm 1e-4", "kspace_modify wire 3.0 slab 3.0", "run 0"], "slab or wire, not both"),
    (["kspace_style ewald/disp 1e-4", "kspace_modify wire 3.0", "run 0"], "does not take kspace_modify wire; ewald and pppm do"),
    (["kspace_style pppm 1e-4", "kspace_modify scafacos tolerance energy", "run 0"], "unknown kspace_modify keyword 'scafacos'"),
    (["kspace_style scafacos fmm 1e-4"], "unknown kspace style"),
    (["pair_style lj/cut 5.0", "pair_coeff * * 1 1", "kspace_style pppm 1e-4", "run 0"], "needs a pair style that leaves it"),
    (["kspace_style none", "run 0"], "needs a kspace_style"),
    (["set type * charge 0", "kspace_style pppm 1e-4", "run 0"], "all charges are 0"),
    (["kspace_style ewald 1e-4", "kspace_modify slab 3.0", "run 0"], "boundary p p f"),
    (["change_box all boundary p p f", "kspace_style pppm 1e-4", "run 0"], "periodic in all directions.*slab"),
    (["pair_style hybrid/overlay coul/long 5.0 lj/cut/coul/long 4.0", "pair_coeff * * coul/long", "pair_coeff * * lj/cut/coul/long 1 1",
      "kspace_style pppm 1e-4", "run 0"], "sub-styles differ")])
def test_what_is_refused(lines, message):
    refused([*SCENE, "pair_style coul/long 6.0", "pair_coeff * *", *lines], message)


def test_units_of_two_charges():
    u = units.get("real")
    assert u.qqr2e * u.qelectron**2 / u.angstrom**2 == pytest.approx(332.06371)
