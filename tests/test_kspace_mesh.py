"""Meshes: transforms in parts of several threads, and single precision."""
from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from wheel import ran

from asemd.engine import Engine, Settings
from asemd.kspace.transforms import POINTS, Transforms


@pytest.mark.parametrize("lead", [(), (2,)])
@pytest.mark.parametrize(("mesh", "threads", "parts"), [((20, 24, 25), 1, 1), ((20, 24, 25), 2, 2), ((9, 30, 45), 3, 3),
                                                        ((45, 9, 30), 5, 3), ((2, 100, 100), 4, 2), ((8, 9, 10), 2, 1)])
def test_parts_make_the_whole(mesh, threads, parts, lead):
    from scipy import fft
    random = np.random.default_rng(1)
    nx, ny, nz = mesh
    half = (nx, ny, nz // 2 + 1)
    term = SimpleNamespace(mesh=mesh, density=random.random((*lead, *mesh)), wave=np.zeros((*lead, *half), complex),
                           waves=random.random((3, *half)) + 1j * random.random((3, *half)), field=np.zeros((3, *mesh)),
                           shares=random.random((7, *half)) + 0j, share_field=np.zeros((7, *mesh)))
    wanted = (fft.rfftn(term.density, axes=(-3, -2, -1)), *(fft.irfftn(w, s=mesh, axes=(1, 2, 3)) for w in (term.waves, term.shares)))
    transforms = Transforms(term, threads)
    assert len(transforms.calls) == parts == min(threads, *mesh[:2], nx * ny * nz // POINTS or 1)
    for stage in range(5):
        for calls in transforms.calls:
            if calls[stage]:
                calls[stage].function()
    for got, want in zip((term.wave, term.field, term.share_field), wanted):
        assert np.abs(got - want).max() < 1e-13 * np.abs(want).max()
    assert all(transforms.addresses(k) == (0,) * 5 for k in range(parts, threads))


SCRIPT = """units real
atom_style charge
region b block 0 24 0 22 0 26
create_box 2 b
mass * 20.0
create_atoms 1 random 400 7 NULL overlap 1.2
create_atoms 2 random 400 9 NULL overlap 1.2
set type 1 charge 0.5
set type 2 charge -0.5
pair_style {pair}
pair_coeff * * 0.05 1.5
kspace_style {solver}
kspace_modify {modify}
"""
COULOMB, DISPERSION = "lj/cut/coul/long 6.0 7.0", "lj/long/coul/long long long 7.0"


def engine(solver: str, modify: str, pair: str = COULOMB, **settings) -> Engine:
    scene = ran(SCRIPT.format(solver=solver, modify=modify, pair=pair)).session.scene
    return Engine(scene.system, scene.interactions, Settings(skin=1.0, **settings))


@pytest.mark.parametrize(("solver", "modify", "pair"), [
    ("pppm 1e-4", "mesh 20 24 27 gewald 0.35", COULOMB), ("pppm 1e-4", "mesh 20 24 27 gewald 0.35 diff ad", COULOMB),
    ("pppm/stagger 1e-4", "mesh 20 24 27 gewald 0.35", COULOMB),
    ("pppm/disp 1e-4", "mesh 20 24 27 gewald 0.35 mesh/disp 24 20 25 gewald/disp 0.3 mix/disp none", DISPERSION)])
def test_threads(solver, modify, pair):
    one = engine(solver, modify, pair)
    a, b = (e.compute(energies=True, virials=True) for e in (one, engine(solver, modify, pair, threads=3)))
    assert np.abs(a.forces - b.forces).max() < 1e-11 * np.abs(a.forces).max()
    assert a.energy["elong"] == pytest.approx(b.energy["elong"], rel=1e-11)
    assert np.abs(a.energies_of["kspace"] - b.energies_of["kspace"]).max() < 1e-11 * np.abs(a.energies_of["kspace"]).max()


@pytest.mark.parametrize(("order", "diff"), [(2, "ik"), (5, "ik"), (7, "ik"), (5, "ad")])
def test_single_precision(order, diff):
    """Where forces are in single precision the mesh is, too, unless more is asked for."""
    modify = f"mesh 20 24 27 gewald 0.35 order {order} diff {diff}"
    double, single, fine = (engine(f"pppm {accuracy}", modify, precision=precision) for accuracy, precision in
                            (("1e-4", "double"), ("1e-4", "mixed"), ("1e-6", "mixed")))
    a, b, c = (_of_mesh(e) for e in (double, single, fine))
    mesh = [next(t for t in e.terms if t.category == "kspace") for e in (double, single, fine)]
    assert [t.density.itemsize for t in mesh] == [8, 4, 8]
    assert [t.weight.itemsize for t in mesh] == ([8, 4, 8] if diff == "ik" else [8, 8, 8])
    size = np.abs(a).max()
    assert 1e-12 * size < np.abs(b - a).max() < 2e-6 * size and np.abs(c - a).max() < 1e-12 * size


def _of_mesh(e: Engine) -> np.ndarray:
    """Forces of the mesh alone."""
    e.compute()
    return next(t for t in e.terms if t.category == "kspace").of_charges(e, e.system.q, e.system.x)[1]
