"""What makes numba compile faster; the code that it makes is the same.

Much of the time goes into finding the types of calls. numba looks for each addition of two numbers through all that can be added, arrays,
dates and texts, as often as there is one; here what was found once is kept. Options of functions are compared each time with all their
values, for their hashes are all equal; here they are not. And garbage is not collected while a function is compiled: there is hardly any
that would go away, and looking for it takes longer the more is loaded.
"""
from __future__ import annotations

import gc

from numba import types
from numba.core import event
from numba.core.targetconfig import ConfigStack, TargetConfig
from numba.core.types.functions import BaseFunction

# whose types alone say what a call is
PLAIN = (types.Number, types.Boolean, types.IntegerLiteral, types.Array, types.BaseTuple, types.NoneType, types.SliceType)
COMPILE = "numba:compile"      # within numba's lock for the compiler

look_up, same_values = BaseFunction.get_call_type, TargetConfig.__eq__
found: dict[tuple, tuple] = {}


def get_call_type(self, context, args, kws):
    """Signature of a call of a builtin function, and how numba implements it."""
    if kws or not hasattr(self, "_impl_keys") or not all(isinstance(a, PLAIN) for a in args):
        return look_up(self, context, args, kws)
    options = ConfigStack.top_or_none()
    known = found.get((context, self, tuple(args), options))
    if known is None:
        signature = look_up(self, context, args, kws)
        # a copy, for numba changes options in place
        found[context, self, tuple(args), options and options.copy()] = signature, self._impl_keys[signature.args]
        return signature
    signature, self._impl_keys[signature.args] = known
    return signature


def options_hash(self) -> int:
    """The same for equal options, whether or not a default is spelt out."""
    plain = ((name, value) for name, value in self._values.items() if isinstance(value, (bool, str)))
    return hash(frozenset((name, value) for name, value in plain if value != self.options[name].default))


def options_equal(self, other):
    return (isinstance(other, TargetConfig) and self._values == other._values) or same_values(self, other)


class NoCollection(event.Listener):
    """Garbage waits while a function is compiled, and what it calls."""

    depth, was = 0, False

    def on_start(self, event):
        if not self.depth:
            self.was = gc.isenabled()
            gc.disable()
        self.depth += 1

    def on_end(self, event):
        self.depth -= 1
        if not self.depth and self.was:
            gc.enable()


def install() -> None:
    """For the whole process."""
    BaseFunction.get_call_type = get_call_type
    TargetConfig.__hash__, TargetConfig.__eq__ = options_hash, options_equal
    event.register(COMPILE, NoCollection())
