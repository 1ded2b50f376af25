"""Text files that fixes write while a run goes on."""
from __future__ import annotations

from typing import IO

from asemd.errors import InputError


class OutputFile:
    """A text file, complete after every `write`; copies of it write nothing.

    Parameters
    ----------
    path : str
    what : str
        The command that writes it, for messages.
    append : bool
        Keep what is there.
    silent : bool
        Write nothing.

    Raises
    ------
    InputError
        The file cannot be written.
    """

    def __init__(self, path: str, what: str, append: bool = False, silent: bool = False):
        self.path, self.what, self.append = path, what, append
        self._file: IO[str] | None = None
        self._start = self._ending = 0
        if not silent:
            try:
                self._file = open(path, "a" if append else "w", encoding="utf-8")      # noqa: SIM115  open as long as the fix
            except OSError as e:
                raise InputError(f"{what}: cannot write {path}: {e.strerror or e}") from None

    def __getstate__(self):
        return {**self.__dict__, "_file": None}

    def write(self, text: str, ending: str = "") -> None:
        """Add text; `ending` stands after it until more comes."""
        if self._file is None:
            return
        try:
            if self._ending:
                self._file.seek(self._file.tell() - self._ending)
                self._file.truncate()
            self._file.write(text + ending)
            self._ending = len(ending)
            self._file.flush()
        except OSError as e:
            raise InputError(f"{self.what}: cannot write {self.path}: {e.strerror or e}") from None

    def mark(self) -> None:
        """What comes from here on is replaced after `rewind`."""
        if self._file is not None:
            self._start = self._file.tell()

    def rewind(self) -> None:
        """Go back to the mark."""
        if self._file is not None:
            self._file.seek(self._start)
            self._file.truncate()
            self._ending = 0


def plain(value: float) -> str:
    """The shortest text that is this number, whole numbers without a point."""
    return repr(float(value)).removesuffix(".0")
