"""``asemd run --dry``: execute everything of a script but its runs and what it writes, and gather all problems with their places."""
from __future__ import annotations

import os
import re
from difflib import get_close_matches
from fnmatch import fnmatchcase

from asemd import units
from asemd.errors import AsemdError, InputError, NotYet, Undefined, Where
from asemd.kspace import solve
from asemd.lammps import script
from asemd.lammps.driver import Driver, check
from asemd.lammps.names import COMMANDS
from asemd.lammps.read import refuse_data
from asemd.lammps.script import Command
from asemd.lammps.session import NESTING, Jump, Session, Stop
from asemd.thermo import parse_reference

WRITERS = ("angle_write", "bond_write", "dihedral_write", "group2ndx", "pair_write", "restart", "rerun", "write_coeff", "write_data",
           "write_dump", "write_restart")
WRITING = (*WRITERS, "dump", "fix", "info", "log", "print", "python", "shell")     # commands that may make files which others read
NAMING = ("compute", "dump", "fix", "group", "molecule", "python", "region", "variable")      # commands that define a name
BOX = ("create_box", "read_data", "read_restart", "read_dump")
KINDS = ("pair", "bond", "angle", "dihedral", "improper")
# what an error says -> commands of which one that failed before explains it
CONSEQUENCES = {**{f"(before|must define) {k}_style": (f"{k}_style",) for k in KINDS},
                **{f"All {k} coeffs are not set": (f"{k}_style", f"{k}_coeff", *BOX, "include", "jump") for k in KINDS},
                "before a kspace_style|needs a kspace_style|kspace_style .* needs a pair style|all charges are 0":
                    ("kspace_style", "pair_style", "set", *BOX, "include", "jump"),
                "no mass for atom type": ("mass", "pair_style", *BOX, "include", "jump")}
ROUNDS = 2      # how often a jump is followed from one line


