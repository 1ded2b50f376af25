"""Spectral neighbour analysis potential: all parameters against LAMMPS, forces as the gradient of the energy, files that are wrong."""
from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from test_manybody import FOLDER, GRADIENT, MEASURE, OURS, scene
from wheel import ask, ran

import asemd
from asemd.bispectrum import bispectrum, clebsch_gordan
from asemd.errors import InputError

CASES = {     # twojmax, elements of the types, lines of the parameter file
    "linear": (4, "Aa Bb", ""), "odd": (3, "Bb Aa", "bzeroflag 0"), "shape": (2, "Aa Bb", "rmin0 0.4\nrfac0 0.9\nswitchflag 0"),
    "inner": (2, "Bb Aa", "switchinnerflag 1\nsinner 2.23 2.4\ndinner 0.5 0.4"), "normed": (3, "Aa", "bnormflag 1\nwselfallflag 1"),
    "quadratic": (3, "Aa Bb", "quadraticflag 1"), "densities": (3, "Aa Bb", "chemflag 1"),
    "densities, all selves": (2, "Bb Aa", "chemflag 1\nwselfallflag 1\nbnormflag 1"),
    "densities, quadratic": (2, "Aa Bb", "chemflag 1\nquadraticflag 1"), "constant": (0, "Aa Bb", "bzeroflag 0"),
}


def write(folder: Path, name: str, twojmax: int, lines: str) -> tuple[Path, Path]:
    count = len(bispectrum(twojmax, False).components) * (8 if "chemflag 1" in lines else 1)
    count += count * (count + 1) // 2 if "quadraticflag 1" in lines else 0
    rng, names = np.random.default_rng(7), [folder / f"{name.replace(' ', '').replace(',', '_')}.snap{end}" for end in ("coeff", "param")]
    elements = [f"{e} {0.5 - 0.03 * k} {1.0 - 0.2 * k}\n" + "".join(f"{c:.8f}\n" for c in 0.01 * rng.normal(size=count + 1))
                for k, e in enumerate(("Aa", "Bb")[:1 if name == "normed" else 2])]
    names[0].write_text(f"# DATE: 2026-01-01 UNITS: metal\n{len(elements)} {count + 1}\n" + "".join(elements))
    names[1].write_text(f"# a comment\nrcutfac 4.1\ntwojmax {twojmax}\n{lines}\n")
    return names[0], names[1]


def jobs(folder: Path) -> dict[str, list[str]]:
    out = {}
    for name, (twojmax, elements, lines) in CASES.items():
        files, words = write(folder, name, twojmax, lines), scene("tersoff shift 0.1" if " " in elements else "sw", "metal")
        for k, line in enumerate(words):
            if line.startswith("pair_style"):
                words[k] = "pair_style snap"
            if line.startswith("pair_coeff"):
                words[k] = f"pair_coeff * * {files[0]} {files[1]} {elements}"
        out[name] = words
    return out


NETWORKS = {"sigmoid 3 relu 4 linear 1": 1, "tanh 2 linear 1": 3, "linear 1": 2}      # and twojmax


