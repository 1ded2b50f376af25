"""What makes numba compile faster; the code of the kernels stays the same.

- Types of calls: numba looks for each addition of two numbers through all that can be added, arrays, dates and texts, as often as there is
  one; here what was found once is kept. Options of functions are compared each time with all their values, for their hashes are all equal;
  here they are not.
- References: to count those of an array, numba takes all parts of it out, those too that hold none.
- Each call of LLVM is announced, and all modules that register functions are looked for again and again.
- What Python calls needs a wrapper, code that takes Python's objects apart, often more of it than the function has. Functions get one that
  are compiled because Python calls them; those that other functions call are compiled once more if Python should call them later.
- Garbage is not collected while a function is compiled: there is hardly any that would go away, and looking for it takes longer the more is
  loaded.
"""
from __future__ import annotations

import gc
from functools import cache
from weakref import WeakSet

from numba import types
from numba.core import event, sigutils, utils
from numba.core.compiler_lock import global_compiler_lock
from numba.core.cpu import CPUContext
from numba.core.datamodel.manager import DataModelManager
from numba.core.dispatcher import Dispatcher, _FunctionCompiler
from numba.core.runtime.context import NRTContext
from numba.core.targetconfig import ConfigStack, TargetConfig
from numba.core.types.functions import BaseFunction

from asemd.kernels import intermediate

# whose types alone say what a call is
PLAIN = (types.Number, types.Boolean, types.IntegerLiteral, types.Array, types.BaseTuple, types.NoneType, types.SliceType)
LLVM_LOCK = "numba:llvm_lock"      # within numba's lock for the compiler

look_up, same_values, load_all = BaseFunction.get_call_type, TargetConfig.__eq__, CPUContext.load_additional_registries
look_model_up, signature_of = DataModelManager.lookup, utils.pysignature
compile_core, compile_once, keep = _FunctionCompiler._compile_core, Dispatcher.compile, Dispatcher.add_overload
found: dict[tuple, tuple] = {}
loaded: WeakSet = WeakSet()
depth = 0      # how many functions are being compiled, each for the one before


def get_call_type(self, context, args, kws):
    """Signature of a call of a builtin function, and how numba implements it."""
    if kws or not hasattr(self, "_impl_keys") or not all(isinstance(a, PLAIN) for a in args):
        return look_up(self, context, args, kws)
    options = ConfigStack.top_or_none()
    key = context, self._code, tuple([a._code for a in args]), options
    known = found.get(key)
    if known is None:
        signature = look_up(self, context, args, kws)
        # a copy, for numba changes options in place
        found[(*key[:3], options and options.copy())] = signature, self._impl_keys[signature.args]
        return signature
    signature, self._impl_keys[signature.args] = known
    return signature


def options_hash(self) -> int:
    """The same for equal options, whether or not a default is spelt out."""
    plain = ((name, value) for name, value in self._values.items() if isinstance(value, (bool, str)))
    return hash(frozenset((name, value) for name, value in plain if value != self.options[name].default))


def options_equal(self, other):
    return (isinstance(other, TargetConfig) and self._values == other._values) or same_values(self, other)


@cache
def counts(model) -> bool:
    """Whether values of that kind have references to count."""
    return model.contains_nrt_meminfo()


def get_meminfos(self, builder, kind, value):
    """What counts the references of a value: pairs of a type and a pointer."""
    models = self._context.data_model_manager
    model = models[kind]
    if not counts(model):
        return []
    own = [(kind, model.get_nrt_meminfo(builder, value))] if model.has_nrt_meminfo() else []
    return own + [one for inner, part in model.traverse(builder) if counts(models[inner])
                  for one in self.get_meminfos(builder, inner, part(value))]


def model_of(self, kind):
    """How values of a type are kept; types are told apart by their number, for which their parts need not be looked at."""
    models = self.__dict__.setdefault("by_number", {})
    model = models.get(kind._code)
    if model is None:
        model = models[kind._code] = look_model_up(self, kind)
    return model


def load_registries(self) -> None:
    """What was registered since; the modules that register are imported the first time."""
    if self in loaded:
        for registry in list(self._registries):
            self.install_registry(registry)
    else:
        load_all(self)
        loaded.add(self)


def unless_of_locks(announce):
    """Events without those of LLVM's lock, one for each call of LLVM."""
    def announced(kind, *data, **more):
        if kind != LLVM_LOCK:
            announce(kind, *data, **more)
    return announced


def core(self, args, return_type):
    """Compile a function, and within that those that it calls; garbage waits meanwhile."""
    global depth
    collects = gc.isenabled()
    gc.disable()
    depth += 1
    try:
        return compile_core(self, args, return_type)
    finally:
        depth -= 1
        if collects:
            gc.enable()


def customize_flags(self, flags):
    """Options of a function that is not for numba's callbacks."""
    if depth > 1:
        flags.no_cpython_wrapper = flags.no_cfunc_wrapper = True
    return flags


def has_wrapper(compiled) -> bool:
    return compiled.library.get_pointer_to_function(compiled.fndesc.llvm_cpython_wrapper_name) != 0


def add_overload(self, compiled) -> None:
    """Keep a compiled function; Python calls it only with a wrapper."""
    if has_wrapper(compiled):
        keep(self, compiled)
    else:
        self.overloads[tuple(compiled.signature.args)] = compiled


def compile_signature(self, sig):
    """The entry point of the function for a signature."""
    with global_compiler_lock:
        entry = compile_once(self, sig)
        if depth:
            return entry
        args, return_type = sigutils.normalize_signature(sig)
        if not has_wrapper(self.overloads[tuple(args)]):
            self._cache_misses[sig] += 1
            compiled = self._compiler.compile(args, return_type)
            self.add_overload(compiled)
            self._cache.save_overload(sig, compiled)
            entry = compiled.entry_point
        return entry


def install() -> None:
    """For the whole process."""
    BaseFunction.get_call_type = get_call_type
    NRTContext.get_meminfos = get_meminfos
    DataModelManager.lookup = DataModelManager.__getitem__ = model_of
    utils.pysignature = cache(signature_of)
    event.start_event, event.end_event = map(unless_of_locks, (event.start_event, event.end_event))
    CPUContext.load_additional_registries = load_registries
    _FunctionCompiler._compile_core, _FunctionCompiler._customize_flags = core, customize_flags
    Dispatcher.add_overload, Dispatcher.compile = add_overload, compile_signature
    TargetConfig.__hash__, TargetConfig.__eq__ = options_hash, options_equal
    intermediate.install()
