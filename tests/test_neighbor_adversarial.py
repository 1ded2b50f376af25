"""Every kind of neighbour list, pair by pair, in cells and of atoms that are made to break them: what a list must have is counted by brute
force over all images. Then energies and forces of the same scenes, through the calculator too."""
from __future__ import annotations

from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from brute import CELLS, images, make, pairs, scattered
from hypothesis import given, settings
from hypothesis import strategies as st
from neighbor_scenes import ALL, OVER_CLUSTERS, SCENES, SHEARED, WIDE

import asemd
from asemd import engine as engines
from asemd import units
from asemd.box import Box
from asemd.compute._pairs import half
from asemd.engine import Engine, Settings
from asemd.forcefield import Interactions
from asemd.kernels import surroundings
from asemd.manybody_term import ManyBodyTerm
from asemd.system import System
from asemd.topology import Topology


def system_of(name: str) -> System:
    x, cell, periodic, _ = SCENES[name]
    return make(x, cell, periodic, np.random.default_rng(3))


def lj(cut) -> Interactions:
    """lj/cut with a strength so small that crowded atoms have finite forces; one cutoff, or one by pair of types."""
    table = cut if np.ndim(cut) else np.full((4, 4), cut)
    return Interactions.build(pair={"lj/cut 1.0": {(i, j): (1e-9, 0.2, table[i, j]) for i in (1, 2, 3) for j in range(i, 4)}})


def made(system: System, interactions: Interactions, *, small: int = 10**9, sparse: float = 0.0, **options) -> Engine:
    """An engine with its list at the system's positions, over clusters for ``small=0`` where the cell allows it."""
    before = engines.SMALL, engines.SPARSE
    engines.SMALL, engines.SPARSE = small, sparse
    try:
        engine = Engine(system, interactions, Settings(**options))
        engine.load()
        return engine
    finally:
        engines.SMALL, engines.SPARSE = before


def vectors(engine: Engine, i, j, image, shifts) -> tuple[np.ndarray, ...]:
    """Rows of the atoms of pairs of slots, and the vector from j to i."""
    s = engine.state
    return s.row[i], s.row[j], (s.x[:, i] - s.x[:, j]).T - shifts[image]


def assert_same(found, expected, scale: float = 1.0) -> None:
    """The same pairs, each as often, with the same vectors; whichever atom comes first."""
    def ordered(i, j, d):
        i, j, d = np.asarray(i, np.int64), np.asarray(j, np.int64), np.asarray(d, float).reshape(-1, 3)
        along = d @ [0.61, 0.37, 0.22]
        turned = (i > j) | ((i == j) & (along < 0))
        i, j, d = np.where(turned, j, i), np.where(turned, i, j), np.where(turned[:, None], -d, d)
        order = np.lexsort((d @ [0.61, 0.37, 0.22], j, i))
        return i[order], j[order], d[order]
    a, b = ordered(*found), ordered(*expected)
    assert len(a[0]) == len(b[0])
    assert np.array_equal(a[0], b[0]) and np.array_equal(a[1], b[1])
    assert np.allclose(a[2], b[2], rtol=0, atol=1e-9 * scale)


@cache
def expected(name: str, reach: float):
    x, cell, periodic, _ = SCENES[name]
    return pairs(x, cell, periodic, reach)


def scale_of(system: System) -> float:
    """How much rounding the positions allow."""
    return 1e-6 * float(np.abs(system.x).max() + np.abs(system.box.cell).max()) + 1.0


@pytest.mark.parametrize("skin", [0.0, 0.3])
@pytest.mark.parametrize("name", SCENES)
def test_plain_list(name, skin):
    system, cut = system_of(name), SCENES[name][3]
    engine = made(system, lj(cut), skin=skin)
    want = expected(name, cut + skin)
    i, j, code = engine.plain
    assert_same(vectors(engine, i, j, code >> 2, engine.plain_shifts), want, scale_of(system))
    assert engine.pairs == len(want[0])


