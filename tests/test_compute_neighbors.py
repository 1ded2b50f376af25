"""Computes that look at the neighbours of atoms: LAMMPS's numbers in liquids, crystals, layers, tilted cells and molecules."""
from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from wheel import ask, ran

from asemd.errors import InputError

COMMON = """
atom_modify map array sort 0 0
lattice {lattice}
region box {box}
create_box 2 box
create_atoms 1 box
set group all type/fraction 2 0.4 123
mass * 1.0
displace_atoms all random 0.05 0.05 {z} 421
pair_style lj/cut 2.4
pair_coeff * * 1.0 1.0
pair_coeff 2 2 0.8 0.9 2.1
region half block 0 2 INF INF INF INF
group half region half
group a type 1
group b type 2
"""
GAS = """
units lj
atom_style full
atom_modify map array sort 0 0
region box block 0 9 0 9 0 9
create_box 2 box bond/types 1 extra/bond/per/atom 6 extra/special/per/atom 20
create_atoms 2 random 120 4321 box overlap 0.75 maxtry 500
set group all type/fraction 1 0.5 99
set type 1 charge 0.3
set type 2 charge -0.4
mass 1 1.0
mass 2 2.0
bond_style harmonic
bond_coeff 1 10.0 1.1
special_bonds lj 0 0.4 1 coul 0 0 1
pair_style lj/cut/coul/cut 2.0 2.5
pair_coeff 1 1 1.0 0.7
pair_coeff 2 2 0.5 0.6
pair_modify tail yes
create_bonds many all all 1 0.75 1.0
region half block 0 4.5 INF INF INF INF
group half region half
group a type 1
group b type 2
"""
SCENES = {
    "crystal": "units lj\natom_style sphere" + COMMON.format(lattice="fcc 1.0", box="block 0 4 0 4 0 4", z="0.05").replace(
        "mass * 1.0", "set type 1 diameter 1.05\nset type 2 diameter 1.1"),
    "layer": "units lj\ndimension 2\natom_style atomic" + COMMON.format(lattice="hex 0.9", box="block 0 8 0 5 -0.25 0.25", z="0.0"),
    "tilted": "units lj\natom_style atomic" + COMMON.format(lattice="bcc 1.1", box="prism 0 5 0 5 0 5 1.2 0.7 -1.1", z="0.05"),
    "molecules": GAS,
    "charges": GAS + "pair_style lj/cut/coul/long 2.0 2.5\npair_coeff 1 1 1.0 0.7\npair_coeff 2 2 0.5 0.6\npair_modify table 0\n"
               "kspace_style ewald 1e-4",
}
SOLVED = ("centroid", "half heat/flux")       # which LAMMPS does not have of long-range solvers
# words of the compute -> its values: G global array, V vector, S scalar, A or B per atom, L or M local, one or several columns
EVERYWHERE = {
    "all rdf 30 * * 1 2": "G", "half rdf 20 1*2 2": "G", "all rdf 25 1 1 cutoff 3.1": "G",
    "all adf 20": "G", "half adf 15 1 1 * 0.0 1.4 0.8 1.9 * 2 2 0 1.6 0 1.6 ordinate cosine": "G",
    "all adf 9 * * 2 0.9 1.4 0.0 1.9 ordinate radian": "G",
    "all coord/atom cutoff 2.0": "A", "half coord/atom cutoff 1.5 group b 1 2 *": "B",
    "all hexorder/atom": "B", "half hexorder/atom nnn 3 degree 5 cutoff 1.9": "B",
    "all orientorder/atom": "B", "half orientorder/atom nnn NULL degrees 2 4 6 wl yes wl/hat yes components 6 cutoff 1.5": "B",
    "all orientorder/atom nnn 5 degrees 2 1 3": "B",
    "all cna/atom 1.3": "A", "half cna/atom 1.5": "A",
    "all ackland/atom": "A", "all ackland/atom legacy yes": "A", "all centro/atom fcc": "A", "half centro/atom 6": "A",
    "a cluster/atom 1.0": "A", "half cluster/atom 0.9": "A",
}
EVERYWHERE |= {
    "all pair/local dist": "L", "half pair/local dist eng force": "M", "a group/group b": "S", "half group/group all": "V",
    "half group/group a": "S", "all centroid/stress/atom NULL": "B", "half stress/atom NULL virial": "B",
    "all heat/flux ke pe stress": "V", "half heat/flux ke pe centroid": "V",
}
HERE = {     # rdf 2 1: LAMMPS's coordination numbers of unlike types are wrong in two dimensions
    "crystal": {"all rdf 12 2 1": "G", "all contact/atom": "A", "half contact/atom b": "A", "all entropy/atom 0.15 2.0": "A",
                "all entropy/atom 0.2 1.5 avg yes 1.1 local yes": "A", "all pair lj/cut": "S", "all voronoi/atom": "B",
                "a voronoi/atom surface b edge_histo 7": "B",
                "all voronoi/atom radius v_r": "B", "a voronoi/atom only_group radius v_r surface b": "B",
                "all voronoi/atom radius v_r neighbors yes": "M", "all voronoi/atom neighbors yes face_threshold 0.1": "M",
                "all ti lj/cut 1 v_f v_g": "S", "all fep 500 pair lj/cut epsilon 1 * v_f": "V",
                "half fep 300 pair lj/cut sigma 2 2 v_s pair lj/cut epsilon 1 1 v_f pair lj/cut epsilon 1 1 v_s volume yes": "V",
                "all fep/ta 200 xy 1.01": "V", "half fep/ta 300 yz 0.98 tail no": "V"},
    "layer": {"all voronoi/atom edge_histo 7": "V", "all voronoi/atom radius v_r": "B"},
    "tilted": {"half voronoi/atom radius v_r": "B", "all voronoi/atom radius v_r edge_histo 7": "V",
               "half voronoi/atom edge_threshold 0.2 face_threshold 0.2 edge_histo 8": "V",
               "half voronoi/atom face_threshold 0.2": "B", "half entropy/atom 0.16 2.2 local yes": "A",
                "all fep/ta 300 xz 1.02": "V"},
    "molecules": {"all nbond/atom": "A", "half nbond/atom bond/type 1": "A", "all nbond/atom bond/type 2": "A",
                  "all fragment/atom": "A", "a fragment/atom": "A", "a fragment/atom single yes": "A", "half aggregate/atom 1.1": "A",
                  "all pair lj/cut/coul/cut ecoul": "S", "all pair lj/cut/coul/cut evdwl": "S", "a group/group b molecule inter": "V",
                  "half fep 900 atom charge 1 v_f atom charge * v_s": "V",
                  "all fep 900 atom charge 2 v_s pair lj/cut/coul/cut epsilon 1 * v_s volume yes tail yes": "V",
                  "all fep/ta 900 xy 1.01 tail yes": "V"},
}
THEIRS = """
answer = {}
for name, (lines, computes) in given["scenes"].items():
    lmp = ran(lines)
    n = lmp.extract_setting("nlocal")
    order = np.argsort(np.array(lmp.numpy.extract_atom("id"))[:n])
    answer[name] = {}
    for k, kind in computes.items():
        if kind in "AB":
            value = np.array(lmp.numpy.extract_compute(k, 1, 1 if kind == "A" else 2))[:n][order]
        elif kind in "LM":
            value = np.array(lmp.numpy.extract_compute(k, 2, 1 if kind == "L" else 2))
        else:
            value = np.array(lmp.numpy.extract_compute(k, 0, "SVG".index(kind)))
        answer[name][k] = value
    lmp.close()
"""


