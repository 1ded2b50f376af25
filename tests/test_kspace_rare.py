"""Long-range solvers of a few atoms where few scenes go: meshes very fine and very small, waves and mixing by settings, factors."""
from __future__ import annotations

import numpy as np
import pytest
from wheel import ask, ran

from asemd.errors import InputWarning

ATOMS = ["create_atoms 1 single 1 1 1", "create_atoms 2 single 4 3 6", "create_atoms 3 single 6 8 2", "create_atoms 1 single 7 2 5",
         "mass * 10", *(f"set atom {i} charge {q}" for i, q in enumerate((0.5, -0.4, 0.3, -0.4), 1))]
SHARES = ["compute e all pe/atom kspace", "compute es all reduce max c_e", "compute s all stress/atom NULL kspace",
          "compute ss all reduce max c_s[2]", "thermo_style custom step elong press pxy evdwl c_es c_ss"]
VALUES = ["elong", "press", "pxy", "evdwl", "c_es", "c_ss"]
BLOCK, PRISM = "block 0 10 0 11 0 12", "prism 0 10 0 11 0 12 2 1 -1.5"
CHARGED = ["pair_style coul/long 6", "pair_coeff * *", "pair_modify table 0"]
LJ = ["pair_coeff 1 1 0.1 2", "pair_coeff 2 2 0.2 3", "pair_coeff 3 3 0.05 2.5"]
UNLIKE = ["pair_coeff 1 1 0.1 1.0", "pair_coeff 2 2 0.2 3.5", "pair_coeff 3 3 0.05 2.5"]


def case(*solver, box=BLOCK, pairs=CHARGED):
    return ["units real", "atom_style charge", f"region b {box}", "create_box 3 b", *ATOMS, *pairs, *solver, *SHARES, "run 0"]


def on_mesh(style, words, **options):
    return case(f"kspace_style {style} 1e-4", f"kspace_modify {words}", **options)


def long(mix, *solver, coeff=LJ, coulomb="long"):
    return case(*solver, pairs=[f"pair_style lj/long/coul/long long {coulomb} 5", *coeff, f"pair_modify table 0 table/disp 0 mix {mix}"])


MESHES = "gewald 0.4 mesh 8 9 10 gewald/disp 0.4 mesh/disp 8 9 10"
CASES = {
    **{f"{style}, a fine mesh": on_mesh(style, "mesh 40 48 48 gewald 0.3") for style in ("pppm", "pppm/cg", "pppm/stagger")},
    "pppm, a fine mesh, diff ad": on_mesh("pppm", "mesh 64 64 64 gewald 0.3 diff ad"),
    "pppm/stagger, a very fine mesh": on_mesh("pppm/stagger", "mesh 60 72 72 gewald 0.2"),
    **{f"{style}, factors of 7, 11 and 13, {words}": on_mesh(style, f"mesh 7 11 13 gewald 0.4 diff {words}")
       for style in ("pppm", "pppm/cg", "pppm/stagger") for words in ("ik", "ad")},
    "pppm, factors of 7, 11 and 13, triclinic": on_mesh("pppm", "mesh 7 11 13 gewald 0.4", box=PRISM),
    **{f"pppm, no tilt along z, {z}": case("kspace_style pppm 1e-4", box=f"prism 0 10 0 11 {z} 2 0 0")
       for z in ("-2.2 10.2", "0 11.4", "-1.1 13.3")},
    "msm, no tilt along z": case("kspace_style msm 1e-4", "kspace_modify pressure/scalar no", box="prism 0 10 0 11 -0.8 13.4 2 0 0",
                                 pairs=["pair_style coul/msm 6", *CHARGED[1:]]),
    "pppm, factors of 7, 11 and 13, no gewald": on_mesh("pppm", "mesh 7 11 13"),
    **{f"{style}, mesh {mesh}, {words}": on_mesh(style, f"mesh {mesh} gewald 0.4 {words}")
       for style, mesh, words in (("pppm", "3 2 2", "order 7"), ("pppm", "1 2 9", "order 7 diff ad"), ("pppm", "1 1 1", "order 5"),
                                  ("pppm/stagger", "3 2 1", "order 6"), ("pppm/cg", "2 1 2", "order 7"))},
    "pppm, mesh 2 1 2, triclinic": on_mesh("pppm", "mesh 2 1 2 gewald 0.4 order 7", box=PRISM),
    "pppm/disp, meshes of 2 1 2 and 1 3 2": long("geometric", "kspace_style pppm/disp 1e-4",
                                                 "kspace_modify gewald 0.4 mesh 2 1 2 order 7 gewald/disp 0.4 mesh/disp 1 3 2"),
    **{f"ewald, kmax {words}": on_mesh("ewald", f"kmax/ewald {words}") for words in ("2 0 5", "0 2 2", "4 0 0")},
    "ewald, kmax 2 0 5, triclinic": on_mesh("ewald", "kmax/ewald 2 0 5", box=PRISM),
    **{f"pppm/disp, splittol {tolerance}, {name}": long(mix, "kspace_style pppm/disp 1e-4", f"kspace_modify {MESHES} splittol {tolerance}",
                                                        coeff=coeff)
       for tolerance, name, mix, coeff in (("0.5", "arithmetic", "arithmetic", LJ), ("0.01", "arithmetic", "arithmetic", LJ),
                                           ("0.01", "unlike", "arithmetic", UNLIKE), ("0.001", "unlike", "arithmetic", UNLIKE),
                                           ("0.5", "geometric", "geometric", LJ))},
    **{f"ewald/disp {accuracy}, {mix}, coulomb {coulomb}": long(mix, f"kspace_style ewald/disp {accuracy}", coulomb=coulomb)
       for mix in ("arithmetic", "geometric") for accuracy in ("1e-3", "1e-5", "1e-7") for coulomb in ("long", "off")},
}
ASK = """
import numpy as np
answer = {}
for name, lines in given["scripts"].items():
    lmp = ran(lines)
    values = [lmp.extract_compute(v[2:], 0, 0) if v[:2] == "c_" else lmp.get_thermo(v) for v in given["values"]]
    answer[name] = [values, np.array(lmp.gather_atoms("f", 1, 3)).tolist()]
    lmp.close()
"""


