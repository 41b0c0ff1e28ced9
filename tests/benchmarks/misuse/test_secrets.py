"""Secrets that carry a mark are found in files, words and variables of processes."""

import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks.misuse.marked_secrets import FIRST, MARK
from benchmarks.misuse.secrets import _in_processes, _readable

PRINTS_A_TOKEN = """
import secrets, sys
from benchmarks.misuse import marked_secrets
import mbkf.cli.main
mbkf.cli.main.main = lambda words: print(secrets.token_urlsafe(16), secrets.token_urlsafe(16))
marked_secrets.main()
"""


def test_the_first_secret_of_a_command_is_told_from_later_ones():
    done = subprocess.run([sys.executable, "-c", PRINTS_A_TOKEN], capture_output=True, text=True, check=True)
    first, second = done.stdout.split()
    assert first.startswith(FIRST)
    assert second.startswith(MARK)
    assert not second.startswith(FIRST)


def test_files_that_only_their_owner_reads_may_hold_secrets(tmp_path):
    for name, mode in (("mine", 0o600), ("everybody's", 0o644)):
        (tmp_path / name).write_text(f"token={FIRST}abc")
        (tmp_path / name).chmod(mode)
    (tmp_path / "nothing").write_text("x")
    assert list(_readable(tmp_path)) == ["everybody's may be read by others"]


@pytest.mark.skipif(not Path("/proc/self/cmdline").exists(), reason="no /proc here")
def test_words_of_processes_are_seen():
    """The process speaks first: its words are complete only after it has begun."""
    command = [sys.executable, "-c", "print('begun', flush=True); input()", f"{FIRST}x"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        try:
            process.stdout.readline()
            assert any("python" in one for one in _in_processes())
        finally:
            process.kill()