VALUES = {"S": "scalar", "V": "vector", "G": "array", "A": "per_atom", "B": "per_atom", "L": "local", "M": "local"}
HELPERS = ["variable f equal 0.7", "variable g equal 1.3", "variable s equal -0.05", "variable walk atom x",
           "variable r atom 0.3+0.15*(type==2)+0.05*sin(x)",
           "velocity all create 1.3 87287",
           "compute ke all ke/atom", "compute pe all pe/atom",
           "compute stress all stress/atom NULL virial"]
CENTROID = "compute centroid all centroid/stress/atom NULL virial"


def computes_of(name: str) -> dict[str, str]:
    """Words and kinds of values of the computes for a scene."""
    return {words: kind for words, kind in (EVERYWHERE | HERE.get(name, {})).items()
            if name != "charges" or not any(word in words for word in SOLVED)}


def rows(values: np.ndarray) -> np.ndarray:
    """Rows of local values in an order that does not depend on the program."""
    values = np.asarray(values).reshape(len(values), -1)
    return values[np.lexsort(values.round(11).T[::-1])]


def prepare(name: str) -> tuple[list[str], dict[str, str]]:
    """The lines of a scene with its computes, up to the forces, and the kinds of values by ID."""
    lines, computes, columns, dumped, local = [line for line in SCENES[name].splitlines() if line], {}, [], [], []
    lines += [*HELPERS, *[CENTROID] * (name != "charges")]
    for k, (words, kind) in enumerate(computes_of(name).items()):
        lines.append(f"compute c{k} {words}")
        computes[f"c{k}"] = kind
        if kind in "AB":
            dumped.append(f"c_c{k}" + "[1]" * (kind == "B"))
        elif kind in "LM":
            local.append(f"dump d{k} all local 1000 /dev/null c_c{k}" + "[1]" * (kind == "M"))
        else:
            columns.append(f"c_c{k}" + {"S": "", "V": "[1]", "G": "[1][1]"}[kind])
    lines += ["comm_modify cutoff 4.0", "thermo_modify norm no", f"dump d all custom 1000 /dev/null id {' '.join(dumped)}",
              *local, "thermo_style custom step pe " + " ".join(columns), "run 0"]
    return lines, computes


