"""A short chain of four atoms that runs, and the mistakes a user can put into it."""
from __future__ import annotations

from dataclasses import dataclass, field

from four_beads import COUNTS, ITEMS, TYPES

SCRIPT = """\
units lj
atom_style full
boundary p p p
pair_style lj/cut 2.5
bond_style harmonic
angle_style harmonic
dihedral_style harmonic
improper_style harmonic
special_bonds lj/coul 0 0 0.5
read_data scene.data
pair_coeff 1 1 1.0 1.0
bond_coeff 1 250.0 1.0
angle_coeff 1 75.0 110.0
dihedral_coeff 1 1.0 1 3
improper_coeff 1 20.0 30.0
fix 1 all nve
timestep 0.001
thermo_style custom step temp pe ke etotal press
run 2
"""

DATA = f"""\
chain of four atoms

{COUNTS}1 impropers
1 atom types
{TYPES}1 improper types
0.0 10.0 xlo xhi
0.0 10.1 ylo yhi
0.0 10.2 zlo zhi

Masses

1 1.5

Atoms # full

1 1 1 0.0 4.0 5.0 5.0
2 1 1 0.0 5.0 5.2 5.0
3 1 1 0.0 5.5 6.1 5.1
4 1 1 0.0 6.5 6.2 5.3

Velocities

1 0.1 0.0 0.0
2 0.0 0.1 0.0
3 0.0 0.0 0.1
4 -0.1 -0.1 -0.1

{ITEMS}
Impropers

1 1 4 3 2 1
"""


@dataclass
class Case:
    """One scene: edits of the script and of the data, and what must be said where."""

    name: str
    expect: str                                  # error, warning or fine
    words: list[str]                             # all of them are in the message (regular expressions)
    at: tuple[str, str | int] | None             # file and line (its text or number) that the message names
    script: list[tuple[str, str]] = field(default_factory=list)
    data: list[tuple[str, str]] = field(default_factory=list)
    text: str | None = None                      # a whole script instead of edits
    files: dict[str, str | bytes] = field(default_factory=dict)
    arguments: list[str] = field(default_factory=list)


CASES: list[Case] = []


def edits(text) -> list[tuple[str, str]]:
    """``old => new`` pairs."""
    return [tuple(t.split(" => ")) for t in ([text] if isinstance(text, str) else text)]


def in_data(name, edit, words, at=None, expect="error", script=(), **more) -> None:
    """A faulty data file: the place is the new text unless `at` says otherwise."""
    pairs = edits(edit)
    place = ("scene.data", pairs[0][1].split("\n")[0]) if at is None else at
    CASES.append(Case(f"data {name}", expect, words.split(";") if words else [], place or None, edits(script), pairs, **more))


def in_script(name, edit, words, at=None, expect="error", data=(), **more) -> None:
    """A faulty script: the place is the last line of the new text unless `at` says otherwise."""
    pairs = edits(edit)
    place = ("in.scene", pairs[0][1].split("\n")[-1]) if at is None else at
    CASES.append(Case(f"script {name}", expect, words.split(";") if words else [], place or None, pairs, edits(data), **more))


def line(name, text, words, before="run 2", expect="error", **more) -> None:
    """A wrong line put in before another."""
    in_script(name, f"{before} => {text}\n{before}", words, more.pop("at", ("in.scene", text.split("\n")[-1])), expect, **more)


RUN = ("in.scene", "run 2")
READ = ("in.scene", "read_data scene.data")

# ---- data files: topology
in_data("bond of an atom with itself", "2 1 2 3\n3 1 => 2 1 2 2\n3 1", "twice|itself;2-2")
in_data("bond to atom 0", "3 1 3 4 => 3 1 3 0", "0;does not exist")
in_data("bond to negative atom", "3 1 3 4 => 3 1 3 -4", "-4;does not exist")
in_data("bond type 0", "3 1 3 4 => 3 0 3 4", "bond type 0;range")
in_data("bond type too large", "3 1 3 4 => 3 2 3 4", "bond type 2;range")
in_data("bond type negative", "3 1 3 4 => 3 -1 3 4", "bond type -1;range")
in_data("bond type text", "3 1 3 4 => 3 CC 3 4", "CC;type")
in_data("bond line short", "3 1 3 4 => 3 1 3", "Bonds;3 values;4")
in_data("bond line long", "3 1 3 4 => 3 1 3 4 5", "Bonds;5 values")
in_data("bond atom not whole", "3 1 3 4 => 3 1 3 4.5", "4.5;whole")
in_data("angle to unknown atom", "2 1 2 3 4\n => 2 1 2 3 7\n", "Angles;7;does not exist")
in_data("angle with an atom twice", "2 1 2 3 4\n => 2 1 2 3 2\n", "Angles;twice")
in_data("angle type", "2 1 2 3 4\n => 2 3 2 3 4\n", "angle type 3;range")
in_data("angle listed twice", "2 1 2 3 4\n => 2 1 3 2 1\n", "Angles;1-2-3;twice|duplicate", expect="warning")
in_data("dihedral with unknown atom", "1 1 1 2 3 4 => 1 1 1 2 3 5", "Dihedrals;5;does not exist")
in_data("dihedral with an atom twice", "1 1 1 2 3 4 => 1 1 1 2 3 1", "Dihedrals;twice")
in_data("dihedral type", "1 1 1 2 3 4 => 1 2 1 2 3 4", "dihedral type 2;range")
in_data("improper with unknown atom", "1 1 4 3 2 1 => 1 1 4 3 2 9", "Impropers;9;does not exist")
in_data("improper type", "1 1 4 3 2 1 => 1 0 4 3 2 1", "improper type 0;range")
in_data("improper with an atom twice", "1 1 4 3 2 1 => 1 1 4 3 4 1", "Impropers;twice")
in_data("too few bonds in the header", "3 bonds => 2 bonds", "Bonds;header says 2", ("scene.data", "3 1 3 4"))
in_data("too many bonds in the header", "3 bonds => 4 bonds", "Bonds;header says 4", ("scene.data", "3 1 3 4"))
in_data("too few angles in the header", "2 angles => 1 angles", "Angles;header says 1", ("scene.data", "2 1 2 3 4"))
in_data("no bonds line in the header", "3 bonds\n => ", "bonds;header", ("scene.data", "Bonds"))
in_data("no bond types line", "1 bond types\n => ", "bond type", ("scene.data", "1 1 1 2"))
in_data("bonds section missing", "\nBonds\n\n1 1 1 2\n2 1 2 3\n3 1 3 4\n => ", "3 bonds;Bonds", ("scene.data", "3 bonds"))

