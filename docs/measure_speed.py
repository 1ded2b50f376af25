"""Error against processor time for every force-field style: ``python docs/measure_speed.py`` writes docs/measured/speed.json.

Each style computes a few thousand items (bonds, angles ... drawn from the Boltzmann distribution along their coordinate, at random places;
pairs of a liquid at reduced temperature 1) with the coefficients of its example: as it is (in double precision, which is the reference of
the errors), with mixed precision, as its own table, and as an expression of style lepton. The pages of the styles show the numbers.
``python docs/measure_speed.py "bond morse" ...`` measures some styles again and keeps the others.
"""
from __future__ import annotations

import functools
import itertools
import json
import math
import os
import sys
import tempfile
import time
import warnings
import zlib
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE)]

import style_plots  # noqa: E402
import style_scenes  # noqa: E402
from measure import machine  # noqa: E402
from style_formula import Untraceable, expression, traced  # noqa: E402

from asemd import style as registry  # noqa: E402
from asemd import units as unit_styles  # noqa: E402
from asemd.engine import Engine  # noqa: E402
from asemd.errors import AsemdError, InputError, SimulationError  # noqa: E402
from asemd.kernels.hooks import bound  # noqa: E402
from asemd.lammps import Lammps  # noqa: E402
from asemd.lammps.command import angle_write, bond_write, dihedral_write  # noqa: E402
from asemd.lammps.table_write import style_of  # noqa: E402
from asemd.topology import ATOMS, Topology  # noqa: E402

FILE = HERE / "measured" / "speed.json"
COMMAND = "python docs/measure_speed.py"
ITEMS, CELLS = 4000, 10             # bonded items; cells of four atoms along an edge of the liquid
TABLES = (200, 1000, 5000)
DENSE = ("spline", 50000)           # the reference of styles that are tables
ON_FILE = 3                         # values on file for each one of the table
COORDINATE = {"bond": "r", "angle": "theta", "dihedral": "phi"}
ROUNDS, BATCH = 25, 1.5e-3          # how often each variant has its turn, and the seconds of a turn
JITTER = 0.02                       # of atoms whose bonds are not what the style depends on
TEMPERATURE = {"real": 0.0019872067 * 300.0, "metal": 8.617333e-5 * 300.0, "lj": 1.0}       # kT
GRID = 2001


@dataclass
class Case:
    """One style with its atoms: `x` where forces are taken, `rest` where bonds are told their length."""

    scene: style_scenes.Scene
    x: np.ndarray
    edge: float
    rest: np.ndarray | None = None
    values: np.ndarray = field(default_factory=lambda: np.zeros(0))      # of the coordinate
    types: np.ndarray | None = None
    items: int = 0


def measured() -> list[tuple[str, str]]:
    """All styles but those that are made of others or of nothing."""
    return [(c, n) for c, n in style_scenes.every_style() if n not in ("none", "zero") and not n.startswith("hybrid")]


# ---------------------------------------------------------------------------------------------------------------------- geometries ---

def turned(rng, n: int) -> np.ndarray:
    """Random rotations (n, 3, 3)."""
    q = rng.normal(size=(n, 4))
    w, x, y, z = (q / np.linalg.norm(q, axis=1, keepdims=True)).T
    return np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 2 * (x * y + z * w), 1 - 2 * (x * x + z * z),
                     2 * (y * z - x * w), 2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], -1).reshape(n, 3, 3)


def along(lmp, category: str, style) -> tuple[np.ndarray, np.ndarray]:
    """Values of the coordinate and the weight of each: its Boltzmann factor times the volume element."""
    lo, hi = style_plots.path_of(style)[1]
    if category == "improper" or style.coordinates == ("gamma",):
        x = np.linspace(lo, hi, GRID)
        return x, np.exp(-0.5 * ((x - 0.5 * (lo + hi)) / (0.1 * (hi - lo))) ** 2)
    if category == "bond" and style.function is None or style.remembers:
        x = np.linspace(0.95, 1.1, GRID) * style_scenes.distance(style)
        return x, np.ones(GRID)
    bound, _, function = style_of(lmp.session, category, 1, f"{category}_write")
    if category == "bond":
        _, places, _ = bond_write.points(bound, GRID, ["1", str(GRID), repr(lo), repr(hi)])
        x = np.linspace(lo, hi, GRID)
    else:
        degrees, places, _ = (angle_write if category == "angle" else dihedral_write).points(bound, GRID, [])
        x = np.radians(degrees)
    energy = np.full(GRID, math.inf)
    for k, place in enumerate(places):
        try:
            energy[k] = function(*place)[0]
        except (ArithmeticError, ValueError):
            continue
    energy[~np.isfinite(energy)] = math.inf
    weight = np.exp(-(energy - energy.min()) / TEMPERATURE[style_scenes.unit_of(style)])
    weight *= x * x if category == "bond" else np.sin(x) if category == "angle" else 1.0
    return x, np.where(weight > 1e-6 * weight.max(), weight, 0.0)


