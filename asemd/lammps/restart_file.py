"""Restart files: a zip archive of ``restart.json`` and numpy arrays (``.npy``), as `numpy.load` and any zip program read it.

Every member carries the archive's CRC-32, which is verified while it is read; nothing in the file is executed when it is read. A file is
written beside the old one under the name ``FILE.part``, brought to the disk, and then takes the old one's name in one step: whatever
happens while it is written, the old file is whole.
"""
from __future__ import annotations

import contextlib
import json
import os
import zipfile
from typing import Any

import numpy as np

from asemd.box import Box
from asemd.errors import InputError

FORMAT, VERSION = "asemd restart", 1
LAMMPS_MAGIC = b"LammpS RestartT"
DOCUMENT = "restart.json"
TAGS = ("array", "tuple", "set", "pairs", "box")


def pack(value: Any, arrays: dict[str, np.ndarray], name: str = "") -> Any:
    """The value in a form that JSON can hold; its numpy arrays go to `arrays` under names that say where they stand."""
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray) and value.dtype != object:
        arrays[name] = value
        return {"array": name}
    if isinstance(value, (list, tuple, set)):
        items = [pack(v, arrays, f"{name}.{k}") for k, v in enumerate(sorted(value) if isinstance(value, set) else value)]
        return items if isinstance(value, list) else {"tuple" if isinstance(value, tuple) else "set": items}
    if isinstance(value, dict):
        if all(isinstance(k, str) for k in value) and not (len(value) == 1 and set(value) & set(TAGS)):
            return {k: pack(v, arrays, f"{name}.{k}" if name else k) for k, v in value.items()}
        return {"pairs": [[pack(k, arrays), pack(v, arrays, f"{name}.{n}")] for n, (k, v) in enumerate(value.items())]}
    if isinstance(value, Box):
        fields = {k: getattr(value, k) for k in ("origin", "cell", "boundary", "triclinic", "initial")}
        return {"box": pack(fields, arrays, name)}
    raise InputError(f"write_restart: {name} is a {type(value).__name__}, which a restart file cannot hold")


def unpack(value: Any, arrays: dict[str, np.ndarray]) -> Any:
    """The value that `pack` was given."""
    if isinstance(value, list):
        return [unpack(v, arrays) for v in value]
    if not isinstance(value, dict):
        return value
    tag, inner = next(iter(value.items())) if len(value) == 1 else ("", None)
    if tag == "array":
        return arrays[inner]
    if tag in ("tuple", "set"):
        return {"tuple": tuple, "set": set}[tag](unpack(v, arrays) for v in inner)
    if tag == "pairs":
        return {unpack(k, arrays): unpack(v, arrays) for k, v in inner}
    if tag == "box":
        return Box(**unpack(inner, arrays))
    return {k: unpack(v, arrays) for k, v in value.items()}


def save(path: str, document: dict[str, Any]) -> None:
    """Write a restart file in one step; what is no file, as /dev/null, is written to as it is.

    Raises
    ------
    InputError
        The folder cannot be written, the disk is full: says what to do; a file of that name is as it was.
    """
    arrays: dict[str, np.ndarray] = {}
    packed = {"format": FORMAT, "version": VERSION, "arrays": [], **pack(document, arrays)}
    packed["arrays"] = list(arrays)
    real = os.path.realpath(path)       # a link stays one
    device = os.path.exists(real) and not os.path.isfile(real)      # /dev/null must not become a file
    part = real if device else f"{real}.part"
    try:
        try:
            with open(part, "wb") as f:
                with zipfile.ZipFile(f, "w") as z:
                    z.writestr(zipfile.ZipInfo(DOCUMENT), json.dumps(packed, indent=1))
                    for name, array in arrays.items():
                        with z.open(zipfile.ZipInfo(f"{name}.npy"), "w", force_zip64=True) as member:
                            np.lib.format.write_array(member, np.ascontiguousarray(array), allow_pickle=False)
                f.flush()
                if not device:
                    os.fsync(f.fileno())
            if not device:
                os.replace(part, real)
        except BaseException:
            if not device:
                with contextlib.suppress(OSError):
                    os.remove(part)
            raise
        sync_folder(real)
    except OSError as e:
        raise InputError(f"cannot write restart file {path}: {e.strerror or e}; restart files written before are whole: make room there or "
                         "choose another place, and go on from the last one") from None


def sync_folder(path: str) -> None:
    """Bring the new name to the disk too, where the system can do that."""
    with contextlib.suppress(OSError):
        folder = os.open(os.path.dirname(path) or ".", os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)


def is_of_lammps(path: str) -> bool:
    """Whether LAMMPS itself wrote the file."""
    try:
        with open(path, "rb") as f:
            return f.read(len(LAMMPS_MAGIC)) == LAMMPS_MAGIC
    except OSError:
        return False        # `load` says why


def load(path: str) -> dict[str, Any]:
    """Read a restart file, all of it.

    Raises
    ------
    InputError
        It does not exist, is truncated or damaged, comes from a newer version, or is no restart file at all.
    """
    try:
        with open(path, "rb") as f:
            start = f.read(2)
            if not start or start != b"PK":
                raise InputError(f"read_restart: {path} is {'no restart file' if start else 'empty'}: write_restart of asemd makes them")
            return _members(f, path)
    except (zipfile.BadZipFile, EOFError, KeyError, ValueError) as e:
        raise InputError(f"read_restart: {path} is truncated or damaged: use an earlier restart file ({e})") from None
    except OSError as e:
        raise InputError(f"read_restart: cannot open {path}: {e.strerror or e}") from None


def _members(f, path: str) -> dict[str, Any]:
    with zipfile.ZipFile(f) as z:
        if DOCUMENT not in z.namelist():
            raise InputError(f"read_restart: {path} is a zip archive but no restart file")
        document = json.loads(z.read(DOCUMENT))
        if not isinstance(document, dict) or document.get("format") != FORMAT:
            raise InputError(f"read_restart: {path} is no restart file of asemd")
        if document["version"] > VERSION:
            raise InputError(f"read_restart: {path} was written by asemd {document['asemd']}, whose files have version "
                             f"{document['version']}: this one reads up to {VERSION}, install a newer asemd")
        arrays = {}
        for name in document["arrays"]:
            with z.open(f"{name}.npy") as member:
                arrays[name] = np.lib.format.read_array(member, allow_pickle=False)
    return unpack(document, arrays)
