"""One small scene for each force-field style: a LAMMPS script and the same in Python, both made from the style's example coefficients.

The pages of the styles show them, tests run both and compare the energies.
"""
from __future__ import annotations

import importlib
import inspect
import math
import re
from dataclasses import dataclass, field

import numpy as np

from asemd import style as registry
from asemd import units
from asemd.lammps import catalog
from asemd.style import Style
from asemd.testing.styles import example_words
from asemd.topology import ATOMS

CATEGORIES = ("bond", "angle", "dihedral", "improper", "pair")
HYBRIDS = ("hybrid", "hybrid/overlay", "hybrid/scaled", "hybrid/molecular")
PARTS = {"bond": ("harmonic", "morse"), "angle": ("harmonic", "cosine"), "dihedral": ("opls", "harmonic"), "improper": ("harmonic", "cvff"),
         "pair": ("lj/cut", "coul/cut")}       # sub-styles that the example of a hybrid has
# bonds of beads, whose example coefficients are meant in reduced units; pair styles are told by their cutoff
REDUCED = {("bond", name) for name in ("fene", "fene/expand", "fene/nm", "quartic", "bpm/spring", "nonlinear", "harmonic/shift",
                                       "harmonic/shift/cut")}
POSITIONS = {
    "angle": [(1.1, 0, 0), (0, 0, 0), (-0.2, 1.0, 0)],
    "dihedral": [(1.4, 0, -0.5), (0, 0, 0), (0, 0, 1.5), (0.7, 1.2, 2.0)],
    "improper": [(0.1, 0, 0.3), (1.0, 0.1, 0), (-0.6, 0.9, 0), (-0.5, -0.8, 0.1)],
}
SIZE = 15.0         # half the edge of the box of a script


@dataclass(frozen=True)
class Extra:
    """What a style needs beside itself.

    `lines` come before the style's commands, `keywords` are arguments of `ForceField`, `setup` Python lines that follow the atoms, `late`
    LAMMPS commands that follow the coefficients; with `chain` atoms that follow each other also have bonds of style zero.
    """

    lines: tuple[str, ...] = ()
    keywords: tuple[str, ...] = ()
    setup: tuple[str, ...] = ()
    late: tuple[str, ...] = ()
    chain: bool = False
    atom_style: str = "full"
    start: tuple[str, ...] = ()


ENERGY = units.factor("energy", "real")
LJ = f"({0.1 * ENERGY:.6g}, 3.0)"
CHARMM = {name: Extra(("special_bonds charmm", f"pair_style {pair}", "pair_coeff 1 1 0.1 3.0"),
                      (f'pair={{"{pair}": {{(1, 1): {LJ}}}}}', 'special_bonds="charmm"'),
                      ("molecule.set_initial_charges([0, 0, 0, 0])",), chain=True)
          for name, pair in (("charmm", "lj/charmm/coul/charmm 8.0 10.0"), ("charmmfsw", "lj/charmmfsw/coul/charmmfsh 8.0 10.0"))}
SPICA = Extra(("special_bonds lj/coul 0 0 1", "pair_style lj/spica 10.0", "pair_coeff 1 1 lj9_6 0.1 3.0"),
              (f'pair={{"lj/spica 10.0": {{(1, 1): "lj9_6 {0.1 * ENERGY:.6g} 3.0"}}}}',
               'special_bonds={"lj": (0, 0, 1), "coul": (0, 0, 1)}'),
              chain=True)
