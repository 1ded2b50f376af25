"""Every potential file of many-body styles that comes with LAMMPS, with all its elements: energies, forces and virial against LAMMPS.

Those of embedded atoms are in `test_embedded`.
"""
from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from test_embedded import folder
from test_manybody import uncompiled
from wheel import ask

pytestmark = pytest.mark.slow
STYLES = {".sw": "sw", ".sw.mod": "sw/mod", ".tersoff": "tersoff", ".tersoff.mod": "tersoff/mod", ".tersoff.modc": "tersoff/mod/c",
          ".tersoff.zbl": "tersoff/zbl", ".gw": "gw", ".gw.zbl": "gw/zbl", ".vashishta": "vashishta", ".edip": "edip/multi",
          ".extep": "extep", ".nb3b.harmonic": "nb3b/harmonic", ".nb3b.screened": "nb3b/screened"}
# file -> pair_style, words before the elements of the types, these elements
OTHERS = {
    "SiCGe.tersoff": ("tersoff", "SiCGe.tersoff", "C Si(D)"), "Si.edip": ("edip", "Si.edip", "Si"),
    "SiO.tersoff": ("tersoff", "SiO.tersoff", "Si O"),
    "CuTa_eam.poly": ("polymorphic", "CuTa_eam.poly", "Ta Cu"), "FeCH_BOP_I.poly": ("polymorphic", "FeCH_BOP_I.poly", "C Fe H"),
    "FeCH_BOP_II.poly": ("polymorphic", "FeCH_BOP_II.poly", "C Fe H"), "GaN_sw.poly": ("polymorphic", "GaN_sw.poly", "N Ga"),
    "GaN_tersoff.poly": ("polymorphic", "GaN_tersoff.poly", "Ga N"), "TlBr_msw.poly": ("polymorphic", "TlBr_msw.poly", "Br Tl"),
    "Si_1.meam.spline": ("meam/spline", "Si_1.meam.spline", "Si"), "Si_2.meam.spline": ("meam/spline", "Si_2.meam.spline", "Si"),
    "Ti.meam.spline": ("meam/spline", "Ti.meam.spline", "Ti"), "TiO.meam.spline": ("meam/spline", "TiO.meam.spline", "Ti O"),
    "Si.b.meam.sw.spline": ("meam/sw/spline", "Si.b.meam.sw.spline", "Si"),
    "Ti.meam.sw.spline": ("meam/sw/spline", "Ti.meam.sw.spline", "Ti"),
    "AlSiMgCuFe.meam": ("meam", "library.meam AlS SiS MgS CuS FeS AlSiMgCuFe.meam", "FeS AlS MgS SiS CuS"),
    "Bi.meam": ("meam", "library.meam Bi Bi.meam", "Bi"), "Cu.meam": ("meam", "library.meam Cu Cu.meam", "Cu"),
    "Ni.meam": ("meam", "library.meam Ni Ni.meam", "Ni"), "SiC.meam": ("meam", "library.meam Si C SiC.meam", "C Si"),
    "WL.meam": ("meam", "library.meam WL WL.meam", "WL"), "HGa.msmeam": ("meam/ms", "library.msmeam H Ga4 HGa.msmeam", "Ga4 H"),
    "MoCoNiVFeAlCr_2nn.meam": ("meam", "library_2nn.meam Mo Co Ni V Fe Al Cr MoCoNiVFeAlCr_2nn.meam", "Mo Co Ni V Fe Al Cr"),
    "CH.rebo": ("rebo", "CH.rebo", "C H"), "CH.airebo": ("airebo 1.4", "CH.airebo", "C H"),
    "CH.airebo-m": ("airebo/morse 1.4", "CH.airebo-m", "H C"),
    "C_SNAP_2021.10.15.quadratic.snapcoeff": ("snap", "C_SNAP_2021.10.15.quadratic.snapcoeff C_SNAP_2021.10.15.quadratic.snapparam", "C"),
    "Si.nn.mliap.model": ("mliap model nn Si.nn.mliap.model descriptor so3 Si.nn.mliap.descriptor", "", "Si"),
    "Ni_Mo.mliap.model": ("mliap model linear Ni_Mo.mliap.model descriptor so3 Ni_Mo.mliap.descriptor", "", "Ni Mo"),
    "Cu.nn.mliap.model": ("mliap model nn Cu.nn.mliap.model descriptor sna Cu.snap.mliap.descriptor", "", "Cu"),
}
FAR = {"CH.rebo": 1.4, "CH.airebo": 1.5, "CH.airebo-m": 1.5, "BN.extep": 1.5, "BNC.tersoff": 1.6,
       "MOH.nb3b.harmonic": 1.0, "PSiO.nb3b.screened": 1.6}
