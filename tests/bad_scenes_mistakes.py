"""Mistakes of users, a second collection: separators, swapped words, wrong kinds of files, numbers that are far too large."""
from __future__ import annotations

import gzip

from bad_scenes import CASES, DATA, READ, RUN, SCRIPT, Case, edits, in_data, in_script, line, script_file

A4 = "4 1 1 0.0 6.5 6.2 5.3"
READ_X = ["read_data scene.data => read_data x.data"]

# ---- data files: how numbers are written
in_data("header words swapped", "4 atoms => atoms 4", "atoms 4")
in_data("header in the singular", "4 atoms => 4 atom", "4 atom")
in_data("types in the singular", "1 atom types => 1 atom type", "atom type")
in_data("thousands separator", "4 atoms => 4,000 atoms", "4,000")
in_data("commas between columns", f"{A4} => 4,1,1,0.0,6.5,6.2,5.3", "Atoms;1 value|comma")
in_data("decimal comma", f"{A4} => 4 1 1 0.0 6,5 6.2 5.3", "6,5;number")
in_data("unicode minus", "4 -0.1 -0.1 -0.1 => 4 \u22120.1 -0.1 -0.1", "ASCII", READ, "warning")
in_data("unit behind a number", f"{A4} => 4 1 1 0.0 6.5A 6.2 5.3", "6.5A;number")
in_data("header says another number twice", "4 atoms => 4 atoms\n5 atoms", "atoms;twice|5", ("scene.data", "5 atoms"))
in_data("bounds swapped", "0.0 10.0 xlo xhi => 0.0 10.0 xhi xlo", "xhi xlo")
in_data("tilt nan", "0.0 10.2 zlo zhi => 0.0 10.2 zlo zhi\n0.0 nan 0.0 xy xz yz", "nan", ("scene.data", "0.0 nan 0.0 xy xz yz"))
in_data("section in small letters", "Atoms # full => atoms # full", "atoms;Atoms")
in_data("line broken in two", f"{A4} => 4 1 1 0.0\n6.5 6.2 5.3", "4 values;7", ("scene.data", "4 1 1 0.0"))
in_data("Atoms twice", "Velocities => Atoms", "Atoms;twice")
in_data("velocities of an element", "1 0.1 0.0 0.0 => 1 C 0.1 0.0", "'C';number")
in_data("mass of a label", "1 1.5 => C 1.5", "'C'")
in_data("section of another style", "Velocities => Ellipsoids", "Ellipsoids")
in_data("section after the end", "1 1 4 3 2 1 => 1 1 4 3 2 1\n\nVelocities\n", "Velocities;twice", ("scene.data", 54))
in_data("negative number of bonds", "3 bonds => -3 bonds", "bonds;negative|-3")
in_data("number of types zero", "1 atom types => 0 atom types", "atom type", ())
in_data("more atoms than memory", "4 atoms => 400000000000 atoms", "400000000000|memory", ())
in_data("more types than memory", "1 bond types => 100000000000000 bond types", "memory", READ)

# ---- data files: not what they seem
for _name, _content, _words in (
        ("utf-16", DATA.encode("utf-16"), "x.data;text|UTF-16"), ("old Mac", DATA.replace("\n", "\r"), None),
        ("null bytes", DATA.replace("5.0 5.2", "5.0\0 5.2"), "x.data;\\\\x00|text|binary"),
        ("png", b"\x89PNG\r\n\x1a\n" + bytes(range(256)), "x.data;text"), ("xyz", "4\nmolecule\nC 0 0 0\nC 1 0 0\nC 2 0 0\nC 3 0 0\n", "x.data"),
        ("pdb", "HEADER    PROTEIN\nATOM      1  N   ALA A   1      11.104   6.134  -6.504\n", "x.data"), ("json", '{"atoms": 4}\n', "x.data"),
        ("html", "<!DOCTYPE html>\n<html><body>404</body></html>\n", "x.data"), ("script", SCRIPT, "x.data"),
        ("no last newline", DATA.rstrip(), None), ("trailing blanks", DATA.replace("\n", "   \n"), None),
        ("comments", DATA.replace("4 atoms", "4 atoms # four").replace("3 1 3 4", "3 1 3 4 # last"), None)):
    CASES.append(Case(f"file {_name}", "error" if _words else "fine", (_words or "").split(";") if _words else [], None, edits(READ_X),
                      files={"x.data": _content}))
