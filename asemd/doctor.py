"""Facts about this installation that decide whether asemd runs, and how fast."""
from __future__ import annotations

import importlib.metadata
import os
import platform
import sys
from dataclasses import dataclass

from asemd import __version__
from asemd.text_table import Table

REQUIRED = ("numpy", "numba", "llvmlite", "scipy", "ase", "rich", "typer")
OPTIONAL = ("lammps", "mpich", "matplotlib", "MDAnalysis", "spglib")
# LLVM's name of an instruction set -> bits of its vectors, widest first
VECTORS = {"avx512f": 512, "avx2": 256, "avx": 256, "sve": 128, "neon": 128, "sse2": 128}


@dataclass(frozen=True)
class Fact:
    """One line of the report; `ok` False with `advice` is a problem unless the thing is `optional`."""

    name: str
    value: str
    ok: bool = True
    advice: str = ""
    optional: bool = False


def examine() -> list[Fact]:
    """Look at versions, processor, kernel cache and LAMMPS."""
    facts = [Fact("asemd", __version__), _python()]
    facts += [_package(name, False) for name in REQUIRED] + [_package(name, True) for name in OPTIONAL]
    return [*facts, *_processor(), _compiler(), _cache(), _lammps()]


def parts(facts: list[Fact]) -> list[Table | str]:
    """A table, and a last line."""
    table = Table("", ("", "", ""), [(f.name, f.value, f.advice) for f in facts])
    wrong = [f.name for f in facts if not f.ok and not f.optional]
    return [table, f"To be mended: {', '.join(wrong)}" if wrong else "All fine."]


def _python() -> Fact:
    new = sys.version_info >= (3, 10)
    return Fact("Python", f"{platform.python_version()} ({platform.python_implementation()}, {sys.executable})", new,
                "" if new else "asemd needs Python 3.10 or later")


def _package(name: str, optional: bool) -> Fact:
    try:
        return Fact(name, importlib.metadata.version(name), True, "", optional)
    except importlib.metadata.PackageNotFoundError:
        return Fact(name, "not installed", False, f"pip install {name}" + (" (optional)" if optional else ""), optional)


def _processor() -> list[Fact]:
    from llvmlite import binding
    features = binding.get_host_cpu_features()
    width = next((bits for name, bits in VECTORS.items() if features.get(name)), 0)
    try:
        cores = len(os.sched_getaffinity(0))
    except AttributeError:
        cores = os.cpu_count() or 1
    lanes = f"{width} bits: {width // 64} numbers in double precision at once, {width // 32} in single"
    return [Fact("processor", f"{binding.get_host_cpu_name()}, {platform.machine()}, {platform.system()}"),
            Fact("cores", f"{cores} usable (--threads)"),
            Fact("vectors", lanes if width else "none")]


def _compiler() -> Fact:
    off = os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")
    return Fact("compiler", "switched off by NUMBA_DISABLE_JIT" if off else "numba", not off,
                "unset NUMBA_DISABLE_JIT: without the compiler runs are about 1000 times slower" if off else "")


def _cache() -> Fact:
    from asemd.cache import MB, contents
    from asemd.kernels.generate import cache_dir
    found = contents()
    wanted = "ASEMD_CACHE_DIR" if os.environ.get("ASEMD_CACHE_DIR") else "the cache folder of the user"
    return Fact("kernel cache", f"{cache_dir()}: {found.modules} kernel modules, {found.size / MB:.1f} MB", found.kept, "" if found.kept
                else f"{wanted} is not writable: kernels are compiled in every process; set ASEMD_CACHE_DIR to a folder that is")


def _lammps() -> Fact:
    from asemd.testing.oracle import lammps_version, why_not
    version = lammps_version()
    return Fact("LAMMPS", f"starts, version {version}" if version else "does not start", bool(version),
                "" if version else f"needed by asemd validate only: {why_not()}", True)
