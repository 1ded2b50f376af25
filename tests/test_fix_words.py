"""Fixes and computes read and write their words, and say what is wrong with them."""
from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from wheel import ran

import asemd.compute
import asemd.fix
from asemd.errors import InputError
from asemd.scene import Scene
from asemd.variable import Variables


@pytest.fixture
def session():
    variables = Variables()
    variables.define("e", "equal", ["1.0"])
    variables.define("a", "atom", ["x"])
    region = SimpleNamespace(inside=lambda x: np.ones(len(x), bool))
    temp, pe = asemd.compute.Temp(), asemd.compute.PE()
    temp.id, pe.id = "t", "pe"
    return SimpleNamespace(variables=variables, scene=Scene(regions={"box": region}, computes={"t": temp, "pe": pe}))


@pytest.mark.parametrize("line", [
    "nve", "nve/limit 0.1", "nvt temp 300.0 310.0 100.0 tchain 3 tloop 1", "nvt temp 1.0 1.0 1.0 tchain 1 tloop 2 drag 0.5",
    "npt temp 1.0 1.0 1.0 tchain 3 tloop 1 x 1.0 1.0 2.0 y 1.0 1.0 2.0 couple xy pchain 2 ploop 1 mtk no flip no scalexy yes "
    "fixedpoint 0.0 1.0 2.0", "nph drag 0.5 z 0.0 2.0 1.0 yz 0.0 0.0 3.0 couple none pchain 0 ploop 1 nreset 10 ptemp 2.0",
    "langevin 1.0 2.0 0.5 77", "langevin v_e 1.0 0.5 77 scale 2 3.0 tally yes zero yes", "langevin 1.0 1.0 0.5 77 gjf vhalf",
    "langevin 1.0 1.0 0.5 77 tally yes gjf vfull", "baoab 1.0 2.0 0.5 77", "baoab v_a 2.0 0.5 77",
    "gjf 1.0 2.0 0.5 77 vel vhalf method 1", "gjf v_a 2.0 0.5 77 vel vfull method 7 0.4", "temp/rescale 5 1.0 2.0 0.1 0.5",
    "temp/csvr 1.0 2.0 0.5 77", "temp/csld v_e 2.0 0.5 77",
    "temp/berendsen v_a 2.0 0.5", "setforce NULL 0.0 v_a region box", "addforce 0.0 v_e v_a every 2 region box energy v_a",
    "addforce 1.0 0.0 0.0", "enforce2d", "momentum 10 linear 1 0 1 angular rescale", "momentum 1 angular",
])
def test_fix_round_trip(line, session):
    name, *words = line.split()
    cls = asemd.fix.find(name)
    assert cls.from_lammps("all", words, session).to_lammps() == words
    assert getattr(asemd.fix, cls.__name__) is cls


@pytest.mark.parametrize("line", ["temp", "pe", "pe pair bond", "ke", "ke/atom", "pe/atom dihedral", "pressure t", "pressure NULL virial",
                                  "stress/atom NULL ke pair", "stress/atom t"])
def test_compute_round_trip(line, session):
    name, *words = line.split()
    assert asemd.compute.find(name).from_lammps("all", words, session).to_lammps() == words