def bonded_case(category: str, name: str, lmp) -> Case:
    """Items at random places, far enough from each other that no atom has two."""
    style, rng = registry.find(category, name), np.random.default_rng(zlib.crc32(f"{category} {name}".encode()))
    grid, weight = along(lmp, category, style)
    total = np.cumsum(weight)
    values = np.interp(rng.uniform(0.0, total[-1], ITEMS), total, grid)
    path = style_plots.path_of(style)[0]
    k = ATOMS[category]
    side = math.ceil(ITEMS ** (1 / 3))
    spacing = 6.0
    centres = np.array(list(itertools.islice(itertools.product(range(side), repeat=3), ITEMS)), float) * spacing + 0.5 * spacing

    def placed(points: np.ndarray) -> np.ndarray:
        points = points - points.mean(axis=1, keepdims=True)
        return (np.einsum("nij,nkj->nki", rotations, points) + centres[:, None]).reshape(ITEMS * k, 3)
    rotations = turned(rng, ITEMS)
    shape = np.array([path(v) for v in values.tolist()], float)
    if category != "bond":
        shape = shape + rng.normal(scale=JITTER, size=shape.shape)
    rest = placed(np.array([path(style_scenes.distance(style))] * ITEMS, float)) if style.remembers else None
    return Case(style_scenes.scene(category, name), placed(shape), side * spacing, rest, values, items=ITEMS)


@functools.cache
def liquid() -> tuple[np.ndarray, float]:
    """Places of the atoms of a Lennard-Jones liquid (T = 1, density 0.8), and the edge of their box."""
    with Lammps(cmdargs=["-screen", "none", "-log", "none"]) as lmp:
        lmp.commands_list(["units lj", "lattice fcc 0.8", f"region box block 0 {CELLS} 0 {CELLS} 0 {CELLS}", "create_box 1 box",
                           "create_atoms 1 box", "mass 1 1.0", "pair_style lj/cut 2.5", "pair_coeff 1 1 1.0 1.0",
                           "velocity all create 2.5 4928", "fix 1 all nve", "fix 2 all langevin 1.0 1.0 0.5 904297", "run 800 post no"])
        system = lmp.scene.need_system("measure")
        return np.mod(system.x - system.box.origin, system.box.lengths), float(system.box.lengths[0])


def pair_case(name: str) -> Case:
    """The liquid, its atoms as large as the style's are."""
    style, scene = registry.find("pair", name), style_scenes.scene("pair", name)
    settings = style.parse_settings(style.settings_example.split())
    sigma = {} if scene.table else style.parse_coeff(style_scenes.words_of(style)[0], settings)
    scale = sigma.get("sigma", style_scenes.distance(style) / 2 ** (1 / 6))
    x, edge = liquid()
    case = Case(scene, x * scale, edge * scale)
    if scene.charges:
        case.types = np.random.default_rng(1).permutation(np.arange(len(x)) % 2 + 1)
        case.scene = replace(scene, types=2, lines=[line.replace("coeff 1 1", "coeff * *") for line in scene.lines])
    return case


# -------------------------------------------------------------------------------------------------------------------------- scenes ---

