"""Secrets that carry a mark are found in files, words and variables of processes."""

import subprocess
import sys

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


def test_words_of_processes_are_seen():
    if sys.platform.startswith("linux"):
        with subprocess.Popen(
            [sys.executable, "-c", "input()", f"{FIRST}x"], stdin=subprocess.PIPE
        ) as process:
            try:
                assert any("python" in one for one in _in_processes())
            finally:
                process.kill()