@pytest.mark.parametrize(("line", "message"), [
    ("nve 1", "takes no arguments"), ("nve/limit", "xmax"), ("nve/limit 0", "positive"), ("nvt", "needs temp"),
    ("nvt temp 1 1", "3 values"), ("nvt temp 1 0 1", "above 0"), ("nvt temp 1 1 0", "damping"), ("nvt temp 1 1 nan", "finite"),
    ("nvt temp 1 1 1 tchain 0", "at least 1"), ("nvt temp 1 1 1 tchian 3", "did you mean tchain"), ("nvt temp 1 1 1 iso 0 0 1", "fix npt"),
    ("nvt temp 1 1 1 drag -1", "negative"), ("nvt temp 1 1 1 update dipole", "need fix nvt/sphere"), ("npt temp 1 1 1", "needs a pressure"),
    ("npt iso 1 1 1", "needs temp"), ("npt temp 1 1 1 iso 1 1 0", "damping time of x"), ("npt temp 1 1 1 iso 1 1", "3 values"),
    ("npt temp 1 1 1 iso 1 1 1 couple xx", "one of none xyz"), ("npt temp 1 1 1 iso 1 1 1 pchain -1", "not be negative"),
    ("npt temp 1 1 1 iso 1 1 1 ploop 0", "ploop must be"), ("npt temp 1 1 1 iso 1 1 1 ptemp 0", "above 0"),
    ("npt temp 1 1 1 iso 1 1 1 mtk 2", "yes or no"), ("npt temp 1 1 1 izo 1 1 1", "did you mean iso"),
    ("nph temp 1 1 1 iso 1 1 1", "fix npt"),
    ("nph iso 1 1 1 dilate nobody", "nobody"), ("nph iso 1 1 1 fixedpoint 1 1", "3 values"),
    ("langevin 1 1 1", "needs Tstart"), ("langevin 1 1 0 1", "damping"),
    ("langevin 1 1 1 0", "seed"),
    ("langevin 1 1 1 1.5", "whole"), ("langevin 1 1 1 1 gjf vhal", "did you mean vhalf"), ("langevin 1 1 1 1 gjf", "1 value"),
    ("baoab 1 1 1", "needs Tstart"), ("baoab 1 1 0 1", "damping"), ("baoab 1 1 1 0", "seed"), ("baoab 1 1 1 1 tally yes", "needs Tstart"),
    ("gjf 1 1 1", "needs Tstart"), ("gjf 1 1 0 1", "damping"), ("gjf 1 1 1 0", "seed"), ("gjf 1 1 1 1 vel vhal", "did you mean vhalf"),
    ("gjf 1 1 1 1 method 9", "from 1 to 8"), ("gjf 1 1 1 1 method 7", "2 values"), ("gjf 1 1 1 1 method 7 1.0", "between 0 and 1"),
    ("gjf 1 1 1 1 method x", "whole"), ("gjf 1 1 1 1 vel", "1 value"), ("gjf 1 1 1 1 zero yes", "unknown keyword"),
    ("baoab -1 1 1 1", "negative"), ("langevin 1 1 1 1 omega yes gjf vhalf", "does not go with gjf"),
    ("langevin 1 1 1 1 angmom -3.3", "must not be negative"), ("langevin 1 1 1 1 angmom yes", "number"),
    ("langevin -1 1 1 1", "negative"), ("langevin 1 1 1 1 talli yes", "did you mean tally"), ("langevin 1 1 1 1 scale 1", "2 values"),
    ("langevin 1 1 1 1 tally maybe", "yes or no"), ("temp/rescale 0 1 1 1 1", "at least 1"),
    ("temp/rescale 1 1 1 1 2", "fraction"), ("temp/rescale 1 1 1", "needs N"), ("temp/berendsen 1 1", "needs"),
    ("temp/csvr 1 1 1", "needs Tstart"), ("temp/csld 1 1 1 0", "seed"), ("temp/csvr 1 1 0 1", "damping"),
    ("temp/berendsen 1 x 1", "number"), ("setforce 1 1", "needs fx fy fz"), ("setforce 1 1 1 regoin box", "did you mean region"),
    ("setforce 1 1 1 region bix", "did you mean box"), ("addforce 1 NULL 1", "number"), ("addforce 1 1 1 energy v_a", "constant"),
    ("addforce v_e 1 1 energy 3", "atom-style"), ("addforce 1 1 1 every 0", "at least 1"), ("momentum 10", "linear"),
    ("momentum 0 angular", "at least 1"), ("momentum 1 linear 1 1 2", "three flags"), ("momentum 1 angualr", "did you mean angular"),
])
def test_fix_errors(line, message, session):
    name, *words = line.split()
    with pytest.raises(InputError, match=message) as e:
        asemd.fix.find(name).from_lammps("all", words, session)
    assert "\n" not in str(e.value)


