"""Second derivatives of the energy, compared with differences of forces; their use by ASE."""
from __future__ import annotations

import ase
import numpy as np
import pytest
from ase.build import bulk, molecule
from ase.phonons import Phonons
from ase.vibrations import Vibrations, VibrationsData

import asemd
from asemd import style as registry
from asemd.errors import InputError, SimulationError
from asemd.testing import styles
from asemd.topology import ATOMS, Topology

CURVED = [(c, n) for c in ATOMS for n in registry.names(c) if registry.find(c, n).d2]
STENCIL = ((-3, -1 / 60), (-2, 3 / 20), (-1, -3 / 4), (1, 3 / 4), (2, -3 / 20), (3, 1 / 60))


def differences(atoms, h=1e-3):
    """The matrix from forces at six places along each coordinate."""
    x, out = atoms.positions.copy(), []
    for k in range(x.size):
        row = 0.0
        for step, weight in STENCIL:
            moved = x.copy()
            moved.flat[k] += step * h
            atoms.positions = moved
            row = row - weight / h * atoms.get_forces().ravel()
        out.append(row)
    atoms.positions = x
    return np.array(out)


def compare(atoms, tolerance=1e-8, h=1e-3, **options):
    got, want = atoms.calc.get_hessian(atoms, **options).toarray(), differences(atoms, h)
    scale = np.abs(want).max()
    assert scale > 0.0
    assert np.abs(got - want).max() < tolerance * scale
    assert np.abs(got - got.T).max() < 1e-14 * scale
    assert np.abs(got.reshape(len(got), -1, 3).sum(axis=1)).max() < 1e-13 * scale
    return got


