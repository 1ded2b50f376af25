"""What computes of local values share: one row for each bond, angle, dihedral or improper, one column for each keyword."""
from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from asemd.compute import Compute
from asemd.compute._items import evaluate_all
from asemd.errors import InputError, nearest
from asemd.kernels import observe
from asemd.words import take

OWNER = {"bond": 0, "angle": 1, "dihedral": 1, "improper": 1}      # the atom of an item that LAMMPS keeps it with


def local_items(state, kind: str, group: str) -> tuple[np.ndarray, np.ndarray]:
    """Rows of the atoms (m, k) and types (m,) of the items all of whose atoms are in the group, without broken ones (type 0).

    Sorted by the row of the atom that owns an item, so that columns of several computes fit together.
    """
    atoms, types = state.system.topology.items(kind)
    mask = state.mask(group)
    if not mask.all() or not types.all():
        keep = mask[atoms].all(axis=1) & (types != 0)
        atoms, types = atoms[keep], types[keep]
    owner = atoms[:, OWNER[kind]]
    if (owner[1:] >= owner[:-1]).all():
        return atoms, types
    order = np.argsort(owner, kind="stable")
    return atoms[order], types[order]


FORCES = {"force", "fx", "fy", "fz"}        # columns that need them


class Geometry:
    """Separations of the atoms of some items and what follows from them, each made when it is first asked for.

    Parameters
    ----------
    state : asemd.result.Snapshot
    kind : str
    group : str
    interactions : asemd.forcefield.Interactions or None
    with_forces : bool
        Whether forces are wanted, too.
    """

    def __init__(self, state, kind: str, group: str, interactions, with_forces: bool = True):
        self.state, self.kind, self.interactions, self.with_forces = state, kind, interactions, with_forces
        self.atoms, self.types = local_items(state, kind, group)
        self._evaluated: tuple[np.ndarray, np.ndarray] | None = None
        self.known: dict[str, Any] = {}      # what several columns follow from

    def between(self, a: int, b: int) -> np.ndarray:
        """(m, 3) vectors from atom b to atom a of each item, counted from 0, as closest images."""
        box = self.state.system.box
        out, far = np.empty((len(self.atoms), 3)), np.empty(len(self.atoms), np.int64)
        near = np.where(box.periodic, 0.499999, np.inf) * np.diag(box.cell) if box.aligned else -np.ones(3)
        far = far[:observe.separations(self.state.system.x, self.atoms, a, b, near, out, far)]
        if len(far):
            out[far] = box.minimum_image(out[far])[0]
        return out

    def evaluated(self) -> tuple[np.ndarray, np.ndarray]:
        """Energies (m,) and forces (m, k, 3)."""
        if self._evaluated is None:
            self._evaluated = evaluate_all(self.state.system, self.interactions, self.kind, self.atoms, self.types, self.state.units,
                                           self.with_forces)
        return self._evaluated

    def energy(self) -> np.ndarray:
        return self.evaluated()[0]


class Local(Compute):
    """Base class.

    Parameters
    ----------
    group : str
        Items count whose atoms are all in it.
    keywords : sequence of str
        Columns: keys of `columns`, or ``v_name``, a formula evaluated for each item.
    interactions : asemd.forcefield.Interactions, optional
        Needed for energies and forces.
    variables : asemd.variable.Variables, optional
        Needed for ``v_name``.
    setting : str
        The internal variable that takes the value of `given` before formulas are evaluated.

    Raises
    ------
    InputError
        No or unknown keywords, formulas without ``set`` or ``set`` without formulas, variables of the wrong style.
    """

    kind: ClassVar[str] = ""
    given: ClassVar[str] = ""
    columns: ClassVar[dict[str, Any]] = {}

    def __init__(self, group: str = "all", keywords=(), interactions=None, variables=None, setting: str = ""):
        super().__init__(group)
        if not keywords:
            raise InputError(f"compute {self.style} needs at least one of {' '.join(self.columns)}")
        formulas = [k for k in keywords if k.startswith("v_")]
        for word in keywords:
            if word not in self.columns and word not in formulas:
                raise self.unknown(word)
        if formulas and not setting:
            raise InputError(f"compute {self.style}: {formulas[0]} needs: set {self.given} and the name of an internal variable")
        if setting and not formulas:
            raise InputError(f"compute {self.style}: set without a variable v_name that uses {setting}")
        for name, style in [(f[2:], "equal") for f in formulas] + [(setting, "internal")] * bool(setting):
            if variables is None or variables.find(name).style != style:
                raise InputError(f"compute {self.style}: variable {name} must have the style {style}")
        self.keywords, self.interactions, self.variables, self.setting = list(keywords), interactions, variables, setting

    def unknown(self, word: str) -> InputError:
        return InputError(f"compute {self.style}: unknown keyword {word!r}{nearest(word, self.columns)}")

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "variables": None}

    @classmethod
    def from_lammps(cls, group, words, session):
        keywords, setting, words = [], "", list(words)
        while words and words[0] != "set":
            keywords.append(words.pop(0))
        while words:
            if words[0] != "set" or take(words[1:], 2, f"compute {cls.style} set")[0] != cls.given:
                wrong = words[0] if words[0] != "set" else words[1]
                raise InputError(f"compute {cls.style}: expected set {cls.given} and the name of an internal variable, got {wrong!r}")
            setting, words = words[2], words[3:]
        return cls(group, keywords, session.scene.interactions, session.variables, setting)

    def to_lammps(self) -> list[str]:
        return [*self.keywords, *(["set", self.given, self.setting] if self.setting else [])]

    def local_columns(self):
        return len(self.keywords) if len(self.keywords) > 1 else 0

    def local(self, state) -> np.ndarray:
        """(m,) for one keyword, (m, k) for several."""
        geometry = Geometry(state, self.kind, self.group, self.interactions, not FORCES.isdisjoint(self.keywords))
        out = [self._formula(geometry, k[2:]) if k.startswith("v_") else self.columns[k](geometry) for k in self.keywords]
        return np.asarray(out[0], float) if len(out) == 1 else np.column_stack(out).astype(float, copy=False)

    def _formula(self, geometry: Geometry, name: str) -> np.ndarray:
        if self.variables is None:
            raise InputError(f"compute {self.id}: v_{name} needs a session")
        values = []
        for value in self.columns[self.given](geometry).tolist():
            self.variables.set(self.setting, repr(self.formula_value(value)))
            values.append(self.variables.number(name))
        return np.array(values)

    def formula_value(self, value: float) -> float:
        """What formulas get of a value."""
        return value
