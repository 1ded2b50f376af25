"""Compiled hooks: each function of a fix in a module of its own, which imports what it calls, so that it is compiled once for all runs."""
from __future__ import annotations

import ast
import inspect
import re
import sys
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from functools import cache, lru_cache, partial
from types import CodeType, ModuleType

import numpy as np

from asemd.kernels import ahead, packed, random
from asemd.kernels.generate import FAST, Builder, load, plain_source
from asemd.kernels.state import Thread
from asemd.style import text_of

INNER = "no_cpython_wrapper=True"       # called by compiled code only
COMPILED = {"barrier": "asemd.kernels.threads", "reduce_sum": "asemd.kernels.threads"}


def _imports(b: Builder, function: Callable, source: str, uses: tuple[Callable, ...]) -> None:
    """Import what a function calls into the module that will hold it."""
    called = {node.id for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Name)} - {function.__name__}
    for word in sorted(called & set(COMPILED)):
        b.line(f"from {COMPILED[word]} import {word}")
    known: dict[str, Callable] = {}
    for helper in (random.uniform, random.normal, *uses):
        other = known.setdefault(helper.__name__, helper)
        if other is not helper and text_of(other) != text_of(helper):
            raise NameError(f"two functions named {helper.__name__} in one fix: of {other.__module__} and {helper.__module__}")
    for word in sorted(called & set(known)):
        b.use(shared(known[word], tuple(f for f in uses if f is not known[word])), word)


@lru_cache(1024)
def shared(function: Callable, uses: tuple[Callable, ...] = ()) -> ModuleType:
    """The module of one function that hooks call.

    Parameters
    ----------
    function : callable
        It may call ``barrier``, ``reduce_sum``, ``uniform`` and ``normal`` of `asemd.kernels`, and what is in `uses`. With the attribute
        ``strict``, its sums and products keep their order to the last bit.
    uses : tuple of callable
        Functions that it and they call by name.

    Raises
    ------
    NameError
        Two functions of `uses` have one name.
    """
    b, source = Builder(function.__name__), plain_source(function)
    _imports(b, function, source, uses)
    b.text(source, INNER + ("" if getattr(function, "strict", False) else f", fastmath={FAST}"))
    return b.build()


def _fields(source: str, name: str) -> list[str] | None:
    """The attributes that a function reads of one of its arguments; None if it hands on the whole."""
    nodes = list(ast.walk(ast.parse(source)))
    read = [n.attr for n in nodes if isinstance(n, ast.Attribute) and isinstance(n.value, ast.Name) and n.value.id == name]
    return sorted(set(read)) if len(read) == sum(isinstance(n, ast.Name) and n.id == name for n in nodes) else None


@lru_cache(1024)
def hook_source(function: Callable, arrays: str, strict: bool) -> str:
    """The module of a hook with an address; arguments as of `compiled`."""
    b, source = Builder(f"{function.__module__}: {function.__name__}"), plain_source(function, "hook")
    _imports(b, function, source, getattr(function, "uses", ()))
    b.line("from importlib import import_module")
    b.line("from numba import types")
    b.line("from asemd.kernels.packed import AFTER_NUMBERS, AFTER_STATE, STATE, entry, reader")
    b.line("from asemd.kernels.packed import read_address, read_numbers, read_thread")
    head, body = source.split("\n", 1)
    th, s, p, a = head.removeprefix("def hook(").removesuffix("):").split(", ")
    b.line(f"read_state = reader(STATE, {_fields(source, s)})")
    b.line(f"read_arrays = reader({arrays})")
    b.line(f"# {packed.LAYOUT}")
    b.text(f"""@entry({"" if strict else f"fastmath={FAST}"})
def hook(thread, arguments):
    {th} = read_thread(thread)
    {s} = read_state(read_address(arguments))
    {p} = read_numbers(arguments + AFTER_STATE)
    {a} = read_arrays(arguments + AFTER_NUMBERS)
{body}""", jit=False)
    return b.checked()


