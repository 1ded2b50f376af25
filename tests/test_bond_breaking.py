"""Bonds with a past: quartic and bpm/spring break, harmonic/restrain remembers; special is a pair interaction. Step by step like LAMMPS."""
from __future__ import annotations

import copy
import math
import pickle

import numpy as np
import pytest
from wheel import ask, ran, start

import asemd
from asemd.errors import InputError, SimulationError
from asemd.kernels import bonded
from asemd.style import find
from asemd.testing.styles import sample

STEPS = r"""
answer = {}
for name, (lines, more) in given["cases"].items():
    lmp, rows = start(), []
    for line in lines + ["run 0 post no"] + more:
        lmp.command(line)
        if line.startswith(("run", "minimize")):
            rows.append({k: lmp.get_thermo(k) for k in given["words"]} | {k: by_id(lmp, k) for k in "xvf"})
    answer[name] = rows
    lmp.close()
"""
WORDS = ("pe", "ebond", "evdwl", "ecoul", "bonds", "press", "pxy")
HEAD = "units lj\nneighbor 0.3 bin\n"
TAIL = "fix 1 all nve\ntimestep 0.003\nthermo_style custom step pe ebond evdwl ecoul bonds press pxy\nthermo_modify norm no"
QUARTIC = (HEAD + "atom_style full\nspecial_bonds lj/coul 1 1 1\npair_style lj/cut 1.5\nbond_style quartic\nread_data {chains}\n"
           "pair_coeff * * 1 1\npair_modify shift yes\nbond_coeff 1 1200 -0.55 0.25 1.3 34.6878\nvelocity all create 6.0 8731 loop geom\n")
BPM = (HEAD + "atom_style bond\nnewton on off\ncomm_modify vel yes\nspecial_bonds {special}\npair_style lj/cut 1.5\nread_data {block}\n"
       "bond_style bpm/spring {words}\npair_coeff * * 1 1\nbond_coeff 1 100 0.06 0.5\nvelocity all create 2.0 8731 loop geom\n")
SPECIAL = (HEAD + "atom_style full\nspecial_bonds lj/coul 0 1 1\npair_style {pair}\nbond_style hybrid harmonic special\nread_data {ring}\n"
           "{coeff}\nbond_coeff 1 harmonic 100 1.0\nbond_coeff 2 special 0.5 0.25\nbond_coeff 3 special 1.0 -0.3\n"
           "velocity all create 2.0 12345 loop geom\n")
RESTRAIN = (HEAD + "atom_style full\npair_style lj/cut 2.5\nbond_style harmonic/restrain\nread_data {ring}\npair_coeff * * 1 1\n"
            "bond_coeff * 80\nvelocity all create 2.0 12345 loop geom\n")
OFF, ON = "lj 0 1 1 coul 1 1 1", "lj/coul 1 1 1"
RUNS = ["run 1 post no"] * 25 + ["run 20 post no"] * 2
CASES = {
    "quartic": (QUARTIC, {}, RUNS),
    "bpm": (BPM, {"special": OFF, "words": ""}, RUNS),
    "bpm overlay": (BPM, {"special": ON, "words": "overlay/pair yes normalize yes smooth no"}, ["run 20 post no"] * 3),
    "bpm unbroken": (BPM, {"special": OFF, "words": "smooth no break no"}, ["run 20 post no"] * 2),
    "special": (SPECIAL, {"pair": "lj/cut/coul/cut 3.5 4.0", "coeff": "pair_coeff * * 1 1\npair_modify shift yes"}, ["run 10 post no"]),
    "special overlay": (SPECIAL, {"pair": "hybrid/overlay lj/cut 3.0 coul/cut 3.5",
                                  "coeff": "pair_coeff * * lj/cut 1 1\npair_coeff * * coul/cut"}, ["run 10 post no"]),
    "restrain": (RESTRAIN, {}, ["run 5 post no", "bond_coeff 1 40", "displace_atoms all random 0.05 0.05 0.05 1234", "run 5 post no",
                                "minimize 0 0 5 5", "run 5 post no", "bond_style harmonic/restrain", "bond_coeff * 30", "run 5 post no"]),
}


