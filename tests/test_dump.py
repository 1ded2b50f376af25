"""Dumps: text equal to LAMMPS's, readable by ASE; dump_modify; mistakes."""
from __future__ import annotations

import copy
import gzip
import pickle
from types import SimpleNamespace

import numpy as np
import pytest
from both import asemd, lines_of
from wheel import ask

from asemd.box import Box
from asemd.dump.atom import Atom
from asemd.dump.custom import Custom
from asemd.dump.xyz import XYZ
from asemd.errors import InputError
from asemd.system import System

SLAB = """
units metal
atom_style full
boundary p f s
lattice fcc 3.52
region b block 0 2 0 1 0 1
create_box 2 b
labelmap atom 1 Cu 2 Ni
create_atoms 1 box
set atom 2*5 type 2
set atom 3 charge -0.123456789
set atom 3*7 mol 2
set group all image 1 NULL NULL
mass * 12.0107
velocity all create 300 1234
pair_style zero 4
pair_coeff * *
variable big atom x*1e7
region r block 1 5 INF INF INF INF units box
group g type 1
"""
TILTED = """
units lj
region b prism 0 3 0 4 0 5 0.5 -0.3 0.2
create_box 1 b
create_atoms 1 random 10 123 NULL
mass 1 1
pair_style zero 1
pair_coeff * *
"""
# name: (script, words after the file, dump_modify words, style, group)
DUMPS = {
    "atom": (SLAB, "atom", "", "sort id"),
    "atom unscaled": (SLAB, "atom", "", "sort id scale no image yes units yes time yes"),
    "atom tilted": (TILTED, "atom", "", "sort id"),
    "custom": (SLAB, "custom", "id mol proc procp1 type element mass x y z xs ys zs xu yu zu xsu ysu zsu ix iy iz vx vy vz fx fy fz q "
               "v_big typelabel", "sort id"),
    "custom tilted": (TILTED, "custom", "id x y z xs ys zs xu", "sort id format float %.12g"),
    "sorted down": (SLAB, "custom", "id type element x vx", "sort -1 element Cu Ni format float %20.15g"),
    "sorted by column": (SLAB, "custom", "id vx", "sort 2"),
    "line": (SLAB, "custom", "id type x vx", 'sort id format line "%d  %3d %f %e" thresh x > 0.1 thresh id < 4'),
    "formats": (SLAB, "custom", "id type x vx", "sort id format 3 %.2f format int %5d format float %g"),
    "region": (SLAB, "custom", "id type x y", "sort id region r"),
    "threshold": (SLAB, "custom", "id q", "sort id thresh q != 0 thresh type == 2"),
    "no header": (SLAB, "custom", "id x", "sort id header no"),
    "names": (SLAB, "custom", "id x", "sort id colname id ident colname -1 place"),
    "xyz": (SLAB, "xyz", "", "sort id"),
    "xyz elements": (SLAB, "xyz", "", 'sort id element Cu Ni format line "%s  %.3f %g   %g" time yes'),
    "xyz labels": (SLAB, "xyz", "", "sort id types labels"),
}
THEIRS = r"""
import os
answer = {}
for name, (lines, style, words, modify) in given["dumps"].items():
    path = os.path.join(given["folder"], "dump")
    ran([*lines, f"dump d all {style} 2 {path} {words}", f"dump_modify d {modify}", "timestep 0.001", "run 0"]).close()
    answer[name] = open(path).read()
"""


@pytest.fixture(scope="module")
def theirs(tmp_path_factory):
    dumps = {name: (lines_of(script), *rest) for name, (script, *rest) in DUMPS.items()}
    return ask(THEIRS, dumps=dumps, folder=str(tmp_path_factory.mktemp("theirs")))


def snapshot(scene, step=0):
    scene.system.box = scene.system.box.shrink_wrapped(scene.system.x)      # a run does that first
    return SimpleNamespace(system=scene.system, groups=scene.groups, mask=scene.groups.mask, dt=0.001, step=step, dimension=3, fixes=[])


def dumped(session, line: str, modify: str = "", step: int = 0) -> None:
    session.execute(f"dump d {line}")
    if modify:
        session.execute(f"dump_modify d {modify}")
    dump = session.scene.dumps["d"]
    dump.write(snapshot(session.scene, step), step)
    dump.close()


