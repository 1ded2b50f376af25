"""What integrators conserve has errors of second order in the time step: energy with that of what they are coupled to."""
from __future__ import annotations

import numpy as np
import pytest
from scripted import script, write_data
from wheel import ran

P = "0 0 60"
RIGID = "neigh_modify exclude molecule/intra all"
SHAKE = "group middle id 2:64:4 3:64:4\ndelete_bonds middle bond 1 remove special\nfix 9 all shake 1e-12 500 0 b 1"
CASES = {
    "nve": ["fix 1 all nve"],
    "nvt": ["fix 1 all nvt temp 300 300 40"],
    "npt": [f"fix 1 all npt temp 300 300 40 aniso {P}"],
    "nph": [f"fix 1 all nph iso {P} pchain 0"],
    "nph of one length": [f"fix 1 all nph z {P} pchain 0 mtk no"],       # the terms of mtk are for all lengths
    "nph with a chain": [f"fix 1 all nph aniso {P}"],
    "msst": ["fix 1 all msst z 0.02 q 25 tscale 0.02"],
    "rigid/nve": [RIGID, "fix 1 all rigid/nve molecule"],
    "rigid": [RIGID, "fix 1 all rigid molecule"],
    "rigid/nvt": [RIGID, "fix 1 all rigid/nvt molecule temp 300 300 40"],
    "shake and nvt": [SHAKE, "fix 1 all nvt temp 300 300 40"],
}
STEPS = 2.0, 1.0
TIME, LOOKS = 32.0, 8       # fs; how often the energy is looked at


def conserved(lmp) -> float:
    """The thermo keyword econserve, without what LAMMPS adds to the scalar of rigid/nvt."""
    fix = lmp.scene.fixes["1"]
    return lmp.extract_variable("e") - (fix._bodies_energy() if fix.style == "rigid/nvt" else 0.0)


def drift(commands: list[str], data, dt: float) -> float:
    """How far apart values of the conserved quantity are, energy units."""
    # bonds get their lengths, then new velocities lose what is along them
    first = ["timestep 1e-5", "run 1", "velocity all create 300 77", "run 1"] if "shake" in commands[0] else []
    smooth = script(data).replace("lj/cut 5.0", "soft 5.0").replace("timestep 1.0", "pair_coeff * * 2.0 5.0")
    steps = round(TIME / dt / LOOKS)
    with ran("\n".join([smooth, *commands, "variable e equal econserve", *first, f"timestep {dt}", f"run {steps}"])) as lmp:
        energies = [conserved(lmp)]
        for _ in range(LOOKS - 1):
            lmp.command(f"run {steps} pre no")
            energies.append(conserved(lmp))
    return float(np.ptp(energies))


@pytest.mark.filterwarnings("ignore::asemd.errors.InputWarning")
@pytest.mark.parametrize("name", CASES)
def test_second_order(name, tmp_path):
    write_data(tmp_path / "data")
    coarse, fine = (drift(CASES[name], tmp_path / "data", dt) for dt in (STEPS if "rigid" in name else (0.5, 0.25)))
    assert fine > 1e-7 and 3.4 < coarse / fine < (20.0 if name == "rigid" else 4.6)        # of fix rigid some errors are of higher order