def opened(case: Case | None, scene: style_scenes.Scene) -> Lammps:
    """A session with the atoms of a case (a few, without one) and everything but the style."""
    lmp, extra, category = Lammps(cmdargs=["-screen", "none", "-log", "none"]), scene.extra, scene.category
    x, edge = (np.array(scene.positions) + 20.0, 40.0) if case is None else (case.x if case.rest is None else case.rest, case.edge)
    types = 1 if case is None or case.types is None else 2
    room = [] if category == "pair" else [f"{category}/types 1", *["bond/types 1"] * (extra.chain and category != "bond")]
    lmp.commands_list([f"units {scene.unit}", f"atom_style {extra.atom_style}", *extra.start,
                       "region box block" + f" 0 {edge!r}" * 3, f"create_box {types} box {' '.join(room)}", "mass * 12.0",
                       f"neighbor {0.3 if scene.unit == 'lj' else 2.0} bin"])
    n = len(x)
    lmp.create_atoms(n, None, [1] * n if case is None or case.types is None else case.types.tolist(), np.mod(x, edge).ravel().tolist())
    system = lmp.scene.need_system("measure")
    if category != "pair":
        k = ATOMS[category]
        rows = np.arange(n).reshape(-1, k)
        system.topology = Topology(**{f"{category}s": rows, f"{category}_types": np.ones(len(rows), int)})
    elif scene.charges:
        lmp.commands_list([f"set type {t} charge {q}" for t, q in enumerate(scene.charges[:types], 1)])
    lmp.commands_list(list(extra.lines))
    lmp.commands_list([line.replace("set atom 1 dipole 0.3 0.4 0.0", "set group all dipole/random 7 0.5") for line in extra.late])
    return lmp


class Runner:
    """One variant, ready to be computed again and again."""

    def __init__(self, lmp, case: Case, precision: str = "double"):
        scene, category = lmp.scene, case.scene.category
        self.engine = engine = Engine(scene.system, scene.interactions, replace(scene.settings(), precision=precision, threads=1))
        engine.load()
        engine.bonds.hold(True)
        if case.rest is not None:
            engine.move(np.mod(case.x, case.edge))
        self.terms = [t for t in engine.terms if t.category == category and (category == "pair" or not hasattr(t, "owner"))]
        if not self.terms:
            self.terms = [t for t in engine.terms if t.category == category]
        self.calls = [bound(t.kernel(False, False), t.arguments(engine, 0)) for t in self.terms]
        engine.buffers[0][:] = 0.0
        self.run(1)
        engine.check()
        self.forces = engine.state.f[:, engine.slot_of].T.copy()
        began = time.process_time()
        self.run(3)
        self.times, self.turn = [], max(1, int(BATCH / max((time.process_time() - began) / 3, 1e-6)))

    def run(self, times: int) -> None:
        for _ in range(times):
            for call in self.calls:
                call()

    def take_turn(self) -> None:
        """Time some evaluations."""
        began = time.process_time()
        self.run(self.turn)
        self.times.append((time.process_time() - began) / self.turn)


# ------------------------------------------------------------------------------------------------------------------------- variants ---

def no_table(style) -> str:
    """Why a style has no table of its own, "" if it has."""
    if style.category == "improper":
        return "there is no improper style table"
    if style.category == "pair" or style.name.startswith("table"):
        return ""
    if style.coordinates != (COORDINATE[style.category],):
        return f"the energy depends on more than the {'length of the bond' if style.category == 'bond' else 'angle between the atoms'}"
    return ""


def table_lines(lmp, case: Case, folder: str, kind: str, n: int) -> list[str]:
    """Commands of the style's own table, which is written by a session with the style; a style that is a table keeps its file."""
    category = case.scene.category
    if case.scene.table:
        return retold(case.scene.lines, kind, n)
    head, edge = f"{category}_style table {kind} {n}", 1e-9
    if category != "pair":
        reach, path = "", f"{folder}/{category}{n}.own"
        if category == "bond":
            lo, hi = case.values.min(), case.values.max()
            reach = f"{lo - 0.002 * (hi - lo):.12g} {hi + 0.002 * (hi - lo):.12g} "
        write, use = [f"{category}_write 1 {ON_FILE * n} {reach}{path} OWN"], [head, f"{category}_coeff 1 {path} OWN"]
    else:
        write, use, path = [], [head], f"{folder}/pair{n}.own"
        inner, outer = case.values.min() * 0.99, case.values.max() * (1.0 - edge)
        for i, j in ((1, 1), (1, 2), (2, 2))[:1 if case.types is None else 3]:
            charges = " {} {}".format(*(case.scene.charges[k - 1] for k in (i, j))) if case.scene.charges else ""
            write.append(f"pair_write {i} {j} {ON_FILE * n} rsq {inner:.12g} {outer:.14g} {path} OWN{i}{j}{charges}")
            use.append(f"pair_coeff {i} {j} {path} OWN{i}{j}")
    if not Path(path).exists():
        lmp.commands_list(write)
    return use