@lru_cache(1024)
def compiled(function: Callable, arrays: str, strict: bool = False):
    """A hook with an address.

    Parameters
    ----------
    function : callable
        ``function(th, s, p, a)``; it may call what is in its attribute ``uses``, see `shared`.
    arrays : str
        The type of `a`, as `asemd.kernels.packed.text_of_type` writes it.
    strict : bool
        Sums and products keep their order to the last bit.

    Returns
    -------
    int, or the function itself where nothing is compiled
    """
    if packed.WITHOUT_COMPILER:         # it finds what it calls as the compiled one does
        return getattr(shared(function, tuple(getattr(function, "uses", ()))), function.__name__)
    return load(hook_source(function, arrays, strict)).hook.address


def takes_thread(kernel: Callable) -> bool:
    """Whether the first argument of a kernel is the `Thread`, named ``th``."""
    code = getattr(inspect.unwrap(getattr(kernel, "py_func", kernel)), "__code__", None)
    return code is not None and code.co_varnames[:1] == ("th",)


@lru_cache(1024)
def kernel_source(kernel: Callable, arguments: str) -> str:
    """The module of a kernel with an address; arguments as of `kernel_address`."""
    thread = takes_thread(kernel)
    function = kernel.py_func
    module, names = sys.modules[function.__module__], function.__code__.co_varnames[:function.__code__.co_argcount]
    b = Builder(f"{function.__name__} by address")
    b.line("from importlib import import_module")
    b.line("from numba import types")
    b.line("from asemd.kernels.packed import entry, read_thread, reader")
    called = sorted(n for n in _names(function.__code__) if n in vars(module) and n not in ("math", "np"))
    if called:
        b.line(f"from {module.__name__} import {', '.join(called)}")
    b.line(f"read = reader({arguments})")
    text = getattr(module, "TEXT", None) or f"{plain_source(function)}\n"      # of a module that is not generated
    body = re.search(rf"^def {function.__name__}\(.*\):\n((?:[ ].*\n|\n)*)", text, re.M).group(1)
    reads = "    th = read_thread(thread)\n" * thread + f"    {''.join(f'{n}, ' for n in names[thread:])}= read(arguments)\n"
    fast = kernel.targetoptions.get("fastmath")
    b.text(f"@entry({f'fastmath={FAST}' if fast else ''})\ndef call(thread, arguments):\n{reads}{body}", jit=False)
    return b.checked()


@lru_cache(1024)
def kernel_address(kernel: Callable, arguments: str):
    """A kernel of a generated module with an address, as hooks have one. It is compiled in this form only: its text is taken over, and what
    it calls is imported.

    Parameters
    ----------
    kernel : callable
        Its first argument may be the `Thread`, see `takes_thread`. It returns nothing.
    arguments : str
        The type of its (other) arguments as one tuple, as `asemd.kernels.packed.text_of_type` writes it.
    """
    if packed.WITHOUT_COMPILER:
        return kernel if takes_thread(kernel) else lambda th, *values: kernel(*values)
    return load(kernel_source(kernel, arguments)).call.address


def compile_ahead(kernels: Iterable[tuple[Callable, str]], functions: Sequence[tuple[Callable, tuple]] = ()) -> None:
    """Compile kernels that will be called by address, (kernel, type of its arguments) each, in several processes; functions too, see
    `asemd.kernels.ahead`."""
    if not packed.WITHOUT_COMPILER:
        ahead.together([kernel_source(*pair) for pair in kernels if hasattr(pair[0], "py_func")], functions)


def _names(code: CodeType) -> set[str]:
    """What a function may look up outside itself."""
    return set(code.co_names).union(*(_names(c) for c in code.co_consts if isinstance(c, CodeType)))


@cache
def _standing(level: int) -> np.ndarray:
    """A thread in memory for kernels that Python calls."""
    return packed.block(Thread(0, 1, 0, 0, 0, 0, 0, 0.0, np.zeros(8, np.int64), np.zeros((1, 8)), level))


