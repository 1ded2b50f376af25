"""A scene on asemd and on LAMMPS: energies, forces and virials term by term, and the rows of its runs side by side."""
from __future__ import annotations

import copy
import os
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from asemd import units as unit_styles
from asemd.engine import Engine, Settings
from asemd.errors import InputError
from asemd.forcefield import CATEGORIES, Interactions
from asemd.lammps import export
from asemd.lammps.session import Stop
from asemd.lammps.switches import Switches
from asemd.scene import Scene
from asemd.system import System
from asemd.testing import thermo_rows
from asemd.testing.comparison import Energy, Force, Report
from asemd.testing.lammps_side import TENSOR, ZERO_STEP, comparable
from asemd.testing.oracle import OracleError, ask, lammps_available, lammps_version, why_not
from asemd.testing.thermo_rows import relative

TOLERANCE = {"double": 1e-9, "mixed": 1e-4}
ENERGIES = {"evdwl": "pair vdwl", "ecoul": "pair coul", "ebond": "bond", "eangle": "angle", "edihed": "dihedral", "eimp": "improper",
            "elong": "k-space", "etail": "tail"}
SETTINGS = frozenset("""fix fix_modify unfix compute compute_modify uncompute thermo thermo_style thermo_modify velocity min_style
                     min_modify run_style timestep reset_timestep""".split())
HOLDERS, FILLED = {"property/atom"}, {"cmap"}       # fixes that hold what belongs to atoms, and those that read_data fills with forces


def validate(source, *, steps: int | None = 20, tolerance: float | None = None, compat: str = "", precision: str = "double",
             threads: int = 1, switches: Switches | None = None) -> Report:
    """Compare asemd with LAMMPS, which runs in a process of its own.

    Parameters
    ----------
    source : path, ase.Atoms or Scene
        A LAMMPS script, executed up to its first run for energies and forces, then with runs of at most `steps` steps for the thermo rows;
        atoms whose calculator is `asemd.ForceField`, or a scene, in any frame: LAMMPS gets them rotated, its forces are rotated back.
    steps : int or None
        Limit on every run and minimisation of the script; 0 compares first rows only, None energies, forces and virials only.
    tolerance : float, optional
        Largest relative difference of energies, forces, virials and thermo rows that counts as agreement; 1e-9 in double precision.
    compat : str
        ``"lammps"``: follow LAMMPS where its forces are not minus the gradient of its energy.
    precision, threads
        As in `asemd.engine.Settings`, for scripts.
    switches : Switches, optional
        LAMMPS's command line switches, for scripts.

    Returns
    -------
    Report

    Raises
    ------
    OracleError
        LAMMPS is not installed or does not take the commands.
    InputError
        A mistake in the script, or atoms without a force field.
    """
    if not lammps_available():
        raise OracleError(why_not())
    if isinstance(source, (str, os.PathLike)):
        switches = copy.deepcopy(switches) if switches else Switches()
        switches.compat, switches.precision, switches.threads, switches.cap = compat or switches.compat, precision, threads, steps
        return _script(os.fspath(source), switches, tolerance)
    if isinstance(source, Scene):
        return _exported("scene", source.need_system("validate"), source.interactions, source.settings(), tolerance, compat)
    return _atoms(source, tolerance, compat)


def _script(path: str, switches: Switches, tolerance: float | None) -> Report:
    from asemd.testing.recorder import Recorder
    session = Recorder(switches)
    try:
        session.file(path)
    except Stop:
        session.label = None
    except InputError as e:
        if not session.runs:
            raise
        session.notes.append(f"the script is compared no further, after runs of few steps and without files written it stops: {e}")
    if session.first is None:
        if session.scene.system is None:
            raise InputError(f"validate: {path} defines no atoms")
        session.first, session.start = session.scene, len(session.commands)
    words = [w for name, values in switches.variables for w in ("-var", name, *values)]
    setup = first_step(session.commands[:session.start])
    scene = session.first
    for fix in scene.fixes.values():        # LAMMPS gets none for the first step but those that hold what is read
        if fix.style not in HOLDERS:
            fix.detach(scene.system)
    limit = TOLERANCE[switches.precision] if tolerance is None else tolerance
    if session.runs and any(use.style.stirred for use in scene.interactions.uses["pair"]):
        report = Report(path, scene.system.n, scene.system.units, lammps_version() or "", limit, 0.0,
                        notes=["friction and noise of the pair style take a run: thermo rows alone are compared"])
    else:
        report = _zero_step(path, scene.system, scene.interactions, scene.settings(), setup, words, limit)
    report.notes += dict.fromkeys(session.notes)
    report.documented += dict.fromkeys(session.documented)
    if session.failed:
        report.failures.append(f"asemd stopped: {session.failed}")
    if session.runs:
        largest = max((f.largest for f in report.forces[-1:]), default=0.0)
        norm = scene.thermo.is_normalised(scene.units)
        energies = sum(abs(e.lammps) for e in report.energies[:-1])
        virials = sum(max(map(abs, f.virial_lammps)) for f in report.forces[:-1])
        thermo_rows.compare(report, session, words,
                            thermo_rows.floors(scene.system, norm, energies, virials, max(report.scale, largest)))
    return report


