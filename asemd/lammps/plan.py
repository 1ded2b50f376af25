"""What a scene needs, what is left out, and why; nothing is compiled and no step is run."""
from __future__ import annotations

import math
import os
import sys
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from asemd import units as unit_styles
from asemd.cluster_term import PairTerm
from asemd.embedded_term import EmbeddedTerm
from asemd.engine import Engine
from asemd.errors import InputError
from asemd.lammps.plan_memory import holdings, pairs_around
from asemd.manybody_term import ManyBodyTerm
from asemd.own_term import OwnTerm
from asemd.term import BondedTerm, PairListTerm, PairRowsTerm
from asemd.text_table import Table

# packages that a run may import -> what needs them
OPTIONAL = {"scipy": "numba looks for it; dump image", "ase": "asemd.read, delete_atoms overlap, triclinic cells",
            "sympy": "styles of one's own given as a formula", "matplotlib": "colours of dump image and movie by name",
            "MDAnalysis": "dump dcd and xtc, and reading such files", "vl_convert": "static plots of pages"}
NEEDED = {"numpy": "arrays", "numba": "compiled kernels", "llvmlite": "numba", "rich": "the progress bar", "typer": "the command line"}


@dataclass
class Item:
    """One thing that a scene needs or does without: what it is, how it is done, why, and what would have switched it on."""

    name: str
    how: str
    why: str = ""
    switch: str = ""


@dataclass
class Plan:
    """What `plan` found; ``print(plan)`` shows it.

    Attributes
    ----------
    source : str
    sections : dict
        Title -> list of `Item`: System, Neighbour list, Forces, Fixes, Output, Memory, Modules, Speed.
    left_out : list of Item
        What does not exist in this run, why, and what would have switched it on.
    bytes : float
        Expected size of the arrays that grow with the scene.
    steps_per_second : float or None
        Expected; None without a calibration of this machine.
    """

    source: str
    sections: dict[str, list[Item]] = field(default_factory=dict)
    left_out: list[Item] = field(default_factory=list)
    bytes: float = 0.0
    steps_per_second: float | None = None

    def parts(self) -> list[Table | str]:
        """Tables, in order."""
        out: list[Table | str] = [f"Plan of {self.source}"]
        for title, items in self.sections.items():
            if items:
                out.append(Table(title, ("", "how", "why"), [(i.name, i.how, i.why) for i in items]))
        return [*out, Table("Left out", ("", "why", "switched on by"), [(i.name, i.why, i.switch) for i in self.left_out])]

    def __str__(self) -> str:
        return "\n\n".join(map(str, self.parts()))

    def to_dict(self) -> dict[str, Any]:
        """Everything, JSON-able."""
        return asdict(self)


def plan(source, calibrate: bool = False) -> Plan:
    """The plan of a scene.

    Parameters
    ----------
    source : path, asemd.scene.Scene or ase.Atoms
        A script is executed up to its first run or minimisation; atoms need `asemd.ForceField` as calculator.
    calibrate : bool
        Measure the speed of this machine if that was not done before (in a process of its own: about seven seconds, about a minute
        where kernels have to be compiled first). Without it, or for atoms, the expected speed is told only where it is known.

    Raises
    ------
    InputError
        A mistake in the script, missing coefficients, atoms without a force field.
    """
    from asemd.scene import Scene
    if isinstance(source, (str, os.PathLike)):
        return of_script(os.fspath(source), calibrate=calibrate)
    if isinstance(source, Scene):
        return of_scene(source, calibrate=calibrate)
    from asemd.calculator import ForceField
    calc = getattr(source, "calc", None)
    if not isinstance(calc, ForceField):
        raise InputError("plan needs the path of a LAMMPS script, a Scene, or atoms whose calculator is asemd.ForceField")
    system = calc._system(source)
    calc.interactions.check_complete(system)
    engine = Engine(system, calc.interactions, calc.settings)
    out = _of_engine(repr(calc), engine)
    out.sections["Output"] = [Item("energy, forces, virial", "at every evaluation", "ASE may ask for any of them")]
    out.left_out.append(Item("energies and virials per atom", "", "nobody has asked", "get_potential_energies or get_stresses"))
    _memory(out, engine)
    return out


