"""The documentation is true: its Python runs, its scripts run, its names and links exist, generated pages are those of the code."""
from __future__ import annotations

import ast
import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import asemd

ROOT = Path(__file__).resolve().parents[1]
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", *(ROOT / "docs").rglob("*.md"), *(ROOT / "workflows").glob("*/README.md")]
MADE = [ROOT / "docs" / name for name in ("_build", "styles", "workflows")]          # by Sphinx
PAGES = sorted(p for p in PAGES if not any(folder in p.parents for folder in MADE))
# page -> what it is about
NEEDED = {"docs/symmetry.md": ["spglib"], "docs/mdanalysis.md": ["MDAnalysis"], "docs/lammps.md": ["lammps"],
          "docs/tutorial.md": ["lammps"]}
EXECUTED = ("index", "tutorial", "ase", "campaigns", "custom-compute", "custom-fix", "data-files", "kspace", "lammps", "lammps-users",
            "mdanalysis", "migration", "symmetry", "units")
ENV = {**os.environ, "PYTHONPATH": str(Path(asemd.__file__).parents[1])}


def blocks(page: Path, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(), re.S | re.M)


def commands(page: Path) -> list[str]:
    """Lines of a page that call `asemd`, without their comments; reports, batteries, calibrations and MPI have tests of their own."""
    text = "\n".join(blocks(page, "sh") + blocks(page, "bash"))
    found = [line.split(" #")[0] for line in text.splitlines() if line.startswith("asemd ")]
    return [line for line in found if not re.search(r"asemd report|--battery|--calibrate|--engine", line)]


def scripts(page: Path) -> dict[str, str]:
    """LAMMPS scripts of a page by the file name that the line above gives them."""
    return dict(re.findall(r"`(in\.\w+)`:\n+```lammps\n(.*?)^```", page.read_text(), re.S | re.M))


def modules_of(page: Path) -> dict[str, str]:
    """Python files of a page that the line above calls `my_...py`."""
    return dict(re.findall(r"`(my_\w+\.py)`:\n+```python\n(.*?)^```", page.read_text(), re.S | re.M))


def files(page: Path) -> dict[str, str]:
    """Other files of a page: text behind `data.NAME` or `NAME.in.WORD`."""
    return dict(re.findall(r"`((?:data\.\w+|\w+\.(?:data|in\.\w+)))`:\n+```text\n(.*?)^```", page.read_text(), re.S | re.M))


def python(*arguments: str, cwd: Path) -> str:
    done = subprocess.run([sys.executable, *arguments], env=ENV, cwd=cwd, capture_output=True, text=True, timeout=1800)      # compiles
    assert done.returncode == 0, done.stdout[-1000:] + done.stderr[-3000:]
    return done.stdout


@pytest.mark.parametrize("name", ["README.md", *(f"docs/{page}.md" for page in EXECUTED)])
def test_python_blocks_run(name, tmp_path):
    page = ROOT / name
    for library in NEEDED.get(name, ()):
        if importlib.util.find_spec(library) is None:       # LAMMPS is never loaded into this process
            pytest.skip(f"{library} is not installed")
    modules = modules_of(page)
    for file, text in (scripts(page) | modules | files(page)).items():
        (tmp_path / file).write_text(text)
    found = [text for text in blocks(page, "python") if text not in modules.values()]
    assert found
    (tmp_path / "page.py").write_text("\n".join(found))
    python("page.py", cwd=tmp_path)


@pytest.mark.parametrize("name", [p.stem for p in PAGES if commands(p) and not modules_of(p)])
def test_commands_run(name, tmp_path):
    """The command lines of a page end without an error, with the page's own scripts or an ordinary one."""
    page = ROOT / "docs" / f"{name}.md"
    lines = [line for line in commands(page) if "validate" not in line or importlib.util.find_spec("lammps")]
    ordinary, = scripts(ROOT / "docs" / "index.md").values()
    for file in re.findall(r"\bin\.\w+", "\n".join(lines)):
        (tmp_path / file).write_text(ordinary)
    for file, text in (scripts(page) | files(page)).items():
        (tmp_path / file).write_text(text)
    python("-c", f"from asemd.cli import main\nfor line in {lines}:\n    assert main(line.split()[1:]) == 0, line", cwd=tmp_path)


def test_lines_of_scripts_run(tmp_path):
    """Pages that show lines of a script, not all of it: by themselves, or before the run of another one."""
    page = ROOT / "docs" / "lammps-users.md"
    for file, text in files(page).items():
        (tmp_path / file).write_text(text)
    (tmp_path / "in.half").write_text(scripts(ROOT / "docs" / "scripts.md")["in.half"])
    pictures, = blocks(ROOT / "docs" / "output.md", "lammps")
    (tmp_path / "in.chains").write_text(re.sub("^run ", lambda run: pictures + run[0], scripts(page)["in.chains"], flags=re.M))
    assert "half of" in python("-m", "asemd.cli", "run", "in.half", cwd=tmp_path)
    python("-m", "asemd.cli", "run", "in.chains", cwd=tmp_path)
    assert (tmp_path / "melt.0.png").stat().st_size > 1000 and (tmp_path / "melt.gif").stat().st_size > 1000


