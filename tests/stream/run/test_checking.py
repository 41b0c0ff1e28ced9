"""Checks of a run in a process of their own: asked for as frames come, and ended with the run."""

import pytest

from mbkf.stream.run import checking
from mbkf.stream.run.checking import LiveChecks
from tests.waiting import until

ECHO = """
import json, sys
for k, line in enumerate(sys.stdin):
    judged = dict(verdict="outside", hint=line) if "person" in line else dict(verdict="inside")
    one = dict(name=f"{sys.argv[1]} {k}", value=1.0, expected_sd=0.5, unit="%", bound=5.0, **judged)
    print(json.dumps({"findings": [one], "exchanged": [["A", "B", 0.9], ["C", "D", 0.1]]}), flush=True)
"""


@pytest.fixture
def notes():
    return []


@pytest.fixture
def checks(tmp_path, notes):
    made = LiveChecks(tmp_path, 100.0, lambda *note: notes.append(note))
    yield made
    made.close()


def test_checks_are_asked_for_after_ever_longer_times(checks, monkeypatch, tmp_path, notes):
    monkeypatch.setattr(checking, "PROGRAM", ECHO)
    checks.reached(99)
    assert checks._thread is None, "a short run needs no process"
    checks.reached(149)
    assert checks._asked.empty() and checks.findings == ()
    checks.reached(150)
    until(lambda: checks.findings)
    assert checks.findings[0].name == f"{tmp_path} 0" and checks.findings[0].verdict == "inside"
    checks.reached(299)
    checks.reached(600)
    until(lambda: checks.findings[0].name.endswith(" 2"))
    process = checks._process
    checks.close()
    assert process.poll() is not None
    ((kind, sentence, *_),) = notes
    assert kind == "names" and sentence.startswith("the names of A and B are exchanged: "), (
        "once, the lasting pair"
    )


def test_a_process_that_ends_is_noted_once(checks, monkeypatch, notes):
    monkeypatch.setattr(checking, "PROGRAM", "import sys; sys.stdin.readline()")
    checks.reached(200)
    until(lambda: notes)
    assert notes[0][0] == "checks" and "at the end of the run only" in notes[0][1]
    checks.reached(400)
    checks.close()
    assert len(notes) == 1


def test_a_process_that_cannot_start_is_noted(checks, monkeypatch, notes):
    def fails(_folder):
        raise OSError("no memory")

    monkeypatch.setattr(checking, "_started", fails)
    checks.reached(200)
    until(lambda: notes)
    assert "cannot start (no memory)" in notes[0][1]


def test_another_person_after_a_restart_is_reported(checks, monkeypatch, notes):
    monkeypatch.setattr(checking, "PROGRAM", ECHO)
    checks.reached(100)
    checks.restarted(120)
    checks.reached(319)
    checks.reached(320)
    until(lambda: len(notes) == 2)
    ((_, names, *_), (kind, sentence, frame, _)) = notes
    assert "A and B" in names and (kind, frame) == ("person", 120)
    assert sentence.startswith("from 1.2 s on, ") and "person 120" in sentence
    assert "person" not in checks.findings[0].hint, "the checks of the run stay"
