"""Modified embedded-atom method: keywords, lattices and corrections of made-up elements against LAMMPS; forces as the gradient; files that
are wrong."""
from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from test_manybody import GRADIENT, MEASURE, OURS, scene, uncompiled
from wheel import ask, ran

from asemd.errors import InputError

Z = {"fcc": 12, "bcc": 8, "hcp": 12, "dim": 1, "dia": 4, "dia3": 4, "sc": 6, "lin": 2, "zig": 2, "tri": 2}
LENGTH = {"fcc": 3.9, "bcc": 3.0, "hcp": 2.7, "dim": 2.4, "dia": 5.2, "dia3": 5.2, "sc": 2.6, "lin": 2.5, "zig": 2.5, "tri": 2.5}
BASE = "rc = 4.6; delr=0.4; Cmin(1,1,1)=0.8; Cmax(2,2,2)=2.2; Cmin(1,2,1)=0.9; Cmin(1,1,2)=0.7; Cmin(2,2,1)=0.6; delta(1,2)=0.2 # a comment"
CASES = {     # lattices and ibar of the elements, lines of the parameter file
    "mixed t": ("dia 1 hcp 3", "mixture_ref_t=1"), "mixed t, other mean": ("dia 1 bcc 3", "mixture_ref_t=1; ialloy=1"),
    "no mean": ("fcc 0 bcc 3", "ialloy=2; augt1=0"), "rose 1": ("fcc 0 bcc 3", "erose_form=1; attrac(1,2)=0.05; repuls(1,2)=0.1"),
    "rose 2": ("fcc 0 bcc 3", "erose_form=2; attrac(1,1)=0.05; repuls(1,2)=0.1; zbl(2,1)=0; zbl(1,1)=0"),
    "negative": ("dia -5 hcp -5", "emb_lin_neg=1; bkgd_dyn=1"), "smooth": ("dim 0 bcc 4", "gsmooth_factor=0.5; rho0(2)=1.4"),
    "given": ("fcc 0 bcc 3", "re(1,2)=2.5; alpha(1,2)=5.1; Ec(1,2)=3.9; nn2(1,1)=1; nn2(2,2)=1; nn2(1,2)=1"),
    "b1": ("fcc 0 bcc 3", "lattce(1,2)='b1'; nn2(1,2)=1; nn2(1,1)=1"), "b2": ("dia 0 hcp 3", "lattce(2,1)=b2; nn2(2,1)=1"),
    "l12": ("fcc 0 bcc 3", "lattce(1,2)=l12; nn2(1,2)=1; nn2(2,2)=1; nn2(1,1)=1; ialloy=1"), "c11": ("fcc 0 dim 3", "lattce(1,2)=c11"),
    "c11 of dia": ("dia 0 fcc 0", "lattce(1,2)=c11"), "l12 without means": ("hcp 0 dia3 0", "lattce(1,2)=l12; ialloy=0"),
    "ch4": ("dia 0 dim 0", "lattce(1,2)=ch4"), "dia": ("fcc 0 sc 0", "lattce(1,2)=dia; nn2(1,2)=1"),
    "dia3": ("dia3 0 sc 3", "lattce(1,2)=dia3; nn2(1,2)=1; nn2(2,2)=1; nn2(1,1)=1"), "dim": ("dim 1 bcc 3", "lattce(1,2)=dim; nn2(1,2)=1"),
    "lin": ("lin 0 tri 3", "lattce(1,2)=lin; nn2(1,2)=1"), "zig": ("zig 0 zig 3", "lattce(1,2)=zig; theta(1,2)=105; nn2(1,2)=1"),
    "tri": ("tri 3 lin 0", "lattce(1,2)=tri; theta(1,2)=115; nn2(1,2)=1"),
    "hcp": ("hcp 3 hcp 4", "lattce(1,2)=hcp; nn2(1,2)=1; nn2(1,1)=1"),
    "second fcc": ("fcc 0 hcp 3", "nn2(1,2)=1"), "second l12": ("dia 1 hcp 3", "lattce(1,2)=l12"),
    "second zig": ("zig 0 dim 3", "lattce(1,2)=zig; theta(1,2)=105; ialloy=0"), "second dia": ("dia 0 dim 1", "lattce(1,2)=dia; ialloy=2"),
    "second mixed t": ("dia 1 hcp 3", "mixture_ref_t=1"),
    "second mixed t, b1": ("dia 1 dia 3", "mixture_ref_t=1; ialloy=0; lattce(1,2)=b1"),
    "second, no mean": ("dia 1 hcp 3", "mixture_ref_t=1; ialloy=2"),
    "second c11": ("fcc 0 hcp 3", "lattce(1,2)=c11; bkgd_dyn=1"),
}


