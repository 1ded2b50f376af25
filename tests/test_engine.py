"""Engines on both lists: special pairs, exclusions, threads, precision, per-atom shares, strain derivatives, hybrids and errors."""
from __future__ import annotations

import itertools

import numpy as np
import pytest
from brute import CELLS, CUT, EPSILON, PAIRS, SIGMA, engine_of, errors, make, scattered

from asemd.box import Box
from asemd.engine import Engine, Settings
from asemd.errors import InputError, SimulationError
from asemd.forcefield import Interactions
from asemd.system import System
from asemd.topology import Topology

BOTH = pytest.mark.parametrize("mode", ["cluster", "plain"])
SNUG = np.diag([4.1, 4.3, 4.2])          # just above twice cutoff plus skin: one cluster sees two images of an atom
SNUG_TILTED = np.array([[4.4, 0, 0], [0.9, 4.4, 0], [-0.7, 1.1, 4.4]])


def chains(n: int, length: int, cell, rng, periodic=(True, True, True), origin=(0.0, 0.0, 0.0)) -> System:
    """Atoms on a jittered grid; neighbours in a list that snakes through it are bonded, `length` at a time, then cut at faces at random."""
    m = round(n ** (1 / 3))
    order = [(i, j if i % 2 == 0 else m - 1 - j, k if (i * m + j) % 2 == 0 else m - 1 - k)
             for i in range(m) for j in range(m) for k in range(m)]
    s = (np.array(order, float) + 0.5 + rng.uniform(-0.15, 0.15, (m**3, 3))) / m + rng.random(3) * np.array(periodic)
    s = np.where(periodic, s % 1.0, s)
    system = make(s @ cell + origin, cell, periodic, rng, origin)
    bonds = [(i, i + 1) for i in range(m**3 - 1) if (i + 1) % length]
    system.topology = Topology(bonds=bonds)
    system.molecule = np.arange(m**3) // length + 1
    system.counts["nbondtypes"] = 1
    return system


def weights(system: System, interactions: Interactions) -> dict:
    pairs, kinds = interactions.special_pairs(system)
    lj, coul = interactions.special_lj, interactions.special_coul
    return {(int(i), int(j)): (lj[k - 1], coul[k - 1]) for (i, j), k in zip(pairs, kinds)}


@BOTH
@pytest.mark.parametrize("lj, coul", [
    ((0, 0, 0), (0, 0, 0)), ((0, 1, 1), (0, 1, 1)), ((0.1, 0.25, 0.5), (0.1, 0.25, 0.5)), ((0, 0, 0.5), (0, 0, 0.8333)),
    ((0, 0, 1), (0, 0.5, 0)), ((1, 1, 1), (1, 1, 1)), ((1, 1, 1), (0, 0, 1))])
def test_special_bonds(lj, coul, mode):
    interactions = Interactions.build(pair=PAIRS, special_bonds={"lj": lj, "coul": coul})
    for cell, periodic in ((SNUG, (True, True, True)), (SNUG_TILTED, (True, True, True)), (CELLS["rotated"], (True, False, True))):
        system = chains(64, 9, cell, np.random.default_rng(4), periodic, (0.4, -9.0, 2.0))
        engine, error = errors(system, mode, interactions=interactions, special=weights(system, interactions))
        assert engine.mode == mode, engine.why
        assert error < 1e-12


def test_only_the_closest_image_of_a_partner_is_special():
    rng = np.random.default_rng(3)
    for cell in (np.diag([1.4, 1.5, 2.7]), np.array([[1.4, 0, 0], [0.6, 1.5, 0], [-0.6, 0.4, 2.2]])):
        for special in ((0, 0, 0), (0.25, 0.5, 0.75)):
            interactions = Interactions.build(pair=PAIRS, special_bonds={"lj": special, "coul": special})
            system = make(np.array([[0.1, 0.1, 0.2], [0.3, 0.8, 0.9], [0.9, 1.3, 1.8]]), cell, (True,) * 3, rng)
            system.topology = Topology(bonds=[(0, 1), (1, 2)])
            assert errors(system, "plain", interactions=interactions, special=weights(system, interactions))[1] < 1e-12


