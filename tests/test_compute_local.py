"""Local values, energies of sub-styles and dump local: LAMMPS's numbers and text."""
from __future__ import annotations

import pickle
from types import SimpleNamespace

import numpy as np
import pytest
from bonded_scene import HYBRID, HYBRID_COEFF, SIMPLE, data, head
from wheel import ask, ran

from asemd.compute import improper_local
from asemd.compute.dihedral_local import phi
from asemd.errors import InputError

SETUP = ["variable x internal 0", "variable twice equal 2*v_x+1", "group odd id 1 2 3 5 6 7 9", "group none id 1000"]
BOND = "dist dx dy dz engpot force fx fy fz engtrans"
# name -> words of the compute
LOCAL = {
    "bond": f"all bond/local {BOND}", "motion": "all bond/local engvib engrot engtrans omega velvib",
    "bond group": "odd bond/local dist", "bond none": "none bond/local dist",
    "bond formula": "all bond/local dist v_twice set dist x", "angle": "all angle/local theta eng", "angle vector": "odd angle/local eng",
    "angle formula": "all angle/local v_twice set theta x", "dihedral": "all dihedral/local phi",
    "dihedral formula": "all dihedral/local phi v_twice set phi x", "improper": "all improper/local chi",
    "bonds": "all property/local batom1 batom2 btype", "angles": "odd property/local aatom1 aatom2 aatom3 atype",
    "dihedrals": "all property/local datom1 datom2 datom3 datom4 dtype",
    "impropers": "all property/local iatom1 iatom2 iatom3 iatom4 itype",
    "type": "all property/local btype", "neighbors": "all property/local natom1 natom2 ntype1 ntype2",
    "pairs": "odd property/local patom1 patom2 ptype1 ptype2",
}
TURNED_OFF = ["delete_bonds all bond 1", "delete_bonds odd multi any", "delete_bonds odd bond 2 any undo"]
SCENES = {"simple": ("", SIMPLE, []), "hybrid": (HYBRID, HYBRID_COEFF, []), "off": ("", SIMPLE, TURNED_OFF),
          "inside": ("", SIMPLE, []), "excluded": ("", SIMPLE, ["neigh_modify exclude type 1 1", "special_bonds lj/coul 1 0 0.3"])}
DUMPS = {
    "plain": ("index c_1[1] c_1[2] c_1[3] c_2[1] c_2[2]", ""), "label": ("index c_3", "label BONDS"),
    "line": ("index c_1[1] c_2[1]", 'label ANGLES format line "%d %4.1f  %20.12g"'),
    "formats": ("index c_1[1] c_2[1]", "format float %20.12g format int %5d format 2 %.1f"),
    "sorted": ("index c_1[1] c_2[1]", "sort 3"), "down": ("index c_1[1] c_2[1]", "sort -3"),
    "names": ("index c_1[1] c_2[1]", "colname 2 first colname index nr units yes time yes"), "no header": ("index c_1[1]", "header no"),
    "all columns": ("index c_1[*] c_2[1*2]", ""), "last columns": ("c_1[2*]", ""), "empty": ("index c_4", ""),
}
DUMPED = ["compute 1 all property/local batom1 batom2 btype", "compute 2 all bond/local dist engpot", "compute 3 odd bond/local dist",
          "compute 4 none bond/local dist"]
THEIRS = r"""
import os
answer = {}
for name, lines, local in given["scenes"]:
    lmp = ran([*lines, *(f"compute {k} {words}" for k, words in local.items())])
    lmp.command("thermo_style custom step pe ebond")
    for k in local:
        lmp.command(f"dump {k} all local 1 {given['folder']}/unused c_{k}" + ("[*]" if given["wide"][k] else ""))
    lmp.command("run 0")
    answer[name] = {}
    for k in local:
        values = lmp.numpy.extract_compute(k, 2, 2 if given["wide"][k] else 1)
        answer[name][k] = np.zeros(0) if values is None else np.array(values)
    lmp.close()
lmp = ran(given["hybrid"])
for kind in ("bond", "angle", "dihedral", "improper"):
    lmp.command(f"compute {kind} all {kind}")
lmp.command("thermo_style custom step " + " ".join(f"c_{k}[{i}]" for k in ("bond", "angle", "dihedral", "improper") for i in (1, 2)))
lmp.command("run 0")
for kind in ("bond", "angle", "dihedral", "improper"):
    answer[kind] = np.array(lmp.numpy.extract_compute(kind, 0, 1))
lmp.close()
answer["dumps"] = {}
for name, (words, modify) in given["dumps"].items():
    path = os.path.join(given["folder"], "dump")
    ran([*given["dumped"], f"dump d all local 1 {path} {words}"] + [f"dump_modify d {modify}"] * bool(modify) + ["run 0"]).close()
    answer["dumps"][name] = open(path).read()
"""