@pytest.mark.parametrize("name", DUMPS)
def test_same_text_as_lammps(theirs, name, tmp_path):
    script, style, words, modify = DUMPS[name]
    dumped(asemd(script), f"all {style} 2 {tmp_path / 'dump'} {words}", modify)
    assert (tmp_path / "dump").read_text() == theirs[name]


def test_read_by_ase(tmp_path):
    from ase.io import read
    session = asemd(SLAB)
    dumped(session, f"all custom 1 {tmp_path}/d id type element x y z vx vy vz fx fy fz q", "element Cu Ni format float %.17g")
    system, atoms = session.scene.system, read(tmp_path / "d", format="lammps-dump-text")
    assert atoms.get_chemical_symbols() == ["Cu" if t == 1 else "Ni" for t in system.type]
    assert np.allclose(atoms.positions, system.x, atol=1e-12) and np.allclose(atoms.get_celldisp().ravel(), system.box.lo)
    assert np.allclose(atoms.cell, system.box.cell) and atoms.pbc.tolist() == [True, False, False]
    session.execute("undump d")
    dumped(session, f"all xyz 1 {tmp_path}/d.xyz", "element Cu Ni")
    assert np.allclose(read(tmp_path / "d.xyz").positions, system.x, rtol=1e-5, atol=1e-5)


def test_scaled_positions_are_read_by_ase(tmp_path):
    from ase.io import read
    session = asemd(TILTED)
    dumped(session, f"all atom 1 {tmp_path}/d", "format line \"%d %d %.17g %.17g %.17g\"")
    atoms = read(tmp_path / "d", format="lammps-dump-text")
    assert np.allclose(atoms.positions, session.scene.system.x, atol=1e-12) and np.allclose(atoms.cell, session.scene.system.box.cell)


def test_several_snapshots_and_gzip(tmp_path):
    session = asemd(TILTED)
    for name in ("a.dump", "a.dump.gz"):
        session.execute(f"dump d all atom 5 {tmp_path / name}")
        dump = session.scene.dumps["d"]
        for step in (0, 5, 10):
            dump.write(snapshot(session.scene, step), step)
        session.execute("undump d")
    plain = (tmp_path / "a.dump").read_text()
    assert plain.count("ITEM: TIMESTEP\n") == 3 and "ITEM: TIMESTEP\n10\n" in plain
    assert gzip.open(tmp_path / "a.dump.gz", "rt").read() == plain


def test_one_file_per_snapshot(tmp_path):
    session = asemd(TILTED)
    session.execute(f"dump d all atom 5 {tmp_path}/a.*.dump")
    session.execute("dump_modify d pad 4 units yes delay 5")
    for step in (0, 5, 10):
        session.scene.dumps["d"].write(snapshot(session.scene, step), step)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.0005.dump", "a.0010.dump"]
    assert all(p.read_text().startswith("ITEM: UNITS\nlj\n") for p in tmp_path.iterdir())


def test_append_and_overwrite(tmp_path):
    path = tmp_path / "d"
    for modify, count in (("append no", 1), ("append yes", 2), ("append no", 1)):
        dumped(asemd(TILTED), f"all atom 1 {path}", modify)
        assert path.read_text().count("TIMESTEP") == count


def test_group_and_empty_group(tmp_path):
    session = asemd(SLAB + "group none empty")
    dumped(session, f"g custom 1 {tmp_path}/a id type")
    lines = (tmp_path / "a").read_text().splitlines()
    assert lines[3] == str(int(session.scene.groups["g"].sum())) and all(line.endswith(" 1") for line in lines[9:])
    session.execute("undump d")
    dumped(session, f"none custom 1 {tmp_path}/b id")
    assert (tmp_path / "b").read_text().splitlines()[3] == "0"


def test_box_in_any_orientation(tmp_path):
    """Distances in the file are those of the system, and fit the cell in the file."""
    from ase.io import read
    rng = np.random.default_rng(2)
    cell = rng.normal(size=(3, 3)) + 3 * np.eye(3)[[1, 2, 0]]
    box = Box(np.array([1.0, 2.0, 3.0]), cell)
    x = box.origin + rng.random((6, 3)) @ cell
    system = System(box=box, x=x, type=1, v=rng.normal(size=(6, 3)), units="metal")
    state = SimpleNamespace(system=system, mask=lambda g: np.ones(6, bool), dt=1.0)
    for cls, more in ((Atom, ()), (Custom, (["id", "type", "x", "y", "z", "vx", "vy", "vz"],))):
        dump = cls("all", 1, str(tmp_path / cls.style), *more)
        dump.formats["float"] = "%.17g"
        dump.write(state, 0)
        dump.close()
        atoms = read(tmp_path / cls.style, format="lammps-dump-text")
        at = atoms.positions - atoms.get_celldisp().ravel()
        assert np.allclose(at @ np.linalg.inv(atoms.cell), (x - box.origin) @ np.linalg.inv(cell), atol=1e-10)
        assert np.allclose(atoms.cell.lengths(), np.linalg.norm(cell, axis=1))


