"""Pair style table: reading files, interpolation, and what is wrong with a file."""
from __future__ import annotations

import math

import numpy as np
import pytest
from test_pair_styles import ask_lammps

from asemd import style, tabulated, units
from asemd.errors import InputError

TABLE = style.find("pair", "table")
HEADS = {"list": "N 60", "R": "N 60 R 1.0 5.0", "slopes": "N 60 R 1.0 5.0 FPRIME -500 0.3", "RSQ": "N 60 RSQ 1.0 5.0", "uneven": "N 60"}


def energy(r):
    return 4 * ((2 / r)**12 - (2 / r)**6) + np.cos(r)


def force(r):
    return 2 * (12 * (2 / r)**13 - 6 * (2 / r)**7) + np.sin(r)


def write(path, head="N 60", kind="list", n=60, lo=1.0, hi=5.0, first="# made up", rows=None, extra="", key="KEY"):
    r = np.linspace(lo, hi, n)
    if kind == "RSQ":
        r = np.sqrt(np.linspace(lo * lo, hi * hi, n))
    elif kind == "uneven":
        r = lo + (hi - lo) * np.linspace(0, 1, n)**1.7
    lines = [f"{i} {a:.15g} {energy(a):.15g} {force(a):.15g}" for i, a in enumerate(r[:rows], 1)]
    path.write_text("\n".join([first, "", "OTHER", "N 2", "", "1 1 1 1", "2 2 2 2", "", f"{key} and more", head, "", *lines, extra]) + "\n")
    return str(path)


def pair(words, settings, unit="real"):
    """Energy and force as functions of the distance, and the cutoff."""
    values = TABLE.parse_settings(settings.split())
    filled = TABLE.filled({(1, 1): TABLE.parse_coeff(words, values)}, values, 1)
    tables = TABLE.pack_pairs(values, filled, 1, units.get(unit), shift=True)
    part = TABLE.variant(values).parts[0]

    def at(r):
        e, d = part.function(r * r, *tables.rows[2:, 1, 1], *tables.arrays)
        return float(e), float(-2 * r * d)
    return at, math.sqrt(tables.rows[0, 1, 1])


def test_converges_to_the_function(tmp_path):
    file = write(tmp_path / "t", "N 400", n=400)
    for settings, tolerance in (("linear 4000", 2e-4), ("spline 400", 1e-3), ("lookup 40000", 1e-2), ("bitmap 14", 2e-4)):
        at, cut = pair([file, "KEY"], settings)
        assert cut == pytest.approx(5.0, rel=1e-15)
        for r in np.linspace(1.5, 4.99, 50):
            e, f = at(r)
            assert e == pytest.approx(energy(r), rel=tolerance, abs=tolerance * 2), settings
            assert f == pytest.approx(force(r), rel=tolerance, abs=tolerance * 10), settings


def test_nodes_are_met_exactly(tmp_path):
    at, _ = pair([write(tmp_path / "t", HEADS["RSQ"], "RSQ"), "KEY"], "linear 60")
    for r2 in np.linspace(1.0, 25.0, 60)[1:-1]:
        r = math.sqrt(r2)
        e, f = at(r * (1 + 1e-15))
        assert e == pytest.approx(energy(r), rel=1e-11, abs=1e-11) and f == pytest.approx(force(r), rel=1e-11, abs=1e-11)


def test_below_the_table_is_outside_the_domain(tmp_path):
    for settings in ("linear 100", "bitmap 9"):
        at, _ = pair([write(tmp_path / "t"), "KEY"], settings)
        assert math.isnan(at(0.999)[0]) and math.isfinite(at(1.001)[0])
    assert "inner end of the table" in TABLE.domain


def test_cutoff_and_units(tmp_path):
    file = write(tmp_path / "t", first="# DATE: 2024-01-01 UNITS: metal")
    at, cut = pair([file, "KEY", "4.5"], "linear 500")
    assert cut == 4.5
    plain, _ = pair([file, "KEY", "4.5"], "linear 500", "metal")
    assert at(2.0) == pytest.approx([23.060549 * v for v in plain(2.0)], rel=1e-14)
    with pytest.raises(InputError, match="requires metal units but lj"):
        pair([file, "KEY"], "linear 500", "lj")


