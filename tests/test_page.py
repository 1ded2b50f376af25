"""Pages: what is written into the file. `test_page_browser` looks at them in a browser."""
from __future__ import annotations

import json
import re

import ase.build
import numpy as np
import pytest
from lj_cell import BASE

from asemd import Box, System, Topology, cli
from asemd.errors import InputError
from asemd.page import Page, Series
from asemd.page.plot import pareto, thin
from asemd.page.run import _limits
from asemd.page.snapshot import describe


def chain(n: int = 12, length: float = 10.0, **words) -> System:
    """A chain along x through the periodic face."""
    x = np.column_stack([(np.arange(n) + 0.5) % length, np.full(n, 5.0), np.full(n, 5.0)])
    bonds = np.column_stack([np.arange(n - 1), np.arange(1, n)])
    words = {"units": "lj", "atom_style": "bond", "type": 1 + np.arange(n) % 2, "mass": [np.nan, 1.0, 2.0]} | words
    topology = Topology(bonds=bonds, bond_types=np.ones(n - 1, int))
    return System(box=Box.from_lammps((0, 0, 0), (length,) * 3), x=x, topology=topology, **words)


def scripts(html: str) -> list[dict]:
    return [json.loads(m) for m in re.findall(r'<script type="application/json">(.*?)</script>', html, re.S)]


def test_a_page_needs_no_network():
    page = Page("All", "of it")
    page.curve("y", [0, 1], [2, 3])
    page.snapshot(chain())
    html = page.html()
    outside = re.findall(r'(?:src|href)\s*=\s*["\']?(?!#|data:)[^"\'> ]+', html.split("application/gzip")[0])
    assert not outside and "@import" not in html and "url(" not in html
    assert "BSD-3-Clause" in html


def test_libraries_come_only_with_what_needs_them():
    plain, curve, molecule = Page("a"), Page("b"), Page("c")
    curve.curve("y", [0, 1], [2, 3])
    molecule.snapshot(chain())
    assert "data-library=" not in plain.html() and len(plain.html()) < 30_000
    assert 'library="3Dmol' not in curve.html() and 'library="vega' not in molecule.html()


def test_text_is_not_markup():
    nasty = "</script><img src=x onerror=alert(1)>"
    page = Page(nasty, nasty)
    page.section(nasty)
    page.text(f"**bold** {nasty}")
    page.warning(nasty)
    page.facts({nasty: nasty})
    page.table([nasty], [[nasty]], nasty, nasty)
    page.curve(nasty, [0, 1], {nasty: [1, 2]}, nasty, nasty, note=nasty)
    page.bars(nasty, {nasty: 1.0})
    page.snapshot(chain(labels={"atom": {1: nasty}}), nasty)
    html = page.html()
    assert "<img" not in html and "<strong>bold</strong>" in html
    assert html.count("</script>") == html.count("<script")
    assert any(nasty in json.dumps(s) for s in scripts(html))


def test_thin_curves_keep_their_extremes():
    rng = np.random.default_rng(1)
    y = rng.normal(size=100_000)
    y[777], y[50_001], y[1234] = 40.0, -50.0, np.nan
    keep = thin(np.arange(y.size), y)
    assert len(keep) <= 800 and {0, 777, 50_001, y.size - 1} <= set(keep.tolist()) and (np.diff(keep) > 0).all()
    assert thin(np.arange(5), np.full(5, np.nan)).tolist() == [0, 1, 2, 3, 4]


def test_gaps_and_infinities_are_written_as_json():
    page = Page("x")
    page.curve("y", [0, 1, 2], [1.0, np.nan, np.inf])
    values = scripts(page.html())[0]["spec"]["data"]["values"]
    assert [v["y"] for v in values] == [1.0, None, None]


def test_pareto_front():
    rng = np.random.default_rng(0)
    x, y = rng.random((2, 200))
    front = set(pareto(x, y).tolist())
    for i in range(200):
        beaten = ((x <= x[i]) & (y <= y[i]) & ((x < x[i]) | (y < y[i]))).any()
        assert (i in front) is not bool(beaten)


def test_loglog_shows_front_bands_floor_and_names():
    page = Page("x")
    series = [Series("timestep", [1, 2, 4, 0], [4e-3, 1e-3, 2e-4, 1e-9], labels=["4", "2", "1", "none"]),
              Series("skin", [3, 5], [3e-3, 3e-3], low=[2e-3, 2e-3], high=[5e-3, 5e-3])]
    plot = page.loglog("work", series, "seconds", "error", front=True, floor=1e-4, here=(2, 1e-3, "script"))
    assert len(plot.spec["data"]["values"]) == 5        # the point at zero seconds has no place
    fronts = [part for part in plot.spec["layer"] if part["mark"].get("strokeDash")]
    assert [(p["x"], p["y"]) for p in fronts[0]["data"]["values"]] == [(1, 4e-3), (2, 1e-3), (4, 2e-4)]
    kinds = [part["mark"]["type"] for part in plot.spec["layer"]]
    assert "rect" in kinds and "area" in kinds and "text" in kinds


