"""Atoms, scenes and trajectories as universes of MDAnalysis, and back."""
from __future__ import annotations

import numpy as np
from ase.calculators.singlepoint import SinglePointCalculator

from asemd.atoms import Atoms
from asemd.errors import InputError
from asemd.interop.attributes import attributes, connections, new_atoms, same_items, topology_of, update
from asemd.interop.frames import FORCE, SPEED, Frame, frame_of
from asemd.interop.sources import frames_of, remembered


def to_mdanalysis(source, dt: float = 1.0):
    """A Universe of MDAnalysis with everything that atoms, a scene or a trajectory know.

    Parameters
    ----------
    source : ase.Atoms, asemd.Scene, asemd.Lammps, asemd.Session, or iterable of ase.Atoms
        Frames of a trajectory have the same atoms in the same order; an ASE trajectory that was opened will do.
    dt : float
        Time between frames, ps.

    Returns
    -------
    MDAnalysis.Universe
        Frames in memory, in Angstrom, Angstrom/ps, kJ/mol/Angstrom (``units lj`` numbers pass unchanged), unwrapped by the image flags,
        turned so that the cell's a lies along x and b in the xy plane. The attributes are ids, names, types, elements, masses, charges,
        resids (residue numbers, else molecule ids), molnums (molecule ids), and bonds, angles, dihedrals, impropers and cmaps with
        their types. Velocities and forces are there if all frames have them; none are computed.

    Raises
    ------
    InputError
        Something else was given, frames differ in their atoms, or MDAnalysis is not installed.

    Notes
    -----
    MDAnalysis keeps positions in single precision and knows cells that are periodic in all directions or none. The universe remembers
    the atoms it was made of, and `from_mdanalysis` gives what was not changed back to the last bit.

    Atoms of a script stand in the order of their ids, as in a dump that MDAnalysis reads: ``universe.load_new`` of the dump of all atoms
    of the same run fits. Atoms and trajectories of ASE keep their own order.
    """
    mda = library()
    frames, reduced = frames_of(source, "to_mdanalysis", by_id=True)
    sources = [remembered(atoms) for atoms in frames]
    _share(sources)
    universe = mda.Universe(topology_of(sources[0]), to_guess=())
    universe.trajectory = in_memory([frame_of(atoms, reduced) for atoms in sources], sources, reduced, dt)
    return universe


def from_mdanalysis(group) -> Atoms:
    """Atoms of a Universe or AtomGroup at its current frame.

    Parameters
    ----------
    group : MDAnalysis.Universe or AtomGroup

    Returns
    -------
    asemd.Atoms
        With bonds, types, charges, masses, molecules and velocities, in ASE's units; forces in a single-point calculator if the frame has
        them. Names and residues become the arrays ``atomtypes``, ``residuenames``, ``residuenumbers``, as ASE has them of PDB files.
        Types that are no numbers are numbered in alphabetical order, and ``info["labels"]`` says which is which. Atoms of a universe
        that `to_mdanalysis` made come back in their own orientation, to the last bit, with all their arrays; what was changed in the
        universe is changed in them, in its single precision.

    Raises
    ------
    InputError
        Something else was given, or the group is empty.
    """
    library()
    from asemd.interop.converter import Frames
    try:
        ag = group.atoms
        universe = ag.universe
    except AttributeError:
        raise InputError(f"from_mdanalysis needs a Universe or AtomGroup of MDAnalysis, got {type(group).__name__}") from None
    if not len(ag):
        raise InputError("from_mdanalysis: the group has no atoms")
    reader, labels = getattr(universe, "_trajectory", None), {}
    if isinstance(reader, Frames):
        source = reader.source
        atoms = source[ag.ix]
        update(atoms, ag, attributes(source))
        topology = connections(ag, labels)
        if not same_items(topology, atoms.topology):
            atoms.topology = topology
        _restore(atoms, ag.ix, reader.ts, frame_of(source, reader.reduced), reader.reduced)
    else:
        atoms = new_atoms(ag)
        atoms.topology = connections(ag, labels)
        if reader is not None:
            _place(atoms, ag.ix, reader.ts)
    if labels:
        atoms.info["labels"] = atoms.info.get("labels", {}) | labels
    return atoms


