"""LAMMPS's input language: sessions, scripts, data files, and `Lammps`, with the methods of the ``lammps`` Python module."""
from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from asemd.errors import InputError
from asemd.lammps.atom_arrays import AtomArrays
from asemd.lammps.library import Library

if TYPE_CHECKING:
    from asemd.scene import Scene

LMP_STYLE_GLOBAL, LMP_STYLE_ATOM, LMP_STYLE_LOCAL = 0, 1, 2
LMP_TYPE_SCALAR, LMP_TYPE_VECTOR, LMP_TYPE_ARRAY, LMP_SIZE_VECTOR, LMP_SIZE_ROWS, LMP_SIZE_COLS = 0, 1, 2, 3, 4, 5
TYPE_COUNTS = ("ntypes", "nbondtypes", "nangletypes", "ndihedraltypes", "nimpropertypes")
FLAGS = {"mu": "mu", "torque": "torque", "omega": "omega", "angmom": "angmom", "ellipsoid": "shape"}      # arrays of atoms
ITEMS = {"nbonds": "bonds", "nangles": "angles", "ndihedrals": "dihedrals", "nimpropers": "impropers"}


class Lammps(AtomArrays, Library):
    """A session with the methods of the ``lammps`` Python module.

    Parameters
    ----------
    name : str
        Not used; there for compatibility.
    cmdargs : sequence of str, optional
        LAMMPS's switches: ``-screen -log -echo -nocite -var -in -sf -pk`` and short forms, ``-compat lammps`` and ``-watchdog no``.
    ptr, comm
        Must be None.

    Notes
    -----
    Errors are exceptions of `asemd.errors`; their text carries the place in the script, or the command. Per-atom arrays of
    `extract_atom` are the session's own: writing to them changes the atoms. Rows are in the order of the session, `gather_atoms` is in
    order of id.

    Examples
    --------
    >>> with Lammps(cmdargs=["-screen", "none", "-log", "none"]) as l:      # doctest: +SKIP
    ...     l.file("in.melt")
    ...     print(l.get_thermo("pe"))
    """

    def __init__(self, name: str = "", cmdargs: Sequence[str] | None = None, ptr=None, comm=None):
        from asemd.lammps.session import Session
        from asemd.lammps.switches import parse
        if ptr is not None or comm is not None:
            raise InputError("Lammps: ptr and comm are not supported, asemd runs in this process")
        switches = parse(cmdargs or ())
        self.session = Session(switches=switches)
        self.closed = False
        if switches.input:
            self.file(switches.input)

    @classmethod
    def of(cls, session) -> Lammps:
        """The methods of this class for a session that is there already."""
        found = cls.__new__(cls)
        found.session, found.closed = session, True       # whoever made the session closes it
        return found

    def __enter__(self) -> Lammps:
        return self

    def __exit__(self, *error) -> None:
        self.close()

    def close(self) -> None:
        """Close dumps and log."""
        if not self.closed:
            self.closed = True
            self.session.close()

    finalize = close

    @property
    def scene(self) -> Scene:
        """The scene the commands have built."""
        return self.session.scene

    # ------------------------------------------------------------- commands ---

    def command(self, cmd: str) -> None:
        """Execute one command."""
        self._guarded(self.session.execute, cmd)

    def commands_list(self, cmdlist: Iterable[str]) -> None:
        """Execute several commands."""
        self.commands_string("\n".join(c.rstrip("\n") for c in cmdlist))

    def commands_string(self, multicmd: str) -> None:
        """Execute the lines of a text."""
        self._guarded(self.session.commands, multicmd)

    def file(self, path: str | os.PathLike) -> None:
        """Execute a script."""
        self._guarded(self.session.file, os.fspath(path))

    def _guarded(self, function, argument) -> None:
        """``quit`` ends the script, not the caller."""
        from asemd.lammps.session import Stop
        try:
            function(argument)
        except Stop:
            self.session.log.flush()
        except Exception as e:
            self.session.log.write(f"ERROR: {e}\n")
            self.session.log.flush()
            raise

    def expand(self, line: str) -> str:
        """The text with its variables replaced."""
        return self.session.substitute(line)

    def eval(self, expr: str) -> float:
        """The value of an equal-style formula."""
        return self.session.variables.evaluate(expr)

    # --------------------------------------------------------------- thermo ---

    def get_thermo(self, name: str) -> float:
        """Current value of a thermo keyword."""
        from asemd.thermo import evaluate
        return float(evaluate(self.session.moment, name, self.scene.thermo.is_normalised(self.scene.units)))

    def last_thermo(self) -> dict[str, Any] | None:
        """The last thermo row: column title -> value; None if there was none."""
        return dict(self.session.last_thermo) or None

    @property
    def last_thermo_step(self) -> int:
        """Step of the last thermo row, -1 if there was none."""
        return self.session.last_thermo_step

    @property
    def is_running(self) -> bool:
        return self.session.running

    # ------------------------------------------------------------------ box ---

    def extract_box(self) -> list:
        """[boxlo, boxhi, xy, yz, xz, periodicity, box_change]"""
        box = self.scene.need_system("extract_box").box
        xy, xz, yz = (float(t) for t in box.tilt)
        change = int(self.scene.box_changes)
        return [[float(v) for v in box.lo], [float(v) for v in box.hi], xy, yz, xz, [int(p) for p in box.periodic], change]

    def reset_box(self, boxlo: Sequence[float], boxhi: Sequence[float], xy: float, yz: float, xz: float) -> None:
        """Another box, the atoms stay where they are."""
        from asemd.box import Box
        system = self.scene.need_system("reset_box")
        system.box = Box.from_lammps(boxlo, boxhi, (xy, xz, yz), system.box.boundary, triclinic=system.box.triclinic)
        self.session.changed()

    def extract_global(self, name: str, dtype=None):
        """A global quantity: counts, box, step, timestep, constants of the unit style; None if unknown."""
        from asemd import units
        scene, system = self.scene, self.scene.system
        box = system.box if system is not None else None
        if name in ("units", "dimension", "dt"):
            return getattr(scene, name)
        if name in ("ntimestep", "atimestep"):
            return scene.step if name == "ntimestep" else scene.time_base[1]
        if name == "atime":
            return scene.time_base[0]
        if name in ("natoms", "nlocal", "nmax"):
            return self.get_natoms()
        if name == "nghost":
            return 0
        if name in TYPE_COUNTS:
            return system.counts[name] if system is not None else 0
        if name in ITEMS:
            return len(getattr(system.topology, ITEMS[name])) if system is not None else 0
        if name == "q_flag":
            return int(system is not None and system.has_charge)
        if box is not None:
            if name in ("boxlo", "boxhi", "sublo", "subhi"):
                return [float(v) for v in (box.lo if name.endswith("lo") else box.hi)]
            if name in ("xy", "xz", "yz"):
                return float(box.tilt[("xy", "xz", "yz").index(name)])
            if name == "triclinic":
                return int(box.triclinic)
            if name == "periodicity":
                return [int(p) for p in box.periodic]
            if name[:3] == "box" and name[3:] in ("xlo", "xhi", "ylo", "yhi", "zlo", "zhi"):
                return float((box.lo if name.endswith("lo") else box.hi)["xyz".index(name[3])])
        return getattr(units.get(scene.units), "qqr2e" if name == "qqrd2e" else name, None)

    def extract_setting(self, name: str) -> int:
        """A count or a flag; -1 if unknown."""
        scene, system = self.scene, self.scene.system
        simple = {"dimension": scene.dimension, "box_exist": int(system is not None), "nthreads": scene.threads, "nghost": 0,
                  "tagint": 4, "bigint": 8, "imageint": 4, "newton_pair": int(scene.newton[0]),
                  "newton_bond": int(scene.newton[1]), "world_size": 1, "world_rank": 0,
                  "universe_size": 1, "universe_rank": 0, "nprocs": 1}
        if name in simple:
            return simple[name]
        if name in ("nlocal", "nall", "natoms", "nmax"):
            return self.get_natoms()
        if name in TYPE_COUNTS or name in ITEMS:
            return self.extract_global(name)
        flags = {"triclinic": lambda: system.box.triclinic, "molecule_flag": lambda: system.has_molecules,
                 "q_flag": lambda: system.has_charge,
                 "rmass_flag": lambda: system.rmass is not None, "radius_flag": lambda: "radius" in system.extra,
                 **{f"{key}_flag": lambda name=name: name in system.extra for key, name in FLAGS.items()}}
        if name in flags:
            return int(flags[name]()) if system is not None else 0
        return -1

    # ------------------------------------------------- computes, fixes, variables ---

    def extract_compute(self, cid: str, cstyle: int, ctype: int):
        """Value of a compute: float, or array; per-atom values in the session's order, local ones by their first atom."""
        moment = self.session.moment
        kinds = {LMP_TYPE_SCALAR: "scalar", LMP_TYPE_VECTOR: "vector", LMP_SIZE_VECTOR: "vector"}
        kind = {LMP_STYLE_ATOM: "per_atom", LMP_STYLE_LOCAL: "local"}.get(cstyle, kinds.get(ctype, "array"))
        value = getattr(moment, kind)(cid)
        if ctype == LMP_SIZE_VECTOR:
            return len(value)
        if ctype in (LMP_SIZE_ROWS, LMP_SIZE_COLS):
            return np.shape(value)[ctype - LMP_SIZE_ROWS] if np.ndim(value) > ctype - LMP_SIZE_ROWS else 0
        return value

    def extract_fix(self, fid: str, fstyle: int, ftype: int, nrow: int = 0, ncol: int = 0):
        """Value of a fix; elements of global vectors and arrays one by one, counted from 0."""
        fix = self.session.moment.fix(fid)
        if fstyle == LMP_STYLE_ATOM:
            return fix.per_atom(self.session.moment.snapshot)
        if ftype == LMP_TYPE_SCALAR:
            return float(fix.scalar())
        if ftype == LMP_TYPE_VECTOR:
            return float(fix.vector(nrow + 1))
        if ftype == LMP_TYPE_ARRAY:
            return float(fix.array(nrow + 1, ncol + 1))
        if ftype == LMP_SIZE_VECTOR and getattr(fix, "size", None) is not None:
            return fix.size
        raise InputError(f"extract_fix: fix {fid} (style {fix.style}) does not give that")

    def extract_variable(self, name: str, group: str | None = None, vartype: int | None = None):
        """Value of a variable: number, text, or (n,) array for style atom (zero outside the group)."""
        variables = self.session.variables
        style = variables.find(name).style
        if style in ("atom", "atomfile"):
            values = variables.per_atom(name, self.get_natoms())
            return np.where(self.scene.groups.mask(group), values, 0.0) if group else values
        if style == "vector":
            return variables.vector(name)
        return variables.number(name) if style in ("equal", "internal", "timer") else variables.value(name)

    def set_variable(self, name: str, value) -> int:
        """Set a string-style variable; 0, or -1 if there is none."""
        return self._set(name, value, "string")

    set_string_variable = set_variable

    def set_internal_variable(self, name: str, value: float) -> int:
        """Set an internal-style variable; 0, or -1 if there is none."""
        return self._set(name, repr(float(value)), "internal")

    def _set(self, name: str, value, style: str) -> int:
        variable = self.session.variables.table.get(name)
        if variable is None or variable.style != style:
            return -1
        self.session.variables.set(name, str(value))
        return 0

    # ---------------------------------------------------------- introspection ---

    def has_style(self, category: str, name: str) -> bool:
        """Whether a style exists here."""
        from asemd.lammps import catalog
        return catalog.exists(category, name)

    def available_styles(self, category: str) -> list[str]:
        """All styles of a category."""
        from asemd.lammps import catalog
        return list(catalog.names(category)) if category in (*catalog.PACKAGES, "atom", "integrate") else []

    def has_id(self, category: str, name: str) -> bool:
        return name in self.available_ids(category)

    def available_ids(self, category: str) -> list[str]:
        """IDs of compute, dump, fix, group, region or variable."""
        scene = self.scene
        tables = {"compute": scene.computes, "dump": scene.dumps, "fix": scene.fixes, "group": scene.groups, "region": scene.regions,
                  "variable": self.session.variables.table}
        return list(tables.get(category, ()))

    def version(self) -> int:
        """The LAMMPS version whose input language this is."""
        from asemd.formula import VERSION
        return int(VERSION)

    has_exceptions = True
    has_mpi_support = False
    has_gzip_support = True

    @property
    def numpy(self) -> NumpyView:
        """The methods that return arrays, under the names of ``lammps.numpy``."""
        return NumpyView(self)


