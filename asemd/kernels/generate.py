"""Generated kernel modules: plain functions of asemd, pasted together as text, compiled once and cached on disk.

Why text: numba's disk cache never hits for closures over a style, and it looks only at a function's own file, so an edited helper in
another file would run stale. A module that holds all its source and is named by the hash of that source has neither problem: the same scene
finds the same file in every process, and an edited style makes a new one. A kernel that calls another generated kernel imports it by its
hashed name.
"""
from __future__ import annotations

import ast
import builtins
import contextlib
import functools
import hashlib
import importlib
import importlib.util
import inspect
import os
import re
import sys
import tempfile
import types
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

import numpy as np

from asemd.cache_folder import cache_folder
from asemd.style import text_of

PACKAGE = "asemd_kernels"
FAST = "{'contract', 'reassoc', 'nsz', 'arcp'}"
LIMIT_BYTES = 512 * 2**20
_DEFINES = re.compile(r"(?:from \S+ import ([^#]+)|(\w+(?:, \w+)*) = )")
_EVERYWHERE = {"math", "np", *dir(builtins)}
_HEADER = "import math\nimport numpy as np\nfrom asemd.kernels.target import njit\n"


def cache_dir() -> Path:
    """The folder of generated modules: ``ASEMD_CACHE_DIR``, else the user's cache folder, else (unwritable) a temporary one."""
    global _dir
    if _dir is None or not _dir.is_dir():
        path = cache_folder() / PACKAGE
        try:
            path.mkdir(parents=True, exist_ok=True)
            with tempfile.NamedTemporaryFile(dir=path):
                _dir = path
        except OSError:
            _dir = Path(tempfile.mkdtemp(prefix="asemd-")) / PACKAGE
            _dir.mkdir()
        package = sys.modules.setdefault(PACKAGE, types.ModuleType(PACKAGE))
        package.__path__ = [str(_dir)]
    return _dir


_dir: Path | None = None
announce: Callable[[], None] | None = None      # called once, before a kernel is compiled that is not in the cache


class _Plain(ast.NodeTransformer):
    """Strip what compiled code does not need; optionally make every number literal a `real` of the working precision and
    map ``math.exp`` to the vectorised twin."""

    def __init__(self, real: bool, vector: bool, constants: Mapping[str, bool]):
        self.real, self.vector, self.constants = real, vector, constants

    def _known(self, test):
        if isinstance(test, ast.Name) and test.id in self.constants:
            return bool(self.constants[test.id])
        if isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not):
            inner = self._known(test.operand)
            return None if inner is None else not inner
        if isinstance(test, ast.BoolOp) and isinstance(test.op, ast.And) and any(self._known(v) is False for v in test.values):
            return False
        return None

    def visit_If(self, node):
        known = self._known(node.test)
        if known is None:
            self.generic_visit(node)
            return node
        chosen = [self.visit(n) for n in (node.body if known else node.orelse)]
        flat = [m for n in chosen for m in (n if isinstance(n, list) else [n])]
        return flat or ast.Pass()

    def visit_IfExp(self, node):
        known = self._known(node.test)
        if known is None:
            self.generic_visit(node)
            return node
        return self.visit(node.body if known else node.orelse)

    def visit_FunctionDef(self, node):
        node.decorator_list, node.returns = [], None
        for a in node.args.args:
            a.annotation = None
        if node.body and isinstance(node.body[0], ast.Expr) and isinstance(node.body[0].value, ast.Constant):
            node.body = node.body[1:]
        self.generic_visit(node)
        if self.vector and node.args.args and node.args.args[0].arg == "r2":
            node.args.args[1:1] = [ast.arg("ir2"), ast.arg("ir")]
        return node

    def visit_BinOp(self, node):
        if isinstance(node.op, ast.Pow) and isinstance(node.right, ast.Constant):
            node.left = self.visit(node.left)      # the exponent stays an integer
            return node
        self.generic_visit(node)
        if self.vector and not self.real and isinstance(node.op, ast.Div) and _is_one(node.left) and _one_and_more(node.right):
            return ast.Call(ast.Name("vector_inverse", ast.Load()), [node.right], [])
        if self.vector and isinstance(node.op, ast.Div) and isinstance(node.right, ast.Name) and node.right.id == "r2":
            inverse = ast.Name("ir2", ast.Load())
            one = isinstance(node.left, ast.Call) and getattr(node.left.func, "id", "") == "real" and node.left.args[0].value == 1.0
            if one or (isinstance(node.left, ast.Constant) and node.left.value == 1):
                return inverse
            return ast.BinOp(node.left, ast.Mult(), inverse)
        return node

    def visit_Constant(self, node):
        if self.real and isinstance(node.value, (int, float)) and not isinstance(node.value, bool):
            return ast.Call(ast.Name("real", ast.Load()), [ast.Constant(float(node.value))], [])
        return node

    def visit_Call(self, node):
        self.generic_visit(node)
        if self.vector and ast.unparse(node) == "math.sqrt(r2inv)":
            return ast.Name("ir", ast.Load())
        if self.vector and ast.unparse(node) == "math.sqrt(r2)":
            return ast.BinOp(ast.Name("r2", ast.Load()), ast.Mult(), ast.Name("ir", ast.Load()))
        if self.vector and isinstance(node.func, ast.Attribute) and node.func.attr in ("exp", "log", "erfc", "pow", "sin", "cos"):
            node.func = ast.Name("vector_" + node.func.attr, ast.Load())
        return node