def items_of(style, seed=3):
    """Twelve items of a bonded style as atoms."""
    x = styles.sample(style, seed).x.T
    k, c = ATOMS[style.category], style.category
    atoms = asemd.Atoms("H" * len(x), positions=x, cell=[styles.BOX] * 3, pbc=True)
    atoms.topology = Topology(**{f"{c}s": np.arange(len(x)).reshape(-1, k), f"{c}_types": np.ones(len(x) // k, int)})
    words = style.example.split()
    if style.weight_14 or hasattr(style, "repulsion"):      # no pairs of the ends
        words[-1] = "0.0"
    atoms.calc = asemd.ForceField(**{c: {f"{style.name} {style.settings_example}".strip(): {1: " ".join(words)}}})
    return atoms


def test_all_scalar_styles_but_tables_have_second_derivatives():
    scalar = {(c, n) for c in ATOMS for n in registry.names(c) if (s := registry.find(c, n)).function and not s.history}
    without = {(c, n) for c, n in scalar - set(CURVED) if not {"ax", "gamma"} & set(registry.find(c, n).coordinates)}
    assert without == {("bond", "table"), ("angle", "table"), ("dihedral", "table"), ("dihedral", "table/cut")}


@pytest.mark.parametrize(("category", "name"), CURVED)
def test_bonded_styles(category, name):
    compare(items_of(registry.find(category, name)), 2e-8, 2e-4 if "restricted" in name else 1e-3)     # steep where they diverge


@pytest.mark.parametrize(("category", "name"), [("angle", "charmm"), ("dihedral", "opls"), ("improper", "umbrella")])
def test_numerical(category, name):
    style = registry.find(category, name)
    if style.d2 is None:
        with pytest.raises(InputError, match=f"no second derivatives of {category} style {name}"):
            items_of(style).calc.get_hessian(items_of(style))
        compare(items_of(style), 1e-7, numerical=True)
    else:      # differences of first derivatives by the coordinates against the exact ones
        atoms, d2 = items_of(style), style.d2
        exact = atoms.calc.get_hessian(atoms).toarray()
        style.d2 = None
        try:
            rough = atoms.calc.get_hessian(atoms, numerical=True).toarray()
        finally:
            style.d2 = d2
        assert np.abs(rough - exact).max() < 1e-10 * np.abs(exact).max()


PAIRS = {
    "lj/cut 4.0": "0.01 2.0", "coul/cut 5.0": "", "lj/cut/coul/cut 4.0 6.0": "0.01 2.0", "morse 5.0": "0.3 1.2 2.0",
    "lj96/cut 4.0": "0.01 2.0", "lepton 4.0": "e*((s/r)^9-exp(-r/s));e=0.01;s=2", "lj/charmm/coul/charmm 2.5 4.0 3.0 5.0": "0.01 2.0",
}


@pytest.mark.parametrize("pair", PAIRS)
def test_pair_styles(pair):
    """A skewed cell with bonded partners at a weight; some pairs are neighbours of their own images."""
    rng = np.random.default_rng(5)
    grid = np.stack(np.meshgrid(*[np.arange(2)] * 3, indexing="ij"), -1).reshape(-1, 3)
    cell = np.array([[4.6, 0.0, 0.0], [0.7, 4.5, 0.0], [-0.4, 0.9, 4.8]])
    atoms = asemd.Atoms("He8", positions=(grid / 2) @ cell + rng.normal(0, 0.1, (8, 3)), cell=cell, pbc=True)
    atoms.set_initial_charges(rng.normal(0, 0.3, 8))
    atoms.topology = Topology(bonds=np.array([[0, 1], [1, 3]]), bond_types=np.array([1, 1]))
    atoms.calc = asemd.ForceField(bond={"harmonic": {1: (2.0, 2.2)}}, pair={pair: {("He", "He"): PAIRS[pair]}},
                                  special_bonds={"lj": (0, 0.3, 0.5), "coul": (0, 0.2, 0.8)})
    compare(atoms)


@pytest.mark.parametrize("style", ["lj/cut/sphere 2.2", "lj/expand/sphere 8.0"])
def test_pairs_of_spheres(style):
    """Whose sizes are those of atoms: by differences, across faces too."""
    rng = np.random.default_rng(3)
    atoms = bulk("Ar", a=5.4, cubic=True) * (2, 1, 1)
    atoms.rattle(0.05, seed=3)
    atoms.set_array("radius", rng.uniform(1.5, 1.7, 8))
    words = "0.01 0.4" if "expand" in style else "0.01"
    atoms.calc = asemd.ForceField(commands=[f"pair_style {style}", f"pair_coeff 1 1 {words}"], units="metal", types=["Ar"])
    with pytest.raises(InputError, match="numerical=True takes differences"):
        atoms.calc.get_hessian(atoms)
    got, want = atoms.calc.get_hessian(atoms, numerical=True).toarray(), differences(atoms)
    assert np.abs(got - want).max() < 1e-7 * np.abs(want).max()


@pytest.mark.parametrize("style", ["lj/cut 6.0", "nm/cut 6.0"])
def test_elastic_constants_with_a_tail_correction(style):
    """As the slopes of the stress, which has the correction too; it also resists shear where the crystal is under pressure."""
    atoms = bulk("Ar", a=5.0, cubic=True) * 2
    words = "0.01 3.4" if style.startswith("lj") else "0.01 3.8 12 6"

    def stress(calc, k, h):
        strain = np.zeros(6)
        strain[k] = h
        x, y, z, a, b, c = strain
        values, vectors = np.linalg.eigh(np.eye(3) + np.array([[2 * x, c, b], [c, 2 * y, a], [b, a, 2 * z]]))
        stretch = vectors * np.sqrt(values) @ vectors.T
        moved = atoms.copy()
        moved.set_cell(atoms.cell.array @ stretch, scale_atoms=True)
        moved.calc, back = calc, np.linalg.inv(stretch)
        second = np.linalg.det(stretch) * back @ moved.get_stress(voigt=False) @ back      # Piola and Kirchhoff's
        return second[[0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]]
    found = []
    for tail in ("no", "yes"):
        calc = asemd.ForceField(commands=[f"pair_style {style}", f"pair_coeff 1 1 {words}", f"pair_modify tail {tail}"], units="metal",
                                types=["Ar"])
        found.append(calc.get_elastic_constants(atoms, relaxed=False))
        slopes = np.array([stress(calc, k, 1e-4) - stress(calc, k, -1e-4) for k in range(6)]) / 2e-4
        assert np.abs(found[-1] - slopes).max() < 1e-6 * np.abs(slopes).max()
    assert np.abs(found[1] - found[0]).max() > 5e-3 * np.abs(found[0]).max()


def test_pairs_of_dihedrals():
    """The weighted 1-4 pairs of dihedral style charmm belong to the matrix."""
    x = np.array([[0.0, 0.9, 0.2], [0.0, 0.0, 0.0], [1.4, 0.0, 0.0], [1.8, 0.7, 1.0]])
    atoms = asemd.Atoms("C4", positions=x)
    atoms.set_initial_charges([0.3, -0.1, 0.1, -0.3])
    atoms.topology = Topology(bonds=np.array([[0, 1], [1, 2], [2, 3]]), bond_types=np.array([1, 1, 1]),
                              dihedrals=np.array([[0, 1, 2, 3]]), dihedral_types=np.array([1]))
    atoms.calc = asemd.ForceField(dihedral={"charmm": {1: (0.1, 3, 180, 0.5)}}, special_bonds="charmm",
                                  pair={"lj/charmm/coul/charmm 8.0 10.0": {("C", "C"): (0.01, 2.0)}})
    weighted = compare(atoms)
    atoms.calc = asemd.ForceField(dihedral={"charmm": {1: (0.1, 3, 180, 0.0)}})
    assert np.abs(weighted[:3, 9:] - atoms.calc.get_hessian(atoms).toarray()[:3, 9:]).max() > 1e-3


def test_many_atoms_use_the_same_pairs_as_few():
    """A cell of more than a thousand atoms, where forces come from the list of clusters."""
    from ase.build import bulk
    atoms = bulk("Ar", cubic=True) * (7, 7, 7)
    atoms.rattle(0.05, seed=1)
    atoms.calc = asemd.ForceField(pair={"lj/cut 8.0": {("Ar", "Ar"): (0.0104, 3.4)}})
    matrix = atoms.calc.get_hessian(atoms)
    shift = np.random.default_rng(2).normal(size=(len(atoms), 3))
    forces, x = [], atoms.positions.copy()
    for h in (1e-4, -1e-4):
        atoms.positions = x + h * shift
        forces.append(atoms.get_forces().ravel())
    want = -(forces[0] - forces[1]) / 2e-4
    assert matrix @ shift.ravel() == pytest.approx(want, abs=1e-6 * np.abs(want).max())
    assert matrix.nnz < matrix.shape[0] * 3 * 250


def straight(theta0=180.0, style="harmonic", bend=0.0):
    t = np.pi - bend
    atoms = asemd.Atoms("OCO", positions=np.array([[1.16, 0, 0], [0, 0, 0], [1.16 * np.cos(t), 1.16 * np.sin(t), 0]]) + 5.0)
    atoms.topology = Topology(bonds=np.array([[0, 1], [1, 2]]), bond_types=np.array([1, 1]), angles=np.array([[0, 1, 2]]),
                              angle_types=np.array([1]))
    atoms.calc = asemd.ForceField(bond={"harmonic": {1: (40.0, 1.16)}},
                                  angle={style: {1: (2.0, theta0) if style == "harmonic" else (2.0,)}})
    return atoms


@pytest.mark.parametrize("style", ["harmonic", "cosine"])
def test_straight_angle(style):
    """Both bends of a straight molecule have the same frequency; near the line the matrix is as smooth as on it."""
    atoms = straight(style=style)
    matrix = compare(atoms, 1e-6)
    values = np.sort(np.linalg.eigvalsh(matrix))
    assert np.abs(values[:5]).max() < 1e-9 and values[5] == pytest.approx(values[6], rel=1e-12)
    for bend in (1e-9, 1e-7, 3e-6, 1e-4):
        near = straight(style=style, bend=bend)
        assert np.abs(near.calc.get_hessian(near).toarray() - matrix).max() < 200.0 * bend + 1e-8


def test_straight_angle_with_a_force_is_reported():
    atoms = straight(theta0=150.0)
    with pytest.raises(SimulationError, match="angle of type 1 between atoms 1 2 3"):
        atoms.calc.get_hessian(atoms)


def water():
    atoms = asemd.Atoms(molecule("H2O"))
    o, (h1, h2) = 0, (1, 2)
    atoms.topology = Topology(bonds=np.array([[o, h1], [o, h2]]), bond_types=np.array([1, 1]), angles=np.array([[h1, o, h2]]),
                              angle_types=np.array([1]))
    r = atoms.get_distance(o, h1)
    atoms.calc = asemd.ForceField(bond={"morse": {1: (4.0, 2.2, r)}}, angle={"harmonic": {1: (1.6, atoms.get_angle(h1, o, h2))}})
    return atoms


def test_vibrations(tmp_path):
    atoms = water()
    exact = VibrationsData.from_2d(atoms, atoms.calc.get_hessian(atoms).toarray())
    rough = Vibrations(atoms, name=str(tmp_path / "vib"), delta=1e-3, nfree=4)
    rough.run()
    assert exact.get_frequencies()[6:].real == pytest.approx(rough.get_frequencies()[6:].real, rel=1e-6)
    assert np.abs(exact.get_frequencies()[:6]).max() < 0.1      # 1/cm; rotations and translations
    assert np.linalg.norm(atoms.get_forces()) < 1e-9


def test_phonons(tmp_path):
    """Force constants of a crystal are blocks of the matrix of its supercell."""
    cell = ase.Atoms("Ar", cell=2.63 * (np.ones((3, 3)) - np.eye(3)), pbc=True)
    field = asemd.ForceField(pair={"lj/cut 6.0": {("Ar", "Ar"): (0.0104, 3.4)}})
    n = 3
    rough = Phonons(cell, field, supercell=(n, n, n), delta=1e-3, name=str(tmp_path / "ph"))
    rough.run()
    rough.read(symmetrize=0, acoustic=False)
    whole = cell.repeat((n, n, n))
    rows = field.copy().get_hessian(whole)[:3].toarray().reshape(3, n**3, 3).transpose(1, 0, 2)
    assert rows == pytest.approx(rough.get_force_constant(), abs=2e-6 * np.abs(rows).max())
    exact = Phonons(cell, field, supercell=(n, n, n), name=str(tmp_path / "exact"))
    exact.C_N, exact.D_N = rows, rows / cell.get_masses()[0]
    for q in ([0, 0, 0], [0.5, 0.5, 0], [0.25, 0, 0]):
        assert exact.band_structure([q])[0] == pytest.approx(rough.band_structure([q])[0], abs=1e-5)


def test_from_a_script_in_other_units(tmp_path):
    box = "".join(f"-9 9 {a}lo {a}hi\n" for a in "xyz")
    (tmp_path / "data").write_text(f"\n\n2 atoms\n1 bonds\n1 atom types\n1 bond types\n{box}\nMasses\n\n1 1.0\n\n"
                                   "Atoms\n\n1 1 1 0 0 0\n2 1 1 1.1 0 0\n\nBonds\n\n1 1 1 2\n")
    (tmp_path / "in.x").write_text(f"units real\natom_style molecular\nbond_style harmonic\nread_data {tmp_path / 'data'}\n"
                                   "bond_coeff 1 300 1.1\n")
    atoms = asemd.read(tmp_path / "in.x")
    kcal = asemd.units.factor("energy", "real")
    assert atoms.calc.get_hessian(atoms)[0, 0] == pytest.approx(600.0 * kcal, rel=1e-12)
