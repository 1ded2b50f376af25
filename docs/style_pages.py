"""A page for every force-field style, written by Sphinx at build time (see conf.py) from the registry and the numbers in docs/measured.

Nothing on the pages is written by hand: text and formula are the docstring of the style's file, units come from its parameters, examples
from `style_scenes`, curves from `style_plots`, and the numbers below an example are what it prints.
"""
from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import style_plots
import style_scenes
import style_speed
from generate import markdown, words

from asemd import style as registry
from asemd import units
from asemd.lammps import catalog
from asemd.style import Parameter, Style

HERE = Path(__file__).resolve().parent
FOLDER = "styles"
SYMBOLS = {
    "real": dict(energy="kcal/mol", distance="Å", time="fs", charge="e", temperature="K", force="kcal/mol/Å", velocity="Å/fs"),
    "metal": dict(energy="eV", distance="Å", time="ps", charge="e", temperature="K", force="eV/Å", velocity="Å/ps"),
    "ase": dict(energy="eV", distance="Å", time="Å √(u/eV)", charge="e", temperature="K", force="eV/Å", velocity="√(eV/u)"),
}
PLAIN = {"": "number", "integer": "whole number", "word": "word", "path": "file"}
POWERS = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
BREAKS = {"off": "A broken bond gets type 0, and the pair interaction that it replaces comes back at once.",
          "removed": "A broken bond is taken out, and from the next step on its atoms are an ordinary pair."}
REMEMBERS = {"atoms": "Each bond remembers the length it has when the first run begins.",
             "bonds": "Each bond remembers the length it has when its force is first computed."}


def docname(category: str, name: str) -> str:
    return f"{category}-{re.sub(r'[^0-9a-z]', '-', name)}"


def unit_text(dimension: str, system: str) -> str:
    """``energy/distance^2`` in the symbols of a unit style: ``kcal/mol/Å²``."""
    if dimension in PLAIN:
        return "-"
    if dimension == "angle":
        return "degrees"
    factors = re.findall(r"([*/]?)([a-z_]+|1)(?:\^(-?\d+))?", dimension)
    out = ""
    for sign, word, power in factors:
        symbol = SYMBOLS[system].get(word, word)
        power = "" if power in ("", "1") else power.translate(POWERS)
        out += {"*": " ", "/": "/", "": ""}[sign] + (f"({symbol})" if power and "/" in symbol else symbol) + power
    return out


def coefficient_table(parameters: tuple[Parameter, ...]) -> list[str]:
    """Names and units of settings or coefficients."""
    out = ["| name | dimension | `units real` | `units metal` | ASE | 1 in `real` is in ASE |", "|---|---|---|---|---|---|"]
    for p in parameters:
        what = PLAIN.get(p.unit, p.unit) + (", may be left out" if p.optional else "")
        if p.unit in PLAIN:
            columns = ["", "", "", ""]
        elif p.unit == "angle":
            columns = ["degrees"] * 3 + ["1"]
        else:
            columns = [*(unit_text(p.unit, s) for s in ("real", "metal", "ase")), f"{units.factor(p.unit, 'real'):.6g}"]
        out.append(f"| `{p.name}` | {' | '.join([what, *columns])} |")
    return [*out, ""]


def outputs() -> dict[str, str]:
    """What the Python examples print; all of them run in one process without the compiler, which is quick for a few atoms."""
    code = ("import contextlib, io, json, os, sys, warnings\nwarnings.simplefilter('ignore')\njobs, said = json.load(sys.stdin), {}\n"
            "for name, text in jobs.items():\n    out = io.StringIO()\n    with contextlib.redirect_stdout(out):\n        exec(text, {})\n"
            "    said[name] = out.getvalue()\nprint(json.dumps(said))")
    jobs = {f"{c} {n}": style_scenes.python(style_scenes.scene(c, n)) for c, n in style_scenes.every_style()}
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": str(HERE.parent)}
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([sys.executable, "-c", code], input=json.dumps(jobs), env=environment, cwd=folder, capture_output=True,
                              text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"an example of the pages of the styles fails:\n{done.stderr[-2000:]}")
    return json.loads(done.stdout)


