"""Functions in Python that a script brings along: the command ``python``, variables of style python.

Source: the LAMMPS manual page of ``python``. The code runs in this process; its ``from lammps import lammps`` gets `asemd.lammps.Lammps`,
and ``lammps(ptr=SELF)`` is the session that runs the script.
"""
from __future__ import annotations

import builtins
import types
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from asemd.errors import AsemdError, InputError, nearest
from asemd.words import take, whole

KEYWORDS = ("invoke", "input", "return", "format", "length", "file", "here", "exists")
TYPES = {"i": int, "f": float, "s": str}


@dataclass
class Function:
    """One function: what it is given, where its result goes, and the letters for the types of both."""

    inputs: list[str] = field(default_factory=list)
    result: str | None = None
    format: str = ""


class PythonFunctions:
    """All functions of a session, and the names their code has defined."""

    def __init__(self, session):
        self.session = session
        self.table: dict[str, Function] = {}
        self.texts: list[tuple[str, str]] = []      # what was executed, and where it comes from
        self.names = self._names()

    def _names(self) -> dict[str, Any]:
        return {"__name__": "__main__", "__builtins__": {**vars(builtins), "__import__": self._import}}

    def __getstate__(self):
        return {**self.__dict__, "names": None}

    def __setstate__(self, state):
        """A copy has the functions that the same code defines anew."""
        vars(self).update(state)
        self.names = self._names()
        for text, origin in self.texts:
            exec(compile(text, f"<python {origin}>", "exec"), self.names)

    def command(self, words: list[str]) -> None:
        """``python NAME keywords...`` or ``python source FILE``."""
        name = take(words, 2, "python")[0]
        if name == "source":
            if words[1] == "here":
                self._execute(take(words, 3, "python source here")[2], "here")
            else:
                self._load(words[1])
        elif words[1] == "invoke":
            if words[2:] not in ([], ["logreturn"]):
                raise InputError(f"python {name} invoke takes logreturn or nothing, got {' '.join(words[2:])}")
            self._invoke(name, bool(words[2:]))
        else:
            self._define(name, words[1:])

    def call(self, name: str, values: list[float] | None = None) -> str:
        """Call a function and give its result as text; `values` go to the internal variables among its inputs."""
        if name not in self.table:
            raise InputError(f"there is no Python function {name}{nearest(name, self.table)}: the command python defines it")
        function = self.table[name]
        if function.result is None:
            raise InputError(f"Python function {name} has no return keyword, so it has no value")
        return self._text(name, function, self._run(name, function, values))

    def _define(self, name: str, words: list[str]) -> None:
        function, code = Function(), ""
        while words:
            key, what = words[0], f"python {name} {words[0]}"
            if key not in KEYWORDS[1:]:
                raise InputError(f"python {name}: unknown keyword {key!r}{nearest(key, KEYWORDS)}")
            if key == "exists":
                code, words = key, words[1:]
                continue
            value = take(words[1:], 1, what)[0]
            if key == "input":
                count = whole(value, what)
                if count < 1:
                    raise InputError(f"{what}: expected a positive number of inputs, got {count}")
                function.inputs = take(words[2:], count, what)
                words = words[count:]
            elif key == "return":
                if not value.startswith("v_"):
                    raise InputError(f"{what}: expected v_name, got {value!r}")
                function.result = value[2:]
            elif key == "format":
                function.format = value
            elif key == "length":
                whole(value, what)      # texts of any length fit
            else:
                code = key
                self._load(value) if key == "file" else self._execute(value, name)
            words = words[2:]
        expected = len(function.inputs) + (function.result is not None)
        if len(function.format) != expected or set(function.format) - set("ifsp"):
            raise InputError(f"python {name} format needs {expected} letters out of i f s p, one for each input and the returned value, "
                             f"got {function.format!r}")
        if not code or not callable(self.names.get(name)):
            raise InputError(f"python {name}: the code defines no function {name}; give it with here, file or exists")
        self.table[name] = function

    def _invoke(self, name: str, tell: bool) -> None:
        if name not in self.table:
            raise InputError(f"python {name} invoke: there is no such function{nearest(name, self.table)}")
        function = self.table[name]
        value = self._run(name, function, None)
        if tell:
            self.session.print(f"Invoked python function {name}" + (f" returned {value}" if function.result else ""))

    def invoke(self, name: str, values: list) -> None:
        """Call a function for a fix: with the session, and what the fix gives besides."""
        from asemd.lammps import Lammps
        self._guarded(name, lambda: self.names[name](Lammps.of(self.session), *values))

    def _run(self, name: str, function: Function, values: list[float] | None) -> Any:
        given = list(values) if values is not None else None
        arguments = [self._argument(name, word, letter, given) for word, letter in zip(function.inputs, function.format)]
        if given:
            raise InputError(f"Python function {name} has {len(values) - len(given)} inputs iv_name for {len(values)} arguments")
        return self._guarded(name, lambda: self.names[name](*arguments))

    def _argument(self, name: str, word: str, letter: str, given: list[float] | None) -> Any:
        variables = self.session.variables
        if word == "SELF":
            from asemd.lammps import Lammps
            return Lammps.of(self.session)
        if word.startswith("iv_"):
            if given is not None:
                if not given:
                    raise InputError(f"Python function {name} has more inputs iv_name than there are arguments")
                variables.define(word[3:], "internal", [repr(given.pop(0))])
            word = word[1:]
        text = variables.value(word[2:]) if word.startswith("v_") else word
        try:
            return TYPES[letter](text)
        except (KeyError, ValueError):
            raise InputError(f"Python function {name}: input {word} = {text!r} does not fit format {letter}") from None

    def _text(self, name: str, function: Function, value: Any) -> str:
        letter = function.format[-1]
        try:
            return f"{float(value):.15g}" if letter == "f" else str(TYPES[letter](value))
        except (KeyError, TypeError, ValueError, OverflowError):
            raise InputError(f"Python function {name} returned {value!r}, which does not fit format {letter}") from None

    def _load(self, path: str) -> None:
        try:
            with open(path, encoding="utf-8") as f:
                text = f.read()
        except (OSError, ValueError) as e:
            raise InputError(f"python: cannot open {path}: {getattr(e, 'strerror', None) or e}") from None
        self._execute(text, path)

    def _execute(self, text: str, origin: str) -> None:
        self._guarded(origin, lambda: exec(compile(text, f"<python {origin}>", "exec"), self.names))
        self.texts.append((text, origin))

    def _guarded(self, name: str, work: Callable[[], Any]) -> Any:
        self.session.refuse_if_safe("python")
        try:
            return work()
        except AsemdError:
            raise
        except Exception as e:
            raise InputError(f"python {name}: {type(e).__name__}: {' '.join(str(e).split())}") from e

    def _import(self, name: str, *rest):
        return self._lammps() if name == "lammps" else builtins.__import__(name, *rest)

    def _lammps(self) -> types.ModuleType:
        """What ``import lammps`` gives: the class for the session of this script."""
        from asemd import lammps
        module = types.ModuleType("lammps")
        vars(module).update({k: v for k, v in vars(lammps).items() if k.startswith("LMP_")})
        module.lammps = lambda name="", cmdargs=None, ptr=None, comm=None: ptr if ptr is not None else lammps.Lammps(name, cmdargs)
        return module
