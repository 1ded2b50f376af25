"""Input with one mistake in it: one clear message that names the place, status 1, no traceback, no silent wrong run."""
from __future__ import annotations

import re
import signal
from pathlib import Path

import bad_scenes_bonded  # noqa: F401  adds its scenes to CASES
import bad_scenes_files  # noqa: F401
import bad_scenes_loops  # noqa: F401
import bad_scenes_mistakes  # noqa: F401
import bad_scenes_numbers  # noqa: F401
import pytest
from bad_scenes import CASES, DATA, SCRIPT, Case

from asemd import cli

SECONDS = 60


def edited(text: str, edits: list[tuple[str, str]]) -> str:
    for old, new in edits:
        assert old in text, f"the scene has no {old!r}"
        text = text.replace(old, new, 1)
    return text


def write(case: Case, folder: Path) -> tuple[str, str]:
    """Write script and data of a case; returns their texts."""
    script = case.text if case.text is not None else edited(SCRIPT, case.script)
    data = edited(DATA, case.data)
    (folder / "in.scene").write_bytes(script if isinstance(script, bytes) else script.encode())
    (folder / "scene.data").write_text(data, encoding="utf-8", newline="")
    for name, content in case.files.items():
        (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    return script, data


def place(case: Case, script: str, data: str) -> str:
    """`file:line` of the line that must be named."""
    if not case.at:
        return ""
    which, text = case.at
    if isinstance(text, int):
        return f"{which}:{text}"
    lines = {"in.scene": script, "scene.data": data, **case.files}[which].split("\n")
    hits = [i for i, line in enumerate(lines, 1) if line.strip() == text.strip()]
    assert len(hits) == 1, f"{len(hits)} lines read {text!r}"
    return f"{which}:{hits[0]}"


@pytest.fixture
def limited():
    """A scene that hangs fails."""
    def stop(*_):
        raise RuntimeError(f"not finished after {SECONDS} s")
    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(SECONDS)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize("case", CASES, ids=[c.name for c in CASES])
def test_bad_scene(case, tmp_path, monkeypatch, capfd, limited):
    script, data = write(case, tmp_path)
    monkeypatch.chdir(tmp_path)
    status = cli.main(["run", "in.scene", *case.arguments])
    out, err = capfd.readouterr()
    assert "Traceback" not in out + err
    errors = [line for line in err.split("\n") if line.strip()]
    if case.expect == "error":
        assert status == 1, f"ran through:\n{out[-1500:]}"
        assert len(errors) == 1 and errors[0].startswith("ERROR: "), err
        message = errors[0]
    else:
        assert status == 0, err
        assert not errors, err
        warnings = [line for line in out.split("\n") if line.startswith("WARNING") and re.search(case.words[0], line)] if case.words else []
        assert len(warnings) == (case.expect == "warning"), out
        message = " ".join(warnings)
    assert "ASEMD_DEBUG" not in message, f"an error nobody thought of: {message}"
    for word in case.words:
        assert re.search(word, message), f"{word!r} is not in: {message}"
    where = place(case, script, data)
    assert re.search(re.escape(where) + r"(?!\d)", message), f"{where} is not in: {message}"
