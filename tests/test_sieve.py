"""Rows of the neighbour list sorted sixteen candidates at a time are those that are sorted one by one."""
from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from asemd.kernels import cluster, sieve
from asemd.kernels.generate import Builder
from asemd.neighbor import COUNTERS

pytestmark = pytest.mark.skipif(not sieve.WIDE, reason="no AVX-512, or nothing is compiled")


@cache
def compiled():
    b = Builder("rows of lists, both ways")
    for name, value in dict(CLUSTER=8, MARK=True, TRACK=False).items():
        b.constant(name, value)
    for f in (*sieve.named(b), cluster.drop, cluster.arrange, sieve.reached16):
        b.function(f, fast=True)
    return b.build()


@pytest.mark.parametrize("nt", [0, 1, 7, 15, 16, 17, 31, 300, 1000])
@pytest.mark.parametrize("width", [4, 8, 16])
def test_rows(nt, width):
    k, rng = compiled(), np.random.default_rng(nt + width)
    for likely in (0.05, 0.5, 0.95):
        who = (rng.random((nt, 8)) < likely) @ (1 << np.arange(8))
        codes = np.zeros(nt + 32, np.int64)
        codes[:nt] = rng.integers(0, 1 << 30, nt) | who << 32
        codes[nt:] = -1         # which is not to be seen
        found = []
        for way in (True, False):
            entries, own, span = np.zeros(nt + 64, np.int32), np.zeros(1, np.int32), np.zeros((1, 8), np.int32)
            hide, tally, start = np.zeros(nt + 64, np.uint8), np.zeros(8, np.int64), 5
            if way:
                spare = np.full((5, nt + 32), -1, np.int32)
                n = k.arrange16(0, codes.copy(), nt, start, entries, own, span, tally, width, 77, hide, *spare)
                kept = tally[7]
            else:
                mine = codes.copy()
                kept = k.drop(mine, nt)
                n = k.arrange(0, mine, kept, start, entries, own, span, COUNTERS, tally, width, 77, hide)
            hide[start + own[0]:start + own[0] + 8] = 0     # set by the caller
            found.append((n, kept, own.tolist(), span.tolist(), entries[:n].tolist(), hide[:n].tolist()))
        assert found[0] == found[1]
        assert found[0][1] == np.count_nonzero(who)


def test_who_is_reached():
    k, rng = compiled(), np.random.default_rng(1)
    x = rng.uniform(-6, 6, (3, 96)).astype(np.float32)
    who = np.full(96, -1, np.int32)
    k.reached16(*x, who, 96, 40, np.float32(20.0))
    r2 = ((x[:, :, None].astype(float) - x[:, None, 40:48]) ** 2).sum(axis=0)
    assert (who == (r2 <= 20.0) @ (1 << np.arange(8))).all() and np.abs(r2 - 20.0).min() > 1e-4
