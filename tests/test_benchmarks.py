"""The benchmark scripts work and count right; nothing here judges a time."""
from __future__ import annotations

import math
from pathlib import Path

import pytest
from wheel import ran


@pytest.fixture
def compare(monkeypatch):
    monkeypatch.syspath_prepend(str(Path(__file__).resolve().parents[1]))
    from tests.benchmarks import compare
    return compare


def test_median_and_quartiles(compare):
    assert compare.spread([5.0, 1.0, 2.0, 4.0, 3.0]) == {"q1": 2.0, "median": 3.0, "q3": 4.0}
    assert compare.spread([7.0]) == {"q1": 7.0, "median": 7.0, "q3": 7.0}


def test_ratios_are_taken_turn_by_turn(compare):
    result = compare.rates({"a": [1.0, 2.0, 4.0], "b": [2.0, 4.0, 8.0]}, 100)
    assert result["ratio"]["b"] == {"q1": 2.0, "median": 2.0, "q3": 2.0}
    assert result["steps_per_second"]["a"]["median"] == 50.0


def test_engines_take_turns(compare):
    from tests.benchmarks import scenes
    ours = compare.Contender("asemd", "asemd")
    result = compare.alternate([ours], scenes.lj((3, 3, 3), "delay 0 every 1 check yes"), steps=4, samples=2)
    assert len(result["asemd"]) == 2 and all(0.0 < s < 60.0 for s in result["asemd"])


def test_a_failing_engine_is_reported(compare):
    with pytest.raises(RuntimeError, match="nonsense"):
        compare.alternate([compare.Contender("asemd", "asemd")], "nonsense 1", steps=1, samples=1)


def test_neighbour_time_of_a_log(compare):
    from tests.benchmarks import neighbour
    text = "Neigh   | 0.1        | 0.2        | 0.3        |   0.0 |  9.00\nNeighbor list builds = 4\n"
    assert math.isclose(neighbour.of_log(text), 50.0)


def test_part_of_a_log(compare):
    text = "Pair    | 0.5        | 0.5        | 0.5        |   0.0 |  9.00\n" \
        "Bond    | 0.1        | 0.2        | 0.3        |   0.0 |  9.00\n"
    assert math.isclose(compare.part_of_log(text, "Bond", 50), 4.0)
    assert math.isclose(compare.part_of_log(text, "Pair", 50), 10.0)


def test_table_of_cases(compare):
    """One row for each scene, of LAMMPS the fastest variant; one thread first, in the order of the cases."""
    from tests.benchmarks import cases

    def result(ours, *theirs):
        values = {"asemd": compare.spread([ours]), **{f"LAMMPS {k}": compare.spread([v]) for k, v in enumerate(theirs)}}
        return {"unit": "steps/s", "values": values, "ratio": {f"LAMMPS {k}": compare.spread([ours / v]) for k, v in enumerate(theirs)}}
    titles = [cases.CASES[name].title for name in ("chain", "lj")]
    table = cases.table({f"{titles[0]}, double, 1": result(30.0, 10.0, 15.0), f"{titles[1]}, double, 2": result(8.0, 1.0),
                         f"{titles[1]}, double, 1": result(4.0, 2.0), "neighbour list, 32,000 atoms, double, 1": result(4.0)})
    assert [row.split(" | ")[0].lstrip("| ") for row in table[2:]] == [titles[1], titles[0], "neighbour list, 32,000 atoms", titles[1]]
    assert table[3].split(" | ")[2:] == ["1", "30 steps/s", "15", "`1`", "2.00 [2.00, 2.00] |"]


def test_tables_of_pages(compare, monkeypatch, tmp_path):
    """Figures that are kept stay when others come; only the text between the marks changes."""
    from tests.benchmarks import page
    for name in ("README", "SPEED"):
        monkeypatch.setattr(page, name, tmp_path / name)
        (tmp_path / name).write_text("before\n<!-- benchmarks sizes: begin -->\nold\n<!-- benchmarks sizes: end -->\nafter\n")
    monkeypatch.setattr(page, "FILE", tmp_path / "json")
    page.keep({"other": {"memory": {"MB": 3.0}}})
    one = {"ns": {"asemd": compare.spread([50.0])}, "memory": {"asemd": 100.0}, "ratio": {}}
    page.keep({"sizes": {"1000": one, "500000": one | {"ns": {"asemd": compare.spread([60.0])}, "memory": {"asemd": 599.0}}}})
    text = (tmp_path / "SPEED").read_text()
    assert text.startswith("before\n") and text.endswith("end -->\nafter\n") and "old" not in text
    assert "| 500,000 | 60.0 | 1.67e+07 | 1000 |" in text and "1.20 times the cheapest" in text
    assert '"memory"' in (tmp_path / "json").read_text()
    monkeypatch.setattr(compare, "machine", lambda: {"cpu": "another", "vectors": "longer"})
    page.keep({"sizes": {"1000": one}})
    readme, both = (tmp_path / "README").read_text(), (tmp_path / "SPEED").read_text()
    assert readme.count("Machine:") == 1 and "cpu another" in readme         # the one that was measured last
    assert both.count("Machine:") == 2 and both.index("cpu another") < both.index("| 500,000")


def test_peptide_scene(compare, tmp_path):
    """Every category of items is there and begins near its rest: the torsions alone have energy."""
    from tests.benchmarks import peptide, scenes
    peptide.write(tmp_path / "peptide.data")
    lmp = ran(scenes.PEPTIDE.format(data=tmp_path / "peptide.data").replace("replicate 2 2 4", "") + "run 0")
    bond, angle, dihedral, improper = (lmp.get_thermo(word) for word in ("ebond", "eangle", "edihed", "eimp"))
    assert 0.0 < bond < 1.0 and 0.0 < angle < 5.0 and 0.0 < dihedral < 0.4 * 182 and 0.0 <= improper < 1e-3


def test_charged_peptide(compare, tmp_path):
    """Neutral, every pair of types has coefficients, and the rigid bonds are those of hydrogen atoms."""
    from tests.benchmarks import peptide, scenes
    rigid = peptide.write(tmp_path / "p.data", charged=True)
    lmp = ran(scenes.PROTEIN_STYLES.replace("coul/long", "coul/charmm").replace("kspace_style pppm 1.0e-4\n", "")
              + f"read_data {tmp_path / 'p.data'}\nvariable q equal charge(all)\n"
              f"fix 1 all shake 0.0001 10 100 b {' '.join(map(str, rigid['b']))} a {' '.join(map(str, rigid['a']))}")
    assert abs(lmp.extract_variable("q")) < 1e-12
    bonds, types = lmp.scene.system.topology.items("bond")
    light = lmp.scene.system.atom_masses() < 2.0
    assert len(rigid["a"]) == 1 and ([abs(t) in rigid["b"] for t in types] == light[bonds].any(axis=1)).all()


def test_watchdog_is_timed(compare):
    from tests.benchmarks import watchdog
    script, _ = watchdog.SCENES["LJ, 500 atoms"]
    assert 0.0 < watchdog.share(script, 200) < 50.0


def test_trees_of_the_source_take_turns(compare, tmp_path):
    from tests.benchmarks import scenes, trees
    root = Path(__file__).resolve().parents[1]
    script = tmp_path / "in.lj"
    script.write_text(scenes.lj((3, 3, 3), "delay 0 every 1 check yes"))
    (least, ratios), (other, others) = trees.measure([root, root], script, 4, "double", 2, 2)
    assert ratios == [1.0, 1.0] and len(others) == 2 and all(0.0 < seconds < 60.0 for seconds in (least, other, *others))