@pytest.fixture(scope="module")
def theirs():
    return ask(THEIRS, scenes={name: prepare(name) for name in SCENES} | {
        "running": (running(), {"c": "A"}), "tails": (tails(), {"c": "S", "d": "S"}),
        "occupied": (occupied(), {"c": "B", "h": "B", "g": "B"})})


def occupied() -> list[str]:
    """Atoms that leave the cells of their lattice."""
    lines = [line for line in SCENES["tilted"].splitlines() if line and not line.startswith("displace")]
    return [*lines, "velocity all create 30.0 87287", "fix 1 all nve", "compute c all voronoi/atom occupation",
            "compute h half voronoi/atom occupation", "compute g half voronoi/atom only_group occupation",
            "dump d all custom 9 /dev/null id c_c[1] c_h[1] c_g[1]", "run 9"]


def test_occupation_of_cells(theirs):
    """The second column of LAMMPS counts one too many for some atoms with only_group."""
    lmp = ran(occupied())
    order = np.argsort(lmp.scene.system.id)
    for k in "chg":
        columns = slice(0, 1 if k == "g" else 2)
        found, expected = lmp.extract_compute(k, 1, 2)[order][:, columns], theirs["occupied"][k][:, columns]
        np.testing.assert_array_equal(found, expected)
    assert (expected != 1.0).any()
    lmp.close()


def running() -> list[str]:
    """Evaluated some steps after the last build of the neighbour list, and again before the next."""
    return [*(line for line in SCENES["tilted"].splitlines() if line), "velocity all create 2.0 87287", "fix 1 all nve",
            "compute c all entropy/atom 0.16 2.2 local yes", "dump d all custom 7 /dev/null id c_c", "timestep 0.001",
            "neigh_modify every 5 delay 0 check no", "run 9"]


def test_density_of_entropy_in_a_run(theirs):
    """It is that of the last evaluation after a list was built."""
    lmp = ran(running())
    value = lmp.extract_compute("c", 1, 1)[np.argsort(lmp.scene.system.id)]
    np.testing.assert_allclose(value, theirs["running"]["c"], rtol=1e-9)
    lmp.close()


def tails() -> list[str]:
    """Tail corrections of some types; each pair of types has its own coefficients, without which LAMMPS counts others."""
    lines = [line for line in SCENES["crystal"].splitlines() if line]
    return [*lines, "pair_coeff 1 2 0.7 0.95", "pair_modify tail yes", "variable f equal 0.7", "variable g equal 1.3",
            "compute c all ti tail * v_f v_g", "compute d all ti tail 2 v_f v_g", "thermo_style custom step etail c_c c_d",
            "thermo_modify norm no", "run 0"]


