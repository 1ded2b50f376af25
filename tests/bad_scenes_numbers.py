"""Numbers that no formula is for: zero, huge, tiny, negative, in digits of other alphabets; four charges of two types in a small box."""
from __future__ import annotations

from bad_scenes import CASES, Case

BOX = """\
units real
atom_style full
region b block 0 14 0 13 0 15
create_box 2 b
create_atoms 1 single 3 3 3
create_atoms 2 single 6 3 3
create_atoms 1 single 3 7 3
create_atoms 2 single 3 3 8
mass * 10.0
set type 1 charge 0.5
set type 2 charge -0.5
"""


def numbers(name, text, words, at, expect="error", **more) -> None:
    """Lines after the box and before a run of no steps, and the words of the message at one of the lines."""
    script = f"{BOX}{text}\nrun 0\n"
    CASES.append(Case(f"numbers {name}", expect, words.split(";") if words else [], ("in.scene", at) if at else None, text=script, **more))


LONG = "pair_style lj/cut/coul/long 5\npair_coeff * * 0.1 3"
for words, text in {"gewald -1": "gewald must not be negative;-1", "gewald 1e308": "too large;mesh", "order 0": "order must be 2 to 7;0",
                    "mesh 20000 1 1": "mesh 20000 1 1;too large", "force 1e-300": "too large;mesh"}.items():
    numbers(f"kspace_modify {words}", f"{LONG}\nkspace_style pppm 1e-4\nkspace_modify {words}", text, "run 0")
for style in ("pppm", "ewald", "msm", "pppm/disp", "ewald/disp"):
    numbers(f"accuracy of {style}", f"{LONG}\nkspace_style {style} 2", f"kspace_style {style};accuracy;at most 1;2", f"kspace_style {style} 2")
numbers("accuracy 1e308", f"{LONG}\nkspace_style pppm 1e308", "at most 1;1e308", "kspace_style pppm 1e308")
numbers("accuracy 1", f"{LONG}\nkspace_style ewald 1", "", None, "fine")
numbers("msm of order 0", f"{LONG.replace('long', 'msm')}\nkspace_style msm 1e-3\nkspace_modify order 0", "order must be 4, 6, 8 or 10;0", "run 0")
for style in ("pppm", "ewald"):
    numbers(f"Coulomb cutoff 0 {style}", f"{LONG.replace('long 5', 'long 5 0')}\nkspace_style {style} 1e-4", "could not compute g_ewald;cutoff 0", "run 0")
    numbers(f"charges beyond measure {style}", f"{LONG}\nset type 1 charge 1e200\nkspace_style {style} 1e-4", "could not compute g_ewald;charges", "run 0")
numbers("Coulomb cutoff 1e-10", f"{LONG.replace('long 5', 'long 5 1e-10')}\nkspace_style pppm 1e-4", "kspace_style pppm;mesh 1638[45] along an edge;0.0001;use", "run 0")
for words in ("long 5 1e-10", "long 5"):
    numbers(f"endless sum {words}", f"{LONG.replace('long 5', words)}\nkspace_style ewald 1e-4\nkspace_modify gewald {1e200 if words == 'long 5' else 0}",
            "kspace_style ewald: the sum over waves;too large;use", "run 0")
DISPERSION = "pair_style lj/long/coul/long long long 5\npair_coeff * * 0.1 3\nkspace_style ewald/disp"
for words, more in {"1e-300": "", "1e-4": "kspace_modify gewald 1e30", "1e-5": "kspace_modify force 1e-300"}.items():
    numbers(f"endless sum with dispersion {words}", f"{DISPERSION} {words}\n{more}", "kspace_style ewald/disp: the sum over waves;too large;use", "run 0")
numbers("mesh beyond memory", f"{LONG}\nkspace_style pppm 1e-4\nkspace_modify mesh 16000 16000 16000", "mesh 16000 16000 16000;too large;use", "run 0")
numbers("msm cutoff 1e-320", "pair_style coul/msm 1e-320\npair_coeff * *\nkspace_style msm 1e-3", "kspace_style msm;cutoff 9.99989e-321", "run 0")

