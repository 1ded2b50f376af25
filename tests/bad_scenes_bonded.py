"""Mistakes in commands and computes of bonded interactions; importing this module adds them to `bad_scenes.CASES`."""
from __future__ import annotations

from bad_scenes import CASES, RUN, line

START = len(CASES)

line("delete_bonds without style", "delete_bonds all", "delete_bonds;2 values")
line("delete_bonds unknown style", "delete_bonds all bonds", "bonds;did you mean bond")
line("delete_bonds unknown group", "delete_bonds frozn multi", "frozn;group")
line("delete_bonds type out of range", "delete_bonds all bond 2", "bond type;range 1 to 1")
line("delete_bonds unknown keyword", "delete_bonds all multi remov", "remov;did you mean remove")
line("delete_bonds stats that removes", "delete_bonds all stats remove", "stats;remove")
line("create_bonds unknown style", "create_bonds singl/bond 1 1 3", "singl/bond;did you mean single/bond")
line("create_bonds atom that is not there", "create_bonds single/bond 1 1 9", "ID 9")
line("create_bonds one atom twice", "create_bonds single/angle 1 1 2 1", "different;1 2 1")
line("create_bonds type out of range", "create_bonds single/dihedral 2 1 2 3 4", "dihedral type;range 1 to 1")
line("create_bonds special without value", "create_bonds single/bond 1 1 3 special", "special;1 value")
line("create_bonds distances the wrong way round", "create_bonds many all all 1 2.0 1.0", "rmin;rmax")
line("create_bonds between bonded pairs that interact", "special_bonds lj/coul 1 1 1\ncreate_bonds many all all 1 0.5 1.0",
     "special_bonds;0")
line("create_bonds too few words", "create_bonds many all all 1", "many;5 values")
line("write_coeff without file", "write_coeff", "write_coeff;1 value")
line("write_coeff into a folder that is not there", "write_coeff nowhere/coeff", "cannot write;nowhere")
line("compute bond without hybrid", "compute e all bond", "compute bond;hybrid;ebond")
line("compute bond/local without keyword", "compute d all bond/local", "bond/local;at least one")
line("compute bond/local eng", "compute d all bond/local eng", "eng;did you mean engpot|engtrans|engvib|engrot")
line("compute bond/local b1 of a style without it", "compute d all bond/local b1\ndump d all local 1 f c_d", "harmonic;b1", at=RUN)
line("compute bond/local formula without set", "variable v equal 1\ncompute d all bond/local v_v", "v_v;set dist")
line("compute angle/local set without formula", "variable v internal 1\ncompute d all angle/local theta set theta v", "set;v_name")
line("compute dihedral/local energy", "compute d all dihedral/local eng", "eng;unknown")
line("compute improper/local formula", "compute d all improper/local v_x", "v_x;unknown")
line("compute property/local of two kinds", "compute d all property/local batom1 aatom2", "batom1;aatom2;together")
line("compute property/local fifth atom", "compute d all property/local datom5", "datom5;unknown")
line("compute property/local radius of points", "compute d all property/local patom1 cutoff radius", "radius;full")
line("dump local without columns", "dump d all local 1 f", "at least one")
line("dump local of an atom property", "dump d all local 1 f index id", "'id';index")
line("dump local of values per atom", "compute e all pe/atom\ndump d all local 1 f c_e", "c_e;local")
line("dump local column out of range", "compute d all bond/local dist engpot\ndump d all local 1 f c_d[3]", r"c_d\[3\];2 columns")
line("dump local array without column", "compute d all bond/local dist engpot\ndump d all local 1 f c_d", r"2 columns;c_d\[1\]")
line("dump local columns of different lengths",
     "compute b all bond/local dist\ncompute a all angle/local theta\ndump d all local 1 f c_b c_a",
     "3 c_b;2 c_a", at=RUN)
line("dump local sorted by id", "compute b all bond/local dist\ndump d all local 1 f c_b\ndump_modify d sort id", "sort;id|ID")
line("local values in thermo output", "compute b all bond/local dist\nthermo_style custom step c_b[1]", "bond/local")
line("turned off bonds still need coefficients", "delete_bonds all bond 1\nbond_style hybrid harmonic", "bond;type 1", at=RUN)

ADDED = CASES[START:]
