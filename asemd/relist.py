"""Lists that the compiled time loop builds by itself, and when it may."""
from __future__ import annotations

from collections.abc import Callable

import numpy as np

from asemd.kernels import packed, relist
from asemd.kernels.hooks import kernel_address
from asemd.neighbor import COUNTERS, Rows

NO_CALLS = np.empty((0, 2), packed.HANDLE)
NO_ROWS = Rows(1)
BY_ROW = ("type_row", "mass_row", "inverse_row", "q_row", "mask_row")


def _place(cls: type, name: str) -> type:
    return next(c for c in cls.__mro__ if name in vars(c))


def follows(term) -> bool:
    """Whether what a term does when there is a new list is known to compiled code: a class whose `rebuild` does more has a `relisted` of
    its own."""
    return hasattr(term, "relisted") and _place(type(term), "relisted") is _place(type(term), "rebuild")


class Relist:
    """What the time loop needs to build the list of an engine.

    Attributes
    ----------
    live : (3,) int64
        What it shares with Python, see `asemd.kernels.relist`.
    """

    def __init__(self):
        self.live = np.zeros(3, np.int64)
        self._given: list = []
        self._functions: list = []
        self._blocks: list[packed.Block] = []
        self._table = NO_CALLS

    def table(self, engine) -> np.ndarray:
        """The calls (m, 2), function and arguments, that build a list; none where only Python can."""
        # arguments of terms are made anew after each list that Python builds; the rest belongs to the atoms
        given = [engine.thread_arguments, engine.state, engine.system.image, engine.varies, *(getattr(engine, name) for name in BY_ROW)]
        if len(given) != len(self._given) or any(a is not b for a, b in zip(given, self._given)):
            found, self._given = calls(engine, self.live) or [], given
            functions = [function for function, _ in found]
            if functions != self._functions or not all(block.take(values) for block, (_, values) in zip(self._blocks, found)):
                self._functions, self._blocks = functions, [packed.Block(values) for _, values in found]
                self._table = np.empty((len(found), 2), packed.HANDLE)
                for row, block, (function, values) in zip(self._table, self._blocks, found):
                    row[:] = kernel_address(function, packed.text_of_arguments(values)), packed.handle(block.memory)
        return self._table

    def kernels(self, engine) -> list[tuple[Callable, str]]:
        """The functions of the table, each with the type of its arguments."""
        return [(function, packed.text_of_arguments(values)) for function, values in calls(engine, self.live) or []]

    @property
    def known(self) -> bool:
        """Whether the loop could build the last list that was due."""
        return len(self._table) > 0

    def ready(self, engine) -> bool:
        """Whether the loop can build the next list, of the atoms that there are now; the grid follows their number."""
        if engine.changed or not possible(engine) or engine.list.shape(engine.list.bins, engine.system.n):
            return False
        engine.thread_arguments = None
        return True

    def take(self, engine, builds: int) -> None:
        """The loop has run, and has built so many lists."""
        engine.ns = int(self.live[relist.NS])
        if builds:
            engine.builds, engine.listed = engine.builds + builds, None


def possible(engine) -> bool:
    """Whether the list of an engine is one that compiled code can build, as far as its terms can, too."""
    c = engine.list
    return not (packed.WITHOUT_COMPILER or engine.mode != "cluster" or engine.expanded or engine.box_moves or not engine.periodic.all()
                or engine.bonds.terms or c.shares is None or any(engine.rows) or len(engine.exclusions.rules) or c.gaps)


def calls(engine, live: np.ndarray) -> list[tuple[Callable, tuple]] | None:
    """Function and arguments of each call; the list first. None where only Python can build it."""
    c, s, rules = engine.list, engine.state, engine.exclusions
    if not possible(engine) or not all(map(follows, engine.terms)):
        return None
    atoms = relist.Atoms(s.x, s.v, engine.system.image, s.row, engine.slot_of, engine.varies, engine.type_row, engine.mass_row,
                         engine.inverse_row, engine.q_row, engine.mask_row, s.type, s.mass, s.inverse_mass, s.q, s.mask, engine.held,
                         engine.moved)
    reduced, close = c.near
    space = relist.Space(engine.origin, engine.vectors, engine.inverse, engine.periodic, c.bins.origin, c.bins.inverse, c.bins.widths,
                         c.far, c.bins.places, c.shifts, reduced, c.nx, c.ny, c.nz, c.void, c.width, int(close), float(c.reach))
    arrays = relist.Arrays(c.x2, c.v2, c.row2, c.counts, c.cell_start, c.column_start, c.column_of, c.key, c.first, c.entries, c.own,
                           c.span, c.unshifted, c.work, c.work_codes, c.row_length, c.hide, c.excluded_first, c.excluded, c.where,
                           c.earlier, c.marks, c.bits, COUNTERS, c.bounds, c.shares, c.lengths)
    rows = engine.rows.get("", NO_ROWS)
    special = relist.Special(*rules.left_out, *rules.rule_arrays, rows.start, rows.owners, rows.neighbors, rows.edges)
    module = relist.module(engine.k, not engine.sparse and rules.partners is not None, engine.sparse)
    found = [(module.relist, (live, atoms, space, arrays, special))]
    for steps in [term.relisted(engine) for term in engine.terms]:
        if steps is None:
            return None
        found += [(getattr(module, name), (live, *arguments)) for name, arguments in steps]
    return found