def test_mistakes_are_named():
    page = Page("x")
    with pytest.raises(InputError, match="row has 1 cells for 2 columns"):
        page.table(["a", "b"], [["1"]])
    with pytest.raises(InputError, match="curve 'p' of 'y' has 3 values for 2 places"):
        page.curve("y", [0, 1], {"p": [1, 2, 3]})
    with pytest.raises(InputError, match="no point is positive"):
        page.loglog("y", [Series("a", [0.0], [1.0])])
    with pytest.raises(InputError, match="one length"):
        page.loglog("y", [Series("a", [1.0, 2.0], [1.0])])
    with pytest.raises(InputError, match="cannot write"):
        page.write("no/such/folder/page.html")


def test_plots_for_papers(tmp_path):
    pytest.importorskip("vl_convert", reason="static plots need vl-convert-python")
    page = Page("x")
    page.curve("A curve", [0, 1, 2], {"one": [1, 2, 3], "two": [3, 2, 1]}, "step", "energy")
    page.loglog("Work", [Series("a", [1, 2], [1e-3, 1e-4])], front=True, floor=1e-5)
    page.bars("Timing", {"Pair": 3.0, "Neigh": 1.0}, "seconds")
    made = {p.name: p for p in page.save_plots(tmp_path / "plots")}
    assert sorted(made) == ["01-a-curve.png", "01-a-curve.svg", "02-work.png", "02-work.svg", "03-timing.png", "03-timing.svg"]
    text = made["01-a-curve.svg"].read_text()
    assert text.startswith("<svg") and "energy" in text and "A curve" in text and "#4477aa" in text
    assert made["03-timing.png"].read_bytes().startswith(b"\x89PNG") and made["02-work.png"].stat().st_size > 5000
    with pytest.raises(InputError, match=r"\.svg, \.png or \.pdf"):
        page.plots[0].save(tmp_path / "x.gif")


# ------------------------------------------------------------------------------------------------------------------ snapshots ---

def test_bonds_through_a_face_are_not_drawn_through_the_box():
    data = describe(chain())
    assert data["crossing"] == [9]          # from 9.5 to 10.5, which is at 0.5
    scale = 60.0 / 10.0
    assert data["toward"] == [[10.0 * scale, 0.0, 0.0]] and data["spacing"] == pytest.approx(scale)
    assert [k[0] for k in data["kinds"]] == ["type 1", "type 2"] and [k[3] for k in data["kinds"]] == [6, 6]
    assert len(data["edges"]) == 12 and not data["flat"]


def test_atoms_outside_the_box_are_shown_in_it():
    system = chain()
    system.x[:, 0] += 30.0
    assert describe(system) == describe(chain())


def test_elements_have_their_colours():
    data = describe(ase.build.molecule("CH3CH2OH", vacuum=3.0))
    colours = {name.split()[0]: colour for name, colour, _, _ in data["kinds"]}
    assert set(colours) == {"C", "H", "O"} and colours["O"][1:3] > "e0" and colours["O"][3:5] < "20"


def test_flat_and_empty_scenes():
    flat = chain(dimension=2)
    data = describe(flat)
    assert data["flat"] and len(data["edges"]) == 4
    nothing = System(units="lj", atom_style="atomic", box=Box.from_lammps((0, 0, 0), (4, 4, 4)), x=np.zeros((0, 3)), type=np.zeros(0, int),
                     mass=[np.nan, 1.0])
    data = describe(nothing)
    assert data["n"] == 0 and data["kinds"] == [] and len(data["edges"]) == 12
    for system in (flat, nothing):
        page = Page("x")
        page.snapshot(system)
        assert "<script" in page.html()


def test_lengths_of_any_size():
    small = chain()
    small.x *= 1e-10
    small.box = Box.from_lammps((0, 0, 0), (1e-9,) * 3)
    assert describe(small)["corners"] == describe(chain())["corners"]


def test_of_very_many_atoms_a_part_is_shown():
    n = 250_000
    rng = np.random.default_rng(0)
    system = System(units="lj", atom_style="atomic", box=Box.from_lammps((0, 0, 0), (60, 60, 60)), x=rng.random((n, 3)) * 60.0,
                    type=np.ones(n, int), mass=[np.nan, 1.0])
    data = describe(system)
    assert data["of"] == n and 60_000 < data["n"] <= 100_000 and len(json.dumps(data)) < 3_000_000
    pairs = np.arange(n).reshape(-1, 2)
    system.topology, system.molecule = Topology(bonds=pairs, bond_types=np.ones(len(pairs), int)), 1 + np.arange(n) // 2
    data = describe(system)
    assert data["n"] <= 100_002 and len(data["bonds"]) > 200_000       # whole molecules, with their bonds


