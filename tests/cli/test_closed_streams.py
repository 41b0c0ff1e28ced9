"""A command whose streams the caller closed works, and its words go into no file."""

import subprocess
import sys

import pytest

PROGRAM = """
import os, sys
from mbkf.cli.closed_streams import open_closed_streams
open_closed_streams()
with open(sys.argv[1], "w") as file:
    print("for the terminal", flush=True)
    print("for the terminal", file=sys.stderr, flush=True)
    file.write(str(file.fileno()))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="needs a POSIX shell")
@pytest.mark.parametrize("closed", ["<&-", ">&-", "2>&-", "<&- >&- 2>&-"])
def test_words_for_a_closed_stream_go_into_no_file(tmp_path, closed):
    file = tmp_path / "file"
    words = ["sh", "-c", f'"$0" -c "$1" "$2" {closed}', sys.executable, PROGRAM, file]
    subprocess.run(words, check=True, capture_output=True)
    assert int(file.read_text()) > 2