@BOTH
@pytest.mark.parametrize("special", [(0, 0, 0), (0.25, 0, 0.75), (1, 0.5, 1)])
def test_two_images_of_a_partner_in_reach(special, mode):
    """Cells wider than cutoff plus skin, but not twice as wide."""
    interactions = Interactions.build(pair=PAIRS, special_bonds={"lj": special, "coul": special})
    for cell in (np.diag([2.1, 3.1, 4.3]), np.array([[2.6, 0, 0], [1.0, 2.9, 0], [-0.9, 1.1, 2.7]])):
        for threads, length in ((1, 4), (3, 7)):
            system = chains(27, length, cell, np.random.default_rng(length), origin=(0.3, 5.0, -2.0))
            engine, error = errors(system, mode, interactions=interactions, special=weights(system, interactions), threads=threads)
            assert engine.mode == mode, engine.why
            assert error < 1e-12
            plain = engine_of(system, "plain", interactions, threads=threads)
            plain.compute()
            assert engine.pairs == plain.pairs


@BOTH
@pytest.mark.parametrize("special", [(1, 1, 1), (0, 0, 0), (0.1, 0.25, 0.5)])
def test_exclusions(special, mode):
    interactions = Interactions.build(pair=PAIRS, special_bonds={"lj": special, "coul": special})
    system = chains(64, 9, SNUG, np.random.default_rng(4))
    n = system.n
    a, b = np.arange(n) % 3 == 0, np.arange(n) % 4 == 1
    same, everyone = system.molecule[:, None] == system.molecule[None], np.ones(n, bool)
    t = system.type
    rules = {
        "type": ([("type", 1, 2), ("type", 3, 3)], ((t[:, None] == 1) & (t[None] == 2)) | ((t[:, None] == 2) & (t[None] == 1))
                 | ((t[:, None] == 3) & (t[None] == 3))),
        "group": ([("group", a, b)], np.outer(a, b) | np.outer(b, a)),
        "group with itself": ([("group", a, a)], np.outer(a, a)),
        "molecule/intra": ([("molecule/intra", everyone)], same),
        "molecule/inter": ([("molecule/inter", a)], ~same & np.outer(a, a)),
        "two rules": ([("group", a, b), ("molecule/intra", b)], np.outer(a, b) | np.outer(b, a) | (same & np.outer(b, b)))}
    for name, (exclude, excluded) in rules.items():
        _, error = errors(system, mode, interactions=interactions, special=weights(system, interactions), excluded=excluded,
                          exclude=exclude)
        assert error < 1e-12, name


@BOTH
@pytest.mark.parametrize("special", [(1, 1, 1), (0, 0, 0), (0.1, 0.25, 0.5)])
def test_threads_and_repetition(special, mode):
    interactions = Interactions.build(pair=PAIRS, bond={"harmonic": {1: (30.0, 1.0)}}, special_bonds={"lj": special, "coul": special})
    system = chains(125, 25, np.diag([5.0, 5.2, 5.1]), np.random.default_rng(4))
    one = engine_of(system.copy(), mode, interactions).compute()
    for threads in (1, 2, 3):
        engine = engine_of(system.copy(), mode, interactions, threads=threads)
        for _ in range(3):                       # later builds share the work by weight
            result = engine.compute()
            assert np.allclose(result.forces, one.forces, rtol=0, atol=1e-12 * np.abs(one.forces).max())
            assert np.allclose(result.virial, one.virial, rtol=0, atol=1e-12 * np.abs(one.virial).max())
            assert result.potential == pytest.approx(one.potential, rel=1e-12)


@pytest.mark.parametrize("special", [(1, 1, 1), (0, 0, 0), (0.1, 0.25, 0.5)])
def test_mixed_precision(special):
    interactions = Interactions.build(pair=PAIRS, special_bonds={"lj": special, "coul": special})
    errors, off = [], []
    for seed in range(4, 11):
        system = chains(343, 7, np.diag([7.0, 7.2, 7.1]), np.random.default_rng(seed))
        exact = engine_of(system.copy(), "cluster", interactions).compute()
        mixed = engine_of(system.copy(), "cluster", interactions, precision="mixed").compute()
        errors.append(np.sqrt(((mixed.forces - exact.forces) ** 2).sum() / (exact.forces**2).sum()))
        # inverse roots from estimates of 12 bits are off by up to 1.8e-7, mostly to one side; repulsion has twelve powers of them
        assert mixed.potential == pytest.approx(exact.potential, rel=1e-6)
        off.append(abs(mixed.potential - exact.potential))
        assert np.allclose(mixed.virial, exact.virial, rtol=0, atol=1e-6 * np.abs(exact.virial).max() * 5)
    assert np.median(off) < 5e-6 * system.n
    # the nearest pair of a system makes most of its error: thirteen powers of an inverse root whose last digits differ between processors
    assert 0 < np.median(errors) < 1e-6 and max(errors) < 13 * 1.3e-7 + 1e-6


