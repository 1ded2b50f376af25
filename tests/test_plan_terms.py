"""``asemd plan``, ``asemd check``, pages and second derivatives know every kind of force: solvers, many-body styles, charges by themselves,
dipoles, noise, hydrogen bonds."""
from __future__ import annotations

import warnings

import numpy as np
import pytest

import asemd
from asemd.errors import InputError
from asemd.lammps import Lammps, calibration, plan

ATOMS = """units real
atom_style {style}
lattice {lattice}
region b block 0 {cells} 0 {cells} 0 {cells}
create_box 2 b
create_atoms 1 box basis 2 2
mass * 20
displace_atoms all random 0.1 0.1 0.1 4711
velocity all create 100.0 5
{more}
fix 1 all nve
"""
SALT = dict(style="charge", lattice="custom 6.0 a1 1 0 0 a2 0 1 0 a3 0 0 1 basis 0 0 0 basis 0.5 0.5 0.5", cells=3)
CHARGES = "set type 1 charge 0.5\nset type 2 charge -0.5\n"
LONG = CHARGES + "pair_style lj/cut/coul/long 6.0\npair_coeff * * 0.1 3.0\nkspace_style {} 1.0e-4"
SCENES = {
    "pppm": LONG.format("pppm"), "ewald": LONG.format("ewald"), "pppm, ad": LONG.format("pppm") + "\nkspace_modify diff ad",
    "msm": LONG.format("msm").replace("coul/long", "coul/msm"),
    "own energies": CHARGES + "pair_style coul/dsf 0.1 6.0\npair_coeff * *",
    "dispersion": CHARGES + "pair_style lj/long/coul/long long long 6.0\npair_coeff * * 0.1 3.0\nkspace_style ewald/disp 1.0e-4",
    "ewald, switched": LONG.format("ewald").replace("lj/cut/coul/long 6.0", "lj/switch3/coulgauss/long 6.0 1.0").replace(
        "0.1 3.0", "0.1 3.0 1.2"),
    "noise": "pair_style dpd 300.0 6.0 4711\npair_coeff * * 3.0 1.0",
    "listed pairs": "pair_style hybrid/overlay lj/cut 5.0 list pairs.txt 5.0\npair_coeff * * lj/cut 0.1 3.0\npair_coeff * * list",
    "spheres": "set group all diameter 3.0\nset group all mass 20\npair_style lj/expand/sphere 4.0\npair_coeff * * 0.1 1.5",
    "many bodies": "pair_style sw\npair_coeff * * two.sw A A",
    "many bodies, tersoff": "pair_style tersoff\npair_coeff * * two.tersoff A A",
}
SW = "A A A 2.1683 2.0951 1.80 21.0 1.20 -0.333333333333 7.049556277 0.6022245584 4.0 0.0 0.0\n"


TERSOFF = "A A A 3.0 1.0 1.3258 4.8381 2.0417 0.0 22.956 0.33675 1.3258 95.373 3.0 0.2 3.2394 3264.7\n"


@pytest.fixture(params=SCENES)
def script(request, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "two.sw").write_text(SW)
    (tmp_path / "two.tersoff").write_text(TERSOFF)
    (tmp_path / "pairs.txt").write_text("1 2 harmonic 1.0 3.0\n")
    dense = dict(SALT, lattice=SALT["lattice"].replace("6.0", "3.0"), cells=6)
    units = dense if request.param.startswith("many bodies") else SALT | {"style": "sphere"} if request.param == "spheres" else SALT
    text = ATOMS.format(**units, more=SCENES[request.param]) + "run 2\n"
    (tmp_path / "in.x").write_text(text.replace("mass * 20\n", "") if request.param == "spheres" else text)
    return request.param


def test_plan(script, monkeypatch):
    items = dict.fromkeys(("bond", "angle", "dihedral", "improper"), 1e-9)
    known = {f: 1e-9 for f in calibration.Costs.__dataclass_fields__} | {"items": items, "program": 1e8}
    monkeypatch.setattr(calibration, "known", lambda *a: calibration.Costs(**known))
    found = asemd.plan("in.x")
    names = [item.name for item in found.sections["Forces"]]
    solver = script.partition(",")[0] if script.startswith(("pppm", "ewald", "msm")) else "ewald/disp" if script == "dispersion" else ""
    assert any(name.startswith("pair ") for name in names)
    if solver:
        assert f"k-space {solver}" in names
        assert f"k-space {solver}" in [item.name for item in found.sections["Memory"]]
        assert "Kspace" in [item.name for item in found.sections["Speed"]]
    assert found.steps_per_second > 0 and str(found)


def test_check_and_page(script):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        report = asemd.check("in.x")
        assert not any("Error" in f.message for f in report.findings)
        if script == "own energies":      # a second derivative that calls another one
            atoms = asemd.read("in.x")
            assert np.isfinite(atoms.calc.get_hessian(atoms).data).all()
        with Lammps(cmdargs=["-screen", "none", "-log", "none"]) as lmp:
            lmp.file("in.x")
            assert plan.of_scene(lmp.scene, "in.x", ())
            atoms = lmp.scene.to_atoms()
    if script.startswith(("pppm", "ewald", "msm", "dispersion")):
        with pytest.raises(InputError, match=r"no second derivatives of kspace_style"):
            atoms.calc.get_hessian(atoms)
    if script == "noise":
        with pytest.raises(InputError, match="take a run"):
            atoms.get_forces()
    else:
        assert np.isfinite(atoms.get_forces()).all()


def test_net_charge_is_told(tmp_path, monkeypatch):
    """Once, and not of a neutral box."""
    monkeypatch.chdir(tmp_path)
    for charge, count in ((-0.4, 1), (-0.5, 0)):
        text = ATOMS.format(**SALT, more=LONG.format("pppm")) + f"set type 2 charge {charge}\nrun 0\nrun 0\n"
        with warnings.catch_warnings(record=True), Lammps(cmdargs=["-screen", "none", "-log", "log"]) as lmp:
            warnings.simplefilter("always")
            lmp.commands_string(text)
        assert (tmp_path / "log").read_text().count("WARNING: System is not charge neutral, net charge = 2.7") == count
