"""delete_bonds, create_bonds, special_bonds angle and dihedral, write_coeff, rest values: what LAMMPS makes of the same lines."""
from __future__ import annotations

import pickle

import numpy as np
import pytest
from bonded_scene import HYBRID, HYBRID_COEFF, SIMPLE, data, head
from wheel import ask

from asemd.errors import InputError
from asemd.topology import Topology

GROUPS = ["group g id 1:6", "group h id 9:12", "group two id 1:2", "group most id 1:8"]
# lines executed after a first run; energies, items and what delete_bonds reports must agree
CASES = {
    "off": ["delete_bonds g bond 2", "delete_bonds g stats"], "any": ["delete_bonds g multi any", "delete_bonds all stats"],
    "remove": ["delete_bonds g bond 1*2", "delete_bonds h angle 1 remove"],
    "remove special": ["delete_bonds g bond 1*2", "delete_bonds h bond 1 remove special"],
    "undo": ["delete_bonds g bond 1*2", "delete_bonds all bond 1 undo"],
    "undo any": ["delete_bonds g multi any", "delete_bonds all atom 1 undo any"], "atom": ["delete_bonds g atom 1 remove"],
    "atom any": ["delete_bonds two atom 2 any remove special"],
    "undo remove": ["delete_bonds all multi", "delete_bonds two bond 1*2 undo remove special"],
    "remove those of other kinds": ["delete_bonds all bond 1", "delete_bonds g angle 1", "delete_bonds h dihedral 1 remove"],
    "remove those off": ["delete_bonds all bond 1", "delete_bonds g bond 1 remove special"],
    "dihedrals": ["delete_bonds all dihedral 1*2 remove", "delete_bonds all improper 2", "delete_bonds all stats"],
    "off, then pairs": ["delete_bonds all bond 1 remove", "create_bonds single/angle 1 1 2 3 special no"],
    "replicated": ["delete_bonds all bond 1 remove", "delete_bonds all angle 1", "replicate 2 1 1"],
    "some atoms deleted": ["delete_bonds all bond 1 remove", "group first id 1", "delete_atoms group first bond yes"],
    "other weights": ["delete_bonds all bond 1 remove", "special_bonds lj/coul 0 0.5 1"],
    "same weights": ["delete_bonds all bond 1 remove", "special_bonds lj/coul 0.5 0 0.5"],
    "dihedral yes": ["delete_bonds all bond 1 remove", "special_bonds lj/coul 0 0.5 1 dihedral yes"],
    "both yes": ["delete_bonds all dihedral 1 remove special", "special_bonds lj/coul 0 0.5 1 dihedral yes angle yes"],
    "angle yes": ["delete_bonds all dihedral 1*2 remove", "delete_bonds all angle 1 remove special",
                  "special_bonds lj/coul 0 0.5 1 angle yes"],
    "lists stay": ["special_bonds lj/coul 0 0.5 1 angle yes dihedral yes", "delete_bonds all multi remove"],
    "many": ["create_bonds many g h 1 0.5 5.0"], "many in one group": ["create_bonds many most most 1 0.5 4.0"],
    "many between 1-4": ["special_bonds lj/coul 0 0 1", "create_bonds many most most 1 0.5 4.0"],
    "many between 1-3": ["special_bonds lj/coul 0 0.5 1", "create_bonds many most most 1 0.5 4.0"],
    "many, none": ["create_bonds many g h 1 -1 0.5"], "single": ["create_bonds single/bond 1 1 5"],
    "single no": ["create_bonds single/bond 1 1 5 special no"],
    "single no, then yes": ["create_bonds single/bond 1 1 5 special no", "create_bonds single/angle 2 1 5 9 special yes"],
    "all four": ["create_bonds single/bond 1 1 2 special yes", "create_bonds single/angle 2 1 5 9 special no",
                 "create_bonds single/dihedral 1 1 5 9 2 special no", "create_bonds single/improper 1 1 5 9 2"],
    "trimmed lists": ["special_bonds lj/coul 0 0 0.5 angle yes dihedral yes", "create_bonds single/bond 1 1 5",
                      "create_bonds single/angle 2 1 5 6"],
}
WORDS = ("pe", "ebond", "eangle", "edihed", "eimp", "evdwl")
END = ["run 0", f"thermo_style custom step {' '.join(WORDS)}", "run 0"]
THEIRS = r"""
answer = {}
place = given["folder"]
for name, lines in given["cases"].items():
    lmp = ran([f"log {place}/log", *given["setup"], *lines, *given["end"], f"write_data {place}/theirs nocoeff"])
    answer[name] = {"energies": [lmp.get_thermo(w) for w in given["words"]], "data": open(f"{place}/theirs").read()}
    answer[name]["items"] = {k: sorted(np.array(getattr(lmp.numpy, f"gather_{k}s")()).reshape(-1, width + 1).tolist())
                             for k, width in (("bond", 2), ("angle", 3), ("dihedral", 4), ("improper", 4))}
    lmp.close()
    answer[name]["log"] = open(f"{place}/log").read()
"""
# style, coefficient lines, whether it is a bond style; LAMMPS's SHAKE shows the rest value
REST = [("bond", "harmonic", "30 1.1"), ("bond", "fene", "30 1.5 1 1.2"), ("bond", "fene/expand", "30 1.5 1 1.2 0.1"),
        ("bond", "fene/nm", "2.25 1.5 1.0 1.05 12 6"), ("bond", "gaussian", "300.0 2 0.0128 0.375 1.07 0.0730 0.148 1.13"),
        ("bond", "harmonic/shift", "10.0 0.8 1.1"), ("bond", "class2", "1.1 300 -500 700"), ("bond", "zero", "1.02"),
        ("angle", "harmonic", "30 105"), ("angle", "charmm", "30 105 0 0"), ("angle", "cosine/periodic", "75.0 -1 3"),
        ("angle", "cosine/periodic", "75.0 -1 5"), ("angle", "fourier", "75.0 1.0 0.5 0.3"), ("angle", "fourier", "75.0 1.0 -0.5 0.3"),
        ("angle", "fourier/simple", "100.0 -1.0 3.0"), ("angle", "gaussian", "300.0 2 0.0128 0.375 80.0 0.0730 0.148 123.0"),
        ("angle", "class2", "105 1 2 3"), ("angle", "zero", "111")]
