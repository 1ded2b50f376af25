r"""Many-body pair styles: energies of an atom that depend on where all its neighbours are.

A style is read from a file, ``pair_coeff * * FILE El1 El2 ...``, one element (or NULL) for each atom type, and is the sum of energies of
sites: of each atom i one energy, a function of the vectors from i to its neighbours within the cutoff::

    def site(i, ti, n, m, near, types, room, grad, constants, arrays, shares):
        ...
        return energy

``near (4, cap)`` holds dx, dy, dz (neighbour minus i) and r^2 of the n neighbours, ``types (cap,)`` their types, and ``grad (3, cap)``,
zero at first, takes the derivative of the energy by the neighbours' positions; the kernel makes forces and virial of it. The neighbours
come in an order: of the first `m` the pair with i is counted here, of the others by the neighbour, so that a pair energy is computed once.
``room (rooms, cap)`` is work space by neighbour, ``constants`` and ``arrays`` are those that `pack_pairs` made (coefficients by atom
type). ``if PER_ATOM:`` the site tells how its energy is shared, with ``share_pair(shares, j, e, gx, gy, gz)``, half of it and of its
virial to i and half to neighbour j, and ``share_triple(shares, j, k, e, gjx, gjy, gjz, gkx, gky, gkz)``, a third to each. Bodies
follow the rules of `asemd.style`: strict, compiled, ``math`` only.

::

    class SW(ManyBody):
        def read(self, file, elements, settings): ...      # -> what pack_pairs needs, kept as coeff["data"]
        def pack_pairs(self, settings, filled, ntypes, units, shift=False): ...     # -> PairTables; rows[0]: cutoffs^2

    register(SW("sw", site=site, rooms=6, ...))

A style that is no sum of such sites (densities first, then forces) has `forces` instead of `site`: its whole kernel, with the arguments
that `asemd.kernels.manybody.site_forces` has and the helpers of that module. Its threads own atoms ``lo..hi-1``, may use
``shared (shares, cap)``, rows of numbers by slot that all threads see, and wait for each other with ``barrier(meeting)``.

A sum over pairs whose coefficients are in a file has `parts`, as any pair style, and neither `site` nor `forces`.

More words before the elements, as a library of elements and a second file: `head_words`, `head`, `read_head`.

A file for each pair of types, as eam has: ``elements=False``, and ``coeff`` as for any pair style. Cutoffs are whatever `pack_pairs`
says, special_bonds weights other than 0 do not matter, and there is no energy of a single pair, as in LAMMPS.
"""
from __future__ import annotations

import inspect
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np

from asemd.errors import InputError
from asemd.pairstyle import PairStyle, PairTables, missing_pairs
from asemd.potential_file import PotentialFile


