"""What the parts of a step cost on this machine: measured once on standard scenes, kept in the cache folder.

The costs are those of a model in which a step takes a fixed time, a time for each atom (integration and loop), for each pair of the list
(fixed, and for each operation and each call of a function such as ``exp`` in the formula of the style), for each bonded item, and for each
pair of a list that is built; and of long-range solvers for each atom in each wave, for each mesh point that a charge goes to, and for each
point of the mesh. ``python -m asemd.lammps.calibration THREADS PRECISION`` measures and prints them.
"""
from __future__ import annotations

import ast
import inspect
import json
import os
import re
import subprocess
import sys
import tempfile
import textwrap
import time
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path

import numpy as np

from asemd import __version__
from asemd.cache_folder import cache_folder
from asemd.errors import SimulationError

FILE = "calibration.json"
STEPS, SAMPLES = 40, 7
ROOTS = {"sqrt", "exp", "log", "sin", "cos", "tan", "pow", "erf", "erfc", "acos", "atan2", "power"}
LIQUID = """units lj
atom_style charge
lattice fcc 0.8442
region b block 0 {size} 0 {size} 0 {size}
create_box 2 b
create_atoms 1 box
set group all type/fraction 2 0.5 7
mass * 1
velocity all create 1.0 87287
pair_style {style}
pair_coeff * * {coeff}
neighbor 0.3 bin
fix 1 all nve
timestep 0.002
thermo 1000000
"""
SOLVED = """set group all type 1
set group all type/ratio 2 0.5 7
set type 1 charge 0.1
set type 2 charge -0.1
kspace_style {solver} 1e-4
kspace_modify gewald 0.8 {modify}
"""
CHAINS = """units lj
atom_style molecular
{category}_style {style}
read_data data.{category}
{category}_coeff 1 {coeff}
velocity all create 0.01 87287
fix 1 all nve
timestep 0.0005
thermo 1000000
"""
PAIRS = {"lj/cut": ("lj/cut 2.5", "1 1"), "coul": ("lj/cut/coul/cut 2.5", "1 1"), "morse": ("morse 2.5", "1 5 1.1")}
MESHES = (12, 36)           # points along an edge: few, so that charges cost more than transforms, and many
ORDER, WAVES = 5, 8         # LAMMPS's default order; waves along an edge
BONDED = {"bond": ("harmonic", "50 1"), "dihedral": ("harmonic", "1 1 2")}


@dataclass
class Costs:
    """Seconds, and bytes of an idle process with compiled kernels."""

    program: float              # bytes
    step: float                 # a step, whatever is in it
    atom: float                 # an atom and step
    pair: float                 # a pair of the cluster list and step
    operation: float            # an arithmetic operation of a pair
    call: float                 # a function call of a pair
    single: float               # a pair of a plain list and step
    build: float                # a pair of a list that is built
    row: float                  # a thermo row
    wave: float                 # an atom in a wave of an Ewald sum, and step
    spread: float               # a mesh point that an atom's charge goes to and its force comes from, and step
    mesh: float                 # a point of a mesh in its transforms, and step
    items: dict[str, float]     # a bonded item and step, by category

    def formula(self, functions) -> float:
        """Seconds for a pair of the cluster list, with the formulas of these functions."""
        operations, calls = work(tuple(functions))
        return self.pair + self.operation * operations + self.call * calls


@cache
def work(functions: tuple) -> tuple[int, int]:
    """Arithmetic operations and calls of expensive functions in the source of pair functions; divisions count four times."""
    operations = calls = 0
    for function in functions:
        try:
            tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
        except (OSError, TypeError, SyntaxError):       # made at run time: a formula of the user
            operations, calls = operations + 20, calls + 1
            continue
        for node in ast.walk(tree):
            if isinstance(node, ast.BinOp):
                operations += 4 if isinstance(node.op, ast.Div) else 1
            elif isinstance(node, ast.Call):
                name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
                calls += name in ROOTS
    return operations, calls


def machine(threads: int, precision: str) -> str:
    """What the costs depend on besides the scene."""
    import numba
    from llvmlite import binding
    return f"{binding.get_host_cpu_name()}, asemd {__version__}, numba {numba.__version__}, {threads} threads, {precision}"


def known(threads: int, precision: str) -> Costs | None:
    """The costs of this machine, if they were measured before."""
    try:
        found = json.loads((cache_folder() / FILE).read_text(encoding="utf-8"))[machine(threads, precision)]
        return Costs(**found)
    except (OSError, ValueError, KeyError, TypeError):
        return None


