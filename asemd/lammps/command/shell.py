"""``shell command args...``"""
from __future__ import annotations

import glob
import os
import shutil
import subprocess
from collections.abc import Callable

from asemd.errors import InputError
from asemd.words import take

MANY = 10**6


def run(session, args):
    session.refuse_if_safe("shell")
    words = take(args, 1, "shell") and list(args)
    if session.passive:
        return
    name, rest = words[0], words[1:]
    if name in BUILT_IN:
        least, most = COUNTS[name]
        if not least <= len(rest) <= most:
            raise InputError(f"shell {name}: wrong number of arguments, got {len(rest)}")
        for failed in BUILT_IN[name](*rest):
            session.warn(f"shell command {name} failed: {failed}")
        return
    session.log.flush()
    status = subprocess.run(" ".join(words), shell=True, check=False).returncode
    if status:
        session.warn(f"shell command {name} ended with status {status}")


def attempts(work: Callable[..., object], *arguments: tuple) -> list[str]:
    """Do the same with each tuple of arguments; returns what went wrong."""
    failed = []
    for values in arguments:
        try:
            work(*values)
        except (OSError, shutil.Error, ValueError) as e:
            failed.append(str(e))
    return failed


def cd(path: str) -> list[str]:
    """LAMMPS would only warn, and go on in the wrong folder."""
    for failed in attempts(os.chdir, (path,)):
        raise InputError(f"shell cd failed: {failed}")
    return []


def mkdir(*paths: str) -> list[str]:
    return attempts(lambda p: os.makedirs(p, exist_ok=True), *((p,) for p in paths))


def mv(old: str, new: str) -> list[str]:
    return attempts(shutil.move, (old, new))


def rm(*words: str) -> list[str]:
    """Remove files; with -f it does not matter if there is none."""
    patterns = [w for w in words if w != "-f"]
    failed = attempts(os.remove, *((p,) for pattern in patterns for p in (glob.glob(pattern) or [pattern])))
    return [] if "-f" in words else failed


def rmdir(*paths: str) -> list[str]:
    return attempts(os.rmdir, *((p,) for p in paths))


def putenv(*pairs: str) -> list[str]:
    return attempts(os.environ.__setitem__, *((name, value) for name, _, value in (p.partition("=") for p in pairs)))


BUILT_IN = {"cd": cd, "mkdir": mkdir, "mv": mv, "rm": rm, "rmdir": rmdir, "putenv": putenv}
COUNTS = {"cd": (1, 1), "mkdir": (1, MANY), "mv": (2, 2), "rm": (1, MANY), "rmdir": (1, MANY), "putenv": (1, MANY)}
