"""Pair styles of ions whose charges may flow (coul/ctip, coul/streitz) against LAMMPS; forces as the gradient; files with mistakes."""
from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest
from both import lines_of
from wheel import ask

from asemd.errors import InputError, SimulationError
from asemd.lammps import Lammps
from asemd.pair.coul_ctip import coul_ctip

COLUMNS = ("evdwl", "ecoul", "elong", "pxx", "pyy", "pzz", "pxy", "pxz", "pyz")
CTIP = "Ni -5.84 14.15739 0.54929 0 0 0 0.2 100\n# oxygen\nO 0.5 15.655862 1.428571 0 0 -0.3 0.1 80\n"
STREITZ = "Al 0.1 10.328655 0 1.968438 0.763905\nO 5.484763 14.035715 0 2.143957 0.2\n"
SCENE = """
units metal
atom_style {atoms}
{before}
lattice custom 4.2 a1 1 0 0 a2 0 1 0 a3 0 0 1 {basis}
region b block 0 {cells} 0 {cells} 0 {cells}
create_box 2 b {bonds}
create_atoms 1 box basis 5 2 basis 6 2 basis 7 2 basis 8 2
mass * 20
displace_atoms all random 0.06 0.06 0.06 4711
change_box all triclinic
change_box all xy final 0.7 yz final -0.4 remap
variable q atom 0.2*(id%4)-0.3
set group all charge v_q
{pair}
compute e all pe/atom pair
compute s all stress/atom NULL pair
thermo_style custom step evdwl ecoul elong pxx pyy pzz pxy pxz pyz
"""
SOLVER = "\nkspace_style ewald 1e-4\nkspace_modify gewald 0.7"
BONDS = ("full", "bond_style zero", "bond/types 1 extra/bond/per/atom 6 extra/special/per/atom 40")
PLACES = ("0 0 0", "0.5 0.5 0", "0.5 0 0.5", "0 0.5 0.5", "0.5 0.5 0.5", "0.5 0 0", "0 0.5 0", "0 0 0.5")
CASES = {      # pair style and what follows, atom style, commands before and after the atoms are there
    "coul/ctip": ("pair_style coul/ctip 0.3 6.5\npair_coeff * * {file} Ni O", "charge", "", ""),
    "coul/ctip one element": ("pair_style coul/ctip 0.0 6.0\npair_coeff * * {file} O O", "charge", "", ""),
    "coul/ctip bonds": ("pair_style coul/ctip 0.3 4.0\npair_coeff * * {file} Ni O\nbond_coeff *\ncreate_bonds many all all 1 0.1 2.1\n"
                        "special_bonds coul 0.4 0.3 0.5",
                        *BONDS),
    "coul/ctip bonds left out": ("pair_style coul/ctip 0.3 4.0\npair_coeff * * {file} Ni O\nbond_coeff *\n"
                                 "create_bonds many all all 1 0.1 2.1\nspecial_bonds coul 0 0.3 0.5", *BONDS),
    "coul/streitz wolf": ("pair_style coul/streitz 6.5 wolf 0.31\npair_coeff * * {file} Al O", "charge", "", ""),
    "coul/streitz one element": ("pair_style coul/streitz 6.5 wolf 0.2\npair_coeff * * {file} O O", "charge", "", ""),
    "coul/streitz ewald": ("pair_style coul/streitz 6.5 ewald\npair_coeff * * {file} Al O" + SOLVER, "charge", "", ""),
    "coul/streitz overlay": ("pair_style hybrid/overlay coul/streitz 6.5 wolf 0.31 lj/cut 6\npair_coeff * * coul/streitz {file} Al O\n"
                             "pair_coeff * * lj/cut 0.01 2", "charge", "", ""),
}
THEIRS = """
import numpy as np
answer = {}
for name, lines in given["cases"].items():
    lmp = ran(lines)
    n = int(lmp.get_natoms())
    order = np.argsort(lmp.numpy.extract_atom("id")[:n])
    answer[name] = {"thermo": [lmp.get_thermo(c) for c in given["columns"]], "f": np.array(lmp.numpy.extract_atom("f"))[:n][order],
                    "e": np.array(lmp.numpy.extract_compute("e", 1, 1))[:n][order],
                    "s": np.array(lmp.numpy.extract_compute("s", 1, 2))[:n][order]}
    answer[name] = {k: np.array(v).tolist() for k, v in answer[name].items()}
    lmp.close()
"""


