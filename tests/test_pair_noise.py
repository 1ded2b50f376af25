"""Dissipative particle dynamics: LAMMPS's trajectories to the last digits, random numbers included; conservation; words."""
from __future__ import annotations

import numpy as np
import pytest
from both import asemd, assert_same, lammps
from wheel import ran

from asemd import style
from asemd.errors import InputError

FLUID = """
units lj
atom_style atomic
comm_modify vel yes
lattice sc 0.8
region b block 0 {size} 0 5 0 5
create_box 2 b
create_atoms 1 box
displace_atoms all random 0.2 0.2 0.2 55
set type 1 type/fraction 2 0.4 77
mass * 1.0
velocity all create 1.0 99
pair_style {pair}
{coeff}
timestep 0.01
{more}
fix 1 all nve
run {steps} post no
"""
CASES = {
    "dpd": ("dpd 1.0 1.5 34387", "pair_coeff * * 25 4.5\npair_coeff 1 2 20 3 1.2", "", 5),
    "cold": ("dpd 0.0 1.5 34387", "pair_coeff * * 25 4.5", "", 5),
    "noise": ("dpd/fdt 1.3 1.5 34387", "pair_coeff * * 25 3.1\npair_coeff 1 2 20 2.5 1.2", "", 5),
    "thermostat": ("hybrid/overlay soft 1.1 dpd/tstat 1.0 2.0 1.5 34387", "pair_coeff * * soft 8\npair_coeff * * dpd/tstat 4.5", "", 5),
    "across": ("dpd/ext 1.0 1.5 34387", "pair_coeff * * 25 4.5 3.0 0.5 0.7", "", 5),
    "across thermostat": ("dpd/ext/tstat 1.0 1.5 1.5 34387", "pair_coeff * * 4.5 3.0 0.5 0.7", "run 5 post no", 5),
    "thin": ("dpd 1.0 1.5 34387", "pair_coeff * * 25 4.5", "", 1.5),
    "unsorted": ("dpd 1.0 1.5 34387", "pair_coeff * * 25 4.5", "atom_modify sort 0 0", 5),
}


def script(name: str, steps: int = 40) -> str:
    pair, coeff, more, size = CASES[name]
    text = FLUID.format(pair=pair, coeff=coeff, more="" if "sort" in more else more, size=size, steps=steps)
    return text.replace("lattice", more + "\nlattice") if "sort" in more else text


def test_trajectories_are_those_of_lammps():
    theirs = lammps({name: script(name) for name in CASES})
    for name in CASES:
        assert_same(asemd(script(name)), theirs[name], x=1e-10, v=1e-10)


# what a run does besides: the timestep, the end of a ramp and the velocity of images across faces count at each step
RUNS = {
    "ramp over two runs": ("dpd/tstat 1.0 4.0 1.5 34387", "pair_coeff * * 4.5", "run 10 post no\nrun 10 pre no post no"),
    "ramp": ("dpd/tstat 1.0 4.0 1.5 34387", "pair_coeff * * 4.5", "run 5 start 0 stop 40\ntimestep 0.005\nrun 5 pre no start 0 stop 40"),
    "timestep": ("dpd 1.0 1.5 34387", "pair_coeff * * 25 4.5", "fix 2 all dt/reset 2 0.001 0.02 0.02 units box\nrun 20"),
    "strain": ("dpd 1.0 1.5 34387", "pair_coeff * * 25 4.5",
               "fix 2 all deform 1 x trate 0.1 y wiggle 0.3 1 z erate -0.1 remap v\nrun 20"),
    "shear": ("dpd/ext 0.0 1.5 34387", "pair_coeff * * 25 4.5 3 0.5 0.7",
              "change_box all triclinic\nfix 2 all deform 2 xy erate 0.2 yz erate 0.1 remap v\nrun 20"),
    "levels": ("dpd 1.0 1.5 34387", "pair_coeff * * 25 4.5", "run_style respa 2 2 pair 1\nrun 10\nrun_style respa 2 2 pair 2\nrun 10"),
    "charges": ("dpd/coul/slater/long 1.0 1.5 34387 0.6 1.9",
                "variable q atom 2*(id%2)-1\nset group all charge v_q\nkspace_style ewald 1e-4\npair_modify table 0\n"
                "pair_coeff 1 1 25 4.5 yes\npair_coeff 1 2 20 3 yes 1.2\npair_coeff 2 2 25 4.5 no", "run 20"),
    "new coefficients": ("hybrid/overlay soft 1.1 dpd/tstat 1.0 2.0 1.5 34387", "pair_coeff * * soft 8\npair_coeff * * dpd/tstat 4.5",
                         "variable a equal 8+step/10\nfix 2 all adapt 4 pair soft a * * v_a reset yes\nrun 10\nrun 10"),
}
MINIMISATIONS = {
    "dpd": ("dpd 1.0 1.5 34387", "pair_coeff * * 25 0.0045", "minimize 0 1e-6 8 100\nminimize 1e-2 1e-6 8 100\nrun 3"),
    "cold": ("dpd 0.0 1.5 34387", "pair_coeff * * 25 4.5", "minimize 0 1e-6 8 100"),
    "ramp": ("hybrid/overlay soft 1.1 dpd/tstat 1.0 4.0 1.5 34387", "pair_coeff * * soft 8\npair_coeff * * dpd/tstat 0.05",
             "minimize 0 1e-6 6 100"),
    "fire": ("dpd/ext 1.0 1.5 34387", "pair_coeff * * 25 4.5 3.0 0.5 0.7", "min_style fire\nminimize 0 1e-6 6 100"),
    "explicit": ("dpd 1.0 1.5 34387", "pair_coeff * * 25 4.5",
                 "min_style fire\nmin_modify integrator eulerexplicit\nminimize 0 1e-6 6 100"),
    "quickmin": ("dpd 1.0 1.5 34387", "pair_coeff * * 25 4.5", "min_style quickmin\nminimize 0 1e-6 6 100"),
    "box": ("dpd 1.0 1.5 34387", "pair_coeff * * 25 0.045", "fix 2 all box/relax aniso 3.0 nreset 2\nminimize 0 1e-6 6 100"),
}


