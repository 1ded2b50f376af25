"""asemd styles: every name of the inventory as done, partial or missing, from the code."""
from __future__ import annotations

import json
from pathlib import Path

import pytest

from asemd import cli, registry, style
from asemd.errors import InputError
from asemd.lammps import catalog
from asemd.lammps.catalog import inventory
from asemd.lammps.coverage import CATALOG, OTHERWISE, PARTIAL, REFUSED, categories, counts, coverage, present


def test_inventory_is_complete_and_unique():
    rows = inventory()
    assert len(rows) > 500 and set(rows[0]) == {"category", "style", "tier", "origin", "in_wheel"}
    assert len({(r["category"], r["style"]) for r in rows}) == len(rows)
    assert {"pair", "fix", "compute", "command", "bond", "units", "variable", "min_style", "run_style"} <= set(categories())


def test_states_follow_from_the_code():
    state = {(n.category, n.style): n.state for n in coverage()}
    assert state["pair", "lj/cut"] == "done" and state["fix", "nve"] == "done" and state["command", "run"] == "done"
    assert state["command", "atom_modify"] == "partial" and state["units", "real"] == "done" and state["min_style", "cg"] == "done"
    assert state["command", "kspace_modify"] == "done" and state["bond", "bpm/rotational"] == "missing"
    assert {name for name in PARTIAL if state[name] != "extra"} == {name for name, how in state.items() if how == "partial"}
    assert state["pair", "zero"] == "extra" and state["run_style", "verlet"] == "done" and state["atom", "full"] == "done"
    assert [state[name] for name in (("kspace", "none"), ("region", "delete"), ("variable", "delete"))] == ["done"] * 3
    for category in catalog.FORCE_FIELD:
        assert set(style.names(category)) <= {s for (c, s), how in state.items() if c == category and how != "missing"}
    for category in ("fix", "compute", "dump", "region", "command", "min_style"):
        named = set(catalog.names(CATALOG.get(category, category))) - {s for c, s in REFUSED if c == category}
        assert named | OTHERWISE.get(category, set()) == present(category)


def test_reasons_belong_to_names_that_exist():
    for category, name in PARTIAL:
        assert name in present(category), f"{category} {name} is called partial but does not exist"
    known = {(r["category"], r["style"]) for r in inventory()}
    for category, name in REFUSED:
        assert (category, name) in known and name not in present(category)
    assert all(n.note for n in coverage(state="partial"))


@pytest.mark.parametrize("category", [*catalog.FORCE_FIELD, "kspace"])
def test_styles_are_of_lammps(category):
    """A name of our own could be one that LAMMPS gives to something else later."""
    assert {(category, name) for name in catalog.names(category)} <= registry.of_lammps()
    newer = [line.split(",") for line in (Path(registry.__file__).parent / "newer.csv").read_text().split()[1:]]
    assert not {tuple(row) for row in newer} & {(r["category"], r["style"]) for r in inventory()}


def test_counts_add_up():
    by_state = counts(coverage("pair"))["pair"]
    assert sum(by_state.values()) - by_state["extra"] == sum(r["category"] == "pair" for r in inventory())


def test_filters():
    assert {n.style for n in coverage("fix", "temp/", "done")} >= {"temp/berendsen", "temp/rescale"}
    assert all(n.state == "missing" for n in coverage(state="missing"))
    with pytest.raises(InputError, match="did you mean dihedral"):
        coverage("dihedrl")
    with pytest.raises(InputError, match="did you mean done"):
        coverage(state="dnoe")


def test_command(capsys):
    assert cli.main(["styles"]) == 0
    out = capsys.readouterr().out
    assert "lj/cut" in out and "atom_modify*" in out
    assert out.splitlines()[1].split() == ["category", "done", "partial", "missing", "extra", "all"]
    assert cli.main(["styles", "--json", "dihedral", "--word", "table"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert [n["style"] for n in answer["names"]] == ["table", "table/cut"] and answer["counts"]["dihedral"]["done"] == 1
    assert cli.main(["styles", "dihedrl"]) == 1
    assert "did you mean dihedral" in capsys.readouterr().err