def test_tail_of_some_types(theirs):
    lmp = ran(tails())
    for k in "cd":
        assert lmp.extract_compute(k, 0, 0) == pytest.approx(float(theirs["tails"][k]), rel=1e-13)
    assert abs(lmp.extract_compute("d", 0, 0)) < 0.99 * abs(lmp.extract_compute("c", 0, 0))
    lmp.close()


@pytest.mark.parametrize("name", SCENES)
def test_like_lammps(name, theirs):
    lines, computes = prepare(name)
    lmp = ran(lines)
    order = np.argsort(lmp.scene.system.id)
    for (id, kind), words in zip(computes.items(), computes_of(name), strict=True):
        value, expected = lmp.extract_compute(id, 0 if kind in "SVG" else 2 if kind in "LM" else 1, "SVG".find(kind)), theirs[name][id]
        if kind in "LM":
            value, expected = rows(value), rows(expected)
        elif kind in "AB":
            value = value[order]
        absolute = 1e-10 if "fep" in words else 1e-12       # LAMMPS's differences are those of two total energies
        np.testing.assert_allclose(value, expected, rtol=1e-11, atol=absolute * max(1.0, abs(expected).max()), err_msg=f"{name}: {words}")
        compute, snapshot = lmp.scene.computes[id], lmp.session.moment.snapshot
        again = type(compute).from_lammps(compute.group, compute.to_lammps(), lmp.session)
        value = VALUES[kind]
        np.testing.assert_array_equal(getattr(again, value)(snapshot), getattr(compute, value)(snapshot), err_msg=words)
    lmp.close()