@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize("name", OVER_CLUSTERS)
def test_cluster_list(name, threads):
    """The list as plain pairs, the number of pairs it tells, the histogram of distances over it, and both cutoffs with skin."""
    system, cut = system_of(name), SCENES[name][3]
    engine = made(system, lj(cut), small=0, skin=0.0, threads=threads)
    assert engine.mode == "cluster" and not engine.sparse, engine.why
    want, s, c = expected(name, cut), engine.state, engine.list
    i, j, code = c.expand(engine.k, s, cut)
    assert_same(vectors(engine, i, j, code >> 2, c.shifts), want, scale_of(system))
    assert engine.pairs == len(want[0])
    counts, bins = np.zeros((1, 1, 41), np.int64), 40
    for t in range(threads):
        surroundings.radial_clusters(s.x, s.row, np.zeros(s.x.shape[1], np.int32), c.first[t], c.entries[t], c.own, c.span,
                                     int(c.bounds[t]), int(c.bounds[t + 1]), c.shifts, bins / cut, counts)
    distances = np.linalg.norm(want[2], axis=1)
    assert counts[0, 0, :bins].sum() == len(distances)
    clear = np.abs(distances * bins / cut - np.rint(distances * bins / cut)) > 1e-6      # others may fall on either side of an edge
    if clear.all():
        assert np.array_equal(counts[0, 0, :bins], np.histogram(distances, bins, (0, cut))[0])


@pytest.mark.parametrize("name", OVER_CLUSTERS)
def test_clusters_end_where_there_is_nothing(name):
    """Kernels in single precision take positions from the first atom of a cluster."""
    engine = made(system_of(name), lj(SCENES[name][3]), small=0, skin=0.1)
    x, row = engine.state.x[:, :engine.ns].T.reshape(-1, 8, 3), engine.state.row[:engine.ns].reshape(-1, 8, 1)
    assert np.array_equal(np.sort(row[row >= 0]), np.arange(engine.system.n))
    extent = np.where(row >= 0, x, -np.inf).max(1) - np.where(row >= 0, x, np.inf).min(1)
    assert extent.max() < 8.0 * engine.reach


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("name", OVER_CLUSTERS)
def test_rows_of_single_atoms(name, threads):
    system, cut = system_of(name), SCENES[name][3]
    engine = made(system, lj(cut), small=0, sparse=np.inf, skin=0.0, threads=threads)
    assert engine.sparse, engine.why
    rows, found = engine.rows[""], []
    for t in range(threads):
        for i in range(int(rows.edges[t]), int(rows.edges[t + 1])):
            entries = rows.neighbors[t, rows.start[t, i]:rows.start[t, i + 1]]
            found.append((np.full(len(entries), i), entries & 0x3FFFFFF, entries >> 26))
    i, j, image = (np.concatenate(part) for part in zip(*found))
    assert_same(vectors(engine, i, j, image, engine.list.shifts), expected(name, cut), scale_of(system))
    assert engine.pairs == rows.entries == len(i)


def entry(a, b, c, cut) -> str:
    """A triple of a Stillinger-Weber file that ends at `cut`."""
    return f"{a} {b} {c} 0.01 1.0 {cut!r} 21.0 1.2 -0.333333333333 7.05 0.6 4 0 0\n"


@pytest.fixture
def three_cutoffs(tmp_path):
    """A many-body potential whose pairs of types end at a tenth of the longest cutoff, at half of it, and there."""
    def write(cut):
        of = {"AA": 0.1, "AB": 0.5, "BB": 1.0, "AC": 0.7, "BC": 0.1, "CC": 0.3}
        path = tmp_path / "three.sw"
        path.write_text("".join(entry(a, b, c, cut * of["".join(sorted(b + a))]) for a in "ABC" for b in "ABC" for c in "ABC"))
        table = np.array([[0.0] * 4, *([0.0, *(cut * of["".join(sorted(a + b))] for b in "ABC")] for a in "ABC")])
        return str(path), table
    return write


def many(file: str, system: System) -> Interactions:
    out = Interactions()
    out.set_style("pair", ["sw"])
    out.set_coeff("pair", ["*", "*", file, "A", "B", "C"], system)
    return out


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("name", SCENES)
def test_rows_of_many_body_styles(name, threads, three_cutoffs):
    """All neighbours of each atom, both ways; the first parts of the rows have each pair once; cutoffs by pair of types."""
    system, cut, skin = system_of(name), SCENES[name][3], 0.2
    file, table = three_cutoffs(cut)
    inter = many(file, system)
    for small in (10**9, 0):
        engine = made(system, inter, small=small, sparse=np.inf, skin=skin, threads=threads)
        term, = (t for t in engine.terms if isinstance(t, ManyBodyTerm))
        i, j, d = expected(name, cut + skin)
        near = (d * d).sum(1) < (table[system.type[i], system.type[j]] + skin) ** 2
        once = i[near], j[near], d[near]
        ns = engine.ns
        slots = [np.repeat(np.arange(ns), e[:ns] - b[:ns]) for b, e in ((term.first, term.middle), (term.middle, term.last))]
        of = [np.concatenate([np.arange(b[s], e[s]) for s in range(ns)] or [np.zeros(0, int)])
              for b, e in ((term.first, term.middle), (term.middle, term.last))]
        for slot, at in zip(slots, of):
            assert_same(vectors(engine, slot, term.neighbors[at], term.codes[at].astype(int), term.shifts), once, scale_of(system))
        assert term.entries == len(once[0])


