"""asemd.EAM: the ASE calculator of an embedded-atom potential file."""
from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from ase import Atoms
from ase.build import bulk
from ase.filters import UnitCellFilter
from ase.io.jsonio import decode, encode
from ase.optimize import BFGS
from test_embedded import potentials, small  # noqa: F401

import asemd
from asemd.errors import InputError


def names(path, *elements) -> str:
    """The same file with other names of its elements."""
    path.write_text(path.read_text().replace("2 A B", f"2 {' '.join(elements)}"))
    return str(path)


def rattled(symbol="Cu", a=3.615, cells=3, seed=1):
    atoms = bulk(symbol, a=a, cubic=True) * (cells, cells, cells)
    atoms.rattle(0.1, rng=np.random.default_rng(seed))
    return atoms


@pytest.mark.parametrize("file, symbol, a, form", [("Cu_mishin1.eam.alloy", "Cu", 3.615, "alloy"), ("Fe_mm.eam.fs", "Fe", 2.855, "fs")])
def test_agrees_with_ase(potentials, file, symbol, a, form):  # noqa: F811
    from ase.calculators.eam import EAM
    atoms = rattled(symbol, a)
    atoms.calc = asemd.EAM.from_file(file)
    other = atoms.copy()
    other.calc = EAM(potential=str(potentials / file), form=form)
    assert atoms.get_potential_energy() == pytest.approx(other.get_potential_energy(), rel=1e-11)
    assert np.abs(atoms.get_forces() - other.get_forces()).max() < 1e-6      # by slopes of other splines


def test_elements_go_by_symbols(potentials):  # noqa: F811
    """Symbols, not numbers of types; what the atoms have may change."""
    atoms = rattled("Ni", 3.52)
    atoms.calc = asemd.EAM.from_file("NiAlH_jea.eam.alloy")
    pure = atoms.get_potential_energy()
    atoms.symbols[::4] = "Al"
    mixed = atoms.get_potential_energy()
    assert mixed != pytest.approx(pure)
    fresh = atoms[::-1]
    fresh.calc = asemd.EAM("NiAlH_jea.eam.alloy")
    assert fresh.get_potential_energy() == pytest.approx(mixed, rel=1e-13)
    atoms.symbols[::4] = "Ni"
    atoms.set_array("type", np.arange(len(atoms)) % 2 + 1)
    assert atoms.get_potential_energy() == pytest.approx(pure, rel=1e-13)
    atoms.symbols[0] = "Au"
    with pytest.raises(InputError, match="NiAlH_jea.eam.alloy has no Au, but Ni Al H"):
        atoms.get_potential_energy()


def test_single_elements_are_mixed(potentials):  # noqa: F811
    atoms = rattled()
    atoms.symbols[::3] = "Ni"
    atoms.calc = asemd.EAM.from_file("Cu_u3.eam", "Ni_u3.eam")
    energy = atoms.get_potential_energy()
    assert energy == pytest.approx(atoms.get_potential_energies().sum(), rel=1e-12)
    atoms.symbols[::3] = "Zn"
    atoms.calc = asemd.EAM("Cu_u3.eam", "Ni_u3.eam", elements={"Cu": "Cu_u3.eam", "Zn": "Ni_u3.eam"})
    assert atoms.get_potential_energy() == pytest.approx(energy, rel=1e-13)


@pytest.mark.parametrize("style", ["eam/alloy", "eam/fs", "adp", "eam/cd"])
def test_stress_is_the_slope_of_the_energy(tmp_path, style):
    atoms = rattled("Ar", 4.1, 2)
    atoms.symbols[::3] = "Kr"
    atoms.calc = asemd.EAM(names(small(tmp_path, style), "Ar", "Kr"), style=style)
    stress, h = atoms.get_stress(voigt=False), 1e-5
    cell = atoms.cell.array.copy()
    for a, b in ((0, 0), (1, 2)):
        energies = []
        for step in (-h, h):
            strain = np.eye(3)
            strain[a, b] += step / (1 if a == b else 2)
            strain[b, a] = strain[a, b] if a != b else strain[a, a]
            atoms.set_cell(cell @ strain, scale_atoms=True)
            energies.append(atoms.get_potential_energy())
            atoms.set_cell(cell, scale_atoms=True)
        assert (energies[1] - energies[0]) / (2 * h) / atoms.get_volume() == pytest.approx(stress[a, b], rel=1e-6, abs=1e-9)


def test_relaxes_cells(potentials):  # noqa: F811
    atoms = bulk("Cu", a=3.7, cubic=True)
    atoms.calc = asemd.EAM("Cu_mishin1.eam.alloy")
    with BFGS(UnitCellFilter(atoms), logfile=None) as optimizer:
        optimizer.run(fmax=1e-4, steps=100)
    assert atoms.cell.lengths() == pytest.approx([3.615] * 3, abs=1e-3)
    assert atoms.get_potential_energy() / 4 == pytest.approx(-3.54, abs=1e-3)


