"""Arrays of atoms that a running loop brings up to date when somebody reads them: observers read few of them."""
from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any


class Late:
    """What is not up to date: arrays `names`, which ``fetch(name, array)`` brings up to date."""

    def __init__(self, fetch: Callable[[str, Any], None], names: Iterable[str]):
        self.fetch, self.names = fetch, set(names)

    def bring(self, name: str, array) -> None:
        """Make sure that an array is up to date."""
        if name in self.names:
            self.names.discard(name)
            self.fetch(name, array)


class LateArray:
    """Such an array as an attribute."""

    def __init__(self, name: str):
        self.name = name

    def __get__(self, owner, kind=None):
        if owner is None:
            return self
        if owner.late is not None:
            owner.late.bring(self.name, owner.__dict__[self.name])
        return owner.__dict__[self.name]

    def __set__(self, owner, array) -> None:
        if owner.late is not None:
            owner.late.names.discard(self.name)
        owner.__dict__[self.name] = array


def late_arrays(*names: str) -> Callable[[type], type]:
    """For classes with arrays of these names: `late` is a `Late`, or None while everything is up to date; copies are up to date."""
    def of(cls: type) -> type:
        for name in names:
            setattr(cls, name, LateArray(name))
        cls.late, cls.__getstate__ = None, lambda self: {name: getattr(self, name) for name in self.__dict__ if name != "late"}
        return cls
    return of
