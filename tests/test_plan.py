"""asemd plan: what a scene needs, what is left out, and why; without compiling and without a step."""
from __future__ import annotations

import json

import numpy as np
import pytest
from lj_cell import BASE
from test_validate import molecules

import asemd
from asemd import cli
from asemd.errors import InputError
from asemd.lammps import calibration


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("load", "forces"):
        monkeypatch.setattr(f"asemd.engine.Engine.{name}", lambda self, *a: pytest.fail("a plan computes nothing"))
    return tmp_path


def items(plan, section: str) -> dict:
    found = plan.left_out if section == "Left out" else plan.sections[section]
    return {i.name: i for i in found}


def big(cells: int) -> str:
    return BASE.replace("0 2 0 2 0 2", " ".join([f"0 {cells}"] * 3))


def test_cluster_scene(folder, capsys):
    (folder / "in.x").write_text(big(6) + "thermo 5\ndump d all atom 3 dump.x\nrun 10\n")
    assert cli.main(["plan", "in.x"]) == 0
    assert "cluster kernel" in capsys.readouterr().out
    plan = asemd.plan("in.x")
    near, pair = items(plan, "Neighbour list"), items(plan, "Forces")["pair lj/cut"]
    assert "clusters of 8" in near["list"].how and "1.8 = cutoff 1.5 + skin 0.3" in near["reach"].how
    assert "without charges" in pair.how and "no exclusions" in pair.how
    assert items(plan, "Fixes")["time loop"].how.startswith("compiled") and items(plan, "Fixes")["fix 1"].how == "nve on group all"
    assert "every 5 steps" in items(plan, "Output")["energy and virial"].how and "dump d" in items(plan, "Output")
    assert {"k-space", "bond forces", "Coulomb part", "energies and virials per atom", "tail correction"} <= set(items(plan, "Left out"))
    assert sorted(p.name for p in folder.iterdir()) == ["in.x"]


def test_small_scene_and_per_atom_computes(folder):
    few = BASE.replace("0 2 0 2 0 2", "0 2 0 2 0 1")
    (folder / "in.x").write_text(few + "compute s all stress/atom NULL\ndump d all custom 3 dump.x id c_s[1]\nrun 10\n")
    plan = asemd.plan("in.x")
    assert "fewer than" in items(plan, "Neighbour list")["list"].why
    assert "compute s" in items(plan, "Output")["per-atom kernels"].why and "energies and virials per atom" not in items(plan, "Left out")


def test_estimated_pairs_are_those_of_the_list(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "in.x").write_text(BASE.replace("lj/cut 1.5", "lj/cut 2.7").replace("0 2 0 2 0 2", "0 6 0 6 0 6") + "run 1\n")
    about = float(items(asemd.plan("in.x"), "Neighbour list")["pairs"].how.split()[1].rstrip(","))
    atoms = asemd.read("in.x")
    atoms.positions += np.random.default_rng(0).normal(0, 0.1, (len(atoms), 3))
    engine = atoms.calc.engine or (atoms.get_potential_energy(), atoms.calc.engine)[1]
    i, *_ = engine.list.expand(engine.k, engine.state, engine.reach)
    assert about == pytest.approx(len(i), rel=0.1)


def test_python_hooks_are_named(folder):
    (folder / "in.x").write_text(BASE + "variable t equal 1+step\nfix 2 all langevin v_t 1 1 123\nrun 10\n")
    loop = items(asemd.plan("in.x"), "Fixes")["time loop"]
    assert loop.how == "step by step" and "fix 2 (langevin)" in loop.why


def test_atoms(folder):
    plan = asemd.plan(molecules())
    forces = items(plan, "Forces")
    assert forces["bond harmonic"].how.startswith("36 bonds")
    assert forces["1-4 pairs"].how == "12 weighted" and forces["1-2 pairs"].how == "36 excluded"
    assert "images along z" in items(plan, "Left out") and "tilted image shifts" not in items(plan, "Left out")
    assert json.loads(json.dumps(plan.to_dict()))["left_out"] and str(plan).startswith("Plan of ForceField")
    with pytest.raises(InputError, match="Scene, or atoms"):
        asemd.plan(asemd.Atoms("H"))