def bound(kernel: Callable, arguments: tuple, level: int = 0) -> Callable[[], None]:
    """A call of a kernel from Python, of the same machine code that the time loop calls.

    Parameters
    ----------
    kernel : callable
        As for `kernel_address`, or any Python function.
    arguments : tuple
        What it takes besides the `Thread`; the arrays live as long as the call.
    level : int
        `Thread.level`.
    """
    if packed.WITHOUT_COMPILER or not hasattr(kernel, "py_func"):
        return partial(kernel, *[_standing(level)] * takes_thread(kernel), *arguments)
    block = packed.Block(arguments)
    address = kernel_address(kernel, packed.text_of_arguments(arguments))
    call = partial(packed.enter_at, address, packed.handle(_standing(level)), packed.handle(block.memory))
    call.block = block      # type: ignore[attr-defined]    # which lives as long as the call
    return call


class BoundKernels:
    """Calls of kernels that take place again and again with the same arguments; `level` as for `bound`."""

    def __init__(self, level: int):
        self.level, self._known = level, (None, None, None)

    def calls(self, kernels: list[Callable], arguments: list[Sequence[tuple]]) -> list[list[Callable[[], None]]]:
        """For each thread, whose arguments are one entry of a list that does not change, the calls of all kernels."""
        if self._known[0] is not arguments or self._known[1] != kernels:
            compile_ahead(zip(kernels, map(packed.text_of_arguments, arguments[0])))
            calls = [[bound(f, a, self.level) for f, a in zip(kernels, mine, strict=True)] for mine in arguments]
            self._known = arguments, kernels, calls
        return self._known[2]


class Calls:
    """The hooks of a run, and their arguments in memory.

    Parameters
    ----------
    hooks : sequence of dict
        Per fix: kind -> hook function.
    everys : sequence of int
        Per fix: `end_of_step` is called on multiples of this.
    strict : collection of str
        Kinds whose sums and products keep their order to the last bit.
    """

    def __init__(self, hooks: Sequence[Mapping[str, Callable]], everys: Sequence[int], strict: Collection[str]):
        self.hooks, self.everys, self.strict = hooks, everys, strict
        self._state = self._data = None
        self._block = self._table = None
        self._arguments: list = []

    def function(self, n: int, kind: str, data):
        """A compiled hook of fix `n`: its address, or the function itself where nothing is compiled."""
        return compiled(self.hooks[n][kind], packed.text_of_arguments(data[n][1]), kind in self.strict)

    def _follow(self, state, data) -> None:
        """Arguments anew where the state or the arrays of fixes are others; the state stays where it is in memory."""
        if state is not self._state:
            self._state = state
            if self._block is None or not self._block.take(state):
                self._block, self._data = packed.Block(state), None
        if data is not self._data:
            known, self._data = self._data, data
            if known is None or any(a is not b for new, old in zip(data, known, strict=True) for a, b in zip(new, old)):
                self._arguments = [packed.arguments(self._block.memory, numbers) for numbers in data]
                self._table = None

    def table(self, kinds: Sequence[str], state, data) -> tuple[np.ndarray, np.ndarray]:
        """For the time loop: (function, arguments, every) of each call, by kind; and where the calls of each kind begin."""
        self._follow(state, data)
        if self._table is None:
            rows, starts = [], [0]
            if not packed.WITHOUT_COMPILER:
                ahead.together([hook_source(hooks[kind], packed.text_of_arguments(data[n][1]), kind in self.strict)
                                for n, hooks in enumerate(self.hooks) for kind in kinds if kind in hooks])
            for kind in kinds:
                rows += [(self.function(n, kind, data), packed.handle(self._arguments[n]), self.everys[n] if kind == "end_of_step" else 1)
                         for n, hooks in enumerate(self.hooks) if kind in hooks]
                starts.append(len(rows))
            calls = np.empty((len(rows), 3), packed.HANDLE)
            for k, row in enumerate(rows):
                calls[k, 0], calls[k, 1], calls[k, 2] = row
            self._table = calls, np.array(starts)
        return self._table

    def call(self, n: int, kind: str, th, state, data, keep: bool = True) -> None:
        """One hook of one fix; its arguments stay in memory for the next call if `keep`, which is for the state of the loop itself."""
        if keep:
            self._follow(state, data)
            arguments = self._arguments[n]
        else:
            block = packed.block(state)
            arguments = packed.arguments(block, data[n])
        packed.enter(self.function(n, kind, data), th, packed.handle(arguments))