def in_small_box(pair: str, coeff: str, what: str) -> str:
    text = FLUID.format(pair=pair, coeff=coeff, more="", size=4, steps="@").replace("run @ post no", what)
    return text.replace("atomic", "charge") if "coul" in pair else text


def test_runs_with_more_than_one_timestep_ramp_or_box():
    theirs = lammps({name: in_small_box(*case) for name, case in RUNS.items()})
    for name, case in RUNS.items():
        assert_same(asemd(in_small_box(*case)), theirs[name], x=1e-10, v=1e-10)


def test_minimisations_are_those_of_lammps():
    theirs = lammps({name: in_small_box(*case) for name, case in MINIMISATIONS.items()})
    for name, case in MINIMISATIONS.items():
        assert_same(asemd(in_small_box(*case)), theirs[name], x=1e-10, v=1e-10)


def test_two_dimensions():
    texts = {}
    for width in (9, 1.5):
        text = FLUID.format(pair="dpd 1.0 1.5 34387", coeff="pair_coeff * * 25 4.5", more="fix 2 all enforce2d", size=width, steps=30)
        text = text.replace("sc 0.8", "sq 0.8").replace("0 5 0 5", "0 9 -0.5 0.5").replace("0.2 0.2 0.2", "0.2 0.2 0")
        texts[str(width)] = "dimension 2\n" + text
    theirs = lammps(texts)
    for name, text in texts.items():
        assert_same(asemd(text), theirs[name], x=1e-10, v=1e-10)


def test_lattices():
    """Atoms on the edges of bins are in those where LAMMPS has them."""
    texts = {}
    for kind, width, flat in (("sq2 3", 10, True), ("hex 3", 7, True), ("sc 3", 5, False), ("bcc 3", 4, False)):
        text = FLUID.format(pair="dpd 1.0 1.0 34387", coeff="pair_coeff * * 25 4.5", more="fix 2 all enforce2d" * flat, size=width, steps=3)
        text = text.replace("sc 0.8", kind).replace("displace_atoms", "#").replace("0 5 0 5", f"0 {width} -0.5 0.5" if flat else "0 5 0 4")
        texts[kind] = "dimension 2\n" * flat + text
    theirs = lammps(texts)
    for name, text in texts.items():
        assert_same(asemd(text), theirs[name], x=1e-10, v=1e-10)


def test_momentum_is_conserved_and_the_temperature_comes():
    lmp = ran(script("dpd", 400).replace("create 1.0", "create 0.1").splitlines())
    v = np.array(lmp.gather_atoms("v", 1, 3)).reshape(-1, 3)
    assert np.abs(v.sum(axis=0)).max() < 1e-10
    assert (v**2).sum() / (3 * len(v) - 3) == pytest.approx(1.0, abs=0.2)


def test_words():
    s = style.find("pair", "dpd")
    for words, message in (("1 2.5 0", "seed must be"), ("-1 2.5 7", "temperature must not be negative"), ("1 0 7", "cutoff must be more")):
        with pytest.raises(InputError, match=f"pair_style dpd: .*{message}"):
            s.parse_settings(words.split())
    with pytest.raises(InputError, match="charged must be yes or no, got 'maybe'"):
        style.find("pair", "dpd/coul/slater/long").parse_coeff("25 4.5 maybe".split(), {})
    with pytest.raises(InputError, match="pair_style dpd/fdt: temperature must not be 0"):
        style.find("pair", "dpd/fdt").parse_settings("0 2.5 7".split())