WATER = """three atoms

3 atoms
1 atom types
2 bonds
1 bond types
1 angles
1 angle types
0 20 xlo xhi
0 20 ylo yhi
0 20 zlo zhi

Masses

1 1.0

Atoms # full

1 1 1 0 5 5 5
2 1 1 0 6.0 5.1 5
3 1 1 0 6.5 5.9 5

Bonds

1 1 1 2
2 1 2 3

Angles

1 1 1 2 3
"""
SHAKEN = r"""
answer = []
for category, style, coeff in given["rest"]:
    lmp = start()
    bond, angle = (style, "zero") if category == "bond" else ("zero", style)
    lines = ["units real", "atom_style full", "special_bonds lj/coul 0 1 1", "pair_style zero 3", f"bond_style {bond}",
             f"angle_style {angle}", f"read_data {given['path']}", "pair_coeff * *",
             "bond_coeff 1 1.0" if category == "angle" else f"bond_coeff 1 {coeff}",
             "angle_coeff 1 100" if category == "bond" else f"angle_coeff 1 {coeff}"]
    if style == "class2" and category == "angle":
        lines += ["angle_coeff 1 bb 1 1 1", "angle_coeff 1 ba 1 1 1 1"]
    lines += ["timestep 0.01", "fix 1 all nve", "fix 2 all shake 1e-10 1000 0 b 1" + " a 1" * (category == "angle"),
              "compute r all bond/local dist" if category == "bond" else "compute r all angle/local theta", "dump 1 all local 1 NAME c_r",
              "run 20"]
    for line in lines:
        lmp.command(line.replace("NAME", given["path"] + ".dump"))
    answer.append(float(lmp.numpy.extract_compute("r", 2, 1)[0]))
    lmp.close()
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("bonded")
    (folder / "d").write_text(data())
    (folder / "water").write_text(WATER)
    return folder


def setup(folder, coeff=SIMPLE, **how) -> list[str]:
    return [*head(folder / "d", **how), *coeff, *GROUPS, "run 0"]


@pytest.fixture(scope="module")
def theirs(folder):
    return ask(THEIRS, cases=CASES, setup=setup(folder), end=END, words=WORDS, folder=str(folder))


def ours(lines, log="none"):
    from asemd.lammps import Lammps
    lmp = Lammps(cmdargs=["-screen", "none", "-log", str(log)])
    lmp.commands_list(lines)
    return lmp


def items(text: str) -> dict[str, list[str]]:
    """Types and atoms of every section of bonded items, sorted."""
    out = {}
    for name in ("Bonds", "Angles", "Dihedrals", "Impropers"):
        if f"\n{name}\n\n" in text:
            lines = text.split(f"\n{name}\n\n")[1].split("\n\n")[0].strip().splitlines()
            out[name] = sorted(line.split(None, 1)[1] for line in lines)
    return out


@pytest.mark.parametrize("name", CASES)
def test_same_as_lammps(theirs, folder, name, tmp_path):
    lmp = ours([*setup(folder), *CASES[name], *END, f"write_data {tmp_path}/ours nocoeff"], log=tmp_path / "log")
    lmp.close()
    expected = theirs[name]
    np.testing.assert_allclose([lmp.get_thermo(w) for w in WORDS], expected["energies"], rtol=1e-11, atol=1e-11)
    assert items((tmp_path / "ours").read_text()) == items(expected["data"])
    assert {k: sorted(getattr(lmp.numpy, f"gather_{k}s")().tolist()) for k in expected["items"]} == expected["items"]
    told = [[line.strip() for line in text.splitlines() if "turned on" in line or line.startswith("Added")]
            for text in ((tmp_path / "log").read_text(), expected["log"])]
    assert told[0] == told[1]


def test_turned_off_items_keep_their_partners(folder):
    """A bond that is off has no force, but its atoms are partners still; on again everything is as before."""
    lmp = ours(setup(folder))
    before = lmp.get_thermo("pe"), lmp.get_thermo("evdwl")
    pairs = lmp.scene.system.topology.special(12)[0].tolist()
    lmp.commands_list(["delete_bonds all multi", "run 0"])
    assert [lmp.get_thermo(w) for w in ("ebond", "eangle", "edihed", "eimp")] == [0.0] * 4
    assert lmp.get_thermo("evdwl") == pytest.approx(before[1], rel=1e-13)
    assert lmp.scene.system.topology.special(12)[0].tolist() == pairs
    assert (lmp.scene.system.topology.bond_types < 0).all()
    lmp.commands_list(["delete_bonds all multi undo", "run 0"])
    assert lmp.get_thermo("pe") == pytest.approx(before[0], rel=1e-13)


def test_lists_of_partners_travel(folder):
    """Copies, pickles, ASE atoms and dictionaries keep lists that no longer follow from the bonds."""
    from asemd.atoms import Atoms
    system = ours([*setup(folder), "delete_bonds all bond 1 remove"]).scene.system
    top, pairs = system.topology, system.topology.special(12)[0].tolist()
    bare = Topology(bonds=top.bonds, bond_types=top.bond_types)
    assert len(bare.special(12)[0]) < len(pairs) and not top.is_empty
    atoms = system.to_ase()
    for copy in (top.copy(), pickle.loads(pickle.dumps(top)), Topology(**top.as_dict()), atoms.topology, atoms.copy().topology,
                 Atoms.fromdict(atoms.todict()).topology, top.select(slice(None), 12)):
        assert copy == top and copy.special(12)[0].tolist() == pairs
    assert top.concatenate(bare.shift(12)).special(24)[0].tolist() == pairs + bare.shift(12).special(24)[0].tolist()
    assert len(top.repeat(12, 3).special(36)[0]) == 3 * len(pairs)
    assert top != bare and Topology(frozen=top).special(12)[0].tolist() == pairs


def test_scripts_turn_items_off_again(folder, tmp_path):
    """Items that are turned off go into a data file, and commands turn them off; what neither can hold is not handed over."""
    from asemd.lammps.export import commands
    off = {"delete_bonds all bond 1": ["delete_bonds all bond 1"], "delete_bonds all bond 1 remove": None,
           "delete_bonds all multi\ndelete_bonds all bond 2 undo\ngroup a id 1:4\ndelete_bonds a bond 2":
           ["group turned_off id 1:4", "delete_bonds turned_off bond 2", "group turned_off delete"]}
    for text, lines in off.items():
        scene = ours([*setup(folder), *text.splitlines()]).scene
        if lines is None:
            with pytest.raises(InputError, match="delete_bonds with remove and special"):
                commands(scene.system, scene.interactions, data=tmp_path / "d")
            continue
        written = commands(scene.system, scene.interactions, data=tmp_path / "d")
        assert "\n".join(lines) in "\n".join(written)
        again = ours(written).scene.system.topology
        assert [types.tolist() for *_, types in again] == [types.tolist() for *_, types in scene.system.topology]
    scene.system.topology.frozen, scene.system.topology.bonds[:] = None, scene.system.topology.bonds[0]
    with pytest.raises(InputError, match="bond type 2: items are turned off where others"):
        commands(scene.system, scene.interactions, data=tmp_path / "d")


def test_type_zero_is_a_broken_bond(folder, tmp_path):
    """Bonds of type 0 have no energy, are in no data file and no local values, and delete_bonds can remove them."""
    lmp = ours(setup(folder))
    lmp.scene.system.topology.bond_types[[0, 3]] = 0
    lmp.session.changed()
    lmp.commands_list([f"write_data {tmp_path}/d", "compute d all bond/local dist engpot", "run 0"])
    assert "\n7 bonds\n" in (tmp_path / "d").read_text() and len(items((tmp_path / "d").read_text())["Bonds"]) == 7
    values = lmp.extract_compute("d", 2, 2)
    assert len(values) == 7 and values[:, 1].sum() == pytest.approx(lmp.get_thermo("ebond"))
    lmp.command("delete_bonds all bond 0 remove")
    assert len(lmp.scene.system.topology.bonds) == 7


PAIRS = ["pair_style hybrid lj/cut 4.5 morse 4.0", "pair_coeff 1 1 lj/cut 0.1 2.0", "pair_coeff 2 2 lj/cut 0.2 2.1 4.0",
         "pair_coeff 1 2 morse 0.1 1.5 2.0"]
LABELS = ["labelmap bond 1 A-A 2 A-B", "labelmap angle 1 A-A-A 2 A-B-A", "labelmap dihedral 1 a 2 b", "labelmap improper 1 a 2 b",
          "bond_coeff A-A 100 1.3", "bond_coeff A-B 90 1.2", "angle_coeff A-A-A 30 110", "angle_coeff A-B-A 30 100",
          "dihedral_coeff a 1 1 2", "dihedral_coeff b 1 -1 2", "improper_coeff a 1 1", "improper_coeff b 2 1"]
CLASS2 = ["bond_coeff 1 1.3 100 -30 10", "bond_coeff 2 1.2 90 -20 5", "angle_coeff * 110 30 5 2", "angle_coeff * bb 10 1.5 1.2",
          "angle_coeff * ba 10 2 1.5 1.2", "improper_coeff * 1 0.5", "improper_coeff * aa 1 2 3 100 110 120",
          "dihedral_coeff * 1 2 3 4 5 6", "dihedral_coeff * mbt 1 2 3 1.2", "dihedral_coeff * ebt 1 2 3 4 5 6 1 1",
          "dihedral_coeff * at 1 2 3 4 5 6 100 101",
          "dihedral_coeff * aat 1 100 101", "dihedral_coeff * bb13 1 1.2 1.2"]
OF_CLASS2 = "\n".join(f"{kind}_style class2" for kind in ("bond", "angle", "dihedral", "improper"))
ZERO = "\n".join(f"{kind}_style zero" for kind in ("bond", "angle", "dihedral", "improper"))
# styles, coefficients, whether LAMMPS writes them too
WRITTEN = {"simple": ("", SIMPLE, True), "hybrid": (HYBRID, HYBRID_COEFF, False), "class2": (OF_CLASS2, CLASS2, True),
           "pairs": ("", SIMPLE + PAIRS, False), "labels": ("", LABELS, True),
           "zero": (ZERO, ["bond_coeff * 1.1", "angle_coeff * 100", "dihedral_coeff *", "improper_coeff *"], True)}
READ = r"""
answer = {}
for name, (styles, lines, writes) in given["files"].items():
    lmp = ran([*lines, f"include {given['folder']}/{name}.coeff", *given["end"]])
    answer[name] = {"energies": [lmp.get_thermo(w) for w in given["words"]]}
    if writes:
        lmp.command(f"write_coeff {given['folder']}/theirs")
        answer[name]["text"] = open(f"{given['folder']}/theirs").read()
    lmp.close()
