"""Atoms that join and leave a run and bonds that come and go, against LAMMPS."""
from __future__ import annotations

import numpy as np
import pytest
from both import asemd, lammps, lines_of
from wheel import ask

import asemd.fix as fixes
from asemd import population
from asemd.errors import InputError

SURFACE = """
units lj
boundary p p f
lattice fcc 1.0
region b block 0 5 0 5 0 10
create_box 2 b
region substrate block INF INF INF INF INF 3
create_atoms 1 region substrate
pair_style lj/cut 2.5
pair_coeff * * 1 1
mass * 1
neigh_modify delay 0
group add type 2
region slab block 0 5 0 5 8 9
compute t add temp
compute_modify t dynamic/dof yes extra/dof 0
fix 1 add nve
fix 4 add deposit 10 2 20 12345 region slab {}
thermo_style custom step atoms temp etotal
thermo_modify temp t norm no
run {}
"""
WATER = """
units lj
atom_style full
lattice sc 0.2
region b block 0 6 0 6 0 6
create_box 4 b bond/types 1 angle/types 1 extra/bond/per/atom 2 extra/angle/per/atom 2 extra/special/per/atom 4
region low block INF INF INF INF INF 2
create_atoms 1 region low
mass * 1
bond_style harmonic
bond_coeff 1 50 0.5
angle_style harmonic
angle_coeff 1 20 100
pair_style lj/cut 2.0
pair_coeff * * 1 0.8
molecule three three.mol
region slab block 0 6 0 6 4 5
fix 1 all nve
fix 4 all deposit 6 1 7 4711 region slab near 0.9 mol three vz -1 -0.5
run 30
"""
THREE = """three beads

3 atoms
2 bonds
1 angles

Coords

1 0 0 0
2 0.5 0.1 0
3 -0.3 0.4 0

Types

1 1
2 2
3 2

Charges

1 -0.2
2 0.1
3 0.1

Bonds

1 1 1 2
2 1 1 3

Angles

1 1 2 1 3
"""
MELT = """
units lj
atom_style molecular
lattice fcc 0.85
region b block 0 4 0 4 0 4
create_box 3 b bond/types 2 angle/types 1 dihedral/types 1 improper/types 1 &
extra/bond/per/atom 6 extra/special/per/atom 60 extra/angle/per/atom 20 extra/dihedral/per/atom 60 extra/improper/per/atom 20
create_atoms 1 box
mass * 1
set group all type/fraction 2 0.5 8493
velocity all create 1.44 87287
pair_style lj/cut 2.5
pair_coeff * * 1 1
special_bonds {}
bond_style harmonic
bond_coeff * 10 1.0
angle_style harmonic
angle_coeff 1 1 120
dihedral_style harmonic
dihedral_coeff 1 0.1 1 2
improper_style harmonic
improper_coeff 1 0.1 10
fix 1 all nve
fix 2 all bond/create 10 1 2 1.1 1 {}
{}
"""
SAME = "lj/coul 0 1 1"
ALLOY = """
units lj
lattice fcc 0.8442
region b block 0 3 0 3 0 3
create_box 3 b
create_atoms 1 box
mass 1 1
mass 2 2
mass 3 3
set atom 7 type 2
set atom 50 type 3
velocity all create 1.44 87287
pair_style lj/cut 2.0
pair_coeff * * 1 1
pair_coeff 2 2 0.8 1
pair_coeff 3 3 1.2 1.02
pair_coeff 1 3 0.6 1
fix 1 all nve
fix 2 all atom/swap 5 3 4711 1.0 {}
run 42
"""
CASES = {
    "swap": ALLOY.format("types 2 3"),
    "swap and keep velocities": ALLOY.format("ke no types 2 3"),
    "semi-grand": ALLOY.format("semi-grand yes mu -0.2 0.3 types 2 3"),
    "semi-grand, many": ALLOY.format("semi-grand yes mu -0.2 0.3 0.1 types 1 2 3").replace("region", "atom_modify sort 0 0\nregion"),
    "deposit": SURFACE.format("near 1.0 vz -1.0 -1.0", 63),
    "deposit local": SURFACE.format("local 0.5 1.0 1.2 vx -0.2 0.3 vz -2 -1 units box", 63),
    "deposit global": SURFACE.format("global 0.5 1.0 near 0.5 vz -1 -1 target 2 2 0 id next", 63),
    "deposit rate": SURFACE.format("near 0.6 rate 1.0 vy 0 1 attempt 50", 63),
    "deposit gaussian": SURFACE.format("near 0.2 gaussian 2.5 2.5 8.5 0.2 vz -1 -1", 15),
    "deposit molecules": WATER,
    "create": MELT.format(SAME, "", "run 32"),
    "create weighted": MELT.format("lj/coul 0.5 1 1", "", "run 22"),
    "create limited": MELT.format(SAME, "iparam 2 3 jparam 1 2", "run 32"),
    "create with items": MELT.format("lj/coul 0 0.3 0.6", "iparam 3 1 atype 1 dtype 1 itype 1", "run 33"),
    "create perhaps": MELT.format(SAME, "prob 0.4 5557", "run 32"),
    "create perhaps, limited": MELT.format("lj/coul 0.5 1 1", "iparam 2 3 jparam 1 2 prob 0.7 77", "run 32"),
    "break perhaps": MELT.format(SAME, "atype 1 dtype 1 itype 1", "run 30\nunfix 2\nfix 2 all bond/break 4 1 1.05 prob 0.5 991\nrun 21"),
    "break": MELT.format(SAME, "atype 1 dtype 1 itype 1", "run 30\nunfix 2\nfix 2 all bond/break 4 1 1.05\nrun 10"),
}
SCRIPT = """
import numpy as np
answer = {}
for name, lines in given["cases"].items():
    lmp = ran(lines)
    x, types = (by_id(lmp, key).tolist() for key in ("x", "type"))
    answer[name] = {"x": x, "type": types,
                    "items": [int(lmp.extract_global(k)) for k in ("nbonds", "nangles", "ndihedrals", "nimpropers")],
                    "pe": lmp.get_thermo("pe"), "temp": lmp.get_thermo("temp")}
    if "fix 2" in str(lines):
        answer[name]["vector"] = [lmp.extract_fix("2", 0, 1, i) for i in (0, 1)]
    lmp.close()
"""


