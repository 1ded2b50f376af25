"""System and Atoms: selecting, repeating, joining, ASE and back; replicate against LAMMPS."""
from __future__ import annotations

import copy
import pickle

import ase
import numpy as np
import pytest
from ase.build import molecule
from hypothesis import given, settings
from hypothesis import strategies as st
from wheel import ask

from asemd import units
from asemd.box import Box
from asemd.errors import InputError, InputWarning
from asemd.system import Atoms, System
from asemd.topology import Topology


def chain(n=6, seed=0, **more):
    """A bead chain through a small tilted box: every few bonds cross a periodic face."""
    rng = np.random.default_rng(seed)
    box = Box.from_lammps([-1, 0, 2], [5, 7, 8], (1.5, -0.7, 0.4))
    step = rng.normal(size=(n, 3))
    x = np.cumsum(step / np.linalg.norm(step, axis=1)[:, None], axis=0) + [0, 1, 3]
    i = np.arange(n)
    top = Topology(bonds=np.column_stack([i[:-1], i[1:]]), bond_types=1 + i[:-1] % 2, angles=np.column_stack([i[:-2], i[1:-1], i[2:]]),
                   dihedrals=np.column_stack([i[:-3], i[1:-2], i[2:-1], i[3:]]))
    arrays = dict(type=1 + i % 3, q=rng.normal(size=n), v=rng.normal(size=(n, 3)), molecule=1 + i // 3, id=i + 5, mass=[np.nan, 1, 2, 3],
                  atom_style="full", topology=top, extra={"tag": i * 1.5}) | more
    system = System(box=box, x=x, **arrays)
    box.wrap(system.x, system.image)
    return system


def bond_energy(system, r0=0.9):
    b = system.topology.bonds
    d = system.box.minimum_image(system.x[b[:, 1]] - system.x[b[:, 0]])[0]
    return float((system.topology.bond_types * (np.linalg.norm(d, axis=1) - r0) ** 2).sum())


def test_defaults():
    s = System(box=Box.from_lammps([0] * 3, [1] * 3), x=[[0, 0, 0], [0.5, 0, 0]], type=[1, 2])
    assert s.n == 2 and s.id.tolist() == [1, 2] and not s.has_charge and not s.molecular
    assert s.counts["ntypes"] == 2 and s.counts["nbondtypes"] == 0 and s.mass.shape == (3,)
    assert (s.x.dtype, s.type.dtype, s.id.dtype, s.image.dtype) == (float, np.int32, np.int64, np.int32)
    with pytest.raises(InputError, match="no mass for atom types 1, 2"):
        s.check_masses()
    s.mass[1:] = 3.0
    s.check_masses()
    assert s.atom_masses().tolist() == [3, 3]


@given(st.lists(st.integers(-6, 5), max_size=6, unique_by=lambda i: i % 6))
def test_select(rows):
    s = chain()
    t = s.select(rows)
    assert t.id.tolist() == s.id[rows].tolist() and t.extra["tag"].tolist() == s.extra["tag"][rows].tolist()
    kept = {frozenset(t.id[b]) for b in t.topology.bonds}
    assert kept == {frozenset(s.id[b]) for b in s.topology.bonds if set(s.id[b]) <= set(s.id[rows])}
    assert t.counts == s.counts and s.n == 6
    t.x[:] = 0
    assert s.x.any(), "a selection shares no memory"


def test_index_of():
    s = chain()
    assert s.index_of([10, 5]).tolist() == [5, 0]
    with pytest.raises(InputError, match=r"atom ID 4 does not exist \(file has IDs 5-10\)"):
        s.index_of([5, 4])


def test_append_raises_ids():
    a, b = chain(4), chain(6, seed=1)
    c = a.append(b)
    assert c.id.tolist() == [5, 6, 7, 8, *(b.id + 8)] and c.molecule.tolist() == [1, 1, 1, 2, *(b.molecule + 2)]
    assert c.topology == a.topology.concatenate(b.topology.shift(4))
    assert c.select(slice(4, None)).topology == b.topology
    with pytest.raises(InputError, match="ID 5 exists"):
        a.append(b, keep_ids=True)
    with pytest.raises(InputError, match="units"):
        a.append(System(box=b.box, x=b.x, type=b.type, units="metal"))