def _is_one(node) -> bool:
    return isinstance(node, ast.Constant) and node.value == 1.0


def _one_and_more(node) -> bool:
    return isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add) and _is_one(node.left)


def plain_source(function: Callable, name: str | None = None, real: bool = False, vector: bool = False,
                 constants: Mapping[str, bool] = MappingProxyType({})) -> str:
    """Source of a function without decorators, annotations and docstring, under another name if asked for.

    Parameters
    ----------
    real : bool
        Wrap number literals as ``real(...)``, so that single-precision kernels stay in single precision.
    vector : bool
        Replace ``math.exp`` and relatives by branch-free versions that vectorise (`asemd.kernels.vector_math`), and ``1.0 / (1.0 + ...)``,
        which is of order 1, by one that takes less time; a function of ``r2`` gets two more arguments, its inverse ``ir2``, which replaces
        divisions by ``r2``, and the root of that, ``ir``, for ``math.sqrt(r2inv)`` and ``math.sqrt(r2)``.
    constants : mapping
        Names whose truth is known: ``if NAME:`` keeps one branch only, so that a variant holds nothing it does not need.
    """
    return ast.unparse(_plain_tree(function, name, real, vector, constants))


def _plain_tree(function: Callable, name: str | None, real: bool, vector: bool, constants: Mapping[str, bool]) -> ast.FunctionDef:
    node = _Plain(real, vector, constants).visit(ast.parse(text_of(function))).body[0]
    if name:
        node.name = name
    return node