MOLECULE = dict(pair=PAIRS, bond={"harmonic": {1: (30.0, 1.0)}}, angle={"harmonic": {1: (4.0, 110.0)}},
                dihedral={"harmonic": {1: (1.0, 1, 3)}}, improper={"harmonic": {1: (2.0, 10.0)}})
SMOOTH = MOLECULE | {"special_bonds": {"lj": (0, 0.5, 1), "coul": (0, 0, 0.3)}, "pair": {"lj/charmm/coul/charmm 1.0 1.5": {
    (i, j): (EPSILON[i, j], SIGMA[i, j]) for i in (1, 2, 3) for j in range(i, 4)}}}


def molecules(cell, rng, periodic=(True, True, True)) -> System:
    system = chains(64, 8, cell, rng, periodic)
    rows = np.arange(64).reshape(8, 8)
    system.topology = Topology(
        bonds=system.topology.bonds, angles=np.concatenate([rows[:, k:k + 3] for k in range(6)]),
        dihedrals=np.concatenate([rows[:, k:k + 4] for k in range(5)]), impropers=rows[:, [1, 0, 2, 5]])
    system.counts |= {f"n{kind}types": 1 for kind in ("bond", "angle", "dihedral", "improper")}
    return system


@BOTH
@pytest.mark.parametrize("name", ["snug", "rotated"])
def test_per_atom_shares_add_up(name, mode):
    system = molecules(SNUG if name == "snug" else CELLS["rotated"], np.random.default_rng(2))
    interactions = Interactions.build(**MOLECULE, special_bonds={"lj": (0, 0.5, 1), "coul": (0, 0, 0.3)})
    for threads in (1, 2):
        engine = engine_of(system, mode, interactions, threads=threads)
        before = engine.compute()
        forces, virial = before.forces.copy(), before.virial.copy()
        result = engine.per_atom(before)
        assert set(result.energies_of) == {"pair", "bond", "angle", "dihedral", "improper"}
        assert result.energies.sum() == pytest.approx(result.potential, rel=1e-12)
        assert np.allclose(result.virials.sum(0), virial, rtol=0, atol=1e-11 * np.abs(virial).max())
        for category, v in result.virials_of.items():
            assert np.allclose(v.sum(0), result.virial_of[category], rtol=0, atol=1e-10), category
        assert np.array_equal(engine.collect().forces, forces)        # the forces are untouched
        for first, second in (("energies", "virials"), ("virials", "energies")):
            alone = engine.per_atom(engine.collect(), [first])
            assert getattr(alone, second) is None
            engine.per_atom(alone, [second])
            for name in ("energies", "virials"):
                np.testing.assert_allclose(getattr(alone, name), getattr(result, name), rtol=0, atol=1e-12 * np.abs(virial).max())


@BOTH
@pytest.mark.parametrize("name", ["snug", "rotated", "left-handed"])
def test_virial_is_the_strain_derivative(name, mode):
    cell = SNUG if name == "snug" else CELLS[name]
    system = molecules(cell, np.random.default_rng(2))
    interactions = Interactions.build(**SMOOTH)
    result = engine_of(system, mode, interactions, skin=0.2).compute()
    virial, h = result.virial.copy(), 1e-5
    for k, (a, b) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))):
        energies = []
        for sign in (1, -1):
            strain = np.eye(3)
            strain[a, b] += sign * h / 2
            strain[b, a] += sign * h / 2
            strained = system.copy()
            strained.x, strained.box = system.x @ strain, Box(system.box.origin @ strain, cell @ strain)
            energies.append(engine_of(strained, mode, interactions, skin=0.2).compute().potential)
        assert -(energies[0] - energies[1]) / (2 * h) == pytest.approx(virial[k], abs=2e-6 * np.abs(virial).max())


@BOTH
def test_forces_are_minus_the_gradient(mode):
    system = molecules(SNUG_TILTED, np.random.default_rng(2))
    interactions = Interactions.build(**SMOOTH)
    engine = engine_of(system, mode, interactions, skin=0.3)
    x = system.x.copy()
    forces, h = engine.compute().forces.copy(), 1e-5
    assert np.allclose(forces.sum(0), 0, atol=1e-10 * np.abs(forces).max())
    for row, axis in itertools.product((0, 7, 20, 63), range(3)):
        energies = []
        for sign in (1, -1):
            y = x.copy()
            y[row, axis] += sign * h
            engine.move(y)
            energies.append(engine.collect().potential)
        assert -(energies[0] - energies[1]) / (2 * h) == pytest.approx(forces[row, axis], abs=1e-6 * np.abs(forces).max())


