"""The process of a live run: what it says is told, it ends when asked and with the server, and a crash says why."""

import json
import sys
from pathlib import Path

import pytest

from mbkf.app import live_run as module
from mbkf.app.live_run import LiveRun
from mbkf.errors import InvalidInput
from mbkf.stream.run.folder import LOG_FOLDER
from tests.waiting import until

PORT = 21234
"""Below the ports that systems give to sockets of their own choice."""

SAYS = """
import json, pathlib, sys
pathlib.Path("{words}").write_text(json.dumps(sys.argv[1:]))
def say(text):
    print(text, file=sys.stderr, flush=True)
say("waiting for lsl …")
say("page: http://127.0.0.1:{port}/")
say("following walk: 36 markers at 100 Hz")
{end}
"""

FOLLOWS = "sys.stdin.read()"
CRASHES = "say('Traceback (most recent call last):'); say('ZeroDivisionError: division by zero'); sys.exit(1)"
REFUSES = "say('mbkf: error: no stream'); sys.exit(2)"


@pytest.fixture
def begun(tmp_path):
    """Begins a run of a program that ends in a given way; ended afterwards."""
    runs = []

    def begin(end, session="P1"):
        script = tmp_path / "program.py"
        script.write_text(SAYS.format(words=(tmp_path / "words.json").as_posix(), port=PORT, end=end))
        run = LiveRun((sys.executable, str(script)))
        runs.append(run)
        run.start(session, ["--from=lsl"], tmp_path / "live-1")
        return run

    yield begin
    for run in runs:
        run.close()


def once(run, state):
    until(lambda: run.state().state == state, run.state)
    return run.state()


def said(run, text):
    until(lambda: text in run.state().said, run.state)
    return run.state()


def test_what_it_says_is_told_and_it_ends_when_asked(begun, tmp_path):
    run = begun(FOLLOWS)
    now = said(run, "following walk")
    assert (now.state, now.port, now.session, now.name) == ("running", PORT, "P1", "live-1") and now.goes_on
    with pytest.raises(InvalidInput, match="a live run of session 'P1' goes on already"):
        run.start("P2", [], tmp_path / "other")
    run.stop()
    run.stop()
    ended = once(run, "ended")
    assert ended.reason == "" and not ended.goes_on and ended.seconds > 0.0
    words = json.loads((tmp_path / "words.json").read_text())
    assert words[:2] == ["live", "--from=lsl"]
    assert {"--view", f"--out={tmp_path / 'live-1'}", "--end-with-input"} <= set(words)


@pytest.mark.parametrize(
    ("end", "why"),
    [
        (CRASHES, "ZeroDivisionError: division by zero"),
        (REFUSES, "no stream"),
        ("import os; os._exit(3)", "following walk: 36 markers at 100 Hz"),
    ],
)
def test_a_crash_is_told_by_its_last_line(begun, end, why):
    failed = once(begun(end), "failed")
    assert failed.reason == why and not failed.goes_on


def test_a_crash_without_a_word_is_told_with_its_status(tmp_path):
    (tmp_path / "silent.py").write_text("raise SystemExit(7)")
    run = LiveRun((sys.executable, str(tmp_path / "silent.py")))
    assert run.state() is None
    run.stop()
    run.start("P1", [], tmp_path / "live-1")
    assert once(run, "failed").reason == "it ended with status 7 and without a message"


@pytest.mark.parametrize("status", [0, 2])
def test_what_a_crash_left_in_its_log_is_recovered_if_it_can_be(begun, tmp_path, status):
    (tmp_path / "live-1" / LOG_FOLDER).mkdir(parents=True)
    end = f"sys.exit({status} if any(word.startswith('--recover') for word in sys.argv) else 1)"
    failed = once(begun(end), "failed")
    kept = "; the frames recorded until then are kept"
    assert failed.reason == "following walk: 36 markers at 100 Hz" + ("" if status else kept)
    assert json.loads((tmp_path / "words.json").read_text()) == ["live", f"--recover={tmp_path / 'live-1'}"]


def test_it_ends_with_the_server(begun):
    run = begun(FOLLOWS)
    said(run, "following")
    run.close()
    assert run.state().state == "ended"


def test_one_that_does_not_end_is_killed_with_the_server(begun, monkeypatch):
    monkeypatch.setattr(module, "END_S", 0.3)
    run = begun("import time; time.sleep(600)")
    said(run, "following")
    run.close()
    assert run.state().state == "failed"


def test_the_next_page_has_the_address_of_the_one_before(begun, tmp_path):
    """So that the browser keeps plots and targets."""
    run = begun(FOLLOWS)
    said(run, "following")
    assert "--view-port=0" in json.loads((tmp_path / "words.json").read_text())
    run.stop()
    once(run, "ended")
    run.start("P2", [], Path(tmp_path / "live-2"))
    said(run, "following")
    assert f"--view-port={PORT}" in json.loads((tmp_path / "words.json").read_text())
    assert run.state().name == "live-2"