class DrySession(Session):
    """Reads and binds every command, runs nothing, writes nothing.

    Attributes
    ----------
    problems : list of InputError
        Each has its place. Problems that follow from others are left out.
    notes : list of str
        Warnings.
    """

    dry = True

    def __init__(self, switches=None):
        super().__init__(switches=switches, passive=True)
        self.problems: list[InputError] = []
        self.notes: list[str] = []
        self.log.warn = lambda message: self.notes.append(message) if message not in self.notes else None
        self._doubtful: set[tuple[str, str]] = set()      # kind and name whose definitions failed, or could not be evaluated
        self._no_box = self._ran = False
        self._failed: set[str] = set()          # names of commands that failed, or could not be followed
        self._written: list[str] = []           # names of files that the script would have made, with * for any text
        self._jumps: dict[Where, int] = {}

    def rehearse(self, path: str | os.PathLike) -> None:
        """Go through a script once."""
        try:
            self.file(path)
        except Stop:
            self.label = None
        except InputError as e:
            self._add(e)
        self.problems.sort(key=lambda p: (p.where.file != os.fspath(path), p.where.file, p.where.line) if p.where else (False, "", 0))

    def file(self, path: str | os.PathLike) -> None:
        commands = script.read(path)
        errors, _ = script.check(commands)
        if errors:
            refuse_data(os.fspath(path))
        broken = {e.where for e in errors}
        for e in errors:
            self._add(e)
        if self._depth >= NESTING:
            raise InputError(f"include: scripts nested deeper than {NESTING}")
        for command in commands:
            if command.where in broken:
                self._doubt(command)
        self._depth += 1
        try:
            self._run([Command("", c.where) if c.where in broken else c for c in commands], os.fspath(path))
        except InputError as e:
            self._add(e)
        finally:
            self._depth -= 1

    def execute(self, command: str | Command) -> None:
        if isinstance(command, str):
            command = Command(command, self._position or Where("", 1, command))
        try:
            super().execute(command)
        except Jump:
            self._jumps[command.where] = self._jumps.get(command.where, 0) + 1
            if self._jumps[command.where] <= ROUNDS:
                raise
        except NotYet:
            self._doubt(command)
        except InputError as e:
            if not (self._ran and isinstance(e, Undefined)):      # runs that were passed over would have made other numbers
                self._add(e)
            self._doubt(command)
        except AsemdError as e:
            self._add(InputError(str(e)))
            self._doubt(command)

    def call(self, name: str, args) -> None:
        if name == "python" and args:
            self._doubtful.add(("function", args[0]))
        if name in WRITERS:
            self.scene.need_system(name)
        elif name != "python":
            try:
                super().call(name, args)
            except InputError as e:
                if isinstance(e.__cause__ or e, NotYet) or not self._will_exist(args, e):
                    raise
                raise NotYet(e.message, e.where) from None
        if name in WRITING:
            self._written += _files(name, args)

    def _will_exist(self, args, problem: InputError) -> bool:
        """Whether what a command did not find is a file that the script would have written before."""
        words = [w for w in args if w in problem.message and not os.path.exists(w)]
        return any(fnmatchcase(w, made) or fnmatchcase(made, w) for w in words for made in self._written)

    def drive(self, driver: Driver) -> None:
        """What is left of a run: the checks before it, and the references of its output."""
        try:
            check(self)
            self._solve()
        except InputError as e:
            self._add(e.at(self._position))
        for word in driver.words:
            try:
                self._bind(word)
            except (NotYet, Undefined):
                continue        # known once the run has begun
            except InputError as e:
                self._add(InputError(f"thermo_style: column {word}: {e.message}", self._position))
        self.scene.step += driver.plan.steps
        self._ran = True

    def _solve(self) -> None:
        """The parameters of the long-range solver, which the run would choose first; a problem is told at the first run that has it."""
        scene = self.scene
        interactions = scene.interactions
        if interactions.kspace == "none" and not interactions.needs_solver:
            return
        try:
            with self.passing_warnings():
                solve(scene.system, interactions, units.get(scene.units), scene.neighbor.skin)
        except InputError as e:
            if not any(p.message == e.message for p in self.problems):
                raise

    def _bind(self, word: str) -> None:
        """Look whether what a thermo column refers to is there."""
        kind, id, index = parse_reference(word) or ("", "", [])
        if kind == "v":
            self.variables.number(id, *index)
        elif kind:
            self.variables.provider.source(kind, id)

    def _add(self, problem: InputError) -> None:
        message = problem.message
        follows = self._no_box and "simulation box" in message
        for text, commands in CONSEQUENCES.items():
            follows = follows or (not self._failed.isdisjoint(commands) and re.search(text, message))
        for kind, name in self._doubtful:
            follows = follows or re.search(rf"\b({kind} '?|{kind[0]}_){re.escape(name)}(?![\w-])", message)
        same = any((p.message, p.where) == (message, problem.where) for p in self.problems)
        if not follows and not same:
            self.problems.extend(getattr(problem, "problems", [problem]))

    def _doubt(self, command: Command) -> None:
        """Remember what this command did not define."""
        try:
            words = command.words
        except InputError:
            return
        if not words:
            return
        words[0] = next(iter(get_close_matches(words[0], COMMANDS, n=1)), words[0])     # what a misspelt command would have done
        self._failed.add(words[0])
        if words[0] in BOX:
            self._no_box = self._no_box or self.scene.system is None
        if words[0] in NAMING and len(words) > 1:
            self._doubtful.add((words[0], words[1]))


def _files(name: str, words) -> list[str]:
    """Names of the files that a command may make, with * for any text."""
    if name in ("shell", "python"):
        return [] if list(words[:1]) in (["mkdir"], ["putenv"], ["rm"], ["rmdir"]) else ["*"]
    names = [word.replace("%", "*") for word in words]
    return names + [f"{n}.*" for n in names] if name == "restart" else names
