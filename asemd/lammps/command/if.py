"""``if condition then commands [elif condition commands] [else commands]``"""
from __future__ import annotations

import re

from asemd.errors import InputError
from asemd.words import take

TOKEN = re.compile(r"\s*(?:(?P<number>-?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)|(?P<text>[A-Za-z_][\w/]*)"
                   r"|(?P<op>==|!=|<=|>=|<|>|&&|\|\||\|\^|!|\(|\)))")
BINARY = (
    {"||": lambda a, b: bool(a) or bool(b), "|^": lambda a, b: bool(a) != bool(b)},
    {"&&": lambda a, b: bool(a) and bool(b)},
    {"==": lambda a, b: a == b, "!=": lambda a, b: a != b},
    {"<": lambda a, b: a < b, "<=": lambda a, b: a <= b, ">": lambda a, b: a > b, ">=": lambda a, b: a >= b},
)


def run(session, args):
    take(args, 3, "if")
    if args[1] != "then":
        raise InputError(f"if: expected then after the condition, got {args[1]!r}")
    branches = [(args[0], [])]
    words = list(args[2:])
    while words:
        word = words.pop(0)
        if word == "elif":
            branches.append((take(words, 1, "if elif")[0], []))
            del words[0]
        elif word == "else":
            branches.append((None, []))
        else:
            branches[-1][1].append(word)
    if not all(commands for _, commands in branches):
        raise InputError("if: every branch needs commands")
    for condition, commands in branches:
        if condition is None or holds(session.substitute(condition)):
            for command in commands:
                session.execute(command)
            return


def holds(text: str) -> bool:
    """Whether a condition of numbers and words is true.

    Raises
    ------
    InputError
        Not a condition, or one that compares a number with a word.
    """
    condition = Condition(text)
    try:
        value = condition.binary(0)
    except RecursionError:
        raise InputError("if: the condition is nested too deeply") from None
    if condition.tokens or isinstance(value, str):
        raise condition.error()
    return bool(value)


class Condition:
    """The tokens of a condition, read from left to right."""

    def __init__(self, text: str):
        self.text, self.tokens, at = text, [], 0
        while text[at:].strip():
            match = TOKEN.match(text, at)
            if not match:
                raise self.error()
            kind = match.lastgroup
            self.tokens.append((kind, match[kind]))
            at = match.end()

    def error(self) -> InputError:
        return InputError(f"if: {self.text!r} must be numbers or words compared with == != < <= > >= and joined by && || |^ ! ( )")

    def next(self, operators=("!", "(", ")")) -> str:
        """The operator that comes next, if it is one of these."""
        if self.tokens and self.tokens[0][0] == "op" and self.tokens[0][1] in operators:
            return self.tokens.pop(0)[1]
        return ""

    def binary(self, level: int):
        if level == len(BINARY):
            return self.operand()
        value = self.binary(level + 1)
        while operator := self.next(BINARY[level]):
            other = self.binary(level + 1)
            if isinstance(value, str) != isinstance(other, str):
                raise InputError(f"if: cannot compare a number with text in {self.text!r}")
            if isinstance(value, str) and operator not in ("==", "!="):
                raise InputError(f"if: words can only be compared with == and != in {self.text!r}")
            value = float(BINARY[level][operator](value, other))
        return value

    def operand(self):
        if self.next(("!",)):
            value = self.operand()
            if isinstance(value, str):
                raise self.error()
            return float(not value)
        if self.next(("(",)):
            value = self.binary(0)
            if not self.next((")",)):
                raise self.error()
            return value
        if not self.tokens or self.tokens[0][0] == "op":
            raise self.error()
        kind, word = self.tokens.pop(0)
        return float(word) if kind == "number" else word