# ---- digits
for digits in ("1_0", "\uff15", "\u0665"):
    numbers(f"cutoff {digits!a}", f"pair_style lj/cut {digits}", f"pair_style lj/cut: cut must be a number;{digits}", f"pair_style lj/cut {digits}")
    at = f"pair_coeff * * {digits} 3"
    numbers(f"epsilon {digits!a}", f"pair_style lj/cut 5\n{at}", f"pair_coeff lj/cut: epsilon must be a number;{digits}", at)
for word, message in {"\u0661": "number or a range;\u0661", "9" * 5000: "999;too large", "1*" + "9" * 5000: "999;too large", "2*1": "2\\*1 is empty"}.items():
    numbers(f"type {word[:4]!a} of {len(word)} letters", f"pair_style lj/cut 5\npair_coeff {word} * 1 3", message, f"pair_coeff {word} * 1 3")
    numbers(f"excluded type {word[:4]!a} of {len(word)} letters", f"neigh_modify exclude type {word} 1", message, f"neigh_modify exclude type {word} 1")
FUNCFL = "a comment\n13 27 4.05 fcc\n5 0.1 5 1.0 {}\n" + 3 * "1 2 3 {} 5\n"
for word in ("1_0", "\uff15", "\u0665"):
    for k, line in enumerate((FUNCFL.format(word, 4, 4, 4), FUNCFL.format(5, word, 4, 4)), 3):
        numbers(f"{word!a} in line {k} of a funcfl file", "pair_style eam\npair_coeff * * al.eam", f"must be a number;{word}", None, files={"al.eam": line})
numbers("mark of UTF-8 in a list", "pair_style list x.list 5\npair_coeff * *", "", None, "fine", files={"x.list": "\ufeff1 2 lj126 0.1 3\n"})
for word in "10":
    numbers(f"pair_modify shift {word}", f"pair_style lj/cut 5\npair_coeff * * 0.1 3\npair_modify shift {word}", "", None, "fine")

# ---- cutoffs and skins
FAR = "cutoff plus skin;images"
numbers("pair_style 1e308", "pair_style lj/cut 1e308\npair_coeff * * 0.1 3", FAR, "run 0")
numbers("cutoff of a pair 1e308", "pair_style lj/cut 5\npair_coeff * * 0.1 3 1e308", FAR, "run 0")
for skin in ("1e200", "1e308"):
    numbers(f"skin {skin}", f"pair_style lj/cut 5\npair_coeff * * 0.1 3\nneighbor {skin} bin", FAR, "run 0")
TERSOFF = "Si Si Si 3 1 0 1.0 1.0 -0.5 0.78 1e-6 1.7 471 {R} 0.15 2.4 1830 {more}\n"
numbers("tersoff R", "pair_style tersoff\npair_coeff * * Si.tersoff Si Si", "images", "run 0", files={"Si.tersoff": TERSOFF.format(R="1e308", more="")})
numbers("Coulomb table", f"{LONG.replace('long 5', 'long 5 1e150')}\npair_modify table 12\nkspace_style ewald 1e-4\nkspace_modify gewald 0.3",
        "pair_modify table;1e\\+150", "run 0")

# ---- formulas without a value
for style, coeff, words in [
        ("mie/cut 5", "1 1 12 -1", "mie/cut, types 1 1;gamR = 12, gamA = -1;cut = 5"), ("mie/cut 5", "1 1 0 6", "no value;gamR = 0"),
        ("morse/soft 2 0.9 5", "1 1 1e300 1", "morse/soft;no value;r0 = 1e\\+300"),
        ("lj/charmmfsw/coul/charmmfsh 1e-320 5", "0.1 3", "lj/charmmfsw/coul/charmmfsh;too small")]:
    numbers(f"{style} {coeff}", f"pair_style {style}\npair_coeff * * {coeff}", words, "run 0")
