"""A scene as LAMMPS commands and a data file, in LAMMPS's frame."""
from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from asemd import atom_style as atom_styles
from asemd import units as unit_styles
from asemd.engine import Settings
from asemd.errors import InputError
from asemd.forcefield import CATEGORIES, Interactions
from asemd.lammps.data_write import write_data
from asemd.system import System
from asemd.topology import Topology

FLAT = 0.01     # of the reach of the list; LAMMPS stops at half of that


def commands(system: System, interactions: Interactions, settings: Settings | None = None,
             data: str | os.PathLike = "data.lammps") -> list[str]:
    """Commands that make LAMMPS see the same atoms under the same forces; writes the data file they read.

    A data file has no bonded items that are turned off: they are written as if they were on, and commands turn them off.

    Parameters
    ----------
    system : System
        A box in another frame than LAMMPS's is rotated (see `asemd.box.Box.to_lammps`), a left-handed one reflected. Units ``ase`` become
        ``metal``; the tiny difference of their Coulomb constants is made up by ``dielectric``.
    interactions : Interactions
    settings : Settings, optional
        Skin and exclusions of the neighbour list.
    data : path
        The data file to write.

    Returns
    -------
    list of str
        One command each, in order, without fixes and runs.

    Raises
    ------
    InputError
        What a data file cannot hold; broken bonds, lists of 1-2, 1-3 and 1-4 pairs of former bonds; bonded items that are turned off
        where others of their type among the same atoms are not.
    """
    top = system.topology
    if _outdated(top) or any((types == 0).any() for _, _, types in top):
        raise InputError("bonds that broke, and bonds or other items whose 1-2, 1-3 and 1-4 lists are older than they are, have no form in "
                         "a data file: use delete_bonds with remove and special, create_bonds with special yes")
    off = turned_off(system)
    settings = settings or Settings()
    native = system.units == "ase"
    name = "metal" if native else system.units
    factor = unit_styles.get(name).qqr2e / unit_styles.get(system.units).qqr2e
    boundary = list(system.box.boundary)
    out = [f"units {name}", f"dimension {system.dimension}", f"boundary {' '.join(boundary)}", f"atom_style {system.atom_style}"]
    out += [f"{category}_style {' '.join(interactions.style_line(category))}" for category in CATEGORIES if interactions.uses[category]]
    written = system.copy()
    # forces do not need masses, LAMMPS does, but for particles with a size, which have their own
    sized = atom_styles.has(system.atom_style, "density")
    written.mass[1:] = np.nan if sized else np.where(np.isnan(system.mass[1:]), 1.0, system.mass[1:])
    write_data(data, written, types="numeric", labels=False, margins=True)
    out.append(f"read_data {quoted(os.fspath(data))}")
    for category in CATEGORIES:
        out += [f"{category}_coeff {' '.join(map(quoted, line))}" for line in interactions.coeff_lines(category)]
    if not sized and any(use.style.many for use in interactions.uses["pair"]):      # whose files have masses, too
        out += [f"mass {t} {m!r}" for t, m in enumerate(written.mass[1:].tolist(), 1)]
    out += [f"pair_modify {' '.join(line)}" for line in interactions.modify_lines()]
    if interactions.uses["pair"]:
        out.append(f"special_bonds {' '.join(interactions.special_line())}")
    else:
        out.append(f"comm_modify cutoff {reach_of_items(system) + settings.skin!r}")
    out += interactions.kspace_lines()
    out.append(f"dielectric {interactions.dielectric * factor!r}")
    reach = settings.skin + (interactions.cutoff(system.counts["ntypes"], None) if interactions.uses["pair"] else 0.0)
    out += [f"neighbor {settings.skin!r} {'nsq' if _flat(system, reach) else 'bin'}", "neigh_modify every 1 delay 0 check yes"]
    return [*out, *exclusions(system, settings), *off]