# ---- data files: atoms
in_data("atom id 0", "4 1 1 0.0 6.5 6.2 5.3 => 0 1 1 0.0 6.5 6.2 5.3", "ID 0")
in_data("atom id negative", "4 1 1 0.0 6.5 6.2 5.3 => -4 1 1 0.0 6.5 6.2 5.3", "ID -4")
in_data("atom id not whole", "4 1 1 0.0 6.5 6.2 5.3 => 4.5 1 1 0.0 6.5 6.2 5.3", "4.5;whole")
in_data("atom id huge", "4 1 1 0.0 6.5 6.2 5.3 => 99999999999999999999 1 1 0.0 6.5 6.2 5.3", "large|99999999999999999999")
in_data("atom type 0", "4 1 1 0.0 6.5 6.2 5.3 => 4 1 0 0.0 6.5 6.2 5.3", "atom type 0;range")
in_data("atom type too large", "4 1 1 0.0 6.5 6.2 5.3 => 4 1 2 0.0 6.5 6.2 5.3", "atom type 2;range")
in_data("atom type text", "4 1 1 0.0 6.5 6.2 5.3 => 4 1 C 0.0 6.5 6.2 5.3", "'C';type")
in_data("coordinate nan", "4 1 1 0.0 6.5 6.2 5.3 => 4 1 1 0.0 6.5 nan 5.3", "NaN;coordinate y;atom 4")
in_data("coordinate text", "4 1 1 0.0 6.5 6.2 5.3 => 4 1 1 0.0 6.5 6.2x 5.3", "6.2x;number")
in_data("coordinate fortran", "4 1 1 0.0 6.5 6.2 5.3 => 4 1 1 0.0 6.5 6.2d0 5.3", "6.2d0;number")
in_data("charge nan", "4 1 1 0.0 6.5 6.2 5.3 => 4 1 1 nan 6.5 6.2 5.3", "NaN;charge;atom 4")
in_data("too few columns", "4 1 1 0.0 6.5 6.2 5.3 => 4 1 1 0.0 6.5 6.2", "6 values;7|full")
in_data("too many columns", "4 1 1 0.0 6.5 6.2 5.3 => 4 1 1 0.0 6.5 6.2 5.3 8", "8 values;full")
in_data("two image flags", "4 1 1 0.0 6.5 6.2 5.3 => 4 1 1 0.0 6.5 6.2 5.3 0 0", "9 values;full")
in_data("image flag not whole", "4 1 1 0.0 6.5 6.2 5.3 => 4 1 1 0.0 6.5 6.2 5.3 0 0 0.5", "10 values|0.5")
in_data("atom far outside", "4 1 1 0.0 6.5 6.2 5.3 => 4 1 1 0.0 1e300 6.2 5.3", "atom 4|1e300")
in_data("atom outside a periodic box", "4 1 1 0.0 6.5 6.2 5.3 => 4 1 1 0.0 16.5 6.2 5.3", "", (), "fine")
in_data("style atomic", "Atoms # full => Atoms # atomic", "atomic;full", expect="warning")
in_data("columns of another style", ["1 1 1 0.0 4.0 => 1 1 1 4.0", "2 1 1 0.0 5.0 => 2 1 1 5.0", "3 1 1 0.0 5.5 => 3 1 1 5.5",
                                     "4 1 1 0.0 6.5 => 4 1 1 6.5"], "6 values;atom_style full", ("scene.data", "1 1 1 4.0 5.0 5.0"))
in_data("too few atoms in the header", "4 atoms => 3 atoms", "Atoms;3", ("scene.data", "4 1 1 0.0 6.5 6.2 5.3"))
in_data("too many atoms in the header", "4 atoms => 5 atoms", "Atoms;5", ("scene.data", "4 1 1 0.0 6.5 6.2 5.3"))
in_data("negative number of atoms", "4 atoms => -4 atoms", "atoms")
in_data("fractional number of atoms", "4 atoms => 4.5 atoms", "atoms;whole")
in_data("zero atoms in the header", "4 atoms => 0 atoms", "Atoms|atoms", ())
in_data("no atoms line", "4 atoms\n => ", 'no "atoms" line', ("scene.data", "Atoms # full"))
in_data("no Atoms section", "Atoms # full => Atomz # full", "Atomz;Atoms")
in_data("misspelt Velocities", "Velocities => Velocity", "Velocity;Velocities")
in_data("coincident atoms", ["4 1 1 0.0 6.5 6.2 5.3 => 4 1 1 0.0 4.0 5.0 5.0", "1 dihedrals => 0 dihedrals", "1 impropers => 0 impropers",
                             "1 1 1 2 3 4 => ", "1 1 4 3 2 1 => ", "Dihedrals\n\n\n\n => ", "Impropers\n\n\n => "],
        "1;4;same|coincid|apart|distance", RUN, script=["special_bonds lj/coul 0 0 0.5 => special_bonds lj/coul 0 0 1"])
in_data("bonded atoms coincide", "2 1 1 0.0 5.0 5.2 5.0 => 2 1 1 0.0 4.0 5.0 5.0", "1;2", RUN)
in_data("bond longer than half the box", "4 1 1 0.0 6.5 6.2 5.3 => 4 1 1 0.0 0.5 6.2 5.3", "half of periodic box;3-4", (), "warning")
in_data("image flags inconsistent", "4 1 1 0.0 6.5 6.2 5.3 => 4 1 1 0.0 6.5 6.2 5.3 0 2 0", "10 values", None)

# ---- data files: velocities
in_data("velocity nan", "4 -0.1 -0.1 -0.1 => 4 nan -0.1 -0.1", "velocity;NaN;atom 4")
in_data("velocity inf", "4 -0.1 -0.1 -0.1 => 4 -0.1 -inf -0.1", "velocity;infinite;atom 4")
in_data("velocity text", "4 -0.1 -0.1 -0.1 => 4 -0.1 x -0.1", "'x';number")
in_data("velocity of unknown atom", "4 -0.1 -0.1 -0.1 => 5 -0.1 -0.1 -0.1", "Velocities;5;does not exist")
in_data("velocity twice", "4 -0.1 -0.1 -0.1 => 3 -0.1 -0.1 -0.1", "Velocities;3;twice|lines")
in_data("velocity missing", "4 -0.1 -0.1 -0.1\n => ", "Velocities;3;4", ("scene.data", "3 0.0 0.0 0.1"))
in_data("velocity columns", "4 -0.1 -0.1 -0.1 => 4 -0.1 -0.1", "Velocities;3 values")
in_data("Velocities before Atoms", ["\nVelocities\n\n1 0.1 0.0 0.0\n2 0.0 0.1 0.0\n3 0.0 0.0 0.1\n4 -0.1 -0.1 -0.1\n => ",
                                    "Atoms # full => Velocities\n\n1 0.1 0.0 0.0\n2 0.0 0.1 0.0\n3 0.0 0.0 0.1\n4 -0.1 -0.1 -0.1\n\nAtoms # full"],
        "Velocities;Atoms", ("scene.data", "Velocities"))