class Builder:
    """Collects the text of one kernel module.

    Examples
    --------
    >>> b = Builder("demo")
    >>> b.constant("SCALE", 2.0)
    >>> b.text("def twice(x):\\n    return SCALE * x")
    >>> b.build().twice(4.0)
    8.0
    """

    def __init__(self, title: str):
        self.lines = [f'"""{title}"""', _HEADER]
        self.constants: dict[str, object] = {}
        self._have: dict[str, Callable] = {}
        self._lines_of: dict[str, str] = {}      # name -> the line that defines it
        self._needs: dict[str, set[str]] = {}      # name of a function -> names that it takes from the module

    def line(self, text: str) -> None:
        self.lines.append(text)
        if match := _DEFINES.match(text):
            names = (match[1] or match[2]).split(",")
            self._lines_of |= {name.split(" as ")[-1].strip(): text for name in names}

    def constant(self, name: str, value) -> None:
        """A module constant, frozen into the machine code; branches on it vanish."""
        self.constants[name] = value
        self.line(f"{name} = {value!r}" if isinstance(value, (bool, int, float, str)) else f"{name} = {value}")

    def text(self, source: str, options: str = "", cache: bool = True, jit: bool = True, apart: bool = False) -> None:
        """A function given as text, compiled with strict IEEE arithmetic unless `options` says otherwise; with `apart` in a module of its
        own where all that it needs is written in single lines: whichever kernels have it in common, it is compiled once."""
        if apart and self._apart(ast.parse(source).body[0], source, options):
            return
        if jit:
            if "fastmath" not in options:      # else numba takes that of the function that calls it first
                options = ", ".join(filter(None, [options, "fastmath=False"]))
            words = ["cache=True"] * cache + ["nogil=True", "no_cfunc_wrapper=True", "error_model='numpy'", options]
            self.lines.append(f"@njit({', '.join(words)})")
        self.lines.append(source)

    def function(self, function: Callable, name: str | None = None, *, fast: bool = False, real: bool = False, vector: bool = False,
                 inline: bool = False) -> str:
        """Paste a Python function; returns its name there. The same function is pasted once. With `inline` it never stays a call, which
        would keep the loop around it from becoming vector code.

        Raises
        ------
        NameError
            Another function has that name.
        """
        name = name or function.__name__
        known = self._have.get(name)
        if known is None:
            self._have[name] = function
            options = ", ".join([f"fastmath={FAST}"] * fast + ["forceinline=True"] * inline)
            tree = _plain_tree(function, name, real, vector, self.constants)
            source = ast.unparse(tree)
            if not self._apart(tree, source, options):
                self.text(source, options)
        elif known is not function and text_of(known) != text_of(function):
            raise NameError(f"two functions named {name} in one module of kernels: of {known.__module__} and {function.__module__}")
        return name

    def _apart(self, tree: ast.FunctionDef, source: str, options: str) -> bool:
        """A module for the function and the lines that it needs; False, and nothing is done, if it needs more than lines."""
        nodes = [n for n in ast.walk(tree) if isinstance(n, (ast.Name, ast.arg))]
        own = {n.arg if isinstance(n, ast.arg) else n.id for n in nodes if isinstance(n, ast.arg) or isinstance(n.ctx, ast.Store)}
        needed = {n.id for n in nodes if isinstance(n, ast.Name)} - own - _EVERYWHERE - {tree.name}
        self._needs[tree.name] = needed
        if not needed <= self._lines_of.keys():
            return False
        b = Builder(tree.name)
        for line in sorted({self._lines_of[n] for n in needed}):
            b.line(line)
        b.text(source, options)
        self.use(b.build(), tree.name)
        return True

    def use(self, module: types.ModuleType, name: str, alias: str | None = None) -> None:
        """Call a kernel of another generated module; its hashed name makes this module's hash follow."""
        self.line(f"from {module.__name__} import {name}" + (f" as {alias}" if alias else ""))

    def source(self) -> str:
        return "\n".join(self.lines) + "\n"

    def build(self) -> types.ModuleType:
        """The module of all that, which raises what `checked` does."""
        return load(self.checked())

    def checked(self) -> str:
        """The source, if it is whole.

        Raises
        ------
        NameError
            A function pasted here calls something that is not.
        """
        have = {*self._lines_of, *self._have, *re.findall(r"^def (\w+)", self.source(), re.M)}
        for name, needed in self._needs.items():
            if missing := needed - have:
                raise NameError(f"{name} needs {', '.join(sorted(missing))}, which this module of kernels lacks: {self.lines[0]}")
        return self.source()


@functools.cache
def _source_of(module: str) -> str:
    """The text of a module of asemd that generated code imports: it is part of what the code is."""
    return inspect.getsource(importlib.import_module(module))


