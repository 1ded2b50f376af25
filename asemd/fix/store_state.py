r"""Keep values of each atom as they are now, or as they are every N steps.

Source: LAMMPS manual, fix store/state. Output: values per atom, a column for each value; zero outside the group.
"""
from __future__ import annotations

import numpy as np

from asemd.errors import InputError, nearest
from asemd.fix import Fix, sampled
from asemd.fix.values import given, read, snapshot_of
from asemd.words import take, whole, yes_no

AXES = "xyz"
WORDS = ("id", "mol", "type", "mass", *AXES, *(a + "s" for a in AXES), *(a + "u" for a in AXES), *(a + "su" for a in AXES),
         *("i" + a for a in AXES), *("v" + a for a in AXES), *("f" + a for a in AXES), "q", "mux", "muy", "muz", "mu", "radius",
         "diameter", "omegax", "omegay", "omegaz", "angmomx", "angmomy", "angmomz", "tqx", "tqy", "tqz")


class StoreState(Fix):
    """Keep values of each atom.

    Parameters
    ----------
    group : str
        The atoms whose values are kept.
    values : sequence of str, Compute, (Compute, column) or callable
        Words such as ``x``, ``vx``, ``xu``; computes with per-atom values; functions of a Snapshot that return (n,).
    every : int
        Steps between two times; 0: once, when the first run begins.
    com : bool
        Store unwrapped positions relative to the centre of mass of the group.

    Raises
    ------
    InputError
        No value, or an unknown word.
    """

    style = "store/state"
    restarts = ("peratom",)
    session = None

    def __init__(self, group: str = "all", values=(), every: int = 0, com: bool = False):
        super().__init__(group)
        if every < 0:
            raise InputError(f"fix store/state: N must not be negative, got {every}")
        if not len(values):
            raise InputError("fix store/state needs at least one value")
        for v in values:
            if isinstance(v, str) and v not in WORDS and v[:2] not in ("i_", "d_") and v[:3] not in ("i2_", "d2_"):
                raise InputError(f"fix store/state: unknown value {v!r}{nearest(v, WORDS)}")
        self.values = [v if isinstance(v, str) else given(v, k) for k, v in enumerate(values, 1)]
        self.store_every, self.com = every, com
        self.data: np.ndarray | None = None

    @classmethod
    def from_lammps(cls, group, words, session):
        what = "fix store/state"
        every, names = whole(take(words, 2, what)[0], f"{what} N"), list(words[1:])
        values, k = [], 0
        while k < len(names) and names[k] != "com":
            name = names[k]
            values.append(read(name, session, what).check("per_atom", what) if name[:2] in ("c_", "f_", "v_") else name)
            k += 1
        options = sampled.keywords(names[k:], {"com": 1}, what)
        fix = cls(group, values, every, yes_no(options.get("com", ["no"])[0], f"{what} com"))
        fix.session, fix.words = session, list(words)
        fix.needs = frozenset().union(*(v.needs() for v in fix.values if not isinstance(v, str)))
        if all(isinstance(v, str) or v.kind == "v" for v in fix.values):        # computes may not be known before a run
            session.variables.provider.session.moment.forget()
            fix._store(session.scene.system, session.scene.groups.mask(group), None)
        return fix

    def to_lammps(self) -> list[str]:
        own = [str(self.store_every), *(v if isinstance(v, str) else v.word for v in self.values)]
        return getattr(self, "words", own)

    def next_end(self, step: int) -> int:
        return (step // self.store_every + 1) * self.store_every if self.store_every else sampled.NEVER

    def setup(self, loop) -> None:
        if not isinstance(self.data, np.ndarray) or (self.store_every and loop.step % self.store_every == 0):
            self.end_of_step(loop)

    def end_of_step(self, loop) -> None:
        """Keep the present values."""
        snapshot = snapshot_of(loop, self.session, self.needs)
        self._store(loop.system, loop.groups[self.group], snapshot)

    def _store(self, system, mask: np.ndarray, snapshot) -> None:
        centre = np.zeros(3)
        if self.com and mask.any():
            mass = system.atom_masses()[mask]
            centre = mass @ system.box.unwrap(system.x, system.image)[mask] / mass.sum()
        now = np.zeros((system.n, len(self.values)))
        for k, v in enumerate(self.values):
            column = _atoms(system, v, centre) if isinstance(v, str) else \
                v.session.variables.per_atom(v.id, system.n) if v.kind == "v" else v.per_atom(snapshot)
            now[mask, k] = np.asarray(column, float)[mask]
        if self.data is not None and len(self.data) == len(now):
            self.data[:] = now
        else:
            self.data = now

    def atom_arrays(self, loop):
        """What is kept goes with the atoms."""
        return (self.data,) if self.data is not None else None

    def per_atom_columns(self) -> int:
        return len(self.values) if len(self.values) > 1 else 0

    def per_atom(self, state=None) -> np.ndarray:
        """(n,) for one value, else (n, values)."""
        data = self.data if self.data is not None else np.zeros((state.system.n if state is not None else 0, len(self.values)))
        return data if len(self.values) > 1 else data[:, 0]

    def state(self):
        return {"data": self.data} if self.data is not None else {}

    def restore(self, state):
        data = np.array(state["data"])
        if data.shape[1] != len(self.values):
            raise InputError(f"fix {self.id} (style store/state): the restart file has {data.shape[1]} values, not {len(self.values)}")
        self.data = data


def _atoms(system, word: str, centre: np.ndarray) -> np.ndarray:
    """(n,) the values that a word names."""
    from asemd.dump._columns import View, column_of
    from asemd.result import Snapshot
    view = View(Snapshot(system, None, {}, 0.0), np.arange(system.n), [])
    values = np.asarray(column_of(view, word), float)
    if len(word) == 2 and word[1] == "u" and word[0] in AXES:
        values = values - centre[AXES.index(word[0])]
    return values
