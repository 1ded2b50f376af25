"""The older computes of molecules give what today's computes of compressed chunks give, and say what is wrong with their words."""
from __future__ import annotations

import numpy as np
import pytest
from test_compute_chunk_lammps import FIRST, START, TILTED, write_data
from wheel import ran

from asemd.errors import InputError

PAIRS = {"com/molecule": "com/chunk c", "inertia/molecule": "inertia/chunk c", "gyration/molecule": "gyration/chunk c",
         "gyration/molecule tensor": "gyration/chunk c tensor", "property/molecule mol count": "property/chunk c id count",
         "property/molecule count": "property/chunk c count", "atom/molecule v_along c_k": "reduce/chunk c sum v_along c_k",
         "msd/molecule": "msd/chunk c"}


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    data = tmp_path_factory.mktemp("molecules") / "data"
    write_data(data, (3.0, -2.0, 1.5))
    lmp = ran(START.format(data=data))
    lmp.commands_string("compute k all ke/atom\ncompute c some chunk/atom molecule compress yes")
    for k, (old, new) in enumerate(PAIRS.items()):
        lmp.commands_string(f"compute old{k} some {old}\ncompute new{k} some {new}")
    lmp.command("run 6")
    return lmp


@pytest.mark.parametrize("k", range(len(PAIRS)), ids=list(PAIRS))
def test_molecules_are_chunks(k, scene):
    kind = "vector" if list(PAIRS)[k] in ("gyration/molecule", "property/molecule count") else "array"
    old, new = (np.asarray(getattr(scene.session.moment, kind)(f"{name}{k}")) for name in ("old", "new"))
    assert old.shape == new.shape and len(old) == 15 and abs(old).max() > 0.0
    assert np.allclose(old, new, rtol=1e-14, atol=0.0)


@pytest.mark.parametrize(("words", "message"), [
    ("com/molecule 1", "0 values"), ("gyration/molecule tensr", "one keyword, tensor"), ("property/molecule", "at least one"),
    ("property/molecule cout", "did you mean count"), ("atom/molecule", "at least one value"), ("atom/molecule c_new0[1]", "per-atom"),
    ("reduce", "1 value"), ("reduce som x", "did you mean sum"), ("reduce sum", "at least one value"),
    ("reduce sum x replace 1 2", "min or max"),
    ("reduce min x y replace 1 3", "two values"), ("reduce sum c_nope", "no compute nope"), ("reduce sum q_x", "not a value"),
    ("reduce sum x c_b", "all per-atom or all local"), ("reduce sum v_nope", "undefined variable"),
    ("reduce/region nope sum x", "unknown region"),
    ("property/atom", "at least one"), ("property/atom idd", "did you mean id"), ("property/atom radius", "no radius"),
    ("chunk/atom", "1 value"), ("chunk/atom molecul", "did you mean molecule"), ("chunk/atom molecule discard mixed", "bins only"),
    ("chunk/atom molecule compres yes", "did you mean compress"), ("chunk/atom bin/1d x lower 1 units box", "units reduced"),
    ("chunk/atom bin/1d x lower 0 units reduced", "thicker than 0"),
    ("chunk/atom bin/2d x lower 0.1 x lower 0.1 units reduced", "given once"),
    ("chunk/atom bin/sphere 0 0 0 0.2 0.1 3 units reduced", "rmin < rmax"), ("chunk/atom molecule limit 3", "max or exact"),
    ("chunk/atom c_new0", "per-atom"), ("com/chunk", "chunkID"), ("com/chunk k", "not chunk/atom"), ("com/chunk c 1", "besides"),
    ("gyration/chunk c tensr", "did you mean tensor"), ("gyration/shape c", "style gyration"),
    ("gyration/shape/chunk new2", "keyword tensor"),
    ("property/chunk c coord1", "no coord1"), ("property/chunk c cont", "did you mean count"),
    ("reduce/chunk c ave c_k", "expected one of"),
    ("chunk/spread/atom c v_along", "neither"), ("chunk/spread/atom c", "at least one"), ("dipole mas", "did you mean mass"),
    ("msd cm yes", "did you mean com"), ("msd com", "1 value"), ("msd/nongauss average yes", "unknown keyword"), ("vacf 1", "no arguments"),
    ("displace/atom refresh nope", "undefined variable"), ("event/displace 0", "positive"), ("count/type atoms", "did you mean atom"),
    ("slice 1 0 1 c_new2", "Nstart <= Nstop"), ("slice 1 2 1 c_k", "no vector"), ("global/atom c_k", "at least one value"),
    ("temp/partial 1 1", "3 values"), ("temp/partial 1 2 1", "0 or 1"), ("temp/ramp vx 0 1 x 0", "6 values"),
    ("temp/ramp vx 0 1 x 2 2", "differ"),
    ("temp/ramp vq 0 1 x 2 3", "expected one of"), ("temp/region nope", "unknown region"), ("temp/profile 0 0 0 x 2", "at least one"),
    ("temp/profile 1 1 1 zz 2", "expected one of"), ("temp/profile 1 1 1 xy 2", "2 values"), ("temp/profile 1 1 1 x 0", "at least 1 bin"),
    ("temp/profile 1 1 1 x 2 out bins", "did you mean bin"), ("temp/chunk c tmp", "did you mean temp"),
    ("temp/chunk c com yes bias thermo_temp", "no bias"),
    ("temp/com 1", "no arguments"),
])
def test_errors(words, message, scene):
    if "b" not in scene.session.scene.computes:
        scene.command("compute b all bond/local dist")
    with pytest.raises(InputError, match=message) as e:
        scene.command(f"compute bad all {words}")
    assert "\n" not in str(e.value) and "bad" not in scene.session.scene.computes


def test_words_make_the_same_compute_again(tmp_path):
    data = tmp_path / "data"
    write_data(data, (3.0, -2.0, 1.5))
    lmp = ran(START.format(data=data))
    computes = FIRST | TILTED | {f"old{k}": (f"all {old.replace('c_k', 'c_ke')}", []) for k, old in enumerate(PAIRS)}
    for id, (words, _) in computes.items():
        lmp.command(f"compute {id} {words}")
        made = lmp.session.scene.computes[id]
        again = made.to_lammps()
        lmp.command(f"compute again {made.group} {made.style} {' '.join(again)}")
        assert lmp.session.scene.computes["again"].to_lammps() == again, id
        lmp.command("uncompute again")
    lmp.close()
