"""Index bookkeeping against the slow and obvious way."""
from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from asemd.box import Box
from asemd.topology import ATOMS, Topology


@st.composite
def topologies(draw, most=8):
    n = draw(st.integers(4, most))
    parts = {}
    for kind, width in ATOMS.items():
        atoms = draw(st.lists(st.permutations(range(n)).map(lambda p, w=width: p[:w]), max_size=6))
        parts[f"{kind}s"] = atoms
        parts[f"{kind}_types"] = draw(st.lists(st.integers(1, 3), min_size=len(atoms), max_size=len(atoms)))
    return n, Topology(**parts)


@given(topologies(), st.data())
def test_select_by_hand(case, data):
    n, top = case
    rows = data.draw(st.lists(st.integers(0, n - 1), unique=True))
    got = top.select(rows, n)
    for kind, atoms, types in top:
        want = [([rows.index(i) for i in item], t) for item, t in zip(atoms.tolist(), types) if set(item) <= set(rows)]
        have = list(zip(got.items(kind)[0].tolist(), got.items(kind)[1]))
        assert have == want
    mask = np.isin(np.arange(n), rows)
    assert top.select(mask, n) == top.select(sorted(rows), n)
    assert top.select([r - n for r in rows], n) == got


@given(topologies(), st.integers(1, 4))
def test_repeat_and_back(case, copies):
    n, top = case
    many = top.repeat(n, copies)
    assert many.counts() == {k: c * copies for k, c in top.counts().items()}
    for c in range(copies):
        assert many.select(slice(c * n, (c + 1) * n), n * copies) == top
    assert many == top.concatenate(*(top.shift(c * n) for c in range(1, copies)))


def reference_special(bonds, n):
    """Shortest walks over the bonds, without a step straight back, by brute force."""
    near = {i: set() for i in range(n)}
    for a, b in bonds:
        near[a].add(b)
        near[b].add(a)
    kind = {}
    for i in range(n):
        for j in near[i]:
            kind.setdefault((i, j), set()).add(1)
            for k in near[j] - {i}:
                kind.setdefault((i, k), set()).add(2)
                for m in near[k] - {j}:
                    kind.setdefault((i, m), set()).add(3)
    return {pair: min(kinds) for pair, kinds in kind.items() if pair[0] < pair[1]}


@given(topologies(9))
def test_special_pairs(case):
    n, top = case
    pairs, kind = top.special(n)
    assert dict(zip(map(tuple, pairs.tolist()), kind.tolist())) == reference_special(top.bonds.tolist(), n)
    assert (pairs[:, 0] < pairs[:, 1]).all() and len(np.unique(pairs, axis=0)) == len(pairs)


def test_special_pairs_of_a_ring_and_a_chain():
    ring = Topology(bonds=[[0, 1], [1, 2], [2, 3], [3, 0]])
    assert dict(zip(map(tuple, ring.special(4)[0].tolist()), ring.special(4)[1])) == {
        (0, 1): 1, (1, 2): 1, (2, 3): 1, (0, 3): 1, (0, 2): 2, (1, 3): 2}
    chain = Topology(bonds=[[i, i + 1] for i in range(4)], angles=[[0, 1, 2]], dihedrals=[[0, 1, 2, 3]])
    full = dict(zip(map(tuple, chain.special(5)[0].tolist()), chain.special(5)[1]))
    assert full == {(0, 1): 1, (1, 2): 1, (2, 3): 1, (3, 4): 1, (0, 2): 2, (1, 3): 2, (2, 4): 2, (0, 3): 3, (1, 4): 3}
    pruned = chain.special(5, angle=True, dihedral=True)
    assert dict(zip(map(tuple, pruned[0].tolist()), pruned[1])) == {k: v for k, v in full.items() if k not in ((2, 4), (1, 4))}
    assert Topology().special(0)[0].shape == (0, 2)


def test_periodic_repeat_connects_neighbouring_copies():
    """A chain that closes on itself through the box becomes one longer chain."""
    box = Box.from_lammps([0, 0, 0], [4, 4, 4])
    x = np.array([[0.5 + i, 1.0, 1.0] for i in range(4)])
    ring = Topology(bonds=[[0, 1], [1, 2], [2, 3], [3, 0]], angles=[[i, (i + 1) % 4, (i + 2) % 4] for i in range(4)],
                    dihedrals=[[i, (i + 1) % 4, (i + 2) % 4, (i + 3) % 4] for i in range(4)])
    many = ring.repeat_periodic(4, (2, 3, 1), box, x)
    big = box.replicate(2, 3, 1)
    place = np.concatenate([x + np.array(c) @ box.cell for c in itertools.product(range(2), range(3), range(1))])
    d = big.minimum_image(place[many.bonds[:, 1]] - place[many.bonds[:, 0]])[0]
    np.testing.assert_allclose(d, np.tile([1.0, 0, 0], (24, 1)))
    for cols in ((0, 1), (1, 2)):
        d = big.minimum_image(place[many.angles[:, cols[1]]] - place[many.angles[:, cols[0]]])[0]
        np.testing.assert_allclose(d, np.tile([1.0, 0, 0], (24, 1)))
    assert (np.bincount(many.bonds.ravel(), minlength=24) == 2).all()


def test_shapes_are_checked():
    with pytest.raises(ValueError, match="bonds must have the shape"):
        Topology(bonds=[[0, 1, 2]])
    assert Topology().is_empty and not Topology(bonds=[[0, 1]]).is_empty
    assert Topology(bonds=[[0, 1]]).copy() == Topology(bonds=[[0, 1]]) != Topology(bonds=[[1, 0]])
