"""Charges in different media (atom style dielectric): LAMMPS's forces, one medium as elsewhere, files, words."""
from __future__ import annotations

import os

import numpy as np
import pytest
from both import asemd, lines_of
from wheel import ask

from asemd.errors import InputError

COLUMNS = ("evdwl", "ecoul", "elong", "pxx", "pyy", "pzz", "pxy", "pxz", "pyz")
SHARED = ("q", "q_scaled", "area", "ed", "em", "epsilon", "curvature", "mux", "muy", "muz", "mu")
MESH = "\nkspace_modify gewald 0.6 mesh 16 16 16"
ATTRACTION = " gewald/disp 0.5 mesh/disp 12 12 12 mix/disp geom"
DISP = MESH + ATTRACTION
LJ = "pair_coeff * * 0.1 2.5\npair_coeff 2 2 0.2 2.0 "
TEXT = """units real
atom_style {atoms}
bond_style zero
read_data {data}
bond_coeff *
special_bonds lj 0.3 0.5 0.5 coul 0.4 0.4 0.5
{pair}
pair_modify table 0 table/disp 0
{more}
compute ea all pe/atom pair
fix keep all ave/atom 1 1 1 c_ea
thermo_style custom step {columns}
run 0
"""
# each solver has kernels of its own: all run without the compiler, some with it
uncompiled = pytest.mark.skipif(not os.environ.get("NUMBA_DISABLE_JIT"), reason="minutes to compile: run with NUMBA_DISABLE_JIT=1")
CASES = {
    "coul/cut/dielectric": "pair_style coul/cut/dielectric 4.0\npair_coeff * *\npair_coeff 2 2 3.0",
    "lj/cut/coul/cut/dielectric": "pair_style lj/cut/coul/cut/dielectric 3.0 4.0\n" + LJ + "2.5 3.5\npair_modify shift yes",
    "lj/cut/coul/debye/dielectric": "pair_style lj/cut/coul/debye/dielectric 0.3 3.0 4.0\n" + LJ + "2.5 3.5",
    "coul/long/dielectric": "pair_style coul/long/dielectric 4.0\npair_coeff * *\nkspace_style pppm/dielectric 1e-4",
    "lj/cut/coul/long/dielectric": "pair_style lj/cut/coul/long/dielectric 3.0 4.0\n" + LJ + "\nkspace_style pppm/dielectric 1e-4" + MESH,
    "lj/long/coul/long/dielectric cut": "pair_style lj/long/coul/long/dielectric cut long 3.0 4.0\n" + LJ
                                        + "\nkspace_style pppm/dielectric 1e-4" + MESH,
    "lj/long/coul/long/dielectric long": "pair_style lj/long/coul/long/dielectric long long 4.0\n" + LJ
                                         + "\nkspace_style pppm/disp/dielectric 1e-4" + DISP,
    "lj/long/coul/long/dielectric mesh": "pair_style lj/long/coul/long/dielectric long long 4.0\n" + LJ
                                         # gewald: found by differences of estimates, it has noise of 1e-12
                                         + "\nkspace_style pppm/disp/dielectric 1e-3\nkspace_modify gewald 0.6" + ATTRACTION,
}
THEIRS = """
import numpy as np
answer = {}
for name, lines in given["cases"].items():
    lmp = start()
    try:
        for line in lines:
            lmp.command(line)
        n = lmp.get_natoms()
        order = np.argsort(np.array(lmp.numpy.extract_atom("id"))[:n])
        answer[name] = {"thermo": [lmp.get_thermo(c) for c in given["columns"]],
                        "f": np.array(lmp.numpy.extract_atom("f"))[:n][order].tolist(),
                        "e": np.array(lmp.numpy.extract_compute("ea", 1, 1))[:n][order].tolist()}
    except Exception as e:
        answer[name] = {"error": str(e)}
    lmp.close()
"""


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    """24 ions, two of them bonded, with normals and media of their own, as a file; and the same as atoms of style full."""
    rng, folder, n = np.random.default_rng(3), tmp_path_factory.mktemp("ions"), 24
    x = np.array([(i, j, k) for i in range(3) for j in range(3) for k in range(3)][:n]) * 3.0 + 0.7 + rng.uniform(-0.5, 0.5, (n, 3))
    q = np.where(np.arange(n) % 2 == 0, 1, -1) * rng.uniform(0.5, 1.2, n).round(3)
    q[-1] -= q.sum()
    more = np.column_stack([rng.normal(size=(n, 3)), rng.uniform(0.5, 2, n), rng.uniform(-5, 5, n), rng.uniform(2, 20, n),
                            rng.uniform(1, 10, n), rng.uniform(0, 1.5, n)])
    for style, rows in (("dielectric", more), ("full", more[:, :0])):
        atoms = "\n".join(" ".join(map(repr, [i + 1, 1, 1 + i % 2, *map(float, [q[i], *x[i], *rows[i]])])) for i in range(n))
        (folder / style).write_text(f"ions\n\n{n} atoms\n2 atom types\n1 bonds\n1 bond types\n\n0 9 xlo xhi\n0 9 ylo yhi\n0 9 zlo zhi\n\n"
                                    f"Masses\n\n1 1.0\n2 2.0\n\nAtoms # {style}\n\n{atoms}\n\nBonds\n\n1 1 1 2\n")
    return folder


