"""Files that commands read, copied beside a script that is written into another folder, and folders of those that they write."""
from __future__ import annotations

import filecmp
import os
import shutil
from collections.abc import Iterable
from pathlib import Path

from asemd.lammps import lex
from asemd.lammps.export import quoted

# commands that read files -> the first word that may name one
READERS = {"pair_style": 1, "pair_coeff": 2, "bond_coeff": 1, "angle_coeff": 1, "dihedral_coeff": 1, "improper_coeff": 1, "fix": 3,
           "molecule": 1, "variable": 2}
WRITERS = ("ave/", "print", "vector")       # fixes whose files are written
NAMING = {"threebody/table", "sw/angle/table"}      # pair styles whose files name tables


def carried(lines: Iterable[str], folder: Path, taken: Iterable[str] = ()) -> list[str]:
    """The commands with the files they read copied into a folder, which they name as they are called there.

    Files in folders of potentials are found from everywhere and stay there. Folders for dumps and files of fixes are made.

    Parameters
    ----------
    lines : iterable of str
        Commands, one each.
    folder : Path
    taken : iterable of str
        Names in the folder that are for other files.
    """
    places: dict[Path, str] = {}
    out, names_more = [], False
    for line in lines:
        words = lex.split(line)
        for written in _written(words):
            place = Path(written).parent
            if not place.is_absolute() and ".." not in place.parts:
                (folder / place).mkdir(parents=True, exist_ok=True)
        first = READERS.get(words[0]) if words else None
        if words[:1] == ["pair_style"]:
            names_more = not NAMING.isdisjoint(words)
        if first is None or (words[0] == "fix" and words[3].startswith(WRITERS)) or (words[0] == "variable" and "file" not in words[2]):
            out.append(line)
            continue
        new = list(words)
        for k, word in enumerate(words[first + 1:], first + 1):
            if (path := _file(word)) and (os.path.isabs(word) or (folder / word).absolute() != path):
                if path not in places:
                    places[path] = _copied(path, folder, [*taken, *places.values()])
                    if names_more:
                        _copy_named(path, folder)
                new[k] = places[path]
        out.append(line if new == words else " ".join([words[0], *map(quoted, new[1:])]))
    return out


def _written(words: list[str]) -> list[str]:
    """The files that a command writes."""
    if words[:1] == ["dump"]:
        return words[5:6]
    fix = words[:1] == ["fix"] and words[3].startswith(WRITERS)
    return [b for a, b in zip(words, words[1:]) if a in ("file", "append")] if fix else []


def _file(word: str) -> Path | None:
    """The file of that name, if there is one."""
    try:
        float(word)
    except ValueError:
        path = Path(word).expanduser()
        return path.absolute() if len(word) < 1000 and "\0" not in word and path.is_file() else None
    return None


def _copied(path: Path, folder: Path, taken: list[str]) -> str:
    """The name of the copy: that of the file, with a number before it where this is the name of another file."""
    name, k = path.name, 0
    while name in taken or ((folder / name).exists() and not filecmp.cmp(path, folder / name, shallow=False)):
        k += 1
        name = f"{k}_{path.name}"
    if not (folder / name).exists():
        shutil.copyfile(path, folder / name)
    return name


def _copy_named(path: Path, folder: Path) -> None:
    """Copy the files that a file names by relative paths, under the same names."""
    for word in set(path.read_text(encoding="utf-8", errors="replace").split()):
        target = folder / word
        if _file(word) and not os.path.isabs(word) and ".." not in Path(word).parts and not target.exists():
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(word, target)
