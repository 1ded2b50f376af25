"""Exchange with a reservoir and trial insertions: the same moves as LAMMPS accepts, and the density that theory demands."""
from __future__ import annotations

import math

import both
import numpy as np
import pytest
from both import asemd, lines_of
from water_molecule import BOX, water
from wheel import ask

import asemd.fix as fixes
from asemd import relist
from asemd.engine import Engine
from asemd.errors import InputError
from asemd.fix.gcmc_moves import Moves
from asemd.kernels import trial_cells
from asemd.lammps import Lammps
from asemd.random import ParkMiller

ATOMS = """
units lj
atom_style {style}
{boundary}
lattice fcc 0.3
region box {box}
create_box 2 box
create_atoms 1 {fill}
mass 1 1.0
mass 2 1.5
pair_style {pair}
{more}
group gas type {types}
group a type 2
fix g gas {fix}
fix 2 all nve
run {steps}
"""
MOLECULES = BOX.format(width="{width}", n="{n}", bond=0.96, angle=104.5, cut=7.0) + """
group gas type 1 2
{first}
fix g gas {fix}
{more}
run {steps}
"""
WATER = water(((0.0, 0.0, 0.0), (0.7, 0.6, 0.0), (-0.7, 0.6, 0.1)))
LJ, COUL = "lj/cut 2.5\npair_coeff * * 1 1", "lj/cut/coul/cut 2.5 3.0\npair_coeff * * 1 1"
GCMC, WIDOM, MOVES = "gcmc 1 20 20 1 29494 2.0 -1.25 1.0 ", "widom 1 50 1 29494 2.0 ", "gcmc 2 30 30 0 29494 400.0 -7.0 0.8 mol water "


def atoms(fix, **other):
    return ATOMS.format(**{"style": "atomic", "boundary": "", "box": "block 0 3 0 3 0 3", "fill": "box", "pair": LJ, "more": "",
                           "types": "1", "steps": 5, "fix": fix, **other})


def molecules(fix, **other):
    return MOLECULES.format(**{"width": 16, "n": 30, "steps": 5, "first": "", "more": "", "fix": fix, **other})


LONG = "lj/cut/{} 2.5 3.0\npair_coeff * * 1 1\npair_modify table 0"
IONS = "set type 1 charge 0.3\nset type 1 type/fraction 2 0.5 8\nset type 2 charge -0.3\nkspace_style "
LONG_WATER = "pair_style lj/cut/coul/long 7.0 7.0\npair_coeff * * 0.1 3\npair_modify table 0\nkspace_style pppm 1e-4"
SITES = "pair_style lj/cut/tip4p/{} 1 2 1 1 0.15 7.0\npair_modify table 0\npair_coeff 1 1 0.15 3.1\npair_coeff * 2 0.0 1.0"
METALS = """
units metal
lattice fcc 4.05
region box block 0 3 0 3 0 3
create_box 2 box
create_atoms 1 box
create_atoms 2 random 10 4711 NULL overlap 1.3 maxtry 2000
mass 1 27
mass 2 1.0
{pair}
{more}
group gas type 2
fix g gas {fix}
fix 2 all nve
timestep 0.0002
run 2
"""
METAL = {"eam/alloy": "pair_style eam/alloy\npair_coeff * * NiAlH_jea.eam.alloy Al H",
         "hybrid": "pair_style hybrid/overlay eam/alloy lj/cut 3.0\npair_coeff * * eam/alloy NiAlH_jea.eam.alloy Al H\n"
                   "pair_coeff 2 2 lj/cut 0.01 2.0"}
