"""The benchmark scripts work and count right; nothing here judges a time."""
from __future__ import annotations

import math
from pathlib import Path

import pytest


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


def test_bonded_time_of_a_log(compare):
    from tests.benchmarks import run_bonded
    text = "Bond    | 0.1        | 0.2        | 0.3        |   0.0 |  9.00\n"
    assert math.isclose(run_bonded.of_log(text, 50), 4.0)


def test_peptide_scene(compare, tmp_path):
    """Every category of items is there and begins near its rest: the torsions alone have energy."""
    from asemd.lammps import Lammps
    from tests.benchmarks import peptide, scenes
    peptide.write(tmp_path / "peptide.data")
    lmp = Lammps(cmdargs=["-screen", "none", "-log", "none"])
    lmp.commands_string(scenes.PEPTIDE.format(data=tmp_path / "peptide.data").replace("replicate 2 2 4", "") + "run 0")
    bond, angle, dihedral, improper = (lmp.get_thermo(word) for word in ("ebond", "eangle", "edihed", "eimp"))
    assert 0.0 < bond < 1.0 and 0.0 < angle < 5.0 and 0.0 < dihedral < 0.4 * 182 and 0.0 <= improper < 1e-3


def test_watchdog_is_timed(compare):
    from tests.benchmarks import watchdog
    script, _ = watchdog.SCENES["LJ, 500 atoms"]
    assert 0.0 < watchdog.share(script, 200) < 50.0