def of_script(path: str, switches=None, calibrate: bool = False) -> Plan:
    """The plan of a script's scene at its first run or minimisation."""
    from asemd.lammps.session import Session, Stop
    session = Session(switches=switches, passive=True)
    try:
        session.file(path)
    except Stop:
        session.label = None
    where = session.stopped_at
    source = f"{path}, line {where.line}: {' '.join(where.text.split())}" if where else f"{path}, which runs nothing: its scene at the end"
    minimizes = where is not None and where.text.split()[0] == "minimize"
    try:
        return of_scene(session.scene, source, session.variables.references, calibrate, minimizes)
    except InputError as error:
        raise error.at(where) from None


def of_scene(scene, source: str = "scene", references=lambda word: {word}, calibrate: bool = False, minimizes: bool = False) -> Plan:
    """The plan of a scene; `references` tells which names a formula uses. A run is described, or a minimisation."""
    system = scene.need_system("plan")
    scene.interactions.check_complete(system)
    engine = Engine(system, scene.interactions, scene.settings())
    out = _of_engine(source, engine)
    out.sections["Fixes"] = _fixes(scene, minimizes)
    out.sections["Output"], more = _output(scene, references, minimizes)
    out.left_out += more
    _costs(out, engine, scene, calibrate, minimizes)
    return out


# ------------------------------------------------------------------------------------------------------------ from the engine ---

def _of_engine(source: str, engine: Engine) -> Plan:
    terms = [_term(engine, t) for t in engine.terms]
    return Plan(source, {"System": _system(engine), "Neighbour list": _list(engine), "Forces": terms + _specials(engine)}, _absent(engine))


def _system(e: Engine) -> list[Item]:
    s = e.system
    arrays = ["id", "type", "x", "image", "v", "f"] + ["molecule"] * s.molecular + ["q"] * s.has_charge + ["rmass"] * (s.rmass is not None)
    shape = "axis-aligned" if e.ortho else "general cell"
    faces = ", ".join(f"{axis} {'periodic' if b == 'pp' else b}" for axis, b in zip("xyz", s.box.boundary))
    return [Item("atoms", f"{s.n} of {s.counts['ntypes']} types, {s.dimension}-dimensional", f"units {s.units}, atom_style {s.atom_style}"),
            Item("arrays", " ".join([*arrays, *s.extra]), "what the atom style has"),
            Item("box", f"{shape}: {faces}", "shifts of periodic images are those of axis-aligned vectors" if e.ortho else
                 "image shifts are sums of the three vectors"),
            Item("threads", str(e.threads), ""),
            Item("precision", e.settings.precision, "sums are always in double precision" if e.settings.precision == "mixed" else "")]


def _list(e: Engine) -> list[Item]:
    s, settings = e.system, e.settings
    if e.mode == "none":
        return []
    how = {"cluster": "clusters of 8 atoms, half list", "plain": "plain pairs with image shifts, half list"}[e.mode]
    if e.expanded:
        how += ", expanded into plain pairs"
    if e.sparse:
        how += ", turned into rows of single atoms"
    around = pairs_around(e)
    often = f"every {settings.every} steps" if settings.every > 1 else "every step"
    late = f", from step {settings.delay} of a list on" if settings.delay > 1 else ""
    check = (f"when an atom has moved half the skin, looked at {often}{late}"
             if settings.check else f"every {max(settings.every, settings.delay)} steps, whether atoms have moved or not")
    out = [Item("list", how, e.why),
           Item("reach", f"{e.reach:g} = cutoff {e.cutoff:g} + skin {settings.skin:g}", "the longest cutoff in use"),
           Item("pairs", f"about {around * s.n:.3g}, {around:.3g} per atom", "estimated from the density"),
           Item("rebuild", check, "neigh_modify")]
    if settings.exclude:
        what = [" ".join(map(str, x)) if x[0] == "type" else x[0] for x in settings.exclude]
        out.append(Item("exclusions", ", ".join(what), "neigh_modify exclude"))
    if e.expanded:
        out.append(Item("expansion", "after each build", "a sub-style with a factor for each atom"))
    return out


