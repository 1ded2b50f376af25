"""``shell command args...``"""
from __future__ import annotations

import glob
import os
import shutil
import subprocess

from asemd.errors import InputError
from asemd.words import take


def run(session, args):
    session.refuse_if_safe("shell")
    words = [session.substitute(w) for w in take(args, 1, "shell") and args]
    if session.passive:
        return
    name, rest = words[0], words[1:]
    try:
        if name in BUILT_IN:
            BUILT_IN[name](*rest)
            return
    except TypeError:
        raise InputError(f"shell {name}: wrong number of arguments, got {len(rest)}") from None
    except OSError as e:
        raise InputError(f"shell {name} failed: {e}") from None
    session.log.flush()
    status = subprocess.run(" ".join(words), shell=True, check=False).returncode
    if status:
        session.warn(f"shell command {name} ended with status {status}")


def cd(path: str) -> None:
    os.chdir(path)


def mkdir(*paths: str) -> None:
    for path in paths:
        os.makedirs(path, exist_ok=True)


def mv(old: str, new: str) -> None:
    shutil.move(old, new)


def rm(*patterns: str) -> None:
    for pattern in patterns:
        if pattern != "-f":
            for path in glob.glob(pattern):
                os.remove(path)


def rmdir(*paths: str) -> None:
    for path in paths:
        os.rmdir(path)


def putenv(*pairs: str) -> None:
    for pair in pairs:
        name, _, value = pair.partition("=")
        os.environ[name] = value


BUILT_IN = {"cd": cd, "mkdir": mkdir, "mv": mv, "rm": rm, "rmdir": rmdir, "putenv": putenv}