def retold(lines: list[str], kind: str, n: int) -> list[str]:
    """The commands of a style that is a table, with another way to interpolate."""
    command, name, _, _, *rest = lines[0].split()
    return [" ".join([command, name, kind, str(n), *rest]), *lines[1:]]


def formula(lmp, case: Case) -> list[str]:
    """Commands of style lepton with the energy of the style.

    Raises
    ------
    Untraceable
        It has no expression.
    """
    category, name = case.scene.category, case.scene.name
    if name == "lepton":
        raise Untraceable("the style is lepton itself")
    if category == "improper":
        raise Untraceable("there is no improper style lepton")
    if case.scene.table:
        raise Untraceable("a table has no expression")
    if category == "pair":
        return pair_formula(lmp, case)
    reason = no_table(registry.find(category, name))
    if reason:
        raise Untraceable(reason)
    function = style_of(lmp.session, category, 1, f"{category}_write")[2]
    plain = traced(function.func)
    # an even number of angles without the ends: none at which a function may have a special case
    grid = np.linspace(case.values.min(), case.values.max(), GRID)
    if category != "bond":
        grid = np.linspace(0.0 if category == "angle" else -math.pi, math.pi, GRID + 3)[1:-1] + 1e-5 / 3.0
    text = expression(lambda q: plain(q, **function.keywords)[0], COORDINATE[category], grid)
    return [f"{category}_style lepton" + " no_offset" * (category != "dihedral"),
            f"{category}_coeff 1 {'' if category == 'dihedral' else '0.0 '}\"{text}\""]


def pair_formula(lmp, case: Case) -> list[str]:
    system, scene = lmp.scene.need_system("measure"), case.scene
    units = unit_styles.get(system.units)
    term, = lmp.scene.interactions.pair_terms(system.counts["ntypes"], units)
    if any(part.arrays for part in term.style.parts):
        raise Untraceable("its function reads arrays")
    lines = [f"pair_style lepton {float(case.values.max())!r}"]
    functions = [traced(part.function) for part in term.style.parts]
    for i, j in ((1, 1), (1, 2), (2, 2))[:1 if case.types is None else 3]:
        qq = units.qqr2e * scene.charges[i - 1] * scene.charges[j - 1] if scene.charges else 0.0

        def energy(r, i=i, j=j, qq=qq):
            row = constant = 0
            total = 0.0
            r2 = r * r
            for part, function in zip(term.style.parts, functions):
                cut2, offset, *given = term.tables.rows[row:row + 2 + len(part.rows), i, j].tolist()
                given += term.tables.constants[constant:constant + len(part.constants)].tolist()
                row, constant = row + 2 + len(part.rows), constant + len(part.constants)
                if r2 < cut2:
                    total = function(r2 if part.coordinate == "r2" else r, *[qq] * part.charged, *given)[0] - offset + total
            return total
        text = expression(energy, "r", np.linspace(case.values.min(), case.values.max() * (1.0 - 1e-12), GRID))
        lines.append(f"pair_coeff {i} {j} \"{text}\"")
    return lines


def pairs_within(case: Case, lmp) -> None:
    """How many pairs a case has, and their distances' limits (as `values`)."""
    from scipy.spatial import cKDTree
    system = lmp.scene.need_system("measure")
    terms = lmp.scene.interactions.pair_terms(system.counts["ntypes"], unit_styles.get(system.units))
    cut = max(float(t.tables.rows[t.cut_rows].max()) for t in terms) ** 0.5
    found = cKDTree(np.mod(case.x, case.edge), boxsize=case.edge).query_pairs(cut, output_type="ndarray")
    d = case.x[found[:, 0]] - case.x[found[:, 1]]
    d -= case.edge * np.rint(d / case.edge)
    case.items, case.values = len(found), np.array([np.linalg.norm(d, axis=1).min(), cut])