LJ = {(i, j): (EPSILON[i, j], SIGMA[i, j], CUT[i, j]) for i in (1, 2, 3) for j in range(i, 4)}


@BOTH
@pytest.mark.parametrize("special", [(1, 1, 1), (0.1, 0.25, 0.5)])
def test_hybrids_equal_the_fused_style(special, mode):
    """lj/cut over coul/cut is lj/cut/coul/cut; a hybrid of two lj/cut styles is one lj/cut."""
    options = {"special_bonds": {"lj": special, "coul": special}}
    system = chains(64, 9, SNUG, np.random.default_rng(4))
    fused = engine_of(system.copy(), mode, Interactions.build(pair=PAIRS, **options))
    whole = fused.per_atom(fused.compute())
    every = {(i, j): () for i in (1, 2, 3) for j in range(i, 4)}
    overlay = engine_of(system.copy(), mode, Interactions.build(pair={"lj/cut 1.5": LJ, "coul/cut 1.73": every}, **options))
    result = overlay.per_atom(overlay.compute())
    assert result.energy["evdwl"] == pytest.approx(whole.energy["evdwl"], rel=1e-12)
    assert result.energy["ecoul"] == pytest.approx(whole.energy["ecoul"], rel=1e-12)
    assert np.allclose(result.forces, whole.forces, rtol=0, atol=1e-12 * np.abs(whole.forces).max())
    assert np.allclose(result.virials, whole.virials, rtol=0, atol=1e-12 * np.abs(whole.virials).max())
    some = [(1, 1), (1, 2), (3, 3)]
    parts = [{p: c for p, c in LJ.items() if (p in some) == chosen} for chosen in (True, False)]
    hybrid = Interactions()
    hybrid.set_style("pair", ["hybrid", "lj/cut", "1.5", "lj/cut", "1.6"])
    for k, part in enumerate(parts, 1):
        for (i, j), c in part.items():
            hybrid.set_coeff("pair", [str(i), str(j), "lj/cut", str(k), *map(str, c)], system)
    one = Interactions.build(pair={"lj/cut 1.5": LJ})
    for other in (hybrid, one):
        other.set_special(["lj/coul", *map(str, special)])
    a, b = (engine_of(system.copy(), mode, other).compute() for other in (hybrid, one))
    assert a.potential == pytest.approx(b.potential, rel=1e-12)
    assert np.allclose(a.forces, b.forces, rtol=0, atol=1e-12 * np.abs(b.forces).max())


def table_file(path, n: int = 600, low: float = 0.4, high: float = 1.5):
    r = np.linspace(low, high, n)
    e = 4 * (r**-12 - r**-6)
    f = 24 * (2 * r**-13 - r**-7)
    rows = "\n".join(f"{k} {a:.15g} {b:.15g} {c:.15g}" for k, (a, b, c) in enumerate(zip(r, e, f), 1))
    path.write_text(f"LJ\nN {n} R {low} {high}\n\n{rows}\n")
    return str(path)


@pytest.mark.parametrize("special", [(1, 1, 1), (0.1, 0.25, 0.5)])
def test_tables_run_over_rows_of_atoms(special, tmp_path):
    path = table_file(tmp_path / "lj.table")
    every = {(i, j): f"{path} LJ 1.5" for i in (1, 2, 3) for j in range(i, 4)}
    interactions = Interactions.build(pair={"table spline 600": every}, special_bonds={"lj": special})
    system = chains(64, 9, SNUG, np.random.default_rng(4))
    engines = [engine_of(system.copy(), mode, interactions) for mode in ("cluster", "plain")]
    assert engines[0].mode == "cluster" and engines[0].sparse
    a, b = (e.per_atom(e.compute()) for e in engines)
    assert a.potential == pytest.approx(b.potential, rel=1e-12)
    assert np.allclose(a.forces, b.forces, rtol=0, atol=1e-12 * np.abs(b.forces).max())
    assert np.allclose(a.virials, b.virials, rtol=0, atol=1e-12 * np.abs(b.virials).max())
    exact = engine_of(system.copy(), "plain", Interactions.build(
        pair={"lj/cut 1.5": {p: (1.0, 1.0) for p in every}}, special_bonds={"lj": special})).compute()
    assert a.potential == pytest.approx(exact.potential, rel=1e-6)