def script(data, pair: str, more: str = "", atoms: str = "dielectric") -> str:
    return TEXT.format(data=data / atoms, atoms=atoms, pair=pair, more=more, columns=" ".join(COLUMNS))


def row(session) -> np.ndarray:
    return np.array([session.variables.evaluate(c) for c in COLUMNS])


@pytest.fixture(scope="module")
def theirs(data):
    return ask(THEIRS, cases={name: lines_of(script(data, pair)) for name, pair in CASES.items()}, columns=COLUMNS)


def marked(names, compiled: tuple[str, ...]):
    return [pytest.param(name, marks=() if name in compiled else uncompiled) for name in names]


@pytest.mark.parametrize("name", marked(CASES, ("coul/cut/dielectric",)))
def test_like_lammps(theirs, data, name):
    expected = theirs[name]
    assert "error" not in expected, expected
    session = asemd(script(data, CASES[name]))
    wanted = np.array(expected["f"])
    np.testing.assert_allclose(session.scene.system.f, wanted, rtol=0, atol=1e-12 * np.abs(wanted).max())
    # with a solver LAMMPS counts the virial twice, and the energy of pppm/disp too
    kept = slice(0, 2) if "disp/" in CASES[name] else slice(0, 3) if "long" in name else slice(0, 9)
    np.testing.assert_allclose(row(session)[kept], np.array(expected["thermo"])[kept], rtol=1e-11, atol=1e-11)
    if "long" not in name:
        np.testing.assert_allclose(session.moment.per_atom("ea"), expected["e"], rtol=1e-11, atol=1e-11)


SOLVED = {
    "lj/cut/coul/cut": "",
    "lj/cut/coul/long": "\nkspace_style pppm{} 1e-4" + MESH,
    "lj/cut/coul/msm": "\nkspace_style msm{} 1e-3\nkspace_modify pressure/scalar no cutoff/adjust no mesh 8 8 8",
    "lj/long/coul/long long long": "\nkspace_style pppm/disp{} 1e-4" + DISP,
}


@pytest.mark.parametrize("name", marked(SOLVED, ("lj/cut/coul/cut",)))
def test_one_medium_is_a_dielectric_constant(data, name):
    style, _, words = name.partition(" ")
    pair = f"pair_style {style}{{}} {words} {'4.0' if words else '3.0 4.0'}\n{LJ}" + SOLVED[name]
    shares = "compute e all pe/atom\ncompute s all stress/atom NULL\nfix k2 all ave/atom 1 1 1 c_e c_s[1]"
    if SOLVED[name]:        # of weighted pairs LAMMPS's energy is another one
        shares += "\nspecial_bonds lj 0.3 0.5 0.5 coul 1 1 1"
    ours = asemd(script(data, pair.format("/dielectric", "/dielectric"), "set group all epsilon 2.5\n" + shares))
    plain = asemd(script(data, pair.format("", ""), "dielectric 2.5\n" + shares, "full"))
    np.testing.assert_allclose(row(ours), row(plain), rtol=1e-11)
    f = plain.scene.system.f
    np.testing.assert_allclose(ours.scene.system.f, f, rtol=0, atol=1e-12 * np.abs(f).max())
    for k in "es":
        np.testing.assert_allclose(ours.moment.per_atom(k), plain.moment.per_atom(k), rtol=1e-9, atol=1e-8)


