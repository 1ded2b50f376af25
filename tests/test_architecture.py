"""The rules of docs/architecture.md, checked on the source: floors, circles, names, sizes, cost of the import."""
from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "asemd"
LINES = 400
LONG: set[str] = set()      # files that may be longer, each with its reason
FLOORS = ROOT / "docs" / "architecture.md"


def module_of(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


SOURCES = {module_of(p): p for p in sorted(PACKAGE.rglob("*.py"))}


def _guarded(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test)


def _imports(body, top: bool, here: str):
    """(module, at module level) for every import of asemd in these statements, those for type checkers left out."""
    for node in body:
        if _guarded(node):
            continue
        if isinstance(node, ast.Import):
            yield from ((a.name, top) for a in node.names if a.name.split(".")[0] == "asemd")
        elif isinstance(node, ast.ImportFrom) and node.module and node.module.split(".")[0] == "asemd":
            for a in node.names:
                full = f"{node.module}.{a.name}"
                yield (full if full in SOURCES else node.module), top
        else:
            inside = isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda))
            yield from _imports(ast.iter_child_nodes(node), top and not inside, here)


@cache
def graph() -> dict[str, list[tuple[str, bool]]]:
    return {name: [(m, top) for m, top in _imports(ast.parse(path.read_text()).body, True, name) if m != name]
            for name, path in SOURCES.items()}


@cache
def floors() -> list[list[str]]:
    """Names of each floor from the ground up, from the block under "Floors" of the architecture page."""
    block = re.search(r"^Floors.*?```\n(.*?)```", FLOORS.read_text(), re.S | re.M)[1]
    return [re.sub(r"\([^)]*\)|[/,]", " ", line).split() for line in block.strip().splitlines()]


@cache
def floor_of(module: str) -> int:
    parts = module.split(".")
    if len(parts) == 1:
        return -1       # asemd itself: imports nothing
    for level, names in enumerate(floors()):
        if parts[1] in names:
            return level
    raise AssertionError(f"{module} has no floor in docs/architecture.md")


def test_every_module_has_a_floor():
    missing = [m for m in SOURCES if m != "asemd" and not any(m.split(".")[1] in names for names in floors())]
    assert not missing


def test_imports_go_down():
    """Also inside functions."""
    up = [f"{a} -> {b}" for a, found in graph().items() for b, _ in found if floor_of(b) > floor_of(a)]
    assert not up, "\n".join(up)


def test_no_circles():
    """Nothing imports itself by a detour while modules are loaded."""
    edges = {a: {b for b, top in found if top} for a, found in graph().items()}
    state: dict[str, int] = {}

    def visit(module: str, trail: tuple[str, ...]) -> None:
        assert state.get(module) != 1, " -> ".join((*trail[trail.index(module):], module))
        if state.get(module) == 2:
            return
        state[module] = 1
        for other in edges.get(module, ()):
            visit(other, (*trail, module))
        state[module] = 2
    for module in edges:
        visit(module, ())


@pytest.mark.parametrize("category", ["bond", "angle", "dihedral", "improper", "pair", "fix", "compute", "dump", "region"])
def test_path_follows_name(category):
    """Each style is found by its LAMMPS name, in the file of that name."""
    from asemd import style
    from asemd.lammps import catalog
    found = [n for n in catalog.names(category) if n not in catalog.WRAPPERS and n != "hybrid/overlay"]
    assert found
    for name in found:
        assert style.module_of(category, name) in SOURCES, name


def test_command_files_define_run():
    for module, path in SOURCES.items():
        if module.startswith("asemd.lammps.command."):
            tree = ast.parse(path.read_text())
            run = [n for n in tree.body if isinstance(n, ast.FunctionDef) and n.name == "run"]
            assert run and [a.arg for a in run[0].args.args] == ["session", "args"], path


def test_files_are_small_and_named_for_something():
    sizes = {p.relative_to(ROOT).as_posix(): len(p.read_text().splitlines()) for p in SOURCES.values()}
    assert {name for name, n in sizes.items() if n > LINES} <= LONG
    assert not {p.stem for p in SOURCES.values()} & {"utils", "util", "helpers", "common", "misc"}


def test_docstrings():
    """Every module with code says what it is."""
    silent = [m for m, p in SOURCES.items() if p.read_text().strip() and not ast.get_docstring(ast.parse(p.read_text()))]
    assert not silent


def test_import_is_cheap():
    code = "import sys, asemd; print(*(m for m in ('numba', 'ase', 'scipy', 'rich', 'typer', 'matplotlib', 'numpy') if m in sys.modules))"
    env = {**os.environ, "PYTHONPATH": str(ROOT)}
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=env)
    assert out.stdout.split() == []


def test_public_names_exist():
    import asemd
    for name in asemd.__all__:
        assert getattr(asemd, name) is not None


def tracked() -> list[Path]:
    try:
        out = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
        return [ROOT / name for name in out.split("\0") if name]
    except (OSError, subprocess.CalledProcessError):
        return [p for p in ROOT.rglob("*") if p.is_file() and not any(part.startswith(".") for part in p.relative_to(ROOT).parts)]


def test_nothing_of_one_machine():
    """No absolute path of somebody's folders in any file."""
    private = re.compile(r"(?<![\w.])/(?:work|opt|root|home|Users|mnt|srv)/\w")
    hits = []
    for path in tracked():
        if path.suffix in (".png", ".gz") or not path.exists():
            continue
        for number, line in enumerate(path.read_text(errors="replace").splitlines(), 1):
            if private.search(line) and path != Path(__file__).resolve():
                hits.append(f"{path.relative_to(ROOT)}:{number}: {line.strip()}")
    assert not hits, "\n".join(hits)


def test_one_place_decides_the_vectors():
    """numba settles the processor's features at the first `njit`; taken from elsewhere, vectors would be as wide as history has it."""
    taken = re.compile(r"^\s*from numba import .*\bn?jit\b|\bnumba\.n?jit\b", re.M)
    where = {p.relative_to(ROOT / "asemd").as_posix() for p in (ROOT / "asemd").rglob("*.py") if taken.search(p.read_text())}
    assert where == {"kernels/target.py"}


def test_modules_of_tests_and_workflows_have_names_of_their_own():
    """Workflows are run inside the tests' own process: of two modules with one name the first one imported would serve both."""
    tests, workflows = ({path.stem for path in (ROOT / folder).glob("*.py")} for folder in ("tests", "workflows"))
    assert "conftest" in tests and "chains" in workflows
    assert not tests & workflows
