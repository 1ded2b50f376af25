"""Many types of atoms: each pair has the coefficients of its types, however these get to the kernel."""
from __future__ import annotations

import numpy as np
import pytest
from wheel import ran

SCRIPT = """
units real
atom_style charge
region b block 0 14 0 15 0 16
create_box {n} b
mass * 12.0
create_atoms 1 random 400 7 NULL overlap 1.6
pair_style lj/cut/coul/cut 6.0
{coefficients}
"""


@pytest.mark.parametrize("switches", [(), ("-precision", "mixed")])
@pytest.mark.parametrize("n", [2, 7, 8, 15, 16, 23])
def test_coefficients_of_types(n, switches):
    rng = np.random.default_rng(n)
    epsilon, sigma, cut = rng.uniform(0.02, 0.2, (n, n)), rng.uniform(1.2, 2.2, (n, n)), rng.uniform(3.0, 6.0, (n, n))
    lines = [f"pair_coeff {i + 1} {j + 1} {epsilon[i, j]:.17g} {sigma[i, j]:.17g} {cut[i, j]:.17g} 5.0"
             for i in range(n) for j in range(i, n)]
    with ran(SCRIPT.format(n=n, coefficients="\n".join(lines)), *switches) as lmp:
        system = lmp.session.scene.system
        kinds = rng.integers(0, n, system.n)
        system.type[:], system.q[:] = kinds + 1, rng.uniform(-0.3, 0.3, system.n)
        lmp.command("run 0")
        forces, x, q = system.f.copy(), system.x, system.q
        i, j = np.triu_indices(system.n, 1)
        d = x[i] - x[j]
        d -= np.diag(system.box.cell) * np.rint(d / np.diag(system.box.cell))
        r = np.linalg.norm(d, axis=1)
        a, b = np.minimum(kinds[i], kinds[j]), np.maximum(kinds[i], kinds[j])
        s6 = (sigma[a, b] / r) ** 6
        f = np.where(r < cut[a, b], 24.0 * epsilon[a, b] * (2.0 * s6 * s6 - s6) / r**2, 0.0)
        f += np.where(r < 5.0, 332.06371 * q[i] * q[j] / r**3, 0.0)
        want = np.zeros_like(forces)
        np.add.at(want, i, f[:, None] * d)
        np.add.at(want, j, -f[:, None] * d)
    assert np.abs(forces - want).max() < (3e-5 if switches else 1e-12) * np.abs(want).max()