def test_only_on_request_is_the_machine_measured(folder, capsys, monkeypatch):
    """It takes some seconds, and more where kernels have to be compiled for it."""
    monkeypatch.setenv("ASEMD_CACHE_DIR", str(folder / "cache"))
    (folder / "in.x").write_text(BASE + "run 10\n")
    costs = calibration.Costs(1e8, 1e-6, 1e-8, 1e-9, 1e-10, 1e-9, 1e-8, 1e-9, 1e-4, 1e-9, 1e-9, 1e-8, {"bond": 1e-8})
    monkeypatch.setattr(calibration, "calibrate", lambda *a, **k: pytest.fail("measured without being asked"))
    assert cli.main(["plan", "in.x"]) == 0
    shown = capsys.readouterr()
    assert "not known" in shown.out and "asemd plan --calibrate" in " ".join(shown.out.split()) and not shown.err
    monkeypatch.setattr(calibration, "calibrate", lambda *a, again: again and monkeypatch.setattr(calibration, "known", lambda *a: costs))
    assert cli.main(["plan", "in.x", "--calibrate"]) == 0
    shown = capsys.readouterr()
    assert "Measuring the speed of this machine" in shown.err and "a calibration of this machine" in shown.out


def test_when_energy_and_virial_are_computed(folder):
    """A barostat asks for the virial on every step; nothing is said of dumps where there are none."""
    text = big(6).replace("fix 1 all nve", "fix 1 all {} temp 1 1 1{}") + "thermo 5\nrun 10\n"
    for style, more in (("nvt", ""), ("npt", " iso 0 0 1")):
        (folder / "in.x").write_text(text.format(style, more))
        plan = asemd.plan("in.x")
        output, left = items(plan, "Output"), items(plan, "Left out")
        assert output["energy and virial"].how == "every 5 steps, first and last"
        assert ("virial" in output) == ("energy between outputs" in left) == (style == "npt")
        assert ("energy and virial between outputs" in left) == (style == "nvt")
    assert output["virial"].how == "every step" and output["virial"].why == "fix 1 (npt) asks for it"
    (folder / "in.x").write_text(text.format("nve #", "") + "dump d all atom 3 dump.x\nrun 10\n")
    (folder / "in.x").write_text((folder / "in.x").read_text().replace("run 10\n", "", 1))
    assert items(asemd.plan("in.x"), "Output")["energy and virial"].how.endswith("; on steps with a dump")


def test_a_script_that_begins_with_minimize(folder):
    (folder / "in.x").write_text(big(6) + "minimize 1e-3 1e-4 10 20\nrun 10\n")
    plan = asemd.plan("in.x")
    line = (folder / "in.x").read_text().splitlines().index("minimize 1e-3 1e-4 10 20") + 1
    assert str(plan).startswith(f"Plan of in.x, line {line}: minimize 1e-3 1e-4 10 20")
    fixes = items(plan, "Fixes")
    assert fixes["minimisation"].how == "min_style cg" and "time loop" not in fixes and fixes["fix 1"].why == "rests during minimisation"
    assert items(plan, "Output")["energy and virial"].how == "at every evaluation" and "Speed" not in plan.sections


def test_mistakes_have_a_place(folder, capsys):
    text = big(6).replace("pair_coeff", "#") + "run 10\n"
    (folder / "in.x").write_text(text)
    for command in ("plan", "report"):
        assert cli.main([command, "in.x"]) == 1
        assert f"(in.x:{len(text.splitlines())}: run 10)" in capsys.readouterr().err


def test_no_forces(folder, capsys):
    (folder / "in.x").write_text("region b block 0 4 0 4 0 4\ncreate_box 1 b\ncreate_atoms 1 single 1 1 1\nmass 1 1\n")
    assert cli.main(["plan", "in.x", "--json"]) == 0
    left = {i["name"] for i in json.loads(capsys.readouterr().out)["left_out"]}
    assert "neighbour list" in left and "energy and virial between outputs" in left
    (folder / "in.y").write_text("units lj\n")
    assert cli.main(["plan", "in.y"]) == 1