def test_size_of_32000_bonded_atoms(tmp_path):
    n, rng = 32_000, np.random.default_rng(0)
    bonds = np.column_stack([np.arange(n - 1), np.arange(1, n)])
    system = System(units="lj", atom_style="bond", box=Box.from_lammps((0, 0, 0), (34, 34, 34)), x=rng.random((n, 3)) * 34.0,
                    type=1 + np.arange(n) % 4, id=rng.permutation(n) + 1, mass=[np.nan, 1, 1, 1, 1],
                    topology=Topology(bonds=bonds, bond_types=np.ones(n - 1, int)))
    page = Page("big")
    page.snapshot(system)
    for k in range(14):
        page.curve(f"curve {k}", np.arange(50_000), rng.normal(size=50_000))
    assert page.write(tmp_path / "big.html").stat().st_size < 5_000_000


# ------------------------------------------------------------------------------------------------------- asemd run --html ---

@pytest.mark.parametrize("script, words", [
    ("units lj\n", ["Atoms</dt><dd>none", "Wall time"]),
    (BASE, ["Snapshot", "Plan", "Left out"]),
    (BASE.replace("fix 1 all nve", "") + "run 3\n", ["No fix moves the atoms", "no fixes with time integration", "Timing"]),
    (BASE + "fix 2 all langevin 1 1 1 77\nthermo 2\nrun 8\n", ["fix 2 (langevin)", "is not counted"]),
    (BASE + "thermo 1\nrun 2\nrun 2\nrun 2\nminimize 0 0 2 9\n", ["run 3", "minimize"]),
    (BASE + "thermo 1\n" + "run 2\n" * 9, ["Conserved quantity", "9"])])
def test_page_of_a_run(tmp_path, monkeypatch, script, words):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "in.x").write_text(script)
    assert cli.main(["run", "in.x", "--quiet", "--html", "x.html"]) == 0
    text = (tmp_path / "x.html").read_text()
    assert [w for w in words if w not in text] == [] and "Page: x.html" in (tmp_path / "log.lammps").read_text()


def test_rows_that_would_flatten_a_curve_are_told_instead():
    y = np.concatenate([[9000.0, 300.0], 1.0 + 0.1 * np.sin(np.arange(100))])
    limits, note = _limits(np.arange(102) * 10.0, y, "K")
    assert 0.8 < limits[0] < 0.9 and 1.1 < limits[1] < 1.2 and note == "2 of 102 rows are beyond the plot, up to 9000 K at step 0."
    assert _limits(np.arange(100.0), np.linspace(0.0, 5.0, 100), "K") == (None, "")
    assert _limits(np.arange(5.0), np.array([9e9, 1, 1, 1, 1]), "K") == (None, "")
    assert _limits(np.arange(30.0), np.append(np.ones(29), 2.0), "K") == (None, "")


def test_a_failed_run_leaves_its_page(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "in.x").write_text(BASE + "thermo 2\nrun 4\nset atom 1 x 0.01 y 0 z 0\nset atom 2 x 0.01 y 0 z 0\nrun 10\n")
    assert cli.main(["run", "in.x", "--quiet", "--html", "x.html"]) == 1
    text = (tmp_path / "x.html").read_text()
    assert "The run ended early" in text and "Snapshot" in text and "Timing" in text
    assert capsys.readouterr().err.count("ERROR") == 1


def test_atoms_that_flew_away_leave_their_page(tmp_path, monkeypatch, capsys):
    """Two atoms almost in one place: after a step they are too far away to be drawn."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "in.x").write_text(BASE + "create_atoms 1 single 0.001 0 0\nrun 10\n")
    assert cli.main(["run", "in.x", "--quiet", "--html", "x.html"]) == 1
    text = (tmp_path / "x.html").read_text()
    assert "The run ended early" in text and "cannot be drawn" in text and "Left out" in text
    assert "no page was written" not in capsys.readouterr().err


def test_pages_that_cannot_be_written_are_refused_first(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "in.x").write_text(BASE + "run 1\n")
    for more, words in ((["--html", "no/x.html"], "--html no/x.html: cannot write"), (["--html", "."], "cannot write"),
                        (["--html", "x.html", "--dry"], "leave out --dry")):
        assert cli.main(["run", "in.x", "--quiet", *more]) == 1
        assert words in capsys.readouterr().err
    assert sorted(p.name for p in tmp_path.iterdir()) == ["in.x"]