def stem_of(text: str) -> str:
    """The name of the module with that text."""
    import numba

    import asemd
    imported = "".join(map(_source_of, sorted(set(re.findall(r"^from (asemd\.[\w.]+) import", text, re.M)))))
    key = f"{asemd.__version__}|{numba.__version__}|{np.__version__}|{sys.version_info[:2]}|{text}|{imported}"
    return "k_" + hashlib.sha256(key.encode()).hexdigest()[:24]


def load(text: str) -> types.ModuleType:
    """The module with that text, written to the cache folder unless it is there."""
    import asemd.kernels.target  # noqa: F401   before the module decorates its functions
    stem = stem_of(text)
    name = f"{PACKAGE}.{stem}"
    if name in sys.modules:
        return sys.modules[name]
    try:
        spec = importlib.util.spec_from_file_location(name, written(stem, text))
        module = importlib.util.module_from_spec(spec)
        run = spec.loader.exec_module
    except OSError:      # no room on the disk: compiled for this process only
        module = types.ModuleType(name)
        run = functools.partial(_run_unwritten, text)
    sys.modules[name] = module
    module.TEXT = text
    try:
        run(module)
    except BaseException:
        del sys.modules[name]
        raise
    for value in vars(module).values():
        if hasattr(value, "_cache"):
            _keep_if_there_is_room(value._cache)
            _announce_misses(value._cache)
    return module


def written(stem: str, text: str) -> Path:
    """The file of a generated module, written unless it is there."""
    folder = cache_dir()
    path = folder / f"{stem}.py"
    if not path.exists():
        _trim_once(folder)
        fd, tmp = tempfile.mkstemp(dir=folder, suffix=".tmp")
        try:
            with os.fdopen(fd, "w") as f:
                f.write(text)
            os.utime(tmp, (1_600_000_000, 1_600_000_000))   # numba's index compares the time: two writers must agree
            os.replace(tmp, path)
        except OSError:
            os.unlink(tmp)
            raise
    return path


def _run_unwritten(text: str, module: types.ModuleType) -> None:
    exec(compile(text.replace("cache=True, ", ""), f"<{module.__name__}>", "exec"), vars(module))


def _keep_if_there_is_room(kept) -> None:
    """Code that the disk has no room for is compiled again in the next process; a run does not end for it."""
    if "save_overload" not in vars(kept):
        save = kept.save_overload

        def attempt(signature, code):
            with contextlib.suppress(OSError):
                save(signature, code)

        kept.save_overload = attempt


def tell() -> None:
    """Say that something is compiled, the first time."""
    global announce
    say, announce = announce, None
    if say is not None:
        say()


def _announce_misses(kept) -> None:
    """Say so before the first code is compiled that is not in the cache: that takes a while."""
    if "load_overload" not in vars(kept):
        look = kept.load_overload

        def found(signature, target):
            code = look(signature, target)
            if code is None:
                tell()
            return code

        kept.load_overload = found


def _trim(folder: Path) -> None:
    """Keep the cache bounded: drop the oldest compiled code first."""
    files = []
    with contextlib.suppress(FileNotFoundError), os.scandir(folder / "__pycache__") as entries:
        for f in entries:
            with contextlib.suppress(FileNotFoundError):
                files.append((f.stat().st_mtime, f.stat().st_size, Path(f.path)))
    total = sum(size for _, size, _ in files)
    for _, size, f in sorted(files):
        if total <= LIMIT_BYTES:
            break
        f.unlink(missing_ok=True)
        total -= size


@functools.cache
def _trim_once(folder: Path) -> None:
    """Looking through thousands of files takes longer than compiling a small kernel: a process does it before its first one."""
    _trim(folder)


def digest(constants: Mapping[str, object]) -> str:
    """A short stable name for a set of constants."""
    return hashlib.sha256(repr(sorted(constants.items())).encode()).hexdigest()[:12]
