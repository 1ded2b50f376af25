"""Fixes that change forces and positions do what LAMMPS's do: positions, velocities and outputs after two runs of a small liquid."""
from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pytest
from scripted import by_lammps, have_lammps, measure, script, write_data

NVE = "fix 1 all nve"
THREE, FOUR, SEVEN = ([f"f_2[{k}]" for k in range(1, n + 1)] for n in (3, 4, 7))
CHUNKS = ["group few molecule 3:9", "compute c few chunk/atom molecule", "compute m all com/chunk c"]
CASES = {
    "aveforce": (["fix 2 some aveforce 0.1 NULL -0.2", NVE], THREE),
    "aveforce variable region": (["fix 2 some aveforce v_one 0.0 NULL region half", NVE], THREE),
    "addtorque": (["fix 2 some addtorque 10 0 -30", "fix_modify 2 energy yes", NVE], ["f_2", *THREE, "pe"]),
    "addtorque variable": (["fix 2 all addtorque v_warm v_one 0.5", NVE], ["f_2", *THREE]),
    "lineforce": (["fix 2 some lineforce 1 2 -0.5", NVE], []),
    "planeforce": (["fix 2 some planeforce 0 1 0.5", NVE], []),
    "nve/noforce": (["fix 1 some nve/noforce"], []),
    "viscous": (["fix 2 all viscous 0.01 scale 2 3.5 scale 3 0.5", NVE], []),
    "drag": (["fix 2 some drag 1 2 3 0.4 2.5", NVE], THREE),
    "drag plane": (["fix 2 some drag 11 NULL -3 0.4 0.0", NVE], THREE),
    "gravity vector": (["fix 2 some gravity 0.02 vector 1 1 -2", "fix_modify 2 energy yes", NVE], ["f_2", "pe"]),
    "gravity chute": (["fix 2 all gravity 0.02 chute 30", NVE], ["f_2"]),
    "gravity spherical variable": (["variable g equal 0.01*(1+step)", "fix 2 all gravity v_g spherical v_warm 30", NVE], ["f_2"]),
    "spring tether": (["fix 2 some spring tether 5.0 3 NULL 4 1.5", "fix_modify 2 energy yes", NVE], ["f_2", *FOUR, "pe"]),
    "spring tether short": (["fix 2 some spring tether 5.0 3 2 4 30", NVE], ["f_2", *FOUR]),
    "spring couple": (["group others type 2", "fix 2 some spring couple others 5.0 1 2 NULL 1.5", NVE], ["f_2", *FOUR]),
    "spring couple overlap": (["group most id 3:50", "fix 2 some spring couple most 5.0 1 2 3 9.5", NVE], ["f_2", *FOUR]),
    "spring/self": (["run 3", "fix 2 some spring/self 5.0", "fix_modify 2 energy yes", NVE], ["f_2", "pe"]),
    "spring/self xz": (["fix 2 some spring/self v_one xz", NVE], ["f_2"]),
    "spring/self by atom": (["fix 2 some spring/self v_along y", NVE], ["f_2"]),
    "spring/rg": (["fix 2 some spring/rg 20.0 4.5", NVE], ["f_2"]),
    "spring/rg NULL": (["fix 2 some spring/rg 20.0 NULL", NVE], ["f_2"]),
    "spring/chunk": ([*CHUNKS, "fix 2 all spring/chunk 5.0 c m", "fix_modify 2 energy yes", NVE], ["f_2", "pe", "press", "pxy"]),
    "spring/chunk group": ([*CHUNKS, NVE, "run 3", "fix 2 some spring/chunk 5.0 c m"], ["f_2", "press"]),
    "smd cvel tether": (["fix 2 some smd cvel 5.0 0.01 tether 3 NULL 4 1.5", "fix_modify 2 virial yes", NVE], [*SEVEN, "press", "pxy"]),
    "smd cfor tether": (["fix 2 some smd cfor 5.0 tether 3 2 NULL 1.5", NVE], SEVEN),
    "smd cvel couple": (["group others type 2", "fix 2 some smd cvel 5.0 0.01 couple others auto auto NULL 1.5", NVE], SEVEN),
    "smd cvel couple along": (["group others type 2",
                               "fix 2 some smd cvel 5.0 -0.01 couple others 1 auto 2 1.5", "fix_modify 2 virial yes", NVE],
                              [*SEVEN, "press", "pxz"]),
    "smd cfor couple": (["group others type 2", "fix 2 some smd cfor 5.0 couple others auto auto auto 1.5", NVE], SEVEN),
    "smd cfor couple along": (["group others type 2", "fix 2 some smd cfor 5.0 couple others 1 2 NULL 1.5", NVE], SEVEN),
    **{f"wall/{style}": ([f"fix 2 some wall/{style} xlo EDGE {xlo} 3.5 yhi 13 {yhi} 3.5 pbc yes units box",
                          "fix_modify 2 energy yes virial yes",
                         NVE], ["f_2", "f_2[1]", "f_2[2]", "pe", "press", "pxx"])
       for style, xlo, yhi in (("lj93", "0.1 0.7", "0.2 1.1"), ("lj126", "0.01 0.7", "v_one 1.1"), ("lj1043", "0.1 0.7", "0.2 1.1"),
                               ("harmonic", "0.1 0.7", "0.2 1.1"), ("morse", "0.1 0.7 2.0", "0.2 1.1 2.0"),
                               ("lepton", "2*(r-1)^2", "(r-rc)^3+v_one*r"))},
    "wall variables": (["variable at equal -1-0.01*step", "variable deep equal 0.01*step", "lattice sc 2.5",
                        "fix 2 all wall/lj93 xlo v_at v_deep 1.0 3.5 xhi 5.0 v_one 1.0 2.5 pbc yes", NVE], ["f_2", "f_2[1]", "f_2[2]"]),
    "wall/table linear": (["fix 2 all wall/table linear 37 xlo -0.5 TABLE HARMONIC 2.1 yhi 13 TABLE HARMONIC 3.0 pbc yes units box",
                           "fix_modify 2 energy yes virial yes", NVE], ["f_2", "f_2[1]", "f_2[2]", "pe", "press", "pxx"]),
    "wall/table spline": (["fix 2 all wall/table spline 23 xlo -0.5 TABLE HARMONIC 2.1 yhi 13 TABLE HARMONIC 3.0 pbc yes units box", NVE],
                          ["f_2", "f_2[1]", "f_2[2]"]),
    **{f"wall/region {name}": ([*region, "group in region r", f"fix 2 in wall/region r {words}", "fix_modify 2 energy yes virial yes", NVE],
                               ["f_2", *THREE, "pe", "press", "pxy"])
       for name, region, words in (
        ("lj93", ["region r sphere 6 6 6 20"], "lj93 0.5 1.0 14.5"),
        ("morse", ["region r block INF INF -3 INF INF 15"], "morse 2 1.1 1 4.5"),
        ("cylinder", ["region r cylinder x 6 6 3 3 8 side out"], "lj1043 1e-6 1.0 2.5"),
        ("cone", ["region r cone z 6 6 1 3 2 9 side out"], "harmonic 5 1 2.5"),
        ("plane", ["region r plane 3 4 5 1 2 0"], "harmonic 5 1 2.5"),
        ("prism", ["region r prism 2 9 2 9 3 9 1 -1 2 side out"], "harmonic 5 1 2.5"))},
    "restrain": (["fix 2 all restrain bond 1 9 2.0 4.0 3.0 5.0 lbound 2 30 5.0 5.0 9.0 9.5 angle 1 5 40 2.0 5.0 100 "
                  "dihedral 1 2 3 4 0.0 20 80 mult 3 dihedral 7 30 3 44 3 2 170", "fix_modify 2 energy yes", NVE], ["f_2", *THREE, "pe"]),
    "tmd": ([NVE, "fix 2 some tmd 0.4 TARGET 4 STATISTICS"], []),
    "tmd images": ([NVE, "run 3", "fix 2 all tmd 0.6 TARGETS 0"], []),
    "efield": (["fix 2 some efield 0.1 0.2 -0.3", "fix_modify 2 energy yes virial yes", NVE], ["f_2", *THREE, "pe", "press", "pxy"]),
    "efield region": (["fix 2 some efield 0.1 0.2 -0.3 region half", NVE], ["f_2", *THREE]),
    "efield variables": (["fix 2 some efield v_along v_one -0.1 energy v_well", "fix_modify 2 energy yes virial yes", NVE],
                         ["f_2", *THREE, "pe", "press"]),
    "efield potential": (["fix 2 some efield v_one 0.0 -0.1 potential v_well", NVE], ["f_2", *THREE]),
    "wall/reflect f": ([NVE, "fix 2 all wall/reflect xlo EDGE xhi EDGE ylo EDGE yhi EDGE zlo EDGE zhi EDGE"], []),
    "wall/reflect variable f": ([NVE, "lattice sc 1.5", "variable top equal 8.0-0.001*step",
                                 "fix 2 all wall/reflect xlo 0.1 xhi v_top yhi 7.9 units lattice",
                                 "fix 3 all wall/reflect ylo EDGE zlo EDGE zhi EDGE"], []),
    "oneway": ([NVE, "fix 2 some oneway 3 half -y"], []),
    "recenter": ([NVE, "fix 2 some recenter INIT NULL 5.5 shift all"], ["f_2", *THREE]),
    "recenter fraction": ([NVE, "fix 2 some recenter 0.4 INIT NULL units fraction"], ["f_2", *THREE]),
    "move linear": (["run 2", "fix 2 some move linear 0.01 NULL -0.02"], []),
    "move wiggle": (["fix 2 some move wiggle 0.2 NULL 0.3 25"], []),
    "move rotate": (["lattice sc 1.3", "fix 2 some move rotate 3 4 5 1 -1 0.5 333"], []),
    "move transrot": (["fix 2 some move transrot 0.01 0.02 -0.03 3 4 5 1 -1 0.5 333 units box"], []),
    "move variable": (["variable dx atom 0.01*step*y/12", "variable vx equal 0.01*step", "variable vz atom 0.001*x",
                       "fix 2 some move variable v_dx NULL NULL v_vx NULL v_vz"], []),
    **{f"indent {shape}": ([*more, f"fix 2 some indent 0.5 {shape}", "fix_modify 2 energy yes", NVE], ["f_2", *THREE, "pe"])
       for shape, more in (("sphere 6 1 5 4", []), ("sphere v_top 5 4 2.0 side in", ["variable top equal 1.0+0.1*step", "lattice sc 1.5"]),
                           ("cylinder y 6 1 3 units box", []),
                           ("cylinder x v_one 4 2 side in",
                           ["lattice custom 1.1 a1 1 0 0 a2 0 2 0 a3 0 0 1.5 basis 0 0 0"]),
                           ("plane y 4 lo", []), ("plane z v_one hi", ["lattice sc 11.0"]))},
    "dt/reset": ([NVE, "fix 2 some dt/reset 3 NULL NULL 0.004"], ["f_2", "dt", "time"]),
    "dt/reset nvt": (["fix 1 all nvt temp 300 350 20", "fix 2 all dt/reset 3 0.2 1.5 0.01"], ["f_2", "dt", "time", "ecouple"]),
    "dt/reset npt": (["fix 1 all npt temp 300 350 20 aniso 0 500 100 drag 0.1", "fix 2 all dt/reset 2 0.2 1.5 0.01"],
                     ["f_2", "dt", "time", "ecouple", "vol"]),
    "dt/reset emax": ([NVE, "lattice sc 2.0", "fix 2 all dt/reset 1 0.2 1.5 0.02 emax 0.01"], ["f_2", "dt", "time"]),
}
# a fix that acts in Python, on nobody: only the hooks are compiled, not the loop around them
BY_PYTHON = ["group nobody subtract all all", "fix 9 nobody setforce v_one NULL NULL"]
COMPILED = ("gravity vector", "wall/lj93")
CHARGES = ["set type 1 charge 0.5", "set type 2 charge -0.8", "set type 3 charge 0.2"]
RUNS = ["run 20", "run 10 start 0 stop 60"]
WHOLE = ["run 20 start 0 stop 60", "run 10 start 0 stop 60"]     # a target that is not left again


