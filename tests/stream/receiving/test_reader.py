"""One frame after the other from a source whose library may fail."""

import threading

import pytest

from mbkf.stream.receiving import reader
from mbkf.stream.receiving.reader import next_frame


class Source:
    """A source that gives what it was made with, one by one."""

    patient = True

    def __init__(self, *script):
        self.script = list(script)

    def read(self, timeout_s):
        if not self.script:
            raise EOFError
        one = self.script.pop(0)
        if isinstance(one, Exception):
            raise one
        return one

    def news(self):
        return [("markers back", "the stream is back")]


def test_failures_become_events_and_the_end_is_passed_on(monkeypatch):
    monkeypatch.setattr(reader, "PAUSE_S", 0.001)
    source, notes = Source("frame", OSError("gone"), None), []
    found = [next_frame(source, lambda *note: notes.append(note), threading.Event()) for _ in range(3)]
    back = ("markers back", "the stream is back")
    assert found == ["frame", None, None]
    assert notes == [back, ("source", "the source failed (OSError: gone)"), back]
    with pytest.raises(EOFError):
        next_frame(source, lambda *_: None, threading.Event())