@settings(max_examples=25, deadline=None)
@given(st.tuples(*[st.integers(1, 3)] * 3), st.integers(0, 9))
def test_replicate_keeps_every_bond(times, seed):
    s = chain(12, seed)
    r = s.replicate(*times)
    copies = int(np.prod(times))
    assert bond_energy(r) == pytest.approx(copies * bond_energy(s), rel=1e-10)
    assert r.n == copies * s.n and len(np.unique(r.id)) == r.n and (np.diff(r.id.reshape(copies, -1), axis=0) == s.id.max()).all()
    assert np.linalg.norm(np.diff(r.box.unwrap(r.x, r.image)[:12], axis=0), axis=1) == pytest.approx(np.ones(11))
    p = s.replicate(*times, bond_periodic=True)
    assert bond_energy(p) == pytest.approx(copies * bond_energy(s), rel=1e-10)


def test_replicate_errors():
    flat = chain(dimension=2)
    with pytest.raises(InputError, match="2d"):
        flat.replicate(1, 1, 2)
    with pytest.raises(InputError, match="at least 1"):
        flat.replicate(0, 1, 1)
    torn = chain()
    torn.image[3] += [2, 0, 0]
    with pytest.warns(InputWarning, match="inconsistent image flags.*atoms 7-8"):
        torn.replicate(2, 1, 1)


REPLICATE = """
lmp = ran(given["lines"])
answer = dict(energy=lmp.get_thermo("pe"), x=list(lmp.gather_atoms("x", 1, 3)), image=list(lmp.gather_atoms("image", 0, 3)),
              mol=list(lmp.gather_atoms("molecule", 0, 1)), box=lmp.extract_box()[:5])
"""


@pytest.mark.parametrize("options", ["", " bond/periodic"])
def test_replicate_is_that_of_lammps(options, tmp_path):
    from asemd.lammps.data_write import write_data
    s = chain(7, id=np.arange(1, 8), topology=Topology(bonds=[[i, i + 1] for i in range(6)]))
    s.molecule[2] = 0
    write_data(tmp_path / "chain.data", s)
    want = ask(REPLICATE, lines=[
        "units lj", "atom_style full", "pair_style zero 1.0", "bond_style harmonic", f"read_data {tmp_path}/chain.data", "pair_coeff * *",
        "bond_coeff 1 1.0 0.9", "thermo_modify norm no", f"replicate 2 1 3{options}", "run 0"])
    mine = s.replicate(2, 1, 3, bond_periodic=bool(options))
    order = np.argsort(mine.id)
    np.testing.assert_allclose(mine.x[order].ravel(), want["x"], atol=1e-12)
    np.testing.assert_array_equal(mine.image[order].ravel(), want["image"])
    np.testing.assert_array_equal(mine.molecule[order], want["mol"])
    np.testing.assert_allclose([*mine.box.lo, *mine.box.hi], [*want["box"][0], *want["box"][1]])
    assert bond_energy(mine) == pytest.approx(want["energy"], rel=1e-12)


# ---- ASE
def test_to_ase_and_back():
    s = chain(labels={"atom": {1: "C", 2: "CA", 3: "O"}}, mass=[np.nan, 12.01, 12.01, 15.9994], units="real")
    atoms = s.to_ase()
    assert isinstance(atoms, ase.Atoms) and set(atoms.get_chemical_symbols()) == {"C", "O"}
    assert atoms.topology == s.topology and atoms.get_celldisp().ravel().tolist() == s.box.origin.tolist()
    np.testing.assert_allclose(atoms.get_velocities(), s.v * units.factor("velocity", "real"), rtol=1e-13)
    back = System.from_ase(atoms, units="real")
    for name in ("id", "type", "image", "molecule", "q"):
        np.testing.assert_array_equal(getattr(back, name), getattr(s, name))
    np.testing.assert_allclose(back.x, s.x, atol=1e-13)
    np.testing.assert_allclose(back.v, s.v, rtol=1e-12)
    np.testing.assert_allclose(back.mass[1:], s.mass[1:])
    assert back.topology == s.topology and back.atom_style == "full"
    np.testing.assert_allclose(back.box.cell, s.box.cell)


def test_elements_from_masses_and_x():
    s = chain(mass=[np.nan, 1.0, 55.847, 15.035], units="metal")
    assert s.to_ase().get_chemical_symbols() == ["H", "Fe", "X"] * 2
    assert set(chain().to_ase().get_chemical_symbols()) == {"X"}, "reduced units have no elements"
    assert chain(units="metal", mass=None).to_ase().get_chemical_symbols() == ["X"] * 6