def make_cases(folder) -> dict[str, dict]:
    for dimension in (2, 3):
        write_data(folder / f"data{dimension}", dimension)
    write_data(folder / "charged", 3, "full")
    r = np.linspace(0.3, 3.5, 33)
    rows = "".join(f"{k + 1} {x:.15g} {(x - 2.5)**4:.15g} {-4 * (x - 2.5)**3:.15g}\n" for k, x in enumerate(r))
    (folder / "wall.table").write_text(f"# a wall\n\nHARMONIC\nN 33\n\n{rows}")
    atoms = (folder / "data3").read_text().split("# bond\n\n")[1].split("\n\n")[0].splitlines()
    aims = [(row.split()[0], np.array(row.split()[3:6], float) + 0.3 * np.sin(7 * k + np.arange(3))) for k, row in enumerate(atoms[::-1])]
    (folder / "target").write_text("".join(f"{i} {x:.15g} {y:.15g} {z:.15g}\n" for i, (x, y, z) in aims))
    with gzip.open(folder / "targets.gz", "wt") as file:
        file.write("0 12 xlo xhi\n0 12 ylo yhi\n0 12.5 zlo zhi\n")
        file.writelines(f"{i} {x - 12:.15g} {y:.15g} {z + 12.5:.15g} 1 0 -1\n" for i, (x, y, z) in aims)
    files = {"TABLE": "wall.table", "TARGETS": "targets.gz", "TARGET": "target", "STATISTICS": "statistics"}
    out = {}
    for name, (commands, values) in CASES.items():
        dimension = 2 if "2d" in name else 3
        for word, file in files.items():
            commands = [c.replace(word, str(folder / file)) for c in commands]
        charged = "efield" in name
        commands = CHARGES * charged + commands + BY_PYTHON * (name not in COMPILED)
        out[name] = {"data": str(folder / ("charged" if charged else f"data{dimension}")), "dimension": dimension, "commands": commands,
                     "boundary": "f f f" if name.endswith(" f") else "p p p", "atom_style": "full" if charged else "bond",
                     "values": values, "runs": WHOLE if "tmd" in name else RUNS}
    return out


