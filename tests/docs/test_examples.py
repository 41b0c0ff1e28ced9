"""Every example of the documentation runs, and what it asserts holds."""

import io
import platform
import runpy
import subprocess
import sys
from contextlib import redirect_stdout
from pathlib import Path

import pytest

from mbkf.cli.main import main
from tests.studies import ThisProcess, from_standing

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = sorted((ROOT / "docs" / "examples").glob("[0-9]*.py"))


def command(words, *, capture_output=False, text=False, check):
    """Does in this process what an example lets a process of its own do: commands of mbkf."""
    assert words[:3] == [sys.executable, "-m", "mbkf"] and check
    with redirect_stdout(io.StringIO() if capture_output else sys.stdout) as printed:
        assert main(words[3:]) == 0
    return subprocess.CompletedProcess(words, 0, printed.getvalue() if text else None)


@pytest.fixture
def here(monkeypatch):
    """No example starts a process: other tests prove that commands and workers do; bodies are those of the static."""
    platform.processor()  # libraries ask for it as they are loaded, which takes a process once
    monkeypatch.setattr(subprocess, "run", command)
    monkeypatch.setattr("mbkf.study.batch.run.LocalWorkers", ThisProcess)
    monkeypatch.setattr("mbkf.study.batch.person.scale_from_session", from_standing)


@pytest.mark.slow
@pytest.mark.usefixtures("here", "registries")
@pytest.mark.parametrize("script", EXAMPLES, ids=lambda path: path.stem)
def test_example_runs(script, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(script), run_name="__main__")
    assert capsys.readouterr().out.strip(), "an example shows what it found"


def test_examples_are_numbered_without_gaps_and_shown_in_a_page():
    assert [int(path.name[:2]) for path in EXAMPLES] == list(range(1, len(EXAMPLES) + 1))
    pages = "".join(page.read_text(encoding="utf-8") for page in (ROOT / "docs").rglob("*.md"))
    assert [path.name for path in EXAMPLES if f"examples/{path.name}" not in pages] == []
