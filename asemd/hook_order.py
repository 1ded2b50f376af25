"""Hooks at the end of a step in the order of their fixes, where some are compiled and others are not."""
from __future__ import annotations

from collections.abc import Mapping, Sequence

from asemd.fix import NEVER, Fix


def before_compiled(fixes: Sequence[Fix], kinds: Sequence[Mapping[str, bool]]) -> list[tuple[Fix, list[Fix]]]:
    """Fixes with an `end_of_step` in Python, each with those behind it whose own is compiled and would come first."""
    out = []
    for n, fix in enumerate(fixes):
        behind = [f for f, hooks in zip(fixes[n + 1:], kinds[n + 1:]) if hooks.get("end_of_step", False)]
        if behind and not kinds[n].get("end_of_step", True):
            out.append((fix, behind))
    return out


def next_mixed(mixed: list[tuple[Fix, list[Fix]]], step: int) -> int:
    """The next known step after `step` at whose end one of them and a compiled one behind it act: it is made hook by hook."""
    due = [(fix.next_end(step), behind) for fix, behind in mixed]
    return min((at for at, behind in due if at < NEVER and any(at % f.every == 0 for f in behind)), default=NEVER)
