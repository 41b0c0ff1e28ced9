"""A command ends when its input closes, and not before."""

import os
import threading
from types import SimpleNamespace

from mbkf.cli import stopping
from mbkf.cli.stopping import stop_with_input


def test_a_closed_input_sets_the_event_and_what_is_typed_does_not(monkeypatch):
    read, write = os.pipe()
    monkeypatch.setattr(stopping.sys, "stdin", SimpleNamespace(fileno=lambda: read))
    stop = threading.Event()
    stop_with_input(stop)
    os.write(write, b"typed\n")
    assert not stop.wait(0.2)
    os.close(write)
    assert stop.wait(10.0)
    os.close(read)