def columns(words: str) -> int:
    named = words.split(" set ")[0].split()[2:]
    return len(named) if len(named) > 1 else 0


def lines_of(scene: str, path) -> list[str]:
    styles, coeff, more = SCENES[scene]
    return [*head(path.with_name("inside") if scene == "inside" else path, styles=styles), *coeff, *SETUP, *more]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("local")
    (folder / "d").write_text(data())
    (folder / "inside").write_text(data(start=4.0))
    return folder


@pytest.fixture(scope="module")
def theirs(folder):
    ids = {name: name.replace(" ", "_") for name in LOCAL}
    local = {ids[name]: words for name, words in LOCAL.items()}
    return ask(THEIRS, scenes=[(name, lines_of(name, folder / "d"), local) for name in SCENES], folder=str(folder),
               wide={ids[name]: columns(words) for name, words in LOCAL.items()}, hybrid=lines_of("hybrid", folder / "d"), dumps=DUMPS,
               dumped=[*lines_of("simple", folder / "d"), *DUMPED])


def by_row(values: np.ndarray, pairs: bool) -> np.ndarray:
    """Rows in order; the two atoms of a pair of neighbours in order of id."""
    values = np.asarray(values, float)
    values = values.reshape(len(values), -1) if len(values) else values.reshape(0, 1)
    if pairs:
        swap = values[:, 0] > values[:, 1]
        values[swap] = values[swap][:, [1, 0, 3, 2]]
    return values[np.lexsort(np.round(values, 6).T[::-1])]


@pytest.mark.parametrize("scene", SCENES)
def test_same_values_as_lammps(theirs, folder, scene):
    lmp = ran([*lines_of(scene, folder / "d"), "run 0"])
    for name, words in LOCAL.items():
        if name == "motion" and scene != "inside":      # LAMMPS takes no image of a bond across a face here
            continue
        k = name.replace(" ", "_")
        lmp.command(f"compute {k} {words}")
        got, expected = lmp.extract_compute(k, 2, 2), theirs[scene][k]
        assert (got.shape[1] if got.ndim == 2 else 0) == columns(words), name
        pairs = name in ("neighbors", "pairs")
        got, expected = by_row(got, pairs), by_row(expected, pairs)
        np.testing.assert_allclose(got, expected.reshape(got.shape), rtol=1e-11, atol=1e-12, err_msg=name)


def test_energies_of_sub_styles(theirs, folder):
    lmp = ran([*lines_of("hybrid", folder / "d"), *(f"compute {k} all {k}" for k in ("bond", "angle", "dihedral", "improper")), "run 0"])
    for kind, total in (("bond", "ebond"), ("angle", "eangle"), ("dihedral", "edihed"), ("improper", "eimp")):
        got = lmp.extract_compute(kind, 0, 1)
        np.testing.assert_allclose(got, theirs[kind], rtol=1e-12)
        assert got.sum() == pytest.approx(lmp.get_thermo(total), rel=1e-13)


@pytest.mark.parametrize("name", DUMPS)
def test_same_dump_as_lammps(theirs, folder, name, tmp_path):
    words, modify = DUMPS[name]
    lines = [*lines_of("simple", folder / "d"), *DUMPED, f"dump d all local 1 {tmp_path}/dump {words}"]
    ran([*lines, *[f"dump_modify d {modify}"] * bool(modify), "run 0"]).close()
    assert (tmp_path / "dump").read_text() == theirs["dumps"][name]


def test_rows_of_two_computes_fit_together(folder):
    """The energy in a row is that of the bond named in the same row of another compute."""
    lmp = ran([*lines_of("hybrid", folder / "d"), "compute p all property/local batom1 batom2 btype",
               "compute e all bond/local engpot dist", "run 0"])
    for (_, _, kind), (energy, r) in zip(lmp.extract_compute("p", 2, 2), lmp.extract_compute("e", 2, 2), strict=True):
        expected = 100 * (r - 1.3) ** 2 if kind == 1 else 50 * (1 - np.exp(-1.5 * (r - 1.2))) ** 2
        assert energy == pytest.approx(expected, rel=1e-12)


def test_forces_of_bonds_are_the_forces(folder):
    """Forces of all bonds add up to the forces on the atoms, energies to the energy."""
    lmp = ran([*head(folder / "d"), *SIMPLE, "pair_style none", "angle_style none", "dihedral_style none", "improper_style none",
               "compute p all property/local batom1 batom2", "compute f all bond/local fx fy fz engpot", "run 0"])
    f, pairs = lmp.extract_compute("f", 2, 2), lmp.extract_compute("p", 2, 2).astype(int) - 1
    total = np.zeros((12, 3))
    np.add.at(total, pairs[:, 0], f[:, :3])
    np.subtract.at(total, pairs[:, 1], f[:, :3])
    np.testing.assert_allclose(total, lmp.extract_atom("f"), atol=1e-11)
    assert f[:, 3].sum() == pytest.approx(lmp.get_thermo("ebond"))