EXTRA = {
    ("bond", "special"): Extra(("special_bonds lj/coul 0 1 1", "pair_style lj/cut 10.0", "pair_coeff 1 1 0.1 3.0"),
                               (f'pair={{"lj/cut 10.0": {{(1, 1): {LJ}}}}}', 'special_bonds={"lj": (0, 1, 1), "coul": (0, 1, 1)}')),
    ("bond", "quartic"): Extra(("special_bonds lj/coul 1 1 1", "pair_style lj/cut 1.1225", "pair_coeff 1 1 1.0 1.0"),
                               ('pair={"lj/cut 1.1225": {(1, 1): (1.0, 1.0)}}', 'special_bonds={"lj": (1, 1, 1), "coul": (1, 1, 1)}')),
    ("bond", "bpm/spring"): Extra(("special_bonds lj/coul 1 1 1", "comm_modify vel yes", "pair_style lj/cut 1.1225",
                                   "pair_coeff 1 1 1.0 1.0"),
                                  ('pair={"lj/cut 1.1225": {(1, 1): (1.0, 1.0)}}', 'special_bonds={"lj": (1, 1, 1), "coul": (1, 1, 1)}'),
                                  start=("newton on off",)),
    ("angle", "dipole"): Extra(setup=("import numpy as np",
                                      'molecule.set_array("mu", np.array([[0.3, 0.4, 0], [0, 0, 0], [0, 0, 0]], float))'),
                               late=("set atom 1 dipole 0.3 0.4 0.0",), atom_style="hybrid full sphere dipole"),
    ("pair", "hybrid/molecular"): Extra(late=("set atom 1*2 mol 1", "set atom 3 mol 2")),
    ("angle", "spica"): SPICA, ("angle", "sdk"): SPICA,
    ("dihedral", "charmm"): CHARMM["charmm"], ("dihedral", "charmmfsw"): CHARMM["charmmfsw"],
}

# two atoms show what these do, in the units that their example is in; measuring one takes minutes on an idle machine
PAIRS = ("buck", "coul/cut", "lepton", "lj/charmm/coul/charmm", "lj/charmmfsw/coul/charmmfsh", "lj/cut", "lj/cut/coul/cut", "lj/sdk",
         "lj/spica", "lj96/cut", "morse", "soft", "table")


def every_style() -> list[tuple[str, str]]:
    """(category, name) of all force-field styles, those included that are made of others or of nothing.

    Of the pair styles those of `PAIRS` have a page; the others stand in the list of styles.
    """
    return [(c, n) for c in CATEGORIES for n in catalog.names(c)
            if c != "pair" or n in (*catalog.WRAPPERS, *HYBRIDS, *PAIRS)]


def text_of(category: str, name: str) -> str:
    """The docstring that describes a style: formula first for bonded styles."""
    if name in catalog.WRAPPERS or name in HYBRIDS:
        return inspect.getdoc(importlib.import_module(registry.module_of(category, name))) or ""
    found = registry.find(category, name)
    return found.doc or inspect.getdoc(importlib.import_module(registry.module_of(category, name))) or ""


@dataclass
class Scene:
    """The example of one style: everything that both scripts are written from."""

    category: str
    name: str
    unit: str                                           # units of the script
    positions: list[tuple[float, ...]]
    table: str = ""                                     # name of the table file that the style reads
    lines: list[str] = field(default_factory=list)      # *_style and *_coeff
    python: str = ""                                    # the style's argument of ForceField
    types: int = 1
    charges: tuple[float, ...] = ()
    size: float = SIZE

    @property
    def extra(self) -> Extra:
        return EXTRA.get((self.category, self.name), Extra())

    @property
    def remembers(self) -> bool:
        return bool(self.category == "bond" and self.name not in (*HYBRIDS, "none") and registry.find("bond", self.name).remembers)


def unit_of(s: Style) -> str:
    """``real``; ``lj`` for coefficients of order one, ``metal`` (eV and Angstrom) for formulas and files."""
    if s.name.startswith(("table", "lepton")):
        return "metal"
    if s.category == "pair":
        words = s.settings_example.split()
        return "lj" if words and float(words[0]) < 5.0 else "real"
    return "lj" if (s.category, s.name) in REDUCED else "real"


def coefficients(s: Style, words: list[str], unit: str) -> list[str]:
    """The words of a coefficient line in ASE's units."""
    settings = s.parse_settings(s.settings_example.split())
    dimension = {p.name: p.unit for p in s.coeff}
    values = s.parse_coeff(words, settings)
    for name, value in values.items():
        kind = dimension.get(name) or dimension.get(re.sub(r"\d+$", "1", name), "")
        if isinstance(value, float) and kind not in ("", "angle", "word"):
            values[name] = float(f"{value * units.factor(kind, unit):.6g}")
    return s.format_coeff(values)


