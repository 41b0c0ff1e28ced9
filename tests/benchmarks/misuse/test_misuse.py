"""Parts of the misuse benchmark are found, and heed an interruption."""

import re
import signal
from pathlib import Path
from types import SimpleNamespace

from benchmarks import misuse
from benchmarks.checks import Context


def test_parts_are_modules_with_rows():
    assert "files" in misuse.parts()
    assert "calls" not in misuse.parts()


def test_the_page_of_promises_names_parts_that_exist():
    page = Path(__file__).resolve().parents[3] / "docs" / "promises.md"
    named = set(re.findall(r"--only (\w+)`", page.read_text(encoding="utf-8")))
    assert named >= {"files", "full_disk", "processes", "inputs", "names", "secrets"}
    assert named - {"PART"} <= set(misuse.parts())


def test_commands_heed_an_interruption_although_a_shell_began_the_benchmark_in_the_background(
    tmp_path, monkeypatch
):
    heeded = []
    rows = SimpleNamespace(rows=lambda _: heeded.append(signal.getsignal(signal.SIGINT)) or [])
    monkeypatch.setattr(misuse.importlib, "import_module", lambda name: rows)
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        misuse.run(Context(None, tmp_path, only=("files",)))
    finally:
        signal.signal(signal.SIGINT, before)
    assert heeded == [signal.default_int_handler]
