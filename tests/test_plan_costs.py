"""What `asemd plan` expects is what a run then takes: memory within a quarter, speed within a factor of three; imports stay away."""
from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from lj_cell import BASE

import asemd
from asemd.lammps import Lammps, calibration, plan_speed

ENV = {**os.environ, "PYTHONPATH": str(Path(asemd.__file__).parents[1])}


def liquid(cells: int, more: str = "", style: str = "lj/cut 2.5", density: float = 0.8442) -> str:
    return f"""
units lj
atom_style charge
lattice fcc {density}
region b block 0 {cells} 0 {cells} 0 {cells}
create_box 1 b
create_atoms 1 box
mass 1 1
pair_style {style}
pair_coeff * * 1 1
velocity all create 1.0 87287
neighbor 0.3 bin
{more}
fix 1 all nve
timestep 0.002
"""


def chains(pairs: str = "", count: int = 60, length: int = 20) -> tuple[str, str]:
    """A script and its data file: zigzag chains with bonds, angles and dihedrals."""
    along = np.arange(length)
    shape = np.column_stack([0.82 * along, 0.57 * (along % 2), 0.1 * (along % 3)])
    atoms, items = [], {"bond": [], "angle": [], "dihedral": []}
    for c in range(count):
        x = shape + (1.0, 1.0 + 2.0 * (c % 14), 1.0 + 2.0 * (c // 14))
        atoms += [f"{c * length + i + 1} {c + 1} 1 {0.1 * (-1) ** i} " + " ".join(f"{a:.4f}" for a in x[i]) for i in range(length)]
        for k, kind in ((2, "bond"), (3, "angle"), (4, "dihedral")):
            items[kind] += [[c * length + i + j + 1 for j in range(k)] for i in range(length - k + 1)]
    counts = [f"{len(v)} {k}s" for k, v in items.items()] + [f"1 {k} types" for k in items]
    out = ["chains", "", f"{count * length} atoms", *counts, "1 atom types", "0 30 xlo xhi", "0 30 ylo yhi", "0 30 zlo zhi",
           "", "Masses", "", "1 1", "", "Atoms", "", *atoms]
    for k, v in items.items():
        out += ["", f"{k.capitalize()}s", "", *(f"{n} 1 " + " ".join(map(str, item)) for n, item in enumerate(v, 1))]
    style, _, rest = pairs.partition("\n")
    script = f"""
units lj
atom_style full
{style}
bond_style harmonic
angle_style harmonic
dihedral_style harmonic
read_data data.chains
{rest}
bond_coeff 1 50 1
angle_coeff 1 10 110
dihedral_coeff 1 1 1 2
velocity all create 0.01 87287
fix 1 all nve
timestep 0.0005
"""
    return script, "\n".join(out) + "\n"


PAIRS = "pair_style lj/cut/coul/cut 1.2 2.5\npair_coeff * * 0.1 0.5\nspecial_bonds lj/coul 0 0 0.5"
SCENES = {"liquid": (liquid(10), ""), "outdated lists": (liquid(8, "neigh_modify every 5 delay 10"), ""),
          "exclusions by group": (liquid(8, "group g id 1:100\nneigh_modify exclude group g g"), ""),
          "gas": (liquid(8, density=0.01), ""), "chains": chains(PAIRS), "chains without pairs": chains(), "few atoms": (liquid(3), ""),
          "wide cutoff": (liquid(4, style="lj/cut 4"), "")}
SOLVERS = {name: (liquid(cells, f"set atom 1*{2 * cells**3} charge 0.3\nset atom {2 * cells**3 + 1}*{4 * cells**3} charge -0.3\n{solver}",
                         style="lj/cut/coul/long 2.5"), "")
           for name, cells, solver in (("mesh", 8, "kspace_style pppm 1e-4"), ("waves", 4, "kspace_style ewald 1e-3"))}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def loaded(folder, name: str, threads: int = 1) -> Lammps:
    script, data = {**SCENES, **SOLVERS}[name]
    (folder / "data.chains").write_text(data)
    lammps = Lammps(cmdargs=["-screen", "none", "-log", "none"])
    lammps.scene.threads = threads
    lammps.commands_string(script)
    return lammps


def held(root) -> int:
    """Bytes of all arrays that can be reached, each counted once."""
    total, seen, stack = 0, set(), [root]
    while stack:
        thing = stack.pop()
        if id(thing) in seen:
            continue
        seen.add(id(thing))
        if isinstance(thing, np.ndarray):
            while isinstance(thing.base, np.ndarray):
                thing = thing.base
                if id(thing) in seen:
                    break
            else:
                seen.add(id(thing))
                total += thing.nbytes
        elif isinstance(thing, dict):
            stack += thing.values()
        elif isinstance(thing, (list, tuple)):
            stack += thing
        elif type(thing).__module__.startswith("asemd"):
            stack += vars(thing).values() if hasattr(thing, "__dict__") else ()
    return total


@pytest.mark.parametrize("name", SCENES)
def test_memory_of_the_arrays(folder, name):
    lammps = loaded(folder, name, threads=2 if name == "liquid" else 1)
    expected = asemd.plan(lammps.scene).bytes
    lammps.command("run 20")
    assert expected == pytest.approx(held(lammps.session), rel=0.25 if lammps.get_natoms() > 1000 else 0.5)


def test_memory_of_a_process(tmp_path):
    """The difference between a large and a small scene, as the system counts it, within a factor of 1.5."""
    code = """
import re, sys, asemd
from asemd.lammps import Lammps
l = Lammps(cmdargs=["-screen", "none", "-log", "none"])
l.commands_string(open(sys.argv[1]).read())
print(asemd.plan(l.scene).bytes)
l.command("run 10")
print(1024 * int(re.search(r"VmHWM:\\s*(\\d+)", open("/proc/self/status").read())[1]))
"""
    if not Path("/proc/self/status").exists():
        pytest.skip("only Linux tells the largest memory of a process apart from its parent's")
    answers = []
    for cells in (7, 7, 28):        # the first one may have to compile, which takes memory
        (tmp_path / "in.x").write_text(liquid(cells))
        done = subprocess.run([sys.executable, "-c", code, "in.x"], cwd=tmp_path, env=ENV, capture_output=True, text=True, check=True)
        answers.append([float(line) for line in done.stdout.split()])
    expected, measured = np.diff(answers[1:], axis=0)[0]
    assert expected / 1.5 < measured < 1.5 * expected


@pytest.fixture(scope="module")
def costs():
    if os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):
        pytest.skip("speed without the compiler is not expected to be anything")
    return calibration.calibrate()


def seconds(lammps: Lammps, steps: int) -> float:
    """Of one step."""
    return calibration.timed(lammps, steps)[0] / steps


def test_speed_of_the_liquid(folder, costs):
    """Within a factor of three of what is expected of the machine as it was before or is after: its speed may change meanwhile."""
    lammps = loaded(folder, "liquid")
    before = asemd.plan(lammps.scene).steps_per_second
    lammps.command("run 10")
    found = 1.0 / float(np.median([seconds(lammps, 40) for _ in range(5)]))
    calibration.calibrate(again=True)
    after = asemd.plan(lammps.scene).steps_per_second
    assert min(before, after) / 3 < found < 3 * max(before, after)


@pytest.mark.parametrize("name", ["chains", "chains without pairs", "few atoms", "gas", *SOLVERS])
def test_speed_beside_the_liquid(folder, costs, name):
    """The ratio of two scenes that run in turns: what slows the machine slows both."""
    one, liquid = scenes = [loaded(folder, name), loaded(folder, "liquid")]
    expected = [asemd.plan(lammps.scene).steps_per_second for lammps in scenes]
    for lammps in scenes:
        lammps.command("run 10")
    found = float(np.median([seconds(liquid, 40) / seconds(one, 300) for _ in range(7)]))
    assert 1 / 3 < found * expected[1] / expected[0] < 3


COSTS = calibration.Costs(program=1e8, step=1e-6, atom=2e-8, pair=1e-9, operation=1e-10, call=1e-9, single=8e-9, build=4e-9, row=1e-4,
                          wave=2e-9, spread=3e-9, mesh=2e-8, items={"bond": 4e-8, "angle": 6e-8, "dihedral": 9e-8, "improper": 9e-8})


@pytest.mark.parametrize("name", ["liquid", "chains", "chains without pairs", "few atoms", "gas"])
def test_speed_is_counts_times_costs(folder, monkeypatch, name):
    """No clock: the counts of the plan are those of the run, and every part of a step is in the sum."""
    monkeypatch.setattr(calibration, "known", lambda *machine: COSTS)
    lammps = loaded(folder, name)
    expected = 1.0 / asemd.plan(lammps.scene).steps_per_second
    lammps.command("run 100")
    e = lammps.session.loop.engine
    count = e.pairs if e.mode != "none" else 0
    pair, = {COSTS.formula(p.function for p in t.style.parts) for t in e.pair_terms} or {0.0}
    if e.mode != "cluster" or name == "gas":        # one pair at a time
        pair += COSTS.single - COSTS.pair
    items = sum(len(t.items) * COSTS.items[t.category] for t in e.terms if t.category != "pair")
    lists = (count * COSTS.build + e.system.n * COSTS.atom) * e.builds / 100
    assert expected == pytest.approx(COSTS.step + e.system.n * COSTS.atom + count * pair + items + lists, rel=0.25)


@pytest.mark.parametrize("name", SOLVERS)
def test_solvers_are_counts_times_costs(folder, monkeypatch, name):
    monkeypatch.setattr(calibration, "known", lambda *machine: COSTS)
    lammps = loaded(folder, name)
    expected, n = 1.0 / asemd.plan(lammps.scene).steps_per_second, lammps.get_natoms()
    monkeypatch.setattr(calibration, "known", lambda *machine: replace(COSTS, wave=0.0, spread=0.0, mesh=0.0))
    without = 1.0 / asemd.plan(lammps.scene).steps_per_second
    lammps.command("run 0")
    solver = lammps.session.loop.engine.solver
    counted = COSTS.wave * n * solver.waves if name == "waves" else COSTS.spread * n * 125 + COSTS.mesh * np.prod(solver.mesh)
    assert expected - without == pytest.approx(counted)


def test_costs_are_numbers(costs):
    assert 5e7 < costs.program < 1e9 and min(costs.atom, costs.pair, costs.single, costs.build, costs.wave, costs.spread, costs.mesh,
                                             *costs.items.values()) > 0.0


def test_calibration_is_done_once(tmp_path, monkeypatch):
    monkeypatch.setenv("ASEMD_CACHE_DIR", str(tmp_path / "new"))
    values = {"step": 1e-6, "atom": 1e-8, "pair": 1e-9, "operation": 1e-10, "call": 1e-9, "single": 1e-8, "build": 1e-9, "row": 1e-4,
              "wave": 1e-9, "spread": 1e-9, "mesh": 1e-8, "items": {"bond": 1e-8}}
    monkeypatch.setattr(calibration, "_process", lambda threads, precision, *what: {"program": 1e8} if what else values)
    first = calibration.calibrate(2, "mixed")
    monkeypatch.setattr(calibration, "_process", lambda threads, precision, *what: {"program": 1e8} if what else {**values, "step": 2e-6})
    assert calibration.calibrate(2, "mixed", again=True).step == 2e-6
    monkeypatch.setattr(calibration, "_process", lambda threads, precision, *what: {"program": 1e8} if what else values)
    calibration.calibrate(2, "mixed", again=True)
    monkeypatch.setattr(calibration, "_process", lambda *a: pytest.fail("measured again"))
    assert calibration.calibrate(2, "mixed") == first == calibration.Costs(program=1e8, **values)
    assert calibration.known(1, "double") is None
    (tmp_path / "new" / calibration.FILE).write_text("{ nonsense")
    assert calibration.known(2, "mixed") is None


def test_formulas_with_more_in_them_cost_more(costs):
    from asemd import style
    work = {name: calibration.work(style.find("pair", name).functions()) for name in ("lj/cut", "lj/cut/coul/cut", "morse")}
    assert work["lj/cut"][0] < work["lj/cut/coul/cut"][0] and work["lj/cut"][1] < work["morse"][1]
    assert costs.formula(style.find("pair", "lj/cut").functions()) < costs.formula(style.find("pair", "morse").functions())


def test_lists_are_built_as_often_as_expected(folder):
    lammps = loaded(folder, "liquid")
    lammps.command("run 0")
    expected = plan_speed.between_builds(lammps.session.loop.engine, lammps.scene.dt)
    lammps.command("run 300")
    assert 300 / lammps.session.loop.engine.builds == pytest.approx(expected, rel=0.5)


@pytest.mark.parametrize("name, switch", [
    ("tail correction", "pair_modify tail yes"), ("energies and virials per atom", "compute 1 all stress/atom NULL"),
    ("dumps", "dump 1 all atom 10 dump.x"), ("marks of pairs out of reach", "neigh_modify every 2"),
    ("Coulomb part", "pair_style lj/cut/coul/cut 1.5\npair_coeff * * 1 1"),
    ("tilted image shifts", "change_box all triclinic\nchange_box all xy final 1 remap"),
    ("energy and virial between outputs", None), ("force buffers of threads", None)])
def test_what_is_left_out_says_what_switches_it_on(folder, name, switch):
    (folder / "in.x").write_text(liquid(6) + "run 1\n")
    item, = [i for i in asemd.plan("in.x").left_out if i.name == name]
    assert item.switch and item.why
    if switch:
        assert switch.split()[0] in item.switch or "triclinic" in item.switch
        (folder / "in.y").write_text(liquid(6) + switch + "\nrun 1\n")
        assert name not in [i.name for i in asemd.plan("in.y").left_out]


def test_everything_left_out_has_a_switch(folder):
    for name in ("liquid", "chains without pairs", "few atoms"):
        assert all(i.switch and i.why for i in asemd.plan(loaded(folder, name).scene).left_out)


# ------------------------------------------------------------------------------------------------------------------- imports ---

def test_import_takes_at_most_150_ms():
    code = "import time; began = time.perf_counter(); import asemd; print(time.perf_counter() - began)"
    assert min(float(subprocess.check_output([sys.executable, "-c", code], env=ENV)) for _ in range(5)) <= 0.15


@pytest.mark.parametrize("more, wanted", [("", set()), ("dump d all dcd 5 x.dcd", {"MDAnalysis"})])
def test_a_run_imports_what_it_uses(tmp_path, more, wanted):
    if wanted:
        pytest.importorskip("MDAnalysis")
    (tmp_path / "in.x").write_text(BASE + more + "\nrun 5\n")
    code = """
import sys
from asemd import cli
assert cli.main(["run", "in.x", "--quiet"]) == 0
heavy = {"MDAnalysis", "matplotlib", "sympy", "spglib", "ase", "vl_convert", "markdown_it", "selenium", "rich",
         "asemd.page", "asemd.report", "asemd.check"}
print(*sorted(heavy & set(sys.modules)))
"""
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, env=ENV, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    found = set(done.stdout.split())
    assert found == set() if not wanted else wanted <= found