# ---- there ------------------------------------------------------------------------------------------------------------------------------
def _share(sources: list[Atoms]) -> None:
    """Keep once what is the same in all frames."""
    first = sources[0]
    for later in sources[1:]:
        for name, array in first.arrays.items():
            if name in later.arrays and np.array_equal(later.arrays[name], array):
                later.arrays[name] = array
        if later.topology == first.topology:
            later.topology = first.topology


def in_memory(frames: list[Frame], sources: list[Atoms], reduced: bool, dt: float, kind=None):
    """A reader of frames for MDAnalysis."""
    from asemd.interop.converter import Frames

    def stacked(name):
        parts = [getattr(frame, name) for frame in frames]
        return None if any(p is None for p in parts) else np.array(parts, np.float32)
    return (kind or Frames)(stacked("positions"), sources, reduced, dt=dt, dimensions=stacked("dimensions"),
                            velocities=stacked("velocities"), forces=stacked("forces"))


# ---- back -------------------------------------------------------------------------------------------------------------------------------
def _place(atoms: Atoms, rows: np.ndarray, ts) -> None:
    """Positions, cell and velocities of a frame of any reader."""
    from MDAnalysis.lib.mdamath import triclinic_vectors
    if ts.has_positions:
        atoms.positions[:] = ts.positions[rows]
    if ts.dimensions is not None:
        atoms.set_cell(triclinic_vectors(ts.dimensions, np.float64))
        atoms.set_pbc(atoms.cell.rank == 3)
    if ts.has_velocities:
        atoms.set_velocities(ts.velocities[rows].astype(float) / SPEED)
    if ts.has_forces:
        atoms.calc = SinglePointCalculator(atoms, forces=ts.forces[rows].astype(float) / FORCE)


def _restore(atoms: Atoms, rows: np.ndarray, ts, frame: Frame, reduced: bool) -> None:
    """What the frame has that is not as it was made: the rest of the atoms is kept in double precision."""
    from MDAnalysis.lib.mdamath import triclinic_vectors
    back = frame.rotation.T
    dimensions = np.zeros(6, np.float32) if ts.dimensions is None else ts.dimensions
    if not np.array_equal(dimensions, frame.dimensions):
        atoms.positions[:] = frame.positions[rows] @ back
        if "image" in atoms.arrays:         # they counted the cells as they were
            atoms.arrays["image"][:] = 0
        atoms.set_cell(triclinic_vectors(dimensions, np.float64) @ back)
        atoms.set_pbc(atoms.pbc if atoms.pbc.any() and dimensions.any() else bool(dimensions.any()))
    moved, x = _changed(ts.positions[rows], frame.positions[rows], back)
    if len(moved):
        image = atoms.arrays.get("image")
        atoms.positions[moved] = x if image is None else x - image[moved].astype(float) @ atoms.cell.array
    if ts.has_velocities:
        known = frame.velocities
        changed, v = _changed(ts.velocities[rows], None if known is None else known[rows], back)
        if len(changed):
            velocities = atoms.get_velocities()
            velocities[changed] = v / (1.0 if reduced else SPEED)
            atoms.set_velocities(velocities)
    if ts.has_forces:
        unit = 1.0 if reduced else FORCE
        forces = np.zeros((len(atoms), 3)) if frame.forces is None else frame.forces[rows] @ back / unit
        changed, f = _changed(ts.forces[rows], None if frame.forces is None else frame.forces[rows], back)
        forces[changed] = f / unit
        atoms.calc = SinglePointCalculator(atoms, forces=forces)


def _changed(now: np.ndarray, before: np.ndarray | None, back: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rows of single-precision vectors that are not those of before any more, and what they are now, turned back."""
    rows = np.arange(len(now)) if before is None else np.flatnonzero((now != before.astype(np.float32)).any(axis=1))
    return rows, now[rows].astype(float) @ back


def library():
    """MDAnalysis, with the converter registered.

    Raises
    ------
    InputError
        It is not installed.
    """
    try:
        import MDAnalysis

        import asemd.interop.converter  # noqa: F401  registers
    except ImportError:
        raise InputError("MDAnalysis is not installed: pip install MDAnalysis") from None
    return MDAnalysis