# digits that LAMMPS does not have; two entries of a file for one triple of atoms, rounded apart: which one counts depends on their order
DIGITS = dict.fromkeys(("CH.rebo", "CH.airebo", "CH.airebo-m"), 1e-9) | {"Si.edip": 1e-5, "CdTeZnSeHgS0.sw": 1e-6}
# for libraries beside LAMMPS
UNREAD = {"SiGeH.sw.quip", "Ta06A.pytorch.mliap"}
TALKS = ("energy", "force", "pressure")
MEASURE = r"""
import numpy as np
def measure(lmp, lines):
    for line in lines:
        lmp.command(line)
    n = int(lmp.get_natoms())
    return {"energy": [lmp.get_thermo("pe")], "force": np.array(lmp.gather_atoms("f", 1, 3)).reshape(n, 3).tolist(),
            "pressure": [lmp.get_thermo(k) for k in ("pxx", "pyy", "pzz", "pxy", "pxz", "pyz")]}
"""
THEIRS = MEASURE + r"""
import os
os.chdir(given["folder"])
answer = {}
for name, lines in given["jobs"].items():
    lmp = start()
    try:
        answer[name] = measure(lmp, lines)
    except Exception as e:
        answer[name] = {"error": str(e)}
    lmp.close()
"""
OURS = MEASURE + r"""
import json, os, sys, warnings
warnings.simplefilter("ignore")
from asemd.lammps import Lammps
os.chdir(os.environ["LAMMPS_POTENTIALS"])
answer = {}
for name, lines in json.load(sys.stdin).items():
    lmp = Lammps(cmdargs=["-screen", "none", "-log", "none", "-compat", "lammps"])
    try:
        answer[name] = measure(lmp, lines)
    except Exception as e:
        answer[name] = {"error": str(e)}
print(json.dumps(answer))
"""


def elements_of(path: Path) -> list[str]:
    """Elements of a file of triples that have an entry of their own."""
    words = [line.split("#")[0].split() for line in path.read_text(errors="replace").splitlines()]
    return list(dict.fromkeys(w[0] for w in words if len(w) > 3 and w[0] == w[1] == w[2] and w[0][0].isalpha()))


def scene(pair: list[str], types: int, spacing: float, seed: int) -> list[str]:
    """Atoms of all types near the points of a sheared cubic lattice, periodic and narrower than the cutoff along two axes."""
    rng, sides = np.random.default_rng(seed), (2, 2, 2 if types < 5 else 3)
    x = (np.stack(np.meshgrid(*map(np.arange, sides), indexing="ij"), -1).reshape(-1, 3) + 0.5) * spacing
    x += rng.uniform(-0.1, 0.1, x.shape) * spacing
    kinds = rng.permutation(np.arange(len(x)) % types + 1)
    a, b, c = (n * spacing for n in sides)
    return ["units metal", "boundary p p f", f"region b prism 0 {a} 0 {b} -3 {c + 3} {0.1 * a} 0 0", f"create_box {types} b",
            *(f"create_atoms {t} single {' '.join(map(repr, p))}" for t, p in zip(kinds, x.tolist())), "mass * 1.0", *pair,
            "thermo_style custom step pe pxx pyy pzz pxy pxz pyz", "thermo_modify norm no", "run 0 post no"]


def jobs(potentials: Path) -> dict[str, list[str]]:
    out = {}
    for k, path in enumerate(sorted(potentials.iterdir())):
        name, ending = path.name, "." + path.name.partition(".")[2]
        style = STYLES.get(ending) or STYLES.get("." + name.rpartition(".")[2])
        if name in OTHERS:
            style, head, elements = OTHERS[name]
            pair, types = [f"pair_style {style}", f"pair_coeff * * {head} {elements}"], len(elements.split())
        elif name.endswith((".snap", ".mliap")) and name not in UNREAD:      # commands
            types = 2 if name.startswith(("InP", "WBe")) or "_He_" in name else 1
            pair = [f"include {name}"]
        elif style:
            elements = elements_of(path)
            pair, types = [f"pair_style {style}", f"pair_coeff * * {name} {' '.join(elements)}"], len(elements)
        else:
            continue
        out[name] = scene(pair, types, FAR.get(name, 2.4), k)
    eim = "Li Na K Rb Cs F Cl Br Id"
    library = [line.split("'")[1] for line in (potentials / "library.meam").read_text().splitlines() if line.startswith("'")]
    for name, style, head, elements in (("ffield.eim", "eim", f"{eim} ffield.eim", eim), *(
            (f"library.meam, {e}", "meam", f"library.meam {e} NULL", e) for e in library)):
        out[name] = scene([f"pair_style {style}", f"pair_coeff * * {head} {elements}"], len(elements.split()), 2.6, 7)
    for name in ("library.meam, Vac", "library.meam, zz"):      # LAMMPS refuses both
        del out[name]
    return out


def test_like_lammps():
    given = jobs(folder())
    theirs = ask(THEIRS, jobs=given, folder=str(folder()))
    ours = uncompiled(OURS, given, str(folder()), timeout=3600.0)
    wrong = []
    for name in given:
        if "error" in theirs[name] or "error" in ours[name]:
            wrong.append((name, theirs[name].get("error"), ours[name].get("error")))
            continue
        for what in TALKS:
            got, want = np.array(ours[name][what]), np.array(theirs[name][what])
            off = np.abs(got - want).max() / max(np.abs(want).max(), 1e-3)
            if not off < DIGITS.get(name, 1e-11):
                wrong.append((name, what, off))
    assert not wrong, "\n".join(map(str, wrong))


def test_no_file_is_forgotten():
    """Files of styles that asemd has are in the sweep, or belong to another file of it."""
    given, named = jobs(folder()), set()
    for lines in given.values():
        named |= {word for line in lines for word in line.split()}
    for name in given:
        if name.endswith((".snap", ".mliap")):
            named |= set((folder() / name).read_text().split())
    endings = (*STYLES, ".poly", ".meam", ".msmeam", ".spline", ".rebo", ".airebo", ".airebo-m", ".snapcoeff", ".snapparam", ".snap",
               ".mliap.model", ".mliap.descriptor", ".mliap", ".eim")
    assert not {n for n in os.listdir(folder()) if n.endswith(endings)} - named - set(given) - UNREAD
