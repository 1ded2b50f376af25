"""Many-body potentials of LAMMPS's files as ASE calculators: Stillinger-Weber, Tersoff and others."""
from __future__ import annotations

from collections.abc import Mapping

from ase.calculators.calculator import external_calculators, register_calculator_class
from ase.data import chemical_symbols

from asemd.calculator import ForceField
from asemd.embedded_calculator import SUFFIXES as EMBEDDED
from asemd.errors import InputError, nearest
from asemd.forcefield import Interactions
from asemd.potential_file import located, named_elements
from asemd.registry import find

SUFFIXES = {".sw": "sw", ".sw.mod": "sw/mod", ".tersoff": "tersoff", ".tersoff.mod": "tersoff/mod", ".tersoff.modc": "tersoff/mod/c",
            ".tersoff.zbl": "tersoff/zbl", ".gw": "gw", ".gw.zbl": "gw/zbl", ".vashishta": "vashishta", ".edip": "edip/multi",
            ".nb3b.harmonic": "nb3b/harmonic", ".nb3b.screened": "nb3b/screened", ".poly": "polymorphic", ".eim": "eim", ".meam": "meam",
            ".msmeam": "meam/ms", ".meam.spline": "meam/spline", ".meam.sw.spline": "meam/sw/spline",
            ".snapcoeff": "snap", ".extep": "extep",
            ".3b": "threebody/table", ".rebo": "rebo", ".airebo": "airebo", ".airebo-m": "airebo/morse"}


class Potential(ForceField):
    """A many-body potential for ``ase.Atoms``; atoms are those elements of the file that their symbols name. Files that name none (older
    ones of meam/spline) are for all of them.

    Parameters
    ----------
    file : str or path, or a sequence of them
        Here or in a folder of ``LAMMPS_POTENTIALS``. Where ``pair_coeff`` has more words before the elements of the types, these words, as
        ``["library.meam", "Si", "C", "SiC.meam"]``; the elements of the atoms are enough for ``"ffield.eim"`` and for a library alone.
    style : str, optional
        LAMMPS's name of the pair style; by default what the file's name ends with.
    elements : mapping, optional
        Chemical symbol -> name of the element in the file, where the two differ.
    settings : str, optional
        Words after the name in ``pair_style``, as ``shift 0.1``; without them airebo has its usual cutoff, 3.0.
    skin : float, optional
        Extra distance of the neighbour list, Angstrom.
    threads : int
    precision, compat : str
        As in `ForceField`.

    Raises
    ------
    InputError
        A file that is not there or whose name does not tell its style; at the first evaluation errors of the file, and elements that it
        does not have.

    Examples
    --------
    >>> from ase.build import bulk
    >>> silicon = bulk("Si", cubic=True)
    >>> silicon.calc = Potential.from_file("Si.sw")  # doctest: +SKIP
    >>> silicon.get_potential_energy() / len(silicon)  # doctest: +SKIP
    -4.3366
    """

    name = "asemd-potential"

    def __init__(self, file, *, style: str = "", elements: Mapping[str, str] | None = None, settings: str = "", skin: float = 1.0,
                 threads: int = 1, precision: str = "double", compat: str = ""):
        super().__init__(skin=skin, threads=threads, precision=precision, compat=compat)
        words = list(file) if isinstance(file, (list, tuple)) else [file]
        self.given, self.words, self.compat = named_elements(elements, "Potential"), settings, compat
        self.style_name = style or _style_of([str(word) for word in words])
        found = find("pair", self.style_name)
        if not (found.many and found.elements):
            known = nearest(style, SUFFIXES.values())
            raise InputError(f"Potential: {self.style_name} is not a many-body style whose file names elements{known}")
        self.words = settings or found.usual
        found.parse_settings(self.words.split())
        self.files = [word if word == "NULL" or (len(words) > 1 and word in chemical_symbols) else located(word, "Potential")
                      for word in words]

    @classmethod
    def from_file(cls, file, **options) -> Potential:
        """The calculator of a potential file; options as in the class."""
        return cls(file, **options)

    def _system(self, atoms):
        new = sorted(set(atoms.get_chemical_symbols()) - set(self.types))
        if new or self.interactions is None:
            made = self._made([*self.types, *new]) if new or self.types else Interactions(compat=self.compat)
            self.types += new
            self.interactions, self._engine = made, None
        if "type" in atoms.arrays:      # numbers of a script: symbols say more
            atoms = atoms.copy()
            del atoms.arrays["type"]
        return super()._system(atoms)

    def _made(self, symbols: list[str]) -> Interactions:
        """The interactions of elements."""
        made, n = Interactions(compat=self.compat), len(symbols)
        made.set_style("pair", [self.style_name, *self.words.split()])
        keys = [(i, j) for i in range(1, n + 1) for j in range(i, n + 1)]
        elements = [self.given.get(s, s) for s in symbols]
        made.assign("pair", keys, [*find("pair", self.style_name).head_for(self.files, elements), *elements])
        return made

    @property
    def _shown(self) -> str | list[str]:
        return self.files if len(self.files) > 1 else self.files[0]

    def todict(self, skip_default: bool = True) -> dict:
        """The arguments, JSON-able."""
        out = {"file": self._shown, "style": self.style_name, "skin": self.settings.skin}
        out |= {} if self.settings.precision == "double" else {"precision": self.settings.precision}
        return out | {k: v for k, v in (("elements", self.given), ("settings", self.words), ("compat", self.compat)) if v}

    def __repr__(self) -> str:
        return f"Potential({self._shown!r}, style={self.style_name!r})"


if Potential.name not in external_calculators:
    register_calculator_class(Potential.name, Potential)


def _style_of(files: list[str]) -> str:
    """The style that a file's name ends with."""
    for suffix in sorted(SUFFIXES, key=len, reverse=True):
        if any(file.endswith(suffix) for file in files):
            return SUFFIXES[suffix]
    if any(file.endswith(suffix) for file in files for suffix in EMBEDDED):
        raise InputError(f"Potential: {' '.join(files)} is an embedded-atom potential: use asemd.EAM")
    raise InputError(f"Potential: the name {' '.join(files)} does not tell its style: give style=, one of {' '.join(SUFFIXES.values())}")