def test_from_ase_of_any_atoms():
    water = molecule("H2O")
    s = System.from_ase(water)
    assert s.units == "ase" and s.labels["atom"] == {1: "H", 2: "O"} and s.type.tolist() == [2, 1, 1] and s.atom_style == "atomic"
    assert s.box.boundary == ("ss", "ss", "ss") and s.rmass is None
    assert System.from_ase(water, types=["O", "H"]).type.tolist() == [1, 2, 2]
    with pytest.raises(InputError, match="element O is not among the types"):
        System.from_ase(water, types=["H"])
    water.set_masses([16, 1, 2])
    assert System.from_ase(water).atom_masses().tolist() == [16, 1, 2]
    water.set_initial_charges([-0.8, 0.4, 0.4])
    assert System.from_ase(water).q.tolist() == [-0.8, 0.4, 0.4]
    left = ase.Atoms("Ar", [[9, -1, 0.5]], cell=[[0, 3, 0], [4, 0, 0], [0, 1, 5]], pbc=[True, True, False])
    got = System.from_ase(left)
    assert np.array_equal(got.box.cell, left.cell) and got.box.boundary == ("pp", "pp", "ss")
    np.testing.assert_allclose(got.box.unwrap(got.x, got.image), left.positions, atol=1e-12)


def test_slicing_atoms():
    atoms = chain().to_ase()
    n = len(atoms)
    for index in (slice(1, None), slice(None, None, -1), [0, 1, 2], [-1, -2], np.arange(n) < 3, [True] * 3 + [False] * 3, []):
        part = atoms[index]
        assert isinstance(part, Atoms)
        ids = {frozenset(part.arrays["id"][b]) for b in part.topology.bonds}
        have = set(part.arrays["id"])
        assert ids == {frozenset(atoms.arrays["id"][b]) for b in atoms.topology.bonds if set(atoms.arrays["id"][b]) <= have}
    assert isinstance(atoms[0], ase.Atom) and atoms[0].index == 0


def test_deleting_and_joining_atoms():
    atoms = chain().to_ase()
    cut = atoms.copy()
    del cut[2]
    assert cut.topology.bonds.tolist() == [[0, 1], [2, 3], [3, 4]] and len(atoms.topology.bonds) == 5
    del cut[[-1]]
    assert cut.topology.bonds.tolist() == [[0, 1], [2, 3]]
    del cut[np.array([True, False, False, False])]
    assert cut.topology.bonds.tolist() == [[1, 2]]
    cut.pop()
    assert cut.topology.is_empty
    both = atoms + atoms
    assert both.topology == atoms.topology.concatenate(atoms.topology.shift(6))
    assert len(set(both.arrays["id"])) == 12 and both.arrays["mol-id"].tolist() == [1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4]
    both += molecule("H2O")
    assert len(set(both.arrays["id"])) == 15 and len(both.topology.bonds) == 10
    both.append(ase.Atom("O"))
    assert len(both) == 16 and len(set(both.arrays["id"])) == 16


@pytest.mark.parametrize("copier", [lambda a: a.copy(), copy.copy, copy.deepcopy, lambda a: pickle.loads(pickle.dumps(a)), Atoms,
                                    lambda a: Atoms.fromdict(a.todict()), lambda a: a * 1])
def test_copies_of_atoms_keep_the_topology(copier):
    atoms = chain().to_ase()
    twin = copier(atoms)
    assert type(twin) is Atoms and twin.topology == atoms.topology and np.array_equal(twin.positions, atoms.positions)


def test_repeated_atoms_keep_the_energy():
    s = chain(12)
    atoms = s.to_ase()
    for times in ((2, 2, 1), 2, (1, 3, 1)):
        many = atoms * times
        copies = 8 if times == 2 else int(np.prod(times))
        assert bond_energy(System.from_ase(many, units="lj")) == pytest.approx(copies * bond_energy(s), rel=1e-10)
        assert len(set(many.arrays["id"])) == len(many)
        np.testing.assert_allclose(many.positions, (ase.Atoms(atoms) * times).positions)
    assert len(atoms.topology.bonds) == 11


def test_system_pickles_and_copies():
    s = chain()
    for twin in (s.copy(), pickle.loads(pickle.dumps(s)), copy.deepcopy(s)):
        assert twin.topology == s.topology and twin.box == s.box and np.array_equal(twin.x, s.x) and twin.counts == s.counts
