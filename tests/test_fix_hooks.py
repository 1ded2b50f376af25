"""Hooks of all fixes go into one module of compiled code."""
from __future__ import annotations

import importlib
import pkgutil

import pytest

import asemd.fix as fixes
from asemd.kernels.generate import Builder, text_of


def test_functions_that_hooks_share_have_names_of_their_own():
    """Two fixes in one run may not bring different functions of one name."""
    found = {}
    for module in pkgutil.iter_modules(fixes.__path__):
        for kind in vars(importlib.import_module(f"asemd.fix.{module.name}")).values():
            for hook in vars(kind).values() if isinstance(kind, type) else ():
                for helper in getattr(getattr(hook, "__func__", hook), "uses", ()):
                    other = found.setdefault(helper.__name__, helper)
                    assert text_of(other) == text_of(helper), f"{helper.__name__} of {other.__module__} and {helper.__module__}"
    assert len(found) > 10


def test_two_functions_of_one_name_are_refused():
    def twice(x):
        return 2.0 * x
    first = twice

    def twice(x):      # noqa: F811
        return x + x
    b = Builder("two of a name")
    b.function(first)
    b.function(first)
    with pytest.raises(NameError, match="two functions named twice"):
        b.function(twice)
    assert b.source().count("def twice") == 1
