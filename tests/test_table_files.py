"""Table files of bonded styles: what LAMMPS reads is read, what is wrong is said with its line."""
from __future__ import annotations

import math

import numpy as np
import pytest

from asemd import style as registry
from asemd import units
from asemd.errors import InputError, InputWarning

ROWS = [f"{i} {r:.15g} {3 * math.cos(r):.15g} {3 * math.sin(r):.15g}" for i, r in enumerate((0.5, 0.6, 0.8, 1.0, 1.3, 1.7, 2.0, 2.5), 1)]
DATA = "\n".join(ROWS) + "\n"
BOND = registry.find("bond", "table")
SETTINGS = {"style": "spline", "N": 20}
pytestmark = pytest.mark.filterwarnings("ignore:bond_coeff table.*inflection")


def read(tmp_path, text, keyword="K", style=BOND, words=()):
    path = tmp_path / "t"
    path.write_text(text)
    return style.parse_coeff([*words, str(path), keyword], SETTINGS)


@pytest.mark.parametrize("text", [
    f"# c\n\nK\nN 8\n\n{DATA}", f"K\nN 8\n\n{DATA}", f"# c\n\nK more words\nN 8 # FP 1 2\n\n{DATA}",
    f"A K\nN 8\n\n{DATA}\nK\nN 8\n\n{DATA}",
    f"K\nN 8\nindex r energy force\n{DATA}", f"K\nN 8\n# index r energy force\n{DATA}", f"K\n\nN 8\n\n{DATA}", f"K\n# c\nN 8\n\n\n{DATA}",
    "K\nN 8\n\n" + "\n# between\n\n".join(ROWS), "K\nN 8\n\n" + " 7 # more\n".join(ROWS), f"K\nN 4 N 8\n\n{DATA}",
    f"K\nN 8\n\n{DATA}\nK\nN 2\n\n1 0 3 4\n2 5 3 4\n", f"# DATE: 2020-01-01 UNITS: real\n\nK\nN 8\n\n{DATA}",
    f"K\nN 8\n\n{DATA}".replace("\n", "\r\n").replace(" ", "\t"),
])
def test_forms_that_are_read(text, tmp_path):
    x, e, f, first, last = read(tmp_path, text)["table"]
    assert x == pytest.approx([0.5, 0.6, 0.8, 1.0, 1.3, 1.7, 2.0, 2.5], abs=0)
    assert (e, f) == (pytest.approx(3 * np.cos(x), rel=1e-14), pytest.approx(3 * np.sin(x), rel=1e-14))
    assert (first, last) == ((f[1] - f[0]) / (x[1] - x[0]), (f[-1] - f[-2]) / (x[-1] - x[-2]))


@pytest.mark.parametrize("order", ["N 8 FP -1 2 EQ 1.1", "EQ 1.1 FP -1 2 N 8", "FP -1 2 N 8 EQ 1.1"])
def test_parameters_in_any_order(order, tmp_path):
    values = read(tmp_path, f"K\n{order}\n\n{DATA}")
    assert values["table"][3:] == (-1.0, 2.0) and values["r0"] == 1.1


@pytest.mark.parametrize(("text", "message", "line"), [
    (f"\nK\nN 8\n{DATA}", "must be blank", 4), (f"K\nFP 1 1\n\n{DATA}", "does not say N", 2), (f"K\nN 8.0\n\n{DATA}", "a whole one", 2),
    (f"K\nN 1\n\n{DATA}", "at least 2", 2), (f"K\nN 8 XX 2\n\n{DATA}", "unknown parameter 'XX'", 2),
    (f"K\nN 8 FP 1\n\n{DATA}", "2 numbers", 2),
    (f"K\nN 8 FP 1 x\n\n{DATA}", "2 numbers", 2), (f"K\nN 9\n\n{DATA}", "8 of N = 9", 11),
    (f"K\nN 8\n\n{DATA}".replace("\n3 0.8", "\n3 0.55"), "0.55 follows 0.6", 6),
    (f"K\nN 8\n\n{DATA}".replace("\n3 0.8", "\n3 0.6"), "0.6 follows 0.6", 6),
    (f"K\nN 8\n\n{DATA}".replace("\n3 0.8", "\n3 0.8x"), "line 3 of table K must have 4 numbers", 6),
    (f"K\nN 8\n\n{DATA}".replace("\n3 0.8", "\n3 nan"), "not finite", 6),
    (f"K\nN 8\n\n{DATA}".replace("\n3 0.8", "\n3.5 0.8"), "2 of N = 8", 6), ("K\n", "no line of parameters", 1),
])
def test_what_is_wrong_has_a_line(text, message, line, tmp_path):
    with pytest.raises(InputError, match=message) as error:
        read(tmp_path, text)
    assert error.value.where.line == line and error.value.where.file == str(tmp_path / "t")