# ---- data files: masses
in_data("mass zero", "1 1.5 => 1 0.0", "mass;type 1;positive")
in_data("mass negative", "1 1.5 => 1 -1.0", "mass;-1.0")
in_data("mass nan", "1 1.5 => 1 nan", "mass;nan")
in_data("mass text", "1 1.5 => 1 heavy", "mass;heavy")
in_data("mass twice", "1 1.5 => 1 1.5\n1 2.5", "1;twice|lines", ("scene.data", "1 2.5"))
in_data("mass of type 2", "1 1.5 => 2 1.5", "type 2;range")
in_data("mass without type", "1 1.5 => 1.5", "Masses|mass")
in_data("no masses", "Masses\n\n1 1.5\n\n => ", "mass;type 1", RUN)

# ---- data files: box
in_data("xlo above xhi", "0.0 10.0 xlo xhi => 10.0 0.0 xlo xhi", "xlo;xhi|x")
in_data("zero size", "0.0 10.1 ylo yhi => 10.0 10.0 ylo yhi", "ylo|y;")
in_data("bounds nan", "0.0 10.0 xlo xhi => 0.0 nan xlo xhi", "nan|xlo")
in_data("one bound", "0.0 10.0 xlo xhi => 10.0 xlo xhi", "xlo xhi;2;1")
in_data("bounds misspelt", "0.0 10.0 xlo xhi => 0.0 10.0 xlow xhi", "xlow")
in_data("tilt text", "0.0 10.2 zlo zhi => 0.0 10.2 zlo zhi\n0.0 z 0.0 xy xz yz", "z", ("scene.data", "0.0 z 0.0 xy xz yz"))
in_data("tilt of two", "0.0 10.2 zlo zhi => 0.0 10.2 zlo zhi\n0.0 0.0 xy xz yz", "3;2", ("scene.data", "0.0 0.0 xy xz yz"))
in_data("no box", "0.0 10.0 xlo xhi\n0.0 10.1 ylo yhi\n0.0 10.2 zlo zhi\n => ", "no line xlo xhi", ("scene.data", "4 atoms"), expect="warning")
in_data("unknown header", "1 atom types => 1 atom kinds", "atom kinds")

# ---- data files: sections
in_data("unknown section", "Impropers\n => Impropper\n", "Impropper;Impropers")
in_data("section twice", "Impropers\n\n1 1 4 3 2 1\n => Bonds\n\n1 1 4 3\n", "Bonds;twice", ("scene.data", 50))
in_data("coefficients of type 2", "Atoms # full => Bond Coeffs\n\n2 250.0 1.0\n\nAtoms # full", "bond type 2;range", ("scene.data", "2 250.0 1.0"))
in_data("coefficient nan", "Atoms # full => Bond Coeffs\n\n1 nan 1.0\n\nAtoms # full", "nan", ("scene.data", "1 nan 1.0"))
in_data("coefficient text", "Atoms # full => Bond Coeffs\n\n1 2x 1.0\n\nAtoms # full", "2x", ("scene.data", "1 2x 1.0"))
in_data("coefficients too few", "Atoms # full => Bond Coeffs\n\n1 250.0\n\nAtoms # full", "K r0;1", ("scene.data", "1 250.0"))
in_data("coefficients too many", "Atoms # full => Angle Coeffs\n\n1 75.0 110.0 2.0\n\nAtoms # full", "K theta0;3", ("scene.data", "1 75.0 110.0 2.0"))
in_data("coefficients without style", "Atoms # full => Bond Coeffs\n\n1 250.0 1.0\n\nAtoms # full", "bond_style;Bond Coeffs",
        ("scene.data", "Bond Coeffs"), script=["bond_style harmonic\n => "])
in_data("cut in a line", "1 1 4 3 2 1 => 1 1 4 3", "Impropers;4 values")
in_data("cut in a section", "3 1 3 4\n\nAngles\n\n1 1 1 2 3\n2 1 2 3 4\n\nDihedrals\n\n1 1 1 2 3 4\n\nImpropers\n\n1 1 4 3 2 1\n => ",
        "3 bonds|Bonds.*2|angles;truncated", ())
in_data("cut before a section", "Impropers\n\n1 1 4 3 2 1\n => ", "1 impropers;truncated", ("scene.data", "1 impropers"))
in_data("cut in the header", DATA[DATA.index("1 atom types"):] + " => ", "Atoms|atom types", ())
in_data("header after section", ["1 improper types\n => ", "Impropers\n => 1 improper types\n\nImpropers\n"], "improper", ())
in_data("no blank lines", ["Bonds\n\n => Bonds\n", "\nAngles\n\n => Angles\n"], "", (), "fine")
in_data("atom style without bonds", "4 atoms => 4 atoms", "bonds;atomic", ("scene.data", "Bonds"), script=["atom_style full => atom_style atomic"])
in_data("label unknown", ["Masses => Atom Type Labels\n\n1 C\n\nMasses", "4 1 1 0.0 6.5 6.2 5.3 => 4 1 N 0.0 6.5 6.2 5.3"], "'N'",
        ("scene.data", "4 1 N 0.0 6.5 6.2 5.3"))
in_data("label twice", "Masses => Bond Type Labels\n\n1 C\n1 D\n\nMasses", "twice", ("scene.data", "1 D"))
in_data("label with digit", "Masses => Bond Type Labels\n\n1 1C\n\nMasses", "1C", ("scene.data", "1 1C"))
in_data("label missing", ["1 bond types => 2 bond types", "Masses => Bond Type Labels\n\n1 C\n\nMasses"], "Bond Type Labels;2", ("scene.data", "Bond Type Labels"))

# ---- data files: files
READ_X = ["read_data scene.data => read_data x.data"]
AT_X = ("in.scene", "read_data x.data")
for _name, _content, _words in (("missing", None, "x.data;not found|No such"), ("empty", "", "x.data"), ("blank", "\n\n\n", "x.data"),
                                ("binary", bytes(range(256)) * 8, "x.data;text"), ("latin-1", DATA.replace("chain", "ch\xe4in").encode("latin-1"), None),
                                ("windows", DATA.replace("\n", "\r\n"), None), ("tabs", DATA.replace(" ", "\t"), None),
                                ("BOM", "\ufeff" + DATA, None), ("prose", "Dear reader,\n\nthis is not a data file at all.\n", "section|header|This|this"),
                                ("a dump", "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n4\n", "ITEM|header|section"), ("long comment", DATA + "#" + "x" * 100000, None)):
    CASES.append(Case(f"file {_name}", "error" if _words else "fine", (_words or "").split(";") if _words else [], None, edits(READ_X),
                      files={} if _content is None else {"x.data": _content}))
CASES.append(Case("file gz that is not", "error", ["x.data.gz", "gzip"], ("in.scene", "read_data x.data.gz"),
                  edits("read_data scene.data => read_data x.data.gz"), files={"x.data.gz": DATA}))
in_script("data is a folder", "read_data scene.data => read_data .", "directory")