@pytest.mark.parametrize("name", SCENES)
def test_pairs_that_computes_see(name):
    """From the list of the forces, and from one of their own where that does not reach so far."""
    system, cut = system_of(name), SCENES[name][3]
    for small, reach in ((10**9, cut), (0, cut), (0, 0.4 * cut), (10**9, 1.3 * cut)):
        engine = made(system, lj(cut), small=small, skin=0.1)
        state = SimpleNamespace(engine=engine, system=system)
        engine.store()
        i, j, d = expected(name, reach)
        found = half(state, reach, own=True)
        assert_same((found.i, found.j, found.d), (i, j, d), scale_of(system))
        assert np.allclose(found.r2, (found.d**2).sum(1), rtol=1e-14)
        start, other, vector, _ = found.around(system.n)      # both ways
        assert np.array_equal(np.diff(start), np.bincount(np.concatenate([i, j]), minlength=system.n))
        first = np.repeat(np.arange(system.n), np.diff(start))
        assert_same((first, other, -vector), [np.concatenate([a, b]) for a, b in ((i, i), (j, j), (d, d))], scale_of(system))


def summed(found, n: int, law, special=None):
    """Energy, the sum of its sizes, forces (n, 3), and those of each atom's pairs, of ``law(r, i, j, weight) -> E, dE/dr``.

    `special`: (i, j) -> weight of the closest image of the pair.
    """
    i, j, d = found
    r = np.linalg.norm(d, axis=1)
    weight = np.ones(len(r))
    for (a, b), w in (special or {}).items():
        at = np.flatnonzero((i == a) & (j == b))
        if len(at):
            weight[at[np.argmin(r[at])]] = w
    e, slope = law(r, i, j, weight)
    f = -(slope / r)[:, None] * d
    forces, size = np.zeros((n, 3)), np.zeros(n)
    np.add.at(forces, i, f)
    np.add.at(forces, j, -f)
    for atoms in (i, j):
        np.add.at(size, atoms, np.abs(slope))
    return float(e.sum()), float(np.abs(e).sum()), forces, size


def laws(name: str):
    """Types, charges, the closest distance; pair styles with coefficients by elements, and what they are: lj/cut as large as the closest
    pair of the scene, with cutoffs of very different lengths, and charges with soft cores."""
    x, cell, periodic, cut = SCENES[name]
    i, j, d = expected(name, cut)
    closest = float(np.linalg.norm(d, axis=1).min(initial=1.0))
    types = np.random.default_rng(3).integers(1, 4, len(x))
    q = np.random.default_rng(4).normal(0, 1, len(x))
    cuts = np.array([[0, 0, 0, 0], [0, 0.1, 0.9, 0.3], [0, 0.9, 1.0, 0.15], [0, 0.3, 0.15, 0.6]]) * cut
    cuts = np.maximum(cuts, min(1.9 * closest, cut))
    e, k = 0.01, units.get("ase").qqr2e

    def lennard_jones(r, i, j, weight):
        s6 = np.where(r < cuts[types[i], types[j]], (closest / r) ** 6, 0.0)
        return 4 * e * weight * (s6 * s6 - s6), -24 * e * weight * (2 * s6 * s6 - s6) / r

    def soft(r, i, j, weight):
        front, core, gap = 0.6**2 * e, 0.5 * 0.4**2, 5.0 * 0.4**2
        u = (r / 0.9) ** 6
        a = 1 / (core + u)
        lj = r < cuts[types[i], types[j]]
        el, fl = 4 * front * (a * a - a), 4 * front * (1 - 2 * a) * a * a * 6 * u / r
        c = 0.6**2 * k * q[i] * q[j]
        return weight * (np.where(lj, el, 0) + c / np.sqrt(gap + r * r)), weight * (np.where(lj, fl, 0) - c * r / (gap + r * r) ** 1.5)
    elements = ["", "Ar", "Kr", "Xe"]
    keys = [(a, b) for a in (1, 2, 3) for b in range(a, 4)]
    own = {f"lj/cut {cut!r}": {(elements[a], elements[b]): (e, closest, float(cuts[a, b])) for a, b in keys}}
    charged = {f"lj/cut/coul/cut/soft 2 0.5 5.0 {cut!r} {cut!r}": {(elements[a], elements[b]): (e, 0.9, 0.6, float(cuts[a, b]), cut)
                                                                  for a, b in keys}}
    return types, q, closest, ((own, lennard_jones), (charged, soft))