def first_step(commands: list[str]) -> list[str]:
    """Commands without those that forces of the first step do not depend on; fixes that read_data fills stay until they have been."""
    kept, left = [], []
    for command in commands:
        name, *words = command.split()
        if name == "fix" and words[2] in HOLDERS | FILLED:
            kept.append(command)
            left += [f"unfix {words[0]}"] * (words[2] in FILLED)
        elif name not in SETTINGS:
            kept.append(command)
    return kept + left


def _atoms(atoms, tolerance: float | None, compat: str) -> Report:
    from asemd.calculator import ForceField
    calc = getattr(atoms, "calc", None)
    if not isinstance(calc, ForceField):
        raise InputError("validate needs the path of a LAMMPS script, a scene, or atoms whose calculator is asemd.ForceField")
    return _exported(repr(calc), calc._system(atoms), calc.interactions, calc.settings, tolerance, compat)


def _exported(name: str, system: System, interactions: Interactions, settings: Settings, tolerance: float | None, compat: str) -> Report:
    interactions = copy.deepcopy(interactions)
    interactions.compat = compat or interactions.compat
    interactions.check_complete(system)
    notes = []
    if system.units == "ase" and _own_constants(system, interactions):
        system = system.copy()
        system.units = "metal"
        notes.append("both programs take the Coulomb constant of units metal, 2.4e-08 smaller than that of ASE's units: it is part of the "
                     "pair style, or of the choice of the long-range sum")
    if interactions.kspace.startswith("msm"):       # its grid is that of the box, which LAMMPS would shrink to the atoms
        system = system.copy()
        system.box = replace(system.box, boundary=tuple(b.replace("s", "f").replace("m", "f") for b in system.box.boundary))
    with tempfile.TemporaryDirectory(prefix="asemd-validate-") as folder:
        setup = export.commands(system, interactions, settings, Path(folder) / "data.scene")
        limit = TOLERANCE[settings.precision] if tolerance is None else tolerance
        report = _zero_step(name, system, interactions, settings, setup, [], limit)
    report.notes += notes
    return report


def _own_constants(system: System, interactions: Interactions) -> bool:
    """Whether the Coulomb constant is in more than the product of two charges, which ``dielectric`` cannot make up for in LAMMPS."""
    if interactions.kspace != "none":
        return True
    terms = (interactions.pair_terms(system.counts["ntypes"], unit_styles.get(name)) for name in ("ase", "metal"))
    tables = [[term.tables for term in of] for of in terms]
    numbers = [[np.asarray(a) for t in of for a in (t.rows, t.constants, *t.arrays)] for of in tables]
    return any(not np.array_equal(a, b, equal_nan=True) for a, b in zip(*numbers, strict=True))


# --------------------------------------------------------------------------------------------- energies, forces, virials ---

def removal_order(interactions: Interactions) -> list[str]:
    """Categories in the order in which they are taken away to see the forces of each.

    The pair style goes last if a dihedral style needs it, after the long-range solver in any case.
    """
    weighted = any(use.style.weight_14 for use in interactions.uses["dihedral"])
    order = "bond angle improper dihedral pair" if weighted else "pair bond angle dihedral improper"
    return ["kspace"] * (interactions.kspace != "none") + [c for c in order.split() if interactions.uses[c]]