"""


def numbers(text: str) -> list[tuple]:
    """The lines of a file of coefficients, numbers as such."""
    lines = [line.split() for line in text.splitlines() if line.strip() and not line.startswith("#")]
    return sorted((tuple(float(w) if w[0].isdigit() or w[0] in "+-." else w for w in words) for words in lines), key=str)


@pytest.fixture(scope="module")
def written(folder):
    """Energies of ours after write_coeff, and what LAMMPS makes of the files."""
    energies, files = {}, {}
    for name, (styles, coeff, writes) in WRITTEN.items():
        lmp = ours([*head(folder / "d", styles=styles), *coeff, *END, f"write_coeff {folder}/{name}.coeff"])
        energies[name] = [lmp.get_thermo(w) for w in WORDS]
        pair = [line for line in coeff if line.startswith("pair_style")]
        files[name] = ("", [*(line for line in head(folder / "d", styles=styles) if not line.startswith("pair_coeff")), *pair], writes)
    return energies, files, ask(READ, files=files, folder=str(folder), end=END, words=WORDS)


@pytest.mark.parametrize("name", WRITTEN)
def test_write_coeff(written, folder, name):
    """The file says the same as LAMMPS's, and gives the same energies when LAMMPS or asemd reads it."""
    energies, files, theirs = written
    np.testing.assert_allclose(energies[name], theirs[name]["energies"], rtol=1e-11, atol=1e-11)
    lmp = ours([*files[name][1], f"include {folder}/{name}.coeff", *END])
    np.testing.assert_allclose([lmp.get_thermo(w) for w in WORDS], energies[name], rtol=1e-13, atol=1e-13)
    if files[name][2]:
        assert numbers((folder / f"{name}.coeff").read_text()) == numbers(theirs[name]["text"])