def measured(lines, values):
    lmp = ran(lines, "-compat", "lammps")
    return [lmp.extract_compute(v[2:], 0, 0) if v[:2] == "c_" else lmp.get_thermo(v) for v in values], lmp.gather_atoms("f", 1, 3)


@pytest.fixture(scope="module")
def theirs():
    return ask(ASK, scripts=CASES, values=VALUES)


@pytest.mark.part(4)
@pytest.mark.parametrize("name", CASES)
def test_against_lammps(name, theirs):
    for got, want in zip(measured(CASES[name], VALUES), theirs[name], strict=True):
        want = np.array(want)
        assert np.abs(np.array(got) - want).max() < 1e-10 * np.abs(want).max(), (name, got, want)


def test_the_log_tells_the_mesh_that_is_taken(tmp_path):
    from wheel import start
    lmp = start("-log", str(tmp_path / "log"))
    lmp.commands_list(case("kspace_style pppm 1e-4", "kspace_modify mesh 7 11 13 gewald 0.4"))
    lmp.close()
    assert "grid = 8 12 15" in (tmp_path / "log").read_text()


def test_what_splittol_leaves_out_is_told():
    for tolerance, coeff, part in ((0.5, LJ, "0.012910687"), (0.001, UNLIKE, "0.00059220167")):
        with pytest.warns(InputWarning, match=f"splitting of dispersion coeffs is {part}"):
            ran(long("arithmetic", "kspace_style pppm/disp 1e-4", f"kspace_modify {MESHES} splittol {tolerance}", coeff=coeff))


# ------------------------------------------------------------------------------------------- charges with dipoles and a factor of fix adapt

def polar(*solver, boundary="p p p", charges=True, moved="0 0 0"):
    return ["units real", "atom_style hybrid dipole sphere", f"boundary {boundary}", f"region b {BLOCK}", "create_box 3 b",
            *(a for a in ATOMS if "mass" not in a and (charges or "charge" not in a)), "set group all diameter 1 density 10",
            *(f"set atom {i} dipole {p}" for i, p in enumerate(("0.3 0.2 0.5", "0.3 -0.2 0.1", "-0.3 0.2 0.4", "0.1 0.2 -0.15"), 1)),
            "pair_style lj/long/dipole/long cut long 5", "pair_coeff * * 0.1 2", "pair_modify table 0", "kspace_style ewald/disp 1e-4",
            *solver, "group one id 1", f"displace_atoms one move {moved}", "fix n all nve", "variable f equal 0.5",
            "fix f all adapt 1 kspace v_f", "compute t all property/atom tqx", "compute ts all reduce max c_t",
            "thermo_style custom step elong press pxy c_ts", "run 0"]


POLAR = {
    "neutral": polar(), "charged": polar("set atom 3 charge 0.7"), "without charges": polar(charges=False),
    "slab": polar("kspace_modify slab 3.0", boundary="p p f"), "nozforce": polar("kspace_modify slab nozforce", boundary="p p f")}


def test_a_factor_acts_on_what_charges_do_to_each_other():
    """Energy and pressure are LAMMPS's; its forces have the dipoles' part multiplied on the charge and not on the dipole that makes it."""
    values = ["elong", "press", "pxy", "c_ts"]
    theirs = ask(ASK, scripts=POLAR, values=values)
    for name, lines in POLAR.items():
        got, want = measured(lines, values)[0], theirs[name][0]
        assert np.allclose(got, want, rtol=1e-10, atol=1e-10 * max(map(abs, want))), (name, got, want)


@pytest.mark.parametrize("boundary, words", [("p p p", ()), ("p p f", ("kspace_modify slab 3.0",))])
def test_forces_with_a_factor_are_the_gradient(boundary, words):
    lmp = ran(polar(*words, boundary=boundary))
    forces, h = np.array(lmp.gather_atoms("f", 1, 3)).reshape(-1, 3), 1e-3
    assert np.abs(forces.sum(axis=0)).max() < 1e-12
    pe = [[ran(polar(*words, boundary=boundary, moved=" ".join(map(str, sign * h * np.eye(3)[d])))).get_thermo("pe") for sign in (1, -1)]
          for d in range(3)]
    assert np.allclose([(b - a) / (2 * h) for a, b in pe], forces[0], rtol=0, atol=2e-7)
    lmp = ran([*polar(*words, boundary=boundary)[:-2], "compute e all pe/atom kspace", "compute es all reduce sum c_e",
               "thermo_style custom step elong c_es", "run 0"])
    assert lmp.extract_compute("es", 0, 0) == pytest.approx(lmp.get_thermo("elong"), rel=1e-12)


def test_charges_that_count_twice_are_told():
    """LAMMPS refuses it."""
    mixed = ["pair_style hybrid lj/cut/coul/long 6 lj/cut/coul/cut 6", "pair_coeff 1*2 1*2 lj/cut/coul/long 0.1 2",
             "pair_coeff * 3 lj/cut/coul/cut 0.1 2"]
    with pytest.warns(InputWarning, match="lj/cut/coul/cut has all of the Coulomb energy .* use coul/long"):
        ran(case("kspace_style ewald 1e-3", pairs=mixed))