def test_bond_outside_its_domain_is_nan(folder):
    """A bond beyond the reach of its style has no energy; the others keep theirs."""
    lmp = ran([*head(folder / "d", styles="bond_style hybrid harmonic fene"), "bond_coeff 1 harmonic 100 1.3",
               "bond_coeff 2 fene 30 1.6 0.1 1", "delete_bonds all bond 2", "compute e all bond/local engpot dist", "run 0",
               "delete_bonds all bond 2 undo"])
    before = lmp.extract_compute("e", 2, 2)
    assert np.isfinite(before).all()
    lmp.scene.system.x[3] += 3.0
    lmp.session.moment.forget()
    after = lmp.extract_compute("e", 2, 2)
    assert np.isnan(after[2, 0]) and np.isfinite(np.delete(after, 2, axis=0)).all()


def test_computes_travel(folder):
    lmp = ran([*lines_of("simple", folder / "d"), "compute b all bond/local dist engpot", "compute p all property/local patom1 patom2",
               "run 0"])
    scene = pickle.loads(pickle.dumps(lmp.scene))
    for id in ("b", "p"):
        np.testing.assert_array_equal(scene.computes[id].local(lmp.session.moment.snapshot), lmp.extract_compute(id, 2, 2))


@pytest.mark.parametrize(("line", "message"), [
    ("compute c all bond/local", "at least one"), ("compute c all bond/local dits", "did you mean dist"),
    ("compute c all bond/local b2", "extra quantity"), ("compute c all bond/local v_twice", "set dist"),
    ("compute c all bond/local dist set dist x", "without a variable"), ("compute c all bond/local v_twice set theta x", "set dist"),
    ("compute c all bond/local v_none set dist x", "none"), ("compute c all bond/local v_twice set dist twice", "internal"),
    ("compute c all bond/local v_x set dist x", "equal"), ("compute c all improper/local v_twice set chi x", "unknown keyword"),
    ("compute c all property/local", "at least one"), ("compute c all property/local batom1 aatom1", "cannot go together"),
    ("compute c all property/local batom3", "unknown attribute"), ("compute c all property/local patom1 cutoff radius", "radius"),
    ("compute c all property/local patom1 cutoff", "needs 1 value"), ("compute c all bond", "hybrid"),
    ("compute c all bond ebond", "no arguments"),
    ("dump d all local 1 f index", "at least one column"), ("dump d all local 1 f id c_1", "must be index"),
    ("dump d all local 1 f c_1", "say which one"), ("dump d all local 1 f c_1[4]", "3 columns"),
    ("dump d all local 1 f c_3[1]", "no columns"),
    ("dump d all local 1 f c_thermo_pe", "no local values"), ("dump d all local 1 f c_nothing", "there is no compute nothing"),
])
def test_mistakes(folder, line, message):
    lmp = ran([*lines_of("simple", folder / "d"), *DUMPED])
    with pytest.raises(InputError, match=message):
        lmp.command(line)


def test_mistakes_with_dumps(folder, tmp_path):
    lmp = ran([*lines_of("simple", folder / "d"), *DUMPED, f"dump d all local 1 {tmp_path}/f c_1[1] c_3"])
    with pytest.raises(InputError, match="no atom ID"):
        lmp.command("dump_modify d sort id")
    with pytest.raises(InputError, match="not supported by dump style local"):
        lmp.command("dump_modify d thresh c_1[1] > 2")
    with pytest.raises(InputError, match=r"different lengths.*9 c_1\[1\], 4 c_3"):
        lmp.command("run 0")


def test_impropers_on_a_line_have_90_degrees_as_in_lammps():
    """Where no planes are; dihedral/local has 0 there."""
    x = np.array([[[-1, 0, 0], [0, 0, 0], [1.5, 0, 0], [2, 1, 0.5]], [[1, 2, 3], [2, 3, 4], [3, 4, 5], [3, 4.5, 6]],
                  [[-0.5, 1, 0], [0, 0, 0], [1.5, 0, 0], [2, 0, 1]]], float).transpose(1, 0, 2)
    g = SimpleNamespace(between=lambda i, j: x[i] - x[j])
    assert improper_local.chi(g) == pytest.approx([90.0, 90.0, 90.0]) and np.abs(phi(g)) == pytest.approx([0.0, 0.0, 90.0])


def test_all_sub_styles_in_thermo_before_the_first_run(folder):
    """``c_ID[*]`` is as long as the hybrid."""
    lmp = ran([*lines_of("hybrid", folder / "d"), "compute b all bond", "compute d all dihedral",
               "thermo_style custom step c_b[*] c_d[*]", "run 0 post no"])
    words = list(lmp.session.scene.thermo.words)
    lmp.close()
    assert words == ["step", *(f"c_{id}[{k}]" for id in "bd" for k in range(1, 1 + len(words) // 2))] and len(words) > 3
