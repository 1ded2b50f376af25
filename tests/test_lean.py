"""What it saves to leave things out: both forms of a scene are the same scene, and the documentation shows what was measured."""
from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest


@pytest.fixture
def lean(monkeypatch):
    monkeypatch.syspath_prepend(str(Path(__file__).resolve().parents[1]))
    from tests.benchmarks import lean
    return lean


@pytest.mark.parametrize("which", [1, 3])
def test_both_forms_have_the_same_energy(lean, monkeypatch, which):
    scene = lean.five(small=True)[which]
    monkeypatch.setattr(lean, "five", lambda small: [scene])
    found, = lean.measure(steps=5, samples=1, small=True).values()
    assert found["lean"]["median"] > 0.0 and found["full"]["energy"] == pytest.approx(found["lean"]["energy"], rel=lean.AGREE)


def test_another_scene_is_noticed(lean, monkeypatch):
    scene = replace(lean.five(small=True)[1], strong=("lj/cut/coul/cut 2.5", "1 1"))
    monkeypatch.setattr(lean, "five", lambda small: [scene])
    with pytest.raises(AssertionError, match="not the same scene"):
        lean.measure(steps=1, samples=1, small=True)


def test_the_page_shows_the_figures(lean):
    found = json.loads(lean.FILE.read_text())
    assert len(found["scenes"]) == 5 == len(lean.five())
    assert lean.into_page(lean.PAGE.read_text(), found) == lean.PAGE.read_text()
    assert found["scenes"]["bonded chains without pairs"]["ratio"]["median"] > 3.0
