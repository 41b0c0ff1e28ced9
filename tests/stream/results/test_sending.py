"""Results are sent in a thread of their own: a slow receiver never holds up the filter."""

import threading

import pytest

from mbkf.stream.results.sending import SendingThread
from tests.waiting import PATIENCE_S


@pytest.mark.parametrize("held", [2, 256])
def test_a_slow_receiver_does_not_hold_up_the_sender(held):
    got, gate = [], threading.Event()

    def slow(frame):
        gate.wait(PATIENCE_S)
        got.append(frame)

    sending = SendingThread(slow, "test", held)
    for k in range(200):
        sending.take(k)
    assert got == []  # all are taken, and the receiver still has its first
    gate.set()
    sending.close()
    assert got[-1] == 199
    assert got == sorted(got)
    if held == 256:
        assert got == list(range(200))
