"""``if condition then commands [elif condition commands] [else commands]``"""
from __future__ import annotations

import re

from asemd.errors import InputError
from asemd.words import take

MARKS = ("elif", "else")
COMPARE = re.compile(r"(.*?)(==|!=)(.*)", re.S)
NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")


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
    for k, (condition, commands) in enumerate(branches):
        if not commands or (condition is None and k != len(branches) - 1):
            raise InputError("if: every branch needs commands, and else comes last")
    for condition, commands in branches:
        if condition is None or holds(session, session.substitute(condition)):
            for command in commands:
                session.execute(command)
            return


def holds(session, text: str) -> bool:
    """Whether a condition is true: a formula of numbers, or two texts compared with == or !=."""
    compare = COMPARE.fullmatch(text.strip())
    if compare and not any(c in text for c in "&|()"):
        left, right = compare[1].strip(), compare[3].strip()
        if not (NUMBER.fullmatch(left) and NUMBER.fullmatch(right)):
            if not left or not right or " " in left or " " in right:
                raise InputError(f"if: cannot compare {text!r}")
            if NUMBER.fullmatch(left) or NUMBER.fullmatch(right):
                raise InputError(f"if: cannot compare a number with text in {text!r}")
            return (left == right) == (compare[2] == "==")
    if re.search(r"[A-Za-z_](?![-+.\d])", re.sub(NUMBER, "", text)):
        raise InputError(f"if: {text!r} must be numbers with operators, or two words compared with == or !=")
    return session.variables.evaluate(text) != 0.0