@pytest.fixture(scope="module")
def theirs(tmp_path_factory):
    mol = tmp_path_factory.mktemp("deposit") / "three.mol"
    mol.write_text(THREE)
    return ask(SCRIPT, cases={name: lines_of(text.replace("&\n", "").replace("three.mol", str(mol))) for name, text in CASES.items()})


@pytest.mark.parametrize("name", CASES)
def test_like_lammps(name, theirs, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "three.mol").write_text(THREE)
    session, expected = asemd(CASES[name]), theirs[name]
    system = session.scene.system
    order = np.argsort(system.id)
    assert system.type[order].tolist() == expected["type"]
    assert system.x[order] == pytest.approx(np.array(expected["x"]), abs=1e-8)
    top = system.topology
    assert [len(top.items(kind)[0]) for kind in ("bond", "angle", "dihedral", "improper")] == expected["items"]
    assert session.last_thermo["Temp"] == pytest.approx(expected["temp"], rel=1e-9)
    assert session.moment.potential() / (1 if "deposit" in name and "mol" not in name else 1) == pytest.approx(
        expected["pe"] * (system.n if "deposit" not in name or "mol" in name else 1), rel=1e-8)
    if "vector" in expected:
        assert [session.scene.fixes["2"].vector(i) for i in (1, 2)] == expected["vector"]


GAS = """
units lj
lattice fcc 0.5
region b block 0 5 0 5 0 5
create_box 1 b
create_atoms 1 box
mass 1 1
velocity all create 1.0 87287
pair_style lj/cut 2.5
pair_coeff 1 1 1 1 2.5
fix 1 all nve
region s block INF INF INF INF 2 INF
"""


def test_evaporate():
    """Atoms of the region go on multiples of N."""
    session = asemd(GAS + "fix 2 all evaporate 10 7 s 4433\nrun 9")
    assert session.scene.system.n == 500
    session.commands("run 1\n")
    assert session.scene.system.n == 493
    session.commands("run 15\n")
    assert session.scene.system.n == 486
    assert session.scene.fixes["2"].scalar() == 14.0
    gone = np.setdiff1d(np.arange(1, 501), session.scene.system.id)
    start = asemd(GAS).scene.system
    height = start.x[np.isin(start.id, gone), 2]
    assert ((height > 1.5 * (4 / 0.5) ** (1 / 3)) | (height == 0.0)).all()      # some came through the lower face