def script(name: str, folder, cells: int = 2) -> str:
    pair, atoms, before, bonds = CASES[name]
    text = CTIP if "ctip" in name else STREITZ
    file = folder / name.replace("/", "_").replace(" ", "_")
    file.write_text(text if "one element" not in name else text[text.index("O "):])      # LAMMPS crashes where it does not use all of it
    return SCENE.format(pair=pair.format(file=file), atoms=atoms, before=before, bonds=bonds, cells=cells,
                        basis=" ".join(f"basis {p}" for p in PLACES))


@pytest.fixture(scope="module")
def theirs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("ions")
    scripts = {name: lines_of(script(name, folder) + "run 0\n") for name in CASES}
    # one process for each: after coul/ctip LAMMPS does not survive another scene
    return {name: ask(THEIRS, cases={name: lines}, columns=COLUMNS)[name] for name, lines in scripts.items()}


@pytest.mark.parametrize("name", CASES)
def test_like_lammps(theirs, name, tmp_path):
    mine, want = Lammps(cmdargs=["-log", "none", "-screen", "none", "-compat", "lammps"]), theirs[name]
    mine.commands_string(script(name, tmp_path) + "run 0\n")
    n = len(want["f"])
    got = {"f": np.reshape(mine.gather_atoms("f", 1, 3), (n, 3)), "e": mine.numpy.extract_compute("e", 1, 1),
           "s": mine.numpy.extract_compute("s", 1, 2), "thermo": [mine.get_thermo(c) for c in COLUMNS]}
    for key, values in got.items():
        np.testing.assert_allclose(values, want[key], rtol=1e-11, atol=1e-12 * np.abs(want[key]).max(), err_msg=key)


@pytest.mark.parametrize("name", [name for name in CASES if "bonds" not in name])
def test_forces_are_the_gradient(name, tmp_path):
    """Along a direction, and the virial along a strain; with LAMMPS's erfc, which is good to 1.5e-7, to 5e-5."""
    mine = Lammps(cmdargs=["-log", "none", "-screen", "none"])
    mine.commands_string(script(name, tmp_path) + "run 0\n")
    engine, rng = mine.session.loop.engine, np.random.default_rng(3)
    system = engine.system
    direction, strain = rng.normal(size=system.x.shape), rng.normal(size=(3, 3))
    strain += strain.T

    def at(h, e):
        new = system.copy()
        new.x = (system.x + h * direction - system.box.origin) @ (np.eye(3) + e * strain) + system.box.origin
        new.box = replace(system.box, cell=system.box.cell @ (np.eye(3) + e * strain))
        return type(engine)(new, engine.interactions, engine.settings).compute()

    here, h = at(0.0, 0.0), 1e-5
    w = here.virial[[0, 3, 4, 3, 1, 5, 4, 5, 2]].reshape(3, 3)
    for step, want in (((h, 0.0), -(here.forces * direction).sum()), ((0.0, h), -(w * strain).sum())):
        slope = (at(*step).potential - at(*(-s for s in step)).potential) / (2.0 * h)
        assert slope == pytest.approx(want, rel=5e-5 if name == "coul/ctip" else 1e-8, abs=1e-6)


