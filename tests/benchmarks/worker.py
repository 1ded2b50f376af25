"""One engine in one process (under mpiexec: one rank of it). It executes the lists of commands it finds in its folder.

``python worker.py asemd|lammps FOLDER switches...``. ``0.go``, ``1.go`` ... hold one JSON list of commands each; ``0.done`` ... tell the
seconds they took and those of the processor. A file ``stop`` ends it. Waiting must not disturb the engine whose turn it is, on as many
threads as there are cores: a worker looks for work `RARELY`, and `OFTEN` once there is a file ``0.soon``, ``1.soon`` ..., so that all ranks
begin at the same time.
"""
from __future__ import annotations

import ctypes
import json
import os
import sys
import time
from pathlib import Path

RARELY, OFTEN = 0.1, 0.001


def engine(name: str, switches: list[str]):
    if name == "asemd":
        from asemd.lammps import Lammps
        return Lammps(cmdargs=switches)
    library = Path(sys.prefix) / "lib" / "libmpi.so.12"     # the mpich wheel puts it there
    if library.exists():
        ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)
    from lammps import lammps
    return lammps(cmdargs=switches)


def main() -> None:
    folder = Path(sys.argv[2])
    first = os.environ.get("PMI_RANK", "0") == "0"
    lmp, number = engine(sys.argv[1], sys.argv[3:]), 0
    while not (folder / "stop").exists():
        ticket = folder / f"{number}.go"
        if not ticket.exists():
            time.sleep(OFTEN if (folder / f"{number}.soon").exists() else RARELY)
            continue
        commands = json.loads(ticket.read_text())
        began, cpu = time.perf_counter(), time.process_time()
        for command in commands:
            lmp.command(command)
        seconds = time.perf_counter() - began
        if first:
            (folder / "answer").write_text(json.dumps({"seconds": seconds, "cpu": time.process_time() - cpu}))
            os.replace(folder / "answer", folder / f"{number}.done")
        number += 1
    lmp.finalize()


if __name__ == "__main__":
    main()