@pytest.mark.parametrize("name", ["hybrid", "class2", "labels"])
def test_coefficients_travel_through_data_files(written, folder, name, tmp_path):
    styles, coeff, _ = WRITTEN[name]
    ours([*head(folder / "d", styles=styles), *coeff, f"write_data {tmp_path}/d", f"write_data {tmp_path}/labels types labels"])
    for path in ("d", "labels"):
        lines = [line for line in head(tmp_path / path, styles=styles) if not line.startswith("pair_coeff")]
        lmp = ours([*lines, *END])
        np.testing.assert_allclose([lmp.get_thermo(w) for w in WORDS], written[0][name], rtol=1e-12, atol=1e-12)


def test_rest_values(folder):
    """The lengths and angles that LAMMPS's SHAKE holds."""
    theirs = ask(SHAKEN, rest=REST, path=str(folder / "water"))
    for (category, style, coeff), expected in zip(REST, theirs, strict=True):
        lmp = ours(["units real", "atom_style full", f"{category}_style {style}", f"read_data {folder}/water",
                    f"{category}_coeff 1 {coeff}"])
        assert lmp.scene.interactions.rest_values(category, 1)[1] == pytest.approx(expected, abs=1e-6), f"{category} {style}"


def test_rest_values_of_a_hybrid(folder):
    lmp = ours([*head(folder / "d", styles=HYBRID), *HYBRID_COEFF])
    inter = lmp.scene.interactions
    assert inter.rest_values("bond", 2)[1:].tolist() == [1.3, 1.2] and inter.rest_values("angle", 2)[1:].tolist() == [110.0, 100.0]
    assert np.isnan(inter.rest_values("dihedral", 2)).all()


