"""Embedded-atom potentials as ASE calculators, from their files alone."""
from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

from ase.calculators.calculator import external_calculators, register_calculator_class
from ase.data import chemical_symbols

from asemd.calculator import ForceField
from asemd.embedded_file import elements_of
from asemd.errors import InputError, nearest
from asemd.forcefield import Interactions
from asemd.potential_file import PotentialFile, located, named_elements
from asemd.registry import find

STYLES = ("eam", "eam/alloy", "eam/fs", "eam/he", "eam/cd", "eam/cd/old", "adp")
SUFFIXES = {".eam.alloy": "eam/alloy", ".alloy": "eam/alloy", ".eam.fs": "eam/fs", ".fs": "eam/fs", ".eam.he": "eam/he", ".he": "eam/he",
            ".cdeam": "eam/cd", ".eam.cd": "eam/cd", ".adp": "adp", ".eam": "eam", ".setfl": "eam/alloy", ".funcfl": "eam"}


class EAM(ForceField):
    """An embedded-atom potential for ``ase.Atoms``; atoms are those elements of the file that their symbols name.

    Parameters
    ----------
    *file, files : str or path
        One file (setfl and its relatives), or one for each element (funcfl): here or in a folder of ``LAMMPS_POTENTIALS``.
    style : str, optional
        ``eam``, ``eam/alloy``, ``eam/fs``, ``eam/he``, ``eam/cd``, ``eam/cd/old`` or ``adp``; by default what the file's name ends with.
    elements : mapping, optional
        Chemical symbol -> name of the element in the file, where the two differ; of funcfl files also the name of the file.
    skin : float, optional
        Extra distance of the neighbour list, Angstrom.
    threads : int
    precision, compat : str
        As in `ForceField`.

    Raises
    ------
    InputError
        A file that is not there or has errors; at the first evaluation an element that no file has.

    Examples
    --------
    >>> from ase.build import bulk
    >>> copper = bulk("Cu", "fcc", a=3.615, cubic=True)
    >>> copper.calc = EAM.from_file("Cu_u3.eam")  # doctest: +SKIP
    >>> copper.get_potential_energy() / len(copper)  # doctest: +SKIP
    -3.54
    """

    name = "asemd-eam"

    def __init__(self, *file, files: Sequence[str] = (), style: str = "", elements: Mapping[str, str] | None = None, skin: float = 1.0,
                 threads: int = 1, precision: str = "double", compat: str = ""):
        super().__init__(skin=skin, threads=threads, precision=precision, compat=compat)
        several = len(file) == 1 and not isinstance(file[0], (str, os.PathLike)) and isinstance(file[0], Sequence)
        self.files = [located(name, "EAM") for name in (*(file[0] if several else file), *files)]
        if not self.files:
            raise InputError("EAM needs a potential file, as EAM.from_file('Cu_u3.eam')")
        self.style_name = style or _style_of(self.files[0])
        if self.style_name not in STYLES:
            raise InputError(f"EAM: unknown style {self.style_name!r}{nearest(self.style_name, STYLES)}")
        if len(self.files) > 1 and self.style_name != "eam":
            raise InputError(f"EAM: style {self.style_name} takes one file for all elements, got {len(self.files)}")
        self.given, self.compat = named_elements(elements, "EAM"), compat
        self.coefficients = self._read()

    @classmethod
    def from_file(cls, *files, **options) -> EAM:
        """The calculator of a potential file, or of one file for each element; options as in the class."""
        return cls(*files, **options)

    def _read(self) -> dict[str, dict[str, Any]]:
        """Coefficients for each chemical symbol that the files know."""
        style, what = find("pair", self.style_name), f"pair_coeff {self.style_name}"
        out = {}
        if self.style_name == "eam":
            return self._read_single(style)
        names = elements_of(PotentialFile(self.files[0], what))
        values = style.parse_coeff([self.files[0], *names], {})
        known = {name: name for name in names} | self.given
        for symbol, name in known.items():
            if name not in names:
                raise InputError(f"EAM: {self.files[0]} has no element {name!r}, it has {' '.join(names)}")
            out[symbol] = {**values, "element": (name,)}
        return out

    def _read_single(self, style) -> dict[str, dict[str, Any]]:
        """The same of files that have one element each."""
        out, used = {}, set()
        for file in self.files:
            values = style.parse_coeff([file], {})
            number = values["data"].number
            own = chemical_symbols[number] if 0 < number < len(chemical_symbols) else ""
            called = {own, file, os.path.basename(file)} - {""}
            names = [symbol for symbol, name in self.given.items() if name in called or os.path.abspath(name) == file]
            used |= set(names)
            names += [own] if own and own not in self.given else []
            if not names:
                raise InputError(f"EAM: {file} is for atomic number {number}: say with elements={{symbol: file}} what it is for")
            if twice := sorted(set(names) & set(out)):
                raise InputError(f"EAM: two files are for {twice[0]}: {out[twice[0]]['file']} and {file}")
            out.update(dict.fromkeys(names, values))
        for symbol in sorted(set(self.given) - used):
            raise InputError(f"EAM: elements: no file is for {self.given[symbol]!r} or has that name, there are {', '.join(self.files)}")
        return out

    def _system(self, atoms):
        new = sorted(set(atoms.get_chemical_symbols()) - set(self.types))
        unknown = [symbol for symbol in new if symbol not in self.coefficients]
        if unknown:
            raise InputError(f"EAM: {', '.join(self.files)} ha{'ve' if len(self.files) > 1 else 's'} no {' or '.join(unknown)}, but "
                             f"{' '.join(self.coefficients)}")
        if new or self.interactions is None:
            self.types += new
            self.interactions, self._engine = self._made() if self.types else Interactions(compat=self.compat), None
        if "type" in atoms.arrays:      # numbers of a script: symbols say more
            atoms = atoms.copy()
            del atoms.arrays["type"]
        return super()._system(atoms)

    def _made(self) -> Interactions:
        """The interactions of the elements in use."""
        made = Interactions(compat=self.compat)
        made.set_style("pair", [self.style_name])
        use, n = made.uses["pair"][0], len(self.types)
        names = tuple(self.coefficients[symbol].get("element", ("",))[0] for symbol in self.types)
        for i in range(1, n + 1):
            for j in range(i, n + 1):
                values = self.coefficients[self.types[i - 1]]
                if self.style_name != "eam":
                    use.coeff[i, j] = use.style.join({}, {**values, "element": names})
                elif i == j:
                    use.coeff[i, i] = use.style.join({}, values)
        return made

    def todict(self, skip_default: bool = True) -> dict:
        """The arguments, JSON-able."""
        out = {"files": self.files, "style": self.style_name, "skin": self.settings.skin}
        out |= {} if self.settings.precision == "double" else {"precision": self.settings.precision}
        return out | {k: v for k, v in (("elements", self.given), ("compat", self.compat)) if v}

    def __repr__(self) -> str:
        return f"EAM({', '.join(map(repr, self.files))}, style={self.style_name!r})"


if EAM.name not in external_calculators:
    register_calculator_class(EAM.name, EAM)


def _style_of(file: str) -> str:
    """The style that a file's name ends with."""
    for suffix in sorted(SUFFIXES, key=len, reverse=True):
        if file.endswith(suffix):
            return SUFFIXES[suffix]
    from asemd.potential_calculator import SUFFIXES as OTHERS
    if any(file.endswith(suffix) for suffix in OTHERS):
        raise InputError(f"EAM: {file} is no embedded-atom potential: use asemd.Potential")
    raise InputError(f"EAM: the name {file} does not tell its style: give style=, one of {', '.join(STYLES)}")