@BOTH
def test_dihedral_charmm_weights_its_ends(mode):
    """The 1-4 interaction is LJ and Coulomb without switch, times the weight, whatever the special factors say."""
    system = molecules(SNUG_TILTED, np.random.default_rng(2))
    pair = {"lj/charmm/coul/charmm 1.0 1.5": {(i, j): (EPSILON[i, j], SIGMA[i, j], 0.3 * i * j, 0.1 * (i + j))
                                              for i in (1, 2, 3) for j in range(i, 4)}}
    e = {}
    for weight in (0.0, 0.5, 1.0):
        interactions = Interactions.build(pair=pair, dihedral={"charmm": {1: (0.2, 2, 180, weight)}})
        engine = engine_of(system.copy(), mode, interactions)
        e[weight] = engine.per_atom(engine.compute())
        assert e[weight].energies.sum() == pytest.approx(e[weight].potential, rel=1e-12)
    near, _ = system.box.minimum_image(system.x[system.topology.dihedrals[:, 0]] - system.x[system.topology.dihedrals[:, 3]])
    r = np.linalg.norm(near, axis=1)
    i, j = (system.type[system.topology.dihedrals[:, k]].astype(int) for k in (0, 3))
    s6 = (0.1 * (i + j) / r) ** 6
    lj = (4 * 0.3 * i * j * (s6 * s6 - s6)).sum()
    coul = (system.q[system.topology.dihedrals[:, 0]] * system.q[system.topology.dihedrals[:, 3]] / r).sum()
    for weight in (0.5, 1.0):
        assert e[weight].energy["evdwl"] - e[0.0].energy["evdwl"] == pytest.approx(weight * lj, rel=1e-9)
        assert e[weight].energy["ecoul"] - e[0.0].energy["ecoul"] == pytest.approx(weight * coul, rel=1e-9)


@BOTH
def test_overlapping_atoms_are_named(mode):
    rng = np.random.default_rng(3)
    system = make(scattered(64, SNUG, 0, rng), SNUG, (True,) * 3, rng)
    system.id = system.id + 500
    system.x[40] = system.x[11]
    with pytest.raises(SimulationError, match="atoms 512 and 541"):
        engine_of(system, mode).compute()


def test_update_takes_over_changes():
    rng = np.random.default_rng(3)
    system = make(scattered(300, np.eye(3) * 7.5, 0, rng), np.eye(3) * 7.5, (True,) * 3, rng)
    engine = Engine(system, Interactions.build(pair=PAIRS), Settings())
    engine.compute()
    for change in ("types", "charges", "box", "fewer atoms"):
        if change == "types":
            system.type = np.roll(system.type, 1)
        elif change == "charges":
            system.q = -2 * np.roll(system.q, 1)
        elif change == "box":
            system.box = Box(system.box.origin, system.box.cell * 1.1)
        else:
            system = system.select(np.arange(0, 300, 3))
        engine.update(system)
        again = Engine(system.copy(), Interactions.build(pair=PAIRS), Settings()).compute()
        result = engine.compute()
        assert result.potential == pytest.approx(again.potential, rel=1e-12), change
        assert np.allclose(result.forces, again.forces, atol=1e-10 * np.abs(again.forces).max()), change


def test_no_pair_style():
    system = molecules(SNUG, np.random.default_rng(2))
    engine = Engine(system, Interactions.build(bond={"harmonic": {1: (30.0, 1.0)}}), Settings())
    result = engine.compute()
    assert engine.mode == "none" and engine.pairs == 0
    near, _ = system.box.minimum_image(system.x[system.topology.bonds[:, 0]] - system.x[system.topology.bonds[:, 1]])
    assert result.energy["ebond"] == pytest.approx((30 * (np.linalg.norm(near, axis=1) - 1) ** 2).sum(), rel=1e-12)


def test_charmm_weight_needs_a_pair_style_with_one_four_coefficients():
    system = molecules(SNUG, np.random.default_rng(2))
    interactions = Interactions.build(pair=PAIRS, dihedral={"charmm": {1: (0.2, 2, 180, 1.0)}})
    with pytest.raises(InputError, match="1-4 coefficients"):
        Engine(system, interactions, Settings())