class ManyBody(PairStyle, ABC):
    """A many-body pair style.

    Parameters
    ----------
    name : str
    site, forces, parts
        One of the three, see above; `helpers` are functions that `site` or `forces` calls.
    eight : callable, optional
        ``eight(end, b, types, arrays, constants)``, the same energy for tables that `fits` agrees to, of eight sites at once with
        `eight_rows` rows of work space; `eight_helpers` are functions that it calls: see `asemd.kernels.eight_sites`.
    rooms, shares : int
        Rows of work space by neighbour of a thread, and by slot for all threads.
    elements : bool
        Coefficients are a file and an element for each atom type.
    converts : bool
        Files in metal units can be used with real units and the other way round; otherwise they must agree.
    """

    many = True
    restarts = False               # potential files are not kept
    kernel_constants: Mapping[str, Any] = MappingProxyType({})      # module constants of `forces` and `helpers`
    flat_room = False         # `room` is one row
    head_words = "FILE"       # words of ``pair_coeff`` before the elements of the types
    ghost_list = False             # LAMMPS's log says that its list has those of ghost atoms too
    usual = ""                     # words of its settings that a calculator has by default
    whole = False                  # one kernel, with energies, for all steps: where the compiler takes long

    def __init__(self, name: str, *, site: Callable | None = None, forces: Callable | None = None, eight: Callable | None = None,
                 eight_rows: int = 0, eight_helpers=(), parts=(), helpers=(), rooms: int = 1, shares: int = 0, elements: bool = True,
                 converts: bool = True, settings="", coeff="", example="", **options):
        coeff, notes = ("file element", {"file": "path", "element": "word"}) if elements else (coeff, {})
        options["units"] = {**notes, **options.get("units", {})}
        options.setdefault("doc", inspect.getdoc(inspect.getmodule(site or forces or parts[0][0])) or "")
        super().__init__(name, parts, settings=settings, coeff=coeff, example=example, **options)
        self.site, self.forces, self.helpers = site, forces, tuple(helpers)
        self.eight, self.eight_rows, self.eight_helpers = eight, eight_rows, tuple(eight_helpers)
        self.reads = name.partition("/")[0]      # the word for it in LAMMPS's log
        self.rooms, self.shares, self.elements, self.converts = rooms, shares, elements, converts

    # ------------------------------------------------------------------ for styles to write ---

    @abstractmethod
    def read(self, file: PotentialFile, elements: tuple[str, ...], settings: Mapping[str, Any]) -> Any:
        """What the file says about the elements (without NULL, each once)."""

    def head(self, words: Sequence[str], what: str) -> int:
        """How many words are before the elements of the types: a file, or what `head_words` names."""
        return 1

    def read_head(self, head: tuple[str, ...], elements: tuple[str, ...], settings: Mapping[str, Any]) -> tuple[Any, PotentialFile]:
        """What the words before the elements of the types say about these, and the file that says in which units."""
        file = PotentialFile(head[0], f"pair_coeff {self.name}")
        return self.read(file, elements, settings), file

    def head_for(self, files: Sequence[str], elements: Sequence[str]) -> list[str]:
        """The words before the elements of the types, for a calculator of these files whose atoms have these elements."""
        return list(files)

    def report(self, coeff: Mapping[str, Any]) -> list[str]:
        """Lines of LAMMPS's log about the files of these coefficients."""
        file = coeff["units"]
        return [f"Reading {self.reads} potential file {file.name} with DATE: {file.date}".replace("  ", " ")] if file.date else []

    @abstractmethod
    def pack_pairs(self, settings, filled, ntypes, units, shift=False) -> PairTables:
        """Squared cutoffs by pair of types as ``rows[0]`` (0: no interaction), constants and arrays of the kernel."""

    def fits(self, tables: PairTables) -> bool:
        """Whether `eight` can compute with these tables."""
        return False

    def alike(self, tables: PairTables) -> bool:
        """Whether all atoms have the same coefficients, those of the first type."""
        return True

    def room_for(self, tables: PairTables, width: int) -> int:
        """Rows of work space of a thread, each as wide as the longest row of neighbours."""
        return self.rooms

    def for_some_types(self, settings: Mapping[str, Any]) -> bool:
        """Whether ``pair_coeff`` may be given for some pairs of types, each with the whole line of elements."""
        return False

    # ------------------------------------------------------------------------------- words ---

    def parse_coeff(self, words, settings):
        if not self.elements:
            return super().parse_coeff(words, settings)
        what = f"pair_coeff {self.name}"
        count = self.head(words, what)
        if len(words) <= count:
            raise InputError(f"{what} needs * * {self.head_words} and an element, or NULL, for each atom type, got {len(words)} word"
                             f"{'s' * (len(words) != 1)} after the types")
        head, elements = tuple(words[:count]), tuple(words[count:])
        chosen = tuple(dict.fromkeys(e for e in elements if e != "NULL"))
        data, file = self.read_head(head, chosen, settings)
        values = {"file": " ".join(head), "head": head, "element": elements, "some": self.for_some_types(settings), "data": data,
                  "units": file, "reach": 0.0}
        n, used = len(elements), [t for t, e in enumerate(elements, 1) if e != "NULL"]
        if used:
            tables = self.pack_pairs(settings, {(i, j): values for i in used for j in used if i <= j}, n, None)
            values["reach"] = float(np.sqrt(tables.rows[0].max()))
        return values

    def join(self, old, new):
        return new if self.elements else dict(new)

    def format_coeff(self, coeff):
        return [*coeff["head"], *coeff["element"]] if self.elements else super().format_coeff(coeff)

    def keys(self, values, keys):
        """The pairs of types, of those of the command, that these coefficients are for: both are elements of the file.

        Raises
        ------
        InputError
            Not all types (``* *``), or not one element for each.
        """
        if not self.elements:
            return keys
        n, elements = max(j for _, j in keys), values["element"]
        if values["some"]:
            barred = [t for pair in keys for t in pair if t <= len(elements) and elements[t - 1] == "NULL"]
            if barred:
                raise InputError(f"pair_coeff {self.name}: type {barred[0]} is mapped to NULL, leave it out of the types of the command")
            return keys
        if len(keys) != n * (n + 1) // 2:
            raise InputError(f"pair_coeff {self.name} must be for all types at once: pair_coeff * * {values['file']} ...")
        if len(elements) != n:
            raise InputError(f"pair_coeff {self.name} needs an element, or NULL, for each of {n} atom types, got {len(elements)}: "
                             f"{' '.join(elements)}")
        return [(i, j) for i, j in keys if elements[i - 1] != "NULL" and elements[j - 1] != "NULL"]

    def lines(self, coeffs):
        if not self.elements:
            return super().lines(coeffs)
        different = {(c["file"], c["element"]): c for c in coeffs.values()}
        some = [(key, [str(t) for t in key], self.format_coeff(c)) for key, c in coeffs.items() if c["some"]]
        return some + [((0, 0), ["*", "*"], self.format_coeff(c)) for c in different.values() if not c["some"]]

    # ------------------------------------------------------------------------ coefficients ---

    def filled(self, coeffs, settings, ntypes, rule=None, only=None):
        pairs = only if only is not None else {(i, j) for i in range(1, ntypes + 1) for j in range(i, ntypes + 1)}
        if self.elements:
            missing = sorted(pair for pair in pairs if pair not in coeffs)
            if missing:
                raise InputError(f"{missing_pairs(missing)}: pair_coeff * * FILE needs an element for each type")
            for c in coeffs.values():
                if len(c["element"]) != ntypes:
                    raise InputError(f"pair_coeff {self.name} needs an element, or NULL, for each of {ntypes} atom types, got "
                                     f"{len(c['element'])}: {' '.join(c['element'])}")
        return {pair: coeffs[pair] for pair in sorted(pairs) if pair in coeffs}

    def reset_cutoffs(self, coeffs):
        return dict(coeffs)

    def reach(self, coeff, settings):
        if "reach" in coeff:
            return coeff["reach"]
        return float(np.sqrt(self.pack_pairs(settings, {(1, 1): coeff}, 1, None).rows[0].max()))

    def unit_factor(self, coeff: Mapping[str, Any], units) -> float:
        """Factor from the energies of a file to those of the scene.

        Raises
        ------
        InputError
            The file is in other units, and the style does not convert them.
        """
        file, name = coeff["units"], units.name if units is not None else ""
        factor = file.factor(name)
        if factor != 1.0 and not self.converts:
            raise file.error(f"the file is in {file.units} units, but {name} units are in use", 1)
        return factor


def element_of(filled: Mapping[tuple[int, int], Mapping[str, Any]], ntypes: int) -> list[str | None]:
    """The element of each atom type, None for types that the style does not serve (and for entry 0)."""
    out: list[str | None] = [None] * (ntypes + 1)
    for (i, j), c in filled.items():
        out[i], out[j] = c["element"][i - 1], c["element"][j - 1]
    return out
