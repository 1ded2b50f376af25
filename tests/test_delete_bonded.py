"""delete_atoms in molecules: what is torn, what stays listed, which pairs stay partners; LAMMPS's numbers."""
from __future__ import annotations

import re

import numpy as np
import pytest
from both import asemd, lines_of
from wheel import ask

from asemd.errors import InputError, SimulationError

COLUMNS = ("evdwl", "ebond", "eangle", "edihed", "pxx")


def write_data(folder) -> str:
    """Two zigzag chains of eight atoms with bonds, angles and dihedrals; returns the path."""
    rng = np.random.default_rng(5)
    x = np.array([(2 + 1.3 * k, 4 + 6 * c + 0.6 * (k % 2), 8 + 0.3 * (k // 2)) for c in range(2) for k in range(8)])
    x += rng.normal(0, 0.05, x.shape)
    items = {"Bonds": 2, "Angles": 3, "Dihedrals": 4}
    rows = {name: [[8 * c + k + 1 + m for m in range(width)] for c in range(2) for k in range(9 - width)] for name, width in items.items()}
    text = ["chains", "", "16 atoms", *(f"{len(r)} {name.lower()}" for name, r in rows.items()), "3 atom types"]
    text += [*(f"2 {name.lower()[:-1]} types" for name in items), *(f"0 16 {a}lo {a}hi" for a in "xyz"), "", "Masses", ""]
    text += ["1 12", "2 1", "3 16", "", "Atoms # molecular", ""]
    text += [f"{n + 1} {n // 8 + 1} {n % 3 + 1} {p[0]:.6f} {p[1]:.6f} {p[2]:.6f}" for n, p in enumerate(x)]
    for name, r in rows.items():
        text += ["", name, "", *(f"{k + 1} {1 + k % 2} {' '.join(map(str, ids))}" for k, ids in enumerate(r))]
    (folder / "chains.data").write_text("\n".join(text) + "\n")
    return str(folder / "chains.data")


def scene(path: str) -> str:
    return f"""
    units real
    atom_style molecular
    pair_style lj/cut 6.0
    bond_style harmonic
    angle_style harmonic
    dihedral_style harmonic
    special_bonds lj 0 0.3 0.5
    read_data {path}
    pair_coeff * * 0.1 2.5
    bond_coeff * 100 1.5
    angle_coeff * 20 120
    dihedral_coeff * 0.5 1 2
    group two type 2
    group three id 3 12
    group one id 1:8
    velocity all create 300 4829 loop geom
    fix 1 all nve
    """


IGNORE = "thermo_modify lost/bond ignore\n"
CASES = {
    "bond yes": "delete_atoms group two bond yes\nrun 2",
    "mol yes": "group five id 5\ndelete_atoms group five mol yes\nrun 0",
    "bond and mol": "group five id 5\ndelete_atoms group five compress no mol yes bond yes\nrun 0",
    "random": "delete_atoms random fraction 0.3 yes all NULL 482793 bond yes\nrun 2",
    "overlap": "delete_atoms overlap 5.0 all two bond yes\nrun 0",
    "torn": IGNORE + "delete_atoms group two\nrun 2\nwrite_data FILE",
    "torn twice": IGNORE + "delete_atoms group two\ndelete_atoms group three\nrun 2\nwrite_data FILE",
    "torn and taken away": IGNORE + "delete_atoms group two\ndelete_atoms group three bond yes\nrun 2\nwrite_data FILE",
    "off and torn": IGNORE + "delete_bonds all bond 1\ndelete_atoms group two\nrun 2",
    "off and deleted": "delete_bonds all bond 1\ndelete_atoms group two bond yes\nrun 2",
    "partners anew": "delete_atoms group two bond yes\nspecial_bonds lj 0 0.2 0.5\nrun 0",
    "partners anew by delete_bonds": "delete_atoms group two bond yes\ndelete_bonds all multi special\nrun 0",
    "partners anew by ids": "delete_atoms group two bond yes\nreset_atoms id\nrun 0",
    "partners of copies": "delete_atoms group two bond yes\nreplicate 2 1 1\nrun 0",
    "partners stay": "delete_atoms group two bond yes\ncreate_atoms 1 single 14 14 14\nrun 2",
    "partners by angle": "special_bonds lj 0 0.3 0.5 angle yes\ndelete_atoms group two bond yes\nrun 0",
    "minimum": IGNORE + "delete_atoms group two\nminimize 0 0 3 10",
    "newton off": "newton on off\n" + IGNORE + "delete_atoms group two\nrun 2\nwrite_data FILE",
}
THEIRS = """
import numpy as np
answer = {}
for name, lines in given["cases"].items():
    lmp = ran(lines)
    ids = np.array(lmp.numpy.extract_atom("id"))[:lmp.extract_setting("nlocal")]
    order = np.argsort(ids)
    values = {key: np.array(lmp.numpy.extract_atom(key))[:len(ids)][order].tolist() for key in ("x", "f", "type", "molecule")}
    answer[name] = {"id": ids[order].tolist(), "thermo": [lmp.get_thermo(c) for c in given["columns"]], **values}
    lmp.close()
"""


def script(name: str, folder, path: str, mark: str) -> str:
    text, case = scene(path), CASES[name]
    if case.startswith("newton"):
        first, _, case = case.partition("\n")
        text = first + text
    return text + case.replace("FILE", str(folder / f"{mark} {name}.data".replace(" ", "_")))


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    folder = tmp_path_factory.mktemp("delete")
    path = write_data(folder)
    cases = {name: lines_of(script(name, folder, path, "theirs").replace("\n    ", "\n")) for name in CASES}
    return folder, path, ask(THEIRS, cases=cases, columns=COLUMNS)


def items_of(path) -> dict[str, list]:
    """Bonds, angles and dihedrals of a data file, without their numbers, sorted; the counts of the header."""
    text = path.read_text()
    out = {"counts": sorted(re.findall(r"^(\d+ (?:bonds|angles|dihedrals))$", text, re.M))}
    for name in ("Bonds", "Angles", "Dihedrals"):
        found = re.search(rf"^{name}\n\n((?:\d.*\n)+)", text, re.M)
        out[name] = sorted(tuple(map(int, line.split()[1:])) for line in found[1].splitlines()) if found else []
    return out


@pytest.mark.filterwarnings("ignore::asemd.errors.InputWarning")
@pytest.mark.parametrize("name", CASES)
def test_like_lammps(both, name):
    folder, path, theirs = both
    session = asemd(script(name, folder, path, "ours").replace("\n    ", "\n"))
    system, expected = session.scene.system, theirs[name]
    order = np.argsort(system.id)
    assert system.id[order].tolist() == expected["id"] and system.type[order].tolist() == expected["type"]
    for mine, other in ((system.x[order], expected["x"]), (system.f[order], expected["f"])):
        np.testing.assert_allclose(mine, other, rtol=0, atol=1e-10 * np.abs(other).max())
    values = [session.variables.evaluate(c) for c in COLUMNS]
    np.testing.assert_allclose(values, expected["thermo"], rtol=1e-10, atol=1e-10)
    if "FILE" in CASES[name]:
        ours, other = (items_of(folder / f"{mark} {name}.data".replace(" ", "_")) for mark in ("ours", "theirs"))
        if name == "newton off":        # there LAMMPS may write an item with any of its atoms
            ours, other = ({k: len(v) if k != "counts" else v for k, v in found.items()} for found in (ours, other))
        assert ours == other


def test_torn_items_stop_a_run_or_warn(tmp_path):
    session = asemd(scene(write_data(tmp_path)))
    with pytest.warns(match="bonds, 12 angles, 10 dihedrals lose some of their atoms"):
        session.execute("delete_atoms group two")
    with pytest.raises(SimulationError, match="Bond atoms 1 2 missing.*delete_atoms"):
        session.execute("run 0")
    with pytest.raises(InputError, match="reset_atoms id: .* lack atoms"):
        session.execute("reset_atoms id")
    session.execute("thermo_modify lost/bond warn")
    with pytest.warns(match="Dihedral atoms .* missing"):
        session.execute("run 0")


@pytest.mark.filterwarnings("ignore::asemd.errors.InputWarning")
def test_restart_keeps_what_is_torn(tmp_path):
    session = asemd(scene(write_data(tmp_path)) + f"    delete_atoms group two\n    write_restart {tmp_path}/r")
    again = asemd(f"read_restart {tmp_path}/r")
    assert [(k, t, tuple(i)) for k, t, i in again.scene.system.torn] == session.scene.system.torn and len(session.scene.system.torn) > 10