def syntax(s: Style) -> list[str]:
    """The two commands with the names of their words."""
    out = [f"{s.category}_style {s.name} {words(s.settings)}".rstrip()]
    head = f"{s.category}_coeff {'i j' if s.category == 'pair' else 'type'}"
    if hasattr(s, "groups"):
        out += [f"{head} {mark} {words(group)}".replace("  ", " ") for mark, group in s.groups.items()]
    elif s.coeff:
        out.append(f"{head} {words(s.coeff)}{' ...' if hasattr(s, 'term') else ''}")
    return ["```lammps", *out, "```", ""]


def domain(s: Style) -> list[str]:
    """Where the style is defined, and what happens elsewhere."""
    if s.category == "pair":
        inside = f"{s.domain[0].upper()}{s.domain[1:]}: an error." if s.domain else "Any distance between 0 and the cutoff."
        return [f"{inside} Beyond its cutoff a pair has no interaction. A force that is not finite stops the run, with the ids of the "
                "atoms where they are known.", ""]
    if not s.domain:
        return ["Defined for every geometry: nothing is clamped. Where only the direction of a force is undefined (atoms on a line, or at "
                "one place with a finite slope) forces are finite and sum to zero; where energy or force is infinite the run stops and the "
                "error names the atoms.", ""]
    text = f"Outside its domain ({s.domain}) the run stops; no value is clamped. The error names the atoms"
    message = style_plots.outside(s)
    return [f"{text}:", "", "```text", message, "```", ""] if message else [f"{text}.", ""]


def agreement(category: str, name: str, known: dict) -> list[str]:
    """The measured difference from LAMMPS."""
    entry = known["styles"].get(f"{category} {name}")
    if entry is None:
        return []
    machine = known["machine"]
    out = ["## Agreement with LAMMPS", "",
           f"Largest relative difference over {known['geometries']} random geometries (`units {entry['units']}`, the coefficients of the "
           f"example): energy {entry['energy']:.1e}, force {entry['force']:.1e}{' with `-compat lammps`' * ('gradient' in entry)}."]
    if "gradient" in entry:
        force = entry["gradient"]["force"]
        out += ["", "LAMMPS's force is not minus the gradient of its energy. Here it is by default; LAMMPS's force is then up to "
                f"{100 * force:.2g} % of the largest force away"
                + (" (for these coefficients and geometries the two agree)" if force < 1e-9 else "")
                + ". `asemd run --compat lammps` and `compat=\"lammps\"` give LAMMPS's."]
    return [*out, "", f"Measured by `docs/measure.py` on {machine['cpu']} with LAMMPS {machine['lammps']}, numpy {machine['numpy']}, numba "
            f"{machine['numba']}.", ""]


def notes(s: Style) -> list[str]:
    """What else there is to know about a bonded style."""
    out = []
    if s.breaks:
        out.append(BREAKS[s.breaks])
    if s.remembers:
        out.append(REMEMBERS[s.remembers])
    if s.weight_14:
        out.append(f"`{s.weight_14}` scales the pair interaction of atoms 1 and 4, which the pair style in use must know.")
    if s.equilibrium and s.category in ("bond", "angle") and s.function:
        out.append(f"`{s.equilibrium}` is the rest {'length' if s.category == 'bond' else 'angle'} that constraints take.")
    if s.category != "pair" and s.function:
        out.append("Second derivatives are exact (`get_hessian`)." if s.d2 else "No second derivatives of its own: "
                   "`get_hessian(numerical=True)` takes differences of the first ones.")
    for reason in dict.fromkeys(s.xfail.values()):
        checks = ", ".join(f"`{c}`" for c, r in s.xfail.items() if r == reason)
        out.append(f"`check_style` leaves out {checks}: {reason}.")
    return ["## Notes", "", *(f"- {n}" for n in out), ""] if out else []


