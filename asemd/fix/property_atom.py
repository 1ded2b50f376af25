"""Give atoms further properties: ``i_name`` and ``d_name`` (whole and real numbers), ``i2_name N`` and ``d2_name N`` (N columns), and
``mol``, ``q`` and ``rmass`` where the atom style has them not.

They begin as 0, are set by `set`, read by `read_data` (with its keyword ``fix``) and written by `write_data`, are the atoms' own in restart
files, and can be used in variables, dumps and computes. With ``ghost yes`` LAMMPS communicates them to ghost atoms, of which there are none
here. Source: LAMMPS manual, fix property/atom.
"""
from __future__ import annotations

import re

import numpy as np

from asemd.errors import InputError, nearest
from asemd.fix import Fix
from asemd.words import number, whole, yes_no

OWN = {"mol": "Molecules", "q": "Charges"}       # their sections in data files
PROPERTY = re.compile(r"([id])(2?)_(\w+)")
WORDS = ("mol", "q", "rmass", "i_name", "d_name", "i2_name", "d2_name")


def _bare(name: str) -> str:
    """The name without its kind: i_a and d_a cannot both be."""
    return re.sub(r"^[id]2?_", "_", name)


class PropertyAtom(Fix):
    """Further properties of atoms, in ``system.extra`` by the names i_name, d_name, i2_name, d2_name.

    Parameters
    ----------
    properties : sequence of str or (str, int)
        ``mol``, ``q``, ``rmass``, ``i_name``, ``d_name``, ``("i2_name", columns)``, ``("d2_name", columns)``.
    group : str
        Has no effect, must be ``all``.
    writedata : bool
        Whether `write_data` writes them.

    Raises
    ------
    InputError
        An unknown property, one that is named twice, a number of columns below 1.
    """

    style = "property/atom"
    restarts = ("peratom",)
    before_box = True

    def __init__(self, properties=(), group: str = "all", writedata: bool = True):
        super().__init__(group)
        self.properties = [(p, 0) if isinstance(p, str) else (p[0], int(p[1])) for p in properties]
        self.writedata, self.ghost = writedata, False
        names = [name for name, _ in self.properties]
        if not names:
            raise InputError("fix property/atom needs at least one property")
        for name, width in self.properties:
            match = PROPERTY.fullmatch(name)
            if name not in ("mol", "q", "rmass") and match is None:
                raise InputError(f"fix property/atom: {name!r} is unknown or not supported, it must be one of {' '.join(WORDS)}"
                                 f"{nearest(name, WORDS)}")
            if match and match[2] and width < 1:
                raise InputError(f"fix property/atom: {name} needs a number of columns of at least 1, got {width}")
        if len({_bare(name) for name in names}) < len(names):
            raise InputError(f"fix property/atom: a property is named twice in {' '.join(names)}")

    @classmethod
    def from_lammps(cls, group, words, session):
        what, properties, words, taken = "fix property/atom", [], list(words), list(words)
        while words and words[0] not in ("ghost", "writedata"):
            name = words.pop(0)
            if name[:3] in ("i2_", "d2_"):
                if not words:
                    raise InputError(f"{what}: {name} needs the number of its columns")
                properties.append((name, whole(words.pop(0), f"{what} {name}")))
            else:
                properties.append((name, 0))
        options = {}
        while words:
            if words[0] not in ("ghost", "writedata"):
                raise InputError(f"{what}: unknown keyword {words[0]!r}{nearest(words[0], ('ghost', 'writedata'))}")
            if len(words) < 2:
                raise InputError(f"{what}: {words[0]} needs yes or no")
            options[words[0]], words = yes_no(words[1], f"{what} {words[0]}"), words[2:]
        fix = cls(properties, group, options.get("writedata", True))
        fix.ghost, fix.words = options.get("ghost", False), taken
        system = session.scene.system
        earlier = [f for f in session.scene.fixes.values() if isinstance(f, cls) and f.id != session.defining]
        for name, _ in fix.properties:
            other = next((f for f in earlier if _bare(name) in (_bare(n) for n, _ in f.properties)), None)
            style = {"mol": system is not None and system.molecular, "q": system is not None and system.q is not None,
                     "rmass": system is not None and system.rmass is not None}.get(name, False)
            if other is not None or (style and not session.scene.restored):
                raise InputError(f"{what}: atoms have {name} already{f', by fix {other.id}' if other else ' by their atom style'}")
        if system is not None:
            fix.attach(system)
        return fix

    def to_lammps(self) -> list[str]:
        out = [w for name, width in self.properties for w in ((name, str(width)) if width else (name,))]
        return out + (["ghost", "yes"] if self.ghost else []) + ([] if self.writedata else ["writedata", "no"])

    def attach(self, system) -> None:
        """Give the atoms of a system the properties that they lack."""
        for name, width in self.properties:
            if name == "mol":
                system.counts["molecules"] = 1
            elif name == "q":
                system.q = np.zeros(system.n) if system.q is None else system.q
            elif name == "rmass":
                system.rmass = np.zeros(system.n) if system.rmass is None else system.rmass
            elif name not in system.extra:
                kind = np.int64 if name[0] == "i" else float
                system.extra[name] = np.zeros((system.n, width) if width else system.n, kind)

    def detach(self, system) -> None:
        """Take them away again."""
        for name, _ in self.properties:
            if name == "mol":
                system.counts.pop("molecules", None)
                system.molecule[:] = 0
            elif name in ("q", "rmass"):
                setattr(system, name, None)
            else:
                system.extra.pop(name, None)

    def columns_in(self, system) -> list[np.ndarray]:
        """(n,) arrays in the order of a data file."""
        own = {"mol": system.molecule, "q": system.q, "rmass": system.rmass}
        out = []
        for name, _ in self.properties:
            values = own[name] if name in own else system.extra[name]
            out += [values] if values.ndim == 1 else list(values.T)
        return out

    def heading(self) -> str:
        """The heading of its section in data files."""
        if len(self.properties) == 1 and self.properties[0][0] in OWN:
            return OWN[self.properties[0][0]]
        shown = [re.sub(r"^([id])2_", r"\1_", name) for name, _ in self.properties]
        return f"{self.id} # {' '.join(shown)}"

    def data_sections(self, system) -> dict[str, dict]:
        """Its section of a data file: heading -> columns."""
        return {self.heading(): {"id": system.id, **dict(enumerate(self.columns_in(system)))}}

    def read_section(self, system, lines, offset: int = 0) -> None:
        """Values from the lines (place, words) of a section of a data file; `offset` is added to atom ids."""
        columns = self.columns_in(system)
        width = len(columns)
        for where, words in lines:
            if len(words) != width + 1:
                raise InputError(f"fix {self.id} (style property/atom): a line of its section has {len(words)} words, not {width + 1}: "
                                 "the atom id and its values", where)
            try:
                row = system.index_of(whole(words[0], "atom id") + offset)[0]
                for column, word in zip(columns, words[1:]):
                    column[row] = whole(word, "value") if column.dtype.kind == "i" else number(word, "value")
            except InputError as e:
                raise e.at(where) from None
