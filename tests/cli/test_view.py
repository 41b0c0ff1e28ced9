"""`mbkf view` writes one page or serves it until interrupted; bad input is one line."""

import signal
import subprocess
import sys
import urllib.request

import pytest

from mbkf.cli.main import main
from mbkf.io.results_folder import write_reconstruction
from mbkf.trial.results.summary import summarise
from tests.recordings import walk
from tests.waiting import PATIENCE_S

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    return write_reconstruction(walk(), summarise(walk()), tmp_path_factory.mktemp("walk") / "result")


def test_html_writes_one_page(result, tmp_path, capsys):
    assert main(["view", str(result), "--html", str(tmp_path / "walk.html")]) == 0
    assert capsys.readouterr().out.strip() == str(tmp_path / "walk.html")
    assert "MeshCat" in (tmp_path / "walk.html").read_text(encoding="utf-8")


HEEDING = "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler)"
"""A shell's background job is born ignoring SIGINT, and so are its children."""


def test_the_page_is_served_until_interrupted(result):
    code = f"{HEEDING}; from mbkf.cli.main import main; sys.exit(main(sys.argv[1:]))"
    words = [sys.executable, "-c", code, "view", str(result), "--no-browser"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            url = process.stdout.readline().strip()
            with urllib.request.urlopen(url, timeout=PATIENCE_S) as answer:
                assert b"walk" in answer.read()
        finally:
            process.send_signal(signal.SIGINT)
        assert process.wait(PATIENCE_S) == 0, process.stderr.read()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["{none}"], "make it with 'mbkf reconstruct'"),
        (["{result}", "--port", "70000"], "--port: '70000' is not a port"),
        (["{result}", "--address", "192.0.2.1", "--no-browser"], "choose another address"),
        (["{result}", "--html", "{result}"], "is a folder"),
    ],
)
def test_bad_input_is_one_line(words, message, result, tmp_path, refused):
    places = {"none": tmp_path / "none", "result": result}
    refused(["view", *(word.format(**places) for word in words)], message)