def test_units_of_the_file(tmp_path):
    coeffs = {1: read(tmp_path, f"# UNITS: metal\n\nK\nN 8\n\n{DATA}")}
    BOND.pack(SETTINGS, coeffs, 1, units.get("metal"))
    BOND.pack(SETTINGS, coeffs, 1, units.get("ase"))
    with pytest.raises(InputError, match="requires metal units but real units are in use"):
        BOND.pack(SETTINGS, coeffs, 1, units.get("real"))


def test_forces_that_do_not_fit_the_energies_warn(tmp_path):
    wrong = "\n".join(" ".join([*row.split()[:3], "-1.0"]) for row in ROWS)
    with pytest.warns(InputWarning, match="6 of 8 force values in table K are inconsistent"):
        read(tmp_path, f"K\nN 8\n\n{wrong}\n")


def test_table_cut(tmp_path):
    """E = f(theta1) f(theta2) E(phi); the factor falls from K at angle1 to zero at angle2."""
    cut, plain = registry.find("dihedral", "table/cut"), registry.find("dihedral", "table")
    text = "K\nN 36\n\n" + "".join(f"{i + 1} {a} {2 + math.cos(math.radians(a))!r} {math.radians(1) * math.sin(math.radians(a))!r}\n"
                                   for i, a in enumerate(range(-170, 190, 10)))
    packed = cut.pack(SETTINGS, {1: read(tmp_path, text, style=cut, words=["aat", "0.5", "100", "140"])}, 1, None)
    whole = plain.pack(SETTINGS, {1: read(tmp_path, text, style=plain)}, 1, None)
    e, slope = plain.function(0.7, *whole.coeff[:, 1], *whole.arrays)
    for one, two, factor in ((90, 95, 0.25), (120, 95, 0.25 * 0.75), (95, 130, 0.25 * 0.4375), (140, 90, 0.0), (150, 90, -0.25 * 0.5625)):
        got = cut.function(0.7, math.radians(one), math.radians(two), *packed.coeff[:, 1], *packed.arrays)
        assert got[:2] == pytest.approx((factor * e, factor * slope), rel=1e-12, abs=1e-15)
    for words, message in ((["aa", "1", "100", "140"], "must be aat"), (["aat", "1", "140", "140"], "larger than angle1"),
                           (["aat", "1", "x", "140"], "angle1 must be a number")):
        with pytest.raises(InputError, match=message):
            read(tmp_path, text, style=cut, words=words)


@pytest.mark.parametrize(("factor", "wrong", "good"), [(1.0, 0, True), (0.6, 36, True), (1.9, 36, True), (0.4, 36, False), (2.2, 36, False),
                                                       (57.3, 36, False), (-1.0, 18, True), (-1.0, 19, False), (0.0, 36, True)])
def test_forces_of_torsions_fit_the_energies_within_a_factor_of_2(factor, wrong, good, tmp_path):
    """At more than half of the angles, as in LAMMPS; 57.3 is a force per radian in a table in degrees."""
    phi = np.arange(36) * 10.0
    energy, force = np.cos(np.radians(phi) + 0.3), np.sin(np.radians(phi) + 0.3) * math.pi / 180.0
    force[:wrong] *= factor
    (tmp_path / "t").write_text("K\nN 36\n\n" + "".join(f"{i} {p} {e} {f}\n" for i, (p, e, f) in enumerate(zip(phi, energy, force), 1)))
    style = registry.find("dihedral", "table")
    if good:
        style.parse_coeff([str(tmp_path / "t"), "K"], {"style": "linear", "N": 50})
        return
    with pytest.raises(InputError, match="inconsistent forces and energies"):
        style.parse_coeff([str(tmp_path / "t"), "K"], {"style": "linear", "N": 50})


def test_splines_of_a_torsion_need_three_angles(tmp_path):
    (tmp_path / "t").write_text("K\nN 2 NOF\n\n1 0 1\n2 90 2\n")
    style = registry.find("dihedral", "table")
    style.parse_coeff([str(tmp_path / "t"), "K"], {"style": "linear", "N": 50})
    with pytest.raises(InputError, match="at least 3 angles"):
        style.parse_coeff([str(tmp_path / "t"), "K"], {"style": "spline", "N": 50})