REGION, TILTED = "region s block 0.2 2 0.2 2 0.5 2.5", "prism 0 3 0 3 0 3 0.5 0.3 0.4"
CASES = {
    "atoms": atoms(GCMC, steps=12),
    "from nothing, every 3": atoms("gcmc 3 20 20 1 29494 2.0 -1.25 1.0", fill="region none", pair="lj/cut 2.5\npair_coeff * * 1 1",
                                   box="block 0 3 0 3 0 3\nregion none block 9 9.1 9 9.1 9 9.1", steps=13),
    "sorted never": atoms("gcmc 2 20 20 1 29494 2.0 -1.25 1.0", boundary="atom_modify sort 0 0"),
    "full energy": atoms(GCMC + "full_energy"),
    "tail": atoms(GCMC, more="pair_modify tail yes", steps=8),
    "hybrid": atoms(GCMC, pair="hybrid lj/cut 2.5 morse 2.5\npair_coeff 1 1 lj/cut 1 1\npair_coeff * 2 morse 1 2 1.2"),
    "pressure": atoms(GCMC + "pressure 0.3 fugacity_coeff 0.9"),
    "region": atoms(GCMC + "region s", more=REGION),
    "region, full energy": atoms(GCMC + "region s full_energy", more=REGION),
    "two types": atoms(GCMC, more="set type 1 type/fraction 2 0.3 777\npair_coeff 2 2 1.2 1.1 2.2", types="1 2"),
    "a frame": atoms(GCMC + "full_energy", more="set group all type 2\ngroup frame type 2\nneigh_modify exclude group frame frame"),
    "overlap and limits": atoms(GCMC + "overlap_cutoff 0.8 min 100 max 106 tfac_insert 2.0"),
    "overlap, full energy": atoms(GCMC + "overlap_cutoff 0.7 full_energy"),
    "tilted": atoms(GCMC, box=TILTED),
    "small": atoms(GCMC, box="block 0 2 0 2 0 1"),
    "small, full energy": atoms(GCMC + "full_energy", box="block 0 2 0 2 0 1"),
    "charges": atoms(GCMC + "charge -0.2", style="charge", pair=COUL, more="set type 1 charge 0.3"),
    "charges, full energy": atoms(GCMC + "charge -0.2 full_energy", style="charge", pair=COUL, more="set type 1 charge 0.3"),
    "groups": atoms(GCMC + "group a grouptype 1 a"),
    "fixed faces": atoms("gcmc 1 20 20 1 29494 2.0 -1.25 0.05", boundary="boundary p p f", more="displace_atoms all move 0 0 0.3"),
    "molecules": molecules(MOVES),
    "molecules, turned far": molecules(MOVES + "tfac_insert 1.6667 maxangle 180 overlap_cutoff 1.5"),
    "molecules, full energy": molecules(MOVES + "full_energy intra_energy 0.1", more="fix 2 all nve\ntimestep 0.2"),
    "molecules, excluded": molecules(MOVES + "full_energy", more="neigh_modify exclude molecule/intra gas"),
    "molecules, to the last one": molecules("gcmc 1 9 9 0 29494 400.0 -300.0 0.8 mol water", n=3),
    "molecules, to the last one, full energy": molecules("gcmc 1 9 9 0 29494 400.0 -300.0 0.8 mol water full_energy", n=3),
    "mcmoves": molecules(MOVES + "mcmoves 0 1 3"),
    "mcmoves, atoms of molecules": molecules(MOVES + "mcmoves 2 1 1 full_energy", more="fix 2 all nve\ntimestep 0.2"),
    "mcmoves of atoms": atoms(GCMC + "mcmoves 3 0 0"),
    "mcmoves in a region": molecules(MOVES + "mcmoves 0 1 1 region s", first="region s block 2 14 2 14 2 14"),
    "molecules, small": molecules(MOVES + "full_energy", width=9, n=6),
    "charges, damped": atoms(GCMC + "charge -0.2 full_energy", style="charge", more="set type 1 charge 0.3",
                             pair="lj/cut/coul/dsf 0.2 2.5 3.0\npair_coeff * * 1 1"),
    "no charges among ions": atoms(GCMC, style="charge", pair="lj/cut/coul/long 2.5 3.0\npair_coeff * * 1 1", more="pair_modify table 0\n"
                                   "set type 1 type/fraction 2 0.5 8\nset type 2 charge 0.3\nkspace_style pppm 1e-4"),
    **{f"ions, {name}": atoms(GCMC + "charge -0.2", style="charge", pair=LONG.format("coul/long"), more=IONS + name, steps=3)
       for name in ("pppm 1e-4", "ewald 1e-4", "pppm/cg 1e-4")},
    "ions, slab": atoms("gcmc 1 20 20 1 29494 2.0 -1.25 0.05 charge -0.2 region s", style="charge", pair=LONG.format("coul/long"), steps=3,
                        boundary="boundary p p f", more=REGION + "\n" + IONS + "pppm 1e-4\nkspace_modify slab 3.0"),
    "ions, tilted": atoms(GCMC + "charge -0.2", style="charge", pair=LONG.format("coul/long"), more=IONS + "pppm 1e-4", box=TILTED,
                          steps=3),
    "ions, small": atoms(GCMC + "charge -0.2", style="charge", pair=LONG.format("coul/long"), more=IONS + "ewald 1e-4", steps=3,
                         box="block 0 2 0 2 0 1"),
    "molecules, pppm": molecules(MOVES + "full_energy intra_energy 0.1", more=LONG_WATER + "\nfix 2 all nve\ntimestep 0.2"),
    "mcmoves, pppm": molecules(MOVES + "mcmoves 2 1 1", more=LONG_WATER + "\nfix 2 all nve\ntimestep 0.2"),
    "molecules, small, pppm": molecules(MOVES + "full_energy", more=LONG_WATER, width=9, n=6),
    "widom, pppm": atoms(WIDOM + "charge -0.2", style="charge", pair=LONG.format("coul/long"), more=IONS + "pppm 1e-4"),
    "widom, molecules, pppm": molecules("widom 1 20 0 29494 400.0 mol water intra_energy 0.1", more=LONG_WATER),
    **{f"{what}, {name}": METALS.format(fix=fix, pair=pair, more="") for name, pair in METAL.items() for what, fix in (
        ("gcmc", "gcmc 1 15 6 2 29494 1200.0 -1.9 0.3 overlap_cutoff 0.8"), ("widom", "widom 1 6 2 29494 1200.0"))},
    "hydrogen in a region": METALS.format(fix="gcmc 1 6 6 2 29494 1200.0 -1.9 0.5 region s", pair=METAL["eam/alloy"],
                                          more="region s block 0.2 2.8 0.2 2.8 0.2 2.8"),
    "molecules, tip4p": molecules(MOVES, more=SITES.format("cut") + "\nfix 2 all nve\ntimestep 0.2", n=9),
    "molecules, tip4p and pppm": molecules(MOVES.replace("30 30", "9 9"), n=9,
                                           more=SITES.format("long") + "\nkspace_style pppm/tip4p 1e-4"),
    "widom, tip4p": molecules("widom 1 20 0 29494 400.0 mol water intra_energy 0.1", more=SITES.format("cut"), n=9),
    "widom": atoms(WIDOM),
    "widom, tail": atoms("widom 2 50 1 29494 2.0", more="pair_modify tail yes"),
    "widom, tilted": atoms(WIDOM + "full_energy", box=TILTED),
    "widom, small": atoms(WIDOM + "full_energy", box="block 0 2 0 2 0 1"),
    "widom, charges": atoms(WIDOM + "charge -0.2", style="charge", pair=COUL, more="set type 1 charge 0.3"),
    "widom, region": atoms(WIDOM + "region s", more=REGION),
    "widom, molecules": molecules("widom 1 50 0 29494 400.0 mol water"),
    "widom, molecules, full energy": molecules("widom 1 50 0 29494 400.0 mol water full_energy intra_energy 0.1", width=9, n=6),
}
SCRIPT = both.ATOMS + """
answer = {}
for name, lines in given["cases"].items():
    lmp = ran(lines)
    answer[name] = atoms_of(lmp, ("id", "type", "x", "v"))
    answer[name]["vector"] = [lmp.extract_fix("g", 0, 1, i) for i in range(3 if "widom" in name else 8)]
    answer[name]["pe"] = lmp.get_thermo("pe")
    if "group a" in str(lines):
        lmp.command("variable a equal count(a)")
        answer[name]["a"] = lmp.extract_variable("a")
    lmp.close()
"""