def as_python(words: list[str]) -> str:
    """Coefficients as a tuple of numbers, or as text where some are words."""
    if len(words) <= 6 and all(re.fullmatch(r"[-+]?[\d.]+(e[-+]?\d+)?", w) for w in words):
        return f"({', '.join(words)}{',' * (len(words) == 1)})"
    return f'"{" ".join(words)}"'


def settings_of(s: Style) -> str:
    """Settings of the example; those of style zero and lepton, which only switch something off, are left out."""
    return "" if s.name in ("zero", "lepton") and s.category != "pair" else s.settings_example


def words_of(s: Style) -> tuple[list[str], str]:
    """Words of the example's coefficients, and the name of the table file they mention."""
    if any(p.unit == "path" for p in s.coeff):
        file = f"{s.category}.table"
        return [{"file": file, "KEYWORD": "EXAMPLE"}.get(w, w) for w in s.example.split()], file
    return s.example.split(), ""


def distance(s: Style) -> float:
    """A distance of two atoms at which something is to be seen."""
    if s.category == "bond":
        if s.name in ("special", "zero", "lepton", "table", "harmonic/restrain", "bpm/spring"):
            return {"special": 3.5}.get(s.name, 1.2)
        rest = s.rest_value(s.parse_coeff(s.example.split(), s.parse_settings(s.settings_example.split())))
        return round(1.05 * rest, 3) if math.isfinite(rest) else 1.2
    return {"soft": 0.5, "coul/cut": 3.0, "zero": 3.0}.get(s.name, 3.5 if unit_of(s) == "real" else 1.3)


def scene(category: str, name: str) -> Scene:
    """The example of a style."""
    if name == "none":
        positions = POSITIONS.get(category, [(0, 0, 0), (1.2, 0, 0)])
        return Scene(category, name, "real", positions, lines=[f"{category}_style none"])
    if name in HYBRIDS:
        return hybrid(category, name)
    s = registry.find(category, name)
    unit, (words, table) = unit_of(s), words_of(s)
    keys, head = ("1 1", "(1, 1)") if category == "pair" else ("1", "1")
    title = f"{name} {settings_of(s)}".rstrip()
    positions = POSITIONS.get(category) or [(0, 0, 0), (distance(s), 0, 0)]
    if category == "improper" and s.centre == 2:
        positions = [positions[1], positions[0], *positions[2:]]
    out = Scene(category, name, unit, positions, table)
    out.lines = [f"{category}_style {title}"] + [f"{category}_coeff {keys} {' '.join(line)}".rstrip() for line in coeff_lines(s, words)]
    in_ase = words if unit != "real" else coefficients(s, words, unit)
    out.python = f'{category}={{"{title}": {{{head}: {as_python(in_ase)}}}}}'
    if category == "pair" and getattr(s, "charged", False):
        out.charges = (0.4, -0.4)
    return out


def coeff_lines(s: Style, words: list[str]) -> list[list[str]]:
    """The lines of coefficients; cross terms have lines of their own."""
    if hasattr(s, "groups"):
        return s.coeff_lines(s.parse_coeff(words, {}))
    return [words]


