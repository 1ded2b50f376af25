"""Methods of the ``lammps`` Python module beside commands and atoms: what is installed, types and sizes of data, fix external, lists."""
from __future__ import annotations

import platform
from collections.abc import Callable, Sequence

import numpy as np

from asemd.errors import InputError, SimulationError, nearest

LAMMPS_NONE, LAMMPS_INT, LAMMPS_DOUBLE, LAMMPS_INT64, LAMMPS_STRING = -1, 0, 2, 4, 6
LONG = ("natoms", "nbonds", "nangles", "ndihedrals", "nimpropers", "ntimestep", "atimestep")       # 64-bit numbers
PACKAGES = ("CLASS2", "EXTRA-FIX", "EXTRA-MOLECULE", "EXTRA-PAIR", "KSPACE", "MOLECULE", "MOFFF", "OPENMP", "PYTHON", "YAFF")
WARNING = 1


class Library:
    """The methods of `asemd.lammps.Lammps` that need neither commands nor atoms; works on its `session` and `scene`."""

    accelerator_config: dict = {}
    has_gpu_device = has_curl_support = has_ffmpeg_support = has_jpeg_support = has_png_support = False

    # ---- what is there ------------------------------------------------------------------------------------------------------------------
    @property
    def installed_packages(self) -> list[str]:
        """LAMMPS's packages whose styles are here, wholly or in part."""
        return list(PACKAGES)

    def has_package(self, name: str) -> bool:
        return name in PACKAGES

    def available_plugins(self, category: str | None = None) -> list:
        """Nothing: styles of one's own come by `asemd.style`, not as plugins."""
        return []

    def get_os_info(self) -> str:
        """Operating system and Python."""
        return f"{platform.platform()}, Python {platform.python_version()}"

    def get_gpu_device_info(self) -> str:
        return ""

    def get_mpi_comm(self) -> None:
        """None: there is one process."""

    # ---- kinds and sizes of data --------------------------------------------------------------------------------------------------------
    def extract_atom_datatype(self, name: str) -> int:
        """Number that says what `extract_atom` gives: 0 int, 1 int by row, 2 float, 3 float by row; -1 for an unknown name."""
        try:
            values = self.extract_atom(name)
        except InputError:
            return LAMMPS_NONE
        return (LAMMPS_DOUBLE if values.dtype.kind == "f" else LAMMPS_INT) + values.ndim - 1

    def extract_atom_size(self, name: str, dtype: int) -> int:
        """Rows (`dtype` LMP_SIZE_ROWS) or columns (LMP_SIZE_COLS) of a per-atom property; -1 if there are none of these."""
        try:
            shape = self.extract_atom(name).shape
        except InputError:
            return -1
        return int(shape[0]) if dtype != 5 else int(shape[1]) if len(shape) > 1 else 0

    def extract_global_datatype(self, name: str) -> int:
        """Number that says what `extract_global` gives: 0 int, 2 float, 4 64-bit int, 6 text; -1 for an unknown name."""
        value = self.extract_global(name)
        value = value[0] if isinstance(value, list) else value
        if value is None:
            return LAMMPS_NONE
        if isinstance(value, str):
            return LAMMPS_STRING
        return LAMMPS_DOUBLE if isinstance(value, float) else LAMMPS_INT64 if name in LONG else LAMMPS_INT

    def extract_pair(self, name: str):
        """Coefficients of the pair style, (ntypes + 1, ntypes + 1), rows and columns 0 unused; a number for a setting; None if unknown.

        Mixed coefficients are those that have been used so far.
        """
        uses = self.scene.interactions.uses["pair"]
        if len(uses) != 1:
            return None
        use, n = uses[0], self.scene.need_system("extract_pair").counts["ntypes"]
        if any(p.name == name for p in use.style.coeff):
            out = np.zeros((n + 1, n + 1))
            for (i, j), values in use.coeff.items():
                out[i, j] = out[j, i] = np.nan if values.get(name) is None else values[name]
            return out
        return use.settings.get(name)

    def extract_pair_dimension(self, name: str) -> int | None:
        """2 for coefficients of pairs of types, 0 for a setting, None if unknown."""
        value = self.extract_pair(name)
        return None if value is None else int(np.ndim(value))

    def map_atom(self, atomid: int) -> int | None:
        """Row of an atom id; None if there is none."""
        found = np.flatnonzero(self.scene.need_system("map_atom").id == int(atomid))
        return int(found[0]) if len(found) else None

    # ---- errors and output --------------------------------------------------------------------------------------------------------------
    def error(self, error_type: int, error_text: str) -> None:
        """A warning in the log for type 1, otherwise an exception."""
        if error_type & WARNING:
            self.session.log.warn(error_text)
        else:
            raise SimulationError(error_text)

    def set_show_error(self, flag: bool) -> None:
        """Errors are exceptions, shown by whoever catches them: no effect."""

    def flush_buffers(self) -> None:
        """Bring the log to the disk."""
        self.session.log.flush()

    def force_timeout(self) -> None:
        """End the current run in order after the steps it is at; called from another thread or a callback."""
        self.session.interrupted = True

    def clearstep_compute(self) -> None:
        """Computes are evaluated when asked for: no effect."""

    def addstep_compute(self, nextstep: int) -> None:
        """Computes are evaluated when asked for: no effect."""

    def addstep_compute_all(self, nextstep: int) -> None:
        """Computes are evaluated when asked for: no effect."""

    @property
    def cmd(self) -> Commands:
        """Commands as methods: ``l.cmd.run(100, "post", "no")``."""
        return Commands(self.command)

    @property
    def ipython(self):
        raise InputError("Lammps.ipython is not supported: use asemd.read and ASE's viewers")

    # ---- neighbour lists ----------------------------------------------------------------------------------------------------------------
    def find_pair_neighlist(self, style: str, exact: bool = True, nsub: int = 0, reqid: int = 0) -> int:
        """0 for the list of a pair style in use once there was a run, else -1."""
        uses = [u.style.name for u in self.scene.interactions.uses["pair"]]
        return 0 if self.session.loop is not None and any(u == style or (not exact and style in u) for u in uses) else -1

    def find_fix_neighlist(self, fixid: str, reqid: int = 0) -> int:
        """-1: fixes have no lists of their own."""
        return -1

    def find_compute_neighlist(self, computeid: str, reqid: int = 0) -> int:
        """-1: computes have no lists of their own."""
        return -1

    def get_neighlist(self, idx: int) -> NeighborList:
        """The pairs of the last list within cutoff plus skin, each once.

        Raises
        ------
        InputError
            No such list.
        """
        if idx != 0 or self.session.loop is None or self.session.loop.engine.mode == "none":
            raise InputError(f"get_neighlist: there is no list {idx}: use find_pair_neighlist after a run")
        return NeighborList(self.session.loop.engine)

    def get_neighlist_size(self, idx: int) -> int:
        """Number of atoms in a list; -1 if there is no such list."""
        try:
            return len(self.get_neighlist(idx))
        except InputError:
            return -1

    def get_neighlist_element_neighbors(self, idx: int, element: int) -> tuple[int, int, np.ndarray]:
        """Row of the atom, number of neighbours, their rows."""
        i, neighbors = self.get_neighlist(idx)[element]
        return i, len(neighbors), neighbors

    # ---- fix external -------------------------------------------------------------------------------------------------------------------
    def _external(self, fix_id: str):
        fixes = self.scene.fixes
        if fix_id not in fixes:
            raise InputError(f"there is no fix {fix_id}{nearest(fix_id, fixes)}")
        if fixes[fix_id].style != "external":
            raise InputError(f"fix {fix_id} has style {fixes[fix_id].style}, not external")
        return fixes[fix_id]

    def set_fix_external_callback(self, fix_id: str, callback: Callable, caller=None) -> None:
        """The function ``callback([caller,] step, nlocal, ids, x, f)`` that fills `f` (n, 3) for fix external pf/callback."""
        self._external(fix_id).set_callback(callback, caller)

    def fix_external_get_force(self, fix_id: str) -> np.ndarray:
        """(n, 3) array by row that fix external adds to the forces; write to it."""
        return self._external(fix_id).forces(self.scene.system)

    def fix_external_set_energy_global(self, fix_id: str, eng: float) -> None:
        """The energy that belongs to the external forces."""
        self._external(fix_id).energy = float(eng)

    def fix_external_set_virial_global(self, fix_id: str, virial: Sequence[float]) -> None:
        """The virial (xx yy zz xy xz yz, pressure times volume) that belongs to the external forces."""
        self._external(fix_id).set_virial(virial)

    def fix_external_set_vector_length(self, fix_id: str, length: int) -> None:
        """The number of elements of the fix's vector."""
        self._external(fix_id).values = np.zeros(int(length))

    def fix_external_set_vector(self, fix_id: str, idx: int, val: float) -> None:
        """Set an element of the fix's vector, counted from 1."""
        values = self._external(fix_id).values
        if not 1 <= idx <= len(values):
            raise InputError(f"fix {fix_id}: index {idx} is out of range, the vector has {len(values)} elements")
        values[idx - 1] = val

    def fix_external_set_energy_peratom(self, fix_id: str, eatom: Sequence[float]) -> None:
        """Energies by row, set by the callback for its step; they count in compute pe/atom."""
        if self._asked(fix_id, "energies"):
            self._external(fix_id).set_energies(eatom)

    def fix_external_set_virial_peratom(self, fix_id: str, vatom: Sequence[Sequence[float]]) -> None:
        """Virials by row (xx yy zz xy xz yz, pressure times volume), set by the callback for its step, for compute stress/atom."""
        if self._asked(fix_id, "virials"):
            self._external(fix_id).set_virials(vatom)

    def _asked(self, fix_id: str, what: str) -> bool:
        """Whether the callback is at work."""
        if not self._external(fix_id).asking:
            self.session.warn(f"fix {fix_id} (style external): {what} by atom have no effect unless its callback sets them")
        return self._external(fix_id).asking


