"""Checks before a run. One check, one file; each registers itself.

A check is a function of a `asemd.check.case.Case` that returns its findings, ``ok`` ones included, or raises `DoesNotApply`::

    @static("charges")
    def charges(case: Case) -> list[Finding]: ...

Styles and fixes bring checks of their own as a method ``check_stability(case)`` that returns `asemd.finding.Finding` objects.
"""
from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable, Iterable

from asemd.check.case import Case
from asemd.finding import Finding

CHECKS: dict[str, Callable[[Case], Iterable[Finding]]] = {}      # by name


class DoesNotApply(Exception):
    """Raised by a check that has nothing to look at; says why."""


def static(name: str):
    """Register a check under a name in plain words."""
    def decorate(function: Callable[[Case], Iterable[Finding]]):
        CHECKS[name] = function
        return function
    return decorate


def all_checks() -> dict[str, Callable[[Case], Iterable[Finding]]]:
    """Every check by name; imports their files."""
    for module in sorted(m.name for m in pkgutil.iter_modules(__path__)):
        importlib.import_module(f"{__name__}.{module}")
    return dict(CHECKS)
