"""Where a log comes from: asemd's version, a hash of the input files, the seeds of random numbers."""
from __future__ import annotations

import hashlib
import os
from collections.abc import Sequence

from asemd import __version__

# command -> (word before the seed or None, how many words after it the seed stands)
SEEDS = {"create_atoms": [("random", 2), ("subset", 2)], "delete_atoms": [("porosity", 3)], "displace_atoms": [("random", 4)],
         "set": [("type/fraction", 3), ("dipole/random", 1)], "velocity": [("create", 2)]}
# commands whose words may be files
FILES = ("read_data", "read_restart", "molecule", "pair_coeff", "bond_coeff", "angle_coeff", "dihedral_coeff", "improper_coeff")


class Origin:
    """What went into a log.

    Attributes
    ----------
    inputs : dict of str to str
        File -> SHA-256 of its content when it was read.
    seeds : dict of str to str
        Seed -> the command that it was given to.
    """

    def __init__(self):
        self.inputs: dict[str, str] = {}
        self.seeds: dict[str, str] = {}
        self._told = ""

    def read(self, path: str | os.PathLike) -> None:
        """Note an input file; one that cannot be read is left out."""
        path = os.fspath(path)
        try:
            with open(path, "rb") as f:
                self.inputs[path] = hashlib.file_digest(f, "sha256").hexdigest() if hasattr(hashlib, "file_digest") else _digest(f)
        except OSError:
            return

    def note(self, command: str, words: Sequence[str], fix=None) -> None:
        """Note the seeds and files of a command that was carried out; `fix` is the fix it defined."""
        if command in FILES:
            for path in words:
                if os.path.isfile(path):
                    self.read(path)
        if getattr(fix, "seed", None):
            self.seeds[str(fix.seed)] = f"fix {fix.style}"
        for before, at in SEEDS.get(command, ()):
            for k, word in enumerate(words):
                if word == before and k + at < len(words) and words[k + at].isdigit():
                    self.seeds[words[k + at]] = command

    @property
    def hash(self) -> str:
        """One hash of all inputs, in the order they were read."""
        return hashlib.sha256("".join(self.inputs.values()).encode()).hexdigest()

    def line(self) -> str:
        """A line for the log that readers of LAMMPS's logs pass over; empty if nothing is new."""
        seeds = ", ".join(f"{seed} ({command})" for seed, command in self.seeds.items())
        files = " ".join(os.path.basename(path) for path in self.inputs)
        text = f"# asemd {__version__}; inputs {f'{files} sha256 {self.hash}' if files else 'none'}; seeds {seeds or 'none'}\n"
        told, self._told = self._told, text
        return text if text != told else ""


def _digest(f) -> str:
    digest = hashlib.sha256()
    while block := f.read(1 << 20):
        digest.update(block)
    return digest.hexdigest()