def library(elements: str, second: bool) -> str:
    words, out = elements.split(), ["# DATE: 2026-01-01 UNITS: metal"]
    for k, (name, lattice, ibar) in enumerate(zip(("Aa", "Bb"), words[::2], words[1::2])):
        more, last = ("1.1 2.3 0.4", "0.3 0.2 0.25") if second else ("", "")
        size = 0.5 if second else 1.0      # where the second set is larger there is no density
        out += [f"'{name}' '{lattice}' {Z[lattice]}. {13 + 5 * k} {26 + k}",
                f"{4.6 + 0.3 * k} {3.1 + 0.4 * k} {2.1 - 0.2 * k} {1.5 + 0.4 * k}",
                f"2.2 {more} {LENGTH[lattice]} {3.3 + 0.5 * k} {1.07 - 0.1 * k} 1.0 {size * (2.5 + k)} {size * (1.3 - 0.3 * k)} "
                f"{size * (1.7 - k)} {last} {1.0 + 0.2 * k} {ibar}"]
    return "\n".join(out) + "\n"


def jobs(folder: Path) -> dict[str, list[str]]:
    out = {}
    for name, (elements, lines) in CASES.items():
        second = name.startswith("second")
        stem = folder / name.replace(" ", "_").replace(",", "")
        stem.with_suffix(".library").write_text(library(elements, second))
        stem.with_suffix(".meam").write_text((BASE + ";" + lines).replace(";", "\n"))
        words = scene("meam", "metal")
        for k, line in enumerate(words):
            if line.startswith("pair_style"):
                words[k] = "pair_style meam/ms" if second else "pair_style meam"
            if line.startswith("pair_coeff"):
                words[k] = f"pair_coeff * * {stem}.library Aa Bb {stem}.meam Aa Bb"
        out[name] = words
    scaled = list(out["given"])
    at = next(k for k, line in enumerate(scaled) if line.startswith("compute"))
    scaled[at:at] = ["variable s equal 0.37", "fix a all adapt 1 pair meam scale 1 2 v_s"]
    return {**out, "scaled": scaled}


THEIRS = MEASURE + r"""
answer = {}
for name, lines in given["jobs"].items():
    lmp = start()
    answer[name] = measure(lmp, lines)
    lmp.close()
"""


def test_like_lammps(tmp_path):
    given = jobs(tmp_path)
    theirs, ours = ask(THEIRS, jobs=given), uncompiled(OURS, given)
    for job in given:
        for what, want in theirs[job].items():
            assert np.allclose(ours[job][what], want, rtol=0, atol=1e-11 * max(np.abs(want).max(), 1e-3)), (job, what)


def test_forces_and_virial_are_derivatives_of_the_energy(tmp_path):
    few = ("mixed t", "mixed t, other mean", "no mean", "negative", "l12", "second l12", "scaled", "second mixed t",
           "second mixed t, b1", "second, no mean")
    found = uncompiled(GRADIENT, {name: lines for name, lines in jobs(tmp_path).items() if name in few})
    for name, (slope, force, strained, virial, largest) in found.items():
        scale = 1e-7 * (largest + abs(slope) + abs(strained))
        assert abs(slope - force) < scale and abs(strained - virial) < scale, name


LINE = "rc = 4.6\n"


