"""A source is waited for until it is there, the patience is over or nobody wants it any more."""

import threading

import pytest

from mbkf.errors import InvalidInput
from mbkf.stream.run.connecting import wait_for


class Late:
    """Appears when it has been looked for a few times."""

    def __init__(self, looks):
        self.looks = looks

    def connect(self, timeout_s):
        self.looks -= 1
        return "here" if self.looks <= 0 else None


def test_a_late_source_is_waited_for():
    source = Late(4)
    assert wait_for(source, "lsl", threading.Event(), None) == "here"
    assert source.looks == 0


def test_patience_ends_in_one_line():
    with pytest.raises(InvalidInput, match="no lsl stream appeared within 0 s; start it"):
        wait_for(Late(10), "lsl", threading.Event(), 0.0)


def test_it_can_be_stopped():
    stop, source = threading.Event(), Late(1)
    stop.set()
    assert wait_for(source, "lsl", stop, None) is None
    assert source.looks == 1