DRYING = """
units lj
atom_style {style}
atom_modify map array{sort}
lattice fcc 0.5
region box block 0 4 0 4 0 4
create_box 1 box
create_atoms 1 box
displace_atoms all random 0.1 0.1 0.1 77
variable m atom (id%9)*(id<100)
{first}
pair_style lj/cut 2.0
pair_coeff 1 1 1 1
velocity all create 3.0 87287 loop geom
region s block INF INF INF INF 1 INF
group g id 1:200
fix 1 all nve
thermo_modify norm no
fix 2 g evaporate {words}
{then}
"""
DRY = {"atomic": ("atomic", "", "mass 1 1", "5 3 s 4711", "run 12\nrun 13"),
       "sphere": ("sphere", "", "set group all diameter 1 density 1", "5 3 s 4711", "run 22"),
       "not sorted": ("atomic", " sort 0 0", "mass 1 1", "4 30 s 99", "run 22"),
       "sorted often": ("atomic", " sort 7 1.1", "mass 1 1", "4 3 s 99", "run 50"),
       "molecules": ("bond", "", "mass 1 1\nset group all mol v_m", "5 3 s 4711 molecule yes", "run 25"),
       "until none is left": ("atomic", "", "mass 1 1", "2 90 s 3", "run 12")}


def test_evaporate_takes_the_atoms_that_lammps_takes():
    scripts = {name: DRYING.format(style=style, sort=sort, first=first, words=words, then=then)
               for name, (style, sort, first, words, then) in DRY.items()}
    theirs = lammps(scripts)
    for name, text in scripts.items():
        assert "error" not in theirs[name], theirs[name]
        assert sorted(asemd(text).scene.system.id.tolist()) == theirs[name]["id"], name
        assert 20 < len(theirs[name]["id"]) < 250, name