def variants(case: Case, folder: str) -> tuple[dict[str, Runner], dict[str, str]]:
    """What can be computed, and why the rest is left out."""
    category, out, missing = case.scene.category, {}, {}
    style = registry.find(category, case.scene.name)
    own = opened(case, case.scene)
    own.commands_list(case.scene.lines)
    if category == "pair":
        pairs_within(case, own)

    def attempt(name: str, make: Callable[[], Runner]) -> None:
        try:
            out[name] = make()
        except SimulationError:
            missing[name] = "it is not finite at some of these geometries"
        except (Untraceable, AsemdError) as e:
            missing[name] = getattr(e, "message", str(e))

    def other(lines: list[str]) -> Runner:
        lmp = opened(case, case.scene)
        lmp.commands_list(lines)
        return Runner(lmp, case)
    out["double"] = first = Runner(own, case)
    if category != "pair":
        missing["mixed"] = "does not apply: bonded forces are always computed in double precision"
    elif first.engine.mode != "cluster" or first.engine.expanded or first.engine.sparse:
        missing["mixed"] = f"does not apply: {first.engine.why}"
    else:
        attempt("mixed", lambda: Runner(own, case, "mixed"))
    reason = no_table(style) if style.function else "the style has no function of its own"
    if reason:
        missing["table"] = reason
    else:
        try:
            lines = {(kind, n): table_lines(own, case, folder, kind, n) for n in TABLES for kind in ("linear", "spline")}
        except AsemdError as e:
            missing["table"], lines = e.message, {}
        for kind in ("linear", "spline"):
            for n in TABLES if lines else ():
                attempt(f"table {kind} {n}", lambda kind=kind, n=n: other(lines[kind, n]))
    if style.function:
        attempt("lepton", lambda: other(formula(own, case)))
    else:
        missing["lepton"] = reason
    return out, missing


def measure(category: str, name: str) -> dict:
    """The entry of one style."""
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        here = os.getcwd()
        os.chdir(folder)
        try:
            scene = style_scenes.scene(category, name)
            if scene.table:
                style_scenes.write_table(category, folder)
            if category == "pair":
                case = pair_case(name)
            else:
                few = opened(None, scene)
                few.commands_list(scene.lines)
                case = bonded_case(category, name, few)
            if scene.table:
                case.scene = replace(case.scene, lines=retold(case.scene.lines, *DENSE))
            runners, missing = variants(case, folder)
        finally:
            os.chdir(here)
    names = list(runners)
    for _ in range(ROUNDS):
        for variant in names:
            runners[variant].take_turn()
    exact = runners["double"].forces
    size = math.sqrt(float((exact**2).sum()))
    entry = {"commands": scene.lines, "items": case.items, "variants": {}, "left out": missing}
    for variant in names:
        error = math.sqrt(float(((runners[variant].forces - exact) ** 2).sum())) / size
        quartiles = np.percentile(runners[variant].times, [25, 50, 75]) / case.items * 1e9
        entry["variants"][variant] = {"error": float(f"{error:.2e}"), "ns": [float(f"{t:.3g}") for t in quartiles]}
    return entry


def main() -> int:
    if any(word.startswith("-") for word in sys.argv[1:]):
        print(__doc__)
        return 0 if {"-h", "--help"} & set(sys.argv) else 2
    given = [tuple(name.split(" ", 1)) for name in sys.argv[1:] if " " in name]
    families = [name for name in sys.argv[1:] if " " not in name]
    given += [(c, n) for c, n in measured() if c in families]
    known = json.loads(FILE.read_text())["styles"] if FILE.exists() and given else {}
    for category, name in given or measured():
        began = time.perf_counter()
        try:
            known[f"{category} {name}"] = measure(category, name)
        except AsemdError as e:
            raise InputError(f"{category} {name}: {e}") from None
        save(known)
        print(f"{category} {name}: {time.perf_counter() - began:.1f} s, "
              + ", ".join(f"{v} {e['error']:.0e} {e['ns'][1]:g}" for v, e in known[f"{category} {name}"]["variants"].items()), flush=True)
    return 0


def save(known: dict) -> None:
    """Write the file, a line for each style."""
    FILE.parent.mkdir(exist_ok=True)
    rows = ",\n".join(f"  {json.dumps(name)}: {json.dumps(entry)}" for name, entry in sorted(known.items()))
    about = {key: word for key, word in machine().items() if key != "lammps"}
    FILE.write_text(f'{{"machine": {json.dumps(about)},\n "command": {json.dumps(COMMAND)},\n "styles": {{\n{rows}}}}}\n')


if __name__ == "__main__":
    sys.exit(main())
