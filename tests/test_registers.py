"""Two atoms of a cluster at a time, or one: the same forces, energies and trajectories."""
from __future__ import annotations

import numpy as np
import pytest
from wheel import ran

from asemd.kernels import pair as kernels

SCRIPT = """
units real
atom_style full
region b prism 0 18 0 17 0 19 3 -2 2
create_box 2 b bond/types 1 extra/bond/per/atom 2 extra/special/per/atom 4
mass * 12.0
create_atoms 1 random 260 7 NULL overlap 1.3
create_atoms 2 random 260 9 NULL overlap 1.3
set type 1 charge 0.4
set type 2 charge -0.4
bond_style harmonic
bond_coeff 1 10.0 1.5
special_bonds lj/coul 0.0 1.0 1.0
create_bonds many all all 1 0.5 1.7
pair_style {style}
pair_coeff 1 1 0.1 1.2
pair_coeff 2 2 0.05 1.5
neighbor 1.0 bin
neigh_modify {modify}
velocity all create 900 4
fix 1 all nve
timestep 0.5
thermo_style custom step pe ecoul evdwl pxx pyz
run 20
"""
OFTEN, BLIND = "every 1 delay 0", "check no every 10 delay 0"


@pytest.fixture
def both(monkeypatch):
    def run(script, precision):
        out = []
        for paired in (True, False):
            kernels.cluster_kernel.cache_clear()
            monkeypatch.setattr(kernels, "two_at_a_time", lambda style, answer=paired: answer)
            lmp = ran(script, "-precision", precision)
            out.append((lmp.numpy.extract_atom("f").copy(), [lmp.get_thermo(k) for k in ("pe", "ecoul", "evdwl", "pxx", "pyz")]))
        return out
    yield run
    kernels.cluster_kernel.cache_clear()


@pytest.mark.parametrize("style, modify, precision", [("lj/cut 6.0", OFTEN, "double"), ("lj/cut/coul/cut 6.0", BLIND, "double"),
                                                       ("lj/cut 6.0", BLIND, "mixed")])
def test_one_atom_or_two(both, style, modify, precision):
    (f, numbers), (g, others) = both(SCRIPT.format(style=style, modify=modify), precision)
    tolerance = 1e-9 if precision == "double" else 1e-3      # twenty steps
    assert np.abs(f).max() > 1.0
    np.testing.assert_allclose(g, f, atol=tolerance * np.abs(f).max())
    np.testing.assert_allclose(others, numbers, rtol=tolerance, atol=tolerance)


def test_rule(monkeypatch):
    from asemd.registry import find
    monkeypatch.setattr(kernels, "many_registers", lambda: False)
    assert [kernels.two_at_a_time(find("pair", name)) for name in ("lj/cut", "lj/cut/coul/cut", "morse")] == [False, True, True]
    monkeypatch.setattr(kernels, "many_registers", lambda: True)
    assert kernels.two_at_a_time(find("pair", "lj/cut"))