@uncompiled
def test_forces_and_pressure_do_not_depend_on_what_the_solver_does(data):
    runs = [asemd(script(data, f"pair_style {pair}\npair_coeff * * {words}\nkspace_style {solver}")) for pair, words, solver in (
        ("coul/long/dielectric 4.4", "", "pppm/dielectric 1e-5\nkspace_modify gewald 0.8 mesh 24 24 24 order 7"),
        ("coul/long/dielectric 4.0", "", "pppm/dielectric 1e-5\nkspace_modify gewald 0.9 mesh 24 24 24 order 7"),
        ("lj/cut/coul/msm/dielectric 4.4", "0 1", "msm/dielectric 1e-5\nkspace_modify mesh 16 16 16 cutoff/adjust no"))]
    f, thermo = runs[0].scene.system.f, row(runs[0])
    for other, limit in zip(runs[1:], (1e-4, 1e-3)):
        np.testing.assert_allclose(other.scene.system.f, f, rtol=0, atol=limit * np.abs(f).max())
        np.testing.assert_allclose(row(other)[3:], thermo[3:], rtol=0, atol=limit * np.abs(thermo[3:]).max())


def test_files_and_properties(data, tmp_path):
    names = " ".join(SHARED)
    pair = f"{CASES['coul/cut/dielectric']}\ncompute p all property/atom {names}\nset atom 3 epsilon 7.5\nset atom 3 dipole 1 2 3"
    session = asemd(script(data, pair) + f"write_data {tmp_path / 'dielectric'} nocoeff\n")
    system = session.scene.system
    q, scaled, _, _, _, epsilon, *_, mu = session.moment.per_atom("p").T
    np.testing.assert_array_equal(scaled, q / epsilon)
    assert epsilon[2] == 7.5 and mu[2] == pytest.approx(14.0**0.5)
    again = asemd(script(tmp_path, CASES["coul/cut/dielectric"])).scene.system
    for name in ("mu", "area", "ed", "em", "epsilon", "curvature"):
        np.testing.assert_array_equal(again.extra[name], system.extra[name])
    np.testing.assert_array_equal(again.q, system.q)
    # normals are no dipoles: the energy in the field is that of the charges
    field = asemd(script(data, CASES["coul/cut/dielectric"], "fix e all efield 1 2 3"))
    want = -field.loop.units.qe2f * float(system.q @ (system.box.unwrap(system.x, system.image) @ np.array([1.0, 2.0, 3.0])))
    assert field.variables.evaluate("f_e") == pytest.approx(want, rel=1e-12)


PAIR = "pair_style coul/cut/dielectric 4\npair_coeff * *\n"


@pytest.mark.parametrize("atoms, line, message", [
    ("full", PAIR, "use atom_style dielectric"),
    ("dielectric", "pair_style coul/cut 4\npair_coeff * *", "knows nothing of the dielectric constants"),
    ("dielectric", "pair_style coul/cut/dielectric 4\npair_coeff * * 1 2", "got 2 values"),
    ("dielectric", "pair_style lj/cut/coul/cut/dielectric 4\npair_coeff * *", "epsilon"),
    ("dielectric", PAIR + "set atom 1 epsilon 0.0", "must be positive"),
    ("full", PAIR + "set atom 1 epsilon 2.0", "has no dielectric constants"),
    ("dielectric", "pair_style coul/long/dielectric 4\npair_coeff * *", "needs a kspace_style, such as pppm/dielectric"),
    ("dielectric", "pair_style coul/long/dielectric 4\npair_coeff * *\nkspace_style pppm 1e-4", "needs a pair style"),
    ("full", "pair_style coul/long 4\npair_coeff * *\nkspace_style pppm/dielectric 1e-4", "needs a pair style"),
    ("dielectric", PAIR + "compute 1 all pair/local eng\ndump 1 all local 1 /dev/null c_1", "single pairs are not available"),
    ("full", "pair_style coul/cut 4\npair_coeff * *\ncompute 1 all property/atom area", "has no dielectric constants"),
])
def test_words(data, atoms, line, message):
    with pytest.raises(InputError, match=message):
        asemd(script(data, line, atoms=atoms))


def test_a_file_with_a_constant_that_cannot_be_is_refused(data, tmp_path):
    text = (data / "dielectric").read_text().split("\n")
    at = next(k for k, line in enumerate(text) if line.startswith("4 1 "))
    words = text[at].split()
    text[at] = " ".join([*words[:-2], "-1.0", words[-1]])
    (tmp_path / "dielectric").write_text("\n".join(text))
    with pytest.raises(InputError, match="invalid epsilon -1 of atom 4") as e:
        asemd(script(tmp_path, PAIR))
    assert str(at + 1) in str(e.value)