@pytest.mark.parametrize(("line", "message"), [
    ("pe bnd", "did you mean bond"), ("pressure", "temperature compute"), ("pressure NULL", "kinetic"), ("pressure tt", "no compute tt"),
    ("pressure pe", "does not compute a temperature"), ("pressure t pairs", "did you mean pair"), ("stress/atom", "needs the ID"),
    ("stress/atom NULL foo", "unknown keyword"), ("ke 1", "takes no arguments"), ("pe/atom fxi", "did you mean fix"),
])
def test_compute_errors(line, message, session):
    name, *words = line.split()
    with pytest.raises(InputError, match=message):
        asemd.compute.find(name).from_lammps("all", words, session)


@pytest.mark.parametrize("name", ["pe", "pressure"])
def test_computes_of_everything_refuse_groups(name, session):
    with pytest.raises(InputError, match="group all"):
        asemd.compute.find(name).from_lammps("some", ["t"] if name == "pressure" else [], session)


def test_unknown_style_offers_the_nearest():
    with pytest.raises(InputError, match="did you mean nvt"):
        asemd.fix.find("nvtt")
    with pytest.raises(InputError, match="did you mean pe/atom"):
        asemd.compute.find("pe/atoms")
    assert not hasattr(asemd.fix, "Nothing")


def test_fix_modify(session):
    nvt = asemd.fix.NVT()
    nvt.modify(["temp", "t", "energy", "no"], session)
    assert nvt.temp is session.scene.computes["t"]
    for words, message in ((["temp", "pe"], "temperature"), (["temp", "x"], "no compute"), (["energy", "yes"], "ecouple"),
                           (["virial", "yes"], "not support"), (["press", "p"], "not support"), (["temp"], "pairs")):
        with pytest.raises(InputError, match=message):
            nvt.modify(words, session)
    push = asemd.fix.AddForce(force=(1.0, 0.0, 0.0))
    push.modify(["energy", "yes", "virial", "yes"], session)
    assert push.thermo_energy and push.thermo_virial
    with pytest.raises(InputError, match="setforce"):
        asemd.fix.SetForce().modify(["energy", "yes"], session)


def test_compute_modify():
    temp = asemd.compute.Temp()
    temp.modify(["extra/dof", "0", "dynamic/dof", "yes"], None)
    assert temp.extra_dof == 0.0
    for words, message in ((["extra/dof", "x"], "number"), (["extra/dof"], "pairs"), (["thermo", "1"], "does not take"),
                           (["dynamic", "2"], "yes or no")):
        with pytest.raises(InputError, match=message):
            temp.modify(words, None)


@pytest.mark.parametrize("line", [
    "langevin v_late 1 1 77", "setforce v_late 0 0", "indent 1.0 sphere v_late 0 0 1.0", "adapt 1 pair lj/cut epsilon 1 1 v_late",
    "heat 1 v_late", "spring/self v_late", "deform 1 x variable v_late v_late",
    "wall/lj126 zlo -3.0 v_late 1 1", "gravity v_late vector 0 0 1",
])
def test_variables_may_be_defined_later(line):
    """Before the run, as in LAMMPS; an error names the fix."""
    text = f"boundary p p {'f' if 'wall' in line else 'p'}\nregion b block 0 5 0 5 0 5\ncreate_box 1 b\ncreate_atoms 1 single 1 1 1\n" \
           f"create_atoms 1 single 2 1 1\nmass 1 1\nvelocity all create 1 77\npair_style lj/cut 1.5\npair_coeff 1 1 1 1\nfix 2 all {line}\n"
    with pytest.raises(InputError, match=rf"undefined variable late .*fix 2 all {line.split()[0]}"):
        ran(text + "run 0")
    ran(text + "variable late equal 0.5\nrun 2")
