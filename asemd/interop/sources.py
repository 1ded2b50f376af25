"""What may be given to another library: atoms, scenes, sessions, trajectories."""
from __future__ import annotations

import numpy as np
from ase import Atoms as PlainAtoms
from ase.calculators.singlepoint import SinglePointCalculator

from asemd.atoms import Atoms
from asemd.calculator import ForceField
from asemd.errors import InputError
from asemd.interop.frames import is_reduced, known_forces
from asemd.scene import Scene


def frames_of(source, what: str, by_id: bool = False) -> tuple[list[Atoms], bool]:
    """The frames of whatever was given (those of a scene by id if wanted), and whether their numbers are in units lj."""
    source = getattr(source, "session", source)             # asemd.Lammps
    scene = getattr(source, "scene", source)                # a session
    if isinstance(scene, Scene):
        atoms = _of_scene(scene, what)
        return [atoms[np.argsort(atoms.arrays["id"])] if by_id else atoms], scene.units == "lj"
    if isinstance(source, PlainAtoms):
        source = [source]
    try:
        frames = list(source) if not isinstance(source, (str, bytes)) else []
    except TypeError:
        frames = [None]
    if not frames or not all(isinstance(atoms, PlainAtoms) for atoms in frames):
        raise InputError(f"{what} needs atoms, a scene, or frames that are atoms (ase.io.read(file, ':')), got "
                         f"{source if isinstance(source, str) else type(source).__name__}{'' if frames else ' without frames'}")
    for k, atoms in enumerate(frames):
        if not np.array_equal(atoms.numbers, frames[0].numbers):
            raise InputError(f"{what}: frame {k} has other atoms than the first ({len(atoms)} and {len(frames[0])}): they stay "
                             "the same in a trajectory")
    return frames, is_reduced(frames[0])


def _of_scene(scene: Scene, what: str) -> Atoms:
    """The atoms of a scene; type labels become their names."""
    atoms = scene.need_system(what).to_ase()
    labels = scene.system.labels["atom"]
    if labels:
        atoms.set_array("atomtypes", np.array([labels.get(int(t), str(t)) for t in atoms.arrays["type"]]))
    return atoms


def remembered(atoms) -> Atoms:
    """A copy with its bonds, also where only `info` or the calculator has them, and with the forces that are known."""
    given = atoms.calc.topology if isinstance(atoms.calc, ForceField) else None
    if isinstance(atoms, Atoms):
        copied = atoms.copy()
        if given is not None and copied.topology.is_empty and atoms.calc.like is None:
            copied.topology = given.copy()
    else:
        copied = Atoms(atoms, topology=given)
        for name, array in atoms.arrays.items():
            if name not in copied.arrays:
                copied.set_array(name, array)
    forces = known_forces(atoms)
    copied.calc = None if forces is None else SinglePointCalculator(copied, forces=forces)
    return copied