def test_one_array_for_all_pairs_and_text(tmp_path):
    file, values = write(tmp_path / "t"), TABLE.parse_settings("spline 50 pppm tip4p".split())
    assert TABLE.format_settings(values) == ["spline", "50", "pppm", "tip4p"]
    coeff = TABLE.parse_coeff([file, "KEY"], values)
    other = TABLE.parse_coeff([file, "KEY", "3.0"], values)
    assert TABLE.format_coeff(other) == [file, "KEY", "3.0"]
    tables = TABLE.pack_pairs(values, TABLE.filled({(1, 1): coeff, (1, 2): coeff, (2, 2): other}, values, 2), 2, units.get("lj"))
    assert tables.arrays[0].shape == (2, 49, 8)
    assert tables.rows[2, 1, 1] == tables.rows[2, 1, 2] == 0 and tables.rows[2, 2, 2] == 1
    with pytest.raises(InputError, match="1 2 is missing.*does not mix"):
        TABLE.filled({(1, 1): coeff, (2, 2): coeff}, values, 2)


@pytest.mark.parametrize("change, message", [
    (dict(head="N 60 FOO 1"), "unknown parameter 'FOO'.*t:10: N 60 FOO 1"), (dict(head="R 1 5"), "does not say N"),
    (dict(head="N 61"), "ends too early.*t:71"), (dict(head="N 60", rows=30, extra="NEXT\nN 2"), "has 30 of N = 60 lines.*NEXT"),
    (dict(head="N x"), "N of table KEY needs 1 number"), (dict(head="N 60 R 1"), "R of table KEY needs 2"),
    (dict(head="N 60 R 5 1"), "increase"), (dict(lo=5.0, hi=1.0), "increase"), (dict(key="KAY"), "no section 'KEY'.*did you mean KAY"),
    (dict(head="N 1"), "at least 2"), (dict(head="N 64 BITMAP 1.0 5.0", n=64), "needs pair_style table bitmap"),
])
def test_bad_files(tmp_path, change, message):
    with pytest.raises(InputError, match=message):
        pair([write(tmp_path / "t", **change), "KEY"], "linear 100")


def test_bad_words(tmp_path):
    file = write(tmp_path / "t")
    for words in (["linear"], ["linear", "1"], ["linear", "x"], ["cubic", "10"], ["linear", "10", "foo"]):
        with pytest.raises(InputError, match="pair_style table"):
            TABLE.parse_settings(words)
    for words, message in (([file], "needs file keyword"), ([file, "KEY", "6.0"], "outside"), ([file, "KEY", "0.5"], "outside"),
                           (["nowhere", "KEY"], "cannot open file nowhere")):
        with pytest.raises(InputError, match=message):
            pair(words, "linear 100")
    with pytest.raises(InputError, match="too few"):
        pair([file, "KEY"], "bitmap 2")


def test_folder_of_potentials(tmp_path, monkeypatch):
    write(tmp_path / "t")
    monkeypatch.setenv("LAMMPS_POTENTIALS", str(tmp_path))
    assert len(tabulated.read_section("t", "KEY", {"N": 1}, 4, "test").columns) == 60


def test_spline_reproduces_cubics():
    x = np.array([0.0, 0.7, 1.0, 2.5, 4.0])
    y, slope, curve = 2 * x**3 - x**2 + 3, 6 * x**2 - 2 * x, 12 * x - 2
    y2 = tabulated.clamped_spline(x, y, slope[0], slope[-1])
    assert np.allclose(y2, curve, rtol=1e-13, atol=1e-13)
    at = np.linspace(0, 4, 33)
    assert np.allclose(tabulated.spline_value(x, y, y2, at), 2 * at**3 - at**2 + 3, rtol=1e-13, atol=1e-13)


def test_against_lammps(tmp_path):
    jobs, mine = [], []
    for kind, head in HEADS.items():
        file = write(tmp_path / kind, head, kind)
        for method in ("linear 100", "linear 7", "lookup 100", "spline 100", "spline 7", "bitmap 8", "bitmap 12"):
            for cut in ("", "4.5"):
                jobs.append(([f"pair_style table {method}", f"pair_coeff * * {file} KEY {cut}"], list(np.linspace(1.01, 4.49, 41))))
                mine.append(pair([file, "KEY", *cut.split()], method)[0])
    for job, at, got in zip(jobs, mine, ask_lammps(jobs, tmp_path), strict=True):
        values = np.array([at(r) for r in got["r"]])
        for k, what in enumerate("ef"):
            want = np.array(got[what])
            scale = np.maximum(np.abs(want), 1e-4 * np.abs(want).max())     # next to a zero of the function
            assert (np.abs(values[:, k] - want) <= 2e-12 * scale).all(), job[0]