SEVERAL = [name for name in SCENES if len(SCENES[name][0]) > 1]


@pytest.mark.parametrize("way", ["plain", "clusters", "rows", "two threads", "mixed"])
@pytest.mark.parametrize("name", SEVERAL)
def test_calculator(name, way, monkeypatch):
    """Energy and forces of ASE's atoms, each atom's as exact as its own pairs; of partners of bonds, across faces too, the closest image
    counts less or not at all."""
    if way != "plain" and name not in OVER_CLUSTERS:
        pytest.skip("the cell is too small for clusters")
    types, q, closest, cases = laws(name)
    if way == "mixed" and ("sites" in name or "lattice" in name or closest < 0.01):
        pytest.skip("single precision cannot tell which side of the cutoff a pair is on, or how far atoms are from each other")
    monkeypatch.setattr(engines, "SMALL", 10**9 if way == "plain" else 0)
    monkeypatch.setattr(engines, "SPARSE", np.inf if way == "rows" else 0.0)
    x, cell, periodic, cut = SCENES[name]
    bonds = [(i, i + 1) for i in range(0, len(x) - 1, 3)]
    allowed = 3e-6 * cut / closest if way == "mixed" else 1e-11 + 3e-15 * np.abs(x).max() / closest
    for (styles, law), weight in zip(cases, (0.4, 0.0)):
        energy, most, forces, size = summed(expected(name, cut), len(x), law, dict.fromkeys(bonds, weight))
        atoms = asemd.Atoms(np.array(["", "Ar", "Kr", "Xe"])[types], positions=x, cell=cell, pbc=periodic, charges=q,
                            topology=Topology(bonds=bonds))
        atoms.calc = asemd.ForceField(pair=styles, bond={"zero": {1: ()}}, special_bonds=(weight, 1.0, 1.0),
                                      skin=0.0 if way == "rows" else 0.2, threads=2 if way == "two threads" else 1,
                                      precision="mixed" if way == "mixed" else "double")
        assert np.all(np.abs(atoms.get_forces() - forces).max(axis=1) <= allowed * size + 1e-13 * size.max()), law.__name__
        assert abs(atoms.get_potential_energy() - energy) <= allowed * (most + closest * size.sum())
        assert atoms.calc.engine.mode == ("plain" if way == "plain" or way == "rows" and "narrow" in name else "cluster")


@pytest.mark.parametrize("name", SEVERAL)
def test_exclusions(name):
    """Pairs that ``neigh_modify exclude`` forbids are in no list, in any image, those of types not in what computes see."""
    x, _, _, cut = SCENES[name]
    n, system = len(x), system_of(name)
    a, b, t = np.arange(n) % 3 == 0, np.arange(n) % 4 == 1, system.type
    system.molecule = np.arange(n) // 4 + 1
    i, j, d = expected(name, cut)
    no = (a[i] & b[j]) | (b[i] & a[j]) | ((system.molecule[i] == system.molecule[j]) & a[i] & a[j])
    of_types = (np.minimum(t[i], t[j]) == 1) & (np.maximum(t[i], t[j]) == 2)
    for small in (10**9, 0):
        engine = made(system, lj(cut), small=small, skin=0.0,
                      exclude=[("group", a, b), ("molecule/intra", a), ("type", 1, 2)])
        assert engine.pairs == (~no).sum()
        engine.store()
        found = half(SimpleNamespace(engine=engine, system=system), cut, own=True)
        keep = ~no & ~of_types
        assert_same((found.i, found.j, found.d), (i[keep], j[keep], d[keep]), scale_of(system))


FUNCFL = "copper, more or less\n29 63.55 3.6 fcc\n{n} 0.05 {n} {dr!r} {cut!r}\n{rows}\n"


def embedded_file(path, cut: float, scale: float, n: int = 300) -> str:
    """An embedded-atom file of smooth functions that are finite everywhere."""
    r, rho = np.linspace(0, cut, n), 0.05 * np.arange(n)
    rows = [-np.sqrt(rho + 0.3) * scale, scale * r * (1 - r / cut) ** 2, scale * (1 - r / cut) ** 3]
    path.write_text(FUNCFL.format(n=n, dr=cut / (n - 1), cut=cut, rows="\n".join(f"{v:.15g}" for row in rows for v in row)))
    return str(path)


