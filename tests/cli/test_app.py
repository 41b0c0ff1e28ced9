"""`mbkf app` prints an address, serves it and ends when asked; bad options are one line."""

import signal
import subprocess
import sys
import urllib.error
import urllib.request

import pytest

from tests.waiting import PATIENCE_S


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals")
def test_it_serves_until_it_is_stopped(tmp_path):
    words = [sys.executable, "-m", "mbkf", "app", str(tmp_path / "lab"), "--no-browser"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as process:
        url = process.stdout.readline().strip()
        assert url.startswith("http://127.0.0.1:") and "token=" in url
        with pytest.raises(urllib.error.HTTPError, match="403"):
            urllib.request.urlopen(url.partition("?")[0])
        process.send_signal(signal.SIGTERM)
        assert process.wait(PATIENCE_S) == 0
    assert (tmp_path / "lab").is_dir()


@pytest.mark.parametrize(
    ("words", "fragment"),
    [
        (["{file}"], "a file stands where a folder is needed"),
        (["{folder}", "--workers", "0"], "--workers: '0' is not a whole number of one or more"),
        (["{folder}", "--port", "70000"], "--port: '70000' is not a port"),
    ],
)
def test_wrong_options_are_refused(tmp_path, refused, words, fragment):
    (tmp_path / "file").touch()
    places = {"file": tmp_path / "file", "folder": tmp_path / "lab"}
    refused(["app", *(word.format(**places) for word in words)], fragment)
