"""Digits of many-body potentials: energies and forces against the same formulas with 40 digits."""
from __future__ import annotations

import pytest
from test_manybody import CASES, COEFF, FOLDER, uncompiled, write_densities, write_tables
from wheel import ask

pytest.importorskip("mpmath")
# the plain Python of a style's kernel runs on arrays of mpmath's numbers
DIGITS = r"""
import json, sys, types, warnings
import mpmath
import numpy as np
from asemd import style
from asemd.kernels import manybody
from asemd.lammps import Lammps
from asemd.manybody_term import ManyBodyTerm
warnings.simplefilter("ignore")
mpmath.mp.dps = 40
many = types.SimpleNamespace(**{n: getattr(mpmath, n) for n in "sqrt exp log cos sin acos atan2 pi inf nan".split()}, pow=mpmath.power,
                             floor=lambda x: int(mpmath.floor(x)))

def exact(value):
    if isinstance(value, np.ndarray) and value.dtype == float:
        return np.frompyfunc(mpmath.mpf, 1, 1)(value)
    return type(value)(map(exact, value)) if type(value) is tuple else value

answer = {}
for name, lines in json.load(sys.stdin).items():
    lmp = Lammps(cmdargs=["-screen", "none", "-log", "none"])
    lmp.commands_list(lines)
    engine, found = lmp.session.loop.engine, style.find("pair", name.split()[0])
    result, n = engine.compute(), engine.system.n
    term = next(t for t in engine.terms if isinstance(t, ManyBodyTerm))
    arguments = [exact(a) for a in term.arguments(engine, 0, True)[:-1]]
    f, acc = arguments[1], arguments[-4]
    f[:], acc[:] = mpmath.mpf(0), mpmath.mpf(0)
    modules = {sys.modules[g.__module__] for g in (found.site or found.forces, *found.helpers, manybody.site_forces)}
    before = [(module, dict(vars(module))) for module in modules]
    for module in modules:
        vars(module).update(math=many, ENERGY=True, **{g.__name__: g for g in found.helpers}, **found.kernel_constants)
    manybody.site = found.site
    (manybody.site_forces if found.site else found.forces)(*arguments, engine.meeting)
    want = f[:3, engine.slot_of[:n]].T
    largest = max(abs(want).max(), abs(acc[0]) / n)
    answer[name] = [float(abs(result.potential - acc[0]) / n / largest), float(abs(exact(result.forces) - want).max() / largest)]
    for module, names in before:
        vars(module).update(names)
print(json.dumps(answer))
"""


def cluster(name: str, folder) -> list[str]:
    """Eight atoms at random in a box without periods."""
    file, elements, a = CASES[name]
    n = len(elements.split())
    return ["units metal", "boundary f f f", f"lattice diamond {a}", "region box block -5 7 -5 7 -5 7", f"create_box {n} box",
            "region some block 0 0.9 0 0.9 0 0.9", "create_atoms 1 region some " + " ".join(f"basis {k + 1} {k % n + 1}" for k in range(8)),
            "mass * 28", "displace_atoms all random 0.2 0.2 0.2 4711", f"pair_style {name}",
            *(f"pair_coeff {c}".replace("HERE", str(folder)) for c in COEFF.get(name, [f"* * {file} {elements}"])), "run 0 post no"]


def test_digits(tmp_path):
    write_tables(tmp_path)
    write_densities(tmp_path)
    found = uncompiled(DIGITS, {name: cluster(name, tmp_path) for name in CASES}, ask(FOLDER + "answer = P"))
    for name, errors in found.items():
        assert max(errors) < 1e-13, (name, errors)