def _term(e: Engine, t) -> Item:
    if t.category == "kspace":
        return Item(f"k-space {t.solver.style}", "; ".join(line.strip() for line in t.solver.lines()[2:]), "kspace_style")
    style = t.style
    if isinstance(t, BondedTerm):
        function = "minimum image" if e.periodic.any() else "no images: nothing is periodic"
        return Item(f"{t.category} {style.name}", f"{len(t.items)} {t.category}s of {len(np.unique(t.types))} types, {function}",
                    f"{t.category}_style and {t.category}_coeff")
    owner = getattr(t, "owner", None)
    times = ", times a factor" if owner is not None and not owner.is_plain else ""
    charged = "with charges" if style.charged and getattr(t, "pairs", "") not in ("one_four", "ends") else "without charges"
    if isinstance(t, PairTerm):
        varying = sum(not u for u in t.uniform)
        rows = f"{varying} of {len(t.uniform)} coefficients by type pair" if varying else "coefficients the same for all pairs of types"
        hidden = "excluded partners moved away" if e.exclusions.partners is not None else "no exclusions"
        precision = "single" if t.single else "double"
        listed = ", over a pruned list" if t.prunes(e) else ""
        what = f"cluster kernel{listed}, {precision} precision, {charged}, {rows}, {hidden}{times}"
        return Item(f"pair {style.name}", what, "pair_style")
    if isinstance(t, PairRowsTerm):
        hidden = "excluded partners left out of the rows" if e.exclusions.partners is not None else "no exclusions"
        which = {"same": ", pairs within molecules", "other": ", pairs between molecules"}.get(t.owner.molecules, "")
        return Item(f"pair {style.name}", f"rows of single atoms{which}, double precision, {charged}, {hidden}{times}", e.why)
    if isinstance(t, EmbeddedTerm):
        blocks = "tables by pair of types" if t.varying else "the same tables for all types"
        return Item(f"pair {style.name}", f"cluster kernel, densities first, then forces, double precision, {blocks}{times}", "pair_style")
    if isinstance(t, ManyBodyTerm):
        how = "rows of all neighbours of each atom" + ", eight atoms at a time" * t.eights
        return Item(f"pair {style.name}", f"{how}, double precision{times}", "pair_style")
    if not isinstance(t, PairListTerm):
        what = "by atom: a constant of the energy, no forces" if isinstance(t, OwnTerm) else f"of {style.name}'s own, double precision"
        return Item(f"pair {style.name}", f"{'energies' if isinstance(t, OwnTerm) else 'kernel'} {what}", "pair_style")
    if t.pairs == "special":
        return Item(f"pair {style.name} (special)", f"{len(e.exclusions.weighted)} weighted pairs, one by one",
                    "special_bonds factors between 0 and 1, which the cluster kernel leaves out")
    if t.pairs == "one_four":
        return Item(f"pair {style.name} (1-4)", f"{len(t.one_four[0])} pairs, one by one", "dihedral style with weights of 1-4 pairs")
    if t.pairs == "ends":
        return Item(f"angle repulsion of {style.name}", f"{len(t.one_four[0])} pairs, one by one", "angle style with repulsion of its ends")
    if t.pairs == "broken":
        return Item(f"pair {style.name} (broken bonds)", f"{len(t.bonds.items)} bonds, one by one",
                    "pairs of bonds that break interact at once, before the next list")
    if t.pairs == "bond":
        return Item("bond special", f"{len(t.items)} pairs with pair style {style.name}, one by one", "bond_style special")
    why = e.why if e.mode == "plain" else "pairs of the expanded list"
    return Item(f"pair {style.name}", f"pair by pair, double precision, {charged}", why)


def _specials(e: Engine) -> list[Item]:
    if e.mode == "none" or e.system.topology.is_empty:
        return []
    _, kinds = e.interactions.special_pairs(e.system)
    out = []
    for kind, name in ((1, "1-2"), (2, "1-3"), (3, "1-4")):
        n, lj, coul = int((kinds == kind).sum()), e.exclusions.weight_lj[kind], e.exclusions.weight_coul[kind]
        if n:
            how = "excluded" if lj == coul == 0.0 else "ordinary pairs" if lj == coul == 1.0 else "weighted"
            out.append(Item(f"{name} pairs", f"{n} {how}", f"special_bonds factors {lj:g} (lj) and {coul:g} (coul)"))
    return out