def hybrid(category: str, name: str) -> Scene:
    """Two styles side by side, or two pair styles one upon the other."""
    a, b = (registry.find(category, n) for n in PARTS[category])
    words = [s.example.split() for s in (a, b)]
    if name in ("hybrid/scaled", "hybrid/molecular"):      # from scripts only
        numbers = ["0.7 ", "0.3 "] if name == "hybrid/scaled" else ["", ""]
        lines = [f"pair_style {name} {numbers[0]}lj/cut 8.0 {numbers[1]}coul/cut 10.0", "pair_coeff 1 1 lj/cut 0.1 3.0",
                 "pair_coeff 1 1 coul/cut"]
        return Scene(category, name, "real", [(0, 0, 0), (3.5, 0, 0), (0, 4.0, 0)], lines=lines, charges=(0.4, -0.4, 0.2))
    if category == "pair":
        same = name == "hybrid/overlay"
        words = [["0.1", "3.0"], []]
        lines = [f"pair_style {name} lj/cut 8.0 coul/cut 10.0", "pair_coeff 1 1 lj/cut 0.1 3.0",
                 f"pair_coeff {'1 1' if same else '1 2'} coul/cut"]
        python = f'pair={{"lj/cut 8.0": {{(1, 1): {LJ}}}, "coul/cut 10.0": {{(1, {1 if same else 2}): ()}}}}'
        if not same:
            lines.append("pair_coeff 2 2 lj/cut 0.2 3.2")
            python = (f'pair={{"lj/cut 8.0": {{(1, 1): {LJ}, (2, 2): ({0.2 * ENERGY:.6g}, 3.2)}}, "coul/cut 10.0": {{(1, 2): ()}}}}')
        return Scene(category, name, "real", [(0, 0, 0), (3.5, 0, 0)], lines=lines, python=python, charges=(0.4, -0.4),
                     types=1 if same else 2)
    lines = [f"{category}_style hybrid {a.name} {b.name}"]
    lines += [f"{category}_coeff {t} {s.name} {' '.join(w)}" for t, (s, w) in enumerate(zip((a, b), words), 1)]
    given = [f'"{s.name}": {{{t}: {as_python(coefficients(s, w, "real"))}}}' for t, (s, w) in enumerate(zip((a, b), words), 1)]
    positions = POSITIONS.get(category) or [(0, 0, 0), (1.2, 0, 0)]
    shifted = [(x, y, round(z + 6.0, 3)) for x, y, z in positions]
    return Scene(category, name, "real", [*positions, *shifted], lines=lines, python=f"{category}={{{', '.join(given)}}}", types=2)


# ---------------------------------------------------------------------------------------------- scripts ---

def items(s: Scene) -> list[tuple[int, ...]]:
    """Rows of atoms that interact; pairs need no list."""
    if s.category == "pair" or s.name == "none":
        return []
    k = ATOMS[s.category]
    return [tuple(range(first, first + k)) for first in range(0, len(s.positions), k)]


def number(value: float) -> str:
    """The shortest text that means the number."""
    return f"{value:g}" if float(f"{value:g}") == value else repr(float(value))


def lammps(s: Scene) -> str:
    """A complete script of the scene."""
    x, made = s.extra, items(s)
    room = [f"{s.category}/types {s.types}"] * bool(made) + ["bond/types 1"] * x.chain
    room += [f"extra/{s.category}/per/atom 1"] * bool(made) + ["extra/bond/per/atom 2"] * x.chain
    room += ["extra/special/per/atom 8"] * (x.chain or (s.category == "bond" and bool(made)))
    atom_types = s.types if s.category == "pair" else 1
    out = [f"units {s.unit}", f"atom_style {x.atom_style}", *x.start, f"region box block {' '.join([f'{-s.size:g} {s.size:g}'] * 3)}",
           f"create_box {atom_types} box {' '.join(room)}".rstrip(), "mass * 12.0"]
    for k, p in enumerate(s.positions):
        out.append(f"create_atoms {min(k + 1, atom_types)} single {' '.join(map(number, p))}")
    out += [f"set atom {k} charge {q:g}" for k, q in enumerate(s.charges, 1)]
    out += [*x.lines, *["bond_style zero", "bond_coeff 1"] * x.chain, *s.lines]
    for t, item in enumerate(made, 1):
        out.append(f"create_bonds single/{s.category} {min(t, s.types)} {' '.join(str(a + 1) for a in item)}")
    out += [f"create_bonds single/bond 1 {a + 1} {b + 1}" for item in made for a, b in zip(item, item[1:])] * x.chain
    out += x.late
    if s.remembers:
        out += ["run 0", "group second id 2", "displace_atoms second move 0.1 0 0"]
    return "\n".join([*out, *["thermo_modify norm no"] * (s.unit == "lj"), "run 0"])