def test_copies_and_arguments(tmp_path):
    calc = asemd.EAM(names(small(tmp_path), "Ar", "X1"), style="eam/alloy", elements={"Kr": "X1"}, skin=0.5)
    atoms = rattled("Ar", 4.1, 2)
    atoms.symbols[::3] = "Kr"
    atoms.calc = calc
    energy = atoms.get_potential_energy()
    given = decode(encode(calc.todict()))
    for other in (calc.copy(), asemd.EAM(*given.pop("files"), **given)):
        twin = atoms.copy()
        twin.calc = other
        assert twin.get_potential_energy() == energy
    assert repr(calc).startswith("EAM('") and "eam/alloy" in repr(calc)


def test_elements_of_single_files(potentials, tmp_path, monkeypatch):  # noqa: F811
    monkeypatch.setenv("LAMMPS_POTENTIALS", potentials)
    copper, other = rattled("Cu", 3.6, 2), rattled("Cu", 3.6, 2)
    copper.calc = asemd.EAM.from_file(["Cu_u3.eam", "Ni_u3.eam"])
    for name in ("Cu", "Cu_u3.eam"):
        other.symbols[:] = "X"
        other.calc = asemd.EAM.from_file("Cu_u3.eam", elements={"X": name})
        assert other.get_potential_energy() == pytest.approx(copper.get_potential_energy(), rel=1e-14)
        other.symbols[:] = "Cu"
        assert other.get_potential_energy() == pytest.approx(copper.get_potential_energy(), rel=1e-14)
    for files, elements, message in ((["Cu_u3.eam"], {"X": "Ag"}, "no file is for 'Ag'"),
                                     (["Cu_u3.eam"], ["X"], "elements are chemical symbols"),
                                     (["Cu_u3.eam", "Cu_u6.eam"], None, "two files are for Cu: Cu_u3.eam and Cu_u6.eam")):
        with pytest.raises(InputError, match=message):
            asemd.EAM.from_file(*files, elements=elements)


@pytest.mark.parametrize("make", [lambda: asemd.EAM.from_file("Cu_u3.eam"), lambda: asemd.Potential("Si.sw"),
                                  lambda: asemd.Potential("library.meam")])
def test_no_atoms(make, potentials, monkeypatch):  # noqa: F811
    monkeypatch.setenv("LAMMPS_POTENTIALS", potentials)
    calc, none = make(), Atoms()
    with pytest.raises(InputError, match="has no atoms yet"):
        calc.get_potential_energy()
    some = bulk("Cu" if isinstance(calc, asemd.EAM) else "Si")
    none.calc = calc
    assert none.get_potential_energy() == 0.0 and none.get_forces().shape == (0, 3)
    assert calc.get_potential_energy(some) < -3.0 and calc.get_potential_energy(none) == 0.0


def test_files_stay_the_same_in_other_folders(potentials, tmp_path, monkeypatch):  # noqa: F811
    monkeypatch.setenv("LAMMPS_POTENTIALS", potentials)
    for folder in ("mine", "run"):
        (tmp_path / folder).mkdir()
    (tmp_path / "mine" / "Si.sw").write_text((Path(potentials) / "Si.sw").read_text().replace("2.1683", "3.0000"))
    monkeypatch.chdir(tmp_path)
    silicon = bulk("Si")
    calcs = [asemd.Potential.from_file("mine/Si.sw"), asemd.Potential.from_file("Si.sw")]
    monkeypatch.chdir(tmp_path / "run")
    mine, theirs = (c.get_potential_energy(silicon) for c in calcs)
    assert mine == pytest.approx(theirs * 3.0 / 2.1683, rel=1e-12)
    assert calcs[1].todict()["file"] == "Si.sw"
    for make in (asemd.Potential.from_file, asemd.EAM.from_file):
        with pytest.raises(InputError, match="cannot open file mine/Si.sw: no such file"):
            make("mine/Si.sw", style="sw" if make == asemd.Potential.from_file else "eam")


def test_what_is_wrong(tmp_path):
    path = names(small(tmp_path), "Ar", "Kr")
    for options, message in (({}, "does not tell its style"), ({"style": "eam/aloy"}, r"unknown style 'eam/aloy' \(did you mean eam/alloy"),
                             ({"style": "eam/alloy", "elements": {"Ne": "N"}}, "has no element 'N', it has Ar Kr")):
        with pytest.raises(InputError, match=message):
            asemd.EAM.from_file(path, **options)
    with pytest.raises(InputError, match="needs a potential file"):
        asemd.EAM()
    with pytest.raises(InputError, match="takes one file for all elements, got 2"):
        asemd.EAM(path, path, style="eam/fs")
    with pytest.raises(InputError, match="cannot open file nothing.eam"):
        asemd.EAM.from_file("nothing.eam")
