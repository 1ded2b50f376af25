"""From text to logical lines, and from a line to words, by the parsing rules of LAMMPS scripts.

Source: the LAMMPS manual, "Parsing rules for input scripts".
"""
from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from asemd.errors import InputError, Where

# what word processors and web pages make of quotes, signs and blanks -> what is meant
PLAIN = str.maketrans({**dict.fromkeys(map(chr, (0xA0, *range(0x2000, 0x200C), 0x202F, 0x2060, 0xFEFF)), " "), "\u2018": "'", "\u2019": "'",
                       "\u201c": '"', "\u201d": '"', "\u2212": "-", "\u02d7": "-", "\u02d6": "+"})
TRIPLE = '"""'


def plain(text: str) -> str:
    """The text with typographic quotes, signs and blanks in ASCII; other characters stay."""
    return text if text.isascii() else text.translate(PLAIN)


@dataclass(frozen=True)
class Line:
    """One logical line: continuation lines joined, comment and variables still in it."""

    text: str
    where: Where


def logical_lines(text: str, file: str = "") -> list[Line]:
    """Join ``&`` continuations and triple-quoted text that runs over several lines.

    Blank lines are kept, since a log echoes them.
    """
    lines, out, i = text.split("\n"), [], 0
    if lines and not lines[-1]:
        lines.pop()
    while i < len(lines):
        first, whole = i, lines[i].rstrip("\r")
        while True:
            i += 1
            bare = whole.rstrip()
            if bare.endswith("&"):
                whole = bare[:-1] + (lines[i].rstrip("\r") if i < len(lines) else "")
            elif whole.count(TRIPLE) % 2 and i < len(lines):
                whole += "\n" + lines[i].rstrip("\r")
            else:
                break
            if i >= len(lines):
                break
        out.append(Line(whole, Where(file, first + 1, " ".join(whole.split()))))
    return out


def _quoted_end(text: str, i: int) -> int:
    """Index just past the quotation that starts at `i`."""
    mark = TRIPLE if text.startswith(TRIPLE, i) else text[i]
    end = text.find(mark, i + len(mark))
    if end < 0:
        raise InputError(f"unmatched {'triple ' * (mark == TRIPLE)}quote {mark} in the command")
    return end + len(mark)


def strip_comment(text: str) -> str:
    """The line up to the first ``#`` outside quotes."""
    i = 0
    while i < len(text):
        if text[i] == "#":
            return text[:i]
        i = _quoted_end(text, i) if text[i] in "\"'" else i + 1
    return text


def split(text: str) -> list[str]:
    """Words of a line; a word that starts with a quote ends at its partner and loses both."""
    words, i = [], 0
    while i < len(text):
        if text[i].isspace():
            i += 1
            continue
        if text[i] in "\"'":
            end = _quoted_end(text, i)
            mark = 3 if text.startswith(TRIPLE, i) else 1
            if end < len(text) and not text[end].isspace():
                raise InputError(f"a closing quote must be followed by a space: {text[i:end + 1]}")
            words.append(text[i + mark:end - mark])
        else:
            end = i
            while end < len(text) and not text[end].isspace():
                end += 1
            words.append(text[i:end])
        i = end
    return words


def _reference(text: str, i: int) -> tuple[str, str, int]:
    """The reference whose ``$`` is at `i`: kind (name or formula), content, index past it."""
    if i + 1 >= len(text) or text[i + 1].isspace():
        raise InputError("a $ must be followed by a variable: $x, ${name} or $(formula)")
    if text[i + 1] == "{":
        end = text.find("}", i)
        if end < 0:
            raise InputError(f"missing }} after {text[i:]}")
        return "name", text[i + 2:end], end + 1
    if text[i + 1] == "(":
        depth, end = 1, i + 2
        while end < len(text) and depth:
            depth += {"(": 1, ")": -1}.get(text[end], 0)
            end += 1
        if depth:
            raise InputError(f"missing ) after {text[i:]}")
        return "formula", text[i + 2:end - 1], end
    return "name", text[i + 1], i + 2


def substitute(text: str, value: Callable[[str], str], formula: Callable[[str], float],
               echo: Callable[[str], None] | None = None, quotes: bool = True) -> str:
    """Replace ``$x``, ``${name}``, ``$(formula)`` and ``$(formula:%format)`` from left to right.

    Parameters
    ----------
    value : callable
        Name -> text of the variable.
    formula : callable
        Formula -> number.
    echo : callable, optional
        Called with the line after each replacement, which is what a log shows.
    quotes : bool
        Whether a quote must have its partner (a command line) or may be an apostrophe (the text of ``print``); text inside quotes stays
        as it is.
    """
    i = 0
    while i < len(text):
        if text[i] in "\"'" and (quotes or text[i] in text[i + 1:]):
            i = _quoted_end(text, i)
        elif text[i] == "$":
            kind, content, end = _reference(text, i)
            new = value(content) if kind == "name" else _immediate(content, formula)
            text = text[:i] + new + text[end:]
            i += len(new)
            if echo:
                echo(text)
        else:
            i += 1
    return text


def _immediate(content: str, formula: Callable[[str], float]) -> str:
    expression, colon, form = content.rpartition(":%")
    if not colon:
        return f"{formula(content):.20g}"
    form = "%" + form
    if form[-1:] not in "eEfFgG":
        raise InputError(f"format {form} of $({content}) must be one of %e, %f, %g")
    if not re.fullmatch(r"%[-+ 0#]*\d{0,3}(\.\d{0,3})?.", form):
        raise InputError(f"format {form} of $({content}) is not a number format")
    try:
        return form % formula(expression)
    except (TypeError, ValueError):
        raise InputError(f"format {form} of $({content}) is not a number format") from None