TABLES = {      # Python lines that write the table file of an example: x, energy, and minus its derivative
    "bond": ("lo, hi, unit", "0.2, 3.0, 1.0"), "angle": ("lo, hi, unit", "0.0, 180.0, np.pi / 180"),
    "dihedral": ("lo, hi, unit", "-170.0, 180.0, np.pi / 180"), "pair": ("lo, hi, unit", "0.8, 2.5, 1.0"),
}


def table_code(category: str) -> list[str]:
    """Python lines that write the table file."""
    names, values = TABLES[category]
    return ["from pathlib import Path", "import numpy as np", "", f"{names} = {values}", "x = np.linspace(lo, hi, 36)",
            "energy, force = 5 * np.cos(unit * x - 0.4), 5 * unit * np.sin(unit * x - 0.4)",
            'rows = [f"{k} {a} {e} {f}" for k, (a, e, f) in enumerate(zip(x, energy, force), 1)]',
            f'Path("{category}.table").write_text("\\n".join(["EXAMPLE", f"N {{len(x)}}", "", *rows, ""]))', ""]


def python(s: Scene) -> str:
    """The scene as Python text that prints energy and forces."""
    if s.name in HYBRIDS and not s.python:
        script = lammps(s)
        return "\n".join(["from pathlib import Path", "import asemd", "", 'Path("in.example").write_text("""', script, '""")',
                          'molecule = asemd.read("in.example")',
                          "energy, forces = molecule.get_potential_energy(), molecule.get_forces()", 'print(f"{energy:.8g} eV")',
                          "print(forces.round(6))"])
    x, made, n = s.extra, items(s), len(s.positions)
    symbols = "C" * n if s.types == 1 or s.category != "pair" else "CO"
    symbols = f"C{n}" if set(symbols) == {"C"} else symbols
    kinds = []
    if made:
        kinds += [f"{s.category}s={[list(i) for i in made]}", f"{s.category}_types={list(range(1, s.types + 1))}"]
    if x.chain:
        kinds += [f"bonds={[[a, a + 1] for a in range(n - 1)]}", f"bond_types={[1] * (n - 1)}"]
    places = ", ".join("[" + ", ".join(f"{v:g}" for v in p) + "]" for p in s.positions)
    out = table_code(s.category) if s.table else []
    out += ["from asemd import Atoms, ForceField" + ", Topology" * bool(kinds), ""]
    atoms = [f'molecule = Atoms("{symbols}", positions=[{places}]']
    if kinds:
        atoms.append(f"                 topology=Topology({', '.join(kinds)})")
    out.append(",\n".join(atoms) + ")")
    if s.charges:
        out.append(f"molecule.set_initial_charges({list(s.charges)})")
    out += x.setup
    keywords = [k for k in (s.python, *x.keywords, 'bond={"zero": {1: ()}}' * x.chain) if k]
    call = ", ".join(keywords)
    if len(call) > 100:
        call = (",\n" + " " * 27).join(keywords)
    out.append(f"molecule.calc = ForceField({call})")
    if s.remembers:
        out += ["molecule.get_potential_energy()          # the length is remembered here", "molecule.positions[1, 0] += 0.1"]
    out += ["energy, forces = molecule.get_potential_energy(), molecule.get_forces()",
            'print(f"{energy:.8g} eV")' if s.unit != "lj" else 'print(f"{energy:.8g}")', "print(forces.round(6))"]
    return "\n".join(out)


def write_table(category: str, folder: str) -> None:
    """The table file of an example, as its Python code writes it."""
    if category == "pair":
        r = np.linspace(0.8, 2.5, 36)
        rows = "".join(f"{k} {a!r} {e!r} {f!r}\n" for k, (a, e, f) in enumerate(zip(r.tolist(), (5 * np.cos(r - 0.4)).tolist(),
                                                                                 (5 * np.sin(r - 0.4)).tolist()), 1))
        with open(f"{folder}/pair.table", "w") as file:
            file.write(f"# written by asemd\n\nEXAMPLE\nN 36\n\n{rows}")
    else:
        example_words(registry.find(category, "table"), folder)
