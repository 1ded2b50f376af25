"""``read_dump file Nstep field1 field2 ... keyword values ...``"""
from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from asemd.atom_style import fresh
from asemd.box import Box
from asemd.errors import InputError, nearest
from asemd.lammps.command.create_box import describe
from asemd.lammps.dump_read import FORMATS, Frame, frames
from asemd.system import System
from asemd.words import choice, take, whole, yes_no

POSITIONS = ("x", "y", "z")
FIELDS = (*POSITIONS, "vx", "vy", "vz", "q", "ix", "iy", "iz", "fx", "fy", "fz")
KEYWORDS = ("box", "timestep", "replace", "purge", "trim", "add", "label", "scaled", "wrapped", "format")


@dataclass
class Request:
    """What to take from snapshots, and what to do with it."""

    fields: list[str] = field(default_factory=list)
    labels: dict[str, str] = field(default_factory=dict)
    box: bool = True
    timestep: bool = True
    replace: bool = True
    purge: bool = False
    trim: bool = False
    add: str = "no"         # no, yes or keep
    scaled: bool = False
    wrapped: bool = True
    format: str = "native"


def run(session, args):
    scene = session.scene
    scene.need_system("read_dump")
    path, step = take(args, 2, "read_dump")[:2]
    request = read_request(session, list(args[2:]), "read_dump")
    wanted = whole(step, "read_dump: the step")
    session.print("Scanning dump file ...")
    frame = next((f for f in frames(path, request.format) if f.step >= wanted), None)
    if frame is None or frame.step != wanted:
        raise InputError(f"read_dump: {path} does not contain a snapshot of step {wanted}")
    if request.timestep and scene.dumps:
        raise InputError("read_dump cannot set the step while there are dumps: use undump before, or timestep no")
    session.print("Reading snapshot from dump file ...")
    before = scene.system.n
    counts = take_snapshot(session, frame, request)
    session.print("\n".join([f"  {describe(scene.system.box)}", f"  {before} atoms before read", f"  {len(frame.rows)} atoms in snapshot",
                             *(f"  {n} atoms {what}" for what, n in counts.items()), f"  {scene.system.n} atoms after read"]))


def read_request(session, words: list[str], command: str) -> Request:
    """Fields and keywords as words of `command`.

    Raises
    ------
    InputError
        Unknown words, impossible combinations.
    """
    system, out = session.scene.system, Request()
    while words and words[0] in ("id", "type", *FIELDS):
        out.fields.append(words.pop(0))
    if len(set(out.fields)) < len(out.fields):
        raise InputError(f"{command}: a field is given twice")
    while words:
        key, what = words[0], f"{command} {words[0]}"
        if key not in KEYWORDS:
            raise InputError(f"{command}: unknown field or keyword {key!r}{nearest(key, (*FIELDS, *KEYWORDS))}")
        value = take(words[1:], 1, what)[0]
        used = 2
        if key == "label":
            used, (name, column) = 3, take(words[1:], 2, what)
            if name not in ("id", "type", *out.fields):
                raise InputError(f"{what}: {name} is not among the fields")
            out.labels[name] = column
        elif key == "add":
            out.add = value if value == "keep" else "yes" if yes_no(value, what) else "no"
        elif key == "format":
            if value in ("molfile", "adios"):
                raise InputError(f"{what} {value} is not supported: convert the file to a text dump or xyz")
            out.format = choice(value, FORMATS, what)
            if len(words) > 2:
                raise InputError(f"{what} must be the last keyword, got {words[2]!r} behind it")
        else:
            setattr(out, key, yes_no(value, what))
        words = words[used:]
    if not out.fields:
        raise InputError(f"{command} needs fields, for example: x y z")
    _check(out, system, command)
    if out.add != "no" and "type" not in out.fields:
        session.print("Adding 'type' field to requested per-atom fields")
    return out


def _check(request: Request, system, command: str) -> None:
    if request.purge and (request.replace or request.trim):
        raise InputError(f"{command}: with purge yes both replace and trim must be no")
    if "q" in request.fields and system.q is None:
        raise InputError(f"{command}: atom_style {system.atom_style} has no charges")
    if system.dimension == 2 and set(request.fields) & {"z", "vz", "iz", "fz"}:
        raise InputError(f"{command}: a 2d simulation has no field z, vz, iz or fz")
    if request.format == "xyz":
        wrong = set(request.fields) - {"id", "type", *POSITIONS}
        if wrong:
            raise InputError(f"{command}: xyz files have no field {min(wrong)}")
        if request.box:
            raise InputError(f"{command}: xyz files have no box, use box no")