def _flat(system: System, reach: float) -> bool:
    """Whether LAMMPS refuses to sort atoms into bins: a direction in which its box, shrunk to the atoms, is too short for them."""
    box = system.box
    inside = (system.x - box.origin) @ box.inverse
    shrinks = [bool(set(b) & set("sm")) for b in box.boundary]
    extents = np.where(shrinks, np.ptp(inside, axis=0) if system.n else 0.0, 1.0) * box.lengths
    return bool((extents < FLAT * reach).any())


def _outdated(topology: Topology) -> bool:
    """Whether the lists of 1-2, 1-3 and 1-4 pairs are those of other items than there are now."""
    then = topology.frozen
    return then is not None and not (isinstance(then, Topology) and all(np.array_equal(then.items(kind)[0], items)
                                                                        for kind, items, _ in topology.every()))


def turned_off(system: System, undo: bool = False) -> list[str]:
    """``delete_bonds`` for the bonded items that are turned off, or, to `undo` it, for all of their types.

    Raises
    ------
    InputError
        Others of the same type among the same atoms are on.
    """
    out = []
    for kind, items, types in system.topology:
        for t in np.unique(-types[types < 0]).tolist():
            group, words = "all", [kind, str(t), *(["undo"] if undo else [])]
            if (types == t).any():
                group, mask = "turned_off", np.isin(np.arange(system.n), items[types == -t])
                if mask[items[types == t]].all(axis=1).any():
                    raise InputError(f"{kind} type {t}: items are turned off where others of this type among the same atoms are on, which "
                                     "has no form in a script: use delete_bonds with remove and special")
                out.append(f"group {group} id {id_ranges(system.id[mask])}")
            out += [" ".join(["delete_bonds", group, *words]), *([f"group {group} delete"] if group != "all" else [])]
    return out


def script(system: System, interactions: Interactions, folder: str | os.PathLike, settings: Settings | None = None,
           name: str = "scene") -> Path:
    """Write ``in.NAME`` and ``data.NAME`` into a folder; the script reads the data file from the working directory.

    Returns
    -------
    Path
        The script.
    """
    folder = Path(folder)
    lines = commands(system, interactions, settings, folder / f"data.{name}")
    lines = [f"read_data data.{name}" if line.startswith("read_data ") else line for line in lines]
    path = folder / f"in.{name}"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def quoted(word: str) -> str:
    """A word as LAMMPS's input needs it: in quotes if it holds blanks or characters that mean something."""
    if word and not any(c.isspace() or c in "#$&\"'" for c in word):
        return word
    for quote in ('"', "'", '"""'):
        if quote not in word and not word.endswith(quote[0]):
            return f"{quote}{word}{quote}"
    return f"'{word}'"


def reach_of_items(system: System) -> float:
    """How far apart atoms of one bonded item are at most, which LAMMPS must know where no pair style says it."""
    longest = 1.0
    for _, items, _ in system.topology:
        for a, b in zip(range(items.shape[1] - 1), range(1, items.shape[1])):
            d, _ = system.box.minimum_image(system.x[items[:, a]] - system.x[items[:, b]])
            longest = max(longest, float(np.sqrt((d * d).sum(axis=1)).max(initial=0.0)))
    return 3.0 * longest


def exclusions(system: System, settings: Settings) -> list[str]:
    """``neigh_modify exclude`` and the groups it needs."""
    out = []
    for kind, *values in settings.exclude:
        if kind == "type":
            out.append(f"neigh_modify exclude type {values[0]} {values[1]}")
            continue
        names = []
        for mask in values:
            names.append(f"excluded{len(out)}")
            out.append(f"group {names[-1]} id {id_ranges(system.id[mask])}" if mask.any() else f"group {names[-1]} empty")
        out.append(f"neigh_modify exclude {kind} {' '.join(names)}")
    return out


def id_ranges(ids: np.ndarray) -> str:
    """``1:5 8``: ids as the command group takes them."""
    ids = np.sort(ids)
    breaks = np.flatnonzero(np.diff(ids) != 1)
    firsts, lasts = ids[np.r_[0, breaks + 1]], ids[np.r_[breaks, len(ids) - 1]]
    return " ".join(str(a) if a == b else f"{a}:{b}" for a, b in zip(firsts.tolist(), lasts.tolist()))
