"""Short runs at constant energy: drift, order in the timestep, temperatures, errors by blocks."""
from __future__ import annotations

import math

import numpy as np
import pytest
from check_scenes import LJ
from wheel import ran

from asemd.errors import InputError
from asemd.report import nve
from asemd.report.copies import load


@pytest.fixture(scope="module")
def melt(tmp_path_factory):
    path = tmp_path_factory.mktemp("melt") / "in.melt"
    path.write_text(LJ)
    return load(path)


def test_verlet_is_of_second_order(melt):
    """The energy is shifted at the cutoff, so that the jumps of an unshifted one do not hide it."""
    found = nve.order(melt, [0.002, 0.004, 0.008], duration=0.8)
    assert found.exponent == pytest.approx(2.0, abs=0.1)
    assert len(found.series) == 3 and found.error < 0.05


def test_the_scene_is_not_touched(melt):
    before = melt.system.x.copy(), melt.system.v.copy(), melt.interactions.shift
    nve.run(melt, steps=20, precision="mixed")
    assert (melt.system.x == before[0]).all() and (melt.system.v == before[1]).all()
    assert (melt.interactions.shift, melt.precision) == (before[2], "double")


def test_temperatures_agree(melt):
    """Equipartition: in equilibrium the configurational temperature is the kinetic one."""
    start = nve.run(melt, steps=400, samples=10)
    melt_later = load(melt)
    melt_later.system = start.system
    found = nve.run(melt_later, steps=600, samples=60, configurational=30)
    conf = found.configurational[np.isfinite(found.configurational)]
    assert len(conf) == 30
    assert conf.mean() == pytest.approx(found.temperature.mean(), rel=0.1)


def test_unstable_run_says_so(melt):
    found = nve.run(melt, dt=0.5, steps=50)
    assert "time step is too long" in found.failed and found.steps < 50


def test_drift_is_the_slope():
    t = np.linspace(0.0, 10.0, 41)
    flat = np.zeros_like(t)
    found = nve.Series(0.1, "lj", 10, 27.0, t, flat, flat + 13.5, 13.5 + 0.054 * t, flat + 1.0, flat, flat, flat[1:] + 1.0,
                       flat[1:], 0.0, 100)
    assert found.drift == pytest.approx(0.054 * 1000.0 / 27.0) and found.drift_error == pytest.approx(0.0, abs=1e-9)
    assert found.fluctuation == pytest.approx(0.0, abs=1e-12)


def test_errors_by_blocks_see_correlation():
    rng = np.random.default_rng(3)
    white = rng.standard_normal(4096)
    assert nve.block_error(white) == pytest.approx(1.0 / 64.0, rel=0.3)
    slow = np.repeat(rng.standard_normal(256), 16)
    assert nve.block_error(slow) == pytest.approx(1.0 / 16.0, rel=0.4)


def test_bad_input(melt):
    with pytest.raises(InputError, match="positive timestep"):
        nve.run(melt, dt=-1.0)
    with pytest.raises(InputError, match="two timesteps"):
        nve.order(melt, [0.001])
    with pytest.raises(InputError, match="nve' or 'own"):
        nve.run(melt, fixes="both")


def test_no_temperature_where_the_energy_curves_down():
    """Two atoms beyond the inflection of their pull."""
    from asemd.report.configurational import Probe
    with ran("units lj\nregion b block -5 5 -5 5 -5 5\ncreate_box 1 b\ncreate_atoms 1 single 0 0 0\ncreate_atoms 1 single 1.6 0 0\n"
             "mass 1 1.0\npair_style lj/cut 4.0\npair_coeff 1 1 1 1\nfix 1 all nve\n") as lmp:
        assert math.isnan(Probe(lmp.scene).temperature(lmp.scene.system))
        lmp.scene.system.x[1] = [1.1, 0, 0]
        assert Probe(lmp.scene).temperature(lmp.scene.system) > 0.0