def take_snapshot(session, frame: Frame, request: Request) -> dict[str, int]:
    """Change the atoms, the box and the step; how many atoms were purged, replaced, trimmed and added."""
    scene, system = session.scene, session.scene.system
    scene.sync_groups()
    dump_box = _box(frame, system, session) if frame.bounds is not None else system.box
    values, unwrapped = _values(frame, request, dump_box)
    ids = values["id"].astype(np.int64)
    counts = dict.fromkeys(("purged", "replaced", "trimmed", "added"), 0)
    if request.purge:
        counts["purged"] = system.n
        system = _keep(scene, np.zeros(0, int))
    order = np.argsort(system.id, kind="stable")
    at = np.searchsorted(system.id, ids, sorter=order)
    rows = order[np.minimum(at, max(system.n - 1, 0))] if system.n else np.zeros(len(ids), int)
    known = system.id[rows] == ids if system.n else np.zeros(len(ids), bool)
    if request.replace:
        _assign(system, rows[known], {name: v[known] for name, v in values.items()}, unwrapped)
        counts["replaced"] = int(known.sum())
    if request.trim:
        stays = np.zeros(system.n, bool)
        stays[rows[known]] = True
        counts["trimmed"] = int((~stays).sum())
        if counts["trimmed"]:
            system = _keep(scene, np.flatnonzero(stays))
    if request.add != "no":
        counts["added"] = int((~known).sum())
        system = _add(scene, {name: v[~known] for name, v in values.items()}, unwrapped, request.add == "keep")
    if request.box:
        system.box = dump_box
    system.box.wrap(system.x, system.image)
    system.box = system.box.shrink_wrapped(system.x)
    if request.timestep:
        scene.step = frame.step
        scene.time_base = (0.0, frame.step) if frame.step < scene.time_base[1] else scene.time_base
    session.changed()
    session.stale()
    return counts


def _keep(scene, rows: np.ndarray):
    scene.groups.select(rows)
    scene.system = scene.system.select(rows)
    return scene.system


def _box(frame: Frame, system, session) -> Box:
    """The box of a snapshot with the boundaries of the scene."""
    bounds, old = frame.bounds, system.box
    tilted = bounds.shape[1] == 3
    if tilted != old.triclinic:
        theirs, ours = ("triclinic", "orthogonal") if tilted else ("orthogonal", "triclinic")
        raise InputError(f"dump file: the box of step {frame.step} is {theirs}, the simulation box is {ours}: use box no, or change_box "
                         f"{theirs.replace('orthogonal', 'ortho')} before").at(frame.where)
    if frame.boundary and frame.boundary != old.boundary:
        session.warn(f"boundaries of the dump file ({' '.join(frame.boundary)}) differ from those of the simulation")
    lo, hi, tilt = frame.corners()
    return Box.from_lammps(lo, hi, tilt, old.boundary, tilted)


def _values(frame: Frame, request: Request, box: Box) -> tuple[dict[str, np.ndarray], bool]:
    """The fields of a snapshot by name, positions in distance units; and whether positions are unwrapped."""
    need = ["id", *(["type"] if request.add != "no" else []), *(f for f in request.fields if f not in ("id", "type"))]
    out, kinds = {}, {}
    for name in need:
        label = request.labels.get(name)
        names = [label] if label else [name, name + "s", name + "u", name + "su"] if name in POSITIONS else [name]
        found = next((n for n in names if n in frame.columns), None)
        if found is None:
            raise InputError(f"dump file: there is no column {' or '.join(names)}; there are {' '.join(frame.columns)}").at(frame.where)
        out[name] = frame.column(found)
        if name in POSITIONS:
            kinds[name] = (request.scaled, not request.wrapped) if label else ("s" in found, "u" in found)
    if len(set(kinds.values())) > 1:
        raise InputError("dump file: x, y and z must all be scaled or not, and wrapped or not").at(frame.where)
    scaled, unwrapped = next(iter(kinds.values()), (False, False))
    if scaled:
        _unscale(out, kinds, box, frame)
    return out, unwrapped


def _unscale(values: dict[str, np.ndarray], kinds, box: Box, frame: Frame) -> None:
    lo, length, (xy, xz, yz) = box.lo, box.hi - box.lo, box.tilt
    if not box.triclinic:
        for k, name in enumerate(POSITIONS):
            if name in values:
                values[name] = values[name] * length[k] + lo[k]
        return
    if len(kinds) < 3:
        raise InputError("dump file: in a triclinic box scaled positions need all of x, y, z").at(frame.where)
    sx, sy, sz = (values[name] for name in POSITIONS)
    values["x"] = sx * length[0] + sy * xy + sz * xz + lo[0]
    values["y"] = sy * length[1] + sz * yz + lo[1]
    values["z"] = sz * length[2] + lo[2]


def _assign(system, rows: np.ndarray, values: dict[str, np.ndarray], unwrapped: bool) -> None:
    if unwrapped:
        system.image[rows] = 0
    for name, column in values.items():
        k = POSITIONS.index(name[-1]) if name[-1] in POSITIONS else 0
        if name in ("id", "type"):
            continue
        if name == "q":
            system.q[rows] = column
        elif name[0] == "i":
            if not unwrapped:
                system.image[rows, k] = column.astype(np.int32)
        else:
            {"v": system.v, "f": system.f}.get(name[0] if len(name) == 2 else "x", system.x)[rows, k] = column


def _add(scene, values: dict[str, np.ndarray], unwrapped: bool, keep: bool) -> System:
    old, n = scene.system, len(values["id"])
    types = values["type"].astype(np.int64)
    bad = (types < 1) | (types > old.counts["ntypes"])
    if bad.any():
        raise InputError(f"dump file: atom type {types[bad][0]} is outside the valid range 1 to {old.counts['ntypes']}")
    new = System(box=old.box, x=np.zeros((n, 3)), type=types, id=values["id"].astype(np.int64) if keep else None, units=old.units,
                 dimension=old.dimension, counts=dict(old.counts), **fresh(old.atom_style, n))
    _assign(new, np.arange(n), values, unwrapped)
    scene.system = old.append(new, keep_ids=keep)
    scene.sync_groups()
    return scene.system
