"""asemd: LAMMPS input scripts as ASE objects."""
from __future__ import annotations

import importlib
from typing import Any

__version__ = "0.1.0"

# public name -> module it is imported from when it is first used
_LAZY = {
    "read": "asemd.lammps.read",
    "Lammps": "asemd.lammps",
    "Session": "asemd.lammps.session",
    "Scene": "asemd.scene",
    "ForceField": "asemd.calculator",
    "EAM": "asemd.embedded_calculator",
    "Potential": "asemd.potential_calculator",
    "plan": "asemd.lammps.plan",
    "check": "asemd.check",
    "report": "asemd.report",
    "validate": "asemd.testing.validate",
    "run_lammps": "asemd.lammps_run",
    "campaign": "asemd.campaigns",
    "MolecularDynamics": "asemd.dynamics",
    "to_mdanalysis": "asemd.interop.mdanalysis",
    "from_mdanalysis": "asemd.interop.mdanalysis",
    "Stream": "asemd.interop.stream",
    "Symmetry": "asemd.interop.symmetry",
    "Atoms": "asemd.system",
    "System": "asemd.system",
    "Box": "asemd.box",
    "Topology": "asemd.topology",
    "find_bonds": "asemd.interop.bonds",
    "topology_from_bonds": "asemd.interop.bonds",
    "AsemdError": "asemd.errors",
    "InputError": "asemd.errors",
    "SimulationError": "asemd.errors",
}
__all__ = ["__version__", *_LAZY]


def __getattr__(name: str) -> Any:
    if name not in _LAZY:
        raise AttributeError(f"module 'asemd' has no attribute {name!r}")
    module = importlib.import_module(_LAZY[name])
    value = module if name in ("check", "report") else getattr(module, name)      # packages that can be called
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
