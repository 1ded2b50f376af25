"""MSD, RDF and Green-Kubo integrals of asemd's computes are those of MDAnalysis and numpy on the dump of the same run.

MDAnalysis keeps positions in single precision: it agrees to that; numpy on the numbers of the dump to round-off.
"""
from __future__ import annotations

import numpy as np
import pytest
from wheel import ran

N, FRAMES, STRIDE, BINS, CUT = 256, 40, 10, 50, 2.5
SCRIPT = """
units lj
atom_style atomic
lattice fcc 0.8
region box block 0 4 0 4 0 4
create_box 2 box
create_atoms 1 box
set group all type/fraction 2 0.4 771
mass 1 1.0
mass 2 2.0
pair_style lj/cut 2.5
pair_coeff * * 1.0 1.0
neighbor 0.3 bin
velocity all create 1.8 4391
velocity all set 0.2 NULL NULL sum yes
fix move all nve
run 200
reset_timestep 0
compute msd all msd
compute nodrift all msd com yes
compute vacf all vacf
compute rdf all rdf {bins} * * 1 2
dump trajectory all custom {stride} {folder}/run.dump id type xu yu zu vx vy vz
dump_modify trajectory sort id format float %.17g
dump wrapped all custom {stride} {folder}/wrapped.dump id type x y z
dump_modify wrapped sort id format float %.17g
variable xy equal pxy
variable yz equal pyz
fix moved all vector {stride} c_msd[1] c_msd[2] c_msd[3] c_msd[4] c_nodrift[4] c_vacf[1] c_vacf[4] v_xy v_yz
variable diffusion equal {stride}*dt*trap(f_moved[7])/3
fix pairs all ave/time {stride} {samples} {last} c_rdf[*] mode vector
fix correlate all ave/correlate {stride} 12 {last} v_xy v_yz type full
thermo_style custom step temp v_xy v_yz f_moved[1][7]
run {last}
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """What asemd computed, and the dump read as plain numbers: (frames, atoms, columns)."""
    pytest.importorskip("MDAnalysis")
    folder, last = tmp_path_factory.mktemp("observables"), (FRAMES - 1) * STRIDE
    text = SCRIPT.format(folder=folder, bins=BINS, stride=STRIDE, last=last, samples=FRAMES - 1)
    with ran(text) as lmp:
        series = np.array([[lmp.extract_fix("moved", 0, 2, i, j) for j in range(9)] for i in range(FRAMES)])
        pairs = np.array([[lmp.extract_fix("pairs", 0, 2, i, j) for j in range(5)] for i in range(BINS)])
        correlation = np.array([[lmp.extract_fix("correlate", 0, 2, i, j) for j in range(6)] for i in range(12)])
        diffusion, (lo, hi) = lmp.extract_variable("diffusion"), lmp.extract_box()[:2]
    lines = (folder / "run.dump").read_text().splitlines()
    rows = np.array([line.split() for line in lines if len(line.split()) == 8 and not line.startswith("ITEM")], float)
    return {"folder": folder, "series": series, "pairs": pairs, "correlation": correlation, "diffusion": diffusion, "edge": hi[0] - lo[0],
            "rows": rows.reshape(FRAMES, N, 8)}


@pytest.fixture(scope="module")
def universe(run):
    import MDAnalysis
    u = MDAnalysis.Universe(str(run["folder"] / "run.dump"), topology_format="LAMMPSDUMP", format="LAMMPSDUMP",
                            lammps_coordinate_convention="unwrapped", convert_units=False)
    u.add_TopologyAttr("masses", run["rows"][0, :, 1])
    return u


def test_msd_of_numpy(run):
    x, mass = run["rows"][:, :, 2:5], run["rows"][0, :, 1]
    squares = ((x - x[0]) ** 2).mean(axis=1)
    assert np.allclose(run["series"][:, :3], squares, rtol=1e-12, atol=1e-14)
    assert np.allclose(run["series"][:, 3], squares.sum(axis=1), rtol=1e-12, atol=1e-14)
    own = x - (mass @ x / mass.sum())[:, None]
    assert np.allclose(run["series"][:, 4], ((own - own[0]) ** 2).sum(axis=2).mean(axis=1), rtol=1e-11, atol=1e-14)


@pytest.mark.parametrize("last", [1, 7, FRAMES - 1])
def test_msd_of_mdanalysis(run, universe, last):
    """EinsteinMSD averages over origins; the longest lag has one origin, the first frame, as compute msd."""
    from MDAnalysis.analysis.msd import EinsteinMSD
    for kind, column in (("xyz", 3), ("x", 0), ("z", 2)):
        theirs = EinsteinMSD(universe, select="all", msd_type=kind, fft=False).run(stop=last + 1).results.timeseries
        assert theirs[-1] == pytest.approx(run["series"][last, column], rel=1e-5)


def test_rdf_of_mdanalysis(run):
    """The same pairs in the same bins, but for those within single precision of an edge; both divide by N (N - 1) for equal atoms."""
    import MDAnalysis
    from MDAnalysis.analysis.rdf import InterRDF
    u = MDAnalysis.Universe(str(run["folder"] / "wrapped.dump"), topology_format="LAMMPSDUMP", format="LAMMPSDUMP", convert_units=False)
    ones, twos = u.select_atoms("type 1"), u.select_atoms("type 2")
    shells = 4 / 3 * np.pi * np.diff(np.linspace(0, CUT, BINS + 1) ** 3)
    for a, b, block, column in ((u.atoms, u.atoms, (1, 1), 1), (ones, twos, None, 3)):
        rdf = InterRDF(a, b, nbins=BINS, range=(0.0, CUT), exclusion_block=block).run(start=1)
        pairs = N * (N - 1) if block else len(ones) * len(twos)
        one = run["edge"] ** 3 / (pairs * shells * (FRAMES - 1))         # g(r) of a single pair in a single frame
        off = (run["pairs"][:, column] - rdf.results.rdf) / one
        assert abs(off).max() <= 6 and abs(off).sum() <= 20, off
        assert np.allclose(run["pairs"][:, 0], rdf.results.bins, rtol=1e-9)


def test_rdf_of_numpy(run):
    """Counts in double precision are equal; the columns after g(r) are coordination numbers."""
    x, types, edge = run["rows"][1:, :, 2:5], run["rows"][0, :, 1], run["edge"]
    counts, ones = np.zeros(BINS), types == 1
    cross = np.zeros(BINS)
    for frame in x:
        d = frame[:, None] - frame[None]
        d -= edge * np.rint(d / edge)
        r = np.sqrt((d * d).sum(axis=2))
        counts += np.histogram(r[~np.eye(N, dtype=bool)], BINS, (0, CUT))[0]
        cross += np.histogram(r[ones][:, ~ones], BINS, (0, CUT))[0]
    shells, frames = 4 / 3 * np.pi * np.diff(np.linspace(0, CUT, BINS + 1) ** 3), FRAMES - 1
    for total, first, second, column in ((counts, N, N - 1, 1), (cross, ones.sum(), (~ones).sum(), 3)):
        g = total * edge**3 / (first * second * shells * frames)
        assert np.allclose(run["pairs"][:, column], g, rtol=1e-9, atol=1e-12)
        assert np.allclose(run["pairs"][:, column + 1], total.cumsum() / (first * frames), rtol=1e-9)


def test_velocities_and_their_integral(run, universe):
    """The velocity autocorrelation and its Green-Kubo integral, from the velocities that MDAnalysis reads and from those of the dump."""
    v = run["rows"][:, :, 5:8]
    ours = run["series"][:, 6]
    theirs = np.array([(ts.velocities.astype(float) * v[0]).sum(axis=1).mean() for ts in universe.trajectory])
    exact = (v * v[0]).sum(axis=2).mean(axis=1)
    assert np.allclose(ours, exact, rtol=1e-11, atol=1e-12) and np.allclose(ours, theirs, rtol=1e-5, atol=1e-5)
    assert np.allclose(run["series"][:, 5], (v * v[0]).mean(axis=1)[:, 0], rtol=1e-11, atol=1e-12)
    assert run["diffusion"] == pytest.approx(np.trapezoid(exact, dx=STRIDE * 0.005) / 3, rel=1e-11)


def test_correlation_of_the_stress(run):
    """fix ave/correlate against all pairs of the same series."""
    series = run["series"][:, 7:9]
    for k, row in enumerate(run["correlation"]):
        assert row[0] == k * STRIDE and row[1] == FRAMES - k
        expected = [(series[:FRAMES - k, i] * series[k:, j]).mean() for i in range(2) for j in range(2)]
        assert row[2:] == pytest.approx(expected, rel=1e-10, abs=1e-13)