CASES.append(Case("file gz", "fine", [], None, edits("read_data scene.data => read_data x.data.gz"), files={"x.data.gz": gzip.compress(DATA.encode())}))
CASES.append(Case("file gz cut", "error", ["x.data.gz"], ("in.scene", "read_data x.data.gz"),
                  edits("read_data scene.data => read_data x.data.gz"), files={"x.data.gz": gzip.compress(DATA.encode())[:200]}))

# ---- scripts: separators and spelling
line("thermo with commas", "thermo_style custom step, temp, pe", "step,")
line("dump with commas", "dump d all custom 1 x.dump id, type, x", "id,")
line("group with commas", "group g id 1,2,3", "1,2,3")
line("group with a dash", "group g id 1-3", "1-3")
line("equals sign", "timestep = 0.001", "timestep")
line("unit behind the timestep", "timestep 1.0fs", "1.0fs")
line("steps with exponent", "run 1e6", "1e6")
line("steps with k", "run 10k", "10k")
line("smart quotes", "print \u201chello there\u201d", "ASCII", expect="warning")
line("brackets around a variable", "print ${n}", "n", before="fix 1 all nve")
line("parenthesis around a variable", "variable n equal 3\nprint $(n)", "'n'|n", at=("in.scene", "print $(n)"))
line("percent variable", "run %n", "%n")
line("condition without quotes", "if 1 > 0 then print", "if|then|>")
line("two commands on a line", "timestep 0.001; run 5", "0.001;timestep|;")
line("C comment", "// nothing here", "//")
line("percent comment", "% nothing here", "%")
line("no-break space", "timestep\u00a00.001", "ASCII", expect="warning")
line("colon", "timestep: 0.001", "timestep:")
line("underscore for a dash", "pair-coeff 1 1 1.0 1.0", "pair_coeff")
line("plural", "groups g type 1", "group")
line("wrong suffix of a style", "fix 2 all nve/omp/gpu", "nve/omp/gpu")
line("style of another category", "fix 2 all temp", "temp")
line("bond style for a pair", "pair_style harmonic 2.5", "harmonic")
line("style that is missing here", "pair_style comb", "comb")

# ---- scripts: words in another order
line("dump file before the interval", "dump d all atom x.dump 100", "x.dump")
line("fix words swapped", "fix nve all 2", "'2'")
line("fix group last", "fix 2 nve all", "all|nve")
line("compute words swapped", "compute temp all t", "'t'")
line("velocity style first", "velocity create all 1.0 123", "create")
line("set without a style", "set charge 0.5", "charge")
line("displace without a group", "displace_atoms move 1 0 0", "move")
line("region name missing", "region block 0 1 0 1 0 1", "'0'|block")
line("nvt without damping", "fix 2 all nvt temp 1.0 1.0", "temp;3|damp|nvt")
line("group after the words", "group type 1 g", "'1'|type")
line("hybrid words without hybrid", "bond_coeff 1 harmonic 250.0 1.0", "harmonic|bond_coeff")
line("mass before type", "mass 12.0 1", "12.0")
line("special weights above one", "special_bonds lj 0 0 2", "2")
in_script("another pair style after the coefficients", "run 2 => pair_style lj/cut/coul/cut 2.0\nrun 2", "pair;1", RUN)
line("exclude a type that is not there", "neigh_modify exclude type 1 9", "9")
line("compute element", "compute p all pressure thermo_temp\nthermo_style custom step c_p[7]", "7", at=())
line("compute without elements", "compute p all pe\nthermo_style custom step c_p[1]", "p;no global vector")
line("thermo of a compute by atom", "compute p all ke/atom\nthermo_style custom step c_p", "p;no global scalar")
line("deform direction after its keywords", "fix d all deform 1 x erate 0.1 remap x y erate 0.1", "y must stand before remap")
line("compute in use", "compute p all pe\nthermo_style custom step c_p\nuncompute p", "there is no compute p", at=RUN)
line("fix replaced by another style", "fix 1 all nvt temp 1 1 1", "fix 1|ID 1|replac")
line("restart that is text", "clear\nread_restart scene.data", "scene.data", at=("in.scene", "read_restart scene.data"))
line("restart that is missing", "clear\nread_restart r.1000", "r.1000", at=("in.scene", "read_restart r.1000"))
line("data file misspelt", "clear\nread_data scene.dat", "scene.dat;did you mean scene.data", at=("in.scene", "read_data scene.dat"))
line("variable of a compute that is missing", "variable a equal c_none\nthermo_style custom step v_a", "none", at=())
line("variable with units", "variable t equal 300 K\nprint $t", "K", at=("in.scene", "print $t"))
line("atom variable printed", "variable a atom x\nprint ${a}", "atom", at=("in.scene", "print ${a}"))
line("atom variable in thermo", "variable a atom x\nthermo_style custom step v_a", "atom;a")
line("write_data without name", "write_data", "write_data")
line("mistake in an included file", "include x.inc", "bnd_coeff;bond_coeff", at=("x.inc", "bnd_coeff 1 1 1"), files={"x.inc": "# more\nbnd_coeff 1 1 1\n"})
line("group of too many", "".join(f"group g{i} type 1\n" for i in range(40)) + "print x", "group;32", at=())