def open_piece(system: System, reach: float) -> System:
    """The atoms of the cell first, then all images near it, in open space: nothing is periodic."""
    x, cell = system.x, system.box.cell
    base = np.where(system.box.periodic, np.floor(x @ np.linalg.inv(cell)), 0.0) @ cell
    shifts = images(cell, system.box.periodic, reach)
    shifts = shifts[np.argsort((shifts**2).sum(1), kind="stable")]
    low, high = (x - base).min(0) - reach, (x - base).max(0) + reach
    copies, types = [x - base], [system.type]
    for shift in shifts[1:]:
        y = x - base + shift
        near = ((y > low) & (y < high)).all(1)
        copies.append(y[near])
        types.append(system.type[near])
    x = np.concatenate(copies)
    return System(box=Box(x.min(0) - 1.0, np.diag(np.ptp(x, axis=0) + 2.0), ("ss",) * 3), x=x, type=np.concatenate(types), units="metal",
                  mass=np.array([np.nan, 1.0, 1.0, 1.0]), counts={"ntypes": 3})


@pytest.mark.parametrize("style", ["sw", "eam"])
@pytest.mark.parametrize("name", [*CELLS, "sheared", "wide"])
def test_many_body_forces_are_those_of_a_piece_in_open_space(name, style, three_cutoffs, tmp_path):
    cell, rng = {**CELLS, "sheared": SHEARED * 0.7, "wide": WIDE * 0.6}[name], np.random.default_rng(11)
    few = name.startswith("tiny")
    for periodic in (ALL, (True, False, True), (False, False, True)):
        x = scattered(3 if few else 60, cell, 0.0, rng) + rng.integers(-3, 4, (3 if few else 60, 3)) * periodic @ cell
        system, cut = make(x, cell, periodic, rng), 1.7 if few else 2.1
        system.units = "metal"
        if few:
            system.type[:] = 1, 2, 2
        if style == "sw":
            inter = many(three_cutoffs(cut)[0], system)
        else:
            inter = Interactions()
            inter.set_style("pair", ["eam"])
            for t in (1, 2, 3):
                inter.set_coeff("pair", [str(t), str(t), embedded_file(tmp_path / f"{t}.eam", cut * (1.1 - 0.1 * t), 0.2 + t)], system)
        piece = made(open_piece(system, 2 * cut + 0.1), inter).compute()
        want = piece.forces[:system.n]
        for small, threads in ((10**9, 1), (0, 1), (0, 2)):
            engine = made(system, inter, small=small, skin=0.1, threads=threads)
            got = engine.compute().forces
            assert np.abs(got - want).max() < 1e-11 * np.abs(want).max(), (periodic, engine.why)


@settings(max_examples=60, derandomize=True, deadline=None)
@given(st.integers(0, 2**31), st.sampled_from([(1.0, 1.0, 1.0), (0.05, 1.0, 1.0), (0.1, 0.1, 1.0), (1.0, 1.0, 20.0), (3.0, 0.01, 1.0)]),
       st.integers(0, 7), st.integers(0, 120), st.floats(0.05, 3.0), st.sampled_from([0.0, 0.3]), st.integers(0, 3), st.booleans())
def test_any_cell_in_any_description(seed, shape, pbc, n, cut, skin, turns, crowded):
    """Random cells, described by vectors of the same lattice that are far from the shortest ones, in any order and direction."""
    rng = np.random.default_rng(seed)
    cell = np.diag(shape) * 4.0 + 0.2 * rng.normal(size=(3, 3)) * np.array(shape)[:, None]
    periodic = np.array([bool(pbc >> k & 1) for k in range(3)])
    for _ in range(turns):      # add one periodic vector to another: the lattice stays
        a, b = rng.permutation(3)[:2]
        if periodic[b]:
            cell[a] += rng.integers(-2, 3) * cell[b]
    cell *= rng.choice([-1, 1], (3, 1))
    widths = 1 / np.linalg.norm(np.linalg.inv(cell), axis=0)
    cut = min(cut, 12.0 * widths[periodic].min(initial=np.inf))      # brute force has to see all images
    n = min(n, int(1e5 / np.prod(2 * (cut + skin) / widths * periodic + 1) ** 0.5 / 30) + 1)
    s = 0.5 + 0.02 * rng.normal(size=(n, 3)) if crowded else rng.random((n, 3))
    x = (s + rng.integers(-5, 6, (n, 3)) * periodic) @ cell
    want = pairs(x, cell, periodic, cut + skin)
    for small, sparse in ((10**9, 0.0), (0, 0.0), (0, np.inf)):
        system = make(x, cell, tuple(periodic), np.random.default_rng(seed))
        engine = made(system, lj(cut), small=small, sparse=sparse, skin=skin)
        engine.store()
        assert engine.pairs == len(want[0])
        found = half(SimpleNamespace(engine=engine, system=system), cut + skin, own=True)
        assert_same((found.i, found.j, found.d), want)