def page(category: str, name: str, known: dict, said: dict[str, str], figure: str = "", speed: dict | None = None, plot: str = "") -> str:
    """The page of one style; `figure` is the file of its curves, `speed` what was measured, `plot` the file of error against time."""
    text = markdown(style_scenes.text_of(category, name))
    out = [f"# {category} {name}", "", text, ""]
    plain = name in catalog.WRAPPERS or name in style_scenes.HYBRIDS
    s = None if plain else registry.find(category, name)
    if s and s.see and s.see not in text:
        out += [f"Source: {s.see}.", ""]
    if s:
        out += ["## Commands", "", *syntax(s)]
        if s.settings:
            out += ["Settings:", "", *coefficient_table(s.settings)]
        if s.coeff:
            out += ["Coefficients:", "", *coefficient_table(s.coeff)]
        if any(p.unit == "angle" for p in (*s.settings, *s.coeff)):
            out += ["Angles are degrees in text and radians in the function: a constant with the dimension of an energy belongs to "
                    "radians.", ""]
    if figure:
        out += ["## Energy and force", "", "```{raw} html", f":file: {figure}", "```", "", caption(s), ""]
    if s and s.function:
        out += ["## Domain", "", *domain(s)]
    scene = style_scenes.scene(category, name)
    out += ["## LAMMPS", "", "```lammps", style_scenes.lammps(scene), "```", ""]
    same = "The same in eV and Angstrom:" if scene.unit != "lj" else "The same in reduced units, whose numbers pass unchanged:"
    out += ["## Python", "", same, "", "```python", style_scenes.python(scene), "```", "", "```text",
            said[f"{category} {name}"].rstrip(), "```", ""]
    if s:
        out += agreement(category, name, known) + (style_speed.section(category, name, speed, plot) if speed else []) + notes(s)
    return re.sub(r"\n{3,}", "\n\n", "\n".join(out)).rstrip() + "\n"


def caption(s: Style) -> str:
    """What the curves show."""
    unit = style_scenes.unit_of(s)
    where = {"lj": "reduced units", "real": "`units real`", "metal": "`units metal`"}[unit]
    if s.category == "pair":
        charges = style_scenes.scene("pair", s.name).charges
        force = "-dE/dr" + (f", charges {charges[0]:g} and {charges[1]:g} e" if charges else "")
    else:
        force = "minus the derivative by the coordinate"
        if s.coordinates[0] != "gamma" and s.category != "bond":
            force += "; arms of length 1" + (", angles of 110 degrees between them" if style_plots.path_of(s)[0] is style_plots.torsion_path
                                             else "")
        if s.remembers:
            force += "; remembered length 0.9"
    return f"Curves for the coefficients shown, in {where}. Force: {force}."


def write(folder: Path) -> list[str]:
    """Write all pages and their curves into a folder; returns the names of the pages in their order."""
    known, speed = (json.loads((HERE / "measured" / name).read_text()) for name in ("agreement.json", "speed.json"))
    said = outputs()
    folder.mkdir(exist_ok=True)
    names = []
    for category, name in style_scenes.every_style():
        title, figure, plot = docname(category, name), "", ""
        s = None if name in catalog.WRAPPERS else registry.find(category, name)
        if s and style_plots.has_curves(s):
            figure = f"{title}.svg"
            save(folder / figure, style_plots.svg(s))
        entry = speed["styles"].get(f"{category} {name}")
        if entry:
            plot = f"{title}-speed.svg"
            save(folder / plot, style_speed.svg(category, name, entry))
        save(folder / f"{title}.md", page(category, name, known, said, figure, speed, plot))
        names.append(title)
    for path in folder.iterdir():
        if path.stem.removesuffix("-speed") not in names:
            path.unlink()
    return names


def save(path: Path, text: str) -> None:
    """Write a file unless it is the same already, so that Sphinx reads again only what changed."""
    if not path.exists() or path.read_text() != text:
        path.write_text(text)


def link(source: str) -> str:
    """The overview page with a link below each title of a style, and the pages in its table of contents."""
    names = [docname(c, n) for c, n in style_scenes.every_style()]

    def below(match):
        name = docname(match[1], match[2])
        return f"{match[0]}\n[Units, curves, examples, agreement, error against time]({FOLDER}/{name}.md)\n" if name in names else match[0]
    text = re.sub(r"^### (\w+) (\S+)\n", below, source, flags=re.M)
    toctree = ["", "```{toctree}", ":hidden:", ":maxdepth: 1", "", *(f"{FOLDER}/{n}" for n in names), "```", ""]
    return text + "\n".join(toctree)