def _absent(e: Engine) -> list[Item]:
    out, inter, s = [], e.interactions, e.system
    if e.mode == "none":
        out.append(Item("neighbour list", "", e.why, "pair_style"))
    elif not any(t.style.charged for t in e.pair_terms + e.many_terms):
        why = "no pair style in use has one" + (", the charges act on nothing" if s.has_charge else "")
        out.append(Item("Coulomb part", "", why, "a pair_style with coul in its name"))
    if e.solver is None:
        out.append(Item("k-space", "", "no style has a long-range part", "kspace_style and a pair_style with coul/long in its name"))
    for category, n in s.topology.counts().items():
        if not any(isinstance(t, BondedTerm) and t.category == category for t in e.terms):
            plural, style = f"{category}s", inter.style_name(category)
            why = f"{category}_style {style}: {n} {plural} without forces" if n else f"there are no {plural}"
            out.append(Item(f"{category} forces", "", why, f"{category}_style" if n else f"{plural} in the data file or by create_bonds"))
    if e.mode != "none" and e.exclusions.partners is None:
        bare = s.topology.is_empty
        out.append(Item("exclusion of bonded pairs", "", "no bonds" if bare else "all special_bonds factors are 1",
                        "bonds" if bare else "special_bonds with other factors"))
    if e.mode != "none" and not inter.tail:
        out.append(Item("tail correction", "", "pair_modify tail no", "pair_modify tail yes"))
    if e.ortho:
        out.append(Item("tilted image shifts", "", "the box is axis-aligned", "a triclinic box"))
    for axis, periodic in zip("xyz", e.periodic):
        if not periodic:
            flat = s.dimension == 2 and axis == "z"
            out.append(Item(f"images along {axis}", "", "two dimensions" if flat else f"{axis} is not periodic",
                            "dimension 3" if flat else f"boundary with p along {axis}"))
    if e.mode == "cluster" and not e.settings.outdated and not e.sparse:
        out.append(Item("marks of pairs out of reach", "", "lists are never outdated",
                        "neigh_modify with check no, or every or delay above 1"))
    if e.threads == 1:
        out.append(Item("force buffers of threads", "", "one thread", "--threads"))
    return out


# ------------------------------------------------------------------------------------------------------------ from the scene ---

def _fixes(scene, minimizes: bool) -> list[Item]:
    out, python = [], []
    if minimizes:
        out = [Item(f"fix {id}", f"{f.style} on group {f.group}", "acts on the forces" if f.minimizes else "rests during minimisation")
               for id, f in scene.fixes.items()]
        why = "the script begins with it; runs after it have a time loop, which this plan does not describe"
        return [Item("minimisation", f"min_style {scene.min_style}", why), *out]
    for id, fix in scene.fixes.items():
        hooks = fix.hooks()
        names = ", ".join(name + ("" if compiled else " (Python)") for name, compiled in hooks.items()) or "no hooks"
        python += [f"fix {id} ({fix.style}) has {name} in Python" for name, compiled in hooks.items() if not compiled]
        out.append(Item(f"fix {id}", f"{fix.style} on group {fix.group}", names))
    movers = [id for id, f in scene.fixes.items() if f.integrates]
    loop = Item("time loop", "step by step" if python else "compiled, from output to output", "; ".join(python) or "every hook is compiled")
    return [loop, *out] if movers or out else [Item("time loop", "compiled, atoms do not move", "no fix integrates")]


def _output(scene, references, minimizes: bool) -> tuple[list[Item], list[Item]]:
    thermo, computes = scene.thermo, scene.computes
    words = thermo.columns()
    row = thermo.needs(words, computes, references)
    when = f"on steps that variable {thermo.every} names" if isinstance(thermo.every, str) else (
        f"every {thermo.every} steps, first and last" if thermo.every else "on the first and last step")
    out = [Item("thermo row", when, " ".join(words))]
    for id, dump in scene.dumps.items():
        needs = ", ".join(sorted(dump.needs)) or "nothing but the atoms"
        out.append(Item(f"dump {id}", f"{dump.style} every {dump.every} steps", f"needs {needs}"))
    for id, compute in computes.items():
        shown = any(w.partition("[")[0] == f"c_{id}" for w in words)
        if not id.startswith("thermo_") and (shown or not compute.maker):
            needs = ", ".join(sorted(compute.needs)) or "nothing but the atoms"
            when_used = "shown in thermo rows" if shown else "evaluated when asked for"
            out.append(Item(f"compute {id}", compute.style, f"needs {needs}; {when_used}"))
    often, absent = _energies(scene, when, minimizes)
    out += often
    per_atom = {"energies", "virials"}
    asking = [f"dump {id}" for id, d in scene.dumps.items() if d.needs & per_atom] + [
        f"compute {id}" for id, c in computes.items() if c.needs & per_atom]
    if row & per_atom or asking:
        out.append(Item("per-atom kernels", "on the steps on which they are shown, and on the last one", ", ".join(asking) or "thermo row"))
    else:
        absent.append(Item("energies and virials per atom", "", "no compute or dump needs them", "compute pe/atom or stress/atom"))
    if not scene.dumps:
        absent.append(Item("dumps", "", "none is defined", "dump"))
    return out, absent