@pytest.fixture(scope="module")
def theirs(tmp_path_factory):
    mol = tmp_path_factory.mktemp("gcmc") / "water.mol"
    mol.write_text(WATER)
    return ask(SCRIPT, cases={name: lines_of(text.replace("water.mol", str(mol))) for name, text in CASES.items()})


@pytest.mark.parametrize("name", CASES)
def test_like_lammps(name, theirs, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "water.mol").write_text(WATER)
    session, expected = asemd(CASES[name]), theirs[name]
    system, fix = session.scene.system, session.scene.fixes["g"]
    order = np.argsort(system.id)
    assert [fix.vector(i + 1) for i in range(fix.size)] == pytest.approx(expected["vector"], rel=1e-9)
    assert system.id[order].tolist() == expected["id"]
    assert system.type[order].tolist() == expected["type"]
    assert system.x[order] == pytest.approx(np.array(expected["x"]).reshape(-1, 3), abs=1e-8)
    assert system.v[order] == pytest.approx(np.array(expected["v"]).reshape(-1, 3), abs=1e-8)
    if "tail" not in name:          # LAMMPS's tail correction is that of the last insertion it tried
        assert session.moment.potential() == pytest.approx(expected["pe"] * (system.n if "units lj" in CASES[name] else 1), rel=1e-9)
    if "a" in expected:
        assert np.count_nonzero(session.scene.groups["a"]) == expected["a"]