# ---- scripts: words
line("unknown command", "pairstyle lj/cut 2.5", "pairstyle;pair_style")
line("command in capitals", "Run 5", "Run")
line("unknown fix style", "fix 2 all nvee", "nvee;nve")
line("unknown compute style", "compute 2 all tmp", "tmp;temp")
line("unknown dump style", "dump 2 all atm 10 x.dump", "atm;atom")
line("unknown region style", "region 2 blok 0 1 0 1 0 1", "blok;block")
line("unknown min style", "min_style cgg", "cgg;cg")
in_script("unknown pair style", "pair_style lj/cut 2.5 => pair_style lj/cutt 2.5", "lj/cutt;lj/cut")
in_script("unknown bond style", "bond_style harmonic => bond_style harmonik", "harmonik;harmonic")
in_script("unknown angle style", "angle_style harmonic => angle_style harmonik", "harmonik;harmonic")
in_script("unknown dihedral style", "dihedral_style harmonic => dihedral_style harmonik", "harmonik;harmonic")
in_script("unknown improper style", "improper_style harmonic => improper_style harmonik", "harmonik;harmonic")
in_script("unknown atom style", "atom_style full => atom_style fulll", "fulll;full")
in_script("unknown units", "units lj => units ljj", "ljj")
in_script("unknown units text", "units lj => units", "units", ("in.scene", "units"))
in_script("boundary nonsense", "boundary p p p => boundary p p q", "q")
in_script("boundary half periodic", "boundary p p p => boundary p p pf", "pf|both")
in_script("boundary two", "boundary p p p => boundary p p", "boundary;3")
in_script("thermo keyword", "thermo_style custom step temp pe ke etotal press => thermo_style custom step tmp", "tmp;temp")
in_script("thermo nothing", "thermo_style custom step temp pe ke etotal press => thermo_style custom", "thermo_style", ("in.scene", "thermo_style custom"))
in_script("thermo style", "thermo_style custom step temp pe ke etotal press => thermo_style customm step", "customm;custom")
line("thermo compute unknown", "thermo_style custom step c_nothing", "nothing", at=())
line("thermo fix unknown", "thermo_style custom step f_nothing", "nothing", at=())
line("thermo variable unknown", "thermo_style custom step v_nothing", "nothing")
line("thermo variable not a number", "variable t string 5\nthermo_style custom step v_t", "style equal;string")
line("thermo variable not a vector", "variable t equal 5\nthermo_style custom step v_t[1]", "style vector;equal")
line("thermo negative", "thermo -1", "-1")
line("thermo text", "thermo often", "often")
line("thermo_modify keyword", "thermo_modify lst ignore", "lst;lost")
line("thermo_modify value", "thermo_modify lost perhaps", "perhaps")
line("thermo_modify without value", "thermo_modify lost", "lost")

# ---- scripts: variables, quotes, files
line("undefined variable in braces", "print ${nothing}", "nothing")
line("undefined variable of one letter", "print $x", "x")
line("undefined variable in a formula", "variable a equal v_nothing+1\nprint $a", "nothing", at=("in.scene", "print $a"))
line("variable that needs itself", "variable a equal v_b\nvariable b equal v_a\nprint $a", "circ|itself|recurs|each other", at=("in.scene", "print $a"))
line("variable of itself", "variable a equal v_a+1\nprint $a", "circ|itself|recurs", at=("in.scene", "print $a"))
line("division by zero", "variable a equal 1/0\nprint $a", "division by 0|modulo 0", at=("in.scene", "print $a"))
line("division by zero at once", "print $(1/0)", "division by 0|modulo 0")
line("modulo zero", "print $(1%0)", "division by 0|modulo 0")
line("root of a negative", "print $(sqrt(-1))", "sqrt")
line("log of zero", "print $(ln(0))", "ln|log")
line("asin of 2", "print $(asin(2))", "asin")
line("power of a negative", "print $((-1)^0.5)", "pow|\\^|negative")
line("overflow is infinite", "print $(exp(1000))", "", expect="fine", at=())
line("unbalanced parenthesis", "variable a equal (1+2\nprint $a", "\\)|parenthes", at=("in.scene", "print $a"))
line("too many parentheses", "variable a equal 1+2)\nprint $a", "\\)|parenthes", at=("in.scene", "print $a"))
line("unknown function", "variable a equal sinn(1)\nprint $a", "sinn;sin", at=("in.scene", "print $a"))
line("wrong number of arguments", "variable a equal sin(1,2)\nprint $a", "sin", at=("in.scene", "print $a"))
line("formula without end", "variable a equal 1+\nprint $a", "1\\+|end|formula", at=("in.scene", "print $a"))
line("formula nonsense", "variable a equal 3$4", "4")
line("unclosed dollar parenthesis", "print $(1+2", "\\)")
line("unclosed brace", "print ${a", "}")
line("dollar alone", "print a$", "\\$")
line("unmatched quote", 'print "hello', "quote", at=("in.scene", 'print "hello'))
line("unterminated triple quote", 'print """hello', "quote", at=("in.scene", 19))
line("unknown variable style", "variable a eqal 3", "eqal;equal")
line("variable without value", "variable a equal", "variable")
line("variable nothing", "variable", "variable")
line("variable name", "variable a-b equal 1", "a-b")
line("loop negative", "variable a loop -3", "-3")
line("loop text", "variable a loop x", "x")
line("index empty", "variable a index", "variable|index")
line("next of an unknown variable", "next nothing", "nothing")
line("next of an equal variable", "variable a equal 1\nnext a", "a")
line("include missing", "include nothing.inc", "nothing.inc")
line("include itself", "include in.scene", "nest|itself|deep", before="units lj", at=())
line("include without file", "include", "include")
line("jump to a missing label", "jump SELF nowhere", "nowhere", at=())
line("jump to a missing file", "jump nothing.in", "nothing.in")
line("label without name", "label", "label")
line("if without then", 'if "1 > 0" print', "then|if")
line("if nonsense", 'if "1 > " then "print a"', "if|1 >")
line("log to a missing folder", "log nowhere/x.log", "nowhere/x.log")
line("log is a folder", "log .", "directory")
line("write_data to a missing folder", "write_data nowhere/x.data", "nowhere/x.data")
line("print to a missing folder", "print a file nowhere/x", "nowhere/x")
line("shell cd nowhere", "shell cd nowhere", "nowhere")

