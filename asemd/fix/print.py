"""Print a line of text every N steps to the log, the terminal and a file; variables in it are replaced anew each time.

N may be an equal-style variable that gives the next step. Source: LAMMPS manual, fix print.
"""
from __future__ import annotations

from asemd.errors import InputError
from asemd.fix import Fix, sampled
from asemd.fix.output_file import OutputFile
from asemd.fix.values import needs_of, snapshot_of
from asemd.words import take, whole, yes_no

KEYWORDS = {"file": 1, "append": 1, "screen": 1, "title": 1}


class Print(Fix):
    """Print text during a run.

    Parameters
    ----------
    group : str
        Has no effect.
    every : int
        Steps between two lines.
    text : str or callable
        A function of a `asemd.engine.Snapshot` that returns the line.
    file : str, optional
        Gets the lines too.
    screen : bool
        Print the lines.

    Raises
    ------
    InputError
        An interval below 1, a file that cannot be written.
    """

    style = "print"
    session = None

    def __init__(self, group: str = "all", every: int = 1, text="", file: str = "", screen: bool = True):
        super().__init__(group)
        if isinstance(every, int) and every < 1:
            raise InputError(f"fix print: N must be at least 1, got {every}")
        self.print_every, self.text, self.screen = every, text, screen
        self.next_print: int | None = None
        self.file = OutputFile(file, "fix print") if file else None

    @classmethod
    def from_lammps(cls, group, words, session):
        what = "fix print"
        take(words, 2, what)
        options = sampled.keywords(words[2:], KEYWORDS, what)
        if words[0].startswith("v_"):
            name, table = words[0][2:], session.variables.table
            if name in table and table[name].style != "equal":
                raise InputError(f"{what}: {words[0]} must be a variable of style equal")
            session.awaited.append(name)
            every = words[0]
        else:
            every = whole(words[0], f"{what} N")
        fix = cls(group, every, words[1], screen=yes_no(options.get("screen", ["yes"])[0], f"{what} screen"))
        fix.session, fix.words = session, list(words)
        path = next((options[k][0] for k in reversed(options) if k in ("file", "append")), "")
        if path:
            fix.file = OutputFile(path, what, "append" in options, session.passive)
            title = options.get("title", [f"# Fix print output for fix {getattr(session, 'defining', '')}"])[0]
            fix.file.write(title + "\n")                           # also in a file that is appended to
        fix.begin(session.scene.step)
        return fix

    def to_lammps(self) -> list[str]:
        words = getattr(self, "words", [str(self.print_every), str(self.text)])
        return [words[0], f'"{words[1]}"', *words[2:]]

    def begin(self, step: int) -> None:
        """The first step with a line."""
        self.next_print = step if isinstance(self.print_every, str) else -(-step // self.print_every) * self.print_every

    def next_end(self, step: int) -> int:
        return self.next_print if self.next_print is not None and self.next_print > step else sampled.NEVER

    def setup(self, loop) -> None:
        self.begin(loop.step)
        if self.session is not None:
            inside = [w for w in self.session.variables.references(self.text)]
            formulas = [f"v_{w}" for w in inside if w in self.session.variables.table]
            self.needs = frozenset(needs_of([*formulas, *(w for w in inside if w[:2] in ("c_", "v_"))], self.session)) | {"energy"}
        if isinstance(self.print_every, str):
            snapshot_of(loop, self.session, self.needs)
            self.next_print = self._by_variable(loop.step)
        elif self.next_print == loop.step:
            self.end_of_step(loop)

    def _by_variable(self, step: int) -> int:
        value = int(self.session.variables.number(self.print_every[2:]))
        if value <= step:
            raise InputError(f"fix print: variable {self.print_every[2:]} gave step {value}, which is not after step {step}")
        return value

    def end_of_step(self, loop) -> None:
        """Print the line."""
        snapshot = snapshot_of(loop, self.session, self.needs)
        text = self.text(snapshot) if callable(self.text) else self.session.substitute(self.text) if self.session is not None else self.text
        if isinstance(self.print_every, str):
            self.next_print = self._by_variable(loop.step)
        else:
            self.next_print = loop.step + self.print_every
        if self.screen:
            if self.session is not None:
                self.session.print(text)
            else:
                print(text)
        if self.file is not None:
            self.file.write(text + "\n")
