"""Sessions: order rules, places in errors, loops, includes, runs and their output."""
from __future__ import annotations

import pickle
import re
import warnings

import numpy as np
import pytest
from lj_cell import BASE

from asemd.errors import InputError
from asemd.lammps.script import Problems
from asemd.lammps.session import Session, Stop
from asemd.lammps.switches import parse
from asemd.scene import GroupTable

ROW = re.compile(r"^\s+\d+( +[-\d.e]+)+ *$")


class Text(list):
    """Collects what goes to the terminal."""

    def __str__(self):
        return "".join(self)

    def rows(self):
        return [[float(w) for w in line.split()] for line in str(self).splitlines() if ROW.match(line)]


@pytest.fixture
def make(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def session(*switches):
        text = Text()
        s = Session(switches=parse(["-log", "log.lammps", *switches]), screen=text.append)
        s.text = text
        return s
    return session


@pytest.fixture
def session(make):
    s = make()
    s.commands(BASE)
    return s


@pytest.mark.parametrize("command, name", [("run 0", "run"), ("mass 1 1", "mass"), ("thermo_style custom step", "thermo_style"),
    ("fix 1 all nve", "fix"),
                                           ("pair_coeff 1 1 1 1", "pair_coeff"), ("minimize 0 0 1 1", "minimize"),
                                           ("group a type 1", "group")])
def test_commands_that_need_a_box(make, command, name):
    with pytest.raises(InputError, match=f"{name}.*before simulation box is defined"):
        make().execute(command)


@pytest.mark.parametrize("command", ["units real", "boundary p p f", "atom_style full", "dimension 2", "newton off"])
def test_commands_that_come_before_the_box(session, command):
    with pytest.raises(InputError, match="after simulation box is defined"):
        session.execute(command)


def test_errors_name_file_line_and_text(make, tmp_path):
    (tmp_path / "in.x").write_text("units lj\n\nvariable a index 1 &\n 2\nmass $a 1.0\n")
    with pytest.raises(InputError) as caught:
        make().file("in.x")
    assert (caught.value.where.file, caught.value.where.line) == ("in.x", 5)
    assert str(caught.value).endswith("(in.x:5: mass $a 1.0)")


def test_nothing_runs_when_the_script_has_unknown_names(make, tmp_path):
    (tmp_path / "in.x").write_text("print hello\nfoo 1\npair_style lj/cutt 2.5\n")
    s = make()
    with pytest.raises(Problems) as caught:
        s.file("in.x")
    assert len(caught.value.problems) == 2 and "hello" not in str(s.text)


def test_undefined_variable(session):
    with pytest.raises(InputError, match="undefined variable nope"):
        session.execute("print ${nope}")


@pytest.mark.parametrize("command, message", [
    ("run", "run needs"), ("run 1.5", "whole number"), ("run 10 foo", "unknown keyword 'foo'"), ("run -1", "negative"),
    ("run 3 start 5", "enclose"),
    ("fix 2 nogroup nve", "unknown group 'nogroup'"), ("fix 2 all nvee", "did you mean nve"), ("unfix 9", "no fix 9"),
    ("uncompute q", "no compute q"),
    ("compute thermo_temp all temp", "exists already"), ("thermo_style custom step tmp", "did you mean temp"),
    ("thermo_style custom c_x", "no compute x"),
    ("thermo_modify foo yes", "unknown or unsupported"), ("thermo_modify lost maybe", "ignore warn error"), ("thermo abc", "whole number"),
    ("timestep abc", "number"), ("neighbor -1 bin", "negative"), ("neigh_modify ever 1", "did you mean every"),
    ("dump d all atom 0 x", "positive"),
    ("undump q", "no dump q"), ("min_style foo", "foo"), ("next a", "undefined variable a"), ("jump SELF a", "only lines of a script"),
    ("echo loud", "none screen"),
    ("if 1 > 2 then", "then"), ("run_style respa 2 2 inner 1 4 5", "inner and outer"),
    ("fix 1 all langevin 1 1 1 1", "exists with style nve"),
    ("print a b", "quotes"),
    ("variable v world 1 2", "one partition"), ("include nofile", "cannot open"), ("print 'a", "quote"),
])
def test_bad_commands(session, command, message):
    with pytest.raises(InputError, match=message):
        session.execute(command)


def test_rows_are_those_of_lammps(session):
    session.commands("thermo 5\nrun 10")
    assert session.text.rows() == [
        [0, 1.44, -5.5046614, 0, -3.4121614, -2.9711435], [5, 1.368833, -5.401655, 0, -3.4125695, -2.3899126],
        [10, 1.0849398, -4.9896631, 0, -3.4131099, -0.40438158]]


def test_no_time_passes(session, tmp_path):
    """With timestep 0 atoms stay, and there is no number of days; what divides by the step says so."""
    session.commands("timestep 0\nthermo 2\nrun 2")
    first, last = session.text.rows()
    assert first[1:] == last[1:]
    with pytest.raises(InputError, match="fix langevin: noise grows without bound"):
        session.commands("fix 2 all langevin 1 1 1 123\nrun 1")
    session.close()
    log = (tmp_path / "log.lammps").read_text()
    assert "Loop time" in log and "Performance" not in log


def test_log_has_echo_and_summary(session, tmp_path):
    session.commands("variable n index 3\nrun $n")
    session.close()
    log = (tmp_path / "log.lammps").read_text()
    assert re.match(r"LAMMPS \(\d+ \w+ \d+ - asemd \S+\)\n", log) and "run $n\nrun 3\n" in log
    assert re.search(r"^Loop time of \S+ on 1 procs for 3 steps with 32 atoms$", log, re.M)
    assert re.search(r"^Performance: [\d.]+ tau/day, [\d.]+ timesteps/s, [\d.]+ [kMG]?atom-step/s$", log, re.M)
    assert re.search(r"^Section \|  min time  \|  avg time  \|  max time  \|%varavg\| %total$", log, re.M)
    for section in ("Pair", "Neigh", "Comm", "Output", "Modify"):
        assert re.search(rf"^{section:<8}\| \S+ +\| \S+ +\| \S+ +\| +0\.0 \| *[\d.]+$", log, re.M)
    assert "Neighbor list builds = " in log and "Dangerous builds = 0" in log and "Total wall time: 0:00:0" in log


def test_pre_no_continues_and_post_no_is_short(session):
    session.commands("run 4 post no\nrun 4 pre no post no")
    split = session.scene.system.x.copy()
    assert "MPI task timing" not in str(session.text) and str(session.text).count("Loop time") == 2
    session.commands("clear\n" + BASE + "run 8")
    assert np.abs(session.scene.system.x - split).max() < 1e-12


def test_upto_start_stop_every(session):
    session.commands("run 4 upto\nrun 10 upto start 0 stop 20 every 3 \"print 'at $(step)'\"")
    assert session.scene.step == 10
    assert re.findall(r"at (\d+)", str(session.text)) == ["7", "10"]


def test_steps_cap(make):
    s = make("-cap", "2")
    s.commands(BASE + "run 100")
    assert s.scene.step == 2


def test_thermo_by_variable(session):
    session.commands("variable v equal stride(2,10,3)\nthermo v_v\nrun 9")
    assert [row[0] for row in session.text.rows()] == [0, 2, 5, 8, 9]


def test_variables_see_the_last_step(session):
    with pytest.raises(InputError, match="run 0"):
        session.variables.evaluate("temp")
    assert session.variables.evaluate("vol") == pytest.approx(37.905709547500592)
    session.commands("compute pa all pe/atom\ncompute p all pressure thermo_temp\nrun 0")
    value = session.variables.evaluate
    assert value("pe*atoms") == pytest.approx(float(session.moment.per_atom("pa").sum()), rel=1e-12)
    assert value("press") == pytest.approx(value("c_p"), rel=1e-14)
    assert value("c_p[1]+c_p[2]+c_p[3]") / 3 != 0.0
    session.execute("variable x atom c_pa*2")
    assert value("v_x[3]") == pytest.approx(2 * value("c_pa[3]"))


@pytest.mark.parametrize("formula, expected", [
    ("xcm(all,x)", 1.2596971435368804), ("gyration(a)", 1.2846440632223288), ("ke(all)", 66.96), ("angmom(all,z)", -17.000436286146822),
    ("inertia(all,xx)", 56.420867322132459), ("omega(all,x)", 0.10960042568885590), ("bound(all,xmax)", 2.5193942870737609),
    ("count(all,r)", 14),
    ("mass(a,r)", 7), ("xcm(all,x,r)", 0.83979809569125352), ("ke(all,r)", 29.414843923055734)])
def test_group_functions_are_those_of_lammps(session, formula, expected):
    session.commands("group a id 1:10\nregion r block 0 1 0 1 0 1\nrun 0")
    assert session.variables.evaluate(formula) == pytest.approx(expected, rel=1e-13)


def test_warnings_in_python_and_in_the_log(session, tmp_path):
    with pytest.warns(UserWarning, match="integrated more than once: by fix 1 and fix 2"):
        session.commands("fix 2 all nve\nrun 0")
    with pytest.warns(UserWarning, match="no fixes with time integration"):
        session.commands("unfix 1\nunfix 2\nrun 0")
    session.close()
    assert (tmp_path / "log.lammps").read_text().count("WARNING: ") == 2


def test_missing_mass_and_coefficients(make):
    s = make()
    s.commands(BASE.replace("mass 1 1.0\n", "").replace("velocity all create 1.44 87287 loop geom\n", ""))
    with pytest.raises(InputError, match="no mass for atom type 1"):
        s.execute("run 0")
    s = make()
    s.commands(BASE.replace("pair_coeff 1 1 1.0 1.0\n", ""))
    with pytest.raises(InputError, match="pair_coeff.*1 1"):
        s.execute("run 0")


def test_loop_if_label_jump_include(make, tmp_path):
    (tmp_path / "in.inc").write_text("print 'inc $i'\n")
    (tmp_path / "in.x").write_text("label top\nvariable i loop 3\ninclude in.inc\n"
                                   "if '$i == 2' then 'print two' elif '$i > 2' 'print more' else 'print one'\n"
                                   "next i\njump SELF top\nprint done\n")
    s = make()
    s.file("in.x")
    printed = [line for line in str(s.text).splitlines() if not line.startswith("asemd")]
    assert printed == ["inc 1", "one", "inc 2", "two", "inc 3", "more", "done"]


def test_jump_out_of_a_loop(make, tmp_path):
    (tmp_path / "in.x").write_text("variable i loop 5\nlabel top\nprint 'i $i'\nif '$i >= 2' then 'jump SELF out'\nnext i\njump SELF top\n"
                                   "label out\nvariable i delete\nprint end\n")
    s = make()
    s.file("in.x")
    assert str(s.text).splitlines()[1:] == ["i 1", "i 2", "end"]


def test_velocities_set_between_runs_count_without_setup_too(session):
    session.commands("run 2\nvelocity all set 0.0 0.0 0.0\nrun 0 pre no")
    assert session.text.rows()[-1][1] == 0.0


def test_values_per_atom_on_every_step_that_shows_them(session, tmp_path):
    session.commands("compute pa all pe/atom\ndump d all custom 2 d.txt id c_pa\nthermo 3\nvariable first equal c_pa[1]\n"
                     "thermo_style custom step v_first\nthermo_modify norm no\nrun 6")
    blocks = (tmp_path / "d.txt").read_text().split("ITEM: TIMESTEP\n")[1:]
    dumped = {int(b.split()[0]): float(b.splitlines()[-32].split()[1]) for b in blocks}
    rows = dict(session.text.rows())
    assert sorted(dumped) == [0, 2, 4, 6] and sorted(rows) == [0, 3, 6]
    assert rows[0] == pytest.approx(dumped[0], rel=1e-5) and rows[6] == pytest.approx(dumped[6], rel=1e-5) and rows[0] != rows[3] != rows[6]


def test_if_compares_text_and_numbers(make):
    s = make()
    s.commands("if 'abc == abc' then 'print A'\nif 'a != b' then 'print B'\nif '1.0 == 1' then 'print C'\nif '1 > 2' then 'print D'\n"
               "variable t equal 3\nif '$t > 2 && (1 < 2)' then 'print E'")
    assert "".join(line for line in str(s.text).splitlines()[1:]) == "ABCE"
    with pytest.raises(InputError):
        s.execute("if abc then 'print x'")


def test_quit(make):
    with pytest.raises(Stop) as stop:
        make().commands("quit 3\nfoo")
    assert stop.value.status == 3


def test_switches(make):
    s = make("-var", "a", "1", "2", "-v", "b", "-3", "-nocite", "-sf", "opt", "-pk", "omp", "2")
    assert [s.variables.value(n) for n in "ab"] == ["1", "-3"]
    for bad in (["-foo"], ["-var", "a"], ["-echo", "loud"], ["-log"]):
        with pytest.raises(InputError):
            parse(bad)


def test_clear(session):
    session.commands("variable a index 1\nclear")
    assert session.scene.system is None and session.variables.value("a") == "1"
    session.commands(BASE + "run 1")


def test_units_choose_timestep_and_skin(make):
    s = make()
    s.execute("units real")
    assert (s.scene.dt, s.scene.neighbor.skin) == (1.0, 2.0)


def test_minimize(session):
    session.commands("unfix 1\ndisplace_atoms all random 0.05 0.05 0.05 123\nminimize 1e-10 1e-10 100 1000")
    assert np.abs(session.scene.system.f).max() < 1e-3
    assert "Stopping criterion = " in str(session.text) and "Iterations, force evaluations = " in str(session.text)


def test_simulation_time(session):
    def now():
        return session.variables.evaluate("time")
    seen = []
    for command in ("run 10", "reset_timestep 100", "timestep 0.01", "run 10", "reset_timestep 7", "reset_timestep 10 time 5"):
        session.execute(command)
        seen.append(now())
    assert seen == pytest.approx([0.05, 0.5, 0.5, 0.6, 0.0, 5.0])


def test_dump_at_multiples(session, tmp_path):
    session.commands("dump d all custom 2 d.txt id x y z\nrun 4\nrun 2")
    steps = re.findall(r"TIMESTEP\n(\d+)", (tmp_path / "d.txt").read_text())
    assert steps == ["0", "2", "4", "6"]


def test_print_to_file(make, tmp_path):
    s = make()
    s.commands("print 'a b' file p.txt screen no\nprint c append p.txt")
    assert (tmp_path / "p.txt").read_text() == "a b\nc\n" and "a b" not in str(s.text)


def test_group_table():
    table = GroupTable(3)
    table["a"], table["b"] = [True, False, False], [False, True, False]
    assert list(table) == ["all", "a", "b"] and table.bit("b") == 2
    del table["a"]
    table["c"] = [False, False, True]
    assert table.bit("c") == 1
    table.resize(4)
    assert table["all"].tolist() == [True] * 4 and not table["c"][3]
    for k in range(29):
        table[f"g{k}"] = [False] * 4
    with pytest.raises(InputError, match="at most 32"):
        table["more"] = [False] * 4


def test_scene_can_be_pickled(session):
    session.execute("run 2")
    scene = pickle.loads(pickle.dumps(session.scene))
    other = Session(scene, parse(["-log", "none", "-screen", "none"]))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        other.execute("run 3")
        session.execute("run 3")
    assert np.array_equal(other.scene.system.x, session.scene.system.x)