@pytest.mark.parametrize(("line", "message"), [
    ("rdf", "needs 1 value"), ("rdf 0", "at least 1"), ("rdf 10 1", "in pairs"), ("rdf 10 1 3", "outside the valid range"),
    ("rdf 10 cutoff", "needs 1 value"), ("rdf 10 cutoff -1", "positive"), ("rdf 10 cutoff 1 2", "unknown keyword"),
    ("adf 0", "at least 1"), ("adf 10 1 1 1", "7 values"),
    ("adf 10 * * * 0 1 2 1", "beyond inner"), ("adf 10 ordinate grad", "one of degree"),
    ("coord/atom", "needs 1 value"), ("coord/atom 2.0", "one of cutoff orientorder"), ("coord/atom cutoff 1 9", "outside the valid range"),
    ("coord/atom cutoff 1 group c", "unknown group"), ("coord/atom orientorder x 0.5", "no compute x"),
    ("coord/atom orientorder thermo_pe 0.5", "orientorder/atom"), ("orientorder/atom degree 1 6", "did you mean degrees"),
    ("orientorder/atom components 5", "not one of the degrees"), ("orientorder/atom degrees 2 4", "needs 2 values"),
    ("orientorder/atom nnn 0", "must be positive"),
    ("hexorder/atom degree -1", "must not be negative"), ("hexorder/atom nn 5", "did you mean nnn"),
    ("cna/atom", "needs 1 value"), ("cna/atom -1", "must not be negative"),
    ("ackland/atom legacy", "needs 1 value"), ("ackland/atom old yes", "did you mean legacy"),
    ("centro/atom 7", "even positive"), ("centro/atom hcp", "whole number"),
    ("centro/atom fcc axis yes", "unknown keyword"), ("cluster/atom", "needs 1 value"), ("aggregate/atom 1", "with bonds"),
    ("pair lj/cuts", "did you mean lj/cut"), ("pair lj/cut eng", "one of epair"), ("pair lj/cut epair 1", "unexpected"),
    ("pair/local", "at least one"), ("pair/local dst", "did you mean dist"), ("pair/local p1", "extra quantity"),
    ("pair/local dist cutoff size", "one of type radius"),
    ("group/group nobody", "unknown group"), ("group/group a par yes", "did you mean pair"),
    ("group/group a kspace maybe", "yes or no"),
    ("group/group a molecule inter", "molecule numbers"), ("entropy/atom 0.2", "needs 2 values"),
    ("entropy/atom 0.2 0", "must be positive"),
    ("entropy/atom 0.2 2 avg yes", "needs 1 value"), ("entropy/atom 0.2 2 ave yes 1", "did you mean avg"),
    ("heat/flux 1 2", "needs 3 values"),
    ("heat/flux thermo_pe thermo_pe thermo_pe", "not a compute ke/atom"), ("heat/flux a b c", "no compute a"),
    ("centroid/stress/atom", "ID of a temperature"), ("centroid/stress/atom NULL per", "did you mean pe|unknown keyword"),
    ("nbond/atom", "with bonds"),
    ("fragment/atom", "with bonds"), ("voronoi/atom surface nobody", "unknown group"), ("voronoi/atom radius v_x", "v_x"),
    ("voronoi/atom occupation edge_histo 3", "cannot be used"), ("voronoi/atom radius 0.3", "atom-style variable v_name"),
    ("voronoi/atom radius v_f", "no per-atom values"), ("voronoi/atom radius", "1 value"),
    ("voronoi/atom face_treshold 1", "did you mean face_threshold"),
    ("voronoi/atom edge_histo 0", "positive"), ("ti lj/cut 1 v_f", "4 words"),
    ("ti lj/cut 1 v_f 3", "expected a variable"), ("ti lj/cutt 1 v_f v_g", "did you mean lj/cut"), ("ti kspace 3 v_f", "4 words"),
    ("fep 1.0", "at least one of pair, atom"), ("fep x pair lj/cut epsilon 1 1 v_f", "expected a number"),
    ("fep 1.0 pair lj/cut epsilon 1 1 0.5", "must be a variable"), ("fep 1.0 pair lj/cuts epsilon 1 1 v_f", "did you mean lj/cut"),
    ("fep 1.0 pair lj/cut radius 1 1 v_f", "no coefficient 'radius'"), ("fep 1.0 pair lj/cut epsilon 1 3 v_f", "outside the valid range"),
    ("fep 1.0 pair lj/cut epsilon 1 1 v_walk", "style equal"), ("fep 1.0 pair lj/cut epsilon 1 1", "needs 5 values"),
    ("fep 1.0 atom charge 1 v_f", "no charges"), ("fep 1.0 atom diameter 1 v_f", "must be charge"),
    ("fep 1.0 bond harmonic", "unknown keyword"),
    ("fep 1.0 pair lj/cut epsilon 1 1 v_f tail", "needs 1 value"), ("fep 1.0 pair lj/cut epsilon 1 1 v_f tale no", "did you mean tail"),
    ("fep/ta 1.0 xy", "needs 3 values"), ("fep/ta 1.0 zz 1.1", "one of xy xz yz"), ("fep/ta 1.0 xy -1", "must be positive"),
    ("fep/ta 1.0 xy 1.1 volume yes", "unknown keyword"),
    ("ti tail 9 v_f v_g", "outside the valid range"), ("ti", "at least one"), ("contact/atom c", "unknown group"),
])
def test_mistakes(crystal, line, message):
    with pytest.raises(InputError, match=message):
        crystal.command(f"compute wrong all {line}")


@pytest.mark.parametrize(("line", "kind"), [("coord/atom cutoff 9", "A"), ("cna/atom 9", "A"), ("cluster/atom 9", "A"),
                                            ("orientorder/atom cutoff 9", "B")])
def test_beyond_the_pair_style(crystal, line, kind):
    crystal.command(f"compute far all {line}")
    try:
        with pytest.raises(InputError, match="longer than that of the pair style"):
            crystal.extract_compute("far", 1, "AB".index(kind) + 1)
    finally:
        crystal.command("uncompute far")


@pytest.fixture(scope="module")
def crystal():
    lmp = ran([SCENES["crystal"], *HELPERS, "run 0"])
    yield lmp
    lmp.close()


def test_tail_that_is_not_there(crystal):
    crystal.command("compute tail all fep/ta 1.0 xy 1.1 tail yes")
    try:
        with pytest.raises(InputError, match="use pair_modify tail yes"):
            crystal.command("run 0")
    finally:
        crystal.command("uncompute tail")