@pytest.fixture(scope="module")
def cases(tmp_path_factory):
    return make_cases(tmp_path_factory.mktemp("forces"))


@pytest.fixture(scope="module")
def expected(cases, tmp_path_factory):
    if not have_lammps():
        pytest.skip("the lammps module is not installed")
    out = by_lammps(cases, tmp_path_factory.mktemp("lammps"))
    (Path(cases["tmd"]["data"]).parent / "statistics").rename(Path(cases["tmd"]["data"]).parent / "statistics.lammps")
    return out


@pytest.mark.parametrize("name", CASES)
def test_like_lammps(name, cases, expected):
    from asemd.lammps import Lammps
    switches = ["-compat", "lammps"] if "spring/chunk" in name else []      # whose forces there are not the gradient of the energy

    def lammps(cmdargs):
        return Lammps(cmdargs=[*cmdargs, *switches])
    for ours, theirs in zip(measure(lammps, cases[name]), expected[name], strict=True):
        for key in ("x", "v"):
            a, b = np.array(ours[key]), np.array(theirs[key])
            assert abs(a - b).max() <= 2e-12 * abs(b).max(), key
        for formula, a, b in zip(cases[name]["values"], ours["values"], theirs["values"], strict=True):
            assert a == pytest.approx(b, rel=1e-10, abs=1e-9), formula