def calibrate(threads: int = 1, precision: str = "double", again: bool = False) -> Costs:
    """The costs of this machine, measured now if they are not known, or `again` (in a process of its own: about seven
    seconds, about a minute where its kernels have to be compiled first).

    Raises
    ------
    SimulationError
        The measurement failed.
    """
    found = known(threads, precision)
    if found is not None and not again:
        return found
    # the memory in a process that has compiled nothing
    costs = Costs(**_process(threads, precision), program=_process(threads, precision, "program")["program"])
    path = cache_folder() / FILE
    try:
        kept = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        kept = {}
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        fresh = path.with_suffix(f".{os.getpid()}")
        fresh.write_text(json.dumps({**kept, machine(threads, precision): asdict(costs)}, indent=1), encoding="utf-8")
        fresh.replace(path)
    except OSError:
        return costs        # a folder that cannot be written to: measured again next time
    return costs


def _process(threads: int, precision: str, *what: str) -> dict:
    """Measure in a process of its own."""
    root = str(Path(__file__).resolve().parents[2])
    env = {**os.environ, "PYTHONPATH": os.pathsep.join([root, *filter(None, [os.environ.get("PYTHONPATH")])])}
    command = [sys.executable, "-m", "asemd.lammps.calibration", str(threads), precision, *what]
    done = subprocess.run(command, capture_output=True, text=True, env=env)
    if done.returncode:
        raise SimulationError(f"the calibration of this machine failed: {(done.stderr.strip().splitlines() or ['no message'])[-1]}")
    return json.loads(done.stdout.splitlines()[-1])


# --------------------------------------------------------------------------------------------------------------- measurement ---

def program(threads: int, precision: str) -> dict:
    """Bytes of a process beside the arrays of its scene."""
    from asemd.lammps.plan_memory import holdings
    found = _run(LIQUID.format(size=10, style=PAIRS["lj/cut"][0], coeff=PAIRS["lj/cut"][1]), threads, precision, samples=1)
    return {"program": largest_memory() - sum(h.bytes for h in holdings(found["engine"]))}


def largest_memory() -> float:
    """Bytes. What `resource` tells may be those of the process that started this one."""
    try:
        return 1024.0 * int(re.search(r"VmHWM:\s*(\d+)", Path("/proc/self/status").read_text(encoding="utf-8"))[1])
    except (OSError, TypeError):
        from asemd.lammps.driver import memory
        return memory() * 2**20


def measure(threads: int, precision: str) -> dict:
    """Run the standard scenes; everything of `Costs` but the memory."""
    liquid = {name: _run(LIQUID.format(size=10, style=style, coeff=coeff), threads, precision) for name, (style, coeff) in PAIRS.items()}
    lj = liquid["lj/cut"]
    n, pairs = lj["atoms"], lj["pairs"]
    rows = np.array([[1.0, *work(lj["functions"])], [1.0, *work(liquid["coul"]["functions"])], [1.0, *work(liquid["morse"]["functions"])]])
    from scipy.optimize import nnls
    pair, operation, call = nnls(rows, np.array([liquid[k]["Pair"] / pairs for k in PAIRS]))[0]
    tiny, small = (_run(LIQUID.format(size=size, style="lj/cut 2.5", coeff="1 1"), 1, precision, 400) for size in (2, 3))
    atom = max((lj["rest"]) / n, 1e-10)
    single = max((small["Pair"] - tiny["Pair"]) / (small["pairs"] - tiny["pairs"]), 1e-10)
    step = max(small["rest"] - atom * small["atoms"] + max(small["Pair"] - single * small["pairs"], 0.0), 1e-8)
    solvers = _solvers(threads, precision)
    items = {}
    with tempfile.TemporaryDirectory() as folder:
        before = os.getcwd()
        os.chdir(folder)
        try:
            for category, (style, coeff) in BONDED.items():
                m = _chains(Path(f"data.{category}"), category)
                found = _run(CHAINS.format(category=category, style=style, coeff=coeff), threads, precision)
                items[category] = found["Bond"] / m
        finally:
            os.chdir(before)
    # not measured, for each category takes seconds to compile: in the middle on a scale of ratios, within a tenth of measured ones
    items["angle"] = (items["bond"] * items["dihedral"]) ** 0.5
    items["improper"] = items["dihedral"]
    return {"step": step, "atom": atom, "pair": float(pair), "operation": float(operation), "call": float(call), "single": single,
            "build": lj["build"] / pairs, "row": lj["row"], **solvers, "items": items}


