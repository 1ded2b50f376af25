"""``asemd check --html``: the findings and the battery as a page."""
from __future__ import annotations

from asemd import cli
from asemd.check.battery.result import Line, Result
from asemd.check.page import page_of, page_of_battery
from asemd.check.report import Report
from asemd.finding import Finding
from asemd.text_table import Table

SCRIPT = """units lj
lattice fcc 0.8442
region b block 0 4 0 4 0 4
create_box 1 b
create_atoms 1 box
mass 1 1
pair_style lj/cut 2.5
pair_coeff 1 1 1 1
velocity all create 1.0 1
fix 1 all nve
timestep {dt}
run 10
"""


def test_command_writes_a_page_and_keeps_its_status(tmp_path, capsys):
    script, page = tmp_path / "in.x", tmp_path / "x.html"
    for dt, status in ((0.005, 0), (0.5, 2)):
        script.write_text(SCRIPT.format(dt=dt))
        assert cli.main(["check", str(script), "--html", str(page)]) == status
        text = page.read_text()
        assert "Check of in.x" in text and ("ERROR" in text) == (status == 2)
    assert cli.main(["check", str(script), "--html", str(tmp_path)]) == 1
    assert "cannot write a file there" in capsys.readouterr().err


def test_findings_and_curves():
    rows = [("0.001", "0.01", "0", ""), ("0.002", "0.04", "0", ""), ("0.004", "nan", "nan", "blew up")]
    report = Report("in.y", [Finding("warning", "time step", "It is <long>.", value=2.0, limit=1.0, advice="timestep 1"),
                             Finding("note", "units", "Odd.")], [("net charge", "no charges")],
                    [Table("By timestep", ("timestep", "fluctuation", "drift", "failed"), rows)])
    page = page_of(report)
    text = page.html()
    assert [p.title for p in page.plots] == ["Fluctuation of the energy"]
    assert "It is &lt;long&gt;." in text and "What to do: timestep 1." in text and "no charges" in text and "blew up" in text


def test_battery():
    lines = [Line("dimer", "energy", 1e-3, 1e-5, "What it says.", lammps=2e-5), Line("dimer", "order", 0.1, 0.7, "More.")]
    text = page_of_battery(Result(lines, "20250722", False, 3.0)).html()
    assert "FAILED" in text and "What it says." in text and "recorded" in text
