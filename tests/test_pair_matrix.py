"""Second derivatives of pairs as a sparse matrix, against the sum written out."""
from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from asemd.hessian import of_pairs


@given(st.integers(1, 7), st.integers(0, 40), st.integers(0, 2**32 - 1))
def test_any_pairs(n, m, seed):
    """Pairs may come twice, as images of each other, either way round, or be an atom with itself."""
    rng = np.random.default_rng(seed)
    atoms, d, a, b = rng.integers(0, n, (m, 2)), rng.normal(size=(m, 3)), rng.normal(size=m), rng.normal(size=m)
    whole = np.zeros((n, 3, n, 3))
    for (i, j), v, one, two in zip(atoms, d, a, b):
        k = one * np.eye(3) + two * np.outer(v, v)
        whole[i, :, i] += k
        whole[j, :, j] += k
        whole[i, :, j] -= k
        whole[j, :, i] -= k
    found = of_pairs(n, atoms, d, a, b)
    assert found.toarray() == pytest.approx(whole.reshape(3 * n, 3 * n), abs=1e-12)
    assert found.has_sorted_indices and found.has_canonical_format
