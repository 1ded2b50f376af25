"""kspace_modify: every keyword with its values, what is refused, and how the settings travel."""
from __future__ import annotations

import pytest
from wheel import ask, ran

from asemd import cli
from asemd.errors import InputError
from asemd.forcefield import Interactions
from asemd.kspace_settings import DEFAULTS, parse, to_words
from asemd.lammps.export import commands
from asemd.lammps.restart import force_field, interactions

GOOD = {
    "": {}, "mesh 10 8 6": {"mesh": (10, 8, 6)}, "mesh 0 0 0": {"mesh": (0, 0, 0)},
    "mesh/disp 10 10 10": {"mesh/disp": (10, 10, 10)}, "order -3": {"order": -3}, "order/disp 0": {"order/disp": 0},
    "minorder 2": {"minorder": 2}, "overlap on": {"overlap": True}, "force -2": {"force": -2.0}, "gewald 0.3": {"gewald": 0.3},
    "gewald/disp -1": {"gewald/disp": -1.0}, "slab 3.0": {"slab": 3.0}, "slab nozforce": {"slab": "nozforce"},
    "slab ew2d": {"slab": "ew2d"}, "wire 3": {"wire": 3.0}, "compute no": {"compute": False},
    "cutoff/adjust no": {"cutoff/adjust": False}, "fftbench yes": {"fftbench": True}, "collective yes": {"collective": True},
    "diff ad": {"diff": "ad"}, "kmax/ewald 0 5 5": {"kmax/ewald": (0, 5, 5)}, "mix/disp geom": {"mix/disp": "geom"},
    "force/disp/real 1e-4": {"force/disp/real": 1e-4}, "force/disp/kspace 0": {"force/disp/kspace": 0.0},
    "splittol -1": {"splittol": -1.0}, "pressure/scalar no": {"pressure/scalar": False}, "disp/auto yes": {"disp/auto": True},
    "order 4 order 6": {"order": 6}}
BAD = {
    "mesh 1 2": "mesh needs 3 values", "mesh 0 1 1": "all 0 or all positive", "mesh -1 -1 -1": "all 0 or all positive",
    "mesh 1.5 1 1": "whole", "mesh/disp 0 3 3": "mesh/disp: the three", "order": "order needs 1 value", "order x": "whole number",
    "order 5 gewald": "gewald needs", "minorder 1": "at least 2", "overlap maybe": "yes or no", "force x": "number",
    "gewald nan": "finite", "slab 1.0": "larger than 1", "slab x": "nozforce or ew2d", "slab 0.5": "larger than 1",
    "wire nozforce": "number", "wire 1": "larger than 1", "compute x": "yes or no", "diff x": "ad ik", "diff none": "ad ik",
    "kmax/ewald -1 -1 -1": "negative", "kmax/ewald 1 1": "3 values", "mix/disp x": "pair geom none", "splittol 1": "smaller than 1",
    "order/split 5": "unknown kspace_modify keyword", "eps 0.5": "unknown", "foo 1": "unknown", "nozforce": "unknown"}


def test_values_and_the_way_back():
    for text, expected in GOOD.items():
        assert parse(text.split()) == expected, text
        assert parse(to_words(expected)) == expected, text
    assert parse([w for key, value in DEFAULTS.items() if value is not None and key not in ("slab", "wire")
                  for w in to_words({key: value})]).keys() >= DEFAULTS.keys() - {"order", "slab", "wire"}


@pytest.mark.parametrize("text", BAD)
def test_mistakes(text):
    with pytest.raises(InputError, match=BAD[text]):
        parse(text.split())


def test_the_same_is_refused_as_in_lammps():
    texts = [*GOOD, *BAD]
    refused = ask("""
lmp = ran(["atom_style charge", "region b block 0 10 0 10 0 10", "create_box 1 b", "pair_style coul/long 4"])
answer = []
for text in given["texts"]:
    try:
        lmp.command("kspace_style pppm 1e-4")
        lmp.command("kspace_modify " + text)
        answer.append(0)
    except Exception:
        answer.append(1)
""", texts=texts)
    assert list(refused) == [0] * len(GOOD) + [1] * len(BAD)


def test_settings_travel_and_end_with_the_style(tmp_path):
    lmp = ran(["region b block 0 4 0 4 0 4", "create_box 1 b", "create_atoms 1 single 1 1 1", "mass 1 1"])
    scene = lmp.session.scene
    scene.interactions.kspace = "pppm 1e-4"     # no such style exists yet
    lmp.command("kspace_modify mesh 8 8 8 gewald 0.25")
    lmp.command("kspace_modify compute no")
    said = {"mesh": (8, 8, 8), "gewald": 0.25, "compute": False}
    assert scene.interactions.kspace_modify == said
    assert interactions(force_field(scene.interactions), "").kspace_modify == said
    written = commands(scene.system, scene.interactions, data=tmp_path / "data")
    at = written.index("kspace_style pppm 1e-4")
    assert written[at + 1] == "kspace_modify mesh 8 8 8 gewald 0.25 compute no"
    lmp.command("kspace_style none")
    assert scene.interactions.kspace_modify == {} == Interactions().kspace_modify
    with pytest.raises(InputError, match="before a kspace_style"):
        lmp.command("kspace_modify mesh 8 8 8")


def test_dry_tells_mistakes_in_both_lines(tmp_path, capsys):
    script = tmp_path / "in.x"
    script.write_text("units real\nkspace_style pppn 1e-4\nkspace_modify order 4\nkspace_modify ordr 5\n")
    assert cli.main(["run", "--dry", str(script)]) == 1
    err = capsys.readouterr().err
    assert "did you mean pppm" in err and "did you mean order" in err and "before a kspace_style" not in err and err.count("ERROR") == 2
