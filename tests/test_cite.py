"""asemd cite: papers of a script's methods, and what its potential files say."""
from __future__ import annotations

import json
import re

import pytest
from lj_cell import BASE

from asemd import citations, cli
from asemd.lammps import catalog

SCRIPT = "atom_style charge\n" + BASE + """fix 2 all nvt temp 1 1 0.5
run 10
unfix 2
pair_style hybrid/overlay lj/cut 1.5 coul/dsf 0.1 1.5
pair_coeff * * lj/cut 1 1
pair_coeff * * coul/dsf
fix 3 all langevin 1 1 0.5 7
run 10
min_style fire
minimize 0 0 1 1
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "in.x").write_text(SCRIPT)
    return tmp_path


def test_papers_of_the_whole_script(folder, capsys):
    """Also of what comes after the first run; nothing is written."""
    assert cli.main(["cite", "in.x", "--engine", "lammps"]) == 0
    out = capsys.readouterr().out
    for line in ("fix nvt", "Nosé, J. Chem. Phys. 81, 511 (1984), https://doi.org/10.1063/1.447334", "fix langevin", "pair_style coul/dsf",
                 "min_style fire", "J. Phys.: Condens. Matter 29, 273002 (2017)", "Comput. Phys. Commun. 271, 108171 (2022)",
                 "Without a paper in asemd's table: pair_style lj/cut"):
        assert line in out, line
    assert [p.name for p in folder.iterdir()] == ["in.x"]
    assert cli.main(["cite", "in.x", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert "LAMMPS" not in found["papers"] and found["without"] == ["pair_style lj/cut"]


def test_bibtex(folder, capsys):
    assert cli.main(["cite", "in.x", "--bibtex"]) == 0
    out = capsys.readouterr().out
    assert re.search(r"@article\{nose1984,\n  author = \{S\. Nos\{\\'e\}\},\n  journal = \{J\. Chem\. Phys\.\},", out)
    assert out.count("@article{nose1984") == 1 and "author = {A. H. Larsen and others}" in out and "@software{asemd" in out
    assert out.count("{") == out.count("}") and out.isascii()
    assert "author = {Miller, III, T. F. and others}" in citations.of_styles([("fix", "rigid")]).bibtex()
    assert "Proc. 2nd Workshop on the LLVM Compiler Infrastructure in HPC},\n  pages = {7:1--7:6},\n  year = {2015}," in out


def test_without_a_doi():
    """Text ends with the year, an entry with its last field that is known; a book is one."""
    hockney, pollock = citations.of_styles([("kspace", "pppm")]).papers["kspace_style pppm"]
    assert str(pollock) == "E. L. Pollock, J. Glosli, Comput. Phys. Commun. 95, 93 (1996)"
    assert pollock.bibtex() == "\n".join([
        "@article{pollock1996,", "  author = {E. L. Pollock and J. Glosli},", "  journal = {Comput. Phys. Commun.},", "  volume = {95},",
        "  pages = {93},", "  year = {1996},", "}"])
    assert str(hockney) == "R. W. Hockney, J. W. Eastwood, Computer Simulation Using Particles (Adam Hilger, New York) (1988)"
    assert hockney.bibtex() == "\n".join([
        "@book{hockney1988,", "  author = {R. W. Hockney and J. W. Eastwood},",
        "  title = {Computer Simulation Using Particles (Adam Hilger, New York)},", "  year = {1988},", "}"])


def test_potential_files(tmp_path, monkeypatch):
    monkeypatch.setenv("LAMMPS_POTENTIALS", str(tmp_path))
    (tmp_path / "Si.sw").write_text("# DATE: 2007-06-11 CONTRIBUTOR: A B CITATION: Stillinger and Weber, PRB 31, 5262 (1985)\nSi\n")
    (tmp_path / "Cu.eam").write_text("Cu functions (universal 3)\n29 63.55\n")
    found = citations.of_styles([("pair", "sw"), ("pair", "meam/spline")], ["*", "Si.sw", "Cu.eam", "Si"])
    assert found.files == {"Si.sw": "Stillinger and Weber, PRB 31, 5262 (1985)", "Cu.eam": "Cu functions (universal 3)"}
    assert list(found.papers) == ["asemd rests on", "pair_style sw", "pair_style meam/spline"]


def test_mistakes_have_their_line(folder, capsys):
    (folder / "in.y").write_text("units lj\npair_style lj/cut\n")
    assert cli.main(["cite", "in.y"]) == 1 and "in.y:2" in capsys.readouterr().err


def test_the_table():
    """Rows are complete, DOIs have their form, and every pattern means a style that exists."""
    rows = citations.table()
    assert len({p.key for p in rows}) == len({str(p) for p in rows}) == len(rows) > 100
    names = {("min_style" if c == "minimize" else c, n) for c in (*catalog.FORCE_FIELD, "kspace", "fix", "compute", "minimize")
             for n in catalog.names(c)} | {("run_style", "respa"), ("kspace_modify", "slab")}
    styles = [f"{c}:{n}" for c, n in names] + ["fix:shake:settle", "fix:rattle:settle", "asemd", "lammps"]
    for paper in rows:
        assert paper.authors and paper.journal and re.fullmatch(r"1[89]\d\d|20[012]\d", paper.year), paper
        assert not paper.doi or re.fullmatch(r"10\.\d{4,5}/\S+", paper.doi), paper
        assert paper.page or not paper.volume, paper
        if paper.doi.startswith("10.1103/"):            # of the American Physical Society: they follow from the rest
            letter = {"Phys. Rev.": "", "Phys. Rev. Lett.": "Lett"}.get(paper.journal, paper.journal[-1])
            assert paper.doi == f"10.1103/PhysRev{letter}.{paper.volume}.{paper.page}", paper
        for pattern in paper.styles.split():
            assert any(citations.fnmatchcase(s, pattern) for s in styles), (paper.key, pattern)