@pytest.mark.parametrize("style, file, message", [
    ("coul/ctip 0.3 6.5", CTIP.replace("1.428571", "0"), "element O: gamma must be positive.*ctip:3"),
    ("coul/ctip 0.3 6.5", CTIP.replace("-0.3 0.1", "0.3 0.1"), "qmin must not be above qmax"),
    ("coul/ctip 0.3 6.5", CTIP + "Ni 1 1 1 1 1 1 1 1", "element Ni: it is there twice"),
    ("coul/ctip 0.3 6.5", CTIP.replace("0.54929", "nan"), "gamma must be a number"),
    ("coul/ctip 0.3 6.5", CTIP.replace("15.655862", "x"), "eta must be a number, got 'x'"),
    ("coul/ctip 0.3 6.5", CTIP[:60], "the last entry needs 9 words|not in the potential file"),
    ("coul/ctip 0.3 0", CTIP, "cutoff must be more than 0"),
    ("coul/ctip 0.3", CTIP, "cut"),
    ("coul/ctip 0.3 6.5", "# UNITS: real\n" + CTIP, "the file is in real units, but metal units are in use"),
    ("coul/streitz 6.5 wolf", STREITZ, "wolf needs alpha"),
    ("coul/streitz 6.5 ewald 0.3", STREITZ, "ewald takes no alpha"),
    ("coul/streitz 6.5 pppm", STREITZ, "the sum must be wolf or ewald"),
    ("coul/streitz 6.5 ewald", STREITZ, "needs a kspace_style, such as pppm"),
    ("coul/streitz 6.5 wolf 0.3", STREITZ.replace("Al", "Ni").replace("0 1.96", "0.1 1.96"), "element Ni: gamma must be 0.*streitz:1"),
    ("coul/streitz 6.5 wolf 0.3", STREITZ, "element Ni is not in the potential file"),
])
def test_refused(style, file, message, tmp_path):
    path = tmp_path / style[5:].split()[0]
    path.write_text(file)
    elements = "Al O" if "kspace" in message else "Ni O"
    lines = SCENE.format(pair=f"pair_style {style}\npair_coeff * * {path} {elements}", atoms="charge", before="", bonds="", cells=1,
                         basis=" ".join(f"basis {p}" for p in PLACES))
    with pytest.raises(InputError, match=message):
        Lammps(cmdargs=["-log", "none", "-screen", "none"]).commands_string(lines + "run 0\n")


def test_weights_of_bonded_ions(tmp_path):
    """With a solver the style has none; a warning says so, and weights of 0, for which LAMMPS keeps the pairs too, are refused."""
    file, energies = tmp_path / "file", []
    file.write_text(STREITZ)
    atoms, before, bonds = BONDS
    pair = f"pair_style coul/streitz 4.0 ewald\npair_coeff * * {file} Al O" + SOLVER
    lines = SCENE.format(pair=pair, atoms=atoms, before=before, bonds=bonds, cells=2, basis=" ".join(f"basis {p}" for p in PLACES))
    lines += "bond_coeff *\ncreate_bonds many all all 1 0.1 2.1\nspecial_bonds coul "
    for weights in ("1 1 1", "0.4 0.3 0.5"):
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            mine = Lammps(cmdargs=["-log", "none", "-screen", "none"])
            mine.commands_string(f"{lines}{weights}\nrun 0\n")
        energies.append(mine.get_thermo("pe"))
        assert any("special_bonds has no effect" in str(w.message) for w in told) == (weights != "1 1 1")
    assert energies[1] == pytest.approx(energies[0], rel=1e-13)
    with pytest.raises(InputError, match="knows no weights"):
        Lammps(cmdargs=["-log", "none", "-screen", "none"]).commands_string(f"{lines}0 0.3 0.5\nrun 0\n")


def test_coinciding_ions_are_named(tmp_path):
    for name in ("coul/ctip", "coul/streitz wolf"):
        mine = Lammps(cmdargs=["-log", "none", "-screen", "none"])
        with pytest.raises(SimulationError, match="coincide"):
            mine.commands_string(script(name, tmp_path, 1) + "set atom 1*2 x 1.0 y 1.0 z 1.0\nrun 0\n")


def test_second_derivative():
    for r in (0.3, 1.1, 3.0, 6.2):
        numbers = -302.0, 0.4, 0.1, -0.02, 0.003, 0.0, 0.0, 6.5      # without damping: LAMMPS's erfc is not smooth to these digits
        slopes = [coul_ctip(r * r * (1.0 + 1e-5 * k), *numbers)[1] for k in (-2, -1, 1, 2)]
        want = (slopes[0] - 8.0 * slopes[1] + 8.0 * slopes[2] - slopes[3]) / (12e-5 * r * r)
        assert coul_ctip.d2(r * r, *numbers) == pytest.approx(want, rel=1e-6)