for style, coeff, words in [
        ("gauss/cut 5", "1 3 0", "sigmah must be > 0"), ("gauss/cut 5", "1 3 -1", "sigmah must be > 0;-1"),
        ("lj/cut/soft 1 0.5 5", "1 0 1", "lj/cut/soft: sigma must be > 0"), ("lj/class2/soft 1 0.5 5", "1 -1 1", "sigma must be > 0;-1"),
        ("lj/class2/coul/long/soft 1 0.5 10 5", "1 0 1", "lj/class2/coul/long/soft: sigma must be > 0"),
        ("lj/pirani 5", "4 8 0 1 1", "gamma must be > 0"), ("lj/pirani 5", "4 8 6 0 1", "rm must be > 0"),
        ("lj/pirani 5", "4 8 6 1 -1", "epsilon must not be negative")]:
    numbers(f"{style} {coeff}", f"pair_style {style}\npair_coeff * * {coeff}", words, f"pair_coeff * * {coeff}")
for style in ("lj/smooth/linear 0", "lj/sf 0", "lj/cubic"):
    numbers(f"{style} of cutoff 0", f"pair_style {style}\npair_coeff * * 1 {int(style != 'lj/cubic')}", "", None, "fine")
for style in ("lj/mdf 0 5", "buck/mdf 0 5", "lennard/mdf 0 5"):
    numbers(style, f"pair_style {style}", "inner must be greater than 0", f"pair_style {style}")
for name in ("Z_i", "Z_j", "ZBLcut", "ZBLexpscale"):
    more = " ".join("-1" if n == name else "14" for n in ("Z_i", "Z_j", "ZBLcut", "ZBLexpscale"))
    numbers(f"tersoff/zbl {name}", "pair_style tersoff/zbl\npair_coeff * * Si.tersoff Si Si", f"entry Si Si Si: {name} must be at least;-1", None,
            files={"Si.tersoff": TERSOFF.format(R="2.85", more=more)})
at = "pair_write 1 1 5 r 1e-200 2 table.txt LJ"
numbers("table from 1e-200", f"pair_style lj/cut 5\npair_coeff * * 0.1 3\n{at}", "pair_write;not finite", at)

# ---- others
at = "pair_modify mix geometric arithmetic"
numbers("pair_modify with a value too many", f"pair_style lj/cut 5\n{at}", "unknown pair_modify keyword 'arithmetic'", at)
numbers("pair_modify of a keyword nobody knows", "pair_style lj/cut 5\npair_modify shfit", "unknown pair_modify keyword 'shfit';did you mean shift", "pair_modify shfit")
SPLINE = "a comment\n3\n0 0\n0 0 0 0\n1 {}\n2 1\n3 1\n" + 4 * "3\n0 0\n0 0 0 0\n1 1\n2 1\n3 1\n"
numbers("spline of 1e308", "pair_style meam/spline\npair_coeff * * Ti.spline Ti Ti", "phi Ti Ti are too large for a spline;Ti.spline:2", None,
        files={"Ti.spline": SPLINE.format("1e308")})
EMPTY = "units lj\natom_style charge\nregion b block 0 1 0 1 0 1\ncreate_box 1 b\nset type 1 charge 1\n"
CASES.append(Case("numbers set without atoms", "error", ["set", "no atoms"], ("in.scene", "set type 1 charge 1"), text=EMPTY))
SIZES = "Si Si Si 1 0 7 0.1 10 1 4 1 5 0 2 0 0 0\n"
numbers("vashishta/table from 1e308", "pair_style vashishta/table 100 1e308\npair_coeff * * Si.vashishta Si Si", "vashishta/table;1e\\+308 is beyond the cutoff",
        "pair_coeff * * Si.vashishta Si Si", files={"Si.vashishta": SIZES})
numbers("mark of UTF-8 in a potential file", "pair_style tersoff\npair_coeff * * Si.tersoff Si Si", "", None, "fine",
        files={"Si.tersoff": "\ufeff" + TERSOFF.format(R="2.85", more="")})