def test_dumps_are_copied_and_pickled():
    dump = asemd(SLAB + "dump d all custom 1 nowhere id x v_big").scene.dumps["d"]
    for other in (copy.copy(dump), pickle.loads(pickle.dumps(dump))):
        assert other.columns == dump.columns and other._file is None


def test_needs_follow_the_columns(tmp_path):
    session = asemd(SLAB + "compute e all pe/atom\nvariable w atom c_e*2\n"
                    f"dump d all custom 1 {tmp_path}/d id v_w\ndump o all atom 1 {tmp_path}/o")
    assert "energies" in session.scene.dumps["d"].needs and not session.scene.dumps["o"].needs


def test_speed(tmp_path):
    import time
    n = 32000
    system = System(box=Box(np.zeros(3), np.eye(3) * 50), x=np.random.default_rng(1).random((n, 3)) * 50, type=1)
    state = SimpleNamespace(system=system, mask=lambda g: np.ones(n, bool), dt=1.0)
    dump = XYZ("all", 1, str(tmp_path / "d"))
    start = time.perf_counter()
    dump.write(state, 0)
    assert time.perf_counter() - start < 1.0


@pytest.mark.parametrize("line, message", [
    ("dump d all custom 1 F", "at least one column"), ("dump d all custom 1 F id foo", "unknown"),
    ("dump d all custom 1 F id tipe", "did you mean type"), ("dump d all custom 1 F id c_no", "no compute no"),
    ("dump d all custom 1 F id v_no", "undefined variable"), ("dump d all atom 1 F id", "no more words"),
    ("dump d all atom 0 F", "positive"), ("dump d all xyz 1 F.%", "per processor"), ("dump d all xyz 1 F.bin", "bin"),
    ("dump d all dcdd 1 F", "dump style"), ("dump d nope atom 1 F", "unknown group"), ("dump_modify a sort 7", "5 columns"),
    ("dump_modify a srot id", "did you mean sort"), ("dump_modify a scale maybe", "yes or no"),
    ("dump_modify a every 0", "positive"),
    ("dump_modify c format line %d", "1 formats for 2"), ('dump_modify a format line "%d %d %d %d %d"', "does not fit"),
    ("dump_modify c format float %d", "float"), ("dump_modify c format 9 %g", "2 columns"),
    ("dump_modify a format float %g", "only line and none"), ("dump_modify c format line %d,%s", "1 formats for 2"),
    ("dump_modify c thresh x > z", "number"), ("dump_modify c thresh x >> 1", "one of"),
    ("dump_modify c region nope", "unknown region"), ("dump_modify c element Cu", "needs 2"), ("dump_modify a pad", "1 value"),
    ("dump_modify a fileper 2", "with %"), ("dump_modify c image yes", "not supported"),
    ("dump_modify c sort 2", "not a number"),
])
def test_mistakes(line, message, tmp_path):
    session = asemd(SLAB + f"dump a all atom 1 {tmp_path}/a\ndump c all custom 1 {tmp_path}/c id element")
    with pytest.raises(InputError, match=message):
        session.execute(line.replace("F", str(tmp_path / "f")))
    assert not list(tmp_path.iterdir())


def test_what_the_atoms_do_not_have(tmp_path):
    session = asemd(TILTED)
    for column, message in (("q", "charges"), ("mol", "molecules"), ("typelabel", "label")):
        session.scene.dumps.clear()
        with pytest.raises(InputError, match=message):
            dumped(session, f"all custom 1 {tmp_path}/f id {column}")
    assert not list(tmp_path.iterdir())


def test_unwritable_file():
    with pytest.raises(InputError, match="cannot write /nonexistent/d"):
        dumped(asemd(TILTED), "all atom 1 /nonexistent/d")
