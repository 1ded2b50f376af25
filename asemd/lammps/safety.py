"""``asemd run --safe``: a script from a stranger writes nothing outside its folder and starts no program.

Every way to open, move or remove a file in Python raises an audit event; `guard` refuses those that lead outside.
"""
from __future__ import annotations

import os
import sys
import sysconfig
import tempfile

from asemd.cache_folder import cache_folder
from asemd.errors import InputError

WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
CHANGING = {"os.remove": (0,), "os.rename": (0, 1), "os.rmdir": (0,), "os.mkdir": (0,), "os.link": (1,), "os.symlink": (1,),
            "os.truncate": (0,), "os.chmod": (0,), "os.chown": (0,), "shutil.move": (0, 1), "shutil.rmtree": (0,)}
PROGRAMS = ("subprocess.Popen", "os.system", "os.exec", "os.posix_spawn", "os.spawn", "pty.spawn")


def guard(folder: str) -> None:
    """From now on, until the process ends, refuse to change files outside `folder` and to start programs.

    The caches of compiled kernels stay writable.
    """
    allowed = [os.path.realpath(p) for p in (folder, cache_folder(), os.environ.get("NUMBA_CACHE_DIR") or folder, os.devnull)]
    libraries = tuple(os.path.realpath(sysconfig.get_path(name)) + os.sep for name in ("purelib", "platlib", "stdlib"))
    package = os.path.realpath(os.path.dirname(os.path.dirname(__file__))) + os.sep

    def inside(path) -> bool:
        full = os.path.realpath(os.fsdecode(path))
        if any(full == a or full.startswith(a + os.sep) for a in allowed):
            return True
        return "__pycache__" in full and full.startswith((*libraries, package))     # compiled Python

    def hook(event: str, args: tuple) -> None:
        if event == "open":
            path, mode, flags = args
            writes = flags & WRITING if isinstance(flags, int) else bool(mode) and any(c in mode for c in "wax+")
            if writes and not isinstance(path, int) and not inside(path):
                raise InputError(f"--safe refuses to write {os.fsdecode(path)}: it is outside {folder}")
        elif event in CHANGING:
            for k in CHANGING[event]:
                if not isinstance(args[k], int) and not inside(args[k]):
                    raise InputError(f"--safe refuses to change {os.fsdecode(args[k])}: it is outside {folder}")
        elif event in PROGRAMS:
            raise InputError("--safe refuses to start another program")

    tempfile.tempdir = folder       # temporary files as well
    sys.addaudithook(hook)