# ---- scripts: order
line("units after the box", "units real", "units;box")
line("atom_style after the box", "atom_style bond", "atom_style;box")
line("boundary after the box", "boundary f f f", "boundary;box")
line("dimension after the box", "dimension 2", "dimension;box")
line("two boxes", "region r block 0 1 0 1 0 1\ncreate_box 1 r", "create_box;box", at=("in.scene", "create_box 1 r"))
line("read_data twice", "read_data scene.data add", "read_data", at=("in.scene", "read_data scene.data add"))
in_script("read_data without add", "run 2 => read_data ./scene.data\nrun 2", "add|defined", ("in.scene", "read_data ./scene.data"))
for _command in ("run 5", "minimize 0 0 10 10", "bond_coeff 1 1.0 1.0", "pair_coeff 1 1 1.5 1.0", "angle_coeff 1 1.0 1.0", "mass 1 1.0", "velocity all create 1.0 1",
                 "set type 1 charge 0", "create_atoms 1 box", "replicate 2 2 2", "write_data x.data", "fix 9 all nve",
                 "group g type 1", "dump 9 all atom 1 x.dump", "displace_atoms all move 1 0 0", "delete_atoms group all", "dihedral_coeff 1 1.5 1 3"):
    line(f"before the box {_command.split()[0]}", _command, f"{_command.split()[0]};box", before="read_data scene.data", at=("in.scene", _command))
in_script("coefficients before the style", ["bond_style harmonic\n => ", "bond_coeff 1 250.0 1.0 => bond_coeff 1 250.0 1.0"], "bond_style;bond_coeff",
          ("in.scene", "bond_coeff 1 250.0 1.0"))
in_script("pair coefficients before the style", ["pair_style lj/cut 2.5\n => ", "pair_coeff 1 1 1.0 1.0 => pair_coeff 1 1 1.0 1.0"], "pair_style;pair_coeff",
          ("in.scene", "pair_coeff 1 1 1.0 1.0"))

# ---- scripts: force field
for _kind, _good in (("pair", "pair_coeff 1 1 1.0 1.0"), ("bond", "bond_coeff 1 250.0 1.0"), ("angle", "angle_coeff 1 75.0 110.0"),
                     ("dihedral", "dihedral_coeff 1 1.0 1 3"), ("improper", "improper_coeff 1 20.0 30.0")):
    in_script(f"no {_kind} coefficients", f"{_good}\n => ", f"{_kind};1", RUN)
    in_script(f"no {_kind} coefficients at all", f"{_good} => {_kind}_coeff", f"{_kind}_coeff")
    in_script(f"only the {_kind} type", f"{_good} => {_good[:_good.index(' 1') + 2 + 2 * (_kind == 'pair')]}", f"{_kind}_coeff")
    in_script(f"too few {_kind} coefficients", f"{_good} => {_good.rpartition(' ')[0]}", f"{_kind}_coeff")
    in_script(f"too many {_kind} coefficients", f"{_good} => {_good} 7 8", f"{_kind}_coeff")
    in_script(f"{_kind} coefficient text", f"{_good} => {_good.rpartition(' ')[0]} abc", f"{_kind}_coeff;abc")
    in_script(f"{_kind} coefficient nan", f"{_good} => {_good.rpartition(' ')[0]} nan", f"{_kind}_coeff;nan")
    in_script(f"{_kind} coefficient inf", f"{_good} => {_good.rpartition(' ')[0]} inf", f"{_kind}_coeff;inf")
    in_script(f"{_kind} coefficients of type 0", f"{_good} => {_good.replace('_coeff 1', '_coeff 0', 1)}", "0;range")
    in_script(f"{_kind} coefficients of type 5", f"{_good} => {_good.replace('_coeff 1', '_coeff 5', 1)}", "5;range")
    in_script(f"{_kind} coefficients of 3*", f"{_good} => {_good.replace('_coeff 1', '_coeff 3*', 1)}", "3\\*;range")
    in_script(f"{_kind} coefficients of a label", f"{_good} => {_good.replace('_coeff 1', '_coeff CT', 1)}", "CT")
    if _kind != "pair":
        in_script(f"no {_kind} style", [f"{_kind}_style harmonic\n => ", f"{_good}\n => "], f"{_kind.capitalize()}s are defined", (), "warning")
    in_script(f"{_kind} style without a name", f"{_kind}_style {'lj/cut 2.5' if _kind == 'pair' else 'harmonic'} => {_kind}_style", f"{_kind}_style",
              ("in.scene", f"{_kind}_style"))
in_script("pair style without cutoff", "pair_style lj/cut 2.5 => pair_style lj/cut", "lj/cut", ("in.scene", "pair_style lj/cut"))
in_script("cutoff text", "pair_style lj/cut 2.5 => pair_style lj/cut abc", "abc")
in_script("cutoff nan", "pair_style lj/cut 2.5 => pair_style lj/cut nan", "nan")
in_script("cutoff huge", "pair_style lj/cut 2.5 => pair_style lj/cut 1e5", "cutoff|images", RUN)
in_script("cutoff negative of a pair", "pair_coeff 1 1 1.0 1.0 => pair_coeff 1 1 1.0 1.0 -2.0", "-2")
in_script("dihedral sign", "dihedral_coeff 1 1.0 1 3 => dihedral_coeff 1 1.0 2 3", "d|sign|1")
in_script("dihedral n not whole", "dihedral_coeff 1 1.0 1 3 => dihedral_coeff 1 1.0 1 3.5", "3.5")
in_script("dihedral n negative", "dihedral_coeff 1 1.0 1 3 => dihedral_coeff 1 1.0 1 -3", "-3|n")
in_script("charmm weight", ["dihedral_style harmonic => dihedral_style charmm", "dihedral_coeff 1 1.0 1 3 => dihedral_coeff 1 1.0 3 180 2.5"], "2.5|weight",
          ("in.scene", "dihedral_coeff 1 1.0 3 180 2.5"))
in_script("fene beyond R0", ["bond_style harmonic => bond_style fene", "bond_coeff 1 250.0 1.0 => bond_coeff 1 30.0 0.9 1.0 1.0",
                             "lj/coul 0 0 0.5 => lj/coul 0 1 1"], "1;2|2;3|fene|FENE", RUN)
in_script("fene R0 zero", ["bond_style harmonic => bond_style fene", "bond_coeff 1 250.0 1.0 => bond_coeff 1 30.0 0.0 1.0 1.0"], "R0",
          ("in.scene", "bond_coeff 1 30.0 0.0 1.0 1.0"))
in_script("fene during the run", ["bond_style harmonic => bond_style fene", "bond_coeff 1 250.0 1.0 => bond_coeff 1 30.0 1.5 1.0 1.0",
                                  "lj/coul 0 0 0.5 => lj/coul 0 1 1", "run 2 => velocity all set 0 0 30\nvelocity all ramp vx -50 50 x 4 7\nrun 500"],
          "bond|fene|FENE", ("in.scene", "run 500"))
in_script("hybrid without styles", "bond_style harmonic => bond_style hybrid", "hybrid", ("in.scene", "bond_style hybrid"))
in_script("hybrid coefficients without a style", ["bond_style harmonic => bond_style hybrid harmonic", "bond_coeff 1 250.0 1.0 => bond_coeff 1 250.0 1.0"], "harmonic|hybrid",
          ("in.scene", "bond_coeff 1 250.0 1.0"))