def data_file(path, x, bonds, length, style, charges=None) -> str:
    types = max((b[2] for b in bonds), default=1)
    lines = ["", "", f"{len(x)} atoms", f"{len(bonds)} bonds", "1 atom types", f"{types} bond types"]
    lines += [f"0 {length!r} {a}lo {a}hi" for a in "xyz"] + ["", "Masses", "", "1 1.0", "", f"Atoms # {style}", ""]
    for k, p in enumerate(x % length, 1):
        q = [] if style == "bond" else [str(charges[k - 1] if charges else 0)]
        lines.append(" ".join([str(k), "1 1", *q, *(repr(float(c)) for c in p)]))
    lines += ["", "Bonds", ""] + [f"{k} {t} {i} {j}" for k, (i, j, t) in enumerate(bonds, 1)]
    path.write_text("\n".join(lines) + "\n")
    return str(path)


@pytest.fixture(scope="module")
def files(tmp_path_factory) -> dict[str, str]:
    """Chains in a periodic box (512 atoms), a block bonded along all axes, and a ring of five atoms."""
    folder, n, a = tmp_path_factory.mktemp("bonds"), 8, 1.05
    grid = np.stack(np.meshgrid(*[np.arange(n)] * 3, indexing="ij"), -1).reshape(-1, 3)[:, ::-1]
    x = grid * a + 0.3 + np.random.default_rng(3).normal(scale=0.02, size=grid.shape)

    def number(p):
        return int(p[0] % n + n * (p[1] % n) + n * n * (p[2] % n) + 1)
    chains = [(number(p), number(p + [1, 0, 0]), 1) for p in grid if p[0] < n - 1]
    block = [(number(p), number(p + step), 1) for p in grid for step in np.eye(3, dtype=int)]
    ring = np.array([[5, 5, 5], [6, 5, 5], [7.0, 5, 5], [8, 5.2, 5], [8.4, 6.2, 5.1]])
    bonds = [(1, 2, 1), (2, 3, 1), (3, 4, 1), (4, 5, 1), (1, 5, 2), (2, 5, 3), (1, 4, 2)]
    return {"chains": data_file(folder / "chains", x, chains, n * a, "full"), "block": data_file(folder / "block", x, block, n * a, "bond"),
            "ring": data_file(folder / "ring", ring, bonds, 10.0, "full", [1, -1, 1, -1, 1])}


def script(name: str, files) -> tuple[list[str], list[str]]:
    text, words, more = CASES[name]
    return (text.format(**words, **files) + TAIL).splitlines(), more


@pytest.fixture(scope="module")
def theirs(files):
    return ask(STEPS, cases={name: script(name, files) for name in CASES}, words=WORDS)


def rows_of(lines: list[str], threads: int = 1) -> list[dict]:
    lmp, rows = start("-threads", str(threads)), []
    for line in lines:
        lmp.command(line)
        if line.startswith(("run", "minimize")):
            arrays = {k: np.array(lmp.gather_atoms(k, 1, 3)).reshape(-1, 3) for k in "xvf"}
            rows.append({k: lmp.get_thermo(k) for k in WORDS} | arrays)
    return rows


@pytest.mark.parametrize(("name", "threads"), [(n, 1) for n in CASES] + [("quartic", 2), ("bpm", 2)])
def test_follows_lammps(name, threads, files, theirs):
    lines, more = script(name, files)
    got = rows_of(lines + ["run 0 post no"] + more, threads)
    assert len(got) == len(theirs[name])
    for k, (a, b) in enumerate(zip(got, theirs[name])):
        for key in WORDS:
            assert a[key] == pytest.approx(b[key], rel=2e-12, abs=2e-12), (name, k, key)
        for key in "xvf":
            scale = np.abs(b[key]).max() + 1e-300
            assert np.abs(a[key] - np.array(b[key])).max() < 2e-12 * max(scale, 1.0), (name, k, key)
    if name in ("quartic", "bpm", "bpm overlay"):      # the comparison is worth something only if bonds do break
        assert got[-1]["ebond"] < 0.95 * max(r["ebond"] for r in got)


LOCAL = r"""
lmp = ran(given["lines"])
answer = Path(given["file"]).read_text()
"""