@pytest.mark.parametrize("name", ["custom-fix", "custom-compute"])
def test_commands_with_own_files(name, tmp_path):
    """The line that brings a page's Python file into `asemd run`; what asemd has already cannot be defined again."""
    page = ROOT / "docs" / f"{name}.md"
    for file, text in (scripts(page) | modules_of(page)).items():
        (tmp_path / file).write_text(text)
    command, = blocks(page, "sh")
    assert "Loop time of" in python("-m", "asemd.cli", *command.split()[1:], cwd=tmp_path)
    script, own = command.split()[2], tmp_path / command.split()[4]
    done = subprocess.run([sys.executable, "-m", "asemd.cli", "run", script], env=ENV, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 1 and "unknown" in done.stderr and f"{script}:" in done.stderr
    own.write_text(re.sub(r'style = "[^"]*"', 'style = "momentum"', own.read_text()))
    done = subprocess.run([sys.executable, "-m", "asemd.cli", *command.split()[1:]], env=ENV, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 1 and "momentum already: give yours another name" in done.stderr


def test_readme_script_runs(tmp_path):
    (name, text), = scripts(ROOT / "README.md").items()
    (tmp_path / name).write_text(text)
    out = python("-m", "asemd.cli", "run", name, cwd=tmp_path)
    rows = [line.split() for line in out.splitlines() if re.match(r" +\d+ +[\d.]+ ", line)]
    assert [int(r[0]) for r in rows] == [0, 100, 200, 300, 400, 500]
    assert (tmp_path / "log.lammps").exists()


def test_every_page_of_python_parses():
    for page in PAGES:
        for text in blocks(page, "python"):
            ast.parse(text)


def test_names_exist():
    """Every dotted name of the package that a page mentions can be imported."""
    import importlib
    for page in PAGES:
        for name in set(re.findall(r"`(asemd(?:\.\w+)+)`", page.read_text())):
            found, module = importlib.import_module("asemd"), "asemd"
            for part in name.split(".")[1:]:
                module = f"{module}.{part}"
                try:
                    found = importlib.import_module(module)
                except ModuleNotFoundError:
                    found = getattr(found, part, None)
            assert found is not None, f"{page.name}: {name}"


def test_files_exist():
    """Every link, and every source file that is named, is there."""
    for page in PAGES:
        text = page.read_text()
        for target in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", text):
            if not target.startswith("http"):
                assert (page.parent / target).exists(), f"{page.relative_to(ROOT)}: {target}"
        for path in re.findall(r"`((?:asemd|tests|docs|workflows)/[\w./-]+\.(?:py|md|txt|csv))`", text):
            assert (ROOT / path).exists(), f"{page.relative_to(ROOT)}: {path}"


def test_generated_pages_are_up_to_date():
    assert python(str(ROOT / "docs" / "generate.py"), "--check", cwd=ROOT) == ""


def test_every_decision_says_what_would_change_it():
    found = sorted((ROOT / "docs" / "decisions").glob("*.md"))
    assert found and [p.name[:4] for p in found] == [f"{k:04d}" for k in range(1, len(found) + 1)]
    for page in found:
        text = page.read_text()
        assert all(f"## {title}" in text for title in ("Context", "Choice", "Evidence", "What would change our mind")), page.name


def test_commands_of_the_readme_are_those_of_ci():
    """The two commands of the README exist, and the CI script runs the one of the tests."""
    readme, ci = (ROOT / "README.md").read_text(), (ROOT / ".ci" / "run").read_text()
    commands = [line for text in blocks(ROOT / "README.md", "sh") for line in text.splitlines()]
    assert len(commands) == 2
    install, test = (c.split(" && ") for c in commands)
    assert all(c[0].startswith("pip install .") for c in (install, test)) and " && ".join(test) in ci
    assert (ROOT / install[1].split()[1]).exists() and readme.count("docs/images/") == 1


def test_command_line_options_of_the_pages_exist():
    """Options of `asemd run` in the pages are those of the program."""
    shown = python("-m", "asemd.cli", "run", "--help", cwd=ROOT)
    for page in PAGES:
        for line in re.findall(r"asemd run [^`\n|]*", page.read_text()):
            for option in re.findall(r"(--[a-z-]+)", line):
                assert option in shown, f"{page.name}: {option}"