class Commands:
    """Commands as methods of this object."""

    def __init__(self, command: Callable[[str], None]):
        self._command = command

    def __getattr__(self, name: str) -> Callable[..., None]:
        if name.startswith("__"):
            raise AttributeError(name)
        return lambda *words: self._command(" ".join([name, *map(str, words)]))


class NeighborList:
    """Pairs of a neighbour list: element k is an atom's row and the rows of its neighbours, each pair in one of its two atoms' elements."""

    def __init__(self, engine):
        row = engine.state.row
        if engine.mode == "cluster" and not engine.expanded:
            i, j, _ = engine.list.expand(engine.k, engine.state, engine.reach)
        else:
            i, j = engine.plain[:2]
        i, j = row[i], row[j]
        order = np.argsort(i, kind="stable")
        self.start = np.searchsorted(i[order], np.arange(engine.system.n + 1))
        self.neighbors = j[order]

    def __len__(self) -> int:
        return len(self.start) - 1

    size = property(__len__)

    def __getitem__(self, k: int) -> tuple[int, np.ndarray]:
        if not 0 <= k < len(self):
            raise IndexError(k)
        return k, self.neighbors[self.start[k]:self.start[k + 1]]

    def get(self, element: int) -> tuple[int, int, np.ndarray]:
        """Row of the atom, number of neighbours, their rows."""
        i, neighbors = self[element]
        return i, len(neighbors), neighbors