def test_broken_bonds_as_local_values(files, tmp_path):
    head = (BPM.format(special=OFF, words="store/local gone 10 time id1 id2 x y z", **files) + TAIL).splitlines()

    def text(path):
        return head + [f"dump 1 all local 20 {path} f_gone[1] f_gone[2] f_gone[3] f_gone[4] f_gone[5] f_gone[6]",
                       "dump_modify 1 format float %.12g", "run 40 post no"]

    def tables(words):
        parts = words.split("ITEM: ENTRIES")[1:]
        rows = [[list(map(float, line.split())) for line in part.splitlines()[1:] if len(line.split()) == 6 and line[0] != "I"]
                for part in parts]
        return [np.array(sorted(r)) for r in rows]
    want = tables(ask(LOCAL, lines=text(tmp_path / "theirs"), file=str(tmp_path / "theirs")))
    lmp = ran(text(tmp_path / "mine"))
    got = tables((tmp_path / "mine").read_text())
    assert [len(t) for t in got] == [len(t) for t in want] and len(got[1]) > 100
    for a, b in zip(got[1:], want[1:]):
        assert (a[:, :3] == b[:, :3]).all()
        d = (a[:, 3:] - b[:, 3:]) / 8.4
        assert np.abs(d - np.rint(d)).max() < 1e-10
    fix = lmp.session.scene.fixes["gone"]
    assert fix.local_columns() == 6 and (fix.local()[:, 0] > 30).all()
    lmp.command("bond_style harmonic")
    assert "gone" not in lmp.session.scene.fixes


def test_energy_is_lost_only_when_bonds_break(files):
    """Every bond that breaks takes U0 with it: the potential ends there with slope zero. The pair style ends before Rc."""
    text = QUARTIC.format(**files).replace("lj/cut 1.5", f"lj/cut {2 ** (1 / 6)!r}") + TAIL + "\ntimestep 0.0005\nrun 0 post no"
    lmp = ran(text)
    energies, broken, topology = [], [], lmp.session.scene.system.topology
    for _ in range(8):
        lmp.command("run 25 post no")
        energies.append(lmp.get_thermo("pe") + lmp.get_thermo("ke"))
        broken.append(int((topology.bond_types == 0).sum()))
    assert broken[0] < broken[-1] and broken == sorted(broken)
    total = np.array(energies) + 34.6878 * np.array(broken)
    assert np.ptp(total) < 2e-5 * abs(total[0])


def test_broken_bonds_leave_the_data_file(files, tmp_path):
    lmp = ran([*script("quartic", files)[0], "run 30 post no", f"write_data {tmp_path / 'out'}"])
    types = lmp.session.scene.system.topology.bond_types
    left, broken = int((types > 0).sum()), int((types == 0).sum())
    assert left and broken and lmp.get_thermo("bonds") == left + broken
    lines = [w for w in script("quartic", files)[0] if not w.startswith(("velocity", "pair_coeff", "bond_coeff", "pair_modify"))]
    again = ran([w.replace(files["chains"], str(tmp_path / "out")) for w in lines] + ["pair_modify shift yes", "run 0 post no"])
    assert again.get_thermo("bonds") == left
    assert again.get_thermo("pe") == pytest.approx(lmp.get_thermo("pe"), rel=1e-10)


def test_shares_of_the_atoms_add_up(files):
    for name in ("quartic", "bpm", "special", "restrain"):
        lmp = ran([*script(name, files)[0], "compute e all pe/atom", "compute s all stress/atom NULL virial", "run 12 post no"])
        moment, result = lmp.session.moment, lmp.session.loop.result
        assert np.sum(moment.per_atom("e")) == pytest.approx(result.potential, rel=1e-11, abs=1e-11)
        units = result.virial_of["bond"] + result.virial_of["pair"]
        np.testing.assert_allclose(-np.sum(moment.per_atom("s"), axis=0), units, rtol=1e-9, atol=1e-9 * np.abs(units).max())


def pair_of_atoms(r):
    atoms = asemd.Atoms("Ar2", positions=[[5, 5, 5], [5 + r, 5, 5]], cell=[20] * 3, pbc=True)
    atoms.topology = asemd.Topology(bonds=[[0, 1]])
    return atoms