def _zero_step(source: str, system: System, interactions: Interactions, settings: Settings, setup: list[str], switches: list[str],
               tolerance: float) -> Report:
    order, exact = removal_order(interactions), comparable(interactions)
    ours = [_evaluate(system, interactions, settings)]
    less = copy.deepcopy(interactions)
    for category in order[:-1]:
        if category == "kspace":
            less.kspace_modify["compute"] = False
        else:
            less.uses[category], less.hybrid[category] = [], ""
        if category == "pair":
            less.tail, less.kspace = False, "none"
        ours.append(_evaluate(system, less, settings))
    cutoff = interactions.cutoff(system.counts["ntypes"], None) if interactions.uses["pair"] else 0.0
    theirs = ask(ZERO_STEP, commands=[*setup, *exact], order=order, categories=[*CATEGORIES, "kspace"],
                 cutoff=max(cutoff, 1e-6), switches=switches, energies=list(ENERGIES))
    if "error" in theirs:
        raise OracleError(f"LAMMPS stops at {theirs['command']!r}: {theirs['error']}")
    rows = np.argsort(system.id)
    if not np.array_equal(system.id[rows], theirs["id"]):
        raise OracleError(f"asemd has {system.n} atoms, LAMMPS {len(theirs['id'])}, or their ids differ: forces cannot be compared")
    rotation = system.box.to_lammps()[1]
    result = ours[0]
    report = Report(source, system.n, system.units, lammps_version() or "", tolerance, 0.0)
    for command in exact:
        report.notes.append(f"LAMMPS is told {command}: " + (
            "by default it has no components of the pressure with msm" if command == TENSOR else
            "asemd computes what LAMMPS looks up in tables of 4096 distances, which changes forces between charges by 1e-6; with --compat "
            "lammps both look it up"))
    _energies(report, result, theirs["energy"], interactions)
    to_virial = theirs["volume"] / theirs["nktv2p"]
    their_virial = {c: _back(rotation, np.asarray(v) * to_virial) for c, v in theirs["virial"].items()}
    our_virial = dict(result.virial_of)
    our_virial["pair"] = our_virial.get("pair", np.zeros(6)) + our_virial.pop("tail", np.zeros(6))
    energy = sum(map(abs, theirs["energy"].values()))
    size = max(sum(np.abs(v).max() for v in our_virial.values()), 1e-3 * energy)       # of a crystal at rest there is only the energy
    length = (system.box.volume / max(system.n, 1)) ** (1 / 3)
    their_forces = [f @ rotation.T for f in theirs["forces"]]
    report.scale = max(float(np.abs(their_forces[0]).max(initial=0.0)), size / max(system.n, 1) / length, 1e-300)
    for k, category in enumerate(order):
        rest = ours[k + 1].forces if k + 1 < len(ours) else 0.0
        _forces(report, "k-space" if category == "kspace" else category, (ours[k].forces - rest)[rows],
                their_forces[k] - their_forces[k + 1], our_virial.get(category, np.zeros(6)), their_virial[category], size)
    whole = result.virial + result.virial_of.get("tail", 0.0)
    _forces(report, "all", result.forces[rows], their_forces[0], whole, sum(their_virial.values(), np.zeros(6)), size)
    if interactions.compat != "lammps":
        report.documented += documented(interactions, report.ok)
    return report


def _evaluate(system: System, interactions: Interactions, settings: Settings):
    """The result of a copy of the system under these interactions."""
    return Engine(system.copy(), interactions, settings).compute()


def _energies(report: Report, result, theirs: dict[str, float], interactions: Interactions) -> None:
    theirs = dict(theirs, evdwl=theirs["evdwl"] - theirs["etail"])
    total = sum(abs(v) for v in theirs.values())
    shown = {"evdwl", "ecoul"} if interactions.uses["pair"] else set()
    for key, name in ENERGIES.items():
        a, b = result.energy[key], theirs[key]
        if a or b or key in shown or (key[1:] in ("bond", "angle") and interactions.uses[key[1:]]):
            report.energies.append(Energy(name, a, b, relative(a, b, max(abs(a), abs(b), 1e-3 * total))))
    a, b = result.potential, sum(theirs.values())
    report.energies.append(Energy("all", a, b, relative(a, b, max(abs(b), 1e-3 * total))))


def _forces(report: Report, term: str, a, b, virial_a, virial_b, size: float) -> None:
    d = a - b
    worst = float(np.abs(d).max(initial=0.0))
    largest = float(np.abs(b).max(initial=0.0))
    scale = max(report.scale, largest)
    virial_error = relative(float(np.abs(virial_a - virial_b).max()), 0.0, size)
    report.forces.append(Force(term, largest, worst, float(np.sqrt((d * d).mean())) if d.size else 0.0, relative(worst, 0.0, scale),
                               np.asarray(virial_a).tolist(), np.asarray(virial_b).tolist(), virial_error))


def _back(rotation: np.ndarray, v: np.ndarray) -> np.ndarray:
    """A symmetric tensor (6,) from LAMMPS's frame to the user's."""
    xx, yy, zz, xy, xz, yz = v
    t = rotation @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ rotation.T
    return np.array([t[0, 0], t[1, 1], t[2, 2], t[0, 1], t[0, 2], t[1, 2]])


def documented(interactions: Interactions, agree: bool = True) -> list[str]:
    """Styles in use whose forces differ from LAMMPS's on purpose; those that do so in rare places only where the programs do not agree."""
    def differs(use) -> bool:
        rarely = use.style.category == "pair" and use.style.variant(use.settings, "lammps") is not use.style.variant(use.settings)
        return getattr(use.style, "twin", None) is not None or rarely and not agree
    return [f"{category} style {use.style.name}: asemd's force is minus the gradient of the energy, LAMMPS's is not everywhere "
            "(the style's page says where); --compat lammps takes LAMMPS's"
            for category, uses in interactions.uses.items() for use in uses if differs(use)]
