"""The velocity command: equal to LAMMPS to the last bit where the numbers follow from seed, ids and positions."""
from __future__ import annotations

import numpy as np
import pytest
from both import asemd, assert_same, lammps

from asemd import units
from asemd.errors import InputError

ATOMS = """
units lj
lattice fcc 0.8442
region b block 0 4 0 4 0 4
create_box 2 b
create_atoms 1 box
mass 1 1
mass 2 2.5
set type 1 type/fraction 2 0.3 12345
group g type 2
variable a atom x*0.1
variable c equal 2
"""
METAL = ATOMS.replace("units lj", "units metal").replace("fcc 0.8442", "fcc 3.52")
FLAT = """
units lj
dimension 2
lattice hex 0.7
region b block 0 10 0 6 -1 1
create_box 1 b
create_atoms 1 box
mass 1 1
"""
EXACT = {
    "uniform": ATOMS + "velocity all create 1.44 87287",
    "gaussian": ATOMS + "velocity all create 1.44 87287 dist gaussian",
    "metal": METAL + "velocity all create 300 4928459 dist gaussian",
    "momentum kept": ATOMS + "velocity all create 3.0 87287 mom no",
    "rotation": ATOMS + "velocity all create 3.0 87287 rot yes",
    "geom": ATOMS + "velocity all create 3.0 87287 loop geom",
    "geom gaussian": ATOMS + "velocity all create 3.0 87287 loop geom dist gaussian",
    "geom displaced": ATOMS + "displace_atoms all random 0.1 0.1 0.1 55\nvelocity all create 3.0 87287 loop geom dist gaussian rot yes",
    "local": ATOMS + "velocity all create 3.0 87287 loop local",
    "group": ATOMS + "velocity g create 3.0 87287\nvelocity all create 1.0 333 sum yes rot yes dist gaussian",
    "flat": FLAT + "velocity all create 1.0 1234",
    "flat geom": FLAT + "velocity all create 1.0 1234 loop geom dist gaussian rot yes",
    "zero kelvin": ATOMS + "velocity all create 0.0 1234",
    "scale": ATOMS + "velocity all create 3.0 87287\nvelocity g scale 1.0\nvelocity all scale 0.5 sum yes",
    "zero": ATOMS + "velocity all create 3.0 87287 mom no\nvelocity g zero linear\nvelocity all zero angular",
    "set": ATOMS + "velocity all set 1 NULL 2\nvelocity g set 0.5 -1 NULL sum yes units box",
    "set variables": ATOMS + "velocity all set v_a v_c 0.2\nvelocity g set v_a NULL v_c sum yes",
    "ramp": ATOMS + "velocity all ramp vx 0 2 y 0.3 3.3\nvelocity all ramp vz 1 2 x 0.3 3.3 units box sum yes",
}


@pytest.fixture(scope="module")
def theirs():
    return lammps(EXACT)


@pytest.mark.parametrize("name", EXACT)
def test_same_bits_as_lammps(theirs, name):
    assert_same(asemd(EXACT[name]), theirs[name])


def temperature(session, group="all"):
    system, mask, u = session.scene.system, session.scene.groups[group], units.get(session.scene.units)
    kinetic = u.mvv2e * (system.atom_masses()[:, None] * system.v**2)[mask].sum()
    return kinetic / (3 * mask.sum() - 3) / u.boltz


def test_temperature_and_momentum():
    session = asemd(METAL + "velocity g create 300 1 rot yes")
    system = session.scene.system
    assert temperature(session, "g") == pytest.approx(300, rel=1e-12)
    m, v, mask = system.atom_masses()[:, None], system.v, session.scene.groups["g"]
    x = (system.x - (m * system.x)[mask].sum(0) / m[mask].sum()) * mask[:, None]
    assert np.abs((m * v).sum(0)).max() < 1e-11 and np.abs((m * np.cross(x, v)).sum(0)).max() < 1e-9
    assert not v[~mask].any()


def test_temperature_compute():
    session = asemd(METAL + "compute half g temp\nvelocity all create 300 1 temp half")
    assert temperature(session, "g") == pytest.approx(300, rel=1e-12)


@pytest.mark.parametrize("line, message", [
    ("velocity all set nan 0 0", "velocity is nan"), ("velocity all set inf 0 0", "velocity is inf"),
    ("velocity all create nan 1", "velocity is nan"), ("velocity all set v_bad 0 0", "infinite|not defined|division"),
    ("velocity all create 1.0 0", "seed"), ("velocity all create -1 5", "negative"), ("velocity all create 1.0", "2 values"),
    ("velocity all creat 1 1", "did you mean create"), ("velocity nope set 0 0 0", "unknown group"),
    ("velocity all create 1 5 distt gaussian", "did you mean dist"), ("velocity all create 1 5 dist gauss", "gaussian"),
    ("velocity all create 1 5 loop some", "all local geom"), ("velocity all create 1 5 temp nope", "no compute"),
    ("velocity all create 1 5 rigid f", "no fix f"), ("velocity all zero linear rigid f", "no fix f"),
    ("velocity all create 1 5 bias", "1 value"),
    ("velocity all create 1 5 bias yes", "needs temp"), ("velocity all create 1 5 temp thermo_temp bias yes", "no bias off"),
    ("velocity all zero linear bias yes", "needs temp"), ("velocity all create 1 5 bias x", "yes or no"),
    ("velocity all zero angular rigid n", "has no rigid bodies"), ("velocity all ramp vx 0 1 x 2 2", "differ"),
    ("velocity all scale 1.0", "temperature of group all is 0"), ("velocity all zero all", "linear angular"),
    ("velocity none create 1 5", "no atoms"), ("velocity all create 1 5 mom", "1 value"),
])
def test_mistakes(line, message):
    session = asemd(ATOMS + "group none empty\nvariable bad atom 1/0\nfix n all nve")
    with pytest.raises(InputError, match=message):
        session.execute(line)


def test_ids_with_gaps():
    session = asemd(ATOMS + "group d id 3\ndelete_atoms group d compress no")
    with pytest.raises(InputError, match="without gaps"):
        session.execute("velocity all create 1 5")
    session.execute("velocity all create 1 5 loop geom")


def test_masses_must_be_set():
    with pytest.raises(InputError, match="no mass for atom type 2"):
        asemd(ATOMS.replace("mass 2 2.5", "") + "velocity all create 1 5")