GAS = """
units lj
region box block 0 {width} 0 {width} 0 {width}
create_box 1 box
mass 1 1
pair_style lj/cut {cut}
pair_coeff * * {epsilon} 1.0
group gas type 1
fix g gas gcmc 1 100 0 1 4711 {t} {mu} 0.1
"""


def test_density_of_an_ideal_gas():
    """Without interactions the mean number is activity times volume, its variance the mean."""
    session = asemd(GAS.format(width=5, cut=1.2, epsilon=0, t=1.5, mu=1.5 * math.log(0.4)) + "run 20")
    numbers = []
    for _ in range(80):
        session.commands("run 3\n")
        numbers.append(session.scene.system.n)
    assert np.mean(numbers) == pytest.approx(50.0, abs=5.0)
    assert np.var(numbers) == pytest.approx(50.0, rel=0.7)


def test_density_of_a_gas_that_attracts():
    """At low density n = z V (1 - 2 B2 z), with the second virial coefficient B2 of Lennard-Jones at T = 2."""
    r = np.linspace(1e-3, 2.5, 20001)
    f = np.exp(-4.0 * (r**-12 - r**-6) / 2.0) - 1.0
    b2 = -2.0 * math.pi * float(((f * r**2)[1:] + (f * r**2)[:-1]).sum() / 2.0 * (r[1] - r[0]))
    z, volume = 0.05, 8.0**3
    session = asemd(GAS.format(width=8, cut=2.5, epsilon=1, t=2.0, mu=2.0 * math.log(z)) + "run 20")
    numbers = []
    for _ in range(80):
        session.commands("run 3\n")
        numbers.append(session.scene.system.n)
    assert b2 == pytest.approx(-1.0, abs=0.3)
    assert np.mean(numbers) == pytest.approx(z * volume * (1.0 - 2.0 * b2 * z), rel=0.08)


def test_excess_potential_of_a_gas():
    """Widom's average is 1 - 2 B2 rho at low density; in an empty box the excess is nothing."""
    session = asemd(ATOMS.format(style="atomic", boundary="", box="block 0 3 0 3 0 3\nregion none block 9 9.1 9 9.1 9 9.1",
                                 fill="region none", pair=LJ, more="", types="1", steps=1, fix=WIDOM))
    fix = session.scene.fixes["g"]
    assert [fix.vector(i) for i in (1, 2)] == [0.0, 1.0]


@pytest.mark.skipif(relist.packed.WITHOUT_COMPILER, reason="nothing is compiled")
def test_lists_after_exchanges_are_those_of_python(monkeypatch):
    """The loop builds them by itself; digits do not depend on who builds."""
    text, built, rebuild = atoms(GCMC.replace("gcmc 1", "gcmc 2"), steps=21), [], Engine.rebuild
    monkeypatch.setattr(Engine, "rebuild", lambda engine: built.append(1) or rebuild(engine))
    quick = asemd(text)
    by_python = len(built)
    monkeypatch.setattr(relist, "possible", lambda engine: False)
    anew = asemd(text)
    assert quick.scene.fixes["g"].vector(4) > 2 and quick.scene.fixes["g"].vector(6) > 2
    assert quick.loop.engine.builds == anew.loop.engine.builds > 10
    assert by_python < 5 < len(built) - by_python
    for name in ("id", "x", "v", "f", "image"):
        assert getattr(quick.scene.system, name).tolist() == getattr(anew.scene.system, name).tolist()


