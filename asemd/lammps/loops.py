"""Loops by ``jump`` that never end: refused where nothing happens in them, warned of where they run for ever."""
from __future__ import annotations

from asemd.errors import InputError

IDLE = ("label", "jump", "if", "print", "echo", "log", "info", "variable")     # after the same text they leave the same state behind
ENDS = ("next", "if", "quit", "include", "python", "shell")
ACTIONS = ("run", "minimize", "rerun")
PASSES = 1000


class Loops:
    """What was executed between jumps."""

    def __init__(self):
        self.texts: list[str] = []                             # since the last jump, variables replaced
        self.before: dict[tuple[str, int], list[str]] = {}     # the same at the last time a line jumped
        self.told: set[tuple[str, int]] = set()
        self.idle = 0

    def note(self, text: str) -> None:
        """A command is executed."""
        self.texts.append(text)

    def jump(self, path: str, line: int) -> str:
        """A line jumps; what to warn of.

        Raises
        ------
        InputError
            The same commands were executed again and again and could not change anything.
        """
        key, texts = (path, line), self.texts
        same, names = self.before.get(key) == texts, {text.split()[0] for text in texts}
        endless = same and key not in self.told and names.isdisjoint(ENDS) and not names.isdisjoint(ACTIONS)
        if endless:
            self.told.add(key)
        self.idle = self.idle + 1 if same and names <= set(IDLE) else 0
        if self.idle >= PASSES:
            raise InputError(f"jump: a loop without end, the same commands were executed {PASSES} times and change nothing; next counts a "
                             "variable on, if and quit leave a loop")
        self.before[key], self.texts = texts, []
        return "jump: this loop has no end, there is no next, if or quit in it" if endless else ""
