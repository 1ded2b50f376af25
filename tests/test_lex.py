"""Parsing rules of scripts; the expected results are those of LAMMPS (22 Jul 2025)."""
from __future__ import annotations

import pytest

from asemd.errors import InputError
from asemd.lammps import lex, script


def words(text, **variables):
    value = {**variables}.__getitem__
    line = lex.strip_comment(lex.logical_lines(text)[0].text)
    return lex.split(lex.substitute(line, value, lambda formula: eval(formula)))


def test_continuation_joins_lines_and_keeps_the_first_line_number():
    lines = lex.logical_lines("a\nrun &\n  10 & \n upto\nb\n", "in.x")
    assert [line.text.split() for line in lines] == [["a"], ["run", "10", "upto"], ["b"]]
    assert [line.where.line for line in lines] == [1, 2, 5]
    assert str(lines[1].where) == "in.x:2: run 10 upto"


def test_comment_after_ampersand_ends_the_command():
    assert [line.text for line in lex.logical_lines("run & # no\n10")] == ["run & # no", "10"]


@pytest.mark.parametrize("text, expected", [
    ("run 10 # comment", ["run", "10"]),
    ("print 'a # b' # c", ["print", "a # b"]),
    ('print "it\'s"', ["print", "it's"]),
    ("print 'say \"x\"'", ["print", 'say "x"']),
    ('print """both " and \' inside"""', ["print", "both \" and ' inside"]),
    ("\tmass   1  1.0 ", ["mass", "1", "1.0"]),
    ("# only", []),
    ('print a"b c"', ["print", 'a"b', 'c"']),
])
def test_words(text, expected):
    assert words(text) == expected


def test_triple_quotes_run_over_lines():
    lines = lex.logical_lines('print """one\ntwo"""\nrun 0')
    assert lex.split(lines[0].text) == ["print", "one\ntwo"]
    assert lines[1].where.line == 3


def test_substitution_outside_quotes_only():
    assert words("print $a ${bc} $(1+1) $(1/4:%.2f)", a="x", bc="y z") == ["print", "x", "y", "z", "2", "0.25"]
    assert words("print '$a' \"${bc}\"", a="x") == ["print", "$a", "${bc}"]


def test_substitution_is_echoed_step_by_step():
    echo = []
    lex.substitute("region box block 0 ${xx} 0 $y", {"xx": "4", "y": "5"}.get, float, echo.append)
    assert echo == ["region box block 0 4 0 $y", "region box block 0 4 0 5"]


def test_substituted_text_is_not_substituted_again():
    assert lex.substitute("$a", {"a": "$b"}.get, float) == "$b"


def test_immediate_formula_has_20_digits():
    assert lex.substitute("$(0.1)", str, float) == "0.10000000000000000555"


@pytest.mark.parametrize("text", ["print 'a", 'print "a', 'print """a', "print 'a'b"])
def test_unmatched_quotes(text):
    with pytest.raises(InputError, match="quote"):
        words(text)


@pytest.mark.parametrize("text", ["run $", "run ${x", "run $(1+(2)", "run $(1.5:%d)"])
def test_bad_references(text):
    with pytest.raises(InputError):
        words(text)


def test_all_unknown_names_are_found_at_once():
    commands = script.parse("units lj\npair_styl lj/cut 2.5\nrun 0\nfix 1 all nvee\n${x} 1\nbond_style $x\nbond_style harmonc\n", "in.x")
    errors, doubtful = script.check(commands)
    assert [e.where.line for e in errors] == [2, 4, 7] and not doubtful
    for error, match in zip(errors, ("pair_style", "nve", "harmonic")):
        assert f"did you mean {match}?" in str(error)
    with pytest.raises(script.Problems) as caught:
        script.raise_problems(errors)
    assert "in.x:2" in str(caught.value) and "in.x:7" in str(caught.value)


def test_a_command_of_lammps_that_is_missing_here_is_not_called_unknown():
    errors, _ = script.check(script.parse("temper_npt a\ntemper_ntp a\n"))
    assert "not supported yet" in str(errors[0]) and "did you mean temper_npt?" in str(errors[1])


def test_names_inside_a_loop_are_only_doubtful():
    errors, doubtful = script.check(script.parse("label a\nfoo 1\njump SELF a\nbar 2\n"))
    assert [e.where.line for e in doubtful] == [2] and [e.where.line for e in errors] == [4]
