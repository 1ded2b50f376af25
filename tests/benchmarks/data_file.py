"""Seconds and memory to write and read a data file: chains of ten atoms with bonds, angles and charges, a million atoms by default.

With type labels instead of numbers after ``labels``: ``data_file.py 1000000 labels``.
"""
from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

MEMORY = "int(open('/proc/self/statm').read().split()[1]) * 4096" if sys.platform.startswith("linux") else "0"
# a new process for each, so that the peak of its memory is its own
READ = f"""
import json, resource, sys, time
from asemd.lammps.data import read_data
base = {MEMORY}
start = time.perf_counter(), time.process_time()
system = read_data(sys.argv[1], "real", "full").system
seconds, cpu = time.perf_counter() - start[0], time.process_time() - start[1]
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
print(json.dumps({{"read_s": seconds, "read_cpu_s": cpu, "read_bytes_per_atom": (peak - base) / system.n}}))
"""


def chains(atoms: int):
    """Atoms near a cubic lattice, in order along it; about `atoms` of them."""
    from asemd.box import Box
    from asemd.system import System
    from asemd.topology import Topology
    rng, k = np.random.default_rng(1), 10 * max(1, round(atoms ** (1 / 3) / 10))     # whole chains in a row
    n, spacing = k**3, 1.1
    x = spacing * np.stack(np.meshgrid(*[np.arange(k)] * 3, indexing="ij"), -1).reshape(-1, 3) + rng.normal(0, 0.05, (n, 3))
    i = np.arange(n - 2)
    bonds, angles = i[i % 10 != 9], i[i % 10 < 8]
    top = Topology(bonds=np.column_stack([bonds, bonds + 1]), bond_types=np.ones(len(bonds), int),
                   angles=np.column_stack([angles, angles + 1, angles + 2]), angle_types=np.ones(len(angles), int))
    system = System(box=Box.from_lammps(np.zeros(3), np.full(3, k * spacing)), x=x, type=rng.integers(1, 4, n), v=rng.normal(0, 1, (n, 3)),
                    q=rng.normal(0, 0.3, n), molecule=np.arange(n) // 10 + 1, topology=top, units="real", atom_style="full",
                    mass=np.array([np.nan, 12.0, 1.0, 16.0]))
    system.box.wrap(system.x, system.image)
    return system


def label(system) -> None:
    """Give every type a label."""
    system.counts |= {"nbondtypes": 1, "nangletypes": 1}
    system.labels |= {"atom": {1: "C", 2: "H", 3: "O-x"}, "bond": {1: "C-C"}, "angle": {1: "C-C-C"}}


def measure(atoms: int = 1_000_000, types: str = "numeric") -> dict:
    """Seconds (and seconds of the processor) to write and to read, bytes of the file, peak of memory while reading."""
    import time

    from asemd.lammps.data_write import write_data
    system = chains(atoms)
    label(system)
    with tempfile.TemporaryDirectory(prefix="asemd-data-") as folder:
        path = Path(folder) / "chains.data"
        start = time.perf_counter(), time.process_time()
        write_data(path, system, types=types)
        out = {"atoms": system.n, "write_s": time.perf_counter() - start[0], "write_cpu_s": time.process_time() - start[1],
               "file_bytes": os.path.getsize(path)}
        answer = subprocess.run([sys.executable, "-c", READ, str(path)], check=True, capture_output=True, text=True)
    return out | json.loads(answer.stdout)


if __name__ == "__main__":
    print(json.dumps(measure(int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000, (*sys.argv[2:], "numeric")[0]), indent=1))
