"""The calculator under ASE's own tools: constraints, filters, paths, vibrations, global searches, each against a known answer."""
from __future__ import annotations

import ase.units as units
import numpy as np
import pytest
from ase import Atoms as PlainAtoms
from ase.build import bulk, make_supercell
from ase.calculators.calculator import Calculator
from ase.constraints import FixAtoms, FixBondLengths, FixCom, FixSymmetry, Hookean
from ase.eos import EquationOfState
from ase.filters import FrechetCellFilter, StrainFilter
from ase.md.verlet import VelocityVerlet
from ase.mep import NEB
from ase.optimize import BFGS, FIRE
from ase.optimize.basin import BasinHopping
from ase.phonons import Phonons
from ase.vibrations import Vibrations
from scipy.optimize import minimize_scalar

from asemd import Atoms, ForceField, MolecularDynamics, Symmetry, Topology
from asemd.fix import NVE

EPSILON, SIGMA, CUT = 0.0104, 3.4, 8.0       # argon; no shell of neighbours is near the cutoff
HBAR = units._hbar * 1e10 / np.sqrt(units._e * units._amu)      # eV, of a frequency in sqrt(eV/amu)/Angstrom
CLUSTERS = {7: -16.505384, 13: -44.326801}   # D. J. Wales, J. P. K. Doye, J. Phys. Chem. A 101, 5111 (1997)


def argon(**options) -> ForceField:
    return ForceField(pair={f"lj/cut {CUT}": {("Ar", "Ar"): (EPSILON, SIGMA)}}, **options)


def cluster(positions) -> PlainAtoms:
    """Atoms whose unit of energy and of length are those of Lennard-Jones, without an end to their reach."""
    atoms = PlainAtoms(f"Ar{len(positions)}", positions=positions)
    atoms.calc = ForceField(pair={"lj/cut 50.0": {("Ar", "Ar"): (1.0, 1.0)}})
    return atoms


def lattice(a: float, n: int = 4) -> np.ndarray:
    """Vectors from one atom of an fcc crystal to the others within the cutoff."""
    points = np.stack(np.meshgrid(*[np.arange(-2 * n, 2 * n + 1)] * 3), -1).reshape(-1, 3)
    points = points[(points.sum(axis=1) % 2 == 0) & points.any(axis=1)] * a / 2
    return points[np.linalg.norm(points, axis=1) < CUT]


