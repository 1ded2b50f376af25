"""Checks that any bonded style must pass: `check_style` runs them on a registered style or on one of your own.

>>> from asemd import style
>>> from asemd.testing.styles import check_style
>>> check_style(style.find("bond", "harmonic"))
"""
from __future__ import annotations

import math
import re
import tempfile
from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np

from asemd.errors import InputError
from asemd.kernels import bonded, curvature
from asemd.kernels.state import Cell, cell_arrays
from asemd.result import COMPONENTS
from asemd.style import Packed, Style
from asemd.testing import digits
from asemd.testing.function import check_function, constants, example, example_words
from asemd.topology import ATOMS

ITEMS = 12
BOX = 40.0
STEP = 3e-5


@dataclass
class Answer:
    """What one kernel call gives for the items of a `Sample`."""

    forces: np.ndarray            # (3, n)
    acc: np.ndarray               # (8,)
    energies: np.ndarray          # (n,) per atom
    virials: np.ndarray           # (6, n) per atom
    bad: np.ndarray               # (4,)

    @property
    def items(self) -> np.ndarray:
        """Energy of each item."""
        return self.energies.reshape(ITEMS, -1).sum(axis=1)


@dataclass
class Sample:
    """Twelve separate items of one type at random, inside the domain of the style."""

    style: Style
    packed: Packed
    x: np.ndarray = field(default=None)
    cell: Cell = field(default_factory=lambda: cell_arrays(np.eye(3) * BOX, np.ones(3, bool)))

    def run(self, x=None, loop=None, cell=None, energy=True, per_atom=True, periodic=False, orthogonal=True) -> Answer:
        x = np.ascontiguousarray(self.x if x is None else x)
        loop = loop or bonded.kernel(self.style, energy=energy, per_atom=per_atom, periodic=periodic, orthogonal=orthogonal)
        k, n = ATOMS[self.style.category], x.shape[1]
        out = Answer(np.zeros_like(x), np.zeros(8), np.zeros(n), np.zeros((6, n)), np.zeros(4))
        arrays = self.packed.arrays
        if self.style.remembers:     # reference lengths, atoms at rest
            history = np.zeros((n // k, 6))
            history[:, 0] = np.linspace(0.9, 1.2, n // k)
            arrays = (*arrays, history, np.zeros_like(x), np.zeros(2))
        loop(x, out.forces, np.arange(n, dtype=np.int32).reshape(-1, k), np.ones(n // k, np.int32), cell or self.cell, self.packed.coeff,
             arrays, 0, n // k, out.acc, out.energies, out.virials, out.bad)
        return out


def sample(style: Style, seed: int = 7) -> Sample:
    """Random items with the example coefficients; bonds about as long as their rest length."""
    packed, length = example(style)
    out = Sample(style, packed)
    rng = np.random.default_rng(seed)
    k, good = ATOMS[style.category], []
    for _ in range(50 * ITEMS):
        steps = rng.normal(size=(3, k))
        steps *= length * rng.uniform(0.75, 1.3, k) / np.linalg.norm(steps, axis=0)
        item = np.cumsum(steps, axis=1) + rng.uniform(0.2 * BOX, 0.8 * BOX, (3, 1))
        if not out.run(item).bad[0]:
            good.append(item)
        if len(good) == ITEMS:
            out.x = np.concatenate(good, axis=1)
            return out
    raise AssertionError(f"{style}: the example coefficients leave nearly every geometry outside the domain")


def twin(style: Style, *, energy: bool, per_atom: bool = False, **variant) -> dict:
    """The same as plain Python: `loop`, and `evaluate`, the function of the style for what `asemd.kernels.bonded.chart` names."""
    found: dict = {}
    for source in (bonded.loop_source(style, **variant), bonded.source(style, energy=energy)):
        exec(compile(re.sub(r"(?m)^@(njit|block_function).*$", "", source.source()), f"<{style.name}>", "exec"), found)
    run, found["madd"] = found["loop"], lambda a, b, c: a * b + c

    def loop(x, out, items, types, cell, coeff, arrays, *rest):
        th = SimpleNamespace(level=2 if per_atom else int(energy))
        with np.errstate(all="ignore"):
            run(th, x, out, items, types, cell, coeff, bonded.arrays(style, arrays), *rest, [found["evaluate"]] * 2, bonded.room(style))

    def evaluate(*values):
        *coordinates, kind, coeff, arrays = values
        numbers, tables = iter(coeff[:, kind]), iter(arrays)
        given = dict(zip(bonded.chart(style), coordinates)) | {"chi": abs(values[0]), "rate": 0.0, "reference": 1.0}
        given |= {n: next(tables) if n in style.arrays else next(numbers) for n in style.arguments}
        e, *slopes = found["potential"](*(given[n] for n in style.coordinates + style.arguments))
        by = dict(zip(style.coordinates, slopes))
        if "chi" in by:
            by["phi"] = math.copysign(1.0, values[0]) * by["chi"]
        return (e, *(by.get(n, 0.0) for n in bonded.chart(style)))
    return {"loop": loop, "evaluate": evaluate}


def _close(style: Style, what: str, got, want, tolerance: float, scale=None) -> None:
    got, want = np.asarray(got, float), np.asarray(want, float)
    scale = max(np.abs(want).max(), 1e-300) if scale is None else scale
    error = float(np.max(np.abs(got - want) / scale))
    assert error <= tolerance, f"{style}: {what}: relative error {error:.2g} is above {tolerance:g}"


def _derivative(function, step: float):
    """Central difference of fourth order (fifth order terms are left out)."""
    return (8.0 * (function(step) - function(-step)) - (function(2.0 * step) - function(-2.0 * step))) / (12.0 * step)


def check_text(style: Style) -> None:
    """Coefficients and settings survive being written and read again; a word too many and a word that is no number are refused."""
    with tempfile.TemporaryDirectory() as folder:
        words = example_words(style, folder)
        for text in {"", style.settings_example}:
            try:
                settings = style.parse_settings(text.split())
            except InputError:
                assert text == "" and any(not p.optional for p in style.settings), f"{style}: settings {text!r} are refused"
                continue
            again = style.parse_settings(style.format_settings(settings))
            assert again == settings, f"{style}: settings {settings} come back as {again}"
            coeff = style.parse_coeff(words, settings)
            back = style.parse_coeff(style.format_coeff(coeff), settings)
            assert repr(back) == repr(coeff), f"{style}: coefficients {coeff} come back as {back}"
            if style.name == "zero" and settings:
                continue
            wrong = [words + ["1.0"]] + ([["x"] + words[1:]] if words else [])
            for line in wrong:
                try:
                    style.parse_coeff(line, settings)
                except InputError:
                    continue
                raise AssertionError(f"{style}: the coefficients {' '.join(line)!r} are not refused")


def check_slope(style: Style) -> None:
    """The returned derivatives are those of the returned energy."""
    s = sample(style)
    evaluate = twin(style, energy=True)["evaluate"]
    names = bonded.chart(style)
    rng = np.random.default_rng(3)
    length = float(np.linalg.norm(s.x[:, 0] - s.x[:, 1]))
    for _ in range(20):
        values = [length * rng.uniform(0.9, 1.2) if n.startswith("r") else rng.uniform(0.2, 2.9) for n in names]
        values[0] *= rng.choice([1, -1]) if names[0] == "phi" else 1
        answer = evaluate(*values, 1, s.packed.coeff, s.packed.arrays)
        if not math.isfinite(answer[0]):
            continue
        assert len(answer) == len(names) + 1, f"{style}: the function must return the energy and {len(names)} derivatives"
        for i, name in enumerate(names):
            def energy(h, i=i, values=values):
                return evaluate(*(v + h * (j == i) for j, v in enumerate(values)), 1, s.packed.coeff, s.packed.arrays)[0]
            want = _derivative(energy, 0.05 * STEP)
            if math.isfinite(want):
                _close(style, f"dE/d{name} is not the derivative of the energy at {name} = {values[i]:.4g}", answer[1 + i], want, 1e-6,
                       abs(want) + 1e-3 * abs(answer[0]) + 1e-9)


def check_twin(style: Style) -> None:
    """Compiled and plain Python give the same numbers, in every variant; forces do not depend on the variant."""
    s = sample(style)
    skewed = cell_arrays(np.array([[BOX, 0, 0], [0.4 * BOX, BOX, 0], [0.3 * BOX, -0.2 * BOX, BOX]]), np.ones(3, bool))
    reference = s.run()
    for energy, per_atom, periodic, orthogonal in ((True, True, False, True), (True, False, True, True), (False, False, True, False)):
        cell = s.cell if orthogonal else skewed
        x = s.x if not periodic else s.x + (cell.vectors.T @ np.random.default_rng(0).integers(-2, 3, s.x.shape))
        variant = dict(energy=energy, per_atom=per_atom, periodic=periodic, orthogonal=orthogonal)
        a, b = s.run(x, cell=cell, **variant), s.run(x, twin(style, **variant)["loop"], cell)
        for name in ("forces", "acc", "energies", "virials", "bad"):
            p, q = getattr(a, name), getattr(b, name)
            _close(style, f"compiled and Python {name} differ for {variant}", p, q, 1e-13)
        _close(style, f"forces differ for {variant}", a.forces, reference.forces, 1e-10)
    total = np.append(reference.acc[0], reference.acc[2:])
    shares = np.append(reference.energies.sum(), reference.virials.sum(axis=1))
    _close(style, "shares of the atoms do not add up", shares, total, 1e-12, np.abs(total).max() + np.abs(reference.energies).sum())


def check_invariance(style: Style) -> None:
    """Energy and forces follow a rotation and a shift; a mirror image keeps the energy unless the style is chiral (not asked for)."""
    s = sample(style)
    q, _ = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))
    q *= np.sign(np.linalg.det(q))
    a, b = s.run(), s.run(q @ s.x + np.array([[3.0], [-7.0], [11.0]]))
    scale = np.abs(a.forces).max() + 1e-300
    _close(style, "the energy changes with a rotation", b.items, a.items, 1e-9, np.abs(a.items).max() + scale)
    _close(style, "forces do not turn with the atoms", b.forces, q @ a.forces, 1e-9, scale)


def check_balance(style: Style) -> None:
    """Forces and torques of an item sum to zero, and the virial is the sum of position times force."""
    s = sample(style)
    a = s.run()
    scale = np.abs(a.forces).max() + 1e-300
    x, f = (v.reshape(3, ITEMS, -1) for v in (s.x, a.forces))
    _close(style, "forces do not sum to zero", f.sum(axis=2), 0.0, 1e-13, scale)
    local = x - x[:, :, :1]
    _close(style, "torques do not sum to zero", np.cross(local, f, axis=0).sum(axis=2), 0.0, 1e-11, scale)
    tensor = np.einsum("aik,bik->ab", local, f)
    want = [tensor[0, 0], tensor[1, 1], tensor[2, 2], tensor[0, 1], tensor[0, 2], tensor[1, 2]]
    _close(style, "the virial is not the sum of position times force", a.acc[2:], want, 1e-11, scale)


def check_gradient(style: Style) -> None:
    """Forces are minus the gradient of the energy."""
    s = sample(style)
    a = s.run()
    k = ATOMS[style.category]
    scale = np.abs(a.forces.reshape(3, ITEMS, k)).max(axis=(0, 2)) + 1e-6 * np.abs(a.items).max() + 1e-12
    for atom in range(k):
        for axis in range(3):
            def energy(h, atom=atom, axis=axis):
                x = s.x.copy()
                x[axis, atom::k] += h
                return s.run(x).items
            _close(style, f"the force on atom {atom + 1} along {'xyz'[axis]} is not minus the gradient of the energy",
                   a.forces[axis, atom::k], -_derivative(energy, STEP), 3e-6, scale)


def check_virial(style: Style) -> None:
    """The virial is minus the derivative of the energy by strain."""
    s = sample(style)
    a = s.run()
    for i, (p, q) in enumerate(COMPONENTS):
        def energy(h, p=p, q=q):
            strain = np.eye(3)
            strain[p, q] += 0.5 * h
            strain[q, p] += 0.5 * h
            return s.run(strain @ s.x).acc[0]
        _close(style, f"virial {'xx yy zz xy xz yz'.split()[i]} is not minus the derivative by strain",
               a.acc[2 + i], -_derivative(energy, STEP), 1e-5, np.abs(a.acc).max() + 1e-12)


def check_curvature(style: Style) -> None:
    """The second derivatives d2 are those of the energy."""
    packed, length = example(style)
    coefficients, names = constants(style, packed), style.coordinates
    loop, rng, count = curvature.of_style(style, style.d2), np.random.default_rng(5), len(names)
    unused, one = np.zeros(0), np.ones(1, np.int32)
    for _ in range(20):
        values = [length * rng.uniform(0.9, 1.2) if n.startswith("r") else rng.uniform(0.2, 2.9) for n in names]
        slope, second = np.zeros((1, count)), np.zeros((1, count, count))
        loop(np.array([values]), one, one, unused, packed.coeff, unused, packed.arrays, slope, second)
        if not np.isfinite(slope).all():
            continue
        for i, first in enumerate(names):
            def slopes(h, i=i, values=values):
                return np.array(style.function(*(v + h * (j == i) for j, v in enumerate(values)), *coefficients)[1:])
            want = _derivative(slopes, STEP)
            for j, other in enumerate(names):
                if math.isfinite(want[j]):
                    _close(style, f"d2E/d{other} d{first} is not that of the energy at {first} = {values[i]:.4g}", second[0, j, i], want[j],
                           1e-6, np.abs(want).max() + np.abs(slope).max() + 1e-9)


def check_digits(style: Style) -> None:
    """Forces keep their digits near singular geometry and far from rest, against the energy with 60 digits."""
    packed, length = example(style)
    s, exact = Sample(style, packed), digits.Exact(style, packed)
    for title, x in digits.geometries(style, length).items():
        a = s.run(np.ascontiguousarray(x.T))
        if a.bad[0]:
            advice = "return math.inf for the energy and all derivatives where the style is not defined"
            try:
                answer = style.function(*exact.place(x), *constants(style, packed))
            except Exception as e:
                raise AssertionError(f"{style}: plain Python raises {type(e).__name__} ({e}) at {title}: {advice}") from None
            assert not any(map(math.isnan, answer)), f"{style}: not a number at {title}: {advice}"
            continue
        error = exact.error(x, a.forces.T)
        assert error <= digits.LIMIT, (f"{style}: at {title} forces are off by {error:.2g} times the rounding that the geometry asks for "
                                       f"(limit {digits.LIMIT:g}): digits cancel in the function, or its derivative is wrong there")


def check_singular(style: Style) -> None:
    """On a line, in a plane and at one place an item either is reported or has finite forces that sum to zero."""
    s = sample(style)
    k = ATOMS[style.category]
    line = np.zeros((3, k))
    line[0] = [0.0, 1.0, 2.0, 3.0][:k]
    back = np.zeros((3, k))
    back[0] = [1.0, 0.0, 1.5, 0.2][:k]
    plane = np.array([[0.0, 1.0, 1.0, 0.0], [0.0, 0.0, 1.0, 1.0], [0.0] * 4])[:, :k]
    for x in (line, back, plane, plane[:, ::-1], np.zeros((3, k)), line * np.nan):
        a = s.run(x)
        if a.bad[0]:
            assert not a.forces.any() and not a.acc.any(), f"{style}: a reported item leaves forces behind"
            assert bonded.describe(style, a.bad[2], range(1, k + 1), 1).count("\n") == 0
            continue
        assert np.isfinite(a.forces).all() and np.isfinite(a.acc).all(), f"{style}: forces are not finite at {x.T.tolist()}"
        _close(style, f"forces do not sum to zero at {x.T.tolist()}", a.forces.sum(axis=1), 0.0, 1e-13, np.abs(a.forces).max() + 1e-300)


CHECKS = {"function": check_function, "text": check_text, "slope": check_slope, "curvature": check_curvature, "twin": check_twin,
          "invariance": check_invariance, "balance": check_balance, "gradient": check_gradient, "virial": check_virial,
          "digits": check_digits, "singular": check_singular}


def left_out(style: Style, name: str) -> str:
    """Why a check does not apply to a style; empty if it does."""
    if style.function is None and name != "text":
        return "the style has no forces"
    if name in style.xfail:
        return style.xfail[name]
    if name == "curvature" and style.d2 is None:
        return "it has no second derivatives, the option d2"
    if name == "digits" and style.history:
        return "its energy depends on the past"
    return style.xfail.get("gradient", "") if name == "digits" else ""


def checks_of(style: Style) -> list[str]:
    """Names of the checks that apply."""
    return [name for name in CHECKS if not left_out(style, name)]


def check_style(style: Style, checks: list[str] | None = None) -> None:
    """Run the shipped checks on a bonded style.

    Parameters
    ----------
    style : Style
        From `asemd.style.find` or of your own.
    checks : list of str, optional
        Some of `CHECKS`; all that apply by default.

    Raises
    ------
    AssertionError
        Says which style does what wrong.
    """
    if style.category not in ATOMS:
        raise ValueError(f"{style}: only bond, angle, dihedral and improper styles can be checked here")
    for name in checks or checks_of(style):
        CHECKS[name](style)


def report_style(style: Style) -> str:
    """What the shipped checks say about a bonded style, a line for each: passed, FAILED and why, or left out and why."""
    lines, usable = [], True
    for name, check in CHECKS.items():
        said, reason = (check.__doc__ or "").split(";")[0].rstrip("."), left_out(style, name)
        if reason or not usable:
            lines.append(f"{name:11}left out  {reason or 'the function must be right first'}")
            continue
        try:
            check(style)
            lines.append(f"{name:11}passed    {said}")
        except AssertionError as e:
            usable = name != "function"
            lines.append(f"{name:11}FAILED    {str(e).removeprefix(f'{style}: ')}")
    return "\n".join([str(style), *lines])
