"""A session executes commands on a scene."""
from __future__ import annotations

import importlib
import os
import warnings
from collections.abc import Callable, Sequence
from contextlib import contextmanager
from typing import Any

from asemd.errors import AsemdError, InputError, InputWarning, SimulationError, Where, nearest
from asemd.lammps import catalog, lex, script
from asemd.lammps.log import Log, to_stdout
from asemd.lammps.loops import Loops
from asemd.lammps.origin import Origin
from asemd.lammps.providers import Providers
from asemd.lammps.python_functions import PythonFunctions
from asemd.lammps.read import refuse_data
from asemd.lammps.script import Command
from asemd.lammps.switches import Switches
from asemd.lammps.timer import Timer
from asemd.moment import Moment, Progress
from asemd.scene import Scene
from asemd.variable import Variables

NESTING = 16
LARGE = 200_000     # lines of a file that take so long that a progress bar is shown
BEFORE_BOX = ("units", "boundary", "atom_style", "dimension", "processors", "package")
ACTIONS = ("run", "minimize", "rerun")


class Stop(Exception):
    """Raised to leave all scripts at once: ``quit``, or the end of what `asemd.read` executes."""

    def __init__(self, status: int = 0):
        super().__init__(status)
        self.status = status


class Session:
    """Executes LAMMPS commands on `scene`.

    Parameters
    ----------
    scene : Scene, optional
    switches : Switches, optional
        LAMMPS's command line switches, read.
    screen : callable, optional
        Takes text for the terminal; by default what the switches say.
    passive : bool
        Read only: no log, no dumps, no ``shell``; stops at the first run or minimisation.

    Attributes
    ----------
    scene, variables, log
    moment : Moment
        What is known about the last step that was evaluated.
    loop : asemd.loop.Loop or None
        The loop of the last run.
    interrupted : bool
        Set it to True to end the current run after the segment it is in.
    """

    dry = False      # whether runs are only checked
    defining = ""    # ID of the fix that is being made

    def __init__(self, scene: Scene | None = None, switches: Switches | None = None,
                 screen: Callable[[str], None] | None = None, passive: bool = False):
        self.switches = switches or Switches()
        self.passive = passive
        self.told_charge = False      # that the box is not neutral
        self.scene = scene or self._fresh_scene()
        if screen is None and self.switches.screen != "none" and not passive:
            screen = to_stdout if self.switches.screen is None else _to_file(self.switches.screen)
        self.log = Log(None if passive else self.switches.log, None if passive else screen, self.switches.echo)
        self.log.unbuffered = self.switches.nonbuf
        self.origin = Origin()
        self.variables = Variables(Providers(self))
        for name, values in self.switches.variables:
            self.variables.define(name, "index", values)
        self.python = PythonFunctions(self)
        self.loop: Any = None
        self.last_thermo: dict[str, Any] = {}
        self.last_words: list[str] = []
        self.last_thermo_step = -1
        self.running = False
        self.between = False        # the commands of run every: formulas look at the run
        self.interrupted = False
        self.timer = Timer()
        self.observer: Any = None          # told about progress by the driver: .start(steps), .update(done), .stop()
        self.record: Any = None            # an asemd.lammps.record.Record, which the driver fills
        self.label: str | None = None      # text is skipped up to this label
        self.exhausted = False             # `next` ran out: the next `jump` is skipped
        self.loops = Loops()
        self._depth = 0                    # scripts within scripts
        self._lines = 0                    # texts of several lines that are being executed
        self._position: Where | None = None
        self.stopped_at: Where | None = None        # the run at which a passive session stopped
        self.list_told: str | None = None       # the last description of the neighbour list
        self.precision_told = ""        # what was said of styles that mixed precision leaves as they are
        self.later: list[str] = []              # lines of the set-up of a run that come after that
        self.partners_told: Any = None          # see asemd.lammps.setup_log.partners_per_atom
        self.awaited: list[str] | None = None       # variables that the fix which is being defined goes by
        self.places: dict[str, Where] = {}      # "fix ID" -> where it was defined
        self.moment = Moment(self.scene, None, self.variables.number, Progress())

    def __getstate__(self) -> dict[str, Any]:
        """Copies have no log, no terminal and no compiled loop: the next run makes the loop anew."""
        return {**self.__dict__, "loop": None, "observer": None, "record": None}

    def _fresh_scene(self) -> Scene:
        scene = Scene()
        scene.threads, scene.precision, scene.compat = self.switches.threads, self.switches.precision, self.switches.compat
        scene.interactions.compat = self.switches.compat
        return scene

    # ------------------------------------------------------------- commands ---

    def execute(self, command: str | Command) -> None:
        """Execute one command.

        Raises
        ------
        InputError
            With the place of the command.
        """
        if isinstance(command, str):
            line = self._position       # of an `if` or the like that executes it
            command = Command(command, Where(line.file if line else "", line.line if line else 1, " ".join(command.split())))
        outer, self._position = self._position, command.where
        try:
            self._execute(command)
        except Jump as jump:
            if self._depth or self._lines:
                raise
            raise InputError(f"jump {jump.file}: only lines of a script can jump").at(command.where) from None
        except InputError as e:
            raise e.at(command.where) from e.__cause__
        except MemoryError:
            advice = "fewer atoms, a shorter cutoff, or --precision mixed may help"
            raise SimulationError(f"not enough memory: {advice} ({command.where})") from None
        except AsemdError as e:
            if not getattr(e, "placed", False):
                e.args = (f"{e} ({command.where})",)
                e.placed = True
            raise
        finally:
            self._position = outer

    def _execute(self, command: Command) -> None:
        if self.label is not None:
            words = command.words
            if len(words) == 2 and words == ["label", self.label]:
                self.label = None
            return
        self.log.echo(command.text)
        plain = lex.plain(command.text)
        text = lex.strip_comment(plain)
        if not text.strip():
            return
        if plain != command.text:
            self.warn("signs that are not ASCII (quotes, dashes, blanks) were read as their ASCII equivalents")
        text = lex.substitute(text, self.variables.value, self.variables.evaluate, self.log.echo)
        words = lex.split(text)
        if words:
            self.loops.note(text)
            self.call(words[0], words[1:])

    def call(self, name: str, args: Sequence[str]) -> None:
        """Execute a command whose words are ready."""
        if not catalog.exists("command", name):
            raise catalog.unknown("command", name)
        if name in BEFORE_BOX and self.scene.system is not None:
            raise InputError(f"{name} command after simulation box is defined: move it before read_data or create_box")
        if self.passive and name in ACTIONS and not self.dry:
            self.scene.need_system(name)
            self.stopped_at = self._position
            raise Stop
        if name in ACTIONS:
            self.log.to_file(self.origin.line())
        importlib.import_module(f"asemd.lammps.command.{name}").run(self, list(args))
        self.scene.sync_groups()
        self.origin.note(name, args, self.scene.fixes.get(args[0]) if name == "fix" and args else None)

    def commands(self, text: str) -> None:
        """Execute several lines of text."""
        self._lines += 1
        try:
            self._run(script.parse(text), "")
        finally:
            self._lines -= 1

    def file(self, path: str | os.PathLike) -> None:
        """Check a script, then execute it."""
        commands = script.read(path)
        self.origin.read(path)
        errors, doubtful = script.check(list(script.before(commands, ACTIONS)) if self.passive else commands)
        if errors:
            refuse_data(os.fspath(path))
        script.raise_problems(errors)
        for problem in doubtful:
            self.log.warn(str(problem))
        if self._depth >= NESTING:
            raise InputError(f"include: scripts nested deeper than {NESTING}")
        self._depth += 1
        try:
            self._run(commands, os.fspath(path))
        finally:
            self._depth -= 1

    def _run(self, commands: list[Command], path: str) -> None:
        i, origin = 0, None
        while i < len(commands):
            command = commands[i]
            try:
                self.execute(command)
            except Jump as jump:
                try:
                    warning = self.loops.jump(path, i)
                except InputError as e:
                    raise e.at(command.where) from None
                if warning:
                    self.warn(warning, command.where)
                if jump.file not in ("SELF", path):
                    try:
                        commands, path = script.read(jump.file), jump.file
                    except InputError as e:
                        raise e.at(command.where) from None
                i, self.label, origin = -1, jump.label, command
            i += 1
        if self.label is not None:
            missing, self.label = self.label, None
            there = script.labels(commands)
            found = nearest(missing, there) or (f"; there are {' '.join(there)}" if there else "; there is none")
            raise InputError(f"jump: no label {missing}{f' in {path}' if path else ''}{found}", origin and origin.where)

    def substitute(self, text: str) -> str:
        """Replace variables in text whose outer quotes are gone (print, if); inner ones keep what is between them."""
        return lex.substitute(text, self.variables.value, self.variables.evaluate, quotes=False)

    def print(self, text: str) -> None:
        """Tell the user: one line in the log and on the terminal."""
        self.log.write(text + "\n")

    @property
    def watched(self) -> bool:
        """Whether somebody looks at the progress of runs."""
        return self.observer is not None

    @contextmanager
    def progress(self, unit: str):
        """A function of how much is done and of how much, which shows a bar where there is a terminal; nothing for small files."""
        observer, begun = self.observer, False

        def tell(done: int, total: int) -> None:
            nonlocal begun
            if total >= LARGE:
                if not begun:
                    begun = True
                    observer.start(total, unit)
                observer.update(done)
        try:
            yield tell if observer is not None else None
        finally:
            if begun:
                observer.stop()

    def close_loop(self) -> None:
        """Forget the loop of the last run."""
        self.loop = None

    def warn(self, message: str, where: Where | None = None) -> None:
        """Warn, naming the command that is being executed, or another place."""
        where = where or self._position
        self.log.warn(f"{message} ({where})" if where and where.file else message)

    @contextmanager
    def passing_warnings(self):
        """Warnings of what is called inside become warnings of the command that is being executed."""
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", InputWarning)
            yield
        for warning in caught:
            self.warn(str(warning.message))

    def remember(self, what: str) -> None:
        """Note that `what` was defined by the command that is being executed."""
        if self._position:
            self.places[what] = self._position

    def refuse_if_safe(self, command: str) -> None:
        """Raise `InputError` for what a script from a stranger must not do."""
        if self.switches.safe:
            raise InputError(f"{command} is refused by --safe: it could do anything to this computer")

    # ---------------------------------------------------------------- state ---

    def clear(self) -> None:
        """Forget the scene; variables, log and working directory stay."""
        self.close_dumps()
        self.scene = self._fresh_scene()
        self.loop = self.list_told = None
        self.stale()

    def changed(self) -> None:
        """The atoms or the box were changed from outside: the next run starts afresh."""
        self.loop = None
        self.moment.forget()

    def look(self, loop) -> None:
        """In the midst of a run: the present step of the loop is what formulas see, with energies and virials if it has them."""
        self.moment = Moment(self.scene, loop.snapshot(), self.variables.number, self.moment.progress, loop.engine)

    @contextmanager
    def in_a_run(self, progress: Progress):
        """Formulas see a run that has this progress."""
        self.moment.progress, self.running = progress, True
        try:
            with self.at_step(progress.begin):
                yield
        finally:
            self.running = False

    @contextmanager
    def at_step(self, step: int):
        """Errors of what is called inside name the step."""
        try:
            yield
        except SimulationError as error:
            if not str(error).startswith("step "):
                error.args = (f"step {step}: {error}",)
            raise

    def stale(self) -> None:
        """What was known about the last step no longer holds."""
        self.moment = Moment(self.scene, None, self.variables.number, Progress())

    def close_dumps(self) -> None:
        for dump in self.scene.dumps.values():
            try:
                dump.close()
            except OSError as e:        # what was kept back until now found no room
                raise InputError(f"dump {dump.id}: cannot write {dump.path}: {e.strerror or e}") from None

    def close(self) -> None:
        """Close dumps and the log."""
        self.close_dumps()
        self.log.write(self.log.total_time())
        self.log.close()


class Jump(Exception):
    """Raised by the command ``jump``."""

    def __init__(self, file: str, label: str | None):
        super().__init__(file, label)
        self.file, self.label = file, label


def _to_file(path: str) -> Callable[[str], None]:
    f = open(path, "w", encoding="utf-8")       # noqa: SIM115  lives as long as the session

    def write(text: str) -> None:
        f.write(text)
        f.flush()
    return write