# ---- scripts: far too large
line("replicate beyond memory", "replicate 100000 100000 100000", "replicate;memory|large|many")
line("create_atoms beyond memory", "create_atoms 1 random 900000000000 123 NULL", "create_atoms;memory|large|many")
line("lattice beyond memory", "lattice fcc 1e12\ncreate_atoms 1 box", "create_atoms;memory|large|many", at=("in.scene", "create_atoms 1 box"))
line("neighbor skin beyond memory", "neighbor 1e6 bin", "cutoff|skin|images", at=())
line("loop backwards", "variable a loop 5 3", "5|3")
line("id range huge", "group g id 1:1000000000000", "", expect="fine", at=())
line("power overflow", "print $(10^400)", "", expect="fine", at=())
in_script("table beyond memory", ["bond_style harmonic => bond_style table linear 1000000000000", "bond_coeff 1 250.0 1.0 => bond_coeff 1 t.table A"],
          "1000000000000;memory|large|many", (), files={"t.table": "A\nN 2\n\n1 0.5 1 1\n2 1.5 1 1\n"})
line("velocity beyond sense", "velocity all set 1e200 0 0\nrun 5", "atom|infinite|lost|NaN|nan|far", at=("in.scene", "run 5"))
in_script("femtoseconds in metal units", ["units lj => units metal", "timestep 0.001 => timestep 1.0", "run 2 => run 200"], "atom|bond|NaN|nan|lost|far", ("in.scene", "run 200"))

# ---- scripts: files
script_file("utf-16", SCRIPT.encode("utf-16"), "text|UTF-16")
script_file("old Mac", SCRIPT.replace("\n", "\r"), "", "fine")
script_file("data instead of a script", "4 atoms\n", "unknown command")
script_file("page of the web", "<!DOCTYPE html>\n", "unknown command")
script_file("continued comment", "# nothing &\nprnt a\nprint b\n", "", "fine")
script_file("blanks after the continuation", "print &  \n a\n", "", "fine")
script_file("comment after the continuation", "print a & # more\nprint b\n", "print|quoted|&|value")
script_file("only comments", "# nothing\n\n   # here\n", "", "fine")
in_data("digits of another alphabet", "3 1 3 4 => 3 1 3 \u0664", "\u0664;whole")
in_data("coordinate of another alphabet", f"{A4} => 4 1 1 0.0 6.5 6.2 \u0665.3", "\u0665.3;number")
line("digits of another alphabet", "timestep \u0663", "\u0663")
# ---- minimisers, limits of time, lists, plugins
line("hftn with the longest force", "min_style hftn\nmin_modify norm max\nminimize 0 1e-6 5 50", "norm max;hftn;two")
line("abcfire maybe", "min_modify abcfire maybe", "abcfire;maybe;yes or no")
line("line search of spins", "min_modify line spin_cubic\nminimize 0 1e-6 5 50", "spin_cubic;spins", at=("in.scene", "minimize 0 1e-6 5 50"))
line("limit of time in words", "timer timeout soon", "timer timeout;soon;seconds")
line("limit of time looked at never", "timer every 0", "timer every;positive")
line("plugin", "plugin load morse2plugin.so", "morse2plugin.so;--import")
line("include without first", "neigh_modify include all\ngroup g type 1\nneigh_modify include g", "include;atom_modify first")
line("collections without multi", "neigh_modify collection/type 1 1", "collection/type;multi")