@pytest.mark.parametrize(("change", "lines", "words", "says"), [
    (None, "cmin(1,1,1)=2", "Aa Bb x.meam Aa Bb", r"unknown keyword 'cmin' \(did you mean Cmin\?\) \(x.meam:2"),
    (None, "Cmin(1,1)=2", "Aa Bb x.meam Aa Bb", r"Cmin needs 3 indices and a value \(x.meam:2"),
    (None, "rho0(3)=2", "Aa Bb x.meam Aa Bb", r"indices of rho0 are elements 1 to 2, got 3 \(x.meam:2"),
    (None, "ialloy=3", "Aa Bb x.meam Aa Bb", r"ialloy must be one of 0 1 2, got 3 \(x.meam:2"),
    (None, "lattce(1,1)=b1", "Aa Bb x.meam Aa Bb", r"the lattice of Aa Aa must be one of fcc bcc .*, got b1 \(x.meam:2"),
    (None, "delr = none", "Aa Bb x.meam Aa Bb", r"delr: the value must be a number, got 'none' \(x.meam:2"),
    (None, "delr = 0", "Aa Bb x.meam Aa Bb", "rc and delr must be positive"),
    (("12.", "8."), "", "Aa Bb x.meam Aa Bb", r"Aa: z must be 12, the number of neighbours in fcc, got 8 \(x.library:2"),
    (("fcc", "b1"), "", "Aa Bb x.meam Aa Bb", r"Aa: the lattice must be one of fcc .*, got b1 \(x.library:2"),
    (("4.6", "4.b"), "", "Aa Bb x.meam Aa Bb", r"alpha must be a number, got '4.b' \(x.library:2"),
    ((" 1.2 3", " 1.2 2"), "", "Aa Bb x.meam Aa Bb", r"Bb: ibar must be 0, 1, 3, 4 or -5, got 2 \(x.library:5"),
    (None, "", "Aa Cc x.meam Aa Cc", "x.library has no entry for Cc"),
    (None, "", "Aa Bb y.meam Aa Bb", "none of Bb y.meam Aa Bb is a file"),
    (None, "", "Aa Bb x.meam Aa Cc", "element Cc is not among those between the files, Aa Bb"),
    (None, "", "Aa Aa x.meam Aa Aa", "an element is there twice between the files: Aa Aa"),
    (None, "", "Aa Bb x.meam Aa", "an element, or NULL, for each of 2 atom types, got 1"),
])
def test_wrong_files(change, lines, words, says, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = library("fcc 0 bcc 3", False)
    Path("x.library").write_text(text.replace(*change, 1) if change else text)
    Path("x.meam").write_text(LINE + lines + "\n")
    lmp = ran(["units metal", "region box block 0 9 0 9 0 9", "create_box 2 box", "create_atoms 1 single 1 1 1", "pair_style meam"])
    with pytest.raises(InputError, match=says):
        lmp.command(f"pair_coeff * * x.library {words}")


def test_masses_and_log(tmp_path, monkeypatch):
    """Masses come from the library; what the log says about the files."""
    from asemd.lammps import Lammps
    monkeypatch.chdir(tmp_path)
    Path("x.library").write_text(library("fcc 0 bcc 3", False))
    lmp = Lammps(cmdargs=["-screen", "none", "-log", "log.lammps"])
    for line in ("units metal", "region box block 0 9 0 9 0 9", "create_box 3 box", "create_atoms 1 single 1 1 1", "pair_style meam",
                 "pair_coeff * * x.library Aa Bb NULL Bb Aa Bb"):
        lmp.command(line)
    assert lmp.scene.system.mass[1:].tolist() == [27.0, 26.0, 27.0]
    assert lmp.scene.interactions.coeff_lines("pair") == [["*", "*", "x.library", "Aa", "Bb", "NULL", "Bb", "Aa", "Bb"]]
    lmp.close()
    assert "Reading MEAM library file x.library with DATE: 2026-01-01" in Path("log.lammps").read_text()


SPLINE = "3\n-2.0 0.0\n1 1 1 1\n1.0 2.0 0.0\n2.0 0.5 0.0\n3.0 0.0 0.0\n"


@pytest.mark.parametrize(("change", "words", "says"), [
    (("2.0 0.5", "2.1 0.5"), "Ti",
     r"phi Ti Ti needs two knots .*, evenly spaced, in rising order \(x.sp:2"),
    (("0.0\n1 1", "none\n1 1"), "Ti", r"the last slope of phi Ti Ti must be a number, got 'none' \(x.sp:3"),
    (None, "Ti O", "x.sp is of one element, got Ti O"), ((SPLINE, ""), "Ti", r"the file ends before spline g Ti Ti \(x.sp:25"),
    (("3\n-2.0", "meam/spline 1 Ti\n3\n-2.0"), "Ti", r"expected spline3eq before spline phi Ti Ti, got 3 \(x.sp:3"),
    (("3\n-2.0", "meam/spline 1 Ti\n3\n-2.0"), "O", "x.sp has no element O, only Ti"),
])
def test_wrong_splines(change, words, says, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = "# a comment\n" + 5 * SPLINE
    Path("x.sp").write_text(text.replace(*change, 1) if change else text)
    lmp = ran(["units metal", "region box block 0 9 0 9 0 9", f"create_box {len(words.split())} box", "pair_style meam/spline"])
    with pytest.raises(InputError, match=says):
        lmp.command(f"pair_coeff * * x.sp {words}")