def test_evaporate_goes_on_from_a_restart(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    fix = "fix 2 all evaporate 10 7 s 4433\n"
    whole = asemd(GAS + fix + "restart 15 r.*\nrun 35")
    rest = asemd("read_restart r.15\nlattice fcc 0.5\nregion s block INF INF INF INF 2 INF\nfix 1 all nve\n" + fix + "run 20")
    assert sorted(rest.scene.system.id) == sorted(whole.scene.system.id)
    assert rest.scene.fixes["2"].scalar() == 21.0


@pytest.mark.parametrize("last", ["restart 15 r.*\nrun 32\nrun 0", "run 15\nwrite_restart r.15\nrun 17"])
def test_bonds_by_chance_go_on_from_a_restart(tmp_path, monkeypatch, last):
    monkeypatch.chdir(tmp_path)
    script = MELT.format(SAME, "prob 0.3 5557", last)
    whole = asemd(script)
    fixes = "\n".join(line for line in lines_of(MELT.format(SAME, "prob 0.3 5557", "")) if line.startswith("fix "))
    rest = asemd(f"read_restart r.15\n{fixes}\nrun 17")
    assert len(whole.scene.system.topology.bonds) > len(asemd("read_restart r.15").scene.system.topology.bonds)
    np.testing.assert_array_equal(np.sort(np.sort(whole.scene.system.id[whole.scene.system.topology.bonds], axis=1), axis=0),
                                  np.sort(np.sort(rest.scene.system.id[rest.scene.system.topology.bonds], axis=1), axis=0))


def test_deposit_goes_on_from_a_restart(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    script = SURFACE.format("near 1.0 vz -1.0 -1.0", 70).replace("run 70", "")
    whole = asemd(script + "restart 30 r.*\nrun 70")
    again = asemd("read_restart r.30\nlattice fcc 1.0\nregion slab block 0 5 0 5 8 9\nfix 1 add nve\n"
                  "fix 4 add deposit 10 2 20 12345 region slab near 1.0 vz -1.0 -1.0\nrun 40")
    assert again.scene.system.n == whole.scene.system.n
    order, other = (np.argsort(s.scene.system.id) for s in (again, whole))
    assert again.scene.system.x[order] == pytest.approx(whole.scene.system.x[other], abs=1e-12)


@pytest.mark.parametrize(("line", "said"), [
    ("fix 2 all evaporate 0 7 s 4433", "N and M must be at least 1"),
    ("fix 2 all evaporate 10 7 nowhere 4433", "nowhere"),
    ("fix 2 all evaporate 10 7 s 4433 molecules yes", "did you mean molecule"),
    ("fix 2 all evaporate 10 7 s 4433 molecule yes", "no molecules"),
    ("fix 2 all deposit 10 1 20 12345", "needs the keyword region"),
    ("fix 2 all deposit 10 1 20 12345 region s", "beyond the box"),
    ("region c block 0 9 0 5 0 5\nfix 2 all deposit 10 1 20 12345 region c", "beyond the box"),
    ("region c block 0 1 0 1 0 1\nfix 2 all deposit 10 2 20 12345 region c", "type"),
    ("region c block 0 1 0 1 0 1\nfix 2 all deposit 10 1 20 12345 region c nera 1", "did you mean near"),
    ("region c block 0 1 0 1 0 1\nfix 2 all deposit 10 1 20 12345 region c shake 1", "cannot use shake and not molecule"),
    ("fix 2 all atom/swap 5 3 4711 1.0 types 1", "types"),
    ("fix 2 all atom/swap 5 3 4711 1.0 semi-grand yes types 1 1", "given together"),
    ("fix 2 all bond/create 10 1 1 1.1 1", "bond type"),
    ("fix 2 all bond/break 10 1", "Nevery bondtype Rmax"),
])
def test_mistakes(line, said):
    with pytest.raises(InputError, match=said):
        asemd(GAS + line)


def test_as_plain_classes():
    """Numbers in words, without a script."""
    with pytest.raises(InputError, match="needs a region"):
        fixes.Deposit(count=3)
    with pytest.raises(InputError, match="must be the same"):
        fixes.BondCreate(types=(1, 1), most=(1, 2))
    assert fixes.BondBreak(every=5, distance=1.5).to_lammps() == ["5", "1", "1.5"]
    assert fixes.find("evaporate") is fixes.Evaporate


def test_semi_grand_composition():
    """Atoms without interaction: the numbers of the two types follow their chemical potentials."""
    session = asemd(GAS.replace("create_box 1", "create_box 2").replace("mass 1 1", "mass * 1").replace("lj/cut 2.5", "zero 2.5").replace(
        "pair_coeff 1 1 1 1 2.5", "pair_coeff * *") + "fix 2 all atom/swap 1 500 7 1.0 semi-grand yes mu 0 1.0 types 1 2\nrun 12")
    share = (session.scene.system.type == 2).mean()
    assert share == pytest.approx(np.e / (1 + np.e), abs=0.06)


@pytest.mark.parametrize("more", ["", "special_bonds lj 0 0.5 1", "neigh_modify exclude type 1 4"])
def test_engine_follows_single_atoms_as_if_it_were_made_anew(more, tmp_path, monkeypatch):
    """Among molecules, more than a plain list is for; atoms of other masses and types come and go."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "three.mol").write_text(THREE)
    start = WATER.split("region slab")[0].replace("0 6 0 6 0 6", "0 12 0 12 0 12").replace("cut 2.0", "cut 2.5")
    text = f"""{start}mass 4 3.0
region all block 0 12 0 12 0 12
create_atoms 0 random 80 4711 all mol three 993 overlap 0.9 maxtry 1000
create_atoms 4 random 30 4712 all overlap 0.9
group single type 4
{more}
fix 1 all nve
fix 2 single evaporate 3 2 all 4713
fix 3 single deposit 50 4 2 4714 region all near 0.8 attempt 50 vx -1 1
run 25
"""
    counted, follow = [], population.turnover.follow
    monkeypatch.setattr(population.turnover, "follow", lambda *args: counted.append(1) or follow(*args))
    quick = asemd(text)
    monkeypatch.setattr(population.turnover, "simple", lambda *args: False)
    anew = asemd(text)
    assert len(counted) > 15 and quick.scene.system.n == anew.scene.system.n
    assert quick.scene.system.id.tolist() == anew.scene.system.id.tolist()
    assert quick.loop.engine.builds == anew.loop.engine.builds
    for name in ("x", "v", "f"):
        assert getattr(quick.scene.system, name) == pytest.approx(getattr(anew.scene.system, name), rel=1e-9, abs=1e-9)
    assert quick.moment.potential() == pytest.approx(anew.moment.potential(), rel=1e-12)