def test_statistics_of_tmd(cases, expected):
    from asemd.lammps import Lammps
    measure(Lammps, cases["tmd"])
    folder = Path(cases["tmd"]["data"]).parent
    assert np.loadtxt(folder / "statistics") == pytest.approx(np.loadtxt(folder / "statistics.lammps"), rel=1e-8)


def test_numerical_forces(cases):
    from asemd.lammps import Lammps
    lmp = Lammps(cmdargs=["-screen", "none", "-log", "none"])
    more = ["group few id 3 17 40", "fix 1 all nve", "fix 2 few numdiff 2 1e-4", "fix 3 all numdiff/virial 2 1e-5",
            "compute v all pressure NULL virial", "thermo_style custom step c_v[1]", "run 3"]
    for line in script(cases["aveforce"]["data"]).splitlines() + more:
        if line.strip():
            lmp.command(line)
    fix, system = lmp.session.scene.fixes["2"], lmp.session.scene.system
    assert not fix.values[system.id == 4].any()
    lmp.command("run 1 pre no")       # on a multiple of 2, forces are those at the same positions
    few = np.isin(system.id, (3, 17, 40))
    assert abs(fix.values[few] - system.f[few]).max() < 1e-6 * abs(system.f).max()
    virial = [lmp.extract_compute("v", 0, 1)[k] for k in (0, 1, 2, 5, 4, 3)]
    assert lmp.session.scene.fixes["3"].values == pytest.approx(virial, rel=1e-6, abs=1e-6 * abs(virial[0]))
    lmp.close()