@pytest.mark.parametrize(("line", "message"), [
    ("delete_bonds nobody multi", "unknown group 'nobody'"), ("delete_bonds all mlti", "did you mean multi"),
    ("delete_bonds all", "needs 2 values"),
    ("delete_bonds all bond", "needs 1 value"), ("delete_bonds all bond 3", "outside the valid range 1 to 2"),
    ("delete_bonds all bond 1 undoo", "did you mean undo"), ("delete_bonds all stats remove", "takes no keywords"),
    ("create_bonds", "needs 1 value"), ("create_bonds single/bnd 1 1 2", "did you mean single/bond"),
    ("create_bonds single/bond 3 1 5", "outside the valid range"), ("create_bonds single/bond * 1 5", "one bond type"),
    ("create_bonds single/bond 1 1 1", "must be different"), ("create_bonds single/bond 1 1 50", "no atom with ID 50"),
    ("create_bonds single/angle 1 1 5", "needs 4 values"), ("create_bonds single/bond 1 1 5 special maybe", "yes or no"),
    ("create_bonds single/bond 1 1 5 specil yes", "did you mean special"), ("create_bonds many g h 1 3 2", "must not exceed"),
    ("create_bonds many g nobody 1 0 2", "unknown group"), ("create_bonds many g h 1 0 2 special no", "takes no keywords"),
    ("create_bonds many g h 1 0", "needs 5 values"), ("write_coeff", "needs 1 value"), ("write_coeff /nowhere/at/all", "cannot write"),
])
def test_mistakes(folder, line, message):
    lmp = ours([*head(folder / "d"), *GROUPS])
    with pytest.raises(InputError, match=message):
        lmp.command(line)


def test_more_mistakes(folder):
    lmp = ours([*head(folder / "d", special="lj/coul 0.5 0 0.5"), *GROUPS])
    with pytest.raises(InputError, match="1-2 pairs the weight 0.0"):
        lmp.command("create_bonds many g h 1 0 2")
    box = ["region b block 0 1 0 1 0 1", "create_box 1 b"]
    for line in ("delete_bonds all multi", "create_bonds single/bond 1 1 2"):
        with pytest.raises(InputError, match="atomic has no bonds"):
            ours([*box, line])
        with pytest.raises(InputError, match="before simulation box is defined"):
            ours([line])
    with pytest.raises(InputError, match="no pair, bond"):
        ours([*box, "write_coeff x"])
