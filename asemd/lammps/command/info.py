"""``info [sections] [out screen|log|overwrite FILE|append FILE]``: what the session knows."""
from __future__ import annotations

import platform
import sys
import time
from itertools import islice

from asemd import __version__
from asemd.errors import InputError, nearest
from asemd.lammps import catalog, driver
from asemd.lammps.catalog import FORCE_FIELD
from asemd.words import choice, take

LINE = "Info-" * 16
STYLES = ("atom", "bond", "angle", "dihedral", "improper", "pair", "kspace", "fix", "compute", "region", "dump", "command", "minimize",
          "integrate")


def run(session, args):
    words, sections, target, path = list(args), [], "screen", None
    while words:
        word = words.pop(0)
        if word == "out":
            target = choice(take(words, 1, "info out")[0], ("screen", "log", "append", "overwrite"), "info out")
            del words[0]
            if target in ("append", "overwrite"):
                path = take(words, 1, f"info out {target}")[0]
                del words[0]
        elif _meant(word) == "styles":
            chosen = [w for w in words[:1] if w in (*STYLES, "all")]
            words = words[len(chosen):]
            sections.append(("styles", chosen[0] if chosen else "all"))
        elif word == "all":
            sections += [(name, "all") for name in SECTIONS]
        elif _meant(word):
            sections.append((_meant(word), ""))
        else:
            raise InputError(f"info: unknown section {word!r}{nearest(word, SECTIONS)}, there are {' '.join(SECTIONS)} all out")
    lines = ["", LINE, time.strftime("Printed on %a %b %d %H:%M:%S %Y")]
    for name, part in dict.fromkeys(sections):
        lines += ["", *SECTIONS[name](session, part)]
    text = "\n".join([*lines, "", LINE, ""])
    if path is None:
        (session.log.to_file if target == "log" else session.log.to_screen)(text + "\n")
    elif not session.passive:
        try:
            with open(path, "a" if target == "append" else "w", encoding="utf-8") as f:
                f.write(text + "\n")
        except OSError as e:
            raise InputError(f"info: cannot write {path}: {e.strerror}") from None


def _meant(word: str) -> str:
    """The section whose first letters a word has: as many as LAMMPS looks at."""
    return next((name for name in SECTIONS if word[:LETTERS.get(name, 3)] == name[:LETTERS.get(name, 3)]), "")


def config(session, _):
    return [f"asemd version: {__version__}", f"Python version: {sys.version.split()[0]}", f"OS information: {platform.platform()}"]


def system(session, _):
    scene = session.scene
    lines = ["System information:", f"Units         = {scene.units}", f"Atom style    = {scene.atom_style}"]
    if scene.system is None:
        return [*lines, "Box has not yet been created"]
    s, box = scene.system, scene.system.box
    lines.append(f"Atoms     = {s.n:12d},  types = {s.counts['ntypes']:8d},  style = {scene.interactions.style_name('pair')}")
    for kind, atoms, _ in s.topology:
        if s.counts[f"n{kind}types"]:
            lines.append(f"{kind.capitalize() + 's':<9} = {len(atoms):12d},  types = {s.counts[f'n{kind}types']:8d},  "
                         f"style = {scene.interactions.style_name(kind)}")
    lines += [f"Dimensions = {scene.dimension}", f"Boundary = {' '.join(b if b[0] != b[1] else b[0] for b in box.boundary)}"]
    if box.is_lammps_frame:
        lines += [f"{a}lo, {a}hi = {lo:.8g}, {hi:.8g}" for a, lo, hi in zip("xyz", box.lo, box.hi)]
    return lines


def named(title: str, table: str):
    """A section that lists what has a name."""
    def section(session, _):
        entries = session.scene.groups if table == "groups" else getattr(session.scene, table)
        lines = [f"{title} information:"]
        for k, (name, item) in enumerate(entries.items()):
            if table == "groups":
                what = f"{name} ({'dynamic' if name in session.scene.dynamic_groups else 'static'})"
                lines.append(f"Group[{k:2d}]: {what}")
                continue
            group = f", group = {item.group}" if getattr(item, "group", None) else ""
            lines.append(f"{title}[{k:3d}]: {name}, style = {item.style}{group}" + (f", side = {item.side}" if table == "regions" else ""))
        return lines
    return section


def variables(session, _):
    lines = ["Variable information:"]
    for k, (name, v) in enumerate(session.variables.table.items()):
        words = list(islice(v.words, 20))
        lines.append(f"Variable[{k:3d}]: {name + ',':<16}  style = {v.style + ',':<10}  def = {' '.join(words)}")
    return lines


def styles(session, which):
    lines = []
    for category in STYLES if which == "all" else (which,):
        lines += [f"{category.capitalize()} styles:", " ".join(catalog.names(category)), ""]
    return lines


def timing(session, _):
    return [f"Total time information (MPI rank 0): {session.log.total_time().strip().removeprefix('Total wall time: ')}"]


def memory(session, _):
    return ["Memory allocation information:", f"Maximum resident set size: {driver.memory():.4g} Mbyte"]


def communication(session, _):
    return ["Communication information:", "One process, no ghost atoms", f"Nprocs = 1,   Nthreads = {session.scene.threads}"]


def accelerator(session, _):
    return ["Accelerator configuration:", f"Kernels compiled by numba, precision: {session.scene.precision}"]


def fft(session, _):
    return ["FFT information:", "No style of asemd uses FFTs"]


def coefficients(session, _):
    lines, scene = ["Coeff status information:"], session.scene
    if scene.system is None:
        return [*lines, "Box has not yet been created"]
    for kind in FORCE_FIELD:
        uses = scene.interactions.uses[kind]
        count = scene.system.counts["ntypes" if kind == "pair" else f"n{kind}types"]
        if not uses or not count:
            continue
        given = {key for use in uses for key in use.coeff}
        lines += ["", f"{kind.capitalize()} coeffs"]
        for i in range(1, count + 1):
            if kind != "pair":
                lines.append(f"{i:6d}: {'is' if i in given else 'is not'} set")
                continue
            for j in range(i, count + 1):
                mixed = (i, j) in given or {(i, i), (j, j)} <= given
                lines.append(f"{i:6d} {j:6d}: {'is' if mixed else 'is not'} set")
    return lines


SECTIONS = {"config": config, "system": system, "groups": named("Group", "groups"), "regions": named("Region", "regions"),
            "computes": named("Compute", "computes"), "dumps": named("Dump", "dumps"), "fixes": named("Fix", "fixes"),
            "variables": variables, "styles": styles, "time": timing, "memory": memory, "communication": communication,
            "accelerator": accelerator, "fft": fft, "coeffs": coefficients}
LETTERS = {"communication": 4, "computes": 4}      # others: 3