class NumpyView:
    """``lammps.numpy``: the same quantities as numpy arrays."""

    def __init__(self, session: Lammps):
        self._l = session

    def extract_atom(self, name: str, dtype=None, nelem=None, dim=None) -> np.ndarray:
        return self._l.extract_atom(name)

    def extract_compute(self, cid: str, cstyle: int, ctype: int):
        return self._l.extract_compute(cid, cstyle, ctype)

    def extract_fix(self, fid: str, fstyle: int, ftype: int, nrow: int = 0, ncol: int = 0):
        return self._l.extract_fix(fid, fstyle, ftype, nrow, ncol)

    def extract_variable(self, name: str, group: str | None = None, vartype: int | None = None):
        return self._l.extract_variable(name, group, vartype)

    def get_neighlist(self, idx: int):
        return self._l.get_neighlist(idx)

    def get_neighlist_element_neighbors(self, idx: int, element: int) -> tuple[int, np.ndarray]:
        """Row of the atom, rows of its neighbours."""
        return self._l.get_neighlist(idx)[element]

    def fix_external_get_force(self, fix_id: str) -> np.ndarray:
        return self._l.fix_external_get_force(fix_id)

    def fix_external_set_energy_peratom(self, fix_id: str, eatom) -> None:
        self._l.fix_external_set_energy_peratom(fix_id, eatom)

    def fix_external_set_virial_peratom(self, fix_id: str, vatom) -> None:
        self._l.fix_external_set_virial_peratom(fix_id, vatom)

    def gather_atoms(self, name: str, dtype: int, count: int) -> np.ndarray:
        """(n,) or (n, count) array in order of id."""
        values = np.array(self._l.gather_atoms(name, dtype, count))
        return values.reshape(-1, count) if count > 1 else values

    def gather_bonds(self) -> np.ndarray:
        """(nbonds, 3) type, id, id."""
        return np.array(self._l.gather_bonds()[1]).reshape(-1, 3)

    def gather_angles(self) -> np.ndarray:
        """(nangles, 4) type, id, id, id."""
        return np.array(self._l.gather_angles()[1]).reshape(-1, 4)

    def gather_dihedrals(self) -> np.ndarray:
        """(ndihedrals, 5) type and four ids."""
        return np.array(self._l.gather_dihedrals()[1]).reshape(-1, 5)

    def gather_impropers(self) -> np.ndarray:
        """(nimpropers, 5) type and four ids."""
        return np.array(self._l.gather_impropers()[1]).reshape(-1, 5)


lammps = Lammps        # ``sys.modules["lammps"] = asemd.lammps`` serves programs that import the ``lammps`` module
