"""Broken scripts: the command line answers with an error of one line, never with a traceback, and does not hang."""
from __future__ import annotations

import io
import sys
from contextlib import redirect_stderr, redirect_stdout

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from asemd import cli
from asemd.errors import AsemdError
from asemd.lammps import lex
from asemd.variable import Variables

SCRIPT = """units lj
lattice fcc 0.8442
region b block 0 1 0 1 0 1
region s sphere 0 0 0 1 side out
create_box 2 b
create_atoms 1 box
set atom 2 type 2
mass * 1.0
pair_style lj/cut 1.2
pair_coeff * * 1.0 1.0 # nothing
group g type 2
group h dynamic all region s every 2
variable i loop 3 pad
variable e equal "2*v_v[2]^2 + $(1+1:%3.1f)"
variable v vector [1,2,3]
variable a atom x*(id>2)
variable f format e %.3f
label top
print "i = $i ${e} $(v_e/3) ${f}" screen yes
if "$i > 1 && a == a" then "print 'big'" else "print small"
next i
jump SELF top
velocity all create 1.0 87287
fix 1 all nve
compute t g temp
thermo_style custom step temp v_e c_t
thermo_modify norm no format float %g
run 0
dump d all custom 1 d.txt id x v_a
undump d
displace_atoms g move 0.1 0 0
delete_atoms group g
info variables
""".splitlines()
WORDS = sorted({w for line in SCRIPT for w in line.split()})
JUNK = st.sampled_from(["", "-1", "0", "1e400", "nan", "inf", "*", "1*0", "2*", "v_", "c_", "v_zz[1]", "${", "$(", "$(1/0)", "${e}",
        "$x", "&", '"', '"""',
                        "'", "#", "\x00", "é", "9" * 40, "[1,2", "((((", "x" * 300, "%s", "$(v_v)", "all", "NULL", "INF", "EDGE",
                        "../../x", "1:2:0"])
CALM = settings(max_examples=60, suppress_health_check=list(HealthCheck))


@st.composite
def mutated(draw):
    """The script with some of its lines changed, moved, lost or doubled; no `run` but that of no steps, no jump without its counter."""
    lines = list(SCRIPT)
    for _ in range(draw(st.integers(1, 3))):
        at = draw(st.integers(0, len(lines) - 1))
        words = lines[at].split(" ")
        what = draw(st.sampled_from(["drop", "swap", "junk", "word", "cut", "double", "lose"]))
        if "next" in lines[at] or "jump" in lines[at] or "variable i" in lines[at] or what == "lose" and "label" in lines[at]:
            continue
        k = draw(st.integers(0, len(words) - 1))
        if what == "drop":
            del words[k]
        elif what == "junk":
            words[k] = draw(JUNK)
        elif what == "word":
            words.insert(k, draw(st.sampled_from(WORDS)))
        elif what == "cut":
            words = [" ".join(words)[:draw(st.integers(0, len(lines[at])))]]
        elif what == "swap":
            other = draw(st.integers(0, len(lines) - 1))
            if not {"next", "jump", "label"} & {lines[other].split(" ")[0], words[0]}:
                lines[other], words = lines[at], lines[other].split(" ")
        elif what == "double":
            words = words * 2
        lines[at] = " ".join(words) if what != "lose" else ""
    return "\n".join(lines) + "\n"


def answer(text: str, monkeypatch, *options: str) -> tuple[int, str]:
    out, err = io.StringIO(), io.StringIO()
    monkeypatch.setattr(sys, "stdin", io.StringIO(text))
    with redirect_stdout(out), redirect_stderr(err):
        status = cli.main(["run", "-", "-log", "none", *options])
    return status, err.getvalue()


@CALM
@given(text=mutated())
def test_mutated_scripts_end_with_an_answer(text, tmp_path_factory, monkeypatch):
    monkeypatch.chdir(tmp_path_factory.mktemp("fuzz"))
    status, error = answer(text, monkeypatch, "--steps-cap", "1")
    assert "ASEMD_DEBUG" not in error, text         # an error that nobody thought of
    assert status in (0, 1) and (status == 0) == (not error), error
    status, error = answer(text, monkeypatch, "--dry")
    assert "ASEMD_DEBUG" not in error and status in (0, 1), error


TOKENS = st.lists(st.sampled_from(["1", "2.5", "x", "v_a", "v_b[1]", "sum(v_b)", "sqrt(", "(", ")", "+", "-", "^", "/", "%", ",", "[",
        "]", "PI", "==", "&&",
                                   "|^", "!", "1e300", "ternary(1,2,3)", "random(0,1,7)", "stride(1,2,3)", "logfreq2(1,2,3)",
                                   "is_file(", "py_a(1)",
                                   "1e999", "next(a)", "gmask(all)", "exp(1e5)", " ", "swiggle(1,2,0)"]), max_size=12)


@settings(max_examples=300)
@given(TOKENS)
def test_formulas_give_a_number_or_an_error(tokens):
    variables = Variables()
    variables.define("a", "string", ["2"])
    variables.define("b", "vector", ["[1,2]"])
    try:
        assert isinstance(variables.evaluate("".join(tokens)), float)
    except AsemdError:
        return


@settings(max_examples=300)
@given(st.text(alphabet="ab \t\n\"'$&{}()#%:\\1", max_size=60))
def test_any_text_can_be_read(text):
    for line in lex.logical_lines(text):
        try:
            bare = lex.strip_comment(line.text)
            lex.split(lex.substitute(bare, lambda name: "b", lambda formula: 1.0))
        except AsemdError:
            continue


@pytest.mark.parametrize("text", ["", "\n\n", "&", '"""', "print '", "\x00\x01", "variable a equal v_a\nprint $a",
        "include -", "label a\njump SELF b",
                                  "variable a equal " + "(" * 3000, "if '" + "(" * 3000 + "' then 'print a'", "print " + "$(" * 200])
def test_odd_scripts(text, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    status, error = answer(text, monkeypatch)
    assert status in (0, 1) and "ASEMD_DEBUG" not in error
