r"""Spread the atoms evenly over processors every N steps: there is one process here, so that all it does is ask for a new neighbour list.

Source: LAMMPS manual, fix balance. Arguments: N thresh, then ``shift dimensions Niter stopthresh`` or ``rcb``; weight, sort and out are
read and have nothing to act on. Output: the scalar is 0 and the vector natoms, 0, 0, as those of LAMMPS on one processor without weights.
"""
from __future__ import annotations

from asemd.errors import InputError
from asemd.fix import NEVER, Fix
from asemd.words import choice, number, take, whole, yes_no

KEYWORDS = ("weight", "sort", "out")
WEIGHTS = {"group": 0, "neigh": 1, "time": 1, "var": 1, "store": 1}


def read_shift(words: list[str], what: str) -> list[str]:
    """Read ``dimensions Niter stopthresh`` of style shift; what follows is returned."""
    dimensions, count, stop = take(words, 3, f"{what} shift dimensions Niter stopthresh")
    if not dimensions or set(dimensions) - set("xyz") or len(set(dimensions)) < len(dimensions):
        raise InputError(f"{what} shift: dimensions are letters x, y and z, each once, got {dimensions!r}")
    if whole(count, f"{what} shift Niter") < 1 or number(stop, f"{what} shift stopthresh") < 1.0:
        raise InputError(f"{what} shift: Niter and stopthresh must be at least 1, got {count} and {stop}")
    return words[3:]


def read_keywords(words: list[str], what: str) -> None:
    """Check keywords that have nothing to act on where there is one process."""
    while words:
        keyword = choice(words[0], KEYWORDS, f"{what} keyword")
        values = take(words[1:], 2 if keyword == "weight" else 1, f"{what} {keyword}")
        words = words[1 + len(values):]
        if keyword == "sort":
            yes_no(values[0], f"{what} sort")
        elif keyword == "weight":
            kind = choice(values[0], WEIGHTS, f"{what} weight")
            if kind == "group":
                pairs = 2 * whole(values[1], f"{what} weight group")
                for factor in take(words, pairs, f"{what} weight group")[1::2]:
                    number(factor, f"{what} weight group")
                words = words[pairs:]
            elif kind in ("neigh", "time"):
                number(values[1], f"{what} weight {kind}")


class Balance(Fix):
    """A new neighbour list every N steps.

    Parameters
    ----------
    group : str
        Without meaning.
    every : int
        Steps between two lists; 0: it asks for none.

    Raises
    ------
    InputError
        `every` is negative.
    """

    style = "balance"
    levels = "every"

    def __init__(self, group: str = "all", every: int = 0):
        super().__init__(group)
        if every < 0:
            raise InputError(f"fix balance: N must not be negative, got {every}")
        self.interval, self.words, self.n = every, [str(every), "1.0", "rcb"], 0

    @classmethod
    def from_lammps(cls, group, words, session):
        what = "fix balance"
        every, threshold, style = take(words, 3, f"{what} N thresh style")
        if number(threshold, f"{what} thresh") < 1.0:
            raise InputError(f"{what}: thresh must be at least 1, got {threshold}")
        rest = read_shift(words[3:], what) if choice(style, ("shift", "rcb"), f"{what} style") == "shift" else words[3:]
        read_keywords(rest, what)
        fix = cls(group, whole(every, f"{what} N"))
        fix.words = list(words)
        return fix

    def to_lammps(self) -> list[str]:
        return list(self.words)

    def setup(self, loop) -> None:
        self.n = loop.system.n
        self._ask(loop.step)

    def _ask(self, step: int) -> None:
        if self.interval:
            self.next_reneighbor = (step // self.interval + 1) * self.interval

    def next_list(self, step: int) -> int:
        return NEVER

    def pre_exchange(self, loop) -> None:
        """Ask for the next list."""
        self.n = loop.system.n
        if loop.step >= self.next_reneighbor:
            self._ask(loop.step)

    def scalar(self) -> float:
        """0: no imbalance was ever found."""
        return 0.0

    def vector(self, i: int) -> float:
        if not 1 <= i <= 3:
            raise InputError(f"fix {self.id} (style balance) has a vector of length 3, there is no component {i}")
        return float(self.n) if i == 1 else 0.0