def _energies(scene, when: str, minimizes: bool) -> tuple[list[Item], list[Item]]:
    """On which steps energy and virial are computed, and when they are not."""
    if minimizes:
        return [Item("energy and virial", "at every evaluation", "the minimiser looks at the energy: the kernel with energies runs")], []
    asking = {id: f for id, f in scene.fixes.items() if f.virial_every}
    every = math.gcd(*(f.virial_every for f in asking.values()))
    whose = ", ".join(f"fix {id} ({f.style})" for id, f in asking.items())
    late = [f"fix {id} ({f.style}) every {f.every}" for id, f in scene.fixes.items() if f.needs and not f.virial_every]
    when = "; ".join([when, *["on steps with a dump"] * bool(scene.dumps), *late])
    steps = "every step" if every == 1 else f"every {every} steps"
    if any(f.with_energies for f in asking.values()):
        return [Item("energy and virial", steps, f"{whose} asks for them")], []
    out = [Item("energy and virial", when, "the kernel with energies runs on these steps only")]
    if every:
        return ([*out, Item("virial", steps, f"{whose} asks for it")],
                [Item("energy between outputs", "", "nobody looks at it", "thermo 1")])
    return out, [Item("energy and virial between outputs", "", "nobody looks at them: the force-only kernel runs", "thermo 1")]


# ------------------------------------------------------------------------------------------------------------- what it costs ---

def _memory(out: Plan, e: Engine, per_atom: bool = False, costs=None) -> None:
    held = holdings(e, per_atom)
    out.bytes = sum(h.bytes for h in held)
    items = [Item(h.name, _bytes(h.bytes), f"{h.what}; {h.why}" if h.what else h.why) for h in held]
    items.append(Item("together", _bytes(out.bytes), f"{out.bytes / max(e.system.n, 1):.0f} bytes an atom"))
    if costs is not None:
        items.append(Item("program", _bytes(costs.program), "interpreter, modules, compiled kernels; measured on this machine"))
    out.sections["Memory"] = items
    loaded = [m for m in (*NEEDED, *OPTIONAL) if m in sys.modules]
    out.sections["Modules"] = [Item(m, "imported", NEEDED.get(m) or OPTIONAL[m]) for m in loaded]
    out.left_out += [Item(f"module {m}", "", "not needed so far", why) for m, why in OPTIONAL.items() if m not in loaded]


def _bytes(n: float) -> str:
    return f"{n / 2**20:.3g} MB" if n >= 2**20 else f"{n / 2**10:.3g} kB"


def _costs(out: Plan, e: Engine, scene, calibrate: bool, minimizes: bool) -> None:
    """Memory, modules and expected speed."""
    from asemd.lammps import calibration, plan_speed
    costs = (calibration.calibrate if calibrate else calibration.known)(e.threads, e.settings.precision)
    per_atom = any(x.needs & {"energies", "virials"} for x in (*scene.computes.values(), *scene.dumps.values()))
    _memory(out, e, per_atom, costs)
    if minimizes:
        return
    if costs is None:
        why = "this machine has not been measured: asemd plan --calibrate does it, once, in about a minute"
        out.sections["Speed"] = [Item("steps per second", "not known", why)]
        return
    every = scene.thermo.every if isinstance(scene.thermo.every, int) else 0
    rows = (1.0 / every if every else 0.0) + sum(1.0 / d.every for d in scene.dumps.values() if isinstance(d.every, int) and d.every)
    python = sum(not compiled for f in scene.fixes.values() for compiled in f.hooks().values())
    speed = plan_speed.expected(e, costs, scene.dt, any(f.integrates for f in scene.fixes.values()), rows, python)
    out.steps_per_second = speed.steps_per_second
    day = 86400.0 * scene.dt * out.steps_per_second
    u = unit_styles.get(scene.units)
    per_day = f"{day:.3g} tau a day" if scene.units == "lj" else f"{day / u.femtosecond / 1e6:.3g} ns a day"
    items = [Item("steps per second", f"about {out.steps_per_second:.3g}",
                  f"{per_day}; from a calibration of this machine, right within a factor of 2 or 3; if it seems wrong: --calibrate")]
    total = sum(speed.parts.values())
    items += [Item(name, f"{100.0 * t / total:.0f} %", "") for name, t in speed.parts.items() if t > 0.005 * total]
    if e.mode != "none" and speed.builds < 1e3:
        items.append(Item("list builds", f"about every {speed.builds:.0f} steps", "from the fastest atom, half the skin and the timestep"))
    out.sections["Speed"] = items