def test_axes_of_symmetry(crystal):
    """They stand at right angles as far as they should, and are those of the pairs."""
    crystal.command("compute axes all centro/atom 6 axes yes")
    crystal.command("compute alone all centro/atom 6")
    values = crystal.extract_compute("axes", 1, 2)
    np.testing.assert_array_equal(values[:, 0], crystal.extract_compute("alone", 1, 1))
    axes = values[:, 1:].reshape(-1, 3, 3)
    np.testing.assert_allclose((axes**2).sum(axis=2), 1.0)
    np.testing.assert_allclose(np.einsum("nka,na->nk", axes[:, :2], axes[:, 2]), 0.0, atol=1e-14)


def test_own_list_as_the_engines(crystal):
    """The pairs do not depend on which list they come from."""
    from dataclasses import replace

    from asemd.compute._pairs import half
    snapshot = crystal.session.moment.snapshot
    found = []
    for state in (snapshot, replace(snapshot, engine=None)):
        p = half(state, 1.9)
        found.append(sorted(zip(np.minimum(p.i, p.j).tolist(), np.maximum(p.i, p.j).tolist(), p.r2.round(9).tolist())))
    assert found[0] == found[1] and len(found[0]) > 1000


def test_rdf_of_mdanalysis(crystal):
    """Another program's g(r) of the same atoms."""
    mda = pytest.importorskip("MDAnalysis")
    from MDAnalysis.analysis.rdf import InterRDF

    from asemd.compute.rdf import RDF
    state = crystal.session.moment.snapshot
    g = RDF(bins=40, cutoff=2.4).array(state)
    universe = mda.Universe.empty(state.system.n, trajectory=True)
    universe.atoms.positions = state.system.x
    universe.dimensions = [*state.system.box.lengths, 90, 90, 90]
    theirs = InterRDF(universe.atoms, universe.atoms, nbins=40, range=(0.0, 2.4), exclusion_block=(1, 1)).run().results
    scale = (state.system.n - 1) / state.system.n       # it divides by all atoms, the central one too
    np.testing.assert_allclose(g[:, 0], theirs.bins, rtol=1e-6)
    np.testing.assert_allclose(g[:, 1] * scale, theirs.rdf, rtol=2e-2, atol=5e-2)      # single precision moves pairs to the next bin


def test_voronoi_cells_fill_the_box():
    """Also those of few atoms, with walls, and where copies of an atom touch."""
    from asemd.box import Box
    from asemd.compute.voronoi_atom import _cells
    rng = np.random.default_rng(5)
    for n, boundary in ((1, "pp"), (2, "pp"), (30, "pp"), (30, "ff")):
        box = Box.from_lammps((0, 0, 0), (3.0, 4.0, 5.0), tilt=(0.0, 0.0, 0.0), boundary=("pp", "pp", boundary))
        system = SimpleNamespace(x=rng.uniform(0.0, 1.0, (n, 3)) * [3, 4, 5], box=box, dimension=3)
        everything = np.arange(n), np.ones(n, bool), 0.0
        cells = _cells(system, *everything)
        assert cells.volume.sum() == pytest.approx(60.0, rel=1e-12), (n, boundary)
        alike = _cells(system, *everything, np.full(n, 0.7))
        assert cells.volume == pytest.approx(alike.volume, rel=1e-11) and list(cells.owner) == list(alike.owner), (n, boundary)
        cells = _cells(system, *everything, rng.uniform(0.0, 1.0, n))
        assert cells.volume.sum() == pytest.approx(60.0, rel=1e-12), (n, boundary)


def test_voronoi_cells_of_two_sizes():
    """Two atoms between walls share the box where their powers are equal."""
    from asemd.box import Box
    from asemd.compute.voronoi_atom import _cells
    box = Box.from_lammps((0, 0, 0), (10.0, 4.0, 4.0), boundary=("ff", "pp", "pp"))
    system = SimpleNamespace(x=np.array([[3.0, 1.0, 1.0], [6.0, 1.0, 1.0]]), box=box, dimension=3)
    volumes = _cells(system, np.arange(2), np.ones(2, bool), 0.0, np.array([1.5, 0.5])).volume
    plane = 3.0 + (3.0**2 + 1.5**2 - 0.5**2) / (2.0 * 3.0)
    assert volumes == pytest.approx([16.0 * plane, 16.0 * (10.0 - plane)], rel=1e-12)