@pytest.mark.parametrize("lengths", [(3.0, 4.0, 9.0), (2.1, 40.0, 2.5)])
def test_cells_know_who_is_around(lengths):
    """While atoms come, go and move."""
    rng, n, cutoff = np.random.default_rng(7), 60, 1.0
    origin, edges, reach = np.array([-1.0, 2.0, 0.5]), np.array(lengths), cutoff / np.array(lengths)
    x, near, r2s = np.zeros((200, 3), order="F"), np.zeros(200, int), np.zeros(200)
    x[:n] = origin + rng.random((n, 3)) * edges
    counts = trial_cells.grid(n, reach)
    assert (counts * cutoff <= edges).all() and 1 < counts.prod() <= n
    cells = origin, np.diag(1.0 / edges), counts, np.zeros(counts.prod(), int), np.zeros(200, int)
    trial_cells.fill(n, x, *cells)
    found = 0
    for _ in range(60):
        what, i = rng.integers(3), rng.integers(n)
        if what == 0:
            x[n] = origin + rng.random(3) * edges
            trial_cells.enter(n, x, *cells)
            n += 1
        else:
            trial_cells.leave(i, x, *cells)
            if what == 1:
                x[i] = origin + rng.random(3) * edges
            else:
                n -= 1
                if i < n:
                    trial_cells.leave(n, x, *cells)
                    x[i] = x[n]
            if i < n:
                trial_cells.enter(i, x, *cells)
        p = origin + (3.0 * rng.random(3) - 1.0) * edges
        d = p - x[:n]
        d -= np.rint(d / edges) * edges
        count = trial_cells.around(p, x, cutoff**2, reach, edges, near, r2s, *cells)
        assert near[:count].tolist() == np.flatnonzero((d * d).sum(axis=1) < cutoff**2).tolist()
        assert r2s[:count] == pytest.approx((d * d).sum(axis=1)[near[:count]])
        found += count
    assert found > 60
    assert not trial_cells.grid(n, np.array([0.1, 0.5, 0.1])).any()