def learned(folder: Path) -> dict[str, list[str]]:
    """Scenes of style mliap."""
    out, rng = {}, np.random.default_rng(5)
    models = [("linear", 2, ""), ("quadratic", 2, "bnormflag 1"), ("linear", 2, "chemflag 1"), *(("nn", j, n) for n, j in NETWORKS.items())]
    for k, (kind, twojmax, lines) in enumerate(models):
        model, descriptor = folder / f"{k}.model", folder / f"{k}.descriptor"
        count = len(bispectrum(twojmax, False).components) * (8 if "chem" in lines else 1)
        words = lines.split() if kind == "nn" else []
        nodes = [count, *map(int, words[1::2])]
        size = sum(n * (m + 1) for m, n in zip(nodes, nodes[1:])) if kind == "nn" else 1 + count
        size += count * (count + 1) // 2 if kind == "quadratic" else 0
        head = f"# DATE: 2026-01-01\n2 {size}\n" + (f"NET {count} {len(nodes) - 1} {lines}\n" if kind == "nn" else "")
        scales = [*rng.normal(size=count), *rng.uniform(5, 9, count)] if kind == "nn" else []
        model.write_text(head + "\n".join(f"{c:.8f}" for _ in "ab" for c in [*scales, *rng.normal(size=size)]) + "\n")
        descriptor.write_text(f"rcutfac 4.1\ntwojmax {twojmax}\nnelems 2\nelems Aa Bb\nradelems 0.5 0.47\nwelems 1.0 0.8\n"
                              + ("" if kind == "nn" else lines) + "\n")
        scenes = scene("tersoff shift 0.1", "metal")
        for at, line in enumerate(scenes):
            if line.startswith("pair_style"):
                scenes[at] = f"pair_style mliap model {kind} {model} descriptor sna {descriptor}"
            if line.startswith("pair_coeff"):
                scenes[at] = "pair_coeff * * Bb Aa"
        out[f"mliap {kind} {lines}"] = scenes
    for k, (kind, nmax, lmax, lines) in enumerate((("linear", 3, 2, ""), ("quadratic", 1, 3, ""), ("nn", 2, 0, "tanh 3 linear 1"),
                                                   ("linear", 2, 5, ""))):
        model, descriptor, count = folder / f"{k}.so3.model", folder / f"{k}.so3.descriptor", nmax * (nmax + 1) // 2 * (lmax + 1)
        size = 3 * (count + 1) + 4 if kind == "nn" else 1 + count + (count * (count + 1) // 2 if kind == "quadratic" else 0)
        scales = [*rng.normal(size=count), *rng.uniform(5, 9, count)] if kind == "nn" else []
        model.write_text(f"2 {size}\n" + (f"NET {count} 2 {lines}\n" if kind == "nn" else "")
                         + "\n".join(f"{c:.8f}" for _ in "ab" for c in [*scales, *(0.1 * rng.normal(size=size))]) + "\n")
        descriptor.write_text(f"# a comment\nrcutfac 4.1\nnmax {nmax}\nlmax {lmax}\nalpha {0.8 + 0.4 * k}\nnelems 2\nelems Aa Bb\n"
                              f"radelems 0.5 {0.47 if k else 0.6}\nwelems 1.0 0.8\n")
        out[f"mliap so3 {kind} {lmax}"] = [
            f"pair_style mliap model {kind} {model} descriptor so3 {descriptor}" if line.startswith("pair_style") else
            "pair_coeff * * Bb Aa" if line.startswith("pair_coeff") else line for line in scene("tersoff shift 0.1", "metal")]
    return out


THEIRS = MEASURE + FOLDER + r"""
os.environ["LAMMPS_POTENTIALS"] = P
answer = {"folder": P}
for name, lines in given["jobs"].items():
    lmp = start()
    answer[name] = measure(lmp, lines)
    lmp.close()
"""


def compiled(script: str, given: dict, folder: str = "") -> dict:
    environment = {**os.environ, "PYTHONPATH": str(Path(asemd.__file__).parents[1]), "LAMMPS_POTENTIALS": folder}
    done = subprocess.run([sys.executable, "-c", script], input=json.dumps(given), env=environment, capture_output=True, text=True,
                          timeout=300)
    assert done.returncode == 0, done.stderr[-2000:]
    return json.loads(done.stdout)


def test_like_lammps(tmp_path):
    given = {**jobs(tmp_path), **learned(tmp_path)}
    for name, words in {"Ta": "Ta06A.snapcoeff Ta06A.snapparam Ta", "InP": "InP_JCPA2020.snapcoeff InP_JCPA2020.snapparam In P"}.items():
        given[name] = [line if not line.startswith("pair_coeff") else f"pair_coeff * * {words}"
                       for line in given["normed" if name == "Ta" else "linear"]]
    at = next(k for k, line in enumerate(given["linear"]) if line.startswith("compute"))
    given["scaled"] = [*given["linear"][:at], "variable s equal 0.37", "fix a all adapt 1 pair snap scale 1 1 v_s", *given["linear"][at:]]
    for name in ("linear", "mliap linear ", "mliap nn tanh 2 linear 1", "mliap so3 nn 0"):      # two atoms together, one without neighbours
        atoms = next(k for k, line in enumerate(given[name]) if line.startswith("create_atoms"))
        box = ["region wide block 0 30 0 30 0 30", "create_box 2 wide", "create_atoms 1 single 1 1 1", "create_atoms 2 single 1 3 1",
               "create_atoms 2 single 15 15 15"]
        rest = [line for line in given[name][atoms + 1:] if not line.startswith(("displace", "change_box"))]
        given[f"{name}, alone"] = [given[name][0], *box, *rest]
    theirs = ask(THEIRS, jobs=given)
    ours = compiled(OURS, given, theirs["folder"])
    for job in given:
        for what, want in theirs[job].items():
            if job == "scaled" and what.startswith("share"):
                continue      # LAMMPS does not scale the virials of atoms
            # LAMMPS's Bessel functions lose digits: its energies were off by 5e-12, its forces by 5e-11 where ours were right to 5e-14
            digits = 1e-10 if "so3" in job else 1e-11
            assert np.allclose(ours[job][what], want, rtol=0, atol=digits * max(np.abs(want).max(), 1e-3)), (job, what)


def test_forces_and_virial_are_derivatives_of_the_energy(tmp_path):
    for name, (slope, force, strained, virial, largest) in compiled(GRADIENT, {**jobs(tmp_path), **learned(tmp_path)}).items():
        scale = 1e-7 * (largest + abs(slope) + abs(strained))
        assert abs(slope - force) < scale and abs(strained - virial) < scale, name


def test_clebsch_gordan_coefficients_are_orthonormal():
    j1, j2 = 3, 4
    for j in (1, 3, 5, 7):
        for m in range(-j, j + 1, 2):
            squares = sum(clebsch_gordan(j1, m1, j2, m - m1, j, m) ** 2 for m1 in range(-j1, j1 + 1, 2) if abs(m - m1) <= j2)
            assert squares == pytest.approx(1.0, abs=1e-14)
    assert clebsch_gordan(2, 0, 2, 0, 4, 0) == pytest.approx((2.0 / 3.0) ** 0.5, abs=1e-15)


@pytest.mark.parametrize(("change", "lines", "words", "says"), [
    (None, "twojmax 2\nrcutfak 4", "Aa Bb", r"unknown keyword 'rcutfak' \(did you mean rcutfac\?\) \(x.snapparam:2"),
    (None, "twojmax 2", "Aa Bb", "x.snapparam has no rcutfac"),
    (None, "twojmax two", "Aa Bb", r"must be a whole number, got 'two' \(x.sna"),
    (None, "twojmax 2\nrcutfac 4 5", "Aa Bb", r"a word too many after rcutfac: 5 \(x.snapparam:2"),
    (None, "twojmax 2\nrcutfac 4\nchemflag 2", "Aa Bb", r"chemflag must be 0 or 1, got 2 \(x.snapparam:3"),
    (None, "twojmax 2\nrcutfac 4\nswitchinnerflag 1", "Aa Bb", "x.snapparam has no sinner"),
    (None, "twojmax 2\nrcutfac -4", "Aa Bb", "rcutfac must be positive"),
    (None, "twojmax 3\nrcutfac 4", "Aa Bb", "flags of x.snapparam ask for 9"),
    (None, "twojmax 2\nrcutfac 4", "Aa Cc", "x.snapcoeff has no element Cc"),
    (("Bb 0.47", "Bb o.47"), "twojmax 2\nrcutfac 4", "Aa Bb", r"the radius must be a number, got 'o.47' \(x.snapcoeff:10"),
    (("2 6", "3 6"), "twojmax 2\nrcutfac 4", "Aa Bb", r"the file ends before an element \(x.snapcoeff:16"),
])
def test_wrong_files(change, lines, words, says, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    first, second = write(tmp_path, "x", 2, "")
    if change:
        first.write_text(first.read_text().replace(*change, 1))
    second.write_text(lines + "\n")
    lmp = ran(["units metal", "region box block 0 9 0 9 0 9", "create_box 2 box", "create_atoms 1 single 1 1 1", "pair_style snap"])
    with pytest.raises(InputError, match=says):
        lmp.command(f"pair_coeff * * x.snapcoeff x.snapparam {words}")


def test_calculator_and_log(tmp_path, monkeypatch):
    """A calculator finds the parameters beside the coefficients; the log tells what was read."""
    from ase import Atoms
    from ase.build import bulk

    from asemd.lammps import Lammps
    monkeypatch.chdir(tmp_path)
    write(tmp_path, "x", 2, "")
    crystal = bulk("W", "bcc", a=3.2, cubic=True)
    crystal.calc = asemd.Potential.from_file("x.snapcoeff", elements={"W": "Bb"})
    assert np.abs(crystal.get_forces()).max() < 1e-12 and crystal.get_potential_energy() != 0.0
    atom = Atoms("W", calculator=crystal.calc)      # what energies of atomisation are counted from
    assert atom.get_potential_energy() == pytest.approx(float((tmp_path / "x.snapcoeff").read_text().split("Bb")[1].split()[2]), rel=1e-12)
    lmp = Lammps(cmdargs=["-screen", "none", "-log", "log.lammps"])
    for line in ("units metal", "region box block 0 9 0 9 0 9", "create_box 1 box", "create_atoms 1 single 1 1 1", "pair_style snap",
                 "pair_coeff * * x.snapcoeff x.snapparam Bb"):
        lmp.command(line)
    lmp.close()
    told = Path("log.lammps").read_text()
    assert "SNAP Element = Bb, Radius 0.47, Weight 0.8" in told and "SNAP keyword rcutfac 4.1" in told


POWER = "rcutfac 4\nnmax 1\nlmax 1\nalpha 1\nnelems 1\nelems Aa\nradelems 0.5\nwelems 1\n"      # of a descriptor so3


@pytest.mark.parametrize(("style", "files", "says"), [
    ("model linear a.model", {}, "needs descriptor, a kind and a file"),
    ("model spline a.model", {}, "model must be one of linear quadratic nn"),
    ("modell linear a.model", {}, r"unknown keyword 'modell', expected model or descriptor \(did you mean model"),
    ("model linear", {}, "model needs a kind and a file"), ("descriptor ace d", {}, "descriptor must be one of sna so3, got ace"),
    ("", {"a.model": "1 5\n"}, r"the file ends before the coefficients \(a.model"),
    ("", {"a.model": "1 5\n1 2 3 4 5\n"}, "a.model announces 5 coefficients, descriptor and model ask for 3"),
    ("", {"a.model": "1 3\n1 2\n"}, r"the file ends before the last of 3 coefficients, 2 of them were read \(a.model:2"),
    ("", {"a.model": "1 3\n1 2 x\n"}, r"a coefficient must be a number, got 'x' \(a.model:2"),
    ("", {"a.model": "2 3\n1 2 3\n4 5 6\n"}, r"a.model is for 2 elements, the descriptor for Aa \(a.model:1"),
    ("", {"d": "rcutfac 4\ntwojmax 1\n"}, "d has no nelems"),
    ("model linear a.model descriptor so3 d", {}, r"unknown keyword 'twojmax' \(d:2"),
    ("model linear a.model descriptor so3 d", {"d": "rcutfac 4\nnmax 1\nlmax 1\n"}, "d has no alpha"),
    ("model linear a.model descriptor so3 d", {"d": "rcutfac 4\nnmax 1 2\n"}, r"a word too many after nmax: 2 \(d:2"),
    ("model linear a.model descriptor so3 d", {"d": "alpha x\n"}, r"alpha must be a number, got 'x' \(d:1"),
    ("model linear a.model descriptor so3 d", {"d": POWER.replace("alpha 1", "alpha 0")}, r"alpha must be positive, got 0 \(d:4"),
    ("model linear a.model descriptor so3 d", {"d": POWER.replace("nmax 1", "nmax 0")}, r"nmax must be 1 to 12, got 0 \(d:2"),
    ("model linear a.model descriptor so3 d", {"d": POWER.replace("Aa", "Zz")}, "d has no element Aa, only Zz"),
    ("model linear a.model descriptor so3 d", {"d": POWER.replace("lmax 1", "lmax 2")}, "ask for 4"),
    ("model nn a.model descriptor sna d", {"a.model": "1 9\nNET 2 1 cubic 1\n1\n"},
     r"a layer is one of linear .*, got cubic 1 \(a.model:2"),
    ("model nn a.model descriptor sna d", {"a.model": "1 9\nNET 2 1 tanh 2\n1\n"}, r"the last layer of the network must have one node"),
])
def test_wrong_models(style, files, says, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    known = {"a.model": "1 3\n1 2 3\n", "d": "rcutfac 4\ntwojmax 1\nnelems 1\nelems Aa\nradelems 0.5\nwelems 1\n"}
    for name, text in {**known, **files}.items():
        Path(name).write_text(text)
    lmp = ran(["units metal", "region box block 0 9 0 9 0 9", "create_box 1 box", "create_atoms 1 single 1 1 1"])
    with pytest.raises(InputError, match=says):
        lmp.command(f"pair_style mliap {style or 'model linear a.model descriptor sna d'}")
        lmp.command("pair_coeff * * Aa")