def _solvers(threads: int, precision: str) -> dict:
    """Costs of long-range solvers: two meshes that the same charges are spread on, and a sum over waves."""
    style, coeff = "lj/cut/coul/long 2.5", PAIRS["coul"][1]

    def run(size: int, solver: str, modify: str) -> dict:
        script = LIQUID.format(size=size, style=style, coeff=coeff) + SOLVED.format(solver=solver, modify=modify)
        return _run(script, threads, precision, samples=4)

    at = [run(10, "pppm", f"mesh {m} {m} {m} order {ORDER}") for m in MESHES]
    points = [m**3 for m in MESHES]
    mesh = max((at[1]["Kspace"] - at[0]["Kspace"]) / (points[1] - points[0]), 1e-12)
    spread = max((at[0]["Kspace"] - mesh * points[0]) / (at[0]["atoms"] * ORDER**3), 1e-12)
    sums = run(5, "ewald", f"kmax/ewald {WAVES} {WAVES} {WAVES}")
    return {"wave": sums["Kspace"] / (sums["atoms"] * sums["engine"].solver.waves), "spread": spread, "mesh": mesh}


def _run(script: str, threads: int, precision: str, steps: int = STEPS, samples: int = SAMPLES) -> dict:
    """Seconds of one step of a scene by part, lower quartiles of some short runs; seconds of a list build and of a thermo row.

    Other work on the machine only adds to them.
    """
    from asemd.lammps import Lammps
    lammps = Lammps(cmdargs=["-screen", "none", "-log", "none"])
    lammps.scene.threads, lammps.scene.precision = threads, precision
    lammps.commands_string(script + "run 10")
    engine = lammps.session.loop.engine
    taken = []
    for _ in range(samples):
        builds = engine.builds
        seconds, spent = timed(lammps, steps)
        count = max(engine.builds - builds, 1)
        rest = seconds - sum(spent.get(k, 0.0) for k in ("Pair", "Bond", "Kspace", "Neigh", "Output"))
        if spent["Neigh"] == 0.0:
            began = time.perf_counter()
            engine.load()
            spent["Neigh"] = time.perf_counter() - began
        parts = {k: spent[k] / steps for k in ("Pair", "Bond", "Kspace")}
        taken.append({**parts, "build": spent["Neigh"] / count, "rest": max(rest, 0.0) / steps, "row": spent["Output"] / 2.0})
    out = {k: float(np.quantile([s[k] for s in taken], 0.25)) for k in taken[0]}
    functions = tuple(p.function for t in engine.pair_terms for p in t.style.parts)
    return {**out, "atoms": lammps.scene.system.n, "pairs": engine.pairs, "functions": functions, "engine": engine}


def timed(lammps, steps: int) -> tuple[float, dict[str, float]]:
    """Seconds of so many steps, together and by section; the time in which the processor did something else is taken off."""
    record = lammps.session.record = _Listener()
    began, busy = time.perf_counter(), time.process_time()
    lammps.command(f"run {steps} pre no")
    share = (time.process_time() - busy) / (lammps.scene.threads * (time.perf_counter() - began))
    return record.seconds * min(share, 1.0), {k: v * min(share, 1.0) for k, v in record.timings.items()}


class _Listener:
    """Takes the place of `asemd.lammps.record.Record`."""

    def row(self, driver, values) -> None:
        """Rows do not matter here."""

    def ended(self, driver, steps: int, seconds: float, timings: dict[str, float]) -> None:
        self.seconds, self.timings = seconds, dict(timings)


def _chains(path: Path, category: str, chains: int = 200, length: int = 20) -> int:
    """A data file of zigzag chains with items of one category; returns how many."""
    k = {"bond": 2, "angle": 3, "dihedral": 4}[category]
    along = np.arange(length)
    shape = np.column_stack([0.82 * along, 0.57 * (along % 2), 0.1 * (along % 3)])
    lines = []
    for c in range(chains):
        start = (1.0, 1.0 + 2.0 * (c % 14), 1.0 + 2.0 * (c // 14))
        lines += [f"{c * length + i + 1} {c + 1} 1 " + " ".join(f"{a:.4f}" for a in start + shape[i]) for i in range(length)]
    items = [[c * length + i + j + 1 for j in range(k)] for c in range(chains) for i in range(length - k + 1)]
    rows = [f"{n} 1 " + " ".join(map(str, item)) for n, item in enumerate(items, 1)]
    path.write_text("\n".join([
        "chains", "", f"{chains * length} atoms", f"{len(items)} {category}s", "1 atom types", f"1 {category} types", "", "0 30 xlo xhi",
        "0 30 ylo yhi", "0 32 zlo zhi", "", "Masses", "", "1 1", "", "Atoms", "", *lines, "", f"{category.capitalize()}s", "", *rows, ""]))
    return len(items)


if __name__ == "__main__":
    print(json.dumps((program if sys.argv[3:] else measure)(int(sys.argv[1]), sys.argv[2])))