def test_goes_on_from_a_restart(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    start = CASES["atoms"].replace("run 12", "").replace("units lj", "units lj\natom_modify sort 0 0")
    whole = asemd(start + "restart 6 r.*\nrun 12")
    again = asemd("read_restart r.6\natom_modify sort 0 0\nfix g gas " + GCMC + "\nfix 2 all nve\nrun 6")
    assert [again.scene.fixes["g"].vector(i) for i in range(1, 9)] == [whole.scene.fixes["g"].vector(i) for i in range(1, 9)]
    assert sorted(again.scene.system.id) == sorted(whole.scene.system.id)


def test_made_in_python():
    """Without a script the peculiarities of LAMMPS are left out."""
    fix = fixes.GCMC(exchanges=5, moves=5, kind=1, displace=0.1)
    assert not fix.as_lammps
    with pytest.raises(InputError, match="no script form"):
        fix.to_lammps()
    with pytest.raises(InputError, match="T must be positive"):
        fixes.GCMC(temperature=-1.0)
    with pytest.raises(InputError, match="N must be at least 1"):
        fixes.Widom(every=0)
    assert fixes.find("widom") is fixes.Widom


@pytest.mark.parametrize(("line", "said"), [
    ("gcmc 0 1 1 1 7 1.0 0 0.1", "N must be at least 1"),
    ("gcmc 1 1 1 1 7 1.0 0", "needs 8 values, got 7"),
    ("gcmc 1 1 1 3 7 1.0 0 0.1", "outside the valid range 1 to 2"),
    ("gcmc 1 1 1 1 0 1.0 0 0.1", "seed must be a positive"),
    ("gcmc 1 1 1 1 7 0.0 0 0.1", "T must be positive"),
    ("gcmc 1 1 1 1 7 1.0 0 -0.1", "displace"),
    ("gcmc 1 1 1 1 7 1.0 0 0.1 presure 1.0", "did you mean pressure"),
    ("gcmc 1 1 1 1 7 1.0 0 0.1 pressure", "needs 1 value, got 0"),
    ("gcmc 1 1 1 1 7 1.0 0 0.1 region nowhere", "nowhere"),
    ("gcmc 1 1 1 1 7 1.0 0 0.1 region wide", "beyond the box"),
    ("gcmc 1 1 1 1 7 1.0 0 0.1 charge 1.0", "the atoms have no charges"),
    ("gcmc 1 1 1 0 7 1.0 0 0.1 mol nothing", "there is no molecule nothing"),
    ("gcmc 1 1 1 1 7 1.0 0 0.1 shake s", "cannot use shake and not molecule"),
    ("gcmc 1 1 1 1 7 1.0 0 0.1 rigid s", "cannot use rigid and not molecule"),
    ("gcmc 1 1 1 1 7 1.0 0 0.1 group b", "group b"),
    ("gcmc 1 1 1 1 7 1.0 0 0.1 mcmoves 0 0 0", "mcmoves"),
    ("gcmc 1 1 1 1 7 1.0 0 0.1 full_energy\nfix w all wall/harmonic zlo EDGE 1 1 1\nfix_modify w energy yes",
     "fix_modify w energy no"),
    ("widom 1 10 1 7", "needs 5 values, got 4"),
    ("widom 1 10 1 7 1.0 max 3", "unknown keyword 'max'"),
    ("widom 1 10 1 7 0.0", "T must be positive"),
])
def test_mistakes(line, said):
    with pytest.raises(InputError, match=said):
        asemd(atoms(line, more="region wide block 0 9 0 1 0 1", boundary="boundary p p f" if "wall" in line else "", steps=0))


BOTH = "lj/long/coul/long long long 2.5\npair_coeff * * 1 1\npair_modify table 0 table/disp 0"
SOLVED = {**{solver: atoms(GCMC + "charge -0.2", style="charge", pair=pair, more=IONS + solver, steps=2) for solver, pair in (
    ("pppm/stagger 1e-4", LONG.format("coul/long")), ("ewald/disp 1e-4", BOTH),
    ("pppm/disp 1e-4\nkspace_modify force/disp/real 1e-3 force/disp/kspace 1e-3", BOTH))},
          "dipoles": atoms(GCMC + "charge -0.2", style="dipole", pair="lj/cut/dipole/long 2.5 3.0\npair_coeff * * 1 1",
                           more="set group all dipole/random 7 0.3\n" + IONS + "ewald/disp 1e-4", steps=2),
          "msm 1e-3": molecules(MOVES.replace("gcmc 2", "gcmc 1"), more=LONG_WATER.replace("long", "msm").replace("pppm", "msm"), steps=2)}


@pytest.mark.parametrize("name", SOLVED)
@pytest.mark.parametrize("threads", [1, 2])
def test_energies_are_those_of_all_atoms(name, threads, monkeypatch, tmp_path):
    """Trials lead to the energy that the atoms have afterwards, with solvers too whose sums LAMMPS forgets to renew."""
    lmp, found, carry = Lammps(cmdargs=["-screen", "none", "-log", "none", "-threads", str(threads)]), [], Moves.carry_over
    monkeypatch.setattr(Moves, "carry_over", lambda moves: (found.append(moves.rest.accepted), carry(moves)))
    monkeypatch.chdir(tmp_path)
    (tmp_path / "water.mol").write_text(WATER)
    lmp.commands_string(SOLVED[name])
    assert len(found) == 2 and found[0] != pytest.approx(found[1], rel=1e-3)
    energy = lmp.session.loop.result.energy
    assert found[1] == pytest.approx(sum(energy.values()) if name == "dipoles" else energy["elong"], rel=1e-10)


def test_single_draws_are_those_of_a_series():
    one, many = ParkMiller(4711), ParkMiller(4711)
    assert [one.uniform() for _ in range(20)] == many.uniform(20).tolist()
    assert one.state == many.state