def slopes(r: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Energy of Lennard-Jones and its first two derivatives."""
    s = (SIGMA / r) ** 6
    return 4 * EPSILON * (s * s - s), 4 * EPSILON * (6 * s - 12 * s * s) / r, 4 * EPSILON * (156 * s * s - 42 * s) / r**2


def per_atom(a: float) -> float:
    return slopes(np.linalg.norm(lattice(a), axis=1))[0].sum() / 2


@pytest.fixture(scope="module")
def crystal() -> dict:
    """Sums over the lattice: lattice constant, energy, bulk modulus, C11, C12 = C44."""
    a = minimize_scalar(per_atom, bounds=(5.1, 5.4), method="bounded", options={"xatol": 1e-12}).x
    r = lattice(a)
    d = np.linalg.norm(r, axis=1)
    energy, first, second = slopes(d)
    stiff = (second - first / d) / d**2 / 2 / (a**3 / 4)
    return {"a": a, "energy": energy.sum() / 2, "C11": (stiff * r[:, 0] ** 4).sum(),
            "C12": (stiff * r[:, 0] ** 2 * r[:, 1] ** 2).sum()}


# ---- constraints ------------------------------------------------------------------------------------------------------------------------

def water(n: int) -> Atoms:
    """Rigid water without charges: springs of a real molecule, held by constraints."""
    one = Atoms("OHH", positions=[[0, 0, 0], [0.9572, 0, 0], [-0.24, 0.9266, 0]], cell=[3.4] * 3, pbc=True,
                topology=Topology(bonds=[[0, 1], [0, 2]], angles=[[1, 0, 2]]))
    atoms = one * (n, n, n)
    atoms.set_array("mol-id", np.arange(len(atoms)) // 3 + 1)
    atoms.calc = ForceField(bond={"harmonic": {1: (19.5, 0.9572)}}, angle={"harmonic": {1: (2.39, 104.52)}},
                            pair={"lj/cut 4.0": {("O", "O"): (0.0066, 3.15), ("H", "H"): (0.0, 1.0)}}, mix="arithmetic")
    atoms.set_velocities(np.random.default_rng(1).normal(0, 0.02, (len(atoms), 3)))
    return atoms


def test_rigid_water_by_rattle_of_ase_and_by_fix_rattle():
    """ASE's constraint and the fix hold the same lengths on the same way."""
    from asemd.fix import Rattle
    theirs, ours = water(2), water(2)
    o = np.arange(0, len(ours), 3)
    pairs = np.concatenate([np.stack([o, o + 1], 1), np.stack([o, o + 2], 1), np.stack([o + 1, o + 2], 1)])
    angle = 2 * 0.9572 * np.sin(np.radians(104.52) / 2)
    lengths = np.repeat([0.9572, 0.9572, angle], len(o))
    theirs.set_constraint(FixBondLengths(pairs, bondlengths=lengths, tolerance=1e-12))
    theirs.set_positions(theirs.positions)
    theirs.set_velocities(theirs.get_velocities())          # without the parts along the bonds
    ours.positions[:], dt = theirs.positions, 1.0 * units.fs
    ours.set_velocities(theirs.get_velocities())
    md = MolecularDynamics(ours, dt, fixes=[NVE(), Rattle(tolerance=1e-12, iterations=500, bonds=[1], angles=[1])])
    VelocityVerlet(theirs, dt).run(20)
    md.run(20)
    d = [ours.get_distance(i, j) for i, j in pairs]
    assert np.allclose(d, lengths, atol=1e-9)
    assert abs(theirs.positions - ours.positions).max() < 1e-8
    assert np.allclose(theirs.get_velocities(), ours.get_velocities(), atol=1e-8)


def test_atoms_held_by_ase_and_by_our_loop(crystal):
    """FixAtoms under ASE's dynamics and under ours: the same way; what is held stays to the last bit."""
    start = bulk("Ar", a=crystal["a"], cubic=True) * 3
    start.rattle(0.05, seed=2)
    start.set_constraint(FixAtoms(range(20)))
    theirs, ours = start.copy(), start.copy()
    theirs.calc, ours.calc = argon(), argon()
    VelocityVerlet(theirs, 4 * units.fs).run(20)
    MolecularDynamics(ours, 4 * units.fs).run(20)
    assert np.array_equal(theirs.positions[:20], start.positions[:20]) and np.array_equal(ours.positions[:20], start.positions[:20])
    assert abs(theirs.positions - start.positions).max() > 0.01
    assert abs(theirs.positions - ours.positions).max() < 1e-11


def test_centre_of_mass_that_is_held():
    """FixCom takes the net force off: in a field of gravity two atoms find their distance, and their middle stays."""
    class Falling(Calculator):
        implemented_properties = ["energy", "forces"]

        def calculate(self, atoms=None, properties=("energy",), system_changes=()):
            super().calculate(atoms, properties, system_changes)
            inner = ForceField(pair={"lj/cut 50.0": {("Ar", "Ar"): (1.0, 1.0)}})
            self.results = {"energy": inner.get_potential_energy(atoms) + 0.3 * atoms.positions[:, 2].sum(),
                            "forces": inner.get_forces(atoms) - [0, 0, 0.3]}
    atoms = PlainAtoms("Ar2", [[0, 0, 0], [0, 0.3, 1.2]])
    middle, atoms.calc = atoms.get_center_of_mass(), Falling()
    assert abs(atoms.get_forces().sum(axis=0)[2] + 0.6) < 1e-12
    atoms.set_constraint(FixCom())
    assert BFGS(atoms, logfile=None).run(fmax=1e-6, steps=100)
    assert np.allclose(atoms.get_center_of_mass(), middle, atol=1e-12)
    assert atoms.get_distance(0, 1) == pytest.approx(2 ** (1 / 6), abs=1e-6)


def test_hookean_equals_a_bond_of_ours():
    """Below its threshold the spring of ASE does nothing, beyond it is ours: k (r - r0)^2 / 2."""
    atoms = Atoms("Ar2", [[0, 0, 0], [0.4, 0.9, 1.3]], topology=Topology(bonds=[[0, 1]]))
    bare = ForceField(pair={"lj/cut 50.0": {("Ar", "Ar"): (1.0, 1.0)}}, special_bonds=(1, 1, 1))
    spring = ForceField(pair={"lj/cut 50.0": {("Ar", "Ar"): (1.0, 1.0)}}, bond={"harmonic": {1: (2.5, 1.2)}}, special_bonds=(1, 1, 1))
    atoms.calc = spring
    energy, forces = atoms.get_potential_energy(), atoms.get_forces()
    atoms.calc = bare
    atoms.set_constraint(Hookean(0, 1, k=5.0, rt=1.2))
    assert atoms.get_potential_energy() == pytest.approx(energy, rel=1e-13)
    assert np.allclose(atoms.get_forces(), forces, atol=1e-13)
    assert abs(atoms.get_forces() - bare.get_forces(atoms)).max() > 1.0
    atoms.set_constraint(Hookean(0, 1, k=5.0, rt=2.0))
    assert np.array_equal(atoms.get_forces(), bare.get_forces(atoms))


def test_symmetry_that_is_held(crystal):
    """A tetragonal start under FixSymmetry keeps its group while the cell relaxes to the cubic crystal; a shear is not let in."""
    pytest.importorskip("spglib")
    atoms = bulk("Ar", a=5.3, cubic=True)
    atoms.set_cell(atoms.cell[:] @ np.diag([1, 1, 1.03]), scale_atoms=True)
    atoms.calc = argon()
    number = Symmetry(atoms).number
    assert number == 139                                     # I4/mmm
    atoms.set_constraint(FixSymmetry(atoms))
    assert BFGS(FrechetCellFilter(atoms), logfile=None).run(fmax=1e-6, steps=100)
    assert np.allclose(atoms.cell.angles(), 90.0, atol=1e-9)
    assert np.allclose(atoms.cell.lengths(), crystal["a"], atol=2e-4)
    assert atoms.get_potential_energy() / 4 == pytest.approx(crystal["energy"], abs=1e-8)


# ---- crystals ---------------------------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("cell", ["primitive", "sheared"])
def test_lattice_constant(crystal, cell):
    """The cell relaxes to the lattice constant and energy of the sums over the lattice, also from a sheared start."""
    atoms = bulk("Ar", a=5.5)
    if cell == "sheared":
        atoms = make_supercell(bulk("Ar", a=5.2, cubic=True), [[1, 0, 0], [1, 1, 0], [0, 0, 1]])
        atoms.set_cell(atoms.cell[:] @ (np.eye(3) + [[0, 0.02, 0], [0, 0, 0.01], [0, 0, 0.02]]), scale_atoms=True)
    atoms.calc = argon()
    assert BFGS(FrechetCellFilter(atoms), logfile=None).run(fmax=1e-6, steps=200)
    assert (4 * atoms.get_volume() / len(atoms)) ** (1 / 3) == pytest.approx(crystal["a"], abs=2e-5)
    assert atoms.get_potential_energy() / len(atoms) == pytest.approx(crystal["energy"], abs=1e-9)
    assert abs(atoms.get_stress()).max() < 1e-6


def test_strain_filter_and_equation_of_state(crystal):
    """The bulk modulus of E(V), of the sums over the lattice and of our elastic constants are the same."""
    atoms = bulk("Ar", a=5.4)
    atoms.calc = argon()
    assert FIRE(StrainFilter(atoms), logfile=None).run(fmax=1e-6, steps=500)
    assert atoms.get_volume() == pytest.approx(crystal["a"] ** 3 / 4, rel=1e-5)
    volumes, energies = [], []
    for x in np.linspace(0.99, 1.01, 7):
        atoms.set_cell(bulk("Ar", a=crystal["a"] * x).cell, scale_atoms=True)
        volumes.append(atoms.get_volume())
        energies.append(atoms.get_potential_energy())
    v, e, modulus = EquationOfState(volumes, energies, eos="birchmurnaghan").fit()
    assert v == pytest.approx(crystal["a"] ** 3 / 4, rel=1e-4) and e == pytest.approx(crystal["energy"], abs=2e-6)
    assert modulus == pytest.approx((crystal["C11"] + 2 * crystal["C12"]) / 3, rel=5e-3)


def test_elastic_constants(crystal):
    """Strained by hand, ASE's stress has the slopes that lattice sums have; Cauchy's relation C12 = C44 holds for pair forces."""
    atoms = bulk("Ar", a=crystal["a"])
    atoms.calc = argon()
    columns = []
    for k in (0, 3):
        stress = []
        for h in (1e-4, -1e-4):
            strain = np.zeros(6)
            strain[k] = h
            x, y, z, a, b, c = strain
            turned = atoms.copy()
            turned.set_cell(atoms.cell[:] @ (np.eye(3) + [[x, c / 2, b / 2], [c / 2, y, a / 2], [b / 2, a / 2, z]]), scale_atoms=True)
            turned.calc = atoms.calc
            stress.append(turned.get_stress())
        columns.append((stress[0] - stress[1]) / 2e-4)
    assert columns[0][0] == pytest.approx(crystal["C11"], rel=1e-5)
    assert columns[0][1] == pytest.approx(crystal["C12"], rel=1e-5) and columns[1][3] == pytest.approx(crystal["C12"], rel=1e-5)
    assert abs(columns[0][3:]).max() < 1e-9


def test_phonons(crystal, tmp_path):
    """Frequencies at X and between: the dynamical matrix summed over the lattice; sound at the centre is silent."""
    cell = bulk("Ar", a=crystal["a"])
    phonons = Phonons(cell, argon(), supercell=(6, 6, 6), delta=1e-3, name=str(tmp_path / "phonon"))
    phonons.run()
    phonons.read(acoustic=True, symmetrize=3)
    r = lattice(crystal["a"])
    d = np.linalg.norm(r, axis=1)
    _, first, second = slopes(d)
    u = r / d[:, None]
    tensors = (second - first / d)[:, None, None] * u[:, :, None] * u[:, None, :] + (first / d)[:, None, None] * np.eye(3)
    for path in ([0.5, 0.5, 0.0], [0.5, 0.5, 0.5], [1 / 3, 1 / 6, 0]):
        k = np.asarray(path) @ cell.cell.reciprocal()[:]
        matrix = (tensors * (1 - np.cos(2 * np.pi * r @ k))[:, None, None]).sum(axis=0) / cell.get_masses()[0]
        expected = np.sqrt(np.linalg.eigvalsh(matrix)) * HBAR
        assert np.allclose(np.sort(phonons.band_structure([path])[0]), expected, rtol=2e-4)
    assert abs(phonons.band_structure([[0, 0, 0]])).max() < 1e-6


def test_vibrations(tmp_path):
    """A harmonic molecule of two: omega = sqrt(2 K / mu), with the curvature of Lennard-Jones in its minimum too."""
    atoms = Atoms("CO", [[0, 0, 0], [0, 0, 1.128]], topology=Topology(bonds=[[0, 1]]))
    atoms.calc = ForceField(bond={"harmonic": {1: (59.3, 1.128)}})
    found = Vibrations(atoms, name=str(tmp_path / "co"), delta=1e-3)
    found.run()
    mu = 1 / (1 / atoms.get_masses()).sum()
    assert found.get_energies()[-1].real == pytest.approx(np.sqrt(2 * 59.3 / mu) * HBAR, rel=1e-6)
    assert abs(found.get_energies()[:5]).max() < 1e-3
    pair = cluster([[0, 0, 0], [2 ** (1 / 6), 0, 0]])
    found = Vibrations(pair, name=str(tmp_path / "ar"), delta=1e-4)
    found.run()
    curvature, mu = 72 / 2 ** (1 / 3), pair.get_masses()[0] / 2
    assert found.get_energies()[-1].real == pytest.approx(np.sqrt(curvature / mu) * HBAR, rel=1e-5)


# ---- paths and searches -----------------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("together", [True, False])
def test_barrier_between_two_posts(together):
    """An atom goes between two that are held: by symmetry the saddle is the middle, and energies are sums of two terms."""
    half = 1.05
    away = np.sqrt(2 ** (1 / 3) - half**2)          # in a minimum it is at the best distance of both
    ends = [cluster([[0, half, 0], [0, -half, 0], [x, 0, 0]]) for x in (-away, away)]
    images = [ends[0], *(ends[0].copy() for _ in range(3)), ends[1]]
    calculator = ends[0].calc
    for image in images:
        image.calc = calculator if together else calculator.copy()
        image.set_constraint(FixAtoms([0, 1]))
    path = NEB(images, climb=True, method="improvedtangent", allow_shared_calculator=together)
    path.interpolate()
    for image in images[1:-1]:
        image.positions[2, 1] += 0.05                       # off the axis, so that there is something to relax
    assert BFGS(path, logfile=None, maxstep=0.1).run(fmax=1e-3, steps=300)
    energies = [image.get_potential_energy() for image in images]
    post = slopes_lj(2 * half)
    assert energies[0] == pytest.approx(post - 2.0, abs=1e-12)
    assert max(energies) - energies[0] == pytest.approx(2 * slopes_lj(half) + 2.0, abs=1e-6)


def slopes_lj(r: float) -> float:
    return 4 * (r**-12 - r**-6)


def test_basin_hopping_finds_the_icosahedron(tmp_path, monkeypatch):
    """Thirteen atoms, the global minimum of Lennard-Jones."""
    rng = np.random.default_rng(3)
    atoms = cluster(rng.uniform(-1.6, 1.6, (13, 3)))
    FIRE(atoms, logfile=None, maxstep=0.05).run(fmax=0.5, steps=200)
    monkeypatch.chdir(tmp_path)
    np.random.seed(3)                   # ASE draws from it
    hopping = BasinHopping(atoms, temperature=0.8, dr=0.35, optimizer=BFGS, fmax=0.02, logfile=None, optimizer_logfile=None)
    hopping.run(30)
    energy, best = hopping.get_minimum()
    best.calc = atoms.calc
    BFGS(best, logfile=None).run(fmax=1e-6, steps=200)
    assert best.get_potential_energy() == pytest.approx(CLUSTERS[13], abs=1e-5)


def test_genetic_algorithm_finds_seven_atoms():
    """ASE's cut and splice with our energies finds the pentagonal bipyramid."""
    try:
        from ase_ga.cutandsplicepairing import CutAndSplicePairing
        from ase_ga.startgenerator import StartGenerator
    except ImportError:                 # a part of ASE before 3.29
        try:
            from ase.ga.cutandsplicepairing import CutAndSplicePairing
            from ase.ga.startgenerator import StartGenerator
        except ImportError:
            pytest.skip("ase-ga is not installed")
    rng = np.random.default_rng(5)
    limits, slab = {(18, 18): 0.7}, PlainAtoms(cell=[8.0] * 3)
    box = [np.full(3, 2.5), [[3.0, 0, 0], [0, 3.0, 0], [0, 0, 3.0]]]
    start = StartGenerator(slab, [18] * 7, limits, box_to_place_in=box, rng=rng)
    mate = CutAndSplicePairing(slab, 7, limits, rng=rng)
    calculator = cluster(np.zeros((0, 3))).calc

    def relaxed(atoms):
        atoms = PlainAtoms("Ar7", positions=atoms.positions, cell=slab.cell)
        atoms.calc = calculator
        FIRE(atoms, logfile=None, maxstep=0.1).run(fmax=1e-3, steps=300)
        return atoms.get_potential_energy(), atoms

    population = sorted((relaxed(start.get_new_candidate()) for _ in range(6)), key=lambda one: one[0])
    for _ in range(20):
        if population[0][0] < CLUSTERS[7] + 1e-3:
            break
        mother, father = rng.choice(len(population), 2, replace=False)
        child = mate.cross(population[mother][1], population[father][1])
        if child is not None:
            population = sorted([*population, relaxed(child)], key=lambda one: one[0])[:6]
    best = population[0][1]
    BFGS(best, logfile=None).run(fmax=1e-6, steps=200)
    assert best.get_potential_energy() == pytest.approx(CLUSTERS[7], abs=1e-6)
