"""Rigid bodies on several levels of time steps: LAMMPS's numbers where it is asked to be followed, and the right motion otherwise.

LAMMPS begins the steps of the innermost level with the force of another level, so that bodies feel 1 + 1/(2 n) times the forces of the
outer one (n inner steps) and 1 - 1/(2 n) times those of the inner one; that is what ``compat lammps`` does, too.
"""
from __future__ import annotations

import numpy as np
import pytest
from both import asemd, lines_of
from scripted import script, write_data
from wheel import ask

from asemd.errors import InputError

TWO, HYBRID = "respa 2 3 inner 1 2.5 3.5 outer 2", "respa 3 2 2 bond 1 inner 2 2.5 3.5 outer 3"
SCENE = """
neigh_modify exclude molecule/intra all
comm_modify cutoff 11.5
group bodies id 1:40
group free subtract all bodies
thermo_style custom step pe ke press pxx pxy
thermo_modify norm no
{fix}
run_style {levels}
timestep {dt}
run {steps}
"""
CASES = {
    "rigid": (TWO, "fix 1 all rigid molecule"),
    "rigid/nve, three levels": (HYBRID, "fix 1 all rigid/nve molecule"),
    "small, beside atoms": (HYBRID, "fix 1 bodies rigid/small molecule\nfix 2 free nve"),
    "bonds between bodies": ("respa 2 2 bond 1 pair 2", "neigh_modify exclude none\nfix 1 all rigid/nve/small custom v_half"),
    "one level": ("respa 1 pair 1", "fix 1 all rigid/nvt molecule temp 300 300 20"),
    "components": (TWO, "fix 1 all rigid molecule force 1*3 off on on torque * on off on"),
}
NUMBERS = ("pe", "ke", "press", "pxx", "pxy")
SCRIPT = """
answer = {}
for name, lines in given["cases"].items():
    lmp = ran(lines)
    x, v = (list(lmp.gather_atoms(key, 1, 3)) for key in "xv")
    answer[name] = {"x": x, "v": v, "thermo": [lmp.get_thermo(key) for key in given["numbers"]]}
    lmp.close()
"""


def scene(folder, name: str, steps: int = 20, dt: float = 1.0) -> str:
    levels, fix = CASES[name]
    return script(folder / "data") + "variable half atom floor((id+1)/2)\n" + SCENE.format(fix=fix, levels=levels, steps=steps, dt=dt)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("levels")
    write_data(folder / "data")
    return folder


@pytest.fixture(scope="module")
def theirs(folder):
    return ask(SCRIPT, numbers=NUMBERS, cases={name: lines_of(scene(folder, name)) for name in CASES})


def as_lammps(text: str):
    """A session with ``compat lammps``."""
    from asemd.lammps.session import Session
    from asemd.lammps.switches import Switches
    switches = Switches()
    switches.log, switches.compat = "none", "lammps"
    session = Session(switches=switches, screen=lambda line: None)
    session.commands("\n".join(lines_of(text)) + "\n")
    return session


@pytest.mark.parametrize("name", CASES)
def test_like_lammps(name, folder, theirs):
    session, expected = as_lammps(scene(folder, name)), theirs[name]
    system = session.scene.system
    for key in ("x", "v"):
        b = np.array(expected[key]).reshape(-1, 3)
        assert abs(getattr(system, key) - b).max() < 1e-11 * abs(b).max(), key
    m = session.moment
    assert [m.potential(), m.kinetic(), m.pressure()] == pytest.approx(expected["thermo"][:3], rel=1e-9)


def ends(text: str) -> np.ndarray:
    """Positions (n, 3) at the end of a script, unwrapped."""
    system = asemd(text).scene.system
    return system.box.unwrap(system.x, system.image)


@pytest.mark.parametrize(("fix", "order"), [("rigid molecule", 2), ("rigid/nvt/small molecule temp 300 300 20", 2),
                                            ("rigid/npt molecule temp 300 300 20 iso 0 0 100", 1)])
def test_small_steps(fix, order, folder):
    """By shorter steps the motion becomes that of run_style verlet, with an error that is a power of the step (1 for LAMMPS's barostat)."""
    head = script(folder / "data") + SCENE.replace("{fix}", f"fix 1 all {fix}").replace("run {steps}", "run {steps} start 0 stop 100000")
    exact = ends(head.format(levels="verlet", steps=128, dt=0.0625))
    long, short = (abs(ends(head.format(levels=HYBRID, steps=round(8 / dt), dt=dt)) - exact).max() for dt in (2.0, 1.0))
    verlet = abs(ends(head.format(levels="verlet", steps=8, dt=1.0)) - exact).max()
    assert short < 0.4 * verlet
    assert 0.8 * order < np.log2(long / short) < 1.2 * order


def test_pressure(folder):
    """The virial of the constraint: every level has its part."""
    lines = script(folder / "data") + SCENE.format(fix="fix 1 all rigid molecule", levels="{levels}", steps=16, dt=0.1)
    verlet, levels = (asemd(lines.format(levels=style)).moment.pressure() for style in ("verlet", HYBRID))
    assert levels == pytest.approx(verlet, rel=2e-3)


def test_mistakes(folder):
    early = scene(folder, "rigid").replace("run_style", "fix_modify 1 bodyforces early\nrun_style")
    with pytest.raises(InputError, match="bodyforces early does not work with run_style respa"):
        asemd(early)
    with pytest.raises(InputError, match="does not support respa 1"):
        asemd(scene(folder, "rigid").replace("run_style", "fix_modify 1 respa 1\nrun_style"))


def test_a_heat_bath_acts_once(folder):
    """Friction of langevin, on the outermost level alone: bodies without forces slow down as with run_style verlet."""
    lines = script(folder / "data") + SCENE.format(fix="fix 1 all rigid molecule langevin 0 0 10 77\npair_coeff * * 0 1",
                                                   levels="{levels}", steps=20, dt=1.0)
    a, b = (asemd(lines.format(levels=style)).scene.fixes["1"].bodies for style in ("verlet", TWO))
    assert b.v == pytest.approx(a.v, rel=1e-9, abs=1e-12)
    assert b.omega == pytest.approx(a.omega, rel=0.05, abs=1e-4)
    assert abs(b.v).max() < 0.15 * 0.016
