"""Scenes to measure on: read from a script, or made from atoms, and copied, so that nothing of the user's is touched."""
from __future__ import annotations

import copy
import os
from dataclasses import replace
from typing import TYPE_CHECKING

from asemd.errors import InputError
from asemd.scene import GroupTable, Scene, default_computes

if TYPE_CHECKING:
    from asemd.lammps.switches import Switches


def load(source, switches: Switches | None = None) -> Scene:
    """A scene of one's own, to be changed at will.

    Parameters
    ----------
    source : path, asemd.scene.Scene or ase.Atoms
        A script is executed up to its first run, without log, dumps and shell; atoms need `asemd.ForceField` as calculator.
    switches : asemd.lammps.switches.Switches, optional
        LAMMPS's command line switches, for a script.

    Raises
    ------
    InputError
        A mistake in the script, missing coefficients, atoms without a force field.
    """
    if isinstance(source, (str, os.PathLike)):
        from asemd.lammps.session import Session, Stop
        session = Session(switches=switches, passive=True)
        try:
            session.file(os.fspath(source))
        except Stop:
            session.label = None
        source = session.scene
    elif not isinstance(source, Scene):
        source = of_atoms(source)
    source.need_system("report")
    source.interactions.check_complete(source.system)
    return copied(source)


def copied(scene: Scene) -> Scene:
    """An independent copy of a scene, without its dumps and restart files."""
    groups = GroupTable()
    groups._slots, groups._masks = list(scene.groups._slots), {name: mask.copy() for name, mask in scene.groups._masks.items()}
    return replace(scene, system=scene.need_system("report").copy(), interactions=copy.deepcopy(scene.interactions), groups=groups,
                   fixes=copy.deepcopy(scene.fixes), computes=copy.copy(scene.computes), dumps={}, restarts={}, restored=None,
                   neighbor=replace(scene.neighbor), thermo=copy.copy(scene.thermo))


def of_atoms(atoms) -> Scene:
    """The scene of ``ase.Atoms`` whose calculator is `asemd.ForceField`, velocities included; it has no fixes of its own."""
    from asemd import units as unit_styles
    from asemd.calculator import ForceField
    calc = getattr(atoms, "calc", None)
    if not isinstance(calc, ForceField):
        raise InputError("needs the path of a LAMMPS script, a Scene, or atoms whose calculator is asemd.ForceField")
    if calc.loads:
        raise InputError("atoms with added forces: give the script they come from instead")
    system = calc._system(atoms)
    system.v = atoms.get_velocities() / unit_styles.factor("velocity", calc.units)
    scene = Scene(system=system, units=calc.units, dimension=system.dimension, boundary=tuple(system.box.boundary),
                  atom_style=system.atom_style, interactions=calc.interactions, computes=default_computes(), groups=GroupTable(system.n),
                  dt=unit_styles.get(calc.units).dt, neighbor=replace(calc.settings), precision=calc.settings.precision,
                  threads=calc.settings.threads)
    for name in calc.bits:
        if name != "all":
            scene.groups[name] = calc.mask(atoms, name)
    return scene
