"""The formats that ``ase.io.read`` and ``ase.io.write`` find when asemd is installed; nothing of asemd is imported until one is used."""
from ase.utils.plugins import ExternalIOFormat

LAMMPS_SCRIPT = ExternalIOFormat("LAMMPS input script, with its force field (asemd)", "1S", module="asemd.interop.script_file", glob="in.*")
DATA = ExternalIOFormat("LAMMPS data file, with bonds (asemd)", "1S", module="asemd.interop.data_file")
DUMP = ExternalIOFormat("LAMMPS text dump, with the bonds of its data file (asemd)", "+S", module="asemd.interop.dump_file")
DATABASE = ExternalIOFormat("ASE database or json, with bonds (asemd)", "+S", module="asemd.interop.database")