def test_calculator_breaks_a_bond_for_good():
    atoms = pair_of_atoms(1.0)
    atoms.calc = asemd.ForceField(bond={"quartic": {1: (1200.0, -0.55, 0.25, 1.3, 34.6878)}},
                                  pair={"lj/cut 2.5": {("Ar", "Ar"): (1.0, 1.0)}}, special_bonds="lj/coul 1 1 1")
    held = atoms.get_potential_energy()
    r, drop = 1.0, 4.0
    assert held == pytest.approx(1200 * 0.3**2 * (0.3 - 0.55) * (0.3 + 0.25) + 34.6878 + 1.0, rel=1e-12)
    atoms.positions[1, 0] = 6.4
    lj = drop * ((r / 1.4) ** 12 - (r / 1.4) ** 6)
    assert atoms.get_potential_energy() == pytest.approx(lj, rel=1e-12)
    assert atoms.topology.bond_types.tolist() == [0]
    atoms.positions[1, 0] = 6.0
    assert atoms.get_potential_energy() == pytest.approx(0.0, abs=1e-12)      # 4 (1 - 1)


def test_restraint_is_the_first_length():
    atoms = pair_of_atoms(1.3)
    atoms.calc = asemd.ForceField(bond={"harmonic/restrain": {1: 2.0}})
    assert atoms.get_potential_energy() == 0.0
    other = copy.deepcopy(atoms)
    for a in (atoms, other):
        a.positions[1, 0] += 0.1
        assert a.get_potential_energy() == pytest.approx(0.02, rel=1e-12)
    again = pickle.loads(pickle.dumps(atoms.calc))
    atoms.calc = again
    atoms.positions[1, 0] += 0.1
    assert atoms.get_potential_energy() == pytest.approx(0.08, rel=1e-12)


def test_memory_follows_lost_atoms(tmp_path):
    """Atoms that leave the box take their bonds along; the others keep their reference lengths."""
    x = np.array([[5.0, 5, 5], [6.1, 5, 5], [9.5, 5, 5], [9.5, 6.3, 5]])
    path = data_file(tmp_path / "data", x, [(3, 4, 1), (1, 2, 1)], 10.0, "full")
    lmp = ran(["units lj", "atom_style full", "boundary f p p", "pair_style zero 1.0", "bond_style harmonic/restrain",
               f"read_data {path}",
               "pair_coeff * *", "bond_coeff 1 10", "group out id 3 4", "velocity out set 5 0 0", "fix 1 all nve", "timestep 0.01",
               "thermo_modify lost ignore norm no", "run 60 post no", "displace_atoms all move 0 0 0", "set atom 2 x 6.2",
               "run 0 post no"])
    assert lmp.get_natoms() == 2
    assert lmp.get_thermo("ebond") == pytest.approx(0.1, rel=1e-12)


@pytest.mark.parametrize(("lines", "message"), [
    (["special_bonds lj/coul 0 1 1", "pair_style lj/cut 1.5", "bond_style quartic"], "needs special_bonds lj/coul 1 1 1"),
    (["special_bonds lj/coul 1 1 1", "bond_style quartic"], "quartic needs a pair style"),
    (["special_bonds lj/coul 1 1 1", "pair_style lj/cut 1.5", "bond_style quartic", "angle_style harmonic"], "together with angle_style"),
    (["pair_style lj/cut 1.5", "bond_style bpm/spring"], "lj 0 1 1 coul 1 1 1"),
    (["special_bonds lj/coul 0 1 1", "pair_style lj/cut 1.5", "bond_style bpm/spring overlay/pair yes"],
     "needs special_bonds lj/coul 1 1 1"),
    (["special_bonds lj 0 1 1 coul 1 1 1", "pair_style lj/cut 1.5", "bond_style bpm/spring"], "newton on off"),
    (["bond_style bpm/spring break no"], "needs smooth no"),
    (["bond_style bpm/spring store/local f 10"], "at least one attribute"),
    (["bond_style bpm/spring colour yes"], "unknown keyword 'colour'"),
    (["bond_style bpm/spring", "bond_coeff 1 1 0 1"], "ecrit must be > 0"),
    (["special_bonds lj/coul 1 1 1", "pair_style lj/cut 1.5", "bond_style special"], "weights of 0 for 1-2 pairs"),
    (["special_bonds lj/coul 0 0 1", "pair_style lj/cut 1.5", "bond_style special"], "special_bonds angle yes"),
    (["bond_style special"], "special needs a pair style"),
])
def test_messages(lines, message, files):
    words = {"quartic": "1200 -0.55 0.25 1.3 34.7", "bpm/spring": "1 0.1 0.1", "special": "0.5 0.5"}
    style = next(w.split()[1] for w in lines if w.startswith("bond_style"))
    more = ["pair_coeff * * 1 1"] * any(w.startswith("pair_style") for w in lines) + [f"bond_coeff * {words[style]}", "run 0 post no"]
    lmp = ran(["units lj", "atom_style full", f"read_data {files['chains']}"])
    with pytest.raises(InputError, match=message):
        lmp.commands_list(lines + more)