in_script("hybrid of hybrid", "bond_style harmonic => bond_style hybrid hybrid harmonic", "hybrid")
in_script("hybrid pair without styles", "pair_style lj/cut 2.5 => pair_style hybrid", "hybrid", ("in.scene", "pair_style hybrid"))
in_script("hybrid pair not of it", ["pair_style lj/cut 2.5 => pair_style hybrid lj/cut 2.5", "pair_coeff 1 1 1.0 1.0 => pair_coeff 1 1 coul/cut"], "coul/cut",
          ("in.scene", "pair_coeff 1 1 coul/cut"))
in_script("charges missing", ["atom_style full => atom_style molecular", "pair_style lj/cut 2.5 => pair_style lj/cut/coul/cut 2.5",
                              "pair_coeff 1 1 1.0 1.0\n => pair_coeff 1 1 1.0 1.0\n"], "charge|q", RUN,
          data=["# full => # molecular", "1 1 1 0.0 => 1 1 1", "2 1 1 0.0 => 2 1 1", "3 1 1 0.0 => 3 1 1", "4 1 1 0.0 => 4 1 1"])
in_script("no pair style", ["pair_style lj/cut 2.5\n => ", "pair_coeff 1 1 1.0 1.0\n => "], "", (), expect="fine")
in_script("special_bonds nonsense", "special_bonds lj/coul 0 0 0.5 => special_bonds lj/coul 0 0", "special_bonds")
in_script("special_bonds range", "special_bonds lj/coul 0 0 0.5 => special_bonds lj/coul 0 0 1.5", "1.5")
in_script("special_bonds keyword", "special_bonds lj/coul 0 0 0.5 => special_bonds lj/cool 0 0 0.5", "lj/cool")
line("pair_modify keyword", "pair_modify shft yes", "shft;shift")
line("pair_modify value", "pair_modify shift perhaps", "perhaps")
line("pair_modify mix", "pair_modify mix mean", "mean")
line("dielectric zero", "dielectric 0", "dielectric")
line("kspace", "kspace_style pppm 1e-4", "kspace_style pppm needs", at=("in.scene", "run 2"))

# ---- scripts: tables
TABLE = "# table\n\nA\nN 5\n\n1 0.5 3.0 2.0\n2 0.75 2.0 2.0\n3 1.0 1.0 2.0\n4 1.25 0.5 2.0\n5 1.5 0.1 2.0\n"
for _name, _words, _coeff, _table, _n in (("keyword missing", "B", "t.table B", TABLE, "100"), ("file missing", "no.table", "no.table A", TABLE, "100"),
                                          ("too short", "5|t.table|A", "t.table A", TABLE.replace("5 1.5 0.1 2.0\n", ""), "100"),
                                          ("not a number", "x", "t.table A", TABLE.replace("0.75", "x"), "100"),
                                          ("without N", "N", "t.table A", TABLE.replace("N 5\n", "FP 0 0\n"), "100"),
                                          ("N of 1", "N|1", "t.table A", TABLE, "1"), ("keyword not said", "bond_coeff", "t.table", TABLE, "100"),
                                          ("not increasing", "increas|order|r", "t.table A", TABLE.replace("0.75", "0.45"), "100")):
    in_script(f"table {_name}", ["bond_style harmonic => bond_style table linear " + _n, f"bond_coeff 1 250.0 1.0 => bond_coeff 1 {_coeff}"], _words, (),
              files={"t.table": _table})
in_script("table left by a bond", ["bond_style harmonic => bond_style table linear 100", "bond_coeff 1 250.0 1.0 => bond_coeff 1 t.table A"],
          "bond|table|r", RUN, files={"t.table": TABLE.replace("0.5 3", "0.1 3").replace("1.25", "0.9").replace("1.5 0", "0.95 0").replace("1.0 1.0", "0.8 1.0")})
in_script("pair table shorter than the cutoff", ["pair_style lj/cut 2.5 => pair_style table linear 100", "pair_coeff 1 1 1.0 1.0 => pair_coeff 1 1 t.table A 5.0"],
          "cut|1.5", ("in.scene", "pair_coeff 1 1 t.table A 5.0"), files={"t.table": TABLE})
in_script("pair table style", "pair_style lj/cut 2.5 => pair_style table cubic 100", "cubic")
in_script("pair table inner", ["lj/coul 0 0 0.5 => lj/coul 1 1 1", "pair_style lj/cut 2.5 => pair_style table linear 100", "pair_coeff 1 1 1.0 1.0 => pair_coeff 1 1 t.table A 1.5"],
          "inner|table|below|less;1;2", RUN, files={"t.table": TABLE.replace("0.5 3.0", "1.1 3.0").replace("0.75", "1.2").replace("3 1.0", "3 1.25").replace("1.25 0.5", "1.3 0.5")},
          data=["2 1 1 0.0 5.0 5.2 5.0 => 2 1 1 0.0 4.1 5.2 5.0"])

# ---- scripts: groups, regions, atoms
line("group unknown", "fix 2 nobody nve", "nobody")
line("group of an unknown region", "group g region nowhere", "nowhere")
line("group style", "group g typ 1", "typ")
line("group type", "group g type x", "x")
line("group union of unknown", "group g union all nobody", "nobody")
line("group without members", "group g id", "group")
line("region unknown in create_atoms", "create_atoms 1 region nowhere", "nowhere|lattice")
line("region block reversed", "region r block 1 0 0 1 0 1", "block|lo|1")
line("region block short", "region r block 0 1 0 1", "block|region")
line("region sphere negative", "region r sphere 0 0 0 -1", "radius|-1")
line("region nan", "region r block 0 nan 0 1 0 1", "nan")
line("region keyword", "region r block 0 1 0 1 0 1 sid in", "sid;side")
line("region twice", "region r block 0 1 0 1 0 1\nregion r block 0 1 0 1 0 1", "r", at=("in.scene", 20))
line("union of unknown", "region r union 2 a b", "a")
line("create_atoms without lattice", "create_atoms 1 box", "lattice")
line("create_atoms type", "create_atoms 9 single 1 1 1", "9")
line("create_atoms outside", "create_atoms 1 single 100 100 100", "", expect="fine", at=())
line("create_atoms nonsense", "create_atoms 1 nonsense", "nonsense")
line("lattice nonsense", "lattice fccc 1.0", "fccc;fcc")
line("lattice scale zero", "lattice fcc 0", "lattice")
line("mass type", "mass 5 1.0", "5")
line("mass zero", "mass 1 0", "mass")
line("mass negative", "mass 1 -1", "-1")
line("mass nan", "mass 1 nan", "nan")
line("mass short", "mass 1", "mass")
line("set nothing", "set", "set")
line("set unknown keyword", "set type 1 chrge 1", "chrge;charge")
line("set unknown type", "set type 1 type 9", "9")
line("set charge nan", "set type 1 charge nan", "nan")
line("set no atoms", "set atom 77 charge 1", "", expect="fine", at=())
line("delete_atoms nonsense", "delete_atoms grup all", "grup;group")
line("delete_atoms unknown", "delete_atoms group nobody", "nobody")
line("displace nonsense", "displace_atoms all mve 1 0 0", "mve;move")
line("displace short", "displace_atoms all move 1 0", "displace_atoms")
line("replicate 0", "replicate 0 1 1", "0")
line("replicate half", "replicate 1.5 1 1", "1.5")
line("velocity negative temperature", "velocity all create -1.0 4928", "-1")
line("velocity seed 0", "velocity all create 1.0 0", "seed|0")
line("velocity seed negative", "velocity all create 1.0 -5", "seed|-5")
line("velocity short", "velocity all create 1.0", "velocity")
line("velocity keyword", "velocity all create 1.0 1 dst gaussian", "dst;dist")
line("velocity style", "velocity all creat 1.0 1", "creat;create")
line("velocity nan", "velocity all create nan 1", "nan")
line("velocity group", "velocity nobody zero linear", "nobody")
line("velocity scale at rest", "velocity all set 0 0 0\nvelocity all scale 1.0", "temperature|zero|0|scale")

