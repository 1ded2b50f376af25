"""Styles in a Python file of the user: ``asemd run --import my_styles.py in.file``."""
from __future__ import annotations

import importlib
import importlib.util
import sys
import traceback
from pathlib import Path

from asemd import registry
from asemd.errors import InputError, Where

files: list[str] = []      # those imported so far, by their absolute paths


def import_file(path: str) -> None:
    """Execute a Python file, so that the styles it defines can be used by name.

    Parameters
    ----------
    path : str
        The file. Its folder can be imported from while it is executed, as that of a program can.

    Raises
    ------
    InputError
        The file cannot be read, it fails, or it defines a style that asemd has already.
    """
    file = Path(path)
    if not file.is_file():
        raise InputError(f"--import: cannot open {path}: no such file")
    title = f"imported_{file.stem}"           # a file may have the name of another module
    spec = importlib.util.spec_from_file_location(title, file)
    if spec is None or spec.loader is None:
        raise InputError(f"--import {path}: the name of a Python file must end with .py")
    module = importlib.util.module_from_spec(spec)
    known = dict(registry.known)
    sys.modules[title] = module           # classes of the file find their module there
    sys.path.insert(0, str(file.resolve().parent))
    try:
        spec.loader.exec_module(module)
    except Exception as e:
        del sys.modules[title]
        lines = [frame.lineno for frame in traceback.extract_tb(e.__traceback__) if Path(frame.filename).resolve() == file.resolve()]
        line = getattr(e, "lineno", None) or (lines[-1] if lines else 1)
        text = file.read_text(errors="replace").splitlines()
        raise InputError(f"--import: {type(e).__name__}: {' '.join(str(getattr(e, 'msg', e)).split())}",
                         Where(path, line, text[line - 1].strip() if line <= len(text) else "")) from None
    finally:
        sys.path.remove(str(file.resolve().parent))
    for key, own in list(registry.known.items()):
        if getattr(own.function, "__module__", "") != title or importlib.util.find_spec(registry.module_of(*key)) is None:
            continue
        importlib.import_module(registry.module_of(*key))      # does nothing if that was done before
        taken = registry.known[key] if registry.known[key] is not own else known.get(key)
        registry.known[key] = taken or own
        if taken and getattr(taken.function, "__module__", "") != title:
            raise InputError(f"--import {path}: asemd has a {key[0]} style {key[1]} already: give yours another name")
    if str(file.resolve()) not in files:
        files.append(str(file.resolve()))