def test_coincident_atoms_are_reported():
    for name, words in (("quartic", "1200 -0.55 0.25 1.3 34.6878"), ("bpm/spring", "1 0.1 0.1")):
        style = find("bond", name)
        s = sample(style)
        s.packed = style.pack(style.parse_settings([]), {1: style.parse_coeff(words.split(), {})}, 1, None)
        answer = s.run(np.zeros((3, 2)))
        assert bool(answer.bad[0]) == (name == "quartic") and np.isfinite(answer.forces).all()
    assert issubclass(SimulationError, Exception) and "longer than 0" in bonded.describe(find("bond", "quartic"), 0.0, (1, 2), 1)


def test_quartic_against_60_digits():
    mp = pytest.importorskip("mpmath")
    function, rng = find("bond", "quartic").function, np.random.default_rng(4)
    with mp.workdps(60):
        def force(r, K, B1, B2, Rc, near):
            d = r - Rc
            return K * (2 * d * (d - B1) * (d - B2) + d * d * (2 * d - B1 - B2)) - near * 48 * (r**-13 - r**-7 / 2)
        for n in range(1500):
            c = [1200.0, -0.55, 0.25, 1.3] if n % 3 else [float(v) for v in (10 ** rng.uniform(-2, 8), *rng.uniform(-2, 2, 2), 2.0)]
            r = float(c[3] * (1 - 10 ** rng.uniform(-14, -1))) if n % 2 else float(c[3] * rng.uniform(1e-3, 1.0))
            exact = [mp.mpf(v) for v in (r, *c)]
            near = 1 if exact[0] ** -6 > mp.mpf(1) / 2 else 0
            f, condition = force(*exact, near), mp.mpf(0)
            for k in range(len(exact)):
                moved = [u * (1 + mp.mpf(10) ** -25) if i == k else u for i, u in enumerate(exact)]
                condition += abs((force(*moved, near) - f) * mp.mpf(10) ** 25)
            assert abs(function(r, *c, 1.0)[1] - f) <= 8 * mp.mpf(2) ** -53 * (condition + abs(f)), (r, c)
    assert math.isnan(function(1.4, 1200.0, -0.55, 0.25, 1.3, 34.7)[0])


def test_style_chosen_again_after_restart_keeps_lengths(files, tmp_path):
    """Reference lengths come from the restart file as long as no run was made; data files have no coefficients of bpm/spring."""
    head = (BPM.format(special=OFF, words="", **files) + TAIL).splitlines()
    lmp = ran([*head, "thermo 10", "run 10", f"write_restart {tmp_path / 'r'}", f"write_data {tmp_path / 'd'}"])
    want = lmp.get_thermo("ebond")
    assert want > 0.0 and "Bond Coeffs" not in (tmp_path / "d").read_text()
    again = ran([f"read_restart {tmp_path / 'r'}", "bond_style bpm/spring", "bond_coeff 1 100 0.06 0.5"])
    (new,), (old,) = (e.session.scene.interactions.uses["bond"] for e in (again, lmp))
    for a, b in zip(new.memory["bonds"], old.memory["bonds"]):
        np.testing.assert_array_equal(a, b)