# ---- scripts: fixes, computes, dumps
line("fix without style", "fix 2 all", "fix")
line("fix nothing", "fix", "fix")
line("fix nve with words", "fix 2 all nve fast", "nve|fast")
line("langevin damp 0", "fix 2 all langevin 1.0 1.0 0.0 123", "damp|period|0")
line("langevin seed 0", "fix 2 all langevin 1.0 1.0 1.0 0", "seed")
line("langevin short", "fix 2 all langevin 1.0 1.0 1.0", "langevin")
line("langevin negative", "fix 2 all langevin -1.0 1.0 1.0 123", "temperature|-1")
line("langevin text", "fix 2 all langevin a 1.0 1.0 123", "'a'|a")
line("langevin keyword", "fix 2 all langevin 1.0 1.0 1.0 123 zer yes", "zer;zero")
line("langevin gjf word", "fix 2 all langevin 1.0 1.0 1.0 123 gjf vful", "vful;vfull")
line("langevin gjf after nve", "fix 2 all langevin 1.0 1.0 1.0 123 gjf vfull", "before;nve", at=RUN)
line("langevin gjf with nvt", "unfix 1\nfix 2 all langevin 1.0 1.0 1.0 123 gjf vfull\nfix 1 all nvt temp 1 1 1", "nvt;nve", at=RUN)
line("baoab short", "fix 2 all baoab 1.0 1.0 1.0", "baoab;seed")
line("nvt damp 0", "fix 2 all nvt temp 1.0 1.0 0.0", "damp|Tdamp|0")
line("nvt without temp", "fix 2 all nvt", "nvt|temp")
line("nvt negative", "fix 2 all nvt temp -1.0 1.0 1.0", "temperature|-1")
line("temp/rescale every 0", "fix 2 all temp/rescale 0 1.0 1.0 0.1 1.0", "0")
line("berendsen damp 0", "fix 2 all temp/berendsen 1.0 1.0 0.0", "damp|period|0")
line("nve/limit 0", "fix 2 all nve/limit -0.1", "limit|-0.1")
line("setforce text", "fix 2 all setforce a b c", "'a'|a")
line("setforce variable", "fix 2 all setforce v_nothing 0 0", "nothing", at=())
line("addforce short", "fix 2 all addforce 1 1", "addforce")
line("addforce nan", "fix 2 all addforce nan 0 0", "nan")
line("enforce2d in 3d", "fix 2 all enforce2d", "enforce2d", at=RUN)
line("momentum 0", "fix 2 all momentum 0 linear 1 1 1", "0")
line("unfix unknown", "unfix 9", "9")
line("fix_modify unknown", "fix_modify 9 energy yes", "9")
line("uncompute unknown", "uncompute nothing", "nothing")
line("compute twice", "compute c all pe\ncompute c all pe", "c", at=("in.scene", 20))
line("compute group", "compute c nobody pe", "nobody|all")
line("compute short", "compute c all", "compute")
line("compute pressure without temperature", "compute c all pressure nothing", "nothing")
line("compute name", "compute a-b all pe", "a-b")
line("dump to a missing folder", "dump d all atom 1 nowhere/x.dump", "nowhere/x.dump", at=())
line("dump every 0", "dump d all atom 0 x.dump", "0")
line("dump every text", "dump d all atom often x.dump", "often")
line("dump attribute", "dump d all custom 1 x.dump id typ", "typ;type")
line("dump custom nothing", "dump d all custom 1 x.dump", "dump")
line("dump compute unknown", "dump d all custom 1 x.dump id c_nothing", "nothing", at=())
line("dump group", "dump d nobody atom 1 x.dump", "nobody")
line("dump twice", "dump d all atom 1 x.dump\ndump d all atom 1 y.dump", "d", at=("in.scene", 20))
line("dump_modify unknown", "dump_modify d sort id", "d")
line("dump_modify keyword", "dump d all atom 1 x.dump\ndump_modify d srt id", "srt;sort", at=("in.scene", "dump_modify d srt id"))
line("undump unknown", "undump d", "d")

# ---- scripts: running
in_script("run negative", "run 2 => run -5", "-5")
in_script("run fraction", "run 2 => run 1.5", "1.5")
in_script("run text", "run 2 => run fast", "fast")
in_script("run nothing", "run 2 => run", "run", ("in.scene", "run"))
in_script("run keyword", "run 2 => run 2 pree no", "pree;pre")
in_script("run upto past", "run 2 => reset_timestep 100\nrun 50 upto", "upto|50|100")
in_script("run huge", "run 2 => run 99999999999999999999", "99999999999999999999|large")
line("timestep 0", "timestep 0", "", expect="fine", at=())
line("time runs backwards", "timestep -0.001", "", expect="fine", at=())
line("timestep nan", "timestep nan", "nan")
line("timestep text", "timestep small", "small")
line("neighbor negative", "neighbor -1 bin", "-1")
line("neighbor style", "neighbor 0.3 bins", "bins;bin")
line("neighbor nan", "neighbor nan bin", "nan")
line("neigh_modify every 0", "neigh_modify every 0", "0|every")
line("neigh_modify keyword", "neigh_modify evry 1", "evry;every")
line("neigh_modify delay", "neigh_modify every 3 delay 10", "delay;every", at=())
line("processors nonsense", "processors a b c", "a", before="read_data scene.data")
line("newton nonsense", "newton perhaps", "perhaps", before="read_data scene.data")
line("comm_modify", "comm_modify cutof 3", "cutof;cutoff")
line("minimize short", "minimize 1e-4 1e-6 10", "minimize")
line("minimize tolerance", "minimize -1 1e-6 10 10", "-1")
line("minimize text", "minimize a 1e-6 10 10", "a")
line("minimize iterations", "minimize 1e-4 1e-6 -10 10", "-10")
line("reset_timestep negative", "reset_timestep -1", "-1")
line("huge time step", "timestep 1000\nrun 50", "atom|nan|lost|far|NaN|bond", at=("in.scene", "run 50"))
in_script("atoms lost", ["boundary p p p => boundary f f f", "run 2 => velocity all set 300 0 0\nrun 400"], "lost|Lost;[1-4]", ("in.scene", "run 400"))
in_script("two integrators", "run 2 => fix 2 all nve\nrun 2", "integrat", ("in.scene", "fix 2 all nve"), "warning")
in_script("no integrator", "fix 1 all nve\n => ", "integration", (), "warning")
in_script("2d with periodic z missing", ["units lj => units lj\ndimension 2", "boundary p p p => boundary p p f"], "period|2d|2", ())
in_script("2d with z motion", ["units lj => units lj\ndimension 2", "run 2 => run 2"], "2d|zlo|z", (), )

# ---- scripts: files and the command line
def script_file(name, text, words, expect="error", at=None, **more) -> None:
    CASES.append(Case(f"script file {name}", expect, words.split(";") if words else [], at, text=text, **more))


script_file("empty", "", "", "fine")
script_file("without box", "run 5\n", "run;box", at=("in.scene", "run 5"))
script_file("windows", SCRIPT.replace("\n", "\r\n"), "", "fine")
script_file("tabs", SCRIPT.replace(" ", "\t"), "", "fine")
script_file("BOM", "\ufeff" + SCRIPT, "", "fine")
script_file("binary", "\0\1\2\3" * 100 + "\n", "text|unknown", )
script_file("long line", "print a" + " #" + "x" * 100000 + "\n", "", "fine")
script_file("without last newline", SCRIPT.rstrip(), "", "fine")
script_file("ends in continuation", "print a &", "", "fine")
for _name, _arguments, _words in (("threads 0", ["--threads", "0"], "threads"), ("threads -3", ["--threads", "-3"], "threads"),
                                  ("threads text", ["--threads", "many"], "threads"), ("precision", ["--precision", "half"], "half"),
                                  ("variable without value", ["-var", "x"], "-var"), ("unknown option", ["--thread", "2"], "--thread"),
                                  ("two scripts", ["in.other"], "in.other"), ("cap negative", ["--steps-cap", "-1"], "cap"),
                                  ("unknown switch", ["-vra", "x", "1"], "-v"), ("log in a missing folder", ["--log", "nowhere/x.log"], "nowhere/x.log")):
    CASES.append(Case(f"command line {_name}", "error", [_words], None, arguments=_arguments))

# ---- more words than a command takes, and values LAMMPS refuses
line("include with two files", "include a b", "include")
line("neighbor with three words", "neighbor 0.3 bin x", "neighbor")
line("thermo with two words", "thermo 10 x", "thermo")
line("unfix with two words", "unfix 1 x", "unfix")
line("group of a region and more", "region r block 0 1 0 1 0 1\ngroup g region r x", "region", at=("in.scene", "group g region r x"))
line("group subtract of one", "group g subtract all", "subtract")
line("create_atoms of all types", "create_atoms * single 1 1 1 units box", "\\*")
line("comm_modify cutoff text", "comm_modify cutoff far", "far")
line("comm_modify mode", "comm_modify mode sngle", "sngle")
line("atom_modify sort negative", "atom_modify sort -1 0", "-1")
line("fix name", "fix \u00e9 all nve", "\u00e9")
line("set molecule fraction", "set atom 1 mol 1.5", "1.5")
line("run every without commands", "run 4 every 2", "every")
line("cylinder without radius", "region r cylinder z 0 0 0 0 1", "radius")
line("endless loop variable", "variable a loop 1 99999999999999999999 pad", "large")
line("long loop variable", "variable a loop 1000000000000", "", expect="fine", at=())
in_script("dihedral n huge", "dihedral_coeff 1 1.0 1 3 => dihedral_coeff 1 1.0 1 99999999999", "large")
in_script("sigma negative", "pair_coeff 1 1 1.0 1.0 => pair_coeff 1 1 1.0 -1.0", "sigma;negative;1 1", (), "warning")
in_script("r0 negative", "bond_coeff 1 250.0 1.0 => bond_coeff 1 250.0 -1.0", "r0;negative", (), "warning")

# ---- commands on boxes, molecules and snapshots
line("change_box without change", "change_box all", "change_box")
line("change_box volume first", "change_box all x volume", "volume")
line("change_box tilt of an upright box", "change_box all xy final 1", "triclinic")
line("molecule without file", "molecule m", "molecule")
line("molecule of a missing file", "molecule m nowhere.mol", "nowhere.mol")
line("create_atoms of a missing molecule", "create_atoms 0 single 1 1 1 mol nobody 5", "nobody")
line("read_dump of a missing file", "read_dump nowhere 10 x y z", "nowhere")
line("rerun without dump", "rerun nowhere x y z", "dump")
line("write_dump of a missing group", "write_dump nobody atom f", "nobody")
line("reset_atoms of what", "reset_atoms mols", "mol")
line("respa without factors", "run_style respa 3 2", "factors")
line("respa with an inner force alone", "run_style respa 2 2 inner 1 4 5", "inner and outer")
line("respa with cutoffs in the wrong order", "run_style respa 2 2 inner 1 5 4 outer 2", "cutoffs")
line("respa with hybrid levels for one style", "run_style respa 2 2 hybrid 1 2", "pair_style hybrid")
line("respa in the wrong order", "run_style respa 2 2 bond 2 angle 1", "angle")
line("partition that is not there", "partition yes 2 run 5", "1 to 1")

# ---- files: labels, meshes, pictures
line("label of two words", "labelmap atom 1 'C 1'", "one word")
line("labelmap clear of something", "labelmap clear atom", "labelmap clear")
line("labelmap write without file", "labelmap write", "labelmap write")
line("group of an unknown label", "labelmap atom 1 C\ngroup g type Q", "Q;label")
line("mesh without file", "create_atoms 1 mesh nowhere.stl units box", "nowhere.stl")
line("mesh in lattice units", "create_atoms 1 mesh nowhere.stl", "units box")
line("mesh mode", "create_atoms 1 mesh nowhere.stl units box meshmode even 1", "even;bisect")
line("overlap on a lattice", "lattice sc 1\ncreate_atoms 1 box overlap 1", "random")
line("variable for a single atom", "variable v equal 1\ncreate_atoms 1 single 1 1 1 var v set x xx", "var")
line("picture seen along nothing", "dump d all image 1 p.*.ppm type type up 0 0 0", "up")
line("colour map upside down", "dump d all image 1 p.*.ppm x type\ndump_modify d amap 2 1 cf 0 2 min red max blue", "bound")
line("whole numbers with digits", "thermo_modify format int %g", "whole number")
line("write_data of unknown types", "write_data f types names", "names;labels")
